//! Ports of the datapath: everything that enters or leaves it, each declared once.
//!
//! A declaration gives the bundle of wires ([`SurfaceInput`]), the same in `fixed` types for a soft core or a host ([`SurfaceIn`]),
//! the paths of the hardware's ports, the columns of the vectors with their rows in FORMAT.md, and the ranges that the proof starts
//! from. This is the only file of the datapath that names `fixed`. Every bit pattern of every input port has one
//! documented result. A direction or a derivative is a [`BlockVector`]: three mantissas and one exponent, so that
//! neither tiny nor huge values lose bits. A profile keeps `fraction_bits` of the fraction of the largest component; lower
//! bits are rounded away on entry. Where its words have 16 bits, the hardware's ports have as many: of a `fixed` port it reads the upper half,
//! rounded to nearest ([`crate::width`]).

use fixed::types::{I1F15, I2F30, I4F12, I4F28, I6F26, I8F24, I16F16, U0F32};

use crate::block::{MANTISSA, Mantissa};
use crate::bundle::bundle;
use crate::fx::Fx;
use crate::scalar::Scalar;

/// Bits before the point of an offset or a roughness: I4F28, ±8.
pub const OFFSET: u32 = 4;
/// Bits before the point of a probe's place or step: I4F28, map units.
pub const POSITION: u32 = 4;
/// Bits before the point of a level of detail: I16F16.
pub const LOD: u32 = 16;
/// Bits before the point of linear light: I8F24.
pub const LIGHT: u32 = 8;
/// Bits before the point of a slope, ±8: I6F26.
pub const SLOPE: u32 = 6;
/// Bits before the point of a weight or a visibility in [0, 1]: I16F16.
pub const SHARE: u32 = 16;
/// Bits before the point of a reflectance in [0, 1]: I16F16.
pub const REFLECTANCE: u32 = 16;
/// Bits before the point of a component of a stored normal, I1F15 on a word of 32 bits.
pub const STORED_NORMAL: u32 = 17;
/// Bits before the point of a stored slope, I4F12 on a word of 32 bits.
pub const STORED_SLOPE: u32 = 20;

/// A scalar port: the `fixed` types of a structure of wires.
pub trait Port: Copy {
    /// The wires.
    type Wires: Copy;
    /// The port on wires.
    fn wires(&self) -> Self::Wires;
    /// The wires as a port.
    fn of(wires: &Self::Wires) -> Self;
}

macro_rules! fixed_ports {
    ($($fixed:ty: $int:expr;)*) => {
        $(impl Port for $fixed {
            type Wires = Fx<Scalar, { $int }>;
            #[inline]
            fn wires(&self) -> Self::Wires {
                Fx::from_raw(self.to_bits().into())
            }
            #[inline]
            fn of(wires: &Self::Wires) -> Self {
                Self::from_bits(wires.raw() as _)
            }
        })*
    };
}

fixed_ports! {
    I2F30: MANTISSA;
    I4F28: OFFSET;
    I6F26: SLOPE;
    I8F24: LIGHT;
    I16F16: SHARE;
    I1F15: STORED_NORMAL;
    I4F12: STORED_SLOPE;
}

macro_rules! integer_ports {
    ($($integer:ty),*) => {
        $(impl Port for $integer {
            type Wires = Fx<Scalar, 32>;
            #[inline]
            fn wires(&self) -> Self::Wires {
                Fx::from_raw(*self as i32)
            }
            #[inline]
            fn of(wires: &Self::Wires) -> Self {
                wires.raw() as Self
            }
        })*
    };
}

integer_ports!(u8, u16, u32, i16);

impl Port for U0F32 {
    type Wires = Fx<i64, 32>;
    #[inline]
    fn wires(&self) -> Self::Wires {
        Fx::from_raw(self.to_bits().into())
    }
    #[inline]
    fn of(wires: &Self::Wires) -> Self {
        Self::from_bits(wires.raw() as u32)
    }
}

impl<P: Port, const N: usize> Port for [P; N] {
    type Wires = [P::Wires; N];
    #[inline]
    fn wires(&self) -> Self::Wires {
        self.map(|port| port.wires())
    }
    #[inline]
    fn of(wires: &Self::Wires) -> Self {
        wires.map(|wires| P::of(&wires))
    }
}

