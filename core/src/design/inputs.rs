//! Input ports of the designs that have a bundle of their own.

use crate::block::{Block, Mantissa};
use crate::bundle::bundle;
use crate::datapath::LobeLaw;
use crate::datapath::pixel::PixelSum;
use crate::datapath::texel::{BumpCodes, BumpMoments, BumpSample, BumpScale};
use crate::ports::{Horizon, LIGHT, LOD, OFFSET, PortBlock, REFLECTANCE, ReflectionInput, SHARE};
use crate::signals::{
    CubePoint, FacePosition, LocalDirection, MapScale, PeakSum, Probes, Sweep, TangentFrame, TexturePosition,
};
use crate::stage::filter::{Address, LEVEL_WEIGHT, Patch, ProbeSum, WEIGHT};
use crate::stage::texture::TextureScale;

bundle! {
    /// Ports of `map_scale`.
    pub struct Edge<W> {
        /// Edge of a face, texels.
        #[range(1..=16384)]
        edge_texels: Int<W>,
    }

    /// Ports of `texture`.
    pub struct MapFootprintInput<W> {
        /// d(u, v)/dx and d(u, v)/dy, repeats per pixel.
        duv: [PortBlock<W, 2>; 2],
        /// Constants of the map.
        #[per(Object)]
        texture: TextureScale<W>,
        /// Scale of the level of detail.
        #[per(Object)]
        map: MapScale<W>,
    }

    /// λ of an ellipse as a port. If λ is zero, its exponent may be that of a zero over a zero, beyond that of other blocks.
    pub struct Deviation<W> {
        /// Mantissa.
        #[range(-1..=1)]
        m: [Mantissa<W>; 1],
        /// Exponent.
        #[range(-262144..=262144)]
        e: Int<W>,
    }

    /// Ports of `probe_reach`.
    pub struct ProbeReachInput<W> {
        /// λ₁ of the footprint.
        major: Deviation<W>,
        /// λ₂.
        minor: Deviation<W>,
        /// Its probes.
        probes: Probes<W>,
        /// Constants of the map.
        #[per(Object)]
        texture: TextureScale<W>,
    }

    /// Ports of `reflection`.
    pub struct ScaledReflectionInput<W> {
        /// The fragment; the edge of its environment is not read.
        fragment: ReflectionInput<W>,
        /// Scale of the environment.
        #[per(Object)]
        map: MapScale<W>,
    }

    /// Ports of `environment_probe`.
    pub struct EnvironmentProbeInput<W> {
        /// Point of the cube at the centre of the footprint.
        point: CubePoint<W>,
        /// The footprint.
        probes: Probes<W>,
        /// Number of the probe, below the count.
        #[range(0..=15)]
        index: Int<W>,
    }

    /// Ports of `sphere_probe`.
    pub struct SphereProbeInput<W> {
        /// The footprint.
        sweep: Sweep<W>,
        /// Number of the probe, below the count.
        #[range(0..=15)]
        index: Int<W>,
        /// The last (coarsest) level of the environment.
        #[per(Object)]
        #[range(0..=14)]
        last_level: Int<W>,
    }

    /// Ports of `texture_probe`.
    pub struct TextureProbeInput<W> {
        /// Centre of the footprint.
        centre: TexturePosition<W>,
        /// The footprint.
        probes: Probes<W>,
        /// Number of the probe, below the count.
        #[range(0..=15)]
        index: Int<W>,
        /// Constants of the map.
        #[per(Object)]
        texture: TextureScale<W>,
    }

    /// Ports of `repeat_address`.
    pub struct RepeatAddressInput<W> {
        /// Place in repeats.
        place: TexturePosition<W>,
        /// Width and height of the level, texels.
        #[range(1..=16384)]
        size: [Int<W>; 2],
    }

    /// Ports of `face_address`.
    pub struct FaceAddressInput<W> {
        /// Place on the cube.
        place: FacePosition<W>,
        /// Edge of the level, texels.
        #[range(1..=16384)]
        edge: Int<W>,
    }

    /// Ports of `face_texels`.
    pub struct FaceTexelsInput<W> {
        /// Face 0…5.
        #[range(0..=5)]
        face: Int<W>,
        /// Address of the sample.
        address: Address<W>,
        /// Edge of the level, texels.
        #[range(1..=16384)]
        edge: Int<W>,
    }

    /// Ports of `levels`.
    pub struct LevelsInput<W> {
        /// Level of detail of the footprint.
        #[range(0..=14)]
        lod: Control<W, LOD>,
        /// The footprint is a rough surface's.
        #[per(Object)]
        rough: W::Flag,
    }

    /// Ports of `corner`.
    pub struct CornerInput<W> {
        /// One channel of the three texels that meet there, unsigned.
        #[range(0..=65535)]
        texels: [Int<W>; 3],
    }

    /// Ports of `bright_texel`.
    pub struct BrightTexelInput<W> {
        /// Exponent in the upper 5 bits, fraction in the lower 11.
        #[range(0..=65535)]
        code: Int<W>,
    }

    /// Ports of `bright_corner`.
    pub struct BrightCornerInput<W> {
        /// One channel of the three texels that meet there, at most 4095 · 2^19.
        #[range(0..=2146959360)]
        texels: [Int<W>; 3],
    }

    /// Ports of `colour_sample`.
    pub struct ColourSampleInput<W> {
        /// Texels (0,0), (1,0), (0,1), (1,1) of the finer, then of the coarser level.
        #[range(0..=65535)]
        texels: [[Int<W>; 4]; 2],
        /// Weights in a level, [0, 1).
        #[range(0..1)]
        weights: [[Control<W, WEIGHT>; 2]; 2],
        /// Weight of the coarser level, [0, 1).
        #[range(0..1)]
        level_weight: Control<W, LEVEL_WEIGHT>,
    }

    /// Ports of `word_sample`.
    pub struct WordSampleInput<W> {
        /// Texels and weights of the finer level.
        fine: Patch<W>,
        /// Texels and weights of the coarser level.
        coarse: Patch<W>,
        /// Weight of the coarser level, [0, 1).
        #[range(0..1)]
        level_weight: Control<W, LEVEL_WEIGHT>,
    }

    /// Ports of `probe_sum`.
    pub struct ProbeSumInput<W> {
        /// The next sample.
        sample: Int<W>,
        /// Its weight.
        #[range(0..=1)]
        weight: Control<W, SHARE>,
        /// The sum so far.
        sum: ProbeSum<W>,
    }

    /// Ports of `bump_texel`.
    pub struct BumpTexelInput<W> {
        /// The texel.
        codes: BumpCodes<W>,
        /// Scales of the map.
        #[per(Object)]
        scale: BumpScale<W>,
    }

    /// Ports of `bump_ramp`.
    pub struct BumpRampInput<W> {
        /// The sample.
        sample: BumpSample<W>,
        /// b₁, b₂ of the texels (0,0), (1,0), (0,1), (1,1) on the finer level.
        #[range(-1..=1)]
        fine: [[Control<W, 2>; 2]; 4],
        /// b₁, b₂ of the texels (0,0), (1,0), (0,1), (1,1) on the coarser level.
        #[range(-1..=1)]
        coarse: [[Control<W, 2>; 2]; 4],
        /// Weight of the coarser level.
        #[range(0..1)]
        level_weight: Control<W, LEVEL_WEIGHT>,
        /// Part of a texel of level 0 that the probe spans across.
        #[range(0..=1)]
        reach: Control<W, SHARE>,
    }

    /// Ports of `bump`.
    pub struct BumpInput<W> {
        /// Mean of the footprint.
        mean: BumpMoments<W>,
        /// Scales of the map.
        #[per(Object)]
        scale: BumpScale<W>,
    }

    /// Ports of `colour`.
    pub struct ColourInput<W> {
        /// Mean of 16-bit texels, 8 more fraction bits.
        #[range(0..=16777215)]
        sample: Int<W>,
        /// log₂ of the unit of the map's channels.
        #[per(Object)]
        #[range(0..=6)]
        exponent: Int<W>,
    }

    /// Ports of `modulated`.
    pub struct ModulatedInput<W> {
        /// Colours below 64, or 64 from a peak.
        #[range(0..=64)]
        colours: [Control<W, LIGHT>; 2],
    }

    /// Ports of `lobe_law`.
    pub struct LobeLawInput<W> {
        /// Law of the finer level.
        fine: LobeLaw<W>,
        /// Law of the coarser level.
        coarse: LobeLaw<W>,
        /// Weight of the coarser level, [0, 1).
        #[range(0..1)]
        level_weight: Control<W, LEVEL_WEIGHT>,
    }

    /// Ports of `lobe`.
    pub struct LobeInput<W> {
        /// The tangents of the roughness.
        rough: [Block<W, 3>; 2],
        /// Width of the lobe relative to the roughness.
        #[range(0..=4)]
        width: Control<W, OFFSET>,
    }

    /// Ports of `lobes`.
    pub struct LobesInput<W> {
        /// Colour of each lobe.
        #[range(0..64)]
        colours: [Control<W, LIGHT>; 2],
        /// Weight of the first lobe.
        #[range(0..=1)]
        weight: Control<W, SHARE>,
    }

    /// Ports of `blend`.
    pub struct BlendInput<W> {
        /// Colour of the surface, below 64.
        #[range(0..64)]
        surface: Control<W, LIGHT>,
        /// Colour of the reflection, below 64.
        #[range(0..64)]
        reflection: Control<W, LIGHT>,
        /// Reflectance, [0, 1].
        #[range(0..=1)]
        reflectance: Control<W, REFLECTANCE>,
    }

    /// Ports of `bright_blend`.
    pub struct BrightBlendInput<W> {
        /// Colour of the surface, below 64.
        #[range(0..64)]
        surface: Control<W, LIGHT>,
        /// Mean of bright texels.
        #[range(0..=2147483647)]
        mean: Int<W>,
        /// log₂ of the unit of the map's channels.
        #[per(Object)]
        #[range(7..=20)]
        exponent: Int<W>,
        /// Reflectance, [0, 1].
        #[range(0..=1)]
        reflectance: Control<W, REFLECTANCE>,
    }

    /// Ports of `local`: blocks between stages, whose exponents may be sums of those of blocks of zeros.
    pub struct LocalInput<W> {
        /// The direction, any length.
        direction: Block<W, 3>,
        /// E₁ and E₂ in units of the mantissas of n.
        frame: TangentFrame<W>,
        /// n.
        normal: Block<W, 3>,
    }

    /// Ports of `peak`.
    pub struct StoredPeakInput<W> {
        /// Half vector in the tangent basis of the surface.
        half: LocalDirection<W>,
        /// Peak as a memory holds it.
        words: [Int<W>; 3],
        /// Its share of the fragment, [0, 1].
        #[range(0..=1)]
        weight: Control<W, SHARE>,
        /// The sum so far.
        sum: PeakSum<W>,
    }

    /// Ports of `horizon`.
    pub struct HorizonInput<W> {
        /// Direction of the light in the tangent basis of the surface, any length.
        light: Block<W, 3>,
        /// Direction of the eye, likewise.
        eye: Block<W, 3>,
        /// Horizon of a peak as it is stored.
        horizon: Horizon<W>,
    }

    /// Ports of `pixel_sum`.
    pub struct PixelSumInput<W> {
        /// The light so far.
        sum: PixelSum<W>,
        /// One more colour.
        #[range(0..=64)]
        colour: Control<W, LIGHT>,
    }
}
