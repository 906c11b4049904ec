//! Fragments that wait, and what they go through together: footprints, fetches, surfaces, lights; the reflection datapath.

use roughxel_core::datapath::Surface;
use roughxel_core::datapath::pixel::{self, PixelSum};
use roughxel_core::datapath::texel::Bump;
use roughxel_core::fx::{Control, Fx};
use roughxel_core::plan::{FootprintKind, FrameSystem, ReflectionPlan};
use roughxel_core::ports::{BlockVector, Port, PortBlock, REFLECTANCE, ReflectionInput, SurfaceInput};
use roughxel_core::precision::RoughnessKind;
use roughxel_core::signals::{SphereProbe, Sweep};
use roughxel_lanes::{Footprint, Reflecting};

use super::colour::Channel;
use super::environment::Look;
use super::lighting::PeaksRead;
use super::phases::{Phase, PhaseClock};
use super::prepare::{Prepared, PreparedObject};
use super::texture::{Footprints, MapReads, Taps};
use crate::plan::Mode;
use crate::raster::FragmentAttributes;

/// Fragments that wait to be shaded, at most: their attributes stay in a first-level cache.
pub(super) const SHADED: usize = 64;

/// Where a colour counts.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// The pixel in its tile.
    pub(super) pixel: usize,
    /// How many of its samples it stands for.
    pub(super) times: u32,
}

/// Fragments of one object that wait to be shaded.
pub(super) struct Fragments {
    pub(super) attributes: Vec<FragmentAttributes>,
    /// Where each counts.
    pub(super) places: Vec<Place>,
    /// From each to every light.
    pub(super) directions: Vec<BlockVector>,
    pub(super) footprints: Footprints,
}

impl Fragments {
    /// None of an object.
    pub(super) fn of(object: &PreparedObject) -> Self {
        let footprints = Footprints::new(object.maps().filter(|_| object.plan.texture_footprint));
        Self { attributes: Vec::new(), places: Vec::new(), directions: Vec::new(), footprints }
    }
}

/// What shading a batch reads; its memory is kept for the next one.
#[derive(Default)]
pub(super) struct Reads {
    /// Of each fragment whose lights read again what its colour has read; else of the one that reads.
    taps: Vec<Taps>,
    peaks: PeaksRead,
    colours: Vec<[Channel; 3]>,
    surfaces: Vec<SurfaceInput<i32>>,
}

impl Reads {
    /// Nothing read, with so many taps.
    fn begin(&mut self, taps: usize) {
        self.taps.resize_with(taps.max(self.taps.len()), Taps::default);
        self.colours.clear();
        self.surfaces.clear();
    }
}

/// Fragments that wait for the reflection datapath, at most: their inputs stay in a second-level cache.
const REFLECTED: usize = 256;

/// Fragments of one plan that wait for the reflection datapath.
pub(super) struct Waiting {
    plan: ReflectionPlan,
    reflectance: [Control<i32, REFLECTANCE>; 3],
    inputs: Inputs,
    /// Where each counts, and its colour without the reflection.
    places: Vec<(Place, [Channel; 3])>,
    /// Probes on the sphere of one batch; the memory is kept for the next one.
    probes: Vec<SphereProbe<i32>>,
}

/// What a reflection is made of.
enum Inputs {
    /// The ports of each fragment.
    Ports(Vec<ReflectionInput<i32>>),
    /// The surface of each, which its lights have seen.
    Surfaces(Vec<Reflecting<i32>>),
}

impl Waiting {
    /// None of an object; without a reflection none will come.
    pub(super) fn of(object: &PreparedObject) -> Self {
        let plan = object.plan.reflection.unwrap_or(ReflectionPlan::FULL);
        let inputs = if object.lighting.is_some() { Inputs::Surfaces(Vec::new()) } else { Inputs::Ports(Vec::new()) };
        Self { plan, reflectance: object.reflectance, inputs, places: Vec::new(), probes: Vec::new() }
    }

