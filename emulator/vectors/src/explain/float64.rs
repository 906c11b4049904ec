//! Values and decisions of the float64 reference for the inputs of a word, field by field.
//!
//! It is fed with exactly the datapath's inputs: the port values, exponents saturated as on entry. A field is left out if the
//! reference has no value for it: inputs, exponents of blocks and status; on the sphere columns, covariance, determinant,
//! direction, sweep, share and level. It is also left out if the value would be that of something different:
//! - values on a face, if the datapath chose a different face;
//! - the step, if the datapath has a different probe count or clamped λ₁;
//! - a highlight, if √m is not the root of m;
//! - the light of a peak, if the stored normal is not a unit vector, the exponent is above 8192 or the sum was saturated;
//! - everything that depends on derivatives or tangents whose exponents are more than 150 from those of v and n (system 1: from
//!   0), for determinants of such footprints leave the range of a float64.

use std::collections::HashMap;

use fixed::types::I2F30;
use roughxel_core::block::MAX_EXPONENT;
use roughxel_core::plan::{Effects, FootprintKind, FrameSystem, HorizonKind};
use roughxel_core::ports::{BlockPort, BlockVector, HighlightIn, PeakIn, ReflectionIn, SurfaceIn};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{RealPeak, real_horizon, real_offset, real_peak, real_vector};
use roughxel_core::status::StatusBit;
use roughxel_reference::frame::{Frame, frame};
use roughxel_reference::highlight::{Scene, half, highlight};
use roughxel_reference::horizon::{Side, correlated, product, ramp};
use roughxel_reference::linear::{Vector3, dot, norm, normalise_exponent, scale_exponent, scaled};
use roughxel_reference::peaks::{local_direction, peak};
use roughxel_reference::perturb::perturb;
use roughxel_reference::roughness::{isotropic_tangents, tangents};
use roughxel_reference::sphere::lobe;
use roughxel_reference::{Options, Roughness, reflection};
use roughxel_study::accuracy::{reference_inputs, reference_options};
use serde::Serialize;

use super::real::{Real, shown};

/// Largest difference of the exponents of inputs that the reference combines.
const SPREAD: i32 = 150;

/// Faces in their order.
const FACES: [&str; 6] = ["+x", "-x", "+y", "-y", "+z", "-z"];

/// A choice that decides what later stages work on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Decision {
    /// Subject of the decision.
    pub what: &'static str,
    /// The datapath's.
    pub taken: String,
    /// The reference's, if it has one.
    pub float64: Option<String>,
    /// Margin of the decision.
    pub note: String,
}

/// Values of the datapath, by the names of the fields.
pub(super) struct Taken<'a>(pub(super) &'a dyn Fn(&str) -> Option<i64>);

impl Taken<'_> {
    fn integer(&self, field: &str) -> Option<i64> {
        (self.0)(field)
    }

    fn raised(&self, bit: StatusBit) -> bool {
        self.integer("status").is_some_and(|status| status & i64::from(bit.mask()) != 0)
    }
}

/// Values of the reference.
#[derive(Default)]
pub(super) struct Float64 {
    /// Values by the names of the fields.
    values: HashMap<String, Real>,
    /// Real values of inputs that are codes, by the names of the fields.
    codes: HashMap<String, Real>,
    /// Decisions of the reference and the datapath.
    pub(super) decisions: Vec<Decision>,
}

impl Float64 {
    /// The value of a field.
    pub(super) fn value(&self, field: &str) -> Option<Real> {
        self.values.get(field).copied()
    }

    /// Value of a code.
    pub(super) fn code(&self, field: &str) -> Option<Real> {
        self.codes.get(field).copied()
    }

    fn set(&mut self, field: &str, value: f64, exponent: i32) {
        if value.is_finite() {
            self.values.insert(field.into(), Real::new(value, exponent));
        }
    }

    /// The components of a vector, times 2^`exponent`.
    fn vector(&mut self, name: &str, letters: &str, components: &[f64], exponent: i32) {
        for (letter, &component) in letters.chars().zip(components) {
            self.set(&format!("{name}_{letter}"), component, exponent);
        }
    }

    fn frame(&mut self, frame: &Frame, exponent: i32, taken: &Taken<'_>) {
        self.vector("frame_0", "xyz", &frame.e1, exponent);
        self.vector("frame_1", "xyz", &frame.e2, exponent);
        if taken.integer("frame_0_x").is_some() {
            let named = |pole: bool| if pole { "pole" } else { "no pole" };
            self.decide("frame", named(taken.raised(StatusBit::FramePole)), Some(named(frame.pole)), String::new());
        }
    }

