//! Ports of the datapath: everything that enters or leaves it, in `fixed` types.
//!
//! This is the only file of the datapath that names `fixed`. Every bit pattern of every input port has one
//! documented result. A direction or a derivative is a [`BlockVector`]: three mantissas and one exponent, so that
//! neither tiny nor huge values lose bits. A profile keeps `fraction_bits` of the fraction of the largest component; lower
//! bits are rounded away on entry.

use fixed::types::{I1F15, I2F30, I4F12, I4F28, I6F26, I8F24, I16F16, U0F32};

use crate::datapath::{
    self, FragmentInput, HighlightInput, HighlightOutput, LitPeakInput, LitPeakOutput, Reflection, ReflectionInput,
    ReflectionOutput, SurfaceInput, TextureFootprint,
};
use crate::fx::Fx;
use crate::plan::{PeakPlan, ReflectionPlan, SurfacePlan};
use crate::precision::Precision;
use crate::scalar::Scalar;
use crate::signals::{Horizon, MapScale, Peak, PortBlock, ShininessPort};
use crate::stage::probes::face_scale;
use crate::stage::texture::TextureScale;

/// Three components with one shared exponent; component `i` is `mantissa[i] · 2^exponent`.
///
/// Units: those of the quantity. Range: any. Outputs have their largest component in [½, 1] by size; all-zero
/// outputs have exponent 0, and an exponent beyond 16 bits is saturated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BlockVector {
    /// Components, I2F30.
    pub mantissa: [I2F30; 3],
    /// Power of two of the block.
    pub exponent: i16,
}

/// Two components with one shared exponent, the planar companion of [`BlockVector`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BlockPair {
    /// Components, I2F30.
    pub mantissa: [I2F30; 2],
    /// Power of two of the block.
    pub exponent: i16,
}

/// One number with an exponent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BlockNumber {
    /// Mantissa, I2F30.
    pub mantissa: I2F30,
    /// Power of two.
    pub exponent: i16,
}

/// Inputs of the reflection datapath for one fragment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReflectionIn {
    /// Surface normal n, any length.
    pub normal: BlockVector,
    /// Vector v from the surface to the eye, any length.
    pub view: BlockVector,
    /// Frame vectors: the main direction h in slot 0 (system 3), or p_u and p_v (systems 1 and 2).
    pub tangents: [BlockVector; 2],
    /// Bump offsets b₁, b₂, relative to |n|; `fraction_bits` − 2 fraction bits are kept.
    pub offset: [I4F28; 2],
    /// Roughness d₁, d₂, d₃ (K = D Dᵀ, D = [[d₁, d₂], [0, d₃]]), relative to |n|; isotropic I₁ in slot 0.
    pub roughness: [I4F28; 3],
    /// ∂v/∂x and ∂v/∂y, per pixel.
    pub dview: [BlockVector; 2],
    /// ∂n/∂x and ∂n/∂y, per pixel, in the units of `normal`.
    pub dnormal: [BlockVector; 2],
    /// Edge of a face of the environment at level 0, in texels, 1…16384 (0 reads as 1, more as 16384).
    pub edge_texels: u16,
}

/// Outputs of every stage of the reflection datapath for one fragment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReflectionOut {
    /// E₁ and E₂, scaled by |n|.
    pub frame: [BlockVector; 2],
    /// n_mod.
    pub normal_mod: BlockVector,
    /// r = 2 n_mod⟨v·n_mod⟩ − v|n_mod|².
    pub reflected: BlockVector,
    /// Face 0…5: +x, −x, +y, −y, +z, −z.
    pub face: u8,
    /// s and t in [−1, 1].
    pub st: [I2F30; 2],
    /// d(s, t) for ∂x, ∂y, d₁E₁, d₂E₁ + d₃E₂.
    pub columns: [BlockPair; 4],
    /// a, b, c of the covariance K on the face plane.
    pub covariance: BlockVector,
    /// det K.
    pub determinant: BlockNumber,
    /// λ₁, standard deviation along the major axis.
    pub major: BlockNumber,
    /// λ₂.
    pub minor: BlockNumber,
    /// Unit direction of λ₁ in (s, t).
    pub direction: [I2F30; 2],
    /// Number of probes, 1…16.
    pub probes: u8,
    /// Step from one probe to the next, in s and t.
    pub step: [I4F28; 2],
    /// Level of detail, 0 … log₂ of the edge.
    pub lod: I16F16,
    /// Sticky bits, see [`crate::status::StatusBit`].
    pub status: u32,
}

