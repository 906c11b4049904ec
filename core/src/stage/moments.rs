//! Moments: mean offset of a bumpy surface over a footprint, and the covariance around it.
//!
//! Within a probe b and K = D Dᵀ are interpolated, never D (erratum 15). Over the probes b and the second moments K + b bᵀ are averaged. This keeps
//! the variance of the *means* between probes, as S97's recursion keeps it between levels (erratum 14).
//!
//! Between the texels of one bilinear patch the surface is a ramp. Half of the ramp's variance within the probe is added to K, for a probe no wider
//! than a texel (of standard deviation ½ texel, or the pixel's if the map is magnified). To count the corners of a patch as a distribution would blur
//! a magnified map (measured on resolved bumps: 3.7 dB).
//!
//! The result becomes D again, K = D Dᵀ: d₃ = √c, d₂ = b/√c, d₁ = √(a − b²/c); c = 0 gives d₂ = 0, d₁ = √a (erratum 13). Numbers are in units of the
//! map's scale: |b|, |d| ≤ 1. A square is rounded alike on both ways, so equal probes give back their K to the bit, and K = 0 if offsets do not
//! differ. Error: K 2^−28 absolute, D the root of it.

use crate::block::{Block, MANTISSA, Mantissa, Number, PRODUCT, Product, normalise, number};
use crate::each::each;
use crate::elementary::root_and_inverse;
use crate::fx::{Control, Fx, Wide};
use crate::ports::{OFFSET, SHARE};
use crate::precision::Precision;
use crate::word::Word;

/// Bits before the point of a second moment; |·| ≤ 3.
pub const MOMENT: u32 = 3;

/// b₁, b₂ and three elements of a symmetric matrix (11, 12, 22): five channels.
pub type Moments<W> = ([Mantissa<W>; 2], [Fx<W, MOMENT>; 3]);

/// Stored 16-bit code as a number in units of the map's scale, |·| ≤ 1, floored to its last place: an offset is code/2^15 · 2^−`down`.
#[inline(always)]
pub fn decode_offset<C: Word<Count = C>>(code: Fx<C, 32>, down: Fx<C, 32>) -> Mantissa<C> {
    Fx::from_raw(code.raw().shl(15).sar_by(down.raw()))
}

/// Stored 16-bit code of a roughness, which is unsigned, in the same units: code/2^16 · 2^−`down`.
#[inline(always)]
pub fn decode_roughness<C: Word<Count = C>>(code: Fx<C, 32>, down: Fx<C, 32>) -> Mantissa<C> {
    Fx::from_raw(code.raw().shl(14).sar_by(down.raw()))
}

/// K = D Dᵀ of one texel: the channels that are interpolated together with b.
#[inline(always)]
pub fn of_texel<W: Word>(d: &[Mantissa<W>; 3]) -> [Fx<W, MOMENT>; 3] {
    let [d1, d2, d3] = *d;
    let [d11, d22, d23, d33] =
        each!((a, b) in [(d1, d1), (d2, d2), (d2, d3), (d3, d3)] => a.mul::<MANTISSA, PRODUCT>(b));
    each!(element in [d11 + d22, d23, d33] => element.round_to(Fx::<W, MOMENT>::FRACTION))
}

/// K of one texel that stores the isotropic I₁.
#[inline(always)]
pub fn of_isotropic_texel<W: Word>(i1: Mantissa<W>) -> [Fx<W, MOMENT>; 3] {
    of_texel(&[i1, Fx::zero(), i1])
}

/// Half the variance of the ramp of b within a probe, |·| ≤ 1: ⅛·(d_u d_uᵀ + d_v d_vᵀ). d are the mean differences of the texels (0,0), (1,0), (0,1),
/// (1,1) along each axis. [`ramp_weights`](super::filter::ramp_weights) weigh those of a finer and of a coarser level. Error: 2^−15 of the root of
/// the trace, from the weights, and 2^−28.
#[inline(always)]
pub fn ramp<W: Word>(offsets: &[[[Mantissa<W>; 2]; 4]; 2], weights: &[Fx<W, SHARE>; 2]) -> [Fx<W, MOMENT>; 3] {
    // A quarter of each texel, so that half a mean difference is at most 1.
    let quarters = each!(level in *offsets => each!(texel in level => each!(b in texel => b.floor_shr(2))));
    let slopes = each!((from, to) in [([0, 2], [1, 3]), ([0, 1], [2, 3])] => {
        each!(channel in [0, 1] => {
            let [fine, coarse]: [Wide<W, { MANTISSA + SHARE }>; 2] = each!(level in [0, 1] => {
                let [rise, other] = each!(i in [0, 1] => quarters[level][to[i]][channel] - quarters[level][from[i]][channel]);
                (rise + other).mul(weights[level])
            });
            let blend = (fine + coarse).claim(-1, 1, 0, "weights_of_a_ramp_sum_to_its_reach");
            blend.round_to::<MANTISSA>(Mantissa::<W>::FRACTION)
        })
    });
    let [u, v] = each!(slope in slopes => products(&slope));
    // Half of the sum: the point moves.
    each!(i in [0, 1, 2] => (u[i] + v[i]).reread::<{ PRODUCT - 1 }>().round_to(Fx::<W, MOMENT>::FRACTION))
}

