//! Elementary functions, exhausted over the mantissa: every p-bit input of every profile against f64, whose own error (2⁻⁵³) is far below the last
//! bit in question.
//!
//! The table [`BOUNDS`] holds the errors found, rounded up in the third decimal of their logarithms: a change of a seed, a table or a rounding
//! shows here first.

use std::ops::Range;

use micromath::F32Ext;
use rayon::prelude::*;
use roughxel_core::block::{Block, MANTISSA};
use roughxel_core::elementary::{
    exp2, half_inverse_root, half_reciprocal, inverse_root, log2, log2_one_plus, root_and_inverse,
};
use roughxel_core::fx::Fx;
use roughxel_core::precision::{Newton, Precision, Profile};
use roughxel_host_tests::bars;
use roughxel_utilities::random::SplitMix64;

/// Fraction bits of a mantissa: 30.
const FRACTION: u32 = i32::BITS - MANTISSA;
const ONE: i32 = 1 << FRACTION;

/// Profiles on 32-bit words.
const NAMES: [&str; 4] = ["paper", "compact", "standard", "precise"];

/// log₂ of the worst errors of a profile, for [`FUNCTIONS`]. 1/2x, 1/2√x and log₂ are absolute, the others relative.
type Bounds = [f64; 5];

const FUNCTIONS: [&str; 5] = ["1/2x", "1/2√x", "log2", "exp2", "log2(1 + x)"];

/// The worst errors, one row per profile, in the order of [`FUNCTIONS`].
const BOUNDS: [Bounds; 4] = [
    [-16.295, -14.875, -18.460, -15.916, -15.150],
    [-16.295, -14.875, -18.460, -15.916, -15.150],
    [-20.233, -18.785, -18.458, -19.021, -18.061],
    [-26.994, -26.002, -18.457, -19.990, -18.461],
];

fn profile(index: usize) -> Precision {
    Profile::by_name(NAMES[index]).map(Profile::precision).expect("a listed profile exists")
}

fn mantissa(x: i32) -> f64 {
    f64::from(x) / f64::from(ONE)
}

/// Largest error of `error` over every mantissa of `fraction_bits` bits from `low` to 1, both included, and its place.
fn worst_over_mantissas(low: i32, fraction_bits: u32, error: impl Fn(i32) -> f64 + Sync) -> (f64, i32) {
    let step = FRACTION - fraction_bits;
    let (worst, unit) = worst_of(low >> step..(ONE >> step) + 1, |unit| error(unit << step));
    (worst, unit << step)
}

/// Largest error over a range, and its first place.
fn worst_of(range: Range<i32>, error: impl Fn(i32) -> f64 + Sync) -> (f64, i32) {
    let errors = range.into_par_iter().with_min_len(1 << 14).map(|x| (error(x), x));
    errors.reduce(|| (0.0, 0), |a, b| if b.0 > a.0 || (b.0 == a.0 && b.1 < a.1) { b } else { a })
}

/// Error of a function at a mantissa.
type Error = fn(i32, &Precision) -> f64;

fn reciprocal_error(x: i32, p: &Precision) -> f64 {
    (mantissa(half_reciprocal(Fx::<i32, 2>::from_raw(x), p).raw()) - 0.5 / mantissa(x)).abs()
}

fn inverse_root_error(x: i32, p: &Precision) -> f64 {
    (mantissa(half_inverse_root(Fx::<i32, 2>::from_raw(x), p).raw()) - 0.5 / mantissa(x).sqrt()).abs()
}

fn log2_error(x: i32, p: &Precision) -> f64 {
    (f64::from(log2(Fx::<i32, 2>::from_raw(x), p).raw()) / f64::from(1 << 24) - mantissa(x).log2()).abs()
}

fn exp2_error(x: i32, p: &Precision) -> f64 {
    let block = exp2(Fx::<i32, 8>::from_raw(x), p);
    let got = mantissa(block.m[0].raw()) * f64::from(block.e.raw()).exp2();
    (got / (f64::from(x) / f64::from(1 << 24)).exp2() - 1.0).abs()
}

fn holds(profile: usize, function: usize, worst: (f64, i32)) {
    let what = format!("{} of {} at {:#010x}", FUNCTIONS[function], NAMES[profile], worst.1);
    bars::holds(&what, worst.0, BOUNDS[profile][function], 0.01);
}

