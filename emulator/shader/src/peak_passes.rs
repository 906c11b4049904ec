//! Passes over the peaks of a map: the texels that a fragment reads, the light of each peak, and the mean over a footprint.

use roughxel_core::bundle::{Value, bundle};
use roughxel_core::datapath::texel::Quad;
use roughxel_core::datapath::{self, texel};
use roughxel_core::each::each;
use roughxel_core::fetch::Fetch;
use roughxel_core::fx::{Control, Fx, Int};
use roughxel_core::ports::{Horizon, LIGHT, SHARE};
use roughxel_core::precision::Precision;
use roughxel_core::signals::LocalDirection;
use roughxel_core::wrapped::{self, Neighbours, View};
use roughxel_simd::BatchWord;

use crate::batch::Batch;
use crate::lights::shown_of;
use crate::maps::{Places, viewed};
use crate::pass::{Group, Pass};
use crate::peaks::{Patches, PeakPairs, PeakTexels, slot};
use crate::signals::{ShadedColour, Slopes};
use crate::texels::WrappedMap;

bundle! {
    /// Patches that a fragment reads of a map: one on each level for each turn.
    pub struct PatchesRead<W> {
        /// Number of probes.
        #[range(1..=16)]
        turns: Int<W>,
        /// Number of levels.
        #[range(1..=2)]
        levels: Int<W>,
    }
}

/// Keeps the texels of all patches that fragments read of a map of peaks.
pub(crate) struct PeakPatches<'a> {
    pub(crate) places: Places<'a>,
    pub(crate) map: &'a WrappedMap,
    /// Number of each fragment.
    pub(crate) numbers: &'a Batch<Value<i32, 32>>,
    pub(crate) patches: &'a Patches<'a>,
}

impl Pass for PeakPatches<'_> {
    type Output = PatchesRead<i32>;
    fn len(&self) -> usize {
        self.places.centres.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> PatchesRead<W> {
        let Value(number) = group.load(self.numbers);
        viewed(
            group,
            self.places,
            self.map,
            false,
            #[inline(always)]
            |view| patches_of(view, number, self.patches, p),
        )
    }
}

/// Light of the peak of every pair: horizon, peaks.
pub(crate) struct PeakLights<'a> {
    pub(crate) pairs: &'a PeakPairs,
    /// Half vectors of fragments.
    pub(crate) halves: &'a Batch<LocalDirection<i32>>,
    /// Slopes of fragments, for a map with horizons.
    pub(crate) slopes: Option<&'a Batch<Slopes<i32>>>,
    pub(crate) map: &'a PeakTexels,
}

impl Pass for PeakLights<'_> {
    type Output = Value<i32, LIGHT>;
    fn len(&self) -> usize {
        self.pairs.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> Value<W, LIGHT> {
        let Value(peak) = group.peaks(self.pairs);
        let half = group.of_pairs(self.pairs, self.halves);
        let weight = match self.slopes {
            Some(slopes) => above_horizon(peak, &group.of_pairs(self.pairs, slopes), self.map, p),
            None => Fx::int(1),
        };
        let [xy, z_amplitude, exponent, _] = W::load_pair(peak.shl(1), self.map.peaks.as_flattened());
        Value(datapath::packed_peak(&half, [xy, z_amplitude, exponent], weight, p))
    }
}

/// Colours returned by the peaks of a map, from the sums of texels: filter, pixel (modulated).
pub(crate) struct PeakMeans<'a> {
    pub(crate) places: Places<'a>,
    pub(crate) map: &'a WrappedMap,
    pub(crate) numbers: &'a Batch<Value<i32, 32>>,
    pub(crate) patches: &'a Patches<'a>,
    pub(crate) sums: &'a [i32],
    /// The colour of the light times that of the peaks.
    pub(crate) colour: &'a [Control<i32, LIGHT>; 3],
}

impl Pass for PeakMeans<'_> {
    type Output = ShadedColour<i32>;
    fn len(&self) -> usize {
        self.places.centres.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> ShadedColour<W> {
        let Value(number) = group.load(self.numbers);
        let returned = viewed(
            group,
            self.places,
            self.map,
            false,
            #[inline(always)]
            |view| mean_of(view, number, self.patches, self.sums, p),
        );
        shown_of(group, returned, self.colour)
    }
}

/// Share of a peak above its horizon.
#[inline(always)]
fn above_horizon<W: Fetch>(peak: Int<W>, slopes: &Slopes<W>, map: &PeakTexels, p: &Precision) -> Control<W, SHARE> {
    let low = peak.shl(2);
    let [low, inverse_width] =
        each!(place in [low, low + Fx::int(2)] => W::load_pair(place, map.horizons.as_flattened()));
    let horizon = Horizon::<W> { low: each!(side in low => side.reread()), inverse_width };
    datapath::horizon(&slopes.light, &slopes.eye, &horizon, map.kind, p)
}

/// Keeps the texels of all patches that a fragment reads.
#[inline(always)]
fn patches_of<W: Fetch>(view: &View<'_, W>, number: Int<W>, patches: &Patches<'_>, p: &Precision) -> PatchesRead<W> {
    let (mut turns, mut levels) = (Fx::zero(), Fx::int(1));
    wrapped::reads(
        view,
        p,
        #[inline(always)]
        |read| {
            let keep = |neighbours: &Neighbours<W>, level| {
                for (texel, row) in neighbours.texels.into_iter().zip(patches.rows(slot(read.turn, level))) {
                    W::scatter(texel, number, row);
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

/// Mean of the sums for the texels of a fragment's patches.
#[inline(always)]
fn mean_of<W: Fetch>(
    view: &View<'_, W>,
    number: Int<W>,
    patches: &Patches<'_>,
    sums: &[i32],
    p: &Precision,
) -> Control<W, LIGHT> {
    let mean = wrapped::mean(
        view,
        #[inline(always)]
        |neighbours: &Neighbours<W>, [turn, level]| {
            let texels = W::per_lane(
                each!(row in patches.rows(slot(turn, level)) => W::gather(number, row).raw()),
                #[inline(always)]
                |places| {
                    // A patch of another turn or level, with weight 0, may name any place.
                    each!(place in places => sums.get(place as u32 as usize).copied().unwrap_or(0))
                },
            );
            Quad { texels: each!(texel in texels => [Fx::from_raw(texel)]), weight: neighbours.weight }
        },
        texel::word_samples::<W, 1>,
        #[inline(always)]
        |sample| sample,
        p,
    );
    mean.channels[0].reread()
}
