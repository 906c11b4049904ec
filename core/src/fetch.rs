//! Readings that address a memory: of one fragment, or of several side by side, each with an address and a number of probes of its own.

use core::cell::Cell;

use crate::each::each;
use crate::fx::{Fx, Int};
use crate::staged::Staged;
use crate::width::{IntegerCount, IntegerWord};
use crate::word::Wire;

/// A word whose reading finds texels.
pub trait Fetch: Staged {
    /// The largest count of a fragment: so many turns a loop over the probes of all has.
    fn most(count: Int<Self>) -> i32;

    /// The place of turn `turn` in a fragment's own loop of `count` turns, and whether it has one: a fragment that is done repeats its last,
    /// which must not count.
    fn turn(turn: i32, count: Int<Self>) -> (Int<Self>, Self::Flag);

    /// Whether it is so of any fragment.
    fn any(flag: Self::Flag) -> bool;

    /// What `read` finds at the address of each fragment.
    fn gather<const IN: usize, const OUT: usize>(
        address: [Self::Count; IN],
        read: impl Fn([i32; IN]) -> [i32; OUT] + Copy,
    ) -> [Self::Count; OUT];

    /// What a memory of words of 64 bits holds at a place and behind it: lower half, upper half, and those of the next word. It has two words
    /// at least; beyond its end the last two are read.
    fn pair(place: Int<Self>, memory: &[u64]) -> [Int<Self>; 4];

    /// An entry of a table of every fragment, by the lowest four bits of the index.
    fn entry(index: Int<Self>, table: &[i32; 16]) -> Int<Self>;

    /// Puts a word of every fragment into a row, each at its place: fragments side by side have neighbouring ones. Beyond the row they are lost.
    fn put(word: Int<Self>, place: Int<Self>, row: &[Cell<i32>]);

    /// The words of a row at the places of all fragments, as [`Self::put`] put them; beyond the row 0.
    fn take(place: Int<Self>, row: &[Cell<i32>]) -> Int<Self>;

    /// A decision that is known before.
    #[inline(always)]
    fn known(flag: bool) -> Self::Flag {
        Self::Count::lit(0).lt(Self::Count::lit(i64::from(flag)))
    }
}

impl<W: IntegerWord> Fetch for W {
    #[inline(always)]
    fn most(count: Int<Self>) -> i32 {
        count.raw().integer()
    }

    #[inline(always)]
    fn turn(turn: i32, _: Int<Self>) -> (Int<Self>, bool) {
        (Fx::from_raw(W::Count::of_integer(turn)), true)
    }

    #[inline(always)]
    fn any(flag: bool) -> bool {
        flag
    }

    #[inline(always)]
    fn gather<const IN: usize, const OUT: usize>(
        address: [W::Count; IN],
        read: impl Fn([i32; IN]) -> [i32; OUT] + Copy,
    ) -> [W::Count; OUT] {
        each!(texel in read(each!(word in address => word.integer())) => W::Count::of_integer(texel))
    }

    #[inline(always)]
    fn pair(place: Int<Self>, memory: &[u64]) -> [Int<Self>; 4] {
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
    fn put(word: Int<Self>, place: Int<Self>, row: &[Cell<i32>]) {
        if let Some(cell) = row.get(place.raw().integer() as u32 as usize) {
            cell.set(word.raw().integer());
        }
    }

    #[inline(always)]
    fn take(place: Int<Self>, row: &[Cell<i32>]) -> Int<Self> {
        Fx::from_raw(W::Count::of_integer(row.get(place.raw().integer() as u32 as usize).map_or(0, Cell::get)))
    }

    #[inline(always)]
    fn known(flag: bool) -> bool {
        flag
    }
}

/// Two neighbouring words of a memory that has two; beyond its end the last two. The place is cut, not asked for: so both are one load, and nothing branches.
#[inline(always)]
pub fn two(memory: &[u64], place: i32) -> [u64; 2] {
    let place = (place as u32 as usize).min(memory.len() - 2);
    [memory[place], memory[place + 1]]
}

/// The integer of every fragment.
#[inline(always)]
pub(crate) fn int<W: Wire>(integer: i32) -> Int<W> {
    Fx::int(i64::from(integer))
}
