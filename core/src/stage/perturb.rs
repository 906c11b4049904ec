//! Perturb: n_mod = n + b₁E₁ + b₂E₂ (W97 App. A), summed exactly up to a common exponent and rounded once.
//!
//! E₁ and E₂ are perpendicular to n, so |n_mod| ≥ |n|: nothing cancels. Error: that of E times |b|/|n_mod| < 1.

use crate::block::{Block, MANTISSA, ZERO_EXPONENT, normalise, places_below};
use crate::each::each;
use crate::fx::{Fx, Wide};
use crate::ports::OFFSET;
use crate::precision::Precision;
use crate::word::{Wire, Word};

/// Bits before the point of a term.
const TERM: u32 = OFFSET + MANTISSA + 1;

/// n + b₁E₁ + b₂E₂. The tangent basis is in units of the mantissas of n; the result carries the exponent of n.
///
/// Range: |b| < 8 with `offset_bits` kept fraction bits. n = 0 gives 0 if the basis is zero too.
#[inline(always)]
pub fn perturb<W: Word>(
    n: &Block<W, 3>,
    offset: &[Fx<W, OFFSET>; 2],
    tangents: [&Block<W, 3>; 2],
    p: &Precision,
) -> Block<W, 3> {
    // Terms with 7 bits before the point: |n| ≤ 1, |b·E| ≤ 8, their sum stays below 32.
    let zero = Fx::int(ZERO_EXPONENT);
    let most = <W::Wide as Wire>::BITS - 1;
    let exponents = each!(i in [0, 1] => Fx::select(offset[i].is_zero(), zero, tangents[i].e));
    let top = exponents[0].max(exponents[1]).max(Fx::select(n.is_zero(), zero, Fx::int(0)));
    let sum = each!(axis in [0, 1, 2] => {
        let mut sum: Wide<W, TERM> = n.m[axis].widen().floor_shr_by(places_below(Fx::int(0), top, most));
        for i in 0..2 {
            let term: Wide<W, { OFFSET + MANTISSA }> = offset[i].mul(tangents[i].m[axis]);
            let term = term.floor_shr(1).reread::<TERM>();
            sum = sum + term.floor_shr_by(places_below(exponents[i], top, most));
        }
        sum
    });
    // Without an offset n is passed on unchanged: its largest mantissa may be 1, which normalising again would halve.
    let flat = offset[0].is_zero() & offset[1].is_zero();
    Block::select(flat, *n, normalise(sum, top + n.e, p.fraction_bits))
}
