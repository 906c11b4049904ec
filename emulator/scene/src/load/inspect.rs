//! One asset alone, as a scene takes it: a picture with the keys of its table, or the keys of a mesh.

use std::path::Path;

use glam::DVec3;
use roughxel_assets::picture::{Statement, beside, srgb_to_linear};
use roughxel_assets::{Picture, ReadOptions};
use toml::{Spanned, Value};

use super::maps::Maps;
use super::object::MAX_OFFSET;
use crate::bump::{BumpField, FrameSystem};
use crate::description::MaterialDescription;
use crate::error::SceneError;
use crate::generate::Unseen;
use crate::roughness::RoughnessField;
use crate::source::{ArgumentTable, Arguments, Source};

/// Key of a scene that names a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureKey {
    /// `colour_map` of a material.
    ColourMap,
    /// `height_map` of a material.
    HeightMap,
    /// `normal_map` of a material.
    NormalMap,
    /// `roughness_map` of a material.
    RoughnessMap,
    /// `equirectangular` of the environment.
    Panorama,
    /// `cube` of the environment.
    Cube,
}

/// A picture file as a scene takes it.
#[derive(Clone, Debug)]
pub struct TakenPicture {
    /// Words of the file, and decisions.
    pub statement: Statement,
    /// Colours, bumps as a normal map with green upwards, deviations over their largest, or the six faces in a row.
    pub shown: Picture,
    /// Warnings of the scene, those of the file among them.
    pub warnings: Vec<String>,
}

/// Reads a picture file with further keys of its table. A value that is no TOML is a text.
///
/// Errors: those of a scene that names the file so.
pub fn take_picture(path: &Path, used_as: PictureKey, keys: &[(String, String)]) -> Result<TakenPicture, SceneError> {
    let file_key = match used_as {
        PictureKey::Panorama => "equirectangular",
        PictureKey::Cube => "cube",
        _ => "path",
    };
    let source = source(Some((file_key, path)), keys);
    let table = parse(&source)?;
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let mut maps = Maps::new(&source, &Unseen);
    let shown = match used_as {
        PictureKey::ColourMap => maps.colour_map(&table, &name)?.as_ref().clone(),
        PictureKey::HeightMap | PictureKey::NormalMap => {
            let mut material = MaterialDescription::default();
            let map =
                if used_as == PictureKey::HeightMap { &mut material.height_map } else { &mut material.normal_map };
            *map = Some(table);
            let field = maps.bump(&material, &name, FrameSystem::NaturalNormalised, false)?;
            field.map_or(Picture::filled(1, 1, [0.0; 3]), |field| normals(&field))
        }
        PictureKey::RoughnessMap => {
            let material = MaterialDescription { roughness_map: Some(table), ..MaterialDescription::default() };
            let field = maps.roughness(&material, &name, FrameSystem::NaturalNormalised, None)?;
            field.map_or(Picture::filled(1, 1, [0.0; 3]), |field| deviations(&field))
        }
        PictureKey::Panorama | PictureKey::Cube => beside(&maps.environment(&table)?.faces.each_ref()),
    };
    let statement = maps.pictures.into_iter().next().map(|picture| picture.statement).unwrap_or_default();
    Ok(TakenPicture { statement, shown, warnings: maps.warnings })
}

/// Options of a mesh by its key `offset`.
///
/// Errors: another key, a value that does not fit.
pub fn mesh_options(keys: &[(String, String)]) -> Result<ReadOptions, SceneError> {
    let source = source(None, keys);
    let table = parse(&source)?;
    let arguments = Arguments::new(&source, &table);
    let offset = arguments.numbers("offset", [0.0; 3], -MAX_OFFSET..=MAX_OFFSET)?;
    arguments.finish()?;
    Ok(ReadOptions { offset: DVec3::from_array(offset), ..ReadOptions::default() })
}

/// The text of a table: a file, and keys.
fn source(file: Option<(&str, &Path)>, keys: &[(String, String)]) -> Source {
    let quoted = |text: &str| Value::String(text.to_owned()).to_string();
    let mut text = "[asset]\n".to_owned();
    text.extend(file.map(|(key, path)| format!("{key} = {}\n", quoted(&path.to_string_lossy()))));
    for (key, value) in keys {
        let line = format!("{key} = {value}\n");
        let is_value = toml::from_str::<toml::Table>(&line).is_ok();
        text += &if is_value { line } else { format!("{key} = {}\n", quoted(value)) };
    }
    Source::new("keys", &text, Path::new(""))
}

fn parse(source: &Source) -> Result<Spanned<ArgumentTable>, SceneError> {
    #[derive(serde::Deserialize)]
    struct Text {
        asset: Spanned<ArgumentTable>,
    }
    let text: Text = toml::from_str(&source.text).map_err(|error| {
        let message = error.message().replace('\n', "; ");
        source.value_error(error.span().unwrap_or(0..0), message, "give each key once, as KEY=VALUE")
    })?;
    Ok(text.asset)
}

/// Rows from the top of a field whose row 0 is at the bottom.
fn from_the_top(width: u32, height: u32, pixels: impl Iterator<Item = [f32; 3]>) -> Picture {
    let pixels: Vec<_> = pixels.collect();
    Picture { width, height, pixels: pixels.rchunks_exact(width as usize).flatten().copied().collect() }
}

/// Light whose sRGB codes are those of a normal map, green upwards.
fn normals(field: &BumpField) -> Picture {
    let normal = |[x, y]: &[f32; 2]| {
        let normal = DVec3::new(f64::from(*x), f64::from(*y), 1.0).normalize();
        normal.to_array().map(|part| srgb_to_linear((part + 1.0) / 2.0) as f32)
    };
    from_the_top(field.width, field.height, field.offsets.iter().map(normal))
}

/// Deviations along both axes in red and green, over the largest of the map.
fn deviations(field: &RoughnessField) -> Picture {
    let largest = field.factors.iter().flat_map(|[along, _, across]| [*along, *across]).fold(1e-6, f32::max);
    let shown = |[along, _, across]: &[f32; 3]| [along / largest, across / largest, 0.0];
    from_the_top(field.width, field.height, field.factors.iter().map(shown))
}
