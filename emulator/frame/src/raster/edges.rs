//! Coverage and depth of one screen triangle: integer edge functions with the top-left rule.
//!
//! A sample p is inside when (b − a) × (p − a) ≥ 0 for the three edges, and on an edge only where that edge is a top or
//! a left one: shared edges are covered exactly once. Depth is near/w, linear on the screen, 56 fraction bits; the larger
//! value wins, among equals the lower triangle index, so the order of drawing does not matter.

use glam::DVec3;

use super::blocks::scale_by_power_of_two;
use super::clip::ScreenPolygon;
use super::{SUBPIXELS, TileRect};

/// Fraction bits of a depth: near/w = 1 is 2^56.
const DEPTH_BITS: i32 = 56;
/// Triangle index of a sample that no triangle covers.
const NO_TRIANGLE: u32 = u32::MAX;

/// Depth over the screen: near/w · 2^56 of the whole triangle, held within the range of its visible part.
#[derive(Clone, Copy, Debug)]
pub(super) struct DepthPlane {
    /// Sub-pixel position that `constant` belongs to.
    reference: [i32; 2],
    constant: i64,
    per_x: i64,
    per_y: i64,
    range: [i64; 2],
}

impl DepthPlane {
    /// Plane of a polygon for a near plane at distance `near`.
    ///
    /// Errors: the coefficients are rounded to 2⁻⁵⁶ per sub-pixel, at most 2⁻³⁴ of near/w across 16384 px. A sliver so thin
    /// that the plane would leave 62 bits gets its mean depth instead.
    pub(super) fn new(polygon: &ScreenPolygon, near: f64) -> Self {
        let reference = [polygon.columns[0] * SUBPIXELS, polygon.rows[0] * SUBPIXELS];
        let origin = [polygon.columns[0], polygon.rows[0]].map(f64::from);
        let [a, b, c] = polygon.corners.map(|p| relative_to(p, origin));
        let determinant = a.dot(b.cross(c));
        // 1/w(x, y) = normal·(x, y, 1)/determinant.
        let normal = (b - a).cross(c - a);
        let code = |value: f64| scale_by_power_of_two(near * value, DEPTH_BITS);
        let range = polygon.inverse_w.map(|value| code(value) as i64);
        let per_subpixel = 1.0 / f64::from(SUBPIXELS);
        let plane = [
            code(normal.z / determinant),
            code(normal.x / determinant) * per_subpixel,
            code(normal.y / determinant) * per_subpixel,
        ];
        let extent = |span: [i32; 2]| f64::from((span[1] - span[0] + 1) * SUBPIXELS);
        let bound = plane[0].abs() + plane[1].abs() * extent(polygon.columns) + plane[2].abs() * extent(polygon.rows);
        let [constant, per_x, per_y] = if bound < scale_by_power_of_two(1.0, 62) {
            plane.map(|value| (value + 0.5).floor() as i64)
        } else {
            [range[0] / 2 + range[1] / 2, 0, 0]
        };
        Self { reference, constant, per_x, per_y, range }
    }

    /// Depth at a sub-pixel position inside the polygon's bounds.
    fn at(&self, x: i32, y: i32) -> i64 {
        let (dx, dy) = (x - self.reference[0], y - self.reference[1]);
        self.constant + self.per_x * i64::from(dx) + self.per_y * i64::from(dy)
    }
}

/// Homogeneous screen coordinates relative to the screen point `origin` (pixels).
pub(super) fn relative_to(corner: DVec3, origin: [f64; 2]) -> DVec3 {
    DVec3::new(corner.x - origin[0] * corner.z, corner.y - origin[1] * corner.z, corner.z)
}

/// Edge from a to b as `constant + per_x·x + per_y·y` ≥ 0 inside, in sub-pixels; below 2^51 on any frame.
#[derive(Clone, Copy, Debug)]
struct Edge {
    constant: i64,
    per_x: i64,
    per_y: i64,
}

impl Edge {
    fn new(a: [i32; 2], b: [i32; 2]) -> Self {
        let [ax, ay] = a.map(i64::from);
        let (dx, dy) = (i64::from(b[0]) - ax, i64::from(b[1]) - ay);
        // Inside is to the right of a left edge (it runs up) and below a top edge (it runs right).
        let owns_boundary = dy < 0 || (dy == 0 && dx > 0);
        Self { constant: dy * ax - dx * ay - i64::from(!owns_boundary), per_x: -dy, per_y: dx }
    }

    fn at(&self, x: i32, y: i32) -> i64 {
        self.constant + self.per_x * i64::from(x) + self.per_y * i64::from(y)
    }
}

/// One piece of a visible triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScreenTriangle {
    /// Corners in sub-pixels, of positive area.
    vertices: [[i32; 2]; 3],
    depth: DepthPlane,
    /// Index of the triangle in the list.
    triangle: u32,
}

impl ScreenTriangle {
    pub(super) fn new(vertices: [[i32; 2]; 3], depth: DepthPlane, triangle: u32) -> Self {
        Self { vertices, depth, triangle }
    }

    /// Columns or rows (axis 0 or 1) of pixels `first..=last` that the piece touches; may lie outside the frame.
    pub(super) fn pixels(&self, axis: usize) -> [i32; 2] {
        let [a, b, c] = self.vertices.map(|v| v[axis]);
        [a.min(b).min(c), a.max(b).max(c)].map(|edge| edge >> super::SUBPIXEL_BITS)
    }

