//! Pictures, cube maps, meshes and models of all kinds, intact and damaged, as their users read them.

mod cube;
mod gltf;
mod hdr;
mod mesh;
mod picture;
