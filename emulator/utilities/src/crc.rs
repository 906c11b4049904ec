//! Check values: CRC-32 with polynomial 04c11db7, not reflected, most significant bit first, no final inversion.
//!
//! The polynomial is primitive, so in words below 2^32 bits every single flipped bit leaves a different remainder and can be located.
//!
//! Many words at once are processed by four-bit digits: the table of a digit is one permutation of a vector. Bytes would take half the steps, but
//! each step would be a gather, which reads one lane after the other.

use roughxel_core::each::each;
use roughxel_core::fetch::Fetch;
use roughxel_core::fx::Fx;
use roughxel_core::word::Wire;
use roughxel_simd::{Backend, BatchWord, Kernel, LANES};

/// Bits of a check value.
pub const BITS: u32 = 32;
/// Number of columns in [`remainders`].
pub const COLUMNS: usize = 64;

/// x³² modulo the polynomial.
const POLYNOMIAL: u32 = 0x04c1_1db7;

/// Bytes processed at once.
const SLICES: usize = 8;

/// Remainder of a byte, by the number of bytes that follow it.
const BY_BYTE: [[u32; 256]; SLICES] = {
    let mut tables = [[0; 256]; SLICES];
    let mut byte = 0;
    while byte < 256 {
        let mut remainder = (byte as u32) << 24;
        let mut followers = 0;
        while followers < SLICES {
            let mut bit = 0;
            while bit < 8 {
                remainder = next(remainder);
                bit += 1;
            }
            tables[followers][byte] = remainder;
            followers += 1;
        }
        byte += 1;
    }
    tables
};

/// Remainders after four more bytes, by four-bit digits, the lowest first.
const BY_DIGIT: [[i32; 16]; 8] = {
    let mut digits = [[0; 16]; 8];
    let mut place = 0;
    while place < 8 {
        let mut digit = 0;
        while digit < 16 {
            digits[place][digit] = BY_BYTE[place / 2][digit << (4 * (place % 2))].cast_signed();
            digit += 1;
        }
        place += 1;
    }
    digits
};

/// x · remainder modulo the polynomial.
const fn next(remainder: u32) -> u32 {
    remainder << 1 ^ if remainder >> 31 == 1 { POLYNOMIAL } else { 0 }
}

/// Remainder that `zeros` more zero bits bring to this one.
pub const fn before_zeros(mut remainder: u32, mut zeros: u32) -> u32 {
    while zeros > 0 {
        // Backwards: the polynomial is odd, so the last bit shows whether it was subtracted.
        remainder = if remainder & 1 == 1 { (remainder ^ POLYNOMIAL) >> 1 | 1 << 31 } else { remainder >> 1 };
        zeros -= 1;
    }
    remainder
}

/// Remainder after `count` more bytes, the last ones of `bytes`.
#[inline(always)]
fn after(bytes: u64, count: usize) -> u32 {
    (0..count).fold(0, |sum, followers| sum ^ BY_BYTE[followers][(bytes >> (8 * followers) & 255) as usize])
}

/// Remainder after these words, the first word first.
pub fn remainder(begun: u32, words: &[u32]) -> u32 {
    let (pairs, last) = words.as_chunks::<2>();
    let remainder = pairs
        .iter()
        .fold(begun, |remainder, &[high, low]| after(u64::from(remainder ^ high) << 32 | u64::from(low), 8));
    last.iter().fold(remainder, |remainder, &word| after(u64::from(remainder ^ word), 4))
}

/// Remainder of each column after its words, the first row first.
pub fn remainders(rows: &[[u32; COLUMNS]], sums: &mut [u32; COLUMNS]) {
    remainders_by(Backend::best(), rows, sums);
}

/// Computes [`remainders`] on a backend.
fn remainders_by(backend: Backend, rows: &[[u32; COLUMNS]], sums: &mut [u32; COLUMNS]) {
    const { assert!(COLUMNS.is_multiple_of(2 * LANES), "no column is left over") }
    backend.dispatch_words(Columns { rows, sums });
}

/// Columns that are processed together, two vectors at once, for a step waits for the one before it.
struct Columns<'a> {
    rows: &'a [[u32; COLUMNS]],
    sums: &'a mut [u32; COLUMNS],
}

