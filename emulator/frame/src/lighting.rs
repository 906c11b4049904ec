//! Lights on a fragment: what a highlight or the peaks of its surface return of each.
//!
//! The surface is made once a fragment, what depends on the light once a light. Peaks of a map are texels whose value is
//! the light they return: they are summed in the texel and filtered like any other, never averaged themselves (F92 §2.4).

use roughxel_core::bundle::Value;
use roughxel_core::datapath::{self, Surface, pixel};
use roughxel_core::each::{each, places};
use roughxel_core::fx::Fx;
use roughxel_core::plan::{HorizonKind, SurfacePlan};
use roughxel_core::ports::{BlockVector, Horizon, Port, ShininessPort, StoredHorizon, StoredPeak, SurfaceInput};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{block_vector, shininess, stored_horizon, stored_peak, uniform_law};
use roughxel_core::signals::{LocalDirection, PeakSum, TexturePosition};
use roughxel_core::width::on_words;

use crate::plan::ObjectPlan;
use crate::raster::{PointFromTriangle, Triangle};
use roughxel_lanes::{Columns, PackedPeak, PeakList, Reading, RepeatedMap};
use roughxel_maps::peak_pyramid::{self as pyramid, MAX_PEAKS, PeakPyramid};
use roughxel_scene::{Highlight, HighlightForm, Light, LightPlace, PeakSource, Peaks};

use super::colour::{Channel, colour_word};
use super::printed;
use super::texture::{Footprints, Taps};

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
    Given(PeakList),
    /// Peaks of a map.
    Map(PeakMap),
}

/// The peaks of every texel of a pyramid.
pub(super) struct PeakMap {
    map: RepeatedMap,
    /// Where the peaks of each texel begin, of all levels, the finest first; and where the last end.
    begins: Vec<u32>,
    peaks: Vec<PackedPeak>,
    /// As many as peaks, or none.
    horizons: Vec<Horizon<i32>>,
    /// How they are stored and joined.
    kind: HorizonKind,
}

impl PeakMap {
    /// As it is stored, or only its base where nothing is filtered; its horizons where peaks have shadows.
    pub(super) fn new(pyramid: &PeakPyramid, filters: bool, kind: HorizonKind) -> Self {
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
        let map = RepeatedMap::new(kept.iter().map(|level| (level.width, level.height)));
        Self {
            map,
            begins: std::iter::once(0).chain(ends).collect(),
            peaks: peaks().map(stored).collect(),
            horizons: peaks()
                .filter_map(|peak| peak.horizon.filter(|_| kind != HorizonKind::None))
                .map(horizon)
                .collect(),
            kind,
        }
    }

    /// Bytes of the stored peaks, and of their horizons.
    fn bytes(&self) -> [u64; 2] {
        let (peaks, horizons) = (self.peaks.len() as u64, self.horizons.len() as u64);
        [peaks * size_of::<StoredPeak>() as u64, horizons * size_of::<StoredHorizon>() as u64]
    }
}

/// No map has this texel.
const NO_TEXEL: u32 = u32::MAX;

/// No fragment reads this many texels.
const NO_PLACE: u32 = u32::MAX;

/// Indices that are written at once, no fewer than a texel has peaks: a fixed length is never mispredicted.
const RUN: usize = MAX_PEAKS.next_power_of_two();

/// Peaks that a fragment reads; its memory is kept for the next one.
#[derive(Default)]
pub(super) struct PeaksRead {
    /// Indices in the map, and room for a run behind them.
    indices: Vec<u32>,
    /// The place of the texel of each in [`Self::sums`], and the same room.
    owners: Vec<u32>,
    peaks: PeakList,
    /// As many as peaks, or none.
    horizons: Vec<Horizon<i32>>,
    lights: Vec<Channel>,
    /// The light of each texel.
    sums: Vec<i32>,
    /// What the fragment reads of the map of the peaks.
    taps: Taps,
}

/// A fragment of a batch in the maps that it reads.
#[derive(Clone, Copy)]
pub(super) struct Spot<'a> {
    pub(super) centres: &'a Columns<TexturePosition<i32>>,
    pub(super) footprints: &'a Footprints,
    /// In the batch.
    pub(super) fragment: usize,
}

