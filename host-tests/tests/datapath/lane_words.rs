//! Every operation of words in lanes gives the bits of the scalar backend, with every instruction set of this machine.

use rayon::prelude::*;
use roughxel_core::word::{Wire, Word};
use roughxel_host_tests::space::{is_full_run, whole_or};
#[cfg(target_arch = "x86_64")]
use roughxel_simd::{Avx2, Avx512};
use roughxel_simd::{Halves, InstructionSet, LANES, Lanes, NARROW_LANES, NarrowLanes, Target, WideLanes};
use roughxel_utilities::random::SplitMix64;

/// A wide wire of 16-bit words, and a control wire of such words.
type NarrowWides<T> = Halves<Lanes<T>>;
/// A wide wire of such control wires.
type NarrowWideCounts<T> = Halves<WideLanes<T>>;

/// The instruction sets of this machine; prints the ones that it cannot test. The baseline is the scalar backend.
pub(super) fn instruction_sets() -> Vec<InstructionSet> {
    for set in InstructionSet::ALL.into_iter().filter(|set| !set.is_available()) {
        eprintln!("SKIPPED: this machine has no {set}");
    }
    InstructionSet::available().collect()
}

/// `check!(set => check::<T>(…))` with the type `T` of an instruction set.
macro_rules! check {
    ($set:expr => $check:ident($($argument:expr),*)) => {
        match $set {
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 => $check::<Avx2>($($argument),*),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => $check::<Avx512>($($argument),*),
            #[cfg(not(target_arch = "x86_64"))]
            set => panic!("{set} belongs to a different machine"),
        }
    };
}

/// A wire with weight on the corners: the ends of the range, single bits, runs of ones; otherwise any bits.
pub(super) fn corner(random: &mut SplitMix64) -> i64 {
    let power = 1_i64 << random.below(64);
    match random.below(8) {
        0 => 0,
        1 => i64::MIN.wrapping_add(random.below(3) as i64),
        2 => i64::MAX - random.below(3) as i64,
        3 => power,
        4 => power.wrapping_neg(),
        5 => power.wrapping_sub(1),
        _ => random.next_u64() as i64 >> random.below(63),
    }
}

/// Every operation that words and wide wires share, on all lanes, against the scalar backend.
macro_rules! shared_operations {
    ($name:ident, $count:literal of $lanes:ident, $int:ty, $counts:ident) => {
        fn $name<T: Target>(random: &mut SplitMix64) {
            let mut lane = || core::array::from_fn(|_| corner(random) as $int);
            let [a, b]: [[$int; $count]; 2] = [lane(), lane()];
            let counts: [i32; $count] = core::array::from_fn(|_| corner(random) as i32);
            let (value, k) = (corner(random) as $int, random.below(u64::from(<$int>::BITS)) as u32);
            let (x, y, n) = ($lanes::<T>::from_array(a), $lanes::<T>::from_array(b), $counts::<T>::from_array(counts));
            let (below, positive) = (x.lt(y), $lanes::lit(0).lt(x));
            macro_rules! same {
                ($lanes_operation:expr, |$i:ident| $scalar:expr) => {
                    // Inside the function that is compiled for the instruction set, as in a stage.
                    let got = T::run(
                        #[inline(always)]
                        || $lanes_operation,
                    );
                    let name = stringify!($lanes_operation);
                    for ($i, got) in got.lanes().iter().enumerate() {
                        let operands = (a[$i], b[$i], counts[$i], k);
                        assert_eq!(*got, $scalar, "{name} of {operands:?}");
                    }
                };
            }
            same!($lanes::<T>::lit(value.into()), |i| value + a[i].and(0));
            same!(x.add(y), |i| a[i].add(b[i]));
            same!(x.sub(y), |i| a[i].sub(b[i]));
            same!(x.shl(k), |i| a[i].shl(k));
            same!(x.sar(k), |i| a[i].sar(k));
            same!(x.shl_by(n), |i| a[i].shl_by(counts[i]));
            same!(x.sar_by(n), |i| a[i].sar_by(counts[i]));
            same!(x.and(y), |i| a[i].and(b[i]));
            same!(x.or(y), |i| a[i].or(b[i]));
            same!(x.xor(y), |i| a[i].xor(b[i]));
            same!(x.lt(y), |i| a[i].lt(b[i]));
            same!(!below, |i| !a[i].lt(b[i]));
            same!(below & positive, |i| a[i].lt(b[i]) & <$int>::lit(0).lt(a[i]));
            same!(below | positive, |i| a[i].lt(b[i]) | <$int>::lit(0).lt(a[i]));
            same!(Wire::select(below, x, y), |i| if a[i].lt(b[i]) { a[i] } else { b[i] });
            same!(x.leading_zeros(), |i| a[i].leading_zeros() as i32);
        }
    };
}

shared_operations!(operations_of_words_and_wide_wires, 16 of Lanes, i32, Lanes);
shared_operations!(operations_of_wide_wires, 16 of WideLanes, i64, Lanes);
shared_operations!(operations_of_narrow_words_and_wide_wires, 32 of NarrowLanes, i16, NarrowWides);
shared_operations!(operations_of_narrow_wide_wires_and_counts, 32 of NarrowWides, i32, NarrowWides);
shared_operations!(operations_of_narrow_wide_counts, 32 of NarrowWideCounts, i64, NarrowWides);

