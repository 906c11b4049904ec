//! Reflections: from the surface to the probes on the environment that it reflects.

use crate::block::{Block, Mantissa};
use crate::bundle::{bundle, never};
use crate::each::each;
use crate::fx::{Fx, Int};
use crate::plan::{FootprintKind, ReflectionPlan};
use crate::ports::{PortBlock, ReflectionInput, ReflectionOutput};
use crate::precision::{Precision, RoughnessKind};
use crate::signals::{Axes, CountAndLevel, CubePoint, Ellipse, MapScale, Probes, Reflected, Sweep};
use crate::stage::columns::{self, Mirror, TangentPlane};
use crate::stage::{cube_face, ellipse, enter, leave, probes, reflect, sweep};
use crate::staged::{Staged, control_stage, stage};
use crate::status::{Status, StatusBit};

use super::footprint::{assemble, pixel_ellipse, principal};
use super::surface::{Surface, surface};

bundle! {
    /// Outcomes of all stages for one fragment. Stages that the plan leaves out have their neutral value.
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
        /// N, step, level of detail; on the sphere N alone.
        probes: Probes<W>,
        /// Path of the probes on the sphere.
        sweep: Sweep<W>,
        /// Sticky bits.
        #[range(0..256)]
        status: Int<W>,
    }
}

/// Scale of an environment whose faces have `edge` texels, any 16-bit number.
#[inline(always)]
pub fn map_scale<W: Staged>(edge: Int<W>, p: &Precision) -> MapScale<W> {
    stage!("map_scale", probes::face_scale(edge, p))
}

/// Reflection datapath of one fragment on an environment of that scale: from n, v, bumps and roughness to the probes on the cube map.
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

/// Reflection of a finished surface, and the point where it meets the cube.
#[inline(always)]
pub fn mirrored<W: Staged>(surface: &Surface<W>, p: &Precision) -> (Reflected<W>, CubePoint<W>) {
    let reflected = stage!("reflect", reflect::reflect(&surface.normal_mod, &surface.view, p));
    let point = stage!("cube_face", cube_face::cube_face(&reflected.r, p));
    (reflected, point)
}

/// Stages after the surface, which was made with at least the stages of [`ReflectionPlan::surface`]. `dview` and `dnormal` are the derivatives over
/// the pixel.
#[inline(always)]
pub fn reflection_of<W: Staged>(
    surface: &Surface<W>,
    [dview, dnormal]: [&[PortBlock<W, 3>; 2]; 2],
    map: &MapScale<W>,
    plan: &ReflectionPlan,
    p: &Precision,
) -> Reflection<W> {
    let (reflected, point) = mirrored(surface, p);
    let mirror = mirror(surface, &reflected, &point);
    let sides = [[&dview[0], &dnormal[0]], [&dview[1], &dnormal[1]]];
    let FootprintStages { columns, ellipse, axes, probes, sweep } = match plan.footprint {
        FootprintKind::None => FootprintStages::none(),
        FootprintKind::Face => on_face(surface, &mirror, sides, map, plan, p),
        FootprintKind::Sphere => on_sphere(surface, &mirror, sides, map, plan, p),
    };

    let status = status(surface, &reflected, &point, &probes);
    Reflection { surface: *surface, reflected, point, columns, ellipse, axes, probes, sweep, status }
}

/// Quantities that all columns of a fragment share.
#[inline(always)]
pub fn mirror<'a, W: Staged>(
    surface: &'a Surface<W>,
    reflected: &'a Reflected<W>,
    point: &'a CubePoint<W>,
) -> Mirror<'a, W> {
    Mirror { normal: &surface.normal_mod, view: &surface.view, reflected, point }
}

/// Sticky bits of a fragment, from the stages that raise them.
#[inline(always)]
pub fn status<W: Staged>(
    Surface { normal, view, frame, .. }: &Surface<W>,
    reflected: &Reflected<W>,
    point: &CubePoint<W>,
    probes: &Probes<W>,
) -> Int<W> {
    control_stage!("status", {
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
    })
}

/// Results from columns to probes, for either kind of footprint; fields of the other kind have their neutral value.
struct FootprintStages<W: Staged> {
    columns: [Block<W, 2>; 4],
    ellipse: Ellipse<W>,
    axes: Axes<W>,
    probes: Probes<W>,
    sweep: Sweep<W>,
}

