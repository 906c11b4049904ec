//! Horizon: slopes and visibility, of correlated and of independent shares, against the reference, stored formats, hard cases, and every backend.

use rayon::prelude::*;
use roughxel_cases::peak_and_horizon::{HorizonCase, horizon_hard_sets, random_horizon_case, uniform};
use roughxel_core::block::Block;
use roughxel_core::bundle::Value;
use roughxel_core::datapath;
use roughxel_core::design::{Design, HorizonInput};
use roughxel_core::fx::Fx;
use roughxel_core::plan::HorizonKind;
use roughxel_core::ports::{BlockVector, Horizon, Port, SHARE, StoredHorizon};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{block_vector, real_horizon, real_vector, stored_horizon, uniform_law};
use roughxel_core::signals::AxisSlope;
use roughxel_core::stage::enter::enter;
use roughxel_core::stage::horizon::{self, product};
use roughxel_core::width::on_words;
use roughxel_host_tests::bars::{holds, shading_bars};
use roughxel_host_tests::reference::horizon::{self as reference, Side};
use roughxel_host_tests::side_by_side::same_in_every_backend;
use roughxel_host_tests::space::profiles;
use roughxel_utilities::random::SplitMix64;

/// Cases of a random set.
const CASES: u64 = 200_000;
/// A visibility of 1.
const CLEAR: i32 = 1 << 16;

fn block(direction: &BlockVector, p: &Precision) -> Block<i32, 3> {
    let direction = &direction.wires();
    on_words!(p, |direction| enter(direction, p))
}

fn slopes(direction: &BlockVector, p: &Precision) -> [AxisSlope<i32>; 2] {
    let local = &block(direction, p);
    on_words!(p, |local| datapath::horizon_slopes(local, p))
}

/// Joins the shares of ramps by the reference.
type Joined = fn(&[f64]) -> f64;

/// Kinds of joining shares, each with the reference's function.
const KINDS: [(HorizonKind, Joined); 2] =
    [(HorizonKind::Correlated, reference::correlated), (HorizonKind::Product, reference::product)];

/// Share that is clear for both light and eye.
fn clear(
    light: &[AxisSlope<i32>; 2],
    eye: &[AxisSlope<i32>; 2],
    stored: &Horizon<i32>,
    kind: HorizonKind,
    p: &Precision,
) -> Fx<i32, SHARE> {
    on_words!(p, |light, eye, stored| Value(datapath::horizon(light, eye, stored, kind, p))).0
}

/// Share that is clear in one direction if the axes are independent.
fn visibility(slopes: &[AxisSlope<i32>; 2], stored: &Horizon<i32>, p: &Precision) -> Fx<i32, SHARE> {
    let ramps = on_words!(p, |slopes, stored| horizon::ramps(slopes, stored, p));
    product::<i32>(ramps.axes[0], ramps.axes[1])
}

fn real_slope(slope: &AxisSlope<i32>) -> f64 {
    f64::from(slope.slope.raw()) / f64::from(1 << 26)
}

fn share(x: Fx<i32, 16>) -> f64 {
    f64::from(x.raw()) / f64::from(CLEAR)
}

/// The distributions that a stored horizon represents.
fn sides(stored: &StoredHorizon) -> [Side; 4] {
    let (low, inverse) = real_horizon(stored);
    core::array::from_fn(|side| Side { low: low[side], width: inverse[side].map_or(0.0, f64::recip) })
}

/// Every case of the random set and of the hard ones.
fn cases(name: &'static str, p: &Precision) -> Vec<HorizonCase> {
    let hard = horizon_hard_sets(p).into_iter().flat_map(|set| set.cases);
    hard.chain((0..CASES).map(|index| random_horizon_case(name, index, p))).collect()
}

#[test]
fn slopes_hold_their_bar_and_saturate_at_8() {
    for (name, p) in profiles() {
        let bar = shading_bars(name).expect("a profile has bars").slope;
        let error = |case: &HorizonCase| {
            let [x, y, z] = real_vector(&case.light).to_array();
            let mut worst = 0.0_f64;
            for (along, got) in [x, y].into_iter().zip(slopes(&case.light, &p)) {
                assert_eq!((got.negative, got.upright), (along < 0.0, along == 0.0));
                if along != 0.0 {
                    let want = (z / along.abs()).clamp(-8.0, 8.0);
                    worst = worst.max((real_slope(&got) - want).abs() / want.abs().max(1.0));
                }
            }
            worst
        };
        let worst = cases(name, &p).par_iter().map(error).reduce(|| 0.0, f64::max);
        holds(&format!("{name} slope"), worst, bar.log2(), 2.0);
    }
}

