//! AVX-512: a word is one vector; a wide wire is two, its even and its odd lanes, so products need no sign extension and rounding no packing. A flag
//! is three masks, of which the optimiser keeps the used ones.

use core::arch::x86_64::*;

use fearless_simd::x86::Avx512 as Proof;
use fearless_simd::{SimdInto, i32x16, i64x8};

use roughxel_core::each::each;
use roughxel_core::fetch::two;
use roughxel_core::rom::upper;

use super::vectors::{Entries, Memory, Table, vectors};

type Word = __m512i;
type Wide = [__m512i; 2];
type Short = __m512i;
type ShortFlag = __mmask32;

/// All lanes of a flag, and its even and its odd lanes. If it were a few bytes, the compiler would treat it as one integer and pack and unpack it at
/// every use.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct Flag {
    all: __mmask16,
    even: __mmask8,
    odd: __mmask8,
}

/// Entries of a table at the places of a vector. 32 entries are one permutation of two vectors, 16 entries one of a single vector. Among the eight
/// permutations for 256 entries three bits of the place choose.
macro_rules! look_up {
    (
        $places:ident in $table:ident, $int:ty, $test:ident, $splat:ident, $blend:ident, $mov:ident, $equal:ident, $srl:ident,
        $of_part:ident, $of_half_part:ident($t:ident), |$entry:ident| $of_entry:expr
    ) => {{
        let (pages, rest) = $table.as_chunks::<256>();
        let (parts, rest) = rest.as_chunks::<32>();
        let (half_parts, entries) = rest.as_chunks::<16>();
        let [bit_5, bit_6, bit_7] = each!(bit in [5, 6, 7] => $test($places, $splat(1 << bit)));
        let mut values = _mm512_setzero_si512();
        let (page_of, part_of) = ($srl::<8>($places), $srl::<5>($places));
        for (index, page) in pages.iter().enumerate() {
            let parts = page.as_chunks().0;
            let eight = each!(i in [0, 1, 2, 3, 4, 5, 6, 7] => $of_part($t, $places, &parts[i]));
            let four = each!(i in [0, 2, 4, 6] => $blend(bit_5, eight[i], eight[i + 1]));
            let two = each!(i in [0, 2] => $blend(bit_6, four[i], four[i + 1]));
            let here = $equal(page_of, $splat(index as $int));
            values = $mov(values, here, $blend(bit_7, two[0], two[1]));
        }
        for (index, part) in parts.iter().enumerate() {
            let here = $equal(part_of, $splat((8 * pages.len() + index) as $int));
            values = $mov(values, here, $of_part($t, $places, part));
        }
        for half_part in half_parts {
            let here = $equal($srl::<4>($places), $splat(($table.len() / 32 * 2) as $int));
            values = $mov(values, here, $of_half_part($t, $places, half_part));
        }
        for (index, &$entry) in entries.iter().enumerate() {
            let place = $table.len() - entries.len() + index;
            let here = $equal($places, $splat(place as $int));
            values = $mov(values, here, $splat($of_entry));
        }
        values
    }};
}