impl<W: Staged> FootprintStages<W> {
    /// Footprint of a point.
    #[inline(always)]
    fn none() -> Self {
        let number = Block::zero();
        let sweep = Sweep {
            centre: [Fx::zero(); 3],
            first: [Fx::zero(); 3],
            second: [Fx::zero(); 3],
            count: Fx::int(1),
            share: Fx::zero(),
            level: Fx::zero(),
        };
        Self {
            columns: [Block::zero(); 4],
            ellipse: Ellipse { k: Block::zero(), det: number },
            axes: Axes { major: number, minor: number, direction: [Fx::int(1), Fx::zero()] },
            probes: no_probes(),
            sweep,
        }
    }
}

/// Probes of the footprint of a point: one, at the finest level.
#[inline(always)]
pub fn no_probes<W: Staged>() -> Probes<W> {
    Probes {
        count: Fx::int(1),
        step: [Fx::zero(); 2],
        lod: Fx::zero(),
        empty: !never::<W>(),
        saturated: never::<W>(),
        capped: never::<W>(),
    }
}

/// Derivatives of v and n over one side of the pixel.
#[inline(always)]
fn pixel_side<W: Staged>(
    [dview, dnormal]: [&PortBlock<W, 3>; 2],
    plan: &ReflectionPlan,
    p: &Precision,
) -> [Block<W, 3>; 2] {
    let dv = stage!("enter.dview", enter::enter(dview, p));
    let dn = if plan.curvature { stage!("enter.dnormal", enter::enter(dnormal, p)) } else { Block::zero() };
    [dv, dn]
}

/// Column of one side of the pixel on the plane of the face.
#[inline(always)]
pub fn pixel_column<W: Staged>(
    mirror: &Mirror<'_, W>,
    derivatives: [&PortBlock<W, 3>; 2],
    plan: &ReflectionPlan,
    p: &Precision,
) -> Block<W, 2> {
    let [dv, dn] = pixel_side(derivatives, plan, p);
    stage!("columns.pixel", columns::column(mirror, &dv, &dn, p))
}

/// Column of one of the two roughness tangents on the plane of the face.
#[inline(always)]
pub fn rough_column<W: Staged>(
    mirror: &Mirror<'_, W>,
    Surface { normal, rough, .. }: &Surface<W>,
    tangent: usize,
    p: &Precision,
) -> Block<W, 2> {
    // Picked here, where the tangent is known: a stage is a function of its own.
    let dn = &rough[tangent];
    stage!("columns.roughness", columns::column(mirror, &Block::zero(), &dn.scaled(normal.e), p))
}

/// Ellipse of the columns of a pixel and, if the plan has any, of its roughness.
#[inline(always)]
pub fn face_ellipse<W: Staged>(
    pixel: &[Block<W, 2>; 2],
    rough: &[Block<W, 2>; 2],
    plan: &ReflectionPlan,
    p: &Precision,
) -> Ellipse<W> {
    match plan.roughness {
        RoughnessKind::None => pixel_ellipse(pixel, p),
        _ => stage!("ellipse", {
            let [box_x, box_y] = ellipse::pixel_columns(pixel, p);
            ellipse::ellipse([box_x, box_y, rough[0], rough[1]], p)
        }),
    }
}

/// Footprint on the plane of the face (W97).
#[inline(always)]
fn on_face<W: Staged>(
    surface: &Surface<W>,
    mirror: &Mirror<'_, W>,
    sides: [[&PortBlock<W, 3>; 2]; 2],
    map: &MapScale<W>,
    plan: &ReflectionPlan,
    p: &Precision,
) -> FootprintStages<W> {
    let pixel = each!(derivatives in sides => pixel_column(mirror, derivatives, plan, p));
    let rough = match plan.roughness {
        RoughnessKind::None => [Block::zero(); 2],
        _ => each!(side in [0, 1] => rough_column(mirror, surface, side, p)),
    };
    let ellipse = face_ellipse(&pixel, &rough, plan, p);
    let (axes, probes) = assemble(&ellipse, map, p);
    let columns = [pixel[0], pixel[1], rough[0], rough[1]];
    FootprintStages { columns, ellipse, axes, probes, ..FootprintStages::none() }
}

/// Footprint on the tangent plane of the sphere, with normals as probes.
#[inline(always)]
fn on_sphere<W: Staged>(
    Surface { normal, rough, .. }: &Surface<W>,
    mirror: &Mirror<'_, W>,
    sides: [[&PortBlock<W, 3>; 2]; 2],
    map: &MapScale<W>,
    plan: &ReflectionPlan,
    p: &Precision,
) -> FootprintStages<W> {
    let [x, y] = each!(derivatives in sides => pixel_side(derivatives, plan, p));
    match plan.roughness {
        RoughnessKind::None => lobe(mirror, [x, y], map, p),
        _ => {
            let [first, second] = each!(dn in *rough => [Block::zero(), stage!("columns.turn", dn.scaled(normal.e))]);
            lobe(mirror, [x, y, first, second], map, p)
        }
    }
}

