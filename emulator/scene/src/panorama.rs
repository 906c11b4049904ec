//! Six cube faces from an equirectangular picture, of the sphere or of a part of it.
//!
//! Resampling averages a grid of bilinear samples no further apart than one texel of the equirectangular picture, so it
//! cannot alias. The grid has at most 64×64 samples, which only texels around the poles reach. Angles come from a fixed
//! series and correctly rounded operations: the same faces on every machine.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, SQRT_2, TAU};

use rayon::prelude::*;
use roughxel_simd::{Backend, LANES};

use crate::cube::direction;
use roughxel_assets::Picture;

/// Most samples of a face texel along an axis.
const MOST_SAMPLES: f64 = 64.0;

/// Directions between the borders of an equirectangular picture, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent {
    /// Azimuths of the left and the right border: 0 is −z, 90 is +x. Range: 1 to 360 apart.
    pub(super) longitudes: [f64; 2],
    /// Elevations of the lower and the upper border. Range: 1 to 180 apart, −90 to 90.
    pub(super) latitudes: [f64; 2],
}

impl Extent {
    /// The whole sphere, −z in the middle.
    pub(super) const SPHERE: Self = Self { longitudes: [-180.0, 180.0], latitudes: [-90.0, 90.0] };

    /// Width over height of square pixels.
    pub(super) fn ratio(&self) -> f64 {
        let [across, up] = [self.longitudes, self.latitudes].map(|[from, to]| to - from);
        across / up
    }

    /// Width and height of a picture of the whole sphere with pixels as large as those of a picture of this extent.
    pub(super) fn whole_size(&self, picture: &Picture) -> [u64; 2] {
        let [across, up] = [self.longitudes, self.latitudes].map(|[from, to]| to - from);
        let whole = |pixels: u32, degrees: f64, all: f64| (f64::from(pixels) * all / degrees).round() as u64;
        [whole(picture.width, across, 360.0), whole(picture.height, up, 180.0)]
    }

    /// A picture of the whole sphere, black around the extent. Borders are moved to whole pixels.
    ///
    /// The size is that of [`Extent::whole_size`], which the caller bounds.
    pub(super) fn on_the_sphere(&self, picture: Picture) -> Picture {
        if *self == Self::SPHERE {
            return picture;
        }
        let [width, height] = self.whole_size(&picture).map(|size| size as usize);
        let columns = picture.width as usize;
        let left = ((self.longitudes[0] + 180.0) / 360.0 * width as f64).round() as i64;
        let left = left.rem_euclid(width as i64) as usize;
        let top = ((90.0 - self.latitudes[1]) / 180.0 * height as f64).round() as usize;
        let top = top.min(height - picture.height as usize);
        let mut whole = Picture::filled(width as u32, height as u32, [0.0; 3]);
        let rows = whole.pixels.chunks_exact_mut(width).skip(top);
        for (to, from) in rows.zip(picture.pixels.chunks_exact(columns)) {
            let until_the_border = columns.min(width - left);
            to[left..left + until_the_border].copy_from_slice(&from[..until_the_border]);
            to[..columns - until_the_border].copy_from_slice(&from[until_the_border..]);
        }
        whole
    }
}

/// Resamples an equirectangular panorama to six cube faces of `face_edge` (at least 1) pixels.
///
/// Directions: +y is up. The centre of the panorama looks along −z and u grows to the right. A quarter to the right of
/// the centre is +x, a quarter to the left −x. The left and right borders meet at +z. Rows run from +y (top) to −y.
/// Linear light in and out; every face pixel is the mean over its area, weighted evenly in (s, t).
///
/// # Panics
/// If `panorama` has no pixels, or not `width · height` of them.
pub fn faces_from_equirectangular(panorama: &Picture, face_edge: u32) -> [Picture; 6] {
    let edge = face_edge.max(1);
    std::array::from_fn(|face| {
        let mut picture = Picture::filled(edge, edge, [0.0; 3]);
        picture.pixels.par_chunks_mut(edge as usize).enumerate().for_each(|(row, means)| {
            for (group, means) in means.chunks_mut(LANES).enumerate() {
                Backend::best().run(
                    #[inline(always)]
                    || resample(panorama, face, [LANES * group, row], edge, means),
                );
            }
        });
        picture
    })
}

