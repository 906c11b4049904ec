//! Real numbers whose exponents may be those of ports, far beyond the range of a float64.

use std::fmt;

use roughxel_core::setup::scale_by_power_of_two;
use serde::{Serialize, Serializer};

/// A number `mantissa · 2^exponent`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Real {
    mantissa: f64,
    exponent: i32,
}

impl Real {
    /// `mantissa · 2^exponent`; the mantissa is finite.
    pub fn new(mantissa: f64, exponent: i32) -> Self {
        Self { mantissa, exponent }
    }

    /// The number as a float64; `None` if it is beyond the range of normal numbers.
    pub fn value(self) -> Option<f64> {
        let value = scale_by_power_of_two(self.mantissa, self.exponent);
        (value.is_normal() || self.mantissa == 0.0).then_some(value)
    }

    /// The number in units of 2^`unit`; infinite beyond the range of a float64, 0 below it.
    pub fn in_units(self, unit: i32) -> f64 {
        // Exponents of ports and of units have 17 bits: their difference fits, and one beyond ±4000 is beyond every float64.
        scale_by_power_of_two(self.mantissa, (self.exponent - unit).clamp(-4000, 4000))
    }
}

impl fmt::Display for Real {
    /// Ten significant digits, the precision of a 30-bit mantissa, without trailing zeros.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.value() {
            Some(value) => f.write_str(&shown(value)),
            None => write!(f, "{}·2^{}", shown(self.mantissa), self.exponent),
        }
    }
}

/// The number itself; `null` beyond the range of a float64.
impl Serialize for Real {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.value().serialize(serializer)
    }
}

/// A number of a few digits before the point in plain form, any other with an exponent of ten.
pub(super) fn shown(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    let digits = format!("{x:.9e}");
    let Some((mantissa, exponent)) = digits.split_once('e') else { return digits };
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let trimmed = |text: &str| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text.to_owned(),
    };
    match exponent {
        -4..=9 => trimmed(&format!("{x:.*}", (9 - exponent) as usize)),
        _ => format!("{}e{exponent}", trimmed(mantissa)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_shown_with_ten_digits_and_an_exponent_where_they_need_one() {
        let cases = [
            (0.0, "0"),
            (1.0, "1"),
            (-0.5, "-0.5"),
            (1.0 / 3.0, "0.3333333333"),
            (0.0001, "0.0001"),
            (0.00001, "1e-5"),
            (16384.0, "16384"),
            (2e10, "2e10"),
            (-5.086_27e-6, "-5.08627e-6"),
        ];
        for (x, text) in cases {
            assert_eq!(shown(x), text);
        }
        assert_eq!(Real::new(0.5, -9000).to_string(), "0.5·2^-9000");
        assert_eq!(Real::new(0.0, -32768).to_string(), "0");
    }

    #[test]
    fn a_number_beyond_a_float64_has_no_value_but_its_units() {
        let real = Real::new(0.75, 20_000);
        assert_eq!((real.value(), real.in_units(19_999)), (None, 1.5));
        assert_eq!(Real::new(0.75, 1).value(), Some(1.5));
    }
}
