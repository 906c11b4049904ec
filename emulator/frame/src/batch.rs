//! Fragments that wait, and what they go through together: footprints, maps, surfaces, lights, the environment.

use roughxel_core::datapath::Surface;
use roughxel_core::datapath::pixel::{self, PixelSum};
use roughxel_core::datapath::texel::Bump;
use roughxel_core::fx::{Control, Fx};
use roughxel_core::plan::{FootprintKind, FrameSystem, ReflectionPlan};
use roughxel_core::ports::{BlockVector, Port, REFLECTANCE, SurfaceInput};
use roughxel_core::precision::RoughnessKind;
use roughxel_core::signals::{CubePoint, Sweep, TexturePosition};
use roughxel_lanes::{Bare, Bumped, ByCount, Columns, Derivatives, Footprint, Look, RepeatedMap, Shown};

use super::colour::Channel;
use super::lighting::{Directions, Lit};
use super::phases::{Phase, PhaseClock};
use super::prepare::{Prepared, PreparedObject};
use super::texture::{Footprints, TextureDerivatives};
use crate::plan::Mode;
use crate::raster::{AttributeRows, FragmentAttributes, same_rows};

/// Fragments that wait to be shaded, at most: their columns stay in a second-level cache.
pub(super) const SHADED: usize = 128;

/// Where a colour counts.
#[derive(Clone, Copy, Default)]
pub(super) struct Place {
    /// The pixel in its tile.
    pub(super) pixel: u32,
    /// How many of its samples it stands for.
    pub(super) times: u32,
}

/// What the fragments of an object have beside their places: columns that its plan does not read stay empty.
#[derive(Clone, Copy, Debug)]
struct Parts {
    /// They have a surface, which reflects or shines.
    surface: bool,
    /// They reflect, over footprints.
    derivatives: bool,
    /// They read maps.
    uv: bool,
    /// With footprints.
    duv: bool,
    /// In place of p_u and p_v.
    main_direction: Option<BlockVector>,
}

/// Fragments of one object that wait to be shaded.
pub(super) struct Fragments {
    parts: Parts,
    bare: Columns<Bare<i32>>,
    derivatives: Columns<Derivatives<i32>>,
    centres: Columns<TexturePosition<i32>>,
    duv: Columns<TextureDerivatives>,
    /// Where each counts.
    places: Vec<Place>,
    /// From each to the lights that stand in the scene.
    pub(super) directions: Directions,
    footprints: Footprints,
}

impl Fragments {
    /// None of an object.
    pub(super) fn of(object: &PreparedObject) -> Self {
        let needs = object.needs();
        let parts = Parts {
            surface: object.plan.reflection.is_some() || object.lighting.is_some(),
            derivatives: object.plan.reflection.is_some_and(|plan| plan.footprint.is_some()),
            uv: needs.uv,
            duv: needs.duv,
            main_direction: (!needs.tangents).then_some(object.main_direction),
        };
        let maps = object.maps().filter(|_| object.plan.texture_footprint);
        Self::with(parts, Footprints::new(maps, object.rough_map()))
    }

    /// None of the rays that hit nothing.
    pub(super) fn rays(mode: Mode) -> Self {
        let none = Some(BlockVector::default());
        let parts = Parts { surface: true, derivatives: mode.filters(), uv: false, duv: false, main_direction: none };
        Self::with(parts, Footprints::default())
    }

    fn with(parts: Parts, footprints: Footprints) -> Self {
        Self {
            parts,
            bare: Columns::default(),
            derivatives: Columns::default(),
            centres: Columns::default(),
            duv: Columns::default(),
            places: Vec::new(),
            directions: Directions::new(),
            footprints,
        }
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.places.len()
    }

    /// Lets a fragment wait.
    pub(super) fn push(&mut self, place: Place, attributes: &FragmentAttributes) {
        let FragmentAttributes { normal, view, frame_vectors, dview, dnormal, uv, duv } = attributes;
        let Parts { surface, derivatives, uv: has_uv, duv: has_duv, main_direction } = self.parts;
        if surface {
            let frame_vectors = main_direction.map_or(*frame_vectors, |main| [main, BlockVector::default()]);
            let frame_vectors = frame_vectors.wires();
            self.bare.push(&Bare { normal: normal.wires(), view: view.wires(), frame_vectors });
        }
        if derivatives {
            self.derivatives.push(&Derivatives { dview: dview.wires(), dnormal: dnormal.wires() });
        }
        if has_uv {
            self.centres.push(&TexturePosition { uv: uv.wires() });
        }
        if has_duv {
            self.duv.push(&duv.wires());
        }
        self.places.push(place);
    }

