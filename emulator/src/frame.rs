//! Whole frames through the integer datapath: visibility, fetches and the blocks of each object's plan.
//!
//! Deferred: a tile's visible triangles first, then each pixel once. Fragments of an object wait until a batch of them
//! gets its footprints, and what reflects waits again for the reflection datapath, so that lanes are full. Tiles are
//! independent, so the bits of a frame do not depend on the number of threads. Memory between address and texel lives
//! here; everything between texel and pixel is a stage of `roughxel-core`.

mod environment;
mod lighting;
mod printed;
mod texture;

use std::fmt;

use fixed::types::I4F28;
use glam::DVec3;
use rayon::prelude::*;
use roughxel_core::datapath::ReflectionInput;
use roughxel_core::fx::Fx;
use roughxel_core::plan::{FrameSystem, ReflectionPlan};
use roughxel_core::ports::{BlockVector, ReflectionIn, environment_scale};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::setup::block_vector;
use roughxel_core::signals::{MapScale, OFFSET};
use roughxel_core::stage::blend::{REFLECTANCE, blend};
use sha2::{Digest, Sha256};

use crate::lanes::Reading;
use crate::maps::bump::BumpPyramid;
use crate::maps::peaks::{PeakPyramid, ScenePeaks};
use crate::picture::Picture;
use crate::plan::{Decision, Effect, Mode, ObjectPlan};
use crate::raster::{
    FragmentAttributes, Projection, RasterError, SUBPIXELS, TileBuffer, TileRect, Triangle, TriangleList, tiles,
};
use crate::scene::{Background, Light, Material, Scene};
pub use environment::EnvironmentMap;
use lighting::{Lighting, PeakMap, PeaksRead, Points};
use texture::{BumpMap, RepeatedMap};
pub use texture::{ColourMap, Footprints, MapReads, Taps};

/// Linear colour with 24 fraction bits per channel, I8F24.
pub type Colour = [i32; 3];

/// A scene with its maps built for one profile and mode; borrows the scene's geometry.
pub struct Prepared<'a> {
    scene: &'a Scene,
    projection: Projection,
    mode: Mode,
    precision: Precision,
    reading: Reading,
    environment: Option<EnvironmentMap>,
    environment_scale: MapScale<i32>,
    objects: Vec<PreparedObject>,
}

/// Maps and constants of one object.
struct PreparedObject {
    plan: ObjectPlan,
    decisions: Vec<Decision>,
    colour: Colour,
    reflectance: [Fx<i32, 16>; 3],
    main_direction: BlockVector,
    colour_map: Option<ColourMap>,
    bump_map: Option<BumpMap>,
    lighting: Option<Lighting>,
}

/// Fragments that wait to be shaded, at most: their attributes stay in a first-level cache.
const SHADED: usize = 64;

/// Fragments of one object that wait to be shaded.
struct Fragments {
    attributes: Vec<FragmentAttributes>,
    /// The pixel of each in its tile.
    pixels: Vec<usize>,
    /// From each to every light.
    directions: Vec<BlockVector>,
    footprints: Footprints,
}

impl Fragments {
    /// None of an object.
    fn of(object: &PreparedObject) -> Self {
        let footprints = Footprints::new(object.maps().filter(|_| object.plan.texture_footprint));
        Self { attributes: Vec::new(), pixels: Vec::new(), directions: Vec::new(), footprints }
    }
}

/// What shading a fragment reads; its memory is kept for the next one.
#[derive(Default)]
struct Reads {
    taps: Taps,
    peaks: PeaksRead,
}

/// Fragments that wait for the reflection datapath, at most: their inputs stay in a second-level cache.
const REFLECTED: usize = 256;

/// Fragments of one plan that wait for the reflection datapath.
struct Waiting {
    plan: ReflectionPlan,
    reflectance: [Fx<i32, 16>; 3],
    inputs: Vec<ReflectionInput<i32>>,
    /// The pixel of each in its tile, and its colour without the reflection.
    pixels: Vec<(usize, Colour)>,
}

