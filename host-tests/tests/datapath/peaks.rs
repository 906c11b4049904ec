//! Peaks: powers of a cosine over every mantissa, local directions and peaks against the reference, stored formats, hard cases, and every backend.

use fixed::types::I1F15;
use glam::{DVec3, dvec3};
use rayon::prelude::*;
use roughxel_cases::CaseSet;
use roughxel_cases::peak_and_horizon::{LocalCase, PeakCase, WHOLE, peak_hard_sets, random_peak_case};
use roughxel_core::block::Block;
use roughxel_core::bundle::Value;
use roughxel_core::datapath;
use roughxel_core::design::{Design, StoredPeakInput};
use roughxel_core::elementary::{VERSINE, cosine_power, minus_log2_one_minus, short_number};
use roughxel_core::fx::Fx;
use roughxel_core::ports::{BlockVector, LIGHT, Port, StoredPeak};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{RealPeak, real_peak, real_vector, stored_peak};
use roughxel_core::signals::{LocalDirection, PeakSum};
use roughxel_core::stage::filter::{self, Patch};
use roughxel_core::stage::peaks;
use roughxel_core::width::on_words;
use roughxel_host_tests::bars::{holds, shading_bars};
use roughxel_host_tests::checked::Integers;
use roughxel_host_tests::reference::peaks as reference;
use roughxel_host_tests::side_by_side::same_in_every_backend;
use roughxel_host_tests::space::{profiles, wide_profiles};
use roughxel_shader::PackedPeak;
use roughxel_utilities::random::SplitMix64;

/// Fraction bits of a versine.
const FRACTION: u32 = i64::BITS - VERSINE;

/// Cases of a random set.
const CASES: u64 = 200_000;

fn number(x: Block<i32, 1>) -> f64 {
    f64::from(x.m[0].raw()) * f64::from(x.e.raw().max(-2000) - 30).exp2()
}

fn direction(x: &LocalDirection<i32>) -> [f64; 3] {
    x.unit.map(|m| f64::from(m.raw()) * f64::from(-30).exp2())
}

fn light(sum: Fx<i32, LIGHT>) -> f64 {
    f64::from(sum.raw()) * f64::from(-24).exp2()
}

fn local(half: &LocalCase, p: &Precision) -> LocalDirection<i32> {
    let input = &half.wires(p);
    on_words!(p, |input| datapath::local_direction(&input.direction, &input.frame, &input.normal, p))
}

/// The light of a peak.
fn lit(h: &LocalDirection<i32>, peak: &StoredPeak, weight: u32, p: &Precision) -> Fx<i32, LIGHT> {
    let (peak, weight) = (&peak.wires(), Fx::from_raw(weight as i32));
    on_words!(p, |h, peak| Value(datapath::peak(h, peak, weight, p))).0
}

/// The datapath's sum over the peaks of a case.
fn sum(case: &PeakCase, p: &Precision) -> (LocalDirection<i32>, PeakSum<i32>) {
    let h = local(&case.half, p);
    let add = |sum, (peak, weight): &(StoredPeak, u32)| datapath::peak_sum(&sum, lit(&h, peak, *weight, p));
    (h, case.peaks.iter().fold(peaks::none(), add))
}

fn real_local(half: &LocalCase) -> Option<[f64; 3]> {
    // Neither the length of the direction nor the unit of the tangent basis matters; f64 holds neither at the ends of a port.
    let of = |v: &BlockVector, unit: i16| real_vector(&BlockVector { exponent: v.exponent.saturating_sub(unit), ..*v });
    let [e1, e2] = [0, 1].map(|i| of(&half.tangents[i], half.normal.exponent).to_array());
    let d = of(&half.direction, half.direction.exponent).to_array();
    reference::local_direction(d, [e1, e2], of(&half.normal, half.normal.exponent).to_array())
}

fn length(a: [f64; 3], b: [f64; 3]) -> f64 {
    DVec3::from_array(a).distance(DVec3::from_array(b))
}

/// log₂ of the worst errors of a profile on 32-bit words: −log₂(1 − y) relative, cosⁿ absolute.
const BOUNDS: [[f64; 2]; 4] = [[-14.74, -15.75], [-14.74, -15.75], [-18.42, -19.28], [-19.45, -20.02]];

