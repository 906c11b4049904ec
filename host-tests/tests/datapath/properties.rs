//! Properties of the reflection datapath that need no reference: lengths do not matter, mirrors mirror back, a block that is off equals a neutral
//! input, status bits mean exactly their documentation.
//!
//! Every property is claimed for the named profiles and arbitrary ports unless stated otherwise.

mod neutral;

use fixed::types::I2F30;
use rayon::prelude::*;
use roughxel_cases::{hard_case_sets, random_fragment};
use roughxel_core::block::{Block, MANTISSA, normalise};
use roughxel_core::datapath::reflection::leave;
use roughxel_core::datapath::{Reflection, environment_probe, reflection};
use roughxel_core::fx::Fx;
use roughxel_core::plan::{FrameSystem, ReflectionPlan};
use roughxel_core::ports::{BlockVector, Port, ReflectionIn, ReflectionOut, SurfaceIn};
use roughxel_core::precision::{AxisDirection, Precision};
use roughxel_core::scalar_api::environment_scale;
use roughxel_core::setup::real_number;
use roughxel_core::signals::FaceSelect;
use roughxel_core::stage::cube_face::cube_face;
use roughxel_core::stage::reflect::reflect;
use roughxel_core::status::StatusBit;
use roughxel_host_tests::reference;
use roughxel_host_tests::reference::linear::{add_scaled, cross, norm, scaled};
use roughxel_host_tests::space::{self, profiles};
use roughxel_study::accuracy::{Figure, reference_inputs, reference_options};
use roughxel_utilities::random::SplitMix64;

/// Fraction bits of a mantissa: 30.
const FRACTION: u32 = i32::BITS - MANTISSA;
const ONE: i32 = 1 << FRACTION;

fn mantissa(x: Fx<i32, 2>) -> f64 {
    f64::from(x.raw()) / f64::from(ONE)
}

fn vector<const N: usize>(m: [Fx<i32, 2>; N]) -> [f64; N] {
    m.map(mantissa)
}

fn number(x: &Block<i32, 1>) -> f64 {
    mantissa(x.m[0]) * f64::from(x.e.raw()).exp2()
}

fn raised(out: &ReflectionOut, bit: StatusBit) -> bool {
    out.status & bit.mask() != 0
}

/// Arbitrary bits, with exponents far from the ends of their ports.
fn any_fragment(set: &str, index: u64) -> ReflectionIn {
    let mut fragment = space::any_fragment(&mut SplitMix64::for_element(set, index));
    let SurfaceIn { normal, view, frame_vectors: [first, second], .. } = &mut fragment.surface;
    let vectors = [normal, view, first, second].into_iter().chain(&mut fragment.dview).chain(&mut fragment.dnormal);
    vectors.for_each(|vector| vector.exponent %= 40);
    // Every eighth main direction is along the normal.
    if index.is_multiple_of(8) {
        fragment.surface.frame_vectors[0] = fragment.surface.normal;
    }
    fragment
}

/// Runs a claim over random fragments, hard cases and arbitrary bits of one profile.
fn everywhere(name: &str, p: &Precision, count: u64, claim: impl Fn(&ReflectionIn) + Sync) {
    (0..count).into_par_iter().for_each(|index| {
        claim(&random_fragment(name, index, p));
        claim(&any_fragment(name, index));
    });
    hard_case_sets(p).into_iter().for_each(|set| set.cases.par_iter().for_each(&claim));
}

fn stages(fragment: &ReflectionIn, plan: &ReflectionPlan, p: &Precision) -> Reflection<i32> {
    reflection(&fragment.wires(), &environment_scale(fragment.edge_texels, p), plan, p)
}

fn longer(v: BlockVector, places: i16) -> BlockVector {
    BlockVector { exponent: v.exponent + places, ..v }
}

/// A result whose exponent is `places` larger; zero has exponent 0 for any factor.
fn expected_longer(v: BlockVector, places: i16) -> BlockVector {
    if v.mantissa == [I2F30::ZERO; 3] { v } else { longer(v, places) }
}

