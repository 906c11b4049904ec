//! Attributes of a fragment from the plane equations of its triangle.
//!
//! The weights eᵢ(x, y) = βᵢ/w (βᵢ barycentric in the plane of the triangle) are linear on the screen and come from the
//! whole triangle by homogeneous cross products, so clipping and snapping change no value. Every attribute is a sum over the
//! three corners: n = Σ eᵢ nᵢ up to one scale per triangle, and aᵢ perspective-correct = Σ eᵢ aᵢ / Σ eᵢ with one
//! integer division per fragment. ∂(u, v) = Σ ∂eᵢ ((u, v)ᵢ − (u, v)) / Σ eᵢ: no two large terms are subtracted.
//! Error: weights 2⁻⁵⁹ of the largest in view, plus float64's rounding in the setup (tests: 2⁻²⁸ of |n|, 1/256 texel).

use fixed::types::U0F32;
use glam::DVec3;
use roughxel_core::ports::{BlockPair, BlockVector};

use super::SUBPIXELS;
use super::camera::{Projection, unit};
use super::clip::ScreenPolygon;
use super::edges::relative_to;
use super::fixed_block::{
    FORM_BITS, FormSlopes, LinearForm, block_pair, block_vector, encode, magnitude_bits, round_shift, scaled_forms,
    slopes_per_pixel,
};

/// Bits of a normalised Σ eᵢ, and of the product with its reciprocal.
const SUM_BITS: u32 = 60;
/// Bits of the integers of [`encode`].
const CODE_BITS: u32 = 52;

/// What the datapath needs to know about one fragment; vectors in world space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FragmentAttributes {
    /// Unnormalised normal: Σ βᵢ nᵢ / w of unit vertex normals, times one power of two per triangle.
    pub normal: BlockVector,
    /// Vector v from the surface to the eye, in pixels of the picture plane; see [`Projection::ray_view`].
    pub view: BlockVector,
    /// p_u and p_v in world units per repeat, perspective-correct.
    pub frame_vectors: [BlockVector; 2],
    /// ∂v/∂x and ∂v/∂y per pixel (y down), in the units of `view`.
    pub dview: [BlockVector; 2],
    /// ∂n/∂x and ∂n/∂y per pixel (y down), in the units of `normal`; constant over the triangle.
    pub dnormal: [BlockVector; 2],
    /// Texture coordinates in repeats, modulo 1, perspective-correct.
    pub uv: [U0F32; 2],
    /// ∂(u, v)/∂x and ∂(u, v)/∂y in repeats per pixel (y down).
    pub duv: [BlockPair; 2],
}

/// Attributes that not every object reads; those that are not read are zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    /// p_u and p_v: S97 systems 1 and 2.
    pub tangents: bool,
    /// u and v: maps.
    pub uv: bool,
    /// Their derivatives: maps with footprints. Not without u and v.
    pub duv: bool,
}

impl Needs {
    /// All.
    pub const ALL: Self = Self { tangents: true, uv: true, duv: true };
}

/// One value at each corner of a triangle, per component: `corner[component][i] · 2^exponent`, 52 bits.
#[derive(Clone, Copy, Debug)]
struct CornerValues<const N: usize> {
    corner: [[i64; 3]; N],
    exponent: i32,
}

impl CornerValues<3> {
    fn from_vectors(corners: [DVec3; 3]) -> Self {
        let components = [0, 1, 2].map(|component| corners.map(|v| v[component]));
        let (codes, exponent) = encode::<9>(flatten(components));
        Self { corner: unflatten(codes), exponent }
    }
}

/// Vectors from a triangle to a point, at its corners: what [`Triangle::direction_to`] interpolates.
#[derive(Clone, Copy, Debug)]
pub struct PointFromTriangle(CornerValues<3>);

/// A triangle with the setup of its attributes.
#[derive(Clone, Debug)]
pub struct Triangle<'a> {
    projection: &'a Projection,
    /// Bounds of the visible part in sub-pixels: `[[left, top], [right, bottom]]`.
    bounds: [[i32; 2]; 2],
    /// Sub-pixel position that the weights' constants belong to.
    reference: [i32; 2],
    corners: [DVec3; 3],
    weights: [LinearForm; 3],
    /// Least value a weight is allowed: zero where the triangle is thinner than snapping moves its edges.
    least_weight: i64,
    slopes: FormSlopes,
    normals: CornerValues<3>,
    dnormal: [BlockVector; 2],
    uv: CornerValues<2>,
    tangents: Option<[CornerValues<3>; 2]>,
    needs: Needs,
}

