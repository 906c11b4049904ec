//! Lights on a surface: the highlight of its lobe, or its peaks with their horizons.

use crate::block::{Block, Number};
use crate::bundle::bundle;
use crate::each::each;
use crate::fx::{Control, Fx, Int};
use crate::plan::{HorizonKind, PeakPlan, SurfacePlan};
use crate::ports::{
    HighlightInput, HighlightOutput, Horizon, LIGHT, Peak, PeakInput, PeakOutput, PortBlock, SHARE, ShininessPort,
};
use crate::precision::{Precision, RoughnessKind};
use crate::signals::{AxisSlope, LightSide, LocalDirection, PeakSum, Shininess, Spread, TangentFrame};
use crate::stage::{enter, half, highlight, horizon, leave, local, peaks};
use crate::staged::{Staged, control_stage, stage};
use crate::status::{Status, StatusBit};
use crate::word::Word;

use super::surface::{Surface, surface};

/// Direction of light or eye in the tangent basis of the surface, at any length: for [`horizon_slopes`].
#[inline(always)]
pub fn local_components<W: Staged>(
    d: &Block<W, 3>,
    frame: &TangentFrame<W>,
    normal: &Block<W, 3>,
    p: &Precision,
) -> Block<W, 3> {
    stage!("local.components", local::components(d, frame, normal, p))
}

/// Direction of the half vector in the tangent basis of the surface, at unit length: for [`packed_peak`].
#[inline(always)]
pub fn local_direction<W: Staged>(
    d: &Block<W, 3>,
    frame: &TangentFrame<W>,
    normal: &Block<W, 3>,
    p: &Precision,
) -> LocalDirection<W> {
    let local = local_components(d, frame, normal, p);
    stage!("local.unit", local::unit(&local, p))
}

bundle! {
    /// A light as the peaks of a fragment see it.
    pub struct PeakLight<W> {
        /// Half vector.
        half: Block<W, 3>,
        /// Half vector in the tangent basis of the surface.
        direction: LocalDirection<W>,
        /// Light in the tangent basis of the surface, at any length: for [`horizon_slopes`].
        light: Block<W, 3>,
        /// Side of the surface on which the light stands.
        side: LightSide<W>,
    }
}

/// Half vector of a light for the peaks of a fragment. `light` points from the surface to the light.
#[inline(always)]
pub fn peak_light<W: Staged>(surface: &Surface<W>, light: &PortBlock<W, 3>, p: &Precision) -> PeakLight<W> {
    let Surface { normal, view, frame, .. } = surface;
    let light = stage!("enter.light", enter::enter(light, p));
    let half = stage!("half", half::half(&light, view, p));
    let direction = local_direction(&half, frame, normal, p);
    let local = local_components(&light, frame, normal, p);
    let side = stage!("local.side", local::side(&light, &local));
    PeakLight { half, direction, light: local, side }
}

/// Light of one stored peak. `weight` is its share of the fragment, times its visibility if there is a horizon.
#[inline(always)]
pub fn peak<W: Staged>(
    h: &LocalDirection<W>,
    stored: &Peak<W>,
    weight: Control<W, SHARE>,
    p: &Precision,
) -> Control<W, LIGHT> {
    control_stage!("peaks.peak", peaks::peak(h, stored, weight, p))
}

/// Light of one peak as a memory holds it, in three words.
#[inline(always)]
pub fn packed_peak<W: Staged>(
    h: &LocalDirection<W>,
    words: [Int<W>; 3],
    weight: Control<W, SHARE>,
    p: &Precision,
) -> Control<W, LIGHT> {
    control_stage!("peaks.packed", peaks::peak::<W>(h, &peaks::unpack(words), weight, p))
}

/// Sum of peaks with one more.
#[inline(always)]
pub fn peak_sum<W: Staged>(sum: &PeakSum<W>, light: Control<W, LIGHT>) -> PeakSum<W> {
    stage!("peaks.sum", peaks::add(sum, light))
}

