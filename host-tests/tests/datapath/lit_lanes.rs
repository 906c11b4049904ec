//! Lights in lanes give the bits of the datapath of one fragment: highlights, given peaks, and the peaks of a map, which are read once for all
//! probes that share them.

use rayon::prelude::*;
use roughxel_cases::random_fragment;
use roughxel_core::bundle::Value;
use roughxel_core::datapath::{self, Surface, texel};
use roughxel_core::fetch::Fetch;
use roughxel_core::fx::{Control, Fx};
use roughxel_core::plan::{FrameSystem, HorizonKind, SurfacePlan};
use roughxel_core::ports::{Horizon, LIGHT, Port, PortBlock, StoredHorizon};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::setup::shininess;
use roughxel_core::signals::{LocalDirection, PeakSum, TexturePosition, WrappedFootprint};
use roughxel_core::width::on_words;
use roughxel_core::wrapped::{self, Neighbours, View};
use roughxel_shader::{
    Batch, GivenPeaks, Halves, Highlights, HorizonSlopes, LightOnPeaks, Lit, MOST_PEAKS, PackedPeak, PeakTexels,
    PeaksRead, Places, Ports, ShadedColour, Shader, Slopes, Surfaces, WrappedMap,
};
use roughxel_simd::{Backend, InstructionSet};
use roughxel_utilities::random::SplitMix64;

use super::lanes::{AnyBits, made_by_all, profiles, random_views, same_columns, stored_peak};

/// Returns random surfaces, with the direction from each to a light.
fn lit_surfaces(
    (name, index): (&str, u64),
    count: usize,
    plan: &SurfacePlan,
    p: &Precision,
) -> (Batch<Surface<i32>>, Batch<PortBlock<i32, 3>>) {
    let fragments =
        |from: u64| (0..count as u64).map(move |i| random_fragment(name, from + 1000 * index + i, p).wires());
    let ports = Ports::from_iter(fragments(0));
    let mut surfaces = Batch::default();
    let scalar = Shader::new(Backend::Scalar, p);
    Surfaces::new(scalar, &ports.bare, &ports.bumps, plan).run(scalar, &mut surfaces);
    (surfaces, fragments(500).map(|other| other.surface.view).collect())
}

const PLAN: SurfacePlan =
    SurfacePlan { bump: true, frame: FrameSystem::MainDirection, roughness: RoughnessKind::Anisotropic, local: true };

/// Light that a source of this colour adds for the share `returned`.
fn shown(returned: Control<i32, LIGHT>, colour: &[Control<i32, LIGHT>; 3]) -> ShadedColour<i32> {
    let channels = colour.map(|channel| datapath::pixel::modulated::<i32>(returned, channel));
    ShadedColour { channels, samples: Fx::from_raw(0) }
}

fn any_colour(random: &mut SplitMix64) -> [Control<i32, LIGHT>; 3] {
    [(); 3].map(|()| Fx::from_raw(random.below(64 << 24) as i32))
}

fn half(surface: &Surface<i32>, light: &PortBlock<i32, 3>, p: &Precision) -> LocalDirection<i32> {
    let lit = on_words!(p, |surface, light| datapath::peak_light(surface, light, p));
    LocalDirection { none: lit.direction.none || lit.side.below, ..lit.direction }
}

fn slopes(surface: &Surface<i32>, light: &PortBlock<i32, 3>, p: &Precision) -> Slopes<i32> {
    let lit = on_words!(p, |surface, light| datapath::peak_light(surface, light, p)).light;
    let eye = on_words!(p, |surface| datapath::local_components(&surface.view, &surface.frame, &surface.normal, p));
    let [light, eye] = [&lit, &eye].map(|local| on_words!(p, |local| datapath::horizon_slopes(local, p)));
    Slopes { light, eye }
}

fn packed_light(
    peak: &PackedPeak,
    half: &LocalDirection<i32>,
    weight: Control<i32, 16>,
    p: &Precision,
) -> Control<i32, LIGHT> {
    let words = peak.words();
    on_words!(p, |half| Value(datapath::packed_peak(half, words, weight, p))).0
}

/// The sum of peaks, in their order.
fn sum(lights: impl Iterator<Item = Control<i32, LIGHT>>) -> Control<i32, LIGHT> {
    let none = PeakSum::<i32> { light: Fx::from_raw(0), saturated: false };
    lights.fold(none, |sum, light| datapath::peak_sum(&sum, light)).light
}

