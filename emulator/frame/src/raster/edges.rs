//! Coverage and depth of one screen triangle: integer edge functions with the top-left rule.
//!
//! A sample p is inside if (b − a) × (p − a) ≥ 0 for the three edges. A sample on an edge is inside only if that edge is a top or
//! a left one: shared edges are covered exactly once. Depth is near/w, linear on the screen, 56 fraction bits. The larger value
//! wins; among equals the triangle drawn first wins. Samples of a pixel, or of neighbouring pixels, lie in vectors of [`VECTOR`].
//! The caller compiles the drawing for the instruction set of the machine.

use glam::DVec3;

use super::blocks::scale_by_power_of_two;
use super::clip::{ScreenPolygon, floor};
use super::{SUBPIXELS, TileRect};

/// Fraction bits of a depth: near/w = 1 is 2^56.
const DEPTH_BITS: i32 = 56;
/// Number that stands for a sample that no triangle covers.
pub(super) const NO_TRIANGLE: u32 = u32::MAX;
/// Samples of a vector.
const VECTOR: usize = 8;

/// Depth over the screen: near/w · 2^56 of the whole triangle, clamped to the range of its visible part.
#[derive(Clone, Copy, Debug)]
pub(super) struct DepthPlane {
    /// Sub-pixel position of `constant`.
    reference: [i32; 2],
    constant: i64,
    per_x: i64,
    per_y: i64,
    range: [i64; 2],
}

impl DepthPlane {
    /// Plane of a polygon for a near plane at distance `near`.
    ///
    /// Errors: the coefficients are rounded to 2⁻⁵⁶ per sub-pixel, at most 2⁻³⁴ of near/w across 16384 px. If a sliver is so thin
    /// that the plane would leave 62 bits, it gets its mean depth instead.
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
            plane.map(|value| floor(value + 0.5))
        } else {
            [range[0] / 2 + range[1] / 2, 0, 0]
        };
        Self { reference, constant, per_x, per_y, range }
    }

    /// Depth at a sub-pixel position, in 64 bits; valid inside the polygon's bounds.
    #[inline(always)]
    fn at(&self, x: i32, y: i32) -> i64 {
        let (dx, dy) = (x - self.reference[0], y - self.reference[1]);
        self.constant.wrapping_add(self.rise(dx.into(), dy.into()))
    }

    /// Increase of the depth over a number of sub-pixels.
    #[inline(always)]
    fn rise(&self, dx: i64, dy: i64) -> i64 {
        self.per_x.wrapping_mul(dx).wrapping_add(self.per_y.wrapping_mul(dy))
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

    #[inline(always)]
    fn at(&self, x: i32, y: i32) -> i64 {
        self.constant + self.rise(x.into(), y.into())
    }

    /// Increase of the edge function over a number of sub-pixels.
    #[inline(always)]
    fn rise(&self, dx: i64, dy: i64) -> i64 {
        self.per_x * dx + self.per_y * dy
    }
}

/// Positions in a pixel at which visibility is tested, and their layout in vectors. The samples of a pixel follow each other. If
/// they fill only a part of a vector, those of the next pixel follow.
#[derive(Clone, Debug)]
pub(super) struct Places {
    count: usize,
    /// Samples of a pixel in memory: a part of a vector, or whole vectors, the last of which repeats the last position.
    stride: usize,
    /// Pixels in a vector.
    pixels: usize,
    /// Offsets for each vector of these pixels, in sub-pixels from the corner of the first pixel: x, then y.
    vectors: Vec<[[i64; VECTOR]; 2]>,
}

