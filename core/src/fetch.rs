//! Backends that address a memory, for one fragment or for several in lanes. Each fragment has its own address and its own probe count.

use core::cell::Cell;

use crate::each::each;
use crate::fx::{Fx, Int};
use crate::staged::Staged;
use crate::width::{IntegerCount, IntegerWord};
use crate::word::Wire;

/// A word whose backend finds texels.
pub trait Fetch: Staged {
    /// Largest count of a fragment: the number of turns of a loop over the probes of all fragments.
    fn max_over_lanes(count: Int<Self>) -> i32;

    /// Place of turn `turn` in a fragment's own loop of `count` turns, and whether the fragment has such a turn. A fragment that is done repeats its
    /// last place, which must not count.
    fn loop_index(turn: i32, count: Int<Self>) -> (Int<Self>, Self::Flag);

    /// Returns true if the flag is set for any fragment.
    fn any(flag: Self::Flag) -> bool;

    /// Result of `read` at the address of each fragment.
    fn per_lane<const IN: usize, const OUT: usize>(
        address: [Self::Count; IN],
        read: impl Fn([i32; IN]) -> [i32; OUT] + Copy,
    ) -> [Self::Count; OUT];

    /// The 64-bit word at a place of a memory and the next one: lower half, upper half, and those of the next word. The memory has at least two
    /// words; beyond its end the last two are read.
    fn load_pair(place: Int<Self>, memory: &[u64]) -> [Int<Self>; 4];

    /// Entry of a 16-entry table for every fragment, by the lowest four bits of the index.
    fn entry(index: Int<Self>, table: &[i32; 16]) -> Int<Self>;

    /// Scatters a word of every fragment into a row. Neighbouring fragments have neighbouring places. Words beyond the row are lost.
    fn scatter(word: Int<Self>, place: Int<Self>, row: &[Cell<i32>]);

    /// Gathers the words of a row at the places of all fragments, as [`Self::scatter`] scattered them; 0 beyond the row.
    fn gather(place: Int<Self>, row: &[Cell<i32>]) -> Int<Self>;

    /// Flag of a decision that is known beforehand.
    #[inline(always)]
    fn known(flag: bool) -> Self::Flag {
        Self::Count::lit(0).lt(Self::Count::lit(i64::from(flag)))
    }
}

impl<W: IntegerWord> Fetch for W {
    #[inline(always)]
    fn max_over_lanes(count: Int<Self>) -> i32 {
        count.raw().integer()
    }

    #[inline(always)]
    fn loop_index(turn: i32, _: Int<Self>) -> (Int<Self>, bool) {
        (Fx::from_raw(W::Count::of_integer(turn)), true)
    }

    #[inline(always)]
    fn any(flag: bool) -> bool {
        flag
    }

    #[inline(always)]
    fn per_lane<const IN: usize, const OUT: usize>(
        address: [W::Count; IN],
        read: impl Fn([i32; IN]) -> [i32; OUT] + Copy,
    ) -> [W::Count; OUT] {
        each!(texel in read(each!(word in address => word.integer())) => W::Count::of_integer(texel))
    }

    #[inline(always)]
    fn load_pair(place: Int<Self>, memory: &[u64]) -> [Int<Self>; 4] {
        if memory.len() < 2 {
            return [Fx::zero(); 4];
        }
        let [first, second] = two(memory, place.raw().integer());
        let halves = [first, first >> 32, second, second >> 32];
        each!(half in halves => Fx::from_raw(W::Count::of_integer(half as i32)))
    }

    #[inline(always)]
    fn entry(index: Int<Self>, table: &[i32; 16]) -> Int<Self> {
        Fx::from_raw(W::Count::of_integer(table[(index.raw().integer() & 15) as usize]))
    }

    #[inline(always)]
    fn scatter(word: Int<Self>, place: Int<Self>, row: &[Cell<i32>]) {
        if let Some(cell) = row.get(place.raw().integer() as u32 as usize) {
            cell.set(word.raw().integer());
        }
    }

    #[inline(always)]
    fn gather(place: Int<Self>, row: &[Cell<i32>]) -> Int<Self> {
        Fx::from_raw(W::Count::of_integer(row.get(place.raw().integer() as u32 as usize).map_or(0, Cell::get)))
    }

    #[inline(always)]
    fn known(flag: bool) -> bool {
        flag
    }
}

/// Two neighbouring words of a memory that has at least two; beyond its end the last two. The place is clamped without a branch, so both words are
/// one load.
#[inline(always)]
pub fn two(memory: &[u64], place: i32) -> [u64; 2] {
    let place = (place as u32 as usize).min(memory.len() - 2);
    [memory[place], memory[place + 1]]
}

/// One integer for every fragment.
#[inline(always)]
pub(crate) fn int<W: Wire>(integer: i32) -> Int<W> {
    Fx::int(i64::from(integer))
}