impl Waiting {
    /// None of an object; without a reflection none will come.
    fn of(object: &PreparedObject) -> Self {
        let plan = object.plan.reflection.unwrap_or(ReflectionPlan::FULL);
        Self { plan, reflectance: object.reflectance, inputs: Vec::new(), pixels: Vec::new() }
    }

    /// None of the rays that hit nothing: mirrors without bumps.
    fn rays(mode: Mode) -> Self {
        let plan = ReflectionPlan {
            bump: false,
            frame: FrameSystem::MainDirection,
            roughness: RoughnessKind::None,
            curvature: false,
            footprint: mode.filters(),
        };
        Self { plan, reflectance: [Fx::lit(1 << REFLECTANCE); 3], inputs: Vec::new(), pixels: Vec::new() }
    }
}

impl PreparedObject {
    /// The maps that a fragment reads.
    fn maps(&self) -> impl Iterator<Item = &RepeatedMap> {
        let colour = self.colour_map.as_ref().map(ColourMap::map);
        let bump = self.bump_map.as_ref().map(BumpMap::map);
        [colour, bump, self.lighting.as_ref().and_then(Lighting::map)].into_iter().flatten()
    }
}

/// The colours of a tile's pixels, summed over their samples.
struct Sums(Vec<[i64; 3]>);

impl Sums {
    fn add(&mut self, pixel: usize, colour: [i64; 3]) {
        for (sum, channel) in self.0[pixel].iter_mut().zip(colour) {
            *sum += channel;
        }
    }
}

/// What a ray that hits nothing sees.
enum Ray {
    /// A colour.
    Colour(Colour),
    /// The environment, as this mirror reflects it.
    Reflection(ReflectionIn),
}

/// A finished frame, rows top to bottom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Linear colours, I8F24.
    pub pixels: Vec<Colour>,
}

impl Frame {
    /// The frame in linear light.
    pub fn picture(&self) -> Picture {
        let pixels =
            self.pixels.iter().map(|pixel| pixel.map(|channel| (f64::from(channel) / f64::from(1 << 24)) as f32));
        Picture { width: self.width, height: self.height, pixels: pixels.collect() }
    }

    /// Peak signal to noise ratio against a frame of the same size, dB: linear light, range 1, all channels, colours
    /// cut to [0, 1] as a display cuts them. Equal frames give infinity, frames of different size NaN.
    pub fn psnr(&self, truth: &Self) -> f64 {
        if (self.width, self.height) != (truth.width, truth.height) {
            return f64::NAN;
        }
        let display = |channel: i32| f64::from(channel.clamp(0, 1 << 24)) / f64::from(1 << 24);
        let channels = self.pixels.iter().flatten().zip(truth.pixels.iter().flatten());
        let sum: f64 = channels.map(|(&a, &b)| (display(a) - display(b)).powi(2)).sum();
        -10.0 * (sum / (3 * self.pixels.len()) as f64).log10()
    }

    /// SHA-256 over size and pixels (big-endian words): equal exactly where every bit of the frame is.
    pub fn digest(&self) -> String {
        let mut hash = Sha256::new();
        hash.update(self.width.to_be_bytes());
        hash.update(self.height.to_be_bytes());
        for channel in self.pixels.iter().flatten() {
            hash.update(channel.to_be_bytes());
        }
        hash.finalize().iter().fold(String::new(), |text, byte| text + &format!("{byte:02x}"))
    }
}

/// The largest exponent of a map: colours stay below 64, the range of the blend. A brighter sun is cut to it.
pub const MAX_MAP_EXPONENT: i32 = 6;

/// The brightest channel of a frame.
const BRIGHTEST: i64 = 63 << 24;

/// What shines in an object, with its peaks if they come from a map.
fn lighting(
    material: &Material,
    plan: &ObjectPlan,
    lights: &[Light],
    pyramid: Option<&PeakPyramid>,
    mode: Mode,
    p: &Precision,
) -> Option<Lighting> {
    let shadowing = plan.horizon;
    match (&material.highlight, plan.highlight, &material.peaks, plan.peaks) {
        (Some(highlight), Some(plan), ..) => Some(Lighting::highlight(highlight, lights, plan, p)),
        (.., Some(peaks), Some(plan)) => {
            let map = pyramid.map(|pyramid| PeakMap::new(pyramid, mode.filters(), shadowing));
            Some(Lighting::peaks(peaks, map, lights, plan, p))
        }
        _ => None,
    }
}

