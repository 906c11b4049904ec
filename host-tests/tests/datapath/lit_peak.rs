//! One light on one peak, from ports to ports: every stage's result against the reference with the stage's inputs, documented results of degenerate
//! inputs, and the same bits as the parts that a frame uses.

use fixed::types::I16F16;
use rayon::prelude::*;
use roughxel_cases::lit_peak::{FULL, lit_peak_sets, random_lit_peak};
use roughxel_core::bundle::Value;
use roughxel_core::datapath;
use roughxel_core::fx::{Control, Fx};
use roughxel_core::plan::{FrameSystem, HorizonKind, PeakPlan};
use roughxel_core::ports::{BlockVector, LIGHT, PeakIn, PeakInput, PeakOut, Port};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{RealPeak, real_peak, real_vector};
use roughxel_core::staged::Staged;
use roughxel_core::status::StatusBit;
use roughxel_core::width::on_words;
use roughxel_host_tests::bars::{LIT_PEAK_BARS, holds};
use roughxel_host_tests::reference::horizon::{Side, correlated, product, ramp};
use roughxel_host_tests::reference::linear::{dot, norm};
use roughxel_host_tests::reference::{frame, highlight, peaks};
use roughxel_host_tests::space::profiles;

/// Cases of a random set.
const CASES: u64 = 100_000;

fn of_any_length(v: &BlockVector) -> [f64; 3] {
    real_vector(&BlockVector { exponent: 0, ..*v }).to_array()
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    peaks::unit(v).unwrap_or_default()
}

fn raised(out: &PeakOut, bit: StatusBit) -> bool {
    out.status & bit.mask() != 0
}

/// |l̂ + v̂|, the margin of h from cancelling; `None` if a port or the tangent basis has no direction.
fn conditioned(case: &PeakIn, out: &PeakOut) -> Option<f64> {
    let bits = [StatusBit::NormalZero, StatusBit::ViewZero, StatusBit::LightZero, StatusBit::HalfZero];
    let defined = bits.iter().chain(&[StatusBit::FramePole, StatusBit::LocalZero]).all(|&bit| !raised(out, bit));
    defined.then(|| norm(&highlight::half(of_any_length(&case.light), of_any_length(&case.surface.view))))
}

/// The length of the error of the local half vector, times the distance of l and v from being opposite, and times the sine between n and h, without
/// which a tangent basis has no direction.
fn direction_error(case: &PeakIn, out: &PeakOut) -> Option<f64> {
    let half_length = conditioned(case, out)?;
    let normal = of_any_length(&case.surface.normal);
    let tangents = case.surface.frame_vectors.map(|tangent| of_any_length(&tangent));
    let frame = frame::frame(frame::FrameSystem::MainDirection, normal, tangents);
    let half = highlight::half(of_any_length(&case.light), of_any_length(&case.surface.view));
    let want = peaks::local_direction(half, [frame.e1, frame.e2], normal)?;
    let got = out.local_half.map(|m| m.to_num::<f64>());
    let cosine = dot(&unit(normal), &unit(tangents[0]));
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let error = norm(&[0, 1, 2].map(|i| got[i] - want[i]));
    Some(error * (half_length / 2.0).min(1.0) * sine)
}

#[test]
fn a_local_half_vector_holds_its_bar_from_the_ports_on() {
    for ((name, p), [bar, _]) in profiles().into_iter().zip(LIT_PEAK_BARS) {
        let error = |index| {
            let case = random_lit_peak("lit direction", index, &p);
            direction_error(&case, &case.shine(&FULL, &p)).unwrap_or(0.0)
        };
        let worst = (0..CASES).into_par_iter().map(error).reduce(|| 0.0, f64::max);
        holds(&format!("{name} direction"), worst, bar, 0.5);
    }
}

/// log₂ of the visibility bar, for every profile. Ramps of 2^−17 count up to two and a half times in correlated shares. The joint of the shares
/// adds 2^−18, and the last rounding 2^−17: 2^−15 at worst. Random cases do not meet all of it at once.
const VISIBILITY_BAR: f64 = -15.1;

/// Values of the ramps for both slopes of a direction, by the reference.
fn climbs(case: &PeakIn, local: &BlockVector, slopes: [f64; 2]) -> [f64; 2] {
    let side = |index: usize| {
        let (low, code) = (case.horizon.low[index].to_num::<f64>(), case.horizon.wires().inverse_width[index].raw());
        let inverse = f64::from(if code < 4096 { code } else { 4096 + code % 4096 })
            * f64::from((code >> 12).max(1) - 1).exp2()
            / 16384.0;
        Side { low, width: if code == 0 { 0.0 } else { 1.0 / inverse } }
    };
    [0, 1].map(|axis: usize| match local.mantissa[axis].to_bits().signum() {
        0 => 1.0,
        sign => ramp(slopes[axis], side(2 * axis + usize::from(sign > 0))),
    })
}

