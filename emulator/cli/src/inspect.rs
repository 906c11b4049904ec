//! `roughxel inspect`.

mod findings;
mod thumbnail;

use std::io::{self, Write as _};
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use miette::miette;
use roughxel_assets::gltf::read_model;
use roughxel_assets::{FileKind, Picture, file_kind, mesh_of_model, picture, read_mesh};
use roughxel_scene::{PictureKey, Scene, SceneError, mesh_options, take_picture};

use self::findings::Findings;
use super::failure::scene_failure;
use super::{Failure, check_file, parse_png};

pub(super) const LONG_HELP: &str = "\
Say of a picture, a model or a scene what it is, how it is read, and what of it is ignored.

A picture is read as the key of a scene given by --as would read it, with the same errors and warnings. --set gives further
keys of that table (emulator/scenes/README.md lists them): --set layer=Combined --set latitudes=[0,90]. A value
that is no TOML is a text. A mesh or a model takes --set offset=[x,y,z]. Of a scene file, all its pictures are listed.

A thumbnail shows colours, bumps as a normal map, the six faces of an environment, a mesh under the generated sky, or the scene.

Exit codes: 0 done, 1 failure, 2 usage.
Data goes to stdout, progress and errors to stderr. NO_COLOR is respected.";

/// Key of a scene that names a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Use {
    /// Colours of a surface (colour_map).
    Colours,
    /// Light by longitude and latitude (equirectangular).
    Environment,
    /// Light of six faces in one file (cube).
    Cube,
    /// Heights (height_map).
    Heights,
    /// Tangent-space normals (normal_map).
    Normals,
    /// Deviations of slopes (roughness_map).
    Roughness,
}

impl From<Use> for PictureKey {
    fn from(wanted: Use) -> Self {
        match wanted {
            Use::Colours => Self::ColourMap,
            Use::Environment => Self::Panorama,
            Use::Cube => Self::Cube,
            Use::Heights => Self::HeightMap,
            Use::Normals => Self::NormalMap,
            Use::Roughness => Self::RoughnessMap,
        }
    }
}

#[derive(Args)]
pub(super) struct InspectArgs {
    /// Picture, cube map, OBJ mesh, glTF model or scene file.
    file: PathBuf,
    /// Use of a picture. The default is colours, and cube for a KTX2 or DDS file with six faces.
    #[arg(long = "as", value_enum, value_name = "USE")]
    used_as: Option<Use>,
    /// Key of the file's table in a scene. Repeat it for more keys.
    #[arg(long = "set", value_parser = parse_key, value_name = "KEY=VALUE")]
    keys: Vec<(String, String)>,
    /// PNG file to write a thumbnail to.
    #[arg(short, long, value_parser = parse_png, value_name = "PNG")]
    output: Option<PathBuf>,
    /// Print everything as JSON.
    #[arg(long)]
    json: bool,
}

/// Parses `KEY=VALUE`.
fn parse_key(text: &str) -> Result<(String, String), String> {
    let (key, value) = text.split_once('=').ok_or("a key is KEY=VALUE, such as layer=Combined or wrap=false")?;
    Ok((key.trim().to_owned(), value.trim().to_owned()))
}

pub(super) fn run(args: &InspectArgs) -> Result<(), Failure> {
    args.output.as_deref().map_or(Ok(()), check_file)?;
    let is_scene = args.file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    let (findings, thumbnail) = if is_scene { scene(args)? } else { asset(args)? };
    if let (Some(path), Some(thumbnail)) = (&args.output, &thumbnail) {
        picture::write_png_srgb(path, thumbnail)?;
    }
    let mut out = io::stdout().lock();
    if args.json {
        writeln!(out, "{:#}", findings.json)?;
    } else {
        writeln!(out, "{}: {}", args.file.display(), findings.lines.join("\n  "))?;
    }
    Ok(())
}

/// Findings about a scene file, and its frame if a thumbnail is wanted.
fn scene(args: &InspectArgs) -> Result<(Findings, Option<Picture>), Failure> {
    refuse(args.used_as.is_some(), "--as", "it belongs to a picture")?;
    refuse(!args.keys.is_empty(), "--set", "a scene file has its keys")?;
    let scene = Scene::open(&args.file.to_string_lossy()).map_err(scene_failure)?;
    let findings = Findings::of_scene(&scene);
    let thumbnail = args.output.as_ref().map(|_| thumbnail::of_scene(scene)).transpose()?;
    Ok((findings, thumbnail))
}

/// Findings about a picture, a cube map, a mesh or a model, and its thumbnail if one is wanted.
fn asset(args: &InspectArgs) -> Result<(Findings, Option<Picture>), Failure> {
    let kind = file_kind(&args.file)?;
    let wants_thumbnail = args.output.is_some();
    let by_kind = match kind {
        FileKind::Picture => Use::Colours,
        FileKind::Cube => Use::Cube,
        FileKind::Model | FileKind::Mesh => {
            refuse(args.used_as.is_some(), "--as", "it belongs to a picture")?;
            let options = mesh_options(&args.keys).map_err(key_failure)?;
            let (findings, mesh) = if kind == FileKind::Model {
                let model = read_model(&args.file)?;
                let read = mesh_of_model(&args.file, &model, &options)?;
                (Findings::of_model(&model, &read), read.mesh)
            } else {
                let read = read_mesh(&args.file, &options)?;
                (Findings::of_mesh(&read), read.mesh)
            };
            return Ok((findings, wants_thumbnail.then(|| thumbnail::of_mesh(mesh)).transpose()?));
        }
    };
    let taken = take_picture(&args.file, args.used_as.unwrap_or(by_kind).into(), &args.keys).map_err(key_failure)?;
    let findings = Findings::of_picture(&taken.statement, &taken.warnings);
    Ok((findings, wants_thumbnail.then(|| thumbnail::of_picture(&taken.shown))))
}

/// An error of usage if an option does not fit the file.
fn refuse(is_given: bool, option: &str, why: &str) -> Result<(), Failure> {
    if is_given { Err(Failure::Usage(format!("leave {option} out: {why}"))) } else { Ok(()) }
}

/// The failure of a file with keys, without the place in the table that was made of them.
fn key_failure(error: SceneError) -> Failure {
    match error.fault() {
        Some(fault) => Failure::Error(miette!("{}; {}", fault.message, fault.help)),
        None => error.into(),
    }
}
