//! Errata of F92: peaks, the printed materials, visibility ramps, and the timing table.

use roughxel_host_tests::reference::linear::{dot, norm, scaled};
use roughxel_host_tests::reference::random::SplitMix64;

/// One row of F92's table: amplitude, vector, exponent.
type Peak = (f64, [f64; 3], i32);

const VELVET: [Peak; 7] = [
    (0.1, [0.0, 0.0, 1.0], 1),
    (0.6, [0.01, 1.0, 0.0], 20),
    (0.6, [0.01, 0.5, 0.866], 20),
    (0.6, [0.01, -0.5, 0.866], 20),
    (0.6, [0.01, -1.0, 0.0], 20),
    (0.6, [0.01, -0.5, -0.866], 20),
    (0.6, [0.01, 0.5, -0.866], 20),
];

const SILK: [Peak; 13] = [
    (0.6, [0.0, 0.0, 1.0], 1),
    (0.1, [0.1, 1.0, 0.0], 32),
    (0.6, [0.8, 1.0, 0.0], 32),
    (0.4, [0.5, 1.0, 0.0], 32),
    (0.1, [0.1, 0.0, 1.0], 32),
    (0.6, [0.8, 0.0, 1.0], 32),
    (0.4, [0.5, 0.0, 1.0], 32),
    (0.1, [0.1, -1.0, 0.0], 32),
    (0.6, [0.8, -1.0, 0.0], 32),
    (0.4, [0.5, -1.0, 0.0], 32),
    (0.1, [0.1, 0.0, -1.0], 32),
    (0.4, [0.8, 0.0, -1.0], 32),
    (0.6, [0.5, 0.0, -1.0], 32),
];

fn unit(vector: [f64; 3]) -> [f64; 3] {
    scaled(1.0 / norm(&vector), vector)
}

fn random_direction(random: &mut SplitMix64) -> [f64; 3] {
    unit([0; 3].map(|_| random.normal()))
}

#[test]
fn row_19_every_peak_has_an_exponent_of_its_own() {
    // Amplitude, two angles and an exponent: only this way do seven peaks have 28 variables.
    let (peaks, own_exponent, shared_exponent) = (7, 4, 3);
    assert_eq!((peaks * own_exponent, peaks * shared_exponent), (28, 21));
    // If n is the number of peaks, as printed in the sum, velvet is a different material.
    let sum = |h: &[f64; 3], exponent: fn(i32) -> i32| -> f64 {
        VELVET.iter().map(|&(a, v, n)| a * dot(&unit(v), h).max(0.0).powi(exponent(n))).sum()
    };
    let mut random = SplitMix64::new(319);
    let (mut squares, mut errors) = (0.0, 0.0);
    for _ in 0..10_000 {
        let h = random_direction(&mut random);
        let (ours, printed) = (sum(&h, |n| n), sum(&h, |_| VELVET.len() as i32));
        squares += ours * ours;
        errors += (printed - ours) * (printed - ours);
    }
    assert!(errors > 0.1 * squares, "{}", errors / squares);
}

#[test]
fn row_20_the_first_row_of_the_tables_names_the_surface_normal() {
    let below = |normal: [f64; 3]| -> Vec<f64> {
        VELVET[1..]
            .iter()
            .chain(&SILK[1..])
            .map(|&(_, v, _)| -dot(&unit(v), &normal).asin().to_degrees())
            .filter(|&degrees| degrees > 0.0)
            .collect()
    };
    let printed = below([0.0, 0.0, 1.0]);
    assert_eq!(printed.len(), 5);
    let deepest = printed.iter().copied().fold(0.0, f64::max);
    let shallowest = printed.iter().copied().fold(90.0, f64::min);
    assert!((shallowest - 51.0).abs() < 0.5 && (deepest - 84.0).abs() < 0.5);
    // The other rows surround x: with (1, 0, 0) as the normal, every peak is above the horizon.
    assert!(below([1.0, 0.0, 0.0]).is_empty());
}

#[test]
fn row_21_silks_vectors_are_normalised() {
    let excess = norm(&SILK[2].1);
    assert!((excess - 1.28).abs() < 0.005);
    let factor = excess.powi(SILK[2].2);
    assert!((factor / 2740.0 - 1.0).abs() < 0.001, "{factor}");
    assert!((norm(&unit(SILK[2].1)).powi(32) - 1.0).abs() < 1e-13);
    // The last group swaps .4 and .6; the printed amplitudes are kept.
    let amplitudes = |group: usize| [0, 1, 2].map(|i| SILK[1 + 3 * group + i].0);
    assert_eq!([0, 1, 2].map(amplitudes), [[0.1, 0.6, 0.4]; 3]);
    assert_eq!(amplitudes(3), [0.1, 0.4, 0.6]);
}

