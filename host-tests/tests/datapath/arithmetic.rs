//! Fixed-point and block arithmetic: rounding, normalising and aligning against 128-bit integers. Inputs of 24 bits or fewer are exhausted, wider
//! ones sampled.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use rayon::prelude::*;
use roughxel_core::block::{Block, MANTISSA, ZERO_EXPONENT, align, cross, dot, normalise, places_below};
use roughxel_core::fx::Fx;
use roughxel_core::rom::{self, upper};
use roughxel_host_tests::checked::{Checked, CheckedWide, CheckedWire};
use roughxel_host_tests::space::whole_or;

/// Fraction bits of a mantissa: 30.
const FRACTION: u32 = i32::BITS - MANTISSA;
const ONE: i32 = 1 << FRACTION;

/// ⌊x/2^k + ½⌋: to nearest, ties towards +∞.
fn rounded(x: i128, k: u32) -> i128 {
    if k == 0 { x } else { (x + (1 << (k - 1))) >> k }
}

fn config() -> ProptestConfig {
    ProptestConfig {
        cases: whole_or(20_000, 4000),
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(1),
        ..Default::default()
    }
}

/// Wide wires with weight on the ends, zero and single bits.
fn wide() -> impl Strategy<Value = i64> {
    prop_oneof![
        any::<i64>(),
        (any::<i64>(), 0_u32..64).prop_map(|(x, k)| x >> k),
        (0_u32..63, -2_i64..=2, any::<bool>()).prop_map(|(k, d, minus)| {
            let x = (1_i64 << k) + d;
            if minus { -x } else { x }
        }),
        Just(i64::MIN),
        Just(i64::MAX),
        Just(-1),
        Just(0),
    ]
}

/// A mantissa of `bits` kept fraction bits.
fn mantissa(fraction_bits: u32) -> impl Strategy<Value = i32> {
    let shift = FRACTION - fraction_bits;
    prop_oneof![
        (-(1_i32 << fraction_bits)..=1 << fraction_bits).prop_map(move |m| m << shift),
        Just(ONE),
        Just(-ONE),
        Just(0),
        Just(1 << shift),
        Just(-1 << shift)
    ]
}

#[test]
fn rounding_is_to_nearest_with_ties_towards_plus_infinity() {
    // The worked numbers: ±½, ±1½ and their neighbours, in halves of the kept unit.
    for (x, expected) in [(1, 1), (-1, 0), (3, 2), (-3, -1), (2, 1), (-2, -1), (0, 0)] {
        let x = Fx::<i64, 33>::from_raw(x);
        assert_eq!(x.round_to::<2>(30).raw(), expected);
    }
    // All 24-bit inputs, all places.
    (0..24_u32).into_par_iter().for_each(|fraction_bits| {
        for x in -(1 << 23)..1 << 23 {
            let expected = rounded(i128::from(x), 24 - fraction_bits) << (24 - fraction_bits);
            assert_eq!(
                i128::from(Fx::<i32, 8>::from_raw(x).quantise(fraction_bits).raw()),
                expected,
                "{x} keeps {fraction_bits}"
            );
        }
    });
}

#[test]
fn keeping_all_bits_changes_nothing() {
    for x in [i32::MIN, -1, 0, 1, i32::MAX] {
        assert_eq!(Fx::<i32, 8>::from_raw(x).quantise(24).raw(), x);
        assert_eq!(Fx::<i32, 8>::from_raw(x).quantise(40).raw(), x);
    }
}

#[test]
fn rounded_shift_equals_rounding_the_quotient() {
    // 17-bit mantissas and all places: 2^22 inputs.
    for fraction_bits in [12, 16] {
        (0..32_u32).into_par_iter().for_each(|k| {
            for m in -(1 << fraction_bits)..=1 << fraction_bits {
                let raw = m << (FRACTION - fraction_bits);
                let got = Fx::<Checked, 2>::from_raw(Checked::new(raw))
                    .round_shr_by(Fx::from_raw(Checked::new(k as i32)), fraction_bits)
                    .raw()
                    .value();
                let expected = rounded(i128::from(m), k) << (FRACTION - fraction_bits);
                assert_eq!(i128::from(got), expected, "{m} by {k}");
            }
        });
    }
}

#[test]
fn rounded_shift_of_a_word_with_no_bit_to_spare_equals_rounding_the_quotient() {
    // Every 16-bit mantissa in [-1, 1] that is kept to 12, 13 or all 14 bits, and all places.
    let fraction = Fx::<i16, 2>::FRACTION;
    for fraction_bits in 12..=fraction {
        for k in 0..16_u32 {
            for m in -(1_i32 << fraction_bits)..=1 << fraction_bits {
                let raw = CheckedWire::new((m << (fraction - fraction_bits)) as i16);
                let got = Fx::<CheckedWire<i16>, 2>::from_raw(raw)
                    .round_shr_by(Fx::lit(k.into()), fraction_bits)
                    .raw()
                    .value();
                let expected = rounded(i128::from(m), k) << (fraction - fraction_bits);
                assert_eq!(i128::from(got), expected, "{m} by {k} keeps {fraction_bits}");
            }
        }
    }
}