/// A linear colour as I8F24, cut to the range of the blend.
fn colour_word(colour: [f32; 3]) -> Colour {
    colour.map(|channel| (f64::from(channel).clamp(0.0, 63.0) * f64::from(1 << 24)).round() as i32)
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
        let precision = mode.precision(profile);
        let projection = Projection::new(&scene.camera)?;
        let any_reflection = scene.objects.iter().any(|o| o.material.reflectance.iter().any(|&r| r > 0.0));
        let needs_environment = any_reflection || matches!(scene.background, Background::Environment);
        let environment = scene
            .environment
            .as_ref()
            .filter(|_| needs_environment)
            .map(|source| EnvironmentMap::new(&source.faces, mode.filters()));
        let edge = environment.as_ref().map_or(1, EnvironmentMap::edge);
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
                    bump_map: bump.filter(|_| plan.bump_map()).map(BumpMap::new),
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

    /// Every effect of each object with the reason for it, in the order of the scene.
    pub fn decisions(&self) -> impl Iterator<Item = &[Decision]> {
        self.objects.iter().map(|object| object.decisions.as_slice())
    }

    /// The same with another plan for one object, to see what an effect changes and what it costs. Blocks without a map
    /// get neutral inputs.
    pub fn with_plan(mut self, object: usize, plan: ObjectPlan) -> Self {
        if let Some(object) = self.objects.get_mut(object) {
            object.plan = plan;
            object.colour_map.take_if(|_| !plan.colour_map);
            object.bump_map.take_if(|_| !plan.bump_map());
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
        let is_rough = object.plan.roughness() != RoughnessKind::None;
        let [offsets, roughness] = [0, 1].map(|part| object.bump_map.as_ref().map(|map| map.bytes()[part]));
        [
            (Effect::ColourTexture, object.colour_map.as_ref().map(ColourMap::bytes)),
            (Effect::Bump, offsets),
            (Effect::Roughness, roughness.filter(|&bytes| bytes > 0 && is_rough)),
            (Effect::Environment, environment.map(EnvironmentMap::bytes)),
            (Effect::Peaks, peaks),
            (Effect::Horizon, horizons),
        ]
        .into_iter()
        .filter_map(|(effect, bytes)| Some((effect, bytes?)))
        .collect()
    }

    /// Draws the frame. `progress` is called once for each of [`Self::work`] pieces, from any thread.
    pub fn render(&self, progress: &(dyn Fn() + Sync)) -> Result<Frame, RasterError> {
        let (width, height) = (self.projection.width(), self.projection.height());
        let triangles = TriangleList::new(&self.projection, &self.scene.objects)?;
        let shaded: Vec<(TileRect, Vec<Colour>)> = tiles(width, height)
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(|tile| {
                let colours = self.shade_tile(&triangles, tile);
                progress();
                (tile, colours)
            })
            .collect();
        let mut pixels = vec![[0; 3]; width as usize * height as usize];
        for (tile, colours) in shaded {
            for (row, line) in (0..).zip(colours.chunks(tile.width as usize)) {
                let start = (tile.y + row) as usize * width as usize + tile.x as usize;
                pixels[start..start + line.len()].copy_from_slice(line);
            }
        }
        Ok(Frame { width, height, pixels })
    }

    /// Number of progress steps of [`Self::render`].
    pub fn work(&self) -> u64 {
        tiles(self.projection.width(), self.projection.height()).count() as u64
    }

    /// Sample positions in a pixel, sub-pixels from its corner: the centre, or a regular grid.
    fn sample_offsets(&self) -> Vec<[i32; 2]> {
        let edge = self.mode.samples_edge() as i32;
        let place = |i: i32| (2 * i + 1) * SUBPIXELS / (2 * edge);
        (0..edge * edge).map(|i| [place(i % edge), place(i / edge)]).collect()
    }

    fn shade_tile(&self, triangles: &TriangleList<'_>, tile: TileRect) -> Vec<Colour> {
        let offsets = self.sample_offsets();
        let mut buffer = TileBuffer::new();
        let mut sums = Sums(vec![[0; 3]; tile.width as usize * tile.height as usize]);
        let mut fragments: Vec<Fragments> = self.objects.iter().map(Fragments::of).collect();
        let mut waiting: Vec<Waiting> = self.objects.iter().map(Waiting::of).collect();
        let mut rays = Waiting::rays(self.mode);
        let mut reads = Reads::default();
        for &offset in &offsets {
            triangles.rasterise_tile(tile, offset, &mut buffer);
            let mut current: Option<(u32, Option<(Triangle<'_>, Points)>)> = None;
            let positions = (0..tile.height).flat_map(|y| (0..tile.width).map(move |x| (tile.x + x, tile.y + y)));
            for ((pixel, (x, y)), visible) in positions.enumerate().zip(buffer.triangles()) {
                let [x, y] = [x as i32 * SUBPIXELS + offset[0], y as i32 * SUBPIXELS + offset[1]];
                let Some(index) = visible else {
                    match self.background(x, y) {
                        Ray::Colour(colour) => sums.add(pixel, colour.map(i64::from)),
                        Ray::Reflection(input) => self.reflect(&mut rays, (pixel, [0; 3]), &input, &mut sums),
                    }
                    continue;
                };
                let object = triangles.object_index(index);
                let prepared = &self.objects[object];
                if current.as_ref().is_none_or(|(held, _)| *held != index) {
                    let triangle = triangles.triangle(index, prepared.plan.needs_tangents());
                    let set_up = triangle.map(|triangle| {
                        let points = prepared.lighting.as_ref().map(|lighting| lighting.points(&triangle));
                        (triangle, points.unwrap_or_default())
                    });
                    current = Some((index, set_up));
                }
                let Some((_, Some((triangle, points)))) = &current else { continue };
                let Fragments { attributes, pixels, directions, .. } = &mut fragments[object];
                attributes.push(triangle.fragment(x, y));
                pixels.push(pixel);
                if let Some(lighting) = &prepared.lighting {
                    lighting.directions(triangle, points, [x, y], directions);
                }
                if attributes.len() == SHADED {
                    self.shade(prepared, &mut fragments[object], &mut waiting[object], &mut reads, &mut sums);
                }
            }
        }
        for ((object, fragments), waiting) in self.objects.iter().zip(&mut fragments).zip(&mut waiting) {
            self.shade(object, fragments, waiting, &mut reads, &mut sums);
        }
        waiting.iter_mut().chain([&mut rays]).for_each(|waiting| self.fetch(waiting, &mut sums));
        let samples = offsets.len() as i64;
        // Many bright lights go beyond the range of a map.
        let mean = |channel: i64| ((channel + samples / 2) / samples).min(BRIGHTEST) as i32;
        sums.0.into_iter().map(|sum| sum.map(mean)).collect()
    }

    /// The waiting fragments of an object: footprints, fetches, lights; what reflects waits again.
    fn shade(
        &self,
        object: &PreparedObject,
        fragments: &mut Fragments,
        waiting: &mut Waiting,
        reads: &mut Reads,
        sums: &mut Sums,
    ) {
        let Fragments { attributes, pixels, directions, footprints } = fragments;
        footprints.set(attributes.iter(), self.reading, &self.precision);
        for (index, (attributes, pixel)) in attributes.iter().zip(pixels.iter().copied()).enumerate() {
            let mut maps = MapReads::new(attributes, (footprints, index), &mut reads.taps, &self.precision);
            let surface = surface(object, &mut maps);
            let needs_ports = object.plan.reflection.is_some() || object.lighting.is_some();
            let ports = needs_ports.then(|| self.ports(object, attributes, &mut maps));
            if let (Some(lighting), Some(ports)) = (&object.lighting, &ports) {
                let directions = &directions[index * lighting.lights()..][..lighting.lights()];
                let light =
                    lighting.shine(ports, directions, &mut maps, &mut reads.peaks, self.reading, &self.precision);
                sums.add(pixel, light);
            }
            match ports.filter(|_| object.plan.reflection.is_some()) {
                None => sums.add(pixel, surface.map(i64::from)),
                Some(input) => self.reflect(waiting, (pixel, surface), &input, sums),
            }
        }
        attributes.clear();
        pixels.clear();
        directions.clear();
    }

    /// Lets a fragment wait; with [`REFLECTED`] of them, all are reflected.
    fn reflect(&self, waiting: &mut Waiting, (pixel, surface): (usize, Colour), input: &ReflectionIn, sums: &mut Sums) {
        waiting.inputs.push(input.wires(self.environment_scale));
        waiting.pixels.push((pixel, surface));
        if waiting.inputs.len() == REFLECTED {
            self.fetch(waiting, sums);
        }
    }

    /// The waiting fragments through the reflection datapath, the environment and the blend.
    fn fetch(&self, waiting: &mut Waiting, sums: &mut Sums) {
        let Waiting { plan, reflectance, inputs, pixels } = waiting;
        let rough = plan.roughness != RoughnessKind::None;
        let footprints = self.reading.footprints(inputs, &plan_of_batch(plan, inputs), &self.precision);
        for (footprint, (pixel, surface)) in footprints.iter().zip(pixels.drain(..)) {
            let reflection = self
                .environment
                .as_ref()
                .map_or([0; 3], |map| map.sample(&footprint.point, &footprint.probes, rough, &self.precision));
            let channel = |i: usize| blend(Fx::from_raw(surface[i]), Fx::from_raw(reflection[i]), reflectance[i]).raw();
            sums.add(pixel, core::array::from_fn(|i| i64::from(channel(i))));
        }
        inputs.clear();
    }

    /// Ports of the datapath, bump map sampled.
    fn ports(
        &self,
        object: &PreparedObject,
        attributes: &FragmentAttributes,
        reads: &mut MapReads<'_>,
    ) -> ReflectionIn {
        let plan = &object.plan;
        let (offset, roughness) = match &object.bump_map {
            None => ([I4F28::ZERO; 2], [I4F28::ZERO; 3]),
            Some(map) => map.sample(reads, plan.roughness(), &self.precision),
        };
        let tangents =
            if plan.needs_tangents() { attributes.tangents } else { [object.main_direction, BlockVector::default()] };
        ReflectionIn {
            normal: attributes.normal,
            view: attributes.view,
            tangents,
            offset,
            roughness,
            dview: attributes.dview,
            dnormal: attributes.dnormal,
            edge_texels: self.environment.as_ref().map_or(1, |map| map.edge() as u16),
        }
    }

    /// What the ray through a pixel sees that hits nothing.
    fn background(&self, x: i32, y: i32) -> Ray {
        match (&self.scene.background, &self.environment) {
            (Background::Colour(colour), _) => Ray::Colour(colour_word(*colour)),
            (Background::Ramp { top, bottom }, _) => {
                let down = y as f32 / (self.projection.height() as i32 * SUBPIXELS) as f32;
                Ray::Colour(colour_word(core::array::from_fn(|i| top[i] + (bottom[i] - top[i]) * down)))
            }
            (Background::Environment, None) => Ray::Colour([0; 3]),
            (Background::Environment, Some(_)) => {
                // A mirror facing the ray from behind: r = 2d⟨d·d⟩ − d|d|² = d|d|², and a footprint as wide as the pixel's.
                let view = self.projection.ray_view(x, y);
                let ray = BlockVector { mantissa: view.mantissa.map(|m| -m), ..view };
                let dview = self.projection.dview();
                Ray::Reflection(ReflectionIn { normal: ray, view: ray, dview, ..ReflectionIn::default() })
            }
        }
    }

    /// Inputs of the reflection datapath for at most `most` reflecting fragments, evenly spread over the frame, with
    /// their plan: what `render --capture` and the demo export as vectors. Ports are quantised to the profile.
    pub fn capture(&self, most: usize) -> Result<Vec<(ReflectionIn, ReflectionPlan)>, RasterError> {
        let triangles = TriangleList::new(&self.projection, &self.scene.objects)?;
        let mut buffer = TileBuffer::new();
        let mut fragments = Vec::new();
        for tile in tiles(self.projection.width(), self.projection.height()) {
            triangles.rasterise_tile(tile, crate::raster::PIXEL_CENTRE_SUBPX, &mut buffer);
            for y in tile.y..tile.y + tile.height {
                for x in tile.x..tile.x + tile.width {
                    let Some(index) = buffer.triangle_at(x, y) else { continue };
                    if self.objects[triangles.object_index(index)].plan.reflection.is_some() {
                        fragments.push((x, y, index));
                    }
                }
            }
        }
        // Rows first, so that the choice does not depend on the tiles.
        fragments.sort_unstable_by_key(|&(x, y, _)| (y, x));
        let count = most.min(fragments.len());
        let chosen = (0..count).filter_map(|i| {
            let &(x, y, index) = fragments.get(i * fragments.len() / count.max(1))?;
            let object = triangles.object_index(index);
            let prepared = &self.objects[object];
            let triangle = triangles.triangle(index, prepared.plan.needs_tangents())?;
            let [x, y] = [x, y].map(|edge| edge as i32 * SUBPIXELS + SUBPIXELS / 2);
            let plan = prepared.plan.reflection?;
            let attributes = triangle.fragment(x, y);
            let mut footprints = Fragments::of(prepared).footprints;
            footprints.set([&attributes].into_iter(), self.reading, &self.precision);
            let mut taps = Taps::default();
            let mut maps = MapReads::new(&attributes, (&footprints, 0), &mut taps, &self.precision);
            let input = self.ports(prepared, &attributes, &mut maps);
            Some((quantised(&input, &self.precision), plan))
        });
        Ok(chosen.collect())
    }
}

/// Colour of a fragment without its reflection and its lights.
fn surface(object: &PreparedObject, reads: &mut MapReads<'_>) -> Colour {
    match &object.colour_map {
        None => object.colour,
        Some(map) => {
            let sample = map.sample(reads);
            core::array::from_fn(|i| multiply(sample[i], object.colour[i]))
        }
    }
}

/// The plan of a batch: without the blocks that every fragment of it feeds with zeros, which change no bit.
fn plan_of_batch(plan: &ReflectionPlan, inputs: &[ReflectionInput<i32>]) -> ReflectionPlan {
    let is_zero = |word: Fx<i32, OFFSET>| word.raw() == 0;
    let is_smooth = inputs.iter().all(|input| input.roughness.into_iter().all(is_zero));
    let is_flat = inputs.iter().all(|input| input.dnormal.iter().flat_map(|dn| dn.mantissa).all(|m| m.raw() == 0));
    ReflectionPlan {
        roughness: if is_smooth { RoughnessKind::None } else { plan.roughness },
        curvature: plan.curvature && !is_flat,
        ..*plan
    }
}

/// The fragment with every port rounded to what the profile keeps.
fn quantised(input: &ReflectionIn, p: &Precision) -> ReflectionIn {
    let vector = |v: BlockVector| {
        let mantissa = DVec3::from_array(v.mantissa.map(|m| f64::from(m.to_bits())));
        let rounded = block_vector(mantissa, p);
        // The integers of the mantissa are 2^30 times its value.
        BlockVector {
            exponent: if rounded == BlockVector::default() { 0 } else { rounded.exponent + v.exponent - 30 },
            ..rounded
        }
    };
    let number = |x: I4F28| I4F28::from_bits(Fx::<i32, 28>::from_raw(x.to_bits()).keep(p.offset_bits()).raw());
    ReflectionIn {
        normal: vector(input.normal),
        view: vector(input.view),
        tangents: input.tangents.map(vector),
        offset: input.offset.map(number),
        roughness: input.roughness.map(number),
        dview: input.dview.map(vector),
        dnormal: input.dnormal.map(vector),
        edge_texels: input.edge_texels,
    }
}

/// Product of two colours with 24 fraction bits, rounded to nearest.
fn multiply(a: i32, b: i32) -> i32 {
    ((i64::from(a) * i64::from(b) + (1 << 23)) >> 24) as i32
}
