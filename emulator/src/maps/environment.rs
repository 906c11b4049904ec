//! Environment maps: six faces with mip levels, neighbours across edges, and faces from an equirectangular picture.
//!
//! Faces in Vulkan's order +x, −x, +y, −y, +z, −z with Vulkan's (s_c, t_c); column 0 at s = −1, row 0 at t = −1 (the top row
//! of the face's picture, no flip). All faces and levels share one exponent, so probes may mix them as integers.
//! Each face is filtered for itself: a texel next to an edge holds its own side only, and the filter looks across the
//! edge ([`texel_across_edge`]). Resampling averages a grid of bilinear samples no further apart than one texel of the
//! equirectangular picture (at most 64×64, which only texels around the poles reach), so it cannot alias. Its
//! angles come from a fixed series and correctly rounded operations: the same faces on every machine.

use crate::maps::mip::{Level, colour_levels, quantise, smallest_exponent};
use crate::picture::Picture;
use rayon::prelude::*;

/// One axis of a face's coordinates: index into (x, y, z) and sign.
type SignedAxis = (usize, i32);

/// Vulkan's table per face: the axes of s_c, t_c and of the major component m.
const FACE_AXES: [[SignedAxis; 3]; 6] = [
    [(2, -1), (1, -1), (0, 1)],
    [(2, 1), (1, -1), (0, -1)],
    [(0, 1), (2, 1), (1, 1)],
    [(0, 1), (2, -1), (1, -1)],
    [(0, 1), (1, -1), (2, 1)],
    [(0, -1), (1, -1), (2, -1)],
];

/// An environment map with its mip levels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CubePyramid {
    /// Edge of a face at level 0, in texels.
    pub edge: u32,
    /// Level 0 (full size) first, down to 1×1; six faces each, row 0 at t = −1.
    pub levels: Vec<[Level; 6]>,
    /// Value of a code: code / 65536 · 2^exponent, one exponent for all faces.
    pub exponent: i32,
}

impl CubePyramid {
    /// Quantises six faces to 16 bits with the [`smallest_exponent`] that holds their maximum, and builds all levels.
    ///
    /// Rounding: as [`ColourPyramid::new`](crate::maps::mip::ColourPyramid::new).
    ///
    /// # Panics
    /// If the faces are not squares of one size of at least 1, with all their pixels.
    pub fn new(faces: &[Picture; 6]) -> Self {
        Self::with_exponent(faces, smallest_exponent(faces))
    }

    /// As [`CubePyramid::new`], with a given exponent; brighter pixels than 2^exponent saturate to code 65535.
    ///
    /// # Panics
    /// If the faces are not squares of one size of at least 1, with all their pixels.
    pub fn with_exponent(faces: &[Picture; 6], exponent: i32) -> Self {
        let edge = faces[0].width;
        assert!(
            faces.iter().all(|face| edge > 0 && (face.width, face.height) == (edge, edge)),
            "an environment needs six square faces of one size"
        );
        let mut pyramids = faces.each_ref().map(|face| {
            let texels = face.pixels.iter().map(|pixel| quantise(*pixel, exponent));
            colour_levels(edge, edge, texels.collect()).into_iter()
        });
        let mut levels = Vec::new();
        while let [Some(a), Some(b), Some(c), Some(d), Some(e), Some(f)] = pyramids.each_mut().map(Iterator::next) {
            levels.push([a, b, c, d, e, f]);
        }
        Self { edge, levels, exponent }
    }
}

/// A texel of a cube map level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FaceTexel {
    /// Face in Vulkan's order, 0…5.
    pub face: u8,
    /// Column, from s = −1.
    pub i: u32,
    /// Row, from t = −1.
    pub j: u32,
}

/// What lies at a texel address of a face that may be one step outside of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CubeTexel {
    /// A texel of this face or of the one across an edge.
    Texel(FaceTexel),
    /// Diagonally outside, where no texel is: the three texels around the corner, the face's own first, then those
    /// across its s and t edges. The filter takes their mean (three equal texels give that value).
    Corner([FaceTexel; 3]),
}

