//! Batches: fragments in columns, side by side through a part of the datapath, and in columns again.

use core::slice::ChunksExact;

use roughxel_core::bundle::{Bundle, Rewire, Value};
use roughxel_core::design::{Form, In};
use roughxel_core::each::{each, places};
use roughxel_core::fx::Fx;
use roughxel_core::staged::Staged;
use roughxel_core::word::{Wire, Word};

use super::columns::{Columns, Walk, WalkMut};
use super::peaks::PeakPairs;
use super::vectors::Vectors;
use super::{LANES, Lanes, Target};

/// Lanes of words of any width, for `PARTS` times [`LANES`] fragments: mantissas and counts enter and leave as words of 32 bits.
pub(super) trait Side<const PARTS: usize>: Staged {
    /// The instruction set.
    type Set: Target;
    /// Mantissas, as [`on_words!`](roughxel_core::on_words!) brings them to words of this width.
    fn of_mantissas(words: [Lanes<Self::Set>; PARTS]) -> Self;
    /// The words of 32 bits with these mantissas.
    fn mantissas(self) -> [Lanes<Self::Set>; PARTS];
    /// Counts.
    fn of_counts(words: [Lanes<Self::Set>; PARTS]) -> Self::Count;
    /// The same as words of 32 bits.
    fn counts(count: Self::Count) -> [Lanes<Self::Set>; PARTS];
}

impl<T: Target> Side<1> for Lanes<T> {
    type Set = T;
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

/// Puts what `body` makes of every input into `results`, in their order, in place of what they held. Lanes behind the last fragment hold what
/// was there before, of other batches, or zeros: `body` takes any.
pub(super) fn map<W: Side<PARTS>, I: Inputs, O: Bundle<W, In<i32>: Form>, const PARTS: usize>(
    inputs: I,
    results: &mut Columns<O::In<i32>>,
    body: impl Fn(&I::In<W>) -> O + Copy,
) {
    results.resize(inputs.len());
    // The composer and both walks are compiled for the instruction set, as the stages are.
    W::Set::run(
        #[inline(always)]
        || {
            for group in 0..inputs.len().div_ceil(PARTS * LANES) {
                let first = PARTS * LANES * group;
                let input = inputs.load::<W, PARTS>(first, W::Set::proof());
                let form = body(&input).rewire(&mut Unload::<PARTS>(results.walk_mut(first)));
                // That of all: one more copy of a bundle costs as much as a stage.
                if group == 0 {
                    results.set_form(form);
                }
            }
        },
    );
}

/// The same in the scalar reading. A function of its own for each body: a caller that holds several is compiled in more time than its parts.
#[inline(never)]
pub(super) fn one_by_one<I: Inputs, B: Form>(
    inputs: I,
    results: &mut Columns<B>,
    body: impl Fn(&I::In<i32>) -> B + Copy,
) {
    results.clear();
    for index in 0..inputs.len() {
        results.push(&body(&inputs.at(index)));
    }
}

/// The same bundle in every lane.
#[inline(always)]
pub(super) fn spread<W: Side<PARTS>, B: Form, const PARTS: usize>(bundle: &B) -> In<B, W> {
    bundle.rewire::<W, _>(&mut Spread::<_, PARTS>(W::Set::proof()))
}

/// Inputs of a part of the datapath: fragments in columns, or several bundles of each.
pub(super) trait Inputs: Copy {
    /// Those of a group, in another reading.
    type In<W: Word>: Copy;
    /// Fragments.
    fn len(self) -> usize;
    /// Those of the scalar reading.
    fn at(self, index: usize) -> Self::In<i32>;
    /// Those of a group that begins with fragment `first`.
    fn load<W: Side<PARTS>, const PARTS: usize>(self, first: usize, proof: W::Set) -> Self::In<W>;
}

impl<B: Form> Inputs for &Columns<B> {
    type In<W: Word> = In<B, W>;
    #[inline(always)]
    fn len(self) -> usize {
        Columns::len(self)
    }
    #[inline(always)]
    fn at(self, index: usize) -> B {
        self.get(index)
    }
    #[inline(always)]
    fn load<W: Side<PARTS>, const PARTS: usize>(self, first: usize, proof: W::Set) -> In<B, W> {
        self.form().rewire::<W, _>(&mut Load::<_, PARTS> { walk: self.walk(first), proof })
    }
}

impl<A: Inputs, B: Inputs> Inputs for (A, B) {
    type In<W: Word> = (A::In<W>, B::In<W>);
    #[inline(always)]
    fn len(self) -> usize {
        self.0.len()
    }
    #[inline(always)]
    fn at(self, index: usize) -> Self::In<i32> {
        (self.0.at(index), self.1.at(index))
    }
    #[inline(always)]
    fn load<W: Side<PARTS>, const PARTS: usize>(self, first: usize, proof: W::Set) -> Self::In<W> {
        (self.0.load::<W, PARTS>(first, proof), self.1.load::<W, PARTS>(first, proof))
    }
}

/// Wires of rows, one after the other.
macro_rules! rewire_rows {
    ($rows:ident) => {
        impl<W: Side<PARTS>, const PARTS: usize> Rewire<i32, W> for $rows<'_, W::Set, PARTS> {
            #[inline(always)]
            fn word(&mut self, _: i32, _: u32) -> W {
                W::of_mantissas(self.row())
            }
            #[inline(always)]
            fn control(&mut self, _: i32, _: u32) -> W::Count {
                W::of_counts(self.row())
            }
            #[inline(always)]
            fn wide(&mut self, _: i64, _: u32) -> <W::Count as Word>::Wide {
                let [low, high] = [W::of_counts(self.row()), W::of_counts(self.row())];
                high.widen().shl(32).or(low.widen().and(Wire::lit(0xffff_ffff)))
            }
            #[inline(always)]
            fn flag(&mut self, _: bool) -> W::Flag {
                W::Count::lit(0).lt(W::of_counts(self.row()))
            }
        }
    };
}