    /// Rows for [`Self::append`]: what no triangle has of its own is in them.
    pub(super) fn rows(&self) -> AttributeRows {
        let mut rows = AttributeRows::default();
        if let Some(main) = self.parts.main_direction {
            rows.frame_vectors[0] = same_rows(&main);
        }
        rows
    }

    /// Lets fragments wait that stand side by side and have their derivatives in common.
    pub(super) fn append(&mut self, places: &[Place], rows: &AttributeRows, derivatives: &Derivatives<i32>) {
        let Parts { surface, derivatives: has_derivatives, uv, duv, main_direction: _ } = self.parts;
        let count = places.len();
        if surface {
            self.bare.append(count, |to| {
                to.block(|bare| bare.normal, &rows.normal);
                to.block(|bare| bare.view, &rows.view);
                to.block(|bare| bare.frame_vectors[0], &rows.frame_vectors[0]);
                to.block(|bare| bare.frame_vectors[1], &rows.frame_vectors[1]);
            });
        }
        if has_derivatives {
            self.derivatives.append_same(count, derivatives);
        }
        if uv {
            self.centres.append(count, |to| {
                to.low(|centre| centre.uv[0], &rows.uv[0]);
                to.low(|centre| centre.uv[1], &rows.uv[1]);
            });
        }
        if duv {
            self.duv.append(count, |to| {
                to.block(|duv| duv[0], &rows.duv[0]);
                to.block(|duv| duv[1], &rows.duv[1]);
            });
        }
        self.places.extend_from_slice(places);
    }

    fn clear(&mut self) {
        let Self { parts: _, bare, derivatives, centres, duv, places, directions, footprints: _ } = self;
        bare.clear();
        derivatives.clear();
        centres.clear();
        duv.clear();
        places.clear();
        directions.iter_mut().for_each(Columns::clear);
    }
}

/// What a batch of fragments becomes on its way; its memory is kept for the next one.
#[derive(Default)]
pub(super) struct Batch {
    colours: Columns<Shown<i32>>,
    bumps: Columns<Bumped<i32>>,
    surfaces: Columns<Surface<i32>>,
    points: Columns<CubePoint<i32>>,
    footprints: Columns<Footprint<i32>>,
    sweeps: Columns<Sweep<i32>>,
    shown: Columns<Shown<i32>>,
    cores: Columns<Surface<i32>>,
    core_shown: Columns<Shown<i32>>,
    both_shown: Columns<Shown<i32>>,
    by_count: ByCount,
    lit: Lit,
}

/// The plan of rays that hit nothing: mirrors without bumps.
fn ray_plan(mode: Mode) -> ReflectionPlan {
    ReflectionPlan {
        bump: false,
        frame: FrameSystem::MainDirection,
        roughness: RoughnessKind::None,
        curvature: false,
        footprint: if mode.filters() { FootprintKind::Face } else { FootprintKind::None },
    }
}

/// The light of a tile's pixels, summed over objects, lights and samples, and what was read for it.
pub(super) struct Sums {
    pub(super) pixels: Vec<[PixelSum<i32>; 3]>,
    /// How many samples each pixel has.
    pub(super) counts: Vec<u32>,
    /// Taps, of four texels each.
    pub(super) taps: u64,
    pub(super) clock: PhaseClock,
}

impl Sums {
    /// No light in so many pixels.
    pub(super) fn new(pixels: usize) -> Self {
        Self {
            pixels: vec![[PixelSum { sum: Fx::zero() }; 3]; pixels],
            counts: vec![0; pixels],
            taps: 0,
            clock: PhaseClock::start(),
        }
    }

    /// So many more samples of each pixel.
    pub(super) fn count(&mut self, counts: &[u32]) {
        self.counts.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
    }

    /// Adds a colour to a pixel, as often as it counts there.
    pub(super) fn add(&mut self, place: Place, colour: [Channel; 3]) {
        let sums = &mut self.pixels[place.pixel as usize];
        *sums = with_colour(*sums, place.times, colour);
    }

