//! The plan of an object: the blocks of the datapath that its fragments go through.

use roughxel_core::plan::{
    Datapath, Effects, FootprintKind, FrameSystem, HorizonKind, PeakPlan, ReflectionPlan, SurfacePlan,
};
use roughxel_core::precision::RoughnessKind;

/// Blocks of one object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ObjectPlan {
    /// True if a colour map is sampled.
    pub colour_map: bool,
    /// True if colour and bump maps have a footprint.
    pub texture_footprint: bool,
    /// Edge filter: true if the share of a pixel that the object covers counts.
    pub edges: bool,
    /// Reflection datapath; `None` if nothing is reflected.
    pub reflection: Option<ReflectionPlan>,
    /// True if a rough reflection has two lobes.
    pub two_lobes: bool,
    /// Surface of a highlight.
    pub highlight: Option<SurfacePlan>,
    /// Surface on which peaks stand.
    pub peaks: Option<SurfacePlan>,
    /// Rule for the horizons of peaks.
    pub horizon: HorizonKind,
}

impl ObjectPlan {
    /// Surface that a fragment's reflection and its lights share.
    pub fn surface(&self) -> SurfacePlan {
        let none = SurfacePlan {
            bump: false,
            frame: FrameSystem::MainDirection,
            roughness: RoughnessKind::None,
            local: false,
        };
        let surfaces = [self.reflection.map(|plan| plan.surface()), self.highlight, self.peaks];
        surfaces.into_iter().flatten().fold(none, |all, plan| SurfacePlan {
            bump: all.bump || plan.bump,
            frame: plan.frame,
            roughness: if plan.roughness == RoughnessKind::None { all.roughness } else { plan.roughness },
            local: all.local || plan.local,
        })
    }

    /// Roughness that a fragment needs of its maps.
    pub fn roughness(&self) -> RoughnessKind {
        let reflection = self.reflection.map_or(RoughnessKind::None, |plan| plan.roughness);
        match (reflection, self.highlight) {
            (RoughnessKind::None, Some(plan)) => plan.roughness,
            (kind, _) => kind,
        }
    }

    /// Datapaths of the object and the blocks of each, for which its vectors and its hardware are made.
    pub fn datapaths(&self) -> impl Iterator<Item = (Datapath, Effects)> {
        let reflection = self.reflection.map(|plan| (Datapath::Reflection, plan.into()));
        let highlight = self.highlight.map(|plan| (Datapath::Highlight, plan.into()));
        let peak = |plan: SurfacePlan| PeakPlan { frame: plan.frame, horizon: self.horizon };
        let peaks = self.peaks.map(|plan| (Datapath::Peak, peak(plan).into()));
        [reflection, highlight, peaks].into_iter().flatten()
    }

    /// Returns true if a bump map, or a roughness map, is sampled.
    pub fn bump_map(&self) -> bool {
        self.has(Effect::Bump) || self.has(Effect::Roughness)
    }

    /// System of the tangent basis, if any block needs p_u and p_v.
    pub fn needs_tangents(&self) -> bool {
        let surfaces = [self.reflection.map(|plan| plan.surface()), self.highlight, self.peaks];
        surfaces.iter().flatten().any(|plan| plan.needs_frame() && plan.frame != FrameSystem::MainDirection)
    }
}

/// Effect that a scene may call for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// A colour map on the object.
    ColourTexture,
    /// Bumps: the normal is moved.
    Bump,
    /// Lost detail of a bump map's level, as roughness.
    Roughness,
    /// Reflection of an environment.
    Environment,
    /// Two lobes of a rough reflection, of a law of the bump map or one for most facets and one for all.
    TwoLobes,
    /// Footprints of samples.
    Footprint,
    /// Share of a pixel that each object covers.
    Edges,
    /// Normals that vary over a triangle and widen the footprint.
    Curvature,
    /// One lobe around the normal.
    Highlight,
    /// Several normals at a point.
    Peaks,
    /// Bumps that hide each other from lights and eye.
    Horizon,
}

