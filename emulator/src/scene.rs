//! Scenes: camera, background, environment and objects, read from a TOML file or built in.
//!
//! `description` holds the file's keys and where each stands, `shapes` and `mesh` make triangles, `bump` makes offset
//! vectors (S97 §7), `roughness` what is finer than those, `generate` makes the maps nobody has to download, `builtin`
//! lists the scenes of the papers.
//! Everything that comes from outside is bounded here, so that later stages see finite numbers and indices in range.

mod builtin;
mod bump;
mod description;
mod error;
mod generate;
mod lighting;
mod load;
mod mesh;
mod roughness;
mod shapes;

use std::path::Path;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::picture::Picture;

pub use builtin::{builtin_names, builtin_text};
pub use bump::{BumpField, FrameSystem, HeightField, OFFSET_LIMIT};
pub use error::{Fault, SceneError};
pub use lighting::{
    EXPONENTS, GivenPeak, Highlight, HighlightForm, Light, LightPlace, MAX_GIVEN_PEAKS, MAX_LIGHTS, PeakSource, Peaks,
};
pub use mesh::MeshError;
pub use roughness::RoughnessField;

/// Largest edge of a frame in pixels.
pub const MAX_FRAME_EDGE_PX: u32 = 16_384;
/// Largest number of pixels of a frame.
pub const MAX_FRAME_PIXELS: u64 = 1 << 26;
/// Largest size of a scene file in bytes.
pub const MAX_SCENE_BYTES: u64 = 1 << 20;

/// Everything a frame is drawn from.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of a built-in scene, or the stem of the file's name.
    pub name: String,
    /// The viewer.
    pub camera: Camera,
    /// What a pixel shows where no object is.
    pub background: Background,
    /// Reflected surroundings, infinitely far away.
    pub environment: Option<EnvironmentSource>,
    /// Lights in the order of the file.
    pub lights: Vec<Light>,
    /// Objects in the order of the file.
    pub objects: Vec<Object>,
    /// What was repaired while reading (dropped triangles, clamped offsets), one sentence each.
    pub warnings: Vec<String>,
}

/// A pinhole camera in a right-handed world; view vectors point from the surface to `eye`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position of the eye, world units.
    pub eye: DVec3,
    /// Point in the centre of the picture, world units.
    pub target: DVec3,
    /// Direction that points up in the picture; any length, not parallel to the line of sight.
    pub up: DVec3,
    /// Full vertical angle of view in degrees, 0.1 to 170.
    pub fov_y_degrees: f64,
    /// Width of the frame in pixels.
    pub width: u32,
    /// Height of the frame in pixels.
    pub height: u32,
}

/// What a pixel shows where no object is. Colours are linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Background {
    /// One colour.
    Colour([f32; 3]),
    /// A ramp over the rows of the frame.
    Ramp {
        /// Colour of the top row.
        top: [f32; 3],
        /// Colour of the bottom row.
        bottom: [f32; 3],
    },
    /// The environment in the direction of the line of sight.
    Environment,
}

/// Six square faces of one size in Vulkan's order +x, −x, +y, −y, +z, −z; linear light.
#[derive(Clone, Debug)]
pub struct EnvironmentSource {
    /// The faces; the left column is s = −1, the top row t = −1.
    pub faces: [Picture; 6],
}

/// A mesh with its material.
#[derive(Clone, Debug)]
pub struct Object {
    /// Name from the file, or `object N`.
    pub name: String,
    /// Triangles in world space.
    pub mesh: Mesh,
    /// Surface.
    pub material: Material,
}

/// Indexed triangles in world space; counter-clockwise seen from the side of the normal for the built-in shapes.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Vertices.
    pub vertices: Vec<Vertex>,
    /// Vertex indices, all below `vertices.len()`; no triangle has zero area.
    pub triangles: Vec<[u32; 3]>,
}