/// Slopes of a local direction over both axes, once for the light and once for the eye.
#[inline(always)]
pub fn horizon_slopes<W: Staged>(local: &Block<W, 3>, p: &Precision) -> [AxisSlope<W>; 2] {
    stage!("horizon.slopes", horizon::slopes(local, p))
}

/// Share of a peak's facets that light and eye both clear; 1 if the plan has no horizon.
#[inline(always)]
pub fn horizon<W: Staged>(
    light: &[AxisSlope<W>; 2],
    eye: &[AxisSlope<W>; 2],
    stored: &Horizon<W>,
    kind: HorizonKind,
    p: &Precision,
) -> Control<W, SHARE> {
    if kind == HorizonKind::None {
        return Fx::int(1);
    }
    let [lit, seen] = each!(slopes in [light, eye] => stage!("horizon.ramps", horizon::ramps(slopes, stored, p)));
    match kind {
        HorizonKind::Product => control_stage!("horizon.product", horizon::independent(&lit, &seen)),
        HorizonKind::None | HorizonKind::Correlated => {
            control_stage!("horizon.correlated", horizon::correlated(&lit, &seen))
        }
    }
}

bundle! {
    /// Quantities that all highlights of a fragment share: the exponent of its material and the spread of its surface.
    pub struct Gloss<W> {
        /// m.
        shininess: Shininess<W>,
        /// Spread of the surface; `None` if the plan has no roughness.
        spread: Option<Spread<W>>,
    }
}

/// Material of one fragment, made once for all its lights.
#[inline(always)]
pub fn gloss<W: Staged>(
    surface: &Surface<W>,
    shininess: &ShininessPort<W>,
    plan: &SurfacePlan,
    p: &Precision,
) -> Gloss<W> {
    let shininess = stage!("enter.shininess", highlight::enter_shininess(shininess, p));
    let spread = match plan.roughness {
        RoughnessKind::None => None,
        _ => Some(stage!("highlight.spread", {
            let rough = each!(c in surface.rough => c.scaled(surface.normal.e));
            highlight::spread(&surface.normal_mod, &rough, &shininess, p)
        })),
    };
    Gloss { shininess, spread }
}

bundle! {
    /// Outcomes of all stages for one light on one fragment.
    pub struct Highlight<W> {
        /// h.
        half: Block<W, 3>,
        /// Share of the light that the highlight returns, [0, 1].
        #[range(0..=1)]
        f: Control<W, LIGHT>,
        /// Sticky bits.
        #[range(0..4096)]
        status: Int<W>,
    }
}

/// Highlight of one light: modified Blinn-Phong. `light` points from the surface to the light.
#[inline(always)]
pub fn highlight<W: Staged>(
    surface: &Surface<W>,
    gloss: &Gloss<W>,
    light: &PortBlock<W, 3>,
    p: &Precision,
) -> Highlight<W> {
    let Surface { normal, view, frame, normal_mod, .. } = surface;
    let light = stage!("enter.light", enter::enter(light, p));
    let half = stage!("half", half::half(&light, view, p));
    let lobe = stage!(
        "highlight",
        highlight::lobe([normal, normal_mod], [&light, &half], gloss.spread.as_ref(), &gloss.shininess, p)
    );
    let status = control_stage!("highlight.status", {
        Status::<W>::clear()
            .raise(StatusBit::NormalZero, normal.is_zero())
            .raise(StatusBit::ViewZero, view.is_zero())
            .raise(StatusBit::FramePole, frame.pole)
            .raise(StatusBit::LightZero, light.is_zero())
            .raise(StatusBit::HalfZero, half.is_zero())
            .raise(StatusBit::LightBelowSurface, lobe.light_below)
            .raise(StatusBit::HalfBelowSurface, lobe.half_below)
            .word()
    });
    Highlight { half, f: lobe.f, status }
}

/// Outcomes of all stages of the highlight datapath for one fragment with one light.
#[derive(Clone, Copy, Debug)]
pub struct LitSurface<W: Word> {
    /// Surface of the fragment.
    pub surface: Surface<W>,
    /// Material of the fragment.
    pub gloss: Gloss<W>,
    /// Light on the fragment.
    pub highlight: Highlight<W>,
}

