//! Maps of a scene: environments, colour, bump and roughness maps, from files or generated.

use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use toml::Spanned;

use super::light;
use crate::bump::{BumpField, Edges, FrameSystem, Green, HeightScale, NormalCoding, OFFSET_LIMIT};
use crate::description::MaterialDescription;
use crate::error::SceneError;
use crate::generate::{
    COLOUR_MAPS, Generators, HEIGHT_MAPS, MapProgress, NORMAL_MAPS, UNIFORM_ROUGHNESS, uniform_roughness,
};
use crate::lighting::PEAK_HEIGHTS;
use crate::roughness::{MAX_DEVIATION, RoughnessChannels, RoughnessField};
use crate::scene::PictureUse;
use crate::source::{ArgumentTable, Arguments, Source};
use roughxel_assets::picture::{
    self, ColourSpace, Picture, PictureError, PictureFile, Purpose, Statement, Transfer, Window, Wishes,
};

/// Reads the maps of one scene; a map that is named more than once is made once.
pub(super) struct Maps<'a> {
    pub(super) source: &'a Source,
    pub(super) progress: &'a dyn MapProgress,
    colour_maps: HashMap<String, Arc<Picture>>,
    bumps: HashMap<String, Arc<BumpField>>,
    roughness: HashMap<String, Arc<RoughnessField>>,
    /// Repairs, one sentence each.
    pub(super) warnings: Vec<String>,
    /// Picture files in the order in which they are read.
    pub(super) pictures: Vec<PictureUse>,
}

impl<'a> Maps<'a> {
    /// A reader of `source` that has read nothing.
    pub(super) fn new(source: &'a Source, progress: &'a dyn MapProgress) -> Self {
        Self {
            source,
            progress,
            colour_maps: HashMap::new(),
            bumps: HashMap::new(),
            roughness: HashMap::new(),
            warnings: Vec::new(),
            pictures: Vec::new(),
        }
    }
}

