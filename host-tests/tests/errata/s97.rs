//! Errata of S97: roughness, its storage and pyramid, and the modified highlight.

use roughxel_host_tests::one_pixel::{EXPONENT, OnePixel};
use roughxel_host_tests::reference::axes::axes;
use roughxel_host_tests::reference::ellipse::{Ellipse, ellipse};
use roughxel_host_tests::reference::frame::frame_main_direction;
use roughxel_host_tests::reference::highlight::printed_cos2;
use roughxel_host_tests::reference::linear::{Vector2, add_scaled, cross, dot, norm, scaled};
use roughxel_host_tests::reference::random::SplitMix64;
use roughxel_host_tests::reference::roughness::{Covariance, Texel, Triangular, compose, covariance, decompose, merge};

/// D·x.
fn times(d: Triangular, x: Vector2) -> Vector2 {
    [d[0] * x[0] + d[1] * x[1], d[2] * x[1]]
}

/// Dᵀ·x.
fn times_transposed(d: Triangular, x: Vector2) -> Vector2 {
    [d[0] * x[0], d[1] * x[0] + d[2] * x[1]]
}

#[test]
fn row_03_the_ellipse_holds_39_percent_of_a_normal_distribution() {
    let mut random = SplitMix64::new(203);
    let d = [0.7, -0.4, 0.3];
    let k = Ellipse::from_matrix(compose(d));
    let count = 200_000;
    let (mut within_1, mut within_2) = (0, 0);
    for _ in 0..count {
        let form = k.quadratic_form(times(d, [random.normal(), random.normal()]));
        within_1 += u32::from(form < 1.0);
        within_2 += u32::from(form < 2.0);
    }
    let share = |hits| f64::from(hits) / f64::from(count);
    // Standard error √(p(1−p)/200 000) = 0.0011: four of them.
    assert!((share(within_1) - (1.0 - (-0.5_f64).exp())).abs() < 0.0044);
    assert!((share(within_1) - 0.3935).abs() < 0.0044, "{}", share(within_1));
    assert!((share(within_2) - 0.632).abs() < 0.0044, "the printed share belongs to 2");
}

#[test]
fn row_04_axes_of_a_uniform_rectangle_are_a_over_root_3() {
    // Midpoints of a 200×200 grid: variance a²/12·(1 − 1/200²).
    let (a, b) = (0.8, 0.3);
    let cell = |i: usize| (i as f64 + 0.5) / 200.0 - 0.5;
    let grid: Vec<Vector2> = (0..40_000).map(|i| [a * cell(i % 200), b * cell(i / 200)]).collect();
    let (_, k) = covariance(&grid);
    let found = axes(&Ellipse::from_matrix(k));
    for (sigma, edge) in [(found.major, a), (found.minor, b)] {
        let full_axis = 2.0 * sigma;
        assert!((sigma / (edge / 12_f64.sqrt()) - 1.0).abs() < 2e-5);
        assert!((full_axis / (edge / 3_f64.sqrt()) - 1.0).abs() < 2e-5);
        let printed = 2.0 * edge / 3_f64.sqrt();
        assert!((printed / full_axis - 2.0).abs() < 1e-4, "right for half edges only");
    }
}

#[test]
fn row_05_the_pixel_term_enters_as_a_covariance() {
    let (dx, dy) = ([0.9, 0.2], [-0.3, 0.6]);
    let rough = [0.2, 0.1, 0.15];
    let mut random = SplitMix64::new(205);
    let points: Vec<Vector2> = (0..200_000)
        .map(|_| {
            // A place in the pixel box and an independent facet.
            let pixel = add_scaled(scaled(random.uniform(-0.5, 0.5), dx), random.uniform(-0.5, 0.5), dy);
            add_scaled(pixel, 1.0, times(rough, [random.normal(), random.normal()]))
        })
        .collect();
    let (_, truth) = covariance(&points);
    let ours = ellipse(&[dx, dy, [rough[0], 0.0], [rough[1], rough[2]]]);
    // Relative standard error of a variance over 200 000 points: about 0.3 %.
    assert!((ours.a / truth[0] - 1.0).abs() < 0.015 && (ours.c / truth[2] - 1.0).abs() < 0.015);
    let box_a = dx[0] * dx[0] + dy[0] * dy[0];
    let printed_a = box_a + compose(rough)[0];
    assert!(printed_a / truth[0] > 5.0, "{}", printed_a / truth[0]);
    // Between the two terms: a factor √12, 1.79 levels.
    assert!((12_f64.sqrt() - 3.46).abs() < 0.005);
    assert!((12_f64.sqrt().log2() - 1.79).abs() < 0.005);
}

