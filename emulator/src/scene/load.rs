//! From the keys of a scene file to a [`Scene`]: ranges, files, generated maps, defaults.

use std::collections::HashMap;
use std::io::Read as _;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec3;
use toml::Spanned;

use super::bump::HeightScale;
use super::description::{
    ArgumentTable, Arguments, BackgroundDescription, CameraDescription, FrameName, MaterialDescription,
    ObjectDescription, OneOrThree, ShapeName, Source,
};
use super::generate::{
    MAX_DEVIATION, UNIFORM_ROUGHNESS, colour_map, environment, height_map, mesh_names, mesh_text, normal_map,
    uniform_roughness,
};
use super::lighting::{self, Available, PeakSource, Peaks};
use super::mesh::{MAX_TRIANGLES, ObjMesh, parse_obj, read_obj};
use super::roughness::RoughnessChannels;
use super::shapes::{MAX_SEGMENTS, Placement, Shape};
use super::{
    Background, BumpField, Camera, EnvironmentSource, FrameSystem, MAX_FRAME_EDGE_PX, MAX_FRAME_PIXELS,
    MAX_SCENE_BYTES, Material, Mesh, Object, RoughnessField, Scene, SceneError, frame_size_is_allowed,
};
use crate::maps::environment::faces_from_equirectangular;
use crate::maps::peaks::{HEIGHTS, MAX_TEXELS};
use crate::picture::{Encoding, Picture, read_exr, read_png};

/// Largest coordinate of a scene, world units.
const MAX_COORDINATE: f64 = 1e6;
/// Range of lengths, world units.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-4..=1e6;
/// Most objects of a scene.
const MAX_OBJECTS: usize = 1000;
/// Largest edge of an environment's face: six such faces stay below 2²⁶ pixels.
pub(super) const MAX_FACE_EDGE: u32 = 2048;

/// Reads a scene file.
pub(super) fn from_file(path: &Path) -> Result<Scene, SceneError> {
    let unreadable = |source| SceneError::Unreadable { path: path.to_owned(), source };
    let file = std::fs::File::open(path).map_err(unreadable)?;
    let bytes = file.metadata().map_err(unreadable)?.len();
    if bytes > MAX_SCENE_BYTES {
        return Err(SceneError::TooLarge { path: path.to_owned(), bytes });
    }
    // The limit again for what has no length of its own (a pipe).
    let mut content = Vec::new();
    file.take(MAX_SCENE_BYTES + 1).read_to_end(&mut content).map_err(unreadable)?;
    if content.len() as u64 > MAX_SCENE_BYTES {
        return Err(SceneError::TooLarge { path: path.to_owned(), bytes: content.len() as u64 });
    }
    let text = String::from_utf8(content).map_err(|_| SceneError::NotText { path: path.to_owned() })?;
    let base_dir = path.parent().unwrap_or(Path::new(""));
    let mut scene = from_toml(&path.display().to_string(), &text, base_dir)?;
    if let Some(stem) = path.file_stem() {
        scene.name = stem.to_string_lossy().into_owned();
    }
    Ok(scene)
}

/// Reads a scene from its text.
pub(super) fn from_toml(label: &str, text: &str, base_dir: &Path) -> Result<Scene, SceneError> {
    let source = Source::new(label, text, base_dir);
    let description = source.parse()?;
    let mut loader = Loader {
        source: &source,
        colour_maps: HashMap::new(),
        bumps: HashMap::new(),
        roughness: HashMap::new(),
        has_lights: false,
        warnings: Vec::new(),
    };
    let camera = loader.camera(&description.camera)?;
    let environment = description.environment.as_ref().map(|table| loader.environment(table)).transpose()?;
    let background = loader.background(description.background.as_ref(), environment.is_some())?;
    if let Some(extra) = description.object.get(MAX_OBJECTS) {
        let help = format!("a scene has at most {MAX_OBJECTS}; join some in one mesh");
        return Err(source.value_error(extra.span(), "too many objects", help));
    }
    let lights = lighting::lights(&source, &description.light)?;
    loader.has_lights = !lights.is_empty();
    let mut objects = Vec::new();
    for (index, object) in description.object.iter().enumerate() {
        objects.push(loader.object(index, object, environment.is_some())?);
    }
    let warnings = loader.warnings;
    Ok(Scene { name: label.to_owned(), camera, background, environment, lights, objects, warnings })
}

/// Reads one scene; maps that are named more than once are made once.
struct Loader<'a> {
    source: &'a Source,
    colour_maps: HashMap<String, Arc<Picture>>,
    bumps: HashMap<String, Arc<BumpField>>,
    roughness: HashMap<String, Arc<RoughnessField>>,
    has_lights: bool,
    warnings: Vec<String>,
}

/// What a picture is read for: colours are decoded from sRGB, data are not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PictureUse {
    Colour,
    Height,
    Normal,
    Roughness,
}

