//! `Fx<X, INT>`: a wire with its binary point in the type, counted from the top. The value is `raw · 2^(INT − BITS)`: `INT` bits, the sign included,
//! stand before the binary point; the rest of the wire stands after it.
//!
//! A stage is therefore the same for words of any width: a mantissa has 2 bits before the point and a product of two has 4, however many follow.
//! Adding two different binary points does not compile. The caller states the binary point of a product, which is checked at compile time. A wire is
//! made where an operation is called, so a backend that records wires knows the line of the stage (`track_caller`). The only lossy conversions are
//! [`Fx::round_to`], [`Fx::quantise`] and those named `saturate`, `floor` or `index`.

use core::ops::{Add, Neg, Sub};

use crate::rom::upper;
use crate::word::{WideWire, Wire, Word};

/// A wire `X` with `INT` bits before the binary point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fx<X, const INT: u32>(X);

/// The wide companion of a word, with its binary point.
pub type Wide<W, const INT: u32> = Fx<<W as Word>::Wide, INT>;

/// A control word, 32 bits in every backend, with its binary point.
pub type Control<W, const INT: u32> = Fx<<W as Wire>::Count, INT>;

/// Wide companion of a control word, 64 bits in every backend.
pub type WideControl<W, const INT: u32> = Wide<<W as Wire>::Count, INT>;

/// A control integer: an exponent, a count, an index.
pub type Int<W> = Control<W, 32>;

impl<X: Wire, const INT: u32> Fx<X, INT> {
    /// Bits after the binary point.
    pub const FRACTION: u32 = X::BITS - INT;

    /// Reads a raw wire as a number with `INT` bits before its binary point.
    #[inline(always)]
    pub fn from_raw(raw: X) -> Self {
        Self(raw)
    }

    /// Raw wire.
    #[inline(always)]
    pub fn raw(self) -> X {
        self.0
    }

    /// Constant of `raw` last places.
    #[inline(always)]
    #[track_caller]
    pub fn lit(raw: i64) -> Self {
        Self(X::lit(raw))
    }

    /// Constant `number · 2^e`; its last place is on the wire.
    #[inline(always)]
    #[track_caller]
    pub fn number(number: i64, e: i32) -> Self {
        Self::lit(number << (Self::FRACTION as i32 + e))
    }

    /// Constant of an integer.
    #[inline(always)]
    #[track_caller]
    pub fn int(number: i64) -> Self {
        Self::number(number, 0)
    }

    /// The largest number below an integer.
    #[inline(always)]
    #[track_caller]
    pub fn below(number: i64) -> Self {
        Self::lit((number << Self::FRACTION) - 1)
    }

    /// Zero.
    #[inline(always)]
    #[track_caller]
    pub fn zero() -> Self {
        Self::lit(0)
    }

    /// `self · 2^k`, exact.
    #[inline(always)]
    #[track_caller]
    #[expect(clippy::should_implement_trait, reason = "an operator would hide that this one is exact")]
    pub fn shl(self, k: u32) -> Self {
        Self(self.0.shl(k))
    }

    /// `⌊self / 2^k⌋` in units of the last place.
    #[inline(always)]
    #[track_caller]
    pub fn floor_shr(self, k: u32) -> Self {
        Self(self.0.sar(k))
    }

    /// Reads the same wire with another binary point: the value changes by `2^(OUT − INT)`.
    #[inline(always)]
    pub fn reread<const OUT: u32>(self) -> Fx<X, OUT> {
        Fx(self.0)
    }

    /// `self < other`.
    #[inline(always)]
    #[track_caller]
    pub fn lt(self, other: Self) -> X::Flag {
        self.0.lt(other.0)
    }

    /// `self ≥ other`.
    #[inline(always)]
    #[track_caller]
    pub fn ge(self, other: Self) -> X::Flag {
        !self.0.lt(other.0)
    }

    /// `self = 0`.
    #[inline(always)]
    #[track_caller]
    pub fn is_zero(self) -> X::Flag {
        !self.0.lt(X::lit(0)) & self.0.lt(X::lit(1))
    }

    /// `if flag { a } else { b }`.
    #[inline(always)]
    #[track_caller]
    pub fn select(flag: X::Flag, a: Self, b: Self) -> Self {
        Self(X::select(flag, a.0, b.0))
    }