    fn decide(&mut self, what: &'static str, taken: impl ToString, float64: Option<impl ToString>, note: String) {
        let (taken, float64) = (taken.to_string(), float64.map(|float64| float64.to_string()));
        self.decisions.push(Decision { what, taken, float64, note });
    }

    /// The side of the surface that a light is on.
    fn light_side(&mut self, facing: f64, taken: &Taken<'_>) {
        let named = |below: bool| if below { "below the surface" } else { "above the surface" };
        let note = format!("the cosine between n and l is {}", shown(facing));
        self.decide("light", named(taken.raised(StatusBit::LightBelowSurface)), Some(named(facing <= 0.0)), note);
    }
}

/// A port as entry reads it.
fn entered<const N: usize>(block: &BlockPort<N>) -> BlockPort<N> {
    let limit = MAX_EXPONENT as i16;
    BlockPort { exponent: block.exponent.clamp(-limit, limit), ..*block }
}

/// The mantissas alone: for vectors of which only the direction counts.
fn unscaled(block: &BlockVector) -> BlockVector {
    BlockVector { exponent: 0, ..*block }
}

fn direction(block: &BlockVector) -> Vector3 {
    real_vector(&unscaled(block)).to_array()
}

fn is_zero(block: &BlockVector) -> bool {
    block.mantissa == [I2F30::ZERO; 3]
}

/// Returns true if the exponents of two vectors are near enough for a float64.
fn near(block: &BlockVector, exponent: i16) -> bool {
    is_zero(block) || (i32::from(block.exponent) - i32::from(exponent)).abs() <= SPREAD
}

/// The surface as entry reads it. Tangent vectors whose lengths do not count become mantissas alone. `None` if their lengths
/// count and their squares leave the range of a float64.
fn entered_surface(surface: &SurfaceIn, system: FrameSystem) -> Option<SurfaceIn> {
    let frame_vectors = match system {
        FrameSystem::Natural => surface.frame_vectors.map(|vector| entered(&vector)),
        FrameSystem::MainDirection | FrameSystem::NaturalNormalised => surface.frame_vectors.map(|v| unscaled(&v)),
    };
    let (normal, view) = (entered(&surface.normal), entered(&surface.view));
    frame_vectors.iter().all(|vector| near(vector, 0)).then_some(SurfaceIn { normal, view, frame_vectors, ..*surface })
}

/// The surface of lights: everything in units of 2^`exponent`, the exponent of n.
struct Surface {
    normal: Vector3,
    exponent: i32,
    frame: Frame,
}

fn surface(ports: &SurfaceIn, options: &Options) -> Surface {
    let normal = direction(&ports.normal);
    let frame = frame(options.frame, normal, ports.frame_vectors.map(|vector| real_vector(&vector).to_array()));
    Surface { normal, exponent: ports.normal.exponent.into(), frame }
}

/// The reflection datapath.
pub(super) fn of_reflection(fragment: &ReflectionIn, effects: &Effects, p: &Precision, taken: &Taken<'_>) -> Float64 {
    let mut float64 = Float64::default();
    let Some(surface) = entered_surface(&fragment.surface, effects.frame) else { return float64 };
    let fragment = ReflectionIn {
        surface,
        dview: fragment.dview.map(|d| entered(&d)),
        dnormal: fragment.dnormal.map(|d| entered(&d)),
        ..*fragment
    };
    let (inputs, options) = (reference_inputs(&fragment), reference_options(&effects.reflection(), p));
    let out = reflection(&inputs, &options);
    let [normal, view] = [surface.normal.exponent, surface.view.exponent].map(i32::from);
    float64.frame(&out.frame, normal, taken);
    float64.vector("normal_mod", "xyz", &out.perturbed, normal);
    float64.vector("reflected", "xyz", &out.reflected, 2 * normal + view);

    let face = out.selection.face as i64;
    let of_taken = taken.integer("face").and_then(|face| FACES.get(usize::try_from(face).ok()?));
    let note = format!("|r| is {} of itself from a tie of two faces", shown(out.tie_margin));
    float64.decide("face", of_taken.unwrap_or(&"none"), Some(FACES[out.selection.face]), note);
    float64.set("face", face as f64, 0);
    if taken.integer("face") != Some(face) {
        return float64;
    }
    float64.vector("st", "st", &[out.selection.s, out.selection.t], 0);
    let derivatives_near = fragment.dview.iter().all(|d| near(d, surface.view.exponent))
        && fragment.dnormal.iter().all(|d| near(d, surface.normal.exponent));
    if !derivatives_near {
        return float64;
    }
    match effects.footprint {
        FootprintKind::None => {}
        FootprintKind::Face => {
            for (index, column) in out.columns.iter().enumerate() {
                float64.vector(&format!("columns_{index}"), "st", &column.q, 0);
            }
            float64.vector("covariance", "abc", &[out.ellipse.a, out.ellipse.b, out.ellipse.c], 0);
            float64.set("determinant_m", out.ellipse.det, 0);
            float64.set("major_m", out.axes.major, 0);
            float64.set("minor_m", out.axes.minor, 0);
            float64.vector("direction", "st", &out.axes.direction, 0);
            float64.set("lod", out.probes.lod, 0);
            let terms = if out.axes.major == 0.0 { 1.0 } else { out.footprint_scale() / out.axes.major };
            let note = format!("its terms are {} times λ₁ before they cancel", shown(terms));
            let named = |is_zero: bool| if is_zero { "empty" } else { "an ellipse" };
            let zero = taken.raised(StatusBit::FootprintZero);
            float64.decide("footprint", named(zero), Some(named(out.axes.major == 0.0)), note);
            float64.probes(out.probes.count, out.axes.ratio(), Some(out.probes.capped), taken, p);
            let same_count = taken.integer("probes") == Some(out.probes.count.into());
            if same_count && !taken.raised(StatusBit::FootprintSaturated) {
                float64.vector("step", "st", &out.probes.step, 0);
            }
        }
        FootprintKind::Sphere => {
            if let Some(lobe) = lobe(&inputs, &options) {
                float64.set("major_m", lobe.major, 0);
                float64.set("minor_m", lobe.minor, 0);
                let ratio = if lobe.major == 0.0 { 1.0 } else { lobe.major / lobe.minor };
                float64.probes(lobe.probes.len() as u32, ratio, None, taken, p);
            }
        }
    }
    float64
}

