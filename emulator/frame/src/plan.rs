//! The plan of a scene: the blocks of the datapath that each object uses, and why.
//!
//! The contents of the scene switch an effect on, never a global default. One plan drives the frame, the vector sets and the
//! reports. [`decisions`] gives the reason for each effect.

use roughxel_core::plan::{FootprintKind, FrameSystem, HorizonKind, ReflectionPlan, SurfacePlan};
use roughxel_core::precision::{Precision, RoughnessKind};

use roughxel_maps::bump::BumpPyramid;
use roughxel_scene::{self as scene, Deviation, FootprintPlace, HighlightForm, Object, Shadowing};
use roughxel_shader::{Effect, ObjectPlan};

/// Sampling and filtering of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// One sample at the centre of the pixel, bilinear at the finest level.
    Unfiltered,
    /// One trilinear probe; the level covers the major axis; isotropic roughness.
    Isotropic,
    /// Footprint assembly as in the profile; the default.
    Footprint,
    /// N = edge² unfiltered samples on a regular grid in the pixel.
    Supersampled {
        /// Samples along each edge of the pixel, 1…64.
        edge: u32,
    },
}

impl Mode {
    /// True if samples have footprints.
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

    /// The accuracy knobs of a profile as the mode uses them.
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

/// The plan of an object: the effects of its material and mesh, in a mode, with a profile.
pub fn object_plan(
    object: &Object,
    bump: Option<&BumpPyramid>,
    has_environment: bool,
    mode: Mode,
    p: &Precision,
) -> ObjectPlan {
    let material = &object.material;
    let reflects = has_environment && material.reflectance.iter().any(|&r| r > 0.0);
    // Bumps change only reflections and highlights.
    let bumps = (reflects || material.highlight.is_some()) && material.bump.is_some();
    let is_rough = bump.is_some_and(|bump| !bump.is_smooth());
    let kept = |shows: bool| if shows && is_rough { p.roughness } else { RoughnessKind::None };
    ObjectPlan {
        colour_map: material.colour_map.is_some(),
        texture_footprint: mode.filters(),
        edges: mode.filters(),
        reflection: reflects.then_some(ReflectionPlan {
            bump: bumps,
            frame: frame_system(material.frame),
            // Without a footprint one sample of the environment stands for the whole reflection.
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
            && material
                .two_lobes
                .unwrap_or_else(|| bump.is_some_and(|bump| !bump.laws.is_empty() || has_two_kinds(bump))),
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

/// The state of an effect of an object, and the reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decision {
    /// The effect.
    pub effect: Effect,
    /// True if the effect is on.
    pub on: bool,
    /// The key of the scene, or the property of its maps, that decides.
    pub why: String,
}

/// Every effect, and the reason why a plan made of these values has it or not.
pub fn decisions(plan: &ObjectPlan, object: &Object, mode: Mode, p: &Precision) -> Vec<Decision> {
    Effect::ALL.map(|effect| Decision { effect, on: plan.has(effect), why: why(plan, effect, object, mode, p) }).into()
}

fn why(plan: &ObjectPlan, effect: Effect, object: &Object, mode: Mode, p: &Precision) -> String {
    let material = &object.material;
    let no_footprint = || format!("samples of mode {mode} are points");
    let reflects = plan.reflection.is_some();
    let plain = material.highlight.as_ref().is_some_and(|highlight| highlight.form == HighlightForm::Plain);
    match effect {
        Effect::ColourTexture if plan.colour_map => "`colour_map`".into(),
        Effect::ColourTexture => "no `colour_map`".into(),
        Effect::Environment if reflects => "`reflectance` above 0 and [environment]".into(),
        Effect::Environment => "`reflectance` is 0".into(),
        Effect::TwoLobes => match material.two_lobes {
            _ if !reflects => "nothing is reflected".into(),
            _ if !plan.has(Effect::Roughness) => "a smooth surface has no lobe".into(),
            Some(asked) => format!("`two_lobes = {asked}`"),
            None if plan.two_lobes && material.deviation == Deviation::Law => {
                "slopes of the bump map are not normally distributed".into()
            }
            None if plan.two_lobes => "most facets of the bump map are flat, a few are steep".into(),
            None => "slopes of the bump map are of one kind".into(),
        },
        Effect::Bump if plan.has(effect) => "`height_map` or `normal_map`, and the object reflects or shines".into(),
        Effect::Bump if material.bump.is_none() => "no `height_map` or `normal_map`".into(),
        Effect::Bump => "nothing is reflected or shines that a bump could move".into(),
        Effect::Footprint if plan.reflection.is_some_and(|plan| plan.footprint == FootprintKind::Sphere) => {
            format!("mode {mode}; on the sphere")
        }
        Effect::Footprint if plan.texture_footprint => format!("mode {mode}"),
        Effect::Edges if plan.edges => format!("mode {mode}"),
        Effect::Edges => format!("mode {mode} shades what it sees sample by sample"),
        Effect::Footprint => no_footprint(),
        Effect::Roughness => match material.roughness.as_ref().map(|map| map.is_smooth()) {
            Some(false) if plan.has(effect) => "`roughness_map`".into(),
            _ if plan.has(effect) => "levels of the bump map have lost detail".into(),
            Some(true) if material.bump.is_none() => "`roughness_map` is all zero".into(),
            None if material.bump.is_none() => "no bumps and no `roughness_map`".into(),
            _ if !reflects && !plan.has(Effect::Highlight) => "nothing is reflected or shines".into(),
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
        Effect::Horizon if plan.has(effect) => "`shadowing` of `peaks`".into(),
        Effect::Horizon if plan.peaks.is_some() => "`peaks` without `shadowing`".into(),
        Effect::Horizon => "no `peaks`".into(),
    }
}

/// The largest standard deviation of slopes, on any level, for which footprints lie on a face. A lobe is twice as wide.
const WIDEST_ON_A_FACE: f64 = 0.1;

/// True if lobes need footprints on the sphere.
fn is_wide(bump: Option<&BumpPyramid>) -> bool {
    bump.is_some_and(|bump| bump.largest_deviation() > WIDEST_ON_A_FACE)
}

/// Concentration below which slopes are of two kinds, flat and steep, so that no single lobe fits. Bricks have 0.52, gravel and
/// grass 0.78 and 0.82, waves 1. `globe`, in which two lobes are 2 to 4 dB worse, has 0.65.
const TWO_KINDS: f64 = 0.6;

/// True if one lobe is not enough.
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
