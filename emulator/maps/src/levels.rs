//! Sizes of levels, and powers of two.

/// Widths and heights of all levels of a map, in texels: `max(1, size >> level)`, ending with (1, 1).
///
/// A size of 0 counts as 1.
pub fn level_sizes(width: u32, height: u32) -> impl Iterator<Item = (u32, u32)> {
    let (width, height) = (width.max(1), height.max(1));
    let last = width.max(height).ilog2();
    (0..=last).map(move |level| ((width >> level).max(1), (height >> level).max(1)))
}

/// 2^exponent in float64, exact for exponents −1022…1023 (outside, the nearest of the two ends).
pub(crate) fn power_of_two(exponent: i32) -> f64 {
    let biased = (exponent.clamp(-1022, 1023) + 1023).unsigned_abs();
    f64::from_bits(u64::from(biased) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_halve_and_round_down_until_one_texel() {
        let sizes: Vec<_> = level_sizes(13, 4).collect();
        assert_eq!(sizes, [(13, 4), (6, 2), (3, 1), (1, 1)]);
        assert_eq!(level_sizes(1, 1).count(), 1);
        assert_eq!(level_sizes(16384, 1).count(), 15);
    }

    #[test]
    fn powers_of_two_are_exact() {
        assert_eq!(power_of_two(0), 1.0);
        assert_eq!(power_of_two(-28), 1.0 / f64::from(1 << 28));
        assert_eq!(power_of_two(1023), f64::MAX / (2.0 - f64::EPSILON));
        assert_eq!(power_of_two(-1022), f64::MIN_POSITIVE);
    }
}
