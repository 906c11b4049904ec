//! The triangles of a frame: clipped, snapped and sorted into tiles once, and drawn tile by tile.
//!
//! Triangles are numbered through all objects in their order. Each tile has a list of the pieces that may touch it. A piece over
//! more than [`MAX_BINNED_TILES`] tiles is in one list for all tiles, which bounds the memory. The order of drawing cannot change
//! the picture, so neither can the order of the lists.

use super::attributes::Triangle;
use super::camera::Projection;
use super::clip::ScreenPolygon;
use super::edges::{DepthPlane, Places, ScreenTriangle, TileBuffer};
use super::{MAX_TRIANGLES, RasterError, TILE_EDGE_PX, TileRect};
use rayon::prelude::*;
use roughxel_assets::Vertex;
use roughxel_scene::Object;
use roughxel_shader::Needs;
use roughxel_simd::Backend;

/// Most tiles whose lists contain one piece.
const MAX_BINNED_TILES: usize = 16;

/// Triangles that one thread sets up in a row.
const SET_UP_TOGETHER: usize = 2048;

/// The pieces that may be visible in a tile, in their order.
#[derive(Clone, Debug, Default)]
pub(super) struct Drawn {
    /// Each piece, with the index of its triangle in `triangles`.
    pieces: Vec<(u32, u32)>,
    /// Numbers of the triangles in the frame.
    pub(super) triangles: Vec<u32>,
}

/// All triangles of a frame that may be visible.
#[derive(Clone, Debug)]
pub struct TriangleList<'a> {
    projection: &'a Projection,
    objects: &'a [Object],
    /// Number of the first triangle of each object, then the number of all triangles.
    first_triangle: Vec<u32>,
    /// Instruction set of the visibility test.
    backend: Backend,
    pieces: Vec<ScreenTriangle>,
    tile_columns: usize,
    /// `bins[bin_start[t]..bin_start[t + 1]]` are the pieces of tile t.
    bin_start: Vec<usize>,
    bins: Vec<u32>,
    /// Pieces over more than [`MAX_BINNED_TILES`] tiles.
    large: Vec<u32>,
}

impl<'a> TriangleList<'a> {
    /// Clips and bins the triangles of `objects`.
    ///
    /// Triangles are left out if they are not finite, behind the near plane, outside the frame or of no area (in the world or on
    /// the sub-pixel grid). Errors: a vertex index out of range, more than [`MAX_TRIANGLES`] triangles.
    pub fn new(projection: &'a Projection, objects: &'a [Object]) -> Result<Self, RasterError> {
        let count: u64 = objects.iter().map(|object| object.mesh.triangles.len() as u64).sum();
        if count > u64::from(MAX_TRIANGLES) {
            let message = format!("{count} triangles in the scene; at most {MAX_TRIANGLES} can be drawn");
            return Err(RasterError::OutOfRange(message));
        }
        let mut first_triangle = vec![0];
        let mut pieces = Vec::new();
        let mut first = 0;
        for object in objects {
            let triangles = &object.mesh.triangles;
            let part = |start: usize| -> Result<Vec<ScreenTriangle>, RasterError> {
                let mut part = Vec::with_capacity(SET_UP_TOGETHER);
                for (index, corners) in triangles.iter().enumerate().skip(start).take(SET_UP_TOGETHER) {
                    let vertices = corner_vertices(object, index, corners)?;
                    if let Some(polygon) = ScreenPolygon::new(projection, vertices.map(|v| v.position)) {
                        let (depth, number) = (DepthPlane::new(&polygon, projection.near()), first + index as u32);
                        part.extend(polygon.pieces().map(|piece| ScreenTriangle::new(piece, depth, number)));
                    }
                }
                Ok(part)
            };
            let starts = (0..triangles.len()).into_par_iter().step_by(SET_UP_TOGETHER);
            let parts: Vec<_> = starts.map(part).collect();
            for part in parts {
                pieces.append(&mut part?);
            }
            first += triangles.len() as u32;
            first_triangle.push(first);
        }
        let tile_columns = projection.width().div_ceil(TILE_EDGE_PX) as usize;
        let tile_rows = projection.height().div_ceil(TILE_EDGE_PX) as usize;
        let mut list = Self {
            projection,
            objects,
            first_triangle,
            backend: Backend::Scalar,
            pieces,
            tile_columns,
            bin_start: vec![0; tile_columns * tile_rows + 1],
            bins: Vec::new(),
            large: Vec::new(),
        };
        list.fill_bins();
        Ok(list)
    }

    /// Replaces the instruction set of the vectors; no bit depends on it.
    pub fn with_backend(self, backend: Backend) -> Self {
        Self { backend, ..self }
    }

    /// Number of triangles of all objects, visible or not.
    pub fn len(&self) -> u32 {
        self.first_triangle.last().copied().unwrap_or(0)
    }

