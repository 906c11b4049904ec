//! Operations of an instruction set, on [`LANES`](super::LANES) lanes in as many vectors as they take.

use std::fmt::Debug;

use super::LANES;

/// A table of the datapath; places beyond it read as 0.
pub(crate) type Table = &'static [i32];

/// A table of sixteen entries.
pub(crate) type Entries<'a> = &'a [i32; 16];

/// 64-bit words, at least two.
pub(crate) type Memory<'a> = &'a [u64];

macro_rules! vectors_trait {
    ($($name:ident($($a:ident: $ty:ident),*) -> $out:ident;)*) => {
        /// Operations of [`Wire`](roughxel_core::word::Wire) and [`Word`](roughxel_core::word::Word). Those of wide wires have the suffix `_wide`,
        /// those of 16-bit words `_short`. A value proves that the machine has the instruction set.
        pub trait Vectors: Copy + Debug + Send + Sync + 'static {
            /// Words.
            type Words: Copy + Debug;
            /// Wide wires.
            type Wides: Copy + Debug;
            /// Flags.
            type Flags: Copy + Debug;
            /// 16-bit words, two in the place of each of [`Self::Words`]: the even and the odd lanes of twice as many fragments.
            type Shorts: Copy + Debug;
            /// Flags of 16-bit words.
            type ShortFlags: Copy + Debug;

            /// Proof of the instruction set. Panics if the machine does not have it.
            fn detect() -> Self;
            /// Proof in a thread that has found it earlier. Panics in any other.
            fn proof() -> Self;
            /// Halves of the word at each place and of the next word, the lower half first.
            fn pairs(self, places: Self::Words, memory: Memory) -> [Self::Words; 4];
            $(
                #[doc = concat!("`", stringify!($name), "` of every lane.")]
                fn $name(self, $($a: vectors_trait!(@type $ty)),*) -> vectors_trait!(@type $out);
            )*
        }
    };
    (@type Words) => { Self::Words };
    (@type Wides) => { Self::Wides };
    (@type Flags) => { Self::Flags };
    (@type Shorts) => { Self::Shorts };
    (@type ShortFlags) => { Self::ShortFlags };
    (@type WordLanes) => { [i32; LANES] };
    (@type WideLanes) => { [i64; LANES] };
    (@type FlagLanes) => { [bool; LANES] };
    (@type $other:ident) => { $other };
}

