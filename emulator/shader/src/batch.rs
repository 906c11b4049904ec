//! Batches: bundles of many fragments, a row for each word, which a backend loads and stores a vector at a time.

use core::slice::{ChunksExact, ChunksExactMut};

use roughxel_core::bundle::{Bundle, End, Rewire, numbered};
use roughxel_core::design::Form;
use roughxel_core::fx::Fx;
use roughxel_simd::LANES;

use crate::order::Order;
use append::Store;

mod append;

pub use append::{Appended, BlockRows, Row};

/// Fragments of the larger group of lanes: rows have room for whole ones.
pub(crate) const GROUP: usize = 2 * LANES;

/// A bundle of each of many fragments; a row holds one word of all.
#[derive(Clone, Debug)]
pub struct Batch<B> {
    /// Which of its parts there are: a plan leaves some out.
    form: Option<B>,
    /// The numbers of its rows.
    numbers: Option<B>,
    memory: Vec<i32>,
    /// Where the rows begin in it: with a cache line, so that no vector of a group lies in two.
    start: usize,
    /// Words of a row, with room behind the last fragment for a whole vector.
    stride: usize,
    len: usize,
}

impl<B> Default for Batch<B> {
    fn default() -> Self {
        Self { form: None, numbers: None, memory: Vec::new(), start: 0, stride: 0, len: 0 }
    }
}

impl<B: Form> FromIterator<B> for Batch<B> {
    fn from_iter<I: IntoIterator<Item = B>>(bundles: I) -> Self {
        let mut columns = Self::default();
        let bundles = bundles.into_iter();
        columns.grow(bundles.size_hint().0);
        bundles.for_each(|bundle| columns.push(&bundle));
        columns
    }
}

impl<B: Form> Batch<B> {
    /// Fragments.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Leaves no fragment; the memory is kept.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds a fragment. It has the parts that all others have.
    pub fn push(&mut self, bundle: &B) {
        self.form = Some(*bundle);
        self.grow(self.len + 1);
        let (stride, place) = (self.stride, self.len);
        bundle.rewire::<i32, _>(&mut Store::<1> { words: self.words_mut(), stride, place });
        self.len += 1;
    }

    /// So many fragments that are all the same, in place of what there was.
    pub fn fill(&mut self, len: usize, bundle: &B) {
        self.clear();
        if len == 0 {
            return;
        }
        self.push(bundle);
        self.grow(len);
        for row in self.rows_mut() {
            let first = row[0];
            row[..len].fill(first);
        }
        self.len = len;
    }

    /// That of a fragment.
    ///
    /// # Panics
    /// If there are not so many.
    pub fn get(&self, index: usize) -> B {
        assert!(index < self.len, "fragment {index} of {}", self.len);
        self.form().rewire::<i32, _>(&mut Take { words: self.words(), stride: self.stride, place: index })
    }

