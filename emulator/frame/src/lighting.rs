//! Lights on a fragment: what a highlight or the peaks of its surface return of each.
//!
//! The surface is made once a fragment, what depends on the light once a light. Peaks of a map are texels whose value is
//! the light they return: they are summed in the texel and filtered like any other, never averaged themselves (F92 §2.4).

use roughxel_core::datapath::{Surface, pixel};
use roughxel_core::fx::Fx;
use roughxel_core::plan::{HorizonKind, SurfacePlan};
use roughxel_core::ports::{BlockVector, Port, PortBlock, ShininessPort, StoredHorizon, StoredPeak, SurfaceInput};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{block_vector, shininess, stored_horizon, stored_peak, uniform_law};
use roughxel_core::signals::LocalDirection;

use crate::plan::ObjectPlan;
use crate::raster::{PointFromTriangle, Triangle};
use roughxel_lanes::{
    Columns, MOST_PEAKS, PackedPeak, PeakTexels, PeaksRead, Places, Reading, RepeatedMap, Shown, Slopes,
};
use roughxel_peaks::{self as pyramid, MAX_PEAKS, PeakPyramid};
use roughxel_scene::{Highlight, HighlightForm, Light, LightPlace, PeakSource, Peaks};

use super::colour::{Channel, colour_word};
use super::printed;

/// What shines in an object, and the lights that make it.
pub(super) struct Lighting {
    /// Effects of the surface.
    plan: SurfacePlan,
    lights: Vec<PreparedLight>,
    lobes: Lobes,
}

/// A light as an object shows it.
struct PreparedLight {
    place: LightPlace,
    /// Direction of a light infinitely far away.
    direction: BlockVector,
    /// Colour of the light times that of the highlight or the peaks.
    colour: [Channel; 3],
}

/// What returns light.
enum Lobes {
    /// One lobe around the normal.
    Highlight(ShininessPort<i32>),
    /// The same, by the formula as printed.
    Printed(f64),
    /// The same peaks everywhere.
    Given(Vec<PackedPeak>),
    /// Peaks of a map.
    Map(PeakTexels),
}

/// The peaks of every texel of a pyramid, as they are stored, or only of its base where nothing is filtered; their horizons where they have
/// shadows.
pub(super) fn peak_texels(pyramid: &PeakPyramid, filters: bool, kind: HorizonKind) -> PeakTexels {
    const _: () = assert!(MAX_PEAKS <= MOST_PEAKS, "lanes read so many");
    let kept = if filters { &pyramid.levels } else { &pyramid.levels[..1] };
    let stored = |peak: &pyramid::Peak| packed(stored_peak(peak.normal, peak.amplitude, peak.exponent));
    let horizon = |sides: [pyramid::Horizon; 4]| {
        let law = |side: pyramid::Horizon| match kind {
            HorizonKind::Product => uniform_law(side.mean, side.deviation),
            HorizonKind::None | HorizonKind::Correlated => [side.low, side.width],
        };
        let laws = sides.map(law);
        stored_horizon(laws.map(|law| law[0]), laws.map(|law| law[1])).wires()
    };
    let texels = kept.iter().flat_map(|level| {
        (0..level.height).flat_map(move |y| (0..level.width).map(move |x| level.texel(x, y).len() as u32))
    });
    let ends = texels.scan(0, |end, peaks| {
        *end += peaks;
        Some(*end)
    });
    let peaks = || kept.iter().flat_map(pyramid::PeakLevel::peaks);
    let horizons = peaks().filter_map(|peak| peak.horizon.filter(|_| kind != HorizonKind::None)).map(horizon);
    let map = RepeatedMap::new(kept.iter().map(|level| (level.width, level.height)));
    PeakTexels::new(map, std::iter::once(0).chain(ends).collect(), peaks().map(stored), (horizons, kind))
}

/// What a batch of fragments goes through at a light; its memory is kept for the next one.
#[derive(Default)]
pub(super) struct Lit {
    directions: Columns<PortBlock<i32, 3>>,
    halves: Columns<LocalDirection<i32>>,
    slopes: Columns<Slopes<i32>>,
    peaks: PeaksRead,
    shown: Columns<Shown<i32>>,
}

/// From each fragment of a batch to each light that stands in the scene, in the order of the lights.
pub(super) type Directions = Vec<Columns<PortBlock<i32, 3>>>;

/// Directions to the lights that stand in the scene, set up for a triangle.
pub(super) type Points = Vec<PointFromTriangle>;

impl Lighting {
    /// The highlight of a material.
    pub(super) fn highlight(highlight: &Highlight, lights: &[Light], plan: SurfacePlan, p: &Precision) -> Self {
        let lobes = match highlight.form {
            HighlightForm::Printed => Lobes::Printed(highlight.exponent),
            HighlightForm::Corrected | HighlightForm::Plain => Lobes::Highlight(shininess(highlight.exponent).wires()),
        };
        Self { plan, lights: prepared(lights, highlight.colour, p), lobes }
    }

    /// The peaks of a material, with the pyramid of its bump map where they come from one.
    pub(super) fn peaks(
        given: &Peaks,
        map: Option<PeakTexels>,
        lights: &[Light],
        plan: SurfacePlan,
        p: &Precision,
    ) -> Self {
        let lobes = match (&given.source, map) {
            (PeakSource::Given(given), _) => {
                let stored = given.iter().map(|peak| stored_peak(peak.normal, peak.amplitude, peak.exponent));
                Lobes::Given(stored.map(packed).collect())
            }
            (PeakSource::Bump { .. }, Some(map)) => Lobes::Map(map),
            (PeakSource::Bump { .. }, None) => Lobes::Given(Vec::new()),
        };
        Self { plan, lights: prepared(lights, given.colour, p), lobes }
    }