#[test]
fn visibility_holds_its_bar_at_the_slopes_of_the_datapath() {
    for (name, p) in profiles() {
        let bar = shading_bars(name).expect("a profile has bars").visibility;
        let error = |case: &HorizonCase| {
            let (light, eye) = (slopes(&case.light, &p), slopes(&case.eye, &p));
            let sides = sides(&case.horizon);
            let ramps: Vec<f64> = [light, eye]
                .iter()
                .flat_map(|slopes| slopes.iter().enumerate())
                .filter(|(_, slope)| !slope.upright)
                .map(|(axis, slope)| reference::ramp(real_slope(slope), sides[2 * axis + usize::from(!slope.negative)]))
                .collect();
            let errors = KINDS.map(|(kind, joined)| {
                (share(clear(&light, &eye, &case.horizon.wires(), kind, &p)) - joined(&ramps)).abs()
            });
            errors[0].max(errors[1])
        };
        let worst = cases(name, &p).par_iter().map(error).reduce(|| 0.0, f64::max);
        holds(&format!("{name} visibility"), worst, bar.log2(), 2.0);
    }
}

/// Whole chain: the effect of the slope's error on each ramp, and no other error.
#[test]
fn visibility_errs_by_the_slope_over_the_width_of_the_ramp() {
    for (name, p) in profiles() {
        let bars = shading_bars(name).expect("a profile has bars");
        let check = |case: &HorizonCase| -> f64 {
            let sides = sides(&case.horizon);
            let mut allowed = 0.0;
            let mut ramps = Vec::new();
            for direction in [real_vector(&case.light), real_vector(&case.eye)] {
                ramps.extend(reference::ramps(direction.to_array(), &sides));
                for (axis, along) in [direction.x, direction.y].into_iter().enumerate().filter(|(_, x)| *x != 0.0) {
                    let (slope, side) = (direction.z / along.abs(), sides[2 * axis + usize::from(along > 0.0)]);
                    let error = bars.slope * slope.abs().clamp(1.0, 8.0);
                    // Beyond ±8 a slope is clamped, and a ramp may continue. A step jumps within the error.
                    let cut = slope.abs() - 8.0;
                    let jumps = (slope - side.low).abs() <= error || cut > 0.0;
                    allowed +=
                        if side.width > 0.0 { (error + cut.max(0.0)) / side.width } else { f64::from(u8::from(jumps)) };
                }
            }
            let (light, eye) = (slopes(&case.light, &p), slopes(&case.eye, &p));
            for (kind, joined) in KINDS {
                // A share rises at most twice as fast as its ramp.
                let allowed = bars.visibility + if kind == HorizonKind::Correlated { 2.0 * allowed } else { allowed };
                let (got, want) = (share(clear(&light, &eye, &case.horizon.wires(), kind, &p)), joined(&ramps));
                assert!((got - want).abs() <= allowed, "{name}: {got} for {want}, {case:?}");
            }
            allowed
        };
        let tight = cases(name, &p).par_iter().filter(|case| check(case) < 0.01).count();
        assert!(tight > CASES as usize / 4, "{name}: {tight} cases are told apart");
    }
}

#[test]
fn a_light_on_a_step_is_visible_and_one_bit_below_it_is_not() {
    for (name, p) in profiles() {
        let eye = slopes(&block_vector(glam::DVec3::Z, &p), &p);
        for slope in [-1.0, -0.25, 0.0, 0.5, 3.0] {
            let horizon = stored_horizon([slope; 4], [0.0; 4]).wires();
            for x in [1.0, -1.0] {
                let exact = block_vector(glam::dvec3(x, 0.0, slope), &p);
                let lit = |direction: &BlockVector| {
                    clear(&slopes(direction, &p), &eye, &horizon, HorizonKind::Correlated, &p).raw()
                };
                assert_eq!(lit(&exact), CLEAR, "{name} {slope}");
                // A last place of the slope, which is larger than that of the mantissa.
                for (step, expected) in [(-1, 0), (1, CLEAR)] {
                    let mut moved = exact;
                    let last = step << (30 - p.fraction_bits + 4);
                    moved.mantissa[2] = fixed::types::I2F30::from_bits(moved.mantissa[2].to_bits() + last);
                    assert_eq!(lit(&moved), expected, "{name} {slope} {step}");
                }
            }
        }
    }
}