vectors_trait! {
    words(lanes: WordLanes) -> Words;
    wides(lanes: WideLanes) -> Wides;
    flags(lanes: FlagLanes) -> Flags;
    word_lanes(a: Words) -> WordLanes;
    wide_lanes(a: Wides) -> WideLanes;
    flag_lanes(a: Flags) -> FlagLanes;
    splat(value: i32) -> Words;
    splat_wide(value: i64) -> Wides;
    not(a: Flags) -> Flags;
    both(a: Flags, b: Flags) -> Flags;
    either(a: Flags, b: Flags) -> Flags;
    add(a: Words, b: Words) -> Words;
    sub(a: Words, b: Words) -> Words;
    and(a: Words, b: Words) -> Words;
    or(a: Words, b: Words) -> Words;
    xor(a: Words, b: Words) -> Words;
    shl(a: Words, k: u32) -> Words;
    sar(a: Words, k: u32) -> Words;
    shl_by(a: Words, k: Words) -> Words;
    sar_by(a: Words, k: Words) -> Words;
    lt(a: Words, b: Words) -> Flags;
    select(f: Flags, a: Words, b: Words) -> Words;
    leading_zeros(a: Words) -> Words;
    lookup(places: Words, table: Table) -> Words;
    entries(places: Words, table: Entries) -> Words;
    add_wide(a: Wides, b: Wides) -> Wides;
    sub_wide(a: Wides, b: Wides) -> Wides;
    and_wide(a: Wides, b: Wides) -> Wides;
    or_wide(a: Wides, b: Wides) -> Wides;
    xor_wide(a: Wides, b: Wides) -> Wides;
    shl_wide(a: Wides, k: u32) -> Wides;
    sar_wide(a: Wides, k: u32) -> Wides;
    shl_wide_by(a: Wides, k: Words) -> Wides;
    sar_wide_by(a: Wides, k: Words) -> Wides;
    lt_wide(a: Wides, b: Wides) -> Flags;
    select_wide(f: Flags, a: Wides, b: Wides) -> Wides;
    leading_zeros_wide(a: Wides) -> Words;
    mul(a: Words, b: Words) -> Wides;
    widen(a: Words) -> Wides;
    narrow(a: Wides) -> Words;
    high(a: Wides) -> Words;
    round_low(a: Wides, drop: u32, up: u32) -> Words;
    splat_short(value: i16) -> Shorts;
    not_short(a: ShortFlags) -> ShortFlags;
    both_short(a: ShortFlags, b: ShortFlags) -> ShortFlags;
    either_short(a: ShortFlags, b: ShortFlags) -> ShortFlags;
    add_short(a: Shorts, b: Shorts) -> Shorts;
    sub_short(a: Shorts, b: Shorts) -> Shorts;
    and_short(a: Shorts, b: Shorts) -> Shorts;
    or_short(a: Shorts, b: Shorts) -> Shorts;
    xor_short(a: Shorts, b: Shorts) -> Shorts;
    shl_short(a: Shorts, k: u32) -> Shorts;
    sar_short(a: Shorts, k: u32) -> Shorts;
    shl_short_by(a: Shorts, even: Words, odd: Words) -> Shorts;
    sar_short_by(a: Shorts, even: Words, odd: Words) -> Shorts;
    lt_short(a: Shorts, b: Shorts) -> ShortFlags;
    select_short(f: ShortFlags, a: Shorts, b: Shorts) -> Shorts;
    even_flags(f: ShortFlags) -> Flags;
    odd_flags(f: ShortFlags) -> Flags;
    short_flags(even: Flags, odd: Flags) -> ShortFlags;
    mul_even(a: Shorts, b: Shorts) -> Words;
    mul_odd(a: Shorts, b: Shorts) -> Words;
    even(a: Shorts) -> Words;
    odd(a: Shorts) -> Words;
    even_high(a: Shorts) -> Words;
    odd_high(a: Shorts) -> Words;
    short(even: Words, odd: Words) -> Shorts;
    short_high(even: Words, odd: Words) -> Shorts;
    round_short_low(even: Words, odd: Words, drop: u32, up: u32) -> Shorts;
    round_short(a: Shorts, drop: u32) -> Shorts;
    lookup_short(even: Words, odd: Words, table: Table) -> Shorts;
}