/// K with the ramp of its probe, each element within ±2 like that of a texel.
#[inline(always)]
pub fn with_ramp<W: Word>(k: &[Fx<W, MOMENT>; 3], ramp: &[Fx<W, MOMENT>; 3]) -> [Fx<W, MOMENT>; 3] {
    each!(i in [0, 1, 2] => (k[i] + ramp[i]).saturate(Fx::int(-2), Fx::int(2)))
}

/// b bᵀ, its elements 11, 12, 22, exact.
#[inline(always)]
fn products<W: Word>(b: &[Mantissa<W>; 2]) -> [Product<W>; 3] {
    each!((x, y) in [(0, 0), (0, 1), (1, 1)] => b[x].mul(b[y]))
}

/// Second moments K + b bᵀ of one probe: the channels that are averaged over probes together with b. |·| ≤ 3.
#[inline(always)]
pub fn of_probe<W: Word>(b: &[Mantissa<W>; 2], k: &[Fx<W, MOMENT>; 3]) -> [Fx<W, MOMENT>; 3] {
    let squares = squares(b);
    each!(i in [0, 1, 2] => k[i] + squares[i])
}

/// b bᵀ as second moments.
#[inline(always)]
fn squares<W: Word>(b: &[Mantissa<W>; 2]) -> [Fx<W, MOMENT>; 3] {
    each!(product in products(b) => product.round_to(Fx::<W, MOMENT>::FRACTION))
}

/// Covariance around the mean: a, b, c of K as a block, a and c not negative.
#[inline(always)]
pub fn covariance<W: Word>(moments: &Moments<W>, p: &Precision) -> Block<W, 3> {
    let (b, moments) = moments;
    let squares = squares(b);
    let [a, b, c] = each!(i in [0, 1, 2] => moments[i].widen::<PRODUCT>() - squares[i].widen());
    normalise([a.max(Fx::zero()), b, c.max(Fx::zero())], Fx::int(0), p.fraction_bits)
}

/// D with K = D Dᵀ in units of the map's scale. `K` from [`covariance`]; a negative determinant (rounding of
/// a rank-1 K) counts as zero.
#[inline(always)]
pub fn decompose<W: Word>(k: &Block<W, 3>, p: &Precision) -> [Control<W, OFFSET>; 3] {
    let fraction_bits = p.fraction_bits;
    let [a, b, c] = k.m;
    let elements = each!(m in k.m => number(m.widen::<PRODUCT>(), k.e, fraction_bits));
    let (root_a, _) = root_and_inverse(elements[0], p);
    let (root_c, inverse_c) = root_and_inverse(elements[2], p);
    let det: Product<W> = (a.mul::<MANTISSA, PRODUCT>(c) - b.mul(b)).max(Fx::zero());
    let (root_det, _) = root_and_inverse(number(det, k.e + k.e, fraction_bits), p);
    let [det_over, b_over] = each!(x in [root_det, elements[1]] => x.times(&inverse_c, fraction_bits));
    let flat = c.is_zero();
    let d1 = Block::select(flat, root_a, det_over);
    let d2 = Block::select(flat, Block::zero(), b_over);
    each!(d in [d1, d2, root_c] => to_roughness(d))
}

/// Number of size ≤ 4 as a roughness, saturated to ±4 (noise of b/√c if c is one last bit).
#[inline(always)]
pub fn to_roughness<W: Word>(x: Number<W>) -> Control<W, OFFSET> {
    let above = Fx::int(2).lt(x.e);
    let at_four: Wide<W, { PRODUCT + 2 }> = x.at_point();
    let value: Control<W, OFFSET> = at_four.round_to_control(28);
    let limit = Fx::int(4).negate_if(x.m[0].lt(Fx::zero()));
    Fx::select(above, limit, value)
}
