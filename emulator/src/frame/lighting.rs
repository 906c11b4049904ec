//! Lights on a fragment: what a highlight or the peaks of its surface return of each.
//!
//! The surface is made once a fragment, what depends on the light once a light. Peaks of a map are texels whose value is
//! the light they return: they are summed in the texel and filtered like any other, never averaged themselves (F92 §2.4).

use fixed::types::I4F28;
use roughxel_core::datapath::{self, Surface, SurfaceInput};
use roughxel_core::fx::Fx;
use roughxel_core::plan::SurfacePlan;
use roughxel_core::ports::{BlockVector, ReflectionIn};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{block_vector, shininess, stored_peak};
use roughxel_core::signals::{LocalDirection, Peak, PortBlock, ShininessPort};
use roughxel_core::stage::peaks;

use crate::maps::peaks::PeakPyramid;
use crate::raster::{FragmentAttributes, PointFromTriangle, Triangle};
use crate::scene::{Highlight, Light, LightPlace, PeakSource, Peaks};

use super::texture::RepeatedMap;
use super::{Colour, colour_word, multiply};

/// A weight of 1.
const WHOLE: i64 = 1 << 16;

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
    /// The same peaks everywhere.
    Given(Vec<Peak<i32>>),
    /// Peaks of a map.
    Map(PeakMap),
}

/// The peaks of every texel of a pyramid.
pub(super) struct PeakMap {
    map: RepeatedMap,
    /// Of each level, where each texel's peaks end, and all peaks.
    levels: Vec<(Vec<usize>, Vec<Peak<i32>>)>,
}

impl PeakMap {
    /// As it is stored.
    pub(super) fn new(pyramid: &PeakPyramid) -> Self {
        let level = |level: &crate::maps::peaks::PeakLevel| {
            let (mut ends, mut peaks) = (Vec::new(), Vec::new());
            for y in 0..level.height {
                for x in 0..level.width {
                    let texel = level.texel(x, y).iter();
                    peaks.extend(texel.map(|peak| stored_peak(peak.normal, peak.amplitude, peak.exponent).wires()));
                    ends.push(peaks.len());
                }
            }
            (ends, peaks)
        };
        let map = RepeatedMap::new(pyramid.levels.iter().map(|level| (level.width, level.height)));
        Self { map, levels: pyramid.levels.iter().map(level).collect() }
    }

    fn texel(&self, level: usize, index: usize) -> &[Peak<i32>] {
        let (ends, peaks) = &self.levels[level];
        let start = index.checked_sub(1).map_or(0, |before| ends[before]);
        &peaks[start..ends[index]]
    }
}

/// Directions to the lights that stand in the scene, set up for a triangle.
pub(super) type Points = Vec<Option<PointFromTriangle>>;

impl Lighting {
    /// The highlight of a material.
    pub(super) fn highlight(highlight: &Highlight, lights: &[Light], plan: SurfacePlan, p: &Precision) -> Self {
        let lobes = Lobes::Highlight(shininess(highlight.exponent).wires());
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
                Lobes::Given(stored.collect())
            }
            (PeakSource::Bump { .. }, Some(map)) => Lobes::Map(map),
            (PeakSource::Bump { .. }, None) => Lobes::Given(Vec::new()),
        };
        Self { plan, lights: prepared(lights, given.colour, p), lobes }
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
        ports: &ReflectionIn,
        (triangle, points): (&Triangle<'_>, &Points),
        (attributes, [x, y]): (&FragmentAttributes, [i32; 2]),
        footprint: bool,
        p: &Precision,
    ) -> [i64; 3] {
        let surface = datapath::surface(&surface_wires(ports), &self.plan, p);
        let gloss = match &self.lobes {
            Lobes::Highlight(shininess) => Some(datapath::gloss(&surface, shininess, &self.plan, p)),
            _ => None,
        };
        let mut sum = [0; 3];
        for (light, point) in self.lights.iter().zip(points) {
            let direction = point.as_ref().map_or(light.direction, |point| triangle.direction_to(point, x, y)).wires();
            let returned = match (&self.lobes, &gloss) {
                (Lobes::Highlight(_), Some(gloss)) => datapath::highlight(&surface, gloss, &direction, p).f.raw(),
                (Lobes::Highlight(_), None) => 0,
                (Lobes::Given(peaks), _) => {
                    self.half(&surface, &direction, p).map_or(0, |half| sum_of(peaks, &half, p))
                }
                (Lobes::Map(map), _) => self.half(&surface, &direction, p).map_or(0, |half| {
                    let texel = |level, index| [sum_of(map.texel(level, index), &half, p)];
                    let [light] = map.map.assemble(attributes, footprint, p, 0, texel, |sample| sample);
                    light
                }),
            };
            for (sum, channel) in sum.iter_mut().zip(light.colour) {
                *sum += i64::from(multiply(returned, channel));
            }
        }
        sum
    }

    /// The half vector of a light in the frame of the surface, where the light is above it.
    fn half(&self, surface: &Surface<i32>, light: &PortBlock<i32, 3>, p: &Precision) -> Option<LocalDirection<i32>> {
        let half = datapath::peak_light(surface, light, p);
        (!half.below).then_some(half.direction)
    }
}

/// The light that peaks return together.
fn sum_of(peaks: &[Peak<i32>], half: &LocalDirection<i32>, p: &Precision) -> i32 {
    let whole = Fx::lit(WHOLE);
    let add = |sum, peak| datapath::peak_sum(&sum, datapath::peak(half, peak, whole, p));
    peaks.iter().fold(peaks::none(), add).light.raw()
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
