//! Per-object and per-fragment set-up in floating point, on the host or a soft core. The datapath never calls it.
//!
//! Real numbers become ports. A vector's largest component goes to [½, 1) and is rounded, ties towards +∞, to the profile's `fraction_bits`. The
//! datapath would keep no more bits of it.
//!
//! Functions that random vectors are made with choose values instead of branches, and are inlined: a loop over many numbers becomes vectors.

use fixed::types::{I1F15, I2F30, I4F12, I4F28, I8F24, I16F16};
use glam::{DVec2, DVec3};

use crate::each::each;
use crate::ports::{BlockNumber, BlockPair, BlockVector, Shininess, StoredHorizon, StoredPeak};
use crate::precision::Precision;

/// 2^exponent for exponents from −1022 to 1023.
#[inline(always)]
fn normal_power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// 2^exponent for any exponent a port can hold; 0 below and ∞ above the range of f64.
#[inline(always)]
fn power_of_two(exponent: i32) -> f64 {
    match exponent {
        -1022..=1023 => normal_power_of_two(exponent),
        1024.. => f64::INFINITY,
        -1074..=-1023 => f64::from_bits(1 << (exponent + 1074)),
        _ => 0.0,
    }
}

/// 2^exponent as two factors, each of which f64 holds even if it does not hold their product.
#[inline(always)]
fn factors(exponent: i32) -> [f64; 2] {
    let half = exponent / 2;
    [power_of_two(half), power_of_two(exponent - half)]
}

/// `x · 2^exponent`, exact if the result is a normal number.
#[inline(always)]
pub fn scale_by_power_of_two(x: f64, exponent: i32) -> f64 {
    let [first, second] = factors(exponent);
    x * first * second
}

/// The exponent e with 2^(e−1) ≤ |x| < 2^e, for finite x ≠ 0.
#[inline(always)]
fn exponent_above(x: f64) -> i32 {
    let normal = biased_exponent(x);
    if normal > 0 { normal - 1022 } else { biased_exponent(x * normal_power_of_two(64)) - (1022 + 64) }
}

/// Exponent as f64 stores it: 0 below 2^−1022.
#[inline(always)]
fn biased_exponent(x: f64) -> i32 {
    (x.to_bits() >> 52 & 0x7ff) as i32
}

/// Rounds `x` to `bits` fraction bits, ties towards +∞, in units of 2^−30. |x| ≤ 1.
#[inline(always)]
fn mantissa(x: f64, bits: u32) -> I2F30 {
    let bits = bits.min(30);
    I2F30::from_bits(floor(x * normal_power_of_two(bits as i32) + 0.5) << (30 - bits))
}

/// `⌊x⌋` for |x| ≤ 2^31 − 1, without the standard library; 0 for a value that is not a number.
#[inline(always)]
fn floor(x: f64) -> i32 {
    // If the last place is 1, a sum is rounded to an integer and ends in its bits.
    const ONES: f64 = 1.5 * (1_u64 << 52) as f64;
    let x = if x.is_nan() { 0.0 } else { x };
    let nearest = x + ONES;
    nearest.to_bits() as i32 - i32::from(nearest - ONES > x)
}

#[inline(always)]
fn block<const N: usize>(components: [f64; N], p: &Precision) -> ([I2F30; N], i16) {
    let largest = components.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let is_zero = largest == 0.0 || !largest.is_finite();
    let largest = if is_zero { 0.5 } else { largest };
    let exponent = exponent_above(largest);
    let half = -exponent / 2;
    let [first, second] = each!(exponent in [half, -exponent - half] => normal_power_of_two(exponent));
    let bits = p.fraction_bits;
    // A largest component that rounds up to 1 belongs to the next octave, where entry is exact again.
    let rounds_up = mantissa(largest * first * second, bits) >= I2F30::ONE;
    let second = if rounds_up { second * 0.5 } else { second };
    let exponent = exponent + i32::from(rounds_up);
    let mantissas = each!(x in components => if is_zero { I2F30::ZERO } else { mantissa(x * first * second, bits) });
    (mantissas, if is_zero { 0 } else { exponent as i16 })
}

