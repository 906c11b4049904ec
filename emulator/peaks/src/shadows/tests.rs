//! Light of facets and of peaks with laws, and fits of the laws to the facets.

use super::super::blocks::NEGLIGIBLE;
use super::super::blocks::tests::levels;
use super::*;
use roughxel_utilities::random::SplitMix64;

/// Slope of a direction over an axis, and the side of its projection.
fn climb(direction: DVec3, axis: usize) -> (f64, usize) {
    ((direction.z / direction[axis].abs()).min(STEEPEST), 2 * axis + usize::from(direction[axis] >= 0.0))
}

fn flat(light: &Light) -> Vec<f64> {
    light.iter().flat_map(|block| block.0).collect()
}

fn facets(count: usize, steepness: f64) -> Vec<(DVec3, HorizonSlopes, f64)> {
    let mut random = SplitMix64::new(22);
    let mut one = || {
        let mut uniform = |low: f64, high: f64| random.uniform(low, high);
        let normal = DVec3::new(uniform(-steepness, steepness), uniform(-steepness, steepness), 1.0);
        (normal.normalize(), std::array::from_fn(|_| steepness * uniform(0.0, 1.2).powi(2)), uniform(0.5, 1.5))
    };
    (0..count).map(|_| one()).collect()
}

fn horizon(low: f64, width: f64) -> Horizon {
    Horizon { mean: low + width / 3.0, deviation: width / 18.0_f64.sqrt(), low, width }
}

fn peaks() -> Vec<(FittedPeak, [Horizon; 4])> {
    let peak = |direction: [f64; 3], exponent: f64, sides: [[f64; 2]; 4]| {
        let direction = DVec3::from(direction).normalize();
        (FittedPeak { amplitude: 0.8, direction, exponent }, sides.map(|[low, width]| horizon(low, width)))
    };
    vec![
        peak([0.3, 0.0, 1.0], 9.0, [[0.0, 0.5], [0.1, 0.9], [0.05, 0.3], [0.0, 2.0]]),
        peak([-0.4, 0.2, 1.0], 20.0, [[0.2, 0.5], [0.0, 0.4], [0.3, 0.0], [-0.1, 0.6]]),
        peak([0.0, -0.5, 1.0], 5.0, [[0.0, 0.2], [0.0, 0.2], [0.0, 0.7], [0.4, 1.1]]),
    ]
}

/// Light of peaks with their laws, as the datapath computes it.
fn lit(peaks: &[(FittedPeak, [Horizon; 4])]) -> Vec<f64> {
    let light = |[light, eye]: [DVec3; 2]| {
        let half = (light + eye).normalize();
        let of = |(peak, sides): &(FittedPeak, [Horizon; 4])| {
            let mut shares = [light, eye].map(|direction| {
                [0, 1].map(|axis| {
                    let (slope, side) = climb(direction, axis);
                    let side = sides[side];
                    let step = if slope < side.low { 0.0 } else { 1.0 };
                    let t = if side.width > 0.0 { ((slope - side.low) / side.width).clamp(0.0, 1.0) } else { step };
                    1.0 - (1.0 - t) * (1.0 - t)
                })
            });
            let shares = shares.as_flattened_mut();
            shares.sort_by(f64::total_cmp);
            peak.amplitude
                * peak.direction.dot(half).max(0.0).powf(peak.exponent)
                * shares[0]
                * (3.0 + shares[1])
                * 0.25
        };
        peaks.iter().map(of).sum()
    };
    directions().into_iter().map(light).collect()
}

fn light_of(values: &[f64]) -> Light {
    std::array::from_fn(|block| Block(std::array::from_fn(|lane| values[block * LANES + lane])))
}

const EQUAL: Light = [Block([1.0; LANES]); BLOCKS];

fn error(peaks: &[(FittedPeak, [Horizon; 4])], wanted: &[f64]) -> f64 {
    lit(peaks).iter().zip(wanted).map(|(got, wanted)| (got - wanted).powi(2)).sum()
}

fn with(peaks: &[(FittedPeak, [Horizon; 4])], laws: Vec<[Horizon; 4]>) -> Vec<(FittedPeak, [Horizon; 4])> {
    peaks.iter().zip(laws).map(|((peak, _), law)| (*peak, law)).collect()
}

#[test]
fn pairs_go_all_around_and_are_low() {
    let pairs = directions();
    assert_eq!(pairs.len(), PAIRS);
    for side in 0..4 {
        let there = |direction: DVec3| (direction[side / 2] < 0.0) == side.is_multiple_of(2);
        let count = |which: usize| pairs.iter().filter(|pair| there(pair[which])).count();
        assert!([0, 1].map(count).iter().all(|count| (100..=140).contains(count)));
        // Light and eye from one side, and from opposite sides.
        let same = pairs.iter().filter(|pair| there(pair[0]) == there(pair[1])).count();
        assert!((80..=160).contains(&same), "{same}");
    }
}

