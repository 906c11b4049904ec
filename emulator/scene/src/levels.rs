//! Levels of a map: sizes, and the texels of a level that a texel of a smaller level covers.

/// Widths and heights of all levels of a map, in texels: `max(1, size >> level)`, ending with (1, 1).
///
/// A size of 0 counts as 1.
pub fn level_sizes(width: u32, height: u32) -> impl Iterator<Item = (u32, u32)> {
    let (width, height) = (width.max(1), height.max(1));
    let last = width.max(height).ilog2();
    (0..=last).map(move |level| ((width >> level).max(1), (height >> level).max(1)))
}

/// The texels that one texel of a smaller level covers along one axis, with integer weights.
#[derive(Debug, PartialEq, Eq)]
pub struct Cover {
    /// First texel.
    pub first: usize,
    /// Last texel.
    pub last: usize,
    first_weight: i64,
    /// Weight of every texel between the first and the last.
    inner_weight: i64,
    last_weight: i64,
}

impl Cover {
    /// Weight of a texel.
    #[inline]
    pub fn weight(&self, index: usize) -> i64 {
        if index == self.first {
            self.first_weight
        } else if index == self.last {
            self.last_weight
        } else {
            self.inner_weight
        }
    }

    /// Sum of the weights.
    #[inline]
    pub fn total(&self) -> i64 {
        (self.first..=self.last).map(|index| self.weight(index)).sum()
    }
}

/// Covers of all `to` texels over `from` ≥ `to` texels. With g = gcd, a texel is to/g units long, its cover from/g.
pub fn covers(from: u32, to: u32) -> Vec<Cover> {
    let g = gcd(from, to);
    let (unit, length) = (i64::from(to / g), i64::from(from / g));
    (0..i64::from(to))
        .map(|index| {
            let (start, end) = (index * length, (index + 1) * length);
            let (first, last) = (start / unit, (end - 1) / unit);
            Cover {
                first: first as usize,
                last: last as usize,
                first_weight: end.min((first + 1) * unit) - start,
                inner_weight: unit,
                last_weight: end - start.max(last * unit),
            }
        })
        .collect()
}

/// Greatest common divisor, Euclid's algorithm.
fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
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
    fn covers_of_odd_sizes_share_the_texel_on_their_border() {
        let cover =
            |first, last, first_weight, last_weight| Cover { first, last, first_weight, inner_weight: 2, last_weight };
        assert_eq!(covers(5, 2), [cover(0, 2, 2, 1), cover(2, 4, 1, 2)]);
        assert_eq!(covers(1024, 512)[511].total(), 2);
    }
}
