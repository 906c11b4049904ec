//! The scalar backend on a small processor: 32-bit registers, no instruction for leading zeros, no vectors, cheap branches.
//!
//! The bits are those of [`crate::scalar`], in fewer instructions:
//! - A narrow word lies in a whole register, so no instruction has to restore its sign after an operation.
//! - Leading zeros come from a table.
//! - Numbers that are shifted by one count decide once where the result lies.
//! - Unused results are not computed.
//! - Without a multiplier, products of narrow words come from a table of quarter squares, and products of wide words from adds.

mod product;

use crate::each::each;
use crate::rom::upper;
use crate::staged::Staged;
use crate::word::{WideWire, Wire, Word};

pub use product::{product_by_adds, product_by_table};

/// Leading zeros of 8 bits; 8 for 0.
static LEADING_ZEROS: [u8; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        table[byte] = (byte as u8).leading_zeros() as u8;
        byte += 1;
    }
    table
};

/// Leading zeros of 32 bits by a table; 32 for 0.
#[inline(always)]
pub fn leading_zeros_by_table(x: u32) -> u32 {
    if x >> 24 != 0 { u32::from(LEADING_ZEROS[(x >> 24) as u8 as usize]) } else { leading_zeros_below(x) }
}

/// Leading zeros of a number below 2^24.
#[inline(never)]
#[cold]
fn leading_zeros_below(x: u32) -> u32 {
    let (places, byte) = if x >> 16 != 0 {
        (8, x >> 16)
    } else if x >> 8 != 0 {
        (16, x >> 8)
    } else {
        (24, x)
    };
    places + u32::from(LEADING_ZEROS[byte as u8 as usize])
}

/// Leading zeros of 32 bits; 32 for 0. It is an instruction if the processor has one.
#[inline(always)]
fn leading_zeros(x: u32) -> u32 {
    if cfg!(all(target_arch = "riscv32", not(target_feature = "zbb"))) {
        leading_zeros_by_table(x)
    } else {
        x.leading_zeros()
    }
}

/// True if an instruction makes products.
const MULTIPLIER: bool = !cfg!(all(target_arch = "riscv32", not(target_feature = "m")));

/// Upper half of a register pair.
#[inline(always)]
fn high(x: i64) -> i32 {
    (x >> 32) as i32
}

/// Lower half of a register pair.
#[inline(always)]
fn low(x: i64) -> u32 {
    x as u32
}

/// A 16-bit word in a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Half(pub i32);

/// A 32-bit word, or a control word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Full(pub i32);

/// The wide companion of [`Half`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WideHalf(pub i32);

/// The wide companion of [`Full`], a pair of registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WideFull(pub i64);

macro_rules! wire {
    ($wire:ident, $int:ty, $bits:literal, |$x:ident| $leading_zeros:expr) => {
        impl Wire for $wire {
            type Flag = bool;
            type Count = Full;
            const BITS: u32 = $bits;
            #[inline(always)]
            fn lit(value: i64) -> Self {
                Self(value as $int)
            }
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                Self(self.0.wrapping_add(other.0))
            }
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                Self(self.0.wrapping_sub(other.0))
            }
            #[inline(always)]
            fn shl(self, k: u32) -> Self {
                Self(self.0.wrapping_shl(k))
            }
            #[inline(always)]
            fn sar(self, k: u32) -> Self {
                Self(self.0.wrapping_shr(k))
            }
            #[inline(always)]
            fn shl_by(self, k: Full) -> Self {
                Self(self.0.wrapping_shl(k.0 as u32))
            }
            #[inline(always)]
            fn sar_by(self, k: Full) -> Self {
                Self(self.0.wrapping_shr(k.0 as u32))
            }
            #[inline(always)]
            fn and(self, other: Self) -> Self {
                Self(self.0 & other.0)
            }
            #[inline(always)]
            fn or(self, other: Self) -> Self {
                Self(self.0 | other.0)
            }
            #[inline(always)]
            fn xor(self, other: Self) -> Self {
                Self(self.0 ^ other.0)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self.0 < other.0
            }
            #[inline(always)]
            fn select(flag: bool, a: Self, b: Self) -> Self {
                if flag { a } else { b }
            }
            #[inline(always)]
            fn unless<T>(flag: bool, instead: T, body: impl FnOnce() -> T) -> T {
                if flag { instead } else { body() }
            }
            #[inline(always)]
            fn leading_zeros(self) -> Full {
                let $x = self.0;
                Full($leading_zeros as i32)
            }
        }
    };
}

