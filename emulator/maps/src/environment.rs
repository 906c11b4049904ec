//! Environment maps: six faces with mip levels.
//!
//! Faces in Vulkan's order +x, −x, +y, −y, +z, −z with Vulkan's (s_c, t_c); column 0 at s = −1, row 0 at t = −1 (the top row
//! of the face's picture, no flip). All faces and levels share one exponent, so probes may mix them as integers.
//! Each face is filtered for itself: a texel next to an edge holds its own side only, and the filter looks across the
//! edge (the stage `edge` of the datapath).

use roughxel_core::sampler::CubeMemory;

use crate::mip::{Level, colour_levels, quantise, smallest_exponent};
use roughxel_scene::picture::Picture;

/// An environment map with its mip levels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CubePyramid {
    /// Edge of a face at level 0, in texels.
    pub edge: u32,
    /// Level 0 (full size) first, down to 1×1; six faces each, row 0 at t = −1.
    pub levels: Vec<[Level; 6]>,
    /// Value of a code: code / 65536 · 2^exponent, one exponent for all faces.
    pub exponent: i32,
}

impl CubePyramid {
    /// Quantises six faces to 16 bits with the [`smallest_exponent`] that holds their maximum, and builds all levels.
    ///
    /// Rounding: as [`ColourPyramid::new`](crate::mip::ColourPyramid::new).
    ///
    /// # Panics
    /// If the faces are not squares of one size of at least 1, with all their pixels.
    pub fn new(faces: &[Picture; 6]) -> Self {
        Self::with_exponent(faces, smallest_exponent(faces))
    }

    /// As [`CubePyramid::new`], with a given exponent; brighter pixels than 2^exponent saturate to code 65535.
    ///
    /// # Panics
    /// If the faces are not squares of one size of at least 1, with all their pixels.
    pub fn with_exponent(faces: &[Picture; 6], exponent: i32) -> Self {
        let edge = faces[0].width;
        assert!(
            faces.iter().all(|face| edge > 0 && (face.width, face.height) == (edge, edge)),
            "an environment needs six square faces of one size"
        );
        let mut pyramids = faces.each_ref().map(|face| {
            let texels = face.pixels.iter().map(|pixel| quantise(*pixel, exponent));
            colour_levels(edge, edge, texels.collect()).into_iter()
        });
        let mut levels = Vec::new();
        while let [Some(a), Some(b), Some(c), Some(d), Some(e), Some(f)] = pyramids.each_mut().map(Iterator::next) {
            levels.push([a, b, c, d, e, f]);
        }
        Self { edge, levels, exponent }
    }
}

impl CubeMemory for CubePyramid {
    #[inline(always)]
    fn texel(&self, level: u32, face: u32, column: u32, row: u32) -> [u16; 3] {
        self.levels[level as usize][face as usize].texel(column, row)
    }

    /// Side by side in memory.
    #[inline(always)]
    fn patch(&self, level: u32, face: u32, column: u32, row: u32) -> [[u16; 3]; 4] {
        let level = &self.levels[level as usize][face as usize];
        let first = row as usize * level.width as usize + column as usize;
        [first, first + 1, first + level.width as usize, first + level.width as usize + 1]
            .map(|index| level.texels[index])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_pyramid_keeps_the_rows_of_its_pictures_and_one_exponent() {
        let mut faces: [Picture; 6] = std::array::from_fn(|face| Picture::filled(6, 6, [face as f32 / 8.0; 3]));
        faces[2].pixels[0] = [3.0; 3];
        let cube = CubePyramid::new(&faces);
        assert_eq!((cube.edge, cube.exponent), (6, 2));
        let edges: Vec<_> = cube.levels.iter().map(|level| level[5].height).collect();
        assert_eq!(edges, [6, 3, 1]);
        assert_eq!(cube.levels[0][2].texel(0, 0), [49152; 3]);
        assert_eq!(cube.levels[2][4].texel(0, 0), [8192; 3]);
    }
}
