//! 16-bit words, for [`NARROW_LANES`] fragments at once: twice as many as 32-bit words in the same vectors.
//!
//! A 32-bit value, be it a wide wire of such words or a count, is two wires of [`LANES`] fragments: the even and the odd ones. The operations are
//! then those of 32-bit words, and a count that comes from a wide wire needs no conversion. A flag is kept for words and for both halves; the
//! optimiser drops the unused ones.

use std::ops::{BitAnd, BitOr, Not};

use roughxel_core::bundle::Bundle;
use roughxel_core::each::{each, places};
use roughxel_core::normalised::normalised;
use roughxel_core::staged::Staged;
use roughxel_core::word::{WideWire, Wire, Word};

use super::{FlagLanes, LANES, Lanes, Target, WideLanes, any, stage};

/// Kept fraction bits of the profiles that run in narrow lanes: all that a 16-bit word has.
pub const KEPT: u32 = 14;

/// Fragments in lanes on 16-bit words.
pub const NARROW_LANES: usize = 2 * LANES;

/// A 16-bit word of [`NARROW_LANES`] fragments, for the instruction set `T`, of profiles that keep [`KEPT`] bits.
#[derive(Clone, Copy, Debug)]
pub struct NarrowLanes<T: Target>(T::Shorts, T);

/// A wire of [`NARROW_LANES`] fragments as two wires: the even and the odd fragments.
#[derive(Clone, Copy, Debug)]
pub struct Halves<X>(pub(super) [X; 2]);

/// A flag of [`NARROW_LANES`] fragments.
#[derive(Clone, Copy, Debug)]
pub struct NarrowFlags<T: Target> {
    words: T::ShortFlags,
    halves: [FlagLanes<T>; 2],
}

impl<T: Target> NarrowLanes<T> {
    /// Wire with these values, lane 0 first.
    #[inline]
    pub fn from_array(lanes: [i16; NARROW_LANES]) -> Self {
        Self::narrow(Halves::<Lanes<T>>::from_array(lanes.map(i32::from)))
    }

    /// Values, lane 0 first.
    #[inline]
    pub fn lanes(self) -> [i16; NARROW_LANES] {
        self.widen().lanes().map(|lane| lane as i16)
    }

    /// Upper halves of 32-bit words.
    #[inline]
    pub(super) fn of_high(Halves([even, odd]): Halves<Lanes<T>>) -> Self {
        Self(even.1.short_high(even.0, odd.0), even.1)
    }

    /// 32-bit words with these upper halves, zeros below.
    #[inline]
    pub(super) fn high(self) -> Halves<Lanes<T>> {
        Halves([Lanes(self.1.even_high(self.0), self.1), Lanes(self.1.odd_high(self.0), self.1)])
    }
}

macro_rules! halves {
    ($lanes:ident, $int:ty) => {
        impl<T: Target> Halves<$lanes<T>> {
            /// Wire with these values, lane 0 first.
            #[inline]
            pub fn from_array(lanes: [$int; NARROW_LANES]) -> Self {
                Self(each!(half in [0, 1] => $lanes::from_array(each!(i in places() => lanes[2 * i + half]))))
            }

            /// Values, lane 0 first.
            #[inline]
            pub fn lanes(self) -> [$int; NARROW_LANES] {
                let halves = [self.0[0].lanes(), self.0[1].lanes()];
                each!(i in places() => halves[i % 2][i / 2])
            }
        }
    };
}

halves!(Lanes, i32);
halves!(WideLanes, i64);

impl<T: Target> NarrowFlags<T> {
    /// Flag with these values, lane 0 first.
    pub fn from_array(lanes: [bool; NARROW_LANES]) -> Self {
        Self::of_halves([0, 1].map(|half| FlagLanes::from_array(core::array::from_fn(|i| lanes[2 * i + half]))))
    }

    /// Values, lane 0 first.
    pub fn lanes(self) -> [bool; NARROW_LANES] {
        let halves = self.halves.map(FlagLanes::lanes);
        core::array::from_fn(|i| halves[i % 2][i / 2])
    }

    /// Returns true if any lane has it.
    #[inline(always)]
    pub(super) fn is_any(self) -> bool {
        let [even, odd] = self.halves;
        any(even | odd)
    }

    #[inline]
    fn of_halves(halves: [FlagLanes<T>; 2]) -> Self {
        let [even, odd] = halves;
        Self { words: even.1.short_flags(even.0, odd.0), halves }
    }

    #[inline]
    fn of_words(words: T::ShortFlags, proof: T) -> Self {
        let halves = [FlagLanes(proof.even_flags(words), proof), FlagLanes(proof.odd_flags(words), proof)];
        Self { words, halves }
    }

    #[inline]
    fn proof(self) -> T {
        self.halves[0].1
    }
}

impl<T: Target> Not for NarrowFlags<T> {
    type Output = Self;
    #[inline]
    fn not(self) -> Self {
        Self { words: self.proof().not_short(self.words), halves: [!self.halves[0], !self.halves[1]] }
    }
}

