//! Fragments of one object that wait to be shaded together.

use roughxel_core::ports::{BlockVector, Port, PortBlock};
use roughxel_core::signals::{MapScale, TexturePosition, WrappedFootprint};
use roughxel_core::stage::texture::TextureScale;

use crate::attributes::{AttributeRows, Needs, same_rows};
use crate::batch::Batch;
use crate::maps::{Places, TextureDerivatives, TextureFootprints};
use crate::material::Material;
use crate::pass::Shader;
use crate::signals::{Derivatives, SurfaceAttributes};
use crate::texels::WrappedMap;

/// Pixel in which a colour counts.
#[derive(Clone, Copy, Debug, Default)]
pub struct Place {
    /// Index of the pixel in its tile.
    pub pixel: u32,
    /// Number of the pixel's samples that the fragment stands for.
    pub times: u32,
}

/// Fragments of one object that wait to be shaded. Batches that its plan does not read stay empty.
#[derive(Debug)]
pub struct Fragments {
    /// True if they reflect or shine.
    pub(crate) has_surface: bool,
    /// True if they reflect over footprints.
    has_derivatives: bool,
    needs: Needs,
    /// Main direction, in place of p_u and p_v.
    main_direction: Option<BlockVector>,
    pub(crate) bare: Batch<SurfaceAttributes<i32>>,
    pub(crate) derivatives: Batch<Derivatives<i32>>,
    pub(crate) centres: Batch<TexturePosition<i32>>,
    pub(crate) duv: Batch<TextureDerivatives>,
    /// Pixel of each fragment.
    pub(crate) places: Vec<Place>,
    /// Directions from each fragment to the local lights of the scene, in their order.
    pub(crate) directions: Vec<Batch<PortBlock<i32, 3>>>,
    pub(crate) footprints: MapFootprints,
}

impl Fragments {
    /// Maximum number of waiting fragments that stay in a second-level cache.
    pub const MANY: usize = 128;

    /// Empty list of fragments.
    pub fn new(material: &Material) -> Self {
        let (plan, needs) = (&material.plan, material.needs());
        let maps = material.maps().filter(|_| plan.texture_footprint);
        Self {
            has_surface: plan.reflection.is_some() || material.lighting.is_some(),
            has_derivatives: plan.reflection.is_some_and(|plan| plan.footprint.is_some()),
            needs,
            main_direction: (!needs.tangents).then_some(material.main_direction),
            bare: Batch::default(),
            derivatives: Batch::default(),
            centres: Batch::default(),
            duv: Batch::default(),
            places: Vec::new(),
            directions: Vec::new(),
            footprints: MapFootprints::new(maps, material.rough_map()),
        }
    }

    /// Number of fragments.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Returns true if there is no fragment.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Rows for [`Self::append`]. They hold the attributes that do not depend on the triangle.
    pub fn rows(&self) -> AttributeRows {
        let mut rows = AttributeRows::default();
        if let Some(main) = self.main_direction {
            rows.frame_vectors[0] = same_rows(&main);
        }
        rows
    }

    /// Adds waiting fragments that share their derivatives, at most a vector of them.
    pub fn append(&mut self, places: &[Place], rows: &AttributeRows, derivatives: &Derivatives<i32>) {
        let count = places.len();
        if self.has_surface {
            self.bare.append(count, |to| {
                to.block(|bare| bare.normal, &rows.normal);
                to.block(|bare| bare.view, &rows.view);
                to.block(|bare| bare.frame_vectors[0], &rows.frame_vectors[0]);
                to.block(|bare| bare.frame_vectors[1], &rows.frame_vectors[1]);
            });
        }
        if self.has_derivatives {
            self.derivatives.append_same(count, derivatives);
        }
        if self.needs.uv {
            self.centres.append(count, |to| {
                to.low(|centre| centre.uv[0], &rows.uv[0]);
                to.low(|centre| centre.uv[1], &rows.uv[1]);
            });
        }
        if self.needs.duv {
            self.duv.append(count, |to| {
                to.block(|duv| duv[0], &rows.duv[0]);
                to.block(|duv| duv[1], &rows.duv[1]);
            });
        }
        self.places.extend_from_slice(places);
    }

    /// Adds the directions from the next fragment to the local lights of the scene.
    pub fn append_directions(&mut self, directions: impl ExactSizeIterator<Item = BlockVector>) {
        self.directions.resize_with(directions.len(), Batch::default);
        for (batch, direction) in self.directions.iter_mut().zip(directions) {
            batch.push(&direction.wires());
        }
    }

    /// Places in a map.
    pub(crate) fn places_in(&self, map: &WrappedMap) -> Places<'_> {
        Places { centres: &self.centres, footprints: self.footprints.for_map(map) }
    }

    /// Removes all fragments; the memory is kept.
    pub(crate) fn clear(&mut self) {
        self.bare.clear();
        self.derivatives.clear();
        self.centres.clear();
        self.duv.clear();
        self.places.clear();
        self.directions.iter_mut().for_each(Batch::clear);
    }
}

/// Footprints of fragments in maps of one size.
#[derive(Debug)]
struct SizedFootprints {
    size: [i32; 2],
    scale: (TextureScale<i32>, MapScale<i32>),
    /// True if bumps with roughness are among the maps.
    is_rough: bool,
    footprints: Batch<WrappedFootprint<i32>>,
}

/// Footprints of fragments in the maps that they read; none if nothing is filtered.
#[derive(Debug)]
pub struct MapFootprints(Vec<SizedFootprints>);

impl MapFootprints {
    /// Footprints of no fragments yet. Footprints of the size of `rough` bumps hold the reach of their probes.
    pub fn new<'a>(maps: impl Iterator<Item = &'a WrappedMap>, rough: Option<&WrappedMap>) -> Self {
        let mut sizes: Vec<SizedFootprints> = Vec::new();
        for map in maps {
            let (size, scale) = (map.size(), map.scale);
            if sizes.iter().all(|sized| sized.size != size) {
                let is_rough = rough.is_some_and(|rough| rough.size() == size);
                sizes.push(SizedFootprints { size, scale, is_rough, footprints: Batch::default() });
            }
        }
        Self(sizes)
    }

    /// Makes the footprints of these fragments, in place of all others.
    pub fn make(&mut self, shader: Shader<'_>, derivatives: &Batch<TextureDerivatives>) {
        for SizedFootprints { scale, is_rough, footprints, .. } in &mut self.0 {
            TextureFootprints { derivatives, scale, is_rough: *is_rough }.run(shader, footprints);
        }
    }

    /// Footprints in a map.
    pub fn for_map(&self, map: &WrappedMap) -> Option<&Batch<WrappedFootprint<i32>>> {
        self.0.iter().find(|sized| sized.size == map.size()).map(|sized| &sized.footprints)
    }
}
