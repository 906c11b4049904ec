//! `roughxel inspect`.

mod thumbnail;

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use glam::DVec3;
use roughxel_assets::gltf::{Model, read_model};
use roughxel_assets::picture::{self, Purpose, Statement, Wishes};
use roughxel_assets::{FileKind, ReadMesh, ReadOptions, file_kind, read_mesh};
use serde_json::{Value, json};

use super::{Failure, check_file, parse_png};

pub(super) const LONG_HELP: &str = "\
Say of a picture or a model what it is, how it is read, and what of it is ignored.

A picture is read as the scene file would read it for the use given by --as. The scene may still refuse its shape, clamp its
light or clamp its slopes. A thumbnail shows a picture, the six faces of a
cube map, or a mesh under the generated sky.

Exit codes: 0 done, 1 failure, 2 usage.
Data goes to stdout, progress and errors to stderr. NO_COLOR is respected.";

/// Use of a picture in a scene.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Use {
    /// Colours of a surface.
    Colours,
    /// Light from all directions.
    Environment,
    /// Heights.
    Heights,
    /// Tangent-space normals.
    Normals,
    /// Other numbers.
    Data,
}

impl From<Use> for Purpose {
    fn from(wanted: Use) -> Self {
        match wanted {
            Use::Colours => Self::Colours,
            Use::Environment => Self::Environment,
            Use::Heights => Self::Heights,
            Use::Normals => Self::Normals,
            Use::Data => Self::Data,
        }
    }
}

#[derive(Args)]
pub(super) struct InspectArgs {
    /// Picture, cube map, OBJ mesh or glTF model.
    file: PathBuf,
    /// Use of a picture.
    #[arg(long = "as", value_enum, default_value = "colours", value_name = "USE")]
    used_as: Use,
    /// PNG file to write a thumbnail to.
    #[arg(short, long, value_parser = parse_png, value_name = "PNG")]
    output: Option<PathBuf>,
    /// Print everything as JSON.
    #[arg(long)]
    json: bool,
}

/// Findings about a file: lines for people and an object for programs.
struct Findings {
    lines: Vec<String>,
    json: Value,
}

pub(super) fn run(args: &InspectArgs) -> Result<(), Failure> {
    args.output.as_deref().map_or(Ok(()), check_file)?;
    let (findings, thumbnail) = match file_kind(&args.file)? {
        FileKind::Picture => {
            let read = picture::read(&args.file, args.used_as.into(), &Wishes::default())?;
            (of_picture(&read.statement), args.output.is_some().then(|| thumbnail::of_picture(&read.picture)))
        }
        FileKind::Cube => {
            let cube = picture::read_cube(&args.file, &Wishes::default())?;
            (of_picture(&cube.statement), args.output.is_some().then(|| thumbnail::of_cube(&cube.faces)))
        }
        kind @ (FileKind::Model | FileKind::Mesh) => {
            let read = read_mesh(&args.file, &ReadOptions::default())?;
            let findings = match kind {
                FileKind::Model => of_model(&read_model(&args.file)?, &read),
                _ => of_mesh(&read),
            };
            (findings, args.output.as_ref().map(|_| thumbnail::of_mesh(&args.file, &read.mesh)).transpose()?)
        }
    };
    if let (Some(path), Some(thumbnail)) = (&args.output, &thumbnail) {
        picture::write_png_srgb(path, thumbnail)?;
    }
    let mut out = io::stdout().lock();
    if args.json {
        writeln!(out, "{:#}", findings.json)?;
    } else {
        writeln!(out, "{}: {}", shown(&args.file), findings.lines.join("\n  "))?;
    }
    Ok(())
}

fn shown(path: &Path) -> String {
    path.display().to_string()
}

fn of_picture(statement: &Statement) -> Findings {
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
    lines.extend(statement.warnings.iter().map(|warning| format!("warning: {warning}")));
    Findings { lines, json: json!(statement) }
}

/// Lines and keys that every mesh has.
fn of_mesh(read: &ReadMesh) -> Findings {
    let positions = || read.mesh.vertices.iter().map(|vertex| vertex.position);
    let low = positions().fold(DVec3::INFINITY, DVec3::min).to_array();
    let high = positions().fold(DVec3::NEG_INFINITY, DVec3::max).to_array();
    let (triangles, vertices) = (read.mesh.triangles.len(), read.mesh.vertices.len());
    let mut lines = vec![
        format!("mesh of {triangles} triangles, {vertices} vertices"),
        format!("from {low:?} to {high:?}"),
        read.without_uv.as_ref().map_or_else(
            || "texture coordinates on every face".to_owned(),
            |place| format!("no texture coordinates at {place}: maps cannot be drawn"),
        ),
    ];
    lines.extend(read.warnings.iter().map(|warning| format!("warning: {warning}")));
    let json = json!({
        "kind": "mesh", "triangles": triangles, "vertices": vertices, "low": low, "high": high,
        "without_texture_coordinates": read.without_uv, "warnings": read.warnings,
    });
    Findings { lines, json }
}

fn of_model(model: &Model, read: &ReadMesh) -> Findings {
    let mut findings = of_mesh(read);
    let [parts, materials, images] = [model.parts.len(), model.materials.len(), model.images.len()];
    findings.lines[0] = format!("glTF model, {}", findings.lines[0]);
    findings
        .lines
        .insert(1, format!("{parts} parts, {materials} materials, {images} images; `roughxel import` makes a scene"));
    findings.json["kind"] = json!("glTF");
    findings.json["parts"] = json!(model.parts.iter().map(|part| &part.name).collect::<Vec<_>>());
    findings.json["materials"] = json!(materials);
    findings.json["images"] = json!(images);
    findings.json["ignored"] = json!(model.ignored);
    findings
}