impl Kernel for Columns<'_> {
    type Outcome = ();
    fn run<W: BatchWord>(self) {
        let Self { rows, sums } = self;
        W::run(
            #[inline(always)]
            || {
                let mut folded = [0; COLUMNS];
                for first in (0..COLUMNS / W::FRAGMENTS).step_by(2) {
                    let vectors = [first, first + 1];
                    let mut pair = each!(vector in vectors => loaded::<W>(sums, vector));
                    for row in rows {
                        pair = each!(i in [0, 1] => after_word::<W>(pair[i].xor(loaded::<W>(row, vectors[i]))));
                    }
                    for (sum, vector) in pair.into_iter().zip(vectors) {
                        W::store(W::counts(sum), W::vectors_mut(&mut folded), vector);
                    }
                }
                *sums = folded.map(i32::cast_unsigned);
            },
        );
    }
}

/// Words of a row from a vector on.
#[inline(always)]
fn loaded<W: BatchWord>(row: &[u32; COLUMNS], vector: usize) -> W::Count {
    let words = row.map(u32::cast_signed);
    W::of_counts(W::load(W::proof(), W::vectors(&words), vector))
}

/// Remainder after four more bytes, which are already added to it.
#[inline(always)]
fn after_word<W: Fetch>(word: W::Count) -> W::Count {
    let digits = each!(digit in [0, 1, 2, 3, 4, 5, 6, 7] => {
        W::entry(Fx::from_raw(word.sar(4 * digit)), &BY_DIGIT[digit as usize]).raw()
    });
    let pairs = each!(i in [0, 2, 4, 6] => digits[i].xor(digits[i + 1]));
    pairs[0].xor(pairs[1]).xor(pairs[2].xor(pairs[3]))
}

/// Place of the single flipped bit in a word of `bits` bits, check value included, if one was flipped. It is the place whose remainder is `syndrome`,
/// the exclusive or of the found and the computed check value.
pub fn flipped_bit(syndrome: u32, bits: u32) -> Option<u32> {
    if syndrome.count_ones() == 1 {
        return Some(syndrome.trailing_zeros());
    }
    // A data bit just above the check value has the remainder x^32, the next one x^33, …
    let mut remainder = POLYNOMIAL;
    for place in BITS..bits {
        if remainder == syndrome {
            return Some(place);
        }
        remainder = next(remainder);
    }
    None
}

#[cfg(test)]
mod tests {
    use roughxel_simd::InstructionSet;

    use super::*;
    use crate::random::SplitMix64;

    /// Remainder bit by bit, as the polynomial defines it.
    fn slowly(begun: u32, words: &[u32]) -> u32 {
        words.iter().fold(begun, |remainder, word| (0..32).fold(remainder ^ word, |remainder, _| next(remainder)))
    }

    #[test]
    fn every_backend_is_the_one_bit_by_bit() {
        let mut random = SplitMix64::new(1);
        let mut word = || random.next_u64() as u32;
        let rows: Vec<[u32; COLUMNS]> = (0..9).map(|_| std::array::from_fn(|_| word())).collect();
        let begun: [u32; COLUMNS] = std::array::from_fn(|_| word());
        let column = |column: usize| rows.iter().map(|row| row[column]).collect::<Vec<_>>();
        let expected: [u32; COLUMNS] = std::array::from_fn(|i| slowly(begun[i], &column(i)));
        assert_eq!(std::array::from_fn(|i| remainder(begun[i], &column(i))), expected);
        let simd = InstructionSet::available().map(Backend::Simd);
        for backend in [Backend::Scalar].into_iter().chain(simd) {
            let mut sums = begun;
            remainders_by(backend, &rows, &mut sums);
            assert_eq!(sums, expected, "{backend}");
        }
    }

    #[test]
    fn zeros_are_taken_back_and_a_flipped_bit_is_found() {
        for zeros in 0..70 {
            let begun = before_zeros(u32::MAX, zeros);
            assert_eq!((0..zeros).fold(begun, |remainder, _| next(remainder)), u32::MAX);
        }
        let words = [0x1234_5678, 0x9abc_def0, 0x0f1e_2d3c];
        let check = remainder(u32::MAX, &words);
        for place in 0..128_u32 {
            let mut flipped = words;
            let found = match (place / 32) as usize {
                0 => check ^ 1 << place,
                word => {
                    flipped[3 - word] ^= 1 << (place % 32);
                    check
                }
            };
            assert_eq!(flipped_bit(remainder(u32::MAX, &flipped) ^ found, 128), Some(place));
        }
    }
}
