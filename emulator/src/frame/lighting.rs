//! Lights on a fragment: what a highlight or the peaks of its surface return of each.
//!
//! The surface is made once a fragment, what depends on the light once a light. Peaks of a map are texels whose value is
//! the light they return: they are summed in the texel and filtered like any other, never averaged themselves (F92 §2.4).

use fixed::types::I4F28;
use roughxel_core::datapath::{self, SurfaceInput};
use roughxel_core::fx::Fx;
use roughxel_core::plan::SurfacePlan;
use roughxel_core::ports::{BlockVector, ReflectionIn, StoredHorizon, StoredPeak};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{block_vector, shininess, stored_horizon, stored_peak};
use roughxel_core::signals::{Horizon, LIGHT, LocalDirection, Peak, SHARE, ShininessPort};
use roughxel_core::stage::peaks;

use crate::lanes::{Reading, WeightedPeak};
use crate::maps::peaks::{self as pyramid, PeakPyramid};
use crate::plan::ObjectPlan;
use crate::raster::{PointFromTriangle, Triangle};
use crate::scene::{Highlight, HighlightForm, Light, LightPlace, PeakSource, Peaks};

use super::printed;
use super::texture::{MapReads, RepeatedMap, Taps, mean};
use super::{Colour, colour_word, multiply};

/// What shines in an object, and the lights that make it.
pub(super) struct Lighting {
    /// Blocks of the surface.
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
    colour: Colour,
}

/// What returns light.
enum Lobes {
    /// One lobe around the normal.
    Highlight(ShininessPort<i32>),
    /// The same, by the formula as printed.
    Printed(f64),
    /// The same peaks everywhere.
    Given(Vec<WeightedPeak<i32>>),
    /// Peaks of a map.
    Map(PeakMap),
}

/// The peaks of every texel of a pyramid.
pub(super) struct PeakMap {
    map: RepeatedMap,
    /// Where the peaks of each texel end, of all levels, the finest first.
    ends: Vec<u32>,
    peaks: Vec<WeightedPeak<i32>>,
    /// As many as peaks, or none.
    horizons: Vec<Horizon<i32>>,
}

impl PeakMap {
    /// As it is stored, or only its base where nothing is filtered; its horizons where peaks have shadows.
    pub(super) fn new(pyramid: &PeakPyramid, filters: bool, shadowing: bool) -> Self {
        let kept = if filters { &pyramid.levels } else { &pyramid.levels[..1] };
        let stored = |peak: &pyramid::Peak| whole(stored_peak(peak.normal, peak.amplitude, peak.exponent).wires());
        let horizon = |sides: [pyramid::Horizon; 4]| {
            stored_horizon(sides.map(|side| side.mean), sides.map(|side| side.deviation)).wires()
        };
        let texels = kept.iter().flat_map(|level| {
            (0..level.height).flat_map(move |y| (0..level.width).map(move |x| level.texel(x, y).len() as u32))
        });
        let ends = texels.scan(0, |end, peaks| {
            *end += peaks;
            Some(*end)
        });
        let peaks = || kept.iter().flat_map(pyramid::PeakLevel::peaks);
        let map = RepeatedMap::new(kept.iter().map(|level| (level.width, level.height)));
        Self {
            map,
            ends: ends.collect(),
            peaks: peaks().map(stored).collect(),
            horizons: peaks().filter_map(|peak| peak.horizon.filter(|_| shadowing)).map(horizon).collect(),
        }
    }

    /// Bytes of the stored peaks, and of their horizons.
    fn bytes(&self) -> [u64; 2] {
        let (peaks, horizons) = (self.peaks.len() as u64, self.horizons.len() as u64);
        [peaks * size_of::<StoredPeak>() as u64, horizons * size_of::<StoredHorizon>() as u64]
    }

    /// Peaks of a texel, and their horizons if there are any.
    fn texel(&self, texel: u32) -> (&[WeightedPeak<i32>], &[Horizon<i32>]) {
        let index = texel as usize;
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        let range = start as usize..self.ends[index] as usize;
        (&self.peaks[range.clone()], self.horizons.get(range).unwrap_or_default())
    }
}

