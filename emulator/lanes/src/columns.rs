//! Bundles of many fragments, wire by wire: what lanes load and store without putting words together one by one.

use roughxel_core::bundle::{End, Rewire};
use roughxel_core::design::Form;

use super::LANES;
use super::order::Order;

/// Fragments of the larger group of lanes: rows have room for whole ones.
pub(super) const GROUP: usize = 2 * LANES;

/// A bundle of each of many fragments; a row holds one word of all.
#[derive(Clone, Debug)]
pub struct Columns<B> {
    /// Which of its parts there are: a plan leaves some out.
    form: Option<B>,
    words: Vec<i32>,
    /// Words of a row, with room behind the last fragment for a whole vector.
    stride: usize,
    len: usize,
}

impl<B> Default for Columns<B> {
    fn default() -> Self {
        Self { form: None, words: Vec::new(), stride: 0, len: 0 }
    }
}

impl<B: Form> FromIterator<B> for Columns<B> {
    fn from_iter<I: IntoIterator<Item = B>>(bundles: I) -> Self {
        let mut columns = Self::default();
        let bundles = bundles.into_iter();
        columns.grow(bundles.size_hint().0);
        bundles.for_each(|bundle| columns.push(&bundle));
        columns
    }
}

impl<B: Form> Columns<B> {
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
        bundle.rewire::<i32, _>(&mut Store { words: &mut self.words, stride: self.stride, place: self.len });
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
        for row in self.words.chunks_exact_mut(self.stride) {
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
        self.form().rewire::<i32, _>(&mut Take { words: &self.words, stride: self.stride, place: index })
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
        &self.words[word * self.stride..][..self.len]
    }

    /// Adds `count` fragments word by word, at most a vector of them: a row of each word, in the order of a walk.
    ///
    /// # Panics
    /// If there are more, or not a row of each word.
    pub fn append(&mut self, count: usize, rows: &[[i32; LANES]]) {
        assert!(count <= LANES && rows.len() == B::WORDS, "a vector of each word");
        self.form.get_or_insert_with(|| B::limit::<i32>(End::Low));
        self.grow(self.len + count);
        for (words, row) in self.words.chunks_exact_mut(self.stride).zip(rows) {
            words[self.len..][..LANES].copy_from_slice(row);
        }
        self.len += count;
    }

    /// Adds `count` fragments that are all the same, at most a vector of them: each word in the order of a walk.
    ///
    /// # Panics
    /// If there are more, or not all words.
    pub fn append_same(&mut self, count: usize, words: &[i32]) {
        assert!(count <= LANES && words.len() == B::WORDS, "all words");
        self.form.get_or_insert_with(|| B::limit::<i32>(End::Low));
        self.grow(self.len + count);
        for (row, &word) in self.words.chunks_exact_mut(self.stride).zip(words) {
            row[self.len..][..LANES].fill(word);
        }
        self.len += count;
    }

    /// The fragments in another order, in place of what `ordered` held.
    pub(super) fn reorder(&self, Order(order): &Order, ordered: &mut Self) {
        ordered.form = self.form;
        ordered.resize(order.len());
        for (words, from) in ordered.words.chunks_exact_mut(ordered.stride).zip(self.words.chunks_exact(self.stride)) {
            for (word, &fragment) in words.iter_mut().zip(order) {
                *word = from[fragment as usize];
            }
        }
    }

    /// Fragments in another order back in their own, in place of what `own` held.
    pub(super) fn restore(&self, Order(order): &Order, own: &mut Self) {
        own.form = self.form;
        own.resize(order.len());
        for (words, from) in own.words.chunks_exact_mut(own.stride).zip(self.words.chunks_exact(self.stride)) {
            for (word, &fragment) in from.iter().zip(order) {
                words[fragment as usize] = *word;
            }
        }
    }

    /// Any bundle of them: what parts there are.
    pub(super) fn form(&self) -> &B {
        self.form.as_ref().unwrap_or_else(|| unreachable!("fragments have a form"))
    }

    pub(super) fn set_form(&mut self, form: B) {
        self.form = Some(form);
    }

    pub(super) fn rows(&self) -> Rows<'_> {
        Rows { words: &self.words, stride: self.stride }
    }

    pub(super) fn rows_mut(&mut self) -> RowsMut<'_> {
        RowsMut { words: &mut self.words, stride: self.stride }
    }

    /// So many fragments, in place of what there was; whoever asks writes all of them.
    pub(super) fn resize(&mut self, len: usize) {
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
        let mut words = vec![0; stride * B::WORDS];
        if self.stride > 0 {
            for (row, old) in words.chunks_exact_mut(stride).zip(self.words.chunks_exact(self.stride)) {
                row[..self.len].copy_from_slice(&old[..self.len]);
            }
        }
        (self.words, self.stride) = (words, stride);
    }
}

/// All words of columns, to be read.
#[derive(Clone, Copy)]
pub(super) struct Rows<'a> {
    words: &'a [i32],
    stride: usize,
}

impl<'a> Rows<'a> {
    /// One word of all.
    #[inline(always)]
    pub(super) fn row(&self, word: usize) -> &'a [i32] {
        &self.words[word * self.stride..][..self.stride]
    }

    /// A vector of a row.
    #[inline(always)]
    pub(super) fn lanes(row: &[i32], first: usize) -> [i32; LANES] {
        row[first..][..LANES].as_chunks().0[0]
    }
}

/// The same, to be written.
pub(super) struct RowsMut<'a> {
    words: &'a mut [i32],
    stride: usize,
}

impl RowsMut<'_> {
    /// A vector of a word.
    #[inline(always)]
    pub(super) fn set_lanes(&mut self, word: usize, first: usize, lanes: [i32; LANES]) {
        self.words[word * self.stride + first..][..LANES].copy_from_slice(&lanes);
    }
}

/// Puts the words of a walk into a place of each row; a wide wire is two of them, a flag is 0 or 1.
struct Store<'a> {
    words: &'a mut [i32],
    stride: usize,
    /// Of the next word.
    place: usize,
}

impl Rewire<i32, i32> for Store<'_> {
    #[inline(always)]
    fn word(&mut self, wire: i32, _: u32) -> i32 {
        self.words[self.place] = wire;
        self.place += self.stride;
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