#[test]
fn lengths_of_normal_view_and_main_direction_change_no_bit() {
    let full = ReflectionPlan::FULL;
    let systems = [FrameSystem::MainDirection, FrameSystem::Natural, FrameSystem::NaturalNormalised];
    for (name, p) in profiles() {
        everywhere(name, &p, 3000, |fragment| {
            for frame in systems {
                let plan = ReflectionPlan { frame, ..full };
                let plain = fragment.reflect(&plan, &p);
                for places in [-300, -1, 1, 77, 900] {
                    let by = |v: BlockVector| longer(v, places);
                    let normal = ReflectionIn {
                        surface: SurfaceIn { normal: by(fragment.surface.normal), ..fragment.surface },
                        dnormal: fragment.dnormal.map(by),
                        ..*fragment
                    };
                    let expected = ReflectionOut {
                        frame: plain.frame.map(|e| expected_longer(e, places)),
                        normal_mod: expected_longer(plain.normal_mod, places),
                        reflected: expected_longer(plain.reflected, 2 * places),
                        ..plain
                    };
                    assert_eq!(normal.reflect(&plan, &p), expected, "n and dn of {fragment:?}");

                    let view = ReflectionIn {
                        surface: SurfaceIn { view: by(fragment.surface.view), ..fragment.surface },
                        dview: fragment.dview.map(by),
                        ..*fragment
                    };
                    let expected = ReflectionOut { reflected: expected_longer(plain.reflected, places), ..plain };
                    assert_eq!(view.reflect(&plan, &p), expected, "v and dv of {fragment:?}");

                    if frame != FrameSystem::Natural {
                        let tangents = ReflectionIn {
                            surface: SurfaceIn {
                                frame_vectors: fragment.surface.frame_vectors.map(by),
                                ..fragment.surface
                            },
                            ..*fragment
                        };
                        assert_eq!(tangents.reflect(&plan, &p), plain, "h, or p_u and p_v of {fragment:?}");
                    }
                }
            }
        });
    }
}

/// A direction with random bits.
fn random_direction(random: &mut SplitMix64, p: &Precision) -> Block<i32, 3> {
    let wide = [(); 3].map(|()| Fx::from_raw(random.next_u64() as i64 >> 2));
    normalise::<i64, 3, 4>(wide, Fx::zero(), p.fraction_bits)
}

#[test]
fn reflecting_twice_gives_the_view_back() {
    for (name, p) in profiles() {
        let sine = |a: [f64; 3], b: [f64; 3]| norm(&cross(a, b)) / (norm(&a) * norm(&b));
        let (once, twice) = (0..250_000_u64)
            .into_par_iter()
            .map(|index| {
                let mut random = SplitMix64::for_element(name, index);
                let (n, v) = (random_direction(&mut random, &p), random_direction(&mut random, &p));
                let r = reflect(&n, &v, &p).r;
                let back = reflect(&n, &r, &p).r;
                let exact = reference::reflect::reflect(vector(v.m), vector(n.m));
                (sine(exact, vector(r.m)), sine(vector(v.m), vector(back.m)))
            })
            .reduce(|| (0.0, 0.0), |a, b| (a.0.max(b.0), a.1.max(b.1)));
        println!("{name}: once 2^{:.2}, twice 2^{:.2}", once.log2(), twice.log2());
        // ⟨v·n⟩ and |n|² are rounded at their common exponent: (4 + 2|v|/|n|)·2^−(p+1) of r, |v|/|n| ≤ 2√3 in mantissas; then r itself, √3·2^−p:
        // 2^−(p−2.9). The second reflection mirrors that error and adds its own.
        let bound = (2.9 - f64::from(p.fraction_bits)).exp2();
        assert!(once < bound, "{name}: {once}");
        assert!(twice < 2.0 * bound, "{name}: {twice}");
    }
}

#[test]
fn faces_are_alike() {
    for (name, p) in profiles() {
        let last = 1 << (FRACTION - p.fraction_bits);
        for index in 0..20_000 {
            let mut random = SplitMix64::for_element(name, index);
            let r = random_direction(&mut random, &p);
            let sizes = |block: &Block<i32, 3>| {
                let point = cube_face(block, &p);
                let mut sizes = point.st.map(|x| x.abs().raw());
                sizes.sort_unstable();
                (sizes, point.half_reciprocal)
            };
            let ([small, large], half_reciprocal) = sizes(&r);
            let [x, y, z] = r.m;
            for m in [[x, z, y], [y, x, z], [y, z, x], [z, x, y], [z, y, x], [-x, y, z], [x, -y, z], [-x, -y, -z]] {
                let ([a, b], same) = sizes(&Block { m, e: r.e });
                assert_eq!(same, half_reciprocal);
                // Ties round towards +∞, so −s may be one last place from s.
                assert!((a - small).abs() <= last && (b - large).abs() <= last, "{m:?}");
            }
        }
    }
}

