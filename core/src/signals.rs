//! Signals between stages: what one block hands to the next.
//!
//! Stages never import each other; they import these bundles, and [`crate::datapath`] passes them on.

use crate::block::{Block, Mantissa};
use crate::bundle::bundle;
use crate::fx::{Fx, Wide};
use crate::word::{Wire, Word};

/// Fraction bits of an offset or a roughness: I4F28, ±8.
pub const OFFSET: u32 = 28;

/// A vector as it comes through a port: any alignment, any exponent.
#[derive(Clone, Copy, Debug)]
pub struct PortBlock<W: Word, const N: usize> {
    /// Mantissas.
    pub mantissa: [Mantissa<W>; N],
    /// Exponent.
    pub exponent: Fx<W, 0>,
}

bundle!(PortBlock<N> { mantissa, exponent });

/// Tangents in units of the mantissas of n.
#[derive(Clone, Copy, Debug)]
pub struct Frame<W: Word> {
    /// E₁.
    pub e1: Block<W, 3>,
    /// E₂.
    pub e2: Block<W, 3>,
    /// n and the frame vectors span nothing.
    pub pole: W::Flag,
}

bundle!(Frame { e1, e2; flag pole });

/// Reflected vector and the scalars the footprint needs again.
#[derive(Clone, Copy, Debug)]
pub struct Reflected<W: Word> {
    /// r, exponent included.
    pub r: Block<W, 3>,
    /// ⟨v·n⟩ and |n|² of the mantissas; their exponent is in −2…2 unless both are zero.
    pub scalars: Block<W, 2>,
    /// ⟨v·n⟩ ≤ 0: seen from below.
    pub below: W::Flag,
}

bundle!(Reflected { r, scalars; flag below });

/// The decisions of the face selection; they permute any vector into the coordinates of the face.
#[derive(Clone, Copy, Debug)]
pub struct FaceSelect<W: Word> {
    /// The major axis is z.
    pub is_z: W::Flag,
    /// The major axis is y.
    pub is_y: W::Flag,
    /// The major component is negative.
    pub negative: W::Flag,
}

bundle!(FaceSelect { ; flag is_z, is_y, negative });

impl<W: Word> FaceSelect<W> {
    /// (s_c, t_c, m) of a vector in the coordinates of the selected face; m is along its outward axis.
    ///
    /// | face | s_c | t_c | | face | s_c | t_c |
    /// |------|-----|-----|-|------|-----|-----|
    /// | +x   | −z  | −y  | | −x   | +z  | −y  |
    /// | +y   | +x  | +z  | | −y   | +x  | −z  |
    /// | +z   | +x  | −y  | | −z   | −x  | −y  |
    #[inline(always)]
    pub fn to_face<X: Wire<Flag = W::Flag>, const FRAC: u32>(&self, vector: [Fx<X, FRAC>; 3]) -> [Fx<X, FRAC>; 3] {
        let [x, y, z] = vector;
        let major = Fx::select(self.is_z, z, Fx::select(self.is_y, y, x));
        let s_c =
            Fx::select(self.is_z, x.negate_if(self.negative), Fx::select(self.is_y, x, (-z).negate_if(self.negative)));
        let t_c = Fx::select(self.is_y, z.negate_if(self.negative), -y);
        [s_c, t_c, major.negate_if(self.negative)]
    }

    /// The inverse of [`Self::to_face`].
    #[inline(always)]
    pub fn from_face<X: Wire<Flag = W::Flag>, const FRAC: u32>(&self, face: [Fx<X, FRAC>; 3]) -> [Fx<X, FRAC>; 3] {
        let [s_c, t_c, m] = face;
        let major = m.negate_if(self.negative);
        let x = Fx::select(self.is_z, s_c.negate_if(self.negative), Fx::select(self.is_y, s_c, major));
        let y = Fx::select(self.is_y, major, -t_c);
        let z = Fx::select(
            self.is_z,
            major,
            Fx::select(self.is_y, t_c.negate_if(self.negative), (-s_c).negate_if(self.negative)),
        );
        [x, y, z]
    }

    /// Face number 0…5 in Vulkan's order +x, −x, +y, −y, +z, −z.
    #[inline(always)]
    pub fn index(&self) -> Fx<W, 0> {
        let axis = Fx::select(self.is_z, Fx::lit(4), Fx::select(self.is_y, Fx::lit(2), Fx::zero()));
        axis + Fx::select(self.negative, Fx::lit(1), Fx::zero())
    }