#[test]
fn reciprocal_inverse_root_and_logarithm_hold_their_bounds_at_every_mantissa() {
    let functions: [(i32, Error); 3] =
        [(ONE / 2, reciprocal_error), (ONE / 4, inverse_root_error), (ONE / 2, log2_error)];
    for index in 0..NAMES.len() {
        let p = profile(index);
        for (function, (low, error)) in functions.into_iter().enumerate() {
            holds(index, function, worst_over_mantissas(low, p.fraction_bits, |x| error(x, &p)));
        }
    }
}

#[test]
fn exponential_holds_its_bound_at_every_fraction() {
    for index in 0..NAMES.len() {
        let p = profile(index);
        holds(index, 3, worst_of(0..1 << 24, |x| exp2_error(x, &p)));
    }
}

/// Tested exponents. Below 1 the table of the ratio runs over as many of its intervals as the exponent leaves; from 1 up the logarithm's table
/// does.
const LOG2_ONE_PLUS_EXPONENTS: [i32; 9] = [-1000, -9, -4, -2, -1, 0, 1, 2, 40];

fn log2_one_plus_error(x: i32, e: i32, p: &Precision) -> f64 {
    let got = log2_one_plus(Block::<i32, 1> { m: [Fx::from_raw(x)], e: Fx::from_raw(e) }, p);
    let want = (mantissa(x) * f64::from(e).exp2()).ln_1p() * std::f64::consts::LOG2_E;
    (mantissa(got.m[0].raw()) * f64::from(got.e.raw()).exp2() / want - 1.0).abs()
}

#[test]
fn logarithm_of_one_plus_holds_its_relative_bound_at_every_mantissa() {
    for index in 0..NAMES.len() {
        let p = profile(index);
        let over = |e: i32| worst_over_mantissas(ONE / 2, p.fraction_bits, |x| log2_one_plus_error(x, e, &p));
        let worst = LOG2_ONE_PLUS_EXPONENTS.map(over);
        holds(index, 4, worst.into_iter().fold((0.0, 0), |a, b| if b.0 > a.0 { b } else { a }));
        assert_eq!(log2_one_plus(Block::<i32, 1>::zero(), &p), Block::zero());
    }
}

/// Bound of 1/2x: the rounding of the result, that of the scaled residual, and the seed's error squared n times.
///
/// A seed errs by 2^−(k+1) (half an interval times the slope 1 at x = ½) and its own rounding 2^−(k+3), at the middle of two less: every table
/// meets 2^−(k+0.7).
fn reciprocal_bound(p: f64, newton: Newton) -> f64 {
    let seed = f64::from(newton.seed_bits) + 0.7;
    (-p - 0.8).exp2() + (-f64::from(1 << newton.steps) * seed).exp2()
}

/// Bound of 1/2√x: two roundings (y² and the result), and the seed's relative error δ as δ ← 1.5·δ², n times.
fn inverse_root_bound(p: f64, newton: Newton) -> f64 {
    let seed = f64::from(newton.seed_bits) - 0.76;
    (-p).exp2() + (-f64::from(1 << newton.steps) * seed).exp2() / 1.5
}

#[test]
fn every_seed_and_step_count_holds_the_bound_by_its_formula() {
    type Bound = fn(f64, Newton) -> f64;
    let functions: [(&str, i32, Error, Bound); 2] = [
        ("1/2x", ONE / 2, reciprocal_error, reciprocal_bound),
        ("1/2√x", ONE / 4, inverse_root_error, inverse_root_bound),
    ];
    for fraction_bits in [12, 16, 18, 22] {
        for (seed_bits, steps) in (6..=10).flat_map(|seed| (0..=2).map(move |steps| (seed, steps))) {
            let newton = Newton { seed_bits, steps };
            let p = Precision { fraction_bits, reciprocal: newton, inverse_root: newton, ..Precision::PAPER };
            for (name, low, error, bound) in functions {
                let (worst, at) = worst_over_mantissas(low, fraction_bits, |x| error(x, &p));
                let bound = bound(f64::from(fraction_bits), newton);
                let (worst, bound) = (worst.log2(), bound.log2());
                println!("{name} p {fraction_bits} {newton:?}: 2^{worst:.3}, bound 2^{bound:.3}");
                assert!(worst <= bound, "{name}, p {fraction_bits}, {newton:?}: 2^{worst:.3} at {at:#x}");
                assert!(worst > bound - 1.0, "{name}, p {fraction_bits}, {newton:?}: the bound 2^{bound:.3} is idle");
            }
        }
    }
}

