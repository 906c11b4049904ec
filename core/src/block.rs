//! Block floating point: directions have no length.
//!
//! A [`Block`] is a few mantissas with one exponent. An exact shift and one rounding to the profile's `fraction_bits` bring max |mantissa| to [½, 1].
//! Zero has exponent [`ZERO_EXPONENT`], so that it never wins an alignment. These are compound steps. Their ranges (|mantissa| ≤ 1 for any input) are
//! claims that an interval walk cannot find; `host-tests` has the proofs (`arithmetic`).

use crate::bundle::bundle;
use crate::each::each;
use crate::fx::{Fx, Int, Wide};
use crate::word::{WideWire, Word};

/// Bits of a mantissa before its binary point.
pub const MANTISSA: u32 = 2;
/// Bits of a product of two mantissas before its binary point.
pub const PRODUCT: u32 = 2 * MANTISSA;

/// A number in [−1, 1].
pub type Mantissa<W> = Fx<W, MANTISSA>;

/// Exact product of two mantissas, or a sum of a few such products.
pub type Product<W> = Wide<W, PRODUCT>;

/// Largest exponent of a vector that enters the datapath, in either direction. Every float64 has a smaller one.
pub const MAX_EXPONENT: i64 = 1 << 11;

/// Exponent of a block of zeros. Exponents of other blocks stay within ±2^14.1. Entering exponents are within ±[`MAX_EXPONENT`], those of columns
/// within twice that, of a covariance four times, of its determinant eight times, each plus a few hundred.
pub const ZERO_EXPONENT: i64 = -(1 << 15);

bundle! {
    /// `N` mantissas with one exponent: component i is `m[i] · 2^e`.
    pub struct Block<W, const N: usize> {
        /// Mantissas, the largest of them in [½, 1] by size, or all zero.
        #[range(-1..=1)]
        m: [Mantissa<W>; N],
        /// Exponent; in a scaled block it is a sum of several.
        #[range(-131072..=131072)]
        e: Int<W>,
    }
}

impl<W: Word<Count: PartialEq> + PartialEq, const N: usize> PartialEq for Block<W, N> {
    fn eq(&self, other: &Self) -> bool {
        (self.m, self.e) == (other.m, other.e)
    }
}

/// A number with an exponent of its own.
pub type Number<W> = Block<W, 1>;

impl<W: Word, const N: usize> Block<W, N> {
    /// Block of zeros.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { m: [Mantissa::zero(); N], e: Fx::int(ZERO_EXPONENT) }
    }

    /// The block times `2^e`.
    #[inline(always)]
    pub fn scaled(self, e: Int<W>) -> Self {
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

    /// Returns true if every component is zero.
    #[inline(always)]
    pub fn is_zero(&self) -> W::Flag {
        let mut zero = self.m[0].is_zero();
        for m in &self.m[1..] {
            zero = zero & m.is_zero();
        }
        zero
    }

    /// Block times a number, rounded once.
    #[inline(always)]
    pub fn times(&self, k: &Number<W>, fraction_bits: u32) -> Self {
        normalise(each!(m in self.m => m.mul::<MANTISSA, PRODUCT>(k.m[0])), self.e + k.e, fraction_bits)
    }

    /// |a|² over the components, rounded once.
    #[inline(always)]
    pub fn square_length(&self, fraction_bits: u32) -> Number<W> {
        number(dot(&self.m, &self.m), self.e + self.e, fraction_bits)
    }

    /// Mantissas at a larger exponent, rounded at `fraction_bits` fraction bits.
    #[inline(always)]
    pub fn mantissas_at(&self, e: Int<W>, fraction_bits: u32) -> [Mantissa<W>; N] {
        let places = places_below(self.e, e, W::BITS - 1);
        each!(m in self.m => m.round_shr_by(places, fraction_bits))
    }
}

impl<W: Word> Number<W> {
    /// The number 1.
    #[inline(always)]
    pub fn one() -> Self {
        Self { m: [Fx::number(1, -1)], e: Fx::int(1) }
    }