    /// The decisions of face number 0…5.
    #[inline(always)]
    pub fn of_index(face: Fx<W, 0>) -> Self {
        let is_z = !face.lt(Fx::lit(4));
        let odd = face - face.floor_shr(1).shl(1);
        Self { is_z, is_y: !is_z & !face.lt(Fx::lit(2)), negative: !odd.is_zero() }
    }
}

/// A point of the cube.
#[derive(Clone, Copy, Debug)]
pub struct CubePoint<W: Word> {
    /// Face selection.
    pub select: FaceSelect<W>,
    /// s, t in [−1, 1], kept fraction bits p.
    pub st: [Mantissa<W>; 2],
    /// 1/(2m) for the major mantissa m in [½, 1].
    pub half_reciprocal: Mantissa<W>,
    /// Two or three components tie for the largest.
    pub tie: W::Flag,
}

bundle!(CubePoint { select, st, half_reciprocal; flag tie });

/// Covariance of the footprint.
#[derive(Clone, Copy, Debug)]
pub struct Ellipse<W: Word> {
    /// a, b, c of K = [[a, b], [b, c]].
    pub k: Block<W, 3>,
    /// det K ≥ 0.
    pub det: Block<W, 1>,
}

bundle!(Ellipse { k, det });

/// Main axes of the footprint.
#[derive(Clone, Copy, Debug)]
pub struct Axes<W: Word> {
    /// λ₁, standard deviation along the major axis.
    pub major: Block<W, 1>,
    /// λ₂ ≤ λ₁.
    pub minor: Block<W, 1>,
    /// Unit direction of the major axis in (s, t).
    pub direction: [Mantissa<W>; 2],
}

bundle!(Axes { major, minor, direction });

/// Fraction bits of a probe position or step: I4F28, map units.
pub const POSITION: u32 = 28;
/// Fraction bits of a level of detail.
pub const LOD: u32 = 16;

/// The probes of one footprint; [`position`](crate::stage::probes::position) gives each one's place.
#[derive(Clone, Copy, Debug)]
pub struct Probes<W: Word> {
    /// N, 1…16.
    pub count: Fx<W, 0>,
    /// From one probe to the next, map units.
    pub step: [Fx<W, POSITION>; 2],
    /// Level of detail, 0 … the last level of the map, `lod_bits` kept fraction bits.
    pub lod: Fx<W, LOD>,
    /// No footprint at all.
    pub empty: W::Flag,
    /// λ₁ was cut to 2 map units.
    pub saturated: W::Flag,
    /// λ₂ was raised.
    pub capped: W::Flag,
}

bundle!(Probes { count, step, lod; flag empty, saturated, capped });

/// Map constants of the level of detail.
#[derive(Clone, Copy, Debug)]
pub struct MapScale<W: Word> {
    /// log₂ of the texels of level 0 in one map unit.
    pub log2_texels: Fx<W, LOD>,
    /// The last (coarsest) level.
    pub last_level: Fx<W, 0>,
}

bundle!(MapScale { log2_texels, last_level });

/// Where a probe of an environment footprint reads: face number, and s, t in [−1, 1] on it.
#[derive(Clone, Copy, Debug)]
pub struct FacePosition<W: Word> {
    /// Face 0…5.
    pub face: Fx<W, 0>,
    /// Position on it.
    pub st: [Fx<W, POSITION>; 2],
}

bundle!(FacePosition { face, st });

/// Where a probe of a texture footprint reads: repeats of the map modulo 1, unsigned.
#[derive(Clone, Copy, Debug)]
pub struct TexturePosition<W: Word> {
    /// u, v in [0, 1).
    pub uv: [Wide<W, 32>; 2],
}

bundle!(TexturePosition { ; wide uv });

/// Fraction bits of linear light: I8F24.
pub const LIGHT: u32 = 24;
/// Fraction bits of a component of a stored normal: I1F15.
pub const STORED_NORMAL: u32 = 15;
/// Fraction bits of a stored slope: I4F12.
pub const STORED_SLOPE: u32 = 12;
/// Fraction bits of a slope on its wire, ±8.
pub const SLOPE: u32 = 26;
/// Fraction bits of a weight or a visibility in [0, 1].
pub const SHARE: u32 = 16;