/// Means of the panorama over the texels of a row of a face, at most [`LANES`], from a column and row on.
#[inline(always)]
fn resample(panorama: &Picture, face: usize, [first, row]: [usize; 2], edge: u32, means: &mut [[f32; 3]]) {
    let texel = 2.0 / f64::from(edge);
    let coordinate = |index: usize, offset: f64| (index as f64 + offset) * texel - 1.0;
    let (mut sums, mut steps) = ([[0.0; 3]; LANES], [0.0; LANES]);
    let mut waiting = Samples::default();
    for (number, step) in steps.iter_mut().enumerate().take(means.len()) {
        let column = first + number;
        let centre = direction(face, coordinate(column, 0.5), coordinate(row, 0.5));
        let count = samples_along(panorama, centre, texel);
        *step = 1.0 / count as f64;
        for j in 0..count {
            let t = coordinate(row, (j as f64 + 0.5) * *step);
            for i in 0..count {
                waiting.push(number, [coordinate(column, (i as f64 + 0.5) * *step), t]);
                if waiting.count == LANES {
                    waiting.add_to(&mut sums, panorama, face);
                }
            }
        }
    }
    waiting.add_to(&mut sums, panorama, face);
    for (mean, (sum, step)) in means.iter_mut().zip(sums.into_iter().zip(steps)) {
        *mean = sum.map(|sum| (sum * step * step) as f32);
    }
}

/// Samples along an axis of a texel of this size in s and t, whose centre on the cube is given.
#[inline(always)]
fn samples_along(panorama: &Picture, [x, y, z]: [f64; 3], texel: f64) -> usize {
    // Extent of the texel in texels of the panorama: texel / |d| radians along a meridian, texel / ρ along a circle of
    // latitude. ρ is the distance from the axis at the texel's point nearest to it, except the pole itself.
    let from_axis = (x * x + z * z).sqrt();
    let nearest = (from_axis - texel).max(0.5 * texel);
    let columns = texel / nearest * f64::from(panorama.width) / TAU;
    let length = (from_axis * from_axis + y * y).sqrt();
    let rows = texel / length * f64::from(panorama.height) / PI;
    columns.max(rows).ceil().clamp(2.0, MOST_SAMPLES) as usize
}

/// Samples of a face that wait for a vector operation.
#[derive(Default)]
struct Samples {
    count: usize,
    /// Texel of each sample.
    of: [usize; LANES],
    /// s and t of each sample.
    places: [[f64; LANES]; 2],
}

impl Samples {
    /// Adds a sample. Range: fewer than [`LANES`] wait.
    #[inline(always)]
    fn push(&mut self, of: usize, [s, t]: [f64; 2]) {
        self.of[self.count] = of;
        self.places[0][self.count] = s;
        self.places[1][self.count] = t;
        self.count += 1;
    }

    /// Takes the waiting samples in order and adds each to the sum of its texel.
    #[inline(always)]
    fn add_to(&mut self, sums: &mut [[f64; 3]; LANES], panorama: &Picture, face: usize) {
        let [s, t] = &self.places;
        let [mut left, mut top, mut right_weight, mut bottom_weight] = [[0.0; LANES]; 4];
        for lane in 0..LANES {
            let cell = cell(panorama, position(direction(face, s[lane], t[lane])));
            [left[lane], top[lane], right_weight[lane], bottom_weight[lane]] = cell;
        }
        for lane in 0..std::mem::take(&mut self.count) {
            let colour = bilinear(panorama, [left[lane], top[lane], right_weight[lane], bottom_weight[lane]]);
            for (sum, channel) in sums[self.of[lane]].iter_mut().zip(colour) {
                *sum += channel;
            }
        }
    }
}