wire!(Half, i32, 16, |x| leading_zeros((x as u32) << 16 | 0x8000));
wire!(Full, i32, 32, |x| leading_zeros(x as u32));
wire!(WideHalf, i32, 32, |x| leading_zeros(x as u32));
wire!(WideFull, i64, 64, |x| { if high(x) != 0 { leading_zeros(high(x) as u32) } else { 32 + leading_zeros(low(x)) } });

macro_rules! word {
    ($word:ident, $wide:ident, $int:ty, $product:ident, $normalised:ident) => {
        impl Word for $word {
            type Wide = $wide;
            #[inline(always)]
            fn mul(self, other: Self) -> $wide {
                $wide(if MULTIPLIER {
                    <$int>::from(self.0).wrapping_mul(<$int>::from(other.0))
                } else {
                    $product(self.0, other.0)
                })
            }
            #[inline(always)]
            fn widen(self) -> $wide {
                $wide(<$int>::from(self.0))
            }
            #[inline(always)]
            fn narrow(wide: $wide) -> Self {
                Self(wide.0 as i32)
            }
            #[inline(always)]
            fn round(wide: $wide, drop: u32, up: u32) -> Self {
                Self(wide.rounded(drop, up)).shl(up)
            }
            #[inline(always)]
            fn lookup(index: Full, table: &'static [i32]) -> Self {
                // A stage never asks outside the table; 0 keeps the function total without a panic path.
                Self(upper(table.get(index.0 as usize).copied().unwrap_or(0), Self::BITS))
            }
            #[inline(always)]
            fn to_count(self) -> Full {
                Full(self.0)
            }
            #[inline(always)]
            fn of_count(count: Full) -> Self {
                Self(count.0)
            }
        }

        impl WideWire for $wide {
            type Word = $word;
            #[inline(always)]
            fn wide_to_count(self) -> Full {
                Full(self.0 as i32)
            }
            #[inline(always)]
            fn wide_of_count(count: Full) -> Self {
                Self(count.0.into())
            }
            #[inline(always)]
            fn normalised<const N: usize>(wires: [Self; N], drop: u32, up: u32) -> ([$word; N], Full, bool) {
                $normalised(wires, drop, up)
            }
        }

        impl Staged for $word {}
    };
}

word!(Half, WideHalf, i32, product_by_table, normalised_half);
word!(Full, WideFull, i64, product_by_adds, normalised_full);

/// `⌊x/2 + ½⌋` of any register.
#[inline(always)]
fn half_up(x: i32) -> i32 {
    (x >> 1) + (x & 1)
}

impl WideHalf {
    /// `⌊self / 2^(drop + up) + ½⌋`, a word; it is far inside the register.
    #[inline(always)]
    fn rounded(self, drop: u32, up: u32) -> i32 {
        ((self.0 >> (drop + up - 1)) + 1) >> 1
    }
}

impl WideFull {
    /// `⌊self / 2^(drop + up) + ½⌋`, a word with `up` bits to spare. With none to spare, twice the word does not fit a register.
    #[inline(always)]
    fn rounded(self, drop: u32, up: u32) -> i32 {
        let k = drop + up - 1;
        match (up, k) {
            (0, _) => (((self.0 >> k) + 1) >> 1) as i32,
            (_, 32..) => ((high(self.0) >> (k - 32)) + 1) >> 1,
            _ => ((self.0 >> k) as i32 + 1) >> 1,
        }
    }
}

/// Implements [`WideWire::normalised`].
#[cfg_attr(not(feature = "small-code"), inline(always))]
#[cfg_attr(feature = "small-code", inline(never))]
fn normalised_half<const N: usize>(wires: [WideHalf; N], drop: u32, up: u32) -> ([Half; N], Full, bool) {
    let mut magnitude = 0;
    for wire in &wires {
        magnitude |= wire.0 ^ (wire.0 >> 31);
    }
    let zeros = leading_zeros(magnitude as u32);
    // Left and right in one shift, unless the left shift is larger.
    let Some(right) = (drop + up).checked_sub(zeros) else { return far_left(wires, zeros, drop, up) };
    let words = each!(wire in wires => Half(((wire.0 >> right) + 1) >> 1).shl(up));
    (words, Full(zeros as i32), false)
}