    fn edges(&self) -> [Edge; 3] {
        let [a, b, c] = self.vertices;
        [Edge::new(a, b), Edge::new(b, c), Edge::new(c, a)]
    }

    /// Whether any sample position of the rectangle may be covered (no false "no").
    pub(super) fn may_touch(&self, rect: TileRect) -> bool {
        let [left, top] = [rect.x, rect.y].map(|start| start as i32 * SUBPIXELS);
        let right = left + rect.width as i32 * SUBPIXELS - 1;
        let bottom = top + rect.height as i32 * SUBPIXELS - 1;
        self.edges().iter().all(|edge| {
            let x = if edge.per_x > 0 { right } else { left };
            let y = if edge.per_y > 0 { bottom } else { top };
            edge.at(x, y) >= 0
        })
    }

    /// Draws the samples at `offset` sub-pixels into their pixels.
    pub(super) fn draw(&self, offset: [i32; 2], buffer: &mut TileBuffer) {
        let rect = buffer.rect;
        let inside = |axis: usize, start: u32, edge: u32| {
            let [first, last] = self.pixels(axis);
            [first.max(start as i32), last.min((start + edge) as i32 - 1)]
        };
        let [first_column, last_column] = inside(0, rect.x, rect.width);
        let [first_row, last_row] = inside(1, rect.y, rect.height);
        if first_column > last_column || first_row > last_row {
            return;
        }
        let edges = self.edges();
        let columns = (last_column - first_column + 1) as usize;
        let x = first_column * SUBPIXELS + offset[0];
        let step = i64::from(SUBPIXELS);
        let edge_step = edges.map(|edge| edge.per_x * step);
        let depth_step = self.depth.per_x * step;
        let [farthest, nearest] = self.depth.range;
        for row in first_row..=last_row {
            let y = row * SUBPIXELS + offset[1];
            let mut inside = edges.map(|edge| edge.at(x, y));
            let mut plane = self.depth.at(x, y);
            let start = (row as u32 - rect.y) as usize * rect.width as usize + (first_column as u32 - rect.x) as usize;
            let depths = &mut buffer.depth[start..start + columns];
            let triangles = &mut buffer.triangle[start..start + columns];
            for (depth, triangle) in depths.iter_mut().zip(triangles) {
                if inside[0] | inside[1] | inside[2] >= 0 {
                    let candidate = plane.clamp(farthest, nearest);
                    if candidate > *depth || (candidate == *depth && self.triangle < *triangle) {
                        *depth = candidate;
                        *triangle = self.triangle;
                    }
                }
                for (value, step) in inside.iter_mut().zip(edge_step) {
                    *value += step;
                }
                // The plane is bounded at the samples, but not one step past the last column.
                plane = plane.wrapping_add(depth_step);
            }
        }
    }
}

/// What is visible in one rectangle of the frame: for each pixel's sample the nearest triangle and its depth.
#[derive(Clone, Debug, Default)]
pub struct TileBuffer {
    rect: TileRect,
    depth: Vec<i64>,
    triangle: Vec<u32>,
}

impl TileBuffer {
    /// An empty buffer; [`super::TriangleList::rasterise_tile`] sizes it and may use it again and again.
    pub fn new() -> Self {
        Self::default()
    }

    /// The rectangle drawn last.
    pub fn rect(&self) -> TileRect {
        self.rect
    }

    /// Visible triangle at a pixel of the frame; `None` where there is none or the pixel is outside the rectangle.
    pub fn triangle_at(&self, x: u32, y: u32) -> Option<u32> {
        let triangle = *self.triangle.get(self.index(x, y)?)?;
        (triangle != NO_TRIANGLE).then_some(triangle)
    }

    /// Depth at a pixel of the frame: near/w in units of 2⁻⁵⁶, larger is nearer; `None` as in
    /// [`TileBuffer::triangle_at`].
    pub fn depth_at(&self, x: u32, y: u32) -> Option<i64> {
        self.triangle_at(x, y)?;
        self.depth.get(self.index(x, y)?).copied()
    }

    /// Visible triangles of the rectangle, row by row from the top left.
    pub fn triangles(&self) -> impl Iterator<Item = Option<u32>> {
        self.triangle.iter().map(|&triangle| Self::shown(triangle))
    }

    /// The same as [`Self::shown`] reads them.
    pub(super) fn visible(&self) -> &[u32] {
        &self.triangle
    }

    /// The triangle that a number says, if any.
    pub(super) fn shown(number: u32) -> Option<u32> {
        (number != NO_TRIANGLE).then_some(number)
    }

    pub(super) fn clear(&mut self, rect: TileRect) {
        let samples = rect.width as usize * rect.height as usize;
        self.rect = rect;
        self.depth.clear();
        self.depth.resize(samples, -1);
        self.triangle.clear();
        self.triangle.resize(samples, NO_TRIANGLE);
    }

    fn index(&self, x: u32, y: u32) -> Option<usize> {
        let column = x.checked_sub(self.rect.x).filter(|&c| c < self.rect.width)?;
        let row = y.checked_sub(self.rect.y).filter(|&r| r < self.rect.height)?;
        Some(row as usize * self.rect.width as usize + column as usize)
    }
}
