//! Lights on fragments side by side: highlights, and peaks that a material gives or a map stores.

use roughxel_core::bundle::{Value, bundle, never};
use roughxel_core::datapath::texel::Quad;
use roughxel_core::datapath::{self, Surface, pixel, texel};
use roughxel_core::each::each;
use roughxel_core::fetch::Fetch;
use roughxel_core::fx::{Control, Fx};
use roughxel_core::plan::SurfacePlan;
use roughxel_core::ports::{Horizon, LIGHT, PortBlock, SHARE, ShininessPort};
use roughxel_core::precision::Precision;
use roughxel_core::repeated::{self, Tap, View};
use roughxel_core::signals::{AxisSlope, LocalDirection, PeakSum};
use roughxel_core::width::on_words;
use roughxel_core::word::Wire;

use super::columns::Columns;
use super::peaks::{PackedPeak, Patches, PeakPairs, PeakTexels, slot};
use super::reading::{Places, Reading, Shown, each_fragment};
use super::texels::RepeatedMap;

bundle! {
    /// What the horizons of peaks have to do with: the slopes of a light and of the eye.
    pub struct Slopes<W> {
        /// Of the light, over both axes of the surface.
        light: [AxisSlope<W>; 2],
        /// Of the eye.
        eye: [AxisSlope<W>; 2],
    }
}

bundle! {
    /// Patches that a fragment reads of a map: of each level one for each turn.
    pub struct PatchesRead<W> {
        /// Its probes.
        #[range(1..=16)]
        turns: Int<W>,
        /// Levels that it reads.
        #[range(1..=2)]
        levels: Int<W>,
    }
}

/// The half vector in the frame of the surface; there is none where the light is below it.
#[inline(always)]
fn half_of<W: Fetch>(surface: &Surface<W>, light: &PortBlock<W, 3>, p: &Precision) -> LocalDirection<W> {
    let lit = datapath::peak_light(surface, light, p);
    LocalDirection { none: lit.direction.none | lit.side.below, ..lit.direction }
}

#[inline(always)]
fn slopes_of<W: Fetch>(surface: &Surface<W>, light: &PortBlock<W, 3>, p: &Precision) -> Slopes<W> {
    let light = datapath::peak_light(surface, light, p).light;
    let eye = datapath::local_components(&surface.view, &surface.frame, &surface.normal, p);
    let [light, eye] = each!(local in [light, eye] => datapath::horizon_slopes(&local, p));
    Slopes { light, eye }
}

/// What returned light adds to a pixel.
#[inline(always)]
fn shown_of<W: Fetch>(returned: Control<W, LIGHT>, colour: &[Value<W, LIGHT>; 3]) -> Shown<W> {
    let channels = each!(Value(channel) in *colour => pixel::modulated::<W>(returned, channel));
    Shown { channels, taps: Fx::zero() }
}

#[inline(always)]
fn highlight<W: Fetch>(
    surface: &Surface<W>,
    light: &PortBlock<W, 3>,
    shininess: &ShininessPort<W>,
    plan: &SurfacePlan,
    colour: &[Value<W, LIGHT>; 3],
    p: &Precision,
) -> Shown<W> {
    let gloss = datapath::gloss(surface, shininess, plan, p);
    shown_of(datapath::highlight(surface, &gloss, light, p).f, colour)
}

/// The light of a list of peaks.
#[inline(always)]
fn given<W: Fetch>(half: &LocalDirection<W>, peaks: &[PackedPeak], p: &Precision) -> Control<W, LIGHT> {
    let mut sum = PeakSum::<W> { light: Fx::zero(), saturated: never::<W>() };
    for peak in peaks {
        let words = each!(word in peak.0 => Fx::from_raw(W::Count::lit(word.into())));
        sum = datapath::peak_sum(&sum, datapath::packed_peak(half, words, Fx::int(1), p));
    }
    sum.light
}

/// The light of a peak of a map.
#[inline(always)]
fn stored<W: Fetch>(
    &Value(peak): &Value<W, 32>,
    half: &LocalDirection<W>,
    weight: Control<W, SHARE>,
    map: &PeakTexels,
    p: &Precision,
) -> Value<W, LIGHT> {
    let [xy, z_amplitude, exponent, _] = W::pair(peak.shl(1), map.peaks.as_flattened());
    Value(datapath::packed_peak(half, [xy, z_amplitude, exponent], weight, p))
}

