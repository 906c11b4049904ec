//! Peaks: w·a·max(0, N·H)ⁿ of one peak of a distribution of normals (F92 §2), and the sum over peaks.
//!
//! 1 − cos = |N − H|²/2 is formed from the difference, so nothing cancels near the peak, and stored vectors of length
//! 1 + e scale it by 1 + e (plus e²/2) instead of adding e: at n = 8192 a length error of 2^−15 counts as 2^−15.
//! Stored peaks: N in 3 × 16 bits, a and n in 16 bits each; [`crate::ports::StoredPeak`] states their errors.
//! Error as a share of w·a: √(n/e) times that of H in direction, 2^−(p−6.9) at n = 8192, 2^−15 for the stored length, and
//! that of [`cosine_power`].

use crate::block::{MANTISSA, Mantissa, dot, places_below};
use crate::each::each;
use crate::elementary::{VERSINE, cosine_power, short_number};
use crate::fx::{Fx, Wide};
use crate::precision::Precision;
use crate::signals::{LIGHT, LightSide, LocalDirection, Peak, PeakSum, SHARE, STORED_NORMAL};
use crate::status::{Status, StatusBit};
use crate::word::Word;

/// The light of one peak, in [0, 64]. Range: any stored peak, weight in [0, 1].
///
/// A stored vector that is not of unit length counts with 1 − |N − H|²/2 for its cosine. No local direction: 0.
#[inline(always)]
pub fn peak<W: Word>(h: &LocalDirection<W>, peak: &Peak<W>, weight: Fx<W, SHARE>, p: &Precision) -> Fx<W, LIGHT> {
    let keep = p.fraction_bits;
    // 1.5² > 2: what is cut has no cosine above 0, and three squares stay below 2^63.
    let limit: Mantissa<W> = Fx::lit(3 << (MANTISSA - 1));
    let difference = each!(i in [0, 1, 2] => {
        let normal: Mantissa<W> = peak.normal[i].reread().shl(MANTISSA - STORED_NORMAL);
        (normal - h.unit[i]).saturate(-limit, limit).keep(keep)
    });
    let square: Wide<W, 60> = dot(&difference, &difference);
    let power = cosine_power(square.reread::<VERSINE>(), short_number(peak.exponent), p);
    // Codes count in 2^−21: a = m·2^(e − 8).
    let amplitude = short_number(peak.amplitude).scaled(Fx::lit(-8));
    let product: Mantissa<W> = power.m[0].mul::<MANTISSA, 60>(amplitude.m[0]).round_to(keep);
    let weighted: Wide<W, 46> = product.mul(weight);
    // A power has the exponent 1 at most, and an amplitude 6.
    let places = places_below(power.e + amplitude.e, Fx::lit(7), 62);
    let at_128: Wide<W, 39> = weighted.reread::<39>().floor_shr_by(places);
    let light = at_128.claim(0..=64 << 39, "a_peak_gives_64_at_most").round_to(LIGHT);
    Fx::select(h.none, Fx::zero(), light)
}

/// The share of the fragment that a peak has, saturated to [0, 1].
#[inline(always)]
pub fn share<W: Word>(weight: Fx<W, SHARE>) -> Fx<W, SHARE> {
    weight.saturate(Fx::zero(), Fx::lit(1 << SHARE))
}

/// What counts of a peak: nothing where the light is below the surface.
#[inline(always)]
pub fn lit<W: Word>(side: &LightSide<W>, weight: Fx<W, SHARE>) -> Fx<W, SHARE> {
    Fx::select(side.below, Fx::zero(), weight)
}

/// No peak yet.
#[inline(always)]
pub fn none<W: Word>() -> PeakSum<W> {
    PeakSum { light: Fx::zero(), saturated: !Fx::<W, 0>::zero().is_zero() }
}

/// One more peak; the sum saturates at the largest number below 64. Range: light in [0, 64].
#[inline(always)]
pub fn add<W: Word>(sum: &PeakSum<W>, light: Fx<W, LIGHT>) -> PeakSum<W> {
    let (exact, last) = (sum.light + light, Fx::lit((64 << LIGHT) - 1));
    PeakSum { light: exact.min(last), saturated: sum.saturated | last.lt(exact) }
}

/// Sticky bits of a sum.
#[inline(always)]
pub fn status<W: Word>(h: &LocalDirection<W>, sum: &PeakSum<W>) -> Status<W> {
    Status::clear().raise(StatusBit::LocalZero, h.none).raise(StatusBit::PeaksSaturated, sum.saturated)
}
