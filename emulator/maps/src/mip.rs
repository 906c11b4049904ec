//! Colour pyramids: 16-bit linear texels, box-filtered with exact area weights.
//!
//! A texel of level `l` covers `W/w` × `H/h` texels of level 0, also if that is not a whole number. Every level is the
//! rounded integer mean over **level 0**, not over the rounded previous level. One rounding in all keeps the mean of each
//! level within half a code of that of level 0. Roundings of each level from the previous one would add up (ties alone
//! brighten by 1/8 code a level). For odd sizes they would blur across the borders of the covered area. If sizes divide, the
//! exact sums of an earlier level are reused. The result is the same integer, and power-of-two maps cost 4/3 of level 0.

use rayon::prelude::*;
use roughxel_assets::Picture;
use roughxel_scene::levels::{covers, level_sizes};
use roughxel_utilities::exp2::power_of_two;

/// One level of a colour map, texels in rows.
///
/// In a [`ColourPyramid`] row 0 lies at v = 0 (the bottom of the picture); in a face of a
/// [`CubePyramid`](crate::environment::CubePyramid) row 0 lies at t = −1 (the top of the picture).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Level {
    /// Texels in a row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Red, green, blue; linear light, value = code / 65536 · 2^exponent of the map.
    pub texels: Vec<[u16; 3]>,
}

impl Level {
    /// Codes of the texel in column `x` and row `y`.
    ///
    /// # Panics
    /// If the texel lies outside the level.
    pub fn texel(&self, x: u32, y: u32) -> [u16; 3] {
        self.texels[y as usize * self.width as usize + x as usize]
    }
}

/// A colour map and its mip levels; row 0 of every level at v = 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColourPyramid {
    /// Level 0 (full size) first, down to 1×1.
    pub levels: Vec<Level>,
    /// Value of a code: code / 65536 · 2^exponent, one exponent for the map; 0 for maps within [0, 1].
    pub exponent: i32,
}

impl ColourPyramid {
    /// Quantises a picture to 16 bits with the [`smallest_exponent`] that holds its maximum, and builds all levels.
    ///
    /// Rounding: to nearest, ties up, once for level 0 and once from its exact sums for every other level.
    ///
    /// # Panics
    /// If `picture` has no pixels, or not `width · height` of them.
    pub fn new(picture: &Picture) -> Self {
        Self::with_exponent(picture, smallest_exponent([picture]))
    }

    /// Quantises a picture as [`ColourPyramid::new`] does, with a given exponent; pixels brighter than 2^exponent
    /// saturate to code 65535.
    ///
    /// For pictures with a few pixels (a sun) so bright that their exponent would leave no codes for the rest.
    ///
    /// # Panics
    /// If `picture` has no pixels, or not `width · height` of them.
    pub fn with_exponent(picture: &Picture, exponent: i32) -> Self {
        let row = picture.width as usize;
        let mut texels = vec![[0; 3]; picture.pixels.len()];
        let rows = picture.pixels.par_chunks_exact(row).rev();
        texels.par_chunks_exact_mut(row).zip(rows).for_each(|(texels, pixels)| {
            texels.iter_mut().zip(pixels).for_each(|(texel, pixel)| *texel = quantise(*pixel, exponent));
        });
        Self { levels: colour_levels(picture.width, picture.height, texels), exponent }
    }
}

/// The smallest exponent ≥ 0 such that the brightest channel of all pictures is at most 2^exponent.
///
/// 0 for LDR pictures, where 1.0 saturates to code 65535. Infinite and NaN pixels do not count.
pub fn smallest_exponent<'a>(pictures: impl IntoIterator<Item = &'a Picture>) -> i32 {
    // The maximum of finite numbers alone is equal in any order.
    let brightest_of = |brightest: f32, pixel: &[f32; 3]| {
        pixel.iter().fold(brightest, |most, &value| if (value > most) & (value < f32::INFINITY) { value } else { most })
    };
    let brightest = pictures
        .into_iter()
        .map(|picture| picture.pixels.par_iter().fold(|| 0.0, brightest_of).reduce(|| 0.0, f32::max))
        .fold(0.0, f32::max);
    let mut exponent = 0;
    while f64::from(brightest) > power_of_two(exponent) {
        exponent += 1;
    }
    exponent
}

/// Codes of one pixel: value · 65536 / 2^exponent to nearest, ties up, saturated to 0…65535; NaN gives 0.
pub(crate) fn quantise(pixel: [f32; 3], exponent: i32) -> [u16; 3] {
    let scale = 65536.0 * power_of_two(-exponent);
    // Exact up to the cast: 24 bits times a power of two, plus one half, fit a float64. The cast saturates, so below zero truncation equals
    // the floor, for which many machines call a function.
    pixel.map(|value| (f64::from(value) * scale + 0.5) as u16)
}

