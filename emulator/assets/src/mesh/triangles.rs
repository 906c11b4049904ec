//! Triangles: what every reader of meshes ends in.

use glam::{DVec2, DVec3};

/// Indexed triangles in world space; counter-clockwise seen from the side of the normal for the built-in shapes.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Vertices.
    pub vertices: Vec<Vertex>,
    /// Vertex indices, all below `vertices.len()`; no triangle has zero area.
    pub triangles: Vec<[u32; 3]>,
}

/// One vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Position, world units.
    pub position: DVec3,
    /// Unit normal, world space.
    pub normal: DVec3,
    /// Texture coordinates in repeats of the map: u to the right, v up, (0, 0) the bottom-left corner.
    pub uv: DVec2,
    /// ∂p/∂u and ∂p/∂v in world units per repeat; both zero if a mesh has no texture coordinates.
    ///
    /// If a mesh mirrors its map, ∂p/∂u and ∂p/∂v are negated. S97's s_u = n × p_v and s_v = p_u × n then still run
    /// against the true p_u and p_v, so that bumps stay bumps. Those of [`Tangents::MikkTSpace`](super::Tangents) have length 1.
    pub tangents: [DVec3; 2],
}

/// Most triangles of a file.
pub const MAX_TRIANGLES: usize = 4_000_000;
