//! Highlights: accuracy against the float64 reference, hard cases, energy, the one-pixel bars, and the backends.

use fixed::types::{I4F28, I8F24, I16F16};
use rayon::prelude::*;
use roughxel_cases::CaseSet;
use roughxel_cases::highlight::{FULL, highlight_sets, random_light};
use roughxel_core::datapath;
use roughxel_core::design::Design;
use roughxel_core::plan::{Datapath, FrameSystem, SurfacePlan};
use roughxel_core::ports::{BlockVector, HighlightIn, HighlightOut, Port, ReflectionIn, Shininess, SurfaceIn};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::setup::{block_vector, offset, real_offset, real_vector, shininess};
use roughxel_core::status::StatusBit;
use roughxel_host_tests::bars::{ONE_PIXEL_BARS, highlight_bar};
use roughxel_host_tests::checked::{counted, reread};
use roughxel_host_tests::designs::same_when_checked;
use roughxel_host_tests::one_pixel::{EXPONENT, OnePixel};
use roughxel_host_tests::reference::ellipse::Ellipse;
use roughxel_host_tests::reference::frame;
use roughxel_host_tests::reference::highlight::{Highlight, Scene, highlight, lobe};
use roughxel_host_tests::reference::linear::{Vector2, Vector3, cross, dot, norm};
use roughxel_host_tests::reference::perturb::perturb;
use roughxel_host_tests::reference::roughness::{decompose, isotropic_tangents, tangents};
use roughxel_host_tests::space::{any_fragment, any_word, effects, profiles};
use roughxel_netlist::integers::integers_at;
use roughxel_utilities::random::SplitMix64;

fn raised(out: &HighlightOut, bit: StatusBit) -> bool {
    out.status & bit.mask() != 0
}

fn f(out: &HighlightOut) -> f64 {
    out.f.to_num()
}

/// A vector in units in which its exponent is 0: no length matters.
fn direction(v: &BlockVector) -> Vector3 {
    real_vector(&BlockVector { exponent: 0, ..*v }).to_array()
}

/// Result of the reference for a fragment.
fn want(fragment: &HighlightIn, plan: &SurfacePlan) -> Highlight {
    let normal = direction(&fragment.surface.normal);
    let system = match plan.frame {
        FrameSystem::MainDirection => frame::FrameSystem::MainDirection,
        FrameSystem::Natural => frame::FrameSystem::Natural,
        FrameSystem::NaturalNormalised => frame::FrameSystem::NaturalNormalised,
    };
    let frame = frame::frame(system, normal, fragment.surface.frame_vectors.map(|t| direction(&t)));
    let b = fragment.surface.offset.map(real_offset);
    let d = fragment.surface.roughness.map(real_offset);
    let scene = Scene {
        normal,
        normal_mod: if plan.bump { perturb(normal, &frame, b) } else { normal },
        tangents: match plan.roughness {
            RoughnessKind::None => [[0.0; 3]; 2],
            RoughnessKind::Isotropic => isotropic_tangents(&frame, d[0]),
            RoughnessKind::Anisotropic => tangents(&frame, d),
        },
        view: direction(&fragment.surface.view),
        light: direction(&fragment.light),
        exponent: fragment.shininess.exponent.to_num::<f64>().clamp(1.0, 8192.0),
    };
    highlight(&scene)
}

/// Returns true if the ports of a fragment are consistent.
fn sound(fragment: &HighlightIn) -> bool {
    let [m, root]: [f64; 2] = [fragment.shininess.exponent.to_num(), fragment.shininess.root.to_num()];
    (root * root / m - 1.0).abs() < 1e-5
}

/// |n·l| over the lengths, below which rounding decides the side of the light.
const HORIZON_MARGIN: f64 = 1e-6;

/// Least length of l/|l| + v/|v| that counts: l and v are at most 166° apart. Beyond, the error of the half vector grows with tan θ (tested
/// separately).
const OPPOSITE: f64 = 0.25;

