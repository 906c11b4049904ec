//! From float64 setup to integers, and from wide integers to the block ports of the datapath.
//!
//! Scaling is by powers of two and exact; the one rounding is the one to the narrower word.

use fixed::types::I2F30;
use roughxel_core::ports::{BlockPair, BlockPort, BlockVector};

/// Bits that [`LinearForm::at`] drops from the wide sum.
const GUARD_BITS: u32 = 24;
/// Bits of a form's value: |value| < 2^60 over the extent it was scaled for.
pub(super) const FORM_BITS: i32 = 60;

/// `constant + per_x·x + per_y·y` over sub-pixel positions, the plane equation of one quantity.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LinearForm {
    constant: i128,
    per_x: i128,
    per_y: i128,
}

impl LinearForm {
    /// Value at (x, y), |value| < 2^60 within the extent given to [`scaled_forms`].
    pub(super) fn at(&self, x: i32, y: i32) -> i64 {
        // Below 2^84 within the extent; coefficients are below 2^84 each, so no i32 position can wrap the sum.
        let sum = self.constant + self.per_x * i128::from(x) + self.per_y * i128::from(y);
        (sum >> GUARD_BITS) as i64
    }
}

/// Derivatives of three forms along x and y, per pixel: `slope[axis][form] · 2^exponent` in units where a form
/// of 2^60 is 1. |slope| < 2^58.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FormSlopes {
    pub(super) slope: [[i64; 3]; 2],
    pub(super) exponent: i32,
}

/// Brings three plane equations `[constant, per sub-pixel x, per sub-pixel y]` to one power of two, so that
/// |value| < 2^60 wherever |x| and |y| stay within `extent` sub-pixels.
///
/// Returns the forms and the exponent that gives their values back; `None` when all are zero or one is not finite.
pub(super) fn scaled_forms(planes: [[f64; 3]; 3], extent: [f64; 2]) -> Option<([LinearForm; 3], i32)> {
    let bound = planes
        .iter()
        .map(|p| p[0].abs() + p[1].abs() * extent[0].max(1.0) + p[2].abs() * extent[1].max(1.0))
        .fold(0.0, f64::max);
    let summed: f64 = planes.iter().flatten().sum();
    if !(summed.is_finite() && bound.is_finite() && bound > 0.0) {
        return None;
    }
    // bound < 2^(exponent + 1), hence every sum is below 2^(60 + GUARD_BITS) after scaling.
    let scale = FORM_BITS + GUARD_BITS as i32 - 1 - exponent_of(bound);
    let code = |value: f64| scale_by_power_of_two(value, scale) as i128;
    let forms = planes.map(|p| LinearForm { constant: code(p[0]), per_x: code(p[1]), per_y: code(p[2]) });
    Some((forms, GUARD_BITS as i32 - scale))
}

/// Derivatives per pixel of three forms of one scale.
pub(super) fn slopes_per_pixel(forms: &[LinearForm; 3]) -> FormSlopes {
    const SLOPE_BITS: u32 = 58;
    let wide = [forms.map(|f| f.per_x), forms.map(|f| f.per_y)];
    let shift = magnitude_bits(wide.as_flattened()).saturating_sub(SLOPE_BITS);
    FormSlopes {
        // The shift rounds by at most half a step of 2^-57, so a carry to 2^58 still fits.
        slope: wide.map(|axis| axis.map(|value| round_shift(value, shift) as i64)),
        exponent: shift as i32 + super::SUBPIXEL_BITS as i32 - FORM_BITS - GUARD_BITS as i32,
    }
}

/// Real numbers as integers of at most 52 bits and one shared exponent: `value ≈ code · 2^exponent`.
///
/// Values that are not finite become 0, and so do all values when they are zero or below 2^-900.
pub(super) fn encode<const N: usize>(values: [f64; N]) -> ([i64; N], i32) {
    const CODE_BITS: i32 = 52;
    let values = values.map(|v| if v.is_finite() { v } else { 0.0 });
    let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    if largest < power_of_two(-900) {
        return ([0; N], 0);
    }
    let exponent = exponent_of(largest) + 1 - CODE_BITS;
    let codes = values.map(|v| (scale_by_power_of_two(v, -exponent) + 0.5).floor() as i64);
    (codes, exponent)
}

/// Three wide integers of unit 2^exponent as a block: largest |mantissa| in [½, 1), rounded once, ties toward +∞.
pub(super) fn block_vector(values: [i128; 3], exponent: i32) -> BlockVector {
    let (mantissa, exponent) = block(values, exponent);
    BlockPort { mantissa, exponent }
}