    /// None of the rays that hit nothing: mirrors without bumps.
    pub(super) fn rays(mode: Mode) -> Self {
        let plan = ReflectionPlan {
            bump: false,
            frame: FrameSystem::MainDirection,
            roughness: RoughnessKind::None,
            curvature: false,
            footprint: if mode.filters() { FootprintKind::Face } else { FootprintKind::None },
        };
        Self {
            plan,
            reflectance: [Fx::int(1); 3],
            inputs: Inputs::Ports(Vec::new()),
            places: Vec::new(),
            probes: Vec::new(),
        }
    }
}

/// The light of a tile's pixels, summed over objects, lights and samples, and what was read for it.
pub(super) struct Sums {
    pub(super) pixels: Vec<[PixelSum<i32>; 3]>,
    /// Taps, of four texels each.
    pub(super) taps: u64,
    pub(super) clock: PhaseClock,
}

impl Sums {
    /// No light in so many pixels.
    pub(super) fn new(pixels: usize) -> Self {
        Self { pixels: vec![[PixelSum { sum: Fx::zero() }; 3]; pixels], taps: 0, clock: PhaseClock::start() }
    }

    /// Adds a colour to a pixel, as often as it counts there.
    pub(super) fn add(&mut self, place: Place, colour: [Channel; 3]) {
        for _ in 0..place.times {
            for (sum, channel) in self.pixels[place.pixel].iter_mut().zip(colour) {
                *sum = pixel::sum(sum, channel);
            }
        }
    }
}

