//! Horizon: the share of a peak's facets that light and eye both clear (F92 §5, erratum 22).
//!
//! For the axis x of a local direction (x, y, z): ramp = (slope − low)·inverse width, clamped to [0, 1], with slope = z/|x| and the stored horizon on
//! the side to which the direction points. A step is visible from its slope on; x = 0 is visible. Slopes are clamped to ±8, so a stored step at −8
//! hides nothing. Four ramps, of light and eye over both axes, become one share, as the plan says:
//!
//! * correlated: a ramp t clears 1 − (1 − t)², a law whose density falls linearly from its low end. Of the two smallest shares a ≤ b the result is
//!   a·(3 + b)/4 = a − a(1 − b)/4. It lies between a·b and a; a alone would mean that a facet in a hole is hidden in every direction.
//! * product: a ramp is the share, a uniform law, and all four are multiplied.
//!
//! If every share is 0 or 1, both give the same result. Error of a slope s: 2^−(p−3.2)·max(1, |s|); of a ramp, in addition: 2^−17.

use crate::block::{Block, MANTISSA, PRODUCT, Product, number};
use crate::each::each;
use crate::elementary::{half_reciprocal, short_number};
use crate::fx::{Control, Fx, Wide, WideControl};
use crate::ports::{Horizon, SHARE, SLOPE, STORED_SLOPE};
use crate::precision::Precision;
use crate::signals::{AxisSlope, Ramps};
use crate::word::Word;

/// z/|x| and z/|y| of a local direction of any length.
#[inline(always)]
pub fn slopes<W: Word>(local: &Block<W, 3>, p: &Precision) -> [AxisSlope<W>; 2] {
    let fraction_bits = p.fraction_bits;
    let [x, y, z] = local.m;
    let rise = number(z.widen::<PRODUCT>(), Fx::int(0), fraction_bits);
    let limit: Wide<W, { PRODUCT + 5 }> = Fx::int(8);
    each!(along in [x, y] => {
        let run = number(along.abs().widen::<PRODUCT>(), Fx::int(0), fraction_bits);
        let product: Product<W> = rise.m[0].mul(half_reciprocal(run.m[0], p));
        let e = rise.e - run.e + Fx::int(1);
        // Both factors are in [½, 1]: with an exponent above 5 the slope is beyond 8.
        let at_32: Wide<W, { PRODUCT + 5 }> = product.at_exponent(e);
        let steep = limit.negate_if(z.lt(Fx::zero()));
        let slope = Fx::select(Fx::int(5).lt(e), steep, at_32.saturate(-limit, limit));
        AxisSlope {
            slope: slope.round_to(slope_bits(p)),
            negative: along.lt(Fx::zero()),
            upright: along.is_zero(),
        }
    })
}

/// Fraction bits of a stored slope.
const STORED: u32 = 32 - STORED_SLOPE;

/// Kept fraction bits of a slope, two fewer than an offset has.
const fn slope_bits(p: &Precision) -> u32 {
    p.fraction_bits - 4
}

/// Ramps that a direction climbs over both axes.
#[inline(always)]
pub fn ramps<W: Word>(slopes: &[AxisSlope<W>; 2], horizon: &Horizon<W>, p: &Precision) -> Ramps<W> {
    let one: Control<W, SHARE> = Fx::int(1);
    let axes = each!(axis in [0, 1] => {
        let AxisSlope { slope, negative, upright } = slopes[axis];
        let low = Fx::select(negative, horizon.low[2 * axis], horizon.low[2 * axis + 1]);
        let code = Fx::select(negative, horizon.inverse_width[2 * axis], horizon.inverse_width[2 * axis + 1]);
        // In counts: on a narrow word a stored slope would lose places, and a ramp, up to 2^13 times as steep, would lose all of them.
        let above = slope.to_control::<SLOPE>() - Fx::<W::Count, SLOPE>::of_control(low);
        // Codes count in 2^−14: 1/width = m·2^(e − 1), e ≤ 14.
        let inverse = short_number::<W::Count>(code);
        let product: WideControl<W, { SLOPE + MANTISSA }> = above.quantise(slope_bits(p).max(STORED)).mul(inverse.m[0]);
        let ramp: WideControl<W, { SLOPE + MANTISSA + 13 }> = product.reread().floor_shr_by(Fx::int(14) - inverse.e);
        let ramp = ramp.saturate(Fx::zero(), Fx::int(1)).round_to::<SHARE>(16);
        let step = Fx::select(above.lt(Fx::zero()), Fx::zero(), one);
        Fx::select(upright, one, Fx::select(code.is_zero(), step, ramp))
    });
    Ramps { axes }
}

/// Share of facets that clear both directions, for falling laws that are correlated, in [0, 1].
#[inline(always)]
pub fn correlated<W: Word>(light: &Ramps<W>, eye: &Ramps<W>) -> Control<W, SHARE> {
    let one: Control<W, SHARE> = Fx::int(1);
    // The two smallest of four.
    let [lit, seen] = each!(ramps in [light, eye] => {
        let [x, y] = ramps.axes;
        [x.min(y), x.max(y)]
    });
    let next = lit[0].max(seen[0]).min(lit[1].min(seen[1]));
    // The part that the smaller share hides stays exact: only 18-bit factors meet.
    let [most, more]: [WideControl<W, { 2 * SHARE }>; 2] = each!(t in [lit[0].min(seen[0]), next] => {
        let hidden = one - t;
        hidden.mul::<SHARE, { 2 * SHARE }>(hidden)
    });
    let least = one - most.round_to(16);
    let taken: WideControl<W, { 2 * SHARE }> = least.mul::<SHARE, { 2 * SHARE }>(more.round_to(16)).floor_shr(2);
    (Fx::int(1) - most - taken).saturate(Fx::zero(), Fx::int(1)).round_to(16)
}

/// Share of facets that clear both directions, for uniform laws that are independent, in [0, 1].
#[inline(always)]
pub fn independent<W: Word>(light: &Ramps<W>, eye: &Ramps<W>) -> Control<W, SHARE> {
    let [lit, seen] = each!(ramps in [light, eye] => product::<W>(ramps.axes[0], ramps.axes[1]));
    product::<W>(lit, seen)
}

/// Product of two shares, rounded to nearest; a factor 1 changes nothing.
#[inline(always)]
pub fn product<W: Word>(a: Control<W, SHARE>, b: Control<W, SHARE>) -> Control<W, SHARE> {
    a.mul::<SHARE, { 2 * SHARE }>(b).round_to(16)
}