/// Position of a direction in the panorama, 0…1 in each coordinate: 0 at the left border and at the top.
#[inline(always)]
fn position([x, y, z]: [f64; 3]) -> [f64; 2] {
    let longitude = atan2(x, -z) / TAU;
    let latitude = atan2(y, (x * x + z * z).sqrt()) / PI;
    [0.5 + longitude, 0.5 - latitude]
}

/// First column and row of a bilinear sample, and the weights of the second column and row. Columns wrap around; rows end at
/// the poles.
#[inline(always)]
fn cell(panorama: &Picture, [u, v]: [f64; 2]) -> [f64; 4] {
    let [width, height] = [panorama.width, panorama.height].map(f64::from);
    let x = u * width - 0.5;
    let y = (v * height - 0.5).max(0.0).min(height - 1.0);
    let (left, top) = (x.floor(), y.floor());
    // x lies within −½…width − ½, so only the first column −1 is wrapped.
    [if left < 0.0 { width - 1.0 } else { left }, top, x - left, y - top]
}

/// Bilinear sample in a [`cell`].
#[inline(always)]
fn bilinear(panorama: &Picture, [left, top, right_weight, bottom_weight]: [f64; 4]) -> [f64; 3] {
    let (width, height) = (panorama.width as usize, panorama.height as usize);
    let (left, top) = (left as u32 as usize, top as u32 as usize);
    let columns = [left, if left + 1 == width { 0 } else { left + 1 }];
    let rows = [top * width, (top + 1).min(height - 1) * width];
    let pixel = |i: usize, j: usize| panorama.pixels[rows[j] + columns[i]].map(f64::from);
    let (a, b, c, d) = (pixel(0, 0), pixel(1, 0), pixel(0, 1), pixel(1, 1));
    std::array::from_fn(|channel| {
        let upper = a[channel] + (b[channel] - a[channel]) * right_weight;
        let lower = c[channel] + (d[channel] - c[channel]) * right_weight;
        upper + (lower - upper) * bottom_weight
    })
}

/// Angle of the point (x, y) in −π…π, 0 for the origin; error below 2⁻³⁶, the same bits on every machine.
///
/// The platform's atan2 may differ in the last bit, and one such bit can move a 16-bit texel. 2⁻³⁶ is 2⁻²⁴ texels of
/// the widest panorama.
#[inline(always)]
fn atan2(y: f64, x: f64) -> f64 {
    // Values are selected without branches, so that loops vectorise.
    let (small, large) = (y.abs().min(x.abs()), y.abs().max(x.abs()));
    // arctan(a/b) = π/4 + arctan((a − b)/(a + b)) maps the upper half of the octant to the lower half.
    let is_upper = small > TAN_PI_8 * large;
    let [numerator, denominator] = if is_upper { [small - large, small + large] } else { [small, large] };
    let series = atan_series(numerator / denominator);
    let first_octant = if is_upper { FRAC_PI_4 + series } else { series };
    let first_quadrant = if y.abs() > x.abs() { FRAC_PI_2 - first_octant } else { first_octant };
    let upper_half = if x < 0.0 { PI - first_quadrant } else { first_quadrant };
    let angle = if y < 0.0 { -upper_half } else { upper_half };
    if large == 0.0 { 0.0 } else { angle }
}

/// tan(π/8) = √2 − 1.
const TAN_PI_8: f64 = SQRT_2 - 1.0;

/// Coefficients 1, −1/3, 1/5 … of the series of arctan, in powers of the square.
const ATAN_COEFFICIENTS: [f64; 12] = [
    1.0,
    -1.0 / 3.0,
    1.0 / 5.0,
    -1.0 / 7.0,
    1.0 / 9.0,
    -1.0 / 11.0,
    1.0 / 13.0,
    -1.0 / 15.0,
    1.0 / 17.0,
    -1.0 / 19.0,
    1.0 / 21.0,
    -1.0 / 23.0,
];