    /// The smaller of the two.
    #[inline(always)]
    #[track_caller]
    pub fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }

    /// The larger of the two.
    #[inline(always)]
    #[track_caller]
    pub fn max(self, other: Self) -> Self {
        Self::select(self.lt(other), other, self)
    }

    /// Saturates to `low ..= high`.
    #[inline(always)]
    #[track_caller]
    pub fn saturate(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }

    /// `−self` if the flag is set.
    #[inline(always)]
    #[track_caller]
    pub fn negate_if(self, flag: X::Flag) -> Self {
        Self::select(flag, -self, self)
    }

    /// Absolute value.
    #[inline(always)]
    #[track_caller]
    pub fn abs(self) -> Self {
        self.negate_if(self.lt(Self::zero()))
    }

    /// `self`, with the fact that it is in `low·2^e ..= high·2^e`, by the named lemma.
    #[inline(always)]
    #[track_caller]
    pub fn claim(self, low: i64, high: i64, e: i32, lemma: &'static str) -> Self {
        let places = Self::FRACTION as i32 + e;
        Self(self.0.claim(low << places, high << places, lemma))
    }

    /// `self`, with the fact that it is in [0, 2^e), by the named lemma.
    #[inline(always)]
    #[track_caller]
    pub fn claim_below(self, e: i32, lemma: &'static str) -> Self {
        Self(self.0.claim(0, (1 << (Self::FRACTION as i32 + e)) - 1, lemma))
    }

    /// `⌊self / 2^k⌋` with the count on a wire.
    #[inline(always)]
    #[track_caller]
    pub fn floor_shr_by(self, k: Fx<X::Count, 32>) -> Self {
        Self(self.0.sar_by(k.raw()))
    }
}

impl<W: Word, const INT: u32> Fx<W, INT> {
    /// Exact product; `OUT = INT + OTHER`.
    #[inline(always)]
    #[track_caller]
    #[expect(clippy::should_implement_trait, reason = "an operator cannot state the binary point of the product")]
    pub fn mul<const OTHER: u32, const OUT: u32>(self, other: Fx<W, OTHER>) -> Wide<W, OUT> {
        const { assert!(INT + OTHER == OUT, "binary point of a product") }
        Fx(self.0.mul(other.0))
    }

    /// Value on the wide wire with `OUT ≥ INT` bits before the point, exact.
    #[inline(always)]
    #[track_caller]
    pub fn widen<const OUT: u32>(self) -> Wide<W, OUT> {
        const { assert!(OUT >= INT && OUT - INT <= W::BITS, "widening keeps every bit") }
        Fx(self.0.widen().shl(W::BITS - (OUT - INT)))
    }

    /// The value rounded to nearest (ties up) at `fraction_bits` fraction bits.
    #[inline(always)]
    #[track_caller]
    pub fn quantise(self, fraction_bits: u32) -> Self {
        if W::WHOLE || fraction_bits >= Self::FRACTION {
            return self;
        }
        let drop = Self::FRACTION - fraction_bits;
        Self(self.0.sar(drop - 1).add(W::lit(1)).sar(1).shl(drop))
    }

    /// `self / 2^k`, rounded to nearest (ties up) at `fraction_bits` fraction bits, for a value already kept to that many bits. The count `k` is on a wire and
    /// below the width of the word. Range: if the word has no more than `fraction_bits` bits, below its largest.
    #[inline(always)]
    #[track_caller]
    pub fn round_shr_by(self, k: Fx<W::Count, 32>, fraction_bits: u32) -> Self {
        if W::WHOLE || fraction_bits >= Self::FRACTION {
            // No bit is free for doubling, so one place less is shifted first.
            let before = self.0.sar_by((k - Fx::int(1)).max(Fx::zero()).raw());
            return Self::select(k.is_zero(), self, Self(before.add(W::lit(1)).sar(1)));
        }
        let unit = Self::FRACTION - fraction_bits;
        let doubled = self.0.sar(unit).shl(1);
        Self(doubled.sar_by(k.raw()).add(W::lit(1)).sar(1).shl(unit))
    }

    /// Constant of a 32-bit word with the same binary point; a word keeps its [`upper`] bits.
    #[inline(always)]
    #[track_caller]
    pub fn entry(value: i32) -> Self {
        Self::lit(upper(value, W::BITS).into())
    }

    /// Entry of a table of 32-bit words with the same binary point.
    #[inline(always)]
    #[track_caller]
    pub fn lookup(index: Fx<W::Count, 32>, table: &'static [i32]) -> Self {
        Self(W::lookup(index.raw(), table))
    }

    /// `⌊self · 2^places⌋`: place in a table of 2^`places` entries for each unit.
    #[inline(always)]
    #[track_caller]
    pub fn index(self, places: u32) -> Fx<W::Count, 32> {
        let fraction = Self::FRACTION;
        if fraction >= places {
            Fx(self.0.sar(fraction - places).to_count())
        } else {
            Fx(self.0.to_count().shl(places - fraction))
        }
    }

    /// `index / 2^places`, the inverse of [`Self::index`]. Exact if the word has that many fraction bits, else floored to its last place.
    #[inline(always)]
    #[track_caller]
    pub fn of_index(index: Fx<W::Count, 32>, places: u32) -> Self {
        let fraction = Self::FRACTION;
        if fraction >= places {
            Self(W::of_count(index.raw()).shl(fraction - places))
        } else {
            Self(W::of_count(index.raw().sar(places - fraction)))
        }
    }

