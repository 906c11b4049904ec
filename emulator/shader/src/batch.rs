//! Batches: bundles of many fragments, one row for each word. A backend loads and stores rows a vector at a time.

use core::slice::{ChunksExact, ChunksExactMut};

use roughxel_core::bundle::{Bundle, End, Rewire, numbered};
use roughxel_core::design::Form;
use roughxel_core::fx::Fx;
use roughxel_simd::LANES;

use crate::order::Order;
use append::Store;

mod append;

pub use append::{Appended, BlockRows, Row};

/// Fragments of the larger lane group; rows have room for whole groups.
pub(crate) const GROUP: usize = 2 * LANES;

/// A bundle for each of many fragments; a row holds one word of all.
#[derive(Clone, Debug)]
pub struct Batch<B> {
    /// Bundle that shows which parts exist: a plan leaves some out.
    form: Option<B>,
    /// Bundle with the numbers of the rows.
    numbers: Option<B>,
    memory: Vec<i32>,
    /// Start of the rows in the memory. They begin with a cache line, so no vector of a group lies in two lines.
    start: usize,
    /// Words of a row, with room after the last fragment for a whole vector.
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
    /// Number of fragments.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Returns true if there is no fragment.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Removes all fragments; the memory is kept.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds a fragment. It has the parts that all other fragments have.
    pub fn push(&mut self, bundle: &B) {
        self.form = Some(*bundle);
        self.grow(self.len + 1);
        let (stride, place) = (self.stride, self.len);
        bundle.rewire::<i32, _>(&mut Store::<1> { words: self.words_mut(), stride, place });
        self.len += 1;
    }

    /// Replaces the content by `len` equal fragments.
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

    /// Bundle of a fragment.
    ///
    /// # Panics
    /// If `index` is not below the number of fragments.
    pub fn get(&self, index: usize) -> B {
        assert!(index < self.len, "fragment {index} of {}", self.len);
        self.form().rewire::<i32, _>(&mut Take { words: self.words(), stride: self.stride, place: index })
    }

    /// Bundles of all fragments, in their order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = B> + '_ {
        (0..self.len).map(|index| self.get(index))
    }

    /// One word of every fragment. The words of a bundle are those of a walk; a wide wire is two words, the lower half first.
    ///
    /// # Panics
    /// If the bundle has no such word.
    pub fn row(&self, word: usize) -> &[i32] {
        &self.words()[word * self.stride..][..self.len]
    }

    /// Row of one of the wires: `row_of(|seen| seen.samples)`.
    pub fn row_of<const INT: u32>(&self, wire: impl Fn(&B) -> Fx<i32, INT>) -> &[i32] {
        self.row(wire(&numbered::<B>()).raw() as usize)
    }

    /// Rows of a part of the bundle, in the order of its walk: `rows_of(|bare| bare.normal)`.
    pub fn rows_of<P: Bundle<i32>>(&self, part: impl Fn(&B) -> P) -> impl Iterator<Item = &[i32]> {
        let mut first = First(None);
        part(&numbered::<B>()).rewire::<i32, _>(&mut first);
        (first.0.unwrap_or(0) as usize..).take(P::WORDS).map(|word| self.row(word))
    }

    /// Adds `count` fragments, at most a vector of them. `write` stores the rows of each part that is read later.
    ///
    /// # Panics
    /// If there are more than [`LANES`] fragments.
    pub fn append(&mut self, count: usize, write: impl FnOnce(&mut Appended<'_, B>)) {
        assert!(count <= LANES, "at most a vector of fragments");
        self.form.get_or_insert_with(|| B::limit::<i32>(End::Low));
        self.grow(self.len + count);
        let numbers = *self.numbers.get_or_insert_with(numbered);
        let (stride, place) = (self.stride, self.len);
        write(&mut Appended { numbers, words: self.words_mut(), stride, place });
        self.len += count;
    }

    /// Adds `count` equal fragments, at most a vector of them.
    ///
    /// # Panics
    /// If there are more than [`LANES`] fragments.
    pub fn append_same(&mut self, count: usize, bundle: &B) {
        assert!(count <= LANES, "at most a vector of fragments");
        self.form.get_or_insert_with(|| B::limit::<i32>(End::Low));
        self.grow(self.len + count);
        let (stride, place) = (self.stride, self.len);
        bundle.rewire::<i32, _>(&mut Store::<LANES> { words: self.words_mut(), stride, place });
        self.len += count;
    }

    /// Puts the fragments into `ordered`, in a different order, in place of its content.
    pub(crate) fn reorder(&self, Order(order): &Order, ordered: &mut Self) {
        ordered.form = self.form;
        ordered.resize(order.len());
        for (words, from) in ordered.rows_mut().zip(self.rows()) {
            for (word, &fragment) in words.iter_mut().zip(order) {
                *word = from[fragment as usize];
            }
        }
    }

    /// Puts reordered fragments back into `own`, in their own order, in place of its content.
    pub(crate) fn restore(&self, Order(order): &Order, own: &mut Self) {
        own.form = self.form;
        own.resize(order.len());
        for (words, from) in own.rows_mut().zip(self.rows()) {
            for (word, &fragment) in from.iter().zip(order) {
                words[fragment as usize] = *word;
            }
        }
    }

    /// Any bundle of the batch; it shows which parts exist.
    pub(crate) fn form(&self) -> &B {
        self.form.as_ref().unwrap_or_else(|| unreachable!("fragments have a form"))
    }

    pub(crate) fn set_form(&mut self, form: B) {
        self.form = Some(form);
    }

    /// Rows, one word of all fragments each, with the room after them.
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

    /// Number of words from one row to the next.
    #[inline(always)]
    pub(crate) fn stride(&self) -> usize {
        self.stride
    }

    /// Sets the number of fragments. The content is undefined; the caller writes all of them.
    pub(crate) fn resize(&mut self, len: usize) {
        self.len = 0;
        self.grow(len);
        self.len = len;
    }

    /// Makes room for `len` fragments.
    fn grow(&mut self, len: usize) {
        let needed = len.next_multiple_of(GROUP) + LANES;
        if needed <= self.stride {
            return;
        }
        // An odd number of cache lines: the places of one fragment in all rows then lie in all the sets of a cache.
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

/// Takes the words at a place in the order of a walk.
struct Take<'a> {
    words: &'a [i32],
    stride: usize,
    /// Place of the next word.
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
