//! Ports of lights: stored peaks and their horizons, highlights, lit peaks.

use fixed::types::{I1F15, I2F30, I4F12, I6F26, I8F24, I16F16};

use super::{
    BlockNumber, BlockVector, LIGHT, PortBlock, SHARE, SLOPE, STORED_NORMAL, STORED_SLOPE, SurfaceIn, SurfaceInput,
};
use crate::block::Mantissa;
use crate::bundle::bundle;
use crate::fx::Fx;

bundle! {
    /// One peak of a distribution of normals as maps store it: a·max(0, N·H)ⁿ, in 10 bytes.
    ///
    /// A 16-bit code holds an exponent c in its upper 4 bits and a fraction f in its lower 12: f units if c = 0, else (4096 + f)·2^(c − 1) units. It
    /// is monotone, and a number of at least 4096 units is within 2^−13 of the stored one.
    #[ports(StoredPeak: Default)]
    pub struct Peak<W> {
        /// stored peak: N in the tangent basis of the surface (E₁, E₂, n), of unit length within 2^−15 and in direction within 2^−15.2 rad.
        /// At any other length, 1 − |N − H|²/2 replaces the cosine
        #[unit = "1"]
        #[components = "xyz"]
        #[range(-1..1)]
        #[port = [I1F15; 3]]
        normal: [Control<W, STORED_NORMAL>; 3],
        /// stored peak: amplitude a, a code: 0 or from 2^−21 to below 64; within 2^−13 from 2^−9 on, 2^−22 below. Larger ones are
        /// saturated: facets of amplitude 15 beyond 76°, which count 1/n_z times
        #[unit = "2^−21"]
        #[range(0..=65535)]
        #[port = u16]
        amplitude: Int<W>,
        /// stored peak: exponent n, a code: from 1 to 8192 within 2^−13, which changes a power by 2^−14.4 at most. Other codes, 0 to
        /// 16 382, are read as they stand
        #[unit = "2^−13"]
        #[range(0..=65535)]
        #[port = u16]
        exponent: Int<W>,
    }

    /// Horizon of a peak as maps store it, towards −x, +x, −y, +y of the local tangent basis, in 16 bytes.
    ///
    /// The share of facets that a direction of slope s = z/|x| clears rises from 0 at `low` to 1 over the width. It rises as a straight line if the
    /// plan takes the product, else as 1 − (1 − t)². `setup::stored_horizon` makes a horizon for either.
    #[ports(StoredHorizon)]
    pub struct Horizon<W> {
        /// stored horizon of −x, +x, −y, +y: slope at which the ramp begins, or of the step; within 2^−13, clamped to ±8
        #[unit = "1"]
        #[range(-8..8)]
        #[port = [I4F12; 4]]
        low: [Control<W, STORED_SLOPE>; 4],
        /// stored horizon of each side: 1/width of the ramp, a code as of a peak: within 2^−13 from ¼ on (widths up to 4), 2^−15 below; 0
        /// is a step, visible at `low` and above
        #[unit = "2^−14"]
        #[range(0..=65535)]
        #[port = [u16; 4]]
        inverse_width: [Int<W>; 4],
    }
}

impl StoredHorizon {
    /// No horizon: every direction is visible.
    pub const OPEN: Self = Self { low: [I4F12::MIN; 4], inverse_width: [0; 4] };
}

impl Default for StoredHorizon {
    fn default() -> Self {
        Self::OPEN
    }
}

