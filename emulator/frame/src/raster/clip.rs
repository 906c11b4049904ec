//! Clipping of a triangle to the part in front of the near plane and near enough to the frame: the clipped polygon on the
//! sub-pixel grid.
//!
//! Sutherland–Hodgman in homogeneous coordinates against the near plane and a guard band of [`GUARD_PX`] pixels around the frame.
//! Intersections are computed from the inner to the outer vertex. Two triangles with a common edge are therefore clipped at the
//! same point and stay watertight. Only coverage uses the polygon; attributes come from the whole triangle.

use glam::DVec3;

use super::camera::Projection;
use super::{SUBPIXEL_BITS, SUBPIXELS};

/// Width of the guard band around the frame, pixels: screen positions stay below 2^15 px, 2^23 sub-pixels.
const GUARD_PX: f64 = 16_384.0;
/// Three vertices, and at most one more for each of the five clip planes.
const MAX_VERTICES: usize = 8;

/// The part of one triangle that may be visible.
#[derive(Clone, Debug)]
pub(super) struct ScreenPolygon {
    /// Homogeneous coordinates of the whole triangle; see [`Projection::homogeneous`].
    pub(super) corners: [DVec3; 3],
    /// Least and largest 1/w over the polygon, both positive.
    pub(super) inverse_w: [f64; 2],
    /// First and last pixel column and row that the polygon touches, inside the frame.
    pub(super) columns: [i32; 2],
    /// See `columns`.
    pub(super) rows: [i32; 2],
    vertices: [[i32; 2]; MAX_VERTICES],
    len: usize,
}

impl ScreenPolygon {
    /// Clips the triangle of three world positions.
    ///
    /// `None` if nothing can be covered: the triangle is not finite, behind the near plane, outside the frame, or of no area in
    /// the world or on the sub-pixel grid.
    pub(super) fn new(projection: &Projection, positions: [DVec3; 3]) -> Option<Self> {
        let [a, b, c] = positions;
        let corners = positions.map(|p| projection.homogeneous(p));
        if (b - a).cross(c - a) == DVec3::ZERO || !corners.iter().all(|c| c.is_finite()) {
            return None;
        }
        let mut clipped = [DVec3::ZERO; MAX_VERTICES];
        clipped[..3].copy_from_slice(&corners);
        let mut len = 3;
        let right = f64::from(projection.width()) + GUARD_PX;
        let bottom = f64::from(projection.height()) + GUARD_PX;
        // A point is inside if normal · (x·w, y·w, w) ≥ offset.
        let planes = [
            (DVec3::Z, projection.near()),
            (DVec3::new(1.0, 0.0, GUARD_PX), 0.0),
            (DVec3::new(-1.0, 0.0, right), 0.0),
            (DVec3::new(0.0, 1.0, GUARD_PX), 0.0),
            (DVec3::new(0.0, -1.0, bottom), 0.0),
        ];
        for (normal, offset) in planes {
            len = clip(&mut clipped, len, |vertex| normal.dot(vertex) - offset);
            if len < 3 {
                return None;
            }
        }

        let mut vertices = [[0; 2]; MAX_VERTICES];
        let mut inverse_w = [f64::INFINITY, 0.0_f64];
        let (mut low, mut high) = ([i32::MAX; 2], [i32::MIN; 2]);
        for (snapped, vertex) in vertices.iter_mut().zip(&clipped[..len]) {
            *snapped = [snap(vertex.x / vertex.z), snap(vertex.y / vertex.z)];
            inverse_w = [inverse_w[0].min(1.0 / vertex.z), inverse_w[1].max(1.0 / vertex.z)];
            for axis in 0..2 {
                low[axis] = low[axis].min(snapped[axis]);
                high[axis] = high[axis].max(snapped[axis]);
            }
        }
        let pixels = |axis: usize, edge: u32| {
            let last = edge as i32 - 1;
            [(low[axis] >> SUBPIXEL_BITS).max(0), (high[axis] >> SUBPIXEL_BITS).min(last)]
        };
        let polygon = Self {
            corners,
            inverse_w,
            columns: pixels(0, projection.width()),
            rows: pixels(1, projection.height()),
            vertices,
            len,
        };
        let on_screen = polygon.columns[0] <= polygon.columns[1] && polygon.rows[0] <= polygon.rows[1];
        (on_screen && polygon.pieces().next().is_some()).then_some(polygon)
    }

    /// Triangles of the polygon's fan, in sub-pixels, each of positive area by [`twice_area`].
    ///
    /// Snapping can turn a sliver of a clipped polygon over. Such a piece is left out, so that the pieces leave no hole and
    /// overlap a neighbour by less than a sub-pixel.
    pub(super) fn pieces(&self) -> impl Iterator<Item = [[i32; 2]; 3]> {
        let fan = (1..self.len - 1).map(|i| [self.vertices[0], self.vertices[i], self.vertices[i + 1]]);
        let positive = fan.clone().map(twice_area).sum::<i64>() > 0;
        fan.map(move |[a, b, c]| if positive { [a, b, c] } else { [a, c, b] }).filter(|&piece| twice_area(piece) > 0)
    }
}

/// Twice the signed area of a triangle in sub-pixels squared, below 2^49; positive when its corners run clockwise on the
/// screen (y down).
pub(super) fn twice_area([a, b, c]: [[i32; 2]; 3]) -> i64 {
    let difference = |p: [i32; 2], axis: usize| i64::from(p[axis]) - i64::from(a[axis]);
    difference(b, 0) * difference(c, 1) - difference(b, 1) * difference(c, 0)
}

/// Keeps the part of a convex polygon where `distance` ≥ 0; returns its new number of vertices.
fn clip(polygon: &mut [DVec3; MAX_VERTICES], len: usize, distance: impl Fn(DVec3) -> f64) -> usize {
    if polygon[..len].iter().all(|&vertex| distance(vertex) >= 0.0) {
        return len;
    }
    let source = *polygon;
    let mut kept = 0;
    let mut push = |vertex: DVec3| {
        // A convex polygon gains one vertex per plane; rounding could make it look concave, hence the guard.
        if kept < MAX_VERTICES {
            polygon[kept] = vertex;
            kept += 1;
        }
    };
    for i in 0..len {
        let (from, to) = (source[i], source[(i + 1) % len]);
        let (d_from, d_to) = (distance(from), distance(to));
        let cut = |inner: DVec3, outer: DVec3, d_inner: f64, d_outer: f64| {
            inner + (outer - inner) * (d_inner / (d_inner - d_outer))
        };
        match (d_from >= 0.0, d_to >= 0.0) {
            (true, true) => push(from),
            (true, false) => {
                push(from);
                push(cut(from, to, d_from, d_to));
            }
            (false, true) => push(cut(to, from, d_to, d_from)),
            (false, false) => {}
        }
    }
    kept
}

/// ⌊x⌋ for |x| < 2^63. `f64::floor` is a call on machines that have no instruction for it.
pub(super) fn floor(x: f64) -> i64 {
    let whole = x as i64;
    whole - i64::from(whole as f64 > x)
}

/// A screen coordinate in pixels on the sub-pixel grid, to nearest. The guard band holds already; the clamp catches its rounding.
fn snap(position_px: f64) -> i32 {
    let limit = 2.5 * GUARD_PX;
    floor(position_px.clamp(-limit, limit) * f64::from(SUBPIXELS) + 0.5) as i32
}
