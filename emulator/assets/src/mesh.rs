//! Triangle meshes from files.
//!
//! [`read_mesh`] decides by a file's own bytes how it is read. A reader fills the format-neutral polygons of `build`, which completes normals and
//! tangents and cuts polygons into triangles.

mod build;
mod kind;
mod model;
mod obj;
mod polygon;
mod tangents;
#[cfg(test)]
mod tests;

use std::io::Read as _;
use std::path::Path;

use glam::{DVec2, DVec3};

use roughxel_utilities::input::open_file;

pub use tangents::Tangents;

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
    /// against the true p_u and p_v, so that bumps stay bumps.
    pub tangents: [DVec3; 2],
}

/// Most triangles of a file.
pub const MAX_TRIANGLES: usize = 4_000_000;
/// Largest file in bytes: 4 million triangles with normals and texture coordinates take about 500 MB.
const MAX_BYTES: u64 = 1 << 29;

/// Reason why a mesh cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{place}: {message}; {remedy}")]
pub struct MeshError {
    /// The file, with the line from 1 if a line is wrong.
    pub place: String,
    /// The mistake.
    pub message: String,
    /// The way to mend it.
    pub remedy: String,
}

impl MeshError {
    pub(crate) fn new(path: &Path, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { place: path.display().to_string(), message: message.into(), remedy: remedy.into() }
    }

    /// An error in a line of a text, from 1.
    fn in_line(path: &Path, line: usize, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { place: format!("{}:{line}", path.display()), ..Self::new(path, message, remedy) }
    }

    /// An error for a file or a number of triangles beyond the limit.
    fn too_large(path: &Path, what: &str, limit: u64) -> Self {
        Self::new(path, format!("{what} is more than {limit}"), "simplify the mesh")
    }
}

/// Choices of the caller that a file does not contain.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReadOptions {
    /// Point of the file that becomes the origin, in units of the file.
    pub offset: DVec3,
    /// Directions of p_u and p_v.
    pub tangents: Tangents,
}

/// A mesh read from a file.
#[derive(Debug)]
pub struct ReadMesh {
    /// Its triangles.
    pub mesh: Mesh,
    /// Place of the first face without texture coordinates: file and line. A map cannot be drawn there.
    pub without_uv: Option<String>,
    /// Repairs, one sentence each.
    pub warnings: Vec<String>,
}

/// Reads a mesh file. Errors: [`MeshError`].
pub fn read_mesh(path: &Path, options: &ReadOptions) -> Result<ReadMesh, MeshError> {
    let unreadable = |source: std::io::Error| {
        let remedy = if source.kind() == std::io::ErrorKind::NotFound {
            "paths are relative to the scene file"
        } else {
            "name a file that can be read"
        };
        MeshError::new(path, format!("cannot read the mesh: {source}"), remedy)
    };
    let mut file = open_file(path).map_err(unreadable)?;
    let bytes_long = file.metadata().map_err(unreadable)?.len();
    if bytes_long > MAX_BYTES {
        return Err(MeshError::too_large(path, &format!("a file of {bytes_long} bytes"), MAX_BYTES));
    }
    let mut bytes = Vec::with_capacity(bytes_long as usize);
    file.read_to_end(&mut bytes).map_err(unreadable)?;
    if kind::is_gltf(&bytes) {
        return model::read(path, &bytes, options);
    }
    if let Some(foreign) = kind::foreign(&bytes) {
        return Err(MeshError::new(path, format!("the file is {}", foreign.what), foreign.remedy));
    }
    parse_obj(path, &kind::text(&bytes), options)
}

/// Reads OBJ text as [`read_mesh`] reads a file; `path` only names it. Errors: [`MeshError`].
pub fn parse_obj(path: &Path, text: &str, options: &ReadOptions) -> Result<ReadMesh, MeshError> {
    let obj::ReadObj { polygons, without_uv } = obj::polygons(path, text, options.offset)?;
    let built = build::build(&polygons, options.tangents)
        .ok_or_else(|| MeshError::new(path, "has no face with an area", "export the mesh with polygons (`f` lines)"))?;
    let without_uv = without_uv.map(|line| format!("{}:{line}", path.display()));
    Ok(ReadMesh { mesh: built.mesh, without_uv, warnings: built.warnings })
}
