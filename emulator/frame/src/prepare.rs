//! Preparation of a frame: the maps and constants of a scene's objects, for one profile and mode.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;
use roughxel_core::fx::Fx;
use roughxel_core::precision::Precision;
use roughxel_core::scalar_api::environment_scale;
use roughxel_core::setup::block_vector;
use roughxel_core::signals::MapScale;
use roughxel_maps::bump::BumpPyramid;
use roughxel_peaks::ScenePeaks;
use roughxel_scene::{Light, LightPlace, Object, Scene};
use roughxel_shader::{BumpMap, CubeTexels, Effect, Environment, Material, ObjectPlan, Shader};
use roughxel_simd::Backend;

use super::colour::colour_word;
use super::environment::EnvironmentMap;
use super::frame::Frame;
use super::lighting::{self, lighting, peak_texels};
use super::shared::{PlannedBumps, address, shared};
use super::texture::{StoredBumps, colour_map};
use crate::plan::{Decision, Mode, decisions, object_plan};
use crate::raster::{Projection, RasterError};

/// A scene with its maps built for one profile and mode; borrows the scene's geometry.
pub struct Prepared<'a> {
    pub(super) scene: &'a Scene,
    pub(super) projection: Projection,
    pub(super) mode: Mode,
    pub(super) precision: Precision,
    pub(super) backend: Backend,
    pub(super) environment: Option<Arc<EnvironmentMap>>,
    pub(super) environment_scale: MapScale<i32>,
    /// Material of rays that hit nothing.
    pub(super) mirror: Material,
    pub(super) objects: Vec<PreparedObject>,
}

/// An object with its maps.
pub(super) struct PreparedObject {
    /// Material of its fragments.
    pub(super) material: Material,
    pub(super) decisions: Vec<Decision>,
    /// Positions of the lights that stand in the scene.
    pub(super) light_points: Vec<DVec3>,
    /// Bytes of offsets and of roughness of its bump map in the stored format.
    bump_bytes: [u64; 2],
}

impl PreparedObject {
    /// Replaces the plan and drops maps that the plan does not read.
    fn with_plan(self, plan: ObjectPlan) -> Self {
        let Material { colour_map, bump_map, lighting, .. } = self.material;
        let bumps = bump_map.map(|map| StoredBumps { map, bytes: self.bump_bytes });
        let (bump_map, bump_bytes) = split(bumps.and_then(|bumps| bumps.with_plan(&plan)));
        let material = Material {
            plan,
            colour_map: colour_map.filter(|_| plan.colour_map),
            bump_map,
            lighting: lighting.and_then(|lighting| lighting::with_plan(lighting, &plan)),
            ..self.material
        };
        Self { material, bump_bytes, ..self }
    }
}

/// The position of a light that stands in the scene.
fn standing(light: &Light) -> Option<DVec3> {
    match light.place {
        LightPlace::Point(point) => Some(point),
        LightPlace::Direction(_) => None,
    }
}

/// A bump map and the bytes of its storage.
fn split(bumps: Option<StoredBumps>) -> (Option<Arc<BumpMap>>, [u64; 2]) {
    bumps.map_or((None, [0; 2]), |StoredBumps { map, bytes }| (Some(map), bytes))
}

impl fmt::Debug for Prepared<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Prepared").field("scene", &self.scene.name).field("mode", &self.mode).finish_non_exhaustive()
    }
}

impl<'a> Prepared<'a> {
    /// Builds the maps that a scene needs in a mode with a profile. Maps outside the plan are not built.
    pub fn new(scene: &'a Scene, mode: Mode, profile: &Precision) -> Result<Self, RasterError> {
        let peaks = ScenePeaks::new(scene, mode.filters(), None, &|_| ())?;
        Self::with_peaks(scene, mode, profile, &peaks)
    }