#[test]
fn row_06_the_spread_along_d_is_that_of_d_transposed() {
    let k = [1.0, 0.9, 1.0];
    let d = decompose(k);
    for (degrees, truth) in [(0.0, 1.0), (45.0, 1.378), (90.0, 1.0), (135.0, 0.316)] {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let along = [cos, sin];
        let variance = k[0] * cos * cos + 2.0 * k[1] * cos * sin + k[2] * sin * sin;
        let spread = norm(&times_transposed(d, along));
        assert!((spread - variance.sqrt()).abs() < 1e-15);
        assert!((spread - truth).abs() < 0.001, "{degrees}°: {spread}");
    }
    let printed = [0.0, 45.0, 90.0, 135.0].map(|degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        norm(&times(d, [cos, sin]))
    });
    for (got, expected) in printed.into_iter().zip([0.436, 1.180, 1.345, 0.780]) {
        assert!((got - expected).abs() < 0.001, "{got}");
    }
}

/// The one-pixel highlight of corrugated iron: PSNR in dB of a model tan²a′ of d = h's slope − mean slope, with the base
/// covariance I/m and the energy kept.
fn corrugated_highlight(model: impl Fn(Covariance, Vector2) -> f64) -> f64 {
    let pixel = OnePixel::corrugated(EXPONENT);
    let m = f64::from(EXPONENT);
    // The model sees K in units of the base, so that a smooth surface has K = I.
    let [a, b, c] = pixel.covariance;
    let relative = [m * a + 1.0, m * b, m * c + 1.0];
    let energy = Ellipse::from_matrix(relative).det.sqrt();
    pixel.psnr(|half| (1.0 + model(relative, pixel.offset(half))).powf(-0.5 * m) / energy)
}

#[test]
fn row_06_the_inverse_form_fits_a_corrugated_highlight_best() {
    let fourth = |d: Vector2| dot(&d, &d).powi(2);
    let safe = |ratio: f64| if ratio.is_nan() { 0.0 } else { ratio };
    // tan²a′ = |d|⁴/|Dd|² (printed), |d|⁴/|Dᵀd|², dᵀK⁻¹d.
    let printed = corrugated_highlight(|k, d| {
        let spread = norm(&times(decompose(k), d));
        safe(fourth(d) / (spread * spread))
    });
    let transposed = corrugated_highlight(|k, d| {
        let spread = norm(&times_transposed(decompose(k), d));
        safe(fourth(d) / (spread * spread))
    });
    let inverse = corrugated_highlight(|k, d| Ellipse::from_matrix(k).quadratic_form(d));
    for (got, expected) in [(printed, 16.7), (transposed, 19.4), (inverse, 21.5)] {
        assert!((got - expected).abs() < 0.05, "{got:.2} dB for {expected} dB");
    }
}

#[test]
fn row_07_a_base_roughness_keeps_the_highlight_finite() {
    // 0/0 at n = h. At D = 0, every flat texel, the highlight is black next to n = h, however close.
    assert!(printed_cos2([0.3, 0.0, 0.3], [0.0; 2]).is_nan());
    assert!(printed_cos2([0.0; 3], [0.0; 2]).is_nan());
    assert_eq!(printed_cos2([0.0; 3], [1e-6, 0.0]), 0.0);
    // With the base covariance I/m and the inverse form both are regular, also for a rank-1 K.
    let base = 1.0 / 64.0;
    for k in [[0.0, 0.0, 0.0], [0.25, 0.0, 0.0], [1.0, 1.0, 1.0]] {
        let total = Ellipse::from_matrix([k[0] + base, k[1], k[2] + base]);
        for d in [[0.0, 0.0], [1e-6, 0.0], [0.0, 0.5]] {
            let cos2 = 1.0 / (1.0 + base * total.quadratic_form(d));
            assert!((0.5..=1.0).contains(&cos2), "{k:?} {d:?}: {cos2}");
        }
        assert_eq!(total.quadratic_form([0.0; 2]), 0.0);
    }
}

