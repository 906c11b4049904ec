//! The composer: the stages in pipeline order, and no arithmetic of its own.
//!
//! ```text
//!  n h|p_u p_v      b          v                    dv dn   d
//!      │            │          │                      │      │
//!    frame ───► perturb ──► reflect ──► cube_face ──► columns ◄── roughness
//!                                           │            │
//!                                           │         ellipse ──► axes ──► probes
//!                                           └──────────────────────────────┤
//!                                                     continuation ──► filter ──► blend
//!  u v, d(u,v) ──► texture ──► ellipse ──► axes ──► probes ──► filter ──► moments ──► b, d
//! ```

use crate::block::{Block, Mantissa, normalise};
use crate::fx::Fx;
use crate::plan::{FrameSystem, ReflectionPlan};
use crate::precision::{Precision, RoughnessKind};
use crate::signals::{Axes, CubePoint, Ellipse, FacePosition, Frame, MapScale, OFFSET, Probes, Reflected};
use crate::stage::columns::Mirror;
use crate::stage::texture::TextureScale;
use crate::stage::{axes, columns, cube_face, ellipse, frame, perturb, probes, reflect, roughness, texture};
use crate::status::{Status, StatusBit};
use crate::word::Word;

/// A vector as it comes through a port: any alignment, any exponent.
#[derive(Clone, Copy, Debug)]
pub struct PortBlock<W: Word, const N: usize> {
    /// Mantissas.
    pub mantissa: [Mantissa<W>; N],
    /// Exponent.
    pub exponent: Fx<W, 0>,
}

impl<W: Word, const N: usize> PortBlock<W, N> {
    /// Normalised: exact if the port carries no more than p significant bits.
    #[inline(always)]
    fn enter(&self, p: &Precision) -> Block<W, N> {
        normalise(self.mantissa.map(Fx::widen::<60>), self.exponent, p.fraction_bits)
    }
}

/// An offset or a roughness with the bits the profile keeps. What would round up to 8 saturates to the largest number
/// below it.
#[inline(always)]
fn enter_offset<W: Word>(x: Fx<W, OFFSET>, p: &Precision) -> Fx<W, OFFSET> {
    let dropped = OFFSET.saturating_sub(p.offset_bits());
    x.min(Fx::lit(i64::from(i32::MAX >> dropped << dropped))).keep(p.offset_bits())
}

/// Inputs of the reflection datapath on wires; [`crate::ports::ReflectionIn`] describes each.
#[derive(Clone, Copy, Debug)]
pub struct ReflectionInput<W: Word> {
    /// n.
    pub normal: PortBlock<W, 3>,
    /// v.
    pub view: PortBlock<W, 3>,
    /// h, or p_u and p_v.
    pub tangents: [PortBlock<W, 3>; 2],
    /// b₁, b₂.
    pub offset: [Fx<W, OFFSET>; 2],
    /// d₁, d₂, d₃, or I₁.
    pub roughness: [Fx<W, OFFSET>; 3],
    /// ∂v/∂x, ∂v/∂y.
    pub dview: [PortBlock<W, 3>; 2],
    /// ∂n/∂x, ∂n/∂y.
    pub dnormal: [PortBlock<W, 3>; 2],
    /// Scale of the environment.
    pub map: MapScale<W>,
}

/// Every stage's outcome for one fragment. Stages the plan leaves out stand at their neutral value.
#[derive(Clone, Copy, Debug)]
pub struct Reflection<W: Word> {
    /// n, normalised.
    pub normal: Block<W, 3>,
    /// v, normalised.
    pub view: Block<W, 3>,
    /// E₁, E₂ in units of the mantissas of n.
    pub frame: Frame<W>,
    /// n_mod.
    pub normal_mod: Block<W, 3>,
    /// r.
    pub reflected: Reflected<W>,
    /// Face, s, t.
    pub point: CubePoint<W>,
    /// Columns of ∂x, ∂y, d₁E₁, d₂E₁ + d₃E₂.
    pub columns: [Block<W, 2>; 4],
    /// K and det.
    pub ellipse: Ellipse<W>,
    /// λ₁, λ₂ and direction.
    pub axes: Axes<W>,
    /// N, step, level of detail.
    pub probes: Probes<W>,
    /// Sticky bits.
    pub status: Status<W>,
}