#[test]
fn upper_bits_of_every_table_are_the_nearest_words() {
    let sized = (6..=10).flat_map(|bits| [rom::reciprocal(bits), rom::inverse_root(bits)]);
    let named: [&'static [i32]; 14] = [
        &rom::LOG2,
        &rom::EXP2,
        &rom::HALF_LOG2_ONE_MINUS_RATIO,
        &rom::HALF_LOG2_ONE_PLUS_RATIO,
        &rom::STEP_PER_SIGMA,
        &rom::LOG2_OF_COUNT,
        &rom::BOX_WEIGHTS,
        &rom::GAUSSIAN_WEIGHTS,
        &rom::SPREAD_LIMIT,
        &rom::NORMAL_PLACES,
        &rom::NORMAL_PLACES_OF_ONE_LESS,
        &rom::NORMAL_WIDENINGS,
        &rom::NORMAL_WIDENINGS_OF_ONE_LESS,
        &rom::ONE_OVER_COUNT,
    ];
    for table in sized.chain(named) {
        for &entry in table {
            assert_eq!(upper(entry, 32), entry);
            for bits in [8, 16] {
                let nearest = rounded(entry.into(), 32 - bits);
                assert_eq!(i128::from(upper(entry, bits)), nearest, "{entry} on {bits} bits");
                assert!(nearest < 1 << (bits - 1), "{entry} rounds up beyond {bits} bits");
            }
        }
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn a_wide_wire_narrows_to_the_nearest_word(x in wide(), fraction_bits in 0_u32..40, shift in 0_u32..33) {
        // Into the range of the result: |x| < 2^31 with 30 fraction bits.
        let x = x >> shift.max(3);
        let places = 60 - fraction_bits.min(30);
        let expected = rounded(i128::from(x), places) << (places - 30);
        let got = Fx::<CheckedWide, 4>::from_raw(CheckedWide::new(x)).round_to::<2>(fraction_bits);
        prop_assert_eq!(i128::from(got.raw().value()), expected);
    }

    #[test]
    fn a_block_keeps_its_value_within_half_a_last_place(
        wide in prop::array::uniform3(wide()),
        fraction_bits in 12_u32..=28,
        exponent in -70_000_i64..70_000,
    ) {
        let block = normalise::<CheckedWide, 3, 4>(
            wide.map(|w| Fx::from_raw(CheckedWide::new(w))),
            Fx::lit(exponent),
            fraction_bits,
        );
        let mantissas = block.m.map(|m| m.raw().value());
        let e = i64::from(block.e.raw().value());
        if wide == [0; 3] {
            prop_assert_eq!((mantissas, e), ([0; 3], ZERO_EXPONENT));
            return Ok(());
        }
        let largest = mantissas.iter().map(|m| m.abs()).max().unwrap_or(0);
        prop_assert!((ONE / 2..=ONE).contains(&largest), "{mantissas:?} · 2^{e}");
        // wide·2^(exponent − 60) against m·2^(e − 30), both in units of 2^(e − 63).
        let up = exponent - 30 - e;
        prop_assert!((-33..=30).contains(&up));
        for (w, m) in wide.into_iter().zip(mantissas) {
            prop_assert_eq!(m & ((1 << (FRACTION - fraction_bits)) - 1), 0, "kept bits only");
            let value = i128::from(w) << (up + 33);
            let kept = i128::from(m) << 33;
            let last_place = 1_i128 << (33 + FRACTION - fraction_bits);
            prop_assert!(2 * (value - kept).abs() <= last_place);
            // Exact if the dropped bits are zero.
            if value % last_place == 0 {
                prop_assert_eq!(value, kept);
            }
        }
    }

    #[test]
    fn normalising_a_block_again_changes_nothing_but_a_mantissa_of_one(
        m in prop::array::uniform3(mantissa(16)),
        exponent in -1000_i64..1000,
    ) {
        let once = normalise::<i64, 3, 4>(m.map(|m| Fx::<i32, 2>::from_raw(m).widen()), Fx::lit(exponent), 16);
        let twice = normalise::<i64, 3, 4>(once.m.map(Fx::widen), once.e, 16);
        // +1 occurs by rounding up (or on entry); it belongs to the next octave.
        if once.m.iter().all(|m| m.raw() < ONE) {
            prop_assert_eq!(once, twice);
        } else {
            prop_assert_eq!(once.m.map(|m| m.raw().rem_euclid(ONE)), twice.m.map(|m| (2 * m.raw()).rem_euclid(ONE)));
        }
    }

    #[test]
    fn aligned_blocks_do_not_grow_and_lose_less_than_a_last_place(
        a in prop::array::uniform2(mantissa(20)),
        b in prop::array::uniform2(mantissa(20)),
        exponents in prop::array::uniform2(-40_i32..40),
    ) {
        let block = |m: [i32; 2], e: i32| Block::<Checked, 2> {
            m: m.map(|m| Fx::from_raw(Checked::new(m))),
            e: Fx::from_raw(Checked::new(e)),
        };
        let ([x, y], top) = align([block(a, exponents[0]), block(b, exponents[1])], 20);
        let top = top.raw().value();
        prop_assert_eq!(top, exponents[0].max(exponents[1]));
        for (before, e, after) in [(a, exponents[0], x), (b, exponents[1], y)] {
            for (before, after) in before.into_iter().zip(after) {
                let after = after.raw().value();
                prop_assert!(after.abs() <= before.abs());
                let places = (top - e) as u32;
                let expected = rounded(i128::from(before >> 10), places.min(40)) << 10;
                prop_assert_eq!(i128::from(after), expected);
            }
        }
    }

    #[test]
    fn dot_and_cross_products_are_exact(
        a in prop::array::uniform3(mantissa(28)),
        b in prop::array::uniform3(mantissa(28)),
    ) {
        let [p, q] = [a, b].map(|v| v.map(|m| Fx::<Checked, 2>::from_raw(Checked::new(m))));
        let exact = |i: usize, j: usize| i128::from(a[i]) * i128::from(b[j]);
        prop_assert_eq!(i128::from(dot(&p, &q).raw().value()), exact(0, 0) + exact(1, 1) + exact(2, 2));
        let got = cross(&p, &q).map(|w| i128::from(w.raw().value()));
        let expected = [exact(1, 2) - exact(2, 1), exact(2, 0) - exact(0, 2), exact(0, 1) - exact(1, 0)];
        prop_assert_eq!(got, expected);
    }

    #[test]
    fn comparisons_follow_the_order_of_the_numbers(x: i32, y: i32, low: i32, high: i32) {
        let [a, b, l, h] = [x, y, low, high].map(Fx::<i32, 7>::from_raw);
        prop_assert_eq!(a.lt(b), x < y);
        prop_assert_eq!(a.ge(b), x >= y);
        prop_assert_eq!(a.is_zero(), x == 0);
        prop_assert_eq!(a.min(b).raw(), x.min(y));
        prop_assert_eq!(a.max(b).raw(), x.max(y));
        if low <= high {
            prop_assert_eq!(a.saturate(l, h).raw(), x.clamp(low, high));
        }
        if x != i32::MIN {
            prop_assert_eq!(a.abs().raw(), x.abs());
            prop_assert_eq!(a.negate_if(true).raw(), -x);
        }
        prop_assert_eq!(a.negate_if(false).raw(), x);
        prop_assert_eq!(Fx::select(x < y, a, b).raw(), x.min(y));
    }

    #[test]
    fn places_below_are_cut_to_what_a_wire_can_lose(e in -2_000_000_i64..2_000_000, top in -2_000_000_i64..2_000_000) {
        let places = places_below::<Checked>(Fx::lit(e), Fx::lit(top), 31).raw().value();
        prop_assert_eq!(i64::from(places), (top - e).clamp(0, 31));
    }
}

#[test]
fn one_bit_and_the_most_negative_word_are_normalised_like_any_other() {
    for k in 0..64 {
        for (value, sign) in [(1_i64.checked_shl(k), 1), (Some(-1 << k), -1)] {
            let Some(value) = value.filter(|value| value.signum() == sign) else { continue };
            let block = normalise::<CheckedWide, 1, 4>([Fx::from_raw(CheckedWide::new(value))], Fx::zero(), 16);
            let (m, e) = (block.m[0].raw().value(), block.e.raw().value());
            // −2^k is −1 in the octave below: one's complement counts its leading bits.
            let expected = if sign > 0 { (ONE / 2, k as i32 - 59) } else { (-ONE, k as i32 - 60) };
            assert_eq!((m, e), expected, "{value}");
        }
    }
}

#[test]
fn a_zero_block_never_wins_an_alignment() {
    let tiny = Block::<i32, 1> { m: [Fx::from_raw(ONE / 2)], e: Fx::lit(-(1 << 14)) };
    let ([zero, kept], top) = align([Block::zero().scaled(Fx::lit(1 << 13)), tiny], 16);
    assert_eq!((zero, kept, top), ([Fx::zero()], tiny.m, tiny.e));
    assert!(Block::<i32, 3>::zero().is_zero());
    assert!(!tiny.is_zero());
}
