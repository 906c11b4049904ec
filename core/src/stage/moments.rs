//! Moments: what a footprint sees of a bumpy surface, mean offset and the covariance around it.
//!
//! Interpolated within a probe are b and K = D Dᵀ, never D (erratum 15). Averaged over the probes are b and the
//! second moments K + b bᵀ, so the variance of the *means* between probes is kept, as S97's recursion keeps it
//! between levels (erratum 14). Between the texels of one bilinear patch the surface is a ramp narrower than the
//! probe; counting its corners as a distribution would triple the ramp's variance and blur a magnified map
//! (measured on resolved bumps: 3.7 dB). The result becomes D again, K = D Dᵀ: d₃ = √c, d₂ = b/√c,
//! d₁ = √(a − b²/c); c = 0 gives d₂ = 0, d₁ = √a (erratum 13). Numbers are in units of the map's scale: |b|, |d| ≤ 1.
//! A square is rounded alike on both ways, so that equal probes give back their K to the bit, none where nothing is lost.
//! Error: K 2^−28 absolute, D the root of it.

use crate::block::{Block, Mantissa, normalise, places_below};
use crate::elementary::root_and_inverse;
use crate::fx::{Fx, Wide};
use crate::precision::Precision;
use crate::word::Word;

/// Fraction bits of a second moment; |·| ≤ 3.
pub const MOMENT: u32 = 29;

/// b₁, b₂ and three elements of a symmetric matrix (11, 12, 22): five channels.
pub type Moments<W> = ([Mantissa<W>; 2], [Fx<W, MOMENT>; 3]);

/// K = D Dᵀ of one texel, the channels that are interpolated beside b.
#[inline(always)]
pub fn of_texel<W: Word>(d: &[Mantissa<W>; 3]) -> [Fx<W, MOMENT>; 3] {
    let product = |a: Mantissa<W>, b: Mantissa<W>| -> Wide<W, 60> { a.mul(b) };
    let [d1, d2, d3] = *d;
    [product(d1, d1) + product(d2, d2), product(d2, d3), product(d3, d3)].map(|element| element.round_to(MOMENT))
}

/// K of one texel that stores the isotropic I₁.
#[inline(always)]
pub fn of_isotropic_texel<W: Word>(i1: Mantissa<W>) -> [Fx<W, MOMENT>; 3] {
    of_texel(&[i1, Fx::zero(), i1])
}

/// Second moments K + b bᵀ of one probe, the channels that are averaged over probes beside b. |·| ≤ 3.
#[inline(always)]
pub fn of_probe<W: Word>(b: &[Mantissa<W>; 2], k: &[Fx<W, MOMENT>; 3]) -> [Fx<W, MOMENT>; 3] {
    let squares = squares(b);
    [0, 1, 2].map(|i| k[i] + squares[i])
}

/// b bᵀ as second moments.
#[inline(always)]
fn squares<W: Word>(b: &[Mantissa<W>; 2]) -> [Fx<W, MOMENT>; 3] {
    [(0, 0), (0, 1), (1, 1)].map(|(x, y)| b[x].mul::<30, 60>(b[y]).round_to(MOMENT))
}

/// Covariance around the mean: a, b, c of K as a block, a and c not negative.
#[inline(always)]
pub fn covariance<W: Word>(moments: &Moments<W>, p: &Precision) -> Block<W, 3> {
    let (b, moments) = moments;
    let squares = squares(b);
    let [a, b, c] = [0, 1, 2].map(|i| -> Wide<W, 60> { moments[i].widen() - squares[i].widen() });
    normalise([a.max(Fx::zero()), b, c.max(Fx::zero())], Fx::zero(), p.fraction_bits)
}

/// D with K = D Dᵀ, I4F28 in units of the map's scale. `K` from [`covariance`]; a negative determinant (rounding of
/// a rank-1 K) counts as zero.
#[inline(always)]
pub fn decompose<W: Word>(k: &Block<W, 3>, p: &Precision) -> [Fx<W, 28>; 3] {
    let keep = p.fraction_bits;
    let [a, b, c] = k.m;
    let element = |m: Mantissa<W>| Block::of(m.widen::<60>(), k.e, keep);
    let (root_a, _) = root_and_inverse(element(a), p);
    let (root_c, inverse_c) = root_and_inverse(element(c), p);
    let det: Wide<W, 60> = (a.mul::<30, 60>(c) - b.mul(b)).max(Fx::zero());
    let (root_det, _) = root_and_inverse(Block::of(det, k.e + k.e, keep), p);
    let over_root_c = |x: Block<W, 1>| Block::of(x.m[0].mul::<30, 60>(inverse_c.m[0]), x.e + inverse_c.e, keep);
    let flat = c.is_zero();
    let d1 = Block::select(flat, root_a, over_root_c(root_det));
    let d2 = Block::select(flat, Block::zero(), over_root_c(element(b)));
    [d1, d2, root_c].map(to_roughness)
}

/// A block of size ≤ 4 as I4F28, saturated to ±4 (noise of b/√c where c is one last bit).
#[inline(always)]
pub fn to_roughness<W: Word>(x: Block<W, 1>) -> Fx<W, 28> {
    let above = Fx::lit(2).lt(x.e);
    let at_four: Wide<W, 58> = x.m[0].widen::<60>().reread().floor_shr_by(places_below(x.e, Fx::lit(2), 62));
    let value: Fx<W, 28> = at_four.round_to(28);
    let limit = Fx::lit(4 << 28).negate_if(x.m[0].lt(Fx::zero()));
    Fx::select(above, limit, value)
}