/// A direction in the frame of a surface: along E₁, E₂ and n.
#[derive(Clone, Copy, Debug)]
pub struct LocalDirection<W: Word> {
    /// Unit length, or zero where there is none.
    pub unit: [Mantissa<W>; 3],
    /// The direction or the frame is zero.
    pub none: W::Flag,
}

bundle!(LocalDirection { unit; flag none });

/// On which side of a surface a light stands.
#[derive(Clone, Copy, Debug)]
pub struct LightSide<W: Word> {
    /// n·l ≤ 0: it lights nothing.
    pub below: W::Flag,
    /// l = 0.
    pub none: W::Flag,
}

bundle!(LightSide { ; flag below, none });

/// A peak as it is stored; [`crate::ports::StoredPeak`] describes each number.
#[derive(Clone, Copy, Debug)]
pub struct Peak<W: Word> {
    /// N.
    pub normal: [Fx<W, STORED_NORMAL>; 3],
    /// a, a code of 16 bits.
    pub amplitude: Fx<W, 0>,
    /// n, a code of 16 bits.
    pub exponent: Fx<W, 0>,
}

bundle!(Peak { normal, amplitude, exponent });

/// Light of the peaks so far.
#[derive(Clone, Copy, Debug)]
pub struct PeakSum<W: Word> {
    /// Their sum, below 64.
    pub light: Fx<W, LIGHT>,
    /// It was cut to the largest number below 64.
    pub saturated: W::Flag,
}

bundle!(PeakSum { light; flag saturated });

/// Slope of a direction over one axis of its surface.
#[derive(Clone, Copy, Debug)]
pub struct AxisSlope<W: Word> {
    /// z/|x|, cut to ±8.
    pub slope: Fx<W, SLOPE>,
    /// It points to the negative side.
    pub negative: W::Flag,
    /// x = 0: to neither side.
    pub upright: W::Flag,
}

bundle!(AxisSlope { slope; flag negative, upright });

/// A horizon as it is stored, towards −x, +x, −y, +y; [`crate::ports::StoredHorizon`] describes each number.
#[derive(Clone, Copy, Debug)]
pub struct Horizon<W: Word> {
    /// Slope at which the ramp begins, or of the step.
    pub low: [Fx<W, STORED_SLOPE>; 4],
    /// Inverse width of the ramp, a code of 16 bits; 0 is a step.
    pub inverse_width: [Fx<W, 0>; 4],
}

bundle!(Horizon { low, inverse_width });

/// The exponent m of a highlight as the host prepares it, once per material; [`crate::ports::Shininess`] describes it.
#[derive(Clone, Copy, Debug)]
pub struct ShininessPort<W: Word> {
    /// m.
    pub exponent: Fx<W, 16>,
    /// √m.
    pub root: Fx<W, 24>,
}

bundle!(ShininessPort { exponent, root });

/// The exponent m of a highlight, normalised.
#[derive(Clone, Copy, Debug)]
pub struct Shininess<W: Word> {
    /// m, 1…8192.
    pub exponent: Block<W, 1>,
    /// √m, 1…91.
    pub root: Block<W, 1>,
}

bundle!(Shininess { exponent, root });

/// What roughness does to a highlight, whatever the light: everything relative to |n_mod| and to the base deviation 1/√m.
#[derive(Clone, Copy, Debug)]
pub struct Spread<W: Word> {
    /// √m·d₁E₁/|n_mod| and √m·(d₂E₁ + d₃E₂)/|n_mod|.
    pub tangents: [Block<W, 3>; 2],
    /// 1/√D ≤ 1, D = det(I + mK).
    pub amplitude: Block<W, 1>,
    /// 1/D.
    pub reciprocal: Block<W, 1>,
}

bundle!(Spread { tangents, amplitude, reciprocal });

/// How much of a highlight a fragment shows.
#[derive(Clone, Copy, Debug)]
pub struct Lobe<W: Word> {
    /// f in [0, 1].
    pub f: Fx<W, LIGHT>,
    /// n·l ≤ 0.
    pub light_below: W::Flag,
    /// n_mod·h ≤ 0.
    pub half_below: W::Flag,
}

bundle!(Lobe { f; flag light_below, half_below });
