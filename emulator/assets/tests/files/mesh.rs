//! Meshes as files of many kinds have them. Right values come from computations that share no code with the readers.

mod faces;
mod general;
mod kinds;
mod normals;
mod polygons;
mod tangents;

use std::path::Path;

use roughxel_assets::{MeshError, ReadMesh, ReadOptions, parse_obj};

fn read(text: &str) -> Result<ReadMesh, MeshError> {
    parse_obj(Path::new("test.obj"), text, &ReadOptions::default())
}

fn message(text: &str) -> String {
    read(text).map_or_else(|error| error.to_string(), |_| "no error".to_owned())
}