    /// Those of all fragments, in their order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = B> + '_ {
        (0..self.len).map(|index| self.get(index))
    }

    /// One word of every fragment: the words of a bundle are those of a walk, a wide wire is two, the lower half first.
    ///
    /// # Panics
    /// If the bundle has not so many words.
    pub fn row(&self, word: usize) -> &[i32] {
        &self.words()[word * self.stride..][..self.len]
    }

    /// The row of one of the wires: `row_of(|seen| seen.taps)`.
    pub fn row_of<const INT: u32>(&self, wire: impl Fn(&B) -> Fx<i32, INT>) -> &[i32] {
        self.row(wire(&numbered::<B>()).raw() as usize)
    }

    /// The rows of a part of the bundle, in the order of its walk: `rows_of(|bare| bare.normal)`.
    pub fn rows_of<P: Bundle<i32>>(&self, part: impl Fn(&B) -> P) -> impl Iterator<Item = &[i32]> {
        let mut first = First(None);
        part(&numbered::<B>()).rewire::<i32, _>(&mut first);
        (first.0.unwrap_or(0) as usize..).take(P::WORDS).map(|word| self.row(word))
    }

    /// Adds `count` fragments, at most a vector of them: `write` puts the rows of each part that anybody reads.
    ///
    /// # Panics
    /// More than [`LANES`] fragments.
    pub fn append(&mut self, count: usize, write: impl FnOnce(&mut Appended<'_, B>)) {
        assert!(count <= LANES, "a vector of them");
        self.form.get_or_insert_with(|| B::limit::<i32>(End::Low));
        self.grow(self.len + count);
        let numbers = *self.numbers.get_or_insert_with(numbered);
        let (stride, place) = (self.stride, self.len);
        write(&mut Appended { numbers, words: self.words_mut(), stride, place });
        self.len += count;
    }

    /// Adds `count` fragments that are all the same, at most a vector of them.
    ///
    /// # Panics
    /// More than [`LANES`] fragments.
    pub fn append_same(&mut self, count: usize, bundle: &B) {
        assert!(count <= LANES, "a vector of them");
        self.form.get_or_insert_with(|| B::limit::<i32>(End::Low));
        self.grow(self.len + count);
        let (stride, place) = (self.stride, self.len);
        bundle.rewire::<i32, _>(&mut Store::<LANES> { words: self.words_mut(), stride, place });
        self.len += count;
    }

    /// The fragments in another order, in place of what `ordered` held.
    pub(crate) fn reorder(&self, Order(order): &Order, ordered: &mut Self) {
        ordered.form = self.form;
        ordered.resize(order.len());
        for (words, from) in ordered.rows_mut().zip(self.rows()) {
            for (word, &fragment) in words.iter_mut().zip(order) {
                *word = from[fragment as usize];
            }
        }
    }

    /// Fragments in another order back in their own, in place of what `own` held.
    pub(crate) fn restore(&self, Order(order): &Order, own: &mut Self) {
        own.form = self.form;
        own.resize(order.len());
        for (words, from) in own.rows_mut().zip(self.rows()) {
            for (word, &fragment) in from.iter().zip(order) {
                words[fragment as usize] = *word;
            }
        }
    }

    /// Any bundle of them: what parts there are.
    pub(crate) fn form(&self) -> &B {
        self.form.as_ref().unwrap_or_else(|| unreachable!("fragments have a form"))
    }

    pub(crate) fn set_form(&mut self, form: B) {
        self.form = Some(form);
    }

    /// One word of all after the other, with the room behind them.
    pub(crate) fn rows(&self) -> ChunksExact<'_, i32> {
        self.words().chunks_exact(self.stride)
    }

    fn rows_mut(&mut self) -> ChunksExactMut<'_, i32> {
        let stride = self.stride;
        self.words_mut().chunks_exact_mut(stride)
    }

    #[inline(always)]
    pub(crate) fn words(&self) -> &[i32] {
        &self.memory[self.start..][..self.stride * B::WORDS]
    }

    #[inline(always)]
    pub(crate) fn words_mut(&mut self) -> &mut [i32] {
        &mut self.memory[self.start..][..self.stride * B::WORDS]
    }

    /// Words from one row to the next.
    #[inline(always)]
    pub(crate) fn stride(&self) -> usize {
        self.stride
    }

    /// So many fragments, in place of what there was; whoever asks writes all of them.
    pub(crate) fn resize(&mut self, len: usize) {
        self.len = 0;
        self.grow(len);
        self.len = len;
    }

    /// Room for so many.
    fn grow(&mut self, len: usize) {
        let needed = len.next_multiple_of(GROUP) + LANES;
        if needed <= self.stride {
            return;
        }
        // An odd number of cache lines: the places of one fragment in all rows lie in as many sets of a cache as it has.
        let stride = (needed.max(2 * self.stride).div_ceil(LANES) | 1) * LANES;
        let memory = vec![0; stride * B::WORDS + LANES];
        let start = memory.as_ptr().align_offset(size_of::<[i32; LANES]>()).min(LANES);
        let old = core::mem::replace(
            self,
            Self { form: self.form, numbers: self.numbers, memory, start, stride, len: self.len },
        );
        if old.stride > 0 {
            for (row, from) in self.rows_mut().zip(old.rows()) {
                row[..old.len].copy_from_slice(&from[..old.len]);
            }
        }
    }
}

/// Finds the number of the first word of a part of [`numbered`].
struct First(Option<i32>);

impl Rewire<i32, i32> for First {
    fn word(&mut self, number: i32, _: u32) -> i32 {
        *self.0.get_or_insert(number)
    }
    fn control(&mut self, number: i32, _: u32) -> i32 {
        *self.0.get_or_insert(number)
    }
    fn wide(&mut self, number: i64, _: u32) -> i64 {
        self.0.get_or_insert(number as i32);
        number
    }
    fn flag(&mut self, flag: bool) -> bool {
        flag
    }
}

/// Takes the words of a place in the order of a walk.
struct Take<'a> {
    words: &'a [i32],
    stride: usize,
    /// Of the next word.
    place: usize,
}

impl Rewire<i32, i32> for Take<'_> {
    #[inline(always)]
    fn word(&mut self, _: i32, _: u32) -> i32 {
        let word = self.words[self.place];
        self.place += self.stride;
        word
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