#[test]
fn row_08_the_energy_of_a_highlight_must_not_depend_on_the_roughness() {
    // Isotropic K = σ²I: cos²a′ = 1/(1 + tan²a/σ²), to the power m/2 = 16, over the disk of projected half vectors.
    let printed = |sigma: f64| -> f64 {
        let steps = 20_000;
        let width = std::f64::consts::FRAC_PI_2 / f64::from(steps);
        (0..steps)
            .map(|i| {
                let (sin, cos) = ((f64::from(i) + 0.5) * width).sin_cos();
                let tangent = sin / cos / sigma;
                (1.0 + tangent * tangent).powi(-16) * sin * cos
            })
            .sum::<f64>()
            * width
    };
    let unit = printed(1.0);
    for (sigma, expected) in [(0.25, 0.07), (0.5, 0.27), (1.0, 1.0), (2.0, 3.07), (4.0, 6.97)] {
        let energy = printed(sigma) / unit;
        assert!((energy - expected).abs() < 0.005, "σ = {sigma}: {energy}");
    }
    // In the plane of slopes, which contains the covariances, the printed formula grows exactly as √det K = σ₁σ₂, and dividing by it levels the
    // energy: midpoints of a square of ±4 σ in 400 × 400 steps, tail below 1e-15.
    let energy = |sigma: Vector2, turn: f64| {
        let (sin, cos) = f64::sin_cos(turn);
        let [p, q] = [scaled(sigma[0], [cos, sin]), scaled(sigma[1], [-sin, cos])];
        let k = Ellipse::from_matrix([p[0] * p[0] + q[0] * q[0], p[0] * p[1] + q[0] * q[1], p[1] * p[1] + q[1] * q[1]]);
        let reach = 4.0 * sigma[0].max(sigma[1]);
        let cell = reach / 200.0;
        let at = |i: u32| (f64::from(i) + 0.5) * cell - reach;
        let sum: f64 = (0..160_000_u32).map(|i| (1.0 + k.quadratic_form([at(i % 400), at(i / 400)])).powi(-16)).sum();
        sum * cell * cell / k.det.sqrt()
    };
    let expected = std::f64::consts::PI / 15.0;
    for (sigma, turn) in [([0.25, 0.25], 0.0), ([4.0, 4.0], 0.0), ([1.0, 0.5], 0.4), ([2.0, 0.7], 2.0)] {
        assert!((energy(sigma, turn) / expected - 1.0).abs() < 1e-6, "{sigma:?}");
    }
}

#[test]
fn row_09_e1_is_perpendicular_to_the_plane_of_n_and_h_and_e2_lies_in_it() {
    let mut random = SplitMix64::new(209);
    for _ in 0..1000 {
        let [n, h] = [0; 2].map(|_| [0; 3].map(|_| random.uniform(-1.0, 1.0)));
        let frame = frame_main_direction(n, h);
        assert!(dot(&frame.e1, &n).abs() < 1e-15 && dot(&frame.e1, &h).abs() < 1e-15);
        assert!(dot(&frame.e2, &cross(n, h)).abs() < 1e-15);
        // The prose states the opposite: "e₂ perpendicular to h, e₁ in the plane of n and h".
        assert!(dot(&frame.e2, &h) > 0.0, "e₂ is the part of h along the surface");
        assert!(dot(&frame.e1, &cross(h, n)) > 0.0);
    }
}

