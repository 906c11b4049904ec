//! Lines for people and objects for programs.

use glam::DVec3;
use roughxel_assets::ReadMesh;
use roughxel_assets::gltf::Model;
use roughxel_assets::picture::Statement;
use roughxel_scene::{PictureUse, Scene};
use serde_json::{Value, json};

use crate::console::counted;

/// Findings about a file.
pub(super) struct Findings {
    pub(super) lines: Vec<String>,
    pub(super) json: Value,
}

fn warning_lines(warnings: &[String]) -> impl Iterator<Item = String> {
    warnings.iter().map(|warning| format!("warning: {warning}"))
}

impl Findings {
    /// A picture, with the warnings of a scene that takes it.
    pub(super) fn of_picture(statement: &Statement, warnings: &[String]) -> Self {
        let mut lines = vec![statement.to_string()];
        let said = [("colour space", &statement.colour_space), ("transfer function", &statement.transfer)];
        for (what, said) in said {
            if let Some(said) = said {
                let words = said.said.as_deref().unwrap_or("nothing");
                lines.push(format!("{what}: the file says {words}; used: {}", said.used));
            }
        }
        if !statement.left.is_empty() {
            lines.push(format!("channels that are not taken: {}", statement.left.join(", ")));
        }
        lines.extend(statement.notes.iter().cloned());
        lines.extend(statement.ignored.iter().map(|ignored| format!("ignored: {ignored}")));
        lines.extend(warning_lines(warnings));
        let mut json = json!(statement);
        json["warnings"] = json!(warnings);
        Self { lines, json }
    }

    /// A mesh: lines and keys that a model has, too.
    pub(super) fn of_mesh(read: &ReadMesh) -> Self {
        let positions = || read.mesh.vertices.iter().map(|vertex| vertex.position);
        let low = positions().fold(DVec3::INFINITY, DVec3::min).to_array();
        let high = positions().fold(DVec3::NEG_INFINITY, DVec3::max).to_array();
        let (triangles, vertices) = (read.mesh.triangles.len(), read.mesh.vertices.len());
        let vertex_word = if vertices == 1 { "vertex" } else { "vertices" };
        let mut lines = vec![
            format!("mesh of {}, {vertices} {vertex_word}", counted(triangles, "triangle")),
            format!("from {low:?} to {high:?}"),
            read.without_uv.as_ref().map_or_else(
                || "texture coordinates on every face".to_owned(),
                |place| format!("no texture coordinates at {place}: maps cannot be drawn"),
            ),
        ];
        lines.extend(warning_lines(&read.warnings));
        let json = json!({
            "kind": "mesh", "triangles": triangles, "vertices": vertices, "low": low, "high": high,
            "without_texture_coordinates": read.without_uv, "warnings": read.warnings,
        });
        Self { lines, json }
    }

    /// A glTF model and its mesh.
    pub(super) fn of_model(model: &Model, read: &ReadMesh) -> Self {
        let mut findings = Self::of_mesh(read);
        let [parts, materials, images] =
            [(model.parts.len(), "part"), (model.materials.len(), "material"), (model.images.len(), "image")]
                .map(|(number, thing)| counted(number, thing));
        findings.lines[0] = format!("glTF model, {}", findings.lines[0]);
        findings.lines.insert(1, format!("{parts}, {materials}, {images}; `roughxel import` makes a scene"));
        findings.json["kind"] = json!("glTF");
        findings.json["parts"] = json!(model.parts.iter().map(|part| &part.name).collect::<Vec<_>>());
        findings.json["materials"] = json!(model.materials.len());
        findings.json["images"] = json!(model.images.len());
        findings.json["ignored"] = json!(model.ignored);
        findings
    }

    /// A scene, its pictures and its warnings.
    pub(super) fn of_scene(scene: &Scene) -> Self {
        let [objects, lights] = [counted(scene.objects.len(), "object"), counted(scene.lights.len(), "light")];
        let environment = if scene.environment.is_some() { "an environment" } else { "no environment" };
        let mut lines = vec![
            format!("scene of {objects}, {lights}, {environment}"),
            "`roughxel render` draws it; `roughxel plan` says which effects its objects have, and why".to_owned(),
        ];
        for PictureUse { used_as, path, statement } in &scene.pictures {
            lines.push(format!("{used_as}: {path}: {statement}"));
            lines.extend(statement.notes.iter().map(|note| format!("  {note}")));
            lines.extend(statement.ignored.iter().map(|ignored| format!("  ignored: {ignored}")));
        }
        lines.extend(warning_lines(&scene.warnings));
        let names: Vec<_> = scene.objects.iter().map(|object| &object.name).collect();
        let json = json!({
            "kind": "scene", "objects": names, "lights": scene.lights.len(), "environment": scene.environment.is_some(),
            "pictures": scene.pictures, "warnings": scene.warnings,
        });
        Self { lines, json }
    }
}
