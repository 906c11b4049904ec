//! Footprints of reflections: whose they are is what a frame can be asked.

use roughxel_reference::cube::Selection;
use roughxel_reference::linear::scaled;
use roughxel_reference::probes::ProbePlan;
use roughxel_reference::sphere::{LobeProbe, lobe};
use roughxel_reference::{Inputs, Options, reflection};

/// λ₁ of a footprint on a cube face beyond which its probes do not reach further out (2 units, the width of the face).
const LONGEST_SIGMA: f64 = 2.0;

/// What a filter reads of an environment for one fragment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Centre.
    pub centre: Selection,
    /// Number of probes, 1 to the most of the profile.
    pub count: u32,
    /// From one probe to the next, half faces.
    pub step: [f64; 2],
    /// Level of detail, 0 to the last level.
    pub lod: f64,
}

impl Footprint {
    /// Probes on a face around `centre`; the step of one whose λ₁ is `sigma` is cut as in the datapath.
    pub(crate) fn new(centre: Selection, plan: &ProbePlan, sigma: f64) -> Self {
        let reach = if sigma > LONGEST_SIGMA { LONGEST_SIGMA / sigma } else { 1.0 };
        Self { centre, count: plan.count, step: scaled(reach, plan.step), lod: plan.lod }
    }
}

/// A reflection datapath: whose footprints a frame has.
pub trait Footprints: Sync {
    /// The footprint of one fragment; `None` where it comes to no number, and the reflection is black.
    fn footprint(&self, inputs: &Inputs, options: &Options) -> Option<Footprint>;

    /// The probes of one fragment on the sphere; of whoever has none of his own the reference's.
    fn lobe(&self, inputs: &Inputs, options: &Options) -> Option<Vec<LobeProbe>> {
        lobe(inputs, options).map(|lobe| lobe.probes)
    }
}

/// The reference.
#[derive(Clone, Copy, Debug)]
pub struct Float64;

impl Footprints for Float64 {
    fn footprint(&self, inputs: &Inputs, options: &Options) -> Option<Footprint> {
        let outputs = reflection(inputs, options);
        Some(Footprint::new(outputs.selection, &outputs.probes, outputs.axes.major))
    }
}
