//! Normalisation as operations of the algebra. Its wires are one part of a stage, which a recording may mark.

use crate::each::each;
use crate::word::{WideWire, Wire, Word};

/// Gives [`WideWire::normalised`] by operations of the algebra.
#[inline(always)]
pub fn normalised<X: WideWire, const N: usize>(wires: [X; N], drop: u32, up: u32) -> ([X::Word; N], X::Count, X::Flag) {
    // One's complement magnitude: −2^k counts as the octave below, so −1 can occur. As many leading zeros as there are bits do not identify a
    // block of zeros: −1 has them, too, but is negative.
    let (mut magnitude, mut bits) = (X::lit(0), X::lit(0));
    for &wire in &wires {
        (magnitude, bits) = (magnitude.or(wire.xor(wire.sar(X::BITS - 1))), bits.or(wire));
    }
    let zeros = magnitude.leading_zeros();
    let all_zero = !zeros.lt(Wire::lit(X::BITS.into())) & !bits.lt(X::lit(0));
    let shift = zeros.sub(Wire::lit(1));
    (each!(wire in wires => X::Word::round(wire.shl_by(shift), drop, up)), zeros, all_zero)
}