    /// Value as a control number, floored to its last place.
    #[inline(always)]
    #[track_caller]
    pub fn to_control<const OUT: u32>(self) -> Fx<W::Count, OUT> {
        let (from, to) = (Self::FRACTION, 32 - OUT);
        let count = self.0.to_count();
        Fx(if to >= from { count.shl(to - from) } else { count.sar(from - to) })
    }

    /// Control number as a word, floored to its last place. Range: it fits.
    #[inline(always)]
    #[track_caller]
    pub fn of_control<const FROM: u32>(control: Fx<W::Count, FROM>) -> Self {
        let (from, to) = (32 - FROM, Self::FRACTION);
        if to >= from {
            Self(W::of_count(control.raw()).shl(to - from))
        } else {
            Self(W::of_count(control.raw().sar(from - to)))
        }
    }
}

impl<X: WideWire, const INT: u32> Fx<X, INT> {
    /// Narrows a wide wire, the one place where a value is rounded: to nearest, ties towards +∞, at `fraction_bits` fraction bits, as a word with `OUT` bits
    /// before its binary point. Range: the result fits the word. `fraction_bits` is capped at the fraction bits of the word, which has fewer than the wide
    /// wire.
    #[inline(always)]
    #[track_caller]
    pub fn round_to<const OUT: u32>(self, fraction_bits: u32) -> Fx<X::Word, OUT> {
        let (drop, up) = Self::places_to_round::<OUT>(fraction_bits);
        Fx(X::Word::round(self.0, drop, up))
    }

    /// Number of places that narrowing drops, and how many places of the word it then clears, as [`Word::round`] takes them.
    #[inline(always)]
    pub fn places_to_round<const OUT: u32>(fraction_bits: u32) -> (u32, u32) {
        let fraction = Fx::<X::Word, OUT>::FRACTION;
        const { assert!(Self::FRACTION > Fx::<X::Word, OUT>::FRACTION, "rounding drops at least one bit") }
        let fraction_bits = if X::Word::WHOLE || fraction_bits >= fraction { fraction } else { fraction_bits };
        (Self::FRACTION - fraction, fraction - fraction_bits)
    }

    /// Narrows as [`Self::round_to`] does, to a control number with as many of its fraction bits as the wide wire has. On narrow words these are more
    /// than a word would have.
    #[inline(always)]
    #[track_caller]
    pub fn round_to_control<const OUT: u32>(self, fraction_bits: u32) -> Fx<X::Count, OUT> {
        if X::Word::BITS == X::Count::BITS {
            return self.round_to::<OUT>(fraction_bits).to_control();
        }
        let (from, to) = (Self::FRACTION, X::Count::BITS - OUT);
        if from <= fraction_bits {
            return Fx(self.0.wide_to_count().shl(to - from));
        }
        Fx(self.0.sar(from - fraction_bits - 1).add(X::lit(1)).sar(1).wide_to_count().shl(to - fraction_bits))
    }

    /// Control number on the wide wire, floored to its last place. Range: it fits.
    #[inline(always)]
    #[track_caller]
    pub fn wide_of_control<const FROM: u32>(count: Fx<X::Count, FROM>) -> Self {
        let (from, to) = (X::Count::BITS - FROM, Self::FRACTION);
        if to >= from {
            Self(X::wide_of_count(count.raw()).shl(to - from))
        } else {
            Self(X::wide_of_count(count.raw().sar(from - to)))
        }
    }

    /// `self · 2^e` with `OUT` bits before the point, floored to the last place. Range: `e ≤ OUT − INT`; a larger one counts as that.
    #[inline(always)]
    #[track_caller]
    pub fn at_exponent<const OUT: u32>(self, e: Fx<X::Count, 32>) -> Fx<X, OUT> {
        let places = (Fx::int(i64::from(OUT - INT)) - e).saturate(Fx::int(0), Fx::int(i64::from(X::BITS - 2)));
        self.reread().floor_shr_by(places)
    }
}

impl<X: Wire, const INT: u32> Add for Fx<X, INT> {
    type Output = Self;
    #[inline(always)]
    #[track_caller]
    fn add(self, other: Self) -> Self {
        Self(self.0.add(other.0))
    }
}

impl<X: Wire, const INT: u32> Sub for Fx<X, INT> {
    type Output = Self;
    #[inline(always)]
    #[track_caller]
    fn sub(self, other: Self) -> Self {
        Self(self.0.sub(other.0))
    }
}

impl<X: Wire, const INT: u32> Neg for Fx<X, INT> {
    type Output = Self;
    #[inline(always)]
    #[track_caller]
    fn neg(self) -> Self {
        Self(X::lit(0).sub(self.0))
    }
}