/// Two wide integers of unit 2^exponent as a block: largest |mantissa| in [½, 1), rounded once, ties toward +∞.
pub(super) fn block_pair(values: [i128; 2], exponent: i32) -> BlockPair {
    let (mantissa, exponent) = block(values, exponent);
    BlockPort { mantissa, exponent }
}

/// A vector of real numbers as a block; see [`block_vector`].
pub(super) fn block_from_reals(values: [f64; 3]) -> BlockVector {
    let (codes, exponent) = encode(values);
    block_vector(codes.map(i128::from), exponent)
}

fn block<const N: usize>(values: [i128; N], exponent: i32) -> ([I2F30; N], i16) {
    const MANTISSA_BITS: i32 = 30;
    let bits = magnitude_bits(&values) as i32;
    if bits == 0 {
        return ([I2F30::ZERO; N], 0);
    }
    let rounded =
        |shift: i32| values.map(|v| if shift > 0 { round_shift(v, shift as u32) as i32 } else { (v << -shift) as i32 });
    let mut shift = bits - MANTISSA_BITS;
    let mut mantissa = rounded(shift);
    if mantissa.iter().any(|m| m.unsigned_abs() >> MANTISSA_BITS != 0) {
        // Rounded up to 1.0: round the wide values again, one place higher.
        shift += 1;
        mantissa = rounded(shift);
    }
    let exponent = (exponent + shift + MANTISSA_BITS).clamp(i32::from(i16::MIN), i32::from(i16::MAX));
    (mantissa.map(I2F30::from_bits), exponent as i16)
}

/// Bits of the largest magnitude: the least b with every |value| < 2^b.
pub(super) fn magnitude_bits(values: &[i128]) -> u32 {
    let largest = values.iter().fold(0, |m, v| m.max(v.unsigned_abs()));
    u128::BITS - largest.leading_zeros()
}

/// `value / 2^shift` to nearest, ties toward +∞; |value| < 2^126, shift < 127.
pub(super) fn round_shift(value: i128, shift: u32) -> i128 {
    if shift == 0 { value } else { (value + (1 << (shift - 1))) >> shift }
}

/// ⌊log₂ |x|⌋ of a finite, non-zero x; below the normal numbers −1023.
pub(super) fn exponent_of(x: f64) -> i32 {
    ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023
}

/// 2^exponent, for −1022 ≤ exponent ≤ 1023.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent.clamp(-1022, 1023) + 1023) as u64) << 52)
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
        let carried = block_vector([(1 << 31) - 1, -3, 0], 0);
        assert_eq!(carried.mantissa.map(I2F30::to_bits), [1 << 29, -1, 0]);
        assert_eq!(carried.exponent, 32);
        let exact = block_vector([-5, 3, 0], 7);
        assert_eq!(exact.mantissa.map(I2F30::to_bits), [-5 << 27, 3 << 27, 0]);
        assert_eq!(exact.exponent, 10);
        // Ties go toward +∞ on both sides of zero.
        let tie = block_pair([(1 << 31) + 2, -2], -40);
        assert_eq!(tie.mantissa.map(I2F30::to_bits), [(1 << 29) + 1, 0]);
    }

    #[test]
    fn a_zero_vector_has_exponent_zero() {
        assert_eq!(block_vector([0; 3], 77), BlockVector::default());
        assert_eq!(block_from_reals([0.0; 3]), BlockVector::default());
    }

    #[test]
    fn forms_stay_within_sixty_bits_over_their_extent() {
        let planes = [[1e5, -3.0, 7.0], [0.0, 1e-9, 0.0], [-4.0, 2.0, 1e3]];
        let extent = 1 << 22;
        let (forms, exponent) = scaled_forms(planes, [f64::from(extent); 2]).expect("finite");
        for (form, plane) in forms.iter().zip(planes) {
            for (x, y) in [(-extent, extent), (extent, -extent), (0, 0), (12_345, -678)] {
                let value = form.at(x, y);
                assert!(value.unsigned_abs() < 1 << FORM_BITS);
                let exact = plane[0] + plane[1] * f64::from(x) + plane[2] * f64::from(y);
                // One step of the form, plus float64's own rounding of a sum of terms up to 7·2^22.
                let allowed = scale_by_power_of_two(1.0, exponent) + 1e-5 * f64::EPSILON * 1e9;
                assert!((scale_by_power_of_two(value as f64, exponent) - exact).abs() <= allowed);
            }
        }
    }

    #[test]
    fn encoding_ignores_what_is_not_finite() {
        assert_eq!(encode([f64::NAN, f64::INFINITY]), ([0, 0], 0));
        let (codes, exponent) = encode([1.0, f64::NAN]);
        assert_eq!((codes, exponent), ([1 << 51, 0], -51));
    }
}