impl<'a> Triangle<'a> {
    /// Setup from the vertices; `None` when nothing of it can be visible.
    pub(super) fn new(
        projection: &'a Projection,
        vertices: [&roughxel_scene::Vertex; 3],
        needs: Needs,
    ) -> Option<Self> {
        let polygon = ScreenPolygon::new(projection, vertices.map(|v| v.position))?;
        let middle = |span: [i32; 2]| (span[0] + span[1]) / 2;
        let reference_px = [middle(polygon.columns), middle(polygon.rows)];
        let reference = reference_px.map(|px| px * SUBPIXELS);
        let bounds =
            [0, 1].map(|end| [polygon.columns[end], polygon.rows[end]].map(|px| (px + end as i32) * SUBPIXELS));

        let (planes, is_thin) = weight_planes(&polygon, reference_px.map(f64::from));
        let extent =
            [0, 1].map(|axis| f64::from((bounds[1][axis] - reference[axis]).max(reference[axis] - bounds[0][axis])));
        let constant = [[1.0, 0.0, 0.0]; 3];
        let (weights, _) = scaled_forms(planes, extent).or_else(|| scaled_forms(constant, extent))?;
        let slopes = slopes_per_pixel(&weights);

        let normals = CornerValues::from_vectors(vertices.map(|v| unit(v.normal).map_or(DVec3::ZERO, |(n, _)| n)));
        let dnormal = slopes.slope.map(|slope| {
            let derivative = normals.corner.map(|corner| weighted_sum(slope, corner));
            block_vector(derivative, slopes.exponent + normals.exponent)
        });
        Some(Self {
            projection,
            bounds,
            reference,
            corners: vertices.map(|v| v.position),
            weights,
            least_weight: if is_thin { 0 } else { i64::MIN },
            slopes,
            normals,
            dnormal,
            uv: corner_uv(vertices.map(|v| v.uv.to_array())),
            tangents: needs
                .tangents
                .then(|| [0, 1].map(|i| CornerValues::from_vectors(vertices.map(|v| v.tangents[i])))),
            needs,
        })
    }

    /// Attributes at a sample that shows this triangle; position in sub-pixels of 1/256 px from the frame's corner.
    ///
    /// Any position has a result: it is taken to the nearest one within the bounds of the visible part.
    /// Rounding: one to nearest per port word, after integer sums of 2⁻⁵⁹ relative error or better.
    pub fn fragment(&self, x_subpx: i32, y_subpx: i32) -> FragmentAttributes {
        let [[left, top], [right, bottom]] = self.bounds;
        let (x, y) = (x_subpx.clamp(left, right), y_subpx.clamp(top, bottom));
        let (weights, sum) = self.weights_at(x - self.reference[0], y - self.reference[1]);

        let normal = self.normals.corner.map(|corner| weighted_sum(weights, corner));
        let mut fragment = FragmentAttributes {
            normal: block_vector(normal, self.normals.exponent - FORM_BITS),
            view: self.projection.ray_view(x_subpx, y_subpx),
            dview: self.projection.dview(),
            dnormal: self.dnormal,
            ..FragmentAttributes::default()
        };
        if self.needs.uv || self.tangents.is_some() {
            let quotient = Quotient::by(sum);
            if let Some(tangents) = self.tangents {
                fragment.frame_vectors = tangents.map(|tangent| {
                    let codes = tangent.corner.map(|corner| quotient.of(weighted_sum(weights, corner)));
                    block_vector(codes, tangent.exponent - Quotient::EXTRA_BITS as i32)
                });
            }
            if self.needs.uv {
                self.place(weights, &quotient, &mut fragment);
            }
        }
        fragment
    }

    /// Texture coordinates and their derivatives.
    fn place(&self, weights: [i64; 3], quotient: &Quotient, fragment: &mut FragmentAttributes) {
        let exponent = self.uv.exponent;
        let codes = self.uv.corner.map(|corner| quotient.of(weighted_sum(weights, corner)));
        fragment.uv = codes.map(|code| wrapped(code, exponent - Quotient::EXTRA_BITS as i32));
        if self.needs.duv {
            fragment.duv = self.slopes.slope.map(|slope| {
                let rise = [0, 1].map(|component| {
                    let here = round_shift(codes[component], Quotient::EXTRA_BITS) as i64;
                    weighted_sum(slope, self.uv.corner[component].map(|corner| corner - here))
                });
                quotient.of_wide(rise, self.slopes.exponent + exponent + FORM_BITS)
            });
        }
    }

    /// Setup of the directions to a point in the world, once a triangle.
    pub fn point(&self, point: DVec3) -> PointFromTriangle {
        PointFromTriangle(CornerValues::from_vectors(self.corners.map(|corner| point - corner)))
    }

    /// Direction from the surface to a point, at a sample as in [`Self::fragment`]; its length means nothing, for
    /// Σ eᵢ (P − pᵢ) is Σ eᵢ times the vector. Rounding as there.
    pub fn direction_to(&self, point: &PointFromTriangle, x_subpx: i32, y_subpx: i32) -> BlockVector {
        let [[left, top], [right, bottom]] = self.bounds;
        let (x, y) = (x_subpx.clamp(left, right), y_subpx.clamp(top, bottom));
        let (weights, _) = self.weights_at(x - self.reference[0], y - self.reference[1]);
        block_vector(point.0.corner.map(|corner| weighted_sum(weights, corner)), point.0.exponent - FORM_BITS)
    }

    /// Weights at a position relative to the reference, below 2^60 each, and their positive sum.
    ///
    /// On a triangle so thin that all weights vanish at a sample it covers, the corners count alike.
    fn weights_at(&self, x: i32, y: i32) -> ([i64; 3], i64) {
        let weights = self.weights.map(|form| form.at(x, y).max(self.least_weight));
        let sum = weights.iter().sum::<i64>();
        if sum > 0 { (weights, sum) } else { ([1; 3], 3) }
    }
}

