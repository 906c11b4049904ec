//! The triangles of a glTF model as one mesh.

use std::path::Path;

use super::build::{Corner, Face, Polygons, Smoothing, build};
use super::{MeshError, ReadMesh, ReadOptions};
use roughxel_utilities::limits::MAX_COORDINATE;

use crate::gltf::{Model, parse_model};

/// Reads a glTF model. Its materials and images are not used.
pub(super) fn read(path: &Path, bytes: &[u8], options: &ReadOptions) -> Result<ReadMesh, MeshError> {
    let model = parse_model(path, bytes)?;
    let without_uv = model.parts.iter().find(|part| part.texcoords.is_empty());
    let without_uv = without_uv.map(|part| format!("{}: `{}`", path.display(), part.name));
    let nothing = || MeshError::new(path, "has no triangle with an area", "export the model with its meshes");
    let polygons = polygons(&model, options);
    if polygons.positions.iter().any(|position| position.abs().max_element() > MAX_COORDINATE) {
        let message = format!("has a position that is not within ±{MAX_COORDINATE:e} units");
        return Err(MeshError::new(path, message, "move the model to the origin, or give the key `offset`"));
    }
    let built = build(&polygons, options.tangents).ok_or_else(nothing)?;
    let mut warnings = built.warnings;
    warnings.extend(model.ignored.iter().map(|what| format!("{}: {what}", path.display())));
    if !model.materials.is_empty() {
        let remedy = "`roughxel import` makes a scene with them";
        warnings.push(format!("{}: materials and textures of the model are not used here; {remedy}", path.display()));
    }
    Ok(ReadMesh { mesh: built.mesh, without_uv, warnings })
}

/// The parts of a model, one behind the other. Faces without normals are flat (glTF 2.0 §3.7.2.1).
fn polygons(model: &Model, options: &ReadOptions) -> Polygons {
    let mut polygons = Polygons::default();
    for part in &model.parts {
        let [position, texcoord, normal] =
            [polygons.positions.len(), polygons.texcoords.len(), polygons.normals.len()].map(|first| first as u32);
        polygons.positions.extend(part.positions.iter().map(|position| *position - options.offset));
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