/// The error of f over max(1, √m), and f; `None` if the fragment does not count.
fn error(fragment: &HighlightIn, plan: &SurfacePlan, p: &Precision) -> Option<(f64, f64)> {
    let want = want(fragment, plan);
    let conditioned = want.facing.abs() > HORIZON_MARGIN && norm(&want.half) > OPPOSITE && sound(fragment);
    let got = f(&fragment.highlight(plan, p));
    let root: f64 = fragment.shininess.root.to_num();
    conditioned.then(|| ((got - want.f).abs() / root.max(1.0), want.f))
}

#[test]
fn f_holds_its_bar_on_random_fragments_and_hard_cases() {
    const FRAGMENTS: u64 = 150_000;
    for (name, p) in profiles() {
        let bar = highlight_bar(name).expect("every profile has a bar");
        let random = (0..FRAGMENTS).into_par_iter().filter_map(|index| {
            let fragment = random_light("highlight", index, &p);
            let (error, f) = error(&fragment, &FULL, &p)?;
            Some((error, u64::from(f > 0.01), 1_u64, fragment))
        });
        let worst = |a: (f64, u64, u64, HighlightIn), b: (f64, u64, u64, HighlightIn)| {
            let larger = if b.0 > a.0 || b.0.is_nan() { b } else { a };
            (larger.0, a.1 + b.1, a.2 + b.2, larger.3)
        };
        let (error_of_random, bright, counted, at) = random.reduce(|| (0.0, 0, 0, HighlightIn::default()), worst);
        println!(
            "{name:8} random: 2^{:.2} of 2^{:.0}, {bright} bright of {counted}",
            error_of_random.log2(),
            bar.log2()
        );
        assert!(counted > FRAGMENTS / 2 && bright > FRAGMENTS / 8);
        assert!(error_of_random <= bar, "{name}: {error_of_random} in {at:?}");
        for set in highlight_sets(&p) {
            let errors = set.cases.iter().filter_map(|fragment| Some((error(fragment, &set.plan, &p)?.0, fragment)));
            let (worst, at) = errors.fold((0.0, None), |a, b| if b.0 > a.0 { (b.0, Some(b.1)) } else { a });
            println!("{name:8} {}: 2^{:.2}", set.name, worst.log2());
            assert!(worst <= bar, "{name} {}: {worst} in {at:?}", set.name);
        }
    }
}

/// The set `name` for every profile.
fn studies(name: &str) -> Vec<(Precision, CaseSet<HighlightIn, SurfacePlan>)> {
    let study = |(_, p): (&str, Precision)| {
        let set = highlight_sets(&p).into_iter().find(|set| set.name == name).expect("the set exists");
        (p, set)
    };
    profiles().map(study).into()
}

fn zero(v: &BlockVector) -> bool {
    v.mantissa.iter().all(|m| m.to_bits() == 0)
}

#[test]
fn a_half_vector_errs_by_its_last_places_until_l_and_v_are_opposite() {
    for (name, p) in profiles() {
        let sets = highlight_sets(&p).into_iter().flat_map(|set| set.cases);
        let random = (0..100_000).map(|index| random_light("half", index, &p));
        let mut worst = 0.0_f64;
        for fragment in sets.chain(random) {
            let want = want(&fragment, &FULL).half;
            let got = datapath::lit_surface(&fragment.wires(), &FULL, &p).highlight.half;
            let got = got.m.map(|m| f64::from(m.raw()));
            if norm(&want) < 1e-12 {
                continue;
            }
            // |h| = 2 cos θ for the angle 2θ between l and v.
            let cos = 0.5 * norm(&want);
            let tan = (1.0 - cos * cos).max(0.0).sqrt() / cos;
            let error = norm(&cross(got, want)) / (norm(&got) * norm(&want));
            worst = worst.max(error / (1.0 + tan));
        }
        println!("{name:8} half vector: 2^{:.2}", worst.log2());
        assert!(worst < (1.1 - f64::from(p.fraction_bits)).exp2(), "{name}: 2^{:.2}", worst.log2());
    }
}