/// Plane equations of the weights around a screen point (pixels), `[constant, per sub-pixel x, per sub-pixel y]`, any common scale.
/// Second: whether half a sub-pixel beyond an edge the weights may be wrong by more than an eighth of
/// their sum, because the triangle is seen edge-on or reaches close to its horizon.
fn weight_planes(polygon: &ScreenPolygon, reference_px: [f64; 2]) -> ([[f64; 3]; 3], bool) {
    let [a, b, c] = polygon.corners.map(|corner| relative_to(corner, reference_px));
    let determinant = a.dot(b.cross(c));
    let sign = if determinant < 0.0 { -1.0 } else { 1.0 };
    let planes = [b.cross(c), c.cross(a), a.cross(b)].map(|n| {
        let per_subpixel = sign / f64::from(SUBPIXELS);
        [n.z * sign, n.x * per_subpixel, n.y * per_subpixel]
    });
    let steepest = planes.iter().fold(0.0_f64, |m, p| m.max(p[1].abs() + p[2].abs()));
    let least_sum = determinant.abs() * polygon.inverse_w[0];
    // Written so that a NaN counts as thin.
    let is_thick = steepest <= least_sum / 8.0;
    (planes, !is_thick)
}

/// Texture coordinates of the corners less a whole number of repeats, so that they stay small.
fn corner_uv(corners: [[f64; 2]; 3]) -> CornerValues<2> {
    let components = [0, 1].map(|component| {
        let values = corners.map(|uv| uv[component]);
        let base = (values.iter().sum::<f64>() / 3.0).floor();
        values.map(|value| value - base)
    });
    let (codes, exponent) = encode::<6>(flatten(components));
    CornerValues { corner: unflatten(codes), exponent }
}

/// Σ weight·value; 60 + 53 + 2 bits at most.
fn weighted_sum(weights: [i64; 3], values: [i64; 3]) -> i128 {
    let [a, b, c] = [0, 1, 2].map(|i| i128::from(weights[i]) * i128::from(values[i]));
    a + b + c
}

/// Division of several sums by one Σ eᵢ: a single integer division, then products.
struct Quotient {
    /// 2^120 / (sum · 2^shift), at most 2^61.
    reciprocal: i128,
    /// Brings the sum to [2^59, 2^60).
    shift: i32,
}

impl Quotient {
    /// Fraction bits of [`Quotient::of`].
    const EXTRA_BITS: u32 = 16;

    /// `sum` is positive and below 2^62.
    fn by(sum: i64) -> Self {
        let shift = sum.leading_zeros() as i32 - (i64::BITS - SUM_BITS) as i32;
        let normalised = if shift < 0 { sum >> -shift } else { sum << shift };
        Self { reciprocal: (1_i128 << (2 * SUM_BITS)) / i128::from(normalised), shift }
    }

    /// `numerator / sum` with 16 fraction bits, for a numerator that is a weighted sum of 52-bit codes.
    ///
    /// Saturates at ±2^53 codes; weights within the triangle cannot exceed 2^52.
    fn of(&self, numerator: i128) -> i128 {
        let shift = self.shift - CODE_BITS as i32;
        // |numerator| < 2^116 and shift ≤ 7.
        let aligned = if shift < 0 { round_shift(numerator, shift.unsigned_abs()) } else { numerator << shift };
        let limit = 1 << (SUM_BITS + 1);
        let product = aligned.clamp(-limit, limit) * self.reciprocal;
        round_shift(product, 2 * SUM_BITS - CODE_BITS - Self::EXTRA_BITS)
    }

    /// `numerators · 2^exponent / sum` as a block, for numerators of any size.
    fn of_wide(&self, numerators: [i128; 2], exponent: i32) -> BlockPair {
        let excess = magnitude_bits(&numerators).saturating_sub(SUM_BITS);
        let products = numerators.map(|numerator| round_shift(numerator, excess) * self.reciprocal);
        block_pair(products, exponent + excess as i32 + self.shift - 2 * SUM_BITS as i32)
    }
}

/// `code · 2^exponent` modulo 1, to nearest.
fn wrapped(code: i128, exponent: i32) -> U0F32 {
    let shift = exponent + u32::BITS as i32;
    let bits = match shift {
        ..-120 => 0,
        -120..0 => round_shift(code, shift.unsigned_abs()),
        // A coordinate of 2^64 repeats has no fraction left.
        0..64 => code << shift,
        64.. => 0,
    };
    U0F32::from_bits(bits as u32)
}

fn flatten<const ROWS: usize, const ALL: usize>(rows: [[f64; 3]; ROWS]) -> [f64; ALL] {
    core::array::from_fn(|i| rows[i / 3][i % 3])
}

fn unflatten<const ROWS: usize, const ALL: usize>(values: [i64; ALL]) -> [[i64; 3]; ROWS] {
    core::array::from_fn(|row| core::array::from_fn(|i| values[3 * row + i]))
}
