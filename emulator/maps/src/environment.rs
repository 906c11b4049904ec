//! Environment maps: six faces with mip levels.
//!
//! Faces are in Vulkan's order +x, −x, +y, −y, +z, −z with Vulkan's (s_c, t_c). Column 0 is at s = −1, row 0 at t = −1 (the top row of
//! the face's picture, no flip). All faces and levels share one unit, so probes may mix them as integers. Maps brighter than 64 ×
//! white have codes with individual exponents in that unit. Each face is filtered alone down to levels of 17 texels. A texel next to
//! an edge then holds its own side only, and the filter looks across the edge (the stage `seam` of the datapath). Coarser levels are
//! filtered on the sphere.

use rayon::prelude::*;
use roughxel_core::sampler::{BRIGHT_EXPONENTS, level_edge};

use crate::bright;
use crate::mip::{Level, coded_levels, colour_levels, quantise, round_ratio, smallest_exponent};
use crate::sphere::{self, Sources};
use roughxel_assets::Picture;
use roughxel_utilities::exp2::power_of_two;

/// An environment map with its mip levels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CubePyramid {
    /// Edge of a face at level 0, in texels.
    pub edge: u32,
    /// Level 0 (full size) first, each of [`level_edge`] texels along an edge; six faces each, row 0 at t = −1.
    pub levels: Vec<[Level; 6]>,
    /// log₂ of the unit of the codes, one for all faces: at most 6, or at least 7 if the codes are bright.
    pub exponent: i32,
}

impl CubePyramid {
    /// Stores six faces in 16 bits a channel with the [`smallest_exponent`] that holds their maximum, and builds all levels. Codes are
    /// linear, as those of a [`ColourPyramid`](crate::mip::ColourPyramid), up to 64 × white, and [`bright`] above. Light beyond the bright
    /// codes is clamped.
    ///
    /// Rounding: to nearest, ties up, once for level 0 and once from its exact sums for every other level down to 17 texels along an edge.
    /// Coarser levels are rounded once more, from a level of at most 64.
    ///
    /// # Panics
    /// If the faces are not squares of one size of at least 1, with all their pixels.
    pub fn new(faces: &[Picture; 6]) -> Self {
        let exponent = smallest_exponent(faces).min(*BRIGHT_EXPONENTS.end());
        let is_bright = BRIGHT_EXPONENTS.contains(&exponent);
        let edge = faces[0].width;
        assert!(
            faces.iter().all(|face| edge > 0 && (face.width, face.height) == (edge, edge)),
            "an environment needs six square faces of one size"
        );
        let mut pyramids = faces.each_ref().map(|face| {
            let pixels = face.pixels.par_iter();
            let levels = if is_bright {
                let texels = pixels.map(|pixel| bright::quantise(*pixel, exponent)).collect();
                coded_levels(edge, edge, texels, |code| bright::decoded(code).into(), bright::code_of_ratio)
            } else {
                colour_levels(edge, edge, pixels.map(|pixel| quantise(*pixel, exponent)).collect())
            };
            levels.into_iter()
        });
        let mut levels = Vec::new();
        while let [Some(a), Some(b), Some(c), Some(d), Some(e), Some(f)] = pyramids.each_mut().map(Iterator::next) {
            levels.push([a, b, c, d, e, f]);
        }
        let mut pyramid = Self { edge, levels, exponent };
        pyramid.filter_coarse_levels();
        pyramid
    }

