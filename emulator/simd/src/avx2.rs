//! AVX2: a word is two vectors; a wide wire is four, the even and the odd lanes of each. A flag is as wide as a word. The instruction set lacks
//! arithmetic shifts of 64 bits and leading zeros; they are made of other instructions.

use core::arch::x86_64::*;

use fearless_simd::x86::Avx2 as Proof;
use fearless_simd::{SimdInto, i32x8, i64x4};

use roughxel_core::each::each;
use roughxel_core::fetch::two;

use super::vectors::{Entries, Memory, Table, vectors};

type Word = __m256i;
type Wide = [__m256i; 2];
type Flag = __m256i;
type Short = __m256i;
type ShortFlag = __m256i;

vectors! {
    /// x86-64-v3: vectors of 256 bits.
    Avx2: Proof, as_avx2, 2 vectors of Word, Wide, Flag, Short, ShortFlag;

    to {
        fn words(t, lanes: [i32; 8]) -> Word { let v: i32x8<Proof> = lanes.simd_into(t); v.into() }
        fn wides(t, lanes: [i64; 8]) -> Wide {
            let half = |first: usize| -> i64x4<Proof> {
                let half: [i64; 4] = core::array::from_fn(|i| lanes[2 * i + first]);
                half.simd_into(t)
            };
            [half(0).into(), half(1).into()]
        }
        fn flags(t, lanes: [bool; 8]) -> Flag {
            let v: i32x8<Proof> = lanes.map(|flag| -i32::from(flag)).simd_into(t);
            v.into()
        }
    }
    from {
        fn word_lanes(t, a: Word) -> [i32; 8] { let v: i32x8<Proof> = a.simd_into(t); *v }
        fn wide_lanes(t, a: Wide) -> [i64; 8] {
            let [even, odd]: [i64x4<Proof>; 2] = a.map(|half| half.simd_into(t));
            core::array::from_fn(|i| if i % 2 == 0 { even[i / 2] } else { odd[i / 2] })
        }
        fn flag_lanes(t, a: Flag) -> [bool; 8] { let v: i32x8<Proof> = a.simd_into(t); (*v).map(|lane| lane != 0) }
    }
    memory {
        // As with AVX-512: lanes 0, 4 in one vector, 1, 5 in the next.
        fn row(t, halves: [[u64; 2]; 2]) -> Word {
            let [a, b] = each!([first, second] in halves => _mm_set_epi64x(second.cast_signed(), first.cast_signed()));
            _mm256_inserti128_si256::<1>(_mm256_castsi128_si256(a), b)
        }
        fn transposed(t, rows: [Word; 4]) -> [Word; 4] {
            let first = each!(i in [0, 2] => _mm256_unpacklo_epi32(rows[i], rows[i + 1]));
            let second = each!(i in [0, 2] => _mm256_unpackhi_epi32(rows[i], rows[i + 1]));
            [
                _mm256_unpacklo_epi64(first[0], first[1]),
                _mm256_unpackhi_epi64(first[0], first[1]),
                _mm256_unpacklo_epi64(second[0], second[1]),
                _mm256_unpackhi_epi64(second[0], second[1]),
            ]
        }
    }
    inline {}
    all {
        fn splat(t, value: i32) -> Word { _mm256_set1_epi32(value) }
        fn splat_wide(t, value: i64) -> Wide { [_mm256_set1_epi64x(value), _mm256_set1_epi64x(value)] }
        fn splat_short(t, value: i16) -> Short { _mm256_set1_epi16(value) }
    }

    fn not(t, a: Flag) -> Flag { _mm256_xor_si256(a, _mm256_set1_epi32(-1)) }
    fn both(t, a: Flag, b: Flag) -> Flag { _mm256_and_si256(a, b) }
    fn either(t, a: Flag, b: Flag) -> Flag { _mm256_or_si256(a, b) }

    fn add(t, a: Word, b: Word) -> Word { _mm256_add_epi32(a, b) }
    fn sub(t, a: Word, b: Word) -> Word { _mm256_sub_epi32(a, b) }
    fn and(t, a: Word, b: Word) -> Word { _mm256_and_si256(a, b) }
    fn or(t, a: Word, b: Word) -> Word { _mm256_or_si256(a, b) }
    fn xor(t, a: Word, b: Word) -> Word { _mm256_xor_si256(a, b) }
    fn shl(t, a: Word, k: u32) -> Word { _mm256_sll_epi32(a, count(t, k & 31)) }
    fn sar(t, a: Word, k: u32) -> Word { _mm256_sra_epi32(a, count(t, k & 31)) }
    fn shl_by(t, a: Word, k: Word) -> Word { _mm256_sllv_epi32(a, _mm256_and_si256(k, _mm256_set1_epi32(31))) }
    fn sar_by(t, a: Word, k: Word) -> Word { _mm256_srav_epi32(a, _mm256_and_si256(k, _mm256_set1_epi32(31))) }
    fn lt(t, a: Word, b: Word) -> Flag { _mm256_cmpgt_epi32(b, a) }
    fn select(t, f: Flag, a: Word, b: Word) -> Word { _mm256_blendv_epi8(b, a, f) }
    fn leading_zeros(t, a: Word) -> Word { zeros(t, a) }

    // Through memory, with one store: if they were taken out of the vector one by one, places and values would compete for the same port. In a table
    // of 256 entries, or of 256 intervals between its entries, no place has to be compared with the end.
    fn lookup(t, places: Word, table: Table) -> Word {
        let lanes = std::hint::black_box(word_lanes(t, places));
        let ([page], rest @ ([] | [_])) = table.as_chunks::<256>() else {
            return words(t, each!(place in lanes => table.get(place as usize).copied().unwrap_or(0)));
        };
        let values = words(t, each!(place in lanes => page[(place & 255) as usize]));
        let inside = _mm256_cmpeq_epi32(_mm256_srli_epi32::<8>(places), _mm256_setzero_si256());
        let values = _mm256_and_si256(values, inside);
        match rest {
            [last] => {
                let here = _mm256_cmpeq_epi32(places, _mm256_set1_epi32(256));
                _mm256_blendv_epi8(values, _mm256_set1_epi32(*last), here)
            }
            _ => values,
        }
    }

    fn entries(t, places: Word, table: Entries) -> Word {
        let [low, high] = each!(half in [0, 1] => {
            _mm256_castsi256_ps(_mm256_permutevar8x32_epi32(words(t, table.as_chunks().0[half]), places))
        });
        let upper = _mm256_castsi256_ps(_mm256_slli_epi32::<28>(places));
        _mm256_castps_si256(_mm256_blendv_ps(low, high, upper))
    }

    fn add_wide(t, a: Wide, b: Wide) -> Wide { [_mm256_add_epi64(a[0], b[0]), _mm256_add_epi64(a[1], b[1])] }
    fn sub_wide(t, a: Wide, b: Wide) -> Wide { [_mm256_sub_epi64(a[0], b[0]), _mm256_sub_epi64(a[1], b[1])] }
    fn and_wide(t, a: Wide, b: Wide) -> Wide { [_mm256_and_si256(a[0], b[0]), _mm256_and_si256(a[1], b[1])] }
    fn or_wide(t, a: Wide, b: Wide) -> Wide { [_mm256_or_si256(a[0], b[0]), _mm256_or_si256(a[1], b[1])] }
    fn xor_wide(t, a: Wide, b: Wide) -> Wide { [_mm256_xor_si256(a[0], b[0]), _mm256_xor_si256(a[1], b[1])] }
    fn shl_wide(t, a: Wide, k: u32) -> Wide {
        let k = count(t, k & 63);
        [_mm256_sll_epi64(a[0], k), _mm256_sll_epi64(a[1], k)]
    }
    fn sar_wide(t, a: Wide, k: u32) -> Wide {
        if k & 63 == 63 {
            let zero = _mm256_setzero_si256();
            return [_mm256_cmpgt_epi64(zero, a[0]), _mm256_cmpgt_epi64(zero, a[1])];
        }
        let k = count(t, k & 63);
        let sign = _mm256_srl_epi64(_mm256_set1_epi64x(i64::MIN), k);
        [signed(t, _mm256_srl_epi64(a[0], k), sign), signed(t, _mm256_srl_epi64(a[1], k), sign)]
    }
    fn shl_wide_by(t, a: Wide, k: Word) -> Wide {
        let k = counts(t, k);
        [_mm256_sllv_epi64(a[0], k[0]), _mm256_sllv_epi64(a[1], k[1])]
    }
    fn sar_wide_by(t, a: Wide, k: Word) -> Wide {
        let k = counts(t, k);
        let sign = _mm256_set1_epi64x(i64::MIN);
        [
            signed(t, _mm256_srlv_epi64(a[0], k[0]), _mm256_srlv_epi64(sign, k[0])),
            signed(t, _mm256_srlv_epi64(a[1], k[1]), _mm256_srlv_epi64(sign, k[1])),
        ]
    }
    fn lt_wide(t, a: Wide, b: Wide) -> Flag {
        _mm256_blend_epi32::<0xaa>(_mm256_cmpgt_epi64(b[0], a[0]), _mm256_cmpgt_epi64(b[1], a[1]))
    }
    fn select_wide(t, f: Flag, a: Wide, b: Wide) -> Wide {
        [
            _mm256_blendv_epi8(b[0], a[0], _mm256_shuffle_epi32::<0xa0>(f)),
            _mm256_blendv_epi8(b[1], a[1], _mm256_shuffle_epi32::<0xf5>(f)),
        ]
    }
    fn leading_zeros_wide(t, a: Wide) -> Word {
        let upper = _mm256_blend_epi32::<0xaa>(_mm256_srli_epi64::<32>(a[0]), a[1]);
        let lower = _mm256_blend_epi32::<0xaa>(a[0], _mm256_slli_epi64::<32>(a[1]));
        let empty = _mm256_cmpeq_epi32(upper, _mm256_setzero_si256());
        let zeros = zeros(t, _mm256_blendv_epi8(upper, lower, empty));
        _mm256_add_epi32(zeros, _mm256_and_si256(empty, _mm256_set1_epi32(32)))
    }

    fn mul(t, a: Word, b: Word) -> Wide {
        [_mm256_mul_epi32(a, b), _mm256_mul_epi32(_mm256_srli_epi64::<32>(a), _mm256_srli_epi64::<32>(b))]
    }
    fn widen(t, a: Word) -> Wide {
        let sign = _mm256_srai_epi32::<31>(a);
        [
            _mm256_blend_epi32::<0xaa>(a, _mm256_slli_epi64::<32>(sign)),
            _mm256_blend_epi32::<0xaa>(_mm256_srli_epi64::<32>(a), sign),
        ]
    }
    fn narrow(t, a: Wide) -> Word { _mm256_blend_epi32::<0xaa>(a[0], _mm256_slli_epi64::<32>(a[1])) }
    fn round_low(t, a: Wide, drop: u32, up: u32) -> Word {
        let half = _mm256_set1_epi64x(1 << (drop + up - 1));
        let even = _mm256_srl_epi64(_mm256_add_epi64(a[0], half), count(t, drop));
        let odd = _mm256_sll_epi64(_mm256_add_epi64(a[1], half), count(t, 32 - drop));
        _mm256_blend_epi32::<0xaa>(even, odd)
    }
    fn high(t, a: Wide) -> Word { _mm256_blend_epi32::<0xaa>(_mm256_srli_epi64::<32>(a[0]), a[1]) }

    fn not_short(t, a: ShortFlag) -> ShortFlag { not(t, a) }
    fn both_short(t, a: ShortFlag, b: ShortFlag) -> ShortFlag { both(t, a, b) }
    fn either_short(t, a: ShortFlag, b: ShortFlag) -> ShortFlag { either(t, a, b) }
    fn add_short(t, a: Short, b: Short) -> Short { _mm256_add_epi16(a, b) }
    fn sub_short(t, a: Short, b: Short) -> Short { _mm256_sub_epi16(a, b) }
    fn and_short(t, a: Short, b: Short) -> Short { and(t, a, b) }
    fn or_short(t, a: Short, b: Short) -> Short { or(t, a, b) }
    fn xor_short(t, a: Short, b: Short) -> Short { xor(t, a, b) }
    fn shl_short(t, a: Short, k: u32) -> Short { _mm256_sll_epi16(a, count(t, k & 15)) }
    fn sar_short(t, a: Short, k: u32) -> Short { _mm256_sra_epi16(a, count(t, k & 15)) }
    fn shl_short_by(t, a: Short, even: Word, odd: Word) -> Short {
        let most = _mm256_set1_epi32(15);
        let odd = _mm256_sllv_epi32(odd_high(t, a), _mm256_and_si256(odd, most));
        _mm256_blend_epi16::<0xaa>(_mm256_sllv_epi32(a, _mm256_and_si256(even, most)), odd)
    }
    fn sar_short_by(t, a: Short, even: Word, odd: Word) -> Short {
        let most = _mm256_set1_epi32(15);
        let even = _mm256_srav_epi32(even_high(t, a), _mm256_and_si256(even, most));
        short_high(t, even, _mm256_srav_epi32(a, _mm256_and_si256(odd, most)))
    }
    fn lt_short(t, a: Short, b: Short) -> ShortFlag { _mm256_cmpgt_epi16(b, a) }
    fn select_short(t, f: ShortFlag, a: Short, b: Short) -> Short { _mm256_blendv_epi8(b, a, f) }
    fn even_flags(t, f: ShortFlag) -> Flag { even(t, f) }
    fn odd_flags(t, f: ShortFlag) -> Flag { odd(t, f) }
    fn short_flags(t, even: Flag, odd: Flag) -> ShortFlag { _mm256_blend_epi16::<0xaa>(even, odd) }
    // Paired with a zero, a product is alone in its sum.
    fn mul_even(t, a: Short, b: Short) -> Word { _mm256_madd_epi16(_mm256_and_si256(a, _mm256_set1_epi32(0xffff)), b) }
    fn mul_odd(t, a: Short, b: Short) -> Word { _mm256_madd_epi16(odd_high(t, a), b) }
    fn even(t, a: Short) -> Word { _mm256_srai_epi32::<16>(_mm256_slli_epi32::<16>(a)) }
    fn odd(t, a: Short) -> Word { _mm256_srai_epi32::<16>(a) }
    fn even_high(t, a: Short) -> Word { _mm256_slli_epi32::<16>(a) }
    fn odd_high(t, a: Short) -> Word { _mm256_and_si256(a, _mm256_set1_epi32(-1 << 16)) }
    fn short(t, even: Word, odd: Word) -> Short { _mm256_blend_epi16::<0xaa>(even, _mm256_slli_epi32::<16>(odd)) }
    fn short_high(t, even: Word, odd: Word) -> Short { _mm256_blend_epi16::<0xaa>(_mm256_srli_epi32::<16>(even), odd) }
    fn round_short_low(t, even: Word, odd: Word, drop: u32, up: u32) -> Short {
        let half = _mm256_set1_epi32(1 << (drop + up - 1));
        let even = _mm256_srl_epi32(_mm256_add_epi32(even, half), count(t, drop));
        let odd = _mm256_sll_epi32(_mm256_add_epi32(odd, half), count(t, 16 - drop));
        _mm256_blend_epi16::<0xaa>(even, odd)
    }
    // (a·2^(15 − drop) + 2^14)/2^15 is one instruction, with room for the sum.
    fn round_short(t, a: Short, drop: u32) -> Short { _mm256_mulhrs_epi16(a, _mm256_set1_epi16(1 << (15 - drop))) }
    fn lookup_short(t, even: Word, odd: Word, table: Table) -> Short {
        round_short_low(t, lookup(t, even, table), lookup(t, odd, table), 16, 0)
    }
}

