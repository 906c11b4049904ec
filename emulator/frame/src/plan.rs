//! The plan of a scene: which blocks of the datapath each object goes through, and why.
//!
//! An effect is switched on by what the scene contains, never by a global default. One value drives the frame, the
//! vector sets and the reports; [`ObjectPlan::decisions`] says of each effect why it is there or not.

use roughxel_core::plan::{
    Datapath, Effects, FootprintKind, FrameSystem, HorizonKind, PeakPlan, ReflectionPlan, SurfacePlan,
};
use roughxel_core::precision::{Precision, RoughnessKind};

use roughxel_maps::bump::BumpPyramid;
use roughxel_scene::{self as scene, FootprintPlace, HighlightForm, Object, Shadowing};

/// How a frame is sampled and filtered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// One sample at the centre of the pixel, bilinear at the finest level.
    Unfiltered,
    /// One trilinear probe; the level covers the major axis; isotropic roughness.
    Isotropic,
    /// Footprint assembly as the profile says: the default.
    Footprint,
    /// N = edge² unfiltered samples on a regular grid in the pixel.
    Supersampled {
        /// Samples along each edge of the pixel, 1…64.
        edge: u32,
    },
}

impl Mode {
    /// Whether samples have footprints.
    pub const fn filters(self) -> bool {
        matches!(self, Self::Isotropic | Self::Footprint)
    }

    /// Samples per pixel along one edge.
    pub const fn samples_edge(self) -> u32 {
        match self {
            Self::Supersampled { edge } => edge,
            _ => 1,
        }
    }

    /// The accuracy knobs the mode leaves of a profile.
    pub fn precision(self, p: &Precision) -> Precision {
        match self {
            Self::Isotropic => {
                let roughness = match p.roughness {
                    RoughnessKind::None => RoughnessKind::None,
                    RoughnessKind::Isotropic | RoughnessKind::Anisotropic => RoughnessKind::Isotropic,
                };
                Precision { max_probes: 1, roughness, ..*p }
            }
            _ => *p,
        }
    }
}

impl std::fmt::Display for Mode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Unfiltered => f.write_str("unfiltered"),
            Self::Isotropic => f.write_str("isotropic"),
            Self::Footprint => f.write_str("footprint"),
            Self::Supersampled { edge } => write!(f, "supersampled:{}", edge * edge),
        }
    }
}

impl std::str::FromStr for Mode {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "unfiltered" => return Ok(Self::Unfiltered),
            "isotropic" => return Ok(Self::Isotropic),
            "footprint" => return Ok(Self::Footprint),
            _ => {}
        }
        let samples = text.strip_prefix("supersampled:").and_then(|n| n.parse::<u32>().ok());
        match samples.map(|n| (n, n.isqrt())) {
            Some((samples, edge)) if edge * edge == samples && (1..=64).contains(&edge) => {
                Ok(Self::Supersampled { edge })
            }
            _ => Err(format!(
                "'{text}' is no mode: use unfiltered, isotropic, footprint or supersampled:N with N a square number \
                 from 1 to 4096 (1, 4, 16, 64, …)"
            )),
        }
    }
}

/// Blocks of one object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ObjectPlan {
    /// A colour map is sampled.
    pub colour_map: bool,
    /// Colour and bump maps have a footprint.
    pub texture_footprint: bool,
    /// Its edges are filtered: what it covers of a pixel counts.
    pub edges: bool,
    /// The reflection datapath; `None` where nothing is reflected.
    pub reflection: Option<ReflectionPlan>,
    /// A rough reflection has two lobes, the narrower one a quarter as wide.
    pub two_lobes: bool,
    /// The surface of a highlight.
    pub highlight: Option<SurfacePlan>,
    /// The surface that peaks stand on.
    pub peaks: Option<SurfacePlan>,
    /// Peaks have horizons.
    pub horizon: HorizonKind,
}