#[test]
fn at_the_peak_nothing_is_divided_by_zero() {
    for (p, set) in studies("highlight_peak") {
        let mut peaks = 0;
        for fragment in &set.cases {
            let out = fragment.highlight(&set.plan, &p);
            assert_eq!(out.status & !(StatusBit::FramePole.mask()), 0);
            if fragment.light == fragment.surface.normal && fragment.surface.view == fragment.surface.normal {
                peaks += 1;
                let smooth = fragment.surface.roughness.iter().all(|d| d.to_bits() == 0);
                assert!(!smooth || out.f == 1, "{}", out.f);
                let want = want(fragment, &set.plan).f;
                let last = 8.0 * (-f64::from(p.fraction_bits)).exp2();
                assert!((f(&out) / want - 1.0).abs() < last + 1e-6 / want, "{} for {want}", f(&out));
            }
        }
        assert_eq!(peaks, 27);
    }
}

#[test]
fn without_a_half_vector_or_a_light_f_is_zero_and_a_bit_says_why() {
    for (p, set) in studies("highlight_opposite") {
        let mut seen = [0; 4];
        for fragment in &set.cases {
            let out = fragment.highlight(&set.plan, &p);
            let [no_normal, no_view, no_light] =
                [fragment.surface.normal, fragment.surface.view, fragment.light].map(|v| zero(&v));
            let sum =
                [0, 1, 2].map(|i| fragment.light.mantissa[i].to_bits() + fragment.surface.view.mantissa[i].to_bits());
            let opposite = sum == [0; 3] && fragment.light.exponent == fragment.surface.view.exponent;
            for (bit, holds) in [
                (StatusBit::NormalZero, no_normal),
                (StatusBit::ViewZero, no_view),
                (StatusBit::LightZero, no_light),
                (StatusBit::HalfZero, no_light || no_view || opposite),
            ] {
                assert_eq!(raised(&out, bit), holds, "{bit:?} of {fragment:?}");
            }
            if no_normal || no_view || no_light || opposite {
                assert_eq!(out.f, 0);
                assert!(raised(&out, StatusBit::HalfBelowSurface));
            }
            assert!(!(no_normal || no_light) || raised(&out, StatusBit::LightBelowSurface));
            for (seen, what) in seen.iter_mut().zip([no_normal, no_view, no_light, opposite]) {
                *seen += i32::from(what);
            }
        }
        assert!(seen.iter().all(|&count| count >= 4), "{seen:?}");
    }
}

#[test]
fn a_light_on_the_horizon_or_below_it_gives_nothing() {
    for (p, set) in studies("highlight_horizon") {
        let (mut on, mut above) = (0, 0);
        for fragment in &set.cases {
            let integers = |v: &BlockVector| v.mantissa.map(|m| i128::from(m.to_bits()));
            let [n, l] = [&fragment.surface.normal, &fragment.light].map(integers);
            let facing: i128 = n.iter().zip(l).map(|(n, l)| n * l).sum();
            let out = fragment.highlight(&set.plan, &p);
            assert_eq!(raised(&out, StatusBit::LightBelowSurface), facing <= 0);
            assert!(facing > 0 || out.f == 0);
            on += i32::from(facing == 0);
            above += i32::from(facing > 0 && f(&out) > 0.01);
        }
        assert!(on >= 16 && above >= 4, "{on} on the horizon, {above} lit above it");
    }
}

#[test]
fn exponents_beyond_the_ends_read_as_the_ends() {
    for (p, set) in studies("highlight_exponent") {
        for fragment in &set.cases {
            let m: f64 = fragment.shininess.exponent.to_num();
            let root: f64 = fragment.shininess.root.to_num();
            let ends = HighlightIn {
                shininess: Shininess { exponent: shininess(m).exponent, root: I8F24::from_num(root.clamp(1.0, 91.0)) },
                ..*fragment
            };
            assert_eq!(fragment.highlight(&set.plan, &p), ends.highlight(&set.plan, &p));
        }
    }
}

