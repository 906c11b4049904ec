//! The hard-case sets of the study, one test each: the documented fallback is taken exactly at the hard case, and the
//! approach to it holds the bars (the bars over all sets are in `accuracy.rs`).

use fixed::types::{I2F30, I4F28};
use roughxel_cases::{CaseSet, hard_case_sets};
use roughxel_core::plan::{FrameSystem, ReflectionPlan};
use roughxel_core::ports::{BlockVector, ReflectionIn, ReflectionOut, SurfaceIn};
use roughxel_core::precision::{Precision, ProbeRule, Profile};
use roughxel_core::setup::{real_number, real_offset, real_pair, real_vector};
use roughxel_core::status::StatusBit;
use roughxel_host_tests::reference::linear::{add_scaled, axis_angle, norm, scaled};
use roughxel_host_tests::reference::{self, Outputs, cube, frame};
use roughxel_study::accuracy::{Figure, reference_inputs, reference_options};

/// One profile with one of its sets.
struct Study {
    name: &'static str,
    p: Precision,
    set: CaseSet<ReflectionIn, ReflectionPlan>,
}

impl Study {
    /// What the datapath makes of fragment `index`.
    fn out(&self, index: usize) -> ReflectionOut {
        self.set.cases[index].reflect(&self.set.plan, &self.p)
    }

    /// What the reference makes of it.
    fn want(&self, index: usize) -> Outputs {
        let options = reference_options(&self.set.plan, &self.p);
        reference::reflection(&reference_inputs(&self.set.cases[index]), &options)
    }

    fn all(&self) -> impl Iterator<Item = (usize, ReflectionOut)> {
        (0..self.set.cases.len()).map(|index| (index, self.out(index)))
    }

    fn bar(&self, figure: Figure) -> f64 {
        figure.bar(self.name).expect("the figure has a bar")
    }

    /// One last place of a mantissa.
    fn last(&self) -> f64 {
        (-f64::from(self.p.fraction_bits)).exp2()
    }
}

/// The set `name` for every profile.
fn studies(name: &str) -> Vec<Study> {
    Profile::NAMES
        .iter()
        .map(|profile| {
            let p = Profile::by_name(profile).map(Profile::precision).expect("a listed profile exists");
            let set = hard_case_sets(&p).into_iter().find(|set| set.name == name).expect("the set exists");
            Study { name: profile, p, set }
        })
        .collect()
}

fn raised(out: &ReflectionOut, bit: StatusBit) -> bool {
    out.status & bit.mask() != 0
}

fn lod(out: &ReflectionOut) -> f64 {
    f64::from(out.lod.to_bits()) / 65536.0
}

fn direction(out: &ReflectionOut) -> [f64; 2] {
    out.direction.map(|d| f64::from(d.to_bits()) / f64::from(1 << 30))
}

/// Mantissas of a port as exact integers.
fn integers(v: &BlockVector) -> [i64; 3] {
    v.mantissa.map(|m| i64::from(m.to_bits()))
}

fn parallel(a: &BlockVector, b: &BlockVector) -> bool {
    let (a, b) = (integers(a), integers(b));
    [(0, 1), (1, 2), (2, 0)].into_iter().all(|(i, j)| a[i] * b[j] == a[j] * b[i])
}

/// E₁ and E₂ in units in which n has the exponent 0.
fn frame_of(fragment: &ReflectionIn, out: &ReflectionOut) -> [[f64; 3]; 2] {
    out.frame
        .map(|e| real_vector(&BlockVector { exponent: e.exponent - fragment.surface.normal.exponent, ..e }).to_array())
}

#[test]
fn every_documented_set_exists_and_holds_fragments() {
    let names = [
        "frame_pole",
        "frame_zero",
        "frame_horizon",
        "frame_natural",
        "frame_natural_normalised",
        "cube_edges",
        "cube_corners",
        "footprint_rank",
        "footprint_circle",
        "footprint_aspect",
        "footprint_size",
        "footprint_level",
        "footprint_swap",
        "footprint_cancel",
        "roughness_rank",
        "roughness_isotropic",
    ];
    for profile in Profile::NAMES {
        let sets = hard_case_sets(&Profile::by_name(profile).map(Profile::precision).expect("a listed profile exists"));
        assert_eq!(sets.iter().map(|set| set.name).collect::<Vec<_>>(), names);
        assert!(sets.iter().all(|set| set.cases.len() > 20 && !set.description.is_empty()));
    }
}

