//! Surfaces: from the ports to the surface of a fragment, made once for its reflection and all its lights.

use crate::block::Block;
use crate::bundle::{bundle, never};
use crate::each::each;
use crate::fx::Control;
use crate::plan::{FrameSystem, SurfacePlan};
use crate::ports::{OFFSET, PortBlock, SHARE, SurfaceInput};
use crate::precision::{Precision, RoughnessKind};
use crate::signals::TangentFrame;
use crate::stage::filter::{self, LEVEL_WEIGHT};
use crate::stage::{enter, frame, perturb, roughness};
use crate::staged::{Staged, stage};

bundle! {
    /// The surface of one fragment.
    pub struct Surface<W> {
        /// n, normalised.
        normal: Block<W, 3>,
        /// v, normalised.
        view: Block<W, 3>,
        /// E₁, E₂ in units of the mantissas of n.
        frame: TangentFrame<W>,
        /// n_mod.
        normal_mod: Block<W, 3>,
        /// d₁E₁ and d₂E₁ + d₃E₂ in units of the mantissas of n; zero if the plan has no roughness.
        rough: [Block<W, 3>; 2],
    }
}

bundle! {
    /// Law of a surface with two lobes: the shape of both is that of its roughness.
    pub struct LobeLaw<W> {
        /// Weight of the first lobe; that of the second is the rest.
        #[range(0..=1)]
        weight: Control<W, SHARE>,
        /// Width of each lobe relative to the roughness.
        #[range(0..=4)]
        widths: [Control<W, OFFSET>; 2],
    }
}

/// Law between two levels of a map.
#[inline(always)]
pub fn lobe_law<W: Staged>(
    fine: &LobeLaw<W>,
    coarse: &LobeLaw<W>,
    level_weight: Control<W, LEVEL_WEIGHT>,
) -> LobeLaw<W> {
    stage!(
        "filter.law",
        LobeLaw {
            weight: filter::law_between::<_, SHARE, { SHARE + LEVEL_WEIGHT }>(
                [fine.weight, coarse.weight],
                level_weight
            ),
            widths: each!(i in [0, 1] => filter::law_between::<_, OFFSET, { OFFSET + LEVEL_WEIGHT }>([fine.widths[i], coarse.widths[i]], level_weight)),
        }
    )
}

/// Roughness tangents of one of two lobes.
#[inline(always)]
pub fn lobe<W: Staged>(rough: &[Block<W, 3>; 2], width: Control<W, OFFSET>, p: &Precision) -> [Block<W, 3>; 2] {
    stage!("roughness.lobe", roughness::lobe(rough, width, p))
}

bundle! {
    /// A normal and its tangent basis, which the fragments of a flat triangle share.
    pub struct Framed<W> {
        /// n, normalised.
        normal: Block<W, 3>,
        /// E₁, E₂ in units of the mantissas of n; zero if the plan needs none.
        frame: TangentFrame<W>,
    }
}

/// Perturbed and rough surface of one fragment.
#[inline(always)]
pub fn surface<W: Staged>(input: &SurfaceInput<W>, plan: &SurfacePlan, p: &Precision) -> Surface<W> {
    let normal = normal(&input.normal, p);
    let view = view(&input.view, p);
    let frame = tangent_frame(&normal, &input.frame_vectors, plan, p);
    bumpy(&Framed { normal, frame }, &view, input, plan, p)
}

/// Normal and tangent basis of a surface, from its normal and its frame vectors.
#[inline(always)]
pub fn framed<W: Staged>(
    normal_port: &PortBlock<W, 3>,
    frame_vectors: &[PortBlock<W, 3>; 2],
    plan: &SurfacePlan,
    p: &Precision,
) -> Framed<W> {
    let normal = normal(normal_port, p);
    Framed { normal, frame: tangent_frame(&normal, frame_vectors, plan, p) }
}

/// Surface as [`surface`] makes it, for an input whose normal and tangent basis are made.
#[inline(always)]
pub fn surface_in_frame<W: Staged>(
    framed: &Framed<W>,
    input: &SurfaceInput<W>,
    plan: &SurfacePlan,
    p: &Precision,
) -> Surface<W> {
    bumpy(framed, &view(&input.view, p), input, plan, p)
}

#[inline(always)]
fn normal<W: Staged>(port: &PortBlock<W, 3>, p: &Precision) -> Block<W, 3> {
    stage!("enter.normal", enter::enter(port, p))
}

#[inline(always)]
fn view<W: Staged>(port: &PortBlock<W, 3>, p: &Precision) -> Block<W, 3> {
    stage!("enter.view", enter::enter(port, p))
}

/// Tangent basis, zero if the plan needs none.
#[inline(always)]
fn tangent_frame<W: Staged>(
    normal: &Block<W, 3>,
    [first, second]: &[PortBlock<W, 3>; 2],
    plan: &SurfacePlan,
    p: &Precision,
) -> TangentFrame<W> {
    if !plan.needs_frame() {
        return TangentFrame { e1: Block::zero(), e2: Block::zero(), pole: never::<W>() };
    }
    let vectors = match plan.frame {
        FrameSystem::MainDirection => [stage!("enter.tangent", enter::enter(first, p)), Block::zero()],
        FrameSystem::Natural | FrameSystem::NaturalNormalised => {
            each!(vector in [first, second] => stage!("enter.tangent", enter::enter(vector, p)))
        }
    };
    match plan.frame {
        FrameSystem::MainDirection => stage!("frame", frame::main_direction(normal, &vectors[0], p)),
        FrameSystem::Natural => stage!("frame", frame::natural(normal, &vectors, p)),
        FrameSystem::NaturalNormalised => stage!("frame", frame::natural_normalised(normal, &vectors, p)),
    }
}

/// Surface with bumps and roughness, from a normal with its tangent basis.
#[inline(always)]
fn bumpy<W: Staged>(
    &Framed { normal, frame }: &Framed<W>,
    view: &Block<W, 3>,
    input: &SurfaceInput<W>,
    plan: &SurfacePlan,
    p: &Precision,
) -> Surface<W> {
    let normal_mod = if plan.bump {
        let offset = stage!("enter.offset", each!(b in input.offset => enter::enter_offset(b, p)));
        stage!("perturb", perturb::perturb(&normal, &offset, [&frame.e1, &frame.e2], p))
    } else {
        normal
    };

    let rough = match plan.roughness {
        RoughnessKind::None => [Block::zero(); 2],
        kind => {
            let d = stage!("enter.roughness", each!(d in input.roughness => enter::enter_offset(d, p)));
            match kind {
                RoughnessKind::Anisotropic => stage!("roughness", roughness::anisotropic(&d, &frame.e1, &frame.e2, p)),
                _ => stage!("roughness", roughness::isotropic(d[0], &frame.e1, &frame.e2, p)),
            }
        }
    };
    Surface { normal, view: *view, frame, normal_mod, rough }
}
