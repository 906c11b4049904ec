//! Whole datapaths from ports to ports, with the outcomes of all stages: vectors are made from them.

use roughxel_core::datapath;
use roughxel_core::plan::{PeakPlan, ReflectionPlan, SurfacePlan};
use roughxel_core::ports::{HighlightInput, HighlightOutput, PeakInput, PeakOutput, ReflectionInput, ReflectionOutput};
use roughxel_core::precision::Precision;
use roughxel_simd::BatchWord;

use crate::batch::Batch;
use crate::pass::{Group, Pass, runs};

runs!(Reflections LitSurfaces LitPeaks);

/// The reflection datapath.
#[derive(Clone, Copy, Debug)]
pub struct Reflections<'a> {
    /// Inputs of each fragment.
    pub inputs: &'a Batch<ReflectionInput<i32>>,
    /// Effects of the datapath.
    pub plan: &'a ReflectionPlan,
}

impl Pass for Reflections<'_> {
    type Output = ReflectionOutput<i32>;
    fn len(&self) -> usize {
        self.inputs.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> ReflectionOutput<W> {
        datapath::fragment(&group.load(self.inputs), self.plan, p)
    }
}

/// The highlight datapath.
#[derive(Clone, Copy, Debug)]
pub struct LitSurfaces<'a> {
    /// Inputs of each fragment.
    pub inputs: &'a Batch<HighlightInput<i32>>,
    /// Effects of the datapath.
    pub plan: &'a SurfacePlan,
}

impl Pass for LitSurfaces<'_> {
    type Output = HighlightOutput<i32>;
    fn len(&self) -> usize {
        self.inputs.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> HighlightOutput<W> {
        datapath::leave_highlight(&datapath::lit_surface(&group.load(self.inputs), self.plan, p))
    }
}

/// The peak datapath.
#[derive(Clone, Copy, Debug)]
pub struct LitPeaks<'a> {
    /// Inputs of each fragment.
    pub inputs: &'a Batch<PeakInput<i32>>,
    /// Effects of the datapath.
    pub plan: &'a PeakPlan,
}

impl Pass for LitPeaks<'_> {
    type Output = PeakOutput<i32>;
    fn len(&self) -> usize {
        self.inputs.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> PeakOutput<W> {
        datapath::lit_peak(&group.load(self.inputs), self.plan, p)
    }
}
