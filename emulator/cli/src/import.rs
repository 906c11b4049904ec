//! `roughxel import`.

mod maps;
mod text;

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use clap::Args;
use miette::miette;
use roughxel_assets::gltf::{Model, Part, read_model};
use roughxel_assets::{ReadOptions, parse_obj};
use roughxel_utilities::limits::MAX_COORDINATE;
use roughxel_utilities::output::write_files;

use super::console::{complain, counted};
use super::{Failure, check_file, file_stem, write_text};

pub(super) const LONG_HELP: &str = "\
Make a scene of a glTF 2.0 model (.glb or .gltf): a scene file, and a folder of the same name with OBJ files and maps.

  reflectance     mean over the maps of 0.04 (1 - metallic) + metallic base colour
  colour          base colour of what is not metal, and emitted light, shown without shading
  normal map      copied; x and y are multiplied by its scale if that is not 1
  roughness map   standard deviation of slopes that comes nearest to GGX with alpha = roughness^2: alpha for a smooth
                  surface, 0.8 alpha from alpha = 0.2 on
  camera          that of the file, else one in front (+z), a little right and above, that sees the whole model
  environment     the generated sky; edit the scene file for another

Files that exist are kept, unless --replace is given. Contents that are not drawn are named on stderr: animations, skins, lights, transparency, other extensions.

Exit codes: 0 done, 1 failure, 2 usage.
Data goes to stdout, progress and errors to stderr. NO_COLOR is respected.";

#[derive(Args)]
pub(super) struct ImportArgs {
    /// Model, a .glb or .gltf file.
    model: PathBuf,
    /// Scene file to write. The default is the name of the model with .toml, in this folder.
    #[arg(short, long, value_name = "TOML")]
    output: Option<PathBuf>,
    /// Replace a scene of that name, with its meshes and maps.
    #[arg(long)]
    replace: bool,
}

pub(super) fn run(args: &ImportArgs) -> Result<(), Failure> {
    let stem = file_stem(&args.model.to_string_lossy());
    let output = args.output.clone().unwrap_or_else(|| format!("{stem}.toml").into());
    if output.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("toml")) {
        return Err(Failure::Usage("scenes are TOML files: end the name in .toml".to_owned()));
    }
    check_file(&output)?;
    let folder = output.with_extension("");
    if let Some(known) = [&output, &folder].into_iter().find(|path| path.exists() && !args.replace) {
        let known = known.display();
        return Err(Failure::Error(miette!("{known} exists already; choose another --output, or give --replace")));
    }
    let mut model = read_model(&args.model)?;
    let folder_name = folder.file_name().map_or_else(|| stem.clone(), |name| name.to_string_lossy().into_owned());
    check_coordinates(&args.model, &model)?;
    let left_out = leave_out(&args.model, &mut model)?;
    // Everything is made before anything is written: a broken image leaves an earlier scene as it was.
    let mut notes = [model.ignored.clone(), left_out].concat();
    let source = maps::Source { path: &args.model, model: &model, images: maps::image_names(&model) };
    let mut files = maps::Files::new();
    let mut objects = Vec::new();
    let mut materials = BTreeMap::new();
    for (index, part) in model.parts.iter().enumerate() {
        let has_uv = !part.texcoords.is_empty();
        let maps = match materials.entry((part.material, has_uv)) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(place) => {
                place.insert(maps::material(&source, part.material, has_uv, &mut files, &mut notes)?)
            }
        };
        objects.push(text::object(part, &format!("{folder_name}/{}", obj_name(index, part)), &folder_name, maps));
    }
    let images = source.images.iter().zip(&model.images).map(|(name, image)| (name, &image.bytes));
    write_files(&folder, images)?;
    write_files(&folder, files)?;
    let meshes = model.parts.iter().enumerate().map(|(index, part)| (obj_name(index, part), obj(part)));
    write_files(&folder, meshes)?;
    write_text(&output, &text::scene(&args.model, &model, &objects))?;
    notes.sort();
    notes.dedup();
    for note in &notes {
        complain(&format!("warning: {}: {note}", args.model.display()));
    }
    let triangles: usize = model.parts.iter().map(|part| part.triangles.len()).sum();
    let shown = output.display();
    let contents = format!("{}, {}", counted(objects.len(), "object"), counted(triangles, "triangle"));
    writeln!(io::stdout().lock(), "{shown}: {contents}; draw it: roughxel render {shown}")?;
    Ok(())
}

/// Takes the parts that a scene would refuse out of a model, such as points and lines, and says which and why.
///
/// Errors: no part is left.
fn leave_out(path: &Path, model: &mut Model) -> Result<Vec<String>, Failure> {
    let mut notes = Vec::new();
    model.parts.retain(|part| {
        let read = parse_obj(Path::new(&part.name), &obj(part), &ReadOptions::default());
        if let Err(error) = &read {
            notes.push(format!("{:?} is left out: it {}", part.name, error.message));
        }
        read.is_ok()
    });
    if model.parts.is_empty() {
        let message = format!("{} has no face with an area", path.display());
        return Err(Failure::Error(miette!("{message}; export the model with triangles")));
    }
    Ok(notes)
}

/// Checks that a scene can hold the model, and a camera that sees it.
fn check_coordinates(path: &Path, model: &Model) -> Result<(), Failure> {
    let positions = model.parts.iter().flat_map(|part| &part.positions);
    let farthest = positions.map(|position| position.abs().max_element()).fold(0.0, f64::max);
    let camera = text::camera(model);
    let seen = camera.eye.abs().max(text::target(&camera).abs()).max_element();
    let shown = path.display();
    let (what, at) = if farthest > MAX_COORDINATE { ("a position", farthest) } else { ("its camera", seen) };
    if at > MAX_COORDINATE {
        let message = format!("{shown} has {what} at {at:e}, beyond ±{MAX_COORDINATE:e} units");
        return Err(Failure::Error(miette!("{message}; move the model to the origin, or scale it down")));
    }
    Ok(())
}

/// File name of a part: a number keeps equal names apart.
fn obj_name(index: usize, part: &Part) -> String {
    format!("{}_{}.obj", index + 1, file_stem(&part.name))
}

/// A part as OBJ text. Numbers have as many digits as they need to be read back as they are.
fn obj(part: &Part) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    for p in &part.positions {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for uv in &part.texcoords {
        let _ = writeln!(text, "vt {} {}", uv.x, uv.y);
    }
    for n in &part.normals {
        let _ = writeln!(text, "vn {} {} {}", n.x, n.y, n.z);
    }
    let (uv, normal) = (!part.texcoords.is_empty(), !part.normals.is_empty());
    for triangle in &part.triangles {
        text.push('f');
        for index in triangle.map(|index| index + 1) {
            let _ = match (uv, normal) {
                (true, true) => write!(text, " {index}/{index}/{index}"),
                (true, false) => write!(text, " {index}/{index}"),
                (false, true) => write!(text, " {index}//{index}"),
                (false, false) => write!(text, " {index}"),
            };
        }
        text.push('\n');
    }
    text
}
