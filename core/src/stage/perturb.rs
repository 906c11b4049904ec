//! Perturb: n_mod = n + b₁E₁ + b₂E₂ (W97 App. A), summed exactly up to a common exponent and rounded once.
//!
//! E₁ and E₂ are perpendicular to n, so |n_mod| ≥ |n|: nothing cancels. Error: that of E times |b|/|n_mod| < 1.

use crate::block::{Block, ZERO_EXPONENT, normalise, places_below};
use crate::each::each;
use crate::fx::{Fx, Wide};
use crate::precision::Precision;
use crate::signals::OFFSET;
use crate::word::Word;

/// n + b₁E₁ + b₂E₂. The frame is in units of the mantissas of n; the result carries the exponent of n.
///
/// Range: |b| < 8 in I4F28 with `offset_bits` kept fraction bits. n = 0 gives 0 where the frame is zero too.
#[inline(always)]
pub fn perturb<W: Word>(
    n: &Block<W, 3>,
    offset: &[Fx<W, OFFSET>; 2],
    tangents: [&Block<W, 3>; 2],
    p: &Precision,
) -> Block<W, 3> {
    // Terms with 57 fraction bits: |n| ≤ 2^57, |b·E| ≤ 2^60, their sum stays below 2^62.
    let zero = Fx::lit(ZERO_EXPONENT);
    let exponents = each!(i in [0, 1] => Fx::select(offset[i].is_zero(), zero, tangents[i].e));
    let top = exponents[0].max(exponents[1]).max(Fx::select(n.is_zero(), zero, Fx::zero()));
    let sum = each!(axis in [0, 1, 2] => {
        let mut sum: Wide<W, 57> = n.m[axis].widen().floor_shr_by(places_below(Fx::zero(), top, 63));
        for i in 0..2 {
            let term: Wide<W, 58> = offset[i].mul(tangents[i].m[axis]);
            let term = term.floor_shr(1).reread::<57>();
            sum = sum + term.floor_shr_by(places_below(exponents[i], top, 63));
        }
        sum
    });
    // Without an offset n stays as it came: its largest mantissa may be 1, which normalising again would halve.
    let flat = offset[0].is_zero() & offset[1].is_zero();
    Block::select(flat, *n, normalise(sum, top + n.e, p.fraction_bits))
}
