//! Steps from the keys of a scene file to a [`Scene`]: ranges, files, generated maps, defaults.

mod environment;
pub(crate) mod inspect;
mod light;
mod lights;
mod maps;
mod material;
mod object;

use std::io::Read as _;
use std::path::Path;

use glam::DVec3;
use toml::Spanned;

use self::maps::Maps;
use self::material::Surroundings;
use crate::builtin::{builtin_names, builtin_text};
use crate::description::{BackgroundDescription, CameraDescription};
use crate::error::SceneError;
use crate::generate::{MapProgress, Unseen};
use crate::scene::{Background, Camera, Scene};
use crate::source::{Exactly, Source};
use roughxel_utilities::input::open_file;
use roughxel_utilities::limits::{
    MAX_COORDINATE, MAX_FRAME_EDGE_PX, MAX_FRAME_PIXELS, MAX_SCENE_BYTES, frame_size_is_allowed,
};
use roughxel_utilities::suggestions::did_you_mean;

/// Most objects of a scene.
const MAX_OBJECTS: usize = 1000;

impl Scene {
    /// Reads a scene file; paths in it are relative to its folder.
    ///
    /// Errors: a file that is missing, too large or not UTF-8, and the errors of [`Scene::from_toml`].
    pub fn from_file(path: &Path) -> Result<Self, SceneError> {
        from_file(path, &Unseen)
    }

    /// Reads a scene from TOML `text`. `label` names it in errors and becomes its name; relative paths start at
    /// `base_dir`.
    ///
    /// Errors, with file, line and column: an unknown or missing key, a wrong type, a value out of range, a picture or
    /// mesh that cannot be read.
    pub fn from_toml(label: &str, text: &str, base_dir: &Path) -> Result<Self, SceneError> {
        from_toml(label, text, base_dir, &Unseen)
    }

    /// The built-in scene `name` ([`builtin_names`](crate::builtin_names)), with its maps generated; `None` for other names.
    pub fn builtin(name: &str) -> Option<Result<Self, SceneError>> {
        let text = builtin_text(name)?;
        Some(Self::from_toml(name, text, Path::new("")))
    }

    /// The built-in scene `name`, or else the scene of that file.
    ///
    /// Errors: those of [`Scene::from_file`], or that there is neither.
    pub fn open(name: &str) -> Result<Self, SceneError> {
        Self::open_with(name, &Unseen)
    }

    /// Opens a scene as [`Scene::open`] does, and reports the progress of its maps.
    pub fn open_with(name: &str, progress: &dyn MapProgress) -> Result<Self, SceneError> {
        let file = Path::new(name);
        match builtin_text(name) {
            Some(text) => from_toml(name, text, Path::new(""), progress),
            None if file.try_exists().is_ok_and(|there| !there) => {
                let meant = did_you_mean(name, builtin_names());
                Err(SceneError::whole(format!(
                    "{name}: there is no such scene file, and no built-in scene of that name \
                     ({meant}`roughxel scenes` lists them)"
                )))
            }
            None => from_file(file, progress),
        }
    }

    /// This scene with another frame size in pixels; the vertical angle of view stays.
    ///
    /// Errors: an edge outside 1 to [`MAX_FRAME_EDGE_PX`](roughxel_utilities::limits::MAX_FRAME_EDGE_PX), or more than
    /// [`MAX_FRAME_PIXELS`](roughxel_utilities::limits::MAX_FRAME_PIXELS).
    pub fn with_size(mut self, width: u32, height: u32) -> Result<Self, SceneError> {
        if !frame_size_is_allowed(width, height) {
            return Err(SceneError::whole(format!(
                "a frame of {width}×{height} pixels is out of range \
                 (choose edges of 1 to {MAX_FRAME_EDGE_PX} and at most {MAX_FRAME_PIXELS} pixels)"
            )));
        }
        self.camera.width = width;
        self.camera.height = height;
        Ok(self)
    }
}

