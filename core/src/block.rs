//! Block floating point: directions have no length.
//!
//! A [`Block`] is a few mantissas with one exponent, brought to max |mantissa| in [½, 1] by an exact shift and
//! one rounding to the profile's `fraction_bits`. Zero has exponent [`ZERO_EXPONENT`], so that it never wins an
//! alignment. These are compound steps: their ranges (|mantissa| ≤ 1, whatever came in) are claims an interval
//! walk cannot find; `host-tests/tests/datapath/arithmetic.rs` holds the proofs.

use crate::bundle::bundle;
use crate::each::each;
use crate::fx::{Fx, Wide};
use crate::word::{Wire, Word};

/// Fraction bits of a mantissa.
pub const MANTISSA: u32 = 30;

/// A number in [−1, 1].
pub type Mantissa<W> = Fx<W, MANTISSA>;

/// A power of two, or a count.
pub type Exponent<W> = Fx<W, 0>;

/// Exponent of a block of zeros. Real exponents stay within ±2^18, sums of them within ±2^23.
pub const ZERO_EXPONENT: i64 = -(1 << 20);

/// `N` mantissas with one exponent: component i is `m[i] · 2^e`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block<W, const N: usize> {
    /// Mantissas, the largest of them in [½, 1] by size, or all zero.
    pub m: [Mantissa<W>; N],
    /// Exponent.
    pub e: Exponent<W>,
}

bundle!(Block<N> { m, e });

impl<W: Word, const N: usize> Block<W, N> {
    /// All zero.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { m: [Mantissa::zero(); N], e: Exponent::lit(ZERO_EXPONENT) }
    }

    /// The block times `2^e`.
    #[inline(always)]
    pub fn scaled(self, e: Exponent<W>) -> Self {
        Self { m: self.m, e: self.e + e }
    }

    /// `if flag { a } else { b }`.
    #[inline(always)]
    pub fn select(flag: W::Flag, a: Self, b: Self) -> Self {
        let mut m = b.m;
        for (m, &a) in m.iter_mut().zip(&a.m) {
            *m = Fx::select(flag, a, *m);
        }
        Self { m, e: Fx::select(flag, a.e, b.e) }
    }

    /// Whether every component is zero.
    #[inline(always)]
    pub fn is_zero(&self) -> W::Flag {
        let mut zero = self.m[0].is_zero();
        for m in &self.m[1..] {
            zero = zero & m.is_zero();
        }
        zero
    }
}

impl<W: Word> Block<W, 1> {
    /// A single number on a wide wire as mantissa and exponent.
    #[inline(always)]
    pub fn of<const FRAC: u32>(wide: Wide<W, FRAC>, e: Exponent<W>, keep: u32) -> Self {
        normalise([wide], e, keep)
    }
}

/// Brings `N` wide numbers `wide[i] · 2^e` to a block whose largest |mantissa| is in [½, 1]: an exact left shift by
/// the common leading bits, then one rounding to `keep` fraction bits.
///
/// Range: any input. The largest mantissa may round up to 1; −1 occurs exactly, too.
#[inline(always)]
pub fn normalise<W: Word, const N: usize, const FRAC: u32>(
    wide: [Wide<W, FRAC>; N],
    e: Exponent<W>,
    keep: u32,
) -> Block<W, N> {
    // One's complement magnitude: −2^k counts as the octave below, which is what lets −1 occur.
    // 64 leading zeros are not enough for a block of zeros: −1 has them, too, but is negative.
    let (mut magnitude, mut bits) = (W::Wide::lit(0), W::Wide::lit(0));
    for w in &wide {
        magnitude = magnitude.or(w.raw().xor(w.raw().sar(63)));
        bits = bits.or(w.raw());
    }
    let zeros = Fx::<W, 0>::from_raw(magnitude.leading_zeros());
    let all_zero = zeros.ge(Fx::lit(64)) & !bits.lt(W::Wide::lit(0));
    let shift = zeros - Fx::lit(1);
    Block {
        // |wide · 2^shift| is in [2^62, 2^63): read with 63 fraction bits it is in [½, 1].
        m: each!(w in wide => Fx::<W::Wide, 63>::from_raw(w.raw().shl_by(shift.raw())).round_to::<MANTISSA>(keep)),
        e: Fx::select(all_zero, Fx::lit(ZERO_EXPONENT), e + Fx::lit(64 - i64::from(FRAC)) - zeros),
    }
}

/// The larger of two exponents decides; a count of places to shift is cut to what a word can lose.
#[inline(always)]
pub fn places_below<W: Word>(e: Exponent<W>, top: Exponent<W>, most: i64) -> Fx<W, 0> {
    (top - e).saturate(Fx::lit(0), Fx::lit(most))
}

/// Brings `COUNT` blocks to the largest of their exponents; smaller ones lose low bits by one rounding.
///
/// Range: no mantissa grows. An all-zero set keeps [`ZERO_EXPONENT`] (or a sum of it with real exponents).
#[inline(always)]
pub fn align<W: Word, const N: usize, const COUNT: usize>(
    blocks: [Block<W, N>; COUNT],
    keep: u32,
) -> ([[Mantissa<W>; N]; COUNT], Exponent<W>) {
    let mut top = blocks[0].e;
    for block in &blocks[1..] {
        top = top.max(block.e);
    }
    let aligned = each!(block in blocks => {
        let places = places_below(block.e, top, 31);
        each!(m in block.m => m.round_shr_by(places, keep))
    });
    (aligned, top)
}

/// Exact dot product, |·| ≤ N.
#[inline(always)]
pub fn dot<W: Word, const N: usize>(a: &[Mantissa<W>; N], b: &[Mantissa<W>; N]) -> Wide<W, 60> {
    let mut sum = Fx::zero();
    for (&x, &y) in a.iter().zip(b) {
        sum = sum + x.mul(y);
    }
    sum
}

/// Exact cross product of mantissas, each component |·| ≤ 2.
#[inline(always)]
pub fn cross<W: Word>(a: &[Mantissa<W>; 3], b: &[Mantissa<W>; 3]) -> [Wide<W, 60>; 3] {
    each!((i, j) in [(1, 2), (2, 0), (0, 1)] => a[i].mul::<MANTISSA, 60>(b[j]) - a[j].mul(b[i]))
}
