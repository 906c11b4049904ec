//! What fragments see of an environment, blended with their own colours.

use roughxel_core::bundle::Value;
use roughxel_core::datapath::pixel;
use roughxel_core::each::each;
use roughxel_core::fx::Control;
use roughxel_core::ports::REFLECTANCE;
use roughxel_core::precision::Precision;
use roughxel_core::sampler;
use roughxel_core::signals::{CubePoint, Sweep};
use roughxel_simd::BatchWord;

use crate::batch::Batch;
use crate::order::Order;
use crate::pass::{Group, Pass, Shader, runs};
use crate::signals::{Footprint, Shown};
use crate::texels::CubeTexels;

runs!(Lobes);

/// Places in an environment, with or without footprints.
#[derive(Clone, Copy, Debug)]
pub enum Look<'a> {
    /// Points without footprints.
    Point(&'a Batch<CubePoint<i32>>),
    /// Footprints on the planes of its faces.
    Face(&'a Batch<Footprint<i32>>),
    /// Footprints on the sphere.
    Sphere(&'a Batch<Sweep<i32>>),
}

/// Colours of fragments, blended by their reflectance with what they see of an environment: seam, filter, blend.
#[derive(Clone, Copy, Debug)]
pub struct EnvironmentColours<'a> {
    /// Places, with or without footprints.
    pub look: Look<'a>,
    /// Their own colours.
    pub own: &'a Batch<Shown<i32>>,
    /// The environment.
    pub map: &'a CubeTexels,
    /// The object is rough: its footprints look at finer levels.
    pub is_rough: bool,
    /// The share of the environment in each channel.
    pub reflectance: &'a [Control<i32, REFLECTANCE>; 3],
}

impl Pass for EnvironmentColours<'_> {
    type Output = Shown<i32>;
    fn len(&self) -> usize {
        self.own.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> Shown<W> {
        let cube = &self.map.cube();
        let seen = match self.look {
            Look::Point(points) => sampler::point_means(&group.of(points), cube, p),
            Look::Face(footprints) => {
                let footprint = group.of(footprints);
                sampler::means(&footprint.point, &footprint.probes, self.is_rough, cube, p)
            }
            Look::Sphere(sweeps) => sampler::swept_means(&group.of(sweeps), self.is_rough, cube, p),
        };
        let own = group.of(self.own);
        let reflectance = each!(share in *self.reflectance => group.all(&Value(share)).0);
        let channels = sampler::blended(&own.channels, &seen, &reflectance, cube);
        Shown { channels: each!(Value(channel) in channels => channel), taps: seen.taps }
    }
}

/// A batch in the order of its probe counts; its memory is kept for the next one.
#[derive(Clone, Debug, Default)]
pub struct ByCount {
    order: Order,
    footprints: Batch<Footprint<i32>>,
    sweeps: Batch<Sweep<i32>>,
    own: Batch<Shown<i32>>,
    shown: Batch<Shown<i32>>,
}

impl EnvironmentColours<'_> {
    /// Puts what fragments show into `shown`, in place of what it held. Groups of lanes are of like probe counts if that spares turns.
    pub fn run(&self, shader: Shader<'_>, by_count: &mut ByCount, shown: &mut Batch<Shown<i32>>) {
        let ByCount { order, footprints, sweeps, own, shown: ordered_shown } = by_count;
        let counts = match self.look {
            Look::Point(_) => &[],
            Look::Face(footprints) => footprints.counts(),
            Look::Sphere(sweeps) => sweeps.counts(),
        };
        let group = shader.backend.group(shader.precision);
        if group == 1 || !order.by(counts, group) {
            return shader.run(self, shown);
        }
        let look = match self.look {
            Look::Point(_) => self.look,
            Look::Face(all) => {
                all.reorder(order, footprints);
                Look::Face(footprints)
            }
            Look::Sphere(all) => {
                all.reorder(order, sweeps);
                Look::Sphere(sweeps)
            }
        };
        self.own.reorder(order, own);
        shader.run(&EnvironmentColours { look, own, ..*self }, ordered_shown);
        ordered_shown.restore(order, shown);
    }
}

/// The mean of what two lobes show.
#[derive(Clone, Copy, Debug)]
pub struct Lobes<'a>(pub [&'a Batch<Shown<i32>>; 2]);

impl Pass for Lobes<'_> {
    type Output = Shown<i32>;
    fn len(&self) -> usize {
        self.0[0].len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, _: &Precision) -> Shown<W> {
        let [a, b] = [group.of(self.0[0]), group.of(self.0[1])];
        let channels = each!(i in [0, 1, 2] => pixel::lobes::<W>(a.channels[i], b.channels[i]));
        Shown { channels, taps: a.taps + b.taps }
    }
}
