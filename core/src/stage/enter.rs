//! Enter: what comes through a port is brought to the form the datapath works in.
//!
//! A vector's largest component comes to [½, 1] by an exact shift and is rounded to `fraction_bits`, exactly if the
//! port carries no more significant bits; its exponent saturates at ±2^11, beyond every float64. An offset is rounded to the bits
//! the profile keeps.

use crate::block::{Block, MAX_EXPONENT, PRODUCT, normalise};
use crate::each::each;
use crate::fx::Fx;
use crate::ports::{OFFSET, PortBlock};
use crate::precision::Precision;
use crate::word::Word;

/// A vector or a derivative, normalised. Range: any mantissas, any exponent of 16 bits.
#[inline(always)]
pub fn enter<W: Word, const N: usize>(port: &PortBlock<W, N>, p: &Precision) -> Block<W, N> {
    let e = port.exponent.saturate(Fx::int(-MAX_EXPONENT), Fx::int(MAX_EXPONENT));
    normalise(each!(m in port.mantissa => m.widen::<PRODUCT>()), e, p.fraction_bits)
}

/// An offset or a roughness with the bits the profile keeps. What would round up to 8 saturates to the largest number
/// below it.
#[inline(always)]
pub fn enter_offset<W: Word>(x: Fx<W, OFFSET>, p: &Precision) -> Fx<W, OFFSET> {
    let dropped = Fx::<W, OFFSET>::FRACTION.saturating_sub(p.offset_bits());
    let largest = ((1 << (W::BITS - 1 - dropped)) - 1) << dropped;
    x.min(Fx::lit(largest)).keep(p.offset_bits())
}