    /// Replaces the coarse levels by levels filtered on the sphere, from the finest level that is small enough.
    fn filter_coarse_levels(&mut self) {
        let Some(source) = self.levels.iter().find(|level| level[0].width <= sphere::SOURCE) else { return };
        let decoded = |code: u16| if self.is_bright() { bright::decoded(code).into() } else { f64::from(code) };
        let texels = source.iter().flat_map(|face| &face.texels);
        let source = Sources::new(source[0].width, texels.map(|texel| texel.map(decoded)).collect());
        let code = |mean: f64| {
            // Below 2^51, and exact up to the floor.
            let (sum, area) = ((mean * power_of_two(20)).floor() as i64, 1 << 20);
            if self.is_bright() { bright::code_of_ratio(sum, area) } else { round_ratio(sum, area) as u16 }
        };
        let coarse = |index: usize| {
            let width = level_edge(self.edge, index as u32);
            let nominal = f64::from(self.edge) * power_of_two(-(index as i32));
            let texels = source.level(width, nominal);
            let codes: Vec<[u16; 3]> = texels.into_iter().map(|texel| texel.map(code)).collect();
            let size = (width * width) as usize;
            [0, 1, 2, 3, 4, 5].map(|face| Level {
                width,
                height: width,
                texels: codes[face * size..(face + 1) * size].to_vec(),
            })
        };
        let is_fine = |level: &&[Level; 6]| level[0].width > sphere::COARSE;
        let fine = self.levels.iter().take_while(is_fine).count().max(1);
        // Levels are made in parallel, as balancing a kernel takes one thread.
        let coarse: Vec<[Level; 6]> = (fine..self.levels.len()).into_par_iter().map(coarse).collect();
        self.levels.truncate(fine);
        self.levels.extend(coarse);
    }

    /// True if the codes are [`bright`] ones.
    pub fn is_bright(&self) -> bool {
        BRIGHT_EXPONENTS.contains(&self.exponent)
    }