#[test]
fn highlights_and_given_peaks_in_lanes_are_those_of_one_fragment() {
    for (name, p) in profiles() {
        (0..100_u64).into_par_iter().for_each(|index| {
            let mut bits = AnyBits(SplitMix64::for_element(name, index));
            let roughness = [RoughnessKind::None, RoughnessKind::Isotropic, RoughnessKind::Anisotropic];
            let plan = SurfacePlan { roughness: roughness[index as usize % 3], ..PLAN };
            let count = 1 + index as usize % 70;
            let (surfaces, lights) = lit_surfaces((name, index), count, &plan, &p);
            let lit = || surfaces.iter().zip(lights.iter());
            let colour = any_colour(&mut bits.0);
            let shininess = &shininess(1.0 + bits.0.below(8192) as f64).wires();
            let given: Vec<PackedPeak> = (0..index % 9).map(|_| PackedPeak::from(&stored_peak(&mut bits))).collect();

            let highlights = Batch::from_iter(lit().map(|(surface, light)| {
                let (surface, light) = (&surface, &light);
                let f = on_words!(&p, |surface, light, shininess| {
                    let gloss = datapath::gloss(surface, shininess, &plan, &p);
                    datapath::highlight(surface, &gloss, light, &p)
                });
                shown(f.f, &colour)
            }));
            let halves = Batch::from_iter(lit().map(|(surface, light)| half(&surface, &light, &p)));
            let peaks = Batch::from_iter(halves.iter().map(|half| {
                let light = given.iter().map(|peak| packed_light(peak, &half, Fx::int(1), &p));
                shown(sum(light), &colour)
            }));
            let slopes = Batch::from_iter(lit().map(|(surface, light)| slopes(&surface, &light, &p)));
            let lit = Lit { surfaces: &surfaces, directions: &lights };
            let context = |what: &'static str| move || format!("{name} {index}, {what}");
            let pass = Highlights { lit, shininess, plan: &plan, colour: &colour };
            made_by_all(&highlights, &p, &context("highlights"), |shader, got| pass.run(shader, got));
            made_by_all(&halves, &p, &context("halves"), |shader, got| Halves(lit).run(shader, got));
            made_by_all(&slopes, &p, &context("slopes"), |shader, got| HorizonSlopes(lit).run(shader, got));
            let pass = GivenPeaks { halves: &halves, peaks: &given, colour: &colour };
            made_by_all(&peaks, &p, &context("given peaks"), |shader, got| pass.run(shader, got));
        });
    }
}

/// Peaks of a map, and their source.
struct RandomPeaks {
    texels: PeakTexels,
    peaks: Vec<PackedPeak>,
    /// One for each peak, or none.
    horizons: Vec<Horizon<i32>>,
}

/// Up to seven peaks in every texel. In a third of the maps few texels have peaks, so that a lane group holds fragments that are far apart. Half of
/// the maps have horizons.
fn random_peaks(map: WrappedMap, index: u64, bits: &mut AnyBits) -> RandomPeaks {
    let texels: i32 = map.levels.iter().map(|level| level.size[0] * level.size[1]).sum();
    let ends = (0..texels).scan(0, |end, _| {
        let is_empty = index.is_multiple_of(3) && bits.0.below(16) > 0;
        *end += if is_empty { 0 } else { bits.0.below(MOST_PEAKS as u64) as u32 };
        Some(*end)
    });
    let begins: Vec<u32> = std::iter::once(0).chain(ends).collect();
    let count = begins.last().map_or(0, |&end| end);
    let kind =
        [HorizonKind::None, HorizonKind::Correlated, HorizonKind::None, HorizonKind::Product][index as usize % 4];
    let horizon = |random: &mut SplitMix64| -> Horizon<i32> {
        let mut code = || random.next_u64() as u16;
        let low = [(); 4].map(|()| fixed::types::I4F12::from_bits(code() as i16));
        StoredHorizon { low, inverse_width: [(); 4].map(|()| code() >> (code() % 16)) }.wires()
    };
    let peaks: Vec<_> = (0..count).map(|_| PackedPeak::from(&stored_peak(bits))).collect();
    let horizons = if kind == HorizonKind::None { 0 } else { count };
    let horizons: Vec<_> = (0..horizons).map(|_| horizon(&mut bits.0)).collect();
    let texels = PeakTexels::new(map, begins, peaks.iter().copied(), (horizons.iter().copied(), kind));
    RandomPeaks { texels, peaks, horizons }
}