#[test]
fn frame_stays_orthonormal_down_to_one_bit() {
    for study in studies("frame_pole") {
        let mut poles = 0;
        for (index, out) in study.all() {
            let fragment = &study.set.cases[index];
            let pole = parallel(&fragment.surface.normal, &fragment.surface.frame_vectors[0]);
            assert_eq!(raised(&out, StatusBit::FramePole), pole, "{} {index}", study.name);
            poles += usize::from(pole);

            let normal = reference_inputs(fragment).normal;
            let [e1, e2] = frame_of(fragment, &out);
            let error = frame::orthonormality_error(normal, e1, e2);
            assert!(error < study.bar(Figure::Frame), "{} {index}: {error}", study.name);
            // Not only orthonormal but the right one, to the last bit of the angle.
            let want = study.want(index).frame;
            assert_eq!(want.pole, pole);
            for (got, want) in [(e1, want.e1), (e2, want.e2)] {
                let error = norm(&add_scaled(got, -1.0, want)) / norm(&normal);
                assert!(error < 2.0 * study.bar(Figure::Frame), "{} {index}: {error}", study.name);
            }
        }
        // n and −n as main direction, for four normals; a last bit may be parallel, too (n along an axis).
        assert!(poles >= 8 && poles < study.set.cases.len() / 2, "{}: {poles} poles", study.name);
    }
}

#[test]
fn zero_normal_gives_face_plus_z() {
    for study in studies("frame_zero") {
        let fragments = &study.set.cases;
        let zero = |v: &BlockVector| integers(v) == [0; 3];
        let mut seen = [0; 3];
        for (index, out) in study.all() {
            let fragment = &fragments[index];
            let (no_normal, no_view) = (zero(&fragment.surface.normal), zero(&fragment.surface.view));
            assert_eq!(raised(&out, StatusBit::NormalZero), no_normal, "{index}");
            assert_eq!(raised(&out, StatusBit::ViewZero), no_view, "{index}");
            if no_normal || no_view {
                assert_eq!((out.face, out.st), (4, [I2F30::ZERO; 2]));
                assert_eq!(out.reflected, BlockVector::default());
                assert_eq!((out.probes, lod(&out)), (1, 0.0));
                assert!(raised(&out, StatusBit::FootprintZero) && raised(&out, StatusBit::FaceTie));
                seen[usize::from(no_normal)] += 1;
            }
            if no_normal {
                assert_eq!((out.frame, out.normal_mod), ([BlockVector::default(); 2], BlockVector::default()));
            }
            if zero(&fragment.surface.frame_vectors[0]) && !no_normal {
                assert!(raised(&out, StatusBit::FramePole), "{index}");
                assert!(frame_of(fragment, &out).iter().all(|e| norm(e) > 0.0), "an axis stands in for h");
                seen[2] += 1;
            }
        }
        assert!(seen.iter().all(|&count| count > 0), "{seen:?}");
    }
}

#[test]
fn tiny_and_huge_vectors_give_the_bits_of_unit_ones() {
    for study in studies("frame_zero") {
        // Four zeros, then n, v (with dv) and h times 2^±1000, 2^±300, 2^±100, 2^±30.
        let first: Vec<ReflectionOut> = (4..7).map(|index| study.out(index)).collect();
        for index in 4..28 {
            let (out, first) = (study.out(index), &first[(index - 4) % 3]);
            let exponents = ReflectionOut {
                frame: first.frame,
                normal_mod: BlockVector { exponent: first.normal_mod.exponent, ..out.normal_mod },
                reflected: BlockVector { exponent: first.reflected.exponent, ..out.reflected },
                ..out
            };
            for (e, same) in out.frame.iter().zip(first.frame) {
                assert_eq!(e.mantissa, same.mantissa, "{} {index}", study.name);
            }
            if index % 3 == 1 {
                // dn and D are relative to |n|; this set has no dn.
                assert_eq!(exponents, *first, "{} {index}", study.name);
            } else {
                assert_eq!(out.st, first.st);
                assert_eq!((out.major, out.minor, out.lod), (first.major, first.minor, first.lod));
            }
        }
    }
}