/// The texel at column `i` and row `j` of a face of `edge` × `edge` texels, with i or j in {−1, edge} across the edge.
///
/// Integers only, no division. With the cube's centre at the origin and units of half a texel, the texel's centre is the
/// vector (s, t, m) = (2i + 1 − edge, 2j + 1 − edge, edge). Folding it over the edge makes the component that is outside the new
/// major one, ±edge, and the old major one edge − 1, the centre of the first row of texels behind the edge. The map is
/// an involution on every edge. Range: edge 1…16384; a face above 5 counts as 5,
/// a position further outside as one step outside.
pub fn texel_across_edge(face: u8, i: i32, j: i32, edge: u32) -> CubeTexel {
    let face = usize::from(face).min(5);
    let edge = edge as i32;
    let (i_inside, j_inside) = (i.clamp(0, edge - 1), j.clamp(0, edge - 1));
    let own = FaceTexel { face: face as u8, i: i_inside as u32, j: j_inside as u32 };
    let across_s = || fold([i, j_inside], 0, face, edge);
    let across_t = || fold([i_inside, j], 1, face, edge);
    match (i == i_inside, j == j_inside) {
        (true, true) => CubeTexel::Texel(own),
        (false, true) => CubeTexel::Texel(across_s()),
        (true, false) => CubeTexel::Texel(across_t()),
        (false, false) => CubeTexel::Corner([own, across_s(), across_t()]),
    }
}

/// The texel behind the edge that `position[outside]` is beyond (outside: 0 = s, 1 = t).
fn fold(position: [i32; 2], outside: usize, face: usize, edge: i32) -> FaceTexel {
    let [s, t] = position.map(|index| 2 * index + 1 - edge);
    let mut local = [s, t, edge - 1];
    local[outside] = if local[outside] < 0 { -edge } else { edge };
    let mut vector = [0; 3];
    for ((axis, sign), component) in FACE_AXES[face].into_iter().zip(local) {
        vector[axis] = sign * component;
    }
    let (major, _) = FACE_AXES[face][outside];
    let face = 2 * major + usize::from(vector[major] < 0);
    let [column, row, _] = FACE_AXES[face].map(|(axis, sign)| sign * vector[axis]);
    FaceTexel { face: face as u8, i: ((column + edge - 1) >> 1) as u32, j: ((row + edge - 1) >> 1) as u32 }
}

/// Most samples a face texel takes along an axis.
const MOST_SAMPLES: f64 = 64.0;

/// Resamples an equirectangular panorama to six cube faces of `face_edge` (at least 1) pixels.
///
/// Directions: +y is up; the centre of the panorama looks along −z and u grows to the right, so that a quarter to the
/// right of the centre is +x, a quarter to the left −x, and the left and right borders meet at +z. Rows run from +y (top)
/// to −y. Linear light in and out; every face pixel is the mean over its area, weighted evenly in (s, t).
///
/// # Panics
/// If `panorama` has no pixels, or not `width · height` of them.
pub fn faces_from_equirectangular(panorama: &Picture, face_edge: u32) -> [Picture; 6] {
    let edge = face_edge.max(1);
    std::array::from_fn(|face| {
        let mut picture = Picture::filled(edge, edge, [0.0; 3]);
        picture.pixels.par_chunks_mut(edge as usize).enumerate().for_each(|(row, pixels)| {
            for (column, pixel) in pixels.iter_mut().enumerate() {
                *pixel = resample(panorama, face, column, row, edge);
            }
        });
        picture
    })
}