/// Vector as a port. A component that is infinite or not a number reads as the zero vector; callers refuse those earlier.
#[inline(always)]
pub fn block_vector(v: DVec3, p: &Precision) -> BlockVector {
    let (mantissa, exponent) = block(v.to_array(), p);
    BlockVector { mantissa, exponent }
}

/// Offset or roughness as a port: `offset_bits` fraction bits, saturated to ±8.
#[inline(always)]
pub fn offset(x: f64, p: &Precision) -> I4F28 {
    let bits = p.offset_bits();
    let scaled = x.clamp(-8.0, 8.0) * normal_power_of_two(bits as i32) + 0.5;
    I4F28::from_bits(floor(scaled.clamp(i32::MIN.into(), f64::from(i32::MAX >> (28 - bits)))) << (28 - bits))
}

/// Exponent m of a highlight as a port: m and √m, rounded to their last bits. Values below 1 and not a number read as 1, above 8192 as 8192.
#[inline(always)]
pub fn shininess(m: f64) -> Shininess {
    let m = if m >= 1.0 { m.min(8192.0) } else { 1.0 };
    let exponent = floor(m * normal_power_of_two(16) + 0.5);
    // √(m·2^16·2^32) = √m·2^24.
    let root = nearest_root((exponent as u64) << 32);
    Shininess { exponent: I16F16::from_bits(exponent), root: I8F24::from_bits(root as i32) }
}

/// √x to the nearest integer, for x from 1 to below 2^62.
#[inline(always)]
fn nearest_root(x: u64) -> u64 {
    // 1/√x by its exponent, then by Newton's rule. Integers make exact a root that is one too small or too large.
    let real = x as f64;
    let mut inverse = f64::from_bits(0x5fe6_eb50_c7b5_37a9 - (real.to_bits() >> 1));
    for _ in 0..4 {
        inverse *= 1.5 - 0.5 * real * inverse * inverse;
    }
    let root = floor(real * inverse) as u64;
    let root = root - u64::from(root * root > x);
    root + u64::from(x - root * root > root)
}

/// Real numbers of a port, exponent applied.
pub fn real_vector(v: &BlockVector) -> DVec3 {
    DVec3::from_array(v.mantissa.map(|m| real(m, v.exponent)))
}

/// Real numbers of a pair.
pub fn real_pair(v: &BlockPair) -> DVec2 {
    DVec2::from_array(v.mantissa.map(|m| real(m, v.exponent)))
}

/// Real value of a number.
pub fn real_number(x: &BlockNumber) -> f64 {
    real(x.mantissa[0], x.exponent)
}

fn real(mantissa: I2F30, exponent: i16) -> f64 {
    scale_by_power_of_two(f64::from(mantissa.to_bits()), i32::from(exponent) - 30)
}

/// Real value of a number with 28 fraction bits.
pub fn real_offset(x: I4F28) -> f64 {
    f64::from(x.to_bits()) * power_of_two(-28)
}

/// 16-bit code nearest to `x` ≥ 0 in units of 2^`unit`. It saturates, and reads a value that is not a number as 0.
#[inline(always)]
fn code(x: f64, unit: i32) -> u16 {
    let units = scale_by_power_of_two(x, -unit);
    let units = if units >= 0.5 { units.min(normal_power_of_two(30)) } else { 0.0 };
    // (4096 + f)·2^(c − 1) with 4096 + f in [4096, 8192]: a carry out of f is one into c.
    let c = exponent_above(units).max(12) - 12;
    let significand = floor(units * normal_power_of_two(-(c - 1).max(0)) + 0.5);
    let below = if c == 0 { 0 } else { (c << 12) - 4096 };
    (below + significand).min(u16::MAX.into()) as u16
}

/// Number of a code in units of 2^`unit`.
fn real_code(code: u16, unit: i32) -> f64 {
    let (c, f) = (i32::from(code >> 12), f64::from(code & 0xfff));
    scale_by_power_of_two(if c == 0 { f } else { f + 4096.0 }, unit + (c - 1).max(0))
}

