//! Attributes of fragments from the plane equations of their triangle.
//!
//! The weights eᵢ(x, y) = βᵢ/w (βᵢ barycentric in the plane of the triangle) are linear on the screen. They come from the whole
//! triangle by homogeneous cross products, so clipping and snapping change no value. Every attribute is a sum over the three
//! corners: n = Σ eᵢ nᵢ up to one scale per triangle, and perspective-correct a = Σ eᵢ aᵢ / Σ eᵢ with one division per fragment.
//! ∂(u, v) = Σ ∂eᵢ ((u, v)ᵢ − (u, v)) / Σ eᵢ subtracts no two large terms. An attribute that is equal at all corners is constant,
//! without a sum. The normal of a flat triangle does not turn, so its ∂n is zero. ∂(Σ eᵢ nᵢ) = n·∂(Σ eᵢ) would be the change of
//! its length with the distance, which bumps would turn into a footprint.
//!
//! All operations are float64 with correctly rounded +, −, × and ÷, none of them fused, up to sixteen fragments at a time: the
//! same bits on every machine. Error: weights 2⁻⁵¹ of the largest in view (tests: 2⁻²⁸ of |n|, 1/256 texel).

use fixed::types::U0F32;
use glam::DVec3;
use roughxel_core::ports::BlockVector;
use roughxel_shader::{AttributeRows, BlockRows, Derivatives, FragmentAttributes, Needs, same_rows};
use roughxel_simd::LANES;

use super::SUBPIXELS;
use super::blocks::{Positions, block, block_rows, derivatives, port, scaled, turns};
use super::camera::{Projection, unit};
use super::clip::ScreenPolygon;
use super::edges::relative_to;

/// The largest number below 1 in the narrowest words, which keep 12 fraction bits.
const LARGEST: f64 = 1.0 - 1.0 / 4096.0;

/// The values of one component at the three corners.
type Corners = [f64; 3];

/// A vector at each corner of a triangle, by component, in units of 2^exponent; components are below 2.
#[derive(Clone, Copy, Debug)]
struct CornerVectors {
    components: [Corners; 3],
    exponent: i32,
}

impl CornerVectors {
    fn new(corners: [DVec3; 3]) -> Self {
        let components = [0, 1, 2].map(|component| corners.map(|v| v[component]));
        let (flat, exponent) = scaled::<9>(core::array::from_fn(|i| components[i / 3][i % 3]));
        Self { components: core::array::from_fn(|row| core::array::from_fn(|i| flat[3 * row + i])), exponent }
    }

    #[inline(always)]
    fn at(&self, weights: Corners) -> [f64; 3] {
        let [x, y, z] = &self.components;
        [weighted_sum(weights, x), weighted_sum(weights, y), weighted_sum(weights, z)]
    }
}

/// A vector over a triangle.
#[derive(Clone, Copy, Debug)]
enum VectorOverTriangle {
    /// The vector of every corner.
    Same(BlockVector),
    /// A sum by the weights of the corners.
    Sum(CornerVectors),
}

impl VectorOverTriangle {
    fn new(corners: [DVec3; 3]) -> Self {
        let vectors = CornerVectors::new(corners);
        let [first, rest @ ..] = corners;
        if rest != [first; 2] {
            return Self::Sum(vectors);
        }
        Self::Same(port(block(vectors.components.map(|component| component[0]), vectors.exponent)))
    }

    /// Builds vectors of free length. If all corners are equal, the largest component becomes [`LARGEST`], so that narrow words
    /// hold most of the vectors.
    fn of_free_length(corners: [DVec3; 3]) -> Self {
        let largest = corners[0].abs().max_element();
        let is_same = corners == [corners[0]; 3] && largest > 0.0;
        Self::new(if is_same { corners.map(|corner| corner * (LARGEST / largest)) } else { corners })
    }

    /// The vector at these weights, times `factor`: the reciprocal of the weights' sum, or any number if the length does not
    /// count.
    fn at(&self, weights: Corners, factor: f64) -> BlockVector {
        match self {
            Self::Same(vector) => *vector,
            Self::Sum(vectors) => port(block(scale(vectors.at(weights), factor), vectors.exponent)),
        }
    }

