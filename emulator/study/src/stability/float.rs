//! Floating point as a method: formulas on a library, and its footprints in a frame.

use glam::{DVec3, Vec2, Vec3};
use roughxel_f32_baseline::formulas::{Careful, Frame, Plain};
use roughxel_f32_baseline::math::{Micromath, Std};
use roughxel_f32_baseline::peak::LitPeak;
use roughxel_f32_baseline::{Environment, FloatFootprint, Fragment};
use roughxel_reference::cube::Selection;
use roughxel_reference::frame::{self, FrameSystem};
use roughxel_reference::linear::{Vector3, normalise_exponent, scale_exponent};
use roughxel_reference::{Inputs, Options, Roughness};
use roughxel_reference_renderer as reference_renderer;

/// The datapath in `f32`. Its footprints of a frame use the probe rule and the largest probe count of `standard`, whatever the
/// profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Float {
    /// The formulas as printed, on the standard library.
    Plain,
    /// Formulas that do not cancel.
    Careful,
    /// The careful formulas on `micromath`.
    Micromath,
}

impl Float {
    /// Every method.
    pub const ALL: [Self; 3] = [Self::Plain, Self::Careful, Self::Micromath];

    /// Its name in curves and pages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Plain => "float32 plain",
            Self::Careful => "float32 careful",
            Self::Micromath => "micromath",
        }
    }

    /// Reflects one fragment.
    pub(super) fn reflect(self, environment: &Environment, fragment: &Fragment) -> FloatFootprint {
        match self {
            Self::Plain => environment.reflect::<Std, Plain>(fragment),
            Self::Careful => environment.reflect::<Std, Careful>(fragment),
            Self::Micromath => environment.reflect::<Micromath, Careful>(fragment),
        }
    }

    fn reflect_on(self, environment: &Environment, fragment: &Fragment, frame: Frame) -> FloatFootprint {
        match self {
            Self::Plain => environment.reflect_on::<Std, Plain>(fragment, frame),
            Self::Careful => environment.reflect_on::<Std, Careful>(fragment, frame),
            Self::Micromath => environment.reflect_on::<Micromath, Careful>(fragment, frame),
        }
    }

    /// Light of one light on one peak.
    pub(super) fn shine(self, peak: &LitPeak) -> f32 {
        match self {
            Self::Plain => peak.shine::<Std, Plain>(),
            Self::Careful => peak.shine::<Std, Careful>(),
            Self::Micromath => peak.shine::<Micromath, Careful>(),
        }
    }
}

/// The point of a footprint; `None` if it is not a number or has no probe.
pub(super) fn place(footprint: &FloatFootprint) -> Option<Selection> {
    let FloatFootprint { face, st, probes, step, lod, .. } = *footprint;
    let finite = st.is_finite() && step.is_finite() && lod.is_finite() && probes > 0;
    finite.then(|| Selection { face: face as usize, s: st.x.into(), t: st.y.into(), m: 1.0 })
}

fn single(v: Vector3) -> Vec3 {
    DVec3::from_array(v).as_vec3()
}

/// Units give n and v exponent 0, which leaves the range of `f32` to the footprint. The tangent basis of systems 1 and 2, which
/// `f32` does not have, is that of the reference.
impl reference_renderer::Footprints for Float {
    fn footprint(&self, inputs: &Inputs, options: &Options) -> Option<reference_renderer::ProbeRow> {
        let (normal, normal_exponent) = normalise_exponent(inputs.normal);
        let (view, view_exponent) = normalise_exponent(inputs.view);
        let (main_direction, _) = normalise_exponent(inputs.tangents[0]);
        let [d1, d2, d3] = match options.roughness {
            Roughness::None => [0.0; 3],
            Roughness::Isotropic => [inputs.roughness[0], 0.0, inputs.roughness[0]],
            Roughness::Anisotropic => inputs.roughness,
        };
        let fragment = Fragment {
            normal: single(normal),
            view: single(view),
            main_direction: single(main_direction),
            offset: Vec2::from_array(inputs.offset.map(|b| b as f32)),
            roughness: single([d1, d2, d3]),
            dview: inputs.dview.map(|d| single(scale_exponent(d, -view_exponent))),
            dnormal: inputs.dnormal.map(|d| single(scale_exponent(d, -normal_exponent))),
        };
        let environment = Environment::new(inputs.edge_texels);
        // A surface without bumps has no tangent basis that could fail.
        let smooth = fragment.offset == Vec2::ZERO && fragment.roughness == Vec3::ZERO;
        let footprint = if options.frame == FrameSystem::MainDirection && !smooth {
            self.reflect(&environment, &fragment)
        } else {
            let found = frame::frame(options.frame, normal, inputs.tangents);
            let frame = Frame { e1: single(found.e1), e2: single(found.e2), pole: found.pole };
            self.reflect_on(&environment, &fragment, frame)
        };
        Some(reference_renderer::ProbeRow {
            centre: place(&footprint)?,
            count: footprint.probes,
            step: footprint.step.to_array().map(f64::from),
            lod: footprint.lod.into(),
        })
    }
}