bundle! {
    /// A vector as it comes through a port: any alignment, any exponent. Component i is `mantissa[i] · 2^exponent`.
    ///
    /// What leaves has its largest component in [½, 1] by size; all-zero
    /// outputs have exponent 0, and an exponent beyond 16 bits is saturated.
    pub struct PortBlock<W, const N: usize> {
        /// mantissa
        mantissa: [Mantissa<W>; N],
        /// exponent of two
        #[range(-32768..=32767)]
        exponent: Int<W>,
    }
}

/// Components with one shared exponent; component `i` is `mantissa[i] · 2^exponent`.
///
/// Units: those of the quantity. Range: any; what enters with an exponent beyond ±2^11 is read as with that one. Outputs have their
/// largest component in [½, 1] by size; all-zero outputs have exponent 0, and an exponent beyond 16 bits is saturated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockPort<const N: usize> {
    /// Components, I2F30.
    pub mantissa: [I2F30; N],
    /// Power of two of the block.
    pub exponent: i16,
}

/// Three components with one shared exponent.
pub type BlockVector = BlockPort<3>;
/// Two components with one shared exponent, the planar companion of [`BlockVector`].
pub type BlockPair = BlockPort<2>;
/// One number with an exponent.
pub type BlockNumber = BlockPort<1>;

impl<const N: usize> Default for BlockPort<N> {
    fn default() -> Self {
        Self { mantissa: [I2F30::ZERO; N], exponent: 0 }
    }
}

impl<const N: usize> Port for BlockPort<N> {
    type Wires = PortBlock<Scalar, N>;
    #[inline]
    fn wires(&self) -> Self::Wires {
        PortBlock { mantissa: self.mantissa.wires(), exponent: self.exponent.wires() }
    }
    #[inline]
    fn of(wires: &Self::Wires) -> Self {
        Self { mantissa: Port::of(&wires.mantissa), exponent: Port::of(&wires.exponent) }
    }
}

bundle! {
    /// What the surface of a fragment is made of, the same for its reflection and its lights.
    #[ports(SurfaceIn: Default)]
    pub struct SurfaceInput<W> {
        /// surface normal n, any length
        #[unit = "length"]
        #[port = BlockVector]
        normal: PortBlock<W, 3>,
        /// vector v from the surface to the eye, any length
        #[unit = "length"]
        #[port = BlockVector]
        view: PortBlock<W, 3>,
        /// frame vectors: the main direction h in slot 0 (system 3), or p_u and p_v (systems 1 and 2)
        #[unit = "length"]
        #[port = [BlockVector; 2]]
        frame_vectors: [PortBlock<W, 3>; 2],
        /// bump offsets b₁, b₂, relative to |n|; `fraction_bits` − 2 fraction bits are kept
        #[unit = "|n|"]
        #[components = "12"]
        #[port = [I4F28; 2]]
        offset: [Fx<W, OFFSET>; 2],
        /// roughness d₁, d₂, d₃ (K = D Dᵀ, D = [[d₁, d₂], [0, d₃]]), relative to |n|; isotropic: I₁ in the first, alone
        #[unit = "|n|"]
        #[components = "123"]
        #[port = [I4F28; 3]]
        roughness: [Fx<W, OFFSET>; 3],
    }
}

bundle! {
    /// Inputs of the reflection datapath for one fragment.
    #[ports(ReflectionIn: Default)]
    pub struct ReflectionInput<W> {
        /// the surface
        #[port = SurfaceIn]
        surface: SurfaceInput<W>,
        /// ∂v/∂x (one pixel to the right) and ∂v/∂y (one pixel down)
        #[unit = "length per pixel"]
        #[port = [BlockVector; 2]]
        dview: [PortBlock<W, 3>; 2],
        /// ∂n/∂x and ∂n/∂y, in the units of n
        #[unit = "length per pixel"]
        #[port = [BlockVector; 2]]
        dnormal: [PortBlock<W, 3>; 2],
        /// edge of a face of the environment at level 0; 0 reads as 1, more than 16384 as 16384
        #[unit = "texels"]
        #[range(0..=65535)]
        #[port = u16]
        edge_texels: Int<W>,
    }
}

