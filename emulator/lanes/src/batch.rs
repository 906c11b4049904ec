//! Batches: fragments side by side in lanes, through a part of the datapath, and one by one again.

use std::mem;

use roughxel_core::bundle::{Bundle, Rewire};
use roughxel_core::design::{Form, In};
use roughxel_core::each::each;
use roughxel_core::staged::Staged;
use roughxel_core::word::{Wire, Word};

use super::vectors::Vectors;
use super::{LANES, Lanes, Target};

/// A word of a group of fragments: lane i stands in part `i % PARTS`.
type Row<const PARTS: usize> = [[i32; LANES]; PARTS];

/// Words of a group of fragments, in the order of a walk.
type Group<const PARTS: usize, const WORDS: usize> = [Row<PARTS>; WORDS];

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

/// Adds what `body` makes of every input to `results`, in their order. The last group is filled up with what its lanes held before. `IN` and
/// `OUT` are the words of an input and of a result: groups of one size for all would mostly be zeros that nobody reads.
pub(super) fn map<
    W: Side<PARTS>,
    I: Form,
    O: Bundle<W, In<i32>: Form>,
    const PARTS: usize,
    const IN: usize,
    const OUT: usize,
>(
    inputs: &[I],
    results: &mut Vec<O::In<i32>>,
    body: impl Fn(&In<I, W>) -> O,
) {
    const { assert!(I::WORDS == IN && O::WORDS == OUT, "a group has the words of its walk") }
    let store = |group: &mut Group<PARTS, IN>, fragments: &[I]| {
        for (lane, fragment) in fragments.iter().enumerate() {
            fragment.rewire::<i32, _>(&mut Store { group, lane, next: 0 });
        }
    };
    let mut out = [[[0; LANES]; PARTS]; OUT];
    let (mut into, mut next) = (&mut [[[0; LANES]; PARTS]; IN], &mut [[[0; LANES]; PARTS]; IN]);
    results.reserve(inputs.len());
    let mut groups = inputs.chunks(PARTS * LANES).peekable();
    if let Some(fragments) = groups.peek() {
        store(next, fragments);
    }
    while let Some(fragments) = groups.next() {
        mem::swap(&mut into, &mut next);
        // A group ahead: a vector loaded from words just stored waits for the last of them.
        if let Some(fragments) = groups.peek() {
            store(next, fragments);
        }
        // The composer and both walks are compiled for the instruction set, as the stages are.
        let form = W::Set::run(
            #[inline(always)]
            || {
                let input = fragments[0].rewire::<W, _>(&mut Load { group: into, proof: W::Set::proof(), next: 0 });
                body(&input).rewire(&mut Unload { group: &mut out, next: 0 })
            },
        );
        let lanes = 0..fragments.len();
        results.extend(lanes.map(|lane| -> O::In<i32> { form.rewire(&mut Lane { group: &out, lane, next: 0 }) }));
    }
}

/// The same bundle in every lane.
#[inline(always)]
pub(super) fn spread<W: Side<PARTS>, B: Form, const PARTS: usize>(bundle: &B) -> In<B, W> {
    bundle.rewire::<W, _>(&mut Spread::<_, PARTS>(W::Set::proof()))
}

/// Puts the words of a walk into a lane of a group; a wide wire is two of them, a flag is 0 or 1.
struct Store<'a, const PARTS: usize, const WORDS: usize> {
    group: &'a mut Group<PARTS, WORDS>,
    lane: usize,
    next: usize,
}

impl<const PARTS: usize, const WORDS: usize> Rewire<i32, i32> for Store<'_, PARTS, WORDS> {
    #[inline(always)]
    fn word(&mut self, wire: i32, _: u32) -> i32 {
        self.group[self.next][self.lane % PARTS][self.lane / PARTS % LANES] = wire;
        self.next += 1;
        wire
    }
    #[inline(always)]
    fn control(&mut self, wire: i32, fraction_bits: u32) -> i32 {
        self.word(wire, fraction_bits)
    }
    #[inline(always)]
    fn wide(&mut self, wire: i64, _: u32) -> i64 {
        self.word(wire as i32, 0);
        self.word((wire >> 32) as i32, 0);
        wire
    }
    #[inline(always)]
    fn flag(&mut self, wire: bool) -> bool {
        self.word(i32::from(wire), 0);
        wire
    }
}

/// Takes the words of a group in the order of a walk, all lanes at once.
struct Load<'a, T, const PARTS: usize, const WORDS: usize> {
    group: &'a Group<PARTS, WORDS>,
    proof: T,
    next: usize,
}

impl<T: Target, const PARTS: usize, const WORDS: usize> Load<'_, T, PARTS, WORDS> {
    #[inline(always)]
    fn row(&mut self) -> [Lanes<T>; PARTS] {
        self.next += 1;
        each!(part in self.group[self.next - 1] => Lanes(self.proof.words(part), self.proof))
    }
}

impl<W: Side<PARTS>, const PARTS: usize, const WORDS: usize> Rewire<i32, W> for Load<'_, W::Set, PARTS, WORDS> {
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

/// Puts the wires of a walk into a group of words; a wide wire is two of them, a flag is 0 or 1.
struct Unload<'a, const PARTS: usize, const WORDS: usize> {
    group: &'a mut Group<PARTS, WORDS>,
    next: usize,
}

impl<const PARTS: usize, const WORDS: usize> Unload<'_, PARTS, WORDS> {
    #[inline(always)]
    fn row<T: Target>(&mut self, words: [Lanes<T>; PARTS]) -> i32 {
        self.group[self.next] = each!(part in words => part.lanes());
        self.next += 1;
        0
    }
}

impl<W: Side<PARTS>, const PARTS: usize, const WORDS: usize> Rewire<W, i32> for Unload<'_, PARTS, WORDS> {
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

/// Takes the words of one lane in the order of a walk.
struct Lane<'a, const PARTS: usize, const WORDS: usize> {
    group: &'a Group<PARTS, WORDS>,
    lane: usize,
    next: usize,
}

impl<const PARTS: usize, const WORDS: usize> Rewire<i32, i32> for Lane<'_, PARTS, WORDS> {
    #[inline(always)]
    fn word(&mut self, _: i32, _: u32) -> i32 {
        self.next += 1;
        self.group[self.next - 1][self.lane % PARTS][self.lane / PARTS % LANES]
    }
    #[inline(always)]
    fn control(&mut self, wire: i32, fraction_bits: u32) -> i32 {
        self.word(wire, fraction_bits)
    }
    #[inline(always)]
    fn wide(&mut self, _: i64, _: u32) -> i64 {
        let [low, high] = [self.word(0, 0), self.word(0, 0)];
        i64::from(high) << 32 | i64::from(low.cast_unsigned())
    }
    #[inline(always)]
    fn flag(&mut self, _: bool) -> bool {
        self.word(0, 0) != 0
    }
}