/// Inputs of the texture footprint for one fragment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TextureIn {
    /// Texture coordinates in repeats of the map, modulo 1 (repeat addressing).
    pub uv: [U0F32; 2],
    /// ∂(u, v)/∂x and ∂(u, v)/∂y, repeats per pixel.
    pub duv: [BlockPair; 2],
}

/// Constants of a map of `size` texels for [`TextureFootprint`]; edges are read as 1…16384.
///
/// Set-up, once per map: the only division of the crate outside tests and tables, and not on the datapath.
pub fn texture_scale(size: [u16; 2]) -> (TextureScale<Scalar>, MapScale<Scalar>) {
    let [width, height] = size.map(|edge| i32::from(edge.clamp(1, 16384)));
    let longer = width.max(height) as u32;
    // ⌈log₂ longer⌉ − 1, and ⌊log₂ longer⌋ below, without a panic path.
    let log2_unit = (u32::BITS - longer.saturating_sub(1).leading_zeros()).saturating_sub(1) as i32;
    let last_level = longer.checked_ilog2().unwrap_or(0) as i32;
    let repeats = |edge: i32| {
        let edge = core::num::NonZeroU32::new(edge as u32).unwrap_or(core::num::NonZeroU32::MIN);
        Fx::from_raw(((1_u32 << (16 + log2_unit)) / edge) as i32)
    };
    let texture = TextureScale {
        size: [Fx::from_raw(width), Fx::from_raw(height)],
        log2_unit: Fx::from_raw(log2_unit),
        repeats_per_unit: [repeats(width), repeats(height)],
    };
    let map = MapScale { log2_texels: Fx::from_raw(log2_unit << 16), last_level: Fx::from_raw(last_level) };
    (texture, map)
}

/// The scale of an environment whose faces have `edge` texels, read as 1…16384.
pub fn environment_scale(edge: u16, p: &Precision) -> MapScale<Scalar> {
    face_scale(Fx::from_raw(i32::from(edge)), p)
}

/// The reflection datapath in the scalar reading, compiled here once for all who call it, as those below are.
pub fn reflection(input: &ReflectionInput<Scalar>, plan: &ReflectionPlan, p: &Precision) -> Reflection<Scalar> {
    datapath::reflection(input, plan, p)
}

/// The reflection datapath from ports to ports.
pub fn fragment(input: &FragmentInput<Scalar>, plan: &ReflectionPlan, p: &Precision) -> ReflectionOutput<Scalar> {
    datapath::fragment(input, plan, p)
}

/// The highlight datapath from ports to ports.
pub fn highlight(input: &HighlightInput<Scalar>, plan: &SurfacePlan, p: &Precision) -> HighlightOutput<Scalar> {
    datapath::leave_highlight(&datapath::lit_surface(input, plan, p))
}

/// One light on one peak from ports to ports.
pub fn lit_peak(input: &LitPeakInput<Scalar>, plan: &PeakPlan, p: &Precision) -> LitPeakOutput<Scalar> {
    datapath::lit_peak(input, plan, p)
}

fn wires<const N: usize>(mantissa: [I2F30; N], exponent: i16) -> PortBlock<Scalar, N> {
    PortBlock { mantissa: mantissa.map(|m| Fx::from_raw(m.to_bits())), exponent: Fx::from_raw(i32::from(exponent)) }
}

impl BlockVector {
    /// The port as scalar wires.
    pub fn wires(&self) -> PortBlock<Scalar, 3> {
        wires(self.mantissa, self.exponent)
    }
}

impl BlockPair {
    /// The port as scalar wires.
    #[inline]
    pub fn wires(&self) -> PortBlock<Scalar, 2> {
        wires(self.mantissa, self.exponent)
    }
}

impl ReflectionIn {
    /// The ports as scalar wires, with the scale of a map.
    pub fn wires(&self, map: MapScale<Scalar>) -> ReflectionInput<Scalar> {
        let FragmentInput { normal, view, tangents, offset, roughness, dview, dnormal, .. } = self.fragment();
        ReflectionInput { normal, view, tangents, offset, roughness, dview, dnormal, map }
    }

