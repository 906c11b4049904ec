//! What a frame is drawn from: camera, background, environment, lights, objects with their materials.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::bump::{BumpField, FrameSystem};
use crate::lighting::{Highlight, Light, Peaks};
use crate::picture::Picture;
use crate::roughness::RoughnessField;

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

impl Scene {
    /// The environment, where an object or the background shows it.
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

/// Where footprints of reflections lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FootprintPlace {
    /// On the plane of a cube face (W97).
    Face,
    /// On the sphere.
    Sphere,
}

/// Which of the bumps that a level has lost its roughness is like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Deviation {
    /// Most of them: the standard deviation times the squared mean of |deviation| in units of the normal law's, where that is below 1, down to half. The same for bumps
    /// of the normal law, and less for those that are mostly flat and seldom steep.
    #[default]
    Mean,
    /// All of them, by their squares (S97 §8): the standard deviation.
    RootMeanSquare,
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
    /// What `bump` leaves behind on coarse levels.
    pub deviation: Deviation,
    /// Where footprints of reflections lie; `None` leaves it to how rough the surface is.
    pub footprint: Option<FootprintPlace>,
    /// Whether rough reflections have two lobes; `None` leaves it to the slopes of `bump`.
    pub two_lobes: Option<bool>,
    /// Highlight of the lights; not together with peaks.
    pub highlight: Option<Highlight>,
    /// Several normals at a point.
    pub peaks: Option<Peaks>,
}
