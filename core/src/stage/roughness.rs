//! Roughness decode: the stored D (or I₁) as two tangents, the images of the unit vectors of its ellipse.
//!
//! K = D Dᵀ with D = [[d₁, d₂], [0, d₃]] (S97 §8; erratum 1): the columns of (E₁ E₂)·D are d₁E₁ and
//! d₂E₁ + d₃E₂. Isotropic: I₁E₁ and I₁E₂, I₁² the larger eigenvalue (S97 §8).

use crate::block::{Block, MANTISSA, ZERO_EXPONENT, normalise, places_below};
use crate::each::each;
use crate::fx::{Control, Fx, Wide};
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

/// Tangents of one of two lobes: those of the roughness times its width, 0…4. A power of two changes the exponent alone.
#[inline(always)]
pub fn lobe<W: Word>(rough: &[Block<W, 3>; 2], width: Control<W, OFFSET>, p: &Precision) -> [Block<W, 3>; 2] {
    let width = Fx::of_control::<OFFSET>(width);
    each!(c in *rough => times(width, &c, p.fraction_bits))
}

/// I₁E₁ and I₁E₂.
#[inline(always)]
pub fn isotropic<W: Word>(i1: Fx<W, OFFSET>, e1: &Block<W, 3>, e2: &Block<W, 3>, p: &Precision) -> [Block<W, 3>; 2] {
    [times(i1, e1, p.fraction_bits), times(i1, e2, p.fraction_bits)]
}