    /// The ports as scalar wires, with the edge of the environment in place of its scale.
    pub fn fragment(&self) -> FragmentInput<Scalar> {
        FragmentInput {
            normal: self.normal.wires(),
            view: self.view.wires(),
            tangents: self.tangents.map(|t| t.wires()),
            offset: self.offset.map(|b| Fx::from_raw(b.to_bits())),
            roughness: self.roughness.map(|d| Fx::from_raw(d.to_bits())),
            dview: self.dview.map(|d| d.wires()),
            dnormal: self.dnormal.map(|d| d.wires()),
            edge_texels: Fx::from_raw(i32::from(self.edge_texels)),
        }
    }

    /// Runs the scalar datapath.
    pub fn reflect(&self, plan: &ReflectionPlan, p: &Precision) -> ReflectionOut {
        ReflectionOut::from(&fragment(&self.fragment(), plan, p))
    }
}

impl TextureIn {
    /// Runs the scalar texture footprint.
    pub fn footprint(
        &self,
        scale: &(TextureScale<Scalar>, MapScale<Scalar>),
        p: &Precision,
    ) -> TextureFootprint<Scalar> {
        let derivatives = self.duv.map(|pair| pair.wires());
        datapath::texture_footprint(&derivatives, &scale.0, &scale.1, p)
    }
}

fn port_mantissa<const N: usize>(m: [Fx<Scalar, 30>; N]) -> [I2F30; N] {
    m.map(|m| I2F30::from_bits(m.raw()))
}

impl From<&PortBlock<Scalar, 3>> for BlockVector {
    fn from(port: &PortBlock<Scalar, 3>) -> Self {
        Self { mantissa: port_mantissa(port.mantissa), exponent: port.exponent.raw() as i16 }
    }
}

impl From<&PortBlock<Scalar, 2>> for BlockPair {
    fn from(port: &PortBlock<Scalar, 2>) -> Self {
        Self { mantissa: port_mantissa(port.mantissa), exponent: port.exponent.raw() as i16 }
    }
}

impl From<&PortBlock<Scalar, 1>> for BlockNumber {
    fn from(port: &PortBlock<Scalar, 1>) -> Self {
        Self { mantissa: I2F30::from_bits(port.mantissa[0].raw()), exponent: port.exponent.raw() as i16 }
    }
}

impl From<&ReflectionOutput<Scalar>> for ReflectionOut {
    fn from(output: &ReflectionOutput<Scalar>) -> Self {
        Self {
            frame: output.frame.each_ref().map(BlockVector::from),
            normal_mod: BlockVector::from(&output.normal_mod),
            reflected: BlockVector::from(&output.reflected),
            face: output.face.raw() as u8,
            st: port_mantissa(output.st),
            columns: output.columns.each_ref().map(BlockPair::from),
            covariance: BlockVector::from(&output.covariance),
            determinant: BlockNumber::from(&output.determinant),
            major: BlockNumber::from(&output.major),
            minor: BlockNumber::from(&output.minor),
            direction: port_mantissa(output.direction),
            probes: output.probes.raw() as u8,
            step: output.step.map(|step| I4F28::from_bits(step.raw())),
            lod: I16F16::from_bits(output.lod.raw()),
            status: output.status.word().raw() as u32,
        }
    }
}

impl From<&Reflection<Scalar>> for ReflectionOut {
    fn from(stages: &Reflection<Scalar>) -> Self {
        Self::from(&datapath::leave(stages))
    }
}

/// One peak of a distribution of normals as maps store it: a·max(0, N·H)ⁿ, in 10 bytes.
///
/// A code of 16 bits holds an exponent c in its upper 4 bits and a fraction f in its lower 12: f units where c = 0, else
/// (4096 + f)·2^(c − 1) units. It is monotone, and a number of at least 4096 units is within 2^−13 of what was stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StoredPeak {
    /// N in the frame of the surface (E₁, E₂, n), of unit length within 2^−15 and in direction within 2^−15.2 rad.
    /// Another length: 1 − |N − H|²/2 stands for the cosine.
    pub normal: [I1F15; 3],
    /// Amplitude a, a code in units of 2^−21: 0 or from 2^−21 to below 64; within 2^−13 from 2^−9 on, 2^−22 below. A larger
    /// one is saturated: facets of amplitude 15 beyond 76°, for they count 1/n_z times.
    pub amplitude: u16,
    /// Exponent n, a code in units of 2^−13: from 1 to 8192 within 2^−13, which changes a power by 2^−14.4 at most.
    /// The other codes, 0 to 16 382, count as they read.
    pub exponent: u16,
}

