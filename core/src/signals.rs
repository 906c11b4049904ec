//! Signals between stages: the bundles that one stage hands to the next.
//!
//! Stages never import each other. They import these bundles and those of [`crate::ports`]; [`crate::datapath`] passes them on.

use crate::block::{Block, Mantissa, Number};
use crate::bundle::bundle;
use crate::fx::{Fx, Int};
use crate::ports::{LIGHT, LOD, POSITION, SHARE, SLOPE};
use crate::word::{Wire, Word};

bundle! {
    /// Tangents in units of the mantissas of n.
    pub struct TangentFrame<W> {
        /// E₁.
        e1: Block<W, 3>,
        /// E₂.
        e2: Block<W, 3>,
        /// n and the frame vectors span nothing.
        pole: W::Flag,
    }

    /// Reflected vector, and the scalars that the footprint needs again.
    pub struct Reflected<W> {
        /// r, exponent included.
        r: Block<W, 3>,
        /// ⟨v·n⟩ and |n|² of the mantissas; their exponent is in −2…2 unless both are zero.
        scalars: Block<W, 2>,
        /// ⟨v·n⟩ ≤ 0: seen from below.
        below: W::Flag,
    }

    /// The decisions of the face selection; they permute any vector into the coordinates of the face.
    pub struct FaceSelect<W> {
        /// The major axis is z.
        is_z: W::Flag,
        /// The major axis is y.
        is_y: W::Flag,
        /// The major component is negative.
        negative: W::Flag,
    }
}

impl<W: Word> FaceSelect<W> {
    /// (s_c, t_c, m) of a vector in the coordinates of the selected face; m is along its outward axis.
    ///
    /// | face | s_c | t_c | | face | s_c | t_c |
    /// |------|-----|-----|-|------|-----|-----|
    /// | +x   | −z  | −y  | | −x   | +z  | −y  |
    /// | +y   | +x  | +z  | | −y   | +x  | −z  |
    /// | +z   | +x  | −y  | | −z   | −x  | −y  |
    #[inline(always)]
    pub fn to_face<X: Wire<Flag = W::Flag>, const INT: u32>(&self, vector: [Fx<X, INT>; 3]) -> [Fx<X, INT>; 3] {
        let [x, y, z] = vector;
        let major = Fx::select(self.is_z, z, Fx::select(self.is_y, y, x));
        let s_c =
            Fx::select(self.is_z, x.negate_if(self.negative), Fx::select(self.is_y, x, (-z).negate_if(self.negative)));
        let t_c = Fx::select(self.is_y, z.negate_if(self.negative), -y);
        [s_c, t_c, major.negate_if(self.negative)]
    }

