//! Bump fields: offset vectors to be added to the normal (S97 §7), from heights or from tangent-space normals.
//!
//! An offset is (o_u, o_v) = (n_x/n_z, n_y/n_z) of the tangent-space normal: minus the slope of the height along +u and
//! +v. Heights are differenced centrally, wrapped around both edges. Texels are square on the surface, except in the
//! natural system, whose slopes are taken per unit of u and of v. Coordinates beyond [`OFFSET_LIMIT`] are clamped.

use roughxel_assets::Picture;

/// Largest absolute value of an offset's coordinate: the ports carry I4F28, below 8.
pub const OFFSET_LIMIT: f32 = 8.0 - 1.0 / 1024.0;

/// Smallest z of a unit normal. A steeper normal counts as this steep; its offset is clamped anyway.
const LEAST_NORMAL_Z: f32 = 1.0 / 4096.0;

/// Tangent basis of an offset (S97 §7).
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FrameSystem {
    /// System 3: e₁ = h×n/|h×n|, e₂ = n×e₁ with a main direction h; b = (o_u, o_v).
    MainDirection,
    /// System 1: s_u = n×p_v, s_v = p_u×n; b = −(o_u, o_v), heights in world units, slopes per unit of u and v.
    Natural,
    /// System 2: s_u and s_v of unit length; b = −(o_u, o_v), slopes without a unit.
    NaturalNormalised,
}

/// Offsets of the normal. Row 0 is at v = 0 (the bottom row of the picture); repeat addressing.
#[derive(Clone, Debug, PartialEq)]
pub struct BumpField {
    /// Texels along u.
    pub width: u32,
    /// Texels along v.
    pub height: u32,
    /// (o_u, o_v) row by row, each coordinate within ±[`OFFSET_LIMIT`].
    pub offsets: Vec<[f32; 2]>,
    /// Heights that the offsets come from, if a material asks for their shadows. A normal map has none.
    pub heights: Option<HeightField>,
}

/// Heights of a bump map, in units in which its offsets are their slopes: o_u = −∂h/∂x, o_v = −∂h/∂y. x counts columns; a
/// row is `rows_apart` in y.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    /// Heights in column distances, in the rows of the offsets, not clamped.
    pub heights: Vec<f32>,
    /// Distance between rows over the distance between columns: 1 for square texels. In the natural system both are
    /// parts of a repeat, so it is columns over rows.
    pub rows_apart: f64,
}

/// Height scale of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HeightScale {
    /// Height of 1 above 0: in lengths of a repeat along u, or in world units per repeat for the natural system.
    Height(f64),
    /// Root mean square of the slope's length, for maps whose look counts, not their depth.
    RmsSlope(f64),
}

impl BumpField {
    /// Offsets of a height picture (first channel), and how many were clamped.
    ///
    /// Along an axis of one texel the slope is 0, as the map wraps.
    pub fn from_heights(heights: &Picture, scale: HeightScale, frame: FrameSystem) -> (Self, usize) {
        let factor = slope_factor(heights, scale, frame);
        Self::clamped(heights, slopes(heights, frame).map(|slope| slope.map(|slope| (-factor * slope) as f32)))
    }

    /// Makes a field as [`BumpField::from_heights`] does, and keeps the heights.
    pub fn with_heights(picture: &Picture, scale: HeightScale, frame: FrameSystem) -> (Self, usize) {
        let factor = slope_factor(picture, scale, frame);
        let (field, clamped) = Self::from_heights(picture, scale, frame);
        let [per_u, per_v] = texels_per_unit(picture, frame);
        let rows = picture.pixels.chunks_exact(picture.width as usize).rev();
        let heights = rows.flatten().map(|pixel| (factor * per_u * f64::from(pixel[0])) as f32).collect();
        (Self { heights: Some(HeightField { heights, rows_apart: per_u / per_v }), ..field }, clamped)
    }

    /// Offsets of a tangent-space normal map, and how many were clamped. Red is +u, green +v as in OpenGL, blue
    /// outwards.
    pub fn from_normals(normals: &Picture) -> (Self, usize) {
        let signed = signed_decoder(normals);
        let (width, height) = (normals.width as usize, normals.height as usize);
        let offsets = (0..height).rev().flat_map(|row| &normals.pixels[row * width..(row + 1) * width]).map(|pixel| {
            let [x, y, z] = pixel.map(&signed);
            let length = (x * x + y * y + z * z).sqrt();
            if length == 0.0 {
                return [0.0, 0.0];
            }
            let z = (z / length).max(LEAST_NORMAL_Z);
            [x / length / z, y / length / z]
        });
        Self::clamped(normals, offsets)
    }

    fn clamped(picture: &Picture, offsets: impl Iterator<Item = [f32; 2]>) -> (Self, usize) {
        let mut clamped = 0;
        let offsets = offsets
            .map(|offset| {
                let inside = offset.map(|coordinate| coordinate.clamp(-OFFSET_LIMIT, OFFSET_LIMIT));
                clamped += usize::from(inside != offset);
                inside
            })
            .collect();
        (Self { width: picture.width, height: picture.height, offsets, heights: None }, clamped)
    }
}