impl Maps<'_> {
    /// Reads the picture `path` that `arguments` name, by their wishes; `used_as` names its use in the scene.
    pub(super) fn read_picture(
        &mut self,
        used_as: &str,
        arguments: &Arguments<'_>,
        (path, span): (&str, Range<usize>),
        purpose: Purpose,
    ) -> Result<PictureFile, SceneError> {
        let wishes = wishes(arguments, purpose)?;
        let read = self.read(path, span, |file| picture::read(file, purpose, &wishes))?;
        self.say(used_as, path, read.statement.clone());
        Ok(read)
    }

    /// Reads the file `path` of a table.
    pub(super) fn read<T>(
        &self,
        path: &str,
        span: Range<usize>,
        read: impl FnOnce(&Path) -> Result<T, PictureError>,
    ) -> Result<T, SceneError> {
        read(&self.resolve(path)).map_err(|error| {
            let missing = error.is_missing();
            let remedy = if missing { "paths are relative to the scene file".to_owned() } else { error.remedy };
            self.source.value_error(span, error.message, remedy)
        })
    }

    /// Keeps what a file says, and warns.
    pub(super) fn say(&mut self, used_as: &str, path: &str, statement: Statement) {
        self.warnings.extend(statement.warnings.iter().map(|warning| format!("{used_as}: {warning}")));
        self.pictures.push(PictureUse { used_as: used_as.to_owned(), path: path.to_owned(), statement });
    }

    /// A path, relative to the scene file.
    pub(super) fn resolve(&self, path: &str) -> PathBuf {
        self.source.base_dir.join(path)
    }

    /// The picture of a table with `path` or `generate`. Keys that neither it nor the caller asked for are refused.
    fn picture(
        &mut self,
        used_as: &str,
        arguments: &Arguments<'_>,
        generators: &Generators<Picture>,
        purpose: Purpose,
    ) -> Result<PictureFile, SceneError> {
        let picture = match (arguments.text("path")?, arguments.text("generate")?) {
            (Some(named), None) => self.read_picture(used_as, arguments, named, purpose)?,
            (None, Some(named)) => {
                let picture = generators.make(arguments, named, self.progress)?;
                PictureFile { picture, statement: Statement::default() }
            }
            _ => {
                return Err(arguments.error("the map is not clear", "give exactly one of `path` and `generate`"));
            }
        };
        arguments.finish()?;
        Ok(picture)
    }

    /// Colour map of the object `name`.
    pub(super) fn colour_map(
        &mut self,
        table: &Spanned<ArgumentTable>,
        name: &str,
    ) -> Result<Arc<Picture>, SceneError> {
        let arguments = Arguments::new(self.source, table);
        let key = arguments.fingerprint();
        if let Some(known) = self.colour_maps.get(&key) {
            return Ok(Arc::clone(known));
        }
        let used_as = format!("{name}: colour map");
        let picture = Arc::new(self.picture(&used_as, &arguments, &COLOUR_MAPS, Purpose::Colours)?.picture);
        self.warnings.extend(light::cut_colour(&used_as, &picture));
        self.colour_maps.insert(key, Arc::clone(&picture));
        Ok(picture)
    }

    /// The bump map of a material.
    pub(super) fn bump(
        &mut self,
        material: &MaterialDescription,
        name: &str,
        frame: FrameSystem,
        with_heights: bool,
    ) -> Result<Option<Arc<BumpField>>, SceneError> {
        let table = match (&material.height_map, &material.normal_map) {
            (None, None) => return Ok(None),
            (Some(table), None) | (None, Some(table)) => table,
            (Some(_), Some(normal_map)) => {
                let help = "keep one of `height_map` and `normal_map`";
                return Err(self.source.value_error(normal_map.span(), "an object has one bump map", help));
            }
        };
        let is_height = material.height_map.is_some();
        let arguments = Arguments::new(self.source, table);
        let key = format!("{is_height} {with_heights} {frame:?} {}", arguments.fingerprint());
        if let Some(known) = self.bumps.get(&key) {
            return Ok(Some(Arc::clone(known)));
        }
        let (field, clamped) = if is_height {
            let scale = height_scale(&arguments, frame)?;
            let wraps = arguments.flag("wrap", true)?.is_none_or(|(wraps, _)| wraps);
            let edges = if wraps { Edges::Wrapped } else { Edges::Open };
            let used_as = format!("{name}: height map");
            let heights = self.picture(&used_as, &arguments, &HEIGHT_MAPS, Purpose::Heights)?.picture;
            if with_heights {
                BumpField::with_heights(&heights, scale, frame, edges)
            } else {
                BumpField::from_heights(&heights, scale, frame, edges)
            }
        } else {
            if frame == FrameSystem::Natural {
                let help = "use `height_map`, or the frame \"natural-normalised\" or \"main-direction\"";
                let message = "the frame \"natural\" needs heights: a normal map has no depth";
                return Err(arguments.error(message, help));
            }
            let green = arguments.word("green", &[("up", Green::Up), ("down", Green::Down)])?.unwrap_or_default();
            let codings = [("zero-at-128", NormalCoding::ZeroAt128), ("gltf", NormalCoding::Gltf)];
            let coding = arguments.word("coding", &codings)?.unwrap_or_default();
            if let Some((_, span)) = arguments.flag("wrap", "–")? {
                let help = "leave `wrap` out: normals are taken as they are, no slope is taken across an edge";
                return Err(arguments.error_at(span, "`wrap` belongs to a height map", help));
            }
            let used_as = format!("{name}: normal map");
            let normals = self.picture(&used_as, &arguments, &NORMAL_MAPS, Purpose::Normals)?;
            let coding = if normals.statement.signed == Some(true) { NormalCoding::Signed } else { coding };
            BumpField::from_normals(&normals.picture, green, coding)
        };
        if clamped > 0 {
            self.warnings.push(format!(
                "{name}: {clamped} texels of the bump map are steeper than {} and were clamped",
                OFFSET_LIMIT
            ));
        }
        // NaN is in no range.
        if let Some(kept) = &field.heights
            && !kept.heights.iter().all(|height| PEAK_HEIGHTS.contains(height))
        {
            let help = "choose a smaller `scale`, or a map without such heights";
            return Err(arguments.error("heights of more than 10^9 texels cast no shadows", help));
        }
        let field = Arc::new(field);
        self.bumps.insert(key, Arc::clone(&field));
        Ok(Some(field))
    }

    /// The roughness map of a material.
    pub(super) fn roughness(
        &mut self,
        material: &MaterialDescription,
        name: &str,
        frame: FrameSystem,
        bump: Option<&BumpField>,
    ) -> Result<Option<Arc<RoughnessField>>, SceneError> {
        let Some(table) = &material.roughness_map else {
            return Ok(None);
        };
        let arguments = Arguments::new(self.source, table);
        if frame == FrameSystem::Natural {
            let help = "use the frame \"natural-normalised\" or \"main-direction\"";
            return Err(arguments.error("the frame \"natural\" takes no roughness map: it has no unit there", help));
        }
        let key = arguments.fingerprint();
        let field = match self.roughness.get(&key) {
            Some(known) => Arc::clone(known),
            None => {
                let (field, clamped) = self.roughness_field(name, &arguments)?;
                if clamped > 0 {
                    self.warnings.push(format!(
                        "{name}: {clamped} texels of the roughness map are outside 0 to {MAX_DEVIATION} and were clamped"
                    ));
                }
                let field = Arc::new(field);
                self.roughness.insert(key, Arc::clone(&field));
                field
            }
        };
        if let Some(bump) = bump
            && field.factors.len() > 1
            && (bump.width, bump.height) != (field.width, field.height)
        {
            let sizes = [(field.width, field.height), (bump.width, bump.height)].map(|(w, h)| format!("{w}×{h}"));
            let message = format!("the roughness map has {} texels and the bump map {}", sizes[0], sizes[1]);
            return Err(arguments.error(message, "make both the same size"));
        }
        Ok(Some(field))
    }

    /// The factors of a table, and how many were out of range.
    fn roughness_field(
        &mut self,
        name: &str,
        arguments: &Arguments<'_>,
    ) -> Result<(RoughnessField, usize), SceneError> {
        if arguments.text("generate")?.is_some_and(|(name, _)| name == UNIFORM_ROUGHNESS) {
            let factor = uniform_roughness(arguments)?;
            arguments.finish()?;
            return Ok((RoughnessField::uniform(factor), 0));
        }
        let deviation = arguments.number("deviation", 0.25, 0.0..=MAX_DEVIATION)?;
        let words = [("isotropic", RoughnessChannels::Isotropic), ("anisotropic", RoughnessChannels::Anisotropic)];
        let channels = arguments.word("channels", &words)?.unwrap_or(RoughnessChannels::Isotropic);
        // The grey of a height map serves for a deviation as well as for a height.
        let picture = self.picture(&format!("{name}: roughness map"), arguments, &HEIGHT_MAPS, Purpose::Data)?.picture;
        Ok(RoughnessField::from_picture(&picture, channels, deviation))
    }
}

