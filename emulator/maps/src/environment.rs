//! Environment maps: six faces with mip levels, and neighbours across edges.
//!
//! Faces in Vulkan's order +x, −x, +y, −y, +z, −z with Vulkan's (s_c, t_c); column 0 at s = −1, row 0 at t = −1 (the top row
//! of the face's picture, no flip). All faces and levels share one exponent, so probes may mix them as integers.
//! Each face is filtered for itself: a texel next to an edge holds its own side only, and the filter looks across the
//! edge ([`texel_across_edge`]).

use crate::mip::{Level, colour_levels, quantise, smallest_exponent};
use roughxel_scene::cube::FACE_AXES;
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

/// A texel of a cube map level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FaceTexel {
    /// Face in Vulkan's order, 0…5.
    pub face: u8,
    /// Column, from s = −1.
    pub i: u32,
    /// Row, from t = −1.
    pub j: u32,
}

/// What lies at a texel address of a face that may be one step outside of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CubeTexel {
    /// A texel of this face or of the one across an edge.
    Texel(FaceTexel),
    /// Diagonally outside, where no texel is: the three texels around the corner, the face's own first, then those
    /// across its s and t edges. The filter takes their mean (three equal texels give that value).
    Corner([FaceTexel; 3]),
}

/// The texel at column `i` and row `j` of a face of `edge` × `edge` texels, with i or j in {−1, edge} across the edge.
///
/// Integers only, no division. With the cube's centre at the origin and units of half a texel, the texel's centre is the
/// vector (s, t, m) = (2i + 1 − edge, 2j + 1 − edge, edge). Folding it over the edge makes the component that is outside the new
/// major one, ±edge, and the old major one edge − 1, the centre of the first row of texels behind the edge. The map is
/// an involution on every edge. Range: edge 1…16384; a face above 5 counts as 5,
/// a position further outside as one step outside.
pub fn texel_across_edge(face: u8, i: i32, j: i32, edge: u32) -> CubeTexel {
    let face = usize::from(face).min(5);
    let edge = edge as i32;
    let (i_inside, j_inside) = (i.clamp(0, edge - 1), j.clamp(0, edge - 1));
    let own = FaceTexel { face: face as u8, i: i_inside as u32, j: j_inside as u32 };
    let across_s = || fold([i, j_inside], 0, face, edge);
    let across_t = || fold([i_inside, j], 1, face, edge);
    match (i == i_inside, j == j_inside) {
        (true, true) => CubeTexel::Texel(own),
        (false, true) => CubeTexel::Texel(across_s()),
        (true, false) => CubeTexel::Texel(across_t()),
        (false, false) => CubeTexel::Corner([own, across_s(), across_t()]),
    }
}

