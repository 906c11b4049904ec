//! Samples of the reflection: the whole datapath against the reference.

use roughxel_core::plan::ReflectionPlan;
use roughxel_core::ports::ReflectionIn;
use roughxel_core::precision::Precision;
use roughxel_core::setup::real_number;
use roughxel_f32_baseline::{Environment, FloatFootprint, Fragment};
use roughxel_reference::cube::{Selection, project};
use roughxel_reference::linear::axis_angle;
use roughxel_reference::{Inputs, Outputs, reflection};
use roughxel_utilities::random::SplitMix64;

use super::float::place;
use super::method::{Method, Sample};
use crate::accuracy::{Figure, reference_inputs, reference_options};

/// Diameter of a footprint of standard deviation 1, 2√3.
const DIAMETER: f64 = 3.464_101_615_137_754_6;

/// Fragments on the way to a degeneracy of the reflection.
pub(super) struct Reflection {
    /// The fragment of a distance.
    pub(super) fragment: fn(f64, &mut SplitMix64, &Precision) -> ReflectionIn,
    /// Figure that is judged.
    pub(super) figure: Figure,
    /// Returns true if the documented fallback holds.
    pub(super) fallback: fn(&Outputs, &Precision) -> bool,
}

/// Outputs of a method for a fragment, as far as figures use them.
struct Seen {
    place: Selection,
    major: f64,
    direction: [f64; 2],
    lod: f64,
}

impl Reflection {
    pub(super) fn sample(&self, method: Method, distance: f64, random: &mut SplitMix64) -> Sample {
        let p = &method.precision();
        let ports = &(self.fragment)(distance, random, p);
        let plan = &ReflectionPlan::FULL;
        let (inputs, seen) = match method {
            Method::Profile(_) => (reference_inputs(ports), Some(by_integers(ports, plan, p))),
            Method::Float(float) => {
                let fragment = Fragment::from(ports);
                let footprint = float.reflect(&Environment::new(ports.edge_texels.into()), &fragment);
                (inputs_of(&fragment, ports.edge_texels), by_float(&footprint))
            }
        };
        let want = reflection(&inputs, &reference_options(plan, p));
        let largest = match self.figure {
            Figure::Coordinates => 2.0,
            Figure::LevelOfDetail => f64::from(inputs.edge_texels.ilog2()),
            Figure::Direction => 90.0,
            Figure::MajorAxis | Figure::Frame | Figure::Reflected => 1.0,
        };
        let error = seen.map_or(largest, |seen| self.error(&seen, &want));
        Sample { error: if error.is_nan() { largest } else { error.min(largest) }, fallback: (self.fallback)(&want, p) }
    }

    /// Error of a figure. Coordinates are judged on the face that the method chose, whatever the reference chose. Near a tie
    /// either face is right; away from it s and t are off by at least the distance to the tie.
    fn error(&self, seen: &Seen, want: &Outputs) -> f64 {
        match self.figure {
            Figure::Coordinates => {
                let want =
                    if want.selection.m == 0.0 { want.selection } else { project(seen.place.face, want.reflected) };
                if want.face != seen.place.face {
                    return f64::NAN;
                }
                (want.s - seen.place.s).abs().max((want.t - seen.place.t).abs())
            }
            Figure::MajorAxis if want.axes.major == seen.major => 0.0,
            Figure::MajorAxis => (seen.major - want.axes.major).abs() / want.axes.major,
            Figure::LevelOfDetail => (seen.lod - want.probes.lod).abs(),
            Figure::Direction if want.axes.ratio() < 1.1 => 0.0,
            Figure::Direction => axis_angle(seen.direction, want.axes.direction).to_degrees(),
            Figure::Frame | Figure::Reflected => f64::NAN,
        }
    }
}

fn by_integers(ports: &ReflectionIn, plan: &ReflectionPlan, p: &Precision) -> Seen {
    let out = ports.reflect(plan, p);
    let [s, t] = out.st.map(|x| x.to_num::<f64>());
    Seen {
        place: Selection { face: out.face.into(), s, t, m: 1.0 },
        major: real_number(&out.major),
        direction: out.direction.map(|x| x.to_num::<f64>()),
        lod: out.lod.to_num(),
    }
}

fn by_float(footprint: &FloatFootprint) -> Option<Seen> {
    let place = place(footprint)?;
    let step = footprint.step.as_dvec2();
    Some(Seen {
        place,
        major: step.length() * f64::from(footprint.probes) / DIAMETER,
        direction: step.to_array(),
        lod: footprint.lod.into(),
    })
}

/// Inputs of `f32` in the form that the reference takes.
fn inputs_of(fragment: &Fragment, edge_texels: u16) -> Inputs {
    let vector = |v: glam::Vec3| v.as_dvec3().to_array();
    Inputs {
        normal: vector(fragment.normal),
        view: vector(fragment.view),
        tangents: [vector(fragment.main_direction), [0.0; 3]],
        offset: fragment.offset.as_dvec2().to_array(),
        roughness: vector(fragment.roughness),
        dview: fragment.dview.map(vector),
        dnormal: fragment.dnormal.map(vector),
        edge_texels: edge_texels.into(),
    }
}