/// No map has this texel.
const NO_TEXEL: u32 = u32::MAX;

/// Peaks that a fragment reads; its memory is kept for the next one.
#[derive(Default)]
pub(super) struct PeaksRead {
    /// Where the peaks of each texel end.
    ends: Vec<usize>,
    peaks: Vec<WeightedPeak<i32>>,
    /// As many as peaks, or none.
    horizons: Vec<Horizon<i32>>,
    lights: Vec<Fx<i32, LIGHT>>,
    sums: Vec<i32>,
}

impl PeaksRead {
    /// Reads the texels of the probes, once what a probe shares with the one before; the texels of `taps` then name their
    /// places in [`Self::sums`].
    fn read(&mut self, map: &PeakMap, taps: &mut Taps) {
        self.ends.clear();
        self.peaks.clear();
        self.horizons.clear();
        // Of each level, four texels and their places.
        let mut before = [[[NO_TEXEL; 4]; 2]; 2];
        for tap in taps {
            let (fine, coarse) = tap.place.levels();
            for (patch, before) in [Some(fine), coarse].into_iter().flatten().zip(&mut before) {
                let [read, places] = *before;
                let new = patch.texels.map(|texel| match read.iter().position(|read| *read == texel) {
                    Some(shared) => places[shared],
                    None => {
                        let (peaks, horizons) = map.texel(texel);
                        self.peaks.extend_from_slice(peaks);
                        self.horizons.extend_from_slice(horizons);
                        self.ends.push(self.peaks.len());
                        self.ends.len() as u32 - 1
                    }
                });
                *before = [std::mem::replace(&mut patch.texels, new), new];
            }
        }
    }

    /// Sums the peaks of each texel, lit by one light.
    fn light(&mut self, half: &LocalDirection<i32>, reading: Reading, p: &Precision) {
        self.lights.clear();
        reading.peaks(half, &self.peaks, p, &mut self.lights);
        self.sums.clear();
        let mut start = 0;
        for &end in &self.ends {
            self.sums.push(sum(&self.lights[start..end]));
            start = end;
        }
    }
}

/// A fragment that is lit, and its triangle.
pub(super) struct LitFragment<'a> {
    pub(super) ports: &'a ReflectionIn,
    pub(super) triangle: &'a Triangle<'a>,
    pub(super) points: &'a Points,
    /// Sub-pixels.
    pub(super) position: [i32; 2],
}