#[test]
fn face_coordinates_and_back_are_inverse_on_every_face() {
    let mut random = SplitMix64::new(6);
    for face in 0..6 {
        let select = FaceSelect::<i32>::of_index(Fx::lit(face));
        assert_eq!(select.index().raw(), face as i32);
        for _ in 0..1000 {
            let v: [Fx<i32, 2>; 3] = [(); 3].map(|()| Fx::from_raw((random.next_u64() as i32) >> 1));
            assert_eq!(select.from_face(select.to_face(v)), v);
            assert_eq!(select.to_face(select.from_face(v)), v);
            let expected = reference::cube::face_components(face as usize, vector(v));
            assert_eq!(vector(select.to_face(v)), expected);
        }
    }
}

#[test]
fn outputs_stay_in_their_ranges_for_any_port() {
    for (name, p) in profiles() {
        let last = 1 << (FRACTION - p.fraction_bits);
        everywhere(name, &p, 60_000, |fragment| {
            let out = fragment.reflect(&ReflectionPlan::FULL, &p);
            let edge = u32::from(fragment.edge_texels.clamp(1, 16384));
            assert!(out.face < 6);
            assert!((1..=16).contains(&out.probes));
            assert!(out.st.iter().all(|x| (-I2F30::ONE..=I2F30::ONE).contains(x)));
            assert!(out.lod >= 0 && out.lod <= edge.ilog2(), "level {} of {edge}", out.lod);
            assert_eq!(out.lod.to_bits() & ((1 << (16 - p.lod_bits)) - 1), 0, "kept bits only");
            let (major, minor) = (real_number(&out.major), real_number(&out.minor));
            assert!(major >= minor && minor >= 0.0, "{major} {minor}");
            let [x, y] = out.direction.map(|d| f64::from(d.to_bits()) / f64::from(ONE));
            // The inverse root used here errs by 2^−(p−2) relative.
            let noise = 8.0 * f64::from(last) / f64::from(ONE);
            assert!((x.hypot(y) - 1.0).abs() <= noise, "{x} {y}");
            assert!(x + y >= -noise, "the larger component is positive: {x} {y}");
            assert!(real_number(&out.determinant) >= 0.0);
            assert!(out.covariance.mantissa[0] >= 0 && out.covariance.mantissa[2] >= 0);
            assert_eq!(out.status >> 8, 0, "eight bits exist");
        });
    }
}

/// Returns true if the cross product of two mantissa vectors is exactly zero.
fn parallel(a: &Block<i32, 3>, b: &Block<i32, 3>) -> bool {
    let m = |v: &Block<i32, 3>, i: usize| i64::from(v.m[i].raw());
    [(0, 1), (1, 2), (2, 0)].into_iter().all(|(i, j)| m(a, i) * m(b, j) == m(a, j) * m(b, i))
}

fn entered(port: &BlockVector, p: &Precision) -> Block<i32, 3> {
    let wide = port.mantissa.map(|m| Fx::<i32, 2>::from_raw(m.to_bits()).widen());
    normalise::<i64, 3, 4>(wide, Fx::lit(i64::from(port.exponent)), p.fraction_bits)
}

#[test]
fn status_bits_say_exactly_what_they_are_documented_to_say() {
    for (name, p) in profiles() {
        for frame in [FrameSystem::MainDirection, FrameSystem::Natural, FrameSystem::NaturalNormalised] {
            let plan = ReflectionPlan { frame, ..ReflectionPlan::FULL };
            everywhere(name, &p, 20_000, |fragment| {
                let stages = stages(fragment, &plan, &p);
                let out = ReflectionOut::from_wires(&leave(&stages));
                let said =
                    |bit: StatusBit, holds: bool| assert_eq!(raised(&out, bit), holds, "{bit:?} of {fragment:?}");

                let zero = |port: &BlockVector| port.mantissa == [I2F30::ZERO; 3];
                said(StatusBit::NormalZero, zero(&fragment.surface.normal));
                said(StatusBit::ViewZero, zero(&fragment.surface.view));

                let [first, second] = fragment.surface.frame_vectors.map(|t| entered(&t, &p));
                let n = &stages.surface.normal;
                said(
                    StatusBit::FramePole,
                    match frame {
                        FrameSystem::MainDirection => parallel(n, &first),
                        FrameSystem::Natural => parallel(&first, &second),
                        FrameSystem::NaturalNormalised => parallel(n, &first) || parallel(n, &second),
                    },
                );

                let along: i64 = (0..3)
                    .map(|i| {
                        i64::from(stages.surface.normal_mod.m[i].raw()) * i64::from(stages.surface.view.m[i].raw())
                    })
                    .sum();
                said(StatusBit::ViewBelowSurface, along <= 0);

                let mut sizes = stages.reflected.r.m.map(|m| m.raw().abs());
                sizes.sort_unstable();
                said(StatusBit::FaceTie, sizes[1] == sizes[2]);

                let (major, minor) = (&stages.axes.major, &stages.axes.minor);
                said(StatusBit::FootprintZero, stages.columns.iter().all(Block::is_zero));
                said(StatusBit::FootprintZero, major.is_zero());
                // 2 itself is ½·2² or 1·2¹, by rounding.
                if major.e.raw() != 2 || major.m[0].raw() != ONE / 2 {
                    said(StatusBit::FootprintSaturated, number(major) > 2.0 && !major.is_zero());
                }
                // The profile's slack on the aspect; columns may differ so much that λ₂ is 0.
                let ratio = number(&minor.scaled(-major.e)) * 16.0 / mantissa(major.m[0]).max(0.5);
                let slack = (4.0 - f64::from(p.fraction_bits)).exp2();
                if (ratio - 1.0 + slack).abs() > slack / 8.0 {
                    said(StatusBit::ProbesCapped, ratio < 1.0 - slack && !major.is_zero());
                }
            });
        }
    }
}

