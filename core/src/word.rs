//! The algebra in which every stage is written: signed integers on *wires*. A *word* carries mantissas. Its *wide* companion has twice the bits and
//! holds sums of products exactly. A *count* controls (exponents, indices, levels) and has 32 bits for words of any width. A *backend* implements
//! these traits; [`crate::scalar`] is the meaning. No operation may leave its wire: `roughxel ranges`.

use core::fmt::Debug;
use core::ops::{BitAnd, BitOr, Not};

/// Operations common to words and wide wires. Shift counts are `0 ≤ k <` the width of the wire.
pub trait Wire: Copy + Debug {
    /// One-bit wire, the outcome of a comparison.
    type Flag: Copy + Debug + Not<Output = Self::Flag> + BitAnd<Output = Self::Flag> + BitOr<Output = Self::Flag>;
    /// Control word.
    type Count: Word<Flag = Self::Flag, Count = Self::Count>;
    /// Bits of the wire.
    const BITS: u32;
    /// Constant. The value fits the wire.
    fn lit(value: i64) -> Self;
    /// `self + other`, exact.
    fn add(self, other: Self) -> Self;
    /// `self − other`, exact.
    fn sub(self, other: Self) -> Self;
    /// `self · 2^k`, exact.
    fn shl(self, k: u32) -> Self;
    /// `⌊self / 2^k⌋`: arithmetic shift.
    fn sar(self, k: u32) -> Self;
    /// `self · 2^k` for a count on a wire, exact.
    fn shl_by(self, k: Self::Count) -> Self;
    /// `⌊self / 2^k⌋` for a count on a wire.
    fn sar_by(self, k: Self::Count) -> Self;
    /// Bitwise and.
    fn and(self, other: Self) -> Self;
    /// Bitwise or.
    fn or(self, other: Self) -> Self;
    /// Bitwise exclusive or.
    fn xor(self, other: Self) -> Self;
    /// `self < other`, signed.
    fn lt(self, other: Self) -> Self::Flag;
    /// `if flag { a } else { b }`; both sides exist in hardware.
    fn select(flag: Self::Flag, a: Self, b: Self) -> Self;
    /// Leading zero bits; the width of the wire for 0.
    fn leading_zeros(self) -> Self::Count;
    /// Runs `body`. Its outcome is `instead`, or has no use, if the flag is set; a backend that branches skips the work.
    #[inline(always)]
    fn unless<T>(_flag: Self::Flag, _instead: T, body: impl FnOnce() -> T) -> T {
        body()
    }
    /// `self`, with a fact that intervals cannot find: `low ≤ self ≤ high` by the named lemma, a test.
    #[inline(always)]
    fn claim(self, _low: i64, _high: i64, _lemma: &'static str) -> Self {
        self
    }
}
/// A wire for mantissas or, if it is its own [`Wire::Count`], a control wire.
pub trait Word: Wire {
    /// True if every profile that runs on these words keeps all their bits; no rounding then needs to ask how many.
    const WHOLE: bool = false;
    /// The companion of twice the bits.
    type Wide: WideWire<Flag = Self::Flag, Count = Self::Count, Word = Self>;
    /// Exact product.
    fn mul(self, other: Self) -> Self::Wide;
    /// Integer of the word on the wide wire.
    fn widen(self) -> Self::Wide;
    /// Integer of the wide wire on a word. It fits.
    fn narrow(wide: Self::Wide) -> Self;
    /// `⌊wide/2^(drop + up) + ½⌋·2^up`, `drop ≥ 1`. A backend may compute it in a shorter way. The value fits.
    #[inline(always)]
    #[track_caller]
    fn round(wide: Self::Wide, drop: u32, up: u32) -> Self {
        Self::narrow(wide.sar(drop + up - 1).add(Self::Wide::lit(1)).sar(1)).shl(up)
    }
    /// `table[index]`, of which a word keeps the [`upper`](crate::rom::upper) bits. The index is inside the table.
    fn lookup(index: Self::Count, table: &'static [i32]) -> Self;
    /// Integer of the word as a count.
    fn to_count(self) -> Self::Count;
    /// Integer of the count on a word. It fits.
    fn of_count(count: Self::Count) -> Self;
}
/// The wide companion of a word.
pub trait WideWire: Wire {
    /// Word of the wide companion.
    type Word: Word<Wide = Self, Flag = Self::Flag, Count = Self::Count>;
    /// Integer of the wide wire as a count. It fits.
    fn wide_to_count(self) -> Self::Count;
    /// Integer of the count on a wide wire. It fits.
    fn wide_of_count(count: Self::Count) -> Self;
    /// `wires` shifted left until the highest bit of one of them is next to the sign, each rounded as by [`Word::round`]; their common leading bits;
    /// and whether all are zero. [`crate::normalised`] says it in operations; a backend may have a shorter way. `drop + up` is more than the bits of
    /// a word.
    fn normalised<const N: usize>(wires: [Self; N], drop: u32, up: u32) -> ([Self::Word; N], Self::Count, Self::Flag);
}
