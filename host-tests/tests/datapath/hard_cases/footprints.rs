//! Hard cases of derivatives, ellipses, probe counts and roughness.

use fixed::types::{I2F30, I4F28};
use roughxel_core::ports::ReflectionOut;
use roughxel_core::precision::ProbeRule;
use roughxel_core::setup::{real_number, real_offset, real_pair};
use roughxel_core::status::StatusBit;
use roughxel_host_tests::reference::linear::{add_scaled, axis_angle, norm};
use roughxel_study::accuracy::Figure;

use super::{lod, raised, studies};

fn direction(out: &ReflectionOut) -> [f64; 2] {
    out.direction.map(|d| f64::from(d.to_bits()) / f64::from(1 << 30))
}

#[test]
fn both_derivatives_zero_give_one_probe_at_level_zero() {
    for study in studies("footprint_rank") {
        let out = study.out(0);
        assert!(raised(&out, StatusBit::FootprintZero));
        assert_eq!((out.probes, lod(&out), out.step), (1, 0.0, [I4F28::ZERO; 2]));
        assert_eq!((real_number(&out.major), real_number(&out.minor)), (0.0, 0.0));
        assert_eq!(out.direction, [I2F30::ONE, I2F30::ZERO]);
        for (index, out) in study.all().skip(1) {
            assert!(!raised(&out, StatusBit::FootprintZero), "{} {index}", study.name);
        }
    }
}

#[test]
fn a_footprint_of_rank_one_is_capped_and_points_along_its_line() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let five = 5_f64.sqrt();
    // Face +z: s = x and t = −y of r, which moves against v.
    let lines =
        [(1, [1.0, 0.0]), (2, [0.0, 1.0]), (3, [half, -half]), (4, [2.0 / five, -1.0 / five]), (5, [half, half])];
    for study in studies("footprint_rank") {
        for (index, line) in lines {
            let out = study.out(index);
            let want = study.want(index);
            assert_eq!(out.probes, 16, "{} {index}", study.name);
            assert!(raised(&out, StatusBit::ProbesCapped));
            let angle = axis_angle(direction(&out), line).to_degrees();
            assert!(angle <= study.bar(Figure::Direction), "{} {index}: {angle}", study.name);
            // λ₂ is the remainder of the minors of p bits, not of a cancelling difference.
            assert!(real_number(&out.minor) <= 4.0 * study.last() * real_number(&out.major), "{} {index}", study.name);
            assert!((lod(&out) - want.probes.lod).abs() <= study.bar(Figure::LevelOfDetail));
        }
        // (1, 0) and (0, 1): a circle.
        let circle = study.out(7);
        assert_eq!((circle.probes, circle.direction), (1, [I2F30::ONE, I2F30::ZERO]));
        let ratio = real_number(&circle.minor) / real_number(&circle.major);
        assert!((1.0 - 2.0 * study.last()..=1.0).contains(&ratio), "{}: {ratio}", study.name);
    }
}

/// Regression: a comparison at the exponent of λ₁ alone, which no other set detects.
#[test]
fn standard_deviations_that_come_out_in_the_wrong_order_change_places() {
    for study in studies("footprint_swap") {
        for (index, out) in study.all() {
            assert_eq!(out.minor, out.major, "{} {index}", study.name);
            // With det above λ₁⁴, λ₂ is above λ₁, though it is the λ₁ of a circle.
            let square = f64::from(out.covariance.mantissa[0]) * 2.0_f64.powi(out.covariance.exponent.into());
            assert!(real_number(&out.determinant) > square * square, "{} {index}", study.name);
        }
    }
}

#[test]
fn skewed_columns_of_equal_length_are_not_mistaken_for_a_circle() {
    for study in studies("footprint_rank") {
        // (1, 0) and (1, .01); then (1, 0) and (1, 2^−k).
        for index in std::iter::once(6).chain(11..study.set.cases.len()) {
            let (out, want) = (study.out(index), study.want(index));
            assert_eq!(u32::from(out.probes), want.probes.count, "{} {index}", study.name);
            let error = (real_number(&out.minor) - want.axes.minor).abs() / want.axes.major;
            assert!(error <= 4.0 * study.last(), "{} {index}: λ₂ is off by {error} of λ₁", study.name);
        }
    }
}

