//! Enter: brings port values to the form in which the datapath works.
//!
//! An exact shift brings a vector's largest component to [½, 1]. It is then rounded to `fraction_bits`, exactly if the port carries no more
//! significant bits. The exponent saturates at ±2^11, beyond every float64. An offset is rounded to the bits that the profile keeps.

use crate::block::{Block, MAX_EXPONENT, PRODUCT, normalise};
use crate::each::each;
use crate::fx::Fx;
use crate::ports::{OFFSET, PortBlock};
use crate::precision::Precision;
use crate::word::Word;

/// Normalises a vector or a derivative. Range: any mantissas, any 16-bit exponent.
#[inline(always)]
pub fn enter<W: Word, const N: usize>(port: &PortBlock<W, N>, p: &Precision) -> Block<W, N> {
    let e = port.exponent.saturate(Fx::int(-MAX_EXPONENT), Fx::int(MAX_EXPONENT));
    normalise(each!(m in port.mantissa => m.widen::<PRODUCT>()), e, p.fraction_bits)
}

/// Rounds an offset or a roughness to the bits that the profile keeps. A value that would round up to 8 saturates to the largest number below it.
#[inline(always)]
pub fn enter_offset<W: Word>(x: Fx<W, OFFSET>, p: &Precision) -> Fx<W, OFFSET> {
    let dropped = Fx::<W, OFFSET>::FRACTION.saturating_sub(p.offset_bits());
    let largest = ((1 << (W::BITS - 1 - dropped)) - 1) << dropped;
    x.min(Fx::lit(largest)).quantise(p.offset_bits())
}
