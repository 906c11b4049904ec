//! # roughxel-simd
//!
//! Words of [`LANES`] fragments at once, or of [`NARROW_LANES`] on 16 bits, with the bits of the scalar words.
//!
//! [`Backend`] chooses words at run time. [`Backend::dispatch`] is the one place where a computation, a [`Kernel`], is compiled for every instruction
//! set. [`BatchWord`] connects words of any backend with the rows of a batch.
//!
//! Vectors are explicit. The even and the odd lanes of a wide wire are apart: a product is one instruction and rounding packs nothing. This table
//! ranks the candidates for that choice. It gives the speed of the whole datapath relative to the scalar backend, from one run of each on one core
//! with AVX-512:
//!
//! | candidate                                             | 128 bits | AVX2 | AVX-512 |
//! |-------------------------------------------------------|----------|------|---------|
//! | crate `wide`, 8 lanes, way in not counted             | 0.9      | 1.4  | 1.9     |
//! | arrays of 16 that the compiler turns into vectors     | 0.6      | 2.4  | 3.3     |
//! | `fearless_simd`, 8 and 16 lanes, way in not counted   |          | 2.4  | 4.4     |
//! | `fearless_simd`, 16 lanes, even and odd apart: chosen |          | 2.9  | 5.5     |
//!
//! The table is of an older datapath and build. `cargo bench -p roughxel-benches --bench backends` gives current figures, as a renderer calls the
//! datapath. With 128 bits the scalar backend is the fastest, and [`Backend::best`] takes it. Vectors begin where a stage begins ([`Staged::stage`]).

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod backend;
mod fetch;
mod group;
mod narrow;
mod target;
mod vectors;

use std::ops::{BitAnd, BitOr, Not};

use roughxel_core::bundle::Bundle;
use roughxel_core::normalised::normalised;
use roughxel_core::staged::Staged;
use roughxel_core::word::{WideWire, Wire, Word};

#[cfg(target_arch = "x86_64")]
pub use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
pub use avx512::Avx512;
pub use backend::{Backend, Kernel};
pub use group::{BatchWord, LanePlaces};
pub use narrow::{Halves, KEPT, NARROW_LANES, NarrowFlags, NarrowLanes};
pub use target::{InstructionSet, Target};
pub use vectors::Vectors;

/// Fragments in lanes on 32-bit words, for every instruction set.
pub const LANES: usize = 16;

