//! F32 baseline of the benchmarks: it is the same mathematics, and its batches give the same numbers.

use fixed::types::I2F30;
use roughxel_cases::random_fragment;
use roughxel_core::plan::ReflectionPlan;
use roughxel_core::ports::{BlockVector, ReflectionIn, SurfaceIn};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{block_vector, offset};
use roughxel_core::status::StatusBit;
use roughxel_f32_baseline::batch::{FootprintBlock, FragmentBlock, reflect_batch};
use roughxel_f32_baseline::formulas::Careful;
use roughxel_f32_baseline::math::{Libm, Micromath, Std};
use roughxel_f32_baseline::{Environment, Fragment};
use roughxel_host_tests::reference;
use roughxel_simd::LANES;
use roughxel_study::accuracy::{CANCELLATION, reference_inputs, reference_options};

const PROFILE: Precision = Precision::STANDARD;

/// Random fragments in the range of `f32`.
fn fragments(count: usize) -> impl Iterator<Item = ReflectionIn> {
    (0..).map(|index| random_fragment("float", index, &PROFILE)).filter(Fragment::in_range).take(count)
}

/// Measured on these fragments: s, t 2^−20.4; step 2^−18.9; level of detail 2^−13.1, all of it the logarithm's.
#[test]
fn plain_version_agrees_with_the_float64_reference() {
    const COUNT: usize = 100_000;
    let options = reference_options(&ReflectionPlan::FULL, &PROFILE);
    let (mut places, mut footprints, mut steps) = (0, 0, 0);
    for ports in fragments(COUNT) {
        let fragment = Fragment::from(&ports);
        let Fragment { normal, main_direction, .. } = fragment;
        // Near the pole, h×n is the f32 remainder of a difference.
        let sine = main_direction.cross(normal).length() / (main_direction.length() * normal.length());
        let want = reference::reflection(&reference_inputs(&ports), &options);
        if sine.is_nan() || sine < 0.05 || want.selection.m == 0.0 || want.tie_margin < 1e-5 {
            continue;
        }
        let got = Environment::new(u32::from(ports.edge_texels)).reflect::<Std, Careful>(&fragment);
        places += 1;
        assert_eq!(got.face as usize, want.selection.face, "{ports:?}");
        let [s, t] = got.st.to_array().map(f64::from);
        let error = (s - want.selection.s).abs().max((t - want.selection.t).abs());
        assert!(error < 2_f64.powi(-17), "s, t: {error:e}, {ports:?}");
        if want.axes.major == 0.0 || want.axes.major * CANCELLATION < want.footprint_scale() {
            continue;
        }
        footprints += 1;
        let error = (f64::from(got.lod) - want.probes.lod).abs();
        assert!(error < 2_f64.powi(-11), "level of detail: {error:e}, {ports:?}");
        let ratio = want.axes.ratio();
        if (ratio - ratio.round()).abs() < 1e-4 * ratio {
            continue;
        }
        assert_eq!(got.probes, want.probes.count, "{ports:?}");
        assert_eq!(got.status & StatusBit::ProbesCapped.mask() != 0, want.probes.capped, "{ports:?}");
        if ratio < 1.1 || want.axes.major > 2.0 {
            continue;
        }
        steps += 1;
        let [x, y] = got.step.to_array().map(f64::from);
        let [u, v] = want.probes.step;
        // The sign of an axis is a convention, and a matter of rounding if its components are equal.
        let error = (x - u).hypot(y - v).min((x + u).hypot(y + v)) / u.hypot(v);
        assert!(error < 2_f64.powi(-15), "step: {error:e}, {ports:?}");
    }
    assert!(places > COUNT * 9 / 10 && footprints > COUNT * 9 / 10 && steps > COUNT * 8 / 10);
}

#[test]
fn batches_are_the_plain_version() {
    let environment = Environment::new(512);
    // The last block is not full.
    let fragments: Vec<_> = fragments(10 * LANES - 3).map(|ports| Fragment::from(&ports)).collect();
    let blocks = FragmentBlock::blocks(&fragments);
    let mut footprints = vec![FootprintBlock::default(); blocks.len()];
    reflect_batch(&environment, &blocks, &mut footprints);
    for (index, fragment) in fragments.iter().enumerate() {
        assert_eq!(
            footprints[index / LANES].get(index % LANES),
            environment.reflect::<Std, Careful>(fragment),
            "{fragment:?}"
        );
    }
}