/// All levels over the texels of level 0.
pub(crate) fn colour_levels(width: u32, height: u32, texels: Vec<[u16; 3]>) -> Vec<Level> {
    coded_levels(width, height, texels, i64::from, |sum, area| round_ratio(sum, area) as u16)
}

/// All levels over the texels of level 0: decoded codes are summed, and the quotient of a sum and an area becomes a code.
pub(crate) fn coded_levels(
    width: u32,
    height: u32,
    texels: Vec<[u16; 3]>,
    decoded: impl Fn(u16) -> i64 + Sync,
    code: impl Fn(i64, i64) -> u16 + Sync,
) -> Vec<Level> {
    assert_eq!(texels.len(), width as usize * height as usize);
    let base = |index: usize| texels[index].map(&decoded);
    let mut levels = Vec::new();
    for_each_level(width, height, base, |sums| {
        let mean = |sum: i64| code(sum, sums.area);
        levels.push(Level {
            width: sums.width,
            height: sums.height,
            texels: sums.sums.par_iter().map(|sum| sum.map(mean)).collect(),
        });
    });
    let base = Level { width, height, texels };
    levels.insert(0, base);
    levels
}

/// sum / area to nearest, ties toward +∞. Range: area > 0, |sum| and area below 2^61.
pub(crate) fn round_ratio(sum: i64, area: i64) -> i64 {
    (2 * sum + area).div_euclid(2 * area)
}

/// Exact sums of `N` integer channels over the area of each texel of one level.
///
/// Mean of a texel = sum / area. With at most 2^26 texels of |channel| < 2^31 every sum is below 2^57.
pub(crate) struct AreaSums<const N: usize> {
    /// Texels in a row of this level.
    pub(crate) width: u32,
    /// Rows of this level.
    pub(crate) height: u32,
    /// Weight that every texel's sum carries, at most the number of texels of level 0.
    pub(crate) area: i64,
    /// Weighted sums, in rows.
    pub(crate) sums: Vec<[i64; N]>,
}

/// Calls `visit` with the exact sums of level 1, 2, … down to 1×1; `base` gives the channels of a texel of level 0.
pub(crate) fn for_each_level<const N: usize>(
    width: u32,
    height: u32,
    base: impl Fn(usize) -> [i64; N] + Sync,
    mut visit: impl FnMut(&AreaSums<N>),
) {
    // The deepest level whose texels are whole blocks of level 0: sums over whole blocks can be summed again.
    let mut blocks: Option<AreaSums<N>> = None;
    for (to_width, to_height) in level_sizes(width, height).skip(1) {
        let reusable = blocks
            .as_ref()
            .filter(|blocks| blocks.width.is_multiple_of(to_width) && blocks.height.is_multiple_of(to_height));
        let sums = match reusable {
            Some(from) => {
                let mut sums = shrink(from.width, from.height, to_width, to_height, |index| from.sums[index]);
                sums.area *= from.area;
                sums
            }
            None => shrink(width, height, to_width, to_height, &base),
        };
        visit(&sums);
        if width.is_multiple_of(to_width) && height.is_multiple_of(to_height) {
            blocks = Some(sums);
        }
    }
}

/// Area-weighted sums over a map; one row of the result is one task, so threads cannot change it.
fn shrink<const N: usize>(
    width: u32,
    height: u32,
    to_width: u32,
    to_height: u32,
    texel: impl Fn(usize) -> [i64; N] + Sync,
) -> AreaSums<N> {
    let columns = covers(width, to_width);
    let rows = covers(height, to_height);
    let mut sums = vec![[0; N]; to_width as usize * to_height as usize];
    sums.par_chunks_mut(to_width as usize).zip(&rows).for_each(|(line, row)| {
        for y in row.first..=row.last {
            let start = y * width as usize;
            let row_weight = row.weight(y);
            for (sum, column) in line.iter_mut().zip(&columns) {
                for x in column.first..=column.last {
                    let weight = row_weight * column.weight(x);
                    let channels = texel(start + x);
                    for (sum, channel) in sum.iter_mut().zip(channels) {
                        *sum += weight * channel;
                    }
                }
            }
        }
    });
    AreaSums { width: to_width, height: to_height, area: columns[0].total() * rows[0].total(), sums }
}

#[cfg(test)]
mod tests {
    use super::*;
    use roughxel_utilities::random::SplitMix64;

    const SIZES: [(u32, u32); 12] =
        [(1, 1), (2, 2), (3, 3), (1, 17), (31, 1), (5, 8), (16, 16), (11, 10), (64, 4), (20, 12), (37, 53), (100, 63)];

    /// Uniform codes.
    fn noise(width: u32, height: u32, seed: u64) -> Vec<[u16; 3]> {
        let mut random = SplitMix64::new(seed);
        (0..width * height).map(|_| [(); 3].map(|()| random.below(1 << 16) as u16)).collect()
    }