bundle! {
    /// What every stage of the reflection datapath makes of one fragment, in the order of the pipeline.
    #[ports(ReflectionOut: Default)]
    pub struct ReflectionOutput<W> {
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
        /// reflected vector r = 2 n_mod⟨v·n_mod⟩ − v|n_mod|²
        #[unit = "length³"]
        #[stage = "reflect"]
        #[port = BlockVector]
        reflected: PortBlock<W, 3>,
        /// d(s, t) for ∂x, ∂y and the roughness tangents d₁E₁, d₂E₁ + d₃E₂ (isotropic: I₁E₁, I₁E₂)
        #[unit = "half faces per pixel; half faces"]
        #[stage = "columns"]
        #[port = [BlockPair; 4]]
        columns: [PortBlock<W, 2>; 4],
        /// a, b, c of the covariance K = [[a, b], [b, c]] on the plane of the face
        #[unit = "half faces²"]
        #[stage = "ellipse"]
        #[components = "abc"]
        #[port = BlockVector]
        covariance: PortBlock<W, 3>,
        /// det K
        #[unit = "half faces⁴"]
        #[stage = "ellipse"]
        #[port = BlockNumber]
        determinant: PortBlock<W, 1>,
        /// λ₁, standard deviation along the major axis
        #[unit = "half faces"]
        #[stage = "axes"]
        #[port = BlockNumber]
        major: PortBlock<W, 1>,
        /// λ₂, standard deviation along the minor axis
        #[unit = "half faces"]
        #[stage = "axes"]
        #[port = BlockNumber]
        minor: PortBlock<W, 1>,
        /// unit direction of λ₁ in (s, t)
        #[unit = "1"]
        #[stage = "axes"]
        #[components = "st"]
        #[range(-1..=1)]
        #[port = [I2F30; 2]]
        direction: [Mantissa<W>; 2],
        /// face 0 to 5: +x, −x, +y, −y, +z, −z
        #[unit = "1"]
        #[out = "cube_face"]
        #[range(0..=5)]
        #[port = u8]
        face: Int<W>,
        /// s (to the right) and t (down) on the face, −1 to 1
        #[unit = "half faces"]
        #[out = "cube_face"]
        #[components = "st"]
        #[range(-1..=1)]
        #[port = [I2F30; 2]]
        st: [Mantissa<W>; 2],
        /// number of probes, 1 to 16
        #[unit = "1"]
        #[out = "probes"]
        #[range(1..=16)]
        #[port = u8]
        probes: Int<W>,
        /// step from one probe to the next, in s and t
        #[unit = "half faces"]
        #[out = "probes"]
        #[components = "st"]
        #[range(-7..=7)]
        #[port = [I4F28; 2]]
        step: [Control<W, POSITION>; 2],
        /// level of detail, 0 to log₂ of the edge
        #[unit = "levels"]
        #[out = "probes"]
        #[keeps(Lod)]
        #[range(0..=14)]
        #[port = I16F16]
        lod: Control<W, LOD>,
        /// sweep of a footprint on the sphere, all of one exponent: centre, first and second. Probe i looks along centre + x·first + x²·second,
        /// x the i-th of N places of the normal law
        #[unit = "1"]
        #[out = "sweep"]
        #[range(-1..=1)]
        #[port = [[I2F30; 3]; 3]]
        sweep: [[Mantissa<W>; 3]; 3],
        /// how far probe i has gone from the i-th of N − 1 places, of which the middle counts twice or a new one stands there, to the i-th of N
        #[unit = "1"]
        #[out = "sweep"]
        #[range(0..=1)]
        #[port = I16F16]
        share: Control<W, SHARE>,
        /// level of detail in the middle of a face for a direction of length 1 in units of the sweep; not saturated
        #[unit = "levels"]
        #[out = "sweep"]
        #[range(-20000..=20000)]
        #[port = I16F16]
        level: Control<W, LOD>,
        /// sticky bits
        #[unit = "bits"]
        #[out = "status"]
        #[range(0..256)]
        #[port = u32]
        status: Int<W>,
    }
}

bundle! {
    /// Inputs of the texture footprint for one fragment.
    #[ports(TextureIn: Default)]
    pub struct TextureInput<W> {
        /// texture coordinates in repeats of the map, modulo 1 (repeat addressing)
        #[unit = "repeats"]
        #[range(0..1)]
        #[port = [U0F32; 2]]
        uv: [WideControl<W, 32>; 2],
        /// ∂(u, v)/∂x and ∂(u, v)/∂y
        #[unit = "repeats per pixel"]
        #[port = [BlockPair; 2]]
        duv: [PortBlock<W, 2>; 2],
    }
}

