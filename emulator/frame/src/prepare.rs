//! What is there before a frame is drawn: the maps and constants of a scene's objects, for one profile and mode.

use std::fmt;
use std::sync::Arc;

use rayon::prelude::*;
use roughxel_core::fx::{Control, Fx};
use roughxel_core::ports::{BlockVector, REFLECTANCE};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::setup::block_vector;
use roughxel_core::signals::MapScale;
use roughxel_core::soft_core::environment_scale;
use roughxel_lanes::{Reading, RepeatedMap};
use roughxel_maps::bump::BumpPyramid;
use roughxel_peaks::{PeakPyramid, ScenePeaks};
use roughxel_scene::{Background, Light, Material, Scene};

use super::colour::{Channel, colour_word};
use super::environment::EnvironmentMap;
use super::frame::Frame;
use super::lighting::{Lighting, peak_texels};
use super::texture::{BumpMap, ColourMap};
use crate::plan::{Decision, Effect, Mode, ObjectPlan};
use crate::raster::{Needs, Projection, RasterError};

/// A scene with its maps built for one profile and mode; borrows the scene's geometry.
pub struct Prepared<'a> {
    pub(super) scene: &'a Scene,
    pub(super) projection: Projection,
    pub(super) mode: Mode,
    pub(super) precision: Precision,
    pub(super) reading: Reading,
    pub(super) environment: Option<Arc<EnvironmentMap>>,
    pub(super) environment_scale: MapScale<i32>,
    pub(super) objects: Vec<PreparedObject>,
}

/// Maps and constants of one object.
pub(super) struct PreparedObject {
    pub(super) plan: ObjectPlan,
    pub(super) decisions: Vec<Decision>,
    pub(super) colour: [Channel; 3],
    pub(super) reflectance: [Control<i32, REFLECTANCE>; 3],
    pub(super) main_direction: BlockVector,
    pub(super) colour_map: Option<ColourMap>,
    pub(super) bump_map: Option<BumpMap>,
    pub(super) lighting: Option<Lighting>,
}

impl PreparedObject {
    /// The maps that a fragment reads.
    pub(super) fn maps(&self) -> impl Iterator<Item = &RepeatedMap> {
        let colour = self.colour_map.as_ref().map(ColourMap::map);
        let bump = self.bump_map.as_ref().map(BumpMap::map);
        [colour, bump, self.lighting.as_ref().and_then(Lighting::map)].into_iter().flatten()
    }

    /// Its bump map, where that is read with its roughness.
    pub(super) fn rough_map(&self) -> Option<&RepeatedMap> {
        let is_rough = self.plan.roughness() != RoughnessKind::None;
        self.bump_map.as_ref().filter(|_| is_rough).map(BumpMap::map)
    }

    /// The attributes that its fragments read.
    pub(super) fn needs(&self) -> Needs {
        let uv = self.maps().next().is_some();
        Needs { tangents: self.plan.needs_tangents(), uv, duv: uv && self.plan.texture_footprint }
    }
}

/// What shines in an object, with its peaks if they come from a map.
fn lighting(
    material: &Material,
    plan: &ObjectPlan,
    lights: &[Light],
    pyramid: Option<&PeakPyramid>,
    mode: Mode,
    p: &Precision,
) -> Option<Lighting> {
    let horizon = plan.horizon;
    match (&material.highlight, plan.highlight, &material.peaks, plan.peaks) {
        (Some(highlight), Some(plan), ..) => Some(Lighting::highlight(highlight, lights, plan, p)),
        (.., Some(peaks), Some(plan)) => {
            let map = pyramid.map(|pyramid| peak_texels(pyramid, mode.filters(), horizon));
            Some(Lighting::peaks(peaks, map, lights, plan, p))
        }
        _ => None,
    }
}

impl fmt::Debug for Prepared<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Prepared").field("scene", &self.scene.name).field("mode", &self.mode).finish_non_exhaustive()
    }
}

impl<'a> Prepared<'a> {
    /// Builds the maps a scene needs in a mode with a profile; what the plan leaves out is not built.
    pub fn new(scene: &'a Scene, mode: Mode, profile: &Precision) -> Result<Self, RasterError> {
        let peaks = ScenePeaks::new(scene, mode.filters(), None, &|_| ())?;
        Self::with_peaks(scene, mode, profile, &peaks)
    }

    /// The same with the peaks of the scene's maps already built, with filters or, for a mode without them, of either kind.
    pub fn with_peaks(
        scene: &'a Scene,
        mode: Mode,
        profile: &Precision,
        peaks: &ScenePeaks,
    ) -> Result<Self, RasterError> {
        Self::with_maps(scene, mode, profile, (peaks, Self::environment_map(scene, mode.filters())))
    }

    /// The environment that a scene shows, with filters or without; it depends on no profile.
    pub fn environment_map(scene: &Scene, filters: bool) -> Option<Arc<EnvironmentMap>> {
        let any_reflection = scene.objects.iter().any(|o| o.material.reflectance.iter().any(|&r| r > 0.0));
        let needs_environment = any_reflection || matches!(scene.background, Background::Environment);
        let source = scene.environment.as_ref().filter(|_| needs_environment)?;
        Some(Arc::new(EnvironmentMap::new(&source.faces, filters)))
    }

