//! The scalar API: the datapaths on the scalar backend, from `fixed` ports to `fixed` ports. A soft core or a host calls it. Each datapath is
//! compiled once, here, for all callers.

use crate::bundle::Value;
use crate::datapath;
use crate::fx::{Fx, Int};
use crate::plan::{PeakPlan, ReflectionPlan, SurfacePlan};
use crate::ports::{
    HighlightIn, HighlightInput, HighlightOut, HighlightOutput, PeakIn, PeakInput, PeakOut, PeakOutput, Port,
    PortBlock, ReflectionIn, ReflectionInput, ReflectionOut, ReflectionOutput, SurfaceInput, TextureIn,
};
use crate::precision::Precision;
use crate::scalar::Scalar;
use crate::signals::{MapScale, SphereProbe, Sweep};
use crate::stage::texture::TextureScale;
use crate::width::on_words;

/// Constants of a map of `size` texels for [`TextureIn::footprint`]; edges are read as 1…16384.
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

/// Scale of an environment whose faces have `edge` texels, read as 1…16384.
pub fn environment_scale(edge: u16, p: &Precision) -> MapScale<Scalar> {
    map_scale(Fx::from_raw(i32::from(edge)), p)
}

/// Scale of an environment from its port.
fn map_scale(edge: Int<Scalar>, p: &Precision) -> MapScale<Scalar> {
    let edge = &Value(edge);
    on_words!(p, |edge| datapath::map_scale(edge.0, p))
}

/// Reflection datapath with the outcomes of all its stages, on an environment of that scale.
pub fn reflection(
    input: &ReflectionInput<Scalar>,
    map: &MapScale<Scalar>,
    plan: &ReflectionPlan,
    p: &Precision,
) -> datapath::Reflection<Scalar> {
    reflection_of(&surface(&input.surface, &plan.surface(), p), [&input.dview, &input.dnormal], map, plan, p)
}

/// Reflection datapath of a finished surface, with the derivatives ∂v and ∂n over the pixel.
pub fn reflection_of(
    surface: &datapath::Surface<Scalar>,
    [dview, dnormal]: [&[PortBlock<Scalar, 3>; 2]; 2],
    map: &MapScale<Scalar>,
    plan: &ReflectionPlan,
    p: &Precision,
) -> datapath::Reflection<Scalar> {
    on_words!(p, |surface, dview, dnormal, map| datapath::reflection_of(surface, [dview, dnormal], map, plan, p))
}

/// Perturbed and rough surface of a fragment.
pub fn surface(input: &SurfaceInput<Scalar>, plan: &SurfacePlan, p: &Precision) -> datapath::Surface<Scalar> {
    on_words!(p, |input| datapath::surface(input, plan, p))
}

/// Normal and tangent basis that the fragments of a surface share.
pub fn framed(input: &SurfaceInput<Scalar>, plan: &SurfacePlan, p: &Precision) -> datapath::Framed<Scalar> {
    on_words!(p, |input| datapath::framed(&input.normal, &input.frame_vectors, plan, p))
}

/// Surface of a fragment whose normal and tangent basis are given.
pub fn surface_in_frame(
    framed: &datapath::Framed<Scalar>,
    input: &SurfaceInput<Scalar>,
    plan: &SurfacePlan,
    p: &Precision,
) -> datapath::Surface<Scalar> {
    on_words!(p, |framed, input| datapath::surface_in_frame(framed, input, plan, p))
}

/// Reflection datapath from ports to ports.
pub fn fragment(input: &ReflectionInput<Scalar>, plan: &ReflectionPlan, p: &Precision) -> ReflectionOutput<Scalar> {
    let stages = &reflection(input, &map_scale(input.edge_texels, p), plan, p);
    on_words!(p, |stages| datapath::reflection::leave(stages))
}

/// Probe `index` of a footprint on the sphere, of an environment with levels up to `last_level`.
pub fn sphere_probe(
    sweep: &Sweep<Scalar>,
    index: Int<Scalar>,
    last_level: Int<Scalar>,
    p: &Precision,
) -> SphereProbe<Scalar> {
    let (index, last_level) = (&Value(index), &Value(last_level));
    on_words!(p, |sweep, index, last_level| datapath::sphere_probe(sweep, index.0, last_level.0, p))
}

/// Footprint of a pixel in a wrapped map of that scale.
pub fn texture_footprint(
    duv: &[PortBlock<Scalar, 2>; 2],
    texture: &TextureScale<Scalar>,
    map: &MapScale<Scalar>,
    p: &Precision,
) -> datapath::TextureFootprint<Scalar> {
    on_words!(p, |duv, texture, map| datapath::texture_footprint(duv, texture, map, p))
}

/// Highlight datapath from ports to ports.
pub fn highlight(input: &HighlightInput<Scalar>, plan: &SurfacePlan, p: &Precision) -> HighlightOutput<Scalar> {
    on_words!(p, |input| datapath::leave_highlight(&datapath::lit_surface(input, plan, p)))
}

/// One light on one peak, from ports to ports.
pub fn lit_peak(input: &PeakInput<Scalar>, plan: &PeakPlan, p: &Precision) -> PeakOutput<Scalar> {
    on_words!(p, |input| datapath::lit_peak(input, plan, p))
}

impl ReflectionIn {
    /// Runs the scalar reflection datapath.
    pub fn reflect(&self, plan: &ReflectionPlan, p: &Precision) -> ReflectionOut {
        Port::from_wires(&fragment(&self.wires(), plan, p))
    }
}

impl TextureIn {
    /// Runs the scalar texture footprint.
    pub fn footprint(
        &self,
        (texture, map): &(TextureScale<Scalar>, MapScale<Scalar>),
        p: &Precision,
    ) -> datapath::TextureFootprint<Scalar> {
        texture_footprint(&self.duv.wires(), texture, map, p)
    }
}

impl HighlightIn {
    /// Runs the scalar highlight datapath.
    pub fn highlight(&self, plan: &SurfacePlan, p: &Precision) -> HighlightOut {
        Port::from_wires(&highlight(&self.wires(), plan, p))
    }
}

impl PeakIn {
    /// Runs the scalar peak datapath.
    pub fn shine(&self, plan: &PeakPlan, p: &Precision) -> PeakOut {
        Port::from_wires(&lit_peak(&self.wires(), plan, p))
    }
}