#[test]
fn row_22_the_visibility_ramp_reaches_root_3_sigma() {
    // Largest distance from the normal distribution, integrated from −8 σ with the trapezoidal rule (error below 1e-8).
    let worst = |reach: f64| {
        let step = 1e-4;
        let density = |x: f64| (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt();
        let (mut below, mut worst) = (0.0, 0.0_f64);
        for i in -80_000..80_000 {
            let x = f64::from(i) * step;
            let ramp = (0.5 + 0.5 * x / reach).clamp(0.0, 1.0);
            worst = worst.max((ramp - below).abs());
            below += 0.5 * step * (density(x) + density(x + step));
        }
        worst
    };
    assert!((worst(1.0) - 0.159).abs() < 0.0005, "{}", worst(1.0));
    assert!((worst(3_f64.sqrt()) - 0.057).abs() < 0.0005, "{}", worst(3_f64.sqrt()));
    // ±√3 σ is the uniform distribution of variance σ²: width²/12.
    assert!(((2.0 * 3_f64.sqrt()).powi(2) / 12.0 - 1.0).abs() < 1e-15);
    // σ = 0: the ramp is 0/0 at the mean slope and must be a step.
    let (slope, mean, sigma) = (0.5_f64, 0.5, 0.0);
    assert!(((slope - mean) / sigma).is_nan());
}

#[test]
fn row_23_about_doubled_is_the_mean_of_the_papers_own_table() {
    // Minutes and seconds: unfiltered, filtered, 16 samples. The bar on this project's own timing is tested elsewhere.
    let seconds = |minutes: u32, seconds: u32| f64::from(60 * minutes + seconds);
    let table = [
        (seconds(3, 30), seconds(7, 38), seconds(52, 39)),
        (seconds(3, 2), seconds(5, 39), seconds(46, 14)),
        (seconds(1, 37), seconds(2, 30), seconds(26, 43)),
        (seconds(3, 34), seconds(8, 34), seconds(53, 6)),
    ];
    let filtered = table.map(|(unfiltered, filtered, _)| filtered / unfiltered);
    for (got, expected) in filtered.into_iter().zip([2.18, 1.86, 1.55, 2.40]) {
        assert!((got - expected).abs() < 0.005, "{got}");
    }
    assert!((filtered.iter().sum::<f64>() / 4.0 - 2.0).abs() < 0.005);
    let samples = table.map(|(_, filtered, samples)| samples / filtered);
    assert!(samples.iter().all(|ratio| (6.15..10.75).contains(ratio)));
}

#[test]
fn row_24_peaks_carry_energy_two_pi_over_n_plus_one() {
    let energy = |amplitude: f64, exponent: i32| -> f64 {
        let steps = 20_000;
        let width = std::f64::consts::FRAC_PI_2 / f64::from(steps);
        let ring = |i: i32| {
            let (sin, cos) = ((f64::from(i) + 0.5) * width).sin_cos();
            cos.powi(exponent) * sin
        };
        amplitude * std::f64::consts::TAU * width * (0..steps).map(ring).sum::<f64>()
    };
    for exponent in [1, 7, 20, 32, 500] {
        let expected = std::f64::consts::TAU / f64::from(exponent + 1);
        // The midpoint rule over 20 000 rings.
        assert!((energy(1.0, exponent) / expected - 1.0).abs() < 1e-4);
    }
    // Two equal normals 2·20° apart, each spread with exponent 64 and amplitude ½, become one peak a level up.
    let (fine, tilt) = (64, 20_f64.to_radians());
    let below = 2.0 * energy(0.5, fine);
    // Same slope variance along the tilt and across it on average: 1/n = 1/64 + tan²(20°)/2.
    let coarse = (1.0 / (1.0 / f64::from(fine) + 0.5 * tilt.tan().powi(2))).round() as i32;
    let kept_amplitude = energy(1.0, coarse) / below;
    assert!(kept_amplitude > 4.0, "brighter by {kept_amplitude}");
    // An amplitude fitted against the density, normalised peaks, keeps the energy.
    let fitted = f64::from(coarse + 1) / f64::from(fine + 1);
    assert!((energy(fitted, coarse) / below - 1.0).abs() < 1e-4);
}
