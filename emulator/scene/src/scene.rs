//! Content of a frame: camera, background, environment, lights, objects with their materials.

use std::sync::Arc;

use glam::DVec3;

use crate::bump::{BumpField, FrameSystem};
use crate::lighting::{Highlight, Light, Peaks};
use crate::roughness::RoughnessField;
use roughxel_assets::Mesh;
use roughxel_assets::picture::{Picture, Statement};

/// Content of a frame.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of a built-in scene, or the stem of the file's name.
    pub name: String,
    /// The viewer.
    pub camera: Camera,
    /// Background of pixels without an object.
    pub background: Background,
    /// Reflected surroundings, infinitely far away.
    pub environment: Option<EnvironmentSource>,
    /// Lights in the order of the file.
    pub lights: Vec<Light>,
    /// Objects in the order of the file.
    pub objects: Vec<Object>,
    /// Picture files and the decisions about them, in the order in which they were read.
    pub pictures: Vec<PictureUse>,
    /// Repairs while reading (dropped triangles, clamped offsets), one sentence each.
    pub warnings: Vec<String>,
}

impl Scene {
    /// The environment, if an object or the background shows it.
    pub fn shown_environment(&self) -> Option<&EnvironmentSource> {
        let reflects = |object: &Object| object.material.reflectance.iter().any(|&share| share > 0.0);
        let is_shown = self.background == Background::Environment || self.objects.iter().any(reflects);
        self.environment.as_ref().filter(|_| is_shown)
    }
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

/// Background of pixels without an object. Colours are linear.
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

/// A picture file and its use.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct PictureUse {
    /// Use in the scene: `environment`, or an object and its map.
    pub used_as: String,
    /// Path as the scene file gives it.
    pub path: String,
    /// Words of the file, and decisions.
    #[serde(flatten)]
    pub statement: Statement,
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

/// Place of the footprints of reflections.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FootprintPlace {
    /// The plane of a cube face (W97).
    Face,
    /// The sphere.
    Sphere,
}

/// Bumps that decide the roughness of a level that no longer shows them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Deviation {
    /// Most bumps: the standard deviation times the squared mean of |deviation| in units of the normal law's. The factor is clamped to ½…1. It is 1
    /// for bumps of the normal law, and less for bumps that are mostly flat and seldom steep.
    #[default]
    Mean,
    /// All bumps, by their squares (S97 §8): the standard deviation.
    RootMeanSquare,
    /// Root mean square of all bumps. If they are not normally distributed, reflections have two lobes with the weights and widths of the map's own law.
    Law,
}

/// Surface of an object, per channel: `(1 − reflectance)·colour·colour_map + reflectance·environment(reflected ray)`, and for
/// each light its colour times the highlight or the peaks.
#[derive(Clone, Debug)]
pub struct Material {
    /// Linear colour, 0 to 1.
    pub colour: [f32; 3],
    /// Colour map, linear, repeat addressing.
    pub colour_map: Option<Arc<Picture>>,
    /// Offsets of the normal.
    pub bump: Option<Arc<BumpField>>,
    /// Roughness in addition to `bump`: of the size of `bump`, or of one texel.
    pub roughness: Option<Arc<RoughnessField>>,
    /// Tangent basis of `bump` and `roughness`. A roughness map excludes [`FrameSystem::Natural`].
    pub frame: FrameSystem,
    /// Main direction h of [`FrameSystem::MainDirection`]: unit, world space.
    pub main_direction: DVec3,
    /// Share of the environment per channel, 0 to 1.
    pub reflectance: [f32; 3],
    /// Roughness that lost bumps of `bump` become on coarse levels.
    pub deviation: Deviation,
    /// Place of the footprints of reflections; `None` lets the surface's roughness decide.
    pub footprint: Option<FootprintPlace>,
    /// True if rough reflections have two lobes; `None` lets the slopes of `bump` decide.
    pub two_lobes: Option<bool>,
    /// Highlight of the lights; not together with peaks.
    pub highlight: Option<Highlight>,
    /// Several normals at a point.
    pub peaks: Option<Peaks>,
}