/// The horizon of a peak as maps store it, towards −x, +x, −y, +y of the local frame, in 16 bytes.
///
/// The share of facets that a direction of slope s = z/|x| clears rises from 0 at `low` to 1 over the width.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StoredHorizon {
    /// Slope at which the ramp begins, μ − √3σ, or of the step; within 2^−13, cut to ±8.
    pub low: [I4F12; 4],
    /// 1/(2√3σ), a code as in [`StoredPeak`] in units of 2^−14: within 2^−13 from ¼ on (widths up to 4), 2^−15 below.
    /// 0 is a step: visible at `low` and above.
    pub inverse_width: [u16; 4],
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

impl StoredPeak {
    /// The port as scalar wires.
    pub fn wires(&self) -> Peak<Scalar> {
        Peak {
            normal: self.normal.map(|n| Fx::from_raw(n.to_bits().into())),
            amplitude: Fx::from_raw(self.amplitude.into()),
            exponent: Fx::from_raw(self.exponent.into()),
        }
    }
}

impl StoredHorizon {
    /// The port as scalar wires.
    pub fn wires(&self) -> Horizon<Scalar> {
        Horizon {
            low: self.low.map(|low| Fx::from_raw(low.to_bits().into())),
            inverse_width: self.inverse_width.map(|code| Fx::from_raw(code.into())),
        }
    }
}

/// The exponent m of a highlight: cos^m on a smooth surface. `setup::shininess` makes one.
///
/// The datapath takes both numbers as they are: a √m that is not the root of m changes the base roughness alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shininess {
    /// m, saturated to 1…8192.
    pub exponent: I16F16,
    /// √m, saturated to 1…91.
    pub root: I8F24,
}

impl Shininess {
    /// The ports as scalar wires.
    pub fn wires(&self) -> ShininessPort<Scalar> {
        ShininessPort { exponent: Fx::from_raw(self.exponent.to_bits()), root: Fx::from_raw(self.root.to_bits()) }
    }
}

/// Inputs of the highlight of one light on one fragment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HighlightIn {
    /// Surface normal n, any length.
    pub normal: BlockVector,
    /// Vector v from the surface to the eye, any length.
    pub view: BlockVector,
    /// Frame vectors, as for [`ReflectionIn`].
    pub tangents: [BlockVector; 2],
    /// Bump offsets b₁, b₂, as for [`ReflectionIn`].
    pub offset: [I4F28; 2],
    /// Roughness d₁, d₂, d₃ or I₁, as for [`ReflectionIn`].
    pub roughness: [I4F28; 3],
    /// Vector l from the surface to the light, any length.
    pub light: BlockVector,
    /// Exponent m.
    pub shininess: Shininess,
}

/// Outputs of every stage of the highlight of one light on one fragment. What belongs to roughness is zero, and the amplitude 1,
/// where the plan has none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HighlightOut {
    /// E₁ and E₂, scaled by |n|.
    pub frame: [BlockVector; 2],
    /// n_mod.
    pub normal_mod: BlockVector,
    /// d₁E₁ and d₂E₁ + d₃E₂, scaled by |n|.
    pub tangents: [BlockVector; 2],
    /// √m/|n_mod| times `tangents`: relative to |n_mod| and to the base deviation 1/√m.
    pub spread: [BlockVector; 2],
    /// 1/√D ≤ 1, D = det(I + mK).
    pub amplitude: BlockNumber,
    /// h = l/|l| + v/|v|.
    pub half: BlockVector,
    /// The share of the light that the highlight returns, [0, 1]. It is 0 where the light is on the horizon of n or below
    /// it, where n_mod faces away from the half vector, and where any of n, v, l or h is zero.
    pub f: I8F24,
    /// Sticky bits, see [`crate::status::LIGHT_STATUS_BITS`]; those of n, v and the frame as for the reflection.
    pub status: u32,
}

impl HighlightIn {
    /// The ports as scalar wires.
    pub fn wires(&self) -> HighlightInput<Scalar> {
        HighlightInput {
            surface: SurfaceInput {
                normal: self.normal.wires(),
                view: self.view.wires(),
                tangents: self.tangents.map(|t| t.wires()),
                offset: self.offset.map(|b| Fx::from_raw(b.to_bits())),
                roughness: self.roughness.map(|d| Fx::from_raw(d.to_bits())),
            },
            light: self.light.wires(),
            shininess: self.shininess.wires(),
        }
    }