vectors! {
    /// AVX-512 of Ice Lake and later: vectors of 512 bits, masks, leading zeros.
    Avx512: Proof, as_avx512, 1 vectors of Word, Wide, Flag, Short, ShortFlag;

    to {
        fn words(t, lanes: [i32; 16]) -> Word { let v: i32x16<Proof> = lanes.simd_into(t); v.into() }
        fn wides(t, lanes: [i64; 16]) -> Wide {
            let half = |first: usize| -> i64x8<Proof> {
                let half: [i64; 8] = core::array::from_fn(|i| lanes[2 * i + first]);
                half.simd_into(t)
            };
            [half(0).into(), half(1).into()]
        }
        fn flags(t, lanes: [bool; 16]) -> Flag {
            let word = words(t, lanes.map(i32::from));
            of_all(t, _mm512_test_epi32_mask(word, word))
        }
    }
    from {
        fn word_lanes(t, a: Word) -> [i32; 16] { let v: i32x16<Proof> = a.simd_into(t); *v }
        fn wide_lanes(t, a: Wide) -> [i64; 16] {
            let [even, odd]: [i64x8<Proof>; 2] = a.map(|half| half.simd_into(t));
            core::array::from_fn(|i| if i % 2 == 0 { even[i / 2] } else { odd[i / 2] })
        }
        fn flag_lanes(t, a: Flag) -> [bool; 16] { core::array::from_fn(|i| a.all >> i & 1 != 0) }
    }
    memory {
        // Lanes 0, 4, 8, 12 in one, 1, 5, 9, 13 in the next: only an exchange inside quarters of vectors is left.
        fn row(t, quarters: [[u64; 2]; 4]) -> Word {
            let [a, b, c, d] = each!([first, second] in quarters => _mm_set_epi64x(second.cast_signed(), first.cast_signed()));
            let low = _mm256_inserti128_si256::<1>(_mm256_castsi128_si256(a), b);
            let high = _mm256_inserti128_si256::<1>(_mm256_castsi128_si256(c), d);
            _mm512_inserti64x4::<1>(_mm512_castsi256_si512(low), high)
        }
        fn transposed(t, rows: [Word; 4]) -> [Word; 4] {
            let first = each!(i in [0, 2] => _mm512_unpacklo_epi32(rows[i], rows[i + 1]));
            let second = each!(i in [0, 2] => _mm512_unpackhi_epi32(rows[i], rows[i + 1]));
            [
                _mm512_unpacklo_epi64(first[0], first[1]),
                _mm512_unpackhi_epi64(first[0], first[1]),
                _mm512_unpacklo_epi64(second[0], second[1]),
                _mm512_unpackhi_epi64(second[0], second[1]),
            ]
        }
    }
    inline {
        // From four pages on, permutations of all of them take longer than reading lane by lane. One page without a knot after it is rows of sixteen
        // by probe count, which most groups of lanes have in common. It takes a permutation of one vector in place of sixteen.
        fn lookup(t, places: Word, table: Table) -> Word {
            if table.len() == 256
                && let Some(row) = common_row(t, places, table.as_chunks().0)
            {
                return entries(t, places, row);
            }
            if table.len() <= 512 {
                return permuted(t, places, table);
            }
            words(t, each!(place in word_lanes(t, places) => table.get(place as usize).copied().unwrap_or(0)))
        }
    }
    all {
        fn splat(t, value: i32) -> Word { _mm512_set1_epi32(value) }
        fn splat_wide(t, value: i64) -> Wide { [_mm512_set1_epi64(value), _mm512_set1_epi64(value)] }
        fn splat_short(t, value: i16) -> Short { _mm512_set1_epi16(value) }
    }

    fn not(t, a: Flag) -> Flag { Flag { all: !a.all, even: !a.even, odd: !a.odd } }
    fn both(t, a: Flag, b: Flag) -> Flag { Flag { all: a.all & b.all, even: a.even & b.even, odd: a.odd & b.odd } }
    fn either(t, a: Flag, b: Flag) -> Flag { Flag { all: a.all | b.all, even: a.even | b.even, odd: a.odd | b.odd } }

    fn add(t, a: Word, b: Word) -> Word { _mm512_add_epi32(a, b) }
    fn sub(t, a: Word, b: Word) -> Word { _mm512_sub_epi32(a, b) }
    fn and(t, a: Word, b: Word) -> Word { _mm512_and_si512(a, b) }
    fn or(t, a: Word, b: Word) -> Word { _mm512_or_si512(a, b) }
    fn xor(t, a: Word, b: Word) -> Word { _mm512_xor_si512(a, b) }
    fn shl(t, a: Word, k: u32) -> Word { _mm512_sllv_epi32(a, _mm512_set1_epi32((k & 31).cast_signed())) }
    fn sar(t, a: Word, k: u32) -> Word { _mm512_srav_epi32(a, _mm512_set1_epi32((k & 31).cast_signed())) }
    fn shl_by(t, a: Word, k: Word) -> Word { _mm512_sllv_epi32(a, _mm512_and_si512(k, _mm512_set1_epi32(31))) }
    fn sar_by(t, a: Word, k: Word) -> Word { _mm512_srav_epi32(a, _mm512_and_si512(k, _mm512_set1_epi32(31))) }
    fn lt(t, a: Word, b: Word) -> Flag { of_all(t, _mm512_cmplt_epi32_mask(a, b)) }
    fn select(t, f: Flag, a: Word, b: Word) -> Word { _mm512_mask_blend_epi32(f.all, b, a) }
    fn leading_zeros(t, a: Word) -> Word { _mm512_lzcnt_epi32(a) }
    fn entries(t, places: Word, table: Entries) -> Word { _mm512_permutexvar_epi32(places, words(t, *table)) }

    fn add_wide(t, a: Wide, b: Wide) -> Wide { [_mm512_add_epi64(a[0], b[0]), _mm512_add_epi64(a[1], b[1])] }
    fn sub_wide(t, a: Wide, b: Wide) -> Wide { [_mm512_sub_epi64(a[0], b[0]), _mm512_sub_epi64(a[1], b[1])] }
    fn and_wide(t, a: Wide, b: Wide) -> Wide { [_mm512_and_si512(a[0], b[0]), _mm512_and_si512(a[1], b[1])] }
    fn or_wide(t, a: Wide, b: Wide) -> Wide { [_mm512_or_si512(a[0], b[0]), _mm512_or_si512(a[1], b[1])] }
    fn xor_wide(t, a: Wide, b: Wide) -> Wide { [_mm512_xor_si512(a[0], b[0]), _mm512_xor_si512(a[1], b[1])] }
    fn shl_wide(t, a: Wide, k: u32) -> Wide {
        let k = _mm512_set1_epi64(i64::from(k & 63));
        [_mm512_sllv_epi64(a[0], k), _mm512_sllv_epi64(a[1], k)]
    }
    fn sar_wide(t, a: Wide, k: u32) -> Wide {
        let k = _mm512_set1_epi64(i64::from(k & 63));
        [_mm512_srav_epi64(a[0], k), _mm512_srav_epi64(a[1], k)]
    }
    fn shl_wide_by(t, a: Wide, k: Word) -> Wide {
        let k = counts(t, k);
        [_mm512_sllv_epi64(a[0], k[0]), _mm512_sllv_epi64(a[1], k[1])]
    }
    fn sar_wide_by(t, a: Wide, k: Word) -> Wide {
        let k = counts(t, k);
        [_mm512_srav_epi64(a[0], k[0]), _mm512_srav_epi64(a[1], k[1])]
    }
    fn lt_wide(t, a: Wide, b: Wide) -> Flag {
        let (even, odd) = (_mm512_cmplt_epi64_mask(a[0], b[0]), _mm512_cmplt_epi64_mask(a[1], b[1]));
        let low = _mm512_maskz_set1_epi64(even, 0xffff_ffff);
        let lanes = _mm512_mask_or_epi64(low, odd, low, _mm512_set1_epi64(-1 << 32));
        Flag { all: _mm512_test_epi32_mask(lanes, lanes), even, odd }
    }
    fn select_wide(t, f: Flag, a: Wide, b: Wide) -> Wide {
        [_mm512_mask_blend_epi64(f.even, b[0], a[0]), _mm512_mask_blend_epi64(f.odd, b[1], a[1])]
    }
    fn leading_zeros_wide(t, a: Wide) -> Word {
        _mm512_or_si512(_mm512_lzcnt_epi64(a[0]), _mm512_slli_epi64::<32>(_mm512_lzcnt_epi64(a[1])))
    }

    fn mul(t, a: Word, b: Word) -> Wide {
        [_mm512_mul_epi32(a, b), _mm512_mul_epi32(_mm512_srli_epi64::<32>(a), _mm512_srli_epi64::<32>(b))]
    }
    fn widen(t, a: Word) -> Wide {
        [_mm512_srai_epi64::<32>(_mm512_slli_epi64::<32>(a)), _mm512_srai_epi64::<32>(a)]
    }
    fn narrow(t, a: Wide) -> Word { _mm512_mask_blend_epi32(0xaaaa, a[0], _mm512_slli_epi64::<32>(a[1])) }
    fn round_low(t, a: Wide, drop: u32, up: u32) -> Word {
        let half = _mm512_set1_epi64(1 << (drop + up - 1));
        let (right, left) = (_mm512_set1_epi64(i64::from(drop)), _mm512_set1_epi64(i64::from(32 - drop)));
        let even = _mm512_srlv_epi64(_mm512_add_epi64(a[0], half), right);
        _mm512_mask_blend_epi32(0xaaaa, even, _mm512_sllv_epi64(_mm512_add_epi64(a[1], half), left))
    }
    fn high(t, a: Wide) -> Word { _mm512_mask_blend_epi32(0xaaaa, _mm512_srli_epi64::<32>(a[0]), a[1]) }

    fn not_short(t, a: ShortFlag) -> ShortFlag { !a }
    fn both_short(t, a: ShortFlag, b: ShortFlag) -> ShortFlag { a & b }
    fn either_short(t, a: ShortFlag, b: ShortFlag) -> ShortFlag { a | b }
    fn add_short(t, a: Short, b: Short) -> Short { _mm512_add_epi16(a, b) }
    fn sub_short(t, a: Short, b: Short) -> Short { _mm512_sub_epi16(a, b) }
    fn and_short(t, a: Short, b: Short) -> Short { and(t, a, b) }
    fn or_short(t, a: Short, b: Short) -> Short { or(t, a, b) }
    fn xor_short(t, a: Short, b: Short) -> Short { xor(t, a, b) }
    fn shl_short(t, a: Short, k: u32) -> Short { _mm512_sllv_epi16(a, _mm512_set1_epi16((k & 15) as i16)) }
    fn sar_short(t, a: Short, k: u32) -> Short { _mm512_srav_epi16(a, _mm512_set1_epi16((k & 15) as i16)) }
    fn shl_short_by(t, a: Short, even: Word, odd: Word) -> Short { _mm512_sllv_epi16(a, short_counts(t, even, odd)) }
    fn sar_short_by(t, a: Short, even: Word, odd: Word) -> Short { _mm512_srav_epi16(a, short_counts(t, even, odd)) }
    fn lt_short(t, a: Short, b: Short) -> ShortFlag { _mm512_cmplt_epi16_mask(a, b) }
    fn select_short(t, f: ShortFlag, a: Short, b: Short) -> Short { _mm512_mask_blend_epi16(f, b, a) }
    fn even_flags(t, f: ShortFlag) -> Flag {
        of_all(t, _mm512_test_epi32_mask(_mm512_movm_epi16(f), _mm512_set1_epi32(1)))
    }
    fn odd_flags(t, f: ShortFlag) -> Flag { of_all(t, _mm512_movepi32_mask(_mm512_movm_epi16(f))) }
    fn short_flags(t, even: Flag, odd: Flag) -> ShortFlag {
        let (even, odd) = (_mm512_movm_epi32(even.all), _mm512_movm_epi32(odd.all));
        _mm512_movepi16_mask(_mm512_mask_blend_epi16(0xaaaa_aaaa, even, odd))
    }
    // Paired with a zero, a product is alone in its sum.
    fn mul_even(t, a: Short, b: Short) -> Word { _mm512_madd_epi16(_mm512_and_si512(a, _mm512_set1_epi32(0xffff)), b) }
    fn mul_odd(t, a: Short, b: Short) -> Word { _mm512_madd_epi16(odd_high(t, a), b) }
    fn even(t, a: Short) -> Word { _mm512_srai_epi32::<16>(_mm512_slli_epi32::<16>(a)) }
    fn odd(t, a: Short) -> Word { _mm512_srai_epi32::<16>(a) }
    fn even_high(t, a: Short) -> Word { _mm512_slli_epi32::<16>(a) }
    fn odd_high(t, a: Short) -> Word { _mm512_and_si512(a, _mm512_set1_epi32(-1 << 16)) }
    fn short(t, even: Word, odd: Word) -> Short {
        _mm512_mask_blend_epi16(0xaaaa_aaaa, even, _mm512_slli_epi32::<16>(odd))
    }
    fn short_high(t, even: Word, odd: Word) -> Short {
        _mm512_mask_blend_epi16(0xaaaa_aaaa, _mm512_srli_epi32::<16>(even), odd)
    }
    fn round_short_low(t, even: Word, odd: Word, drop: u32, up: u32) -> Short {
        let half = _mm512_set1_epi32(1 << (drop + up - 1));
        let (right, left) = (_mm512_set1_epi32(drop.cast_signed()), _mm512_set1_epi32((16 - drop).cast_signed()));
        let even = _mm512_srlv_epi32(_mm512_add_epi32(even, half), right);
        _mm512_mask_blend_epi16(0xaaaa_aaaa, even, _mm512_sllv_epi32(_mm512_add_epi32(odd, half), left))
    }
    // (a·2^(15 − drop) + 2^14)/2^15 is one instruction, with room for the sum.
    fn round_short(t, a: Short, drop: u32) -> Short { _mm512_mulhrs_epi16(a, _mm512_set1_epi16(1 << (15 - drop))) }
    fn lookup_short(t, even: Word, odd: Word, table: Table) -> Short {
        let places = short(t, even, odd);
        look_up!(places in table, i16, _mm512_test_epi16_mask, _mm512_set1_epi16, _mm512_mask_blend_epi16, _mm512_mask_mov_epi16,
            _mm512_cmpeq_epi16_mask, _mm512_srli_epi16, of_short_part, of_half_short_part(t), |entry| upper(entry, 16) as i16)
    }
}