/// A peak of each, in its map, and the bundle of its fragment.
impl<B: Form> Inputs for (&PeakPairs, &Columns<B>) {
    type In<W: Word> = (Value<W, 32>, In<B, W>);
    #[inline(always)]
    fn len(self) -> usize {
        self.0.len()
    }
    #[inline(always)]
    fn at(self, index: usize) -> Self::In<i32> {
        let (pairs, bundles) = self;
        (Value(Fx::from_raw(pairs.peaks[index])), bundles.get(pairs.fragments[index] as usize))
    }
    #[inline(always)]
    fn load<W: Side<PARTS>, const PARTS: usize>(self, first: usize, proof: W::Set) -> Self::In<W> {
        let (pairs, bundles) = self;
        let [peaks, fragments] = each!(words in [&pairs.peaks, &pairs.fragments] => {
            each!(part in places::<PARTS>() => words[first + LANES * part..][..LANES].as_chunks().0[0])
        });
        let peak = W::of_counts(each!(words in peaks => Lanes(proof.words(words), proof)));
        // By fragment: most groups are of one.
        let (one, last) = (fragments[0][0], fragments[PARTS - 1][LANES - 1]);
        let bundle = if one == last {
            spread::<W, _, _>(&bundles.get(one as usize))
        } else {
            bundles.form().rewire::<W, _>(&mut Pick::new(bundles.rows(), fragments, proof))
        };
        (Value(Fx::from_raw(peak)), bundle)
    }
}

/// Takes the words of any fragments in the order of a walk: of fragments near each other, as are those of peaks in their order, a permutation of a vector.
struct Pick<'a, T: Target, const PARTS: usize> {
    rows: ChunksExact<'a, i32>,
    /// In ascending order.
    fragments: [[i32; LANES]; PARTS],
    /// Where they lie behind the first one, if all are in one vector from there on.
    behind_first: [Option<T::Words>; PARTS],
    proof: T,
}

