//! Rows of neighbouring fragments, added to a batch by the names of its wires.

use roughxel_core::bundle::Rewire;
use roughxel_core::design::Form;
use roughxel_core::fx::WideControl;
use roughxel_core::ports::PortBlock;
use roughxel_simd::LANES;

/// A word for each of [`LANES`] fragments.
pub type Row = [i32; LANES];

/// Words of a block for each of [`LANES`] fragments.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct BlockRows<const N: usize> {
    /// Mantissas.
    pub mantissa: [Row; N],
    /// Exponents.
    pub exponent: Row,
}

impl<const N: usize> Default for BlockRows<N> {
    fn default() -> Self {
        Self { mantissa: [[0; LANES]; N], exponent: [0; LANES] }
    }
}

/// Writer of the rows that [`Batch::append`](super::Batch::append) adds. A part that is not written keeps what the memory held.
pub struct Appended<'a, B> {
    pub(super) numbers: B,
    pub(super) words: &'a mut [i32],
    pub(super) stride: usize,
    /// Place of the first fragment.
    pub(super) place: usize,
}

impl<B: Form> Appended<'_, B> {
    /// Writes the rows of all words, in the order of a walk.
    ///
    /// # Panics
    /// If the number of rows is not the number of words of the bundle.
    pub fn words(&mut self, rows: &[Row]) {
        assert_eq!(rows.len(), B::WORDS, "a row of each word");
        for (number, row) in (0..).zip(rows) {
            self.put(number, row);
        }
    }

    /// Writes the rows of a block.
    #[inline(always)]
    pub fn block<const N: usize>(&mut self, block: impl Fn(&B) -> PortBlock<i32, N>, rows: &BlockRows<N>) {
        let PortBlock { mantissa, exponent } = block(&self.numbers);
        for (wire, row) in mantissa.iter().zip(&rows.mantissa) {
            self.put(wire.raw(), row);
        }
        self.put(exponent.raw(), &rows.exponent);
    }

    /// Writes the lower words of a wide number in [0, 2^32), and zeros above them.
    #[inline(always)]
    pub fn low<const INT: u32>(&mut self, wide: impl Fn(&B) -> WideControl<i32, INT>, row: &Row) {
        let number = wide(&self.numbers).raw() as i32;
        self.put(number, row);
        self.put(number + 1, &[0; LANES]);
    }

    #[inline(always)]
    fn put(&mut self, number: i32, row: &Row) {
        self.words[number as usize * self.stride + self.place..][..LANES].copy_from_slice(row);
    }
}

/// Stores the words of a walk at `PLACES` places of each row; a wide wire is two words, a flag is 0 or 1.
pub(super) struct Store<'a, const PLACES: usize> {
    pub(super) words: &'a mut [i32],
    pub(super) stride: usize,
    /// Place of the next word.
    pub(super) place: usize,
}

impl<const PLACES: usize> Rewire<i32, i32> for Store<'_, PLACES> {
    #[inline(always)]
    fn word(&mut self, wire: i32, _: u32) -> i32 {
        self.words[self.place..][..PLACES].fill(wire);
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
