//! Whole datapaths side by side, from ports to ports with all that is looked at on the way: what vectors are made of.

use roughxel_core::datapath;
use roughxel_core::plan::{PeakPlan, ReflectionPlan, SurfacePlan};
use roughxel_core::ports::{HighlightInput, HighlightOutput, PeakInput, PeakOutput, ReflectionInput, ReflectionOutput};
use roughxel_core::precision::Precision;
use roughxel_core::soft_core;

use super::columns::Columns;
use super::reading::{Reading, each_fragment};

impl Reading {
    /// The reflection datapath of every fragment.
    pub fn fragments(
        self,
        fragments: &Columns<ReflectionInput<i32>>,
        plan: &ReflectionPlan,
        p: &Precision,
        outputs: &mut Columns<ReflectionOutput<i32>>,
    ) {
        each_fragment!(
            self, p, fragments, outputs,
            |fragment| datapath::fragment(fragment, plan, p),
            else soft_core::fragment(fragment, plan, p)
        );
    }

    /// The highlight datapath of every light on a surface.
    pub fn lit_surfaces(
        self,
        lights: &Columns<HighlightInput<i32>>,
        plan: &SurfacePlan,
        p: &Precision,
        outputs: &mut Columns<HighlightOutput<i32>>,
    ) {
        each_fragment!(
            self, p, lights, outputs,
            |light| datapath::leave_highlight(&datapath::lit_surface(light, plan, p)),
            else soft_core::highlight(light, plan, p)
        );
    }

    /// The peak datapath of every light on a peak.
    pub fn lit_peaks(
        self,
        lights: &Columns<PeakInput<i32>>,
        plan: &PeakPlan,
        p: &Precision,
        outputs: &mut Columns<PeakOutput<i32>>,
    ) {
        each_fragment!(
            self, p, lights, outputs,
            |light| datapath::lit_peak(light, plan, p),
            else soft_core::lit_peak(light, plan, p)
        );
    }
}
