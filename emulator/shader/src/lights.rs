//! Lights on fragments: highlights, and the half vectors and slopes that peaks need.

use roughxel_core::bundle::{Value, never};
use roughxel_core::datapath::{self, Surface, pixel};
use roughxel_core::each::each;
use roughxel_core::fetch::Fetch;
use roughxel_core::fx::{Control, Fx};
use roughxel_core::plan::SurfacePlan;
use roughxel_core::ports::{LIGHT, PortBlock, ShininessPort};
use roughxel_core::precision::Precision;
use roughxel_core::signals::{LocalDirection, PeakSum};
use roughxel_core::word::Wire;
use roughxel_simd::BatchWord;

use crate::batch::Batch;
use crate::pass::{Group, Pass, runs};
use crate::peaks::PackedPeak;
use crate::signals::{ShadedColour, Slopes};

runs!(Highlights Halves HorizonSlopes GivenPeaks);

/// Colour of returned light.
#[inline(always)]
pub(crate) fn shown_of<W: BatchWord>(
    group: &Group<W>,
    returned: Control<W, LIGHT>,
    colour: &[Control<i32, LIGHT>; 3],
) -> ShadedColour<W> {
    let channels = each!(channel in *colour => pixel::modulated::<W>(returned, group.all(&Value(channel)).0));
    ShadedColour { channels, samples: Fx::zero() }
}

/// Surfaces, and the directions from them to a light.
#[derive(Clone, Copy, Debug)]
pub struct Lit<'a> {
    /// Surfaces.
    pub surfaces: &'a Batch<Surface<i32>>,
    /// Directions to the light.
    pub directions: &'a Batch<PortBlock<i32, 3>>,
}

/// Colours returned by a highlight: half, spread, highlight, pixel (modulated).
#[derive(Clone, Copy, Debug)]
pub struct Highlights<'a> {
    /// Surfaces and directions to the light.
    pub lit: Lit<'a>,
    /// The exponent of the material.
    pub shininess: &'a ShininessPort<i32>,
    /// Effects of the surface.
    pub plan: &'a SurfacePlan,
    /// The colour of the light times that of the highlight.
    pub colour: &'a [Control<i32, LIGHT>; 3],
}

impl Pass for Highlights<'_> {
    type Output = ShadedColour<i32>;
    fn len(&self) -> usize {
        self.lit.surfaces.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> ShadedColour<W> {
        let (surface, light) = (group.load(self.lit.surfaces), group.load(self.lit.directions));
        let gloss = datapath::gloss(&surface, &group.all(self.shininess), self.plan, p);
        shown_of(group, datapath::highlight(&surface, &gloss, &light, p).f, self.colour)
    }
}

/// Half vectors in the tangent bases of surfaces: half, local. A half vector is zero if the light is below the surface.
#[derive(Clone, Copy, Debug)]
pub struct Halves<'a>(pub Lit<'a>);

impl Pass for Halves<'_> {
    type Output = LocalDirection<i32>;
    fn len(&self) -> usize {
        self.0.surfaces.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> LocalDirection<W> {
        let lit = datapath::peak_light(&group.load(self.0.surfaces), &group.load(self.0.directions), p);
        LocalDirection { none: lit.direction.none | lit.side.below, ..lit.direction }
    }
}

/// Slopes of the light and of the eye, for comparison with horizons.
#[derive(Clone, Copy, Debug)]
pub struct HorizonSlopes<'a>(pub Lit<'a>);

impl Pass for HorizonSlopes<'_> {
    type Output = Slopes<i32>;
    fn len(&self) -> usize {
        self.0.surfaces.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> Slopes<W> {
        let (surface, light) = (group.load(self.0.surfaces), group.load(self.0.directions));
        let light = datapath::peak_light(&surface, &light, p).light;
        let eye = datapath::local_components(&surface.view, &surface.frame, &surface.normal, p);
        let [light, eye] = each!(local in [light, eye] => datapath::horizon_slopes(&local, p));
        Slopes { light, eye }
    }
}

/// Colours returned by a list of peaks: peaks, pixel (modulated).
#[derive(Clone, Copy, Debug)]
pub struct GivenPeaks<'a> {
    /// Half vectors.
    pub halves: &'a Batch<LocalDirection<i32>>,
    /// Peaks of the material.
    pub peaks: &'a [PackedPeak],
    /// The colour of the light times that of the peaks.
    pub colour: &'a [Control<i32, LIGHT>; 3],
}

impl Pass for GivenPeaks<'_> {
    type Output = ShadedColour<i32>;
    fn len(&self) -> usize {
        self.halves.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> ShadedColour<W> {
        shown_of(group, given(&group.load(self.halves), self.peaks, p), self.colour)
    }
}

/// Light of a list of peaks.
#[inline(always)]
fn given<W: Fetch>(half: &LocalDirection<W>, peaks: &[PackedPeak], p: &Precision) -> Control<W, LIGHT> {
    let mut sum = PeakSum::<W> { light: Fx::zero(), saturated: never::<W>() };
    for peak in peaks {
        let words = each!(word in peak.0 => Fx::from_raw(W::Count::lit(word.into())));
        sum = datapath::peak_sum(&sum, datapath::packed_peak(half, words, Fx::int(1), p));
    }
    sum.light
}
