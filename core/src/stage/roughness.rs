//! Roughness decode: the stored D (or I₁) as two tangents, the images of the unit vectors of its ellipse.
//!
//! K = D Dᵀ with D = [[d₁, d₂], [0, d₃]] (S97 §8; erratum 1): the columns of (E₁ E₂)·D are d₁E₁ and
//! d₂E₁ + d₃E₂. Isotropic: I₁E₁ and I₁E₂, I₁² the larger eigenvalue (S97 §8).

use crate::block::{Block, MANTISSA, ZERO_EXPONENT, normalise, places_below};
use crate::each::each;
use crate::fx::{Fx, Wide};
use crate::ports::OFFSET;
use crate::precision::Precision;
use crate::word::{Wire, Word};

/// Bits before the point of a roughness times a tangent, at most 8, and of the sum of two.
const TERM: u32 = OFFSET + MANTISSA;

/// A number times a tangent.
#[inline(always)]
fn times<W: Word>(d: Fx<W, OFFSET>, tangent: &Block<W, 3>, fraction_bits: u32) -> Block<W, 3> {
    normalise(each!(m in tangent.m => d.mul::<MANTISSA, TERM>(m)), tangent.e, fraction_bits)
}

/// d₁E₁ and d₂E₁ + d₃E₂.
#[inline(always)]
pub fn anisotropic<W: Word>(
    d: &[Fx<W, OFFSET>; 3],
    e1: &Block<W, 3>,
    e2: &Block<W, 3>,
    p: &Precision,
) -> [Block<W, 3>; 2] {
    let [e_1, e_2] =
        each!((d, e) in [(d[1], e1.e), (d[2], e2.e)] => Fx::select(d.is_zero(), Fx::int(ZERO_EXPONENT), e));
    let top = e_1.max(e_2);
    let most = <W::Wide as Wire>::BITS - 1;
    let (places_1, places_2) = (places_below(e_1, top, most), places_below(e_2, top, most));
    let sum = each!(i in [0, 1, 2] => {
        let first: Wide<W, TERM> = d[1].mul(e1.m[i]);
        let second: Wide<W, TERM> = d[2].mul(e2.m[i]);
        first.floor_shr_by(places_1) + second.floor_shr_by(places_2)
    });
    [times(d[0], e1, p.fraction_bits), normalise(sum, top, p.fraction_bits)]
}

/// log₂ of the ratio between the widths of a lobe and of its core, for surfaces with two lobes.
const LOG2_CORE: i64 = 2;

/// Lobe at a quarter of its deviations: a change of the exponent. It is the lobe of the facets that make up most of a surface, if a few facets are
/// steep.
#[inline(always)]
pub fn core<W: Word>(rough: &[Block<W, 3>; 2]) -> [Block<W, 3>; 2] {
    each!(c in *rough => c.scaled(Fx::int(-LOG2_CORE)))
}

/// I₁E₁ and I₁E₂.
#[inline(always)]
pub fn isotropic<W: Word>(i1: Fx<W, OFFSET>, e1: &Block<W, 3>, e2: &Block<W, 3>, p: &Precision) -> [Block<W, 3>; 2] {
    [times(i1, e1, p.fraction_bits), times(i1, e2, p.fraction_bits)]
}
