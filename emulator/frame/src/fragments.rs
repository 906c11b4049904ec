//! Every fragment of a frame as the ports of a device that reflects, blends and sums it.

use roughxel_core::fx::{Control, Int};
use roughxel_core::plan::ReflectionPlan;
use roughxel_core::ports::{REFLECTANCE, ReflectionInput};
use roughxel_core::precision::RoughnessKind;
use roughxel_shader::{Channel, Fragments, Material, Place, Shader};

use super::prepare::Prepared;
use super::tile::Shading;
use crate::raster::{RasterError, TileRect, TileSamples, TriangleList, tiles};

/// A fragment of a frame with its maps sampled.
#[derive(Clone, Copy, Debug)]
pub struct FrameFragment {
    /// Column and row of its pixel.
    pub pixel: [u32; 2],
    /// Number of times that its colour counts in the pixel.
    pub times: u32,
    /// Number of times that all colours of the pixel count.
    pub samples: u32,
    /// Colour of the surface, or of a background without environment.
    pub colour: [Channel; 3],
    /// Its reflection; none if it reflects nothing.
    pub reflection: Option<FragmentReflection>,
}

/// Reflection of a fragment.
#[derive(Clone, Copy, Debug)]
pub struct FragmentReflection {
    /// Ports of the datapath.
    pub ports: ReflectionInput<i32>,
    /// True if the object is rough: its footprint reads finer levels.
    pub is_rough: bool,
    /// Share of the environment in each channel.
    pub reflectance: [Control<i32, REFLECTANCE>; 3],
}

/// Fragments of a tile, by the index of their pixel in it.
struct TileFragments {
    edge_texels: Int<i32>,
    found: Vec<(u32, FrameFragment)>,
}

impl TileFragments {
    fn push(&mut self, place: Place, colour: [Channel; 3], reflection: Option<FragmentReflection>) {
        let fragment = FrameFragment { pixel: [0; 2], times: place.times, samples: 1, colour, reflection };
        self.found.push((place.pixel, fragment));
    }
}

impl Shading for TileFragments {
    fn shade(&mut self, shader: Shader<'_>, material: &Material, fragments: &mut Fragments) {
        for of in shader.fragment_ports(material, fragments) {
            let reflection = material.plan.reflection.map(|plan| FragmentReflection {
                ports: ReflectionInput {
                    surface: of.surface,
                    dview: of.derivatives.dview,
                    dnormal: of.derivatives.dnormal,
                    edge_texels: self.edge_texels,
                },
                is_rough: plan.roughness != RoughnessKind::None,
                reflectance: material.reflectance,
            });
            self.push(of.place, of.colour, reflection);
        }
    }

    fn add(&mut self, place: Place, colour: [Channel; 3]) {
        self.push(place, colour, None);
    }
}

impl Prepared<'_> {
    /// Every fragment of the frame, tile by tile, with the light of highlights and peaks left out. `progress` is called once for each of
    /// [`Self::work`] pieces.
    ///
    /// Errors: a scene that cannot be set up.
    pub fn fragments(&self, progress: &dyn Fn()) -> Result<Vec<FrameFragment>, RasterError> {
        let triangles = TriangleList::new(&self.projection, &self.scene.objects)?.with_backend(self.backend);
        let (passes, mut samples) = (self.sampling().passes(), TileSamples::default());
        let mut fragments = Vec::new();
        for tile in tiles(self.projection.width(), self.projection.height()) {
            let edge = self.environment.as_ref().map_or(1, |map| map.edge());
            let mut of_tile = TileFragments { edge_texels: Int::<i32>::int(edge.into()), found: Vec::new() };
            let counts = self.walk_tile(&triangles, tile, &passes, &mut samples, &mut of_tile);
            let TileRect { x, y, width, .. } = tile;
            fragments.extend(of_tile.found.into_iter().map(|(index, fragment)| FrameFragment {
                pixel: [x + index % width, y + index / width],
                samples: counts[index as usize],
                ..fragment
            }));
            progress();
        }
        Ok(fragments)
    }

    /// Plans of all reflections in the frame: those of the objects, and that of rays that show the environment as background.
    pub fn reflection_plans(&self) -> impl Iterator<Item = ReflectionPlan> {
        let shown =
            self.environment.is_some() && matches!(self.scene.background, roughxel_scene::Background::Environment);
        let background = self.mirror.plan.reflection.filter(|_| shown);
        self.plans().filter_map(|plan| plan.reflection).chain(background)
    }
}
