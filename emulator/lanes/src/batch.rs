//! Batches: fragments side by side in lanes, through a part of the datapath, and one by one again.

use std::mem;

use roughxel_core::bundle::{Bundle, Rewire};
use roughxel_core::design::{Form, In};
use roughxel_core::word::{Wire, Word};

use super::{FlagLanes, LANES, Lanes, Target, WideLanes};

/// A word of [`LANES`] fragments.
type Row = [i32; LANES];

/// Words of a group of fragments, in the order of a walk.
type Group<const WORDS: usize> = [Row; WORDS];

/// Adds what `body` makes of every input to `results`, in their order. The last group is filled up with what its lanes held before. `IN` and
/// `OUT` are the words of an input and of a result: groups of one size for all would mostly be zeros that nobody reads.
pub(super) fn map<T: Target, I: Form, O: Bundle<Lanes<T>, In<i32>: Form>, const IN: usize, const OUT: usize>(
    inputs: &[I],
    results: &mut Vec<O::In<i32>>,
    body: impl Fn(&In<I, Lanes<T>>) -> O,
) {
    const { assert!(I::WORDS == IN && O::WORDS == OUT, "a group has the words of its walk") }
    let store = |group: &mut Group<IN>, fragments: &[I]| {
        for (lane, fragment) in fragments.iter().enumerate() {
            fragment.rewire::<i32, _>(&mut Store { group, lane, next: 0 });
        }
    };
    let (mut into, mut next, mut out) = (&mut [[0; LANES]; IN], &mut [[0; LANES]; IN], [[0; LANES]; OUT]);
    results.reserve(inputs.len());
    let mut groups = inputs.chunks(LANES).peekable();
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
        let form = T::run(
            #[inline(always)]
            || {
                let input = fragments[0].rewire(&mut Load { group: into, proof: T::proof(), next: 0 });
                body(&input).rewire(&mut Unload { group: &mut out, next: 0 })
            },
        );
        let lanes = 0..fragments.len();
        results.extend(lanes.map(|lane| -> O::In<i32> { form.rewire(&mut Lane { group: &out, lane, next: 0 }) }));
    }
}

/// The same bundle in every lane.
#[inline(always)]
pub(super) fn spread<T: Target, B: Form>(bundle: &B) -> In<B, Lanes<T>> {
    bundle.rewire(&mut Spread::<T>(T::proof()))
}

/// Puts the words of a walk into a lane of a group; a wide wire is two of them, a flag is 0 or 1.
struct Store<'a, const WORDS: usize> {
    group: &'a mut Group<WORDS>,
    lane: usize,
    next: usize,
}

impl<const WORDS: usize> Rewire<i32, i32> for Store<'_, WORDS> {
    #[inline(always)]
    fn word(&mut self, wire: i32, _: u32) -> i32 {
        self.group[self.next][self.lane] = wire;
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
struct Load<'a, T, const WORDS: usize> {
    group: &'a Group<WORDS>,
    proof: T,
    next: usize,
}

impl<T: Target, const WORDS: usize> Rewire<i32, Lanes<T>> for Load<'_, T, WORDS> {
    #[inline(always)]
    fn word(&mut self, _: i32, _: u32) -> Lanes<T> {
        self.next += 1;
        Lanes(self.proof.words(self.group[self.next - 1]), self.proof)
    }
    #[inline(always)]
    fn control(&mut self, wire: i32, fraction_bits: u32) -> Lanes<T> {
        self.word(wire, fraction_bits)
    }
    #[inline(always)]
    fn wide(&mut self, _: i64, _: u32) -> WideLanes<T> {
        let [low, high] = [self.word(0, 0), self.word(0, 0)];
        let low = low.widen().and(Wire::lit(0xffff_ffff));
        high.widen().shl(32).or(low)
    }
    #[inline(always)]
    fn flag(&mut self, _: bool) -> FlagLanes<T> {
        Lanes::lit(0).lt(self.word(0, 0))
    }
}

/// The same wire in every lane.
struct Spread<T>(T);

impl<T: Target> Rewire<i32, Lanes<T>> for Spread<T> {
    #[inline(always)]
    fn word(&mut self, wire: i32, _: u32) -> Lanes<T> {
        Lanes(self.0.words([wire; LANES]), self.0)
    }
    #[inline(always)]
    fn control(&mut self, wire: i32, fraction_bits: u32) -> Lanes<T> {
        self.word(wire, fraction_bits)
    }
    #[inline(always)]
    fn wide(&mut self, wire: i64, _: u32) -> WideLanes<T> {
        WideLanes(self.0.wides([wire; LANES]), self.0)
    }
    #[inline(always)]
    fn flag(&mut self, wire: bool) -> FlagLanes<T> {
        Lanes::lit(0).lt(self.word(i32::from(wire), 0))
    }
}

/// Puts the wires of a walk into a group of words; a wide wire is two of them, a flag is 0 or 1.
struct Unload<'a, const WORDS: usize> {
    group: &'a mut Group<WORDS>,
    next: usize,
}

impl<T: Target, const WORDS: usize> Rewire<Lanes<T>, i32> for Unload<'_, WORDS> {
    #[inline(always)]
    fn word(&mut self, wire: Lanes<T>, _: u32) -> i32 {
        self.group[self.next] = wire.lanes();
        self.next += 1;
        0
    }
    #[inline(always)]
    fn control(&mut self, wire: Lanes<T>, fraction_bits: u32) -> i32 {
        self.word(wire, fraction_bits)
    }
    #[inline(always)]
    fn wide(&mut self, wire: WideLanes<T>, _: u32) -> i64 {
        self.word(Lanes::narrow(wire), 0);
        self.word(Lanes::narrow(wire.sar(32)), 0);
        0
    }
    #[inline(always)]
    fn flag(&mut self, wire: FlagLanes<T>) -> bool {
        self.word(Lanes::select(wire, Wire::lit(1), Wire::lit(0)), 0);
        false
    }
}

/// Takes the words of one lane in the order of a walk.
struct Lane<'a, const WORDS: usize> {
    group: &'a Group<WORDS>,
    lane: usize,
    next: usize,
}

impl<const WORDS: usize> Rewire<i32, i32> for Lane<'_, WORDS> {
    #[inline(always)]
    fn word(&mut self, _: i32, _: u32) -> i32 {
        self.next += 1;
        self.group[self.next - 1][self.lane]
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