#[test]
fn a_neutral_map_gives_the_bits_of_the_design_without_it() {
    for (_, p) in profiles() {
        let sets = highlight_sets(&p).into_iter().flat_map(|set| set.cases);
        let random = (0..20_000).map(|index| random_light("neutral map", index, &p));
        for fragment in sets.chain(random) {
            let flat =
                HighlightIn { surface: SurfaceIn { roughness: [I4F28::ZERO; 3], ..fragment.surface }, ..fragment };
            let without = SurfacePlan { roughness: RoughnessKind::None, ..FULL };
            let expected = flat.highlight(&without, &p);
            for roughness in [RoughnessKind::Anisotropic, RoughnessKind::Isotropic] {
                assert_eq!(flat.highlight(&SurfacePlan { roughness, ..FULL }, &p), expected, "{flat:?}");
            }
            let plane = HighlightIn { surface: SurfaceIn { offset: [I4F28::ZERO; 2], ..flat.surface }, ..flat };
            let bare = plane.highlight(&SurfacePlan { bump: false, ..without }, &p);
            let with_frame = plane.highlight(&without, &p);
            assert_eq!(with_frame.f, bare.f);
            assert_eq!(with_frame.status & !(StatusBit::FramePole.mask()), bare.status);
        }
    }
}

/// A fragment on the plane z = 0, x and y as its tangents, seen and lit along `half`.
fn on_plane(half: Vector3, mean: Vector2, d: [f64; 3], m: f64, p: &Precision) -> HighlightIn {
    let vector = |v: Vector3| block_vector(v.into(), p);
    HighlightIn {
        surface: SurfaceIn {
            normal: vector([0.0, 0.0, 1.0]),
            view: vector(half),
            frame_vectors: [vector([0.0, 1.0, 0.0]), BlockVector::default()],
            offset: mean.map(|b| offset(b, p)),
            roughness: d.map(|d| offset(d, p)),
        },
        light: vector(half),
        shininess: shininess(m),
    }
}

#[test]
fn energy_over_the_plane_of_slopes_does_not_depend_on_the_roughness() {
    const M: f64 = 32.0;
    for (name, p) in profiles() {
        let energy = |sigma: [f64; 2]| -> f64 {
            // Six deviations of the total covariance to either side; the tail beyond is below 1 %.
            let reach = sigma.map(|s| 6.0 * (s * s + 1.0 / M).sqrt());
            let steps = 160;
            let at = |i: usize, axis: usize| (2.0 * (i as f64 + 0.5) / f64::from(steps) - 1.0) * reach[axis];
            let cell = reach.map(|r| 2.0 * r / f64::from(steps));
            let rows = (0..steps as usize).into_par_iter().map(|y| -> f64 {
                let light = |x| on_plane([at(x, 0), at(y, 1), 1.0], [0.0; 2], [sigma[0], 0.0, sigma[1]], M, &p);
                (0..steps as usize).map(|x| f(&light(x).highlight(&FULL, &p))).sum()
            });
            rows.sum::<f64>() * cell[0] * cell[1]
        };
        let smooth = energy([0.0; 2]);
        // ∫(1 + |t|²)^(−m/2) dt = 2π/(m − 2).
        assert!((smooth / (std::f64::consts::TAU / (M - 2.0)) - 1.0).abs() < 0.01, "{name}: {smooth}");
        for sigma in [[0.25; 2], [0.5; 2], [1.0; 2], [2.0; 2], [4.0; 2], [1.0, 0.0], [2.0, 0.3]] {
            let ratio = energy(sigma) / smooth;
            println!("{name:8} σ = {sigma:?}: {ratio:.4}");
            assert!((ratio - 1.0).abs() < 0.05, "{name} {sigma:?}: {ratio}");
        }
    }
}

