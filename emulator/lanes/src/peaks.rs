//! Peaks of maps as a memory holds them, and which of them fragments read.

use std::cell::Cell;

use roughxel_core::fx::{Fx, Int};
use roughxel_core::plan::HorizonKind;
use roughxel_core::ports::{Horizon, Peak};

use super::columns::GROUP;
use super::texels::RepeatedMap;

/// Words of a [`PackedPeak`].
pub(super) const WORDS: usize = 3;

/// A peak as a memory holds it: its five numbers of 16 bits in three words.
#[derive(Clone, Copy, Debug)]
pub struct PackedPeak(pub(super) [i32; WORDS]);

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
    /// Of all texels.
    pub peaks: Vec<PackedPeak>,
    /// As many as peaks, or none.
    pub horizons: Vec<Horizon<i32>>,
    /// How horizons are joined.
    pub kind: HorizonKind,
}

/// Peaks of a texel, at most.
pub const MOST_PEAKS: usize = 8;

/// Patches that a fragment reads, at most: of two levels for each probe.
pub(super) const PATCHES: usize = 32;

/// The slot of a patch of a fragment.
pub(super) fn slot(turn: i32, level: i32) -> i32 {
    2 * turn + level
}

/// The patches of a batch of fragments, slot by slot: the texels of each, or the places of what stands for them.
#[derive(Clone, Copy)]
pub(super) struct Patches<'a> {
    cells: &'a [Cell<[i32; 4]>],
    /// As many as there is room for.
    fragments: usize,
}

impl<'a> Patches<'a> {
    pub(super) fn of(cells: &'a mut [[i32; 4]]) -> Self {
        let fragments = cells.len() / PATCHES;
        Self { cells: Cell::from_mut(cells).as_slice_of_cells(), fragments }
    }

    /// That of a fragment, in its [`slot`].
    #[inline(always)]
    pub(super) fn at(&self, fragment: i32, slot: i32) -> &'a Cell<[i32; 4]> {
        &self.cells[slot as usize * self.fragments + fragment as usize]
    }
}

/// Fragments with peaks that they read, by fragment.
#[derive(Clone, Debug, Default)]
pub(super) struct PeakPairs {
    /// The fragment of each, the last one again up to a whole group of lanes.
    pub(super) fragments: Vec<i32>,
    /// The peak of each in its map, and any up to a whole group of lanes.
    pub(super) peaks: Vec<i32>,
    len: usize,
}

impl PeakPairs {
    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Room for so many and a whole group of lanes.
    pub(super) fn reserve(&mut self, pairs: usize) {
        let room = (pairs + MOST_PEAKS).next_multiple_of(GROUP) + GROUP;
        if self.peaks.len() < room {
            self.peaks.resize(room, 0);
            self.fragments.resize(room, 0);
        }
    }

    /// That there are so many.
    pub(super) fn end(&mut self, len: usize) {
        self.len = len;
        let last = len.checked_sub(1).map_or(0, |last| self.fragments[last]);
        self.fragments[len..len.next_multiple_of(GROUP)].fill(last);
    }
}