#[test]
fn a_circle_takes_one_probe_and_the_same_level_at_every_angle() {
    for study in studies("footprint_circle") {
        let level = lod(&study.out(0));
        for (index, out) in study.all() {
            let excess = [0.0, 1e-4, 0.09, 0.11][index % 4];
            let near = index >= 256 || excess == 0.0;
            if near {
                assert_eq!(out.probes, 1, "{} {index}", study.name);
                assert!((lod(&out) - level).abs() <= 2.0 * study.bar(Figure::LevelOfDetail), "{} {index}", study.name);
            } else if excess > 0.01 {
                assert_eq!(out.probes, 2, "{} {index}", study.name);
            }
            // λ does not jump while the axes turn: the radius is .011/√12, whatever the angle.
            let ratio = real_number(&out.minor) / real_number(&study.out(0).minor);
            assert!((ratio - 1.0).abs() < 32.0 * study.last(), "{} {index}: {ratio}", study.name);
        }
    }
}

#[test]
fn probe_count_changes_just_above_every_whole_aspect() {
    for study in studies("footprint_aspect") {
        let rule = |count: u32| match study.p.probe_rule {
            ProbeRule::Ceiling => count.min(16),
            ProbeRule::PowerOfTwo => count.next_power_of_two().min(16),
        };
        for n in 1..=17_u32 {
            for turn in 0..6 {
                let at = |step: usize| study.out(((n as usize - 1) * 5 + step) * 6 + turn);
                // One percent below and above n; 10⁻⁴ above if that exceeds the slack of the profile.
                let (below, exact, above) = (at(0), at(2), at(4));
                // Just below 1 the other axis is the major one.
                assert_eq!(u32::from(below.probes), rule(n.max(2)), "{} just below {n}", study.name);
                assert_eq!(u32::from(exact.probes), rule(n), "{} at {n}", study.name);
                assert_eq!(u32::from(above.probes), rule(n + 1), "{} just above {n}", study.name);
                assert_eq!(raised(&below, StatusBit::ProbesCapped), n == 17);
                assert_eq!(raised(&above, StatusBit::ProbesCapped), n >= 16);
                if study.p.fraction_bits > 18 {
                    assert_eq!(u32::from(at(3).probes), rule(n + 1), "{} 10⁻⁴ above {n}", study.name);
                }
                // The picture does not jump with the probe count: N·step is the diameter on both sides.
                let length = |out: &ReflectionOut| f64::from(out.probes) * norm(&out.step.map(real_offset));
                assert!((length(&exact) / length(&above) - 1.0).abs() < 0.001, "{} around {n}", study.name);
            }
        }
        // Far beyond: clamped, the level follows λ₁/16 whatever λ₂ is.
        let capped: Vec<ReflectionOut> = (85 * 6..study.set.cases.len()).map(|index| study.out(index)).collect();
        assert_eq!(capped.len(), 36);
        for out in &capped {
            assert!(out.probes == 16 && raised(out, StatusBit::ProbesCapped));
            assert!((lod(out) - lod(&capped[0])).abs() <= 2.0 * study.bar(Figure::LevelOfDetail));
        }
    }
}

#[test]
fn level_rises_by_one_per_octave_and_stays_inside_the_map() {
    for study in studies("footprint_size") {
        let levels: Vec<f64> = study.all().map(|(_, out)| lod(&out)).collect();
        for kind in 0..2 {
            let levels: Vec<f64> = levels.iter().skip(kind).step_by(2).copied().collect();
            assert!(levels.windows(2).all(|pair| pair[0] <= pair[1]), "{} {levels:?}", study.name);
            assert_eq!((levels[0], levels[levels.len() - 1]), (0.0, 8.0));
            for pair in levels.windows(2).filter(|pair| pair[0] > 0.0 && pair[1] < 8.0) {
                // Powers of two of one footprint have the same mantissas: exactly one level.
                assert_eq!(pair[1] - pair[0], 1.0, "{}", study.name);
            }
        }
        for (index, out) in study.all() {
            let major = real_number(&out.major);
            assert_eq!(raised(&out, StatusBit::FootprintSaturated), major > 2.0, "{} {index}", study.name);
            let length = f64::from(out.probes) * norm(&out.step.map(real_offset));
            assert!(length <= 6.94, "{} {index}: the footprint is cut to two faces, {length}", study.name);
            assert_eq!(
                out.probes,
                study.out(index % 2).probes,
                "{} {index}: the aspect is that of the set",
                study.name
            );
        }
    }
}

