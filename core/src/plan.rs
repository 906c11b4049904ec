//! The plan: which blocks a batch of fragments goes through. A block that is off does not exist.
//!
//! A plan is known when the datapath is built or called, never data. Leaving a block out gives the same bits as
//! running it with a neutral input (b = 0, D = 0, dn = 0).

use crate::precision::RoughnessKind;

/// How the tangent frame is found (S97 §7).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameSystem {
    /// System 3: a main direction h.
    MainDirection,
    /// System 1: p_u and p_v.
    Natural,
    /// System 2: p_u and p_v, lengths dropped.
    NaturalNormalised,
}

/// Blocks that make the surface, which reflection and lights share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SurfacePlan {
    /// Frame and perturb.
    pub bump: bool,
    /// Which frame; it exists where `bump` or `roughness` needs it.
    pub frame: FrameSystem,
    /// Tangents of the roughness.
    pub roughness: RoughnessKind,
    /// The frame itself is asked for: peaks stand in it.
    pub local: bool,
}

impl SurfacePlan {
    /// Whether anything needs the tangents of the frame.
    pub const fn needs_frame(&self) -> bool {
        self.local || self.bump || !matches!(self.roughness, RoughnessKind::None)
    }
}

/// On what a reflection's footprint lies, and what its probes step along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FootprintKind {
    /// Nowhere: one probe at the finest level.
    None,
    /// On the plane of the cube face that r selects, stepping over that plane (W97): all that a lobe of a few degrees needs.
    Face,
    /// On the tangent plane of the sphere at r, stepping over normals that are reflected one by one: for lobes up to a hemisphere, without a
    /// step where r changes face.
    Sphere,
}

impl FootprintKind {
    /// Whether there is one.
    pub const fn is_some(self) -> bool {
        !matches!(self, Self::None)
    }
}

/// Blocks of the reflection datapath.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReflectionPlan {
    /// Frame and perturb.
    pub bump: bool,
    /// Which frame; it exists where `bump` or `roughness` needs it.
    pub frame: FrameSystem,
    /// Roughness columns.
    pub roughness: RoughnessKind,
    /// The dn terms of the pixel columns.
    pub curvature: bool,
    /// Columns, ellipse, axes, probes.
    pub footprint: FootprintKind,
}

impl ReflectionPlan {
    /// Every block.
    pub const FULL: Self = Self {
        bump: true,
        frame: FrameSystem::MainDirection,
        roughness: RoughnessKind::Anisotropic,
        curvature: true,
        footprint: FootprintKind::Face,
    };

    /// The surface that the reflection needs: without a footprint its roughness is of no use.
    pub const fn surface(&self) -> SurfacePlan {
        let roughness = if self.footprint.is_some() { self.roughness } else { RoughnessKind::None };
        SurfacePlan { bump: self.bump, frame: self.frame, roughness, local: false }
    }

    /// Whether anything needs the tangents of the frame.
    pub const fn needs_frame(&self) -> bool {
        self.surface().needs_frame()
    }

    /// The same with its footprint, if any, on a face: what is compiled with it has no stages of the sphere.
    #[inline(always)]
    pub const fn on_face(self) -> Self {
        let footprint = if self.footprint.is_some() { FootprintKind::Face } else { FootprintKind::None };
        Self { footprint, ..self }
    }

    /// The same with a footprint on the sphere, and none of the stages on a face.
    #[inline(always)]
    pub const fn on_sphere(self) -> Self {
        Self { footprint: FootprintKind::Sphere, ..self }
    }
}

/// How the shares of a horizon that light and eye clear, over two axes each, become the share of facets that both see.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HorizonKind {
    /// Facets hide nothing.
    None,
    /// Who lies in a hole lies in it for every direction: the smallest of the four, less a quarter of what the next one hides of it. Horizons are
    /// stored by a law that falls from its low end.
    Correlated,
    /// Their product, as if they were independent (F92 §5, erratum 22). Horizons are stored by a uniform law.
    Product,
}

