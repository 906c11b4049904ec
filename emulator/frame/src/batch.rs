//! Fragments that wait, and what they go through together: footprints, fetches, lights; the reflection datapath.

use fixed::types::I4F28;
use roughxel_core::datapath::ReflectionInput;
use roughxel_core::fx::Fx;
use roughxel_core::plan::{FrameSystem, ReflectionPlan};
use roughxel_core::ports::{BlockVector, ReflectionIn};
use roughxel_core::precision::RoughnessKind;
use roughxel_core::signals::OFFSET;
use roughxel_core::stage::blend::{REFLECTANCE, blend};

use super::lighting::PeaksRead;
use super::prepare::{Prepared, PreparedObject};
use super::texture::{Footprints, MapReads, Taps};
use super::{Colour, multiply};
use crate::plan::Mode;
use crate::raster::FragmentAttributes;

/// Fragments that wait to be shaded, at most: their attributes stay in a first-level cache.
pub(super) const SHADED: usize = 64;

/// Fragments of one object that wait to be shaded.
pub(super) struct Fragments {
    pub(super) attributes: Vec<FragmentAttributes>,
    /// The pixel of each in its tile.
    pub(super) pixels: Vec<usize>,
    /// From each to every light.
    pub(super) directions: Vec<BlockVector>,
    pub(super) footprints: Footprints,
}

impl Fragments {
    /// None of an object.
    pub(super) fn of(object: &PreparedObject) -> Self {
        let footprints = Footprints::new(object.maps().filter(|_| object.plan.texture_footprint));
        Self { attributes: Vec::new(), pixels: Vec::new(), directions: Vec::new(), footprints }
    }
}

/// What shading a fragment reads; its memory is kept for the next one.
#[derive(Default)]
pub(super) struct Reads {
    taps: Taps,
    peaks: PeaksRead,
}

/// Fragments that wait for the reflection datapath, at most: their inputs stay in a second-level cache.
const REFLECTED: usize = 256;

/// Fragments of one plan that wait for the reflection datapath.
pub(super) struct Waiting {
    plan: ReflectionPlan,
    reflectance: [Fx<i32, 16>; 3],
    inputs: Vec<ReflectionInput<i32>>,
    /// The pixel of each in its tile, and its colour without the reflection.
    pixels: Vec<(usize, Colour)>,
}

impl Waiting {
    /// None of an object; without a reflection none will come.
    pub(super) fn of(object: &PreparedObject) -> Self {
        let plan = object.plan.reflection.unwrap_or(ReflectionPlan::FULL);
        Self { plan, reflectance: object.reflectance, inputs: Vec::new(), pixels: Vec::new() }
    }

    /// None of the rays that hit nothing: mirrors without bumps.
    pub(super) fn rays(mode: Mode) -> Self {
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

/// The colours of a tile's pixels, summed over their samples.
pub(super) struct Sums(pub(super) Vec<[i64; 3]>);

impl Sums {
    pub(super) fn add(&mut self, pixel: usize, colour: [i64; 3]) {
        for (sum, channel) in self.0[pixel].iter_mut().zip(colour) {
            *sum += channel;
        }
    }
}

impl Prepared<'_> {
    /// The waiting fragments of an object: footprints, fetches, lights; what reflects waits again.
    pub(super) fn shade(
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
    pub(super) fn reflect(
        &self,
        waiting: &mut Waiting,
        (pixel, surface): (usize, Colour),
        input: &ReflectionIn,
        sums: &mut Sums,
    ) {
        waiting.inputs.push(input.wires(self.environment_scale));
        waiting.pixels.push((pixel, surface));
        if waiting.inputs.len() == REFLECTED {
            self.fetch(waiting, sums);
        }
    }

    /// The waiting fragments through the reflection datapath, the environment and the blend.
    pub(super) fn fetch(&self, waiting: &mut Waiting, sums: &mut Sums) {
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
    pub(super) fn ports(
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