#[test]
fn focus_of_the_parabolic_mirror_has_a_footprint_far_below_a_texel() {
    for study in studies("footprint_cancel") {
        for point in 0..4 {
            let texels = |defocus: usize| {
                let out = study.out(4 * point + defocus);
                12_f64.sqrt() * real_number(&out.major) * 128.0
            };
            // Terms of half a texel cancel; their rounding remains.
            assert!(texels(0) < 32.0 * study.last(), "{} {point}: {} texels at the focus", study.name, texels(0));
            assert_eq!(lod(&study.out(4 * point)), 0.0);
            assert!(texels(1) < texels(2) && texels(2) < texels(3), "{} {point}", study.name);
            let want = 12_f64.sqrt() * study.want(4 * point + 3).axes.major * 128.0;
            assert!((texels(3) / want - 1.0).abs() < study.bar(Figure::MajorAxis), "{} {point}", study.name);
        }
    }
}

#[test]
fn a_cylinder_spreads_in_one_direction_only() {
    for study in studies("footprint_cancel") {
        for index in 16..study.set.cases.len() {
            let (out, want) = (study.out(index), study.want(index));
            assert!(out.probes > 1, "{} {index}", study.name);
            assert_eq!(u32::from(out.probes), want.probes.count, "{} {index}", study.name);
            let angle = axis_angle(direction(&out), want.axes.direction).to_degrees();
            assert!(angle <= study.bar(Figure::Direction), "{} {index}: {angle}", study.name);
        }
    }
}

#[test]
fn roughness_of_rank_one_makes_a_line_and_none_makes_a_point() {
    for study in studies("roughness_rank") {
        for (index, out) in study.all() {
            let fragment = &study.set.cases[index];
            let [d1, d2, d3] = fragment.surface.roughness.map(|d| i64::from(d.to_bits()));
            let (alone, rank_one) = (index % 2 == 1, d1 * d3 == 0);
            let nothing = [d1, d2, d3] == [0; 3];
            assert_eq!(raised(&out, StatusBit::FootprintZero), alone && nothing, "{} {index}", study.name);
            if alone && rank_one && !nothing {
                assert!(out.probes == 16 && raised(&out, StatusBit::ProbesCapped), "{} {index}", study.name);
                let ratio = real_number(&out.minor) / real_number(&out.major);
                assert!(ratio <= 8.0 * study.last(), "{} {index}: aspect 1/{ratio}", study.name);
            }
            // d₁ or d₃ of one last bit, d₂ of any sign: λ₁ is still right.
            let want = study.want(index).axes.major;
            let error = (real_number(&out.major) - want).abs();
            assert!(error <= study.bar(Figure::MajorAxis) * want, "{} {index}: {error} of {want}", study.name);
        }
    }
}

#[test]
fn columns_of_rank_one_roughness_are_parallel_to_its_tangent() {
    for study in studies("roughness_rank") {
        // The first 32 decompositions turn the line of rank one by 180°/32.
        for index in (1..64).step_by(2) {
            let (out, want) = (study.out(index), study.want(index));
            let columns = [2, 3].map(|column| real_pair(&out.columns[column]).to_array());
            for (got, want) in columns.into_iter().zip([2, 3].map(|column| want.columns[column])) {
                let error = norm(&add_scaled(got, -1.0, want.q));
                assert!(error <= study.bar(Figure::MajorAxis) * want.scale, "{} {index}: {error}", study.name);
            }
        }
    }
}

#[test]
fn isotropic_roughness_scales_its_footprint_exactly() {
    for study in studies("roughness_isotropic") {
        let outs: Vec<ReflectionOut> = study.all().map(|(_, out)| out).collect();
        // Every other fragment has no pixel: K is σ² times one matrix, from the last bit to the end of the range.
        let alone: Vec<&ReflectionOut> = outs.iter().step_by(2).collect();
        assert_eq!(alone.len() as u32, study.p.offset_bits() + 3);
        for pair in alone.windows(2) {
            assert_eq!(pair[1].major.mantissa, pair[0].major.mantissa, "{}", study.name);
            assert_eq!(pair[1].major.exponent, pair[0].major.exponent + 1, "{}", study.name);
            assert_eq!((pair[1].direction, pair[1].probes), (pair[0].direction, pair[0].probes));
        }
        // With the pixel σ only adds.
        for (with, without) in outs.iter().skip(1).step_by(2).zip(&alone) {
            let sum = real_number(&without.major).max(real_number(&outs[1].major));
            assert!(real_number(&with.major) >= sum * (1.0 - 16.0 * study.last()), "{}", study.name);
        }
    }
}