fearless_simd::kernel! {
    /// A shift count for all lanes.
    #[inline(always)]
    fn count(t: Avx2, k: u32) -> __m128i { _mm_cvtsi32_si128(k.cast_signed()) }
}

fearless_simd::kernel! {
    /// Shift counts of a wide wire.
    #[inline(always)]
    fn counts(t: Avx2, k: Word) -> Wide {
        let most = _mm256_set1_epi64x(63);
        [_mm256_and_si256(k, most), _mm256_and_si256(_mm256_srli_epi64::<32>(k), most)]
    }
}

fearless_simd::kernel! {
    /// Sign-extends a lane that was shifted right with zeros, given the place of its sign bit.
    #[inline(always)]
    fn signed(t: Avx2, shifted: __m256i, sign: __m256i) -> __m256i {
        _mm256_sub_epi64(_mm256_xor_si256(shifted, sign), sign)
    }
}

fearless_simd::kernel! {
    /// Leading zeros from the exponent of a float. A word without the bit below its highest does not round up to the next power of two. 0 has the
    /// exponent 0; a negative word has a sign above the exponent.
    #[inline(always)]
    fn zeros(t: Avx2, a: Word) -> Word {
        let highest = _mm256_andnot_si256(_mm256_srli_epi32::<1>(a), a);
        let exponent = _mm256_srli_epi32::<23>(_mm256_castps_si256(_mm256_cvtepi32_ps(highest)));
        let zeros = _mm256_sub_epi32(_mm256_set1_epi32(158), exponent);
        _mm256_max_epi32(_mm256_min_epi32(zeros, _mm256_set1_epi32(32)), _mm256_setzero_si256())
    }
}