macro_rules! carrier {
    ($(#[$doc:meta])* $name:ident, $vectors:ident, $lane:ty, $of:ident, $lanes:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name<T: Target>(T::$vectors, T);

        impl<T: Target> $name<T> {
            /// Wire with these values, lane 0 first.
            #[inline]
            pub fn from_array(lanes: [$lane; LANES]) -> Self {
                let proof = T::detect();
                Self(proof.$of(lanes), proof)
            }

            /// Values, lane 0 first.
            #[inline]
            pub fn lanes(self) -> [$lane; LANES] {
                self.1.$lanes(self.0)
            }
        }
    };
}

carrier!(
    /// A word of [`LANES`] fragments, for the instruction set `T`.
    Lanes, Words, i32, words, word_lanes
);
carrier!(
    /// A wide wire of [`LANES`] fragments.
    WideLanes, Wides, i64, wides, wide_lanes
);
carrier!(
    /// A flag of [`LANES`] fragments.
    FlagLanes, Flags, bool, flags, flag_lanes
);

impl<T: Target> Not for FlagLanes<T> {
    type Output = Self;
    #[inline]
    fn not(self) -> Self {
        Self(self.1.not(self.0), self.1)
    }
}

impl<T: Target> BitAnd for FlagLanes<T> {
    type Output = Self;
    #[inline]
    fn bitand(self, other: Self) -> Self {
        Self(self.1.both(self.0, other.0), self.1)
    }
}

impl<T: Target> BitOr for FlagLanes<T> {
    type Output = Self;
    #[inline]
    fn bitor(self, other: Self) -> Self {
        Self(self.1.either(self.0, other.0), self.1)
    }
}

macro_rules! wire {
    (
        $name:ident, $int:ty, $splat:ident, $add:ident, $sub:ident, $shl:ident, $sar:ident, $shl_by:ident, $sar_by:ident,
        $and:ident, $or:ident, $xor:ident, $lt:ident, $select:ident, $leading_zeros:ident
    ) => {
        impl<T: Target> Wire for $name<T> {
            type Flag = FlagLanes<T>;
            type Count = Lanes<T>;
            const BITS: u32 = <$int>::BITS;
            #[inline]
            fn lit(value: i64) -> Self {
                let proof = T::proof();
                Self(proof.$splat(value as $int), proof)
            }
            #[inline]
            fn add(self, other: Self) -> Self {
                Self(self.1.$add(self.0, other.0), self.1)
            }
            #[inline]
            fn sub(self, other: Self) -> Self {
                Self(self.1.$sub(self.0, other.0), self.1)
            }
            #[inline]
            fn shl(self, k: u32) -> Self {
                Self(self.1.$shl(self.0, k), self.1)
            }
            #[inline]
            fn sar(self, k: u32) -> Self {
                Self(self.1.$sar(self.0, k), self.1)
            }
            #[inline]
            fn shl_by(self, k: Lanes<T>) -> Self {
                Self(self.1.$shl_by(self.0, k.0), self.1)
            }
            #[inline]
            fn sar_by(self, k: Lanes<T>) -> Self {
                Self(self.1.$sar_by(self.0, k.0), self.1)
            }
            #[inline]
            fn and(self, other: Self) -> Self {
                Self(self.1.$and(self.0, other.0), self.1)
            }
            #[inline]
            fn or(self, other: Self) -> Self {
                Self(self.1.$or(self.0, other.0), self.1)
            }
            #[inline]
            fn xor(self, other: Self) -> Self {
                Self(self.1.$xor(self.0, other.0), self.1)
            }
            #[inline]
            fn lt(self, other: Self) -> FlagLanes<T> {
                FlagLanes(self.1.$lt(self.0, other.0), self.1)
            }
            #[inline]
            fn select(flag: FlagLanes<T>, a: Self, b: Self) -> Self {
                Self(a.1.$select(flag.0, a.0, b.0), a.1)
            }
            #[inline]
            fn leading_zeros(self) -> Lanes<T> {
                Lanes(self.1.$leading_zeros(self.0), self.1)
            }
            #[inline(always)]
            fn unless<B>(flag: FlagLanes<T>, instead: B, body: impl FnOnce() -> B) -> B {
                if any(!flag) { body() } else { instead }
            }
        }
    };
}

/// Returns true if any lane has the flag.
#[inline(always)]
fn any<T: Target>(flag: FlagLanes<T>) -> bool {
    let [one, zero] = [flag.1.splat(1), flag.1.splat(0)];
    flag.1.word_lanes(flag.1.select(flag.0, one, zero)).iter().fold(0, |any, lane| any | lane) != 0
}

wire!(Lanes, i32, splat, add, sub, shl, sar, shl_by, sar_by, and, or, xor, lt, select, leading_zeros);
wire!(
    WideLanes,
    i64,
    splat_wide,
    add_wide,
    sub_wide,
    shl_wide,
    sar_wide,
    shl_wide_by,
    sar_wide_by,
    and_wide,
    or_wide,
    xor_wide,
    lt_wide,
    select_wide,
    leading_zeros_wide
);

impl<T: Target> Word for Lanes<T> {
    type Wide = WideLanes<T>;
    #[inline]
    fn mul(self, other: Self) -> WideLanes<T> {
        WideLanes(self.1.mul(self.0, other.0), self.1)
    }
    #[inline]
    fn widen(self) -> WideLanes<T> {
        WideLanes(self.1.widen(self.0), self.1)
    }
    #[inline]
    fn narrow(wide: WideLanes<T>) -> Self {
        Self(wide.1.narrow(wide.0), wide.1)
    }
    #[inline(always)]
    fn round(wide: WideLanes<T>, drop: u32, up: u32) -> Self {
        let proof = wide.1;
        // If a sum wraps, the shift up or the narrowing drops its difference from the exact sum.
        let multiple = |word: Self| word.and(Self::lit(-1 << up));
        if drop <= 32 {
            return multiple(Self(proof.round_low(wide.0, drop, up), proof));
        }
        // The lower half is dropped whole. The rest is done on words, of which a vector holds twice as many.
        let high = Self(proof.high(wide.0), proof);
        if up == 0 {
            // For 33 places the upper half loses the rounding bit: the sum would need one more bit.
            return match drop {
                33 => Self::narrow(wide.sar(32).add(Wire::lit(1)).sar(1)),
                _ => high.sar(drop - 33).add(Self::lit(1)).sar(1),
            };
        }
        multiple(high.sar(drop - 32).add(Self::lit(1 << (up - 1))))
    }
    #[inline(always)]
    fn lookup(index: Self, table: &'static [i32]) -> Self {
        // A stage never asks outside the table; 0 keeps the function total, as on the scalar backend.
        Self(index.1.lookup(index.0, table), index.1)
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

impl<T: Target> WideWire for WideLanes<T> {
    type Word = Lanes<T>;
    #[inline(always)]
    fn wide_to_count(self) -> Lanes<T> {
        Lanes::narrow(self)
    }
    #[inline(always)]
    fn wide_of_count(count: Lanes<T>) -> Self {
        count.widen()
    }
    #[inline(always)]
    fn normalised<const N: usize>(wires: [Self; N], drop: u32, up: u32) -> ([Self::Word; N], Self::Count, Self::Flag) {
        normalised(wires, drop, up)
    }
}

impl<T: Target> Staged for Lanes<T> {
    #[inline(always)]
    fn stage<B: Bundle<Self>>(_name: &'static str, body: impl Fn() -> B + Copy) -> B {
        stage::<T, B>(body)
    }
}

/// One stage of the datapath as a separate function, compiled for the instruction set `T`. The body is passed by reference. If it were copied, its
/// captures would be read in other sizes than they were just written in, which stalls.
#[inline(never)]
#[expect(clippy::redundant_closure, reason = "only a closure can say that it is always inlined")]
fn stage<T: Target, B>(body: impl Fn() -> B + Copy) -> B {
    T::run(
        #[inline(always)]
        || body(),
    )
}
