//! Triangle meshes from files.
//!
//! [`read_mesh`] decides by a file's own bytes how it is read. A reader fills the format-neutral polygons of `build`, which completes normals and
//! tangents and cuts polygons into triangles.

mod build;
pub(crate) mod error;
pub(crate) mod kind;
mod model;
mod obj;
mod polygon;
mod tangents;
pub(crate) mod triangles;

use std::io::Read as _;
use std::path::Path;

use glam::DVec3;

use roughxel_utilities::input::open_file;

use self::build::Polygons;
use crate::gltf::{Model, parse_model};
pub use error::MeshError;
pub use tangents::Tangents;
pub use triangles::{MAX_TRIANGLES, Mesh, Vertex};

/// Largest file in bytes: 4 million triangles with normals and texture coordinates take about 500 MB.
const MAX_BYTES: u64 = 1 << 29;

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
        return mesh_of_model(path, &parse_model(path, &bytes)?, options);
    }
    if let Some(foreign) = kind::foreign(&bytes) {
        return Err(MeshError::new(path, format!("the file is {}", foreign.what), foreign.remedy));
    }
    parse_obj(path, &kind::text(&bytes), options)
}

/// Joins the parts of a glTF model to one mesh, as [`read_mesh`] does; `path` only names its file. Errors: [`MeshError`].
pub fn mesh_of_model(path: &Path, model: &Model, options: &ReadOptions) -> Result<ReadMesh, MeshError> {
    let model::ReadModel { polygons, without_uv, warnings } = model::polygons(path, model, options.offset)?;
    let read = finish(path, &polygons, without_uv, options.tangents)?;
    Ok(ReadMesh { warnings: [read.warnings, warnings].concat(), ..read })
}

/// Reads OBJ text as [`read_mesh`] reads a file; `path` only names it. Errors: [`MeshError`].
pub fn parse_obj(path: &Path, text: &str, options: &ReadOptions) -> Result<ReadMesh, MeshError> {
    let obj::ReadObj { polygons, without_uv } = obj::polygons(path, text, options.offset)?;
    finish(path, &polygons, without_uv.map(|line| format!("{}:{line}", path.display())), options.tangents)
}

/// Makes a mesh of polygons.
fn finish(
    path: &Path,
    polygons: &Polygons,
    without_uv: Option<String>,
    tangents: Tangents,
) -> Result<ReadMesh, MeshError> {
    let built = build::build(polygons, tangents)
        .ok_or_else(|| MeshError::new(path, "has no face with an area", "export the mesh with polygons (`f` lines)"))?;
    Ok(ReadMesh { mesh: built.mesh, without_uv, warnings: built.warnings })
}