#[test]
fn visibility_and_light_are_what_the_reference_makes_of_the_stages_before_them() {
    for ((name, p), [_, bar]) in profiles().into_iter().zip(LIT_PEAK_BARS) {
        let errors = |index| {
            let case = random_lit_peak("lit light", index, &p);
            let (horizon, joined): (_, fn(&[f64]) -> f64) =
                if index % 4 == 0 { (HorizonKind::Product, product) } else { (HorizonKind::Correlated, correlated) };
            let out = case.shine(&PeakPlan { horizon, ..FULL }, &p);
            let [light, eye] = out.slopes.map(|axes| axes.map(|slope| slope.to_num::<f64>()));
            let ramps = [climbs(&case, &out.local_light, light), climbs(&case, &out.local_eye, eye)];
            let want = joined(ramps.as_flattened());
            let visibility = out.visibility.to_num::<f64>();
            let lit = if raised(&out, StatusBit::LightBelowSurface) { 0.0 } else { 1.0 };
            let share = case.weight.to_num::<f64>().clamp(0.0, 1.0) * visibility * lit;
            let RealPeak { normal, amplitude: a, exponent: n } = real_peak(&case.peak);
            let direction = out.local_half.map(|m| m.to_num::<f64>());
            // Random bits are no unit vectors, and their exponents have no bar.
            let plausible = (normal.length() - 1.0).abs() < 2.0_f64.powi(-14) && n <= 8192.0;
            let peak = a * share * peaks::peak(direction, normal.to_array(), 1.0, n);
            // The weight is rounded to 16 fraction bits, the light to 24. A stored N whose length is not 1 also scales 1 − cos.
            let cosine = peaks::peak(direction, normal.to_array(), 1.0, 1.0);
            let steep = n * (1.0 - cosine) * cosine.powf(n - 1.0) * (normal.length() - 1.0).abs();
            let free = a * (2.0_f64.powi(-17) + share * steep) + 2.0_f64.powi(-24);
            let error = ((out.peak.to_num::<f64>() - peak).abs() - free).max(0.0) / a.max(2.0_f64.powi(-21));
            let slack = if direction == [0.0; 3] { 0.0 } else { 1.0 };
            [(visibility - want).abs(), if plausible { error * slack } else { 0.0 }]
        };
        let worst = (0..CASES).into_par_iter().map(errors).reduce(|| [0.0; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])]);
        holds(&format!("{name} visibility"), worst[0], VISIBILITY_BAR, 0.5);
        holds(&format!("{name} light"), worst[1], bar, 0.5);
    }
}

#[test]
fn what_has_no_light_gives_none_and_a_bit_says_why() {
    for (_, p) in profiles() {
        let sets = lit_peak_sets(&p);
        let cases = sets.iter().flat_map(|set| set.cases.iter().map(|case| (case, set.plan)));
        let mut seen = 0;
        for (case, plan) in cases {
            let out = case.shine(&plan, &p);
            let is_zero = |v: &BlockVector| v.mantissa.iter().all(|m| m.to_bits() == 0);
            for (zero, bit) in [
                (is_zero(&case.surface.normal), StatusBit::NormalZero),
                (is_zero(&case.surface.view), StatusBit::ViewZero),
                (is_zero(&case.light), StatusBit::LightZero),
                (is_zero(&out.half), StatusBit::HalfZero),
                (is_zero(&out.local_light) || out.local_light.mantissa[2].to_bits() <= 0, StatusBit::LightBelowSurface),
                (out.local_half.iter().all(|m| m.to_bits() == 0), StatusBit::LocalZero),
            ] {
                assert_eq!(raised(&out, bit), zero, "{bit:?}: {case:?} gives {out:?}");
                if zero {
                    assert_eq!(out.peak.to_bits(), 0, "{bit:?}: {case:?}");
                    seen |= bit.mask();
                }
            }
            let [visibility, peak] = [out.visibility.to_bits(), out.peak.to_bits()];
            assert!((0..=1 << 16).contains(&visibility) && (0..64 << 24).contains(&peak), "{case:?}");
        }
        let all = [0, 1, 8, 9, 10, 12].iter().fold(0, |all, bit| all | 1 << bit);
        assert_eq!(seen, all, "every reason is among the hard cases");
    }
}

/// The light of a case from the parts that the renderer calls: a direction below the horizon is skipped, and a weight is a visibility.
fn from_parts(case: &PeakIn, plan: &PeakPlan, p: &Precision) -> i32 {
    let input = &case.wires();
    on_words!(p, |input| Value(light_of_parts(input, plan, p))).0.raw()
}

fn light_of_parts<W: Staged<Count = i32, Flag = bool>>(
    input: &PeakInput<W>,
    plan: &PeakPlan,
    p: &Precision,
) -> Control<W, LIGHT> {
    let surface = datapath::surface(&input.surface, &plan.surface(), p);
    let lit = datapath::peak_light(&surface, &input.light, p);
    if lit.side.below {
        return Fx::zero();
    }
    let eye = datapath::local_components(&surface.view, &surface.frame, &surface.normal, p);
    let slopes = [lit.light, eye].map(|local| datapath::horizon_slopes(&local, p));
    let visibility = datapath::horizon(&slopes[0], &slopes[1], &input.horizon, plan.horizon, p);
    datapath::peak(&lit.direction, &input.peak, visibility, p)
}

#[test]
fn a_whole_peak_has_the_bits_of_its_parts() {
    for (_, p) in profiles() {
        for index in 0..2000 {
            let frame = [FrameSystem::MainDirection, FrameSystem::Natural, FrameSystem::NaturalNormalised];
            let horizon = [HorizonKind::None, HorizonKind::Correlated, HorizonKind::Product][index as usize / 3 % 3];
            let plan = PeakPlan { frame: frame[index as usize % 3], horizon };
            let case = PeakIn { weight: I16F16::ONE, ..random_lit_peak("parts", index, &p) };
            let whole = case.shine(&plan, &p).peak.to_bits();
            assert_eq!(whole, from_parts(&case, &plan, &p).min((64 << 24) - 1), "{case:?}");
        }
    }
}
