//! The scene file of a model.

use std::path::Path;

use glam::DVec3;
use roughxel_assets::gltf::{Model, ModelCamera, Part};
use roughxel_frame::raster::Projection;
use roughxel_utilities::limits::MAX_COORDINATE;
use serde_json::json;

use super::maps::MaterialMaps;

/// Vertical angle of view of the camera of a model without one, in degrees.
const FOV_Y_DEGREES: f64 = 40.0;

/// A text in quotes. JSON's escapes are TOML's.
fn quoted(text: &str) -> String {
    json!(text).to_string()
}

fn numbers(all: impl IntoIterator<Item = f64>) -> String {
    let all: Vec<String> = all.into_iter().map(|number| format!("{:?}", (number * 1e6).round() / 1e6 + 0.0)).collect();
    format!("[{}]", all.join(", "))
}

/// A place with six decimals, or with all digits if a sight is shorter than a unit.
fn place(point: DVec3, sight: f64) -> String {
    if sight >= 1.0 { numbers(point.to_array()) } else { format!("{:?}", point.to_array()) }
}

/// The `[[object]]` of a part.
pub(super) fn object(part: &Part, path: &str, folder: &str, maps: &MaterialMaps) -> String {
    let mut text = format!(
        "[[object]]\nname = {}\nshape = \"mesh\"\npath = {}\n\n[object.material]\nreflectance = {}\ncolour = {}\n",
        quoted(&part.name),
        quoted(path),
        numbers(maps.reflectance),
        numbers(maps.colour),
    );
    let file = |name: &str| quoted(&format!("{folder}/{name}"));
    if let Some(name) = &maps.colour_map {
        text += &format!("colour_map = {{ path = {} }}\n", file(name));
    }
    if let Some(name) = &maps.normal_map {
        text += &format!("normal_map = {{ path = {}, coding = \"gltf\" }}\n", file(name));
    }
    let deviation = (maps.deviation * 1e6).round() / 1e6;
    match &maps.roughness_map {
        Some(name) => text += &format!("roughness_map = {{ path = {}, deviation = {deviation:?} }}\n", file(name)),
        // The direction of a uniform roughness needs texture coordinates, too.
        None if deviation > 0.0 && maps.has_uv => {
            let along = format!("along = {deviation:?}, across = {deviation:?}");
            text += &format!("roughness_map = {{ generate = \"uniform\", {along} }}\n");
        }
        None => {}
    }
    text
}

/// The whole file.
pub(super) fn scene(model_path: &Path, model: &Model, objects: &[String]) -> String {
    let camera = camera(model);
    let ModelCamera { eye, up, fov_y_degrees, .. } = camera;
    let target = target(&camera);
    let sight = (target - eye).length();
    let name = model_path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let shown = name.replace(|c: char| c.is_control(), " ");
    format!(
        "# Made from {shown} by `roughxel import`.\n\n[camera]\neye = {}\ntarget = {}\nup = {}\nfov_y = {:?}\n\n\
         [environment]\ngenerate = \"sky\"\n\n{}",
        place(eye, sight),
        place(target, sight),
        numbers(up.to_array()),
        (fov_y_degrees * 1e3).round() / 1e3,
        objects.join("\n"),
    )
}

/// The camera of a model, or one that sees all of it.
pub(super) fn camera(model: &Model) -> ModelCamera {
    model.camera.unwrap_or_else(|| overview(model))
}

/// Point that a camera looks at. Its distance gives the scene the near plane of the camera, unless the point would lie beyond the coordinates of scenes.
pub(super) fn target(camera: &ModelCamera) -> DVec3 {
    let coordinate = camera.eye.abs().max_element();
    let room = MAX_COORDINATE - coordinate;
    let least = 1e-9 * coordinate;
    camera.eye + camera.forward * (camera.near / Projection::NEAR_SHARE).min(room).max(least)
}

/// A camera that sees all parts, from the front (+z) and a little above. It looks at their centre.
fn overview(model: &Model) -> ModelCamera {
    let positions = || model.parts.iter().flat_map(|part| &part.positions).copied();
    let low = positions().fold(DVec3::INFINITY, DVec3::min);
    let high = positions().fold(DVec3::NEG_INFINITY, DVec3::max);
    let radius = (high - low).length() / 2.0;
    let radius = if radius > 0.0 { radius } else { 1.0 };
    let outwards = DVec3::new(0.3, 0.25, 1.0).normalize();
    let distance = 1.05 * radius / (FOV_Y_DEGREES / 2.0).to_radians().sin();
    ModelCamera {
        eye: (low + high) / 2.0 + outwards * distance,
        forward: -outwards,
        up: DVec3::Y,
        fov_y_degrees: FOV_Y_DEGREES,
        near: distance * Projection::NEAR_SHARE,
    }
}
