//! Surface of every fragment, and the direction of its reflection.

use roughxel_core::datapath::{self, Framed, LobeLaw, Surface, texel};
use roughxel_core::each::each;
use roughxel_core::fx::Fx;
use roughxel_core::plan::{ReflectionPlan, SurfacePlan};
use roughxel_core::precision::Precision;
use roughxel_core::scalar_api;
use roughxel_core::signals::{CubePoint, MapScale, Sweep, WrappedFootprint};
use roughxel_core::stage::filter::LevelPair;
use roughxel_simd::BatchWord;

use crate::batch::Batch;
use crate::pass::{Group, Pass, Shader, runs};
use crate::signals::{Derivatives, FaceFootprint, FilteredBump, Ports, SurfaceAttributes, ports};

runs!(Surfaces LobeLaws LobeSurfaces Points Footprints Sweeps);

/// Surfaces with their bumps: enter, frame, perturb, roughness.
#[derive(Clone, Copy, Debug)]
pub struct Surfaces<'a> {
    bare: &'a Batch<SurfaceAttributes<i32>>,
    bumps: &'a Batch<FilteredBump<i32>>,
    plan: &'a SurfacePlan,
    /// Tangent basis that all of them share.
    framed: Option<Framed<i32>>,
}

impl<'a> Surfaces<'a> {
    /// Surfaces of these fragments; a tangent basis that all fragments share is made once.
    pub fn new(
        shader: Shader<'_>,
        bare: &'a Batch<SurfaceAttributes<i32>>,
        bumps: &'a Batch<FilteredBump<i32>>,
        plan: &'a SurfacePlan,
    ) -> Self {
        let in_one_frame = plan.needs_frame()
            && shader.backend.run(
                #[inline(always)]
                || bare.is_in_one_frame(),
            );
        let framed =
            in_one_frame.then(|| scalar_api::framed(&ports(&bare.get(0), &bumps.get(0).bump), plan, shader.precision));
        Self { bare, bumps, plan, framed }
    }
}

impl Pass for Surfaces<'_> {
    type Output = Surface<i32>;
    fn len(&self) -> usize {
        self.bare.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> Surface<W> {
        let input = ports(&group.load(self.bare), &group.load(self.bumps).bump);
        match &self.framed {
            Some(framed) => datapath::surface_in_frame(&group.all(framed), &input, self.plan, p),
            None => datapath::surface(&input, self.plan, p),
        }
    }
}

/// Law of the two lobes of every fragment, from those of the levels of its bump map: filter (levels, law).
#[derive(Clone, Copy, Debug)]
pub struct LobeLaws<'a> {
    /// Footprints in the bump map.
    pub footprints: &'a Batch<WrappedFootprint<i32>>,
    /// Law of each level, the finest first, at least one; beyond the last level it is the last.
    pub levels: &'a [LobeLaw<i32>],
}

impl Pass for LobeLaws<'_> {
    type Output = LobeLaw<i32>;
    fn len(&self) -> usize {
        self.footprints.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> LobeLaw<W> {
        let LevelPair { level, weight } = texel::levels::<W>(group.load(self.footprints).probes.lod, W::known(true), p);
        let (levels, last) = (self.levels, self.levels.len() - 1);
        let [fine, coarse] = each!(level in [level, level + Fx::int(1)] => {
            let read = W::per_lane(
                [level.raw()],
                #[inline(always)]
                |[level]| {
                    let LobeLaw { weight, widths: [first, second] } = levels[(level as usize).min(last)];
                    [weight.raw(), first.raw(), second.raw()]
                },
            );
            LobeLaw::<W> { weight: Fx::from_raw(read[0]), widths: [Fx::from_raw(read[1]), Fx::from_raw(read[2])] }
        });
        datapath::lobe_law(&fine, &coarse, weight)
    }
}

/// Surfaces with one of their two lobes: roughness (lobe).
#[derive(Clone, Copy, Debug)]
pub struct LobeSurfaces<'a> {
    /// Surfaces.
    pub surfaces: &'a Batch<Surface<i32>>,
    /// Laws of their lobes.
    pub laws: &'a Batch<LobeLaw<i32>>,
    /// Number of the lobe, 0 or 1.
    pub lobe: usize,
}

impl Pass for LobeSurfaces<'_> {
    type Output = Surface<i32>;
    fn len(&self) -> usize {
        self.surfaces.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> Surface<W> {
        let (surface, law) = (group.load(self.surfaces), group.load(self.laws));
        Surface { rough: datapath::lobe(&surface.rough, law.widths[self.lobe], p), ..surface }
    }
}

/// Points that surfaces reflect without a footprint: reflect, cube face.
#[derive(Clone, Copy, Debug)]
pub struct Points<'a>(pub &'a Batch<Surface<i32>>);

impl Pass for Points<'_> {
    type Output = CubePoint<i32>;
    fn len(&self) -> usize {
        self.0.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> CubePoint<W> {
        datapath::mirrored(&group.load(self.0), p).1
    }
}

/// Inputs of a reflection's footprint.
#[derive(Clone, Copy, Debug)]
pub struct Reflected<'a> {
    /// Surfaces.
    pub surfaces: &'a Batch<Surface<i32>>,
    /// Derivatives of normals and views over a pixel.
    pub derivatives: &'a Batch<Derivatives<i32>>,
    /// The scale of the environment.
    pub scale: &'a MapScale<i32>,
    /// Effects of the reflection.
    pub plan: &'a ReflectionPlan,
}

/// Footprints on the planes of cube faces: reflect, cube face, columns, ellipse, axes, probes.
#[derive(Clone, Copy, Debug)]
pub struct Footprints<'a>(pub Reflected<'a>);

impl Pass for Footprints<'_> {
    type Output = FaceFootprint<i32>;
    fn len(&self) -> usize {
        self.0.surfaces.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> FaceFootprint<W> {
        let Reflected { surfaces, derivatives, scale, plan } = self.0;
        let (surface, d, scale) = (group.load(surfaces), group.load(derivatives), group.all(scale));
        FaceFootprint::from_reflection(&datapath::reflection_of(
            &surface,
            [&d.dview, &d.dnormal],
            &scale,
            &plan.on_face(),
            p,
        ))
    }
}

impl Ports {
    /// Footprints of all fragments on the planes of cube faces.
    pub fn footprints(
        &self,
        shader: Shader<'_>,
        scale: &MapScale<i32>,
        plan: &ReflectionPlan,
    ) -> Batch<FaceFootprint<i32>> {
        let (mut surfaces, mut footprints) = (Batch::default(), Batch::default());
        Surfaces::new(shader, &self.bare, &self.bumps, &plan.surface()).run(shader, &mut surfaces);
        let (surfaces, derivatives) = (&surfaces, &self.derivatives);
        Footprints(Reflected { surfaces, derivatives, scale, plan }).run(shader, &mut footprints);
        footprints
    }
}

/// Sweeps that probes on the sphere step along: columns, ellipse, axes, probes, sweep.
#[derive(Clone, Copy, Debug)]
pub struct Sweeps<'a>(pub Reflected<'a>);

impl Pass for Sweeps<'_> {
    type Output = Sweep<i32>;
    fn len(&self) -> usize {
        self.0.surfaces.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> Sweep<W> {
        let Reflected { surfaces, derivatives, scale, plan } = self.0;
        let (surface, d, scale) = (group.load(surfaces), group.load(derivatives), group.all(scale));
        datapath::reflection_of(&surface, [&d.dview, &d.dnormal], &scale, &plan.on_sphere(), p).sweep
    }
}
