//! The plan: the blocks that a batch of fragments goes through. A block that is off does not exist.
//!
//! A plan is fixed when the datapath is built or called; it is never data. A block that is left out gives the same bits as one that runs with a
//! neutral input (b = 0, D = 0, dn = 0).

use crate::precision::RoughnessKind;

/// Construction of the tangent basis (S97 §7).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameSystem {
    /// System 3: a main direction h.
    MainDirection,
    /// System 1: p_u and p_v.
    Natural,
    /// System 2: p_u and p_v without their lengths.
    NaturalNormalised,
}

/// Blocks that make the surface, which reflection and lights share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SurfacePlan {
    /// Tangent basis and perturb.
    pub bump: bool,
    /// System of the tangent basis, which exists if `bump` or `roughness` needs it.
    pub frame: FrameSystem,
    /// Tangents of the roughness.
    pub roughness: RoughnessKind,
    /// True if the tangent basis itself is needed: peaks stand in it.
    pub local: bool,
}

impl SurfacePlan {
    /// Returns true if any block needs the tangents of the basis.
    pub const fn needs_frame(&self) -> bool {
        self.local || self.bump || !matches!(self.roughness, RoughnessKind::None)
    }
}

/// Surface on which a reflection's footprint lies, and along which its probes step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FootprintKind {
    /// No footprint: one probe at the finest level.
    None,
    /// Footprint on the plane of the cube face that r selects, with steps over that plane (W97). It suffices for lobes of a few degrees.
    Face,
    /// Footprint on the tangent plane of the sphere at r, with steps over normals that are reflected one by one. It serves lobes up to a hemisphere,
    /// without a jump where r changes face.
    Sphere,
}

impl FootprintKind {
    /// Returns true if there is a footprint.
    pub const fn is_some(self) -> bool {
        !matches!(self, Self::None)
    }
}

/// Blocks of the reflection datapath.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReflectionPlan {
    /// Tangent basis and perturb.
    pub bump: bool,
    /// System of the tangent basis, which exists if `bump` or `roughness` needs it.
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

    /// Surface that the reflection needs. Without a footprint its roughness has no effect.
    pub const fn surface(&self) -> SurfacePlan {
        let roughness = if self.footprint.is_some() { self.roughness } else { RoughnessKind::None };
        SurfacePlan { bump: self.bump, frame: self.frame, roughness, local: false }
    }

    /// Returns true if any block needs the tangents of the basis.
    pub const fn needs_frame(&self) -> bool {
        self.surface().needs_frame()
    }

    /// Plan with its footprint, if any, on a face. Code compiled with it has no stages of the sphere.
    #[inline(always)]
    pub const fn on_face(self) -> Self {
        let footprint = if self.footprint.is_some() { FootprintKind::Face } else { FootprintKind::None };
        Self { footprint, ..self }
    }

    /// Plan with a footprint on the sphere. Code compiled with it has none of the stages on a face.
    #[inline(always)]
    pub const fn on_sphere(self) -> Self {
        Self { footprint: FootprintKind::Sphere, ..self }
    }
}

/// Rule that joins the shares of a horizon. Light and eye each clear two, one over each axis; the result is the share of facets that both see.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HorizonKind {
    /// Facets hide nothing.
    None,
    /// Correlated shares: a facet that lies in a hole lies in it for every direction. The result is the smallest of the four shares, less a quarter
    /// of what the next one hides of it. Horizons are stored by a law that falls from its low end.
    Correlated,
    /// Product of the shares, as if they were independent (F92 §5, erratum 22). Horizons are stored by a uniform law.
    Product,
}

/// Blocks of one light on one peak.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PeakPlan {
    /// System of the tangent basis that the peak stands in.
    pub frame: FrameSystem,
    /// Facets hide each other from light and eye.
    pub horizon: HorizonKind,
}

impl PeakPlan {
    /// Surface that a peak stands on. A peak brings its own normal.
    pub const fn surface(&self) -> SurfacePlan {
        SurfacePlan { bump: false, frame: self.frame, roughness: RoughnessKind::None, local: true }
    }
}

/// A datapath with its own ports, for which vectors are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Datapath {
    /// Reflection: from a surface to the probes on the environment that it reflects.
    Reflection,
    /// One light on a surface with a lobe around its normal.
    Highlight,
    /// One light on one of the peaks of a surface.
    Peak,
}

impl Datapath {
    /// Every datapath.
    pub const ALL: [Self; 3] = [Self::Reflection, Self::Highlight, Self::Peak];

    /// Name in manifests and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Reflection => "reflection",
            Self::Highlight => "highlight",
            Self::Peak => "peak",
        }
    }
}

/// Blocks that are on, for every datapath; each reads those that it has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effects {
    /// Tangent basis and perturb: reflection and highlight.
    pub bump: bool,
    /// System of the tangent basis, if one exists.
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
    /// Every block. Of blocks with several kinds: the footprint on a face, anisotropic roughness and correlated horizons.
    pub const ALL: Self = Self {
        bump: true,
        frame: FrameSystem::MainDirection,
        roughness: RoughnessKind::Anisotropic,
        curvature: true,
        footprint: FootprintKind::Face,
        horizon: HorizonKind::Correlated,
    };

    /// No optional block.
    pub const NONE: Self = Self {
        bump: false,
        frame: FrameSystem::MainDirection,
        roughness: RoughnessKind::None,
        curvature: false,
        footprint: FootprintKind::None,
        horizon: HorizonKind::None,
    };

    /// Effects that a datapath has; the others are off.
    pub fn restricted_to(&self, datapath: Datapath) -> Self {
        match datapath {
            Datapath::Reflection => self.reflection().into(),
            Datapath::Highlight => self.highlight().into(),
            Datapath::Peak => self.peak().into(),
        }
    }

    /// Effects of the reflection datapath.
    pub const fn reflection(&self) -> ReflectionPlan {
        let Self { bump, frame, roughness, curvature, footprint, .. } = *self;
        ReflectionPlan { bump, frame, roughness, curvature, footprint }
    }

    /// Effects of a highlight. Its roughness needs no footprint.
    pub const fn highlight(&self) -> SurfacePlan {
        SurfacePlan { bump: self.bump, frame: self.frame, roughness: self.roughness, local: false }
    }

    /// Effects of a peak.
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
