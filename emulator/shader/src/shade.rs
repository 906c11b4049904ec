//! The path of a fragment: every pass by its name, in the order of the block diagram.

use roughxel_core::datapath::texel::Bump;
use roughxel_core::datapath::{LobeLaw, Surface, pixel};
use roughxel_core::fx::Fx;
use roughxel_core::plan::{FootprintKind, ReflectionPlan, SurfacePlan};
use roughxel_core::ports::{BlockVector, Port, PortBlock, SurfaceInput};
use roughxel_core::precision::RoughnessKind;
use roughxel_core::signals::{CubePoint, LocalDirection, Sweep};

use crate::attributes::AttributeRows;
use crate::batch::Batch;
use crate::environment::{EnvironmentColours, Lobes, Ordered, Reflector};
use crate::fragments::{Fragments, Place};
use crate::lights::{GivenPeaks, Halves, Highlights, HorizonSlopes, Lit};
use crate::maps::{Bumps, Colours};
use crate::material::{Channel, Formula, Light, Material, Shine};
use crate::pass::{Environment, Shader};
use crate::peaks_read::{LightOnPeaks, PeaksRead};
use crate::phases::Phase;
use crate::signals::{Derivatives, FaceFootprint, FilteredBump, ShadedColour, Slopes, SurfaceAttributes, ports};
use crate::sums::Sums;
use crate::surface::{Footprints, LobeLaws, LobeSurfaces, Points, Reflected, Surfaces, Sweeps};

/// Batches between the passes; the next fragments reuse their memory.
#[derive(Debug, Default)]
pub struct Work {
    colours: Batch<ShadedColour<i32>>,
    bumps: Batch<FilteredBump<i32>>,
    surfaces: Batch<Surface<i32>>,
    lit: LitWork,
    seen: SeenWork,
}

/// Batches of a light.
#[derive(Debug, Default)]
struct LitWork {
    directions: Batch<PortBlock<i32, 3>>,
    halves: Batch<LocalDirection<i32>>,
    slopes: Batch<Slopes<i32>>,
    peaks: PeaksRead,
    shown: Batch<ShadedColour<i32>>,
}

/// Batches of the reflection.
#[derive(Debug, Default)]
struct SeenWork {
    points: Batch<CubePoint<i32>>,
    footprints: Batch<FaceFootprint<i32>>,
    ordered_footprints: Ordered<FaceFootprint<i32>>,
    sweeps: Batch<Sweep<i32>>,
    ordered_sweeps: Ordered<Sweep<i32>>,
    shown: Batch<ShadedColour<i32>>,
    laws: Batch<LobeLaw<i32>>,
    lobe: Batch<Surface<i32>>,
    of_second: Batch<ShadedColour<i32>>,
    of_both: Batch<ShadedColour<i32>>,
}

/// The plan of a batch. It leaves out stages whose inputs would be zero for every fragment, which changes no bit.
struct BatchPlan {
    surface: SurfacePlan,
    reflection: Option<ReflectionPlan>,
    /// True if the object is rough, even if a batch leaves stages out.
    is_rough: bool,
    /// True for two lobes; each lobe of a smooth batch gives the same colour.
    two_lobes: bool,
}

impl BatchPlan {
    fn new(material: &Material, fragments: &Fragments, bumps: &Batch<FilteredBump<i32>>) -> Self {
        let plan = &material.plan;
        let reflection = plan.reflection.map(|plan| {
            let is_smooth = plan.roughness == RoughnessKind::None || bumps.is_smooth();
            ReflectionPlan {
                roughness: if is_smooth { RoughnessKind::None } else { plan.roughness },
                curvature: plan.curvature && !fragments.derivatives.is_flat(),
                ..plan
            }
        });
        let surface = match (&material.lighting, &reflection) {
            (None, Some(reflection)) => reflection.surface(),
            _ => plan.surface(),
        };
        let is_rough = |plan: ReflectionPlan| plan.roughness != RoughnessKind::None;
        Self {
            surface,
            reflection,
            is_rough: plan.reflection.is_some_and(is_rough),
            two_lobes: plan.two_lobes && reflection.is_some_and(is_rough),
        }
    }
}

