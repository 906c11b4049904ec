//! Bright texels: 16-bit codes with individual exponents, for environments brighter than 64 × white.
//!
//! A code is c in the upper 5 bits and f in the lower 11. It stands for f if c = 0, else for (2048 + f)·2^(c − 1), in 2^−31 of the
//! unit of the map ([`texel::bright_texel`], which the datapath runs between memory and filter). Codes are in the order of their
//! values, so a rounding that carries out of f carries into c.

use roughxel_core::datapath::texel;
use roughxel_core::fx::Fx;

use crate::mip::round_ratio;
use roughxel_utilities::exp2::power_of_two;

/// The largest code, 4095 · 2^19. Larger codes, which no map has, read as this one.
pub const LAST_CODE: u16 = 21 * 2048 - 1;

/// Value of a code, in 2^−31 of the unit of the map.
pub fn decoded(code: u16) -> i32 {
    texel::bright_texel::<i32>(Fx::from_raw(code.into())).raw()
}

/// The code of `significand`·2^`places`, with `significand` from 2048 to 4096, or less if `places` is 0.
fn code(significand: i64, places: u32) -> u16 {
    (i64::from(places) * 2048 + significand).min(LAST_CODE.into()) as u16
}

/// Shift that leaves 12 bits of a number of units.
fn places(units: i64) -> u32 {
    (64 - units.leading_zeros()).saturating_sub(12)
}

/// The code of `sum` / `area`, rounded once: to nearest, ties up. Range: sum ≥ 0 and area > 0 as those of
/// [`AreaSums`](crate::mip::AreaSums).
pub(crate) fn code_of_ratio(sum: i64, area: i64) -> u16 {
    let places = places(sum / area);
    code(round_ratio(sum, area << places), places)
}

/// Codes of one pixel: to nearest, ties up; saturated to 0 and to [`LAST_CODE`]; NaN gives 0.
pub(crate) fn quantise(pixel: [f32; 3], exponent: i32) -> [u16; 3] {
    let scale = power_of_two(31 - exponent);
    pixel.map(|value| {
        // Exact: 24 bits times a power of two. Casts saturate.
        let units = f64::from(value) * scale;
        let places = places((units as i64).clamp(0, i32::MAX.into()));
        code(((units * power_of_two(-(places as i32)) + 0.5).floor() as i64).clamp(0, 4096), places)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_comes_back_and_codes_are_in_the_order_of_their_values() {
        let mut below = -1;
        for code in 0..=u16::MAX {
            let value = decoded(code);
            if code > LAST_CODE {
                assert_eq!(value, below, "reads as the last code");
                continue;
            }
            assert!(value > below, "{code}");
            assert_eq!(code_of_ratio(value.into(), 1), code);
            assert_eq!(code_of_ratio(i64::from(value) * 12_345, 12_345), code);
            // A 12-bit value is a float32, whatever the unit.
            for exponent in [7, 13, 20] {
                let real = f64::from(value) * power_of_two(exponent - 31);
                assert_eq!(quantise([real as f32; 3], exponent), [code; 3]);
            }
            below = value;
        }
        assert_eq!(below, 4095 << 19);
    }

    #[test]
    fn what_lies_between_two_codes_becomes_the_nearer_one_and_ties_go_up() {
        for code in 0..LAST_CODE {
            let (low, high) = (i64::from(decoded(code)), i64::from(decoded(code + 1)));
            assert!(high - low <= 1.max(low / 2048), "{code}: a relative error of 2^-12 at most");
            // Half way, and a millionth to either side.
            let twice = low + high;
            for (sum, expected) in [(-1, code), (0, code + 1), (1, code + 1)] {
                assert_eq!(code_of_ratio(twice * 500_000 + sum, 1_000_000), expected, "{code}");
            }
            let real = twice as f64 / 2.0 * power_of_two(10 - 31);
            assert_eq!(quantise([real as f32; 3], 10), [code + 1; 3]);
        }
    }

    #[test]
    fn quantisation_is_total_and_saturates() {
        for (value, expected) in [
            (-1.0, 0),
            (f32::NAN, 0),
            (f32::NEG_INFINITY, 0),
            (0.0, 0),
            (f32::MIN_POSITIVE, 0),
            (128.0, LAST_CODE),
            (1e30, LAST_CODE),
            (f32::INFINITY, LAST_CODE),
            (64.0, 20 * 2048),
        ] {
            assert_eq!(quantise([value; 3], 7), [expected; 3], "{value}");
        }
    }
}