/// The reflection datapath of one fragment: from n, v, bumps and roughness to the probes on the cube map.
#[inline(always)]
pub fn reflection<W: Word>(input: &ReflectionInput<W>, plan: &ReflectionPlan, p: &Precision) -> Reflection<W> {
    let never = !Fx::<W, 0>::zero().is_zero();
    let normal = input.normal.enter(p);
    let view = input.view.enter(p);

    let frame = if plan.needs_frame() {
        match plan.frame {
            FrameSystem::MainDirection => frame::main_direction(&normal, &input.tangents[0].enter(p), p),
            FrameSystem::Natural => frame::natural(&normal, &input.tangents.map(|t| t.enter(p)), p),
            FrameSystem::NaturalNormalised => {
                frame::natural_normalised(&normal, &input.tangents.map(|t| t.enter(p)), p)
            }
        }
    } else {
        Frame { e1: Block::zero(), e2: Block::zero(), pole: never }
    };

    let normal_mod = if plan.bump {
        let offset = input.offset.map(|b| enter_offset(b, p));
        perturb::perturb(&normal, &offset, [&frame.e1, &frame.e2], p)
    } else {
        normal
    };

    let reflected = reflect::reflect(&normal_mod, &view, p);
    let point = cube_face::cube_face(&reflected.r, p);

    let (columns, ellipse, axes, probes) = if plan.footprint {
        let mirror = Mirror { normal: &normal_mod, view: &view, reflected: &reflected, point: &point };
        let pixel = core::array::from_fn(|i| {
            let dn = if plan.curvature { input.dnormal[i].enter(p) } else { Block::zero() };
            columns::column(&mirror, &input.dview[i].enter(p), &dn, p)
        });
        let d = input.roughness.map(|d| enter_offset(d, p));
        let tangents = match plan.roughness {
            RoughnessKind::None => None,
            RoughnessKind::Isotropic => Some(roughness::isotropic(d[0], &frame.e1, &frame.e2, p)),
            RoughnessKind::Anisotropic => Some(roughness::anisotropic(&d, &frame.e1, &frame.e2, p)),
        };
        let [box_x, box_y] = ellipse::pixel_columns(&pixel, p);
        let (rough, ellipse) = match tangents {
            None => ([Block::zero(); 2], ellipse::ellipse([box_x, box_y], p)),
            Some(tangents) => {
                let rough = tangents.map(|dn| columns::column(&mirror, &Block::zero(), &dn.scaled(normal.e), p));
                (rough, ellipse::ellipse([box_x, box_y, rough[0], rough[1]], p))
            }
        };
        let axes = axes::axes(&ellipse, p);
        let probes = probes::probes(&axes, &input.map, p);
        ([pixel[0], pixel[1], rough[0], rough[1]], ellipse, axes, probes)
    } else {
        no_footprint(never)
    };

    let status = Status::clear()
        .raise(StatusBit::NormalZero, normal.is_zero())
        .raise(StatusBit::ViewZero, view.is_zero())
        .raise(StatusBit::FramePole, frame.pole)
        .raise(StatusBit::ViewBelowSurface, reflected.below)
        .raise(StatusBit::FaceTie, point.tie)
        .raise(StatusBit::FootprintZero, probes.empty)
        .raise(StatusBit::FootprintSaturated, probes.saturated)
        .raise(StatusBit::ProbesCapped, probes.capped);
    Reflection { normal, view, frame, normal_mod, reflected, point, columns, ellipse, axes, probes, status }
}

/// What stands for the footprint where the plan has none: a point.
fn no_footprint<W: Word>(never: W::Flag) -> ([Block<W, 2>; 4], Ellipse<W>, Axes<W>, Probes<W>) {
    let number = Block::zero();
    let probes = Probes {
        count: Fx::lit(1),
        step: [Fx::zero(); 2],
        lod: Fx::zero(),
        empty: !never,
        saturated: never,
        capped: never,
    };
    let ellipse = Ellipse { k: Block::zero(), det: number };
    let axes = Axes { major: number, minor: number, direction: [Fx::lit(1 << 30), Fx::zero()] };
    ([Block::zero(); 4], ellipse, axes, probes)
}

/// Place of probe `index`: on its face, or across the edge where it leaves the face.
#[inline(always)]
pub fn probe_position<W: Word>(
    point: &CubePoint<W>,
    probes: &Probes<W>,
    index: Fx<W, 0>,
    p: &Precision,
) -> FacePosition<W> {
    let offset = probes::position(probes, index);
    cube_face::continuation(point, &offset, p)
}

/// The footprint of a fragment in a repeated map.
#[derive(Clone, Copy, Debug)]
pub struct TextureFootprint<W: Word> {
    /// Columns of ∂x and ∂y in map units.
    pub columns: [Block<W, 2>; 2],
    /// K and det.
    pub ellipse: Ellipse<W>,
    /// λ₁, λ₂ and direction.
    pub axes: Axes<W>,
    /// N, step, level of detail.
    pub probes: Probes<W>,
}

/// Footprint of a pixel in a colour or bump map: the environment's ellipse, axes and probes, other columns.
#[inline(always)]
pub fn texture_footprint<W: Word>(
    derivatives: &[PortBlock<W, 2>; 2],
    texture: &TextureScale<W>,
    map: &MapScale<W>,
    p: &Precision,
) -> TextureFootprint<W> {
    let columns = [0, 1].map(|i: usize| texture::texture_column(&derivatives[i].enter(p), texture, p));
    let ellipse = ellipse::ellipse(ellipse::pixel_columns(&columns, p), p);
    let axes = axes::axes(&ellipse, p);
    let probes = probes::probes(&axes, map, p);
    TextureFootprint { columns, ellipse, axes, probes }
}
