//! # roughxel-f32-baseline
//!
//! One fragment of the reflection datapath in `f32`, as a user would write it: the baseline of comparisons, on hosts and on processors without
//! floating point.
//!
//! [`Environment::reflect`] is the mathematics of [`ReflectionPlan::FULL`] on `glam` vectors. Square roots, divisions and the logarithm are those of
//! a library, a type parameter: each implementation of [`Math`] is a feature, `std`, `libm`, `micromath`. A second type parameter is the care of the
//! formulas: [`formulas::Careful`] or as printed, [`formulas::Plain`]. [`peak::LitPeak`] is a light on a peak.
//!
//! It has the range of `f32`, not that of the ports ([`Fragment::in_range`]).
//!
//! [`ReflectionPlan::FULL`]: roughxel_core::plan::ReflectionPlan::FULL
#![no_std]
#![forbid(unsafe_code)]

// Needed for its square root.
#[cfg(feature = "std")]
extern crate std;

#[cfg(feature = "batch")]
pub mod batch;
pub mod formulas;
pub mod math;
pub mod peak;

use glam::{Vec2, Vec3};
use roughxel_core::ports::{BlockVector, ReflectionIn};
use roughxel_core::setup::{real_offset, real_vector};
use roughxel_core::status::StatusBit;

use crate::formulas::{Axes, Formulas, Frame, Mirror};
use crate::math::Math;

/// Most probes of a footprint, as in every named profile.
const MAX_PROBES: f32 = 16.0;
/// Standard deviation of a pixel box of unit edges, 1/√12.
const BOX_SIGMA: f32 = 0.288_675_13;
/// Diameter of a footprint of standard deviation 1, 2√3.
const DIAMETER: f32 = 3.464_101_6;
/// λ₁ beyond which the step is clamped, map units.
const LONGEST_SIGMA: f32 = 2.0;

/// Inputs of one fragment in real units; the fields are those of [`ReflectionIn`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fragment {
    /// n.
    pub normal: Vec3,
    /// v, from the surface to the eye.
    pub view: Vec3,
    /// h.
    pub main_direction: Vec3,
    /// b₁, b₂.
    pub offset: Vec2,
    /// d₁, d₂, d₃.
    pub roughness: Vec3,
    /// ∂v/∂x, ∂v/∂y.
    pub dview: [Vec3; 2],
    /// ∂n/∂x, ∂n/∂y.
    pub dnormal: [Vec3; 2],
}

impl From<&ReflectionIn> for Fragment {
    /// Rounds the numbers of the ports to `f32`.
    fn from(ports: &ReflectionIn) -> Self {
        let vector = |v: &BlockVector| real_vector(v).as_vec3();
        let [b1, b2] = ports.surface.offset.map(|b| real_offset(b) as f32);
        Self {
            normal: vector(&ports.surface.normal),
            view: vector(&ports.surface.view),
            main_direction: vector(&ports.surface.frame_vectors[0]),
            offset: Vec2::new(b1, b2),
            roughness: Vec3::from_array(ports.surface.roughness.map(|d| real_offset(d) as f32)),
            dview: ports.dview.each_ref().map(vector),
            dnormal: ports.dnormal.each_ref().map(vector),
        }
    }
}

impl Fragment {
    /// True if no product leaves the range of `f32`. The exponents of the ports lie within ±23, which bounds products of three inputs. Derivatives
    /// are less than 2^30 times as long as the vectors that they derive. That bounds the determinant of a footprint, a product of four such
    /// quotients.
    pub fn in_range(ports: &ReflectionIn) -> bool {
        let ReflectionIn { surface, dview, dnormal, .. } = ports;
        let size = |v: &BlockVector| {
            let largest = v.mantissa.iter().fold(0, |largest, m| largest | m.to_bits().unsigned_abs());
            i32::from(v.exponent) - largest.leading_zeros().cast_signed()
        };
        let is_near = |derivatives: &[BlockVector; 2], of| derivatives.iter().all(|d| size(d) - size(of) < 29);
        [&surface.normal, &surface.view, &surface.frame_vectors[0]]
            .into_iter()
            .chain(dview)
            .chain(dnormal)
            .all(|v| v.exponent.abs() < 24)
            && is_near(dview, &surface.view)
            && is_near(dnormal, &surface.normal)
    }
}

/// Data of one fragment that a sampler needs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FloatFootprint {
    /// Face 0…5: +x, −x, +y, −y, +z, −z.
    pub face: u32,
    /// s, t in [−1, 1].
    pub st: Vec2,
    /// N, 1…16.
    pub probes: u32,
    /// Step from one probe to the next, in s and t.
    pub step: Vec2,
    /// Level of detail, 0 … the last level.
    pub lod: f32,
    /// Sticky bits, see [`StatusBit`].
    pub status: u32,
}

/// Data of a cube map that the level of detail needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment {
    /// Texels of level 0 in one map unit, half the edge of a face.
    texels: f32,
    /// The last (coarsest) level.
    last_level: f32,
}

/// Position of the axes of the world on the selected face.
#[derive(Clone, Copy)]
struct Face {
    is_z: bool,
    is_y: bool,
    /// Sign of the major component, ±1.
    sign: f32,
}

impl Face {
    /// (s_c, t_c, m) of a vector by Vulkan's table.
    #[inline(always)]
    fn components(self, w: Vec3) -> Vec3 {
        let Self { is_z, is_y, sign } = self;
        if is_z {
            Vec3::new(sign * w.x, -w.y, sign * w.z)
        } else if is_y {
            Vec3::new(w.x, sign * w.z, sign * w.y)
        } else {
            Vec3::new(-sign * w.z, -w.y, sign * w.x)
        }
    }
}