    /// Rows of [`LANES`] samples; `of` computes their values from the corners.
    #[inline(always)]
    fn rows(&self, of: impl Fn(&CornerVectors, usize) -> [f64; 3]) -> BlockRows<3> {
        match self {
            Self::Same(vector) => same_rows(vector),
            Self::Sum(vectors) => block_rows(vectors.exponent, |lane| of(vectors, lane)),
        }
    }

    /// The derivative by one of the weights' slopes; its length does not count.
    fn slope(&self, slope: Corners) -> BlockVector {
        match self {
            Self::Same(_) => BlockVector::default(),
            Self::Sum(vectors) => port(block(vectors.at(slope), vectors.exponent)),
        }
    }
}

/// Vectors from a triangle to a point, at its corners; [`Triangle::direction_to`] interpolates them.
#[derive(Clone, Copy, Debug)]
pub struct PointFromTriangle(CornerVectors);

/// A linear function on the screen: constant, per sub-pixel x, per sub-pixel y.
type Plane = [f64; 3];

/// A triangle with the setup of its attributes.
#[derive(Clone, Debug)]
pub struct Triangle<'a> {
    projection: &'a Projection,
    /// Bounds of the visible part in sub-pixels: `[[left, top], [right, bottom]]`.
    bounds: [[i32; 2]; 2],
    /// Sub-pixel position of the weights' constants.
    reference: [i32; 2],
    corners: [DVec3; 3],
    /// Planes of the weights, of one scale: below 2 in view.
    weights: [Plane; 3],
    /// Least allowed weight: zero if the triangle is thinner than the distance by which snapping moves its edges.
    least_weight: f64,
    /// Slopes of the weights, per pixel.
    slopes: [Corners; 2],
    normals: VectorOverTriangle,
    dnormal: [BlockVector; 2],
    /// Texture coordinates less a whole number of wraps.
    uv: [Corners; 2],
    tangents: Option<[VectorOverTriangle; 2]>,
    needs: Needs,
}

impl<'a> Triangle<'a> {
    /// Setup from the vertices; `None` if nothing of the triangle can be visible.
    pub(super) fn new(
        projection: &'a Projection,
        vertices: [&roughxel_assets::Vertex; 3],
        needs: Needs,
    ) -> Option<Self> {
        let polygon = ScreenPolygon::new(projection, vertices.map(|v| v.position))?;
        let middle = |span: [i32; 2]| (span[0] + span[1]) / 2;
        let reference_px = [middle(polygon.columns), middle(polygon.rows)];
        let reference = reference_px.map(|px| px * SUBPIXELS);
        let bounds =
            [0, 1].map(|end| [polygon.columns[end], polygon.rows[end]].map(|px| (px + end as i32) * SUBPIXELS));

        let (planes, is_thin) = weight_planes(&polygon, reference_px.map(f64::from));
        let weights = scaled_planes(planes, bounds, reference)?;
        let slopes = [1, 2].map(|axis| weights.map(|plane| plane[axis] * f64::from(SUBPIXELS)));

        let normals =
            VectorOverTriangle::of_free_length(vertices.map(|v| unit(v.normal).map_or(DVec3::ZERO, |(n, _)| n)));
        let dnormal = slopes.map(|slope| normals.slope(slope));
        Some(Self {
            projection,
            bounds,
            reference,
            corners: vertices.map(|v| v.position),
            weights,
            least_weight: if is_thin { 0.0 } else { f64::NEG_INFINITY },
            slopes,
            normals,
            dnormal,
            uv: corner_uv(vertices.map(|v| v.uv.to_array())),
            tangents: needs.tangents.then(|| [0, 1].map(|i| VectorOverTriangle::new(vertices.map(|v| v.tangents[i])))),
            needs,
        })
    }

