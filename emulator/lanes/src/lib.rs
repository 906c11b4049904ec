//! The lanes reading: the datapath for `N` fragments at once.

mod batch;
mod reading;
mod target;

use std::marker::PhantomData;
use std::ops::{BitAnd, BitOr, Not};

use roughxel_core::bundle::Bundle;
use roughxel_core::word::{Wire, Word};

pub use batch::{Batch, Footprint, LANES};
pub use reading::Reading;
#[cfg(target_arch = "x86_64")]
pub use target::{Avx2, Avx512};
pub use target::{Baseline, InstructionSet, Target};

/// A word of `N` fragments, for the instruction set `T`.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Lanes<T, const N: usize>([i32; N], PhantomData<T>);

/// A wide wire of `N` fragments.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct WideLanes<T, const N: usize>([i64; N], PhantomData<T>);

/// A flag of `N` fragments.
#[derive(Clone, Copy, Debug)]
pub struct FlagLanes<T, const N: usize>([bool; N], PhantomData<T>);

/// An array by its places. Always inlined, so that it is compiled for the instruction set of the stage around it.
#[inline(always)]
#[expect(clippy::needless_range_loop, reason = "an iterator here makes the optimiser take five times as long")]
fn from_places<L: Copy + Default, const N: usize>(lane: impl Fn(usize) -> L) -> [L; N] {
    let mut lanes = [L::default(); N];
    for i in 0..N {
        lanes[i] = lane(i);
    }
    lanes
}

/// `lanes!(i => expression)`: the wire whose lane `i` is the expression.
macro_rules! lanes {
    ($i:ident => $lane:expr) => {
        Self::of(from_places(
            #[inline(always)]
            |$i| $lane,
        ))
    };
}

macro_rules! carrier {
    ($name:ident, $lane:ty) => {
        impl<T, const N: usize> $name<T, N> {
            /// The wire with these values, lane 0 first.
            #[inline(always)]
            pub fn of(lanes: [$lane; N]) -> Self {
                Self(lanes, PhantomData)
            }

            /// The values, lane 0 first.
            #[inline(always)]
            pub fn lanes(&self) -> &[$lane; N] {
                &self.0
            }
        }
    };
}

carrier!(Lanes, i32);
carrier!(WideLanes, i64);
carrier!(FlagLanes, bool);

impl<T: Target, const N: usize> Not for FlagLanes<T, N> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        lanes!(i => !self.0[i])
    }
}

impl<T: Target, const N: usize> BitAnd for FlagLanes<T, N> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        lanes!(i => self.0[i] & other.0[i])
    }
}

impl<T: Target, const N: usize> BitOr for FlagLanes<T, N> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        lanes!(i => self.0[i] | other.0[i])
    }
}

macro_rules! wire {
    ($name:ident, $int:ty, $leading_zeros:ident) => {
        impl<T: Target, const N: usize> Wire for $name<T, N> {
            type Flag = FlagLanes<T, N>;
            type Count = Lanes<T, N>;
            #[inline(always)]
            fn lit(value: i64) -> Self {
                Self::of([value as $int; N])
            }
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                lanes!(i => self.0[i].wrapping_add(other.0[i]))
            }
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                lanes!(i => self.0[i].wrapping_sub(other.0[i]))
            }
            #[inline(always)]
            fn shl(self, k: u32) -> Self {
                lanes!(i => self.0[i].wrapping_shl(k))
            }
            #[inline(always)]
            fn sar(self, k: u32) -> Self {
                lanes!(i => self.0[i].wrapping_shr(k))
            }
            #[inline(always)]
            fn shl_by(self, k: Lanes<T, N>) -> Self {
                lanes!(i => self.0[i].wrapping_shl(k.0[i] as u32))
            }
            #[inline(always)]
            fn sar_by(self, k: Lanes<T, N>) -> Self {
                lanes!(i => self.0[i].wrapping_shr(k.0[i] as u32))
            }
            #[inline(always)]
            fn and(self, other: Self) -> Self {
                lanes!(i => self.0[i] & other.0[i])
            }
            #[inline(always)]
            fn or(self, other: Self) -> Self {
                lanes!(i => self.0[i] | other.0[i])
            }
            #[inline(always)]
            fn xor(self, other: Self) -> Self {
                lanes!(i => self.0[i] ^ other.0[i])
            }
            #[inline(always)]
            fn lt(self, other: Self) -> FlagLanes<T, N> {
                FlagLanes::of(from_places(
                    #[inline(always)]
                    |i| self.0[i] < other.0[i],
                ))
            }
            #[inline(always)]
            fn select(flag: FlagLanes<T, N>, a: Self, b: Self) -> Self {
                lanes!(i => if flag.0[i] { a.0[i] } else { b.0[i] })
            }
            #[inline(always)]
            fn leading_zeros(self) -> Lanes<T, N> {
                Lanes::of(from_places(
                    #[inline(always)]
                    |i| $leading_zeros::<T>(self.0[i]),
                ))
            }
        }
    };
}

