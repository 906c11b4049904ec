//! Lights on peaks to test with: seeded random ones, and every hard case of peaks and horizons on a surface.

use std::ops::Range;

use fixed::types::{I2F30, I16F16};
use glam::{DVec3, dvec3};
use roughxel_core::bundle::Bundle;
use roughxel_core::each::{each, places};
use roughxel_core::plan::{FrameSystem, HorizonKind, PeakPlan};
use roughxel_core::ports::{BlockVector, PeakIn, PeakInput, Port, StoredHorizon, SurfaceIn};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{block_vector, stored_peak, stored_unit_peak};

use super::draws::{Elements, Kind, Rows, at, direction, set, unit, unit_or};
use super::fragment::{FRAGMENT, Fragments, SURFACE, bit};
use super::highlight::eye_and_light;
use super::peak_and_horizon::{HorizonCase, PeakCase, WHOLE, horizon_hard_sets, peak_hard_sets, uniform};
use super::set::CaseSet;
use roughxel_lanes::Columns;
use roughxel_scene::exp2::exp2;
use roughxel_scene::random::SplitMix64;

/// Every effect.
pub const FULL: PeakPlan = PeakPlan { frame: FrameSystem::MainDirection, horizon: HorizonKind::Correlated };

/// The weight of a peak in 2^−16 as its port.
fn weight(share: u32) -> I16F16 {
    I16F16::from_bits(share.cast_signed())
}

/// Peak `index` of the random set `set`: nine in ten are plausible (any attitude, exponents from 1 to 8192, a half vector
/// within a few widths of the peak, horizons from steps to ramps), one in ten has random bits at corner exponents. Depends on
/// the name and the index only.
pub fn random_lit_peak(set: &str, index: u64, p: &Precision) -> PeakIn {
    PeakIn::of(&Peaks::one(set, index, p))
}

/// The ports of those peaks of the random set `set`, as [`random_lit_peak`] makes them, in place of what `columns` held.
pub fn random_lit_peaks(set: &str, indices: Range<u64>, p: &Precision, columns: &mut Columns<PeakInput<i32>>) {
    Peaks::many(set, indices, p, columns);
}

/// Words of a light on a peak.
const PEAK: usize = <PeakInput<i32> as Bundle<i32>>::WORDS;

/// The kind of [`random_lit_peak`].
pub(super) enum Peaks {}

impl Kind<PEAK> for Peaks {
    type Ports = PeakInput<i32>;

    #[inline(always)]
    fn plausible<const N: usize>(elements: Elements<N>, p: &Precision, words: &mut [[i32; N]; PEAK]) {
        let draws = &mut elements.draws();
        draws.skip();
        let [mut normals, mut tangents] = draws.directions::<2, 6>();
        let exponents = draws.powers(0.0, 13.0);
        let [mut peaks, away] = draws.directions::<2, 6>();
        let far = draws.uniform(0.0, 2.0);
        let [mut eyes] = draws.directions::<1, 3>();
        let [means, sigmas] = each!(() in [(); 2] => each!(() in [(); 4] => draws.uniform(-1.0, 1.0)));
        let [normal_sizes, eye_sizes, light_sizes] = each!(() in [(); 3] => draws.powers(-6.0, 6.0));
        let amplitudes = draws.powers(-10.0, 5.0);
        let weights = draws.each(|random| random.below(u64::from(WHOLE) + 1) as i32);
        let mut lights = [[0.0; N]; 3];
        for lane in 0..N {
            let [normal, tangent] = each!(vectors in [&normals, &tangents] => unit(at(vectors, lane)));
            let e1 = unit_or(tangent.cross(normal), DVec3::ZERO);
            let e2 = normal.cross(e1);
            let peak = unit_or(at(&peaks, lane) + DVec3::Z, DVec3::Z);
            // A few widths √(2/n) away.
            let half = peak + at(&away, lane) * far[lane] * (2.0 / exponents[lane]).sqrt();
            let half = unit_or(e1 * half.x + e2 * half.y + normal * half.z, normal);
            let [eye, light] = eye_and_light(unit(at(&eyes, lane)), half);
            set(&mut normals, lane, normal * normal_sizes[lane]);
            set(&mut tangents, lane, tangent);
            set(&mut eyes, lane, eye * eye_sizes[lane]);
            set(&mut lights, lane, light * light_sizes[lane]);
            set(&mut peaks, lane, unit_or(peak / peak.abs().max_element(), DVec3::ZERO));
        }
        let mut words = Rows::new(words);
        for vectors in [normals, eyes, tangents] {
            words.put_vectors(&vectors, p);
        }
        words.put_zeros::<{ SURFACE - 12 }>();
        words.put_vectors(&lights, p);
        words.put(
            #[inline(always)]
            |lane| {
                let peak = stored_unit_peak(at(&peaks, lane), amplitudes[lane], exponents[lane]);
                let [x, y, z] = each!(n in peak.normal => n.to_bits().into());
                [x, y, z, peak.amplitude.into(), peak.exponent.into()]
            },
        );
        words.put::<8>(
            #[inline(always)]
            |lane| {
                // A quarter of the horizons are steps.
                let sigma = each!(side in places::<4>() => (sigmas[side][lane] + 0.5).max(0.0));
                let StoredHorizon { low, inverse_width } = uniform(each!(side in places() => means[side][lane]), sigma);
                let [l0, l1, l2, l3] = each!(low in low => low.to_bits().into());
                let [w0, w1, w2, w3] = each!(width in inverse_width => width.into());
                [l0, l1, l2, l3, w0, w1, w2, w3]
            },
        );
        words.put_row(&weights);
    }