impl ObjectPlan {
    /// The plan of an object: what its material and mesh call for, in a mode, with a profile.
    pub fn new(object: &Object, bump: Option<&BumpPyramid>, has_environment: bool, mode: Mode, p: &Precision) -> Self {
        let material = &object.material;
        let reflects = has_environment && material.reflectance.iter().any(|&r| r > 0.0);
        // Bumps move only what is reflected or shines.
        let bumps = (reflects || material.highlight.is_some()) && material.bump.is_some();
        let is_rough = bump.is_some_and(|bump| !bump.is_smooth());
        let kept = |shows: bool| if shows && is_rough { p.roughness } else { RoughnessKind::None };
        Self {
            colour_map: material.colour_map.is_some(),
            texture_footprint: mode.filters(),
            edges: mode.filters(),
            reflection: reflects.then_some(ReflectionPlan {
                bump: bumps,
                frame: frame_system(material.frame),
                // Without a footprint one sample of the environment stands for all that is reflected.
                roughness: kept(mode.filters()),
                curvature: mode.filters() && curved_triangles(object) > 0,
                footprint: match material.footprint {
                    _ if !mode.filters() => FootprintKind::None,
                    // A smooth surface has no lobe.
                    _ if kept(true) == RoughnessKind::None => FootprintKind::Face,
                    Some(FootprintPlace::Face) => FootprintKind::Face,
                    Some(FootprintPlace::Sphere) => FootprintKind::Sphere,
                    None if is_wide(bump) => FootprintKind::Sphere,
                    None => FootprintKind::Face,
                },
            }),
            two_lobes: reflects
                && kept(mode.filters()) != RoughnessKind::None
                && material.two_lobes.unwrap_or_else(|| bump.is_some_and(has_two_kinds)),
            highlight: material.highlight.as_ref().map(|highlight| SurfacePlan {
                bump: bumps,
                frame: frame_system(material.frame),
                roughness: kept(highlight.form != HighlightForm::Plain),
                local: false,
            }),
            peaks: material.peaks.as_ref().map(|_| SurfacePlan {
                bump: false,
                frame: frame_system(material.frame),
                roughness: RoughnessKind::None,
                local: true,
            }),
            horizon: match material.peaks.as_ref().and_then(|peaks| peaks.shadowing) {
                None => HorizonKind::None,
                Some(Shadowing::Correlated) => HorizonKind::Correlated,
                Some(Shadowing::Product) => HorizonKind::Product,
            },
        }
    }

    /// The surface that a fragment's reflection and its lights share.
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

    /// The roughness that a fragment needs of its maps.
    pub fn roughness(&self) -> RoughnessKind {
        let reflection = self.reflection.map_or(RoughnessKind::None, |plan| plan.roughness);
        match (reflection, self.highlight) {
            (RoughnessKind::None, Some(plan)) => plan.roughness,
            (kind, _) => kind,
        }
    }

    /// The datapaths the object calls for and the blocks of each: what its vectors and its hardware are made for.
    pub fn datapaths(&self) -> impl Iterator<Item = (Datapath, Effects)> {
        let reflection = self.reflection.map(|plan| (Datapath::Reflection, plan.into()));
        let highlight = self.highlight.map(|plan| (Datapath::Highlight, plan.into()));
        let peak = |plan: SurfacePlan| PeakPlan { frame: plan.frame, horizon: self.horizon };
        let peaks = self.peaks.map(|plan| (Datapath::Peak, peak(plan).into()));
        [reflection, highlight, peaks].into_iter().flatten()
    }

    /// Whether a bump map, or a roughness map, is sampled.
    pub fn bump_map(&self) -> bool {
        self.has(Effect::Bump) || self.has(Effect::Roughness)
    }

    /// The frame system, where any block needs p_u and p_v.
    pub fn needs_tangents(&self) -> bool {
        let surfaces = [self.reflection.map(|plan| plan.surface()), self.highlight, self.peaks];
        surfaces.iter().flatten().any(|plan| plan.needs_frame() && plan.frame != FrameSystem::MainDirection)
    }
}

/// What a scene may call for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// A colour map on the object.
    ColourTexture,
    /// Bumps: the normal is moved.
    Bump,
    /// The detail that a bump map's level has lost.
    Roughness,
    /// An environment is reflected.
    Environment,
    /// A lobe for most facets and one for all.
    TwoLobes,
    /// Samples have footprints.
    Footprint,
    /// A pixel shows every object by the share that it covers.
    Edges,
    /// Normals that vary over a triangle widen the footprint.
    Curvature,
    /// A lobe around the normal.
    Highlight,
    /// Several normals at a point.
    Peaks,
    /// Bumps hide each other from lights and eye.
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

    /// Its name in reports.
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

/// Whether an object has an effect, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decision {
    /// The effect.
    pub effect: Effect,
    /// Whether it exists.
    pub on: bool,
    /// Which key of the scene or property of its maps decided.
    pub why: String,
}

impl ObjectPlan {
    /// Whether an effect is on.
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

    /// The plan without an effect, and without what needs it; roughness goes with the bumps and with the footprints.
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

    /// Every effect with the reason that this plan, made of these, has it or not.
    pub fn decisions(&self, object: &Object, mode: Mode, p: &Precision) -> Vec<Decision> {
        Effect::ALL
            .map(|effect| Decision { effect, on: self.has(effect), why: self.why(effect, object, mode, p) })
            .into()
    }

