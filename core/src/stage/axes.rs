//! Axes: standard deviations λ₁ ≥ λ₂ and the unit direction of λ₁.
//!
//! λ₁² = ½(a + c + √((c − a)² + 4b²)) (W97 (16)); λ₂² = det/λ₁² (erratum 12). For r₁ = (cos α, −sin α) the direction belongs to λ₁ if c − a < 0
//! (erratum 2), tan 2α = 2b/(c − a), |α| ≤ 45° (W97 (18)–(20)). It is found exactly by (h + |a − c|, 2b), the branch that does not cancel, or by a
//! table of a few angles (erratum 18). Sign: the larger component is positive. At 45° downwards, where the two differ by roundings alone, the
//! positive one may be smaller by 7 last places at most. A circle has direction (1, 0). Error of λ₁ for a given K: 2^−(p−3), relative,
//! in the named profiles. Shorter seeds or fewer steps of the inverse root than these have add its own error.

use crate::block::{Block, MANTISSA, Mantissa, Number, PRODUCT, Product, normalise, number, places_below};
use crate::each::each;
use crate::elementary::{over_length, root_and_inverse};
use crate::fx::{Fx, Wide};
use crate::precision::{AxisDirection, Precision};
use crate::rom;
use crate::signals::{Axes, Ellipse};
use crate::word::{Wire, Word};

/// Bits before the point of numbers below 4 that come from a mantissa with an exponent of at most 2.
const WITHIN_FOUR: u32 = PRODUCT + 2;

/// Main axes of an ellipse. K = 0 gives λ₁ = λ₂ = 0 and direction (1, 0).
#[inline(always)]
pub fn axes<W: Word>(ellipse: &Ellipse<W>, p: &Precision) -> Axes<W> {
    let fraction_bits = p.fraction_bits;
    let [a, b, c] = ellipse.k.m;
    // (a − c, 2b) is the doubled-angle vector; h its length.
    let difference: Product<W> = a.widen() - c.widen();
    let double = normalise([difference, b.widen::<PRODUCT>().shl(1)], Fx::int(0), fraction_bits);
    let (h, _) = root_and_inverse(double.square_length(fraction_bits), p);

    // λ₁² with 6 bits before the point: (a + c)/2 ≤ 1, h/2 ≤ 1; h = m·2^e with e ≤ 2 (h ≤ a + c ≤ 2).
    let mean: Wide<W, WITHIN_FOUR> = (a.widen() + c.widen()).floor_shr(1);
    let half_h = h.at_point::<WITHIN_FOUR>().floor_shr(1);
    let lambda_square = number(mean + half_h, ellipse.k.e, fraction_bits);
    let (major, inverse) = root_and_inverse(lambda_square, p);
    let (root_det, _) = root_and_inverse(ellipse.det, p);
    let minor = root_det.times(&inverse, fraction_bits);
    let swapped = less(&major, &minor);
    Axes { major, minor: Block::select(swapped, major, minor), direction: direction(&double, &h, p) }
}

/// `a < b` of two numbers ≥ 0.
#[inline(always)]
fn less<W: Word>(a: &Number<W>, b: &Number<W>) -> W::Flag {
    let top = a.e.max(b.e);
    let most = <W::Wide as Wire>::BITS - 1;
    let [a, b]: [Product<W>; 2] = each!(x in [a, b] => x.m[0].widen().floor_shr_by(places_below(x.e, top, most)));
    a.lt(b)
}

#[inline(always)]
fn direction<W: Word>(double: &Block<W, 2>, h: &Number<W>, p: &Precision) -> [Mantissa<W>; 2] {
    let [x, y] = double.m;
    let (larger, smaller) = match p.direction {
        AxisDirection::Exact => half_angle(double, h, p),
        AxisDirection::Table { steps } => nearest_angle(x.abs(), y.abs(), steps, p),
    };
    // `larger` goes with the larger of a, c; the sign of b puts the smaller one on its side.
    let smaller = smaller.negate_if(y.lt(Fx::zero()));
    let a_larger = x.ge(Fx::zero());
    let circle = double.is_zero();
    let one = Fx::int(1);
    [
        Fx::select(circle, one, Fx::select(a_larger, larger, smaller)),
        Fx::select(circle, Fx::zero(), Fx::select(a_larger, smaller, larger)),
    ]
}

/// (cos |α|, sin |α|) ∝ (h + |a − c|, |2b|).
#[inline(always)]
fn half_angle<W: Word>(double: &Block<W, 2>, h: &Number<W>, p: &Precision) -> (Mantissa<W>, Mantissa<W>) {
    let [x, y] = each!(m in double.m => m.abs());
    // h over the scale of `double` is in [½, √2], so h + |x| < 4.
    let h: Wide<W, WITHIN_FOUR> = h.scaled(-double.e).at_point();
    let w = normalise([h + x.widen(), y.widen()], Fx::int(0), p.fraction_bits);
    let [cos, sin] = each!(unit in over_length(&w, p) => unit.min(Fx::int(1)));
    (cos, sin)
}

/// (cos, sin) of the entry nearest to |α|, 0 ≤ |α| ≤ 45°, from tan 2|α| = y/x. The number of steps is the number of boundaries below it.
#[inline(always)]
fn nearest_angle<W: Word>(x: Mantissa<W>, y: Mantissa<W>, steps: u32, p: &Precision) -> (Mantissa<W>, Mantissa<W>) {
    let [mut cos, mut sin] = angle(0, steps, p);
    for step in 1..=steps >> 1 {
        // The boundary between entries step − 1 and step is at 2α = (2·step − 1)·90°/steps.
        let [boundary_cos, boundary_sin] = angle(2 * step - 1, steps, p);
        let past = boundary_sin.mul::<MANTISSA, PRODUCT>(x).lt(boundary_cos.mul(y));
        let [next_cos, next_sin] = angle(step, steps, p);
        cos = Fx::select(past, next_cos, cos);
        sin = Fx::select(past, next_sin, sin);
    }
    (cos, sin)
}

/// (cos, sin) of the share `numerator/denominator` of a right angle.
#[inline(always)]
fn angle<W: Word>(numerator: u32, denominator: u32, p: &Precision) -> [Mantissa<W>; 2] {
    let (sin, cos) = rom::sin_cos_of_right_angle(numerator, denominator);
    each!(value in [cos, sin] => Fx::entry(value).quantise(p.fraction_bits))
}
