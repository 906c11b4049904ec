//! From the surface to the probes on the environment that it reflects.

use crate::block::Block;
use crate::bundle::{bundle, never};
use crate::each::each;
use crate::fx::{Fx, Int};
use crate::plan::ReflectionPlan;
use crate::ports::{PortBlock, ReflectionInput, ReflectionOutput};
use crate::precision::{Precision, RoughnessKind};
use crate::signals::{Axes, CubePoint, Ellipse, MapScale, Probes, Reflected};
use crate::stage::columns::{self, Mirror};
use crate::stage::{cube_face, ellipse, enter, leave, probes, reflect};
use crate::staged::{Staged, control_stage, stage};
use crate::status::{Status, StatusBit};

use super::footprint::{assemble, pixel_ellipse};
use super::surface::{Surface, surface};

bundle! {
    /// Every stage's outcome for one fragment. Stages the plan leaves out stand at their neutral value.
    pub struct Reflection<W> {
        /// The surface.
        surface: Surface<W>,
        /// r.
        reflected: Reflected<W>,
        /// Face, s, t.
        point: CubePoint<W>,
        /// Columns of ∂x, ∂y, d₁E₁, d₂E₁ + d₃E₂.
        columns: [Block<W, 2>; 4],
        /// K and det.
        ellipse: Ellipse<W>,
        /// λ₁, λ₂ and direction.
        axes: Axes<W>,
        /// N, step, level of detail.
        probes: Probes<W>,
        /// Sticky bits.
        #[range(0..256)]
        status: Int<W>,
    }
}

/// The scale of an environment whose faces have `edge` texels, any number of 16 bits.
#[inline(always)]
pub fn map_scale<W: Staged>(edge: Int<W>, p: &Precision) -> MapScale<W> {
    stage!("map_scale", probes::face_scale(edge, p))
}

/// The reflection datapath of one fragment on an environment of that scale: from n, v, bumps and roughness to the probes on the
/// cube map.
#[inline(always)]
pub fn reflection<W: Staged>(
    input: &ReflectionInput<W>,
    map: &MapScale<W>,
    plan: &ReflectionPlan,
    p: &Precision,
) -> Reflection<W> {
    let surface = surface(&input.surface, &plan.surface(), p);
    reflection_of(&surface, [&input.dview, &input.dnormal], map, plan, p)
}

/// What comes after the surface, which was made with the stages of [`ReflectionPlan::surface`] at least: `dview` and `dnormal` are
/// the derivatives over the pixel.
#[inline(always)]
pub fn reflection_of<W: Staged>(
    surface: &Surface<W>,
    [dview, dnormal]: [&[PortBlock<W, 3>; 2]; 2],
    map: &MapScale<W>,
    plan: &ReflectionPlan,
    p: &Precision,
) -> Reflection<W> {
    let Surface { normal, view, frame, normal_mod, rough } = surface;
    let reflected = stage!("reflect", reflect::reflect(normal_mod, view, p));
    let point = stage!("cube_face", cube_face::cube_face(&reflected.r, p));

    let (columns, ellipse, axes, probes) = if plan.footprint {
        let mirror = Mirror { normal: normal_mod, view, reflected: &reflected, point: &point };
        let pixel = each!(i in [0, 1] => {
            let dv = stage!("enter.dview", enter::enter(&dview[i], p));
            let dn =
                if plan.curvature { stage!("enter.dnormal", enter::enter(&dnormal[i], p)) } else { Block::zero() };
            stage!("columns.pixel", columns::column(&mirror, &dv, &dn, p))
        });
        let (rough, ellipse) = match plan.roughness {
            RoughnessKind::None => ([Block::zero(); 2], pixel_ellipse(&pixel, p)),
            _ => {
                let rough = each!(dn in *rough => {
                    stage!("columns.roughness", columns::column(&mirror, &Block::zero(), &dn.scaled(normal.e), p))
                });
                let ellipse = stage!("ellipse", {
                    let [box_x, box_y] = ellipse::pixel_columns(&pixel, p);
                    ellipse::ellipse([box_x, box_y, rough[0], rough[1]], p)
                });
                (rough, ellipse)
            }
        };
        let (axes, probes) = assemble(&ellipse, map, p);
        ([pixel[0], pixel[1], rough[0], rough[1]], ellipse, axes, probes)
    } else {
        no_footprint()
    };

    let status = control_stage!("status", {
        Status::<W>::clear()
            .raise(StatusBit::NormalZero, normal.is_zero())
            .raise(StatusBit::ViewZero, view.is_zero())
            .raise(StatusBit::FramePole, frame.pole)
            .raise(StatusBit::ViewBelowSurface, reflected.below)
            .raise(StatusBit::FaceTie, point.tie)
            .raise(StatusBit::FootprintZero, probes.empty)
            .raise(StatusBit::FootprintSaturated, probes.saturated)
            .raise(StatusBit::ProbesCapped, probes.capped)
            .word()
    });
    Reflection { surface: *surface, reflected, point, columns, ellipse, axes, probes, status }
}

/// What stands for the footprint where the plan has none: a point.
fn no_footprint<W: Staged>() -> ([Block<W, 2>; 4], Ellipse<W>, Axes<W>, Probes<W>) {
    let number = Block::zero();
    let probes = Probes {
        count: Fx::int(1),
        step: [Fx::zero(); 2],
        lod: Fx::zero(),
        empty: !never::<W>(),
        saturated: never::<W>(),
        capped: never::<W>(),
    };
    let ellipse = Ellipse { k: Block::zero(), det: number };
    let axes = Axes { major: number, minor: number, direction: [Fx::int(1), Fx::zero()] };
    ([Block::zero(); 4], ellipse, axes, probes)
}

/// The outcomes of the stages in the form of ports.
#[inline(always)]
pub fn leave<W: Staged>(stages: &Reflection<W>) -> ReflectionOutput<W> {
    let Surface { normal, frame, normal_mod, .. } = &stages.surface;
    stage!(
        "leave",
        ReflectionOutput {
            frame: each!(e in [frame.e1, frame.e2] => leave::leave(&e.scaled(normal.e))),
            normal_mod: leave::leave(normal_mod),
            reflected: leave::leave(&stages.reflected.r),
            columns: each!(q in stages.columns => leave::leave(&q)),
            covariance: leave::leave(&stages.ellipse.k),
            determinant: leave::leave(&stages.ellipse.det),
            major: leave::leave(&stages.axes.major),
            minor: leave::leave(&stages.axes.minor),
            direction: stages.axes.direction,
            face: stages.point.select.index(),
            st: stages.point.st,
            probes: stages.probes.count,
            step: stages.probes.step,
            lod: stages.probes.lod,
            status: stages.status,
        }
    )
}

/// The reflection datapath from ports to ports.
#[inline(always)]
pub fn fragment<W: Staged>(input: &ReflectionInput<W>, plan: &ReflectionPlan, p: &Precision) -> ReflectionOutput<W> {
    let map = map_scale(input.edge_texels, p);
    leave(&reflection(input, &map, plan, p))
}