#[test]
fn logarithm_of_a_cosine_holds_its_bound_at_every_mantissa() {
    for ((name, p), [bound, _]) in wide_profiles().into_iter().zip(BOUNDS) {
        // Every kept mantissa and every midpoint between two, which rounding moves most, for y in [½, 1) and [¼, ½), in which the table bends most.
        // Below ¼, where all 2^27 mantissas take minutes, up to 20 bits.
        let kept = 1_i32 << p.fraction_bits..2 << p.fraction_bits;
        let octaves: &[u32] = if p.fraction_bits <= 20 { &[0, 1, 2, 5, 11, 40] } else { &[0, 1] };
        let worst = octaves.par_iter().map(|places| {
            let error = |unit: i32| {
                let raw = i64::from(unit) << (FRACTION - 1 - p.fraction_bits) >> places;
                let y = raw as f64 / f64::from(FRACTION).exp2();
                let got = number(minus_log2_one_minus::<i32>(Fx::from_raw(raw), &p));
                (got / (-(-y).ln_1p() / std::f64::consts::LN_2) - 1.0).abs()
            };
            kept.clone().into_par_iter().with_min_len(1 << 14).map(error).reduce(|| 0.0, f64::max)
        });
        holds(&format!("{name} -log2(1 - y)"), worst.reduce(|| 0.0, f64::max), bound, 0.05);
    }
}

#[test]
fn powers_of_a_cosine_hold_their_bound_for_every_exponent() {
    for ((name, p), [_, bound]) in wide_profiles().into_iter().zip(BOUNDS) {
        // Every octave of n, its ends and 64 values between; powers from 1 down to 2^−28, whose exponents grow as the square of the step.
        let codes = (8192..=61_440_u16).into_par_iter().step_by(61).chain([8193, 20_479, 61_439]);
        let worst = codes.map(|code| {
            let n = short_number(Fx::<i32, 32>::from_raw(code.into()));
            let error = |step: u32| {
                let x = 20.0 * (f64::from(step) / 4096.0).powi(2);
                let raw = (-(-x / number(n)).exp_m1() * f64::from(FRACTION).exp2()) as i64;
                let y = raw as f64 / f64::from(FRACTION).exp2();
                (number(cosine_power(Fx::from_raw(raw), n, &p)) - (number(n) * (-y).ln_1p()).exp()).abs()
            };
            (1..4096).map(error).fold(0.0, f64::max)
        });
        holds(&format!("{name} cos^n"), worst.reduce(|| 0.0, f64::max), bound, 0.05);
    }
}

#[test]
fn a_power_is_1_on_its_peak_and_0_from_a_right_angle_on() {
    for (_, p) in wide_profiles() {
        for code in [0, 1, 4096, 8192, 30_000, 61_440, u16::MAX] {
            let n = short_number(Fx::<i32, 32>::from_raw(code.into()));
            assert_eq!(number(cosine_power(Fx::zero(), n, &p)), 1.0);
            for y in [1_i64 << FRACTION, (1 << FRACTION) + 1, 27 << (FRACTION - 3)] {
                assert_eq!(number(cosine_power(Fx::from_raw(y), n, &p)), 0.0);
            }
            let last = number(cosine_power(Fx::from_raw((1 << FRACTION) - 1), n, &p));
            // cos = 2^−61 and the least power that differs from 0.
            let exact = (-61.0 * number(n)).max(-63.0).exp2();
            assert!((last / exact - 1.0).abs() < 1e-3 || last < 2.0_f64.powi(-40), "{last:e} {exact:e} for {code}");
        }
    }
}

#[test]
fn a_power_falls_with_the_angle() {
    for ((name, p), [_, bound]) in wide_profiles().into_iter().zip(BOUNDS) {
        let slack = bound.exp2();
        for code in [8192, 12_000, 20_480, 40_000, 61_440] {
            let n = short_number(Fx::<i32, 32>::from_raw(code));
            let power = |step: i64| number(cosine_power(Fx::from_raw(step << 48), n, &p));
            assert!((1..1 << 13).all(|step| power(step) <= power(step - 1) + slack), "{name} {code}");
        }
    }
}

#[test]
fn local_directions_hold_their_bar() {
    for (name, p) in profiles() {
        let bar = shading_bars(name).expect("a profile has bars").direction;
        let error = |index: u64| {
            let case = random_peak_case("local", index, &p);
            let exact = real_local(&case.half).expect("a direction in a tangent basis");
            length(direction(&local(&case.half, &p)), exact)
        };
        let worst = (0..CASES).into_par_iter().map(error).reduce(|| 0.0, f64::max);
        holds(&format!("{name} direction"), worst, bar.log2(), 2.0);
    }
}

