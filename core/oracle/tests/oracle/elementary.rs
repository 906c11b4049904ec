//! Roots, logarithms and powers at the ends of their domains.

use roughxel_core::block::{Block, Mantissa};
use roughxel_core::elementary::{
    VERSINE, exp2, half_inverse_root, half_reciprocal, log2, log2_one_plus, minus_log2_one_minus, one_plus,
    short_number,
};
use roughxel_core::fx::Fx;
use roughxel_core::precision::{Newton, Precision};

use roughxel_oracle::random::Random;

/// Seeds and steps of both iterations.
fn newton(seed_bits: u32, steps: u32) -> Precision {
    let newton = Newton { seed_bits, steps };
    Precision { fraction_bits: 28, reciprocal: newton, inverse_root: newton, ..Precision::PRECISE }
}

pub(crate) fn what_rounds_up_to_one_has_the_seed_of_the_last_interval() {
    for seed_bits in 6..=10 {
        let p = &newton(seed_bits, 0);
        let [one, below] = [1 << 30, (1 << 30) - 1].map(Mantissa::<i32>::from_raw);
        assert_eq!(half_inverse_root(one, p), half_inverse_root(below, p));
        assert_eq!(half_reciprocal(one, p), half_reciprocal(below, p));
    }
}

pub(crate) fn a_step_squares_the_error_of_a_seed() {
    let mut random = Random(1);
    for seed_bits in 6..=10 {
        for steps in 0..=2 {
            let p = &newton(seed_bits, steps);
            // At ¼, half an interval is 2^−seed_bits of a root, and the seed is rounded. No step is accurate beyond the kept bits.
            let mut bar = 1.25 * f64::from(-(seed_bits as i32)).exp2();
            (0..steps).for_each(|_| bar = 1.5 * bar * bar + 3.0 * (-28_f64).exp2());
            for _ in 0..200 {
                let raw = (1 << 28) + random.below(3 << 28) as i32;
                let x = f64::from(raw) / f64::from(1 << 30);
                let error =
                    |found: Mantissa<i32>, exact: f64| f64::from(found.raw()) / f64::from(1 << 30) / exact - 1.0;
                let root = error(half_inverse_root(Fx::from_raw(raw), p), 0.5 / x.sqrt());
                assert!(root.abs() <= bar, "{seed_bits} {steps} {x}: {root} {bar}");
                if x >= 0.5 {
                    let reciprocal = error(half_reciprocal(Fx::from_raw(raw), p), 0.5 / x);
                    assert!(reciprocal.abs() <= bar, "{seed_bits} {steps} {x}: {reciprocal} {bar}");
                }
            }
        }
    }
}

/// Error of logarithms and powers of a word with `fraction` fraction bits.
fn logarithms(of: impl Fn(f64) -> (f64, f64), power: impl Fn(f64) -> (f64, f64), bar: f64) {
    for i in 0..=1000 {
        let (x, log) = of(0.5 + f64::from(i) / 2000.0);
        assert!((log - x.log2()).abs() <= bar, "log2 {x}: {log}");
        let (x, found) = power(f64::from(i) / 50.0 - 10.0);
        assert!((found / x.exp2() - 1.0).abs() <= bar, "exp2 {x}: {found}");
    }
}

pub(crate) fn logarithms_and_powers_are_right_on_words_of_every_width() {
    macro_rules! check {
        ($word:ty, $bar:expr) => {
            let p = &Precision { fraction_bits: <$word>::BITS - 2, ..Precision::PRECISE };
            let unit = f64::from(<$word>::BITS - 2).exp2();
            logarithms(
                |x| {
                    let raw = (x * unit) as $word;
                    (f64::from(raw) / unit, f64::from(log2::<$word>(Fx::from_raw(raw), p).raw()) / 24_f64.exp2())
                },
                |x| {
                    let raw = (x * 24_f64.exp2()) as i32;
                    let found = exp2::<$word>(Fx::from_raw(raw), p);
                    let mantissa = f64::from(found.m[0].raw()) / unit;
                    (f64::from(raw) / 24_f64.exp2(), mantissa * f64::from(found.e.raw()).exp2())
                },
                $bar,
            );
        };
    }
    // A table of 256 intervals is accurate to 2^−18. For an 8-bit word, only the knot and half a last place remain.
    check!(i32, (-18_f64).exp2());
    check!(i16, (-13_f64).exp2());
    check!(i8, (-6_f64).exp2());
}

/// The number that a block stands for.
fn real(x: &Block<i32, 1>) -> f64 {
    f64::from(x.m[0].raw()) / f64::from(1 << 30) * f64::from(x.e.raw()).exp2()
}

pub(crate) fn logarithms_beside_one_keep_the_accuracy_of_small_numbers() {
    let p = &Precision { fraction_bits: 28, ..Precision::PRECISE };
    for e in (-70..=0).chain([1, 2, 5, 20, 31, 32, 33, 62, 63, 64, 65, 70, 300, 1000]) {
        for raw in [1 << 29, 5 << 27, 7 << 27, (1 << 30) - 7, 0x2b3c_4d5e] {
            let x = Block::<i32, 1> { m: [Fx::from_raw(raw)], e: Fx::int(e) };
            let exact = real(&x).ln_1p() / std::f64::consts::LN_2;
            let found = real(&log2_one_plus(x, p));
            assert!((found / exact - 1.0).abs() < (-18_f64).exp2(), "log2(1 + {}): {found}", real(&x));
            // y on its wide wire: at least 2^−61.
            if (-57..1).contains(&e) {
                let y = Fx::<i64, VERSINE>::from_raw(i64::from(raw) << 31 >> -e);
                let real_y = y.raw() as f64 / 61_f64.exp2();
                let exact = -(-real_y).ln_1p() / std::f64::consts::LN_2;
                let found = real(&minus_log2_one_minus::<i32>(y, p));
                assert!((found / exact - 1.0).abs() < (-18_f64).exp2(), "−log2(1 − {real_y}): {found}");
            }
        }
    }
    // 64 for 1 and more.
    for y in [1 << 61, (1 << 61) + 5] {
        assert_eq!(real(&minus_log2_one_minus::<i32>(Fx::from_raw(y), p)), 64.0);
    }
}

pub(crate) fn a_short_number_is_its_fraction_at_its_exponent() {
    for code in 0..=0xffff {
        let (c, f) = (code >> 12, code & 0xfff);
        let number = short_number::<i32>(Fx::from_raw(code));
        let value = f64::from(number.m[0].raw()) / f64::from(1 << 30) * f64::from(number.e.raw()).exp2();
        let expected = if c == 0 { f64::from(f) } else { f64::from(f + 4096) * f64::from(c - 1).exp2() };
        assert_eq!(value * 8192.0, expected, "{code:#x}");
    }
}

pub(crate) fn one_and_a_number_is_the_larger_of_them_where_they_are_far_apart() {
    let block = |e: i64| Block::<i32, 1> { m: [Fx::number(3, -2)], e: Fx::int(e) };
    for e in [40, 63, 64, 65, 66, 2000, 70_000] {
        assert!(one_plus(block(e), 28) == block(e), "{e}");
        assert!(one_plus(block(-e), 28) == Block::one(), "{e}");
    }
    let [sum, small] = [one_plus(block(2), 28), one_plus(block(-3), 28)];
    assert_eq!([sum, small].map(|sum| (sum.m[0].raw(), sum.e.raw())), [(1 << 29, 3), (35 << 24, 1)]);
}
