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
    /// Columns, ellipse, axes, probes. Off: one probe at the finest level.
    pub footprint: bool,
}

impl ReflectionPlan {
    /// Every block.
    pub const FULL: Self = Self {
        bump: true,
        frame: FrameSystem::MainDirection,
        roughness: RoughnessKind::Anisotropic,
        curvature: true,
        footprint: true,
    };

    /// The surface that the reflection needs: without a footprint its roughness is of no use.
    pub const fn surface(&self) -> SurfacePlan {
        let roughness = if self.footprint { self.roughness } else { RoughnessKind::None };
        SurfacePlan { bump: self.bump, frame: self.frame, roughness, local: false }
    }

    /// Whether anything needs the tangents of the frame.
    pub const fn needs_frame(&self) -> bool {
        self.surface().needs_frame()
    }
}