/// Highlight datapath of one fragment with one light: surface, material, light.
#[inline(always)]
pub fn lit_surface<W: Staged>(input: &HighlightInput<W>, plan: &SurfacePlan, p: &Precision) -> LitSurface<W> {
    let surface = surface(&input.surface, plan, p);
    let gloss = gloss(&surface, &input.shininess, plan, p);
    LitSurface { surface, gloss, highlight: highlight(&surface, &gloss, &input.light, p) }
}

/// Outcomes of the highlight's stages in the form of ports. Without roughness the spread is zero and the amplitude 1.
#[inline(always)]
pub fn leave_highlight<W: Staged>(stages: &LitSurface<W>) -> HighlightOutput<W> {
    let LitSurface { surface: Surface { normal, frame, normal_mod, rough, .. }, gloss, highlight } = stages;
    let (spread, amplitude) = match &gloss.spread {
        None => ([Block::zero(); 2], Number::one()),
        Some(spread) => (spread.rough, spread.amplitude),
    };
    stage!(
        "leave.highlight",
        HighlightOutput {
            frame: each!(e in [frame.e1, frame.e2] => leave::leave(&e.scaled(normal.e))),
            normal_mod: leave::leave(normal_mod),
            rough: each!(c in *rough => leave::leave(&c.scaled(normal.e))),
            half: leave::leave(&highlight.half),
            spread: each!(q in spread => leave::leave(&q)),
            amplitude: leave::leave(&amplitude),
            f: highlight.f,
            status: highlight.status,
        }
    )
}

/// One light on one peak of a fragment: tangent basis, half vector, horizon, peak. Every stage's outcome is in the form of ports.
///
/// A fragment with several peaks makes the results before [`horizon`](horizon()) once for all of them.
#[inline(always)]
pub fn lit_peak<W: Staged>(input: &PeakInput<W>, plan: &PeakPlan, p: &Precision) -> PeakOutput<W> {
    let surface = surface(&input.surface, &plan.surface(), p);
    let lit = peak_light(&surface, &input.light, p);
    let (eye, slopes, visibility) = if plan.horizon != HorizonKind::None {
        let eye = local_components(&surface.view, &surface.frame, &surface.normal, p);
        let [of_light, of_eye] = each!(local in [lit.light, eye] => horizon_slopes(&local, p));
        let slopes = each!(axes in [of_light, of_eye] => each!(axis in axes => axis.slope));
        (eye, slopes, horizon(&of_light, &of_eye, &input.horizon, plan.horizon, p))
    } else {
        (Block::zero(), [[Fx::zero(); 2]; 2], Fx::int(1))
    };
    let weight = control_stage!(
        "peaks.weight",
        peaks::lit(&lit.side, horizon::product::<W>(peaks::share(input.weight), visibility))
    );
    let sum = peak_sum::<W>(&peaks::none(), peak(&lit.direction, &input.peak, weight, p));
    let status = control_stage!("peaks.status", {
        Status::<W>::clear()
            .raise(StatusBit::LocalZero, lit.direction.none)
            .raise(StatusBit::PeaksSaturated, sum.saturated)
            .raise(StatusBit::NormalZero, surface.normal.is_zero())
            .raise(StatusBit::ViewZero, surface.view.is_zero())
            .raise(StatusBit::FramePole, surface.frame.pole)
            .raise(StatusBit::LightZero, lit.side.none)
            .raise(StatusBit::HalfZero, lit.half.is_zero())
            .raise(StatusBit::LightBelowSurface, lit.side.below)
            .word()
    });
    stage!(
        "leave.peak",
        PeakOutput {
            frame: each!(e in [surface.frame.e1, surface.frame.e2] => leave::leave(&e.scaled(surface.normal.e))),
            half: leave::leave(&lit.half),
            local_half: lit.direction.unit,
            local_light: leave::leave(&lit.light),
            local_eye: leave::leave(&eye),
            slopes,
            visibility,
            peak: sum.light,
            status,
        }
    )
}