static TABLE: [i32; 1100] = {
    let mut table = [0; 1100];
    let mut place = 0;
    while place < table.len() {
        table[place] = (place as i32 + 1).wrapping_mul(-0x61c8_8647);
        place += 1;
    }
    table
};

/// The operations of words only.
macro_rules! operations_of_words {
    ($name:ident, $count:literal of $words:ident, $int:ty, $wides:ident, $wide:ty, $counts:ident) => {
        fn $name<T: Target>(random: &mut SplitMix64) {
            // No whole vector of entries; one, and several; a page of 256 and more.
            let lengths = [5, 16, 17, 32, 49, 77, 192, 256, 257, 768, 1024, 1100];
            let table = &TABLE[..lengths[random.below(lengths.len() as u64) as usize]];
            // Places over the whole table and beyond, or all in one row of sixteen.
            let row = random.below(table.len() as u64 / 16 + 2) as i32;
            let (first, span) = if random.below(2) == 1 { (-1, table.len() as u64 + 40) } else { (16 * row, 16) };
            let mut lane = || core::array::from_fn(|_| corner(random) as $int);
            let [a, b]: [[$int; $count]; 2] = [lane(), lane()];
            let places: [i32; $count] = core::array::from_fn(|_| first + random.below(span) as i32);
            let wide: [$wide; $count] = core::array::from_fn(|_| corner(random) as $wide);
            let [x, y] = [a, b].map($words::<T>::from_array);
            let (w, place) = ($wides::<T>::from_array(wide), $counts::<T>::from_array(places));
            macro_rules! same {
                ($operation:expr, $got:expr, |$i:ident| $scalar:expr) => {
                    let got = T::run(
                        #[inline(always)]
                        || $got,
                    );
                    for ($i, got) in got.lanes().into_iter().enumerate() {
                        let operands = (a[$i], b[$i], wide[$i], places[$i]);
                        assert_eq!(got, $scalar, "{} of {operands:?}", $operation);
                    }
                };
            }
            same!("mul", x.mul(y), |i| a[i].mul(b[i]));
            same!("widen", x.widen(), |i| a[i].widen());
            same!("narrow", $words::<T>::narrow(w), |i| <$int>::narrow(wide[i]));
            same!("lookup", $words::<T>::lookup(place, table), |i| <$int>::lookup(places[i], table));
            same!("to_count", x.to_count(), |i| a[i].to_count());
            same!("of_count", $words::<T>::of_count(place), |i| <$int>::of_count(places[i]));
            for drop in 1..<$wide>::BITS {
                for up in (0..<$int>::BITS).take_while(|up| drop + up < <$wide>::BITS) {
                    let name = format!("round by {drop} + {up}");
                    same!(name, $words::<T>::round(w, drop, up), |i| <$int>::round(wide[i], drop, up));
                }
            }
        }
    };
}

operations_of_words!(operations_of_words, 16 of Lanes, i32, WideLanes, i64, Lanes);
operations_of_words!(operations_of_narrow_words, 32 of NarrowLanes, i16, NarrowWides, i32, NarrowWides);
operations_of_words!(operations_of_narrow_counts, 32 of NarrowWides, i32, NarrowWideCounts, i64, NarrowWides);

#[test]
fn every_operation_gives_the_bits_of_the_scalar_backend() {
    for set in instruction_sets() {
        (0..whole_or(20_000_u64, 4000)).into_par_iter().for_each(|index| {
            let random = &mut SplitMix64::for_element("operations", index);
            check!(set => operations_of_words_and_wide_wires(random));
            check!(set => operations_of_wide_wires(random));
            check!(set => operations_of_words(random));
            check!(set => operations_of_narrow_words_and_wide_wires(random));
            check!(set => operations_of_narrow_wide_wires_and_counts(random));
            check!(set => operations_of_narrow_wide_counts(random));
            check!(set => operations_of_narrow_words(random));
            check!(set => operations_of_narrow_counts(random));
        });
    }
}

/// Leading zeros of the words whose upper half is `upper`.
fn leading_zeros_below<T: Target>(upper: u16) {
    for lower in (0..=u16::MAX).step_by(LANES) {
        let words = core::array::from_fn(|lane| i32::from(upper as i16) << 16 | i32::from(lower + lane as u16));
        let zeros = T::run(
            #[inline(always)]
            || Lanes::<T>::from_array(words).leading_zeros(),
        );
        assert_eq!(zeros.lanes(), words.map(|word| word.leading_zeros() as i32), "{words:?}");
    }
}

#[test]
fn leading_zeros_are_those_of_every_word() {
    // Without a full run, words whose upper halves have few leading bits.
    let upper = (0..=u16::MAX).filter(|&upper| is_full_run() || upper.count_ones() <= 1 || upper % 257 == 0);
    let upper: Vec<u16> = upper.collect();
    for set in instruction_sets() {
        upper.par_iter().for_each(|&upper| check!(set => leading_zeros_below(upper)));
        check!(set => leading_zeros_of_narrow_words());
    }
}

fn leading_zeros_of_narrow_words<T: Target>() {
    for first in (0..=u16::MAX).step_by(NARROW_LANES) {
        let words = core::array::from_fn(|lane| (first + lane as u16) as i16);
        let zeros = T::run(
            #[inline(always)]
            || NarrowLanes::<T>::from_array(words).leading_zeros(),
        );
        assert_eq!(zeros.lanes(), words.map(|word| word.leading_zeros() as i32), "{words:?}");
    }
}