    /// Same as [`Self::new`], from the scene's peaks, which are built already. The peaks are built with filters; a mode without
    /// filters takes either kind.
    pub fn with_peaks(
        scene: &'a Scene,
        mode: Mode,
        profile: &Precision,
        peaks: &ScenePeaks,
    ) -> Result<Self, RasterError> {
        Self::with_maps(scene, mode, profile, (peaks, Self::environment_map(scene, mode.filters())))
    }

    /// The environment of a scene, with filters or without. It does not depend on the profile.
    pub fn environment_map(scene: &Scene, filters: bool) -> Option<Arc<EnvironmentMap>> {
        let source = scene.shown_environment()?;
        Some(Arc::new(EnvironmentMap::new(&source.faces, filters)))
    }

    /// Same as [`Self::with_peaks`], from the result of [`Self::environment_map`] for the mode's filters. Build the environment
    /// once per scene and share it between profiles.
    pub fn with_maps(
        scene: &'a Scene,
        mode: Mode,
        profile: &Precision,
        (peaks, environment): (&ScenePeaks, Option<Arc<EnvironmentMap>>),
    ) -> Result<Self, RasterError> {
        let precision = mode.precision(profile);
        let projection = Projection::new(&scene.camera)?;
        let edge = environment.as_ref().map_or(1, |map| map.edge());
        let light_points: Vec<DVec3> = scene.lights.iter().filter_map(standing).collect();
        let (objects, filters) = (&scene.objects, mode.filters());
        let colour_maps =
            shared(objects.iter().map(|object| object.material.colour_map.as_deref().map(address)), |group| {
                let own = objects[group[0]].material.colour_map.as_deref();
                vec![own.map(|picture| Arc::new(colour_map(picture, filters))); group.len()]
            });
        let shows_bumps = |own: &roughxel_scene::Material| environment.is_some() || own.highlight.is_some();
        let bump_key = |object: &Object| (shows_bumps(&object.material), BumpPyramid::key(&object.material, filters));
        let planned = shared(objects.iter().map(bump_key), |group| {
            let own = &objects[group[0]].material;
            let bump = shows_bumps(own).then(|| BumpPyramid::of_material(own, filters, &precision)).flatten();
            let plan =
                |&index: &usize| object_plan(&objects[index], bump.as_ref(), environment.is_some(), mode, &precision);
            let plans = group.par_iter().map(plan).collect();
            PlannedBumps::of(bump, plans)
        });
        let peak_keys = planned
            .iter()
            .enumerate()
            .map(|(index, planned)| (peaks.pyramid(index).map(address), planned.plan.horizon as u8));
        let peak_maps = shared(peak_keys, |group| {
            let (pyramid, kind) = (peaks.pyramid(group[0]), planned[group[0]].plan.horizon);
            vec![pyramid.map(|pyramid| Arc::new(peak_texels(pyramid, filters, kind))); group.len()]
        });
        let maps = colour_maps.into_par_iter().zip(planned).zip(peak_maps);
        let objects = objects.par_iter().zip(maps).map(|(object, ((colour_map, planned), peaks))| {
            let (own, PlannedBumps { plan, lobes, bumps }) = (&object.material, planned);
            let (bump_map, bump_bytes) = split(bumps);
            let share = |r: f32| Fx::from_raw((f64::from(r).clamp(0.0, 1.0) * 65536.0).round() as i32);
            let material = Material {
                plan,
                colour: colour_word(own.colour),
                reflectance: own.reflectance.map(share),
                main_direction: block_vector(own.main_direction, &precision),
                colour_map,
                bump_map,
                lobes,
                lighting: lighting(own, &plan, &scene.lights, peaks, &precision),
            };
            let decisions = decisions(&plan, object, mode, &precision);
            PreparedObject { material, decisions, light_points: light_points.clone(), bump_bytes }
        });
        let objects = objects.collect();
        let environment_scale = environment_scale(edge as u16, &precision);
        let backend = Backend::best();
        let mirror = Material::mirror(mode.filters());
        Ok(Self { scene, projection, mode, precision, backend, environment, environment_scale, mirror, objects })
    }