    /// The same as [`Self::with_peaks`] with what [`Self::environment_map`] has of the mode's filters: for who draws a scene in many profiles.
    pub fn with_maps(
        scene: &'a Scene,
        mode: Mode,
        profile: &Precision,
        (peaks, environment): (&ScenePeaks, Option<Arc<EnvironmentMap>>),
    ) -> Result<Self, RasterError> {
        let precision = mode.precision(profile);
        let projection = Projection::new(&scene.camera)?;
        let edge = environment.as_ref().map_or(1, |map| map.edge());
        let objects = scene
            .objects
            .par_iter()
            .enumerate()
            .map(|(index, object)| {
                let material = &object.material;
                let shows_bumps = environment.is_some() || material.highlight.is_some();
                let bump =
                    shows_bumps.then(|| BumpPyramid::of_material(material, mode.filters(), &precision)).flatten();
                let plan = ObjectPlan::new(object, bump.as_ref(), environment.is_some(), mode, &precision);
                PreparedObject {
                    plan,
                    lighting: lighting(material, &plan, &scene.lights, peaks.pyramid(index), mode, &precision),
                    decisions: plan.decisions(object, mode, &precision),
                    colour: colour_word(material.colour),
                    reflectance: material
                        .reflectance
                        .map(|r| Fx::from_raw((f64::from(r).clamp(0.0, 1.0) * 65536.0).round() as i32)),
                    main_direction: block_vector(material.main_direction, &precision),
                    colour_map: material.colour_map.as_ref().map(|map| ColourMap::new(map, mode.filters())),
                    bump_map: bump.and_then(|bump| BumpMap::new(bump).with_plan(&plan)),
                }
            })
            .collect();
        let environment_scale = environment_scale(edge as u16, &precision);
        let reading = Reading::best();
        Ok(Self { scene, projection, mode, precision, reading, environment, environment_scale, objects })
    }

    /// The same with another reading of the reflection datapath than [`Reading::best`]; no bit of a frame depends on it.
    pub fn with_reading(self, reading: Reading) -> Self {
        Self { reading, ..self }
    }

    /// The plan of each object, in the order of the scene.
    pub fn plans(&self) -> impl Iterator<Item = &ObjectPlan> {
        self.objects.iter().map(|object| &object.plan)
    }

    /// Whether what is reflected is brighter than 64 × white somewhere: its texels have an exponent each.
    pub fn has_bright_environment(&self) -> bool {
        self.environment.as_ref().is_some_and(|map| map.is_bright())
    }

    /// Every effect of each object with the reason for it, in the order of the scene.
    pub fn decisions(&self) -> impl Iterator<Item = &[Decision]> {
        self.objects.iter().map(|object| object.decisions.as_slice())
    }

    /// The same with another plan for one object, to see what an effect changes and what it costs. Effects without a map
    /// get neutral inputs.
    pub fn with_plan(mut self, object: usize, plan: ObjectPlan) -> Self {
        if let Some(object) = self.objects.get_mut(object) {
            object.plan = plan;
            object.colour_map.take_if(|_| !plan.colour_map);
            object.bump_map = object.bump_map.take().and_then(|map| map.with_plan(&plan));
            object.lighting = object.lighting.take().and_then(|lighting| lighting.with_plan(&plan));
        }
        self
    }

    /// The maps of an object and the environment it reflects, by effect, in bytes of their storage.
    pub fn map_bytes(&self, object: usize) -> Vec<(Effect, u64)> {
        let Some(object) = self.objects.get(object) else { return Vec::new() };
        let environment = self.environment.as_ref().filter(|_| object.plan.reflection.is_some());
        let [peaks, horizons] =
            object.lighting.as_ref().map_or([0; 2], Lighting::bytes).map(|bytes| (bytes > 0).then_some(bytes));
        let [offsets, roughness] = [0, 1].map(|part| object.bump_map.as_ref().map(|map| map.bytes()[part]));
        [
            (Effect::ColourTexture, object.colour_map.as_ref().map(ColourMap::bytes)),
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

    /// Bytes of all maps, those that objects share once for each, and the environment once.
    pub fn all_map_bytes(&self) -> u64 {
        let of_object = |object: &PreparedObject| {
            let colour = object.colour_map.as_ref().map_or(0, ColourMap::bytes);
            let bump = object.bump_map.as_ref().map_or([0; 2], BumpMap::bytes);
            let lighting = object.lighting.as_ref().map_or([0; 2], Lighting::bytes);
            colour + bump.into_iter().chain(lighting).sum::<u64>()
        };
        self.environment.as_ref().map_or(0, |map| map.bytes()) + self.objects.iter().map(of_object).sum::<u64>()
    }

    /// Bytes that the frame takes until it is a file, at most at a time: [`Frame::BYTES_A_PIXEL`] of each pixel.
    pub fn frame_bytes(&self) -> u64 {
        Frame::BYTES_A_PIXEL * u64::from(self.projection.width()) * u64::from(self.projection.height())
    }
}