impl<T: Target> BitAnd for NarrowFlags<T> {
    type Output = Self;
    #[inline]
    fn bitand(self, other: Self) -> Self {
        Self {
            words: self.proof().both_short(self.words, other.words),
            halves: [self.halves[0] & other.halves[0], self.halves[1] & other.halves[1]],
        }
    }
}

impl<T: Target> BitOr for NarrowFlags<T> {
    type Output = Self;
    #[inline]
    fn bitor(self, other: Self) -> Self {
        Self {
            words: self.proof().either_short(self.words, other.words),
            halves: [self.halves[0] | other.halves[0], self.halves[1] | other.halves[1]],
        }
    }
}

impl<T: Target, X: Wire<Flag = FlagLanes<T>, Count = Lanes<T>>> Wire for Halves<X> {
    type Flag = NarrowFlags<T>;
    type Count = Halves<Lanes<T>>;
    const BITS: u32 = X::BITS;
    #[inline]
    fn lit(value: i64) -> Self {
        let wire = X::lit(value);
        Self([wire, wire])
    }
    #[inline]
    fn add(self, other: Self) -> Self {
        Self([self.0[0].add(other.0[0]), self.0[1].add(other.0[1])])
    }
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self([self.0[0].sub(other.0[0]), self.0[1].sub(other.0[1])])
    }
    #[inline]
    fn shl(self, k: u32) -> Self {
        Self([self.0[0].shl(k), self.0[1].shl(k)])
    }
    #[inline]
    fn sar(self, k: u32) -> Self {
        Self([self.0[0].sar(k), self.0[1].sar(k)])
    }
    #[inline]
    fn shl_by(self, k: Self::Count) -> Self {
        Self([self.0[0].shl_by(k.0[0]), self.0[1].shl_by(k.0[1])])
    }
    #[inline]
    fn sar_by(self, k: Self::Count) -> Self {
        Self([self.0[0].sar_by(k.0[0]), self.0[1].sar_by(k.0[1])])
    }
    #[inline]
    fn and(self, other: Self) -> Self {
        Self([self.0[0].and(other.0[0]), self.0[1].and(other.0[1])])
    }
    #[inline]
    fn or(self, other: Self) -> Self {
        Self([self.0[0].or(other.0[0]), self.0[1].or(other.0[1])])
    }
    #[inline]
    fn xor(self, other: Self) -> Self {
        Self([self.0[0].xor(other.0[0]), self.0[1].xor(other.0[1])])
    }
    #[inline]
    fn lt(self, other: Self) -> NarrowFlags<T> {
        NarrowFlags::of_halves([self.0[0].lt(other.0[0]), self.0[1].lt(other.0[1])])
    }
    #[inline]
    fn select(flag: NarrowFlags<T>, a: Self, b: Self) -> Self {
        Self([X::select(flag.halves[0], a.0[0], b.0[0]), X::select(flag.halves[1], a.0[1], b.0[1])])
    }
    #[inline]
    fn leading_zeros(self) -> Self::Count {
        Halves([self.0[0].leading_zeros(), self.0[1].leading_zeros()])
    }
}

impl<T: Target> Word for Halves<Lanes<T>> {
    type Wide = Halves<WideLanes<T>>;
    #[inline]
    fn mul(self, other: Self) -> Self::Wide {
        Halves([self.0[0].mul(other.0[0]), self.0[1].mul(other.0[1])])
    }
    #[inline]
    fn widen(self) -> Self::Wide {
        Halves([self.0[0].widen(), self.0[1].widen()])
    }
    #[inline]
    fn narrow(wide: Self::Wide) -> Self {
        Self([Lanes::narrow(wide.0[0]), Lanes::narrow(wide.0[1])])
    }
    #[inline(always)]
    fn round(wide: Self::Wide, drop: u32, up: u32) -> Self {
        Self([Lanes::round(wide.0[0], drop, up), Lanes::round(wide.0[1], drop, up)])
    }
    #[inline(always)]
    fn lookup(index: Self, table: &'static [i32]) -> Self {
        Self([Lanes::lookup(index.0[0], table), Lanes::lookup(index.0[1], table)])
    }
    #[inline]
    fn to_count(self) -> Self {
        self
    }
    #[inline]
    fn of_count(count: Self) -> Self {
        count
    }
}

impl<T: Target> WideWire for Halves<WideLanes<T>> {
    type Word = Halves<Lanes<T>>;
    #[inline]
    fn wide_to_count(self) -> Halves<Lanes<T>> {
        Word::narrow(self)
    }
    #[inline]
    fn wide_of_count(count: Halves<Lanes<T>>) -> Self {
        count.widen()
    }
    #[inline(always)]
    fn normalised<const N: usize>(wires: [Self; N], drop: u32, up: u32) -> ([Self::Word; N], Self::Count, Self::Flag) {
        normalised(wires, drop, up)
    }
}