impl Loader<'_> {
    fn camera(&self, camera: &CameraDescription) -> Result<Camera, SceneError> {
        let source = self.source;
        let point = |key, value: &Spanned<[f64; 3]>| {
            source.all_in_range(key, value, -MAX_COORDINATE..=MAX_COORDINATE).map(DVec3::from_array)
        };
        let eye = point("eye", &camera.eye)?;
        let target = point("target", &camera.target)?;
        let up = camera.up.as_ref().map_or(Ok(DVec3::Y), |up| point("up", up))?;
        let sight = target - eye;
        if sight.length() < *LENGTHS.start() {
            let help = "move them apart: the camera looks from `eye` to `target`";
            return Err(source.value_error(camera.target.span(), "`target` is where `eye` is", help));
        }
        // 1e-6 is the sine of the angle between them; below it the picture's right-hand direction is rounding.
        if sight.cross(up).length() <= 1e-6 * sight.length() * up.length() {
            let span = camera.up.as_ref().map_or(camera.target.span(), Spanned::span);
            let help = "choose an `up` that is not zero and not parallel to the line from `eye` to `target`";
            return Err(source.value_error(span, "`up` gives no direction in the picture", help));
        }
        let fov_y_degrees = match &camera.fov_y {
            None => 40.0,
            Some(fov) => source.in_range("fov_y", *fov.get_ref(), fov.span(), 0.1..=170.0)?,
        };
        let edge = |key, value: &Option<Spanned<i64>>, default| match value {
            None => Ok(default),
            Some(value) => source.whole_in_range(key, *value.get_ref(), value.span(), 1..=MAX_FRAME_EDGE_PX),
        };
        let width = edge("width", &camera.width, 640)?;
        let height = edge("height", &camera.height, 480)?;
        if !frame_size_is_allowed(width, height) {
            let span = camera.height.as_ref().or(camera.width.as_ref()).map_or(0..0, Spanned::span);
            let help = format!("width × height is at most {MAX_FRAME_PIXELS}");
            return Err(source.value_error(span, format!("{width}×{height} pixels are too many"), help));
        }
        Ok(Camera { eye, target, up, fov_y_degrees, width, height })
    }

    fn background(
        &self,
        background: Option<&Spanned<BackgroundDescription>>,
        has_environment: bool,
    ) -> Result<Background, SceneError> {
        let Some(background) = background else {
            return Ok(if has_environment { Background::Environment } else { Background::Colour([0.0; 3]) });
        };
        let colour = |key, value: &Spanned<[f64; 3]>| {
            self.source.all_in_range(key, value, 0.0..=1.0).map(|colour| colour.map(|channel| channel as f32))
        };
        match background.get_ref() {
            BackgroundDescription { colour: Some(one), top: None, bottom: None, environment: None } => {
                Ok(Background::Colour(colour("colour", one)?))
            }
            BackgroundDescription { colour: None, top: Some(top), bottom: Some(bottom), environment: None } => {
                Ok(Background::Ramp { top: colour("top", top)?, bottom: colour("bottom", bottom)? })
            }
            BackgroundDescription { colour: None, top: None, bottom: None, environment: Some(shown) }
                if *shown.get_ref() =>
            {
                if has_environment {
                    return Ok(Background::Environment);
                }
                let help = "add a table [environment], or choose a `colour`";
                Err(self.source.value_error(shown.span(), "there is no environment to show", help))
            }
            _ => Err(self.source.value_error(
                background.span(),
                "the background is not clear",
                "give exactly one of: `colour`; `top` and `bottom`; `environment = true`",
            )),
        }
    }

    fn environment(&self, table: &Spanned<ArgumentTable>) -> Result<EnvironmentSource, SceneError> {
        let arguments = Arguments::new(self.source, table);
        let generate = arguments.text("generate")?;
        let equirectangular = arguments.text("equirectangular")?;
        let paths = arguments.texts("faces")?;
        let faces = match (generate, equirectangular, paths) {
            (Some((name, span)), None, None) => environment(&arguments, name, span)?,
            (None, Some((path, span)), None) => {
                let face_edge = arguments.whole("face_edge", 512, 1..=MAX_FACE_EDGE)?;
                let picture = self.read_picture(path, span, Encoding::Srgb)?;
                faces_from_equirectangular(&picture, face_edge)
            }
            (None, None, Some((paths, span))) => self.six_faces(paths, span)?,
            _ => {
                return Err(arguments.error(
                    "the environment is not clear",
                    "give exactly one of: `faces` (six files), `equirectangular` (a file), `generate` (a name)",
                ));
            }
        };
        arguments.finish()?;
        Ok(EnvironmentSource { faces })
    }

    fn six_faces(&self, paths: &[String], span: Range<usize>) -> Result<[Picture; 6], SceneError> {
        let wrong_count = |_| {
            let message = format!("`faces` names {} files", paths.len());
            self.source.value_error(span.clone(), message, "name six: +x, −x, +y, −y, +z, −z, in this order")
        };
        let mut faces = Vec::new();
        for path in <&[String; 6]>::try_from(paths).map_err(|_| wrong_count(()))? {
            let face = self.read_picture(path, span.clone(), Encoding::Srgb)?;
            let edge = faces.first().map_or(face.width, |first: &Picture| first.width);
            if face.width != face.height || face.width != edge || edge > MAX_FACE_EDGE {
                let message = format!("the face `{path}` has {}×{} pixels", face.width, face.height);
                let help = format!("all six must be squares of one size of at most {MAX_FACE_EDGE} pixels");
                return Err(self.source.value_error(span, message, help));
            }
            faces.push(face);
        }
        <[Picture; 6]>::try_from(faces).map_err(|_| wrong_count(()))
    }

    /// Reads a PNG or, by its ending, an EXR file (always linear).
    fn read_picture(&self, path: &str, span: Range<usize>, encoding: Encoding) -> Result<Picture, SceneError> {
        let path = self.resolve(path);
        let is_exr = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr"));
        let picture = if is_exr { read_exr(&path) } else { read_png(&path, encoding) };
        picture.map_err(|source| SceneError::Picture {
            fault: self.source.fault(span, source.to_string(), "paths are relative to the scene file"),
            source,
        })
    }

    fn resolve(&self, path: &str) -> PathBuf {
        self.source.base_dir.join(path)
    }

    /// The picture of a table with `path` or `generate`; refuses keys that neither it nor the caller asked for.
    fn picture(&self, arguments: &Arguments<'_>, usage: PictureUse) -> Result<Picture, SceneError> {
        let path = arguments.text("path")?;
        let generate = arguments.text("generate")?;
        let picture = match (path, generate, usage) {
            (Some((path, span)), None, PictureUse::Colour) => self.read_picture(path, span, Encoding::Srgb)?,
            (Some((path, span)), None, _) => self.read_picture(path, span, Encoding::Linear)?,
            (None, Some((name, span)), PictureUse::Colour) => colour_map(arguments, name, span)?,
            (None, Some((name, span)), PictureUse::Normal) => normal_map(arguments, name, span)?,
            // The grey of a height map is as good for a deviation as for a height.
            (None, Some((name, span)), PictureUse::Height | PictureUse::Roughness) => {
                height_map(arguments, name, span)?
            }
            _ => {
                return Err(arguments.error("the map is not clear", "give exactly one of `path` and `generate`"));
            }
        };
        arguments.finish()?;
        Ok(picture)
    }

    fn colour_map(&mut self, table: &Spanned<ArgumentTable>) -> Result<Arc<Picture>, SceneError> {
        let arguments = Arguments::new(self.source, table);
        let key = arguments.fingerprint();
        if let Some(known) = self.colour_maps.get(&key) {
            return Ok(Arc::clone(known));
        }
        let picture = Arc::new(self.picture(&arguments, PictureUse::Colour)?);
        self.colour_maps.insert(key, Arc::clone(&picture));
        Ok(picture)
    }

    fn object(
        &mut self,
        index: usize,
        object: &Spanned<ObjectDescription>,
        has_environment: bool,
    ) -> Result<Object, SceneError> {
        let span = object.span();
        let object = object.get_ref();
        let name = object.name.clone().unwrap_or_else(|| format!("object {}", index + 1));
        let (mut mesh, has_uv, shape) = self.triangles(object, &name, span)?;
        let placement = self.placement(object)?;
        let uv_repeat = match &object.uv_repeat {
            None => [1.0; 2],
            Some(repeat) => self.source.all_in_range("uv_repeat", repeat, 0.001..=4096.0)?,
        };
        placement.apply(&mut mesh, uv_repeat);
        let beyond = |vertex: &super::Vertex| vertex.position.abs().max_element() > 2.0 * MAX_COORDINATE;
        if mesh.vertices.iter().any(beyond) {
            let help = "choose a smaller `scale`, or a smaller shape";
            return Err(self.source.value_error(object.shape.span(), "the object reaches too far out", help));
        }
        let material = self.material(&object.material, &name, shape, has_uv, &placement, has_environment)?;
        Ok(Object { name, mesh, material })
    }

    /// Triangles in object space, whether they have texture coordinates, and the built-in shape.
    fn triangles(
        &mut self,
        object: &ObjectDescription,
        name: &str,
        object_span: Range<usize>,
    ) -> Result<(Mesh, bool, Option<Shape>), SceneError> {
        let source = self.source;
        let shape_name = *object.shape.get_ref();
        let measures = [
            ("size", object.size.as_ref().map(Spanned::span)),
            ("radius", object.radius.as_ref().map(Spanned::span)),
            ("height", object.height.as_ref().map(Spanned::span)),
            ("arc_degrees", object.arc_degrees.as_ref().map(Spanned::span)),
            ("focal_length", object.focal_length.as_ref().map(Spanned::span)),
            ("depth", object.depth.as_ref().map(Spanned::span)),
            ("folds", object.folds.as_ref().map(Spanned::span)),
            ("segments", object.segments.as_ref().map(Spanned::span)),
            ("path", object.path.as_ref().map(Spanned::span)),
            ("generate", object.generate.as_ref().map(Spanned::span)),
        ];
        let known: &[&str] = match shape_name {
            ShapeName::Plane => &["size", "segments"],
            ShapeName::Sphere => &["radius", "segments"],
            ShapeName::Cylinder => &["radius", "height", "arc_degrees", "segments"],
            ShapeName::Paraboloid => &["radius", "focal_length", "segments"],
            ShapeName::Drapery => &["size", "depth", "folds", "segments"],
            ShapeName::Mesh => &["path", "generate"],
        };
        for (key, span) in measures {
            if let Some(span) = span
                && !known.contains(&key)
            {
                let help = format!("this shape takes: {}", known.join(", "));
                return Err(source.value_error(span, format!("`{key}` does not belong to this shape"), help));
            }
        }
        let number = |key, value: &Option<Spanned<f64>>, default, range| match value {
            None => Ok(default),
            Some(value) => source.in_range(key, *value.get_ref(), value.span(), range),
        };
        let length = |key, value, default| number(key, value, default, LENGTHS);
        let radius = length("radius", &object.radius, 1.0)?;
        let size = object.size.as_ref().map_or(Ok([1.0; 2]), |size| source.all_in_range("size", size, LENGTHS))?;
        let shape = match shape_name {
            ShapeName::Plane => Shape::Plane { size },
            ShapeName::Sphere => Shape::Sphere { radius },
            ShapeName::Cylinder => Shape::Cylinder {
                radius,
                height: length("height", &object.height, 1.0)?,
                arc_degrees: number("arc_degrees", &object.arc_degrees, 360.0, 1.0..=360.0)?,
            },
            ShapeName::Paraboloid => {
                Shape::Paraboloid { radius, focal_length: length("focal_length", &object.focal_length, 1.0)? }
            }
            ShapeName::Drapery => Shape::Drapery {
                size,
                depth: length("depth", &object.depth, 0.1)?,
                folds: number("folds", &object.folds, 5.0, 0.25..=64.0)?,
            },
            ShapeName::Mesh => {
                let ObjMesh { mesh, has_uv, warnings } = self.obj(object, object_span)?;
                self.warnings.extend(warnings.into_iter().map(|warning| format!("{name}: {warning}")));
                return Ok((mesh, has_uv, None));
            }
        };
        let segments = match &object.segments {
            None => shape.default_segments(),
            Some(segments) => {
                let fewest = shape.fewest_segments();
                let [u, v] = *segments.get_ref();
                let whole =
                    |count, fewest| source.whole_in_range("segments", count, segments.span(), fewest..=MAX_SEGMENTS);
                [whole(u, fewest[0])?, whole(v, fewest[1])?]
            }
        };
        debug_assert!(2 * MAX_SEGMENTS as usize * MAX_SEGMENTS as usize <= MAX_TRIANGLES);
        Ok((shape.mesh(segments), true, Some(shape)))
    }

    /// The triangles of a mesh, from a file or generated.
    fn obj(&self, object: &ObjectDescription, object_span: Range<usize>) -> Result<ObjMesh, SceneError> {
        let source = self.source;
        let (read, span) = match (&object.path, &object.generate) {
            (Some(path), None) => (read_obj(&self.resolve(path.get_ref())), path.span()),
            (None, Some(name)) => {
                let text = mesh_text(name.get_ref()).ok_or_else(|| {
                    let message = format!("there is no generated mesh `{}`", name.get_ref());
                    source.value_error(name.span(), message, format!("the generated ones are: {}", mesh_names()))
                })?;
                (parse_obj(Path::new(name.get_ref()), &text), name.span())
            }
            _ => {
                let help = "give exactly one of `path` (an OBJ file, relative to the scene file) and `generate`";
                return Err(source.value_error(object_span, "a mesh needs a file", help));
            }
        };
        read.map_err(|error| SceneError::Mesh {
            fault: source.fault(span, error.to_string(), "paths are relative to the scene file"),
            source: error,
        })
    }

    fn placement(&self, object: &ObjectDescription) -> Result<Placement, SceneError> {
        let source = self.source;
        let triple = |key, value: &Option<Spanned<[f64; 3]>>, bound: f64| match value {
            None => Ok([0.0; 3]),
            Some(value) => source.all_in_range(key, value, -bound..=bound),
        };
        let translate = triple("translate", &object.translate, MAX_COORDINATE)?;
        let rotate_degrees = triple("rotate_degrees", &object.rotate_degrees, 3600.0)?;
        let scale = self.one_or_three("scale", &object.scale, 1.0, 1e-4..=1e4)?;
        Ok(Placement::new(DVec3::from_array(translate), rotate_degrees, scale))
    }

    fn one_or_three(
        &self,
        key: &str,
        value: &Option<Spanned<OneOrThree>>,
        default: f64,
        range: std::ops::RangeInclusive<f64>,
    ) -> Result<[f64; 3], SceneError> {
        let Some(value) = value else {
            return Ok([default; 3]);
        };
        let OneOrThree(three) = *value.get_ref();
        for number in three {
            self.source.in_range(key, number, value.span(), range.clone())?;
        }
        Ok(three)
    }

    fn material(
        &mut self,
        material: &MaterialDescription,
        name: &str,
        shape: Option<Shape>,
        has_uv: bool,
        placement: &Placement,
        has_environment: bool,
    ) -> Result<Material, SceneError> {
        let source = self.source;
        let maps = [&material.colour_map, &material.height_map, &material.normal_map, &material.roughness_map];
        if let Some(map) = maps.into_iter().flatten().next()
            && !has_uv
        {
            let help = "export the mesh with texture coordinates (`vt` lines), or leave the map out";
            return Err(source.value_error(map.span(), "the mesh has no texture coordinates for a map", help));
        }
        let colour = match &material.colour {
            None => [1.0; 3],
            Some(colour) => source.all_in_range("colour", colour, 0.0..=1.0)?,
        };
        let reflectance = self.one_or_three("reflectance", &material.reflectance, 0.0, 0.0..=1.0)?;
        if let Some(value) = &material.reflectance
            && reflectance != [0.0; 3]
            && !has_environment
        {
            let help = "add a table [environment], or leave `reflectance` out";
            return Err(source.value_error(value.span(), "there is no environment to reflect", help));
        }
        let frame = match material.frame.as_ref().map(|frame| *frame.get_ref()) {
            Some(FrameName::MainDirection) => FrameSystem::MainDirection,
            Some(FrameName::Natural) => FrameSystem::Natural,
            Some(FrameName::NaturalNormalised) => FrameSystem::NaturalNormalised,
            // One direction cannot follow the charts of an arbitrary mesh.
            None if shape.is_none() => FrameSystem::NaturalNormalised,
            None => FrameSystem::MainDirection,
        };
        let main_direction = match &material.main_direction {
            None => shape.map_or(DVec3::Y, Shape::main_direction),
            Some(direction) => {
                let vector = DVec3::from_array(source.all_in_range(
                    "main_direction",
                    direction,
                    -MAX_COORDINATE..=MAX_COORDINATE,
                )?);
                if vector.length() < 1e-6 {
                    let help = "give the axis of the object, for example [0, 1, 0]";
                    return Err(source.value_error(direction.span(), "`main_direction` has no length", help));
                }
                vector
            }
        };
        let colour_map = material.colour_map.as_ref().map(|table| self.colour_map(table)).transpose()?;
        let shadowing = material.peaks.as_ref().is_some_and(|peaks| peaks.get_ref().needs_heights());
        let bump = self.bump(material, name, frame, shadowing)?;
        let roughness = self.roughness(material, name, frame, bump.as_deref())?;
        let heights = material.height_map.is_some();
        let there = Available { lights: self.has_lights, heights, bumps: heights || material.normal_map.is_some() };
        let highlight = material.highlight.as_ref().map(|highlight| lighting::highlight(source, highlight, there));
        let peaks = material.peaks.as_ref().map(|peaks| lighting::peaks(source, peaks, there));
        if let (Some(_), Some(peaks)) = (&material.highlight, &material.peaks) {
            let help = "give the highlight as a further peak: normal = [0, 0, 1] and its exponent";
            return Err(source.value_error(peaks.span(), "a material has one of `highlight` and `peaks`", help));
        }
        let (highlight, peaks) = (highlight.transpose()?, peaks.transpose()?);
        if let (Some(field), Some(Peaks { source: PeakSource::Bump { .. }, .. })) = (&bump, &peaks)
            && field.offsets.len() as u64 > MAX_TEXELS
            && let Some(map) = material.height_map.as_ref().or(material.normal_map.as_ref())
        {
            let message = format!("{}×{} texels are too many to fit peaks to", field.width, field.height);
            let help = format!("make the map smaller, at most {MAX_TEXELS} texels (1024×1024), or leave `peaks` out");
            return Err(source.value_error(map.span(), message, help));
        }
        Ok(Material {
            colour: colour.map(|channel| channel as f32),
            colour_map,
            bump,
            roughness,
            frame,
            main_direction: placement.direction(main_direction),
            reflectance: reflectance.map(|channel| channel as f32),
            highlight,
            peaks,
        })
    }

    fn bump(
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
            let heights = self.picture(&arguments, PictureUse::Height)?;
            if with_heights {
                BumpField::with_heights(&heights, scale, frame)
            } else {
                BumpField::from_heights(&heights, scale, frame)
            }
        } else {
            if frame == FrameSystem::Natural {
                let help = "use `height_map`, or the frame \"natural-normalised\" or \"main-direction\"";
                let message = "the frame \"natural\" needs heights: a normal map has no depth";
                return Err(arguments.error(message, help));
            }
            BumpField::from_normals(&self.picture(&arguments, PictureUse::Normal)?)
        };
        if clamped > 0 {
            self.warnings.push(format!(
                "{name}: {clamped} texels of the bump map are steeper than {} and were clamped",
                super::OFFSET_LIMIT
            ));
        }
        // NaN is within nothing.
        if let Some(kept) = &field.heights
            && !kept.heights.iter().all(|height| HEIGHTS.contains(height))
        {
            let help = "choose a smaller `scale`, or a map without such heights";
            return Err(arguments.error("heights of more than 10^9 texels cast no shadows", help));
        }
        let field = Arc::new(field);
        self.bumps.insert(key, Arc::clone(&field));
        Ok(Some(field))
    }

    fn roughness(
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
                let (field, clamped) = self.roughness_field(&arguments)?;
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
    fn roughness_field(&self, arguments: &Arguments<'_>) -> Result<(RoughnessField, usize), SceneError> {
        if arguments.text("generate")?.is_some_and(|(name, _)| name == UNIFORM_ROUGHNESS) {
            let factor = uniform_roughness(arguments)?;
            arguments.finish()?;
            return Ok((RoughnessField::uniform(factor), 0));
        }
        let deviation = arguments.number("deviation", 0.25, 0.0..=MAX_DEVIATION)?;
        let channels = match arguments.text("channels")? {
            None | Some(("isotropic", _)) => RoughnessChannels::Isotropic,
            Some(("anisotropic", _)) => RoughnessChannels::Anisotropic,
            Some((other, span)) => {
                let message = format!("`channels` is \"{other}\"");
                return Err(arguments.error_at(span, message, "choose \"isotropic\" or \"anisotropic\""));
            }
        };
        Ok(RoughnessField::from_picture(&self.picture(arguments, PictureUse::Roughness)?, channels, deviation))
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERA: &str = "camera = { eye = [0, 1, 5], target = [0, 0, 0] }\n";
    const STUDIO: &str = "environment = { generate = \"studio\", face_edge = 8 }\n";

    fn read(rest: &str) -> Result<Scene, SceneError> {
        Scene::from_toml("test.toml", &format!("{CAMERA}{rest}"), Path::new("no such folder"))
    }

    fn plane(material: &str) -> Result<Scene, SceneError> {
        read(&format!("{STUDIO}[[object]]\nshape = \"plane\"\n[object.material]\n{material}\n"))
    }

    #[test]
    fn defaults_are_those_of_the_readme() {
        let scene = plane("").unwrap();
        let camera = scene.camera;
        assert_eq!((camera.up, camera.fov_y_degrees, camera.width, camera.height), (DVec3::Y, 40.0, 640, 480));
        assert_eq!(scene.background, Background::Environment);
        let object = &scene.objects[0];
        assert_eq!((object.name.as_str(), object.mesh.triangles.len()), ("object 1", 2));
        let material = &object.material;
        assert_eq!((material.colour, material.reflectance), ([1.0; 3], [0.0; 3]));
        assert_eq!((material.frame, material.main_direction), (FrameSystem::MainDirection, DVec3::NEG_Z));
        assert!(material.bump.is_none() && material.colour_map.is_none());
        assert_eq!(read("").unwrap().background, Background::Colour([0.0; 3]));
    }

    #[test]
    fn equal_maps_are_made_once_wherever_they_stand() {
        let object = "[[object]]\nshape = \"plane\"\n[object.material]\n\
                      colour_map = { generate = \"noise\", size = 16 }\nheight_map = { generate = \"bumps\", size = 16 }\n";
        let scene = read(&object.repeat(2)).unwrap();
        let [first, second] = [0, 1].map(|index| &scene.objects[index].material);
        assert!(first.colour_map.is_some() && first.bump.is_some());
        assert!(Arc::ptr_eq(first.colour_map.as_ref().unwrap(), second.colour_map.as_ref().unwrap()));
        assert!(Arc::ptr_eq(first.bump.as_ref().unwrap(), second.bump.as_ref().unwrap()));
    }

    /// Message, line and column of the error of a whole scene text.
    fn fault(text: &str) -> (String, usize, usize) {
        match Scene::from_toml("test.toml", text, Path::new("no such folder")) {
            Ok(_) => panic!("no error in {text}"),
            Err(error) => {
                let fault = error.fault().unwrap();
                (error.to_string(), fault.line, fault.column)
            }
        }
    }

    #[test]
    fn bad_scenes_name_line_column_and_remedy() {
        let object = |line: &str| format!("{CAMERA}{STUDIO}[[object]]\nshape = \"plane\"\n{line}\n");
        let material = |line: &str| object(&format!("[object.material]\n{line}"));
        for (text, place, expected) in [
            ("camera = {".to_owned(), (1, 11), ""),
            ("x = 1\n".to_owned(), (1, 1), "unknown field `x`, expected one of `camera`"),
            (format!("{CAMERA}\ncolor = 1\n"), (3, 1), "unknown field `color`"),
            ("[camera]\neye = [0, 0, 0]\n".to_owned(), (1, 1), "missing field `target`"),
            ("[camera]\neye = [0, 0]\ntarget = [0, 0, 1]\n".to_owned(), (2, 7), "invalid length 2"),
            ("[camera]\neye = \"here\"\n".to_owned(), (2, 7), "invalid type: string"),
            ("[camera]\neye = [nan, 0, 0]\ntarget = [0, 0, 1]\n".to_owned(), (2, 7), "`eye` is NaN"),
            ("[camera]\neye = [0, 0, 1]\ntarget = [0, 0, 1]\n".to_owned(), (3, 10), "move them apart"),
            ("[camera]\neye = [0, 1, 0]\ntarget = [0, 0, 0]\n".to_owned(), (3, 10), "not parallel"),
            ("[camera]\neye = [0, 1, 0]\ntarget = [1, 0, 0]\nfov_y = 180\n".to_owned(), (4, 9), "from 0.1 to 170"),
            ("[camera]\neye = [0, 1, 0]\ntarget = [1, 0, 0]\nwidth = 0\n".to_owned(), (4, 9), "from 1 to 16384"),
            (
                "[camera]\neye = [0, 1, 0]\ntarget = [1, 0, 0]\nwidth = 16384\nheight = 16384\n".to_owned(),
                (5, 10),
                "too many",
            ),
            (format!("{CAMERA}background = {{ top = [0, 0, 0] }}\n"), (2, 14), "exactly one of"),
            (format!("{CAMERA}background = {{ environment = true }}\n"), (2, 30), "no environment to show"),
            (format!("{CAMERA}environment = {{ generate = \"mars\" }}\n"), (2, 28), "moon, zebra"),
            (
                format!("{CAMERA}environment = {{ generate = \"moon\", stripes = 3 }}\n"),
                (2, 36),
                "known here: `generate`",
            ),
            (format!("{CAMERA}environment = {{ faces = [\"a\", \"b\"] }}\n"), (2, 25), "name six"),
            (format!("{CAMERA}environment = {{ equirectangular = \"a.png\" }}\n"), (2, 35), "a.png"),
            (object("radius = 2"), (5, 10), "this shape takes: size, segments"),
            (object("arc_degrees = 90"), (5, 15), "this shape takes: size, segments"),
            (object("size = [1, -1]"), (5, 8), "out of range"),
            (format!("{CAMERA}[[object]]\nshape = \"cylinder\"\narc_degrees = 361\n"), (4, 15), "from 1 to 360"),
            (format!("{CAMERA}[[object]]\nshape = \"drapery\"\nfolds = 0\n"), (4, 9), "from 0.25 to 64"),
            (format!("{CAMERA}[[object]]\nshape = \"drapery\"\nradius = 1\n"), (4, 10), "size, depth, folds, segments"),
            (object("segments = [0, 4]"), (5, 12), "from 1 to 1024"),
            (object("scale = [1, 0, 1]"), (5, 9), "out of range"),
            (object("scale = [1, 1]"), (5, 9), "three numbers"),
            (object("scale = \"big\""), (5, 9), "a number or an array of three numbers"),
            (object("rotate_degrees = [inf, 0, 0]"), (5, 18), "out of range"),
            (object("scale = 10000\ntranslate = [1e6, 1e6, 1e6]\nsize = [1e6, 1]"), (4, 9), "too far out"),
            (material("reflectance = 1.5"), (6, 15), "out of range"),
            (material("frame = \"frenet\""), (6, 9), "unknown variant `frenet`, expected one of"),
            (material("main_direction = [0, 0, 0]"), (6, 18), "no length"),
            (material("colour_map = {}"), (6, 14), "exactly one of `path` and `generate`"),
            (material("colour_map = { generate = \"noise\", sise = 3 }"), (6, 36), "unknown key `sise`"),
            (material("colour_map = { generate = \"noise\", size = 3.5 }"), (6, 43), "a whole number"),
            (material("colour_map = { generate = \"writing\", text = \"ä\" }"), (6, 45), "no letter `Ä`"),
            (material("colour_map = { path = \"missing.png\" }"), (6, 23), "missing.png"),
            (material("height_map = { generate = \"waves\", scale = 1, rms_slope = 1 }"), (6, 14), "keep one"),
            (material("normal_map = { generate = \"waves\" }"), (6, 27), "no generated normal map `waves`"),
            (material("roughness_map = {}"), (6, 17), "exactly one of `path` and `generate`"),
            (material("roughness_map = { generate = \"uniform\", along = 5 }"), (6, 49), "from 0 to 4"),
            (material("roughness_map = { generate = \"uniform\", deviation = 1 }"), (6, 41), "unknown key `deviation`"),
            (material("roughness_map = { generate = \"waves\", channels = \"d\" }"), (6, 50), "`channels` is \"d\""),
            (
                material("frame = \"natural\"\nroughness_map = { generate = \"uniform\" }"),
                (7, 17),
                "takes no roughness map",
            ),
            (
                material(
                    "height_map = { generate = \"bumps\", size = 16 }\n\
                     roughness_map = { generate = \"bumps\", size = 8 }",
                ),
                (7, 17),
                "the roughness map has 8×8 texels and the bump map 16×16 (make both the same size)",
            ),
            (material("height_map = { generate = \"grooves\", periods_u = 0 }"), (6, 14), "no period"),
            (material("frame = \"natural\"\nnormal_map = { path = \"n.png\" }"), (7, 14), "needs heights"),
            (
                material("height_map = { generate = \"waves\" }\nnormal_map = { path = \"n.png\" }"),
                (7, 14),
                "one bump map",
            ),
            (format!("{CAMERA}[[object]]\nshape = \"cube\"\n"), (3, 9), "unknown variant `cube`"),
            (format!("{CAMERA}[[object]]\nshape = \"mesh\"\n"), (2, 1), "a mesh needs a file"),
            (format!("{CAMERA}[[object]]\nshape = \"mesh\"\npath = \"no.obj\"\n"), (4, 8), "no.obj"),
            (format!("{CAMERA}[[object]]\nshape = \"mesh\"\ngenerate = \"cow\"\n"), (4, 12), "no generated mesh `cow`"),
            (
                format!("{CAMERA}[[object]]\nshape = \"plane\"\nmaterial = {{ reflectance = 1 }}\n"),
                (4, 28),
                "no environment to reflect",
            ),
        ] {
            let (message, line, column) = fault(&text);
            assert!(message.contains(expected), "{text}\n{message}");
            assert_eq!((line, column), place, "{text}\n{message}");
            assert!(message.starts_with(&format!("test.toml:{line}:{column}: ")), "{message}");
        }
    }

    #[test]
    fn a_scene_cut_anywhere_is_an_error_or_a_scene_but_never_a_panic() {
        let text = super::super::builtin_text("shapes").unwrap();
        for end in (0..text.len()).filter(|&end| text.is_char_boundary(end)).step_by(7) {
            let _ = Source::new("cut", &text[..end], Path::new("")).parse();
        }
    }

    #[test]
    fn files_are_found_beside_the_scene() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("square.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\nf 1/1 1/1 2/2\n");
        write("bad.obj", "v 0 0 nan\n");
        write("square.toml", &format!("{CAMERA}[[object]]\nname = \"it\"\nshape = \"mesh\"\npath = \"square.obj\"\n"));
        write("bad.toml", &format!("{CAMERA}[[object]]\nshape = \"mesh\"\npath = \"bad.obj\"\n"));
        let scene = Scene::from_file(&folder.path().join("square.toml")).unwrap();
        assert_eq!((scene.name.as_str(), scene.objects[0].mesh.triangles.len()), ("square", 1));
        assert_eq!(scene.objects[0].material.frame, FrameSystem::NaturalNormalised);
        assert_eq!(scene.warnings, ["it: 1 triangles without an area were dropped"]);
        let error = Scene::from_file(&folder.path().join("bad.toml")).unwrap_err().to_string();
        assert!(error.contains("bad.toml:4:8: ") && error.contains("bad.obj:1: coordinate `nan`"), "{error}");
        std::fs::write(folder.path().join("binary.toml"), [0xff, 0xfe]).unwrap();
        let not_text = Scene::from_file(&folder.path().join("binary.toml"));
        assert!(matches!(not_text, Err(SceneError::NotText { .. })));
        let missing = Scene::from_file(&folder.path().join("missing.toml"));
        assert!(matches!(missing, Err(SceneError::Unreadable { .. })));
    }

    #[test]
    fn a_mesh_without_texture_coordinates_takes_no_map() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("bare.obj"), "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n").unwrap();
        let text = format!(
            "{CAMERA}[[object]]\nshape = \"mesh\"\npath = \"bare.obj\"\n\
             material = {{ height_map = {{ generate = \"bumps\" }} }}\n"
        );
        let error = Scene::from_toml("test.toml", &text, folder.path()).unwrap_err().to_string();
        assert!(error.contains("no texture coordinates"), "{error}");
    }

    #[test]
    fn frame_sizes_from_outside_are_checked() {
        let scene = read("").unwrap();
        assert_eq!(scene.clone().with_size(1280, 720).unwrap().camera.width, 1280);
        for (width, height) in [(0, 10), (10, 0), (16_385, 1), (16_384, 16_384)] {
            assert!(matches!(scene.clone().with_size(width, height), Err(SceneError::FrameSize { .. })));
        }
    }
}
