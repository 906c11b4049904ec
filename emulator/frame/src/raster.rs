//! Rasterisation of triangles into fragments: camera, clipping, setup and the integer rasteriser.
//!
//! The host turns every triangle into plane equations with exactly rounded float64 operations only (+, −, ×, ÷, √; the field of
//! view uses `libm`). Visibility at a sample is decided in integers, its attributes in the same few float64 operations. The bits
//! are the same on every machine and for every order of tiles. Drawing is deferred: [`TriangleList::samples`] finds the visible
//! triangle of each sample, [`Triangle::fragment`] its attributes, as ports of the datapath.
//!
//! Screen: x right, y down, in pixels or in sub-pixels of 1/256 px; the centre of pixel (i, j) is the sub-pixel position (256 i +
//! 128, 256 j + 128). Edges follow the top-left rule. Back faces are drawn, because mirrors may be open surfaces; the normal is
//! that of the mesh. Nothing is drawn nearer than [`Projection::near`]. v and the unnormalised n are linear in screen space, as
//! W97 allows (section "The calculation of the three contributions"), so their derivatives are constant over a triangle. The sign
//! of ∂v is that of erratum 11.

mod attributes;
mod blocks;
mod camera;
mod clip;
mod coverage;
mod edges;
mod setup;
#[cfg(test)]
mod tests;

use thiserror::Error;

pub use attributes::{PointFromTriangle, Triangle};
pub use blocks::Positions;
pub use camera::Projection;
pub use coverage::{Pass, Sample, Sampling, TileSamples};
pub use setup::TriangleList;

/// Bits of the sub-pixel grid: one pixel is 2^8 steps.
pub const SUBPIXEL_BITS: u32 = 8;
/// Sub-pixel steps in one pixel.
pub const SUBPIXELS: i32 = 1 << SUBPIXEL_BITS;
/// Sample offset of the pixel centre, in sub-pixels.
pub const PIXEL_CENTRE_SUBPX: [i32; 2] = [SUBPIXELS / 2; 2];
/// Edge of the tiles of [`tiles`] in pixels.
pub const TILE_EDGE_PX: u32 = 64;
/// Largest edge of a frame in pixels.
pub const MAX_EDGE_PX: u32 = 16_384;
/// Most triangles of a frame: six pieces of each still have 32-bit numbers.
pub const MAX_TRIANGLES: u32 = 1 << 29;

/// Reason why a frame cannot be set up.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum RasterError {
    /// A camera or triangles out of range.
    #[error("{0}")]
    OutOfRange(String),
    /// The bump map of an object has no peaks.
    #[error(transparent)]
    Peaks(#[from] roughxel_peaks::ObjectPeakError),
}

/// A rectangle of pixels of the frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TileRect {
    /// Left column, pixels.
    pub x: u32,
    /// Top row, pixels.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// The tiles of a frame of `width` × `height` pixels, left to right and top to bottom. The last tiles may be smaller.
pub fn tiles(width: u32, height: u32) -> impl Iterator<Item = TileRect> {
    let starts = |edge: u32| (0..edge).step_by(TILE_EDGE_PX as usize);
    starts(height).flat_map(move |y| {
        starts(width).map(move |x| TileRect {
            x,
            y,
            width: TILE_EDGE_PX.min(width - x),
            height: TILE_EDGE_PX.min(height - y),
        })
    })
}

/// The tiles of [`tiles`], each with its rows of the frame's pixels, so that threads write tiles in parallel without a copy of
/// the frame. The list takes 16 bytes for each row of a tile, ¼ byte a pixel of whole tiles.
///
/// # Panics
/// If `width` is 0.
pub fn tile_rows<T>(pixels: &mut [T], width: u32, height: u32) -> Vec<(TileRect, Vec<&mut [T]>)> {
    let edge = TILE_EDGE_PX as usize;
    let mut places: Vec<(TileRect, Vec<&mut [T]>)> =
        tiles(width, height).map(|tile| (tile, Vec::with_capacity(tile.height as usize))).collect();
    let across = width.div_ceil(TILE_EDGE_PX) as usize;
    for (places, band) in places.chunks_mut(across).zip(pixels.chunks_mut(width as usize * edge)) {
        for row in band.chunks_mut(width as usize) {
            for ((_, rows), part) in places.iter_mut().zip(row.chunks_mut(edge)) {
                rows.push(part);
            }
        }
    }
    places
}
