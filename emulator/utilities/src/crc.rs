//! Check values: CRC-32 with polynomial 04c11db7, not reflected, most significant bit first, no final inversion.
//!
//! The polynomial is primitive, so in words below 2^32 bits every single flipped bit leaves another remainder and can be located.
//!
//! Of many words at once a step is by digits of four bits: the table of a digit is one permutation of a vector. By bytes it would be half the steps,
//! each a gather, which reads one lane after the other.

#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::{
    __m256i, __m512i, _mm256_blendv_ps, _mm256_castps_si256, _mm256_castsi256_ps, _mm256_permutevar8x32_epi32,
    _mm256_set1_epi32, _mm256_slli_epi32, _mm256_srlv_epi32, _mm256_xor_si256, _mm512_permutexvar_epi32,
    _mm512_set1_epi32, _mm512_srlv_epi32, _mm512_xor_si512,
};

#[cfg(target_arch = "x86_64")]
use fearless_simd::{Level, SimdInto, u32x8, u32x16};

/// Bits of a check value.
pub const BITS: u32 = 32;
/// Words side by side in [`remainders`].
pub const COLUMNS: usize = 64;

/// x³² modulo the polynomial.
const POLYNOMIAL: u32 = 0x04c1_1db7;

/// Bytes that are taken in at once.
const SLICES: usize = 8;

/// The remainder of a byte that so many bytes follow.
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