/// The light of a peak of a map above its horizon.
#[inline(always)]
fn above_horizon<W: Fetch>(
    &Value(peak): &Value<W, 32>,
    half: &LocalDirection<W>,
    slopes: &Slopes<W>,
    map: &PeakTexels,
    p: &Precision,
) -> Value<W, LIGHT> {
    let low = peak.shl(2);
    let [low, inverse_width] = each!(place in [low, low + Fx::int(2)] => W::pair(place, map.horizons.as_flattened()));
    let horizon = Horizon::<W> { low: each!(side in low => side.reread()), inverse_width };
    let weight = datapath::horizon(&slopes.light, &slopes.eye, &horizon, map.kind, p);
    stored(&Value(peak), half, weight, map, p)
}

/// Keeps the texels of all patches that a fragment reads.
#[inline(always)]
fn patches_of<W: Fetch>(
    view: &View<'_, W>,
    &Value(number): &Value<W, 32>,
    patches: &Patches<'_>,
    p: &Precision,
) -> PatchesRead<W> {
    let (mut turns, mut levels) = (Fx::zero(), Fx::int(1));
    repeated::reads(
        view,
        p,
        #[inline(always)]
        |read| {
            let keep = |tap: &Tap<W>, level| {
                for (texel, row) in tap.texels.into_iter().zip(patches.rows(slot(read.turn, level))) {
                    W::put(texel, number, row);
                }
            };
            keep(&read.fine, 0);
            if let Some(coarse) = &read.coarse {
                keep(coarse, 1);
            }
            turns = turns + Fx::select(read.counts, Fx::int(1), Fx::zero());
            levels = Fx::select(read.level_weight.is_zero(), Fx::int(1), Fx::int(2));
        },
    );
    PatchesRead { turns, levels }
}