/// The texel behind the edge that `position[outside]` is beyond (outside: 0 = s, 1 = t).
fn fold(position: [i32; 2], outside: usize, face: usize, edge: i32) -> FaceTexel {
    let [s, t] = position.map(|index| 2 * index + 1 - edge);
    let mut local = [s, t, edge - 1];
    local[outside] = if local[outside] < 0 { -edge } else { edge };
    let mut vector = [0; 3];
    for ((axis, sign), component) in FACE_AXES[face].into_iter().zip(local) {
        vector[axis] = sign * component;
    }
    let (major, _) = FACE_AXES[face][outside];
    let face = 2 * major + usize::from(vector[major] < 0);
    let [column, row, _] = FACE_AXES[face].map(|(axis, sign)| sign * vector[axis]);
    FaceTexel { face: face as u8, i: ((column + edge - 1) >> 1) as u32, j: ((row + edge - 1) >> 1) as u32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EDGES: [u32; 5] = [1, 2, 3, 8, 13];

    /// Centre of a texel in space, in units of half a texel.
    fn centre(texel: FaceTexel, edge: u32) -> [i32; 3] {
        let edge = edge as i32;
        let local = [2 * texel.i as i32 + 1 - edge, 2 * texel.j as i32 + 1 - edge, edge];
        let mut vector = [0; 3];
        for ((axis, sign), component) in FACE_AXES[usize::from(texel.face)].into_iter().zip(local) {
            vector[axis] = sign * component;
        }
        vector
    }

    fn distance_squared(a: [i32; 3], b: [i32; 3]) -> i32 {
        a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
    }

    fn all_texels(edge: u32) -> impl Iterator<Item = FaceTexel> {
        (0..6).flat_map(move |face| (0..edge).flat_map(move |j| (0..edge).map(move |i| FaceTexel { face, i, j })))
    }

    /// Steps (di, dj) from a texel to the four sides, with what lies there.
    fn steps(texel: FaceTexel, edge: u32) -> [(i32, i32, CubeTexel); 4] {
        [(-1, 0), (1, 0), (0, -1), (0, 1)].map(|(di, dj)| {
            let (i, j) = (texel.i as i32 + di, texel.j as i32 + dj);
            (di, dj, texel_across_edge(texel.face, i, j, edge))
        })
    }

    #[test]
    fn the_texel_across_an_edge_is_the_nearest_one_of_the_other_faces() {
        for edge in EDGES {
            for texel in all_texels(edge) {
                for (di, dj, neighbour) in steps(texel, edge) {
                    let CubeTexel::Texel(neighbour) = neighbour else {
                        panic!("a step to the side never meets a corner")
                    };
                    assert!(neighbour.i < edge && neighbour.j < edge);
                    if neighbour.face == texel.face {
                        continue;
                    }
                    // The middle of the shared edge of the two squares.
                    let here = centre(texel, edge);
                    let [(s, s_sign), (t, t_sign), _] = FACE_AXES[usize::from(texel.face)];
                    let mut border = here;
                    border[s] += s_sign * di;
                    border[t] += t_sign * dj;
                    let nearest = all_texels(edge)
                        .filter(|other| other.face != texel.face)
                        .min_by_key(|other| distance_squared(centre(*other, edge), border));
                    assert_eq!(nearest, Some(neighbour), "{texel:?} {di} {dj}, edge {edge}");
                    assert_eq!(distance_squared(centre(neighbour, edge), border), 1);
                    assert_eq!(distance_squared(centre(neighbour, edge), here), 2);
                }
            }
        }
    }

    #[test]
    fn going_across_an_edge_and_back_returns_to_the_texel() {
        for edge in EDGES {
            for texel in all_texels(edge) {
                let neighbours = steps(texel, edge).map(|(.., neighbour)| neighbour);
                for (index, neighbour) in neighbours.iter().enumerate() {
                    assert!(!neighbours[..index].contains(neighbour), "four different ones");
                    let CubeTexel::Texel(neighbour) = *neighbour else {
                        panic!("a step to the side never meets a corner")
                    };
                    let back =
                        steps(neighbour, edge).iter().filter(|(.., there)| *there == CubeTexel::Texel(texel)).count();
                    assert_eq!(back, 1, "{texel:?} → {neighbour:?}, edge {edge}");
                }
            }
        }
    }

    #[test]
    fn corners_name_the_three_texels_that_touch_them() {
        for edge in EDGES {
            let last = edge as i32;
            let mut corners = Vec::new();
            for face in 0..6 {
                for (i, j) in [(-1, -1), (last, -1), (-1, last), (last, last)] {
                    let CubeTexel::Corner(texels) = texel_across_edge(face, i, j, edge) else {
                        panic!("both coordinates are outside")
                    };
                    assert_eq!(texels[0].face, face);
                    let faces: std::collections::BTreeSet<_> = texels.iter().map(|texel| texel.face).collect();
                    assert_eq!(faces.len(), 3);
                    // The corner of the cube next to which all three centres lie, at distance √2.
                    let [(s, s_sign), (t, t_sign), (m, m_sign)] = FACE_AXES[usize::from(face)];
                    let mut corner = [0; 3];
                    corner[s] = s_sign * i.signum() * last;
                    corner[t] = t_sign * j.signum() * last;
                    corner[m] = m_sign * last;
                    for texel in texels {
                        assert_eq!(distance_squared(centre(texel, edge), corner), 2);
                    }
                    let mut set = texels.map(|texel| (texel.face, texel.i, texel.j));
                    set.sort_unstable();
                    corners.push((corner, set));
                }
            }
            // Each of the eight corners is the same three texels from all three faces.
            corners.sort_unstable();
            corners.dedup();
            assert_eq!(corners.len(), 8);
        }
    }

    #[test]
    fn texels_inside_are_themselves_and_far_positions_are_total() {
        let inside = FaceTexel { face: 3, i: 2, j: 5 };
        assert_eq!(texel_across_edge(3, 2, 5, 8), CubeTexel::Texel(inside));
        assert_eq!(texel_across_edge(3, 2, -100, 8), texel_across_edge(3, 2, -1, 8));
        assert_eq!(texel_across_edge(200, 0, 0, 1), texel_across_edge(5, 0, 0, 1));
    }

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