    /// The same with the effects of another plan.
    pub(super) fn with_plan(mut self, plan: &ObjectPlan) -> Option<Self> {
        let surface =
            if matches!(self.lobes, Lobes::Highlight(_) | Lobes::Printed(_)) { plan.highlight } else { plan.peaks };
        self.plan = surface?;
        self.lobes = match self.lobes {
            Lobes::Map(map) if plan.horizon == HorizonKind::None => Lobes::Map(map.without_horizons()),
            lobes => lobes,
        };
        Some(self)
    }

    /// Bytes of the stored peaks, and of their horizons.
    pub(super) fn bytes(&self) -> [u64; 2] {
        match &self.lobes {
            Lobes::Highlight(_) | Lobes::Printed(_) => [0; 2],
            Lobes::Given(peaks) => [size_of::<StoredPeak>() as u64 * peaks.len() as u64, 0],
            Lobes::Map(map) => {
                let peaks = map.count() as u64;
                let horizons = if map.has_horizons() { peaks } else { 0 };
                [peaks * size_of::<StoredPeak>() as u64, horizons * size_of::<StoredHorizon>() as u64]
            }
        }
    }

    /// What a triangle's fragments need to know of the lights in the scene.
    pub(super) fn points(&self, triangle: &Triangle<'_>) -> Points {
        let point = |light: &PreparedLight| match light.place {
            LightPlace::Point(point) => Some(triangle.point(point)),
            LightPlace::Direction(_) => None,
        };
        self.lights.iter().filter_map(point).collect()
    }

    /// Adds the directions from a sample, position in sub-pixels, to the lights that stand in the scene.
    pub(super) fn directions(
        &self,
        triangle: &Triangle<'_>,
        points: &Points,
        [x, y]: [i32; 2],
        directions: &mut Directions,
    ) {
        directions.resize_with(points.len(), Columns::default);
        for (point, directions) in points.iter().zip(directions) {
            directions.push(&triangle.direction_to(point, x, y).wires());
        }
    }

    /// The map of the peaks, if they come from one.
    pub(super) fn map(&self) -> Option<&RepeatedMap> {
        match &self.lobes {
            Lobes::Map(map) => Some(&map.map),
            _ => None,
        }
    }

    /// Hands the colours that each light makes of a batch of surfaces to `add`; `input` tells what the surface of a fragment was made of,
    /// and `places` where fragments look in a map. Returns the bilinear samples read.
    pub(super) fn shine<'a>(
        &self,
        surfaces: &Columns<Surface<i32>>,
        input: impl Fn(usize) -> SurfaceInput<i32>,
        (directions, places): (&Directions, impl Fn(&RepeatedMap) -> Places<'a>),
        lit: &mut Lit,
        (reading, p): (Reading, &Precision),
        mut add: impl FnMut(&Columns<Shown<i32>>),
    ) -> u64 {
        let Lit { directions: same, halves, slopes, peaks, shown } = lit;
        let taps = match &self.lobes {
            Lobes::Map(map) => peaks.read(map, places(&map.map), reading, p),
            Lobes::Highlight(_) | Lobes::Printed(_) | Lobes::Given(_) => 0,
        };
        let mut points = directions.iter();
        for PreparedLight { place, direction, colour } in &self.lights {
            let directions = match place {
                LightPlace::Direction(_) => {
                    same.fill(surfaces.len(), &direction.wires());
                    &*same
                }
                LightPlace::Point(_) => points.next().unwrap_or_else(|| unreachable!("a direction to each point")),
            };
            match &self.lobes {
                Lobes::Highlight(shininess) => {
                    reading.highlights((surfaces, directions), (shininess, &self.plan), colour, p, shown);
                }
                Lobes::Printed(exponent) => {
                    let surfaces = surfaces.iter().zip(directions.iter()).enumerate();
                    *shown = surfaces
                        .map(|(fragment, (surface, light))| {
                            let light = printed::light(&surface, &input(fragment), &BlockVector::of(&light), *exponent);
                            let channels = colour.map(|channel| pixel::modulated::<i32>(light, channel));
                            Shown { channels, taps: Fx::zero() }
                        })
                        .collect();
                }
                Lobes::Given(given) => {
                    reading.halves((surfaces, directions), p, halves);
                    reading.given_peaks(halves, given, colour, p, shown);
                }
                Lobes::Map(map) => {
                    reading.halves((surfaces, directions), p, halves);
                    let has_horizons = map.has_horizons();
                    if has_horizons {
                        reading.slopes((surfaces, directions), p, slopes);
                    }
                    let views = (&*halves, has_horizons.then_some(&*slopes));
                    peaks.shine((map, places(&map.map)), views, colour, (reading, p), shown);
                }
            }
            add(shown);
        }
        taps
    }
}

fn packed(peak: StoredPeak) -> PackedPeak {
    PackedPeak::from(&peak.wires())
}

fn prepared(lights: &[Light], colour: [f32; 3], p: &Precision) -> Vec<PreparedLight> {
    let light = |light: &Light| {
        let direction = match light.place {
            LightPlace::Direction(direction) => block_vector(direction, p),
            LightPlace::Point(_) => BlockVector::default(),
        };
        let colour = colour_word(core::array::from_fn(|i| light.colour[i] * colour[i]));
        PreparedLight { place: light.place, direction, colour }
    };
    lights.iter().map(light).collect()
}