#[test]
fn degenerate_inputs_give_the_documented_point() {
    for (name, p) in profiles() {
        everywhere(name, &p, 2000, |fragment| {
            let no_normal =
                ReflectionIn { surface: SurfaceIn { normal: BlockVector::default(), ..fragment.surface }, ..*fragment };
            let no_view =
                ReflectionIn { surface: SurfaceIn { view: BlockVector::default(), ..fragment.surface }, ..*fragment };
            for nothing in [no_normal, no_view] {
                let out = nothing.reflect(&ReflectionPlan::FULL, &p);
                assert_eq!(out.reflected, BlockVector::default());
                assert_eq!((out.face, out.st), (4, [I2F30::ZERO; 2]));
                assert_eq!((out.probes, out.lod.to_bits()), (1, 0));
                assert!(raised(&out, StatusBit::FootprintZero));
            }
        });
    }
}

#[test]
fn steps_cover_the_major_diameter() {
    for (name, p) in profiles() {
        everywhere(name, &p, 30_000, |fragment| {
            let out = fragment.reflect(&ReflectionPlan::FULL, &p);
            let [x, y] = out.step.map(|step| f64::from(step.to_bits()) / f64::from(1 << 28));
            let length = f64::from(out.probes) * x.hypot(y);
            let major = real_number(&out.major).min(2.0);
            // Error of the step: 2^−(p−4) relative (table entry and length of the direction), and its own last place, floored to a wide wire with 7
            // bits before its point if that has fewer.
            let diameter = 12_f64.sqrt() * major;
            let places = (2 * p.word_bits() - 8).min(28);
            let bound = diameter * (4.0 - f64::from(p.fraction_bits)).exp2() + 16.0 * (-f64::from(places)).exp2();
            assert!((length - diameter).abs() <= bound, "{length} for {diameter} of {fragment:?}");
        });
    }
}

#[test]
fn probes_lie_symmetrically_and_go_on_across_edges_where_the_reference_says() {
    for (name, p) in profiles() {
        let bar = Figure::Coordinates.bar(name).expect("coordinates have a bar");
        everywhere(name, &p, 20_000, |fragment| {
            let stages = stages(fragment, &ReflectionPlan::FULL, &p);
            let count = stages.probes.count.raw();
            let face = stages.point.select.index().raw() as usize;
            let centre = vector(stages.point.st);
            let step = stages.probes.step.map(|step| f64::from(step.raw()) / f64::from(1 << 28));
            for index in 0..count {
                let place = environment_probe(&stages.point, &stages.probes, Fx::from_raw(index), &p).place;
                let got = place.st.map(|x| f64::from(x.raw()) / f64::from(1 << 28));
                assert!(got.iter().all(|x| x.abs() <= 1.0) && (0..6).contains(&place.face.raw()));
                let offset = f64::from(2 * index - count + 1) / 2.0;
                let on_plane = add_scaled(centre, offset, step);
                let want = reference::cube::continue_across(face, on_plane[0], on_plane[1]);
                let direction = reference::cube::direction_of(face, on_plane[0], on_plane[1]);
                if want.face == place.face.raw() as usize {
                    // st has 28 fraction bits; centre and offset drop lower bits.
                    let bound = bar + 4.0 * (-28_f64).exp2();
                    assert!((got[0] - want.s).abs() <= bound && (got[1] - want.t).abs() <= bound, "{fragment:?}");
                } else {
                    // A different face occurs only at a common edge; the direction is the same within the bar.
                    assert!(reference::cube::tie_margin(direction) <= 2.0 * bar, "{fragment:?}");
                    let unit = |v: [f64; 3]| scaled(1.0 / norm(&v), v);
                    let back = unit(reference::cube::direction_of(place.face.raw() as usize, got[0], got[1]));
                    assert!(norm(&add_scaled(back, -1.0, unit(direction))) <= 2.0 * bar, "{fragment:?}");
                }
            }
        });
    }
}