wire!(Lanes, i32, leading_zeros_of_word);
wire!(WideLanes, i64, leading_zeros_of_wide);

/// Leading zeros of a word: from the exponent of a float where vectors cannot count them. Without the bit below its
/// highest the word does not round up to the next power of two.
#[inline(always)]
fn leading_zeros_of_word<T: Target>(word: i32) -> i32 {
    if T::COUNTS_LEADING_ZEROS {
        return word.leading_zeros() as i32;
    }
    let highest = word & !(word.cast_unsigned() >> 1).cast_signed();
    let exponent = (highest as f32).to_bits() >> 23;
    // 0 has the exponent 0, a negative word a sign above the exponent. Wrapping: no lane may branch, in no build.
    158_i32.wrapping_sub(exponent.cast_signed()).clamp(0, 32)
}

/// Leading zeros of a wide wire, half by half.
#[inline(always)]
fn leading_zeros_of_wide<T: Target>(wide: i64) -> i32 {
    if T::COUNTS_LEADING_ZEROS {
        return wide.leading_zeros() as i32;
    }
    let (high, low) = ((wide >> 32) as i32, wide as i32);
    let (half, above) = if high == 0 { (low, 32) } else { (high, 0) };
    leading_zeros_of_word::<T>(half).wrapping_add(above)
}

impl<T: Target, const N: usize> Word for Lanes<T, N> {
    type Wide = WideLanes<T, N>;
    #[inline(always)]
    fn mul(self, other: Self) -> WideLanes<T, N> {
        WideLanes::of(from_places(
            #[inline(always)]
            |i| i64::from(self.0[i]).wrapping_mul(i64::from(other.0[i])),
        ))
    }
    #[inline(always)]
    fn widen(self) -> WideLanes<T, N> {
        WideLanes::of(from_places(
            #[inline(always)]
            |i| i64::from(self.0[i]),
        ))
    }
    #[inline(always)]
    fn narrow(wide: WideLanes<T, N>) -> Self {
        lanes!(i => wide.0[i] as i32)
    }
    #[inline(always)]
    fn round(wide: WideLanes<T, N>, k: u32) -> Self {
        if k <= 33 {
            return Self::narrow(wide.sar(k - 1).add(Wire::lit(1)).sar(1));
        }
        // The lower half is shifted out whole, and a bit more, so that the one fits: the rest is done on words, of which a
        // vector holds twice as many.
        let high: Self = lanes!(i => (wide.0[i] >> 32) as i32);
        high.sar(k - 33).add(Wire::lit(1)).sar(1)
    }
    #[inline(always)]
    fn lookup(self, table: &'static [i32]) -> Self {
        Self::of(lookup(&self.0, table))
    }
    #[inline(always)]
    fn block<B: Bundle<Self>>(_name: &'static str, body: impl FnOnce() -> B) -> B {
        stage::<T, B>(body)
    }
}

/// One block of the datapath as a function of its own, compiled for the instruction set `T`.
#[inline(never)]
fn stage<T: Target, B>(body: impl FnOnce() -> B) -> B {
    T::run(body)
}

/// Lookups are loads one by one: out of line, so that they do not pull what stands around them out of the vectors.
#[inline(never)]
fn lookup<const N: usize>(places: &[i32; N], table: &'static [i32]) -> [i32; N] {
    // A stage never asks outside the table; 0 keeps the function total, as in the scalar reading.
    places.map(|place| table.get(place as usize).copied().unwrap_or(0))
}