#[test]
fn view_below_the_perturbed_surface_is_flagged_and_still_reflected() {
    for study in studies("frame_horizon") {
        let mut below = 0;
        for (index, out) in study.all() {
            let fragment = &study.set.cases[index];
            let want = study.want(index);
            let view = reference_inputs(fragment).view;
            let cosine = reference::linear::dot(&view, &want.perturbed) / (norm(&view) * norm(&want.perturbed));
            // Within the frame's error of the horizon either answer is right.
            if cosine.abs() > study.bar(Figure::Frame) {
                assert_eq!(raised(&out, StatusBit::ViewBelowSurface), cosine < 0.0, "{} {index}", study.name);
            }
            below += usize::from(raised(&out, StatusBit::ViewBelowSurface));
            if want.tie_margin > 0.01 {
                assert_eq!(usize::from(out.face), want.selection.face, "{} {index}", study.name);
            }
            assert!(!raised(&out, StatusBit::NormalZero), "n_mod cannot vanish: E is perpendicular to n");
        }
        assert!(below > 20, "{}: {below} from below", study.name);
    }
}

#[test]
fn natural_frames_keep_their_direction_however_skewed_the_tangents() {
    for name in ["frame_natural", "frame_natural_normalised"] {
        for study in studies(name) {
            for (index, out) in study.all() {
                let fragment = &study.set.cases[index];
                let pole = match study.set.plan.frame {
                    FrameSystem::Natural => {
                        parallel(&fragment.surface.frame_vectors[0], &fragment.surface.frame_vectors[1])
                    }
                    _ => fragment.surface.frame_vectors.iter().any(|t| parallel(&fragment.surface.normal, t)),
                };
                assert_eq!(raised(&out, StatusBit::FramePole), pole, "{name} {} {index}", study.name);
                if pole {
                    assert_eq!(out.frame, [BlockVector::default(); 2]);
                    assert_eq!(real_vector(&out.normal_mod), real_vector(&fragment.surface.normal), "unperturbed");
                    continue;
                }
                let want = study.want(index).frame;
                for (got, want) in frame_of(fragment, &out).into_iter().zip([want.e1, want.e2]) {
                    // Relative to the vector itself: system 1 has any length, 0 where n lies along the other tangent.
                    let error = norm(&add_scaled(got, -1.0, want));
                    let bound = 2.0 * study.bar(Figure::Frame) * norm(&want);
                    assert!(error <= bound, "{name} {} {index}: {error}", study.name);
                }
            }
        }
    }
}

/// The reflected ray of the cube sets, exact in integers: n = e_z turns v into (−x, −y, z).
fn exact_ray(fragment: &ReflectionIn) -> [i64; 3] {
    let [x, y, z] = integers(&fragment.surface.view);
    [-x, -y, z]
}

#[test]
fn ties_go_to_z_then_y_then_x_at_every_edge_and_corner() {
    for name in ["cube_edges", "cube_corners"] {
        for study in studies(name) {
            let mut faces = [0; 6];
            let mut ties = 0;
            for (index, out) in study.all() {
                let ray = exact_ray(&study.set.cases[index]);
                let sizes = ray.map(i64::abs);
                let largest = sizes.into_iter().max().unwrap_or(0);
                let axis = (0..3).rev().find(|&axis| sizes[axis] == largest).unwrap_or(2);
                let face = 2 * axis + usize::from(ray[axis] < 0);
                assert_eq!(usize::from(out.face), face, "{name} {} {index}: {ray:?}", study.name);
                let tie = sizes.iter().filter(|&&size| size == largest).count() > 1;
                assert_eq!(raised(&out, StatusBit::FaceTie), tie, "{name} {} {index}: {ray:?}", study.name);
                faces[face] += 1;
                ties += usize::from(tie);

                let [s, t] = out.st.map(|x| f64::from(x.to_bits()) / f64::from(1 << 30));
                let want = cube::select(ray.map(|x| x as f64));
                let bound = 2.0 * study.last();
                assert!((s - want.s).abs() <= bound && (t - want.t).abs() <= bound, "{name} {} {index}", study.name);
            }
            assert!(faces.iter().all(|&count| count > 0), "{name}: {faces:?}");
            assert!(ties > 20, "{name}: {ties} ties");
        }
    }
}

