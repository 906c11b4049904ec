//! Ellipse: K = (1/12)(q₁q₁ᵀ + q₂q₂ᵀ) + q₃q₃ᵀ + q₄q₄ᵀ, all of it covariances (W97 (3), (12), (13); errata 1, 4, 5).
//!
//! det K = Σ of the squared 2×2 minors of the columns (Cauchy–Binet, erratum 12): nothing cancels. The columns
//! come to one exponent first, so nothing over- or underflows. Error of K: 2^−(p−2) of its larger diagonal.

use crate::block::{Block, MANTISSA, PRODUCT, Product, align, dot, normalise, number};
use crate::each::{each, places};
use crate::fx::Fx;
use crate::precision::Precision;
use crate::rom;
use crate::signals::Ellipse;
use crate::word::Word;

/// Columns as standard deviations. The first two are those of a pixel: a box of one pixel has variance 1/12.
#[inline(always)]
pub fn pixel_columns<W: Word, const N: usize, const COLUMNS: usize>(
    columns: &[Block<W, N>; COLUMNS],
    p: &Precision,
) -> [Block<W, N>; COLUMNS] {
    let sigma = Fx::entry(rom::BOX_SIGMA).quantise(p.fraction_bits);
    each!(column in places() => {
        let q = columns[column];
        if column < 2 {
            normalise(each!(m in q.m => m.mul::<MANTISSA, PRODUCT>(sigma)), q.e, p.fraction_bits)
        } else {
            q
        }
    })
}

/// Ellipse of `COLUMNS` columns (2 or 4), each a covariance's square root.
#[inline(always)]
pub fn ellipse<W: Word, const COLUMNS: usize>(columns: [Block<W, 2>; COLUMNS], p: &Precision) -> Ellipse<W> {
    let fraction_bits = p.fraction_bits;
    let (q, e) = align(columns, fraction_bits);
    let sums = each!((i, j) in [(0, 0), (0, 1), (1, 1)] => {
        let mut sum: Product<W> = Fx::zero();
        for column in &q {
            sum = sum + column[i].mul(column[j]);
        }
        sum
    });
    // 2 columns have 1 minor, 4 have 6; unused places stay zero.
    let minors: [Product<W>; 6] = each!((i, j) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] => {
        match (q.get(i), q.get(j)) {
            (Some(a), Some(b)) => a[0].mul::<MANTISSA, PRODUCT>(b[1]) - b[0].mul(a[1]),
            _ => Fx::zero(),
        }
    });
    let minors = normalise(minors, e + e, fraction_bits);
    let squares = dot(&minors.m, &minors.m);
    Ellipse { k: normalise(sums, e + e, fraction_bits), det: number(squares, minors.e + minors.e, fraction_bits) }
}