#[test]
fn ends_of_the_domains_are_right_and_zero_is_bounded() {
    let fx = Fx::<i32, 2>::from_raw;
    for name in NAMES {
        let p = Profile::by_name(name).map(Profile::precision).expect("a listed profile exists");
        // 0 is the mantissa of a block of zeros only: the result is bounded, and meets a factor 0.
        assert_eq!(half_reciprocal(fx(0), &p), fx(ONE));
        assert_eq!(half_reciprocal(fx(ONE / 2), &p), fx(ONE));
        assert_eq!(half_inverse_root(fx(0), &p), fx(ONE));
        let last = 1 << (FRACTION - p.fraction_bits);
        for (name, got, exact) in [
            ("1/2x at 1", half_reciprocal(fx(ONE), &p), ONE / 2),
            ("1/2√x at ¼", half_inverse_root(fx(ONE / 4), &p), ONE),
            ("1/2√x at 1", half_inverse_root(fx(ONE), &p), ONE / 2),
        ] {
            assert!((got.raw() - exact).abs() <= 2 * last, "{name}: {got:?}");
        }
        assert_eq!(log2(fx(ONE), &p).raw(), 0);
        for x in [ONE / 2, ONE / 2 - 1, 0, -1, -ONE] {
            assert_eq!(log2(fx(x), &p).raw(), -1 << 24, "below ½ reads as ½");
        }
        for whole in -63..=63 {
            let power = exp2(Fx::<i32, 8>::from_raw(whole << 24), &p);
            assert_eq!((power.m[0].raw(), power.e.raw()), (ONE / 2, whole + 1));
        }
    }
}

#[test]
fn roots_of_blocks_are_right_at_every_exponent_and_zero() {
    for (index, name) in NAMES.iter().enumerate() {
        let p = profile(index);
        let mut random = SplitMix64::for_element("roots of blocks", index as u64);
        for round in 0..20_000 {
            let drop = FRACTION - p.fraction_bits;
            let mantissa_bits = (ONE / 2 + random.below(1 << 29) as i32) >> drop << drop;
            let exponent =
                if round % 2 == 0 { random.below(9) as i32 - 4 } else { random.below(1 << 19) as i32 - (1 << 18) };
            let x = Block::<i32, 1> { m: [Fx::from_raw(mantissa_bits)], e: Fx::from_raw(exponent) };
            let (root, inverse) = root_and_inverse(x, &p);
            assert_eq!(inverse, inverse_root(x, &p));
            // √(m·2^e) over 2^⌊e/2⌋, so that no exponent leaves f64.
            let half = exponent.div_euclid(2);
            let expected = (mantissa(mantissa_bits) * f64::from(exponent.rem_euclid(2)).exp2()).sqrt();
            let value = |block: Block<i32, 1>, e: i32| mantissa(block.m[0].raw()) * f64::from(block.e.raw() - e).exp2();
            // The inverse root halves x if its exponent is odd (½ place lost), and the root rounds once more.
            let bound = 3.0 * BOUNDS[index][1].exp2() + 2.0 * (-f64::from(p.fraction_bits)).exp2();
            assert!((value(inverse, -half) * expected - 1.0).abs() < bound, "{name}: 1/√ of {x:?}");
            assert!((value(root, half) / expected - 1.0).abs() < bound, "{name}: √ of {x:?}");
        }
        let (root, _) = root_and_inverse(Block::<i32, 1>::zero(), &p);
        assert_eq!(root, Block::zero());
    }
}

/// Float alternative of a soft core: micromath's approximations, whose worst errors are percents.
#[test]
fn cheap_float_functions_err_by_percents_where_a_seed_table_does_not() {
    let worst = |approximate: fn(f32) -> f32, exact: fn(f64) -> f64| {
        let error = |i: u32| {
            // Two octaves: the errors repeat with the exponent's parity.
            let x = 1.0 + 3.0 * i as f32 / 1_000_000.0;
            (f64::from(approximate(x)) / exact(f64::from(x)) - 1.0).abs()
        };
        (0..1_000_000).map(error).fold(0.0, f64::max)
    };
    let measured = [
        ("1/√x", worst(F32Ext::invsqrt, |x| 1.0 / x.sqrt()), 0.034, 1),
        ("√x", worst(F32Ext::sqrt, f64::sqrt), 0.061, 1),
        ("1/x", worst(f32::inv, f64::recip), 0.125, 0),
    ];
    for (name, error, documented, function) in measured {
        println!("micromath {name}: {:.2} %", 100.0 * error);
        assert!((error - documented).abs() < 0.001, "{name}: {error}");
        // Absolute errors of the halves are relative errors of at most twice their size; the project's, at p = 16:
        let ours = 2.0 * BOUNDS[0][function].exp2();
        assert!(error > 400.0 * ours, "{name}: {error} against {ours}");
    }
}