/// The highlight datapath.
pub(super) fn of_highlight(light: &HighlightIn, effects: &Effects, p: &Precision, taken: &Taken<'_>) -> Float64 {
    let mut float64 = Float64::default();
    let Some(ports) = entered_surface(&light.surface, effects.frame) else { return float64 };
    let options = reference_options(&effects.reflection(), p);
    let Surface { normal, exponent, frame } = surface(&ports, &options);
    let offset = if effects.bump { ports.offset.map(real_offset) } else { [0.0; 2] };
    let roughness = ports.roughness.map(real_offset);
    let normal_mod = perturb(normal, &frame, offset);
    let rough = match options.roughness {
        Roughness::None => [[0.0; 3]; 2],
        Roughness::Isotropic => isotropic_tangents(&frame, roughness[0]),
        Roughness::Anisotropic => tangents(&frame, roughness),
    };
    float64.frame(&frame, exponent, taken);
    float64.vector("normal_mod", "xyz", &normal_mod, exponent);

    let [m, root]: [f64; 2] = [light.shininess.exponent.to_num(), light.shininess.root.to_num()];
    let (m, root) = (m.clamp(1.0, 8192.0), root.clamp(1.0, 91.0));
    let length = norm(&normal_mod);
    for (index, tangent) in (1..).zip(rough) {
        float64.vector(&format!("rough_{index}"), "xyz", &tangent, exponent);
        if length > 0.0 {
            float64.vector(&format!("spread_{index}"), "xyz", &scaled(root / length, tangent), 0);
        }
    }
    let [view, to_light] = [direction(&ports.view), direction(&light.light)];
    let scene = Scene { normal, normal_mod, tangents: rough, view, light: to_light, exponent: m };
    let lit = highlight(&scene);
    float64.vector("half", "xyz", &lit.half, 0);
    float64.light_side(lit.facing, taken);
    let along = dot(&normal_mod, &lit.half);
    let named = |below: bool| if below { "behind the surface" } else { "before the surface" };
    let of_taken = named(taken.raised(StatusBit::HalfBelowSurface));
    float64.decide("half vector", of_taken, Some(named(along <= 0.0)), String::new());
    // The reference knows m alone; a root rounded to its 24 fraction bits is that of m.
    if (root - m.sqrt()).abs() <= ROOT_SLACK {
        float64.set("f", lit.f, 0);
        if length > 0.0 {
            // Along n_mod a highlight has its amplitude.
            let along = Scene { normal: normal_mod, view: normal_mod, light: normal_mod, ..scene };
            float64.set("amplitude_m", highlight(&along).f, 0);
        }
    }
    float64
}

/// Two last places of the port of √m.
const ROOT_SLACK: f64 = 2.0 / (1 << 24) as f64;

/// Largest deviation from 1 of the length of a stored normal that was stored as one of unit length.
const STORED_LENGTH: f64 = 1.0 / (1 << 14) as f64;