/// Implements [`WideWire::normalised`] if a shift to the left leaves nothing to be rounded. It is a separate call: products of mantissas come here if
/// half of their bits or more are lost.
#[cold]
#[inline(never)]
fn far_left<const N: usize>(wires: [WideHalf; N], zeros: u32, drop: u32, up: u32) -> ([Half; N], Full, bool) {
    let all_zero = zeros == 32 && wires.iter().all(|wire| wire.0 == 0);
    (each!(wire in wires => Half(wire.0 << (zeros - 1 - drop - up)).shl(up)), Full(zeros as i32), all_zero)
}

/// Implements [`WideWire::normalised`].
#[cfg_attr(not(feature = "small-code"), inline(always))]
#[cfg_attr(feature = "small-code", inline(never))]
fn normalised_full<const N: usize>(wires: [WideFull; N], drop: u32, up: u32) -> ([Full; N], Full, bool) {
    let mut magnitude = 0;
    for wire in &wires {
        magnitude |= high(wire.0) ^ (high(wire.0) >> 31);
    }
    let zeros = leading_zeros(magnitude as u32);
    if up < FEW_TO_SPARE && zeros < 32 {
        return from_pairs(wires, zeros, drop, up);
    }
    // The upper registers hold all kept bits: left and right in one shift.
    let Some(right) = (drop + up - 32).checked_sub(zeros) else { return from_both(wires, zeros, drop, up) };
    // There are bits to spare, for without any the other branches were taken: at most 31 − up and a sign.
    let words = each!(wire in wires => Full(((high(wire.0) >> right) + 1) >> 1).shl(up));
    (words, Full(zeros as i32), false)
}

/// Bits to spare below which a kept number reaches into the lower register half of the time: more than 24 kept bits.
const FEW_TO_SPARE: u32 = 6;

/// Implements [`WideWire::normalised`] if neither half is empty: the kept bits lie in the upper register after the shift.
#[inline(always)]
fn from_pairs<const N: usize>(wires: [WideFull; N], zeros: u32, drop: u32, up: u32) -> ([Full; N], Full, bool) {
    let (shift, back) = (zeros - 1, 32 - zeros);
    let words = each!(wire in wires => {
        let top = (high(wire.0) << shift) | (low(wire.0) >> 1 >> back) as i32;
        Full(half_up(top >> (drop + up - 33))).shl(up)
    });
    (words, Full(zeros as i32), false)
}

/// Implements [`WideWire::normalised`] if the lower registers count, too. It is a separate call: products of mantissas come here if a third of their
/// bits or more are lost, and inlined it would be most of the code.
#[cold]
#[inline(never)]
fn from_both<const N: usize>(wires: [WideFull; N], zeros: u32, drop: u32, up: u32) -> ([Full; N], Full, bool) {
    // A sign may lie in the upper register and its word in the lower one: a pair, too.
    if zeros < 32 || (lower_magnitude(&wires) as i32) < 0 {
        return from_pairs(wires, zeros, drop, up);
    }
    let magnitude = lower_magnitude(&wires);
    let zeros = leading_zeros(magnitude);
    let all_zero = magnitude == 0 && wires.iter().all(|wire| wire.0 == 0);
    // The shift is one place less than `zeros`, to keep the sign.
    let words = each!(wire in wires => Full(half_up((low(wire.0) << (zeros - 1)) as i32 >> (drop + up - 33))).shl(up));
    (words, Full(32 + zeros as i32), all_zero)
}

/// Bits of the lower registers that are no signs, if the upper registers hold signs alone.
#[inline(always)]
fn lower_magnitude<const N: usize>(wires: &[WideFull; N]) -> u32 {
    let mut magnitude = 0;
    for wire in wires {
        magnitude |= low(wire.0) ^ high(wire.0) as u32;
    }
    magnitude
}
