//! Passes: one body, generic over words, that reads the rows of a group of fragments, calls the composer, and hands over the result.

use core::slice::ChunksExact;

use roughxel_core::bundle::{Bundle, Rewire, Value};
use roughxel_core::design::{Form, In};
use roughxel_core::fx::Fx;
use roughxel_core::precision::Precision;
use roughxel_core::signals::MapScale;
use roughxel_core::word::{Wire, Word};
use roughxel_simd::{Backend, BatchWord, Kernel};

use crate::batch::Batch;
use crate::peaks::PeakPairs;
use crate::texels::CubeTexels;

/// A part of the way of a fragment. Its fields are the batches that it reads and the values that all fragments share.
pub trait Pass {
    /// Bundle that the pass makes for each fragment.
    type Output: Form;
    /// Number of fragments.
    fn len(&self) -> usize;
    /// Makes the bundles of a group. Unused lanes of the last group hold stale or zero data; the pass accepts any.
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> In<Self::Output, W>;
}

/// Backend, accuracy and environment of all fragments of a frame.
#[derive(Clone, Copy, Debug)]
pub struct Shader<'a> {
    /// The words that passes run on.
    pub backend: Backend,
    /// The knobs of their arithmetic.
    pub precision: &'a Precision,
    /// Environment that is reflected.
    pub environment: Option<Environment<'a>>,
}

/// An environment.
#[derive(Clone, Copy, Debug)]
pub struct Environment<'a> {
    /// Texels of the map.
    pub texels: &'a CubeTexels,
    /// Scale of footprints in the environment.
    pub scale: &'a MapScale<i32>,
}

impl<'a> Shader<'a> {
    /// A shader without an environment.
    pub fn new(backend: Backend, precision: &'a Precision) -> Self {
        Self { backend, precision, environment: None }
    }

    /// Puts the results of a pass for every fragment into `results`, in place of its content.
    pub(crate) fn run<P: Pass>(self, pass: &P, results: &mut Batch<P::Output>) {
        self.backend.dispatch(self.precision, Run { pass, precision: self.precision, results });
    }
}

/// Public `run` of passes, compiled here once.
macro_rules! runs {
    ($($pass:ident)*) => {
        $(impl $pass<'_> {
            /// Puts the results of the pass for every fragment into `results`, in place of its content.
            pub fn run(&self, shader: $crate::Shader<'_>, results: &mut $crate::Batch<<Self as $crate::pass::Pass>::Output>) {
                shader.run(self, results);
            }
        })*
    };
}
pub(crate) use runs;

/// A pass on words of any backend.
struct Run<'a, P: Pass> {
    pass: &'a P,
    precision: &'a Precision,
    results: &'a mut Batch<P::Output>,
}

impl<P: Pass> Kernel for Run<'_, P> {
    type Outcome = ();
    #[inline(never)]
    fn run<W: BatchWord>(self) {
        let Self { pass, precision, results } = self;
        let len = pass.len();
        results.resize(len);
        // The composer and both walks are compiled for the instruction set, like the stages.
        W::run(
            #[inline(always)]
            || {
                for first in (0..len).step_by(W::FRAGMENTS) {
                    let made: In<P::Output, W> = pass.group(&Group::<W> { first, proof: W::proof() }, precision);
                    let walk = Walk::new::<W, P::Output>(results, first);
                    let form =
                        made.rewire::<i32, _>(&mut Unload::<W> { vectors: W::vectors_mut(results.words_mut()), walk });
                    // Set by the first group, for the whole batch: one more copy of a bundle costs as much as a stage.
                    if first == 0 {
                        results.set_form(form);
                    }
                }
            },
        );
    }
}

/// Place of a group in its batch.
pub struct Group<W: BatchWord> {
    first: usize,
    proof: W::Proof,
}

impl<W: BatchWord> Group<W> {
    /// Loads the bundles of the group's fragments.
    #[inline(always)]
    pub(crate) fn load<B: Form>(&self, batch: &Batch<B>) -> In<B, W> {
        let walk = Walk::new::<W, B>(batch, self.first);
        batch.form().rewire::<W, _>(&mut Load::<W> { vectors: W::vectors(batch.words()), walk, proof: self.proof })
    }

