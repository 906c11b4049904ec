//! Fetches of fragments in lanes; each fragment has its own address, level and probe count.

use std::cell::Cell;

use roughxel_core::each::{each, places};
use roughxel_core::fetch::Fetch;
use roughxel_core::fx::{Fx, Int};
use roughxel_core::word::Wire;

use super::narrow::Halves;
use super::{FlagLanes, LANES, Lanes, NarrowFlags, NarrowLanes, Target, any};

#[inline(always)]
fn most<T: Target>(count: Lanes<T>) -> i32 {
    count.lanes().iter().fold(0, |most, &count| most.max(count))
}

/// Place of a turn, and whether the fragment has that many turns.
#[inline(always)]
fn turn<C: Wire>(turn: i32, count: Fx<C, 32>) -> (Fx<C, 32>, C::Flag) {
    let turn = Fx::int(turn.into());
    (turn.min(count - Fx::int(1)).max(Fx::zero()), turn.lt(count))
}

/// Gathers by a loop over the lanes: vectors that address a memory are not safe.
#[inline(always)]
fn gather<T: Target, const IN: usize, const OUT: usize>(
    address: [Lanes<T>; IN],
    read: &impl Fn([i32; IN]) -> [i32; OUT],
) -> [Lanes<T>; OUT] {
    let proof = address[0].1;
    let mut rows = [[0; LANES]; OUT];
    read_all(&each!(words in address => words.lanes()), &mut rows, read);
    each!(row in rows => Lanes(proof.words(row), proof))
}

/// Separate function, the same for every instruction set.
#[inline(never)]
fn read_all<const IN: usize, const OUT: usize>(
    address: &[[i32; LANES]; IN],
    rows: &mut [[i32; LANES]; OUT],
    read: &impl Fn([i32; IN]) -> [i32; OUT],
) {
    for lane in 0..LANES {
        let texel = read(each!(word in places() => address[word][lane]));
        for word in 0..OUT {
            rows[word][lane] = texel[word];
        }
    }
}

/// Cells of a row from the place of the first fragment on; the places of the others follow it.
#[inline(always)]
fn cells<T: Target>(place: Lanes<T>, row: &[Cell<i32>]) -> Option<&[Cell<i32>; LANES]> {
    row.get(place.lanes()[0] as u32 as usize..)?.first_chunk()
}

impl<T: Target> Fetch for Lanes<T> {
    #[inline(always)]
    fn max_over_lanes(count: Int<Self>) -> i32 {
        most(count.raw())
    }
    #[inline(always)]
    fn loop_index(index: i32, count: Int<Self>) -> (Int<Self>, FlagLanes<T>) {
        turn(index, count)
    }
    #[inline(always)]
    fn any(flag: FlagLanes<T>) -> bool {
        any(flag)
    }
    #[inline(always)]
    fn per_lane<const IN: usize, const OUT: usize>(
        address: [Self; IN],
        read: impl Fn([i32; IN]) -> [i32; OUT] + Copy,
    ) -> [Self; OUT] {
        gather(address, &read)
    }
    #[inline(always)]
    fn load_pair(place: Int<Self>, memory: &[u64]) -> [Int<Self>; 4] {
        let Lanes(places, proof) = place.raw();
        each!(words in proof.pairs(places, memory) => Fx::from_raw(Lanes(words, proof)))
    }
    #[inline(always)]
    fn entry(index: Int<Self>, table: &[i32; 16]) -> Int<Self> {
        let Lanes(places, proof) = index.raw();
        Fx::from_raw(Lanes(proof.entries(places, table), proof))
    }
    #[inline(always)]
    fn scatter(word: Int<Self>, place: Int<Self>, row: &[Cell<i32>]) {
        if let Some(cells) = cells(place.raw(), row) {
            cells.iter().zip(word.raw().lanes()).for_each(|(cell, word)| cell.set(word));
        }
    }
    #[inline(always)]
    fn gather(place: Int<Self>, row: &[Cell<i32>]) -> Int<Self> {
        let place = place.raw();
        let words = cells(place, row)
            .map_or([0; LANES], |cells| each!(cell in each!(i in places() => &cells[i]) => cell.get()));
        Fx::from_raw(Lanes(place.1.words(words), place.1))
    }
}

impl<T: Target> Fetch for NarrowLanes<T> {
    #[inline(always)]
    fn max_over_lanes(count: Int<Self>) -> i32 {
        let Halves([even, odd]) = count.raw();
        most(even).max(most(odd))
    }
    #[inline(always)]
    fn loop_index(index: i32, count: Int<Self>) -> (Int<Self>, NarrowFlags<T>) {
        turn(index, count)
    }
    #[inline(always)]
    fn any(flag: NarrowFlags<T>) -> bool {
        flag.is_any()
    }
    #[inline(always)]
    fn per_lane<const IN: usize, const OUT: usize>(
        address: [Halves<Lanes<T>>; IN],
        read: impl Fn([i32; IN]) -> [i32; OUT] + Copy,
    ) -> [Halves<Lanes<T>>; OUT] {
        let [even, odd] = each!(half in [0, 1] => gather(each!(words in address => words.0[half]), &read));
        each!(word in places() => Halves([even[word], odd[word]]))
    }
    #[inline(always)]
    fn load_pair(place: Int<Self>, memory: &[u64]) -> [Int<Self>; 4] {
        let [even, odd] = each!(half in place.raw().0 => <Lanes<T> as Fetch>::load_pair(Fx::from_raw(half), memory));
        each!(word in places() => Fx::from_raw(Halves([even[word].raw(), odd[word].raw()])))
    }
    #[inline(always)]
    fn entry(index: Int<Self>, table: &[i32; 16]) -> Int<Self> {
        let halves = each!(half in index.raw().0 => <Lanes<T> as Fetch>::entry(Fx::from_raw(half), table).raw());
        Fx::from_raw(Halves(halves))
    }
    #[inline(always)]
    fn scatter(word: Int<Self>, place: Int<Self>, row: &[Cell<i32>]) {
        let (word, place) = (word.raw().0, place.raw().0);
        for half in [0, 1] {
            <Lanes<T> as Fetch>::scatter(Fx::from_raw(word[half]), Fx::from_raw(place[half]), row);
        }
    }
    #[inline(always)]
    fn gather(place: Int<Self>, row: &[Cell<i32>]) -> Int<Self> {
        let halves = each!(half in place.raw().0 => <Lanes<T> as Fetch>::gather(Fx::from_raw(half), row).raw());
        Fx::from_raw(Halves(halves))
    }
}
