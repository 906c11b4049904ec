//! Per-object and per-fragment set-up in floating point, on the host or a soft core. The datapath never calls it.
//!
//! Real numbers become ports: a vector's largest component goes to [½, 1) and is rounded, ties towards +∞, to the
//! profile's `fraction_bits`, which is what the datapath would keep of it anyway.

use fixed::types::{I2F30, I4F28};
use glam::{DVec2, DVec3};

use crate::ports::{BlockNumber, BlockPair, BlockVector};
use crate::precision::Precision;

/// 2^exponent for any exponent a port can hold; 0 below and ∞ above the range of f64.
fn power_of_two(exponent: i32) -> f64 {
    match exponent {
        -1022..=1023 => f64::from_bits(((exponent + 1023) as u64) << 52),
        1024.. => f64::INFINITY,
        -1074..=-1023 => f64::from_bits(1 << (exponent + 1074)),
        _ => 0.0,
    }
}

/// `x · 2^exponent`, exact where the result is a normal number.
pub fn scale_by_power_of_two(x: f64, exponent: i32) -> f64 {
    let half = exponent / 2;
    x * power_of_two(half) * power_of_two(exponent - half)
}

/// The exponent e with 2^(e−1) ≤ |x| < 2^e, for finite x ≠ 0.
fn exponent_above(x: f64) -> i32 {
    let biased = (x.to_bits() >> 52 & 0x7ff) as i32;
    if biased > 0 { biased - 1022 } else { exponent_above(x * power_of_two(64)) - 64 }
}

/// Rounds `x` to `bits` fraction bits, ties towards +∞, in units of 2^−30.
fn mantissa(x: f64, bits: u32) -> I2F30 {
    let bits = bits.min(30);
    let scaled = libm_floor(x * power_of_two(bits as i32) + 0.5) as i64;
    I2F30::from_bits((scaled << (30 - bits)) as i32)
}

/// `⌊x⌋` for |x| < 2^52 without the standard library.
fn libm_floor(x: f64) -> f64 {
    let whole = x as i64 as f64;
    if whole > x { whole - 1.0 } else { whole }
}

fn block<const N: usize>(components: [f64; N], p: &Precision) -> ([I2F30; N], i16) {
    let largest = components.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return ([I2F30::ZERO; N], 0);
    }
    // A largest component that rounds up to 1 belongs to the next octave, where entry is exact again.
    let rounds_up = |exponent: i32| mantissa(scale_by_power_of_two(largest, -exponent), p.fraction_bits) >= I2F30::ONE;
    let exponent = exponent_above(largest);
    let exponent = exponent + i32::from(rounds_up(exponent));
    (components.map(|x| mantissa(scale_by_power_of_two(x, -exponent), p.fraction_bits)), exponent as i16)
}

/// A vector as a port. Not a number or infinite reads as the zero vector; callers refuse those earlier.
pub fn block_vector(v: DVec3, p: &Precision) -> BlockVector {
    let (mantissa, exponent) = block(v.to_array(), p);
    BlockVector { mantissa, exponent }
}

/// An offset or a roughness as a port: `offset_bits` fraction bits, saturated to ±8.
pub fn offset(x: f64, p: &Precision) -> I4F28 {
    let bits = p.offset_bits();
    let scaled = libm_floor(x.clamp(-8.0, 8.0) * power_of_two(bits as i32) + 0.5) as i64;
    I4F28::from_bits(
        (scaled << (28 - bits)).clamp(i64::from(i32::MIN), i64::from(i32::MAX >> (28 - bits) << (28 - bits))) as i32,
    )
}

/// The real numbers of a port, exponent undone.
pub fn real_vector(v: &BlockVector) -> DVec3 {
    DVec3::from_array(v.mantissa.map(|m| real(m, v.exponent)))
}

/// The real numbers of a pair.
pub fn real_pair(v: &BlockPair) -> DVec2 {
    DVec2::from_array(v.mantissa.map(|m| real(m, v.exponent)))
}

/// The real value of a number.
pub fn real_number(x: &BlockNumber) -> f64 {
    real(x.mantissa, x.exponent)
}

fn real(mantissa: I2F30, exponent: i16) -> f64 {
    scale_by_power_of_two(f64::from(mantissa.to_bits()), i32::from(exponent) - 30)
}

/// The real value of a number with 28 fraction bits.
pub fn real_offset(x: I4F28) -> f64 {
    f64::from(x.to_bits()) * power_of_two(-28)
}
