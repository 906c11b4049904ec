//! # roughxel-assets
//!
//! Files that people bring: pictures and meshes, read as they say they are meant.
//!
//! `picture` reads and writes pictures; `mesh` reads triangles. Sizes are bounded before memory is taken.

mod file_kind;
pub mod gltf;
mod mesh;
pub mod picture;

pub use file_kind::{FileKind, file_kind};
pub use mesh::{
    MAX_TRIANGLES, Mesh, MeshError, ReadMesh, ReadOptions, Tangents, Vertex, mesh_of_model, parse_obj, read_mesh,
};
pub use picture::Picture;