#[test]
fn neighbouring_inputs_give_neighbouring_footprints() {
    for (name, p) in profiles() {
        let plan = ReflectionPlan::FULL;
        let options = reference_options(&plan, &p);
        let last = 1 << (FRACTION - p.fraction_bits);
        let changes: Vec<f64> = (0..20_000_u64)
            .into_par_iter()
            .filter_map(|index| {
                let fragment = random_fragment(name, index, &p);
                let want = reference::reflection(&reference_inputs(&fragment), &options);
                let out = fragment.reflect(&plan, &p);
                let scale = want.footprint_scale();
                // A last bit is small only next to a whole mantissa; on a tie the plane of the footprint changes.
                let whole = |v: &BlockVector| v.mantissa.iter().any(|m| m.unsigned_abs() >= 0.5);
                let moving = [fragment.surface.normal, fragment.surface.view, fragment.dview[0], fragment.dnormal[1]];
                if !moving.iter().all(whole) || want.tie_margin < 0.01 || scale == 0.0 {
                    return None;
                }
                let mut random = SplitMix64::for_element("neighbours", index);
                let mut moved = fragment;
                for v in
                    [&mut moved.surface.normal, &mut moved.surface.view, &mut moved.dview[0], &mut moved.dnormal[1]]
                {
                    let component = random.below(3) as usize;
                    let step = if random.below(2) == 0 { last } else { -last };
                    v.mantissa[component] = I2F30::from_bits(v.mantissa[component].to_bits() + step);
                }
                let neighbour = moved.reflect(&plan, &p);
                let change = |a: f64, b: f64| (a - b).abs() / scale;
                let major = change(real_number(&out.major), real_number(&neighbour.major));
                let minor = change(real_number(&out.minor), real_number(&neighbour.minor));
                // Near a pole of the tangent basis the tangents turn freely with the last bit, and the roughness with them.
                let h = entered(&fragment.surface.frame_vectors[0], &p);
                let n = entered(&fragment.surface.normal, &p);
                let [h, n] = [h.m, n.m].map(vector);
                let sine = norm(&cross(h, n)) / (norm(&h) * norm(&n));
                (sine > 0.25).then_some(major.max(minor))
            })
            .collect();
        assert!(changes.len() > 8000, "{name}: {} fragments have neighbours", changes.len());
        let worst = changes.into_iter().fold(0.0, f64::max);
        println!("{name}: 2^{:.2} of the footprint's terms", worst.log2());
        // One last bit at four ports, amplified by the tangent basis (1/sin of its angle) and the face (√3).
        assert!(worst < (4.0 - f64::from(p.fraction_bits)).exp2(), "{name}: 2^{:.2}", worst.log2());
    }
}

#[test]
fn exact_and_table_directions_differ_by_the_table_only() {
    for steps in [2, 10, 32, 64] {
        let exact = Precision::COMPACT;
        let table = Precision { direction: AxisDirection::Table { steps }, ..exact };
        for index in 0..5000 {
            let fragment = random_fragment("table directions", index, &exact);
            let by = |p: &Precision| fragment.reflect(&ReflectionPlan::FULL, p);
            let (fine, coarse) = (by(&exact), by(&table));
            assert_eq!(
                (fine.major, fine.minor, fine.probes, fine.lod),
                (coarse.major, coarse.minor, coarse.probes, coarse.lod)
            );
            let [a, b] = [fine, coarse].map(|out| out.direction.map(|d| f64::from(d.to_bits())));
            let angle = reference::linear::axis_angle(a, b).to_degrees();
            // Half a step, and the exact one's own error of 2⁻¹³ radians if the ellipse is well defined.
            let aspect = real_number(&fine.major) / real_number(&fine.minor);
            assert!(angle <= 45.0 / f64::from(steps) + 0.02 || aspect < 1.1, "{angle} of {steps}: {fragment:?}");
        }
    }
}