#[test]
fn row_13_a_quantised_k_is_indefinite_where_a_quantised_d_is_not() {
    // Corrugated iron: rank 1 along (.8, .6), a different strength in every texel, 8 bits.
    let code = |x: f64| (x * 255.0).round();
    let mut random = SplitMix64::new(213);
    let count = 10_000;
    let mut indefinite = 0;
    for _ in 0..count {
        let k = scaled(random.uniform(0.05, 1.0), [0.64, 0.48, 0.36]);
        let [a, b, c] = k.map(code);
        if a * c < b * b {
            indefinite += 1;
            assert!((a - b * b / c).sqrt().is_nan());
        }
        // Codes of D are integers: the determinant is (d₁d₃)² exactly.
        let [a, b, c] = compose(decompose(k).map(code));
        assert!(a * c >= b * b);
    }
    let share = f64::from(indefinite) / f64::from(count);
    assert!((0.4..0.6).contains(&share), "{share}");
    // c = 0, bumps along one axis only: the printed formula divides 0 by 0.
    let [a, b, c] = [0.25_f64, 0.0, 0.0];
    assert!((b / c.sqrt()).is_nan() && (a - b * b / c).sqrt().is_nan());
    assert_eq!(decompose([a, b, c]), [0.5, 0.0, 0.0]);
}

#[test]
fn row_14_the_recursion_has_a_plus() {
    let mut random = SplitMix64::new(214);
    let mut worst = 0.0_f64;
    for _ in 0..1000 {
        let blocks: Vec<Vec<Vector2>> =
            (0..4).map(|_| (0..4).map(|_| [random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)]).collect()).collect();
        let (_, truth) = covariance(&blocks.concat());
        let texels: Vec<Texel> = blocks
            .iter()
            .map(|block| {
                let (mean, k) = covariance(block);
                Texel { mean, k }
            })
            .collect();
        let ours = merge(texels.iter().map(|texel| (0.25, texel))).k;
        worst = (0..3).map(|i| (ours[i] - truth[i]).abs()).fold(worst, f64::max);

        let within = (0..4).fold([0.0; 3], |sum, n| add_scaled(sum, 0.25, texels[n].k));
        let means: Vec<Vector2> = texels.iter().map(|texel| texel.mean).collect();
        let (_, between) = covariance(&means);
        // Two adjacent matrices are a product, ¼·(ΣK)·(Σ(f−f̄)(f−f̄)ᵀ); either sum alone is no better.
        let product = [
            4.0 * (within[0] * between[0] + within[1] * between[1]),
            0.0,
            4.0 * (within[1] * between[1] + within[2] * between[2]),
        ];
        for printed in [product, within, between] {
            assert!(printed[0] < truth[0] && (printed[0] / truth[0] - 1.0).abs() > 1e-4);
        }
    }
    // A few units in the last place of 0.08.
    assert!(worst < 1e-16, "{worst}");
}

#[test]
fn row_15_covariances_are_interpolated_not_d() {
    let [up, down] = [decompose([1.0, 0.9, 1.0]), decompose([1.0, -0.9, 1.0])];
    let halfway = add_scaled(scaled(0.5, up), 0.5, down);
    let [a, ..] = compose(halfway);
    assert!((a - 0.19).abs() < 1e-15, "{a}");
    let ours = add_scaled(scaled(0.5, compose(up)), 0.5, compose(down));
    assert!((ours[0] - 1.0).abs() < 1e-15 && ours[1].abs() < 1e-15);

    // Between two smooth texels of opposite slope, neither texel holds a spread, but their means have one.
    let texels = [-0.5, 0.5].map(|slope| Texel { mean: [slope, 0.0], k: [0.0; 3] });
    let interpolated = add_scaled(scaled(0.5, texels[0].k), 0.5, texels[1].k);
    assert_eq!(interpolated, [0.0; 3]);
    let truth = merge(texels.iter().map(|texel| (0.5, texel)));
    assert_eq!((truth.mean, truth.k), ([0.0; 2], [0.25, 0.0, 0.0]));
    // Second moments E[f fᵀ] interpolate linearly and lose nothing (LEAN mapping).
    let moment = texels.iter().map(|texel| 0.5 * (texel.k[0] + texel.mean[0].powi(2))).sum::<f64>();
    assert_eq!(moment - truth.mean[0].powi(2), 0.25);
}