/// Blocks of one light on one peak.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PeakPlan {
    /// Which frame the peak stands in.
    pub frame: FrameSystem,
    /// Facets hide each other from light and eye.
    pub horizon: HorizonKind,
}

impl PeakPlan {
    /// The surface that a peak stands on: it brings its own normal.
    pub const fn surface(&self) -> SurfacePlan {
        SurfacePlan { bump: false, frame: self.frame, roughness: RoughnessKind::None, local: true }
    }
}

/// A datapath with ports of its own: what vectors are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Datapath {
    /// From a surface to the probes on the environment it reflects.
    Reflection,
    /// One light on a surface with a lobe around its normal.
    Highlight,
    /// One light on one of the peaks of a surface.
    Peak,
}

impl Datapath {
    /// Every one.
    pub const ALL: [Self; 3] = [Self::Reflection, Self::Highlight, Self::Peak];

    /// Its name in manifests and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Reflection => "reflection",
            Self::Highlight => "highlight",
            Self::Peak => "peak",
        }
    }
}

/// Blocks that are on, of every datapath: each looks at those it has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effects {
    /// Frame and perturb: reflection and highlight.
    pub bump: bool,
    /// Which frame, where one exists.
    pub frame: FrameSystem,
    /// Roughness of reflection and highlight.
    pub roughness: RoughnessKind,
    /// The dn terms of a reflection.
    pub curvature: bool,
    /// The footprint of a reflection.
    pub footprint: FootprintKind,
    /// Horizons of peaks.
    pub horizon: HorizonKind,
}

impl Effects {
    /// Every block; of those with several kinds the footprint on a face, anisotropic roughness and correlated horizons.
    pub const ALL: Self = Self {
        bump: true,
        frame: FrameSystem::MainDirection,
        roughness: RoughnessKind::Anisotropic,
        curvature: true,
        footprint: FootprintKind::Face,
        horizon: HorizonKind::Correlated,
    };

    /// What a datapath cannot do without.
    pub const NONE: Self = Self {
        bump: false,
        frame: FrameSystem::MainDirection,
        roughness: RoughnessKind::None,
        curvature: false,
        footprint: FootprintKind::None,
        horizon: HorizonKind::None,
    };

    /// Those that a datapath has; the others are off.
    pub fn of(&self, datapath: Datapath) -> Self {
        match datapath {
            Datapath::Reflection => self.reflection().into(),
            Datapath::Highlight => self.highlight().into(),
            Datapath::Peak => self.peak().into(),
        }
    }

    /// Those of the reflection datapath.
    pub const fn reflection(&self) -> ReflectionPlan {
        let Self { bump, frame, roughness, curvature, footprint, .. } = *self;
        ReflectionPlan { bump, frame, roughness, curvature, footprint }
    }

    /// Those of a highlight: its roughness needs no footprint.
    pub const fn highlight(&self) -> SurfacePlan {
        SurfacePlan { bump: self.bump, frame: self.frame, roughness: self.roughness, local: false }
    }

    /// Those of a peak.
    pub const fn peak(&self) -> PeakPlan {
        PeakPlan { frame: self.frame, horizon: self.horizon }
    }
}

impl From<ReflectionPlan> for Effects {
    fn from(plan: ReflectionPlan) -> Self {
        let ReflectionPlan { bump, frame, roughness, curvature, footprint } = plan;
        Self { bump, frame, roughness, curvature, footprint, horizon: HorizonKind::None }
    }
}

impl From<SurfacePlan> for Effects {
    fn from(plan: SurfacePlan) -> Self {
        Self { bump: plan.bump, frame: plan.frame, roughness: plan.roughness, ..Self::NONE }
    }
}

impl From<PeakPlan> for Effects {
    fn from(plan: PeakPlan) -> Self {
        Self { frame: plan.frame, horizon: plan.horizon, ..Self::NONE }
    }
}