/// One vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Position, world units.
    pub position: DVec3,
    /// Unit normal, world space.
    pub normal: DVec3,
    /// Texture coordinates in repeats of the map: u to the right, v up, (0, 0) the bottom-left corner.
    pub uv: DVec2,
    /// ∂p/∂u and ∂p/∂v in world units per repeat; both zero where a mesh has no texture coordinates.
    ///
    /// Where a mesh mirrors its map both are negated: S97's s_u = n × p_v and s_v = p_u × n then still run against
    /// the true p_u and p_v, so that bumps stay bumps.
    pub tangents: [DVec3; 2],
}

/// Surface: `(1 − reflectance)·colour·colour_map + reflectance·environment(reflected ray)`, and for each light its colour times
/// the highlight or the peaks, per channel.
#[derive(Clone, Debug)]
pub struct Material {
    /// Linear colour, 0 to 1.
    pub colour: [f32; 3],
    /// Colour map, linear, repeat addressing.
    pub colour_map: Option<Arc<Picture>>,
    /// Offsets of the normal.
    pub bump: Option<Arc<BumpField>>,
    /// Roughness besides `bump`: of the same size as that, or of one texel.
    pub roughness: Option<Arc<RoughnessField>>,
    /// In which frame `bump` and `roughness` are meant; the latter not in [`FrameSystem::Natural`].
    pub frame: FrameSystem,
    /// Main direction h of [`FrameSystem::MainDirection`]: unit, world space.
    pub main_direction: DVec3,
    /// Share of the environment per channel, 0 to 1.
    pub reflectance: [f32; 3],
    /// Highlight of the lights; not together with peaks.
    pub highlight: Option<Highlight>,
    /// Several normals at a point.
    pub peaks: Option<Peaks>,
}

impl Scene {
    /// Reads a scene file; paths in it are relative to its folder.
    ///
    /// Errors: the file is missing, too large or not UTF-8, or one of those of [`Scene::from_toml`].
    pub fn from_file(path: &Path) -> Result<Self, SceneError> {
        load::from_file(path)
    }

    /// Reads a scene from TOML `text`; `label` names it in errors and becomes its name, `base_dir` is where its
    /// relative paths start.
    ///
    /// Errors: with file, line and column, for an unknown or missing key, a wrong type, a value out of range, or a
    /// picture or mesh that cannot be read.
    pub fn from_toml(label: &str, text: &str, base_dir: &Path) -> Result<Self, SceneError> {
        load::from_toml(label, text, base_dir)
    }

    /// The built-in scene of that name ([`builtin_names`]), with its maps generated; `None` for other names.
    pub fn builtin(name: &str) -> Option<Result<Self, SceneError>> {
        let text = builtin_text(name)?;
        Some(Self::from_toml(name, text, Path::new("")))
    }

    /// The built-in scene of that name, or else the scene in that file.
    ///
    /// Errors: those of [`Scene::from_file`].
    pub fn open(name: &str) -> Result<Self, SceneError> {
        Self::builtin(name).unwrap_or_else(|| Self::from_file(Path::new(name)))
    }

    /// The same scene at another frame size in pixels; the vertical angle of view stays.
    ///
    /// Errors: an edge outside 1 to [`MAX_FRAME_EDGE_PX`], or more than [`MAX_FRAME_PIXELS`].
    pub fn with_size(mut self, width: u32, height: u32) -> Result<Self, SceneError> {
        if !frame_size_is_allowed(width, height) {
            return Err(SceneError::FrameSize { width, height });
        }
        self.camera.width = width;
        self.camera.height = height;
        Ok(self)
    }
}

/// Whether a frame of that size may be drawn.
fn frame_size_is_allowed(width: u32, height: u32) -> bool {
    let edge = 1..=MAX_FRAME_EDGE_PX;
    edge.contains(&width) && edge.contains(&height) && u64::from(width) * u64::from(height) <= MAX_FRAME_PIXELS
}
