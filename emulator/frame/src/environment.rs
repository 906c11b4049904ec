//! The environment of a frame.

use roughxel_assets::Picture;
use roughxel_core::fx::Fx;
use roughxel_core::precision::Precision;
use roughxel_core::signals::Sweep;
use roughxel_maps::environment::CubePyramid;
use roughxel_shader::{
    Batch, Channel, CubeTexels, EnvironmentColours, FaceFootprint, Ordered, Reflector, ShadedColour, Shader,
};
use roughxel_simd::Backend;

/// The environment of a scene.
#[derive(Clone, Debug)]
pub struct EnvironmentMap {
    texels: CubeTexels,
}

impl EnvironmentMap {
    /// Builds the pyramid, or only its base if nothing is filtered.
    pub fn new(faces: &[Picture; 6], filters: bool) -> Self {
        let mut pyramid = CubePyramid::new(faces);
        if !filters {
            pyramid.levels.truncate(1);
        }
        let (edge, exponent, is_bright) = (pyramid.edge, pyramid.exponent, pyramid.is_bright());
        let faces: Vec<_> = pyramid.levels.iter().flatten().map(|level| &level.texels[..]).collect();
        Self { texels: CubeTexels::new(edge, exponent, is_bright, &faces) }
    }

    /// Edge of level 0 in texels.
    pub fn edge(&self) -> u32 {
        self.texels.edge()
    }

    /// Bytes of the texels in a three-channel memory.
    pub fn bytes(&self) -> u64 {
        (size_of::<[u16; 3]>() * self.texels.len()) as u64
    }

    /// True if each code has an exponent: the environment is brighter than 64 × white.
    pub fn is_bright(&self) -> bool {
        self.texels.is_bright()
    }

    pub(super) fn texels(&self) -> &CubeTexels {
        &self.texels
    }

    /// The mean colour of a footprint on its face, I8F24, below 64: N trilinear probes along the major axis. A rough footprint is
    /// sampled with the roughness bias.
    pub fn sample(&self, footprint: &FaceFootprint<i32>, is_rough: bool, p: &Precision) -> [Channel; 3] {
        self.mirror(is_rough, |reflector, shown| {
            let looks = &Batch::from_iter([*footprint]);
            let colours = EnvironmentColours { looks, reflector };
            colours.run(Shader::new(Backend::Scalar, p), &mut Ordered::default(), shown);
        })
    }

    /// The mean colour of a footprint on the sphere; see [`Self::sample`].
    pub fn sample_sphere(&self, sweep: &Sweep<i32>, is_rough: bool, p: &Precision) -> [Channel; 3] {
        self.mirror(is_rough, |reflector, shown| {
            let looks = &Batch::from_iter([*sweep]);
            let colours = EnvironmentColours { looks, reflector };
            colours.run(Shader::new(Backend::Scalar, p), &mut Ordered::default(), shown);
        })
    }

    /// Colour of the environment in a perfect mirror.
    fn mirror(&self, is_rough: bool, look: impl FnOnce(Reflector<'_>, &mut Batch<ShadedColour<i32>>)) -> [Channel; 3] {
        let own = &Batch::from_iter([ShadedColour { channels: [Channel::zero(); 3], samples: Fx::zero() }]);
        let mut shown = Batch::default();
        look(Reflector { own, map: &self.texels, is_rough, reflectance: &[Fx::int(1); 3] }, &mut shown);
        shown.get(0).channels
    }
}
