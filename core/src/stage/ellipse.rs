//! Ellipse: K = (1/12)(q₁q₁ᵀ + q₂q₂ᵀ) + q₃q₃ᵀ + q₄q₄ᵀ, all of it covariances (W97 (3), (12), (13); errata 1, 4, 5).
//!
//! det K = Σ of the squared 2×2 minors of the columns (Cauchy–Binet, erratum 12): nothing cancels. The columns
//! come to one exponent first, so nothing over- or underflows. Error of K: 2^−(p−2) of its larger diagonal.

use crate::block::{Block, align, normalise};
use crate::fx::{Fx, Wide};
use crate::precision::Precision;
use crate::rom;
use crate::signals::Ellipse;
use crate::word::Word;

/// The covariance of a pixel's two columns: a box of one pixel has variance 1/12.
#[inline(always)]
pub fn pixel_columns<W: Word>(columns: &[Block<W, 2>; 2], p: &Precision) -> [Block<W, 2>; 2] {
    let sigma = Fx::lit(i64::from(rom::BOX_SIGMA)).keep(p.fraction_bits);
    columns.map(|q| normalise(q.m.map(|m| m.mul::<30, 60>(sigma)), q.e, p.fraction_bits))
}

/// The ellipse of `COLUMNS` columns (2 or 4), each a covariance's square root.
#[inline(always)]
pub fn ellipse<W: Word, const COLUMNS: usize>(columns: [Block<W, 2>; COLUMNS], p: &Precision) -> Ellipse<W> {
    let keep = p.fraction_bits;
    let (q, e) = align(columns, keep);
    let sum =
        |i: usize, j: usize| -> Wide<W, 60> { q.iter().fold(Fx::zero(), |sum, column| sum + column[i].mul(column[j])) };
    // 2 columns have 1 minor, 4 have 6; unused places stay zero.
    let mut minors: [Wide<W, 60>; 6] = [Fx::zero(); 6];
    let pairs = (0..COLUMNS).flat_map(|i| (i + 1..COLUMNS).map(move |j| (i, j)));
    for (minor, (i, j)) in minors.iter_mut().zip(pairs) {
        if let (Some(a), Some(b)) = (q.get(i), q.get(j)) {
            *minor = a[0].mul::<30, 60>(b[1]) - b[0].mul(a[1]);
        }
    }
    let minors = normalise(minors, e + e, keep);
    let squares = minors.m.iter().fold(Fx::zero(), |sum, &minor| sum + minor.mul::<30, 60>(minor));
    Ellipse {
        k: normalise([sum(0, 0), sum(0, 1), sum(1, 1)], e + e, keep),
        det: Block::of(squares, minors.e + minors.e, keep),
    }
}
