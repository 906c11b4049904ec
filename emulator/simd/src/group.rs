//! Words of a group of fragments between the rows of a batch and the registers of a backend.

use roughxel_core::each::{each, places};
use roughxel_core::fetch::Fetch;
use roughxel_core::width::IntegerWord;
use roughxel_core::word::Wire;

use super::narrow::{Halves, NARROW_LANES, NarrowLanes};
use super::{LANES, Lanes, Target};

/// A word of every fragment of a group. A batch holds each wire as a row of 32-bit words; narrower mantissas are their upper halves.
pub trait BatchWord: Fetch {
    /// Number of fragments in a group.
    const FRAGMENTS: usize;
    /// Words of a row that are read together.
    type Vector;
    /// The 32-bit words of one wire of a group.
    type Row: Copy;
    /// Places of the fragments of a group in a row, in ascending order.
    type Places: Copy;
    /// The proof that the machine has the instruction set.
    type Proof: Copy;

    /// Runs `body`, compiled for the instruction set if it is inlined.
    fn run<R>(body: impl FnOnce() -> R) -> R;
    /// Proof inside of [`Self::run`].
    fn proof() -> Self::Proof;
    /// Rows as vectors, without the words after the last whole vector.
    fn vectors(words: &[i32]) -> &[Self::Vector];
    /// Rows as writable vectors.
    fn vectors_mut(words: &mut [i32]) -> &mut [Self::Vector];
    /// Loads the words of the group whose first vector is `first`.
    fn load(proof: Self::Proof, vectors: &[Self::Vector], first: usize) -> Self::Row;
    /// Stores the words of a group.
    fn store(row: Self::Row, vectors: &mut [Self::Vector], first: usize);
    /// Repeats a word for every fragment.
    fn splat(proof: Self::Proof, word: i32) -> Self::Row;
    /// First places of a slice that holds at least those of a group.
    fn places(proof: Self::Proof, places: &[i32]) -> Self::Places;
    /// Words of a row at places; 0 beyond its end.
    fn pick(proof: Self::Proof, row: &[i32], places: &Self::Places) -> Self::Row;
    /// Word from mantissas, rounded to the width of this word as [`roughxel_core::on_words!`] does.
    fn of_mantissas(row: Self::Row) -> Self;
    /// Mantissas as 32-bit words.
    fn mantissas(self) -> Self::Row;
    /// Count word from 32-bit words.
    fn of_counts(row: Self::Row) -> Self::Count;
    /// Counts as 32-bit words.
    fn counts(count: Self::Count) -> Self::Row;
}

/// The scalar backend is a group of one.
macro_rules! scalar {
    ($($word:ty)*) => {
        $(impl BatchWord for $word {
            const FRAGMENTS: usize = 1;
            type Vector = i32;
            type Row = i32;
            type Places = i32;
            type Proof = ();
            #[inline(always)]
            fn run<R>(body: impl FnOnce() -> R) -> R {
                body()
            }
            #[inline(always)]
            fn proof() {}
            #[inline(always)]
            fn vectors(words: &[i32]) -> &[i32] {
                words
            }
            #[inline(always)]
            fn vectors_mut(words: &mut [i32]) -> &mut [i32] {
                words
            }
            #[inline(always)]
            fn load((): (), words: &[i32], first: usize) -> i32 {
                words[first]
            }
            #[inline(always)]
            fn store(row: i32, words: &mut [i32], first: usize) {
                words[first] = row;
            }
            #[inline(always)]
            fn splat((): (), word: i32) -> i32 {
                word
            }
            #[inline(always)]
            fn places((): (), places: &[i32]) -> i32 {
                places[0]
            }
            #[inline(always)]
            fn pick((): (), row: &[i32], &place: &i32) -> i32 {
                row.get(place as usize).copied().unwrap_or(0)
            }
            #[inline(always)]
            fn of_mantissas(row: i32) -> Self {
                Self::of_port(row)
            }
            #[inline(always)]
            fn mantissas(self) -> i32 {
                self.to_port()
            }
            #[inline(always)]
            fn of_counts(row: i32) -> i32 {
                row
            }
            #[inline(always)]
            fn counts(count: i32) -> i32 {
                count
            }
        })*
    };
}

scalar!(i32 i16);

