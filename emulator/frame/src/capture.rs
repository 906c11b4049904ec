//! Fragments of a frame as ports of the reflection datapath.

use fixed::types::I4F28;
use glam::DVec3;
use roughxel_core::plan::ReflectionPlan;
use roughxel_core::ports::{BlockVector, Port, ReflectionIn, SurfaceIn};
use roughxel_core::precision::Precision;
use roughxel_core::setup::block_vector;
use roughxel_shader::{FragmentAttributes, Fragments};
use roughxel_simd::LANES;

use super::prepare::Prepared;
use crate::raster::{RasterError, Sampling, TileSamples, TriangleList, tiles};

impl Prepared<'_> {
    /// Inputs of the reflection datapath for at most `most` reflecting fragments, spread evenly over the frame, with their plan.
    /// `render --capture` and the demo export them as vectors. Ports are quantised to the profile.
    pub fn capture(&self, most: usize) -> Result<Vec<(ReflectionIn, ReflectionPlan)>, RasterError> {
        let triangles = TriangleList::new(&self.projection, &self.scene.objects)?.with_backend(self.backend);
        let passes = Sampling::Grid { edge: 1 }.passes();
        let mut samples = TileSamples::default();
        let mut fragments = Vec::new();
        for tile in tiles(self.projection.width(), self.projection.height()) {
            for pass in &passes {
                triangles.samples(tile, pass, &mut samples);
                for (triangle, shown) in samples.by_triangle() {
                    let Some(index) = triangle else { continue };
                    if self.objects[triangles.object_index(index)].material.plan.reflection.is_some() {
                        fragments.extend(shown.iter().map(|&sample| (samples.position(sample), index)));
                    }
                }
            }
        }
        // Rows first, so that the choice does not depend on the tiles.
        fragments.sort_unstable_by_key(|&([x, y], _)| (y, x));
        let count = most.min(fragments.len());
        let chosen = (0..count).filter_map(|i| {
            let &([x, y], index) = fragments.get(i * fragments.len() / count.max(1))?;
            let object = triangles.object_index(index);
            let prepared = &self.objects[object];
            let material = &prepared.material;
            let triangle = triangles.triangle(index, material.needs())?;
            let plan = material.plan.reflection?;
            let (attributes, mut rows) = (triangle.fragment(x, y), Fragments::new(material).rows());
            triangle.fragments(&[[x; LANES], [y; LANES]], &mut rows);
            let surface = self.shader().surface_input(material, &rows, &triangle.derivatives());
            let surface = SurfaceIn::from_wires(&surface);
            let edge_texels = self.environment.as_ref().map_or(1, |map| map.edge() as u16);
            let FragmentAttributes { dview, dnormal, .. } = attributes;
            let input = ReflectionIn { surface, dview, dnormal, edge_texels };
            Some((quantised(&input, &self.precision), plan))
        });
        Ok(chosen.collect())
    }
}

/// The fragment with every port rounded to the bits that the profile keeps.
fn quantised(input: &ReflectionIn, p: &Precision) -> ReflectionIn {
    let vector = |v: BlockVector| {
        let mantissa = DVec3::from_array(v.mantissa.map(|m| f64::from(m.to_bits())));
        let rounded = block_vector(mantissa, p);
        // Mantissa integers are 2^30 times their value.
        BlockVector {
            exponent: if rounded == BlockVector::default() { 0 } else { rounded.exponent + v.exponent - 30 },
            ..rounded
        }
    };
    let number = |x: I4F28| I4F28::from_wires(&x.wires().quantise(p.offset_bits()));
    let SurfaceIn { normal, view, frame_vectors, offset, roughness } = input.surface;
    ReflectionIn {
        surface: SurfaceIn {
            normal: vector(normal),
            view: vector(view),
            frame_vectors: frame_vectors.map(vector),
            offset: offset.map(number),
            roughness: roughness.map(number),
        },
        dview: input.dview.map(vector),
        dnormal: input.dnormal.map(vector),
        edge_texels: input.edge_texels,
    }
}