/// Units of the codes of an amplitude, an exponent and an inverse width, as powers of two.
const UNITS: [i32; 3] = [-21, -13, -14];

/// Rounds `x` to `bits` fraction bits of a 16-bit word, saturated.
#[inline(always)]
fn word_of_16(x: f64, bits: i32) -> i16 {
    floor((x * normal_power_of_two(bits) + 0.5).clamp(i16::MIN.into(), i16::MAX.into())) as i16
}

/// Least amplitude that a stored peak does not hold.
pub const AMPLITUDE_LIMIT: f64 = 64.0;

/// Peak as a port: N brought to unit length, the amplitude saturated below [`AMPLITUDE_LIMIT`], the exponent to 1…8192.
///
/// A vector without a direction (zero, infinite, not a number) and a negative amplitude give a peak without light; callers refuse those earlier.
pub fn stored_peak(normal: DVec3, amplitude: f64, exponent: f64) -> StoredPeak {
    // After scaling by the largest component, no square overflows or vanishes.
    stored_unit_peak((normal / normal.abs().max_element()).normalize_or_zero(), amplitude, exponent)
}

/// Peak as a port, from N that has unit length or is zero.
#[inline(always)]
pub fn stored_unit_peak(unit: DVec3, amplitude: f64, exponent: f64) -> StoredPeak {
    let amplitude = if unit == DVec3::ZERO { 0.0 } else { amplitude };
    StoredPeak {
        normal: each!(x in unit.to_array() => I1F15::from_bits(word_of_16(x, 15))),
        amplitude: code(amplitude, UNITS[0]),
        exponent: code(exponent.clamp(1.0, 8192.0), UNITS[1]),
    }
}

/// Horizon as a port, from the least slope and the width of its law, towards −x, +x, −y, +y. A width ≤ 0 is a step.
///
/// If the plan takes the product of shares, the law is uniform ([`uniform_law`]); else it falls, with the density 2(1 − t)/width.
#[inline(always)]
pub fn stored_horizon(low: [f64; 4], width: [f64; 4]) -> StoredHorizon {
    let mut stored = StoredHorizon::OPEN;
    for side in 0..4 {
        stored.low[side] = I4F12::from_bits(word_of_16(low[side], 12));
        let inverse = code(1.0 / width[side], UNITS[2]).max(1);
        stored.inverse_width[side] = if width[side] > 0.0 { inverse } else { 0 };
    }
    stored
}

/// Least slope and width of the uniform law with a mean and a standard deviation: ±√3σ (erratum 22).
#[inline(always)]
pub fn uniform_law(mean: f64, sigma: f64) -> [f64; 2] {
    const SQRT_3: f64 = 1.732_050_807_568_877_2;
    [mean - SQRT_3 * sigma, 2.0 * SQRT_3 * sigma]
}

/// Numbers of a stored peak.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RealPeak {
    /// N in the tangent basis.
    pub normal: DVec3,
    /// a, at its maximum.
    pub amplitude: f64,
    /// n of the power of the cosine.
    pub exponent: f64,
}

/// Decodes a stored peak.
pub fn real_peak(stored: &StoredPeak) -> RealPeak {
    RealPeak {
        normal: DVec3::from_array(stored.normal.map(|x| f64::from(x.to_bits()) * power_of_two(-15))),
        amplitude: real_code(stored.amplitude, UNITS[0]),
        exponent: real_code(stored.exponent, UNITS[1]),
    }
}

/// Least slope of each ramp of a stored horizon, and its inverse width; `None` for a step.
pub fn real_horizon(stored: &StoredHorizon) -> ([f64; 4], [Option<f64>; 4]) {
    let low = stored.low.map(|low| f64::from(low.to_bits()) * power_of_two(-12));
    (low, stored.inverse_width.map(|code| (code > 0).then(|| real_code(code, UNITS[2]))))
}