/// Reads a scene file.
fn from_file(path: &Path, progress: &dyn MapProgress) -> Result<Scene, SceneError> {
    let shown = path.display();
    let unreadable = |source| SceneError::Whole {
        message: format!("{shown}: cannot read the scene file: {source} (check the name and the permissions)"),
        source: Some(source),
    };
    let too_large = |bytes| {
        let message = format!("{shown}: is {bytes} bytes long, more than {MAX_SCENE_BYTES} (is it a scene file?)");
        Err(SceneError::whole(message))
    };
    let file = open_file(path).map_err(unreadable)?;
    let bytes = file.metadata().map_err(unreadable)?.len();
    if bytes > MAX_SCENE_BYTES {
        return too_large(bytes);
    }
    // The limit is checked again, as a file may grow.
    let mut content = Vec::new();
    file.take(MAX_SCENE_BYTES + 1).read_to_end(&mut content).map_err(unreadable)?;
    if content.len() as u64 > MAX_SCENE_BYTES {
        return too_large(content.len() as u64);
    }
    if content.starts_with(b"glTF") {
        return Err(SceneError::whole(format!("{shown}: is a glTF model (make a scene of it with `roughxel import`)")));
    }
    let not_text = |_| SceneError::whole(format!("{shown}: is not UTF-8 text (save the scene file as UTF-8)"));
    let text = String::from_utf8(content).map_err(not_text)?;
    let base_dir = path.parent().unwrap_or(Path::new(""));
    let mut scene = from_toml(&path.display().to_string(), &text, base_dir, progress)?;
    if let Some(stem) = path.file_stem() {
        scene.name = stem.to_string_lossy().into_owned();
    }
    Ok(scene)
}

/// Reads a scene from its text.
fn from_toml(label: &str, text: &str, base_dir: &Path, progress: &dyn MapProgress) -> Result<Scene, SceneError> {
    let source = Source::new(label, text, base_dir);
    let description = source.parse()?;
    let mut maps = Maps::new(&source, progress);
    let camera = camera(&source, &description.camera)?;
    let environment = description.environment.as_ref().map(|table| maps.environment(table)).transpose()?;
    let background = background(&source, description.background.as_ref(), environment.is_some())?;
    if let Some(extra) = description.object.get(MAX_OBJECTS) {
        let help = format!("a scene has at most {MAX_OBJECTS}; join some in one mesh");
        return Err(source.value_error(extra.span(), "too many objects", help));
    }
    let lights = lights::lights(&source, &description.light)?;
    let there = Surroundings { environment: environment.is_some(), lights: !lights.is_empty() };
    let mut objects = Vec::new();
    for (index, object) in description.object.iter().enumerate() {
        objects.push(object::object(&mut maps, index, object, there)?);
    }
    let Maps { warnings, pictures, .. } = maps;
    Ok(Scene { name: label.to_owned(), camera, background, environment, lights, objects, pictures, warnings })
}

/// The viewer of the scene.
fn camera(source: &Source, camera: &CameraDescription) -> Result<Camera, SceneError> {
    let point = |key, value: &Spanned<Exactly<f64, 3>>| {
        source.all_in_range(key, value, -MAX_COORDINATE..=MAX_COORDINATE).map(DVec3::from_array)
    };
    let eye = point("eye", &camera.eye)?;
    let target = point("target", &camera.target)?;
    let up = camera.up.as_ref().map_or(Ok(DVec3::Y), |up| point("up", up))?;
    let sight = target - eye;
    // Nearer points have no direction but that of their last digits.
    if sight.length() <= 1e-11 * eye.abs().max(target.abs()).max_element() {
        let help = "move them apart: the camera looks from `eye` to `target`";
        return Err(source.value_error(camera.target.span(), "`target` is where `eye` is", help));
    }
    // 1e-6 is the sine of the angle between sight and up; below it the picture's right-hand direction is rounding.
    if sight.cross(up).length() <= 1e-6 * sight.length() * up.length() {
        let span = camera.up.as_ref().map_or(camera.target.span(), Spanned::span);
        let help = "choose an `up` that is not zero and not parallel to the line from `eye` to `target`";
        return Err(source.value_error(span, "`up` gives no direction in the picture", help));
    }
    let fov_y_degrees = source.number("fov_y", &camera.fov_y, 40.0, 0.1..=170.0)?;
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

/// The background of the scene.
fn background(
    source: &Source,
    background: Option<&Spanned<BackgroundDescription>>,
    has_environment: bool,
) -> Result<Background, SceneError> {
    let Some(background) = background else {
        return Ok(if has_environment { Background::Environment } else { Background::Colour([0.0; 3]) });
    };
    let colour = |key, value: &Spanned<Exactly<f64, 3>>| {
        source.all_in_range(key, value, 0.0..=1.0).map(|colour| colour.map(|channel| channel as f32))
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
            Err(source.value_error(shown.span(), "there is no environment to show", help))
        }
        _ => Err(source.value_error(
            background.span(),
            "the background is not clear",
            "give exactly one of: `colour`; `top` and `bottom`; `environment = true`",
        )),
    }
}
