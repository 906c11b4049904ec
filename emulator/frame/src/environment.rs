//! Fetches from the environment: probes on cube faces, across their edges and at their corners.

use roughxel_core::datapath::texel;
use roughxel_core::precision::Precision;
use roughxel_core::sampler::{self, Cube};
use roughxel_core::signals::{CubePoint, Probes};
use roughxel_core::width::on_words;
use roughxel_maps::environment::CubePyramid;
use roughxel_maps::mip::smallest_exponent;
use roughxel_scene::picture::Picture;

use super::MAX_MAP_EXPONENT;
use super::colour::Channel;

/// The environment of a scene.
#[derive(Clone, Debug)]
pub struct EnvironmentMap {
    pyramid: CubePyramid,
}

impl EnvironmentMap {
    /// Builds the pyramid, or only its base where nothing is filtered.
    pub fn new(faces: &[Picture; 6], filters: bool) -> Self {
        let exponent = smallest_exponent(faces).min(MAX_MAP_EXPONENT);
        let mut pyramid = CubePyramid::with_exponent(faces, exponent);
        if !filters {
            pyramid.levels.truncate(1);
        }
        Self { pyramid }
    }

    /// Edge of level 0 in texels.
    pub fn edge(&self) -> u32 {
        self.pyramid.edge
    }

    /// Bytes of the stored texels.
    pub fn bytes(&self) -> u64 {
        let levels = self.pyramid.levels.iter().flatten();
        levels.map(|level| size_of_val(level.texels.as_slice()) as u64).sum()
    }

    /// Taps that [`EnvironmentMap::sample`] reads, four texels each: one of each probe, and another of the coarser level unless its
    /// weight is 0.
    pub fn taps(&self, probes: &Probes<i32>, rough: bool, p: &Precision) -> u64 {
        let fine = u64::from(probes.count.raw().unsigned_abs());
        if texel::levels::<i32>(probes.lod, rough, p).weight.raw() == 0 { fine } else { fine + fine }
    }

    /// The mean colour of a footprint, I8F24: N trilinear probes along its major axis; a rough one is sampled with the
    /// roughness bias.
    pub fn sample(&self, point: &CubePoint<i32>, probes: &Probes<i32>, rough: bool, p: &Precision) -> [Channel; 3] {
        let cube = Cube {
            memory: &self.pyramid,
            edge: self.pyramid.edge,
            last_level: self.pyramid.levels.len() as u32 - 1,
            exponent: self.pyramid.exponent,
        };
        on_words!(p, |point, probes| sampler::environment(point, probes, rough, &cube, p)).map(|channel| channel.0)
    }
}