/// Implements [`Vectors`] and [`Target`](super::Target) with the vectors of an instruction set. Code written for one vector of words runs for all of
/// them.
#[cfg(target_arch = "x86_64")]
macro_rules! vectors {
    (
        $(#[$doc:meta])*
        $target:ident: $proof:ident, $detected:ident, $vectors:tt vectors of $Word:ident, $Wide:ident, $Flag:ident, $Short:ident, $ShortFlag:ident;
        to { $(fn $to:ident($t0:ident, $a0:ident: $lanes0:ty) -> $out0:ident $body0:block)* }
        from { $(fn $from:ident($t1:ident, $a1:ident: $ty1:ident) -> $lanes1:ty $body1:block)* }
        memory { $(fn $part:ident($t3:ident, $a3:ident: $ty3:ty) -> $out3:ty $body3:block)* }
        inline { $(fn $inline:ident($t4:ident $(, $a4:ident: $ty4:ident)*) -> $out4:ident $body4:block)* }
        all { $(fn $all:ident($t2:ident, $a2:ident: $ty2:ident) -> $out2:ident $body2:block)* }
        $(fn $name:ident($t:ident $(, $a:ident: $ty:ident)*) -> $out:ident $body:block)*
    ) => {
        $(fearless_simd::kernel! { #[inline(always)] fn $to($t0: $target, $a0: $lanes0) -> $out0 { $body0 } })*
        $(fearless_simd::kernel! { #[inline(always)] fn $from($t1: $target, $a1: $ty1) -> $lanes1 { $body1 } })*
        $(fearless_simd::kernel! { #[inline(always)] fn $part($t3: $target, $a3: $ty3) -> $out3 { $body3 } })*

        // No kernels: at their size those would be calls, and vectors go to a call and come back through memory.
        $(
            #[inline(always)]
            fn $inline($t4: $proof $(, $a4: $ty4)*) -> $out4 { $body4 }
        )*

        #[inline(always)]
        fn pairs_of(t: $proof, places: $Word, memory: Memory) -> [$Word; 4] {
            if memory.len() < 2 {
                return [splat(t, 0); 4];
            }
            let lanes = word_lanes(t, places);
            let rows = each!(i in [0, 1, 2, 3] => {
                row(t, each!(part in roughxel_core::each::places() => two(memory, lanes[i + 4 * part])))
            });
            transposed(t, rows)
        }
        $(fearless_simd::kernel! { #[inline(always)] fn $all($t2: $target, $a2: $ty2) -> $out2 { $body2 } })*
        $(fearless_simd::kernel! { #[inline(always)] fn $name($t: $target $(, $a: $ty)*) -> $out { $body } })*

        const _: () = assert!(size_of::<[$Word; $vectors]>() == size_of::<[i32; $crate::LANES]>(), "vectors hold every lane");

        type Words = [$Word; $vectors];
        type Wides = [$Wide; $vectors];
        type Flags = [$Flag; $vectors];
        type Shorts = [$Short; $vectors];
        type ShortFlags = [$ShortFlag; $vectors];

        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $target($proof);

        thread_local! {
            /// Proof for literals, which have no operand that carries it. It is stored at the start of a function compiled for the instruction set,
            /// so asking costs a compare at most.
            static PROOF: core::cell::Cell<Option<$proof>> = const { core::cell::Cell::new(None) };
        }

        /// Proof of this thread. It uses `try_with`, the one access that the standard library marks to be inlined.
        #[inline]
        fn found() -> Option<$proof> {
            PROOF.try_with(core::cell::Cell::get).ok().flatten()
        }

        /// Keeps the proof for this thread. If it cannot be kept, it is not found.
        #[inline]
        fn keep(proof: $proof) {
            let _ = PROOF.try_with(#[inline(always)] |kept| kept.set(Some(proof)));
        }

        /// Looks for the instruction set, once in a thread.
        #[cold]
        #[inline(never)]
        fn detect() -> $proof {
            let Some(proof) = fearless_simd::Level::new().$detected() else {
                unreachable!("the machine has the instruction set")
            };
            keep(proof);
            proof
        }

        impl $crate::Target for $target {
            #[inline(always)]
            fn run<R>(body: impl FnOnce() -> R) -> R {
                // Never dropped. A drop would run if a call unwinds, as in `each`.
                let body = core::mem::ManuallyDrop::new(body);
                let Self(proof) = $crate::vectors::Vectors::detect();
                fearless_simd::Simd::vectorize(
                    proof,
                    #[inline(always)]
                    || {
                        keep(proof);
                        core::mem::ManuallyDrop::into_inner(body)()
                    },
                )
            }
        }

        impl $crate::vectors::Vectors for $target {
            type Words = Words;
            type Wides = Wides;
            type Flags = Flags;
            type Shorts = Shorts;
            type ShortFlags = ShortFlags;

            #[inline]
            fn detect() -> Self {
                Self(found().unwrap_or_else(detect))
            }
            #[inline]
            fn proof() -> Self {
                // Not `detect`: around a call that may return, every vector would have to go to memory.
                let Some(proof) = found() else { $crate::vectors::outside() };
                Self(proof)
            }
            $(
                #[inline(always)]
                fn $to(self, lanes: vectors!(@lanes $out0)) -> vectors!(@vectors $out0) {
                    let lanes = lanes.as_chunks().0;
                    vectors!(@each $vectors, $to, self.0, (lanes: $out0))
                }
            )*
            $(
                #[inline(always)]
                fn $from(self, a: vectors!(@vectors $ty1)) -> vectors!(@lanes $ty1) {
                    let vectors: [$lanes1; $vectors] = vectors!(@each $vectors, $from, self.0, (a: $ty1));
                    // As a whole: element by element it is a loop through memory.
                    vectors!(@joined $vectors, vectors)
                }
            )*
            #[inline(always)]
            fn pairs(self, places: Self::Words, memory: Memory) -> [Self::Words; 4] {
                let vectors: [[$Word; 4]; $vectors] = vectors!(@each $vectors, pairs_of, self.0, (places: Word), (memory: Memory));
                each!(word in [0, 1, 2, 3] => each!(vector in vectors => vector[word]))
            }
            $(
                #[inline(always)]
                fn $inline(self $(, $a4: vectors!(@vectors $ty4))*) -> vectors!(@vectors $out4) {
                    vectors!(@each $vectors, $inline, self.0 $(, ($a4: $ty4))*)
                }
            )*
            $(
                #[inline(always)]
                fn $all(self, value: $ty2) -> vectors!(@vectors $out2) {
                    vectors!(@same $vectors, $all(self.0, value))
                }
            )*
            // One call for all vectors: the optimiser has it in its last form before it inlines it anywhere.
            $(
                #[inline]
                fn $name(self $(, $a: vectors!(@vectors $ty))*) -> vectors!(@vectors $out) {
                    fearless_simd::kernel! {
                        #[inline(always)]
                        fn all(t: $target $(, $a: vectors!(@all $ty))*) -> vectors!(@all $out) {
                            vectors!(@each $vectors, $name, t $(, ($a: $ty))*)
                        }
                    }
                    all(self.0 $(, $a)*)
                }
            )*
        }
    };
    (@lanes Word) => { [i32; $crate::LANES] };
    (@lanes Wide) => { [i64; $crate::LANES] };
    (@lanes Flag) => { [bool; $crate::LANES] };
    (@vectors Word) => { Self::Words };
    (@vectors Wide) => { Self::Wides };
    (@vectors Flag) => { Self::Flags };
    (@vectors Short) => { Self::Shorts };
    (@vectors ShortFlag) => { Self::ShortFlags };
    (@all Word) => { Words };
    (@all Wide) => { Wides };
    (@all Flag) => { Flags };
    (@all Short) => { Shorts };
    (@all ShortFlag) => { ShortFlags };
    (@all $other:ident) => { $other };
    (@vectors u32) => { u32 };
    (@vectors Table) => { Table };
    (@vectors Entries) => { Entries };
    (@joined 1, $vectors:ident) => { $vectors[0] };
    (@joined 2, $vectors:ident) => { $crate::vectors::joined($vectors) };
    // `[vector; 2]` is a loop.
    (@same 1, $value:expr) => { [$value] };
    (@same 2, $value:expr) => {{
        let value = $value;
        [value, value]
    }};
    // Written out: as a loop every operation is ten blocks. A stage has ten thousands of operations before the optimiser sees it whole.
    (@each 1, $name:ident, $proof:expr $(, ($a:ident: $ty:ident))*) => {
        [$name($proof $(, vectors!(@vector $ty, $a, 0))*)]
    };
    (@each 2, $name:ident, $proof:expr $(, ($a:ident: $ty:ident))*) => {
        [$name($proof $(, vectors!(@vector $ty, $a, 0))*), $name($proof $(, vectors!(@vector $ty, $a, 1))*)]
    };
    (@vector u32, $a:ident, $v:literal) => { $a };
    (@vector Table, $a:ident, $v:literal) => { $a };
    (@vector Entries, $a:ident, $v:literal) => { $a };
    (@vector Memory, $a:ident, $v:literal) => { $a };
    (@vector $other:ident, $a:ident, $v:literal) => { $a[$v] };
}
#[cfg(target_arch = "x86_64")]
pub(crate) use vectors;

/// Ends the program if a thread makes a literal before any other wire.
#[cfg(target_arch = "x86_64")]
#[cold]
#[inline(never)]
pub(crate) fn outside() -> ! {
    unreachable!("the first wire of a thread is made inside `Target::run`, or of values")
}

/// Lanes of two vectors, one after the other.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(crate) fn joined<T: Copy>([first, second]: [[T; LANES / 2]; 2]) -> [T; LANES] {
    let mut lanes = [first[0]; LANES];
    lanes[..LANES / 2].copy_from_slice(&first);
    lanes[LANES / 2..].copy_from_slice(&second);
    lanes
}
