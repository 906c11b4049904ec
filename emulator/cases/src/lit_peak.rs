//! Lights on peaks to test with: seeded random ones, and every hard case of peaks and horizons on a surface.

use fixed::types::{I1F15, I2F30, I4F12, I16F16};
use glam::{DVec3, dvec3};
use roughxel_core::plan::{FrameSystem, HorizonKind, PeakPlan};
use roughxel_core::ports::{BlockVector, PeakIn, StoredHorizon, StoredPeak, SurfaceIn};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{block_vector, stored_peak};

use super::fragment::{bit, direction, random_fragment};
use super::peak_and_horizon::{HorizonCase, PeakCase, WHOLE, horizon_hard_sets, peak_hard_sets, uniform};
use super::set::CaseSet;
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
    let random = &mut SplitMix64::for_element(set, index);
    if random.below(10) == 0 {
        let fragment = random_fragment(set, index, p);
        let mut bits = || random.next_u64();
        return PeakIn {
            surface: SurfaceIn { offset: Default::default(), roughness: Default::default(), ..fragment.surface },
            light: fragment.dview[0],
            peak: StoredPeak {
                normal: [(); 3].map(|()| I1F15::from_bits(bits() as i16)),
                amplitude: bits() as u16,
                exponent: bits() as u16,
            },
            horizon: StoredHorizon {
                low: [(); 4].map(|()| I4F12::from_bits(bits() as i16)),
                inverse_width: [(); 4].map(|()| bits() as u16),
            },
            weight: I16F16::from_bits(bits() as i32),
        };
    }
    let [normal, tangent] = [(); 2].map(|()| direction(random).normalize());
    let e1 = tangent.cross(normal).normalize_or_zero();
    let e2 = normal.cross(e1);
    let exponent = random.uniform(0.0, 13.0).exp2();
    let peak = (direction(random) + DVec3::Z).normalize_or(DVec3::Z);
    // A few widths √(2/n) away.
    let half = peak + direction(random) * random.uniform(0.0, 2.0) * (2.0 / exponent).sqrt();
    let half = (e1 * half.x + e2 * half.y + normal * half.z).normalize_or(normal);
    // An eye on the side of the half vector, and the light opposite.
    let eye = direction(random).normalize();
    let eye = if eye.dot(half) < 0.0 { -eye } else { eye };
    let light = 2.0 * eye.dot(half) * half - eye;
    let [mean, sigma] = [(); 2].map(|()| [(); 4].map(|()| random.uniform(-1.0, 1.0)));
    // A quarter of the horizons are steps.
    let horizon = uniform(mean, sigma.map(|sigma: f64| (sigma + 0.5).max(0.0)));
    let mut sized = |vector: DVec3| block_vector(vector * random.uniform(-6.0, 6.0).exp2(), p);
    let (normal, view, light) = (sized(normal), sized(eye), sized(light));
    PeakIn {
        surface: SurfaceIn {
            normal,
            view,
            frame_vectors: [block_vector(tangent, p), BlockVector::default()],
            ..SurfaceIn::default()
        },
        light,
        peak: stored_peak(peak, random.uniform(-10.0, 5.0).exp2(), exponent),
        horizon,
        weight: weight(random.below(u64::from(WHOLE) + 1) as u32),
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
        let u = direction(random) * random.uniform(-6.0, 6.0).exp2();
        let v = match index % 8 {
            0 => u,
            1 => DVec3::ZERO,
            2 => u + direction(random) * random.uniform(-20.0, -6.0).exp2(),
            _ => direction(random) * random.uniform(-6.0, 6.0).exp2(),
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