/// Measured on these fragments: `libm` gives the same bits. With `micromath`, one in 75 is on a different face, and s, t are off by 0.05 in the
/// median and 0.22 at worst; a face is two map units.
#[test]
fn libm_is_the_standard_library_and_micromath_errs_by_texels() {
    const COUNT: usize = 2048;
    let environment = Environment::new(256);
    let (mut errors, mut other_faces) = (Vec::with_capacity(COUNT), 0);
    for ports in fragments(COUNT) {
        let fragment = Fragment::from(&ports);
        let exact = environment.reflect::<Std, Careful>(&fragment);
        assert_eq!(environment.reflect::<Libm, Careful>(&fragment), exact, "{fragment:?}");
        let cheap = environment.reflect::<Micromath, Careful>(&fragment);
        if cheap.face == exact.face {
            errors.push((cheap.st - exact.st).abs().max_element());
        } else {
            other_faces += 1;
        }
    }
    errors.sort_by(f32::total_cmp);
    let (median, worst) = (errors[errors.len() / 2], errors[errors.len() - 1]);
    println!("micromath: s, t {median:.3}, at worst {worst:.3}, {other_faces} of {COUNT} on a different face");
    // A texel of this map is 2/256.
    assert!((4.0 / 256.0..0.1).contains(&median) && worst < 0.3, "{median}, {worst}");
    assert!(other_faces < COUNT / 20, "{other_faces}");
}

#[test]
fn degenerate_fragments_are_those_of_the_ports() {
    let vector = |x: f64, y: f64, z: f64| block_vector([x, y, z].into(), &PROFILE);
    let number = |x: f64| offset(x, &PROFILE);
    let zero = BlockVector::default();
    // A mirror facing +z, seen at 45 degrees.
    let plain = ReflectionIn {
        surface: SurfaceIn {
            normal: vector(0.0, 0.0, 1.0),
            view: vector(0.5, 0.25, 1.0),
            frame_vectors: [vector(0.0, 1.0, 0.0), zero],
            offset: [number(0.125), number(-0.0625)],
            roughness: [number(0.0625), number(0.03125), number(0.0625)],
        },
        dview: [vector(0.01, 0.0, 0.0), vector(0.0, 0.02, 0.0)],
        dnormal: [zero; 2],
        edge_texels: 256,
    };
    let flat = ReflectionIn {
        surface: SurfaceIn { offset: [number(0.0); 2], roughness: [number(0.0); 3], ..plain.surface },
        ..plain
    };
    for (what, ports, bits) in [
        ("nothing", plain, 0),
        ("n = 0", ReflectionIn { surface: SurfaceIn { normal: zero, ..plain.surface }, ..plain }, 0b0011_1101),
        ("v = 0", ReflectionIn { surface: SurfaceIn { view: zero, ..plain.surface }, ..plain }, 0b0011_1010),
        (
            "h along n",
            ReflectionIn {
                surface: SurfaceIn { frame_vectors: [plain.surface.normal, zero], ..plain.surface },
                ..plain
            },
            0b0000_0100,
        ),
        (
            "h = 0",
            ReflectionIn { surface: SurfaceIn { frame_vectors: [zero; 2], ..plain.surface }, ..plain },
            0b0000_0100,
        ),
        (
            "seen from below",
            ReflectionIn { surface: SurfaceIn { view: vector(0.5, 0.25, -1.0), ..flat.surface }, ..flat },
            0b0000_1000,
        ),
        (
            "a tie of x and z",
            ReflectionIn { surface: SurfaceIn { view: vector(1.0, 0.25, 1.0), ..flat.surface }, ..flat },
            0b0001_0000,
        ),
        ("no footprint", ReflectionIn { dview: [zero; 2], ..flat }, 0b0010_0000),
        (
            "wider than a face",
            ReflectionIn { dview: [vector(30.0, 0.0, 0.0), vector(0.0, 30.0, 0.0)], ..flat },
            0b0100_0000,
        ),
        ("a line", ReflectionIn { dview: [vector(0.01, 0.0, 0.0), zero], ..flat }, 0b1000_0000),
    ] {
        let integer = ports.reflect(&ReflectionPlan::FULL, &PROFILE);
        let float = Environment::new(256).reflect::<Std, Careful>(&Fragment::from(&ports));
        assert_eq!((float.status, integer.status), (bits, bits), "{what}: {float:?}");
        assert_eq!((float.face, float.probes), (u32::from(integer.face), u32::from(integer.probes)), "{what}");
        let difference = |x: f32, y: i32, fraction_bits: i32| f64::from(x) - f64::from(y) * 2_f64.powi(-fraction_bits);
        let [s, t] = integer.st.map(I2F30::to_bits);
        assert!(difference(float.st.x, s, 30).abs().max(difference(float.st.y, t, 30).abs()) < 1e-5, "{what}");
        assert!(difference(float.lod, integer.lod.to_bits(), 16).abs() < 1.0 / 128.0, "{what}");
    }
}
