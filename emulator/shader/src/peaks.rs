//! Peaks of maps as a memory holds them, and the peaks that fragments read.

use std::cell::Cell;

use roughxel_core::each::each;
use roughxel_core::fx::{Fx, Int};
use roughxel_core::plan::HorizonKind;
use roughxel_core::ports::{Horizon, Peak};

use crate::batch::GROUP;
use crate::texels::{WrappedMap, wide};

/// Number of words of a [`PackedPeak`].
pub(crate) const WORDS: usize = 3;

/// A peak as a memory holds it: its five 16-bit numbers in three words.
#[derive(Clone, Copy, Debug)]
pub struct PackedPeak(pub(crate) [i32; WORDS]);

impl From<&Peak<i32>> for PackedPeak {
    /// Range: the range of [`StoredPeak`](roughxel_core::ports::StoredPeak).
    fn from(peak: &Peak<i32>) -> Self {
        let pair = |low: i32, high: i32| low & 0xffff | high << 16;
        let [x, y, z] = peak.normal.map(Fx::raw);
        Self([pair(x, y), pair(z, peak.amplitude.raw()), peak.exponent.raw()])
    }
}

impl PackedPeak {
    /// Words of the peak.
    pub fn words(&self) -> [Int<i32>; WORDS] {
        self.0.map(Fx::from_raw)
    }
}

/// Peaks of every texel of a wrapped map.
#[derive(Clone, Debug)]
pub struct PeakTexels {
    /// Levels of the map.
    pub map: WrappedMap,
    /// Index of the first peak of each texel, over all levels, the finest first; then the end of the last. No texel has more than [`MOST_PEAKS`].
    pub begins: Vec<u32>,
    /// Peaks of all texels: the words of each, and a 0.
    pub(crate) peaks: Vec<[u64; 2]>,
    /// Horizons, one for each peak, or none: least slopes, then the inverse widths.
    pub(crate) horizons: Vec<[u64; 4]>,
    /// Rule that joins horizons.
    pub kind: HorizonKind,
}

impl PeakTexels {
    /// Packs the peaks of the texels of one map; horizons are optional.
    ///
    /// # Panics
    /// If there are other numbers of peaks or horizons, or a texel has more than [`MOST_PEAKS`].
    pub fn new(
        map: WrappedMap,
        begins: Vec<u32>,
        peaks: impl Iterator<Item = PackedPeak>,
        (horizons, kind): (impl Iterator<Item = Horizon<i32>>, HorizonKind),
    ) -> Self {
        let peaks: Vec<_> = peaks.map(|PackedPeak([a, b, c])| [wide([a, b]), wide([c, 0])]).collect();
        let horizon = |Horizon { low, inverse_width }: Horizon<i32>| {
            let [[a, b, c, d], [e, f, g, h]] = [low.map(Fx::raw), inverse_width.map(Fx::raw)];
            [[a, b], [c, d], [e, f], [g, h]].map(wide)
        };
        let horizons: Vec<_> = horizons.map(horizon).collect();
        let of_texels = begins.is_sorted() && begins.windows(2).all(|of| of[1] - of[0] <= MOST_PEAKS as u32);
        assert!(of_texels && begins.last().is_some_and(|&end| end as usize == peaks.len()), "the peaks of all texels");
        assert!(horizons.is_empty() || horizons.len() == peaks.len(), "a horizon for each peak");
        Self { map, begins, peaks, horizons, kind }
    }

    /// Number of peaks of all texels.
    pub fn count(&self) -> usize {
        self.peaks.len()
    }

    /// Returns true if peaks have horizons.
    pub fn has_horizons(&self) -> bool {
        !self.horizons.is_empty()
    }

    /// A copy without horizons.
    pub fn without_horizons(&self) -> Self {
        let Self { map, begins, peaks, kind, .. } = self;
        Self { map: map.clone(), begins: begins.clone(), peaks: peaks.clone(), horizons: Vec::new(), kind: *kind }
    }
}

/// Maximum number of peaks of a texel.
pub const MOST_PEAKS: usize = 8;

/// Maximum number of patches that a fragment reads: two levels for each probe.
const PATCHES: usize = 32;

/// Slot of a patch of a fragment.
pub(crate) fn slot(turn: i32, level: i32) -> i32 {
    2 * turn + level
}

/// Patches of a batch of fragments. Each slot has four rows, with a word for every fragment: the texels of its patch, or the places of their sums.
#[derive(Clone, Copy)]
pub(crate) struct Patches<'a> {
    cells: &'a [Cell<i32>],
    /// Number of fragments for which there is room.
    fragments: usize,
}

impl<'a> Patches<'a> {
    /// Number of words for `fragments` fragments.
    pub(crate) const fn words(fragments: usize) -> usize {
        4 * PATCHES * fragments
    }

    pub(crate) fn from_words(words: &'a mut [i32]) -> Self {
        let fragments = words.len() / Self::words(1);
        Self { cells: Cell::from_mut(words).as_slice_of_cells(), fragments }
    }

    /// Rows of a [`slot`].
    #[inline(always)]
    pub(crate) fn rows(&self, slot: i32) -> [&'a [Cell<i32>]; 4] {
        each!(texel in [0, 1, 2, 3] => &self.cells[(4 * slot as usize + texel) * self.fragments..][..self.fragments])
    }
}

/// Pairs of a fragment and a peak that it reads, by fragment.
#[derive(Clone, Debug, Default)]
pub(crate) struct PeakPairs {
    /// Fragment of each pair, the last one repeated to fill a lane group.
    pub(crate) fragments: Vec<i32>,
    /// Peak of each pair in its map, and any peak to fill a lane group.
    pub(crate) peaks: Vec<i32>,
    len: usize,
}

impl PeakPairs {
    /// Number of pairs.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Makes room for `pairs` pairs and a whole lane group.
    pub(crate) fn reserve(&mut self, pairs: usize) {
        let room = (pairs + MOST_PEAKS).next_multiple_of(GROUP) + GROUP;
        if self.peaks.len() < room {
            self.peaks.resize(room, 0);
            self.fragments.resize(room, 0);
        }
    }

    /// Sets the number of pairs.
    pub(crate) fn end(&mut self, len: usize) {
        self.len = len;
        let last = len.checked_sub(1).map_or(0, |last| self.fragments[last]);
        self.fragments[len..len.next_multiple_of(GROUP)].fill(last);
    }
}