impl Environment {
    /// A cube map whose faces have `edge_texels` texels along an edge, at least 1.
    pub fn new(edge_texels: u32) -> Self {
        Self { texels: 0.5 * edge_texels as f32, last_level: edge_texels.max(1).ilog2() as f32 }
    }

    /// Reflects one fragment. It is one call a fragment, as in a renderer, whose fetches come next. Inlined into a bare loop, it would be vectorised
    /// too.
    #[inline(never)]
    pub fn reflect<M: Math, F: Formulas>(&self, fragment: &Fragment) -> FloatFootprint {
        self.datapath::<M, F>(fragment)
    }

    /// Reflects one fragment on a given tangent basis of any system; `main_direction` is not read.
    #[inline(never)]
    pub fn reflect_on<M: Math, F: Formulas>(&self, fragment: &Fragment, frame: Frame) -> FloatFootprint {
        self.footprint::<M, F>(fragment, frame)
    }

    /// Tangent basis, perturb, reflect, cube face, columns, ellipse, axes, probes: the body of a loop that is to be vectorised.
    #[inline(always)]
    pub fn datapath<M: Math, F: Formulas>(&self, fragment: &Fragment) -> FloatFootprint {
        self.footprint::<M, F>(fragment, F::frame::<M>(fragment.normal, fragment.main_direction))
    }

    /// Perturb and all later steps.
    #[inline(always)]
    fn footprint<M: Math, F: Formulas>(&self, fragment: &Fragment, frame: Frame) -> FloatFootprint {
        let &Fragment { normal: n, view: v, offset, roughness, dview, dnormal, .. } = fragment;
        let Frame { e1, e2, pole } = frame;

        // r = 2 n⟨v·n⟩ − v|n|² with n = n_mod from here on.
        let n = n + e1 * offset.x + e2 * offset.y;
        let (along, square) = (v.dot(n), n.dot(n));
        let r = n * (2.0 * along) - v * square;

        let size = r.abs();
        let is_z = (size.z >= size.x) & (size.z >= size.y);
        let is_y = !is_z & (size.y >= size.x);
        let major = if is_z {
            r.z
        } else if is_y {
            r.y
        } else {
            r.x
        };
        let second = if is_z {
            size.x.max(size.y)
        } else if is_y {
            size.x.max(size.z)
        } else {
            size.y.max(size.z)
        };
        let negative = major < 0.0;
        let face = Face { is_z, is_y, sign: if negative { -1.0 } else { 1.0 } };
        let on_face = face.components(r);
        let over_m = if on_face.z > 0.0 { M::quotient(1.0, on_face.z) } else { 0.0 };
        let (s, t) = (on_face.x * over_m, on_face.y * over_m);

        // q = (ds_c − s·dm, dt_c − t·dm)/m of dr.
        let column = |dr: Vec3, weight: f32| {
            let dr = face.components(dr);
            Vec2::new(dr.x - s * dr.z, dr.y - t * dr.z) * (over_m * weight)
        };
        let mirror = Mirror { normal: n, view: v, along, square };
        let Axes { major, minor, direction, empty } = F::axes::<M>(&[
            column(F::moved(&mirror, dview[0], dnormal[0]), BOX_SIGMA),
            column(F::moved(&mirror, dview[1], dnormal[1]), BOX_SIGMA),
            column(F::curved(&mirror, e1 * roughness.x), 1.0),
            column(F::curved(&mirror, e1 * roughness.y + e2 * roughness.z), 1.0),
        ]);

        // N = ⌈λ₁/λ₂⌉ up to 16; beyond that λ₂ is raised to λ₁/16.
        let aspect = if empty { 1.0 } else { M::quotient(major, minor) * F::ASPECT_SLACK };
        let capped = aspect > MAX_PROBES;
        let aspect = aspect.clamp(1.0, MAX_PROBES);
        let whole = aspect as i32 as f32;
        let count = if whole < aspect { whole + 1.0 } else { whole };
        let minor = if capped { major / MAX_PROBES } else { minor };
        let step = direction * M::quotient(DIAMETER * major.min(LONGEST_SIGMA), count);
        // Not `clamp`: its check of the bounds would keep the compiler from vectorising the loop.
        let lod = F::log2::<M>(DIAMETER * minor * self.texels).max(0.0).min(self.last_level);

        let bit = |bit: StatusBit, flag: bool| if flag { bit.mask() } else { 0 };
        let axis = if is_z {
            4
        } else if is_y {
            2
        } else {
            0
        };
        FloatFootprint {
            face: axis + u32::from(negative),
            st: Vec2::new(s, t),
            probes: count as u32,
            step,
            lod,
            status: bit(StatusBit::NormalZero, fragment.normal == Vec3::ZERO)
                | bit(StatusBit::ViewZero, v == Vec3::ZERO)
                | bit(StatusBit::FramePole, pole)
                | bit(StatusBit::ViewBelowSurface, along <= 0.0)
                | bit(StatusBit::FaceTie, second == on_face.z)
                | bit(StatusBit::FootprintZero, empty)
                | bit(StatusBit::FootprintSaturated, major > LONGEST_SIGMA)
                | bit(StatusBit::ProbesCapped, capped),
        }
    }
}
