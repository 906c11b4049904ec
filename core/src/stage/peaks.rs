//! Peaks: w·a·max(0, N·H)ⁿ of one peak of a distribution of normals (F92 §2), and the sum over peaks.
//!
//! 1 − cos = |N − H|²/2 is formed from the difference, so nothing cancels near the peak. A stored vector of length 1 + e scales it by 1 + e (plus
//! e²/2) instead of adding e: at n = 8192 a length error of 2^−15 counts as 2^−15. Stored peaks have N in 3 × 16 bits, a and n in 16 bits each.
//! [`crate::ports::StoredPeak`] states their errors; [`unpack`] takes three words of a memory apart. Error as a share of w·a: √(n/e) times that of H
//! in direction, 2^−(p−6.9) at n = 8192, 2^−15 for the stored length, and that of [`cosine_power`].

use crate::block::{MANTISSA, Mantissa, PRODUCT, Product, dot};
use crate::bundle::never;
use crate::each::each;
use crate::elementary::{VERSINE, cosine_power, short_number};
use crate::fx::{Control, Fx, Int, WideControl};
use crate::ports::{LIGHT, Peak, SHARE};
use crate::precision::Precision;
use crate::signals::{LightSide, LocalDirection, PeakSum};
use crate::word::{Wire, Word};

/// Light of one peak, in [0, 64]. Range: any stored peak, weight in [0, 1].
///
/// A stored vector that is not of unit length counts with 1 − |N − H|²/2 for its cosine. Without a local direction the light is 0.
#[inline(always)]
pub fn peak<W: Word>(
    h: &LocalDirection<W>,
    peak: &Peak<W>,
    weight: Control<W, SHARE>,
    p: &Precision,
) -> Control<W, LIGHT> {
    let fraction_bits = p.fraction_bits;
    // 1.5² > 2: a clamped component has no cosine above 0, and three squares stay below 2^63.
    let limit: Mantissa<W> = Fx::number(3, -1);
    let difference = each!(i in [0, 1, 2] => {
        (Mantissa::of_control(peak.normal[i]) - h.unit[i]).saturate(-limit, limit).quantise(fraction_bits)
    });
    let square: Product<W> = dot(&difference, &difference);
    let power = cosine_power(square.reread::<VERSINE>(), short_number::<W>(peak.exponent), p);
    // Codes count in 2^−21: a = m·2^(e − 8).
    let amplitude = short_number::<W>(peak.amplitude).scaled(Fx::int(-8));
    let product: Mantissa<W> = power.m[0].mul::<MANTISSA, PRODUCT>(amplitude.m[0]).round_to(fraction_bits);
    let weighted: WideControl<W, { MANTISSA + SHARE }> = product.to_control::<MANTISSA>().mul(weight);
    // A power has an exponent of at most 1, and an amplitude of at most 6.
    let at_128: WideControl<W, { MANTISSA + SHARE + 7 }> = weighted.at_exponent(power.e + amplitude.e);
    let light = at_128.claim(0, 64, 0, "a_peak_gives_64_at_most").round_to(24);
    Fx::select(h.none, Fx::zero(), light)
}

/// Share of the fragment that a peak has, saturated to [0, 1].
#[inline(always)]
pub fn share<C: Word>(weight: Fx<C, SHARE>) -> Fx<C, SHARE> {
    weight.saturate(Fx::zero(), Fx::int(1))
}

/// Weight of a peak under a light: 0 if the light is below the surface.
#[inline(always)]
pub fn lit<W: Word>(side: &LightSide<W>, weight: Control<W, SHARE>) -> Control<W, SHARE> {
    Fx::select(side.below, Fx::zero(), weight)
}

/// Sum of no peaks.
#[inline(always)]
pub fn none<W: Word>() -> PeakSum<W> {
    PeakSum { light: Fx::zero(), saturated: never::<W>() }
}

/// Adds one more peak; the sum saturates at the largest number below 64. Range: light in [0, 64].
#[inline(always)]
pub fn add<W: Word>(sum: &PeakSum<W>, light: Control<W, LIGHT>) -> PeakSum<W> {
    let (exact, last) = (sum.light + light, Fx::below(64));
    PeakSum { light: exact.min(last), saturated: sum.saturated | last.lt(exact) }
}

/// Peak as a memory holds it, its five 16-bit numbers in three words: x and y of N, z and the amplitude, the exponent. The first of two is in the
/// lower half. Range: any bits.
#[inline(always)]
pub fn unpack<W: Word>([xy, z_amplitude, exponent]: [Int<W>; 3]) -> Peak<W> {
    let normal = each!(component in [signed(xy), xy.floor_shr(16), signed(z_amplitude)] => component.reread());
    Peak { normal, amplitude: code(z_amplitude.floor_shr(16)), exponent: code(exponent) }
}

/// Lower half of a word, not negative.
#[inline(always)]
fn code<C: Word<Count = C>>(word: Fx<C, 32>) -> Fx<C, 32> {
    Fx::from_raw(word.raw().and(Wire::lit(0xffff)))
}

/// Lower half of a word with its sign. The sign bit is flipped and subtracted: a shift up and down again would leave the word on its way.
#[inline(always)]
fn signed<C: Word<Count = C>>(word: Fx<C, 32>) -> Fx<C, 32> {
    Fx::from_raw(code(word).raw().xor(Wire::lit(0x8000))) - Fx::int(0x8000)
}