/// Directions to the lights that stand in the scene, set up for a triangle.
pub(super) type Points = Vec<Option<PointFromTriangle>>;

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
        map: Option<PeakMap>,
        lights: &[Light],
        plan: SurfacePlan,
        p: &Precision,
    ) -> Self {
        let lobes = match (&given.source, map) {
            (PeakSource::Given(given), _) => {
                let stored = given.iter().map(|peak| stored_peak(peak.normal, peak.amplitude, peak.exponent).wires());
                Lobes::Given(stored.map(whole).collect())
            }
            (PeakSource::Bump { .. }, Some(map)) => Lobes::Map(map),
            (PeakSource::Bump { .. }, None) => Lobes::Given(Vec::new()),
        };
        Self { plan, lights: prepared(lights, given.colour, p), lobes }
    }

    /// The same with the blocks of another plan.
    pub(super) fn with_plan(mut self, plan: &ObjectPlan) -> Option<Self> {
        let surface =
            if matches!(self.lobes, Lobes::Highlight(_) | Lobes::Printed(_)) { plan.highlight } else { plan.peaks };
        self.plan = surface?;
        if let (false, Lobes::Map(map)) = (plan.horizon, &mut self.lobes) {
            map.horizons = Vec::new();
        }
        Some(self)
    }

    /// Bytes of the stored peaks, and of their horizons.
    pub(super) fn bytes(&self) -> [u64; 2] {
        match &self.lobes {
            Lobes::Highlight(_) | Lobes::Printed(_) => [0; 2],
            Lobes::Given(peaks) => [size_of::<StoredPeak>() as u64 * peaks.len() as u64, 0],
            Lobes::Map(map) => map.bytes(),
        }
    }

    /// What a triangle's fragments need to know of the lights in the scene.
    pub(super) fn points(&self, triangle: &Triangle<'_>) -> Points {
        let point = |light: &PreparedLight| match light.place {
            LightPlace::Point(point) => Some(triangle.point(point)),
            LightPlace::Direction(_) => None,
        };
        self.lights.iter().map(point).collect()
    }

    /// The colour that all lights make at a sample; channels may go beyond a word where lights are many.
    pub(super) fn shine(
        &self,
        at: &LitFragment<'_>,
        reads: &mut MapReads<'_>,
        read: &mut PeaksRead,
        reading: Reading,
        p: &Precision,
    ) -> [i64; 3] {
        let surface = datapath::surface(&surface_wires(at.ports), &self.plan, p);
        let directions = self.lights.iter().zip(at.points).map(|(light, point)| {
            let [x, y] = at.position;
            point.as_ref().map_or(light.direction, |point| at.triangle.direction_to(point, x, y))
        });
        let mut sum = [0; 3];
        let mut add = |light: &PreparedLight, returned: i32| {
            for (sum, channel) in sum.iter_mut().zip(light.colour) {
                *sum += i64::from(multiply(returned, channel));
            }
        };
        match &self.lobes {
            Lobes::Highlight(shininess) => {
                let gloss = datapath::gloss(&surface, shininess, &self.plan, p);
                for (light, direction) in self.lights.iter().zip(directions) {
                    add(light, datapath::highlight(&surface, &gloss, &direction.wires(), p).f.raw());
                }
            }
            Lobes::Printed(exponent) => {
                for (light, direction) in self.lights.iter().zip(directions) {
                    add(light, printed::light(&surface, at.ports, &direction, *exponent).raw());
                }
            }
            Lobes::Given(peaks) => {
                for (light, direction) in self.lights.iter().zip(directions) {
                    let lit = datapath::peak_light(&surface, &direction.wires(), p);
                    if !lit.side.below {
                        read.lights.clear();
                        reading.peaks(&lit.direction, peaks, p, &mut read.lights);
                        add(light, self::sum(&read.lights));
                    }
                }
            }
            Lobes::Map(map) => {
                let taps = reads.take(&map.map);
                read.read(map, taps);
                let eye = (!map.horizons.is_empty()).then(|| {
                    let eye = datapath::local_components(&surface.view, &surface.frame, &surface.normal, p);
                    datapath::horizon_slopes(&eye, p)
                });
                for (light, direction) in self.lights.iter().zip(directions) {
                    let lit = datapath::peak_light(&surface, &direction.wires(), p);
                    if lit.side.below {
                        continue;
                    }
                    if let Some(eye) = &eye {
                        let slopes = datapath::horizon_slopes(&lit.light, p);
                        for (peak, horizon) in read.peaks.iter_mut().zip(&read.horizons) {
                            peak.weight = datapath::horizon(&slopes, eye, horizon, p);
                        }
                    }
                    read.light(&lit.direction, reading, p);
                    let [returned] = mean(taps, 0, |place| [read.sums[place as usize]], |sample| sample);
                    add(light, returned);
                }
            }
        }
        sum
    }
}

/// A peak of which nothing is hidden.
fn whole(peak: Peak<i32>) -> WeightedPeak<i32> {
    WeightedPeak { peak, weight: Fx::lit(1 << SHARE) }
}

/// The light that peaks return together.
fn sum(lights: &[Fx<i32, LIGHT>]) -> i32 {
    lights.iter().fold(peaks::none(), |sum, &light| datapath::peak_sum(&sum, light)).light.raw()
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

/// The surface's part of the ports.
fn surface_wires(ports: &ReflectionIn) -> SurfaceInput<i32> {
    let number = |x: I4F28| Fx::from_raw(x.to_bits());
    SurfaceInput {
        normal: ports.normal.wires(),
        view: ports.view.wires(),
        tangents: ports.tangents.map(|tangent| tangent.wires()),
        offset: ports.offset.map(number),
        roughness: ports.roughness.map(number),
    }
}
