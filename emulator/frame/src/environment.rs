//! Fetches from the environment: probes on cube faces, across their edges and at their corners.

use roughxel_core::bundle::Value;
use roughxel_core::datapath::{pixel, texel};
use roughxel_core::fx::{Control, Fx};
use roughxel_core::ports::REFLECTANCE;
use roughxel_core::precision::Precision;
use roughxel_core::sampler::{self, Cube, CubeMemory};
use roughxel_core::signals::{CubePoint, Probes, SphereProbe};
use roughxel_core::width::on_words;
use roughxel_maps::environment::{BrightCube, CubePyramid};
use roughxel_scene::picture::Picture;

use super::colour::Channel;

/// Where a fragment looks, and over which footprint.
#[derive(Clone, Copy, Debug)]
pub enum Look<'a> {
    /// On the plane of a face.
    Face(&'a CubePoint<i32>, &'a Probes<i32>),
    /// On the sphere: its probes.
    Sphere(&'a [SphereProbe<i32>]),
}

/// The environment of a scene.
#[derive(Clone, Debug)]
pub struct EnvironmentMap {
    pyramid: CubePyramid,
}

impl EnvironmentMap {
    /// Builds the pyramid, or only its base where nothing is filtered.
    pub fn new(faces: &[Picture; 6], filters: bool) -> Self {
        let mut pyramid = CubePyramid::new(faces);
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
    pub fn taps(&self, look: Look<'_>, rough: bool, p: &Precision) -> u64 {
        let taps =
            |lod, fine: u64| if texel::levels::<i32>(lod, rough, p).weight.raw() == 0 { fine } else { fine + fine };
        match look {
            Look::Face(_, probes) => taps(probes.lod, probes.count.raw().unsigned_abs().into()),
            Look::Sphere(probes) => probes.iter().map(|probe| taps(probe.lod, 1)).sum(),
        }
    }

    /// Whether its codes have an exponent each: it is brighter than 64 × white.
    pub fn is_bright(&self) -> bool {
        self.pyramid.is_bright()
    }

    /// The mean colour of a footprint, I8F24, below 64: N trilinear probes along its major axis; a rough one is sampled with the
    /// roughness bias.
    pub fn sample(&self, look: Look<'_>, rough: bool, p: &Precision) -> [Channel; 3] {
        self.blended(&[Channel::zero(); 3], (look, rough), &[Fx::int(1); 3], p)
    }

    /// The same mean, blended with the colour of a surface by its reflectance before it is cut.
    pub fn blended(
        &self,
        surface: &[Channel; 3],
        (look, rough): (Look<'_>, bool),
        reflectance: &[Control<i32, REFLECTANCE>; 3],
        p: &Precision,
    ) -> [Channel; 3] {
        let CubePyramid { edge, levels, exponent } = &self.pyramid;
        let (edge, last_level, exponent) = (*edge, levels.len() as u32 - 1, *exponent);
        let unit = Fx::from_raw(exponent);
        if self.is_bright() {
            let cube = Cube { memory: &BrightCube(&self.pyramid), edge, last_level, exponent };
            let means = means(look, rough, &cube, p);
            let channel = |i: usize| pixel::bright_blend::<i32>(surface[i], means[i].0, unit, reflectance[i]);
            return core::array::from_fn(channel);
        }
        let cube = Cube { memory: &self.pyramid, edge, last_level, exponent };
        let means = means(look, rough, &cube, p);
        let colour = |i: usize| pixel::colour::<i32>(means[i].0, unit);
        core::array::from_fn(|i| pixel::blend::<i32>(surface[i], colour(i), reflectance[i]))
    }
}

/// The mean of a footprint as the stages of pixels take it.
fn means<M: CubeMemory>(look: Look<'_>, rough: bool, cube: &Cube<'_, M>, p: &Precision) -> [Value<i32, 32>; 3] {
    match look {
        Look::Face(point, probes) => on_words!(p, |point, probes| sampler::means(point, probes, rough, cube, p)),
        // Of nothing but numbers that control: the same on words of any width.
        Look::Sphere(probes) => sampler::swept_means(probes.iter().copied(), rough, cube, p),
    }
}