/// The largest error of a peak of a case as a share of its amplitude and weight; half a last place of the light is free.
fn peak_error(case: &PeakCase, p: &Precision) -> f64 {
    let h = local(&case.half, p);
    let exact = real_local(&case.half);
    let error = |(peak, weight): &(StoredPeak, u32)| {
        let RealPeak { normal, amplitude: a, exponent: n } = real_peak(peak);
        let scale = a * f64::from(*weight) / f64::from(WHOLE);
        let want = exact.map_or(0.0, |h| reference::peak(h, normal.to_array(), 1.0, n));
        let got = light(lit(&h, peak, *weight, p));
        let error = (got - scale * want).abs() - 2.0_f64.powi(-25);
        if error <= 0.0 { 0.0 } else { error / scale }
    };
    case.peaks.iter().map(error).fold(0.0, f64::max)
}

#[test]
fn peaks_hold_their_bar() {
    for (name, p) in profiles() {
        let bar = shading_bars(name).expect("a profile has bars").peak;
        let random = (0..CASES).into_par_iter().map(|index| peak_error(&random_peak_case("peaks", index, &p), &p));
        let worst = random.reduce(|| 0.0, f64::max);
        holds(&format!("{name} peak"), worst, bar.log2(), 2.0);
        // A vector that is no unit vector has no cosine, and exponents beyond 8192 have no bar.
        for set in peak_hard_sets(&p).into_iter().filter(|set| set.name != "peak_codes") {
            let worst = set.cases.iter().map(|case| peak_error(case, &p)).fold(0.0, f64::max);
            println!("{name:8} {} 2^{:.3}", set.name, worst.log2());
            assert!(worst <= bar, "{name} {}: 2^{:.3}", set.name, worst.log2());
        }
    }
}

#[test]
fn an_error_of_a_peak_is_that_of_its_direction_times_the_root_of_its_exponent() {
    for (name, p) in profiles() {
        let bars = shading_bars(name).expect("a profile has bars");
        for exponent in [1.0, 32.0, 1024.0] {
            let error = |index: u64| {
                let PeakCase { half, peaks } = random_peak_case("exponents", index, &p);
                let peaks = peaks.into_iter().map(|(peak, _)| {
                    let near = real_local(&half).map_or(DVec3::Z, DVec3::from_array);
                    (stored_peak(near * 2.0 + real_peak(&peak).normal, 1.0, exponent), WHOLE)
                });
                peak_error(&PeakCase { half, peaks: peaks.collect() }, &p)
            };
            let worst = (0..CASES / 10).into_par_iter().map(error).reduce(|| 0.0, f64::max);
            // The stored length, within 2^−15, scales the versine: x·2^−x·2^−15 at most.
            let bound = (exponent / std::f64::consts::E).sqrt().max(1.0) * bars.direction + 2.0_f64.powf(-15.5);
            println!("{name:8} n = {exponent}: 2^{:.3}, bound 2^{:.3}", worst.log2(), bound.log2());
            assert!(worst <= bound);
        }
    }
}

fn set<'a>(sets: &'a [CaseSet<PeakCase>], name: &str) -> &'a [PeakCase] {
    sets.iter().find(|set| set.name == name).map(|set| set.cases.as_slice()).expect("a listed set")
}

#[test]
fn sums_of_0_7_and_56_peaks_are_those_of_the_reference() {
    for (name, p) in profiles() {
        let bar = shading_bars(name).expect("a profile has bars").peak;
        let mut counts = Vec::new();
        for case in set(&peak_hard_sets(&p), "peak_count") {
            let (_, sum) = sum(case, &p);
            let h = real_local(&case.half).expect("a direction in a tangent basis");
            let (mut want, mut scale) = (0.0, 0.0);
            for (peak, weight) in &case.peaks {
                let RealPeak { normal, amplitude: a, exponent: n } = real_peak(peak);
                let weighted = a * f64::from(*weight) / f64::from(WHOLE);
                want += reference::peak(h, normal.to_array(), weighted, n);
                scale += weighted;
            }
            let rounding = case.peaks.len() as f64 * 2.0_f64.powi(-25);
            assert!((light(sum.light) - want).abs() <= bar * scale + rounding, "{name}: {want}");
            assert!(!sum.saturated);
            counts.push(case.peaks.len());
            let all_equal = case.peaks.windows(2).all(|pair| pair[0] == pair[1]);
            if all_equal && case.peaks.len() > 1 {
                let one = lit(&local(&case.half, &p), &case.peaks[0].0, case.peaks[0].1, &p);
                assert_eq!(sum.light.raw(), one.raw() * case.peaks.len() as i32, "equal peaks count alike");
            }
        }
        assert!([0, 1, 7, 56].iter().all(|count| counts.contains(count)));
    }
}