    /// Runs the scalar datapath.
    pub fn highlight(&self, plan: &SurfacePlan, p: &Precision) -> HighlightOut {
        HighlightOut::from(&highlight(&self.wires(), plan, p))
    }
}

impl From<&HighlightOutput<Scalar>> for HighlightOut {
    fn from(output: &HighlightOutput<Scalar>) -> Self {
        Self {
            frame: output.frame.each_ref().map(BlockVector::from),
            normal_mod: BlockVector::from(&output.normal_mod),
            tangents: output.tangents.each_ref().map(BlockVector::from),
            spread: output.spread.each_ref().map(BlockVector::from),
            amplitude: BlockNumber::from(&output.amplitude),
            half: BlockVector::from(&output.half),
            f: I8F24::from_bits(output.f.raw()),
            status: output.status.word().raw() as u32,
        }
    }
}

/// Inputs of one light on one peak of a fragment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PeakIn {
    /// Surface normal n, any length.
    pub normal: BlockVector,
    /// Vector v from the surface to the eye, any length.
    pub view: BlockVector,
    /// Frame vectors, as for [`ReflectionIn`].
    pub tangents: [BlockVector; 2],
    /// Vector l from the surface to the light, any length.
    pub light: BlockVector,
    /// The peak.
    pub peak: StoredPeak,
    /// Its horizon.
    pub horizon: StoredHorizon,
    /// Its share of the fragment, saturated to [0, 1].
    pub weight: I16F16,
}

/// Outputs of every stage of one light on one peak. What belongs to the horizon is zero, and the visibility 1, where the
/// plan has none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PeakOut {
    /// E₁ and E₂, scaled by |n|.
    pub frame: [BlockVector; 2],
    /// h = l/|l| + v/|v|.
    pub half: BlockVector,
    /// h along E₁, E₂ and n, at unit length; zero where h or the frame is.
    pub direction: [I2F30; 3],
    /// l along E₁, E₂ and n, at any length.
    pub light: BlockVector,
    /// v along E₁, E₂ and n, at any length.
    pub eye: BlockVector,
    /// Slopes z/|x| and z/|y| of l, then of v, cut to ±8.
    pub slopes: [[I6F26; 2]; 2],
    /// The share of the peak's facets that light and eye clear, [0, 1].
    pub visibility: I16F16,
    /// The light that the peak returns, [0, 64); 0 where the light is on the horizon of n or below it, and where any of n,
    /// v, l, h or the frame is zero.
    pub peak: I8F24,
    /// Sticky bits, see [`crate::status::LIGHT_STATUS_BITS`]; those of n, v and the frame as for the reflection.
    pub status: u32,
}

impl PeakIn {
    /// The ports as scalar wires.
    pub fn wires(&self) -> LitPeakInput<Scalar> {
        LitPeakInput {
            surface: SurfaceInput {
                normal: self.normal.wires(),
                view: self.view.wires(),
                tangents: self.tangents.map(|t| t.wires()),
                offset: [Fx::zero(); 2],
                roughness: [Fx::zero(); 3],
            },
            light: self.light.wires(),
            peak: self.peak.wires(),
            horizon: self.horizon.wires(),
            weight: Fx::from_raw(self.weight.to_bits()),
        }
    }

    /// Runs the scalar datapath.
    pub fn shine(&self, plan: &PeakPlan, p: &Precision) -> PeakOut {
        PeakOut::from(&lit_peak(&self.wires(), plan, p))
    }
}

impl From<&LitPeakOutput<Scalar>> for PeakOut {
    fn from(output: &LitPeakOutput<Scalar>) -> Self {
        Self {
            frame: output.frame.each_ref().map(BlockVector::from),
            half: BlockVector::from(&output.half),
            direction: port_mantissa(output.direction),
            light: BlockVector::from(&output.light),
            eye: BlockVector::from(&output.eye),
            slopes: output.slopes.map(|axes| axes.map(|slope| I6F26::from_bits(slope.raw()))),
            visibility: I16F16::from_bits(output.visibility.raw()),
            peak: I8F24::from_bits(output.peak.raw()),
            status: output.status.word().raw() as u32,
        }
    }
}