/// arctan for |tan| up to tan(π/8): the first omitted term, t²⁵/25, is below 2⁻³⁶.
#[inline(always)]
fn atan_series(tan: f64) -> f64 {
    let square = tan * tan;
    let sum = ATAN_COEFFICIENTS.iter().rev().fold(0.0, |sum, coefficient| sum * square + coefficient);
    tan * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_agree_with_the_platform_to_36_bits() {
        for step in 0..=7200 {
            let (y, x) = (f64::from(step) / 10.0 - 360.0).to_radians().sin_cos();
            assert!((atan2(y, x) - y.atan2(x)).abs() <= power(-36), "{y} {x}");
        }
        assert_eq!(atan2(0.0, 0.0), 0.0);
        assert_eq!(atan2(0.0, -1.0), PI);
    }

    fn power(exponent: i32) -> f64 {
        2_f64.powi(exponent)
    }

    /// A panorama whose pixel is a function of its direction.
    fn panorama(width: u32, height: u32, colour: impl Fn([f64; 3]) -> [f32; 3]) -> Picture {
        let mut picture = Picture::filled(width, height, [0.0; 3]);
        for (index, pixel) in picture.pixels.iter_mut().enumerate() {
            let u = ((index as u32 % width) as f64 + 0.5) / f64::from(width);
            let v = ((index as u32 / width) as f64 + 0.5) / f64::from(height);
            let (longitude, latitude) = ((u - 0.5) * TAU, (0.5 - v) * PI);
            *pixel = colour([latitude.cos() * longitude.sin(), latitude.sin(), -latitude.cos() * longitude.cos()]);
        }
        picture
    }

    #[test]
    fn each_face_shows_its_axis_in_its_middle_and_its_table_at_its_sides() {
        let map = panorama(256, 128, |d| d.map(|c| (0.5 + 0.5 * c) as f32));
        let faces = faces_from_equirectangular(&map, 32);
        for (face, picture) in faces.iter().enumerate() {
            for (column, row) in [(16, 16), (0, 0), (31, 0), (0, 31), (31, 31), (5, 20)] {
                let coordinate = |index: u32| (f64::from(index) + 0.5) / 16.0 - 1.0;
                let d = direction(face, coordinate(column), coordinate(row));
                let length = d.iter().map(|c| c * c).sum::<f64>().sqrt();
                let pixel = picture.pixels[(row * 32 + column) as usize];
                for (c, got) in d.iter().zip(pixel) {
                    // The mean over a texel and bilinear interpolation each bend by about (2π/256)²/8.
                    let expected = 0.5 + 0.5 * c / length;
                    assert!((f64::from(got) - expected).abs() < 1e-3, "face {face}");
                }
            }
        }
    }

    #[test]
    fn fine_stripes_are_averaged_and_do_not_alias() {
        // Texels of the panorama alternate between black and white, many in a face texel: grey, also around the poles.
        for (width, height, vertical) in [(1024, 512, true), (1024, 512, false)] {
            let mut map = Picture::filled(width, height, [0.0; 3]);
            for (index, pixel) in map.pixels.iter_mut().enumerate() {
                let stripe = index as u32 / if vertical { 1 } else { width };
                *pixel = [(stripe % 2) as f32; 3];
            }
            for face in faces_from_equirectangular(&map, 16) {
                for pixel in face.pixels {
                    // About 10 stripes cross a texel; the partial ones at its ends give up to 5 %.
                    assert!((pixel[0] - 0.5).abs() < 0.05, "{}", pixel[0]);
                }
            }
        }
    }

    #[test]
    fn constant_panoramas_give_constant_faces_at_any_size() {
        for (width, height, edge) in [(1, 1, 1), (2, 1, 5), (64, 32, 3), (7, 300, 8)] {
            let map = Picture::filled(width, height, [0.25, 3.0, 1e-3]);
            for face in faces_from_equirectangular(&map, edge) {
                for pixel in face.pixels {
                    for (got, expected) in pixel.iter().zip([0.25, 3.0, 1e-3]) {
                        // Up to 64² float64 sums, rounded to float32 once.
                        assert!((got - expected).abs() <= expected * f32::EPSILON);
                    }
                }
            }
        }
    }
}