/// Lobe of pairs (dv, dn), the first two of them the sides of a pixel. A stage that does not depend on the number of pairs is a function of its own;
/// here it would be compiled for every number.
#[inline(always)]
fn lobe<W: Staged, const COLUMNS: usize>(
    mirror: &Mirror<'_, W>,
    pairs: [[Block<W, 3>; 2]; COLUMNS],
    map: &MapScale<W>,
    p: &Precision,
) -> FootprintStages<W> {
    let plane = tangent_plane(mirror, p);
    let moves = each!([dv, dn] in pairs => derivative(mirror, &dv, &dn, p));
    let q = each!(dr in moves => column_on_sphere(mirror, &plane, &dr, p));
    let deviations = stage!("ellipse.pixel", ellipse::pixel_columns(&q, p));
    let ellipse = stage!("ellipse", ellipse::ellipse(deviations, p));
    let (axes, spread, probes) = spread_probes(&ellipse, map, p);

    let turns = each!([_, dn] in pairs => dn);
    let shares = stage!("sweep.shares", sweep::shares(deviations, &axes, (spread, probes.count), p));
    let first = stage!("sweep.first", sweep::mixed(&shares, &moves, p));
    let turn = stage!("sweep.turn", sweep::mixed(&shares, &turns, p));
    let shift = stage!("sweep.mean", sweep::mean_shift(ellipse::pixel_columns(&turns, p), mirror.view, p));
    let sweep = swept(mirror, [&first, &turn, &shift], &axes, &probes, p);

    let mut columns = [Block::zero(); 4];
    for (column, q) in columns.iter_mut().zip(q) {
        *column = q;
    }
    let none = FootprintStages::none();
    let CountAndLevel { count, empty, capped, .. } = probes;
    FootprintStages { columns, ellipse, axes, probes: Probes { count, empty, capped, ..none.probes }, sweep }
}

#[inline(always)]
fn tangent_plane<W: Staged>(mirror: &Mirror<'_, W>, p: &Precision) -> TangentPlane<W> {
    stage!("columns.plane", columns::tangent_plane(mirror.point, p))
}

#[inline(always)]
fn derivative<W: Staged>(mirror: &Mirror<'_, W>, dv: &Block<W, 3>, dn: &Block<W, 3>, p: &Precision) -> Block<W, 3> {
    stage!("columns.derivative", columns::derivative(mirror, dv, dn, p))
}

#[inline(always)]
fn column_on_sphere<W: Staged>(
    mirror: &Mirror<'_, W>,
    plane: &TangentPlane<W>,
    dr: &Block<W, 3>,
    p: &Precision,
) -> Block<W, 2> {
    stage!("columns.sphere", columns::on_sphere(mirror, plane, dr, p))
}

/// Axes of a lobe, the spread of the probes over the longer one, and their number.
#[inline(always)]
fn spread_probes<W: Staged>(
    ellipse: &Ellipse<W>,
    map: &MapScale<W>,
    p: &Precision,
) -> (Axes<W>, Mantissa<W>, CountAndLevel<W>) {
    let axes = principal(ellipse, p);
    let spread = stage!("sweep.spread", sweep::spread(&axes, p));
    (axes, spread, stage!("probes", probes::count_and_level(&axes, spread, map, p)))
}

/// Sweep of mixed columns: dr, dn, and the distance of the lobe's mean from r.
#[inline(always)]
fn swept<W: Staged>(
    mirror: &Mirror<'_, W>,
    [first, turn, shift]: [&Block<W, 3>; 3],
    axes: &Axes<W>,
    probes: &CountAndLevel<W>,
    p: &Precision,
) -> Sweep<W> {
    let second = stage!("sweep.second", reflect::reflect(turn, mirror.view, p));
    let r = &mirror.reflected.r;
    let centre = stage!("sweep.centre", sweep::centre(r, [shift, &second.r], axes, p));
    stage!("sweep", sweep::sweep(r, [&centre, first, &second.r], probes, p))
}

/// Outcomes of the stages in the form of ports.
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
            sweep: [stages.sweep.centre, stages.sweep.first, stages.sweep.second],
            share: stages.sweep.share,
            level: stages.sweep.level,
            status: stages.status,
        }
    )
}

/// Reflection datapath from ports to ports.
#[inline(always)]
pub fn fragment<W: Staged>(input: &ReflectionInput<W>, plan: &ReflectionPlan, p: &Precision) -> ReflectionOutput<W> {
    let map = map_scale(input.edge_texels, p);
    leave(&reflection(input, &map, plan, p))
}
