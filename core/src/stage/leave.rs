//! Leave: blocks in the form of ports.
//!
//! Mantissas stay; an exponent is saturated to the 16 bits of a port, and that of a block of zeros is 0.

use crate::block::Block;
use crate::fx::Fx;
use crate::ports::PortBlock;
use crate::word::Word;

/// A block as a port shows it.
#[inline(always)]
pub fn leave<W: Word, const N: usize>(block: &Block<W, N>) -> PortBlock<W, N> {
    let exponent = block.e.saturate(Fx::int(i16::MIN.into()), Fx::int(i16::MAX.into()));
    PortBlock { mantissa: block.m, exponent: Fx::select(block.is_zero(), Fx::int(0), exponent) }
}
