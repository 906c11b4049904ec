//! Lemmas behind the claims on wires: bounds an interval walk cannot find, for every precision that can be built.
//!
//! A claim in the core names its lemma, and the lemma is the test of that name. In a sweep mantissas are exhausted for every p up to
//! 24 fraction bits, for 26 (`precise`) and 28; what is monotone is tried at its end and exhausted for small p beside it.

use rayon::prelude::*;
use roughxel_core::block::{Block, MANTISSA};
use roughxel_core::elementary::{exp2, half_reciprocal, inverse_root, short_number};
use roughxel_core::fx::Fx;
use roughxel_core::precision::{Newton, Precision, ProbeRule};
use roughxel_core::rom::{self, upper};
use roughxel_core::signals::Axes;
use roughxel_core::soft_core::environment_scale;
use roughxel_core::stage::probes::{position, probes};
use roughxel_host_tests::space::whole_or;

/// 2^30.
/// Fraction bits of a mantissa.
const FRACTION: u32 = i32::BITS - MANTISSA;
const ONE: i32 = 1 << FRACTION;

/// Every seed and step count with every p of up to 22 bits. With more, up to the most, the coarsest seed without a step,
/// the knobs of `precise`, and the finest: the bound of a seed and of its steps does not depend on p.
fn precisions() -> Vec<Precision> {
    let newtons = (6..=10).flat_map(|seed_bits| (0..=2).map(move |steps| Newton { seed_bits, steps }));
    let mut list = Vec::new();
    for newton in newtons {
        for fraction_bits in (12..=24).chain([26, 28]) {
            if fraction_bits <= 22 || [(6, 0), (8, 2), (10, 2)].contains(&(newton.seed_bits, newton.steps)) {
                let p = Precision { fraction_bits, reciprocal: newton, inverse_root: newton, ..Precision::STANDARD };
                list.push(p.checked().expect("the knobs are inside their limits"));
            }
        }
    }
    list
}

/// Runs `check` for every mantissa from ½ to 1 that a profile keeps; without a sweep, for some 2^17 of them and both ends.
fn for_every_mantissa(p: &Precision, check: impl Fn(i32) + Sync) {
    let dropped = FRACTION - p.fraction_bits;
    let units = ONE >> (dropped + 1)..(ONE >> dropped) + 1;
    // Odd, so that every bit of a mantissa changes.
    let step = whole_or(1, (1 << p.fraction_bits.saturating_sub(18)) - 1).max(1);
    units.into_par_iter().step_by(step).with_min_len(1 << 12).for_each(|unit| check(unit << dropped));
    check(ONE);
}

fn rises(table: &'static [i32]) -> impl Iterator<Item = i32> {
    table.windows(2).map(|knots| knots[1] - knots[0])
}

/// How far neighbouring knots rise on words of 16 bits.
fn rises_on_16_bits(table: &[i32]) -> impl Iterator<Item = i32> {
    table.windows(2).map(|knots| upper(knots[1], 16) - upper(knots[0], 16))
}

#[test]
fn knots_of_log2_rise_by_less_than_2_to_the_minus_7() {
    assert!(rises(&rom::LOG2).all(|rise| (0..1 << 17).contains(&rise)));
    // Narrower words: 2^−6.
    assert!(rises_on_16_bits(&rom::LOG2).all(|rise| (0..1 << 2).contains(&rise)));
}

#[test]
fn knots_of_exp2_rise_by_less_than_2_to_the_minus_8() {
    assert!(rises(&rom::EXP2).all(|rise| (0..1 << 22).contains(&rise)));
    assert!(rises_on_16_bits(&rom::EXP2).all(|rise| (0..1 << 7).contains(&rise)));
}

#[test]
fn knots_of_log2_one_minus_rise_by_less_than_2_to_the_minus_9() {
    assert!(rises(&rom::HALF_LOG2_ONE_MINUS_RATIO).all(|rise| (0..1 << 17).contains(&rise)));
    assert!(rises_on_16_bits(&rom::HALF_LOG2_ONE_MINUS_RATIO).all(|rise| (0..1 << 2).contains(&rise)));
}

/// A power of a cosine is 2^−x for x ≥ 0: at x = 0 it is ½·2, elsewhere a mantissa of at most 1 with an exponent of at most
/// 0. Times an amplitude m·2^(e − 8) with m < 1 and e ≤ 14, and a weight of at most 1, it is 64 at most, and not below 0;
/// what is rounded to p bits between is a mantissa of at most ½ or 1, which stays at most that.
#[test]
fn a_peak_gives_64_at_most() {
    for p in precisions() {
        let steps = (0..=63 << 8).into_par_iter().map(|x| x << 16).chain((0..1 << 16).into_par_iter());
        steps.for_each(|x: i32| {
            let power = exp2(Fx::<i32, 8>::from_raw(-x), &p);
            let (m, e) = (power.m[0].raw(), power.e.raw());
            assert!(0 < m && (m == ONE / 2 && e == 1 || m <= ONE && e <= 0), "2^−{x:#x} with {p:?}");
            let last = short_number(Fx::<i32, 32>::from_raw(u16::MAX.into()));
            assert!(last.m[0].raw() < ONE && last.e.raw() == 14);
            let product: Fx<i32, 2> = power.m[0].mul::<2, 4>(last.m[0]).round_to(p.fraction_bits);
            assert!((0..=m).contains(&product.raw()));
        });
    }
}

#[test]
fn knots_of_log2_one_plus_fall_by_less_than_2_to_the_minus_9() {
    assert!(rises(&rom::HALF_LOG2_ONE_PLUS_RATIO).all(|rise| (0..1 << 17).contains(&-rise)));
    assert!(rises_on_16_bits(&rom::HALF_LOG2_ONE_PLUS_RATIO).all(|rise| (0..1 << 2).contains(&-rise)));
}

