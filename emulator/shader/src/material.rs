//! Materials: constants and maps with which the fragments of an object are shaded, in addition to their attributes.

use std::fmt;
use std::sync::Arc;

use roughxel_core::datapath::{LobeLaw, Surface};
use roughxel_core::fx::{Control, Fx};
use roughxel_core::plan::{FootprintKind, FrameSystem, HorizonKind, ReflectionPlan, SurfacePlan};
use roughxel_core::ports::{BlockVector, LIGHT, REFLECTANCE, ShininessPort, SurfaceInput};
use roughxel_core::precision::RoughnessKind;

use crate::attributes::Needs;
use crate::maps::{BumpMap, ColourMap};
use crate::peaks::{PackedPeak, PeakTexels};
use crate::plan::ObjectPlan;
use crate::texels::WrappedMap;

/// A channel of a colour on its wire, I8F24.
pub type Channel = Control<i32, LIGHT>;

/// Maps and constants of an object, and the stages that its fragments go through. Objects can share maps.
#[derive(Debug)]
pub struct Material {
    /// Plan of its stages.
    pub plan: ObjectPlan,
    /// Colour of the object.
    pub colour: [Channel; 3],
    /// Share of the environment in each channel.
    pub reflectance: [Control<i32, REFLECTANCE>; 3],
    /// Direction on which tangent bases of system 3 are built.
    pub main_direction: BlockVector,
    /// Colours that vary over the object.
    pub colour_map: Option<Arc<ColourMap>>,
    /// Bumps and roughness.
    pub bump_map: Option<Arc<BumpMap>>,
    /// Laws of two lobes on the levels of the bump map, the finest first, at least one.
    pub lobes: Vec<LobeLaw<i32>>,
    /// Lights and highlights of the object.
    pub lighting: Option<Lighting>,
}

/// Law for slopes of two kinds: half of the light from a lobe as wide as the roughness, half from one a quarter as wide. It is the lobe of the facets
/// that make up most of a surface, if a few facets are steep.
pub fn core_and_whole() -> LobeLaw<i32> {
    LobeLaw { weight: Fx::number(1, -1), widths: [Fx::int(1), Fx::number(1, -2)] }
}

impl Material {
    /// Material of rays that hit nothing: a smooth mirror without colour.
    pub fn mirror(filters: bool) -> Self {
        let reflection = ReflectionPlan {
            bump: false,
            frame: FrameSystem::MainDirection,
            roughness: RoughnessKind::None,
            curvature: false,
            footprint: if filters { FootprintKind::Face } else { FootprintKind::None },
        };
        let plan = ObjectPlan {
            colour_map: false,
            texture_footprint: filters,
            edges: filters,
            reflection: Some(reflection),
            two_lobes: false,
            highlight: None,
            peaks: None,
            horizon: HorizonKind::None,
        };
        Self {
            plan,
            colour: [Fx::zero(); 3],
            reflectance: [Fx::int(1); 3],
            main_direction: BlockVector::default(),
            colour_map: None,
            bump_map: None,
            lobes: vec![core_and_whole()],
            lighting: None,
        }
    }

    /// Maps that a fragment reads.
    pub fn maps(&self) -> impl Iterator<Item = &WrappedMap> {
        let colour = self.colour_map.as_ref().map(|map| &map.texels.map);
        let bump = self.bump_map.as_ref().map(|map| map.texels.map());
        [colour, bump, self.lighting.as_ref().and_then(Lighting::map)].into_iter().flatten()
    }

    /// Bump map, if it is read with its roughness.
    pub(crate) fn rough_map(&self) -> Option<&WrappedMap> {
        let is_rough = self.plan.roughness() != RoughnessKind::None;
        self.bump_map.as_ref().filter(|_| is_rough).map(|map| map.texels.map())
    }

    /// Attributes that its fragments read.
    pub fn needs(&self) -> Needs {
        let uv = self.maps().next().is_some();
        Needs { tangents: self.plan.needs_tangents(), uv, duv: uv && self.plan.texture_footprint }
    }
}

/// Lights, and the lobe or peaks that return them.
#[derive(Debug)]
pub struct Lighting {
    /// Effects of the surface.
    pub plan: SurfacePlan,
    /// Lights on the object.
    pub lights: Vec<Light>,
    /// Lobe or peaks that return the light.
    pub shine: Shine,
}

impl Lighting {
    /// Map of the peaks, if they come from one.
    fn map(&self) -> Option<&WrappedMap> {
        match &self.shine {
            Shine::Map(map) => Some(&map.map),
            _ => None,
        }
    }
}

/// A light as an object returns it.
#[derive(Clone, Copy, Debug)]
pub struct Light {
    /// Direction to the light, if it is infinitely far away; otherwise each fragment has its own.
    pub direction: Option<BlockVector>,
    /// Colour of the light times that of the highlight or the peaks.
    pub colour: [Channel; 3],
}

/// Lobe or peaks that return light.
pub enum Shine {
    /// One lobe around the normal.
    Highlight(ShininessPort<i32>),
    /// A formula that no datapath has, for comparison. Its arguments are a surface, the ports of the surface and the direction to the light.
    Formula(Formula),
    /// Peaks that are the same everywhere.
    Given(Vec<PackedPeak>),
    /// Peaks of a map.
    Map(Arc<PeakTexels>),
}

/// Share of a light that a surface returns.
pub type Formula = Box<dyn Fn(&Surface<i32>, &SurfaceInput<i32>, &BlockVector) -> Channel + Send + Sync>;

impl fmt::Debug for Shine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Highlight(_) => "Highlight",
            Self::Formula(_) => "Formula",
            Self::Given(_) => "Given",
            Self::Map(_) => "Map",
        })
    }
}