bundle! {
    /// The exponent m of a highlight: cos^m on a smooth surface. `setup::shininess` makes one.
    ///
    /// The datapath takes both numbers as they are: a √m that is not the root of m changes the base roughness alone.
    #[ports(Shininess: Default)]
    pub struct ShininessPort<W> {
        /// exponent m, saturated to 1…8192
        #[unit = "1"]
        #[port = I16F16]
        exponent: Control<W, 16>,
        /// √m, saturated to 1…91
        #[unit = "1"]
        #[port = I8F24]
        root: Control<W, 8>,
    }

    /// Inputs of the highlight of one light on one fragment.
    #[ports(HighlightIn: Default)]
    pub struct HighlightInput<W> {
        /// the surface
        #[port = SurfaceIn]
        surface: SurfaceInput<W>,
        /// vector l from the surface to the light, any length
        #[unit = "length"]
        #[port = BlockVector]
        light: PortBlock<W, 3>,
        /// exponent m
        #[per(Object)]
        #[port = Shininess]
        shininess: ShininessPort<W>,
    }

    /// Outcomes of all stages of the highlight of one light on one fragment. If the plan has no roughness, its outcomes are zero and the amplitude is
    /// 1.
    #[ports(HighlightOut: Default)]
    pub struct HighlightOutput<W> {
        /// tangents E₁ and E₂, scaled by |n|
        #[unit = "length"]
        #[stage = "frame"]
        #[port = [BlockVector; 2]]
        frame: [PortBlock<W, 3>; 2],
        /// perturbed normal n_mod
        #[unit = "length"]
        #[stage = "perturb"]
        #[port = BlockVector]
        normal_mod: PortBlock<W, 3>,
        /// roughness tangents d₁E₁ and d₂E₁ + d₃E₂ (isotropic: I₁E₁, I₁E₂), scaled by |n|
        #[unit = "length"]
        #[stage = "roughness"]
        #[components = "12"]
        #[port = [BlockVector; 2]]
        rough: [PortBlock<W, 3>; 2],
        /// half vector h = l/|l| + v/|v|
        #[unit = "1"]
        #[stage = "half"]
        #[port = BlockVector]
        half: PortBlock<W, 3>,
        /// √m/|n_mod| times `rough`: relative to |n_mod| and to the base deviation 1/√m
        #[unit = "1"]
        #[stage = "highlight"]
        #[components = "12"]
        #[port = [BlockVector; 2]]
        spread: [PortBlock<W, 3>; 2],
        /// 1/√det(I + mK)
        #[unit = "1"]
        #[stage = "highlight"]
        #[port = BlockNumber]
        amplitude: PortBlock<W, 1>,
        /// share of the light that the highlight returns, 0 to 1
        #[unit = "1"]
        #[out = "highlight"]
        #[range(0..=1)]
        #[port = I8F24]
        f: Control<W, LIGHT>,
        /// sticky bits
        #[unit = "bits"]
        #[out = "status"]
        #[range(0..4096)]
        #[port = u32]
        status: Int<W>,
    }

    /// Inputs of one light on one peak of a fragment; the peak brings its own normal and roughness.
    #[ports(PeakIn: Default)]
    pub struct PeakInput<W> {
        /// the surface
        #[port = SurfaceIn]
        surface: SurfaceInput<W>,
        /// vector l from the surface to the light, any length
        #[unit = "length"]
        #[port = BlockVector]
        light: PortBlock<W, 3>,
        /// the peak
        #[port = StoredPeak]
        peak: Peak<W>,
        /// horizon of the peak
        #[port = StoredHorizon]
        horizon: Horizon<W>,
        /// share of the fragment that belongs to the peak, saturated to [0, 1]
        #[unit = "1"]
        #[port = I16F16]
        weight: Control<W, SHARE>,
    }

    /// Outcomes of all stages of one light on one peak of a fragment. If the plan has no horizon, its outcomes are zero and the visibility is 1.
    #[ports(PeakOut: Default)]
    pub struct PeakOutput<W> {
        /// tangents E₁ and E₂, scaled by |n|
        #[unit = "length"]
        #[stage = "frame"]
        #[port = [BlockVector; 2]]
        frame: [PortBlock<W, 3>; 2],
        /// half vector h = l/|l| + v/|v|
        #[unit = "1"]
        #[stage = "half"]
        #[port = BlockVector]
        half: PortBlock<W, 3>,
        /// components of h along E₁, E₂ and n, at unit length; zero if h or the tangent basis is zero
        #[unit = "1"]
        #[stage = "local"]
        #[components = "xyz"]
        #[range(-1..=1)]
        #[port = [I2F30; 3]]
        local_half: [Mantissa<W>; 3],
        /// components of l along E₁, E₂ and n, at any length
        #[unit = "length"]
        #[stage = "local"]
        #[port = BlockVector]
        local_light: PortBlock<W, 3>,
        /// components of v along E₁, E₂ and n, at any length
        #[unit = "length"]
        #[stage = "local"]
        #[port = BlockVector]
        local_eye: PortBlock<W, 3>,
        /// slopes z/|x| and z/|y| of l, then of v, clamped to ±8
        #[unit = "1"]
        #[stage = "horizon"]
        #[range(-8..=8)]
        #[port = [[I6F26; 2]; 2]]
        slopes: [[Fx<W, SLOPE>; 2]; 2],
        /// share of the peak's facets that light and eye clear, 0 to 1
        #[unit = "1"]
        #[stage = "horizon"]
        #[range(0..=1)]
        #[port = I16F16]
        visibility: Control<W, SHARE>,
        /// light that the peak returns, 0 to below 64; 0 if the light is on the horizon of n or below it, or if n, v, l, h or the tangent
        /// basis is zero
        #[unit = "1"]
        #[out = "peaks"]
        #[range(0..64)]
        #[port = I8F24]
        peak: Control<W, LIGHT>,
        /// sticky bits
        #[unit = "bits"]
        #[out = "status"]
        #[range(0..16384)]
        #[port = u32]
        status: Int<W>,
    }
}