/// Texels per unit of the directions in which slopes are taken.
fn texels_per_unit(picture: &Picture, frame: FrameSystem) -> [f64; 2] {
    let [width, height] = [picture.width, picture.height].map(f64::from);
    [width, if frame == FrameSystem::Natural { height } else { width }]
}

/// Slopes of a height picture of height 1 along +u and +v, from the bottom row up.
fn slopes(heights: &Picture, frame: FrameSystem) -> impl Iterator<Item = [f64; 2]> {
    let (width, height) = (heights.width as usize, heights.height as usize);
    let [per_u, per_v] = texels_per_unit(heights, frame);
    let at = move |column: usize, row: usize| f64::from(heights.pixels[row * width + column][0]);
    // Picture rows run down; v runs up.
    (0..height).rev().flat_map(move |row| {
        let (above, below) = ((row + height - 1) % height, (row + 1) % height);
        (0..width).map(move |column| {
            let (left, right) = ((column + width - 1) % width, (column + 1) % width);
            [(at(right, row) - at(left, row)) * 0.5 * per_u, (at(column, above) - at(column, below)) * 0.5 * per_v]
        })
    })
}

/// Factor for the slopes of a picture of height 1.
fn slope_factor(heights: &Picture, scale: HeightScale, frame: FrameSystem) -> f64 {
    match scale {
        HeightScale::Height(height) => height,
        HeightScale::RmsSlope(wanted) => {
            let sum: f64 = slopes(heights, frame).map(|[u, v]| u * u + v * v).sum();
            let rms = (sum / heights.pixels.len() as f64).sqrt();
            if rms > 0.0 { wanted / rms } else { 0.0 }
        }
    }
}

