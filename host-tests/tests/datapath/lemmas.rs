//! Lemmas behind the claims on wires: bounds that an interval walk cannot find, for every possible precision.
//!
//! A claim in the core names its lemma, and the lemma is the test of that name. In a full run, mantissas are exhausted for every p up to 24 fraction
//! bits, for 26 (`precise`) and 28. Monotone functions are tried at their end and also exhausted for small p. On 16-bit words, which have 12 to 14
//! fraction bits, mantissas are always exhausted.

use rayon::prelude::*;
use roughxel_core::block::{Block, MANTISSA, Mantissa, PRODUCT};
use roughxel_core::elementary::{LOGARITHM, exp2, half_reciprocal, inverse_root, short_number};
use roughxel_core::fx::Fx;
use roughxel_core::precision::{Newton, Precision, ProbeRule};
use roughxel_core::rom::{self, upper};
use roughxel_core::signals::{Axes, MapScale};
use roughxel_core::stage::filter::ramp_weights;
use roughxel_core::stage::probes::{face_scale, position, probes};
use roughxel_core::word::Word;
use roughxel_host_tests::checked::Visible;
use roughxel_host_tests::space::whole_or;

/// Fraction bits of a mantissa.
fn fraction<W: Word>() -> u32 {
    W::BITS - MANTISSA
}

/// 1 as a mantissa.
fn one<W: Word>() -> i64 {
    1 << fraction::<W>()
}

/// A mantissa as a number.
fn real<W: Word>(m: i64) -> f64 {
    m as f64 / one::<W>() as f64
}

/// Every seed and step count with every p of up to 22 bits that a word has. For larger p, up to the largest: the coarsest seed without a step, the
/// knobs of `precise`, and the finest seed. The bound of a seed and of its steps does not depend on p.
fn precisions<W: Word>() -> Vec<Precision> {
    let newtons = (6..=10).flat_map(|seed_bits| (0..=2).map(move |steps| Newton { seed_bits, steps }));
    let mut list = Vec::new();
    for newton in newtons {
        for fraction_bits in (12..=24).chain([26, 28]).filter(|&p| p <= fraction::<W>()) {
            if fraction_bits <= 22 || [(6, 0), (8, 2), (10, 2)].contains(&(newton.seed_bits, newton.steps)) {
                let p = Precision { fraction_bits, reciprocal: newton, inverse_root: newton, ..Precision::STANDARD };
                list.push(p.checked().expect("the knobs are inside their limits"));
            }
        }
    }
    list
}

/// Runs `check` for every mantissa from ½ to 1 that a profile keeps; without a full run, for about 2^17 of them and both ends.
fn for_every_mantissa<W: Word>(p: &Precision, check: impl Fn(i64) + Sync) {
    let dropped = fraction::<W>() - p.fraction_bits;
    // As i32, which a parallel iterator can step through.
    let units = 1_i32 << (p.fraction_bits - 1)..(1 << p.fraction_bits) + 1;
    // Odd, so that every bit of a mantissa changes.
    let step = whole_or(1, (1 << p.fraction_bits.saturating_sub(18)) - 1).max(1);
    units.into_par_iter().step_by(step).with_min_len(1 << 12).for_each(|unit| check(i64::from(unit) << dropped));
    check(one::<W>());
}

fn rises(table: &'static [i32]) -> impl Iterator<Item = i32> {
    table.windows(2).map(|knots| knots[1] - knots[0])
}

/// Rises between neighbouring knots on 16-bit words.
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

/// A power of a cosine is 2^−x for x ≥ 0. At x = 0 it is ½·2; elsewhere it is a mantissa of at most 1 with an exponent of at most 0. Times an
/// amplitude m·2^(e − 8) with m < 1 and e ≤ 14, and a weight of at most 1, it is 64 at most, and not below 0. Each intermediate value that is
/// rounded to p bits is a mantissa of at most ½ or 1, and stays within that bound.
#[test]
fn a_peak_gives_64_at_most() {
    power_gives_64_at_most::<i32>();
    power_gives_64_at_most::<i16>();
}