    /// A channel of a texel in linear light, exact.
    pub fn light(&self, code: u16) -> f64 {
        if self.is_bright() {
            f64::from(bright::decoded(code)) * power_of_two(self.exponent - 31)
        } else {
            f64::from(code) * power_of_two(self.exponent - 16)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bright::LAST_CODE;
    use roughxel_utilities::limits::BRIGHTEST_ENVIRONMENT;
    use roughxel_utilities::random::SplitMix64;

    #[test]
    fn a_cube_pyramid_keeps_the_rows_of_its_pictures_and_one_exponent() {
        let mut faces: [Picture; 6] = std::array::from_fn(|face| Picture::filled(6, 6, [face as f32 / 8.0; 3]));
        faces[2].pixels[0] = [3.0; 3];
        let cube = CubePyramid::new(&faces);
        assert_eq!((cube.edge, cube.exponent), (6, 2));
        let edges: Vec<_> = cube.levels.iter().map(|level| level[5].height).collect();
        assert_eq!(edges, [6, 6, 6]);
        assert_eq!(cube.levels[0][2].texel(0, 0), [49152; 3]);
        // Coarse levels see other faces too: 0 to 5 eighths of 16384.
        assert!((1..10240).contains(&cube.levels[2][4].texel(0, 0)[0]));
    }

    /// A grey noisy sky with a small sun on one face.
    fn sky_with_sun(sun: f32, edge: u32) -> [Picture; 6] {
        let mut random = SplitMix64::new(edge.into());
        let mut faces = [(); 6].map(|()| Picture {
            width: edge,
            height: edge,
            pixels: (0..edge * edge).map(|_| [(); 3].map(|()| random.uniform(0.01, 1.0) as f32)).collect(),
        });
        faces[2].pixels[(edge * (edge / 3) + edge / 4) as usize] = [sun, 0.9 * sun, 0.8 * sun];
        faces
    }

    /// The mean of each face and channel.
    fn means(faces: &[Picture; 6]) -> [[f64; 3]; 6] {
        faces.each_ref().map(|face| {
            let sum = |channel: usize| face.pixels.iter().map(|pixel| f64::from(pixel[channel])).sum::<f64>();
            [0, 1, 2].map(|channel| sum(channel) / face.pixels.len() as f64)
        })
    }

    #[test]
    fn fine_levels_of_a_bright_environment_have_the_light_of_each_face() {
        for (edge, sun) in [(64, 30_000.0), (37, 30_000.0), (128, 65_504.0), (64, 65.0), (20, 1e6)] {
            let faces = sky_with_sun(sun, edge);
            let (cube, expected) = (CubePyramid::new(&faces), means(&faces));
            assert!(cube.is_bright());
            for level in cube.levels.iter().filter(|level| level[0].width > sphere::COARSE || level[0].width == edge) {
                for (face, expected) in level.iter().zip(expected) {
                    for (channel, expected) in expected.into_iter().enumerate() {
                        let sum: f64 = face.texels.iter().map(|texel| cube.light(texel[channel])).sum();
                        let mean = sum / face.texels.len() as f64;
                        // Two roundings of a relative 2^-12; single dark texels are rounded by half a unit.
                        let bound = expected * 2.0 * power_of_two(-12) + power_of_two(cube.exponent - 31);
                        assert!((mean - expected).abs() <= bound, "{edge} {sun} {}: {mean} {expected}", face.width);
                    }
                }
            }
        }
    }

    /// The mean of each channel over the sphere: every texel counts by its solid angle.
    fn mean(edge: u32, light: impl Fn(usize, usize) -> [f64; 3]) -> [f64; 3] {
        let (mut sum, mut all) = ([0.0; 3], 0.0);
        for face in 0..6 {
            for index in 0..edge * edge {
                let centre = |i: u32| f64::from(2 * i + 1) / f64::from(edge) - 1.0;
                let weight = (1.0 + centre(index % edge).powi(2) + centre(index / edge).powi(2)).powf(-1.5);
                let light = light(face, index as usize);
                sum = [0, 1, 2].map(|channel| sum[channel] + weight * light[channel]);
                all += weight;
            }
        }
        sum.map(|sum| sum / all)
    }

    #[test]
    fn coarse_levels_of_an_environment_have_the_light_of_the_level_they_come_from() {
        for (edge, sun) in [(64, 30_000.0), (37, 30_000.0), (128, 65_504.0), (64, 65.0), (20, 1e6), (128, 40.0)] {
            let faces = sky_with_sun(sun, edge);
            let cube = CubePyramid::new(&faces);
            let mean_of = |level: &[Level; 6]| {
                mean(level[0].width, |face, index| level[face].texels[index].map(|code| cube.light(code)))
            };
            let is_coarse = |level: &&[Level; 6]| level[0].width <= sphere::COARSE;
            let source = cube.levels.iter().find(|level| level[0].width <= sphere::SOURCE).expect("a level is small");
            let expected = mean_of(source);
            for level in cube.levels.iter().filter(is_coarse) {
                for (mean, expected) in mean_of(level).into_iter().zip(expected) {
                    assert!((mean / expected - 1.0).abs() < 0.01, "{edge} {sun} {}: {mean} {expected}", level[0].width);
                }
            }
        }
    }

    #[test]
    fn stops_of_exposure_change_the_unit_and_no_code() {
        let faces = sky_with_sun(30_000.0, 16);
        let cube = CubePyramid::new(&faces);
        for stops in [-6, 4] {
            let mut exposed = faces.clone();
            for channel in exposed.iter_mut().flat_map(|face| &mut face.pixels).flatten() {
                *channel *= power_of_two(stops) as f32;
            }
            let other = CubePyramid::new(&exposed);
            assert_eq!((other.exponent, &other.levels), (cube.exponent + stops, &cube.levels));
        }
    }

    #[test]
    fn up_to_64_times_white_codes_are_linear_and_above_the_brightest_they_are_cut() {
        for (sun, exponent, is_bright) in [(1.0, 0, false), (64.0, 6, false), (64.01, 7, true), (1e9, 20, true)] {
            let cube = CubePyramid::new(&sky_with_sun(sun, 8));
            assert_eq!((cube.exponent, cube.is_bright()), (exponent, is_bright), "{sun}");
            let brightest = cube.levels[0].iter().flat_map(|face| &face.texels).flatten().max();
            if sun > 1e6 {
                assert_eq!(brightest, Some(&LAST_CODE));
                assert_eq!(cube.light(LAST_CODE), BRIGHTEST_ENVIRONMENT);
            }
        }
    }
}