#[test]
fn an_open_horizon_changes_no_bit_of_a_weight() {
    for (name, p) in profiles() {
        for (index, case) in cases(name, &p).iter().enumerate().take(50_000) {
            let (light, eye) = (slopes(&case.light, &p), slopes(&case.eye, &p));
            for (kind, _) in KINDS {
                let open = clear(&light, &eye, &StoredHorizon::OPEN.wires(), kind, &p);
                assert_eq!(open.raw(), CLEAR, "{name} {index}");
            }
        }
        for weight in 0..=CLEAR {
            assert_eq!(product::<i32>(Fx::from_raw(weight), Fx::from_raw(CLEAR)).raw(), weight);
            assert_eq!(product::<i32>(Fx::from_raw(weight), Fx::zero()).raw(), 0);
        }
    }
}

#[test]
fn straight_up_and_straight_down_every_horizon_is_clear() {
    for (name, p) in profiles() {
        let high = uniform([7.9; 4], [0.0, 1.0, 0.0, 1.0]).wires();
        for z in [1.0, -1.0, 0.0] {
            let upright = slopes(&block_vector(glam::dvec3(0.0, 0.0, z), &p), &p);
            assert_eq!(visibility(&upright, &high, &p).raw(), CLEAR, "{name} {z}");
        }
        // Along one axis, only that axis hides.
        let along = slopes(&block_vector(glam::dvec3(0.0, -1.0, 0.5), &p), &p);
        let sides = |y: f64| uniform([7.9, 7.9, y, 7.9], [0.0; 4]).wires();
        assert_eq!(visibility(&along, &sides(0.4), &p).raw(), CLEAR);
        assert_eq!(visibility(&along, &sides(0.6), &p).raw(), 0);
    }
}

#[test]
fn visibility_rises_with_the_slope() {
    for (name, p) in profiles() {
        for (mean, sigma) in [(0.5, 0.0), (0.5, 0.01), (0.0, 0.4), (1.0, 2.0), (-0.3, 0.1)] {
            let horizon = uniform([mean; 4], [sigma; 4]).wires();
            let at =
                |slope: f64| visibility(&slopes(&block_vector(glam::dvec3(0.6, -0.3, slope), &p), &p), &horizon, &p);
            let values: Vec<i32> = (-400..1600).map(|step| at(f64::from(step) * 0.003).raw()).collect();
            assert!(values.windows(2).all(|pair| pair[0] <= pair[1]), "{name} {mean} {sigma}");
            assert!(values.iter().all(|value| (0..=CLEAR).contains(value)));
        }
    }
}

#[test]
fn a_stored_horizon_is_within_its_stated_error() {
    let mut random = SplitMix64::new(5);
    for _ in 0..100_000 {
        let mean = [(); 4].map(|()| random.uniform(-4.0, 6.0));
        let sigma = [(); 4].map(|()| random.uniform(-11.0, 1.0).exp2() * if random.below(4) == 0 { 0.0 } else { 1.0 });
        let laws: [[f64; 2]; 4] = core::array::from_fn(|side| uniform_law(mean[side], sigma[side]));
        let (low, inverse) = real_horizon(&uniform(mean, sigma));
        for (side, [least, width]) in laws.into_iter().enumerate() {
            let law = Side::uniform(mean[side], sigma[side]);
            assert!((law.low - least).abs() < 1e-14 && (law.width - width).abs() < 1e-14);
            assert!((low[side] - least).abs() <= 2.0_f64.powi(-13));
            match inverse[side] {
                None => assert_eq!(sigma[side], 0.0),
                Some(got) => {
                    let exact = width.recip();
                    let error = if exact >= 0.25 { exact * 2.0_f64.powi(-13) } else { 2.0_f64.powi(-15) };
                    assert!((got - exact).abs() <= error, "{exact} {got}");
                }
            }
        }
    }
    let (low, inverse) = real_horizon(&uniform([100.0, -100.0, 1.0, f64::NAN], [0.0, 0.0, 1e9, f64::NAN]));
    assert_eq!(low, [8.0 - 2.0_f64.powi(-12), -8.0, -8.0, 0.0]);
    assert_eq!(inverse, [None, None, Some(2.0_f64.powi(-14)), None]);
    assert_eq!(real_horizon(&uniform([0.0; 4], [1e-9; 4])).1, [Some(8191.0); 4]);
}

#[test]
fn every_backend_gives_the_same_bits() {
    for (name, p) in profiles() {
        let hard = horizon_hard_sets(&p).into_iter().flat_map(|set| set.cases);
        let cases: Vec<_> = hard.chain((0..4000).map(|index| random_horizon_case(name, index, &p))).collect();
        cases.par_chunks(64).for_each(|cases| {
            let input = |case: &HorizonCase| {
                let [light, eye] = [&case.light, &case.eye].map(|direction| block(direction, &p));
                HorizonInput { light, eye, horizon: case.horizon.wires() }
            };
            same_in_every_backend::<{ Design::Horizon as usize }>(&cases.iter().map(input).collect::<Vec<_>>(), &p);
        });
    }
}