/// |numerator| ≤ m for the largest component m, so |numerator·(1/2m)| is largest at m itself. A block of zeros has
/// numerators of zero.
#[test]
fn a_quotient_by_the_largest_component_is_near_one_at_most() {
    for p in precisions() {
        for_every_mantissa(&p, |m| {
            let half = i64::from(half_reciprocal(Fx::<i32, MANTISSA>::from_raw(m), &p).raw());
            assert!(half >= 0 && i64::from(m) * half <= 17 << 55, "m = {m:#x} with {p:?}");
        });
    }
}

/// A component of w is at most |w|, and |w|² at most half a place above the mantissa it is rounded to: what is left is
/// √x·(1/√x) at every mantissa and both parities of the exponent.
#[test]
fn a_component_over_its_length_is_near_one_at_most() {
    for p in precisions() {
        let half_place = (-f64::from(p.fraction_bits) - 1.0).exp2();
        for e in [-1, 0] {
            for_every_mantissa(&p, |m| {
                let square = Block::<i32, 1> { m: [Fx::from_raw(m)], e: Fx::from_raw(e) };
                let inverse = inverse_root(square, &p);
                // |w| ≥ ½: the shift that follows counts from exponent 2 down.
                assert!(inverse.e.raw() <= 2);
                let length = ((f64::from(m) / f64::from(ONE) + half_place) * f64::from(e).exp2()).sqrt();
                let inverse = f64::from(inverse.m[0].raw()) / f64::from(ONE) * f64::from(inverse.e.raw()).exp2();
                assert!(inverse >= 0.0 && length * inverse < 17.0 / 16.0 - 1e-9, "m = {m:#x}, e = {e} with {p:?}");
            });
        }
    }
}

/// λ₁ and λ₂ with direction (0, −1): no component of a direction is larger.
fn axes(major: (i32, i32), minor: (i32, i32)) -> Axes<i32> {
    let block = |(m, e)| Block { m: [Fx::from_raw(m)], e: Fx::from_raw(e) };
    Axes { major: block(major), minor: block(minor), direction: [Fx::zero(), Fx::from_raw(-ONE)] }
}

/// Every p with both rules of the probe count and every largest count.
fn probe_precisions() -> impl Iterator<Item = Precision> {
    (12..=28).flat_map(|fraction_bits| {
        [ProbeRule::Ceiling, ProbeRule::PowerOfTwo].into_iter().flat_map(move |probe_rule| {
            (1..=16).map(move |max_probes| Precision { fraction_bits, probe_rule, max_probes, ..Precision::STANDARD })
        })
    })
}

/// Footprints with λ₁ = 2, the largest that is not cut, and with one that is cut to it, for every count that can occur:
/// a step is the product of 2√3/N, λ₁ and a component, each rounded to nearest, so it is largest where they are.
fn largest_footprints(p: &Precision) -> Vec<Axes<i32>> {
    let minors = (1..=16).map(|n| {
        // λ₁ / λ₂ = n − ½.
        let ratio: f64 = 2.0 / (f64::from(n) - 0.5).max(1.0);
        let exponent = ratio.log2().ceil() as i32;
        ((ratio / f64::from(exponent).exp2() * f64::from(ONE)) as i32, exponent)
    });
    let minors: Vec<_> = minors.chain([(0, -(1 << 20))]).collect();
    let majors = [(ONE, 1), (ONE / 2, 2), (ONE, 30)];
    let footprints = majors.into_iter().flat_map(|major| minors.iter().map(move |&minor| axes(major, minor)));
    let footprints: Vec<_> = footprints.collect();
    let map = environment_scale(256, p);
    let counts = |count: i32| footprints.iter().any(|axes| probes(axes, &map, p).count.raw() == count);
    let most = p.max_probes as i32;
    match p.probe_rule {
        ProbeRule::Ceiling => assert!((1..=most).all(counts), "a count is missing with {p:?}"),
        ProbeRule::PowerOfTwo => assert!((0..=most.ilog2()).all(|power| counts(1 << power)), "a count is missing"),
    }
    footprints
}

#[test]
fn a_step_is_below_seven_map_units() {
    for p in probe_precisions() {
        let map = environment_scale(256, &p);
        for axes in largest_footprints(&p) {
            let [zero, step] = probes(&axes, &map, &p).step.map(Fx::raw);
            assert!(zero == 0 && step <= 0 && step > -7 << 28, "{axes:?} with {p:?}");
        }
        if p.max_probes == 1 && p.fraction_bits <= 20 {
            for_every_mantissa(&p, |m| {
                let step = probes(&axes((m, 1), (m, 1)), &map, &p).step[1].raw();
                assert!(step > -7 << 28, "λ₁ = {m:#x}·2 with {p:?}");
            });
        }
    }
}

/// |2i − N + 1| ≤ N − 1 for every probe i below N, and a step is at most 2√3·2/N and its roundings.
#[test]
fn probes_stay_on_the_major_axis() {
    for p in probe_precisions() {
        let map = environment_scale(256, &p);
        for axes in largest_footprints(&p) {
            let footprint = probes(&axes, &map, &p);
            let (count, step) = (footprint.count.raw(), footprint.step.map(|step| i64::from(step.raw())));
            for index in 0..count {
                let twice = step.map(|step| step * i64::from(2 * index - count + 1));
                assert!(twice.iter().all(|twice| twice.abs() <= 7 << 28), "probe {index} of {count} with {p:?}");
                // Twice the place with 28 fraction bits, rounded to nearest.
                let place = position(&footprint, Fx::from_raw(index)).offset.map(|place| i64::from(place.raw()));
                assert_eq!(place, twice.map(|twice| (twice + 1) >> 1));
            }
        }
    }
}
