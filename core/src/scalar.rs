//! The scalar backend: one integer per wire. It is the meaning of the design; every other backend equals it.
//!
//! A word has 32 or 16 bits. Its wide companion is the integer of twice as many bits. Control words are an `i32` with either. 8-bit words are for
//! tests alone: they have few enough inputs to try them all.
//!
//! No stage lets a value leave its word, so the wrapping operations below never wrap. They are written so that no build of any kind contains a panic
//! path.

use crate::bundle::Bundle;
use crate::normalised::normalised;
use crate::rom::upper;
use crate::staged::Staged;
use crate::word::{WideWire, Wire, Word};

/// Word of the scalar backend for which ports are made; its wide companion is `i64`.
pub type Scalar = i32;

macro_rules! wire {
    ($int:ty) => {
        impl Wire for $int {
            type Flag = bool;
            type Count = i32;
            const BITS: u32 = <$int>::BITS;
            #[inline(always)]
            fn lit(value: i64) -> Self {
                value as $int
            }
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                self.wrapping_add(other)
            }
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                self.wrapping_sub(other)
            }
            #[inline(always)]
            fn shl(self, k: u32) -> Self {
                self.wrapping_shl(k)
            }
            #[inline(always)]
            fn sar(self, k: u32) -> Self {
                self.wrapping_shr(k)
            }
            #[inline(always)]
            fn shl_by(self, k: i32) -> Self {
                self.wrapping_shl(k as u32)
            }
            #[inline(always)]
            fn sar_by(self, k: i32) -> Self {
                self.wrapping_shr(k as u32)
            }
            #[inline(always)]
            fn and(self, other: Self) -> Self {
                self & other
            }
            #[inline(always)]
            fn or(self, other: Self) -> Self {
                self | other
            }
            #[inline(always)]
            fn xor(self, other: Self) -> Self {
                self ^ other
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn select(flag: bool, a: Self, b: Self) -> Self {
                if flag { a } else { b }
            }
            #[inline(always)]
            fn leading_zeros(self) -> i32 {
                <$int>::leading_zeros(self) as i32
            }
        }
    };
}

wire!(i8);
wire!(i16);
wire!(i32);
wire!(i64);

macro_rules! word {
    ($word:ty, $wide:ty) => {
        impl Word for $word {
            type Wide = $wide;
            #[inline(always)]
            fn mul(self, other: Self) -> $wide {
                <$wide>::from(self).wrapping_mul(<$wide>::from(other))
            }
            #[inline(always)]
            fn widen(self) -> $wide {
                <$wide>::from(self)
            }
            #[inline(always)]
            fn narrow(wide: $wide) -> Self {
                wide as $word
            }
            #[inline(always)]
            fn lookup(index: i32, table: &'static [i32]) -> Self {
                // A stage never asks outside the table; 0 keeps the function total without a panic path.
                upper(table.get(index as usize).copied().unwrap_or(0), Self::BITS) as $word
            }
            #[inline(always)]
            fn to_count(self) -> i32 {
                i32::from(self)
            }
            #[inline(always)]
            fn of_count(count: i32) -> Self {
                count as $word
            }
        }

        impl WideWire for $wide {
            type Word = $word;
            #[inline(always)]
            fn wide_to_count(self) -> i32 {
                self as i32
            }
            #[inline(always)]
            fn wide_of_count(count: i32) -> Self {
                count as $wide
            }
            #[inline(always)]
            fn normalised<const N: usize>(
                wires: [Self; N],
                drop: u32,
                up: u32,
            ) -> ([Self::Word; N], Self::Count, Self::Flag) {
                normalised(wires, drop, up)
            }
        }

        /// A stage is a function of its own, which the optimiser inlines if it is small. If stages were always inlined, every caller of a datapath
        /// would hold all of them once more.
        impl Staged for $word {
            #[inline]
            fn stage<B: Bundle<Self>>(_: &'static str, body: impl Fn() -> B + Copy) -> B {
                body()
            }
        }
    };
}

word!(i8, i16);
word!(i16, i32);
word!(i32, i64);
