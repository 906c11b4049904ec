//! Leave: blocks in the form of ports.
//!
//! Mantissas stay as they are. An exponent is saturated to the 16 bits of a port; a block of zeros has the exponent 0.

use crate::block::Block;
use crate::fx::Fx;
use crate::ports::PortBlock;
use crate::word::Word;

/// Block in the form of a port.
#[inline(always)]
pub fn leave<W: Word, const N: usize>(block: &Block<W, N>) -> PortBlock<W, N> {
    let exponent = block.e.saturate(Fx::int(i16::MIN.into()), Fx::int(i16::MAX.into()));
    PortBlock { mantissa: block.m, exponent: Fx::select(block.is_zero(), Fx::int(0), exponent) }
}
