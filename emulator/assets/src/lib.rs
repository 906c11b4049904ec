//! # roughxel-assets
//!
//! Files that people bring: pictures and meshes, read as they say they are meant.
//!
//! `picture` reads and writes pictures; `mesh` reads triangles. Sizes are bounded before memory is taken.

pub mod gltf;
mod mesh;
pub mod picture;

pub use mesh::{MAX_TRIANGLES, Mesh, MeshError, ReadMesh, ReadOptions, Tangents, Vertex, parse_obj, read_mesh};
pub use picture::Picture;