    #[inline(always)]
    fn odd<const N: usize>(elements: Elements<N>, p: &Precision, words: &mut [[i32; N]; PEAK]) {
        let draws = &mut elements.draws();
        draws.skip();
        let mut fragment = [[0; N]; FRAGMENT];
        Fragments::odd(elements, p, &mut fragment);
        let mut words = Rows::new(words);
        for row in &fragment[..16] {
            words.put_row(row);
        }
        words.put_zeros::<{ SURFACE - 16 }>();
        // Light along the first derivative of the view.
        for row in &fragment[SURFACE..][..4] {
            words.put_row(row);
        }
        let signed = |random: &mut SplitMix64| i32::from(random.next_u64() as i16);
        let unsigned = |random: &mut SplitMix64| i32::from(random.next_u64() as u16);
        let mut put = |bits: [i32; N]| words.put_row(&bits);
        (0..3).for_each(|_| put(draws.each(signed)));
        (0..2).for_each(|_| put(draws.each(unsigned)));
        (0..4).for_each(|_| put(draws.each(signed)));
        (0..4).for_each(|_| put(draws.each(unsigned)));
        put(draws.each(|random| random.next_u64() as i32));
    }
}

/// Light and eye in the upright frame, E₁ = x, E₂ = y, n = z, on a peak that is seen whole.
fn upright(light: BlockVector, view: BlockVector, p: &Precision) -> PeakIn {
    PeakIn {
        surface: SurfaceIn {
            normal: block_vector(DVec3::Z, p),
            view,
            frame_vectors: [block_vector(DVec3::Y, p), BlockVector::default()],
            ..SurfaceIn::default()
        },
        light,
        peak: stored_peak(dvec3(0.2, -0.1, 1.0), 0.6, 20.0),
        horizon: StoredHorizon::OPEN,
        weight: weight(WHOLE),
    }
}

/// Every hard case of a light on a peak.
pub fn lit_peak_sets(p: &Precision) -> Vec<CaseSet<PeakIn, PeakPlan>> {
    // Light and eye along the half vector give it exactly.
    let on_peaks = |case: PeakCase| {
        let half = case.half.direction;
        let mut peaks = case.peaks;
        peaks.dedup();
        peaks.into_iter().map(move |(peak, share)| PeakIn { peak, weight: weight(share), ..upright(half, half, p) })
    };
    let under_horizon = |case: HorizonCase| PeakIn { horizon: case.horizon, ..upright(case.light, case.eye, p) };
    let set = |name, description, cases| CaseSet { name, description, cases, plan: FULL };
    let mut sets = vec![set(
        "peak_light",
        "light at and around the horizon of n; n, v, l zero, tiny and huge; l = -v; h along n",
        lights(p),
    )];
    // Counts are of sums, and zero frames stand in `peak_light`.
    for of in peak_hard_sets(p).into_iter().filter(|of| !["peak_count", "local_zero"].contains(&of.name)) {
        sets.push(set(of.name, of.description, of.cases.into_iter().flat_map(on_peaks).collect()));
    }
    for of in horizon_hard_sets(p) {
        sets.push(set(of.name, of.description, of.cases.into_iter().map(under_horizon).collect()));
    }
    let ramps = horizon_hard_sets(p).into_iter().filter(|of| of.name == "horizon_at").flat_map(|of| of.cases);
    sets.push(CaseSet {
        name: "horizon_product",
        description: "slopes at and around steps and ramps, shares of light and eye multiplied (F92)",
        cases: ramps.map(under_horizon).collect(),
        plan: PeakPlan { horizon: HorizonKind::Product, ..FULL },
    });
    let natural = random_with(FrameSystem::Natural, p);
    sets.push(CaseSet {
        name: "peak_natural",
        description: "p_u, p_v of any length, skewed, equal, zero; no horizon",
        cases: natural,
        plan: PeakPlan { frame: FrameSystem::Natural, horizon: HorizonKind::None },
    });
    sets
}

