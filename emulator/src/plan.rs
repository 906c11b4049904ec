//! The plan of a scene: which blocks of the datapath each object goes through, and why.
//!
//! An effect is switched on by what the scene contains, never by a global default. One value drives the frame, the
//! vector sets and the reports.

use roughxel_core::plan::{FrameSystem, ReflectionPlan};
use roughxel_core::precision::{Precision, RoughnessKind};

use crate::maps::bump::BumpPyramid;
use crate::scene::{self, Object};

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
    /// A bump map is sampled.
    pub bump_map: bool,
    /// Colour and bump maps have a footprint.
    pub texture_footprint: bool,
    /// The reflection datapath; `None` where nothing is reflected.
    pub reflection: Option<ReflectionPlan>,
}

impl ObjectPlan {
    /// The plan of an object: what its material and mesh call for, in a mode, with a profile.
    pub fn new(object: &Object, bump: Option<&BumpPyramid>, has_environment: bool, mode: Mode, p: &Precision) -> Self {
        let material = &object.material;
        let reflects = has_environment && material.reflectance.iter().any(|&r| r > 0.0);
        // A bump map moves only what is reflected.
        let bump_map = reflects && bump.is_some();
        let lost_detail = bump.is_some_and(|bump| !bump.is_smooth());
        let roughness = if mode.filters() && lost_detail { p.roughness } else { RoughnessKind::None };
        Self {
            colour_map: material.colour_map.is_some(),
            bump_map,
            texture_footprint: mode.filters(),
            reflection: reflects.then_some(ReflectionPlan {
                bump: bump_map,
                frame: frame_system(material.frame),
                roughness,
                curvature: mode.filters() && is_curved(object),
                footprint: mode.filters(),
            }),
        }
    }
}

/// The datapath's name of a scene's frame system.
pub const fn frame_system(frame: scene::FrameSystem) -> FrameSystem {
    match frame {
        scene::FrameSystem::MainDirection => FrameSystem::MainDirection,
        scene::FrameSystem::Natural => FrameSystem::Natural,
        scene::FrameSystem::NaturalNormalised => FrameSystem::NaturalNormalised,
    }
}

/// Whether the normal varies over any triangle.
fn is_curved(object: &Object) -> bool {
    object.mesh.triangles.iter().any(|corners| {
        let [a, b, c] = corners.map(|corner| object.mesh.vertices.get(corner as usize).map(|v| v.normal));
        a != b || b != c
    })
}
