//! Horizon: which share of a peak's facets a direction of light or view clears (F92 §5, erratum 22).
//!
//! For the axis x of a local direction (x, y, z): visibility = (slope − low)·inverse width, cut to [0, 1], with
//! slope = z/|x|, low = μ − √3σ and width = 2√3σ of the horizon on the side to which the direction points; the product
//! over both axes. σ = 0 is a step, visible from μ on; x = 0 is visible. Slopes are cut to ±8, so a stored step at −8
//! hides nothing. Error of a slope s: 2^−(p−3.2)·max(1, |s|); of a factor, beside that: 2^−17.

use crate::block::{Block, MANTISSA, PRODUCT, Product, number};
use crate::each::each;
use crate::elementary::{half_reciprocal, short_number};
use crate::fx::{Control, Fx, Wide, WideControl};
use crate::ports::{Horizon, SHARE, SLOPE, STORED_SLOPE};
use crate::precision::Precision;
use crate::signals::AxisSlope;
use crate::word::Word;

/// z/|x| and z/|y| of a local direction of any length.
#[inline(always)]
pub fn slopes<W: Word>(local: &Block<W, 3>, p: &Precision) -> [AxisSlope<W>; 2] {
    let keep = p.fraction_bits;
    let [x, y, z] = local.m;
    let rise = number(z.widen::<PRODUCT>(), Fx::int(0), keep);
    let limit: Wide<W, { PRODUCT + 5 }> = Fx::int(8);
    each!(along in [x, y] => {
        let run = number(along.abs().widen::<PRODUCT>(), Fx::int(0), keep);
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

/// The share of facets that a direction clears, in [0, 1].
#[inline(always)]
pub fn visibility<W: Word>(slopes: &[AxisSlope<W>; 2], horizon: &Horizon<W>, p: &Precision) -> Control<W, SHARE> {
    let one: Control<W, SHARE> = Fx::int(1);
    let [x, y] = each!(axis in [0, 1] => {
        let AxisSlope { slope, negative, upright } = slopes[axis];
        let low = Fx::select(negative, horizon.low[2 * axis], horizon.low[2 * axis + 1]);
        let code = Fx::select(negative, horizon.inverse_width[2 * axis], horizon.inverse_width[2 * axis + 1]);
        // In counts: on a narrow word a stored slope would lose places, and a ramp, up to 2^13 times as steep, all of them.
        let above = slope.to_control::<SLOPE>() - Fx::<W::Count, SLOPE>::of_control(low);
        // Codes count in 2^−14: 1/width = m·2^(e − 1), e ≤ 14.
        let inverse = short_number::<W::Count>(code);
        let product: WideControl<W, { SLOPE + MANTISSA }> = above.keep(slope_bits(p).max(STORED)).mul(inverse.m[0]);
        let ramp: WideControl<W, { SLOPE + MANTISSA + 13 }> = product.reread().floor_shr_by(Fx::int(14) - inverse.e);
        let ramp = ramp.saturate(Fx::zero(), Fx::int(1)).round_to::<SHARE>(16);
        let step = Fx::select(above.lt(Fx::zero()), Fx::zero(), one);
        Fx::select(upright, one, Fx::select(code.is_zero(), step, ramp))
    });
    product::<W>(x, y)
}

/// The product of two shares, rounded to nearest; 1 changes nothing.
#[inline(always)]
pub fn product<W: Word>(a: Control<W, SHARE>, b: Control<W, SHARE>) -> Control<W, SHARE> {
    a.mul::<SHARE, { 2 * SHARE }>(b).round_to(16)
}