    /// Attributes at a sample that shows this triangle; position in sub-pixels of 1/256 px from the frame's corner.
    ///
    /// Any position has a result: it is moved to the nearest one within the bounds of the visible part. Rounding: one to nearest
    /// per port word, after sums of 2⁻⁵¹ relative error or better.
    pub fn fragment(&self, x_subpx: i32, y_subpx: i32) -> FragmentAttributes {
        let (weights, reciprocal) = self.weights_at(x_subpx, y_subpx);
        let mut fragment = FragmentAttributes {
            normal: self.normals.at(weights, 1.0),
            view: self.projection.ray_view(x_subpx, y_subpx),
            dview: self.projection.dview(),
            dnormal: self.dnormal,
            ..FragmentAttributes::default()
        };
        if let Some(tangents) = &self.tangents {
            fragment.frame_vectors = tangents.map(|tangent| tangent.at(weights, reciprocal));
        }
        if self.needs.uv {
            let uv = self.uv_at(weights, reciprocal);
            fragment.uv = uv.map(|u| U0F32::from_bits(turns(u)));
            if self.needs.duv {
                fragment.duv = [0, 1].map(|axis| port(block(self.duv_at(axis, uv, reciprocal), 0)));
            }
        }
        fragment
    }

    /// Attributes of [`LANES`] samples.
    #[inline(always)]
    pub fn fragments(&self, positions: &Positions, rows: &mut AttributeRows) {
        let mut weights = [[0.0; LANES]; 3];
        let mut reciprocal = [0.0; LANES];
        for lane in 0..LANES {
            let (here, over) = self.weights_at(positions[0][lane], positions[1][lane]);
            for (row, weight) in weights.iter_mut().zip(here) {
                row[lane] = weight;
            }
            reciprocal[lane] = over;
        }
        let at = |lane: usize| [weights[0][lane], weights[1][lane], weights[2][lane]];
        let AttributeRows { normal, view, frame_vectors, uv, duv } = rows;
        *normal = self.normals.rows(
            #[inline(always)]
            |normals, lane| normals.at(at(lane)),
        );
        *view = self.projection.ray_views(positions);
        if let Some(tangents) = &self.tangents {
            for (tangent, rows) in tangents.iter().zip(frame_vectors) {
                *rows = tangent.rows(
                    #[inline(always)]
                    |tangents, lane| scale(tangents.at(at(lane)), reciprocal[lane]),
                );
            }
        }
        if self.needs.uv {
            let mut places = [[0.0; LANES]; 2];
            for lane in 0..LANES {
                let [u, v] = self.uv_at(at(lane), reciprocal[lane]);
                (places[0][lane], places[1][lane]) = (u, v);
                (uv[0][lane], uv[1][lane]) = (turns(u) as i32, turns(v) as i32);
            }
            if self.needs.duv {
                let here = |lane: usize| [places[0][lane], places[1][lane]];
                duv[0] = block_rows(0, |lane| self.duv_at(0, here(lane), reciprocal[lane]));
                duv[1] = block_rows(0, |lane| self.duv_at(1, here(lane), reciprocal[lane]));
            }
        }
    }

    /// ∂v and ∂n of all fragments of the triangle.
    pub fn derivatives(&self) -> Derivatives<i32> {
        derivatives(self.projection.dview(), self.dnormal)
    }

    /// Setup of the directions to a point in the world, once per triangle.
    pub fn point(&self, point: DVec3) -> PointFromTriangle {
        PointFromTriangle(CornerVectors::new(self.corners.map(|corner| point - corner)))
    }

    /// Direction from the surface to a point, at a sample as in [`Self::fragment`]. Its length has no meaning, for Σ eᵢ (P − pᵢ)
    /// is Σ eᵢ times the vector. Rounding as in [`Self::fragment`].
    pub fn direction_to(&self, point: &PointFromTriangle, x_subpx: i32, y_subpx: i32) -> BlockVector {
        let (weights, _) = self.weights_at(x_subpx, y_subpx);
        port(block(point.0.at(weights), point.0.exponent))
    }

    /// Weights at a position and the reciprocal of their positive sum.
    ///
    /// If a triangle is so thin that all weights vanish at a covered sample, the corners count alike.
    #[inline(always)]
    fn weights_at(&self, x_subpx: i32, y_subpx: i32) -> (Corners, f64) {
        let [[left, top], [right, bottom]] = self.bounds;
        let x = f64::from(x_subpx.max(left).min(right) - self.reference[0]);
        let y = f64::from(y_subpx.max(top).min(bottom) - self.reference[1]);
        let [a, b, c] = &self.weights;
        let weight = |plane: &Plane| (plane[0] + plane[1] * x + plane[2] * y).max(self.least_weight);
        let [a, b, c] = [weight(a), weight(b), weight(c)];
        let sum = a + b + c;
        let counts = sum > 0.0;
        let or_one = |weight: f64| if counts { weight } else { 1.0 };
        ([or_one(a), or_one(b), or_one(c)], 1.0 / if counts { sum } else { 3.0 })
    }