fn power_gives_64_at_most<W: Visible>() {
    let one = one::<W>();
    for p in precisions::<W>() {
        // A step of 2^−8, and everything between 0 and the first step.
        let step = 1_i64 << (32 - LOGARITHM - 8);
        let steps = (0..=63_i64 << 8).into_par_iter().map(|x| x * step).chain((0..step).into_par_iter());
        steps.for_each(|x| {
            let power = exp2::<W>(Fx::lit(-x), &p);
            let (m, e) = (power.m[0].raw().integer(), W::count_integer(power.e.raw()));
            assert!(0 < m && (m == one / 2 && e == 1 || m <= one && e <= 0), "2^−{x:#x} with {p:?}");
            let last = short_number::<W>(Fx::int(u16::MAX.into()));
            assert!(last.m[0].raw().integer() < one && W::count_integer(last.e.raw()) == 14);
            let product: Mantissa<W> = power.m[0].mul::<MANTISSA, PRODUCT>(last.m[0]).round_to(p.fraction_bits);
            assert!((0..=m).contains(&product.raw().integer()));
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
    quotient_is_near_one_at_most::<i32>();
    quotient_is_near_one_at_most::<i16>();
}

fn quotient_is_near_one_at_most<W: Visible>() {
    for p in precisions::<W>() {
        for_every_mantissa::<W>(&p, |m| {
            let half = half_reciprocal(Mantissa::<W>::lit(m), &p).raw().integer();
            assert!(half >= 0 && m * half <= 17 << (2 * fraction::<W>() - 5), "m = {m:#x} with {p:?}");
        });
    }
}

/// A component of w is at most |w|, and |w|² at most half a place above its rounded mantissa. This leaves √x·(1/√x) at every mantissa and both
/// parities of the exponent.
#[test]
fn a_component_over_its_length_is_near_one_at_most() {
    component_is_near_one_at_most::<i32>();
    component_is_near_one_at_most::<i16>();
}

fn component_is_near_one_at_most<W: Visible>() {
    // A component has 6 bits before its point on a wide wire, and is floored to that wire.
    let floored = (6.0 - 2.0 * f64::from(W::BITS)).exp2();
    for p in precisions::<W>() {
        let half_place = (-f64::from(p.fraction_bits) - 1.0).exp2();
        for e in [-1, 0] {
            for_every_mantissa::<W>(&p, |m| {
                let square = Block::<W, 1> { m: [Fx::lit(m)], e: Fx::int(e) };
                let inverse = inverse_root(square, &p);
                let (inverse, inverse_e) = (inverse.m[0].raw().integer(), W::count_integer(inverse.e.raw()));
                // |w| ≥ ½: the shift that follows counts from exponent 2 downwards.
                assert!(inverse_e <= 2);
                let length = ((real::<W>(m) + half_place) * (e as f64).exp2()).sqrt();
                let unit = length * real::<W>(inverse) * (inverse_e as f64).exp2() + floored;
                assert!(inverse >= 0 && unit < 17.0 / 16.0 - 1e-9, "m = {m:#x}, e = {e} with {p:?}");
            });
        }
    }
}

/// λ₁ and λ₂ with direction (0, −1): no component of a direction is larger.
fn axes<W: Word>(major: (i64, i64), minor: (i64, i64)) -> Axes<W> {
    let block = |(m, e)| Block { m: [Fx::lit(m)], e: Fx::int(e) };
    Axes { major: block(major), minor: block(minor), direction: [Fx::zero(), Fx::lit(-one::<W>())] }
}

/// Every p of a word with both rules of the probe count and every largest count.
fn probe_precisions<W: Word>() -> impl Iterator<Item = Precision> {
    (12..=fraction::<W>().min(28)).flat_map(|fraction_bits| {
        [ProbeRule::Ceiling, ProbeRule::PowerOfTwo].into_iter().flat_map(move |probe_rule| {
            (1..=16).map(move |max_probes| Precision { fraction_bits, probe_rule, max_probes, ..Precision::STANDARD })
        })
    })
}

/// Footprints with λ₁ = 2, the largest without clamping, and with a λ₁ that is clamped to 2, for every probe count that can occur. A step is the
/// product of 2√3/N, λ₁ and a component, each rounded to nearest, so it is largest for these footprints.
fn largest_footprints<W: Visible>(map: &MapScale<W>, p: &Precision) -> Vec<Axes<W>> {
    let one = one::<W>();
    let minors = (1..=16).map(|n| {
        // λ₁ / λ₂ = n − ½.
        let ratio: f64 = 2.0 / (f64::from(n) - 0.5).max(1.0);
        let exponent = ratio.log2().ceil();
        ((ratio / exponent.exp2() * one as f64) as i64, exponent as i64)
    });
    let minors: Vec<_> = minors.chain([(0, -(1 << 20))]).collect();
    let majors = [(one, 1), (one / 2, 2), (one, 30)];
    let footprints = majors.into_iter().flat_map(|major| minors.iter().map(move |&minor| axes(major, minor)));
    let footprints: Vec<_> = footprints.collect();
    let counts = |count: i64| footprints.iter().any(|axes| W::count_integer(probes(axes, map, p).count.raw()) == count);
    let most = i64::from(p.max_probes);
    match p.probe_rule {
        ProbeRule::Ceiling => assert!((1..=most).all(counts), "a count is missing with {p:?}"),
        ProbeRule::PowerOfTwo => assert!((0..=most.ilog2()).all(|power| counts(1 << power)), "a count is missing"),
    }
    footprints
}

#[test]
fn a_step_is_below_seven_map_units() {
    step_is_below_seven_map_units::<i32>();
    step_is_below_seven_map_units::<i16>();
}

fn step_is_below_seven_map_units<W: Visible<Count: Sync>>() {
    for p in probe_precisions::<W>() {
        let map = face_scale::<W>(Fx::int(256), &p);
        let step_of = |axes: &Axes<W>| probes(axes, &map, &p).step.map(|step| W::count_integer(step.raw()));
        for axes in largest_footprints(&map, &p) {
            let [zero, step] = step_of(&axes);
            assert!(zero == 0 && step <= 0 && step > -7 << 28, "{axes:?} with {p:?}");
        }
        if p.max_probes == 1 && p.fraction_bits <= 20 {
            for_every_mantissa::<W>(&p, |m| {
                assert!(step_of(&axes((m, 1), (m, 1)))[1] > -7 << 28, "λ₁ = {m:#x}·2 with {p:?}");
            });
        }
    }
}

/// |2i − N + 1| ≤ N − 1 for every probe i below N, and a step is at most 2√3·2/N and its roundings.
#[test]
fn probes_stay_on_the_major_axis() {
    every_probe_stays_on_the_major_axis::<i32>();
    every_probe_stays_on_the_major_axis::<i16>();
}

fn every_probe_stays_on_the_major_axis<W: Visible>() {
    for p in probe_precisions::<W>() {
        let map = face_scale::<W>(Fx::int(256), &p);
        for axes in largest_footprints(&map, &p) {
            let footprint = probes(&axes, &map, &p);
            let count = W::count_integer(footprint.count.raw());
            let step = footprint.step.map(|step| W::count_integer(step.raw()));
            for index in 0..count {
                let twice = step.map(|step| step * (2 * index - count + 1));
                assert!(twice.iter().all(|twice| twice.abs() <= 7 << 28), "probe {index} of {count} with {p:?}");
                // Twice the place with 28 fraction bits, rounded to nearest.
                let place = position(&footprint, Fx::int(index)).offset.map(|place| W::count_integer(place.raw()));
                assert_eq!(place, twice.map(|twice| (twice + 1) >> 1));
            }
        }
    }
}

/// Mean differences are at most 1 in each level, so their weighted sum is at most 1, too.
#[test]
fn weights_of_a_ramp_sum_to_its_reach() {
    let step = whole_or(1, 17);
    (0..1_i32 << 12).into_par_iter().for_each(|level_weight| {
        for reach in (0..=1_i32 << 16).step_by(step).chain([1 << 16]) {
            let [fine, coarse] = ramp_weights::<i32>(Fx::from_raw(level_weight), Fx::from_raw(reach)).map(Fx::raw);
            assert!(fine >= 0 && coarse >= 0 && fine + coarse == reach, "{level_weight} {reach}: {fine} {coarse}");
        }
    });
}
