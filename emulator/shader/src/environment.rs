//! Colours of an environment at fragments, blended with the fragments' own colours.

use roughxel_core::bundle::Value;
use roughxel_core::datapath::{LobeLaw, pixel};
use roughxel_core::design::{Form, In};
use roughxel_core::each::each;
use roughxel_core::fx::Control;
use roughxel_core::ports::REFLECTANCE;
use roughxel_core::precision::Precision;
use roughxel_core::sampler::{self, Cube, EnvironmentSample};
use roughxel_core::signals::{CubePoint, Sweep};
use roughxel_simd::BatchWord;

use crate::batch::Batch;
use crate::order::Order;
use crate::pass::{Group, Pass, Shader, runs};
use crate::signals::{FaceFootprint, ShadedColour};
use crate::texels::CubeTexels;

runs!(Lobes);

/// A lookup in an environment: a point, or a footprint around one.
pub trait EnvironmentLookup: Form {
    /// The colours that a group sees; a rough footprint reads finer levels.
    fn seen<W: BatchWord>(
        look: &In<Self, W>,
        is_rough: bool,
        cube: &Cube<'_, CubeTexels>,
        p: &Precision,
    ) -> EnvironmentSample<W>;
}

impl EnvironmentLookup for CubePoint<i32> {
    #[inline(always)]
    fn seen<W: BatchWord>(
        point: &CubePoint<W>,
        _: bool,
        cube: &Cube<'_, CubeTexels>,
        p: &Precision,
    ) -> EnvironmentSample<W> {
        sampler::point_means(point, cube, p)
    }
}

/// A footprint on the plane of a face.
impl EnvironmentLookup for FaceFootprint<i32> {
    #[inline(always)]
    fn seen<W: BatchWord>(
        footprint: &FaceFootprint<W>,
        is_rough: bool,
        cube: &Cube<'_, CubeTexels>,
        p: &Precision,
    ) -> EnvironmentSample<W> {
        sampler::means(&footprint.point, &footprint.probes, is_rough, cube, p)
    }
}

/// A footprint on the sphere.
impl EnvironmentLookup for Sweep<i32> {
    #[inline(always)]
    fn seen<W: BatchWord>(
        sweep: &Sweep<W>,
        is_rough: bool,
        cube: &Cube<'_, CubeTexels>,
        p: &Precision,
    ) -> EnvironmentSample<W> {
        sampler::swept_means(sweep, is_rough, cube, p)
    }
}

/// Colours of fragments, blended by their reflectance with the environment: seam, filter, blend.
#[derive(Clone, Copy, Debug)]
pub struct EnvironmentColours<'a, L> {
    /// The lookup of each fragment.
    pub looks: &'a Batch<L>,
    /// Data common to every kind of lookup.
    pub reflector: Reflector<'a>,
}

/// Fragments that reflect an environment.
#[derive(Clone, Copy, Debug)]
pub struct Reflector<'a> {
    /// The fragments' own colours.
    pub own: &'a Batch<ShadedColour<i32>>,
    /// The environment.
    pub map: &'a CubeTexels,
    /// True if the object is rough: its footprints read finer levels.
    pub is_rough: bool,
    /// The share of the environment in each channel.
    pub reflectance: &'a [Control<i32, REFLECTANCE>; 3],
}

impl<L: EnvironmentLookup> Pass for EnvironmentColours<'_, L> {
    type Output = ShadedColour<i32>;
    fn len(&self) -> usize {
        self.looks.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> ShadedColour<W> {
        let Reflector { own, map, is_rough, reflectance } = self.reflector;
        let cube = &map.cube();
        let seen = L::seen(&group.load(self.looks), is_rough, cube, p);
        let reflectance = each!(share in *reflectance => group.all(&Value(share)).0);
        let channels = sampler::blended::<W, _>(&group.load(own).channels, &seen, &reflectance, cube);
        ShadedColour { channels: each!(Value(channel) in channels => channel), samples: seen.samples }
    }
}

impl EnvironmentColours<'_, CubePoint<i32>> {
    /// Replaces `shown` by the colours of the fragments.
    pub fn run(&self, shader: Shader<'_>, shown: &mut Batch<ShadedColour<i32>>) {
        shader.run(self, shown);
    }
}

impl EnvironmentColours<'_, FaceFootprint<i32>> {
    /// Replaces `shown` by the colours of the fragments. Lanes are grouped by probe count if that saves iterations.
    pub fn run(
        &self,
        shader: Shader<'_>,
        ordered: &mut Ordered<FaceFootprint<i32>>,
        shown: &mut Batch<ShadedColour<i32>>,
    ) {
        ordered.run(self, self.looks.counts(), shader, shown);
    }
}

impl EnvironmentColours<'_, Sweep<i32>> {
    /// Replaces `shown` by the colours of the fragments. Lanes are grouped by probe count if that saves iterations.
    pub fn run(&self, shader: Shader<'_>, ordered: &mut Ordered<Sweep<i32>>, shown: &mut Batch<ShadedColour<i32>>) {
        ordered.run(self, self.looks.counts(), shader, shown);
    }
}

/// A batch in the order of its probe counts; the next batch reuses its memory.
#[derive(Clone, Debug)]
pub struct Ordered<L> {
    order: Order,
    looks: Batch<L>,
    own: Batch<ShadedColour<i32>>,
    shown: Batch<ShadedColour<i32>>,
}

impl<L> Default for Ordered<L> {
    fn default() -> Self {
        Self { order: Order::default(), looks: Batch::default(), own: Batch::default(), shown: Batch::default() }
    }
}

impl<L: EnvironmentLookup> Ordered<L> {
    /// Runs a pass on fragments with these probe counts.
    fn run(
        &mut self,
        pass: &EnvironmentColours<'_, L>,
        counts: &[i32],
        shader: Shader<'_>,
        all_shown: &mut Batch<ShadedColour<i32>>,
    ) {
        let Self { order, looks, own, shown } = self;
        let group = shader.backend.group(shader.precision);
        if group == 1 || !order.by(counts, group) {
            return shader.run(pass, all_shown);
        }
        pass.looks.reorder(order, looks);
        pass.reflector.own.reorder(order, own);
        shader.run(&EnvironmentColours { looks, reflector: Reflector { own, ..pass.reflector } }, shown);
        shown.restore(order, all_shown);
    }
}

/// The weighted mean of the colours of two lobes.
#[derive(Clone, Copy, Debug)]
pub struct Lobes<'a> {
    /// Colours of each lobe.
    pub colours: [&'a Batch<ShadedColour<i32>>; 2],
    /// Laws of the lobes.
    pub laws: &'a Batch<LobeLaw<i32>>,
}

impl Pass for Lobes<'_> {
    type Output = ShadedColour<i32>;
    fn len(&self) -> usize {
        self.laws.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, _: &Precision) -> ShadedColour<W> {
        let [a, b] = [group.load(self.colours[0]), group.load(self.colours[1])];
        let weight = group.load(self.laws).weight;
        let channels = each!(i in [0, 1, 2] => pixel::lobes::<W>([a.channels[i], b.channels[i]], weight));
        ShadedColour { channels, samples: a.samples + b.samples }
    }
}