fearless_simd::kernel! {
    /// Entries of a small table.
    #[inline(always)]
    fn permuted(t: Avx512, places: Word, table: Table) -> Word {
        look_up!(places in table, i32, _mm512_test_epi32_mask, _mm512_set1_epi32, _mm512_mask_blend_epi32, _mm512_mask_mov_epi32,
            _mm512_cmpeq_epi32_mask, _mm512_srli_epi32, of_part, of_half_part(t), |entry| entry)
    }
}

fearless_simd::kernel! {
    /// Shift counts of 16-bit words.
    #[inline(always)]
    fn short_counts(t: Avx512, even: Word, odd: Word) -> Short {
        _mm512_and_si512(short(t, even, odd), _mm512_set1_epi16(15))
    }
}

fearless_simd::kernel! {
    /// A flag of 32-bit lanes.
    #[inline(always)]
    fn of_all(t: Avx512, all: __mmask16) -> Flag {
        let lanes = _mm512_movm_epi32(all);
        Flag { all, even: _mm512_test_epi64_mask(lanes, _mm512_set1_epi64(1)), odd: _mm512_movepi64_mask(lanes) }
    }
}

fearless_simd::kernel! {
    /// Entries at the places modulo 32.
    #[inline(always)]
    fn of_part(t: Avx512, places: Word, part: &[i32; 32]) -> Word {
        let [low, high] = each!(half in [0, 1] => words(t, part.as_chunks().0[half]));
        _mm512_permutex2var_epi32(low, places, high)
    }
}