#[test]
fn coordinates_on_an_axis_are_zero_and_the_most_negative_words_are_a_corner() {
    for study in studies("cube_corners") {
        // 8 corners and 6 axes, 27 neighbours each: the exact target is number 13.
        for (axis, face) in (0..6).enumerate() {
            let out = study.out((8 + axis) * 27 + 13);
            assert_eq!((out.face, out.st), (face, [I2F30::ZERO; 2]), "{}", study.name);
        }
        let all_negative = study.out(14 * 27);
        // v = −2·(1, 1, 1) reflects to (2, 2, −2): face −z, s = −x, t = −y.
        assert_eq!(all_negative.face, 5);
        assert!(all_negative.st.iter().all(|x| *x <= -I2F30::ONE + I2F30::from_bits(1 << 15)));
        assert!(raised(&all_negative, StatusBit::FaceTie) && raised(&all_negative, StatusBit::ViewBelowSurface));
    }
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
            // λ₂ is what is left of the minors of p bits, not of a cancelling difference.
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

/// No set had them, and a comparison at the exponent of λ₁ alone passed all sets.
#[test]
fn standard_deviations_that_come_out_in_the_wrong_order_change_places() {
    for study in studies("footprint_swap") {
        for (index, out) in study.all() {
            assert_eq!(out.minor, out.major, "{} {index}", study.name);
            // With det above λ₁⁴ λ₂ is above λ₁, though it is λ₁ of a circle.
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
                // One percent below and above n; 10⁻⁴ above where it exceeds the slack of the profile.
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
                // The picture does not jump with the count: N·step is the diameter on both sides.
                let length = |out: &ReflectionOut| f64::from(out.probes) * norm(&out.step.map(real_offset));
                assert!((length(&exact) / length(&above) - 1.0).abs() < 0.001, "{} around {n}", study.name);
            }
        }
        // Far beyond: capped, the level follows λ₁/16 whatever λ₂.
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
            // Terms of half a texel cancel; what is left is their rounding.
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
            // d₁ or d₃ of one last bit, d₂ of any sign: λ₁ is right all the same.
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

#[test]
fn frame_vectors_of_opposite_normals_are_opposite_in_e1_only() {
    for study in studies("frame_pole") {
        for index in 0..study.set.cases.len() {
            let fragment = study.set.cases[index];
            let opposite =
                BlockVector { mantissa: fragment.surface.normal.mantissa.map(|m| -m), ..fragment.surface.normal };
            let flipped = ReflectionIn { surface: SurfaceIn { normal: opposite, ..fragment.surface }, ..fragment };
            let [e1, e2] = frame_of(&fragment, &study.out(index));
            let [f1, f2] = frame_of(&flipped, &flipped.reflect(&study.set.plan, &study.p));
            // e₁ = h×n turns round with n, e₂ = n×e₁ stays; ties of rounding differ by a last place.
            let length = norm(&e1);
            assert!(norm(&add_scaled(e1, 1.0, f1)) <= 4.0 * study.last() * length, "{} {index}", study.name);
            assert!(norm(&add_scaled(e2, -1.0, f2)) <= 4.0 * study.last() * length, "{} {index}", study.name);
            let unit = scaled(1.0 / length, e1);
            assert!((norm(&unit) - 1.0).abs() < 1e-12);
        }
    }
}