    fn why(&self, effect: Effect, object: &Object, mode: Mode, p: &Precision) -> String {
        let material = &object.material;
        let no_footprint = || format!("samples of mode {mode} are points");
        let reflects = self.reflection.is_some();
        let plain = material.highlight.as_ref().is_some_and(|highlight| highlight.form == HighlightForm::Plain);
        match effect {
            Effect::ColourTexture if self.colour_map => "`colour_map`".into(),
            Effect::ColourTexture => "no `colour_map`".into(),
            Effect::Environment if reflects => "`reflectance` above 0 and [environment]".into(),
            Effect::Environment => "`reflectance` is 0".into(),
            Effect::TwoLobes => match material.two_lobes {
                _ if !reflects => "nothing is reflected".into(),
                _ if !self.has(Effect::Roughness) => "a smooth surface has no lobe".into(),
                Some(asked) => format!("`two_lobes = {asked}`"),
                None if self.two_lobes => "most facets of the bump map are flat, a few are steep".into(),
                None => "slopes of the bump map are of one kind".into(),
            },
            Effect::Bump if self.has(effect) => {
                "`height_map` or `normal_map`, and the object reflects or shines".into()
            }
            Effect::Bump if material.bump.is_none() => "no `height_map` or `normal_map`".into(),
            Effect::Bump => "nothing is reflected or shines that a bump could move".into(),
            Effect::Footprint if self.reflection.is_some_and(|plan| plan.footprint == FootprintKind::Sphere) => {
                format!("mode {mode}; on the sphere")
            }
            Effect::Footprint if self.texture_footprint => format!("mode {mode}"),
            Effect::Edges if self.edges => format!("mode {mode}"),
            Effect::Edges => format!("mode {mode} shades what it sees sample by sample"),
            Effect::Footprint => no_footprint(),
            Effect::Roughness => match material.roughness.as_ref().map(|map| map.is_smooth()) {
                Some(false) if self.has(effect) => "`roughness_map`".into(),
                _ if self.has(effect) => "levels of the bump map have lost detail".into(),
                Some(true) if material.bump.is_none() => "`roughness_map` is all zero".into(),
                None if material.bump.is_none() => "no bumps and no `roughness_map`".into(),
                _ if !reflects && !self.has(Effect::Highlight) => "nothing is reflected or shines".into(),
                _ if !reflects && plain => "`form` of the `highlight` is plain".into(),
                _ if !mode.filters() => no_footprint(),
                _ if p.roughness == RoughnessKind::None => "the profile has none".into(),
                _ => "no level of the bump map has lost detail".into(),
            },
            Effect::Curvature if !reflects => "nothing is reflected".into(),
            Effect::Curvature if !mode.filters() => no_footprint(),
            Effect::Curvature => {
                let (curved, all) = (curved_triangles(object), object.mesh.triangles.len());
                format!("normals vary over {curved} of {all} triangles")
            }
            Effect::Highlight if material.highlight.is_some() => "`highlight` and [[light]]".into(),
            Effect::Highlight => "no `highlight`".into(),
            Effect::Peaks if material.peaks.is_some() => "`peaks` and [[light]]".into(),
            Effect::Peaks => "no `peaks`".into(),
            Effect::Horizon if self.has(effect) => "`shadowing` of `peaks`".into(),
            Effect::Horizon if self.peaks.is_some() => "`peaks` without `shadowing`".into(),
            Effect::Horizon => "no `peaks`".into(),
        }
    }
}

/// A plan without roughness, and so without lobes that a face does not hold.
const fn smooth(plan: ReflectionPlan) -> ReflectionPlan {
    ReflectionPlan { roughness: RoughnessKind::None, ..plan.on_face() }
}

/// The largest standard deviation of slopes, of any level, that footprints on a face hold. A lobe is twice as wide.
const WIDEST_ON_A_FACE: f64 = 0.1;

/// Whether lobes call for footprints on the sphere.
fn is_wide(bump: Option<&BumpPyramid>) -> bool {
    bump.is_some_and(|bump| bump.largest_deviation() > WIDEST_ON_A_FACE)
}

/// Concentration below which slopes are of two kinds, flat and steep, and no one lobe is like both: bricks have 0.52, gravel and grass 0.78 and
/// 0.82, waves 1; `globe`, where two lobes are 2 to 4 dB worse, has 0.65.
const TWO_KINDS: f64 = 0.6;

/// Whether one lobe is not enough.
fn has_two_kinds(bump: &BumpPyramid) -> bool {
    bump.concentration < TWO_KINDS
}

/// The datapath's name of a scene's frame system.
pub const fn frame_system(frame: scene::FrameSystem) -> FrameSystem {
    match frame {
        scene::FrameSystem::MainDirection => FrameSystem::MainDirection,
        scene::FrameSystem::Natural => FrameSystem::Natural,
        scene::FrameSystem::NaturalNormalised => FrameSystem::NaturalNormalised,
    }
}

/// Triangles over which the normal varies.
fn curved_triangles(object: &Object) -> usize {
    let is_curved = |corners: &&[u32; 3]| {
        let [a, b, c] = corners.map(|corner| object.mesh.vertices.get(corner as usize).map(|v| v.normal));
        a != b || b != c
    };
    object.mesh.triangles.iter().filter(is_curved).count()
}
