//! Bump fields: offset vectors to be added to the normal (S97 §7), from heights or from tangent-space normals.
//!
//! An offset is (o_u, o_v) = (n_x/n_z, n_y/n_z) of the tangent-space normal: minus the slope of the height along +u and
//! +v. Heights are differenced centrally; at the edges of a map, [`Edges`] decides. Texels are square on the surface,
//! except in the natural system, whose slopes are taken per unit of u and of v. Coordinates beyond [`OFFSET_LIMIT`] are
//! clamped.

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

/// Neighbours of the texels at the edges of a height map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Edges {
    /// Texels of the opposite edge: the map repeats without a seam.
    #[default]
    Wrapped,
    /// No texels: slopes are one-sided differences, and horizons end at the edge.
    Open,
}

/// Directions that green of a normal map points in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Green {
    /// Towards +v, as in OpenGL and glTF.
    #[default]
    Up,
    /// Towards −v, as in DirectX.
    Down,
}

/// Numbers that the components of a normal map have for −1 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalCoding {
    /// 0 to 1. Maps of 8-bit codes have their zero at 128: (c − 128)/127.
    #[default]
    ZeroAt128,
    /// 0 to 1, 2v − 1 of 8-bit codes, too: no code is zero (glTF 2.0 §3.9.3).
    Gltf,
    /// −1 to 1.
    Signed,
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
    /// Neighbours at the edges.
    pub edges: Edges,
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
    /// Along an axis of one texel the slope is 0. Along a wrapped axis of two texels it is 0 as well.
    pub fn from_heights(heights: &Picture, scale: HeightScale, frame: FrameSystem, edges: Edges) -> (Self, usize) {
        let factor = slope_factor(heights, scale, frame, edges);
        Self::clamped(heights, slopes(heights, frame, edges).map(|slope| slope.map(|slope| (-factor * slope) as f32)))
    }

    /// Makes a field as [`BumpField::from_heights`] does, and keeps the heights.
    pub fn with_heights(picture: &Picture, scale: HeightScale, frame: FrameSystem, edges: Edges) -> (Self, usize) {
        let factor = slope_factor(picture, scale, frame, edges);
        let (field, clamped) = Self::from_heights(picture, scale, frame, edges);
        let [per_u, per_v] = texels_per_unit(picture, frame);
        let rows = picture.pixels.chunks_exact(picture.width as usize).rev();
        let heights = rows.flatten().map(|pixel| (factor * per_u * f64::from(pixel[0])) as f32).collect();
        (Self { heights: Some(HeightField { heights, rows_apart: per_u / per_v, edges }), ..field }, clamped)
    }

    /// Offsets of a tangent-space normal map, and how many were clamped. Red is +u, green as `green` says, blue outwards.
    pub fn from_normals(normals: &Picture, green: Green, coding: NormalCoding) -> (Self, usize) {
        let around_128 = signed_decoder(normals);
        let signed = |component: f32| match coding {
            NormalCoding::ZeroAt128 => around_128(component),
            NormalCoding::Gltf => 2.0 * component - 1.0,
            NormalCoding::Signed => component,
        };
        let (width, height) = (normals.width as usize, normals.height as usize);
        let offsets = (0..height).rev().flat_map(|row| &normals.pixels[row * width..(row + 1) * width]).map(|pixel| {
            let [x, y, z] = pixel.map(signed);
            let length = (x * x + y * y + z * z).sqrt();
            if length == 0.0 {
                return [0.0, 0.0];
            }
            let z = (z / length).max(LEAST_NORMAL_Z);
            let y = if green == Green::Down { -y } else { y };
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
fn slopes(heights: &Picture, frame: FrameSystem, edges: Edges) -> impl Iterator<Item = [f64; 2]> {
    let (width, height) = (heights.width as usize, heights.height as usize);
    let [per_u, per_v] = texels_per_unit(heights, frame);
    let at = move |column: usize, row: usize| f64::from(heights.pixels[row * width + column][0]);
    // Picture rows run down; v runs up.
    (0..height).rev().flat_map(move |row| {
        let ([above, below], per_row) = neighbours(row, height, edges);
        (0..width).map(move |column| {
            let ([left, right], per_column) = neighbours(column, width, edges);
            [
                (at(right, row) - at(left, row)) * per_column * per_u,
                (at(column, above) - at(column, below)) * per_row * per_v,
            ]
        })
    })
}

/// Texels before and after a texel along an axis of `size` texels, and the reciprocal of their distance.
fn neighbours(index: usize, size: usize, edges: Edges) -> ([usize; 2], f64) {
    match edges {
        Edges::Wrapped => ([(index + size - 1) % size, (index + 1) % size], 0.5),
        Edges::Open => {
            let is_edge = index == 0 || index + 1 == size;
            ([index.saturating_sub(1), (index + 1).min(size - 1)], if is_edge { 1.0 } else { 0.5 })
        }
    }
}

/// Factor for the slopes of a picture of height 1.
fn slope_factor(heights: &Picture, scale: HeightScale, frame: FrameSystem, edges: Edges) -> f64 {
    match scale {
        HeightScale::Height(height) => height,
        HeightScale::RmsSlope(wanted) => {
            let sum: f64 = slopes(heights, frame, edges).map(|[u, v]| u * u + v * v).sum();
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
mod tests;