impl Effect {
    /// Every effect, in the order of the datapath.
    pub const ALL: [Self; 11] = [
        Self::ColourTexture,
        Self::Bump,
        Self::Roughness,
        Self::Environment,
        Self::TwoLobes,
        Self::Footprint,
        Self::Edges,
        Self::Curvature,
        Self::Highlight,
        Self::Peaks,
        Self::Horizon,
    ];

    /// Name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ColourTexture => "colour texture",
            Self::Bump => "bump",
            Self::Roughness => "roughness",
            Self::Environment => "environment",
            Self::TwoLobes => "two lobes",
            Self::Footprint => "footprint",
            Self::Edges => "edges",
            Self::Curvature => "curvature",
            Self::Highlight => "highlight",
            Self::Peaks => "peaks",
            Self::Horizon => "horizon",
        }
    }
}

impl ObjectPlan {
    /// Returns true if an effect is on.
    pub fn has(&self, effect: Effect) -> bool {
        let reflection = |on: fn(&ReflectionPlan) -> bool| self.reflection.as_ref().is_some_and(on);
        match effect {
            Effect::ColourTexture => self.colour_map,
            Effect::Bump => reflection(|plan| plan.bump) || self.highlight.is_some_and(|plan| plan.bump),
            Effect::Roughness => self.roughness() != RoughnessKind::None,
            Effect::Environment => self.reflection.is_some(),
            Effect::TwoLobes => self.two_lobes,
            Effect::Footprint => self.texture_footprint,
            Effect::Edges => self.edges,
            Effect::Curvature => reflection(|plan| plan.curvature),
            Effect::Highlight => self.highlight.is_some(),
            Effect::Peaks => self.peaks.is_some(),
            Effect::Horizon => self.horizon != HorizonKind::None,
        }
    }

    /// Plan without an effect and without the effects that need it. Roughness goes with the bumps and with the footprints.
    pub fn without(mut self, effect: Effect) -> Self {
        match effect {
            Effect::ColourTexture => self.colour_map = false,
            Effect::Bump => {
                self.two_lobes = false;
                self.change_reflection(|plan| *plan = ReflectionPlan { bump: false, ..smooth(*plan) });
                self.change_highlight(|plan| (plan.bump, plan.roughness) = (false, RoughnessKind::None));
            }
            Effect::Roughness => {
                self.two_lobes = false;
                self.change_reflection(|plan| *plan = smooth(*plan));
                self.change_highlight(|plan| plan.roughness = RoughnessKind::None);
            }
            Effect::Environment => (self.reflection, self.two_lobes) = (None, false),
            Effect::TwoLobes => self.two_lobes = false,
            Effect::Footprint => {
                (self.texture_footprint, self.two_lobes) = (false, false);
                self.change_reflection(|plan| {
                    (plan.footprint, plan.curvature, plan.roughness) =
                        (FootprintKind::None, false, RoughnessKind::None);
                });
                self.change_highlight(|plan| plan.roughness = RoughnessKind::None);
            }
            Effect::Edges => self.edges = false,
            Effect::Curvature => self.change_reflection(|plan| plan.curvature = false),
            Effect::Highlight => self.highlight = None,
            Effect::Peaks => (self.peaks, self.horizon) = (None, HorizonKind::None),
            Effect::Horizon => self.horizon = HorizonKind::None,
        }
        self
    }

    fn change_reflection(&mut self, change: impl FnOnce(&mut ReflectionPlan)) {
        if let Some(plan) = &mut self.reflection {
            change(plan);
        }
    }

    fn change_highlight(&mut self, change: impl FnOnce(&mut SurfacePlan)) {
        if let Some(plan) = &mut self.highlight {
            change(plan);
        }
    }
}

/// Plan without roughness, and so without lobes that are too wide for a face.
const fn smooth(plan: ReflectionPlan) -> ReflectionPlan {
    ReflectionPlan { roughness: RoughnessKind::None, ..plan.on_face() }
}