impl Places {
    /// Builds the layout of positions in sub-pixels from the corner of the pixel, 0 to 255 each.
    ///
    /// # Panics
    /// If there is no position.
    pub(super) fn new(places: &[[i32; 2]]) -> Self {
        let count = places.len();
        let pixels = if VECTOR.is_multiple_of(count) { VECTOR / count } else { 1 };
        let stride = if pixels > 1 { count } else { count.next_multiple_of(VECTOR) };
        let at = |index: usize, axis: usize| {
            let (pixel, place) = (index / stride, places[(index % stride).min(count - 1)]);
            i64::from(place[axis]) + if axis == 0 { pixel as i64 * i64::from(SUBPIXELS) } else { 0 }
        };
        let vector = |index: usize| [0, 1].map(|axis| core::array::from_fn(|lane| at(index * VECTOR + lane, axis)));
        Self { count, stride, pixels, vectors: (0..stride * pixels / VECTOR).map(vector).collect() }
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

    /// Number of the triangle in the frame.
    pub(super) fn triangle(&self) -> u32 {
        self.triangle
    }

    /// First and last pixel column (axis 0) or row (axis 1) that the piece touches; they may lie outside the frame.
    pub(super) fn pixels(&self, axis: usize) -> [i32; 2] {
        let [a, b, c] = self.vertices.map(|v| v[axis]);
        [a.min(b).min(c), a.max(b).max(c)].map(|edge| edge >> super::SUBPIXEL_BITS)
    }

    fn edges(&self) -> [Edge; 3] {
        let [a, b, c] = self.vertices;
        [Edge::new(a, b), Edge::new(b, c), Edge::new(c, a)]
    }

    /// True if any sample position of the rectangle may be covered; never false for a covered one.
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

    /// Draws the samples of the piece under the number `number`.
    #[inline(always)]
    pub(super) fn draw(&self, number: u32, places: &Places, buffer: &mut TileBuffer) {
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
        let pixels = places.pixels as i32;
        let [first, last] = [first_column, last_column].map(|column| (column - rect.x as i32) / pixels);
        let (edges, depth) = (self.edges(), &self.depth);
        let x = rect.x as i32 * SUBPIXELS + first * pixels * SUBPIXELS;
        let step = i64::from(pixels * SUBPIXELS);
        let (edge_step, depth_step) = (edges.map(|edge| edge.rise(step, 0)), depth.rise(step, 0));
        let [farthest, nearest] = depth.range;
        for (index, [dx, dy]) in places.vectors.iter().enumerate() {
            let mut edge_rise = [[0; VECTOR]; 3];
            let mut depth_rise = [0; VECTOR];
            for lane in 0..VECTOR {
                for (rise, edge) in edge_rise.iter_mut().zip(&edges) {
                    rise[lane] = edge.rise(dx[lane], dy[lane]);
                }
                depth_rise[lane] = depth.rise(dx[lane], dy[lane]);
            }
            for row in first_row..=last_row {
                let y = row * SUBPIXELS;
                let [mut a, mut b, mut c] = edges.map(|edge| edge.at(x, y));
                let mut plane = depth.at(x, y);
                let start = (row as u32 - rect.y) as usize * buffer.row + first as usize * places.vectors.len() + index;
                let vectors = (last - first) as usize * places.vectors.len() + 1;
                let depths = buffer.depth[start..start + vectors].iter_mut();
                let shown = buffer.shown[start..start + vectors].iter_mut();
                for (Depths(depths), shown) in depths.zip(shown).step_by(places.vectors.len()) {
                    for lane in 0..VECTOR {
                        let inside = (a + edge_rise[0][lane]) | (b + edge_rise[1][lane]) | (c + edge_rise[2][lane]);
                        let candidate = plane.wrapping_add(depth_rise[lane]).clamp(farthest, nearest);
                        let wins = (inside >= 0) & (candidate > depths[lane]);
                        depths[lane] = if wins { candidate } else { depths[lane] };
                        shown[lane] = if wins { number } else { shown[lane] };
                    }
                    (a, b, c) = (a + edge_step[0], b + edge_step[1], c + edge_step[2]);
                    plane = plane.wrapping_add(depth_step);
                }
            }
        }
    }
}

/// Depths of a vector of samples: one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Depths([i64; VECTOR]);

/// Visibility in one rectangle of the frame: for each sample the nearest triangle and its depth.
#[derive(Clone, Debug, Default)]
pub(super) struct TileBuffer {
    rect: TileRect,
    /// Samples of a pixel, and their number in memory.
    count: usize,
    stride: usize,
    /// Vectors in a row of pixels.
    row: usize,
    depth: Vec<Depths>,
    shown: Vec<[u32; VECTOR]>,
}

impl TileBuffer {
    /// Clears the rectangle; the memory is kept.
    pub(super) fn clear(&mut self, rect: TileRect, places: &Places) {
        self.row = (rect.width as usize).div_ceil(places.pixels) * places.vectors.len();
        (self.rect, self.count, self.stride) = (rect, places.count, places.stride);
        let vectors = self.row * rect.height as usize;
        self.depth.clear();
        self.depth.resize(vectors, Depths([-1; VECTOR]));
        self.shown.clear();
        self.shown.resize(vectors, [NO_TRIANGLE; VECTOR]);
    }

    /// Numbers of the triangles that the samples of a row of pixels show, or [`NO_TRIANGLE`]; pixel by pixel.
    #[inline(always)]
    pub(super) fn shown(&self, row: usize) -> impl Iterator<Item = &[u32]> {
        let pixels = self.shown[row * self.row..][..self.row].as_flattened().chunks_exact(self.stride);
        pixels.map(|samples| &samples[..self.count]).take(self.rect.width as usize)
    }

    /// Number at a position of a pixel of the frame, and its depth: near/w in units of 2⁻⁵⁶, larger is nearer. `None` if no
    /// triangle covers it or the pixel is outside the rectangle.
    #[cfg(test)]
    pub(super) fn at(&self, x: u32, y: u32, place: usize) -> Option<(u32, i64)> {
        let column = x.checked_sub(self.rect.x).filter(|&c| c < self.rect.width)?;
        let row = y.checked_sub(self.rect.y).filter(|&r| r < self.rect.height)?;
        let index = row as usize * self.row * VECTOR + column as usize * self.stride + place;
        let number = self.shown.as_flattened()[index];
        (number != NO_TRIANGLE).then(|| (number, self.depth[index / VECTOR].0[index % VECTOR]))
    }
}