/// Decoder from a value of `picture` to −1…1.
///
/// 8-bit maps mean zero by 128 and ±1 by 128 ± 127, so the usual neutral (128, 128, 255) is exactly flat. Deeper maps
/// run from −1 to 1 over their whole range.
pub(super) fn signed_decoder(picture: &Picture) -> impl Fn(f32) -> f32 + use<> {
    let is_8_bit = picture.pixels.iter().flatten().all(|value| {
        let code = value * 255.0;
        // A 16-bit code that is no 8-bit code is at least 1/257 away; the rounding of value·255 is 2e-5.
        (code - code.round()).abs() < 1e-3
    });
    move |value| if is_8_bit { ((value * 255.0).round() - 128.0) / 127.0 } else { 2.0 * value - 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: u32, height: u32, value: impl Fn(u32, u32) -> [f32; 3]) -> Picture {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| value(x, y)).collect();
        Picture { width, height, pixels }
    }

    #[test]
    fn offsets_are_minus_the_slope_and_v_runs_up() {
        // A tent along u and a tent along v, in eighths.
        let tent = |x: u32| [0.0, 0.125, 0.25, 0.375, 0.5, 0.375, 0.25, 0.125][x as usize];
        let along_u = picture(8, 4, |x, _| [tent(x); 3]);
        let (field, clamped) = BumpField::from_heights(&along_u, HeightScale::Height(0.5), FrameSystem::MainDirection);
        assert_eq!(clamped, 0);
        assert_eq!(field.offsets[1], [-0.5, 0.0]);
        assert_eq!(field.offsets[5], [0.5, 0.0]);
        let along_v = picture(8, 8, |_, y| [tent(7 - y); 3]);
        let (field, _) = BumpField::from_heights(&along_v, HeightScale::Height(0.5), FrameSystem::MainDirection);
        assert_eq!(field.offsets[8], [0.0, -0.5], "row 1 from the bottom climbs with v");
    }

    #[test]
    fn differences_wrap_around_both_edges() {
        let spike = picture(4, 4, |x, y| [if (x, y) == (0, 0) { 1.0 } else { 0.0 }; 3]);
        let (field, _) = BumpField::from_heights(&spike, HeightScale::Height(0.5), FrameSystem::MainDirection);
        assert_eq!(field.offsets[3 * 4 + 3], [-1.0, 0.0], "left of the spike, through the seam");
        assert_eq!(field.offsets[0], [0.0, 1.0], "above the spike, through the seam");
    }

    #[test]
    fn the_natural_system_takes_slopes_per_unit_of_v() {
        let tall = picture(2, 8, |_, y| [if y == 7 { 0.125 } else { 0.0 }; 3]);
        let (square, _) = BumpField::from_heights(&tall, HeightScale::Height(1.0), FrameSystem::NaturalNormalised);
        let (natural, _) = BumpField::from_heights(&tall, HeightScale::Height(1.0), FrameSystem::Natural);
        assert_eq!(square.offsets[2], [0.0, 0.125]);
        assert_eq!(natural.offsets[2], [0.0, 0.5]);
    }

    const FRAMES: [FrameSystem; 3] = [FrameSystem::MainDirection, FrameSystem::Natural, FrameSystem::NaturalNormalised];

    /// One smooth hill a repeat, for maps of any shape.
    fn hill(width: u32, height: u32) -> Picture {
        let wave = |place: u32, size: u32| (std::f64::consts::TAU * f64::from(place) / f64::from(size)).cos();
        picture(width, height, |x, y| [(0.5 + 0.2 * wave(x, width) + 0.3 * wave(y + 2, height)) as f32; 3])
    }

    /// The hill in all shapes, bases and scales.
    fn kept_hills() -> impl Iterator<Item = (FrameSystem, BumpField)> {
        [(24, 24), (40, 16), (12, 60)].into_iter().flat_map(|(width, height)| {
            FRAMES.into_iter().flat_map(move |frame| {
                let scales = [HeightScale::Height(0.3), HeightScale::Height(-0.07), HeightScale::RmsSlope(0.4)];
                let field = move |scale| BumpField::with_heights(&hill(width, height), scale, frame);
                scales.into_iter().map(field).map(move |(field, clamped)| {
                    assert_eq!(clamped, 0);
                    (frame, field)
                })
            })
        })
    }

    #[test]
    fn heights_and_offsets_are_one_surface_in_every_frame_and_shape() {
        for (frame, field) in kept_hills() {
            let (width, height) = (field.width as usize, field.height as usize);
            let HeightField { heights, rows_apart } = field.heights.as_ref().unwrap();
            let is_natural = frame == FrameSystem::Natural;
            assert_eq!(*rows_apart, if is_natural { width as f64 / height as f64 } else { 1.0 });
            let at = |x: usize, y: usize| f64::from(heights[y % height * width + x % width]);
            let highest = heights.iter().fold(0.0_f32, |most, height| most.max(height.abs()));
            for (index, offset) in field.offsets.iter().enumerate() {
                let (x, y) = (index % width, index / width);
                let slopes = [
                    0.5 * (at(x + 1, y) - at(x + width - 1, y)),
                    0.5 * (at(x, y + 1) - at(x, y + height - 1)) / rows_apart,
                ];
                for (offset, slope) in offset.iter().zip(slopes) {
                    // Two heights rounded to f32, and the offset.
                    let rounding = f64::from(f32::EPSILON * highest) * (1.0 + 1.0 / rows_apart);
                    assert!((f64::from(*offset) + slope).abs() <= rounding, "{frame:?} {offset} {slope}");
                }
            }
        }
    }

    #[test]
    fn a_map_one_texel_wide_or_high_has_no_slope_along_that_axis() {
        for (frame, (width, height)) in FRAMES.into_iter().zip([(1, 1), (1, 6), (6, 1)]) {
            let bumpy = picture(width, height, |x, y| [((x + y) % 3) as f32 * 0.1 + 0.5; 3]);
            let (field, _) = BumpField::with_heights(&bumpy, HeightScale::Height(0.5), frame);
            assert!(field.offsets.iter().all(|[u, v]| (width > 1 || *u == 0.0) && (height > 1 || *v == 0.0)));
            assert_eq!(field.offsets.iter().any(|offset| *offset != [0.0; 2]), width * height > 1);
        }
    }

    #[test]
    fn an_rms_slope_is_met_and_a_flat_map_stays_flat() {
        let waves = picture(16, 16, |x, y| [((x * 7 + y * 3) % 16) as f32 / 16.0; 3]);
        let (field, _) = BumpField::from_heights(&waves, HeightScale::RmsSlope(0.25), FrameSystem::MainDirection);
        let mean: f32 = field.offsets.iter().map(|[u, v]| u * u + v * v).sum::<f32>() / 256.0;
        // f32 rounding of 256 squares.
        assert!((mean.sqrt() - 0.25).abs() < 1e-6);
        let flat = picture(4, 4, |_, _| [0.5; 3]);
        let (field, _) = BumpField::from_heights(&flat, HeightScale::RmsSlope(0.25), FrameSystem::MainDirection);
        assert!(field.offsets.iter().all(|offset| *offset == [0.0; 2]));
    }

    #[test]
    fn the_neutral_8_bit_normal_is_exactly_flat_and_16_bit_uses_its_whole_range() {
        let neutral = picture(2, 2, |_, _| [128.0 / 255.0, 128.0 / 255.0, 1.0]);
        assert!(BumpField::from_normals(&neutral).0.offsets.iter().all(|offset| *offset == [0.0; 2]));
        let deep = picture(1, 1, |_, _| [49_152.0 / 65_535.0, 0.5, 0.75]);
        let (field, _) = BumpField::from_normals(&deep);
        // Half a 16-bit code.
        assert!((field.offsets[0][0] - 1.0).abs() < 1e-4 && field.offsets[0][1] == 0.0);
    }

    #[test]
    fn normals_pointing_inwards_are_clamped_and_counted() {
        let inwards = picture(2, 1, |x, _| if x == 0 { [1.0, 0.5, 0.2] } else { [0.0; 3] });
        let (field, clamped) = BumpField::from_normals(&inwards);
        assert_eq!(clamped, 2);
        assert!(field.offsets.iter().flatten().all(|coordinate| coordinate.abs() <= OFFSET_LIMIT));
        assert_eq!(field.offsets[0][0], OFFSET_LIMIT);
    }
}
