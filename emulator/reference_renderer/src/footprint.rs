//! Footprints of reflections, with the source of the footprints as a parameter of a frame.

use roughxel_reference::cube::Selection;
use roughxel_reference::linear::scaled;
use roughxel_reference::probes::ProbePlan;
use roughxel_reference::sphere::{LobeProbe, lobe};
use roughxel_reference::{Inputs, Options, reflection};

/// λ₁ of a footprint on a cube face beyond which its probes reach no further out (2 units, the width of the face).
const LONGEST_SIGMA: f64 = 2.0;

/// The data that a filter reads for one fragment of an environment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbeRow {
    /// Centre.
    pub centre: Selection,
    /// Probe count, 1 to the profile's largest.
    pub count: u32,
    /// Distance between neighbouring probes, half faces.
    pub step: [f64; 2],
    /// Level of detail, 0 to the last level.
    pub lod: f64,
}

impl ProbeRow {
    /// Probes on a face around `centre`. `sigma` is λ₁; the step is clamped as in the datapath.
    pub(crate) fn new(centre: Selection, plan: &ProbePlan, sigma: f64) -> Self {
        let reach = if sigma > LONGEST_SIGMA { LONGEST_SIGMA / sigma } else { 1.0 };
        Self { centre, count: plan.count, step: scaled(reach, plan.step), lod: plan.lod }
    }
}

/// A reflection datapath that gives a frame its footprints.
pub trait Footprints: Sync {
    /// The footprint of one fragment; `None` if it is not a number, and the reflection is black.
    fn footprint(&self, inputs: &Inputs, options: &Options) -> Option<ProbeRow>;

    /// The probes of one fragment on the sphere. The default is those of the reference.
    fn lobe(&self, inputs: &Inputs, options: &Options) -> Option<Vec<LobeProbe>> {
        lobe(inputs, options).map(|lobe| lobe.probes)
    }
}

/// The reference.
#[derive(Clone, Copy, Debug)]
pub struct Float64;

impl Footprints for Float64 {
    fn footprint(&self, inputs: &Inputs, options: &Options) -> Option<ProbeRow> {
        let outputs = reflection(inputs, options);
        Some(ProbeRow::new(outputs.selection, &outputs.probes, outputs.axes.major))
    }
}