    /// Replaces [`Backend::best`] by a different backend; no bit of a frame depends on it.
    pub fn with_backend(self, backend: Backend) -> Self {
        Self { backend, ..self }
    }

    /// Shader of its fragments.
    pub(super) fn shader(&self) -> Shader<'_> {
        let of = |map| Environment { texels: EnvironmentMap::texels(map), scale: &self.environment_scale };
        Shader { backend: self.backend, precision: &self.precision, environment: self.environment.as_deref().map(of) }
    }

    /// The plan of each object, in the order of the scene.
    pub fn plans(&self) -> impl Iterator<Item = &ObjectPlan> {
        self.objects.iter().map(|object| &object.material.plan)
    }

    /// Texels of the environment, if the scene shows one.
    pub fn environment_texels(&self) -> Option<&CubeTexels> {
        self.environment.as_deref().map(EnvironmentMap::texels)
    }

    /// True if the environment is brighter than 64 × white somewhere, so that each texel has an exponent.
    pub fn has_bright_environment(&self) -> bool {
        self.environment.as_ref().is_some_and(|map| map.is_bright())
    }

    /// Every effect of each object with its reason, in the order of the scene.
    pub fn decisions(&self) -> impl Iterator<Item = &[Decision]> {
        self.objects.iter().map(|object| object.decisions.as_slice())
    }

    /// Replaces the plan of one object, to see what an effect changes and costs. Effects without a map get neutral inputs.
    pub fn with_plan(mut self, object: usize, plan: ObjectPlan) -> Self {
        let changed = |(index, own): (usize, PreparedObject)| if index == object { own.with_plan(plan) } else { own };
        self.objects = self.objects.into_iter().enumerate().map(changed).collect();
        self
    }

    /// Bytes of storage, by effect, of an object's maps and of the environment it reflects.
    pub fn map_bytes(&self, object: usize) -> Vec<(Effect, u64)> {
        let Some(object) = self.objects.get(object) else { return Vec::new() };
        let environment = self.environment.as_ref().filter(|_| object.material.plan.reflection.is_some());
        let lighting = object.material.lighting.as_ref();
        let [peaks, horizons] = lighting.map_or([0; 2], lighting::bytes).map(|bytes| (bytes > 0).then_some(bytes));
        let [offsets, roughness] = object.bump_bytes.map(|bytes| object.material.bump_map.as_ref().map(|_| bytes));
        [
            (Effect::ColourTexture, object.material.colour_map.as_ref().map(|map| map.texels.bytes())),
            (Effect::Bump, offsets),
            (Effect::Roughness, roughness.filter(|&bytes| bytes > 0)),
            (Effect::Environment, environment.map(|map| map.bytes())),
            (Effect::Peaks, peaks),
            (Effect::Horizon, horizons),
        ]
        .into_iter()
        .filter_map(|(effect, bytes)| Some((effect, bytes?)))
        .collect()
    }

    /// Bytes of all maps. A map that objects share counts once.
    pub fn all_map_bytes(&self) -> u64 {
        let of_object = |object: &PreparedObject| {
            let Material { colour_map, bump_map, lighting, .. } = &object.material;
            let colour = colour_map.as_ref().map(|map| (address(&**map), map.texels.bytes()));
            let bumps = bump_map.as_ref().map(|map| (address(&**map), object.bump_bytes.into_iter().sum()));
            let lights = lighting.as_ref().map(|own| (lighting::address(own), lighting::bytes(own).into_iter().sum()));
            [colour, bumps, lights].into_iter().flatten()
        };
        let maps: BTreeMap<usize, u64> = self.objects.iter().flat_map(of_object).collect();
        self.environment.as_ref().map_or(0, |map| map.bytes()) + maps.into_values().sum::<u64>()
    }

    /// Most bytes at a time from the frame to its file: [`Frame::BYTES_A_PIXEL`] for each pixel.
    pub fn frame_bytes(&self) -> u64 {
        Frame::BYTES_A_PIXEL * u64::from(self.projection.width()) * u64::from(self.projection.height())
    }
}