/// The light of a texel, peak by peak.
fn texel_light(texel: i32, of: &RandomPeaks, half: &LocalDirection<i32>, slopes: &Slopes<i32>, p: &Precision) -> i32 {
    let map = &of.texels;
    let [begin, end] = [0, 1].map(|next| map.begins[texel as usize + next] as usize);
    let light = |index: usize| {
        let weight = of.horizons.get(index).map_or(Fx::int(1), |horizon| {
            let Slopes { light, eye } = slopes;
            on_words!(p, |light, eye, horizon| Value(datapath::horizon(light, eye, horizon, map.kind, p))).0
        });
        packed_light(&of.peaks[index], half, weight, p)
    };
    sum((begin..end).map(light)).raw()
}

/// Mean value of the texels of a map over a fragment's footprint, and the number of bilinear samples read.
fn mean<W: Fetch>(view: &View<'_, W>, light: &dyn Fn(i32) -> i32, p: &Precision) -> ShadedColour<W> {
    let quad = |neighbours: &Neighbours<W>, _| {
        let texels =
            neighbours.texels.map(|texel| W::per_lane([texel.raw()], |[texel]| [light(texel)]).map(Fx::from_raw));
        texel::Quad { texels, weight: neighbours.weight }
    };
    let mean = wrapped::mean(view, quad, texel::word_samples::<W, 1>, |sample| sample, p);
    ShadedColour { channels: [mean.channels[0].reread(); 3], samples: mean.samples }
}

fn averaged(
    centre: &TexturePosition<i32>,
    probes: Option<&WrappedFootprint<i32>>,
    map: &PeakTexels,
    light: &dyn Fn(i32) -> i32,
    p: &Precision,
) -> ShadedColour<i32> {
    let (levels, texture) = (&map.map.levels[..], &map.map.scale.0);
    match probes {
        None => on_words!(p, |centre| mean(&View { centre, footprint: None, levels, rough: false }, light, p)),
        Some(probes) => on_words!(p, |centre, probes, texture| {
            mean(&View { centre, footprint: Some((probes, texture)), levels, rough: false }, light, p)
        }),
    }
}

#[test]
fn peaks_of_maps_in_lanes_are_those_of_each_texel() {
    for (name, p) in profiles() {
        (0..120_u64).into_par_iter().for_each(|index| {
            let mut bits = AnyBits(SplitMix64::for_element(name, index));
            let (map, centres, probes) = random_views(name, index, &p);
            let of = &random_peaks(map, index, &mut bits);
            let map = &of.texels;
            let (surfaces, lights) = lit_surfaces((name, index), centres.len(), &PLAN, &p);
            let colour = any_colour(&mut bits.0);
            for footprints in [None, Some(&probes)] {
                let places = Places { centres: &centres, footprints };
                let mut samples = 0;
                let expected = Batch::from_iter((0..centres.len()).map(|fragment| {
                    let (surface, light) = (surfaces.get(fragment), lights.get(fragment));
                    let (half, slopes) = (half(&surface, &light, &p), slopes(&surface, &light, &p));
                    let light = |texel| texel_light(texel, of, &half, &slopes, &p);
                    let probes = footprints.map(|probes| probes.get(fragment));
                    let mean = averaged(&centres.get(fragment), probes.as_ref(), map, &light, &p);
                    samples += mean.samples.raw() as u64;
                    shown(mean.channels[0], &colour)
                }));
                let (mut halves, mut slopes) = (Batch::default(), Batch::default());
                for backend in InstructionSet::available().map(Backend::Simd).chain([Backend::Scalar]) {
                    let (mut read, mut got) = (PeaksRead::default(), Batch::default());
                    let (shader, lit) = (Shader::new(backend, &p), Lit { surfaces: &surfaces, directions: &lights });
                    Halves(lit).run(shader, &mut halves);
                    HorizonSlopes(lit).run(shader, &mut slopes);
                    let slopes = map.has_horizons().then_some(&slopes);
                    let light = LightOnPeaks { map, places, halves: &halves, slopes, colour: &colour };
                    // Twice: data that a batch leaves in the memory of the next one changes nothing.
                    for turn in 0..2 {
                        let context = || format!("{name} {index}, {backend}, {footprints:?}, turn {turn}");
                        assert_eq!(read.read(map, places, shader), samples, "{}", context());
                        read.shine(&light, shader, &mut got);
                        same_columns(&expected, &got, &context);
                    }
                }
            }
        });
    }
}
