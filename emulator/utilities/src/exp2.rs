//! Powers of two that are the same on every machine. They use operations that IEEE 754 fixes to the last bit, without a branch, so loops become
//! vectors.

use std::f64::consts::LN_2;

/// 2^`x`, with a relative error below 2⁻⁵¹; exact for whole numbers. Range: |x| < 1000.
#[inline(always)]
pub fn exp2(x: f64) -> f64 {
    /// 1/n.
    const INVERSE: [f64; 14] = {
        let mut inverse = [0.0; 14];
        let mut n = 1;
        while n < 14 {
            inverse[n] = 1.0 / n as f64;
            n += 1;
        }
        inverse
    };
    let whole = (x + 0.5).floor();
    // e^t = 1 + t(1 + t/2(1 + t/3(…))), |t| ≤ ln 2/2: the omitted terms are below 2⁻⁵⁷.
    let t = (x - whole) * LN_2;
    let mut series = 1.0;
    for n in (1..14).rev() {
        series = 1.0 + t * INVERSE[n] * series;
    }
    // Above 2⁵² the lowest bits of a float are those of an integer: here the exponent of 2^whole.
    let exponent = (whole + (1023.0 + (1_u64 << 52) as f64)).to_bits() << 52;
    f64::from_bits(exponent) * series
}

/// 2^exponent in float64, exact for exponents −1022…1023. An exponent outside counts as the nearest end.
#[inline(always)]
pub fn power_of_two(exponent: i32) -> f64 {
    let biased = (exponent.clamp(-1022, 1023) + 1023).unsigned_abs();
    f64::from_bits(u64::from(biased) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn powers_of_two_agree_with_the_library() {
        let mut random = SplitMix64::new(3);
        let drawn = (0..100_000).map(|_| random.uniform(-60.0, 60.0));
        for x in (-1000..=1000).map(|step| f64::from(step) / 100.0).chain(drawn) {
            // The library's own error is below one last place.
            assert!((exp2(x) / x.exp2() - 1.0).abs() < 2.0 * f64::EPSILON, "{x}");
        }
        for whole in -1000..1000 {
            assert_eq!(exp2(whole.into()), 2_f64.powi(whole));
        }
    }

    #[test]
    fn powers_of_two_are_exact() {
        assert_eq!(power_of_two(0), 1.0);
        assert_eq!(power_of_two(-28), 1.0 / f64::from(1 << 28));
        assert_eq!(power_of_two(1023), f64::MAX / (2.0 - f64::EPSILON));
        assert_eq!(power_of_two(-1022), f64::MIN_POSITIVE);
    }
}