impl<'a, T: Target, const PARTS: usize> Pick<'a, T, PARTS> {
    #[inline(always)]
    fn new(rows: ChunksExact<'a, i32>, fragments: [[i32; LANES]; PARTS], proof: T) -> Self {
        let behind_first = each!(of_part in fragments => {
            let (first, last) = (of_part[0], of_part[LANES - 1]);
            (last - first < LANES as i32).then_some(proof.sub(proof.words(of_part), proof.splat(first)))
        });
        Self { rows, fragments, behind_first, proof }
    }
}

impl<T: Target, const PARTS: usize> Pick<'_, T, PARTS> {
    #[inline(always)]
    fn row(&mut self) -> [Lanes<T>; PARTS] {
        let row = self.rows.next().unwrap_or_default();
        each!(part in places() => {
            let fragments = self.fragments[part];
            let vector = row.get(fragments[0] as usize..).and_then(<[i32]>::first_chunk);
            let words = match (self.behind_first[part], vector) {
                (Some(places), Some(vector)) => self.proof.entries(places, vector),
                _ => self.proof.words(each!(fragment in fragments => row.get(fragment as usize).copied().unwrap_or(0))),
            };
            Lanes(words, self.proof)
        })
    }
}

rewire_rows!(Pick);

/// Takes the words of a group in the order of a walk, all lanes at once.
struct Load<'a, T, const PARTS: usize> {
    walk: Walk<'a>,
    proof: T,
}

impl<T: Target, const PARTS: usize> Load<'_, T, PARTS> {
    #[inline(always)]
    fn row(&mut self) -> [Lanes<T>; PARTS] {
        each!(words in self.walk.next() => Lanes(self.proof.words(words), self.proof))
    }
}

rewire_rows!(Load);

/// The same wire in every lane.
struct Spread<T, const PARTS: usize>(T);

impl<T: Target, const PARTS: usize> Spread<T, PARTS> {
    #[inline(always)]
    fn row(&self, word: i32) -> [Lanes<T>; PARTS] {
        [Lanes(self.0.splat(word), self.0); PARTS]
    }
}

impl<W: Side<PARTS>, const PARTS: usize> Rewire<i32, W> for Spread<W::Set, PARTS> {
    #[inline(always)]
    fn word(&mut self, wire: i32, _: u32) -> W {
        W::of_mantissas(self.row(wire))
    }
    #[inline(always)]
    fn control(&mut self, wire: i32, _: u32) -> W::Count {
        W::of_counts(self.row(wire))
    }
    #[inline(always)]
    fn wide(&mut self, wire: i64, _: u32) -> <W::Count as Word>::Wide {
        Wire::lit(wire)
    }
    #[inline(always)]
    fn flag(&mut self, wire: bool) -> W::Flag {
        W::Count::lit(0).lt(W::of_counts(self.row(i32::from(wire))))
    }
}

/// Puts the wires of a walk into columns; a wide wire is two words, a flag is 0 or 1.
struct Unload<'a, const PARTS: usize>(WalkMut<'a>);

impl<const PARTS: usize> Unload<'_, PARTS> {
    #[inline(always)]
    fn row<T: Target>(&mut self, words: [Lanes<T>; PARTS]) -> i32 {
        self.0.put(each!(words in words => words.lanes()));
        0
    }
}

impl<W: Side<PARTS>, const PARTS: usize> Rewire<W, i32> for Unload<'_, PARTS> {
    #[inline(always)]
    fn word(&mut self, wire: W, _: u32) -> i32 {
        self.row(wire.mantissas())
    }
    #[inline(always)]
    fn control(&mut self, wire: W::Count, _: u32) -> i32 {
        self.row(W::counts(wire))
    }
    #[inline(always)]
    fn wide(&mut self, wire: <W::Count as Word>::Wide, _: u32) -> i64 {
        self.row(W::counts(Word::narrow(wire)));
        self.row(W::counts(Word::narrow(wire.sar(32))));
        0
    }
    #[inline(always)]
    fn flag(&mut self, wire: W::Flag) -> bool {
        self.row(W::counts(Wire::select(wire, Wire::lit(1), Wire::lit(0))));
        false
    }
}