/// Keys of a table with a picture file that decide against the words of the file.
pub(super) fn wishes(arguments: &Arguments<'_>, purpose: Purpose) -> Result<Wishes, SceneError> {
    let mut wishes = Wishes {
        layer: arguments.text("layer")?.map(|(layer, _)| layer.to_owned()),
        window: arguments.word("window", &Window::WORDS)?,
        ..Wishes::default()
    };
    if purpose.is_light() {
        wishes.colour_space = arguments.word("colour_space", &ColourSpace::WORDS)?;
        wishes.transfer = arguments.word("transfer", &Transfer::WORDS)?;
    }
    if purpose == Purpose::Normals {
        wishes.signed = arguments.flag("signed", "–")?.map(|(signed, _)| signed);
    }
    Ok(wishes)
}

/// `scale` or `rms_slope` of a height map.
fn height_scale(arguments: &Arguments<'_>, frame: FrameSystem) -> Result<HeightScale, SceneError> {
    let scale = arguments.optional_number("scale", -1e3..=1e3)?;
    let rms_slope = arguments.optional_number("rms_slope", 0.0..=4.0)?;
    match (scale, rms_slope) {
        (None, None) => Ok(HeightScale::Height(0.05)),
        (Some(scale), None) => Ok(HeightScale::Height(scale)),
        (None, Some(_)) if frame == FrameSystem::Natural => {
            Err(arguments.error("`rms_slope` has no meaning in the frame \"natural\"", "give `scale` in world units"))
        }
        (None, Some(rms_slope)) => Ok(HeightScale::RmsSlope(rms_slope)),
        (Some(_), Some(_)) => Err(arguments.error("the height is given twice", "keep one of `scale` and `rms_slope`")),
    }
}