#[test]
fn facets_are_bright_where_light_and_eye_clear_their_horizons() {
    let facets = facets(50, 0.8);
    let got = flat(&light(facets.iter().copied(), 12.0));
    let mut seen = 0;
    for ([to_light, to_eye], got) in directions().into_iter().zip(got) {
        let half = (to_light + to_eye).normalize();
        let visible = |slopes: &HorizonSlopes| {
            [to_light, to_eye].iter().all(|direction| {
                (0..2).all(|axis| {
                    let (slope, side) = climb(*direction, axis);
                    slope >= slopes[side]
                })
            })
        };
        let all = facets.iter().filter(|(_, slopes, _)| visible(slopes));
        seen += all.clone().count();
        // Only the negligible part of each facet is omitted.
        let shares = all.map(|(normal, _, a)| (a, normal.dot(half).max(0.0).powf(12.0)));
        let wanted: f64 = shares.filter(|(_, share)| share.ln() > NEGLIGIBLE).map(|(a, share)| a * share).sum();
        assert!((got - wanted).abs() < 1e-11, "{got} {wanted}");
    }
    assert!((50 * PAIRS / 10..50 * PAIRS / 2).contains(&seen), "{seen}");
}

#[test]
fn derivatives_are_those_of_the_shares() {
    for (_, sides) in peaks() {
        let law = Law::new(&sides);
        let all: Vec<[f64; 8]> = ALL
            .iter()
            .flat_map(|pairs| {
                let slopes = dispatch!(*LEVEL, simd => slopes(simd, pairs, &law).map(Block::store));
                (0..LANES).map(move |lane| slopes.map(|block| block.0[lane]))
            })
            .collect();
        for variable in 0..8 {
            let share = |step: f64| {
                let by = std::array::from_fn(|index| if index == variable { step } else { 0.0 });
                let law = law.moved(&by);
                flat(&dispatch!(*LEVEL, simd => shares(simd, &law)))
            };
            let step = 1e-6;
            let numeric = share(step).into_iter().zip(share(-step)).map(|(up, down)| (up - down) / (2.0 * step));
            // The derivative jumps at changes from one ramp to another.
            let off = numeric.zip(&all).filter(|(numeric, slopes)| (numeric - slopes[variable]).abs() > 1e-4);
            assert!(off.count() <= 2, "{variable}");
        }
    }
}

#[test]
fn laws_that_are_right_stay_and_steps_stay_steps() {
    let peaks = peaks();
    let laws = laws(&light_of(&lit(&peaks)), &EQUAL, &peaks);
    for ((_, wanted), got) in peaks.iter().zip(&laws) {
        for (wanted, got) in wanted.iter().zip(got) {
            assert!((got.low - wanted.low).abs() < 1e-6 && (got.width - wanted.width).abs() < 1e-6);
            assert_eq!(
                (got.mean, got.deviation, got.width == 0.0),
                (wanted.mean, wanted.deviation, wanted.width == 0.0)
            );
        }
    }
}

#[test]
fn laws_come_nearer_to_the_light_that_is_wanted() {
    let wanted = lit(&peaks());
    let mut start = peaks();
    for side in start.iter_mut().flat_map(|(_, sides)| sides).filter(|side| side.width > 0.0) {
        *side = horizon(side.low + 0.1, 1.5 * side.width);
    }
    let fitted = with(&start, laws(&light_of(&wanted), &EQUAL, &start));
    let (before, after) = (error(&start, &wanted), error(&fitted, &wanted));
    assert!(after < 0.05 * before, "{before} {after}");
}

/// Fits without light, weight or amplitude have no data, and return finite numbers.
#[test]
fn what_nothing_is_known_of_stays() {
    let peaks = peaks();
    let same = |laws: Vec<[Horizon; 4]>| {
        let lows = |sides: &[Horizon; 4]| sides.map(|side| side.low);
        assert!(laws.iter().zip(&peaks).all(|(law, (_, start))| lows(law) == lows(start)));
    };
    same(laws(&DARK, &weights(&DARK), &peaks));
    let dark: Vec<_> = peaks.iter().map(|(peak, sides)| (FittedPeak { amplitude: 0.0, ..*peak }, *sides)).collect();
    same(laws(&EQUAL, &EQUAL, &dark));
    let far = laws(&EQUAL.map(|_| Block([1e9; LANES])), &EQUAL, &peaks);
    assert!(far.iter().flatten().all(|side| LOWS.contains(&side.low) && side.width.is_finite()));
}

#[test]
fn laws_are_the_same_bits_on_every_instruction_set() {
    let facets = facets(40, 0.6);
    let (peaks, all) = (peaks(), levels());
    let wanted = light(facets.iter().copied(), 12.0);
    let weights = weights(&wanted);
    let own = laws(&wanted, &weights, &peaks);
    for level in all {
        let mut sum = DARK;
        dispatch!(level, simd => add_all(simd, &mut sum, &mut facets.iter().copied(), 12.0));
        assert_eq!(flat(&sum), flat(&wanted), "{level:?}");
        assert_eq!(dispatch!(level, simd => fitted(simd, &wanted, &weights, &peaks)), own, "{level:?}");
    }
}