impl<T: Target> Wire for NarrowLanes<T> {
    type Flag = NarrowFlags<T>;
    type Count = Halves<Lanes<T>>;
    const BITS: u32 = i16::BITS;
    #[inline]
    fn lit(value: i64) -> Self {
        let proof = T::proof();
        Self(proof.splat_short(value as i16), proof)
    }
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(self.1.add_short(self.0, other.0), self.1)
    }
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self(self.1.sub_short(self.0, other.0), self.1)
    }
    #[inline]
    fn shl(self, k: u32) -> Self {
        Self(self.1.shl_short(self.0, k), self.1)
    }
    #[inline]
    fn sar(self, k: u32) -> Self {
        Self(self.1.sar_short(self.0, k), self.1)
    }
    #[inline]
    fn shl_by(self, Halves([even, odd]): Self::Count) -> Self {
        Self(self.1.shl_short_by(self.0, even.0, odd.0), self.1)
    }
    #[inline]
    fn sar_by(self, Halves([even, odd]): Self::Count) -> Self {
        Self(self.1.sar_short_by(self.0, even.0, odd.0), self.1)
    }
    #[inline]
    fn and(self, other: Self) -> Self {
        Self(self.1.and_short(self.0, other.0), self.1)
    }
    #[inline]
    fn or(self, other: Self) -> Self {
        Self(self.1.or_short(self.0, other.0), self.1)
    }
    #[inline]
    fn xor(self, other: Self) -> Self {
        Self(self.1.xor_short(self.0, other.0), self.1)
    }
    #[inline]
    fn lt(self, other: Self) -> NarrowFlags<T> {
        NarrowFlags::of_words(self.1.lt_short(self.0, other.0), self.1)
    }
    #[inline]
    fn select(flag: NarrowFlags<T>, a: Self, b: Self) -> Self {
        Self(a.1.select_short(flag.words, a.0, b.0), a.1)
    }
    #[inline(always)]
    fn unless<B>(flag: NarrowFlags<T>, instead: B, body: impl FnOnce() -> B) -> B {
        if (!flag).is_any() { body() } else { instead }
    }
    #[inline]
    fn leading_zeros(self) -> Self::Count {
        // In the upper half of a 32-bit word, with a one after it.
        self.high().or(Wire::lit(1 << 15)).leading_zeros()
    }
}

impl<T: Target> Word for NarrowLanes<T> {
    // All shift counts but those of tables are thus known when a stage is compiled, and roundings need no mask.
    const WHOLE: bool = true;
    type Wide = Halves<Lanes<T>>;
    #[inline]
    fn mul(self, other: Self) -> Self::Wide {
        let (even, odd) = (self.1.mul_even(self.0, other.0), self.1.mul_odd(self.0, other.0));
        Halves([Lanes(even, self.1), Lanes(odd, self.1)])
    }
    #[inline]
    fn widen(self) -> Self::Wide {
        Halves([Lanes(self.1.even(self.0), self.1), Lanes(self.1.odd(self.0), self.1)])
    }
    #[inline]
    fn narrow(Halves([even, odd]): Self::Wide) -> Self {
        Self(even.1.short(even.0, odd.0), even.1)
    }
    #[inline(always)]
    fn round(wide: Self::Wide, drop: u32, up: u32) -> Self {
        if drop > 16 {
            // The lower half is dropped whole. The rest is done on words, of which a vector holds twice as many.
            let high = Self::of_high(wide);
            return Self(high.1.round_short(high.0, drop + up - 16), high.1).shl(up);
        }
        // If a sum wraps, the shift up or the narrowing drops its difference from the exact sum.
        let Halves([even, odd]) = wide;
        Self(even.1.round_short_low(even.0, odd.0, drop, up), even.1).and(Self::lit(-1 << up))
    }
    #[inline(always)]
    fn lookup(Halves([even, odd]): Self::Count, table: &'static [i32]) -> Self {
        Self(even.1.lookup_short(even.0, odd.0, table), even.1)
    }
    #[inline]
    fn to_count(self) -> Self::Count {
        self.widen()
    }
    #[inline]
    fn of_count(count: Self::Count) -> Self {
        Self::narrow(count)
    }
}

impl<T: Target> WideWire for Halves<Lanes<T>> {
    type Word = NarrowLanes<T>;
    #[inline]
    fn wide_to_count(self) -> Self {
        self
    }
    #[inline]
    fn wide_of_count(count: Self) -> Self {
        count
    }
    #[inline(always)]
    fn normalised<const N: usize>(wires: [Self; N], drop: u32, up: u32) -> ([Self::Word; N], Self::Count, Self::Flag) {
        normalised(wires, drop, up)
    }
}

impl<T: Target> Staged for NarrowLanes<T> {
    #[inline(always)]
    fn stage<B: Bundle<Self>>(_name: &'static str, body: impl Fn() -> B + Copy) -> B {
        stage::<T, B>(body)
    }
}
