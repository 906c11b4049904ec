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
//!  h, frame ──► local ──► peaks ──► light        l, v, frame ──► local ──► horizon ──► weight of a peak
//!
//!  l, v ──► half ──► highlight ◄── spread ◄── perturb, roughness
//! ```

use crate::block::{Block, MANTISSA, Mantissa};
use crate::bundle::{Bundle, Rewire, Step, bundle};
use crate::each::each;
use crate::fx::Fx;
use crate::plan::{FrameSystem, PeakPlan, ReflectionPlan, SurfacePlan};
use crate::precision::{Precision, RoughnessKind};
use crate::signals::{
    Axes, AxisSlope, CubePoint, Ellipse, FacePosition, Frame, Horizon, LIGHT, LOD, LightSide, LocalDirection, MapScale,
    OFFSET, POSITION, Peak, PeakSum, PortBlock, Probes, Reflected, SHARE, SLOPE, Shininess, ShininessPort, Spread,
    TexturePosition,
};
use crate::stage::columns::Mirror;
use crate::stage::texture::TextureScale;
use crate::stage::{
    axes, columns, cube_face, ellipse, enter, frame, half, highlight, horizon, leave, local, peaks, perturb, probes,
    reflect, roughness, texture,
};
use crate::status::{Status, StatusBit};
use crate::word::Word;

/// One stage as a named block of the reading `W`: one function, whatever the optimiser thinks of its size.
macro_rules! block {
    ($name:literal, $stage:expr) => {
        W::block(
            $name,
            #[inline(always)]
            || $stage,
        )
    };
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

bundle!(ReflectionInput { normal, view, tangents, offset, roughness, dview, dnormal, map });

impl<W: Word> ReflectionInput<W> {
    /// What the surface needs of it.
    #[inline(always)]
    pub fn surface(&self) -> SurfaceInput<W> {
        let Self { normal, view, tangents, offset, roughness, .. } = *self;
        SurfaceInput { normal, view, tangents, offset, roughness }
    }
}

/// Inputs of the surface on wires: those of the reflection datapath that do not depend on what it is for.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceInput<W: Word> {
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
}

bundle!(SurfaceInput { normal, view, tangents, offset, roughness });

/// The surface of one fragment, made once for its reflection and all its lights.
#[derive(Clone, Copy, Debug)]
pub struct Surface<W: Word> {
    /// n, normalised.
    pub normal: Block<W, 3>,
    /// v, normalised.
    pub view: Block<W, 3>,
    /// E₁, E₂ in units of the mantissas of n.
    pub frame: Frame<W>,
    /// n_mod.
    pub normal_mod: Block<W, 3>,
    /// d₁E₁ and d₂E₁ + d₃E₂ in units of the mantissas of n; zero where the plan has no roughness.
    pub roughness: [Block<W, 3>; 2],
}

bundle!(Surface { normal, view, frame, normal_mod, roughness });