/// Mean of the panorama over one texel of a face.
fn resample(panorama: &Picture, face: usize, column: usize, row: usize, edge: u32) -> [f32; 3] {
    let texel = 2.0 / f64::from(edge);
    let coordinate = |index: usize, offset: f64| (index as f64 + offset) * texel - 1.0;
    let [x, y, z] = direction(face, coordinate(column, 0.5), coordinate(row, 0.5));
    // The span of the texel in texels of the panorama: texel / |d| radians along a meridian, texel / ρ along a circle
    // of latitude, with ρ the distance from the axis at the texel's nearest point, but for the pole itself.
    let from_axis = (x * x + z * z).sqrt();
    let nearest = (from_axis - texel).max(0.5 * texel);
    let columns = texel / nearest * f64::from(panorama.width) / std::f64::consts::TAU;
    let length = (from_axis * from_axis + y * y).sqrt();
    let rows = texel / length * f64::from(panorama.height) / std::f64::consts::PI;
    let samples = columns.max(rows).ceil().clamp(2.0, MOST_SAMPLES);

    let step = 1.0 / samples;
    let count = samples as usize;
    let mut sum = [0.0; 3];
    for j in 0..count {
        let t = coordinate(row, (j as f64 + 0.5) * step);
        for i in 0..count {
            let s = coordinate(column, (i as f64 + 0.5) * step);
            let colour = bilinear(panorama, position(direction(face, s, t)));
            for (sum, channel) in sum.iter_mut().zip(colour) {
                *sum += channel;
            }
        }
    }
    sum.map(|sum| (sum * step * step) as f32)
}

/// The direction of (s, t) on the cube of half edge 1.
fn direction(face: usize, s: f64, t: f64) -> [f64; 3] {
    let mut vector = [0.0; 3];
    for ((axis, sign), component) in FACE_AXES[face].into_iter().zip([s, t, 1.0]) {
        vector[axis] = f64::from(sign) * component;
    }
    vector
}

/// Position of a direction in the panorama, both 0…1: 0 at the left border and at the top.
fn position([x, y, z]: [f64; 3]) -> [f64; 2] {
    let longitude = atan2(x, -z) / std::f64::consts::TAU;
    let latitude = atan2(y, (x * x + z * z).sqrt()) / std::f64::consts::PI;
    [0.5 + longitude, 0.5 - latitude]
}

