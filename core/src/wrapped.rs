//! Sampling of a wrapped map: from the probes of a footprint to the contents of the map. Frames fetch colours, bumps and the places of peaks with it.

use core::mem::ManuallyDrop;

use crate::datapath::texel::Quad;
use crate::datapath::{texel, texture_probe};
use crate::each::each;
use crate::fetch::{Fetch, int};
use crate::fx::{Control, Fx, Int};
use crate::ports::SHARE;
use crate::precision::Precision;
use crate::signals::{TexturePosition, WrappedFootprint};
use crate::stage::filter::{LEVEL_WEIGHT, LevelPair, ProbeSum, WEIGHT};
use crate::stage::texture::TextureScale;
use crate::word::Word;

/// A level of a wrapped map in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Level {
    /// Columns and rows, 1…16384.
    pub size: [i32; 2],
    /// Places from one row to the next.
    pub stride: i32,
    /// Number of places of the levels before it.
    pub start: i32,
}

/// View of a fragment into a wrapped map.
#[derive(Clone, Copy, Debug)]
pub struct View<'a, W: Word> {
    /// Centre of the footprint.
    pub centre: &'a TexturePosition<W>,
    /// Footprint around the centre, with the scale of the map. Without one there is a single probe, on the finest level.
    pub footprint: Option<(&'a WrappedFootprint<W>, &'a TextureScale<W>)>,
    /// Levels of the map, the finest first, at least one; texels are in rows.
    pub levels: &'a [Level],
    /// True if the lost detail of a level is stored as roughness. The footprint then reads finer levels, as that of a rough reflection does.
    pub rough: bool,
}

/// Four neighbouring texels on one level, for a bilinear sample.
#[derive(Clone, Copy, Debug)]
pub struct Neighbours<W: Word> {
    /// Places of the texels in all levels: (0,0), (1,0), (0,1), (1,1).
    pub texels: [Int<W>; 4],
    /// Weights of the right and of the lower texels, [0, 1).
    pub weight: [Control<W, WEIGHT>; 2],
}

/// Read of one probe.
#[derive(Clone, Copy, Debug)]
pub struct Read<W: Word> {
    /// Number of the probe, from 0.
    pub turn: i32,
    /// True if it is one of the fragment's own probes.
    pub counts: W::Flag,
    /// Weight of the probe, 0 if it does not count; the weights of a footprint sum to 1.
    pub weight: Control<W, SHARE>,
    /// Neighbours on the finer level.
    pub fine: Neighbours<W>,
    /// Neighbours on the coarser level, unless its weight is 0 for all fragments.
    pub coarse: Option<Neighbours<W>>,
    /// Weight of the coarser level.
    pub level_weight: Control<W, LEVEL_WEIGHT>,
}

/// Hands the read of each probe of a fragment to `take`, in the order of the probes.
#[inline(always)]
pub fn reads<W: Fetch>(view: &View<'_, W>, p: &Precision, take: impl FnMut(Read<W>)) {
    // As in `each`.
    let mut take = ManuallyDrop::new(take);
    let Some((WrappedFootprint { probes, .. }, scale)) = view.footprint else {
        let (fine, level_weight) = (point::<W>(view, p), Fx::zero());
        return take(Read { turn: 0, counts: W::known(true), weight: Fx::int(1), fine, coarse: None, level_weight });
    };
    let LevelPair { level, weight: level_weight } = texel::levels::<W>(probes.lod, W::known(view.rough), p);
    let fine = level_of::<W>(level, view.levels);
    let coarse = W::any(!level_weight.is_zero()).then(
        #[inline(always)]
        || level_of::<W>(level + Fx::int(1), view.levels),
    );
    for turn in 0..W::max_over_lanes(probes.count) {
        let (index, counts) = W::loop_index(turn, probes.count);
        let probe = texture_probe(view.centre, probes, index, scale, p);
        let weight = Fx::select(counts, probe.weight, Fx::zero());
        let fine = neighbours::<W>(&probe.place, fine, p);
        let coarse = match coarse {
            Some(level) => Some(neighbours::<W>(&probe.place, level, p)),
            None => None,
        };
        take(Read { turn, counts, weight, fine, coarse, level_weight });
    }
}

