//! Ports of the datapath: all inputs and outputs, each declared once.
//!
//! A declaration gives the bundle of wires ([`SurfaceInput`]) and the same in `fixed` types for a soft core or a host ([`SurfaceIn`]). It also gives
//! the paths of the hardware's ports, the columns of the vectors with their rows in FORMAT.md, and the ranges from which the proof starts. Only these
//! files of the datapath name `fixed`. Every bit pattern of every input port has one documented result.
//!
//! A direction or a derivative is a [`BlockVector`]: three mantissas and one exponent, so that neither tiny nor huge values lose bits. A profile
//! keeps `fraction_bits` of the fraction of the largest component; lower bits are rounded away on entry. If its words have 16 bits, so have the
//! hardware's ports: they read the upper half of a `fixed` port, rounded to nearest ([`crate::width`]).

use fixed::types::{I1F15, I2F30, I4F12, I4F28, I6F26, I8F24, I16F16, U0F32};

use crate::block::{MANTISSA, Mantissa};
use crate::bundle::bundle;
use crate::fx::Fx;
use crate::scalar::Scalar;

mod light;

pub use light::*;

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
/// Bits before the point of a component of a stored normal, I1F15 on a 32-bit word.
pub const STORED_NORMAL: u32 = 17;
/// Bits before the point of a stored slope, I4F12 on a 32-bit word.
pub const STORED_SLOPE: u32 = 20;

/// A scalar port: the `fixed` types of a structure of wires.
pub trait Port: Copy {
    /// The wires.
    type Wires: Copy;
    /// Converts the port to wires.
    fn wires(&self) -> Self::Wires;
    /// Converts wires to a port.
    fn from_wires(wires: &Self::Wires) -> Self;
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
            fn from_wires(wires: &Self::Wires) -> Self {
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
            fn from_wires(wires: &Self::Wires) -> Self {
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
    fn from_wires(wires: &Self::Wires) -> Self {
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
    fn from_wires(wires: &Self::Wires) -> Self {
        wires.map(|wires| P::from_wires(&wires))
    }
}

bundle! {
    /// A vector at a port: any alignment, any exponent. Component i is `mantissa[i] · 2^exponent`.
    ///
    /// Outputs have their largest component in [½, 1] by size. All-zero outputs have exponent 0, and an exponent beyond 16 bits is saturated.
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
/// Units: those of the quantity. Range: any; an input with an exponent beyond ±2^11 is read with that exponent. Outputs have their largest component
/// in [½, 1] by size. All-zero outputs have exponent 0, and an exponent beyond 16 bits is saturated.
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
    fn from_wires(wires: &Self::Wires) -> Self {
        Self { mantissa: Port::from_wires(&wires.mantissa), exponent: Port::from_wires(&wires.exponent) }
    }
}

bundle! {
    /// Inputs of the surface of a fragment, the same for its reflection and its lights.
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
        #[per(Object)]
        #[range(0..=65535)]
        #[port = u16]
        edge_texels: Int<W>,
    }

    /// Outcomes of all stages of the reflection datapath for one fragment, in the order of the pipeline.
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
        /// sweep of a footprint on the sphere, with one exponent: centre, first and second. Probe i looks along centre + x·first +
        /// x²·second, where x is place i of N of the normal distribution
        #[unit = "1"]
        #[out = "sweep"]
        #[range(-1..=1)]
        #[port = [[I2F30; 3]; 3]]
        sweep: [[Mantissa<W>; 3]; 3],
        /// progress of probe i from its place among N − 1 to its place among N; the middle of the N − 1 places counts twice, or a new one lies there
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

/// A probe of a footprint on an environment: its place and weight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CubeProbe {
    /// Face 0 to 5: +x, −x, +y, −y, +z, −z.
    pub face: u8,
    /// s (to the right) and t (down) on the face, −1 to 1, half faces.
    pub st: [I4F28; 2],
    /// Share of the footprint; the shares of one footprint sum to exactly 1.
    pub weight: I16F16,
}

/// A probe of a footprint in a wrapped map: its place and weight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapProbe {
    /// Texture coordinates in repeats, modulo 1.
    pub uv: [U0F32; 2],
    /// Share of the footprint; the shares of one footprint sum to exactly 1.
    pub weight: I16F16,
}

/// Linear light of three channels.
pub type Light = [I8F24; 3];
/// Place on a face of an environment, s and t.
pub type FacePlace = [I2F30; 2];
/// Level of detail.
pub type Level = I16F16;