impl Prepared<'_> {
    /// The waiting fragments of an object: footprints, fetches, surfaces, lights; what reflects waits again.
    pub(super) fn shade(
        &self,
        object: &PreparedObject,
        fragments: &mut Fragments,
        waiting: &mut Waiting,
        reads: &mut Reads,
        sums: &mut Sums,
    ) {
        let Fragments { attributes, places, directions, footprints } = fragments;
        let caller = sums.clock.enter(Phase::Footprints);
        footprints.set(attributes.iter(), self.reading, &self.precision);
        sums.clock.enter(Phase::Maps);
        // The taps of a whole batch push its attributes out of the first-level cache.
        let last_taps = if object.lighting.is_some() { attributes.len().saturating_sub(1) } else { 0 };
        reads.begin(last_taps + 1);
        let Reads { taps, peaks, colours, surfaces } = reads;
        let has_surface = object.plan.reflection.is_some() || object.lighting.is_some();
        for (index, attributes) in attributes.iter().enumerate() {
            let taps = &mut taps[index.min(last_taps)];
            let mut maps = MapReads::new(attributes, (footprints, index), taps, &self.precision);
            colours.push(object.colour(&mut maps));
            if has_surface {
                surfaces.push(self.surface_input(object, attributes, &mut maps));
            }
        }
        let coloured = places.iter().copied().zip(colours.iter().copied());
        match &object.lighting {
            None if object.plan.reflection.is_none() => coloured.for_each(|(place, colour)| sums.add(place, colour)),
            None => {
                for ((attributes, place), &surface) in attributes.iter().zip(coloured).zip(&*surfaces) {
                    let FragmentAttributes { dview, dnormal, .. } = attributes;
                    let edge_texels = Fx::int(1);
                    let input =
                        ReflectionInput { surface, dview: dview.wires(), dnormal: dnormal.wires(), edge_texels };
                    self.reflect(waiting, place, &input, sums);
                }
            }
            Some(lighting) => {
                sums.clock.enter(Phase::Footprints);
                let made = self.reading.surfaces(surfaces, &object.plan.surface(), &self.precision);
                sums.clock.enter(Phase::Lights);
                for (index, (surface, place)) in made.iter().zip(coloured).enumerate() {
                    let (own, colour) = place;
                    let mut maps =
                        MapReads::again(&attributes[index], (footprints, index), &mut taps[index], &self.precision);
                    let directions = &directions[index * lighting.lights()..][..lighting.lights()];
                    let lit = (&surfaces[index], surface);
                    lighting.shine(lit, directions, &mut maps, peaks, (self.reading, &self.precision), |light| {
                        sums.add(own, light);
                    });
                    match object.plan.reflection {
                        None => sums.add(own, colour),
                        Some(_) => self.reflect_surface(waiting, place, surface, &attributes[index], sums),
                    }
                }
            }
        }
        sums.taps += taps.iter_mut().map(Taps::fetched).sum::<u64>();
        attributes.clear();
        places.clear();
        directions.clear();
        sums.clock.enter(caller);
    }

    /// Lets a fragment wait; with [`REFLECTED`] of them, all are reflected.
    pub(super) fn reflect(
        &self,
        waiting: &mut Waiting,
        place: (Place, [Channel; 3]),
        input: &ReflectionInput<i32>,
        sums: &mut Sums,
    ) {
        let Inputs::Ports(inputs) = &mut waiting.inputs else {
            unreachable!("surfaces of an object without lights are made with the reflection")
        };
        inputs.push(*input);
        self.wait(waiting, place, sums);
    }

    /// The same with a surface that is made.
    fn reflect_surface(
        &self,
        waiting: &mut Waiting,
        place: (Place, [Channel; 3]),
        surface: &Surface<i32>,
        attributes: &FragmentAttributes,
        sums: &mut Sums,
    ) {
        let Inputs::Surfaces(inputs) = &mut waiting.inputs else {
            unreachable!("surfaces of an object with lights are made before the reflection")
        };
        let FragmentAttributes { dview, dnormal, .. } = attributes;
        inputs.push(Reflecting { surface: *surface, dview: dview.wires(), dnormal: dnormal.wires() });
        self.wait(waiting, place, sums);
    }

    fn wait(&self, waiting: &mut Waiting, place: (Place, [Channel; 3]), sums: &mut Sums) {
        waiting.places.push(place);
        if waiting.places.len() == REFLECTED {
            self.fetch(waiting, sums);
        }
    }

    /// The waiting fragments through the reflection datapath, the environment and the blend.
    pub(super) fn fetch(&self, waiting: &mut Waiting, sums: &mut Sums) {
        let Waiting { plan, reflectance, inputs, places, probes } = waiting;
        // The bias of rough reflections is the object's, whatever a batch leaves out.
        let is_rough = plan.roughness != RoughnessKind::None;
        let caller = sums.clock.enter(Phase::Footprints);
        let seen = self.seen(plan, inputs);
        match plan.footprint {
            FootprintKind::None | FootprintKind::Face => {
                let footprints = self.footprints(&seen, inputs);
                sums.clock.enter(Phase::Environment);
                for (Footprint { point, probes }, place) in footprints.iter().zip(places.drain(..)) {
                    self.read(Look::Face(point, probes), is_rough, reflectance, place, sums);
                }
            }
            FootprintKind::Sphere => {
                let last_level = self.environment_scale.last_level;
                let sweeps = self.sweeps(&seen, inputs);
                probes.clear();
                self.reading.sphere_probes(&sweeps, last_level, &self.precision, probes);
                sums.clock.enter(Phase::Environment);
                let mut rest = probes.as_slice();
                for (sweep, place) in sweeps.iter().zip(places.drain(..)) {
                    let (own, others) = rest.split_at(sweep.count.raw() as usize);
                    self.read(Look::Sphere(own), is_rough, reflectance, place, sums);
                    rest = others;
                }
            }
        }
        match inputs {
            Inputs::Ports(inputs) => inputs.clear(),
            Inputs::Surfaces(inputs) => inputs.clear(),
        }
        sums.clock.enter(caller);
    }

    /// What a fragment sees of the environment, blended with its own colour.
    fn read(
        &self,
        look: Look<'_>,
        is_rough: bool,
        reflectance: &[Control<i32, REFLECTANCE>; 3],
        (place, surface): (Place, [Channel; 3]),
        sums: &mut Sums,
    ) {
        let colour = match &self.environment {
            Some(map) => {
                sums.taps += map.taps(look, is_rough, &self.precision);
                map.blended(&surface, (look, is_rough), reflectance, &self.precision)
            }
            None => core::array::from_fn(|i| pixel::blend::<i32>(surface[i], Fx::zero(), reflectance[i])),
        };
        sums.add(place, colour);
    }

    /// The plan of the waiting fragments without stages that every one of them would feed with zeros, which changes no bit.
    fn seen(&self, plan: &ReflectionPlan, inputs: &Inputs) -> ReflectionPlan {
        let is_flat = |dnormal: &[PortBlock<i32, 3>; 2]| dnormal.iter().flat_map(|dn| dn.mantissa).all(is_zero);
        let (is_smooth, is_flat) = match inputs {
            Inputs::Ports(inputs) => (
                inputs.iter().all(|input| input.surface.roughness.into_iter().all(is_zero)),
                inputs.iter().all(|input| is_flat(&input.dnormal)),
            ),
            Inputs::Surfaces(inputs) => (
                inputs.iter().all(|input| input.surface.rough.iter().flat_map(|d| d.m).all(is_zero)),
                inputs.iter().all(|input| is_flat(&input.dnormal)),
            ),
        };
        ReflectionPlan {
            roughness: if is_smooth { RoughnessKind::None } else { plan.roughness },
            curvature: plan.curvature && !is_flat,
            ..*plan
        }
    }

    /// Where the waiting fragments look.
    fn footprints(&self, plan: &ReflectionPlan, inputs: &Inputs) -> Vec<Footprint<i32>> {
        let (scale, p) = (&self.environment_scale, &self.precision);
        match inputs {
            Inputs::Ports(inputs) => self.reading.footprints(inputs, scale, plan, p),
            Inputs::Surfaces(inputs) => self.reading.footprints_of(inputs, scale, plan, p),
        }
    }

    /// The same of footprints on the sphere.
    fn sweeps(&self, plan: &ReflectionPlan, inputs: &Inputs) -> Vec<Sweep<i32>> {
        let (scale, p) = (&self.environment_scale, &self.precision);
        match inputs {
            Inputs::Ports(inputs) => {
                let ports: Vec<SurfaceInput<i32>> = inputs.iter().map(|input| input.surface).collect();
                let surfaces = self.reading.surfaces(&ports, &plan.surface(), p);
                let reflecting = surfaces.into_iter().zip(inputs).map(|(surface, input)| {
                    let ReflectionInput { dview, dnormal, .. } = *input;
                    Reflecting { surface, dview, dnormal }
                });
                self.reading.sweeps(&reflecting.collect::<Vec<_>>(), scale, plan, p)
            }
            Inputs::Surfaces(inputs) => self.reading.sweeps(inputs, scale, plan, p),
        }
    }

    /// What the surface of a fragment is made of, bump map sampled.
    pub(super) fn surface_input(
        &self,
        object: &PreparedObject,
        attributes: &FragmentAttributes,
        reads: &mut MapReads<'_>,
    ) -> SurfaceInput<i32> {
        let plan = &object.plan;
        let none = || Bump { offset: [Fx::zero(); 2], roughness: [Fx::zero(); 3] };
        let bump =
            object.bump_map.as_ref().map_or_else(none, |map| map.sample(reads, plan.roughness(), &self.precision));
        let vectors = if plan.needs_tangents() {
            attributes.frame_vectors
        } else {
            [object.main_direction, BlockVector::default()]
        };
        SurfaceInput {
            normal: attributes.normal.wires(),
            view: attributes.view.wires(),
            frame_vectors: vectors.wires(),
            offset: bump.offset,
            roughness: bump.roughness,
        }
    }
}

fn is_zero<const INT: u32>(word: Fx<i32, INT>) -> bool {
    word.raw() == 0
}

impl PreparedObject {
    /// Colour of a fragment without its reflection and its lights.
    fn colour(&self, reads: &mut MapReads<'_>) -> [Channel; 3] {
        match &self.colour_map {
            None => self.colour,
            Some(map) => {
                let sample = map.sample(reads);
                core::array::from_fn(|i| pixel::modulated::<i32>(sample[i], self.colour[i]))
            }
        }
    }
}