    fn mean(level: &Level, channel: usize) -> f64 {
        let sum: u64 = level.texels.iter().map(|t| u64::from(t[channel])).sum();
        sum as f64 / level.texels.len() as f64
    }

    #[test]
    fn every_level_keeps_the_mean_to_half_a_code() {
        for (width, height) in SIZES {
            let levels = colour_levels(width, height, noise(width, height, 7));
            for level in &levels {
                for channel in 0..3 {
                    let error = mean(level, channel) - mean(&levels[0], channel);
                    // Half a code from the one rounding; 1e-9 for the float64 means of this test.
                    assert!(error.abs() <= 0.5 + 1e-9, "{width}x{height} at {}x{}: {error}", level.width, level.height);
                }
            }
        }
    }

    #[test]
    fn constant_maps_stay_constant_at_every_size_and_code() {
        for (width, height) in SIZES {
            for code in [0, 1, 32767, 65535] {
                let texels = vec![[code; 3]; (width * height) as usize];
                for level in colour_levels(width, height, texels) {
                    assert!(level.texels.iter().all(|texel| *texel == [code; 3]));
                }
            }
        }
    }

    #[test]
    fn every_texel_is_the_area_mean_of_level_0_rounded_once() {
        for (width, height) in SIZES {
            let levels = colour_levels(width, height, noise(width, height, 3));
            let base = &levels[0];
            for level in &levels {
                let (w, h) = (u64::from(level.width), u64::from(level.height));
                for (index, texel) in level.texels.iter().enumerate() {
                    let (i, j) = (index as u64 % w, index as u64 / w);
                    let overlap = |k: u64, small: u64, index: u64, large: u64| {
                        ((k + 1) * small).min((index + 1) * large).saturating_sub((k * small).max(index * large))
                    };
                    let mut sum = [0; 3];
                    for y in 0..u64::from(height) {
                        for x in 0..u64::from(width) {
                            let weight = overlap(x, w, i, u64::from(width)) * overlap(y, h, j, u64::from(height));
                            for (sum, code) in sum.iter_mut().zip(base.texel(x as u32, y as u32)) {
                                *sum += weight * u64::from(code);
                            }
                        }
                    }
                    let area = u64::from(width) * u64::from(height);
                    assert_eq!(sum.map(|sum| ((2 * sum + area) / (2 * area)) as u16), *texel);
                }
            }
        }
    }

    #[test]
    fn row_0_of_a_pyramid_is_the_bottom_row_of_the_picture() {
        let picture = Picture { width: 1, height: 2, pixels: vec![[1.0, 0.5, 0.0], [0.25; 3]] };
        let pyramid = ColourPyramid::new(&picture);
        assert_eq!(pyramid.exponent, 0);
        assert_eq!(pyramid.levels[0].texel(0, 0), [16384; 3]);
        assert_eq!(pyramid.levels[0].texel(0, 1), [65535, 32768, 0]);
        // (16384 + 65535) / 2 is a tie and goes up.
        assert_eq!(pyramid.levels[1].texel(0, 0), [40960, 24576, 8192]);
    }

    #[test]
    fn the_exponent_is_the_smallest_that_holds_the_maximum() {
        let exponent = |value| smallest_exponent([&Picture::filled(1, 1, [value, 0.0, 0.0])]);
        assert_eq!(exponent(0.0), 0);
        assert_eq!(exponent(1.0), 0);
        assert_eq!(exponent(1.000_001), 1);
        assert_eq!(exponent(2.0), 1);
        assert_eq!(exponent(65504.0), 16);
        assert_eq!(exponent(f32::MAX), 128);
        assert_eq!(exponent(f32::INFINITY), 0);
        assert_eq!(exponent(f32::NAN), 0);
    }

    #[test]
    fn quantisation_is_total_and_saturates() {
        let q = |value| quantise([value; 3], 1)[0];
        assert_eq!(q(1.0), 32768);
        assert_eq!(q(2.0), 65535);
        assert_eq!(q(f32::INFINITY), 65535);
        assert_eq!(q(-1.0), 0);
        assert_eq!(q(f32::NAN), 0);
        assert_eq!(q(0.5 / 32768.0), 1);
        assert_eq!(q(0.49 / 32768.0), 0);
    }

    #[test]
    fn rounding_of_ratios_is_to_nearest_with_ties_up() {
        assert_eq!([-3, -2, -1, 0, 1, 2, 3].map(|sum| round_ratio(sum, 2)), [-1, -1, 0, 0, 1, 1, 2]);
    }

    #[test]
    fn texels_do_not_depend_on_the_number_of_threads() {
        let build = |threads| {
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .map(|pool| pool.install(|| colour_levels(100, 63, noise(100, 63, 5))))
        };
        assert_eq!(build(1).ok(), build(3).ok());
    }
}