    /// Adds the colours of a batch. Samples of a pixel mostly follow each other: their sum does not go through memory.
    fn add_all(&mut self, places: &[Place], colours: &Columns<Shown<i32>>) {
        let mut colours = colours.colours();
        for of_pixel in places.chunk_by(|a, b| a.pixel == b.pixel) {
            let sums = &mut self.pixels[of_pixel[0].pixel as usize];
            *sums = of_pixel
                .iter()
                .zip(&mut colours)
                .fold(*sums, |sums, (place, colour)| with_colour(sums, place.times, colour));
        }
    }
}

/// Sums with a colour that counts so often.
#[inline(always)]
fn with_colour(mut sums: [PixelSum<i32>; 3], times: u32, colour: [Channel; 3]) -> [PixelSum<i32>; 3] {
    for _ in 0..times {
        for (sum, channel) in sums.iter_mut().zip(colour) {
            *sum = pixel::sum(sum, channel);
        }
    }
    sums
}

impl Prepared<'_> {
    /// The waiting fragments of an object: footprints, maps, surfaces, lights, the environment.
    pub(super) fn shade(&self, object: &PreparedObject, fragments: &mut Fragments, batch: &mut Batch, sums: &mut Sums) {
        if fragments.len() == 0 {
            return;
        }
        let (reading, p) = (self.reading, &self.precision);
        let caller = sums.clock.enter(Phase::Footprints);
        fragments.footprints.set(&fragments.duv, reading, p);
        sums.clock.enter(Phase::Maps);
        let spots = (&fragments.centres, &fragments.footprints);
        match &object.colour_map {
            None => batch.colours.fill(fragments.len(), &Shown { channels: object.colour, taps: Fx::zero() }),
            Some(map) => map.sample(spots, &object.colour, (reading, p), &mut batch.colours),
        }
        sums.taps += batch.colours.taps();
        if fragments.parts.surface {
            self.bumps(object, fragments, &mut batch.bumps);
            sums.taps += batch.bumps.taps();
            sums.clock.enter(Phase::Footprints);
            let seen = object.plan.reflection.map(|plan| seen(&plan, fragments, &batch.bumps));
            let plan = match (&object.lighting, &seen) {
                (None, Some(seen)) => seen.surface(),
                _ => object.plan.surface(),
            };
            reading.surfaces(&fragments.bare, &batch.bumps, &plan, p, &mut batch.surfaces);
            if object.lighting.is_some() {
                sums.clock.enter(Phase::Lights);
                self.light(object, fragments, batch, sums);
            }
            if let (Some(plan), Some(seen)) = (&object.plan.reflection, &seen) {
                // The bias of rough reflections is the object's, whatever a batch leaves out.
                let is_rough = plan.roughness != RoughnessKind::None;
                // A smooth batch shows the same by both.
                let two_lobes = object.plan.two_lobes && seen.roughness != RoughnessKind::None;
                self.reflect((seen, is_rough, two_lobes), &object.reflectance, fragments, batch, sums);
            }
        }
        if object.plan.reflection.is_none() {
            sums.add_all(&fragments.places, &batch.colours);
        }
        fragments.clear();
        sums.clock.enter(caller);
    }

    /// The waiting rays that hit nothing and see the environment.
    pub(super) fn shade_rays(&self, rays: &mut Fragments, batch: &mut Batch, sums: &mut Sums) {
        if rays.len() == 0 {
            return;
        }
        let caller = sums.clock.enter(Phase::Footprints);
        let plan = seen(&ray_plan(self.mode), rays, &batch.bumps);
        batch.colours.fill(rays.len(), &Shown { channels: [Fx::zero(); 3], taps: Fx::zero() });
        batch.bumps.fill(rays.len(), &flat());
        self.reading.surfaces(&rays.bare, &batch.bumps, &plan.surface(), &self.precision, &mut batch.surfaces);
        self.reflect((&plan, false, false), &[Fx::int(1); 3], rays, batch, sums);
        rays.clear();
        sums.clock.enter(caller);
    }

    /// What each light makes of surfaces that are made.
    fn light(&self, object: &PreparedObject, fragments: &Fragments, batch: &mut Batch, sums: &mut Sums) {
        let Some(lighting) = &object.lighting else { return };
        let Fragments { bare, centres, footprints, places, directions, .. } = fragments;
        let Batch { bumps, surfaces, lit, .. } = batch;
        let taps = lighting.shine(
            surfaces,
            |fragment| ports(&bare.get(fragment), &bumps.get(fragment)),
            (directions, |map: &RepeatedMap| footprints.places(centres, map)),
            lit,
            (self.reading, &self.precision),
            |shown| sums.add_all(places, shown),
        );
        sums.taps += taps;
    }

    /// What the environment makes of surfaces that are made, with the colours of a batch; `seen` is the plan, whether its object is rough, and
    /// whether it has two lobes.
    fn reflect(
        &self,
        (seen, is_rough, two_lobes): (&ReflectionPlan, bool, bool),
        reflectance: &[Control<i32, REFLECTANCE>; 3],
        fragments: &Fragments,
        batch: &mut Batch,
        sums: &mut Sums,
    ) {
        let Batch {
            colours, surfaces, points, footprints, sweeps, shown, by_count, cores, core_shown, both_shown, ..
        } = batch;
        let (p, places) = (&self.precision, &fragments.places);
        let Some(map) = &self.environment else {
            for (&place, own) in places.iter().zip(colours.colours()) {
                let channel = |i: usize| pixel::blend::<i32>(own[i], Fx::zero(), reflectance[i]);
                sums.add(place, core::array::from_fn(channel));
            }
            return;
        };
        let mut look = |surfaces: &Columns<Surface<i32>>, shown: &mut Columns<Shown<i32>>, sums: &mut Sums| {
            let (scale, derivatives) = (&self.environment_scale, &fragments.derivatives);
            sums.clock.enter(Phase::Footprints);
            let look = match seen.footprint {
                FootprintKind::None => {
                    self.reading.points(surfaces, p, points);
                    Look::Point(points)
                }
                FootprintKind::Face => {
                    self.reading.footprints(surfaces, derivatives, (scale, seen), p, footprints);
                    Look::Face(footprints)
                }
                FootprintKind::Sphere => {
                    self.reading.sweeps(surfaces, derivatives, (scale, seen), p, sweeps);
                    Look::Sphere(sweeps)
                }
            };
            sums.clock.enter(Phase::Environment);
            self.reading.environment(look, colours, (map.texels(), is_rough, reflectance), p, (by_count, shown));
            sums.taps += shown.taps();
        };
        look(surfaces, shown, sums);
        if !two_lobes {
            return sums.add_all(places, shown);
        }
        self.reading.cores(surfaces, p, cores);
        look(cores, core_shown, sums);
        self.reading.lobes([shown, core_shown], p, both_shown);
        sums.add_all(places, both_shown);
    }

    /// Bumps and roughness of the waiting fragments of an object.
    fn bumps(&self, object: &PreparedObject, fragments: &Fragments, bumps: &mut Columns<Bumped<i32>>) {
        match &object.bump_map {
            None => bumps.fill(fragments.len(), &flat()),
            Some(map) => {
                let spots = (&fragments.centres, &fragments.footprints);
                map.sample(spots, object.plan.roughness(), (self.reading, &self.precision), bumps);
            }
        }
    }

    /// What the surface of a fragment is made of, bump map sampled.
    pub(super) fn surface_input(
        &self,
        object: &PreparedObject,
        place: Place,
        attributes: &FragmentAttributes,
    ) -> SurfaceInput<i32> {
        let (mut fragments, mut bumps) = (Fragments::of(object), Columns::default());
        fragments.push(place, attributes);
        fragments.footprints.set(&fragments.duv, self.reading, &self.precision);
        self.bumps(object, &fragments, &mut bumps);
        ports(&fragments.bare.get(0), &bumps.get(0))
    }
}

/// No bump, no roughness.
fn flat() -> Bumped<i32> {
    Bumped { bump: Bump { offset: [Fx::zero(); 2], roughness: [Fx::zero(); 3] }, taps: Fx::zero() }
}

fn ports(bare: &Bare<i32>, bumped: &Bumped<i32>) -> SurfaceInput<i32> {
    let (Bare { normal, view, frame_vectors }, Bump { offset, roughness }) = (*bare, bumped.bump);
    SurfaceInput { normal, view, frame_vectors, offset, roughness }
}

/// The plan of the waiting fragments without stages that every one of them would feed with zeros, which changes no bit.
fn seen(plan: &ReflectionPlan, fragments: &Fragments, bumps: &Columns<Bumped<i32>>) -> ReflectionPlan {
    let is_smooth = plan.roughness == RoughnessKind::None || bumps.is_smooth();
    ReflectionPlan {
        roughness: if is_smooth { RoughnessKind::None } else { plan.roughness },
        curvature: plan.curvature && !fragments.derivatives.is_flat(),
        ..*plan
    }
}