impl Shader<'_> {
    /// Shades the waiting fragments of an object and adds their light to their pixels.
    pub fn shade(self, material: &Material, fragments: &mut Fragments, work: &mut Work, sums: &mut Sums) {
        if fragments.is_empty() {
            return;
        }
        let caller = sums.clock.enter(Phase::Footprints);

        // maps: texture, ellipse, axes, probes
        fragments.footprints.make(self, &fragments.duv);
        sums.clock.enter(Phase::Maps);

        // maps: filter, [memory], filter, pixel (colour, modulated)
        self.colours(material, fragments, &mut work.colours);
        sums.samples += work.colours.samples();

        if fragments.has_surface {
            // maps: filter, [memory], moments, filter, pixel (bump)
            self.bumps(material, fragments, &mut work.bumps);
            sums.samples += work.bumps.samples();
            sums.clock.enter(Phase::Footprints);

            // surface: enter, frame, perturb, roughness
            let plan = BatchPlan::new(material, fragments, &work.bumps);
            Surfaces::new(self, &fragments.bare, &work.bumps, &plan.surface).run(self, &mut work.surfaces);

            // lights: half, highlight; or local, horizon, peaks; pixel (modulated), pixel (sum)
            self.light(material, fragments, work, sums);

            // reflection: reflect to probes; seam, [memory], filter, blend; pixel (sum)
            self.reflect(material, &plan, fragments, work, sums);
        }
        if material.plan.reflection.is_none() {
            sums.add_all(&fragments.places, &work.colours);
        }
        fragments.clear();
        sums.clock.enter(caller);
    }

    /// The colour of the object at every fragment.
    pub(crate) fn colours(self, material: &Material, fragments: &Fragments, colours: &mut Batch<ShadedColour<i32>>) {
        let own = &material.colour;
        match &material.colour_map {
            None => colours.fill(fragments.len(), &ShadedColour { channels: *own, samples: Fx::zero() }),
            Some(map) => Colours { places: fragments.places_in(&map.texels.map), map, own }.run(self, colours),
        }
    }

    /// Bumps and roughness of the object at every fragment.
    pub(crate) fn bumps(self, material: &Material, fragments: &Fragments, bumps: &mut Batch<FilteredBump<i32>>) {
        let flat = Bump { offset: [Fx::zero(); 2], roughness: [Fx::zero(); 3] };
        match &material.bump_map {
            None => bumps.fill(fragments.len(), &FilteredBump { bump: flat, samples: Fx::zero() }),
            Some(map) => {
                let (places, kind) = (fragments.places_in(map.texels.map()), material.plan.roughness());
                Bumps { places, map, kind }.run(self, bumps);
            }
        }
    }

    /// Adds the light that each surface returns.
    fn light(self, material: &Material, fragments: &Fragments, work: &mut Work, sums: &mut Sums) {
        let Some(lighting) = &material.lighting else { return };
        sums.clock.enter(Phase::Lights);
        let Work { bumps, surfaces, lit, .. } = work;
        let LitWork { directions: same, halves, slopes, peaks, shown } = lit;
        if let Shine::Map(map) = &lighting.shine {
            sums.samples += peaks.read(map, fragments.places_in(&map.map), self);
        }
        let mut own = fragments.directions.iter();
        for Light { direction, colour } in &lighting.lights {
            let directions = match direction {
                Some(direction) => {
                    same.fill(surfaces.len(), &direction.wires());
                    &*same
                }
                None => own.next().unwrap_or_else(|| unreachable!("fragments have a direction to each light")),
            };
            let lit = Lit { surfaces, directions };
            match &lighting.shine {
                Shine::Highlight(shininess) => {
                    Highlights { lit, shininess, plan: &lighting.plan, colour }.run(self, shown);
                }
                Shine::Formula(formula) => {
                    *shown = by_formula(formula, lit, &fragments.bare, bumps, colour).collect();
                }
                Shine::Given(given) => {
                    Halves(lit).run(self, halves);
                    GivenPeaks { halves, peaks: given, colour }.run(self, shown);
                }
                Shine::Map(map) => {
                    Halves(lit).run(self, halves);
                    let places = fragments.places_in(&map.map);
                    let slopes = map.has_horizons().then(|| {
                        HorizonSlopes(lit).run(self, slopes);
                        &*slopes
                    });
                    peaks.shine(&LightOnPeaks { map, places, halves, slopes, colour }, self, shown);
                }
            }
            sums.add_all(&fragments.places, shown);
        }
    }

    /// Adds the reflection of the environment, blended with the colours of surfaces.
    fn reflect(self, material: &Material, plan: &BatchPlan, fragments: &Fragments, work: &mut Work, sums: &mut Sums) {
        let Some(reflection) = &plan.reflection else { return };
        let Work { colours, surfaces, seen, .. } = work;
        let Some(environment) = self.environment else {
            for (&place, own) in fragments.places.iter().zip(colours.colours()) {
                let channel = |i: usize| pixel::blend::<i32>(own[i], Fx::zero(), material.reflectance[i]);
                sums.add(place, core::array::from_fn(channel));
            }
            return;
        };
        let Environment { texels: map, scale } = environment;
        let reflector = Reflector { own: colours, map, is_rough: plan.is_rough, reflectance: &material.reflectance };
        let SeenWork {
            points,
            footprints,
            ordered_footprints,
            sweeps,
            ordered_sweeps,
            shown,
            laws,
            lobe,
            of_second,
            of_both,
        } = seen;
        let mut look = |surfaces: &Batch<Surface<i32>>, shown: &mut Batch<ShadedColour<i32>>, sums: &mut Sums| {
            sums.clock.enter(Phase::Footprints);
            let reflected = Reflected { surfaces, derivatives: &fragments.derivatives, scale, plan: reflection };
            match reflection.footprint {
                FootprintKind::None => {
                    Points(surfaces).run(self, points);
                    sums.clock.enter(Phase::Environment);
                    EnvironmentColours { looks: points, reflector }.run(self, shown);
                }
                FootprintKind::Face => {
                    Footprints(reflected).run(self, footprints);
                    sums.clock.enter(Phase::Environment);
                    EnvironmentColours { looks: footprints, reflector }.run(self, ordered_footprints, shown);
                }
                FootprintKind::Sphere => {
                    Sweeps(reflected).run(self, sweeps);
                    sums.clock.enter(Phase::Environment);
                    EnvironmentColours { looks: sweeps, reflector }.run(self, ordered_sweeps, shown);
                }
            }
            sums.samples += shown.samples();
        };
        let rough_map = material.rough_map().filter(|_| plan.two_lobes);
        let Some(footprints) = rough_map.and_then(|map| fragments.footprints.for_map(map)) else {
            look(surfaces, shown, sums);
            return sums.add_all(&fragments.places, shown);
        };
        LobeLaws { footprints, levels: &material.lobes }.run(self, laws);
        LobeSurfaces { surfaces, laws, lobe: 0 }.run(self, lobe);
        look(lobe, shown, sums);
        LobeSurfaces { surfaces, laws, lobe: 1 }.run(self, lobe);
        look(lobe, of_second, sums);
        Lobes { colours: [shown, of_second], laws }.run(self, of_both);
        sums.add_all(&fragments.places, of_both);
    }

    /// The ports of the surface of a fragment, the first of these rows, with its bump map sampled.
    pub fn surface_input(
        self,
        material: &Material,
        rows: &AttributeRows,
        derivatives: &Derivatives<i32>,
    ) -> SurfaceInput<i32> {
        let (mut fragments, mut bumps) = (Fragments::new(material), Batch::default());
        fragments.append(&[Place::default()], rows, derivatives);
        fragments.footprints.make(self, &fragments.duv);
        self.bumps(material, &fragments, &mut bumps);
        ports(&fragments.bare.get(0), &bumps.get(0).bump)
    }
}

/// Colours returned by a formula.
fn by_formula(
    formula: &Formula,
    Lit { surfaces, directions }: Lit<'_>,
    bare: &Batch<SurfaceAttributes<i32>>,
    bumps: &Batch<FilteredBump<i32>>,
    colour: &[Channel; 3],
) -> impl Iterator<Item = ShadedColour<i32>> {
    let inputs = bare.iter().zip(bumps.iter()).map(|(bare, bumped)| ports(&bare, &bumped.bump));
    let lit = surfaces.iter().zip(directions.iter());
    lit.zip(inputs).map(|((surface, light), input)| {
        let share = formula(&surface, &input, &BlockVector::from_wires(&light));
        ShadedColour { channels: colour.map(|channel| pixel::modulated::<i32>(share, channel)), samples: Fx::zero() }
    })
}