#[test]
fn on_a_peak_light_is_the_amplitude_and_one_bit_beside_it_nearly() {
    for (name, p) in profiles() {
        for case in set(&peak_hard_sets(&p), "peak_on") {
            let (peak, _) = &case.peaks[0];
            let RealPeak { amplitude: a, exponent: n, .. } = real_peak(peak);
            let got = light(sum(case, &p).1.light);
            // A stored vector is at most 2^−15.2 rad away, H one bit and its own error: cosⁿ ≥ 1 − n·angle²/2.
            let angle = 2.0_f64.powf(-15.2) + 3.5 * 2.0_f64.powi(1 - p.fraction_bits as i32);
            let least = a * (1.0 - n * angle * angle / 2.0 - 2.0_f64.powi(1 - p.fraction_bits as i32));
            assert!(got <= a && got >= least - a * 2.0_f64.powi(-19), "{name}: {got} of {a}, n = {n}");
        }
    }
}

#[test]
fn beyond_a_right_angle_and_opposite_a_peak_gives_nothing() {
    for (name, p) in profiles() {
        let bars = shading_bars(name).expect("a profile has bars");
        let (mut dark, mut below) = (0, 0);
        for case in set(&peak_hard_sets(&p), "peak_side") {
            let h = real_local(&case.half).expect("a direction in a tangent basis");
            let RealPeak { normal, .. } = real_peak(&case.peaks[0].0);
            let cosine = DVec3::from_array(h).dot(normal.normalize());
            let got = sum(case, &p).1.light.raw();
            if cosine < -2.0 * bars.direction - 2.0_f64.powi(-14) {
                assert_eq!(got, 0, "{name}: cos = {cosine:e}");
                dark += 1;
            }
            // A peak below the horizon is treated like any other.
            below += usize::from(normal.z < 0.0 && got > 0);
        }
        assert!(dark > 50 && below > 10, "{dark} {below}");
    }
}

#[test]
fn any_codes_give_a_bounded_sum_that_says_when_it_is_cut() {
    for (_, p) in profiles() {
        let mut cut = 0;
        for case in set(&peak_hard_sets(&p), "peak_codes") {
            let (h, sum) = sum(case, &p);
            assert!((0..64 << 24).contains(&sum.light.raw()));
            let parts: i64 = case.peaks.iter().map(|(peak, weight)| i64::from(lit(&h, peak, *weight, &p).raw())).sum();
            assert_eq!(i64::from(sum.light.raw()), parts.min((64 << 24) - 1));
            assert_eq!(sum.saturated, parts >= 64 << 24);
            cut += usize::from(sum.saturated);
            let nothing = case.peaks.iter().all(|(peak, weight)| peak.amplitude == 0 || *weight == 0);
            assert!(!nothing || sum.light.raw() == 0);
        }
        assert!(cut > 0, "a sum saturates");
    }
}

#[test]
fn without_a_direction_no_peak_is_lit() {
    for (name, p) in profiles() {
        let (mut none, mut some) = (0, 0);
        for (index, case) in set(&peak_hard_sets(&p), "local_zero").iter().enumerate() {
            let (h, sum) = sum(case, &p);
            let zero = |v: &BlockVector| v.mantissa.iter().all(|m| m.to_bits() == 0);
            let LocalCase { direction: d, tangents, normal } = &case.half;
            let expected = zero(d) || tangents.iter().any(zero) || zero(d) && zero(normal);
            assert_eq!(h.none, expected, "{name} {index}");
            if expected {
                assert_eq!((direction(&h), sum.light.raw()), ([0.0; 3], 0));
                none += 1;
            } else {
                assert!((DVec3::from_array(direction(&h)).length() - 1.0).abs() < 1e-3, "{name} {index}");
                some += 1;
            }
        }
        assert!(none >= 4 && some > 10);
    }
}

