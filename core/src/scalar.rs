//! The scalar reading: one `i32` per word. This is the meaning of the design; every other reading equals it.
//!
//! No stage lets a value leave its word, so the wrapping operations below never wrap; they are written so
//! that no build of any kind contains a panic path.

use crate::staged::Staged;
use crate::word::{WideWire, Wire, Word};

/// The word of the scalar reading; its wide companion is `i64`.
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

wire!(i32);
wire!(i64);

impl Word for i32 {
    type Wide = i64;
    #[inline(always)]
    fn mul(self, other: Self) -> i64 {
        i64::from(self).wrapping_mul(i64::from(other))
    }
    #[inline(always)]
    fn widen(self) -> i64 {
        i64::from(self)
    }
    #[inline(always)]
    fn narrow(wide: i64) -> Self {
        wide as i32
    }
    #[inline(always)]
    fn lookup(index: i32, table: &'static [i32]) -> Self {
        // A stage never asks outside the table; 0 keeps the function total without a panic path.
        table.get(index as usize).copied().unwrap_or(0)
    }
    #[inline(always)]
    fn to_count(self) -> i32 {
        self
    }
    #[inline(always)]
    fn of_count(count: i32) -> Self {
        count
    }
}

impl WideWire for i64 {
    type Word = i32;
}

impl Staged for i32 {}