fearless_simd::kernel! {
    /// Entries at the places modulo 16.
    #[inline(always)]
    fn of_half_part(t: Avx512, places: Word, part: &[i32; 16]) -> Word { entries(t, places, part) }
}

fearless_simd::kernel! {
    /// Row that holds all places, if there is one.
    #[inline(always)]
    fn common_row(t: Avx512, places: Word, rows: &'static [[i32; 16]]) -> Option<&'static [i32; 16]> {
        let of_lanes = _mm512_srli_epi32::<4>(places);
        let first = _mm512_castsi512_si128(of_lanes);
        let alike = _mm512_cmpeq_epi32_mask(of_lanes, _mm512_broadcastd_epi32(first));
        if alike == u16::MAX { rows.get(_mm_cvtsi128_si32(first) as usize) } else { None }
    }
}

fearless_simd::kernel! {
    /// Entries at the places modulo 32, rounded to their upper halves: every second word of two vectors.
    #[inline(always)]
    fn of_short_part(t: Avx512, places: Short, part: &[i32; 32]) -> Short {
        let half = _mm512_set1_epi32(1 << 15);
        let [low, high] = each!(i in [0, 1] => _mm512_add_epi32(words(t, part.as_chunks().0[i]), half));
        let places = _mm512_or_si512(_mm512_slli_epi16::<1>(places), _mm512_set1_epi16(1));
        _mm512_permutex2var_epi16(low, places, high)
    }
}

fearless_simd::kernel! {
    /// Entries of sixteen at the places modulo 16, rounded to their upper halves.
    #[inline(always)]
    fn of_half_short_part(t: Avx512, places: Short, part: &[i32; 16]) -> Short {
        let part = _mm512_add_epi32(words(t, *part), _mm512_set1_epi32(1 << 15));
        _mm512_permutexvar_epi16(_mm512_or_si512(_mm512_slli_epi16::<1>(places), _mm512_set1_epi16(1)), part)
    }
}

fearless_simd::kernel! {
    /// Shift counts of a wide wire.
    #[inline(always)]
    fn counts(t: Avx512, k: Word) -> Wide {
        let most = _mm512_set1_epi64(63);
        [_mm512_and_si512(k, most), _mm512_and_si512(_mm512_srli_epi64::<32>(k), most)]
    }
}
