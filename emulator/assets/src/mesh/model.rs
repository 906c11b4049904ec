//! The triangles of a glTF model as one mesh.

use std::path::Path;

use glam::DVec3;
use roughxel_utilities::limits::MAX_COORDINATE;

use super::build::{Corner, Face, Polygons, Smoothing};
use super::error::MeshError;
use crate::gltf::Model;

/// Polygons of a model, with what is said of them.
pub(super) struct ReadModel {
    pub(super) polygons: Polygons,
    /// Name of the first part without texture coordinates, with its file.
    pub(super) without_uv: Option<String>,
    pub(super) warnings: Vec<String>,
}

/// Polygons of a glTF model from the file `path`; `offset` becomes the origin. Its materials and images are not used.
pub(super) fn polygons(path: &Path, model: &Model, offset: DVec3) -> Result<ReadModel, MeshError> {
    let without_uv = model.parts.iter().find(|part| part.texcoords.is_empty());
    let without_uv = without_uv.map(|part| format!("{}: `{}`", path.display(), part.name));
    let polygons = joined(model, offset);
    if polygons.positions.iter().any(|position| position.abs().max_element() > MAX_COORDINATE) {
        let message = format!("has a position that is not within ±{MAX_COORDINATE:e} units");
        return Err(MeshError::new(path, message, "move the model to the origin, or give the key `offset`"));
    }
    let mut warnings: Vec<String> = model.ignored.iter().map(|what| format!("{}: {what}", path.display())).collect();
    if !model.materials.is_empty() {
        let remedy = "`roughxel import` makes a scene with them";
        warnings.push(format!("{}: materials of the model are not used here; {remedy}", path.display()));
    }
    Ok(ReadModel { polygons, without_uv, warnings })
}

/// The parts of a model, one behind the other. Faces without normals are flat (glTF 2.0 §3.7.2.1).
fn joined(model: &Model, offset: DVec3) -> Polygons {
    let mut polygons = Polygons::default();
    for part in &model.parts {
        let [position, texcoord, normal] =
            [polygons.positions.len(), polygons.texcoords.len(), polygons.normals.len()].map(|first| first as u32);
        polygons.positions.extend(part.positions.iter().map(|position| *position - offset));
        polygons.texcoords.extend(&part.texcoords);
        polygons.normals.extend(&part.normals);
        let [has_uv, has_normal] = [!part.texcoords.is_empty(), !part.normals.is_empty()];
        for triangle in &part.triangles {
            polygons.corners.extend(triangle.map(|index| Corner {
                position: position + index,
                texcoord: has_uv.then_some(texcoord + index),
                normal: has_normal.then_some(normal + index),
            }));
            polygons.faces.push(Face { end: polygons.corners.len(), smoothing: Smoothing::Flat });
        }
    }
    polygons
}