/// The perturbed and rough surface of one fragment.
#[inline(always)]
pub fn surface<W: Word>(input: &SurfaceInput<W>, plan: &SurfacePlan, p: &Precision) -> Surface<W> {
    let never = !Fx::<W, 0>::zero().is_zero();
    let normal = block!("enter.normal", enter::enter(&input.normal, p));
    let view = block!("enter.view", enter::enter(&input.view, p));

    let frame = if plan.needs_frame() {
        let tangents = match plan.frame {
            FrameSystem::MainDirection => [block!("enter.tangent", enter::enter(&input.tangents[0], p)), Block::zero()],
            FrameSystem::Natural | FrameSystem::NaturalNormalised => {
                input.tangents.map(|tangent| block!("enter.tangent", enter::enter(&tangent, p)))
            }
        };
        block!(
            "frame",
            match plan.frame {
                FrameSystem::MainDirection => frame::main_direction(&normal, &tangents[0], p),
                FrameSystem::Natural => frame::natural(&normal, &tangents, p),
                FrameSystem::NaturalNormalised => frame::natural_normalised(&normal, &tangents, p),
            }
        )
    } else {
        Frame { e1: Block::zero(), e2: Block::zero(), pole: never }
    };

    let normal_mod = if plan.bump {
        let offset = block!("enter.offset", each!(b in input.offset => enter::enter_offset(b, p)));
        block!("perturb", perturb::perturb(&normal, &offset, [&frame.e1, &frame.e2], p))
    } else {
        normal
    };

    let roughness = match plan.roughness {
        RoughnessKind::None => [Block::zero(); 2],
        kind => {
            let d = block!("enter.roughness", each!(d in input.roughness => enter::enter_offset(d, p)));
            block!(
                "roughness",
                match kind {
                    RoughnessKind::Anisotropic => roughness::anisotropic(&d, &frame.e1, &frame.e2, p),
                    _ => roughness::isotropic(d[0], &frame.e1, &frame.e2, p),
                }
            )
        }
    };
    Surface { normal, view, frame, normal_mod, roughness }
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

bundle!(Reflection { normal, view, frame, normal_mod, reflected, point, columns, ellipse, axes, probes, status });

/// The reflection datapath of one fragment: from n, v, bumps and roughness to the probes on the cube map.
#[inline(always)]
pub fn reflection<W: Word>(input: &ReflectionInput<W>, plan: &ReflectionPlan, p: &Precision) -> Reflection<W> {
    reflection_of(&surface(&input.surface(), &plan.surface(), p), input, plan, p)
}

/// What comes after the surface, which was made with the blocks of [`ReflectionPlan::surface`] at least.
#[inline(always)]
pub fn reflection_of<W: Word>(
    surface: &Surface<W>,
    input: &ReflectionInput<W>,
    plan: &ReflectionPlan,
    p: &Precision,
) -> Reflection<W> {
    let Surface { normal, view, frame, normal_mod, roughness } = *surface;
    let reflected = block!("reflect", reflect::reflect(&normal_mod, &view, p));
    let point = block!("cube_face", cube_face::cube_face(&reflected.r, p));

    let (columns, ellipse, axes, probes) = if plan.footprint {
        let mirror = Mirror { normal: &normal_mod, view: &view, reflected: &reflected, point: &point };
        let pixel = core::array::from_fn(|i| {
            let dv = block!("enter.dview", enter::enter(&input.dview[i], p));
            let dn = if plan.curvature {
                block!("enter.dnormal", enter::enter(&input.dnormal[i], p))
            } else {
                Block::zero()
            };
            block!("columns.pixel", columns::column(&mirror, &dv, &dn, p))
        });
        let (rough, ellipse) = match plan.roughness {
            RoughnessKind::None => ([Block::zero(); 2], pixel_ellipse(&pixel, p)),
            _ => {
                let rough = roughness.map(|dn| {
                    block!("columns.roughness", columns::column(&mirror, &Block::zero(), &dn.scaled(normal.e), p))
                });
                let ellipse = block!("ellipse", {
                    let [box_x, box_y] = ellipse::pixel_columns(&pixel, p);
                    ellipse::ellipse([box_x, box_y, rough[0], rough[1]], p)
                });
                (rough, ellipse)
            }
        };
        let (axes, probes) = assemble(&ellipse, &input.map, p);
        ([pixel[0], pixel[1], rough[0], rough[1]], ellipse, axes, probes)
    } else {
        no_footprint(!Fx::<W, 0>::zero().is_zero())
    };

    let status = block!("status", {
        Status::clear()
            .raise(StatusBit::NormalZero, normal.is_zero())
            .raise(StatusBit::ViewZero, view.is_zero())
            .raise(StatusBit::FramePole, frame.pole)
            .raise(StatusBit::ViewBelowSurface, reflected.below)
            .raise(StatusBit::FaceTie, point.tie)
            .raise(StatusBit::FootprintZero, probes.empty)
            .raise(StatusBit::FootprintSaturated, probes.saturated)
            .raise(StatusBit::ProbesCapped, probes.capped)
    });
    Reflection { normal, view, frame, normal_mod, reflected, point, columns, ellipse, axes, probes, status }
}

/// The ellipse of a pixel's two columns.
#[inline(always)]
fn pixel_ellipse<W: Word>(pixel: &[Block<W, 2>; 2], p: &Precision) -> Ellipse<W> {
    block!("ellipse", ellipse::ellipse(ellipse::pixel_columns(pixel, p), p))
}

/// The probes that cover an ellipse on a map.
#[inline(always)]
fn assemble<W: Word>(ellipse: &Ellipse<W>, map: &MapScale<W>, p: &Precision) -> (Axes<W>, Probes<W>) {
    let axes = block!("axes", axes::axes(ellipse, p));
    (axes, block!("probes", probes::probes(&axes, map, p)))
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

/// What leaves the reflection datapath, as [`crate::ports::ReflectionOut`] describes it, in the order of the pipeline.
#[derive(Clone, Copy, Debug)]
pub struct ReflectionOutput<W: Word> {
    /// E₁ and E₂, scaled by |n|.
    pub frame: [PortBlock<W, 3>; 2],
    /// n_mod.
    pub normal_mod: PortBlock<W, 3>,
    /// r.
    pub reflected: PortBlock<W, 3>,
    /// Face 0…5.
    pub face: Fx<W, 0>,
    /// s and t.
    pub st: [Mantissa<W>; 2],
    /// Columns of ∂x, ∂y, d₁E₁, d₂E₁ + d₃E₂.
    pub columns: [PortBlock<W, 2>; 4],
    /// a, b, c of K.
    pub covariance: PortBlock<W, 3>,
    /// det K.
    pub determinant: PortBlock<W, 1>,
    /// λ₁.
    pub major: PortBlock<W, 1>,
    /// λ₂.
    pub minor: PortBlock<W, 1>,
    /// Direction of λ₁.
    pub direction: [Mantissa<W>; 2],
    /// N.
    pub probes: Fx<W, 0>,
    /// Step between probes.
    pub step: [Fx<W, POSITION>; 2],
    /// Level of detail.
    pub lod: Fx<W, LOD>,
    /// Sticky bits.
    pub status: Status<W>,
}

bundle!(ReflectionOutput {
    frame,
    normal_mod,
    reflected,
    face,
    st,
    columns,
    covariance,
    determinant,
    major,
    minor,
    direction,
    probes,
    step,
    lod,
    status
});

/// The outcomes of the stages in the form of ports.
#[inline(always)]
pub fn leave<W: Word>(stages: &Reflection<W>) -> ReflectionOutput<W> {
    block!(
        "leave",
        ReflectionOutput {
            frame: each!(e in [stages.frame.e1, stages.frame.e2] => leave::leave(&e.scaled(stages.normal.e))),
            normal_mod: leave::leave(&stages.normal_mod),
            reflected: leave::leave(&stages.reflected.r),
            face: stages.point.select.index(),
            st: stages.point.st,
            columns: each!(q in stages.columns => leave::leave(&q)),
            covariance: leave::leave(&stages.ellipse.k),
            determinant: leave::leave(&stages.ellipse.det),
            major: leave::leave(&stages.axes.major),
            minor: leave::leave(&stages.axes.minor),
            direction: stages.axes.direction,
            probes: stages.probes.count,
            step: stages.probes.step,
            lod: stages.probes.lod,
            status: stages.status,
        }
    )
}

/// Ports of the reflection datapath as vectors have them: the edge of the environment's faces in place of its scale.
#[derive(Clone, Copy, Debug)]
pub struct FragmentInput<W: Word> {
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
    /// Edge of a face, texels; any 16-bit number.
    pub edge_texels: Fx<W, 0>,
}

bundle!(FragmentInput { normal, view, tangents, offset, roughness, dview, dnormal, edge_texels });

/// The reflection datapath from ports to ports.
#[inline(always)]
pub fn fragment<W: Word>(input: &FragmentInput<W>, plan: &ReflectionPlan, p: &Precision) -> ReflectionOutput<W> {
    let FragmentInput { normal, view, tangents, offset, roughness, dview, dnormal, edge_texels } = *input;
    let map = block!("map_scale", probes::face_scale(edge_texels, p));
    let input = ReflectionInput { normal, view, tangents, offset, roughness, dview, dnormal, map };
    leave(&reflection(&input, plan, p))
}

/// A probe: where it reads and how much it counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Probe<P, W> {
    /// Place on the map.
    pub place: P,
    /// Weight; the weights of one footprint sum to exactly 1.
    pub weight: Fx<W, 16>,
}

impl<W: Word, P: Bundle<W>> Bundle<W> for Probe<P, W> {
    type In<V: Word> = Probe<P::In<V>, V>;
    #[inline(always)]
    fn rewire<V: Word, R: Rewire<W, V>>(&self, with: &mut R) -> Self::In<V> {
        let place = with.part(Step::Field("place"), &self.place);
        Probe { place, weight: with.part(Step::Field("weight"), &self.weight) }
    }
}

/// Probe `index` of an environment footprint: on its face, or across the edge where it leaves the face.
#[inline(always)]
pub fn environment_probe<W: Word>(
    point: &CubePoint<W>,
    probes: &Probes<W>,
    index: Fx<W, 0>,
    p: &Precision,
) -> Probe<FacePosition<W>, W> {
    let offset = block!("probes.position", probes::position(probes, index));
    let place = block!("continuation", cube_face::continuation(point, &offset, p));
    Probe { place, weight: block!("probes.weight", probes::weight(probes, index, p)) }
}

/// Probe `index` of a footprint in a repeated map.
#[inline(always)]
pub fn texture_probe<W: Word>(
    centre: &TexturePosition<W>,
    probes: &Probes<W>,
    index: Fx<W, 0>,
    texture: &TextureScale<W>,
    p: &Precision,
) -> Probe<TexturePosition<W>, W> {
    let offset = block!("probes.position", probes::position(probes, index));
    let place = block!("texture.position", texture::texture_position(centre, &offset, texture));
    Probe { place, weight: block!("probes.weight", probes::weight(probes, index, p)) }
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

bundle!(TextureFootprint { columns, ellipse, axes, probes });

/// Footprint of a pixel in a colour or bump map: the environment's ellipse, axes and probes, other columns.
#[inline(always)]
pub fn texture_footprint<W: Word>(
    derivatives: &[PortBlock<W, 2>; 2],
    texture: &TextureScale<W>,
    map: &MapScale<W>,
    p: &Precision,
) -> TextureFootprint<W> {
    let columns = each!(duv in *derivatives => {
        let duv = block!("enter.duv", enter::enter(&duv, p));
        block!("texture", texture::texture_column(&duv, texture, p))
    });
    let ellipse = pixel_ellipse(&columns, p);
    let (axes, probes) = assemble(&ellipse, map, p);
    TextureFootprint { columns, ellipse, axes, probes }
}

/// A direction in the frame of the surface, at any length: of the light and of the eye, for [`horizon_slopes`].
#[inline(always)]
pub fn local_components<W: Word>(
    d: &Block<W, 3>,
    frame: &Frame<W>,
    normal: &Block<W, 3>,
    p: &Precision,
) -> Block<W, 3> {
    block!("local.components", local::components(d, frame, normal, p))
}

/// A direction in the frame of the surface, at unit length: of the half vector, for [`peak`].
#[inline(always)]
pub fn local_direction<W: Word>(
    d: &Block<W, 3>,
    frame: &Frame<W>,
    normal: &Block<W, 3>,
    p: &Precision,
) -> LocalDirection<W> {
    let local = local_components(d, frame, normal, p);
    block!("local.unit", local::unit(&local, p))
}

/// What a light is to the peaks of a fragment.
#[derive(Clone, Copy, Debug)]
pub struct PeakLight<W: Word> {
    /// The half vector.
    pub half: Block<W, 3>,
    /// The half vector in the frame of the surface.
    pub direction: LocalDirection<W>,
    /// The light in the frame of the surface, at any length: for [`horizon_slopes`].
    pub light: Block<W, 3>,
    /// Whether it lights any.
    pub side: LightSide<W>,
}

bundle!(PeakLight { half, direction, light, side });

/// The half vector of a light for the peaks of a fragment. `light` points from the surface to the light.
#[inline(always)]
pub fn peak_light<W: Word>(surface: &Surface<W>, light: &PortBlock<W, 3>, p: &Precision) -> PeakLight<W> {
    let Surface { normal, view, frame, .. } = surface;
    let light = block!("enter.light", enter::enter(light, p));
    let half = block!("half", half::half(&light, view, p));
    let direction = local_direction(&half, frame, normal, p);
    let local = local_components(&light, frame, normal, p);
    let side = block!("local.side", local::side(&light, &local));
    PeakLight { half, direction, light: local, side }
}

/// The light of one stored peak. `weight` is its share of the fragment, times its visibility where there is a horizon.
#[inline(always)]
pub fn peak<W: Word>(h: &LocalDirection<W>, stored: &Peak<W>, weight: Fx<W, SHARE>, p: &Precision) -> Fx<W, LIGHT> {
    block!("peaks.peak", peaks::peak(h, stored, weight, p))
}

/// A sum of peaks with one more.
#[inline(always)]
pub fn peak_sum<W: Word>(sum: &PeakSum<W>, light: Fx<W, LIGHT>) -> PeakSum<W> {
    block!("peaks.sum", peaks::add(sum, light))
}

/// Sticky bits of a finished sum.
#[inline(always)]
pub fn peak_status<W: Word>(h: &LocalDirection<W>, sum: &PeakSum<W>) -> Status<W> {
    block!("peaks.status", peaks::status(h, sum))
}

/// The slopes of a local direction over both axes, once for the light and once for the eye.
#[inline(always)]
pub fn horizon_slopes<W: Word>(local: &Block<W, 3>, p: &Precision) -> [AxisSlope<W>; 2] {
    block!("horizon.slopes", horizon::slopes(local, p))
}

/// The share of a peak's facets that light and eye both clear.
#[inline(always)]
pub fn horizon<W: Word>(
    light: &[AxisSlope<W>; 2],
    eye: &[AxisSlope<W>; 2],
    stored: &Horizon<W>,
    p: &Precision,
) -> Fx<W, SHARE> {
    let [lit, seen] =
        each!(slopes in [light, eye] => block!("horizon.visibility", horizon::visibility(slopes, stored, p)));
    block!("horizon.product", horizon::product(lit, seen))
}

/// Inputs of a highlight on wires; [`crate::ports::HighlightIn`] describes each.
#[derive(Clone, Copy, Debug)]
pub struct HighlightInput<W: Word> {
    /// The surface.
    pub surface: SurfaceInput<W>,
    /// l.
    pub light: PortBlock<W, 3>,
    /// m.
    pub shininess: ShininessPort<W>,
}

bundle!(HighlightInput { surface, light, shininess });

/// What all highlights of a fragment share: the exponent of its material and the spread of its surface.
#[derive(Clone, Copy, Debug)]
pub struct Gloss<W: Word> {
    /// m.
    pub shininess: Shininess<W>,
    /// `None` where the plan has no roughness.
    pub spread: Option<Spread<W>>,
}

/// The material of one fragment, made once for all its lights.
#[inline(always)]
pub fn gloss<W: Word>(
    surface: &Surface<W>,
    shininess: &ShininessPort<W>,
    plan: &SurfacePlan,
    p: &Precision,
) -> Gloss<W> {
    let shininess = block!("enter.shininess", highlight::enter_shininess(shininess, p));
    let spread = match plan.roughness {
        RoughnessKind::None => None,
        _ => Some(block!("highlight.spread", {
            let tangents = each!(c in surface.roughness => c.scaled(surface.normal.e));
            highlight::spread(&surface.normal_mod, &tangents, &shininess, p)
        })),
    };
    Gloss { shininess, spread }
}

/// Every stage's outcome for one light on one fragment.
#[derive(Clone, Copy, Debug)]
pub struct Highlight<W: Word> {
    /// h.
    pub half: Block<W, 3>,
    /// The share of the light that the highlight returns, [0, 1].
    pub f: Fx<W, LIGHT>,
    /// Sticky bits.
    pub status: Status<W>,
}

bundle!(Highlight { half, f, status });

/// The highlight of one light: modified Blinn-Phong. `light` points from the surface to the light.
#[inline(always)]
pub fn highlight<W: Word>(
    surface: &Surface<W>,
    gloss: &Gloss<W>,
    light: &PortBlock<W, 3>,
    p: &Precision,
) -> Highlight<W> {
    let Surface { normal, view, frame, normal_mod, .. } = surface;
    let light = block!("enter.light", enter::enter(light, p));
    let half = block!("half", half::half(&light, view, p));
    let lobe = block!(
        "highlight",
        highlight::lobe([normal, normal_mod], [&light, &half], gloss.spread.as_ref(), &gloss.shininess, p)
    );
    let status = block!("highlight.status", {
        Status::clear()
            .raise(StatusBit::NormalZero, normal.is_zero())
            .raise(StatusBit::ViewZero, view.is_zero())
            .raise(StatusBit::FramePole, frame.pole)
            .raise(StatusBit::LightZero, light.is_zero())
            .raise(StatusBit::HalfZero, half.is_zero())
            .raise(StatusBit::LightBelowSurface, lobe.light_below)
            .raise(StatusBit::HalfBelowSurface, lobe.half_below)
    });
    Highlight { half, f: lobe.f, status }
}

/// Every stage's outcome of the highlight datapath for one fragment with one light.
#[derive(Clone, Copy, Debug)]
pub struct LitSurface<W: Word> {
    /// The surface.
    pub surface: Surface<W>,
    /// Its material.
    pub gloss: Gloss<W>,
    /// The light on it.
    pub highlight: Highlight<W>,
}

/// The highlight datapath of one fragment with one light: surface, material, light.
#[inline(always)]
pub fn lit_surface<W: Word>(input: &HighlightInput<W>, plan: &SurfacePlan, p: &Precision) -> LitSurface<W> {
    let surface = surface(&input.surface, plan, p);
    let gloss = gloss(&surface, &input.shininess, plan, p);
    LitSurface { surface, gloss, highlight: highlight(&surface, &gloss, &input.light, p) }
}

/// What leaves the highlight datapath, as [`crate::ports::HighlightOut`] describes it, in the order of the pipeline.
#[derive(Clone, Copy, Debug)]
pub struct HighlightOutput<W: Word> {
    /// E₁ and E₂, scaled by |n|.
    pub frame: [PortBlock<W, 3>; 2],
    /// n_mod.
    pub normal_mod: PortBlock<W, 3>,
    /// d₁E₁ and d₂E₁ + d₃E₂, scaled by |n|.
    pub tangents: [PortBlock<W, 3>; 2],
    /// The same relative to |n_mod| and to the base deviation.
    pub spread: [PortBlock<W, 3>; 2],
    /// 1/√D.
    pub amplitude: PortBlock<W, 1>,
    /// h.
    pub half: PortBlock<W, 3>,
    /// f.
    pub f: Fx<W, LIGHT>,
    /// Sticky bits.
    pub status: Status<W>,
}

bundle!(HighlightOutput { frame, normal_mod, tangents, spread, amplitude, half, f, status });

/// The outcomes of the highlight's stages in the form of ports; without roughness its spread stands at zero, its amplitude at 1.
#[inline(always)]
pub fn leave_highlight<W: Word>(stages: &LitSurface<W>) -> HighlightOutput<W> {
    let LitSurface { surface: Surface { normal, frame, normal_mod, roughness, .. }, gloss, highlight } = stages;
    let (spread, amplitude) = match &gloss.spread {
        None => ([Block::zero(); 2], Block { m: [Fx::lit(1 << (MANTISSA - 1))], e: Fx::lit(1) }),
        Some(spread) => (spread.tangents, spread.amplitude),
    };
    block!(
        "leave.highlight",
        HighlightOutput {
            frame: each!(e in [frame.e1, frame.e2] => leave::leave(&e.scaled(normal.e))),
            normal_mod: leave::leave(normal_mod),
            tangents: each!(c in *roughness => leave::leave(&c.scaled(normal.e))),
            spread: each!(q in spread => leave::leave(&q)),
            amplitude: leave::leave(&amplitude),
            half: leave::leave(&highlight.half),
            f: highlight.f,
            status: highlight.status,
        }
    )
}

/// Inputs of one light on one peak on wires; [`crate::ports::PeakIn`] describes each.
#[derive(Clone, Copy, Debug)]
pub struct LitPeakInput<W: Word> {
    /// The surface; a peak brings its own normal and roughness.
    pub surface: SurfaceInput<W>,
    /// l.
    pub light: PortBlock<W, 3>,
    /// The peak.
    pub peak: Peak<W>,
    /// Its horizon.
    pub horizon: Horizon<W>,
    /// Its share of the fragment.
    pub weight: Fx<W, SHARE>,
}

bundle!(LitPeakInput { surface, light, peak, horizon, weight });

/// What leaves the datapath of one light on one peak, as [`crate::ports::PeakOut`] describes it.
#[derive(Clone, Copy, Debug)]
pub struct LitPeakOutput<W: Word> {
    /// E₁ and E₂, scaled by |n|.
    pub frame: [PortBlock<W, 3>; 2],
    /// h.
    pub half: PortBlock<W, 3>,
    /// h in the frame of the surface, at unit length.
    pub direction: [Mantissa<W>; 3],
    /// l in the frame of the surface.
    pub light: PortBlock<W, 3>,
    /// v in the frame of the surface.
    pub eye: PortBlock<W, 3>,
    /// Slopes of l and of v over both axes.
    pub slopes: [[Fx<W, SLOPE>; 2]; 2],
    /// The share of the facets that light and eye clear.
    pub visibility: Fx<W, SHARE>,
    /// The light that the peak returns.
    pub peak: Fx<W, LIGHT>,
    /// Sticky bits.
    pub status: Status<W>,
}

bundle!(LitPeakOutput { frame, half, direction, light, eye, slopes, visibility, peak, status });

/// One light on one peak of a fragment: frame, half vector, horizon, peak; every stage's outcome in the form of ports.
///
/// A fragment with several peaks has what comes before [`horizon`](horizon()) once for all of them.
#[inline(always)]
pub fn lit_peak<W: Word>(input: &LitPeakInput<W>, plan: &PeakPlan, p: &Precision) -> LitPeakOutput<W> {
    let surface = surface(&input.surface, &plan.surface(), p);
    let lit = peak_light(&surface, &input.light, p);
    let (eye, slopes, visibility) = if plan.horizon {
        let eye = local_components(&surface.view, &surface.frame, &surface.normal, p);
        let [of_light, of_eye] = each!(local in [lit.light, eye] => horizon_slopes(&local, p));
        let slopes = each!(axes in [of_light, of_eye] => each!(axis in axes => axis.slope));
        (eye, slopes, horizon(&of_light, &of_eye, &input.horizon, p))
    } else {
        (Block::zero(), [[Fx::zero(); 2]; 2], Fx::lit(1 << SHARE))
    };
    let weight =
        block!("peaks.weight", { peaks::lit(&lit.side, horizon::product(peaks::share(input.weight), visibility)) });
    let sum = peak_sum(&peaks::none(), peak(&lit.direction, &input.peak, weight, p));
    let status = block!("peaks.status", {
        peaks::status(&lit.direction, &sum)
            .raise(StatusBit::NormalZero, surface.normal.is_zero())
            .raise(StatusBit::ViewZero, surface.view.is_zero())
            .raise(StatusBit::FramePole, surface.frame.pole)
            .raise(StatusBit::LightZero, lit.side.none)
            .raise(StatusBit::HalfZero, lit.half.is_zero())
            .raise(StatusBit::LightBelowSurface, lit.side.below)
    });
    block!(
        "leave.peak",
        LitPeakOutput {
            frame: each!(e in [surface.frame.e1, surface.frame.e2] => leave::leave(&e.scaled(surface.normal.e))),
            half: leave::leave(&lit.half),
            direction: lit.direction.unit,
            light: leave::leave(&lit.light),
            eye: leave::leave(&eye),
            slopes,
            visibility,
            peak: sum.light,
            status,
        }
    )
}