    /// u and v.
    #[inline(always)]
    fn uv_at(&self, weights: Corners, reciprocal: f64) -> [f64; 2] {
        let [u, v] = &self.uv;
        [weighted_sum(weights, u) * reciprocal, weighted_sum(weights, v) * reciprocal]
    }

    /// ∂(u, v) along an axis.
    #[inline(always)]
    fn duv_at(&self, axis: usize, [u, v]: [f64; 2], reciprocal: f64) -> [f64; 2] {
        let rise = |corners: &Corners, here: f64| {
            let [a, b, c] = *corners;
            weighted_sum(self.slopes[axis], &[a - here, b - here, c - here]) * reciprocal
        };
        [rise(&self.uv[0], u), rise(&self.uv[1], v)]
    }
}

/// Plane equations of the weights around a screen point (pixels), at any common scale.
/// The second value is true if, half a sub-pixel beyond an edge, the weights may be wrong by more than an eighth of their sum:
/// the triangle is seen edge-on or reaches close to its horizon.
fn weight_planes(polygon: &ScreenPolygon, reference_px: [f64; 2]) -> ([Plane; 3], bool) {
    let [a, b, c] = polygon.corners.map(|corner| relative_to(corner, reference_px));
    let determinant = a.dot(b.cross(c));
    let sign = if determinant < 0.0 { -1.0 } else { 1.0 };
    let planes = [b.cross(c), c.cross(a), a.cross(b)].map(|n| {
        let per_subpixel = sign / f64::from(SUBPIXELS);
        [n.z * sign, n.x * per_subpixel, n.y * per_subpixel]
    });
    let steepest = planes.iter().fold(0.0_f64, |m, p| m.max(p[1].abs() + p[2].abs()));
    let least_sum = determinant.abs() * polygon.inverse_w[0];
    // This order makes a NaN count as thin.
    let is_thick = steepest <= least_sum / 8.0;
    (planes, !is_thick)
}

/// The planes times a power of two, so that weights stay below 2 in view and no attribute leaves float64. If the planes are not
/// finite or all zero, the corners count alike.
fn scaled_planes(planes: [Plane; 3], bounds: [[i32; 2]; 2], reference: [i32; 2]) -> Option<[Plane; 3]> {
    let extent =
        [0, 1].map(|axis| f64::from((bounds[1][axis] - reference[axis]).max(reference[axis] - bounds[0][axis])));
    let bound = planes
        .iter()
        .map(|p| p[0].abs() + p[1].abs() * extent[0].max(1.0) + p[2].abs() * extent[1].max(1.0))
        .fold(0.0, f64::max);
    let is_finite = planes.as_flattened().iter().sum::<f64>().is_finite() && bound.is_finite() && bound > 0.0;
    let planes = if is_finite { planes } else { [[1.0, 0.0, 0.0]; 3] };
    // The bound is scaled together with the numbers.
    let mut numbers = [if is_finite { bound } else { 1.0 }; 10];
    numbers[1..].copy_from_slice(planes.as_flattened());
    let (numbers, _) = scaled(numbers);
    let (planes, _) = numbers[1..].as_chunks();
    planes.first_chunk().copied()
}

/// Texture coordinates of the corners, by coordinate, less a whole number of wraps, so that they stay small.
fn corner_uv(corners: [[f64; 2]; 3]) -> [Corners; 2] {
    // A coordinate of 2^64 has no fraction left.
    let most = 2_f64.powi(64);
    [0, 1].map(|component| {
        let values = corners.map(|uv| if uv[component].is_finite() { uv[component].clamp(-most, most) } else { 0.0 });
        let base = (values.iter().sum::<f64>() / 3.0).floor();
        values.map(|value| value - base)
    })
}

/// Σ weight·value.
#[inline(always)]
fn weighted_sum(weights: Corners, values: &Corners) -> f64 {
    weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2]
}

#[inline(always)]
fn scale([x, y, z]: [f64; 3], factor: f64) -> [f64; 3] {
    [x * factor, y * factor, z * factor]
}