    /// The inverse of [`Self::to_face`].
    #[inline(always)]
    pub fn from_face<X: Wire<Flag = W::Flag>, const INT: u32>(&self, face: [Fx<X, INT>; 3]) -> [Fx<X, INT>; 3] {
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
    pub fn index(&self) -> Int<W> {
        let axis = Fx::select(self.is_z, Fx::int(4), Fx::select(self.is_y, Fx::int(2), Fx::int(0)));
        axis + Fx::select(self.negative, Fx::int(1), Fx::int(0))
    }

    /// Decisions of face number 0…5.
    #[inline(always)]
    pub fn of_index(face: Int<W>) -> Self {
        let is_z = face.ge(Fx::int(4));
        let odd = face - face.floor_shr(1).shl(1);
        Self { is_z, is_y: !is_z & face.ge(Fx::int(2)), negative: !odd.is_zero() }
    }
}

bundle! {
    /// A point of the cube.
    pub struct CubePoint<W> {
        /// Face selection.
        select: FaceSelect<W>,
        /// s, t in [−1, 1], kept fraction bits p.
        #[range(-1..=1)]
        st: [Mantissa<W>; 2],
        /// 1/(2m) for the major mantissa m in [½, 1].
        #[range(0..=1)]
        half_reciprocal: Mantissa<W>,
        /// Two or three components tie for the largest.
        tie: W::Flag,
    }

    /// Covariance of the footprint.
    pub struct Ellipse<W> {
        /// a, b, c of K = [[a, b], [b, c]].
        k: Block<W, 3>,
        /// det K ≥ 0.
        det: Number<W>,
    }

    /// Main axes of the footprint.
    pub struct Axes<W> {
        /// λ₁, standard deviation along the major axis.
        major: Number<W>,
        /// λ₂ ≤ λ₁.
        minor: Number<W>,
        /// Unit direction of the major axis in (s, t).
        #[range(-1..=1)]
        direction: [Mantissa<W>; 2],
    }

    /// The probes of one footprint; [`position`](crate::stage::probes::position) gives each one's place.
    pub struct Probes<W> {
        /// N, 1…16.
        #[range(1..=16)]
        count: Int<W>,
        /// Step from one probe to the next, map units: |step| ≤ 2√3·λ₁ < 7 with λ₁ ≤ 2.
        #[range(-7..=7)]
        step: [Control<W, POSITION>; 2],
        /// Level of detail, 0 … the last level of the map, `lod_bits` kept fraction bits.
        #[range(0..=14)]
        lod: Control<W, LOD>,
        /// True if there is no footprint.
        empty: W::Flag,
        /// λ₁ was clamped to 2 map units.
        saturated: W::Flag,
        /// λ₂ was raised.
        capped: W::Flag,
    }

    /// Footprint of a fragment in a wrapped map.
    pub struct WrappedFootprint<W> {
        /// Probes of the footprint.
        probes: Probes<W>,
        /// Part of a texel of level 0 that each probe spans across: 2λ₂, but 1 if it is more, and 0 if no rough bumps are read.
        #[range(0..=1)]
        reach: Control<W, SHARE>,
    }

    /// Probe count of a footprint, and the width of its probes.
    pub struct CountAndLevel<W> {
        /// N, 1…16.
        #[range(1..=16)]
        count: Int<W>,
        /// Share of the way that the probes have gone, from the places for one probe less to their own places.
        #[range(0..=1)]
        share: Control<W, SHARE>,
        /// log₂ of the minor diameter in texels of level 0; −2^13 and less if there is no footprint.
        #[range(-8300..=8300)]
        level: Control<W, LOD>,
        /// λ₂ was raised.
        capped: W::Flag,
        /// True if there is no footprint.
        empty: W::Flag,
    }

    /// Directions that a normal's reflection sweeps as the normal moves along the major axis of its lobe: centre + x·first + x²·second at x standard
    /// deviations, all three of one exponent.
    pub struct Sweep<W> {
        /// r, moved to the mean of the lobe.
        centre: [Mantissa<W>; 3],
        /// First derivative of r along the sweep.
        first: [Mantissa<W>; 3],
        /// Bend of r along the sweep.
        second: [Mantissa<W>; 3],
        /// N, 1…16.
        #[range(1..=16)]
        count: Int<W>,
        /// Share of the way that the probes have gone, from the places for one probe less to their own places.
        #[range(0..=1)]
        share: Control<W, SHARE>,
        /// Level of detail of a probe in the middle of a face, for a direction of length 1 in units of these mantissas; not saturated.
        #[range(-20000..=20000)]
        level: Control<W, LOD>,
    }

    /// A probe on the sphere: its place, level of detail and weight.
    pub struct SphereProbe<W> {
        /// Place on the cube.
        place: FacePosition<W>,
        /// Level of detail, 0 … the last level of the map, `lod_bits` kept fraction bits.
        #[range(0..=14)]
        lod: Control<W, LOD>,
        /// Weight; the weights of one footprint sum to exactly 1.
        #[range(0..=1)]
        weight: Control<W, SHARE>,
    }

    /// Place of a probe relative to the centre of its footprint, map units.
    pub struct MapOffset<W> {
        /// |·| ≤ 3.5.
        #[range(-4..=4)]
        offset: [Control<W, POSITION>; 2],
    }

    /// Map constants of the level of detail. Faces of 1 to 16 384 texels: 2 map units across.
    pub struct MapScale<W> {
        /// log₂ of the number of level-0 texels in one map unit.
        #[range(-1..=13)]
        log2_texels: Control<W, LOD>,
        /// The last (coarsest) level.
        #[range(0..=14)]
        last_level: Int<W>,
    }

    /// Place of a probe of an environment footprint: face number, and s, t in [−1, 1] on the face.
    pub struct FacePosition<W> {
        /// Face 0…5.
        #[range(0..=5)]
        face: Int<W>,
        /// Position on the face.
        #[range(-1..=1)]
        st: [Control<W, POSITION>; 2],
    }

    /// Place of a probe of a texture footprint: repeats of the map modulo 1, unsigned.
    pub struct TexturePosition<W> {
        /// u, v in [0, 1).
        #[range(0..1)]
        uv: [WideControl<W, 32>; 2],
    }

    /// Direction in the tangent basis of a surface: along E₁, E₂ and n.
    pub struct LocalDirection<W> {
        /// Unit vector, or zero if there is none.
        #[range(-1..=1)]
        unit: [Mantissa<W>; 3],
        /// The direction or the tangent basis is zero.
        none: W::Flag,
    }

    /// Side of a surface on which a light stands.
    pub struct LightSide<W> {
        /// n·l ≤ 0: the light reaches no facet.
        below: W::Flag,
        /// l = 0.
        none: W::Flag,
    }

    /// Light of the peaks so far.
    pub struct PeakSum<W> {
        /// Sum of the light, below 64.
        #[range(0..64)]
        light: Control<W, LIGHT>,
        /// The sum was clamped to the largest number below 64.
        saturated: W::Flag,
    }

    /// Slope of a direction over one axis of its surface.
    pub struct AxisSlope<W> {
        /// z/|x|, clamped to ±8.
        #[range(-8..=8)]
        slope: Fx<W, SLOPE>,
        /// The direction points to the negative side.
        negative: W::Flag,
        /// x = 0: the direction points to neither side.
        upright: W::Flag,
    }

    /// Ramps that a direction climbs on the horizons of a peak, on the sides that it points to.
    pub struct Ramps<W> {
        /// Ramp over x and over y, 0 at the least slope of the law and 1 at its end.
        #[range(0..=1)]
        axes: [Control<W, SHARE>; 2],
    }

    /// The exponent m of a highlight, normalised.
    pub struct Shininess<W> {
        /// m, 1…8192.
        exponent: Number<W>,
        /// √m, 1…91.
        root: Number<W>,
    }

    /// Effect of roughness on a highlight, for any light. Everything is relative to |n_mod| and to the base deviation 1/√m.
    pub struct Spread<W> {
        /// √m·d₁E₁/|n_mod| and √m·(d₂E₁ + d₃E₂)/|n_mod|.
        rough: [Block<W, 3>; 2],
        /// 1/√D ≤ 1, D = det(I + mK).
        amplitude: Number<W>,
        /// 1/D.
        reciprocal: Number<W>,
    }

    /// Share of a highlight that a fragment shows.
    pub struct Lobe<W> {
        /// f in [0, 1].
        #[range(0..=1)]
        f: Control<W, LIGHT>,
        /// n·l ≤ 0.
        light_below: W::Flag,
        /// n_mod·h ≤ 0.
        half_below: W::Flag,
    }

    /// A probe of an environment footprint: its place and weight.
    pub struct FaceProbe<W> {
        /// Place on the cube.
        place: FacePosition<W>,
        /// Weight; the weights of one footprint sum to exactly 1.
        #[range(0..=1)]
        weight: Control<W, SHARE>,
    }

    /// A probe of a texture footprint: its place and weight.
    pub struct TextureProbe<W> {
        /// Place on the map.
        place: TexturePosition<W>,
        /// Weight; the weights of one footprint sum to exactly 1.
        #[range(0..=1)]
        weight: Control<W, SHARE>,
    }
}