#[test]
fn lengths_of_the_direction_and_of_the_frame_change_no_bit() {
    let p = Precision::STANDARD;
    for index in 0..2000 {
        let PeakCase { half, .. } = random_peak_case("lengths", index, &p);
        let mut scaled = half;
        scaled.direction.exponent += 300;
        scaled.normal.exponent -= 77;
        scaled.tangents.iter_mut().for_each(|tangent| tangent.exponent -= 77);
        assert_eq!(Integers::from_bundle(&local(&half, &p)), Integers::from_bundle(&local(&scaled, &p)));
    }
}

/// Eight texels with the same peaks, interpolated as channels of a map: exactly the light of one texel.
#[test]
fn interpolated_sums_of_equal_texels_are_that_sum() {
    let p = Precision::STANDARD;
    let mut random = SplitMix64::new(56);
    for index in 0..500 {
        let case = random_peak_case("texels", index, &p);
        let light = sum(&case, &p).1.light.raw();
        let mut weight = || Fx::from_raw(random.below(1 << 10) as i32);
        let mut patch = || Patch::<i32> { texels: [Fx::from_raw(light); 4], weight: [weight(), weight()] };
        let (fine, coarse) = (patch(), patch());
        let level = Fx::from_raw(random.below(1 << 12) as i32);
        assert_eq!(filter::trilinear(&fine, &coarse, level, 0).raw(), light);
    }
}

#[test]
fn a_stored_peak_is_within_its_stated_error() {
    let mut random = SplitMix64::new(15);
    for _ in 0..100_000 {
        let normal = dvec3(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
        let a = random.uniform(-23.0, 6.0).exp2().min(63.99);
        let n = random.uniform(0.0, 13.0).exp2();
        let stored = stored_peak(normal * random.uniform(-99.0, 99.0).exp2(), a, n);
        let RealPeak { normal: got, amplitude: got_a, exponent: got_n } = real_peak(&stored);
        assert!((got.length() - 1.0).abs() <= 2.0_f64.powi(-15));
        let angle = got.normalize().cross(normal.normalize()).length();
        assert!(angle <= 2.0_f64.powf(-15.2), "2^{:.3}", angle.log2());
        assert!((got_n / n - 1.0).abs() <= 2.0_f64.powi(-13), "{n} {got_n}");
        let error = if a >= 2.0_f64.powi(-9) { a * 2.0_f64.powi(-13) } else { 2.0_f64.powi(-22) };
        assert!((got_a - a).abs() <= error, "{a} {got_a}");
    }
    // F92's own exponents and the ends are exact; +1 is the only component that does not fit.
    for n in [1.0, 20.0, 32.0, 100.0, 8192.0] {
        let want = RealPeak { normal: dvec3(0.0, 0.0, 1.0 - 2.0_f64.powi(-15)), amplitude: 0.5, exponent: n };
        assert_eq!(real_peak(&stored_peak(DVec3::Z, 0.5, n)), want);
    }
    assert_eq!(stored_peak(DVec3::NEG_X, 0.0, 1.0).normal[0], I1F15::MIN);
}

#[test]
fn every_backend_gives_the_same_bits() {
    for (name, p) in profiles() {
        let sets = peak_hard_sets(&p).into_iter().flat_map(|set| set.cases);
        let cases: Vec<PeakCase> = sets.chain((0..2000).map(|index| random_peak_case(name, index, &p))).collect();
        cases.par_chunks(64).for_each(|cases| {
            let halves: Vec<_> = cases.iter().map(|case| case.half.wires(&p)).collect();
            same_in_every_backend::<{ Design::Local as usize }>(&halves, &p);
            let mut inputs = Vec::new();
            for case in cases {
                let h = local(&case.half, &p);
                let mut sum = peaks::none();
                for (peak, weight) in &case.peaks {
                    let (peak, weight) = (peak.wires(), Fx::from_raw(*weight as i32));
                    let words = PackedPeak::from(&peak).words();
                    inputs.push(StoredPeakInput { half: h, words, weight, sum });
                    sum = datapath::peak_sum(&sum, datapath::peak(&h, &peak, weight, &p));
                }
            }
            same_in_every_backend::<{ Design::Peak as usize }>(&inputs, &p);
        });
    }
}
