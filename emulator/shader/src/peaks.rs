//! Peaks of maps as a memory holds them, and which of them fragments read.

use std::cell::Cell;

use roughxel_core::each::each;
use roughxel_core::fx::{Fx, Int};
use roughxel_core::plan::HorizonKind;
use roughxel_core::ports::{Horizon, Peak};

use crate::batch::GROUP;
use crate::texels::{RepeatedMap, wide};

/// Words of a [`PackedPeak`].
pub(crate) const WORDS: usize = 3;

/// A peak as a memory holds it: its five numbers of 16 bits in three words.
#[derive(Clone, Copy, Debug)]
pub struct PackedPeak(pub(crate) [i32; WORDS]);

impl From<&Peak<i32>> for PackedPeak {
    /// Range: what [`StoredPeak`](roughxel_core::ports::StoredPeak) holds.
    fn from(peak: &Peak<i32>) -> Self {
        let pair = |low: i32, high: i32| low & 0xffff | high << 16;
        let [x, y, z] = peak.normal.map(Fx::raw);
        Self([pair(x, y), pair(z, peak.amplitude.raw()), peak.exponent.raw()])
    }
}

impl PackedPeak {
    /// Its words.
    pub fn words(&self) -> [Int<i32>; WORDS] {
        self.0.map(Fx::from_raw)
    }
}

/// The peaks of every texel of a repeated map.
#[derive(Clone, Debug)]
pub struct PeakTexels {
    /// Its levels.
    pub map: RepeatedMap,
    /// Where the peaks of each texel begin, of all levels, the finest first; and where the last end. No texel has more than [`MOST_PEAKS`].
    pub begins: Vec<u32>,
    /// Of all texels: the words of each, and a 0.
    pub(crate) peaks: Vec<[u64; 2]>,
    /// As many as peaks, or none: the beginnings of each, then what its widths are the reciprocals of.
    pub(crate) horizons: Vec<[u64; 4]>,
    /// How horizons are joined.
    pub kind: HorizonKind,
}

impl PeakTexels {
    /// Of a map's texels; a horizon for each peak, or none.
    ///
    /// # Panics
    /// If there are other numbers of them, or a texel has more than [`MOST_PEAKS`].
    pub fn new(
        map: RepeatedMap,
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

    /// Peaks of all texels.
    pub fn count(&self) -> usize {
        self.peaks.len()
    }

    /// Whether peaks have horizons.
    pub fn has_horizons(&self) -> bool {
        !self.horizons.is_empty()
    }

    /// The same without horizons.
    pub fn without_horizons(self) -> Self {
        Self { horizons: Vec::new(), ..self }
    }
}

/// Peaks of a texel, at most.
pub const MOST_PEAKS: usize = 8;

/// Patches that a fragment reads, at most: of two levels for each probe.
const PATCHES: usize = 32;

/// The slot of a patch of a fragment.
pub(crate) fn slot(turn: i32, level: i32) -> i32 {
    2 * turn + level
}

/// The patches of a batch of fragments: of each slot four rows, with a word of every fragment, which are the texels of its patch or the places of what stands
/// for them.
#[derive(Clone, Copy)]
pub(crate) struct Patches<'a> {
    cells: &'a [Cell<i32>],
    /// As many as there is room for.
    fragments: usize,
}

impl<'a> Patches<'a> {
    /// Words for so many fragments.
    pub(crate) const fn words(fragments: usize) -> usize {
        4 * PATCHES * fragments
    }

    pub(crate) fn of(words: &'a mut [i32]) -> Self {
        let fragments = words.len() / Self::words(1);
        Self { cells: Cell::from_mut(words).as_slice_of_cells(), fragments }
    }

    /// The rows of a [`slot`].
    #[inline(always)]
    pub(crate) fn rows(&self, slot: i32) -> [&'a [Cell<i32>]; 4] {
        each!(texel in [0, 1, 2, 3] => &self.cells[(4 * slot as usize + texel) * self.fragments..][..self.fragments])
    }
}

/// Fragments with peaks that they read, by fragment.
#[derive(Clone, Debug, Default)]
pub(crate) struct PeakPairs {
    /// The fragment of each, the last one again up to a whole group of lanes.
    pub(crate) fragments: Vec<i32>,
    /// The peak of each in its map, and any up to a whole group of lanes.
    pub(crate) peaks: Vec<i32>,
    len: usize,
}

impl PeakPairs {
    /// Number of fragments.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Room for so many and a whole group of lanes.
    pub(crate) fn reserve(&mut self, pairs: usize) {
        let room = (pairs + MOST_PEAKS).next_multiple_of(GROUP) + GROUP;
        if self.peaks.len() < room {
            self.peaks.resize(room, 0);
            self.fragments.resize(room, 0);
        }
    }

    /// That there are so many.
    pub(crate) fn end(&mut self, len: usize) {
        self.len = len;
        let last = len.checked_sub(1).map_or(0, |last| self.fragments[last]);
        self.fragments[len..len.next_multiple_of(GROUP)].fill(last);
    }
}