/// Mean of a map over a footprint, and the bilinear samples read for it.
#[derive(Clone, Copy, Debug)]
pub struct Mean<W: Word, const CHANNELS: usize> {
    /// The mean of each channel.
    pub channels: [Int<W>; CHANNELS],
    /// Number of bilinear samples.
    pub samples: Int<W>,
}

/// Averages channels of texels over the probes. `quad` reads the neighbours, given the turn of their probe and 0 for the finer level or 1 for the
/// coarser. `filter` interpolates them. `probe` turns the result into the averaged quantities.
#[inline(always)]
pub fn mean<W: Fetch, const CHANNELS: usize>(
    view: &View<'_, W>,
    quad: impl Fn(&Neighbours<W>, [i32; 2]) -> Quad<W, CHANNELS> + Copy,
    filter: impl Fn(&Quad<W, CHANNELS>, Option<&Quad<W, CHANNELS>>, Control<W, LEVEL_WEIGHT>) -> [Int<W>; CHANNELS] + Copy,
    probe: impl Fn([Int<W>; CHANNELS]) -> [Int<W>; CHANNELS] + Copy,
    p: &Precision,
) -> Mean<W, CHANNELS> {
    if view.footprint.is_none() {
        // The mean of one sample of one level is the sample.
        let sample = filter(&quad(&point::<W>(view, p), [0, 0]), None, Fx::zero());
        return Mean { channels: probe(sample), samples: Fx::int(1) };
    }
    let mut sums = [ProbeSum::<W>::zero(); CHANNELS];
    let mut samples = Fx::zero();
    reads(
        view,
        p,
        #[inline(always)]
        |read: Read<W>| {
            let fine = quad(&read.fine, [read.turn, 0]);
            let coarse = read.coarse.as_ref().map(
                #[inline(always)]
                |neighbours| quad(neighbours, [read.turn, 1]),
            );
            let sample = probe(filter(&fine, coarse.as_ref(), read.level_weight));
            sums = texel::probe_sums(&sums, &sample, read.weight);
            let levels = Fx::select(read.level_weight.is_zero(), Fx::int(1), Fx::int(2));
            samples = samples + Fx::select(read.counts, levels, Fx::zero());
        },
    );
    Mean { channels: texel::probe_means(&sums), samples }
}

/// Columns, rows, stride and start of a level.
type Place<W> = [Int<W>; 4];

/// Neighbours without a footprint: the centre, on the finest level.
#[inline(always)]
fn point<W: Fetch>(view: &View<'_, W>, p: &Precision) -> Neighbours<W> {
    let Level { size: [width, height], stride, start } = view.levels[0];
    neighbours::<W>(view.centre, each!(number in [width, height, stride, start] => int::<W>(number)), p)
}

/// Level of every fragment; beyond the last level it is the last.
#[inline(always)]
fn level_of<W: Fetch>(level: Int<W>, levels: &[Level]) -> Place<W> {
    let last = levels.len() - 1;
    let read = W::per_lane(
        [level.raw()],
        #[inline(always)]
        |[level]| {
            let Level { size: [width, height], stride, start } = levels[(level as usize).min(last)];
            [width, height, stride, start]
        },
    );
    each!(number in read => Fx::from_raw(number))
}

/// Neighbours for a bilinear sample on a level.
#[inline(always)]
fn neighbours<W: Fetch>(
    place: &TexturePosition<W>,
    [width, height, stride, start]: Place<W>,
    p: &Precision,
) -> Neighbours<W> {
    let address = texel::repeat_address(place, [width, height], p);
    let [x0, x1] = address.columns;
    let [y0, y1] = each!(row in address.rows => start + Fx::from_raw(W::Count::narrow(row.raw().mul(stride.raw()))));
    Neighbours { texels: [y0 + x0, y0 + x1, y1 + x0, y1 + x1], weight: address.weight }
}
