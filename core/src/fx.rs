//! `Fx<W, FRAC>`: a wire with its binary point in the type. The value is `raw / 2^FRAC`.
//!
//! Adding two different binary points does not compile; a product's binary point is stated by the caller and
//! checked at compile time. A wire is made where an operation is called, so a reading that records wires knows the
//! line of the stage (`track_caller`). The only lossy conversions are [`Fx::round_to`] and those named `saturate` or `floor`.

use core::ops::{Add, Neg, RangeInclusive, Sub};

use crate::word::{Wire, Word};

/// A wire `W` with `FRAC` fraction bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fx<W, const FRAC: u32>(W);

/// The wide companion of a word, with its binary point.
pub type Wide<W, const FRAC: u32> = Fx<<W as Word>::Wide, FRAC>;

impl<W: Wire, const FRAC: u32> Fx<W, FRAC> {
    /// Reads a raw wire as a number with `FRAC` fraction bits.
    #[inline(always)]
    pub fn from_raw(raw: W) -> Self {
        Self(raw)
    }

    /// The wire itself.
    #[inline(always)]
    pub fn raw(self) -> W {
        self.0
    }

    /// The constant `raw / 2^FRAC`.
    #[inline(always)]
    #[track_caller]
    pub fn lit(raw: i64) -> Self {
        Self(W::lit(raw))
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

    /// The same wire read with another binary point: the value changes by `2^(FRAC − OUT)`.
    #[inline(always)]
    pub fn reread<const OUT: u32>(self) -> Fx<W, OUT> {
        Fx(self.0)
    }

    /// `self < other`.
    #[inline(always)]
    #[track_caller]
    pub fn lt(self, other: Self) -> W::Flag {
        self.0.lt(other.0)
    }

    /// `self ≥ other`.
    #[inline(always)]
    #[track_caller]
    pub fn ge(self, other: Self) -> W::Flag {
        !self.0.lt(other.0)
    }

    /// `self = 0`.
    #[inline(always)]
    #[track_caller]
    pub fn is_zero(self) -> W::Flag {
        !self.0.lt(W::lit(0)) & self.0.lt(W::lit(1))
    }

    /// `if flag { a } else { b }`.
    #[inline(always)]
    #[track_caller]
    pub fn select(flag: W::Flag, a: Self, b: Self) -> Self {
        Self(W::select(flag, a.0, b.0))
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

    /// `−self` where the flag is set.
    #[inline(always)]
    #[track_caller]
    pub fn negate_if(self, flag: W::Flag) -> Self {
        Self::select(flag, -self, self)
    }

    /// Absolute value.
    #[inline(always)]
    #[track_caller]
    pub fn abs(self) -> Self {
        self.negate_if(self.lt(Self::zero()))
    }

    /// `self`, with the fact that its integer is in `range`, by the lemma of that name.
    #[inline(always)]
    #[track_caller]
    pub fn claim(self, range: RangeInclusive<i64>, lemma: &'static str) -> Self {
        Self(self.0.claim(*range.start(), *range.end(), lemma))
    }

    /// `⌊self / 2^k⌋` with the count on a wire.
    #[inline(always)]
    #[track_caller]
    pub fn floor_shr_by(self, k: Fx<W::Count, 0>) -> Self {
        Self(self.0.sar_by(k.0))
    }
}

impl<W: Word, const FRAC: u32> Fx<W, FRAC> {
    /// Exact product; `OUT = FRAC + OTHER`.
    #[inline(always)]
    #[track_caller]
    #[expect(clippy::should_implement_trait, reason = "an operator cannot state the binary point of the product")]
    pub fn mul<const OTHER: u32, const OUT: u32>(self, other: Fx<W, OTHER>) -> Wide<W, OUT> {
        const { assert!(FRAC + OTHER == OUT, "binary point of a product") }
        Fx(self.0.mul(other.0))
    }

    /// The same value on a wide wire with `OUT ≥ FRAC` fraction bits, exact.
    #[inline(always)]
    #[track_caller]
    pub fn widen<const OUT: u32>(self) -> Wide<W, OUT> {
        const { assert!(OUT >= FRAC, "widening keeps every bit") }
        Fx(self.0.widen().shl(OUT - FRAC))
    }

    /// The value rounded to nearest (ties up) at `keep` fraction bits; `keep ≤ FRAC`.
    #[inline(always)]
    #[track_caller]
    pub fn keep(self, keep: u32) -> Self {
        if keep >= FRAC {
            return self;
        }
        let drop = FRAC - keep;
        Self(self.0.sar(drop - 1).add(W::lit(1)).sar(1).shl(drop))
    }

    /// `self / 2^k`, rounded to nearest (ties up) at `keep` fraction bits, for a value already kept to `keep`
    /// bits and a count on a wire, `0 ≤ k ≤ 31`. `keep < FRAC` leaves the bit that doubling needs.
    #[inline(always)]
    #[track_caller]
    pub fn round_shr_by(self, k: Fx<W, 0>, keep: u32) -> Self {
        let unit = FRAC.saturating_sub(keep);
        let doubled = self.0.sar(unit).shl(1);
        Self(doubled.sar_by(k.0).add(W::lit(1)).sar(1).shl(unit))
    }
}

impl<X: Wire, const FRAC: u32> Fx<X, FRAC>
where
    X::Count: Word<Wide = X>,
{
    /// Narrowing of a wide wire, the one place where a value is rounded: to nearest, ties towards +∞, at `keep`
    /// fraction bits, as a word with `OUT` fraction bits. Range: the result fits 32 bits. `keep` is capped at
    /// `OUT`, which is below `FRAC`.
    #[inline(always)]
    #[track_caller]
    pub fn round_to<const OUT: u32>(self, keep: u32) -> Fx<X::Count, OUT> {
        const { assert!(OUT < FRAC, "rounding drops at least one bit") }
        let keep = if keep < OUT { keep } else { OUT };
        Fx(X::Count::round(self.0, FRAC - OUT, OUT - keep))
    }
}

impl<W: Wire, const FRAC: u32> Add for Fx<W, FRAC> {
    type Output = Self;
    #[inline(always)]
    #[track_caller]
    fn add(self, other: Self) -> Self {
        Self(self.0.add(other.0))
    }
}

impl<W: Wire, const FRAC: u32> Sub for Fx<W, FRAC> {
    type Output = Self;
    #[inline(always)]
    #[track_caller]
    fn sub(self, other: Self) -> Self {
        Self(self.0.sub(other.0))
    }
}

impl<W: Wire, const FRAC: u32> Neg for Fx<W, FRAC> {
    type Output = Self;
    #[inline(always)]
    #[track_caller]
    fn neg(self) -> Self {
        Self(W::lit(0).sub(self.0))
    }
}
