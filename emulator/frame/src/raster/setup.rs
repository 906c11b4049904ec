//! The triangles of a frame: clipped, snapped and sorted into tiles once, then drawn tile by tile.
//!
//! Triangles are numbered through all objects in their order. Each tile has a list of the pieces that may touch it; a
//! piece over more than [`MAX_BINNED_TILES`] tiles is kept in one list for all tiles, which bounds the memory.
//! The order of drawing cannot change the picture, so neither can the order of the lists.

use super::attributes::{Needs, Triangle};
use super::camera::Projection;
use super::clip::ScreenPolygon;
use super::edges::{DepthPlane, ScreenTriangle, TileBuffer};
use super::{MAX_TRIANGLES, RasterError, SUBPIXELS, TILE_EDGE_PX, TileRect};
use roughxel_scene::{Object, Vertex};

/// Most tiles whose lists one piece is entered in.
const MAX_BINNED_TILES: usize = 16;

/// All triangles of a frame that may be visible.
#[derive(Clone, Debug)]
pub struct TriangleList<'a> {
    projection: &'a Projection,
    objects: &'a [Object],
    /// Number of the first triangle of each object, then the number of all triangles.
    first_triangle: Vec<u32>,
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
    /// Triangles that are not finite, behind the near plane, outside the frame or of no area (in the world or on the sub-pixel grid) are left
    /// out. Errors: a vertex index out of range, more than [`MAX_TRIANGLES`] triangles.
    pub fn new(projection: &'a Projection, objects: &'a [Object]) -> Result<Self, RasterError> {
        let count: u64 = objects.iter().map(|object| object.mesh.triangles.len() as u64).sum();
        if count > u64::from(MAX_TRIANGLES) {
            return Err(RasterError::TooManyTriangles { count });
        }
        let mut first_triangle = vec![0];
        let mut pieces = Vec::new();
        let mut number = 0;
        for object in objects {
            for (index, corners) in object.mesh.triangles.iter().enumerate() {
                let vertices = corner_vertices(object, index, corners)?;
                if let Some(polygon) = ScreenPolygon::new(projection, vertices.map(|v| v.position)) {
                    let depth = DepthPlane::new(&polygon, projection.near());
                    pieces.extend(polygon.pieces().map(|piece| ScreenTriangle::new(piece, depth, number)));
                }
                number += 1;
            }
            first_triangle.push(number);
        }
        let tile_columns = projection.width().div_ceil(TILE_EDGE_PX) as usize;
        let tile_rows = projection.height().div_ceil(TILE_EDGE_PX) as usize;
        let mut list = Self {
            projection,
            objects,
            first_triangle,
            pieces,
            tile_columns,
            bin_start: vec![0; tile_columns * tile_rows + 1],
            bins: Vec::new(),
            large: Vec::new(),
        };
        list.fill_bins();
        Ok(list)
    }

    /// Number of triangles of all objects, visible or not.
    pub fn len(&self) -> u32 {
        self.first_triangle.last().copied().unwrap_or(0)
    }

    /// Whether there are no triangles at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Object of a triangle: its index in the objects of the frame.
    pub fn object_index(&self, triangle: u32) -> usize {
        self.first_triangle.partition_point(|&first| first <= triangle).saturating_sub(1)
    }

    /// Setup of a triangle's attributes; `None` when no sample of the frame can show it.
    pub fn triangle(&self, triangle: u32, needs: Needs) -> Option<Triangle<'a>> {
        let object_index = self.object_index(triangle);
        let object = self.objects.get(object_index)?;
        let index = (triangle - self.first_triangle[object_index]) as usize;
        let vertices = corner_vertices(object, index, object.mesh.triangles.get(index)?).ok()?;
        Triangle::new(self.projection, vertices, needs)
    }

    /// Finds the visible triangle of one sample per pixel of `tile`, at `sample_offset_subpx` from the pixel's top-left
    /// corner (0 to 255 sub-pixels each, the centre is [`super::PIXEL_CENTRE_SUBPX`]).
    ///
    /// `tile` is taken as far as it lies in the frame; offsets outside 0 to 255 are taken to the nearest.
    pub fn rasterise_tile(&self, tile: TileRect, sample_offset_subpx: [i32; 2], buffer: &mut TileBuffer) {
        let (x, y) = (tile.x.min(self.projection.width()), tile.y.min(self.projection.height()));
        let tile = TileRect {
            x,
            y,
            width: tile.width.min(self.projection.width() - x),
            height: tile.height.min(self.projection.height() - y),
        };
        buffer.clear(tile);
        if tile.width == 0 || tile.height == 0 {
            return;
        }
        let offset = sample_offset_subpx.map(|steps| steps.clamp(0, SUBPIXELS - 1));
        let span = |start: u32, edge: u32| start / TILE_EDGE_PX..=(start + edge - 1) / TILE_EDGE_PX;
        for row in span(tile.y, tile.height) {
            for column in span(tile.x, tile.width) {
                let bin = row as usize * self.tile_columns + column as usize;
                for &piece in &self.bins[self.bin_start[bin]..self.bin_start[bin + 1]] {
                    self.pieces[piece as usize].draw(offset, buffer);
                }
            }
        }
        for &piece in &self.large {
            let piece = &self.pieces[piece as usize];
            if piece.may_touch(tile) {
                piece.draw(offset, buffer);
            }
        }
    }

    /// Counts, then fills, the lists of the tiles.
    fn fill_bins(&mut self) {
        let tile_rows = (self.bin_start.len() - 1) / self.tile_columns;
        let touched = |piece: &ScreenTriangle| {
            let edge = TILE_EDGE_PX as i32;
            let span = |axis: usize, tiles: usize| {
                let [first, last] = piece.pixels(axis);
                // Both are inside after the clamp: a piece outside the frame yields an empty range.
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
        vertices.get(vertex as usize).ok_or_else(|| RasterError::VertexIndex {
            object: object.name.clone(),
            triangle,
            vertex,
            vertices: vertices.len(),
        })
    });
    Ok([a?, b?, c?])
}