/// The mean of what stands for the texels of a fragment's patches.
#[inline(always)]
fn mean_of<W: Fetch>(
    view: &View<'_, W>,
    &Value(number): &Value<W, 32>,
    (patches, sums): (&Patches<'_>, &[i32]),
    p: &Precision,
) -> Control<W, LIGHT> {
    let mean = repeated::mean(
        view,
        #[inline(always)]
        |tap: &Tap<W>, [turn, level]| {
            let texels = W::gather(
                each!(row in patches.rows(slot(turn, level)) => W::take(number, row).raw()),
                #[inline(always)]
                |places| {
                    // A patch of another turn or level, with the weight 0, may name any place.
                    each!(place in places => sums.get(place as u32 as usize).copied().unwrap_or(0))
                },
            );
            Quad { texels: each!(texel in texels => [Fx::from_raw(texel)]), weight: tap.weight }
        },
        texel::word_samples::<W, 1>,
        #[inline(always)]
        |sample| sample,
        p,
    );
    mean.channels[0].reread()
}

impl Reading {
    /// What every fragment shows of a light of this colour by its highlight; `directions` point to the light.
    pub fn highlights(
        self,
        (surfaces, directions): (&Columns<Surface<i32>>, &Columns<PortBlock<i32, 3>>),
        (shininess, plan): (&ShininessPort<i32>, &SurfacePlan),
        colour: &[Control<i32, LIGHT>; 3],
        p: &Precision,
        shown: &mut Columns<Shown<i32>>,
    ) {
        let colour = &colour.map(Value::<i32, _>);
        each_fragment!(
            self, p, (surfaces, directions), shown,
            |(surface, light), shininess, colour| highlight(surface, light, shininess, plan, colour, p),
            else on_words!(p, |surface, light, shininess, colour| {
                highlight(surface, light, shininess, plan, colour, p)
            })
        );
    }

    /// The half vector of a light for the peaks of every fragment, in the frame of its surface; `directions` point to the light. There is
    /// none where the light is below the surface.
    pub fn halves(
        self,
        (surfaces, directions): (&Columns<Surface<i32>>, &Columns<PortBlock<i32, 3>>),
        p: &Precision,
        halves: &mut Columns<LocalDirection<i32>>,
    ) {
        each_fragment!(
            self, p, (surfaces, directions), halves,
            |(surface, light)| half_of(surface, light, p),
            else on_words!(p, |surface, light| half_of(surface, light, p))
        );
    }

    /// The slopes of a light and of the eye for the horizons of every fragment; `directions` point to the light.
    pub fn slopes(
        self,
        (surfaces, directions): (&Columns<Surface<i32>>, &Columns<PortBlock<i32, 3>>),
        p: &Precision,
        slopes: &mut Columns<Slopes<i32>>,
    ) {
        each_fragment!(
            self, p, (surfaces, directions), slopes,
            |(surface, light)| slopes_of(surface, light, p),
            else on_words!(p, |surface, light| slopes_of(surface, light, p))
        );
    }

    /// What every fragment shows of a light of this colour by a list of peaks.
    pub fn given_peaks(
        self,
        halves: &Columns<LocalDirection<i32>>,
        peaks: &[PackedPeak],
        colour: &[Control<i32, LIGHT>; 3],
        p: &Precision,
        shown: &mut Columns<Shown<i32>>,
    ) {
        let colour = &colour.map(Value::<i32, _>);
        each_fragment!(
            self, p, halves, shown,
            |half, colour| shown_of(given(half, peaks, p), colour),
            else on_words!(p, |half, colour| shown_of(given(half, peaks, p), colour))
        );
    }

    /// The light of the peak of every pair; `slopes` are those of the fragments of a map with horizons.
    pub(super) fn peaks(
        self,
        pairs: &PeakPairs,
        (halves, slopes): (&Columns<LocalDirection<i32>>, Option<&Columns<Slopes<i32>>>),
        map: &PeakTexels,
        p: &Precision,
        lights: &mut Columns<Value<i32, LIGHT>>,
    ) {
        match slopes {
            None => each_fragment!(
                self, p, (pairs, halves), lights,
                |(peak, half)| stored(peak, half, Fx::int(1), map, p),
                else on_words!(p, |peak, half| stored(peak, half, Fx::int(1), map, p))
            ),
            Some(slopes) => each_fragment!(
                self, p, ((pairs, halves), (pairs, slopes)), lights,
                |((peak, half), (_, slopes))| above_horizon(peak, half, slopes, map, p),
                else on_words!(p, |peak, half, slopes| above_horizon(peak, half, slopes, map, p))
            ),
        }
    }

    /// Keeps the texels of all patches that fragments read of a map of peaks; `numbers` count them.
    pub(super) fn peak_patches(
        self,
        places: Places<'_>,
        map: &RepeatedMap,
        numbers: &Columns<Value<i32, 32>>,
        patches: &Patches<'_>,
        p: &Precision,
        read: &mut Columns<PatchesRead<i32>>,
    ) {
        let (levels, texture) = (&map.levels[..], &map.scale.0);
        match places.footprints {
            Some(footprints) => each_fragment!(
                self, p, ((places.centres, footprints), numbers), read,
                |((centre, footprint), number), texture| {
                    patches_of(&View { centre, footprint: Some((footprint, texture)), levels, rough: false }, number, patches, p)
                },
                else on_words!(p, |centre, footprint, number, texture| {
                    patches_of(&View { centre, footprint: Some((footprint, texture)), levels, rough: false }, number, patches, p)
                })
            ),
            None => each_fragment!(
                self, p, (places.centres, numbers), read,
                |(centre, number)| patches_of(&View { centre, footprint: None, levels, rough: false }, number, patches, p),
                else on_words!(p, |centre, number| {
                    patches_of(&View { centre, footprint: None, levels, rough: false }, number, patches, p)
                })
            ),
        }
    }

    /// What every fragment shows of a light of this colour by what `sums` says of the texels of its patches.
    pub(super) fn peak_means(
        self,
        (places, numbers): (Places<'_>, &Columns<Value<i32, 32>>),
        (map, patches, sums): (&RepeatedMap, &Patches<'_>, &[i32]),
        colour: &[Control<i32, LIGHT>; 3],
        p: &Precision,
        shown: &mut Columns<Shown<i32>>,
    ) {
        let colour = &colour.map(Value::<i32, _>);
        let (levels, texture, light) = (&map.levels[..], &map.scale.0, (patches, sums));
        match places.footprints {
            Some(footprints) => each_fragment!(
                self, p, ((places.centres, footprints), numbers), shown,
                |((centre, footprint), number), texture, colour| {
                    let view = View { centre, footprint: Some((footprint, texture)), levels, rough: false };
                    shown_of(mean_of(&view, number, light, p), colour)
                },
                else on_words!(p, |centre, footprint, number, texture, colour| {
                    let view = View { centre, footprint: Some((footprint, texture)), levels, rough: false };
                    shown_of(mean_of(&view, number, light, p), colour)
                })
            ),
            None => each_fragment!(
                self, p, (places.centres, numbers), shown,
                |(centre, number), colour| {
                    shown_of(mean_of(&View { centre, footprint: None, levels, rough: false }, number, light, p), colour)
                },
                else on_words!(p, |centre, number, colour| {
                    shown_of(mean_of(&View { centre, footprint: None, levels, rough: false }, number, light, p), colour)
                })
            ),
        }
    }
}