/// What four bytes behind it make of a remainder, by its digits of four bits, the lowest first.
#[cfg(target_arch = "x86_64")]
const BY_DIGIT: [[u32; 16]; 8] = {
    let mut digits = [[0; 16]; 8];
    let mut place = 0;
    while place < 8 {
        let mut digit = 0;
        while digit < 16 {
            digits[place][digit] = BY_BYTE[place / 2][digit << (4 * (place % 2))];
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

/// The remainder that so many zeros bring to this one.
pub const fn before_zeros(mut remainder: u32, mut zeros: u32) -> u32 {
    while zeros > 0 {
        // Backwards: the polynomial is odd, so the last bit says whether it was taken off.
        remainder = if remainder & 1 == 1 { (remainder ^ POLYNOMIAL) >> 1 | 1 << 31 } else { remainder >> 1 };
        zeros -= 1;
    }
    remainder
}

/// The remainder after so many bytes more, the last ones of `bytes`.
#[inline(always)]
fn after(bytes: u64, count: usize) -> u32 {
    (0..count).fold(0, |sum, followers| sum ^ BY_BYTE[followers][(bytes >> (8 * followers) & 255) as usize])
}

/// What these words make of a remainder, the first word first.
pub fn remainder(begun: u32, words: &[u32]) -> u32 {
    let (pairs, last) = words.as_chunks::<2>();
    let remainder = pairs
        .iter()
        .fold(begun, |remainder, &[high, low]| after(u64::from(remainder ^ high) << 32 | u64::from(low), 8));
    last.iter().fold(remainder, |remainder, &word| after(u64::from(remainder ^ word), 4))
}

/// What the words of each column make of its remainder, the first row first.
pub fn remainders(rows: &[[u32; COLUMNS]], sums: &mut [u32; COLUMNS]) {
    #[cfg(target_arch = "x86_64")]
    {
        let level = Level::new();
        if let Some(avx512) = level.as_avx512() {
            return by_avx512(avx512, rows, sums);
        }
        if let Some(avx2) = level.as_avx2() {
            return by_avx2(avx2, rows, sums);
        }
    }
    by_bytes(rows, sums);
}

/// One word after the other.
fn by_bytes(rows: &[[u32; COLUMNS]], sums: &mut [u32; COLUMNS]) {
    for row in rows {
        for (sum, &word) in sums.iter_mut().zip(row) {
            *sum = after(u64::from(*sum ^ word), 4);
        }
    }
}

#[cfg(target_arch = "x86_64")]
fearless_simd::kernel! {
    /// Two vectors side by side, for a step waits for the one before.
    fn by_avx512(t: Avx512, rows: &[[u32; COLUMNS]], sums: &mut [u32; COLUMNS]) {
        let loaded = |words: &[u32; 16]| -> __m512i {
            let words: u32x16<_> = (*words).simd_into(t);
            words.into()
        };
        let tables = BY_DIGIT.map(|table| loaded(&table));
        let step = |word: __m512i| {
            let mut sum = _mm512_permutexvar_epi32(word, tables[0]);
            for (digit, &table) in (0..).zip(&tables).skip(1) {
                let place = _mm512_srlv_epi32(word, _mm512_set1_epi32(4 * digit));
                sum = _mm512_xor_si512(sum, _mm512_permutexvar_epi32(place, table));
            }
            sum
        };
        for (pair, sums) in sums.as_chunks_mut::<16>().0.as_chunks_mut::<2>().0.iter_mut().enumerate() {
            let [mut first, mut second] = [loaded(&sums[0]), loaded(&sums[1])];
            for row in rows {
                let row = row.as_chunks().0;
                first = step(_mm512_xor_si512(first, loaded(&row[2 * pair])));
                second = step(_mm512_xor_si512(second, loaded(&row[2 * pair + 1])));
            }
            let [first, second]: [u32x16<_>; 2] = [first.simd_into(t), second.simd_into(t)];
            *sums = [*first, *second];
        }
    }
}

#[cfg(target_arch = "x86_64")]
fearless_simd::kernel! {
    /// The same; half a table is a vector.
    fn by_avx2(t: Avx2, rows: &[[u32; COLUMNS]], sums: &mut [u32; COLUMNS]) {
        let loaded = |words: &[u32; 8]| -> __m256i {
            let words: u32x8<_> = (*words).simd_into(t);
            words.into()
        };
        let tables = BY_DIGIT.map(|table| [loaded(&table.as_chunks().0[0]), loaded(&table.as_chunks().0[1])]);
        let entries = |places: __m256i, [low, high]: [__m256i; 2]| {
            let [low, high] = [low, high].map(|half| _mm256_castsi256_ps(_mm256_permutevar8x32_epi32(half, places)));
            let upper = _mm256_castsi256_ps(_mm256_slli_epi32::<28>(places));
            _mm256_castps_si256(_mm256_blendv_ps(low, high, upper))
        };
        let step = |word: __m256i| {
            let mut sum = entries(word, tables[0]);
            for (digit, &table) in (0..).zip(&tables).skip(1) {
                let place = _mm256_srlv_epi32(word, _mm256_set1_epi32(4 * digit));
                sum = _mm256_xor_si256(sum, entries(place, table));
            }
            sum
        };
        for (four, sums) in sums.as_chunks_mut::<8>().0.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            let mut vectors = [loaded(&sums[0]), loaded(&sums[1]), loaded(&sums[2]), loaded(&sums[3])];
            for row in rows {
                let row = row.as_chunks().0;
                for (i, vector) in vectors.iter_mut().enumerate() {
                    *vector = step(_mm256_xor_si256(*vector, loaded(&row[4 * four + i])));
                }
            }
            for (sum, vector) in sums.iter_mut().zip(vectors) {
                let words: u32x8<_> = vector.simd_into(t);
                *sum = *words;
            }
        }
    }
}

/// Which bit of a word of so many bits, check value included, was flipped, if one was: the place whose remainder is `syndrome`, the exclusive
/// or of the check value found and the one computed.
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
    use super::*;
    use crate::random::SplitMix64;

    /// A way from rows and remainders to remainders.
    type Way<'a> = dyn Fn(&[[u32; COLUMNS]], &mut [u32; COLUMNS]) + 'a;

    /// Bit by bit, as the polynomial says.
    fn slowly(begun: u32, words: &[u32]) -> u32 {
        words.iter().fold(begun, |remainder, word| (0..32).fold(remainder ^ word, |remainder, _| next(remainder)))
    }

    #[test]
    fn every_way_is_the_one_bit_by_bit() {
        let mut random = SplitMix64::new(1);
        let mut word = || random.next_u64() as u32;
        let rows: Vec<[u32; COLUMNS]> = (0..9).map(|_| std::array::from_fn(|_| word())).collect();
        let begun: [u32; COLUMNS] = std::array::from_fn(|_| word());
        let column = |column: usize| rows.iter().map(|row| row[column]).collect::<Vec<_>>();
        let expected: [u32; COLUMNS] = std::array::from_fn(|i| slowly(begun[i], &column(i)));
        assert_eq!(std::array::from_fn(|i| remainder(begun[i], &column(i))), expected);
        let by = |way: &Way<'_>| {
            let mut sums = begun;
            way(&rows, &mut sums);
            sums
        };
        assert_eq!(by(&remainders), expected);
        assert_eq!(by(&by_bytes), expected);
        #[cfg(target_arch = "x86_64")]
        {
            let level = Level::new();
            if let Some(avx2) = level.as_avx2() {
                assert_eq!(by(&|rows, sums| by_avx2(avx2, rows, sums)), expected);
            }
            if let Some(avx512) = level.as_avx512() {
                assert_eq!(by(&|rows, sums| by_avx512(avx512, rows, sums)), expected);
            }
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