bundle! {
    /// One peak of a distribution of normals as maps store it: a·max(0, N·H)ⁿ, in 10 bytes.
    ///
    /// A code of 16 bits holds an exponent c in its upper 4 bits and a fraction f in its lower 12: f units where c = 0, else
    /// (4096 + f)·2^(c − 1) units. It is monotone, and a number of at least 4096 units is within 2^−13 of what was stored.
    #[ports(StoredPeak: Default)]
    pub struct Peak<W> {
        /// stored peak: N in the frame of the surface (E₁, E₂, n), of unit length within 2^−15 and in direction within 2^−15.2 rad.
        /// Of another length: 1 − |N − H|²/2 stands for the cosine
        #[unit = "1"]
        #[components = "xyz"]
        #[range(-1..1)]
        #[port = [I1F15; 3]]
        normal: [Control<W, STORED_NORMAL>; 3],
        /// stored peak: amplitude a, a code: 0 or from 2^−21 to below 64; within 2^−13 from 2^−9 on, 2^−22 below. A larger one was
        /// saturated: facets of amplitude 15 beyond 76°, for they count 1/n_z times
        #[unit = "2^−21"]
        #[range(0..=65535)]
        #[port = u16]
        amplitude: Int<W>,
        /// stored peak: exponent n, a code: from 1 to 8192 within 2^−13, which changes a power by 2^−14.4 at most. The other codes,
        /// 0 to 16 382, count as they read
        #[unit = "2^−13"]
        #[range(0..=65535)]
        #[port = u16]
        exponent: Int<W>,
    }
}

bundle! {
    /// The horizon of a peak as maps store it, towards −x, +x, −y, +y of the local frame, in 16 bytes.
    ///
    /// The share of facets that a direction of slope s = z/|x| clears rises from 0 at `low` to 1 over the width: as a straight line
    /// where the plan takes the product, else as 1 − (1 − t)². `setup::stored_horizon` makes one for either.
    #[ports(StoredHorizon)]
    pub struct Horizon<W> {
        /// stored horizon of −x, +x, −y, +y: slope at which the ramp begins, or of the step; within 2^−13, cut to ±8
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
}

bundle! {
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
        #[port = Shininess]
        shininess: ShininessPort<W>,
    }
}

bundle! {
    /// What every stage of the highlight of one light makes of one fragment. What belongs to roughness is zero, and the amplitude 1,
    /// where the plan has none.
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
}

bundle! {
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
        /// its horizon
        #[port = StoredHorizon]
        horizon: Horizon<W>,
        /// share of the fragment that the peak has, saturated to 0 to 1
        #[unit = "1"]
        #[port = I16F16]
        weight: Control<W, SHARE>,
    }
}

bundle! {
    /// What every stage of one light on one peak makes of one fragment. What belongs to the horizon is zero, and the visibility 1,
    /// where the plan has none.
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
        /// h along E₁, E₂ and n, at unit length; zero where h or the frame is
        #[unit = "1"]
        #[stage = "local"]
        #[components = "xyz"]
        #[range(-1..=1)]
        #[port = [I2F30; 3]]
        local_half: [Mantissa<W>; 3],
        /// l along E₁, E₂ and n, at any length
        #[unit = "length"]
        #[stage = "local"]
        #[port = BlockVector]
        local_light: PortBlock<W, 3>,
        /// v along E₁, E₂ and n, at any length
        #[unit = "length"]
        #[stage = "local"]
        #[port = BlockVector]
        local_eye: PortBlock<W, 3>,
        /// slopes z/|x| and z/|y| of l, then of v, cut to ±8
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
        /// light that the peak returns, 0 to below 64; 0 where the light is on the horizon of n or below it, and where any of n,
        /// v, l, h or the frame is zero
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

/// A probe of a footprint on an environment: where it reads, and how much that counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CubeProbe {
    /// Face 0 to 5: +x, −x, +y, −y, +z, −z.
    pub face: u8,
    /// s (to the right) and t (down) on it, −1 to 1, half faces.
    pub st: [I4F28; 2],
    /// Share of the footprint; those of one footprint sum to exactly 1.
    pub weight: I16F16,
}

/// A probe of a footprint in a repeated map: where it reads, and how much that counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapProbe {
    /// Texture coordinates in repeats, modulo 1.
    pub uv: [U0F32; 2],
    /// Share of the footprint; those of one footprint sum to exactly 1.
    pub weight: I16F16,
}

/// Linear light of three channels.
pub type Light = [I8F24; 3];
/// A place on a face of an environment, s and t.
pub type FacePlace = [I2F30; 2];
/// A level of detail.
pub type Level = I16F16;
