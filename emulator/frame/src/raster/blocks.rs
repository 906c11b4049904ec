//! Conversion from float64 to the block ports of the datapath, for one fragment or for sixteen lanes.
//!
//! Only comparisons and correctly rounded +, − and × are used: the same bits on every machine, in vectors or not. Scaling is by
//! powers of two and exact. The only rounding is the one to the narrower word, to nearest, ties to even.

use fixed::types::I2F30;
use roughxel_core::ports::{BlockPort, BlockVector, Port};
use roughxel_shader::{BlockRows, Derivatives, Row};
use roughxel_simd::LANES;

/// Positions of [`LANES`] samples in sub-pixels of 1/256 px from the frame's corner: columns, then rows.
pub type Positions = [Row; 2];

/// Fraction bits of a mantissa.
const MANTISSA_BITS: i32 = 30;

/// 1½·2^52: a sum with it is rounded to an integer, which is in its lower bits in two's complement.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// Numbers below 2^this become zero.
const LEAST: i32 = -900;

/// Numbers of unit 2^exponent as a block: mantissas, the largest in [½, 1), and their exponent; all zero below 2^[`LEAST`].
///
/// Range: below 2^900.
#[inline(always)]
pub(super) fn block<const N: usize>(values: [f64; N], exponent: i32) -> ([i32; N], i32) {
    let mut largest = 0.0_f64;
    for value in values {
        largest = largest.max(value.abs());
    }
    let octave = exponent_of(largest);
    let is_zero = octave < LEAST;
    let scale = power_of_two(MANTISSA_BITS - 1 - octave.max(LEAST));
    // If the largest rounds up to 1.0, all are rounded one place higher.
    let carries = largest * scale + ROUNDER >= power_of_two(MANTISSA_BITS) + ROUNDER;
    let scale = if carries { 0.5 * scale } else { scale };
    let mut mantissas = [0; N];
    for (mantissa, value) in mantissas.iter_mut().zip(values) {
        *mantissa = if is_zero { 0 } else { rounded(value * scale) };
    }
    let exponent = (octave + 1 + i32::from(carries) + exponent).clamp(i16::MIN.into(), i16::MAX.into());
    (mantissas, if is_zero { 0 } else { exponent })
}

/// Rounds to nearest, ties to even. Range: below 2^31 in magnitude.
#[inline(always)]
fn rounded(value: f64) -> i32 {
    (value + ROUNDER).to_bits() as i32
}

/// A number modulo 1 with 32 fraction bits, to nearest, ties to even.
#[inline(always)]
pub(super) fn turns(value: f64) -> u32 {
    let share = value - value.floor();
    (share * power_of_two(32) + ROUNDER).to_bits() as u32
}

/// Blocks of [`LANES`] fragments.
#[inline(always)]
pub(super) fn block_rows<const N: usize>(exponent: i32, values: impl Fn(usize) -> [f64; N]) -> BlockRows<N> {
    let mut rows = BlockRows::default();
    for lane in 0..LANES {
        let (mantissas, exponent) = block(values(lane), exponent);
        for (row, mantissa) in rows.mantissa.iter_mut().zip(mantissas) {
            row[lane] = mantissa;
        }
        rows.exponent[lane] = exponent;
    }
    rows
}

/// ∂v and ∂n as wires.
pub(super) fn derivatives(dview: [BlockVector; 2], dnormal: [BlockVector; 2]) -> Derivatives<i32> {
    Derivatives { dview: dview.wires(), dnormal: dnormal.wires() }
}

/// The numbers as a port.
pub(super) fn port<const N: usize>((mantissas, exponent): ([i32; N], i32)) -> BlockPort<N> {
    BlockPort { mantissa: mantissas.map(I2F30::from_bits), exponent: exponent as i16 }
}

/// Numbers scaled by a power of two until the largest is in [1, 2), and the exponent that restores them. A number that is not
/// finite becomes 0. All become 0 if they are zero or below 2^[`LEAST`].
pub(super) fn scaled<const N: usize>(values: [f64; N]) -> ([f64; N], i32) {
    let values = values.map(|v| if v.is_finite() { v } else { 0.0 });
    let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let exponent = exponent_of(largest);
    if exponent < LEAST {
        return ([0.0; N], 0);
    }
    (values.map(|v| scale_by_power_of_two(v, -exponent)), exponent)
}

/// ⌊log₂ |x|⌋ of a finite, non-zero x; below the normal numbers −1023.
#[inline(always)]
fn exponent_of(x: f64) -> i32 {
    ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023
}

/// 2^exponent, for −1022 ≤ exponent ≤ 1023.
#[inline(always)]
const fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// `x · 2^exponent`, exact unless the result leaves the normal numbers; |exponent| ≤ 2044.
pub(super) fn scale_by_power_of_two(x: f64, exponent: i32) -> f64 {
    let half = exponent / 2;
    x * power_of_two(half) * power_of_two(exponent - half)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_is_normalised_and_rounded_once() {
        // (2^30 − ½)·2^k rounds up to 1.0 and must come out as ½ of the next exponent.
        assert_eq!(block([2_147_483_647.0, -3.0, 0.0], 0), ([1 << 29, -1, 0], 32));
        assert_eq!(block([-5.0, 3.0, 0.0], 7), ([-5 << 27, 3 << 27, 0], 10));
        // Ties go to even on both sides of zero.
        assert_eq!(block([2_147_483_650.0, -2.0, 6.0], -40), ([1 << 29, 0, 2], -8));
    }

    #[test]
    fn a_zero_vector_has_exponent_zero() {
        assert_eq!(block([0.0; 3], 77), ([0; 3], 0));
        assert_eq!(block([1e-300, 0.0], 77), ([0; 2], 0));
        assert_eq!(scaled([0.0, f64::NAN, f64::INFINITY]), ([0.0; 3], 0));
    }

    #[test]
    fn every_octave_gives_its_exponent() {
        for octave in LEAST..900 {
            let (mantissas, exponent) = block([power_of_two(octave), -0.75 * power_of_two(octave)], 0);
            assert_eq!((mantissas, exponent), ([1 << 29, -3 << 27], octave + 1));
        }
    }

    #[test]
    fn turns_are_those_of_the_fraction() {
        for (value, expected) in [(0.25, 1 << 30), (-0.25, 3 << 30), (-1e-30, 0), (4096.5, 1 << 31), (1e300, 0)] {
            assert_eq!(turns(value), expected, "{value}");
        }
    }
}