/// Bilinear sample; columns wrap around, rows end at the poles.
fn bilinear(panorama: &Picture, [u, v]: [f64; 2]) -> [f64; 3] {
    let (width, height) = (panorama.width as usize, panorama.height as usize);
    let x = u * f64::from(panorama.width) - 0.5;
    let y = (v * f64::from(panorama.height) - 0.5).clamp(0.0, (height - 1) as f64);
    let (left, top) = (x.floor(), y.floor());
    let (right_weight, bottom_weight) = (x - left, y - top);
    // x lies within −½…width − ½, so only the columns −1 and width are to be wrapped.
    let first = if left < 0.0 { width - 1 } else { left as usize };
    let columns = [first, if first + 1 == width { 0 } else { first + 1 }];
    let rows = [top as usize, (top as usize + 1).min(height - 1)];
    let pixel = |i: usize, j: usize| panorama.pixels[rows[j] * width + columns[i]].map(f64::from);
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
fn atan2(y: f64, x: f64) -> f64 {
    let (small, large) = (y.abs().min(x.abs()), y.abs().max(x.abs()));
    if large == 0.0 {
        return 0.0;
    }
    // arctan(a/b) = π/4 + arctan((a − b)/(a + b)) brings the upper half of the octant to the lower.
    let first_octant = if small > TAN_PI_8 * large {
        std::f64::consts::FRAC_PI_4 + atan_series((small - large) / (small + large))
    } else {
        atan_series(small / large)
    };
    let first_quadrant = if y.abs() > x.abs() { std::f64::consts::FRAC_PI_2 - first_octant } else { first_octant };
    let upper_half = if x < 0.0 { std::f64::consts::PI - first_quadrant } else { first_quadrant };
    if y < 0.0 { -upper_half } else { upper_half }
}

/// tan(π/8) = √2 − 1.
const TAN_PI_8: f64 = std::f64::consts::SQRT_2 - 1.0;

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

/// arctan for |tan| up to tan(π/8): the first term left out, t²⁵/25, is below 2⁻³⁶.
fn atan_series(tan: f64) -> f64 {
    let square = tan * tan;
    let sum = ATAN_COEFFICIENTS.iter().rev().fold(0.0, |sum, coefficient| sum * square + coefficient);
    tan * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    const EDGES: [u32; 5] = [1, 2, 3, 8, 13];

    /// Centre of a texel in space, in units of half a texel.
    fn centre(texel: FaceTexel, edge: u32) -> [i32; 3] {
        let edge = edge as i32;
        let local = [2 * texel.i as i32 + 1 - edge, 2 * texel.j as i32 + 1 - edge, edge];
        let mut vector = [0; 3];
        for ((axis, sign), component) in FACE_AXES[usize::from(texel.face)].into_iter().zip(local) {
            vector[axis] = sign * component;
        }
        vector
    }

    fn distance_squared(a: [i32; 3], b: [i32; 3]) -> i32 {
        a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
    }

    fn all_texels(edge: u32) -> impl Iterator<Item = FaceTexel> {
        (0..6).flat_map(move |face| (0..edge).flat_map(move |j| (0..edge).map(move |i| FaceTexel { face, i, j })))
    }

    /// Steps (di, dj) from a texel to the four sides, with what lies there.
    fn steps(texel: FaceTexel, edge: u32) -> [(i32, i32, CubeTexel); 4] {
        [(-1, 0), (1, 0), (0, -1), (0, 1)].map(|(di, dj)| {
            let (i, j) = (texel.i as i32 + di, texel.j as i32 + dj);
            (di, dj, texel_across_edge(texel.face, i, j, edge))
        })
    }

    #[test]
    fn the_texel_across_an_edge_is_the_nearest_one_of_the_other_faces() {
        for edge in EDGES {
            for texel in all_texels(edge) {
                for (di, dj, neighbour) in steps(texel, edge) {
                    let CubeTexel::Texel(neighbour) = neighbour else {
                        panic!("a step to the side never meets a corner")
                    };
                    assert!(neighbour.i < edge && neighbour.j < edge);
                    if neighbour.face == texel.face {
                        continue;
                    }
                    // The middle of the shared edge of the two squares.
                    let here = centre(texel, edge);
                    let [(s, s_sign), (t, t_sign), _] = FACE_AXES[usize::from(texel.face)];
                    let mut border = here;
                    border[s] += s_sign * di;
                    border[t] += t_sign * dj;
                    let nearest = all_texels(edge)
                        .filter(|other| other.face != texel.face)
                        .min_by_key(|other| distance_squared(centre(*other, edge), border));
                    assert_eq!(nearest, Some(neighbour), "{texel:?} {di} {dj}, edge {edge}");
                    assert_eq!(distance_squared(centre(neighbour, edge), border), 1);
                    assert_eq!(distance_squared(centre(neighbour, edge), here), 2);
                }
            }
        }
    }

    #[test]
    fn going_across_an_edge_and_back_returns_to_the_texel() {
        for edge in EDGES {
            for texel in all_texels(edge) {
                let neighbours = steps(texel, edge).map(|(.., neighbour)| neighbour);
                for (index, neighbour) in neighbours.iter().enumerate() {
                    assert!(!neighbours[..index].contains(neighbour), "four different ones");
                    let CubeTexel::Texel(neighbour) = *neighbour else {
                        panic!("a step to the side never meets a corner")
                    };
                    let back =
                        steps(neighbour, edge).iter().filter(|(.., there)| *there == CubeTexel::Texel(texel)).count();
                    assert_eq!(back, 1, "{texel:?} → {neighbour:?}, edge {edge}");
                }
            }
        }
    }

    #[test]
    fn corners_name_the_three_texels_that_touch_them() {
        for edge in EDGES {
            let last = edge as i32;
            let mut corners = Vec::new();
            for face in 0..6 {
                for (i, j) in [(-1, -1), (last, -1), (-1, last), (last, last)] {
                    let CubeTexel::Corner(texels) = texel_across_edge(face, i, j, edge) else {
                        panic!("both coordinates are outside")
                    };
                    assert_eq!(texels[0].face, face);
                    let faces: std::collections::BTreeSet<_> = texels.iter().map(|texel| texel.face).collect();
                    assert_eq!(faces.len(), 3);
                    // The corner of the cube next to which all three centres lie, at distance √2.
                    let [(s, s_sign), (t, t_sign), (m, m_sign)] = FACE_AXES[usize::from(face)];
                    let mut corner = [0; 3];
                    corner[s] = s_sign * i.signum() * last;
                    corner[t] = t_sign * j.signum() * last;
                    corner[m] = m_sign * last;
                    for texel in texels {
                        assert_eq!(distance_squared(centre(texel, edge), corner), 2);
                    }
                    let mut set = texels.map(|texel| (texel.face, texel.i, texel.j));
                    set.sort_unstable();
                    corners.push((corner, set));
                }
            }
            // Each of the eight corners is the same three texels from all three faces.
            corners.sort_unstable();
            corners.dedup();
            assert_eq!(corners.len(), 8);
        }
    }

    #[test]
    fn texels_inside_are_themselves_and_far_positions_are_total() {
        let inside = FaceTexel { face: 3, i: 2, j: 5 };
        assert_eq!(texel_across_edge(3, 2, 5, 8), CubeTexel::Texel(inside));
        assert_eq!(texel_across_edge(3, 2, -100, 8), texel_across_edge(3, 2, -1, 8));
        assert_eq!(texel_across_edge(200, 0, 0, 1), texel_across_edge(5, 0, 0, 1));
    }

    #[test]
    fn angles_agree_with_the_platform_to_36_bits() {
        for step in 0..=7200 {
            let (y, x) = (f64::from(step) / 10.0 - 360.0).to_radians().sin_cos();
            assert!((atan2(y, x) - y.atan2(x)).abs() <= power(-36), "{y} {x}");
        }
        assert_eq!(atan2(0.0, 0.0), 0.0);
        assert_eq!(atan2(0.0, -1.0), std::f64::consts::PI);
    }

    fn power(exponent: i32) -> f64 {
        crate::maps::power_of_two(exponent)
    }

    /// A panorama whose pixel is a function of its direction.
    fn panorama(width: u32, height: u32, colour: impl Fn([f64; 3]) -> [f32; 3]) -> Picture {
        let mut picture = Picture::filled(width, height, [0.0; 3]);
        for (index, pixel) in picture.pixels.iter_mut().enumerate() {
            let u = ((index as u32 % width) as f64 + 0.5) / f64::from(width);
            let v = ((index as u32 / width) as f64 + 0.5) / f64::from(height);
            let (longitude, latitude) = ((u - 0.5) * std::f64::consts::TAU, (0.5 - v) * std::f64::consts::PI);
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
                    // The mean over a texel and bilinear interpolation both bend by about (2π/256)²/8.
                    let expected = 0.5 + 0.5 * c / length;
                    assert!((f64::from(got) - expected).abs() < 1e-3, "face {face}");
                }
            }
        }
    }

    #[test]
    fn fine_stripes_are_averaged_and_do_not_alias() {
        // One texel black, one white in the panorama, many of them in a face texel: grey, also around the poles.
        for (width, height, vertical) in [(1024, 512, true), (1024, 512, false)] {
            let mut map = Picture::filled(width, height, [0.0; 3]);
            for (index, pixel) in map.pixels.iter_mut().enumerate() {
                let stripe = index as u32 / if vertical { 1 } else { width };
                *pixel = [(stripe % 2) as f32; 3];
            }
            for face in faces_from_equirectangular(&map, 16) {
                for pixel in face.pixels {
                    // Some 10 stripes cross a texel; the partial ones at its ends give up to 5 %.
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

    #[test]
    fn a_cube_pyramid_keeps_the_rows_of_its_pictures_and_one_exponent() {
        let mut faces: [Picture; 6] = std::array::from_fn(|face| Picture::filled(6, 6, [face as f32 / 8.0; 3]));
        faces[2].pixels[0] = [3.0; 3];
        let cube = CubePyramid::new(&faces);
        assert_eq!((cube.edge, cube.exponent), (6, 2));
        let edges: Vec<_> = cube.levels.iter().map(|level| level[5].height).collect();
        assert_eq!(edges, [6, 3, 1]);
        assert_eq!(cube.levels[0][2].texel(0, 0), [49152; 3]);
        assert_eq!(cube.levels[2][4].texel(0, 0), [8192; 3]);
    }
}