/// Random peaks on p_u, p_v.
fn random_with(frame: FrameSystem, p: &Precision) -> Vec<PeakIn> {
    let name = format!("{frame:?}");
    let any = |index: u64| {
        let random = &mut SplitMix64::for_element(&name, index);
        let u = direction(random) * exp2(random.uniform(-6.0, 6.0));
        let v = match index % 8 {
            0 => u,
            1 => DVec3::ZERO,
            2 => u + direction(random) * exp2(random.uniform(-20.0, -6.0)),
            _ => direction(random) * exp2(random.uniform(-6.0, 6.0)),
        };
        PeakIn {
            surface: SurfaceIn {
                frame_vectors: [u, v].map(|tangent| block_vector(tangent, p)),
                ..random_lit_peak(&name, index, p).surface
            },
            ..random_lit_peak(&name, index, p)
        }
    };
    (0..200).map(any).collect()
}

fn lights(p: &Precision) -> Vec<PeakIn> {
    let mut peaks = Vec::new();
    let view = block_vector(dvec3(0.3, 0.2, 1.0), p);
    for run in [dvec3(1.0, 0.0, 0.0), dvec3(-0.4, 0.7, 0.0), dvec3(0.5, 0.5, 0.0)] {
        for rise in [1.0, 0.1, 0.001, 0.0, -0.001, -1.0] {
            let light = block_vector(run + DVec3::Z * rise, p);
            for step in [-1, 0, 1] {
                let mut light = light;
                light.mantissa[2] = I2F30::from_bits(light.mantissa[2].to_bits() + step * bit(p));
                peaks.push(upright(light, view, p));
            }
        }
    }
    let exact = upright(block_vector(dvec3(-0.3, 0.4, 0.8), p), view, p);
    let zero = BlockVector::default();
    let opposite = BlockVector { mantissa: view.mantissa.map(|m| -m), ..view };
    peaks.extend([
        PeakIn { surface: SurfaceIn { normal: zero, ..exact.surface }, ..exact },
        PeakIn { surface: SurfaceIn { view: zero, ..exact.surface }, ..exact },
        PeakIn { light: zero, ..exact },
        PeakIn { light: opposite, ..exact },
        PeakIn { light: view, ..exact },
        PeakIn { surface: SurfaceIn { frame_vectors: [exact.surface.normal; 2], ..exact.surface }, ..exact },
        PeakIn { surface: SurfaceIn { frame_vectors: [zero; 2], ..exact.surface }, ..exact },
        PeakIn { surface: SurfaceIn { normal: zero, view: zero, ..exact.surface }, light: zero, ..exact },
    ]);
    for exponent in [i16::MIN, -900, -40, 40, 900, i16::MAX] {
        let scaled = |vector: BlockVector| BlockVector { exponent, ..vector };
        peaks.extend([
            PeakIn { surface: SurfaceIn { normal: scaled(exact.surface.normal), ..exact.surface }, ..exact },
            PeakIn { surface: SurfaceIn { view: scaled(exact.surface.view), ..exact.surface }, ..exact },
            PeakIn { light: scaled(exact.light), ..exact },
            PeakIn {
                surface: SurfaceIn { frame_vectors: exact.surface.frame_vectors.map(scaled), ..exact.surface },
                ..exact
            },
        ]);
    }
    for share in [i32::MIN, -1, 0, 1, 0xffff, 0x1_0000, 0x1_0001, i32::MAX] {
        peaks.push(PeakIn { weight: I16F16::from_bits(share), ..exact });
    }
    peaks
}