/// The peak datapath.
pub(super) fn of_peak(light: &PeakIn, effects: &Effects, p: &Precision, taken: &Taken<'_>) -> Float64 {
    let mut float64 = Float64::default();
    let RealPeak { normal: stored, amplitude, exponent } = real_peak(&light.peak);
    let (low, inverse_width) = real_horizon(&light.horizon);
    float64.codes.insert("peak_amplitude".into(), Real::new(amplitude, 0));
    float64.codes.insert("peak_exponent".into(), Real::new(exponent, 0));
    for (side, inverse) in inverse_width.iter().enumerate() {
        let inverse = Real::new(inverse.unwrap_or(0.0), 0);
        float64.codes.insert(format!("horizon_inverse_width_{side}"), inverse);
    }

    let Some(ports) = entered_surface(&light.surface, effects.frame) else { return float64 };
    let surface = surface(&ports, &reference_options(&effects.reflection(), p));
    let Surface { normal, frame, .. } = surface;
    float64.frame(&frame, surface.exponent, taken);
    let [view, to_light] = [direction(&ports.view), direction(&light.light)];
    let half = half(to_light, view);
    float64.vector("half", "xyz", &half, 0);
    // Zero if the half vector or the tangent basis is zero: the datapath documents this, and the reference has no direction.
    let local_half = local_direction(half, [frame.e1, frame.e2], normal).unwrap_or_default();
    float64.vector("local_half", "xyz", &local_half, 0);

    // Along the tangent basis in units of the mantissas of n, as in the datapath.
    let (mantissas, unit) = normalise_exponent(normal);
    // Mantissas fill two's complement: a largest component of −½ has the mantissa −1.
    let unit = if mantissas.iter().all(|m| (-0.5..0.5).contains(m)) { unit - 1 } else { unit };
    let axes = [frame.e1, frame.e2, normal].map(|axis| scale_exponent(axis, -unit));
    let has_frame = frame.e1 != [0.0; 3] && frame.e2 != [0.0; 3];
    let along = |d: Vector3| if has_frame { axes.map(|axis| dot(&axis, &d)) } else { [0.0; 3] };
    let locals = [along(to_light), along(view)];
    let exponents = [entered(&light.light).exponent, ports.view.exponent].map(i32::from);
    for ((name, local), exponent) in ["local_light", "local_eye"].into_iter().zip(&locals).zip(exponents) {
        float64.vector(name, "xyz", local, exponent);
    }
    let facing = locals[0][2] / (norm(&axes[2]) * norm(&to_light));
    float64.light_side(if facing.is_nan() { 0.0 } else { facing }, taken);

    let sides = [0, 1, 2, 3]
        .map(|side: usize| Side { low: low[side], width: inverse_width[side].map_or(0.0, |inverse| 1.0 / inverse) });
    let mut ramps = Vec::with_capacity(4);
    for (index, [x, y, z]) in locals.into_iter().enumerate() {
        for (axis, run) in [x, y].into_iter().enumerate() {
            if run == 0.0 {
                ramps.push(1.0);
                continue;
            }
            let slope = (z / run.abs()).clamp(-8.0, 8.0);
            float64.set(&format!("slopes_{index}_{axis}"), slope, 0);
            ramps.push(ramp(slope, sides[2 * axis + usize::from(run > 0.0)]));
        }
    }
    let visibility = match effects.horizon {
        HorizonKind::None => 1.0,
        HorizonKind::Correlated => correlated(&ramps),
        HorizonKind::Product => product(&ramps),
    };
    float64.set("visibility", visibility, 0);
    let is_stored = (norm(&stored.to_array()) - 1.0).abs() < STORED_LENGTH && exponent <= 8192.0;
    if is_stored && !taken.raised(StatusBit::PeaksSaturated) {
        let lit = if facing > 0.0 { 1.0 } else { 0.0 };
        let share = light.weight.to_num::<f64>().clamp(0.0, 1.0) * visibility * lit;
        float64.set("peak", share * peak(local_half, stored.to_array(), amplitude, exponent), 0);
    }
    float64
}

impl Float64 {
    /// `capped`: tells whether the reference wants more probes than allowed, if it knows.
    fn probes(&mut self, count: u32, ratio: f64, capped: Option<bool>, taken: &Taken<'_>, p: &Precision) {
        let Some(of_taken) = taken.integer("probes") else { return };
        let named = |count: i64, capped: bool| format!("{count}{}", if capped { ", capped" } else { "" });
        let note = format!("λ₁/λ₂ is {}, a footprint has {} at most", shown(ratio), p.max_probes);
        let of_taken = named(of_taken, taken.raised(StatusBit::ProbesCapped));
        self.decide("probes", of_taken, Some(named(count.into(), capped.unwrap_or(false))), note);
        self.set("probes", count.into(), 0);
    }
}
