//! Linear maps of words over GF(2), such as a step of a cyclic code, of many words at once.
//!
//! By digits of four bits: the table of a digit is one permutation of a vector. By bytes it would be half the steps, each a gather, which reads one
//! lane after the other.

use roughxel_core::each::each;
use roughxel_core::fetch::Fetch;
use roughxel_core::fx::Fx;
#[cfg(target_arch = "x86_64")]
use roughxel_core::word::Wire;
use roughxel_core::word::Word;

use super::LANES;
use super::reading::Reading;
#[cfg(target_arch = "x86_64")]
use super::{Avx2, Avx512, InstructionSet, Lanes, Target};

/// What a map makes of each value of each digit of a word, the lowest digit first: of a word it makes the exclusive or of what it makes of its digits.
pub type Digits = [[i32; 16]; 8];

/// What the map makes of a word of each fragment.
#[inline(always)]
fn through<W: Fetch + Word<Count = W>>(map: &Digits, word: W) -> W {
    let digits = each!(digit in [0, 1, 2, 3, 4, 5, 6, 7] => {
        W::entry(Fx::from_raw(word.sar(4 * digit)), &map[digit as usize]).raw()
    });
    let pairs = each!(i in [0, 2, 4, 6] => digits[i].xor(digits[i + 1]));
    pairs[0].xor(pairs[1]).xor(pairs[2].xor(pairs[3]))
}

/// A word of each of these columns.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn loaded<T: Target>(proof: T, words: &[u32; LANES]) -> Lanes<T> {
    Lanes(proof.words(words.map(u32::cast_signed)), proof)
}

/// [`Reading::fold`], so many columns side by side: two vectors at once, for a step waits for the one before.
#[cfg(target_arch = "x86_64")]
fn fold_lanes<T: Target, const COLUMNS: usize>(map: &Digits, rows: &[[u32; COLUMNS]], sums: &mut [u32; COLUMNS]) {
    T::run(
        #[inline(always)]
        || {
            let proof = T::proof();
            for (pair, sums) in sums.as_chunks_mut::<LANES>().0.as_chunks_mut::<2>().0.iter_mut().enumerate() {
                let [mut first, mut second] = each!(sums in *sums => loaded(proof, &sums));
                for row in rows {
                    let row = row.as_chunks().0;
                    first = through(map, first.xor(loaded(proof, &row[2 * pair])));
                    second = through(map, second.xor(loaded(proof, &row[2 * pair + 1])));
                }
                *sums = each!(sum in [first, second] => sum.lanes().map(i32::cast_unsigned));
            }
        },
    );
}

impl Reading {
    /// Folds the rows of each column into its sum, the first row first: a sum becomes what the map makes of the exclusive or of it and of the
    /// column's word. Columns are a multiple of twice [`LANES`].
    pub fn fold<const COLUMNS: usize>(self, map: &Digits, rows: &[[u32; COLUMNS]], sums: &mut [u32; COLUMNS]) {
        const { assert!(COLUMNS.is_multiple_of(2 * LANES), "no column is left over") }
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Lanes(InstructionSet::Avx2) => fold_lanes::<Avx2, COLUMNS>(map, rows, sums),
            #[cfg(target_arch = "x86_64")]
            Self::Lanes(InstructionSet::Avx512) => fold_lanes::<Avx512, COLUMNS>(map, rows, sums),
            _ => {
                for row in rows {
                    for (sum, word) in sums.iter_mut().zip(row) {
                        *sum = through(map, (*sum ^ word).cast_signed()).cast_unsigned();
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reading_folds_as_the_map_does_bit_by_bit() {
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state ^ state >> 15
        };
        // A map of any bits, and the tables of its digits.
        let of_bit: [u32; 32] = std::array::from_fn(|_| random());
        let sum = |word: u32| (0..32).filter(|bit| word >> bit & 1 == 1).fold(0, |sum, bit| sum ^ of_bit[bit]);
        let map: Digits =
            std::array::from_fn(|digit| std::array::from_fn(|value| sum((value as u32) << (4 * digit)).cast_signed()));
        let rows: Vec<[u32; 64]> = (0..9).map(|_| std::array::from_fn(|_| random())).collect();
        let started: [u32; 64] = std::array::from_fn(|_| random());
        let expected =
            rows.iter().fold(started, |sums, row| std::array::from_fn(|column| sum(sums[column] ^ row[column])));
        for reading in [Reading::Scalar].into_iter().chain(InstructionSet::available().map(Reading::Lanes)) {
            let mut sums = started;
            reading.fold(&map, &rows, &mut sums);
            assert_eq!(sums, expected, "{reading}");
        }
    }
}