#[test]
fn one_pixel_highlights_hold_their_bars() {
    let m = f64::from(EXPONENT);
    for (pixel, (name, bar, averaged)) in OnePixel::all(EXPONENT).into_iter().zip(ONE_PIXEL_BARS) {
        assert_eq!(pixel.name, name);
        let [a, b, c] = pixel.covariance;
        let total = [a + 1.0 / m, b, c + 1.0 / m];
        let real = pixel.psnr(|half| lobe(total, pixel.offset(half), m));
        // The printed formula with the same base and energy: only |d|⁴/|Dd|² differs.
        let relative = total.map(|k| m * k);
        let energy = Ellipse::from_matrix(relative).det.sqrt();
        let printed = pixel.psnr(|half| {
            let d = pixel.offset(half);
            let [d1, d2, d3] = decompose([relative[0], relative[1], relative[2]]);
            let spread = [d1 * d[0] + d2 * d[1], d3 * d[1]];
            let square = dot(&d, &d);
            let tan2 = if square > 0.0 { square * square / dot(&spread, &spread) } else { 0.0 };
            (1.0 + tan2).powf(-0.5 * m) / energy
        });
        // A Gaussian tail instead of the power fits no better.
        let gaussian = pixel.psnr(|half| {
            let form = Ellipse::from_matrix(total).quadratic_form(pixel.offset(half));
            (-0.5 * form).exp() / energy
        });
        assert!(real > gaussian - 0.01, "{name}: {gaussian:.2} dB with a Gaussian tail");
        let mean = pixel.averaged();
        println!("{name:12} {real:.2} dB in float64, Gaussian {gaussian:.2}, printed {printed:.2}, averaged {mean:.2}");
        assert!((mean - averaged).abs() < 1.0, "{name}: {mean:.2} dB for {averaged}");
        for (profile, p) in profiles() {
            let d = decompose(pixel.covariance);
            let got = pixel.psnr(|half| f(&on_plane(half, pixel.mean, d, m, &p).highlight(&FULL, &p)));
            println!("{name:12} {profile:8} {got:.2} dB");
            assert!(got >= bar, "{name} {profile}: {got:.2} dB");
            assert!((got - real).abs() < 0.1);
        }
    }
}

/// Any bits at any port.
fn any_highlight(random: &mut SplitMix64) -> HighlightIn {
    let ReflectionIn { surface, dview: [light, _], .. } = any_fragment(random);
    let [exponent, root] = [(); 2].map(|()| any_word(random));
    let shininess = Shininess { exponent: I16F16::from_bits(exponent), root: I8F24::from_bits(root) };
    HighlightIn { surface, light, shininess }
}

#[test]
fn backends_agree_for_any_bits_at_the_ports_under_every_plan() {
    let plans = effects(Some(Datapath::Highlight));
    for (name, p) in profiles() {
        let hard: Vec<_> = highlight_sets(&p).into_iter().flat_map(|set| set.cases).collect();
        (0..20_000_u64).into_par_iter().for_each(|index| {
            let mut random = SplitMix64::for_element(name, index);
            let fragment = match index % 3 {
                0 => hard[index as usize / 3 % hard.len()],
                1 => random_light(name, index, &p),
                _ => any_highlight(&mut random),
            };
            let effects = &plans[random.below(plans.len() as u64) as usize];
            same_when_checked(Design::Highlight, &integers_at(&fragment.wires(), &p), effects, &p);
            let f = fragment.highlight(&effects.highlight(), &p).f.to_bits();
            assert!((0..=1 << 24).contains(&f), "f of {fragment:?}");
        });
    }
}

#[test]
fn several_lights_share_one_surface() {
    let p = Precision::STANDARD;
    let (light, all) = counted(|| {
        let wires = reread(&random_light("lights", 1, &p).wires());
        let surface = datapath::surface(&wires.surface, &FULL, &p);
        let gloss = datapath::gloss(&surface, &wires.shininess, &FULL, &p);
        let (_, one) = counted(|| datapath::highlight(&surface, &gloss, &wires.light, &p));
        one
    });
    let rest = all.hardware() - light.hardware();
    println!("{rest} operations for the surface and its material, {} a light", light.hardware());
    assert!(light.hardware() < rest, "a second light costs less than the surface");
}
