//! Samples of a light on a peak: the whole datapath against the reference.

use fixed::types::I16F16;
use glam::{DVec3, Vec3};
use roughxel_cases::direction;
use roughxel_core::plan::{FrameSystem, HorizonKind, PeakPlan};
use roughxel_core::ports::{BlockVector, PeakIn, StoredHorizon, SurfaceIn};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{RealPeak, block_vector, real_peak, real_vector, stored_peak};
use roughxel_f32_baseline::peak::LitPeak;
use roughxel_reference::{frame, highlight, peaks};
use roughxel_utilities::random::SplitMix64;

use super::method::{Method, Sample};

const PLAN: PeakPlan = PeakPlan { frame: FrameSystem::MainDirection, horizon: HorizonKind::None };

/// The error of the light of one peak whose half vector is `angle` away, as a share of its amplitude.
pub(super) fn sample(method: Method, angle: f64, random: &mut SplitMix64) -> Sample {
    let p = &method.precision();
    let ports = &lit_peak(angle, random, p);
    let RealPeak { normal: stored, amplitude, exponent } = real_peak(&ports.peak);
    let (seen, got) = match method {
        Method::Profile(_) => {
            let real = |v: &BlockVector| real_vector(v).to_array();
            let SurfaceIn { normal, view, frame_vectors: [main_direction, _], .. } = &ports.surface;
            let seen = [normal, view, main_direction, &ports.light].map(real);
            (seen, ports.shine(&PLAN, p).peak.to_num::<f64>())
        }
        Method::Float(float) => {
            let lit = LitPeak::from(ports);
            let real = |v: Vec3| v.as_dvec3().to_array();
            ([lit.normal, lit.view, lit.main_direction, lit.light].map(real), float.shine(&lit).into())
        }
    };
    let [normal, view, main_direction, light] = seen;
    let frame = frame::frame(frame::FrameSystem::MainDirection, normal, [main_direction, [0.0; 3]]);
    let local = peaks::local_direction(highlight::half(light, view), [frame.e1, frame.e2], normal).unwrap_or_default();
    let want = peaks::peak(local, stored.to_array(), amplitude, exponent);
    let error = (got - want).abs() / amplitude;
    Sample { error: if error.is_nan() { 1.0 } else { error.min(1.0) }, fallback: false }
}

/// A peak of exponent 64 to 8192, half of them 8192, on a surface of any attitude, as in [`crate::accuracy::lit_peak_bar`].
fn lit_peak(angle: f64, random: &mut SplitMix64, p: &Precision) -> PeakIn {
    let normal = direction(random).normalize();
    let e1 = direction(random).cross(normal).normalize();
    let e2 = normal.cross(e1);
    let exponent = if random.below(2) == 0 { 8192.0 } else { random.uniform(6.0, 13.0).exp2() };
    let peak = stored_peak(DVec3::Z + 0.6 * direction(random), 1.0, exponent);
    let unit = real_peak(&peak).normal.normalize();
    let side = unit.cross(direction(random)).normalize();
    let half = unit * angle.cos() + side * angle.sin();
    let half = e1 * half.x + e2 * half.y + normal * half.z;
    let eye = (half + 0.4 * direction(random)).normalize();
    let light = 2.0 * eye.dot(half) * half - eye;
    PeakIn {
        surface: SurfaceIn {
            normal: block_vector(normal, p),
            view: block_vector(eye, p),
            frame_vectors: [block_vector(e2, p), BlockVector::default()],
            ..SurfaceIn::default()
        },
        light: block_vector(light, p),
        peak,
        horizon: StoredHorizon::OPEN,
        weight: I16F16::ONE,
    }
}