impl PeaksRead {
    /// Reads the texels of the probes, once what a probe shares with the one before; the texels of [`Self::taps`] then name their
    /// places in [`Self::sums`]. Returns the bilinear samples.
    fn read(&mut self, map: &PeakMap, spot: Spot<'_>, p: &Precision) -> u64 {
        let Spot { centres, footprints, fragment } = spot;
        let probes = footprints.of(&map.map).map(|probes| probes.get(fragment));
        let taps = &mut self.taps;
        taps.set(&map.map, &centres.get(fragment), probes.as_ref(), p);
        let most = 4 * RUN * taps.levels().iter().map(Vec::len).sum::<usize>();
        if self.indices.len() < most {
            self.indices.resize(most, 0);
            self.owners.resize(most, 0);
        }
        let (begins, indices, owners) = (&map.begins[..], &mut self.indices[..], &mut self.owners[..]);
        let (mut peaks, mut texels) = (0, 0);
        for patches in taps.levels() {
            let mut before = [(NO_TEXEL, NO_PLACE); 4];
            for patch in patches {
                let now = each!(texel in patch.texels => {
                    let texel = texel.raw() as u32;
                    let same = |place, &(read, at): &(u32, u32)| if read == texel { at } else { place };
                    let shared = before.iter().fold(NO_PLACE, same);
                    let is_new = shared == NO_PLACE;
                    let [begin, end] = each!(i in [0, 1] => begins[texel as usize + i]);
                    // Written in any case and kept if new: whether a texel is shared cannot be predicted.
                    indices[peaks..peaks + RUN].copy_from_slice(&each!(i in places::<RUN>() => begin + i as u32));
                    owners[peaks..peaks + RUN].copy_from_slice(&[texels; RUN]);
                    let place = if is_new { texels } else { shared };
                    peaks += if is_new { end - begin } else { 0 } as usize;
                    texels += u32::from(is_new);
                    (texel, place)
                });
                patch.texels = each!((_, place) in now => Fx::from_raw(place as i32));
                before = now;
            }
        }
        let indices = &self.indices[..peaks];
        self.peaks.gather(&map.peaks, indices);
        self.horizons.clear();
        if !map.horizons.is_empty() {
            self.horizons.extend(indices.iter().map(|&index| map.horizons[index as usize]));
        }
        self.sums.resize(texels as usize, 0);
        self.taps.count()
    }

    /// Sums the peaks of each texel, lit by one light.
    fn light(&mut self, half: &LocalDirection<i32>, reading: Reading, p: &Precision) {
        self.lights.clear();
        reading.peaks(half, &self.peaks, p, &mut self.lights);
        let sums = &mut self.sums[..];
        sums.fill(0);
        for (&owner, &light) in self.owners.iter().zip(&self.lights) {
            let sum = &mut sums[owner as usize];
            *sum =
                datapath::peak_sum(&PeakSum::<i32> { light: Fx::from_raw(*sum), saturated: false }, light).light.raw();
        }
    }