/// Places of a vector of fragments. If all places are within one vector from the first on, their distances from it are kept, too.
#[derive(Clone, Copy)]
pub struct LanePlaces<T: Target> {
    places: [i32; LANES],
    behind_first: Option<T::Words>,
}

impl<T: Target> LanePlaces<T> {
    #[inline(always)]
    fn new(proof: T, places: [i32; LANES]) -> Self {
        let (first, last) = (places[0], places[LANES - 1]);
        let is_near = last - first < LANES as i32;
        Self { places, behind_first: is_near.then_some(proof.sub(proof.words(places), proof.splat(first))) }
    }

    /// Picks words that are near each other with one permutation of a vector.
    #[inline(always)]
    fn pick(&self, proof: T, row: &[i32]) -> Lanes<T> {
        let vector = row.get(self.places[0] as usize..).and_then(<[i32]>::first_chunk);
        let words = match (self.behind_first, vector) {
            (Some(places), Some(vector)) => proof.entries(places, vector),
            _ => proof.words(each!(place in self.places => row.get(place as usize).copied().unwrap_or(0))),
        };
        Lanes(words, proof)
    }
}

/// Rows of this many vectors of [`LANES`] fragments.
macro_rules! lanes {
    ($parts:literal, $fragments:expr) => {
        const FRAGMENTS: usize = $fragments;
        type Vector = [i32; LANES];
        type Row = [Lanes<T>; $parts];
        type Places = [LanePlaces<T>; $parts];
        type Proof = T;
        #[inline(always)]
        fn run<R>(body: impl FnOnce() -> R) -> R {
            <T as Target>::run(body)
        }
        #[inline(always)]
        fn proof() -> T {
            T::proof()
        }
        #[inline(always)]
        fn vectors(words: &[i32]) -> &[[i32; LANES]] {
            words.as_chunks().0
        }
        #[inline(always)]
        fn vectors_mut(words: &mut [i32]) -> &mut [[i32; LANES]] {
            words.as_chunks_mut().0
        }
        #[inline]
        fn load(proof: T, vectors: &[[i32; LANES]], first: usize) -> Self::Row {
            each!(part in places::<$parts>() => Lanes(proof.words(vectors[first + part]), proof))
        }
        #[inline(always)]
        fn store(row: Self::Row, vectors: &mut [[i32; LANES]], first: usize) {
            each!(part in places::<$parts>() => vectors[first + part] = row[part].lanes());
        }
        #[inline]
        fn splat(proof: T, word: i32) -> Self::Row {
            each!(_ in places::<$parts>() => Lanes(proof.splat(word), proof))
        }
        #[inline(always)]
        fn places(proof: T, places_of_all: &[i32]) -> Self::Places {
            let vectors = places_of_all.as_chunks().0;
            each!(part in places::<$parts>() => LanePlaces::new(proof, vectors[part]))
        }
        #[inline(always)]
        fn pick(proof: T, row: &[i32], places: &Self::Places) -> Self::Row {
            each!(part in *places => part.pick(proof, row))
        }
    };
}

impl<T: Target> BatchWord for Lanes<T> {
    lanes!(1, LANES);
    #[inline(always)]
    fn of_mantissas([words]: [Self; 1]) -> Self {
        words
    }
    #[inline(always)]
    fn mantissas(self) -> [Self; 1] {
        [self]
    }
    #[inline(always)]
    fn of_counts([words]: [Self; 1]) -> Self {
        words
    }
    #[inline(always)]
    fn counts(count: Self) -> [Self; 1] {
        [count]
    }
}

impl<T: Target> BatchWord for NarrowLanes<T> {
    lanes!(2, NARROW_LANES);
    #[inline(always)]
    fn of_mantissas(row: [Lanes<T>; 2]) -> Self {
        // A value that would round up beyond the largest word stays the largest word.
        let largest = Halves::lit(i64::from(i32::MAX) - (1 << 15));
        let words = Halves(row);
        Self::of_high(Halves::select(words.lt(largest), words, largest).add(Wire::lit(1 << 15)))
    }
    #[inline(always)]
    fn mantissas(self) -> [Lanes<T>; 2] {
        self.high().0
    }
    #[inline(always)]
    fn of_counts(row: [Lanes<T>; 2]) -> Halves<Lanes<T>> {
        Halves(row)
    }
    #[inline(always)]
    fn counts(count: Halves<Lanes<T>>) -> [Lanes<T>; 2] {
        count.0
    }
}