    /// True if there are no triangles at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Object of a triangle: its index in the objects of the frame.
    pub fn object_index(&self, triangle: u32) -> usize {
        self.first_triangle.partition_point(|&first| first <= triangle).saturating_sub(1)
    }

    /// Setup of a triangle's attributes; `None` if no sample of the frame can show it.
    pub fn triangle(&self, triangle: u32, needs: Needs) -> Option<Triangle<'a>> {
        let object_index = self.object_index(triangle);
        let object = self.objects.get(object_index)?;
        let index = (triangle - self.first_triangle[object_index]) as usize;
        let vertices = corner_vertices(object, index, object.mesh.triangles.get(index)?).ok()?;
        Triangle::new(self.projection, vertices, needs)
    }

    /// Replaces `drawn` by the pieces that may be visible in a part of the frame.
    pub(super) fn drawn(&self, tile: TileRect, drawn: &mut Drawn) {
        let Drawn { pieces, triangles } = drawn;
        pieces.clear();
        triangles.clear();
        let span = |start: u32, edge: u32| start / TILE_EDGE_PX..(start + edge).div_ceil(TILE_EDGE_PX);
        let (rows, columns) = (span(tile.y, tile.height), span(tile.x, tile.width));
        let bins = rows.clone().flat_map(|row| columns.clone().map(move |column| (row as usize, column as usize)));
        for (row, column) in bins {
            let bin = row * self.tile_columns + column;
            pieces.extend(self.bins[self.bin_start[bin]..self.bin_start[bin + 1]].iter().map(|&piece| (piece, 0)));
        }
        let large = self.large.iter().filter(|&&piece| self.pieces[piece as usize].may_touch(tile));
        pieces.extend(large.map(|&piece| (piece, 0)));
        // Each list is in order; a tile of the frame has one list besides the large ones.
        pieces.sort_unstable();
        pieces.dedup();
        for (piece, number) in pieces {
            let triangle = self.pieces[*piece as usize].triangle();
            if triangles.last() != Some(&triangle) {
                triangles.push(triangle);
            }
            *number = triangles.len() as u32 - 1;
        }
    }

    /// Finds the visible triangle of every sample of `tile`, a part of the frame, by its number in `drawn`: the nearest one, or
    /// among equally near ones the first of the frame.
    pub(super) fn draw(&self, drawn: &Drawn, places: &Places, tile: TileRect, buffer: &mut TileBuffer) {
        buffer.clear(tile, places);
        self.backend.run(
            #[inline(always)]
            || {
                for &(piece, number) in &drawn.pieces {
                    self.pieces[piece as usize].draw(number, places, buffer);
                }
            },
        );
    }

    /// Counts the entries of the tiles' lists, then fills them.
    fn fill_bins(&mut self) {
        let tile_rows = (self.bin_start.len() - 1) / self.tile_columns;
        let touched = |piece: &ScreenTriangle| {
            let edge = TILE_EDGE_PX as i32;
            let span = |axis: usize, tiles: usize| {
                let [first, last] = piece.pixels(axis);
                // Each end is inside after the clamp: a piece outside the frame gives an empty range.
                (first.max(0) / edge) as usize..((last + edge).max(0) / edge).min(tiles as i32) as usize
            };
            (span(0, self.tile_columns), span(1, tile_rows))
        };
        let mut entries = Vec::new();
        for (number, piece) in (0_u32..).zip(&self.pieces) {
            let (columns, rows) = touched(piece);
            let tiles = columns.len() * rows.len();
            if tiles > MAX_BINNED_TILES {
                self.large.push(number);
                continue;
            }
            for row in rows {
                for column in columns.clone() {
                    let rect = TileRect {
                        x: column as u32 * TILE_EDGE_PX,
                        y: row as u32 * TILE_EDGE_PX,
                        width: TILE_EDGE_PX,
                        height: TILE_EDGE_PX,
                    };
                    if tiles == 1 || piece.may_touch(rect) {
                        let bin = row * self.tile_columns + column;
                        self.bin_start[bin + 1] += 1;
                        entries.push((bin, number));
                    }
                }
            }
        }
        for bin in 1..self.bin_start.len() {
            self.bin_start[bin] += self.bin_start[bin - 1];
        }
        let mut next = self.bin_start.clone();
        self.bins = vec![0; entries.len()];
        for (bin, number) in entries {
            self.bins[next[bin]] = number;
            next[bin] += 1;
        }
    }
}

/// Vertices of one triangle.
fn corner_vertices<'a>(
    object: &'a Object,
    triangle: usize,
    corners: &[u32; 3],
) -> Result<[&'a Vertex; 3], RasterError> {
    let vertices = &object.mesh.vertices;
    let [a, b, c] = corners.map(|vertex| {
        vertices.get(vertex as usize).ok_or_else(|| {
            let (name, count) = (&object.name, vertices.len());
            let message =
                format!("object {name:?}: triangle {triangle} names vertex {vertex}, but the mesh has {count}");
            RasterError::OutOfRange(message)
        })
    });
    Ok([a?, b?, c?])
}