    /// The light of all peaks, lit by one light.
    fn given(&mut self, half: &LocalDirection<i32>, peaks: &PeakList, reading: Reading, p: &Precision) -> Channel {
        self.lights.clear();
        reading.peaks(half, peaks, p, &mut self.lights);
        let none = PeakSum::<i32> { light: Fx::zero(), saturated: false };
        self.lights.iter().fold(none, |sum, &light| datapath::peak_sum(&sum, light)).light
    }
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
                let stored = given.iter().map(|peak| stored_peak(peak.normal, peak.amplitude, peak.exponent));
                let mut peaks = PeakList::default();
                peaks.gather(&stored.map(packed).collect::<Vec<_>>(), &(0..given.len() as u32).collect::<Vec<_>>());
                Lobes::Given(peaks)
            }
            (PeakSource::Bump { .. }, Some(map)) => Lobes::Map(map),
            (PeakSource::Bump { .. }, None) => Lobes::Given(PeakList::default()),
        };
        Self { plan, lights: prepared(lights, given.colour, p), lobes }
    }

    /// The same with the effects of another plan.
    pub(super) fn with_plan(mut self, plan: &ObjectPlan) -> Option<Self> {
        let surface =
            if matches!(self.lobes, Lobes::Highlight(_) | Lobes::Printed(_)) { plan.highlight } else { plan.peaks };
        self.plan = surface?;
        if let (HorizonKind::None, Lobes::Map(map)) = (plan.horizon, &mut self.lobes) {
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

    /// Adds the direction to each light at a sample, position in sub-pixels, to `directions`.
    pub(super) fn directions(
        &self,
        triangle: &Triangle<'_>,
        points: &Points,
        [x, y]: [i32; 2],
        directions: &mut Vec<BlockVector>,
    ) {
        directions.extend(
            self.lights.iter().zip(points).map(|(light, point)| {
                point.as_ref().map_or(light.direction, |point| triangle.direction_to(point, x, y))
            }),
        );
    }

    /// Number of lights.
    pub(super) fn lights(&self) -> usize {
        self.lights.len()
    }

    /// The map of the peaks, if they come from one.
    pub(super) fn map(&self) -> Option<&RepeatedMap> {
        match &self.lobes {
            Lobes::Map(map) => Some(&map.map),
            _ => None,
        }
    }

    /// Hands the colour that each light makes of a surface to `add`, with the direction to each light; `input` is what the surface
    /// was made of. Returns the bilinear samples read.
    pub(super) fn shine(
        &self,
        (input, surface): (&SurfaceInput<i32>, &Surface<i32>),
        directions: &[BlockVector],
        spot: Spot<'_>,
        read: &mut PeaksRead,
        (reading, p): (Reading, &Precision),
        mut add: impl FnMut([Channel; 3]),
    ) -> u64 {
        let mut taps = 0;
        let mut add = |light: &PreparedLight, returned: Channel| {
            add(light.colour.map(|channel| pixel::modulated::<i32>(returned, channel)));
        };
        match &self.lobes {
            Lobes::Highlight(shininess) => {
                let gloss = &on_words!(p, |surface, shininess| datapath::gloss(surface, shininess, &self.plan, p));
                for (light, direction) in self.lights.iter().zip(directions) {
                    let direction = &direction.wires();
                    let lit =
                        on_words!(p, |surface, gloss, direction| datapath::highlight(surface, gloss, direction, p));
                    add(light, lit.f);
                }
            }
            Lobes::Printed(exponent) => {
                for (light, direction) in self.lights.iter().zip(directions) {
                    add(light, printed::light(surface, input, direction, *exponent));
                }
            }
            Lobes::Given(peaks) => {
                for (light, direction) in self.lights.iter().zip(directions) {
                    let direction = &direction.wires();
                    let lit = on_words!(p, |surface, direction| datapath::peak_light(surface, direction, p));
                    if !lit.side.below {
                        add(light, read.given(&lit.direction, peaks, reading, p));
                    }
                }
            }
            Lobes::Map(map) => {
                taps = read.read(map, spot, p);
                let eye = (!map.horizons.is_empty()).then(|| {
                    on_words!(p, |surface| {
                        let eye = datapath::local_components(&surface.view, &surface.frame, &surface.normal, p);
                        datapath::horizon_slopes(&eye, p)
                    })
                });
                for (light, direction) in self.lights.iter().zip(directions) {
                    let direction = &direction.wires();
                    let lit = on_words!(p, |surface, direction| datapath::peak_light(surface, direction, p));
                    if lit.side.below {
                        continue;
                    }
                    if let Some(eye) = &eye {
                        let local = &lit.light;
                        let slopes = &on_words!(p, |local| datapath::horizon_slopes(local, p));
                        let visible = |horizon| {
                            on_words!(p, |slopes, eye, horizon| {
                                Value(datapath::horizon(slopes, eye, horizon, map.kind, p))
                            })
                            .0
                        };
                        read.peaks.weigh(read.horizons.iter().map(visible));
                    }
                    read.light(&lit.direction, reading, p);
                    add(light, read.taps.mean(&read.sums));
                }
            }
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