    /// The number with `OUT` bits before the point of a wide wire, floored to its last place. Range: the exponent is at most `OUT − PRODUCT`; a
    /// larger one counts as that.
    #[inline(always)]
    pub fn at_point<const OUT: u32>(&self) -> Wide<W, OUT> {
        self.m[0].widen::<PRODUCT>().at_exponent(self.e)
    }
}

/// Block of control words as one of mantissas. Range: its mantissas fit the word.
#[inline(always)]
pub fn of_control<W: Word, const N: usize>(block: Block<W::Count, N>) -> Block<W, N> {
    Block { m: each!(m in block.m => Fx::of_control(m)), e: block.e }
}

/// Single number on a wide wire as mantissa and exponent.
#[inline(always)]
pub fn number<X: WideWire, const INT: u32>(
    wide: Fx<X, INT>,
    e: Fx<X::Count, 32>,
    fraction_bits: u32,
) -> Number<X::Word> {
    normalise([wide], e, fraction_bits)
}

/// Normalises `N` wide numbers `wide[i] · 2^e` to a block whose largest |mantissa| is in [½, 1]: an exact left shift by the common leading bits, then
/// one rounding to `fraction_bits` fraction bits.
///
/// Range: any input. The largest mantissa may round up to 1; −1 also occurs exactly.
#[inline(always)]
pub fn normalise<X: WideWire, const N: usize, const INT: u32>(
    wide: [Fx<X, INT>; N],
    e: Fx<X::Count, 32>,
    fraction_bits: u32,
) -> Block<X::Word, N> {
    // Shifted, with one bit before the point, the largest number is in [½, 1].
    let (drop, up) = Fx::<X, 1>::places_to_round::<MANTISSA>(fraction_bits);
    let (m, zeros, all_zero) = X::normalised(each!(w in wide => w.raw()), drop, up);
    let zeros = Fx::<X::Count, 32>::from_raw(zeros);
    Block {
        m: each!(m in m => Fx::from_raw(m)),
        e: Fx::select(all_zero, Fx::int(ZERO_EXPONENT), e + Fx::int(INT.into()) - zeros),
    }
}

/// Places by which a block of exponent `e` is shifted to reach `top`, clamped to what a wire can lose. An `e` above `top` is not shifted.
#[inline(always)]
pub fn places_below<C: Word<Count = C>>(e: Fx<C, 32>, top: Fx<C, 32>, most: u32) -> Fx<C, 32> {
    (top - e).saturate(Fx::int(0), Fx::int(most.into()))
}

/// Aligns `COUNT` blocks to the largest of their exponents. Smaller blocks lose low bits by one rounding.
///
/// Range: no mantissa grows. A set of zeros keeps [`ZERO_EXPONENT`], or a sum of it with real exponents.
#[inline(always)]
pub fn align<W: Word, const N: usize, const COUNT: usize>(
    blocks: [Block<W, N>; COUNT],
    fraction_bits: u32,
) -> ([[Mantissa<W>; N]; COUNT], Int<W>) {
    let mut top = blocks[0].e;
    for block in &blocks[1..] {
        top = top.max(block.e);
    }
    (each!(block in blocks => block.mantissas_at(top, fraction_bits)), top)
}

/// Exact dot product, |·| ≤ N.
#[inline(always)]
pub fn dot<W: Word, const N: usize>(a: &[Mantissa<W>; N], b: &[Mantissa<W>; N]) -> Product<W> {
    let mut sum = Fx::zero();
    for (&x, &y) in a.iter().zip(b) {
        sum = sum + x.mul(y);
    }
    sum
}

/// Exact cross product of mantissas, each component |·| ≤ 2.
#[inline(always)]
pub fn cross<W: Word>(a: &[Mantissa<W>; 3], b: &[Mantissa<W>; 3]) -> [Product<W>; 3] {
    each!((i, j) in [(1, 2), (2, 0), (0, 1)] => a[i].mul::<MANTISSA, PRODUCT>(b[j]) - a[j].mul(b[i]))
}