    /// Bundle that all fragments share.
    #[inline(always)]
    pub(crate) fn all<B: Form>(&self, bundle: &B) -> In<B, W> {
        bundle.rewire::<W, _>(&mut Spread::<W>(self.proof))
    }

    /// Peaks of a group of pairs.
    #[inline(always)]
    pub(crate) fn peaks(&self, pairs: &PeakPairs) -> Value<W, 32> {
        let row = W::load(self.proof, W::vectors(&pairs.peaks[self.first..]), 0);
        Value(Fx::from_raw(W::of_counts(row)))
    }

    /// Bundles of the fragments of pairs; most groups are of one fragment.
    #[inline(always)]
    pub(crate) fn of_pairs<B: Form>(&self, pairs: &PeakPairs, batch: &Batch<B>) -> In<B, W> {
        let fragments = &pairs.fragments[self.first..][..W::FRAGMENTS];
        let (one, last) = (fragments[0], fragments[W::FRAGMENTS - 1]);
        if one == last {
            return self.all(&batch.get(one as usize));
        }
        let places = W::places(self.proof, fragments);
        batch.form().rewire::<W, _>(&mut Pick::<W> { rows: batch.rows(), places, proof: self.proof })
    }
}

/// Place of the next word of a group, among the vectors of a batch.
struct Walk {
    place: usize,
    stride: usize,
}

impl Walk {
    #[inline(always)]
    fn new<W: BatchWord, B: Form>(batch: &Batch<B>, first: usize) -> Self {
        let words = size_of::<W::Vector>() / size_of::<i32>();
        Self { place: first / words, stride: batch.stride() / words }
    }

    #[inline(always)]
    fn next(&mut self) -> usize {
        self.place += self.stride;
        self.place - self.stride
    }
}

/// Takes the words of a group in the order of a walk.
struct Load<'a, W: BatchWord> {
    vectors: &'a [W::Vector],
    walk: Walk,
    proof: W::Proof,
}

impl<W: BatchWord> Load<'_, W> {
    #[inline(always)]
    fn row(&mut self) -> W::Row {
        W::load(self.proof, self.vectors, self.walk.next())
    }
}

/// Takes the words of any fragments in the order of a walk.
struct Pick<'a, W: BatchWord> {
    rows: ChunksExact<'a, i32>,
    places: W::Places,
    proof: W::Proof,
}

impl<W: BatchWord> Pick<'_, W> {
    #[inline(always)]
    fn row(&mut self) -> W::Row {
        W::pick(self.proof, self.rows.next().unwrap_or_default(), &self.places)
    }
}

/// Rewires the wires of rows, one after the other.
macro_rules! rewire_rows {
    ($rows:ident) => {
        impl<W: BatchWord> Rewire<i32, W> for $rows<'_, W> {
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

rewire_rows!(Load);
rewire_rows!(Pick);

/// Repeats a wire for every fragment.
struct Spread<W: BatchWord>(W::Proof);

impl<W: BatchWord> Rewire<i32, W> for Spread<W> {
    #[inline(always)]
    fn word(&mut self, wire: i32, _: u32) -> W {
        W::of_mantissas(W::splat(self.0, wire))
    }
    #[inline(always)]
    fn control(&mut self, wire: i32, _: u32) -> W::Count {
        W::of_counts(W::splat(self.0, wire))
    }
    #[inline(always)]
    fn wide(&mut self, wire: i64, _: u32) -> <W::Count as Word>::Wide {
        Wire::lit(wire)
    }
    #[inline(always)]
    fn flag(&mut self, wire: bool) -> W::Flag {
        W::Count::lit(0).lt(W::of_counts(W::splat(self.0, i32::from(wire))))
    }
}

/// Stores the wires of a walk in rows; a wide wire is two words, a flag is 0 or 1.
struct Unload<'a, W: BatchWord> {
    vectors: &'a mut [W::Vector],
    walk: Walk,
}

impl<W: BatchWord> Unload<'_, W> {
    #[inline(always)]
    fn row(&mut self, row: W::Row) -> i32 {
        W::store(row, self.vectors, self.walk.next());
        0
    }
}

impl<W: BatchWord> Rewire<W, i32> for Unload<'_, W> {
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
