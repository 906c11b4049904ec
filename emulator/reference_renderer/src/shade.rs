//! One sample in float64, from attributes to colour, by the mathematics of the reference.

use std::sync::Arc;

use roughxel_core::plan::{FootprintKind, FrameSystem};
use roughxel_core::ports::{BlockPair, BlockVector};
use roughxel_core::precision::{Precision, ProbeRule, ProbeWeights, RoughnessKind};
use roughxel_frame::plan::{Mode, object_plan};
use roughxel_frame::raster::{Projection, SUBPIXELS};
use roughxel_frame::shared::{address, shared};
use roughxel_maps::bump::BumpPyramid;
use roughxel_maps::law::Law;
use roughxel_scene::{Background, Object, Scene};
use roughxel_shader::FragmentAttributes;
use roughxel_shader::ObjectPlan;

use super::footprint::{Footprints, ProbeRow};
use super::maps::{self, BUMP_CHANNELS};
use roughxel_reference::cube::select;
use roughxel_reference::filter::{
    CubeMap, Map, cube_assemble, cube_trilinear, differences, texels_to_repeats, trilinear,
};
use roughxel_reference::linear::{add_scaled, norm, scaled};
use roughxel_reference::probes::{self, ProbePlan};
use roughxel_reference::roughness::Covariance;
use roughxel_reference::sphere::LobeProbe;
use roughxel_reference::{
    self as reference, Inputs, Options, Roughness, columns_in_texels, frame, perturb, reflect, roughness,
};

/// Everything a sample needs.
pub(super) struct Shader<'a> {
    scene: &'a Scene,
    projection: &'a Projection,
    footprints: &'a dyn Footprints,
    filters: bool,
    rule: probes::ProbeRule,
    max_probes: u32,
    /// Probe weights for each count, from 1.
    weights: Vec<Vec<f64>>,
    environment: Option<Vec<CubeMap<3>>>,
    objects: Vec<ShadedObject<'a>>,
}

struct ShadedObject<'a> {
    object: &'a Object,
    plan: ObjectPlan,
    /// Levels of its maps, which other objects may share.
    colour: Option<Arc<Vec<Map<3>>>>,
    bump: Option<Arc<Vec<Map<BUMP_CHANNELS>>>>,
    /// Weight and widths of two lobes on each level of the bump map, the finest first.
    lobes: Vec<[f64; 3]>,
}

/// A probe in a wrapped map.
struct Probe {
    /// Middle of the probe, in wraps.
    uv: [f64; 2],
    /// Level of detail, at least that of the finest level.
    lod: f64,
    /// Width of the probe in texels of the finest level: twice its standard deviation, at most 1.
    reach: f64,
}

fn real_vector(v: BlockVector) -> [f64; 3] {
    v.mantissa.map(|m| f64::from(m.to_bits()) * 2_f64.powi(i32::from(v.exponent) - 30))
}

fn real_pair(v: BlockPair) -> [f64; 2] {
    v.mantissa.map(|m| f64::from(m.to_bits()) * 2_f64.powi(i32::from(v.exponent) - 30))
}

impl<'a> Shader<'a> {
    /// Builds the maps of a scene that the plan needs.
    pub(super) fn new(
        scene: &'a Scene,
        projection: &'a Projection,
        mode: Mode,
        profile: &Precision,
        footprints: &'a dyn Footprints,
    ) -> Self {
        let p = mode.precision(profile);
        let filters = mode.filters();
        let environment = scene.shown_environment().map(|source| maps::environment(&source.faces, filters));
        let materials = || scene.objects.iter().map(|object| &object.material);
        let colours = shared(materials().map(|own| own.colour_map.as_deref().map(address)), |group| {
            let own = scene.objects[group[0]].material.colour_map.as_deref();
            vec![own.map(|map| Arc::new(maps::colour(map, filters))); group.len()]
        });
        let planned = shared(materials().map(|own| BumpPyramid::key(own, filters)), |group| {
            let own = &scene.objects[group[0]].material;
            let pyramid = environment.as_ref().and_then(|_| BumpPyramid::of_material(own, filters, &p));
            let plan =
                |&index: &usize| object_plan(&scene.objects[index], pyramid.as_ref(), environment.is_some(), mode, &p);
            let plans: Vec<ObjectPlan> = group.iter().map(plan).collect();
            let lobes = laws(pyramid.as_ref());
            let bump = pyramid.filter(|_| plans.iter().any(ObjectPlan::bump_map));
            let bump = bump.map(|pyramid| Arc::new(maps::bump(&pyramid)));
            let planned = |plan: ObjectPlan| (plan, lobes.clone(), bump.clone().filter(|_| plan.bump_map()));
            plans.into_iter().map(planned).collect()
        });
        let objects = scene.objects.iter().zip(colours).zip(planned);
        let objects =
            objects.map(|((object, colour), (plan, lobes, bump))| ShadedObject { object, plan, colour, bump, lobes });
        let kind = match p.probe_weights {
            ProbeWeights::Box => probes::ProbeWeights::Box,
            ProbeWeights::Gaussian => probes::ProbeWeights::Gaussian,
        };
        Self {
            scene,
            projection,
            footprints,
            filters,
            rule: match p.probe_rule {
                ProbeRule::Ceiling => probes::ProbeRule::Ceiling,
                ProbeRule::PowerOfTwo => probes::ProbeRule::PowerOfTwo,
            },
            max_probes: p.max_probes,
            weights: (1..=p.max_probes).map(|count| probes::weights(count, kind)).collect(),
            objects: objects.collect(),
            environment,
        }
    }

    /// Returns true if fragments of an object need p_u and p_v.
    pub(super) fn needs_tangents(&self, object: usize) -> bool {
        let plan = self.objects[object].plan.reflection;
        plan.is_some_and(|plan| plan.needs_frame() && plan.frame != FrameSystem::MainDirection)
    }

    /// Colour of one fragment.
    pub(super) fn fragment(&self, object: usize, attributes: &FragmentAttributes) -> [f64; 3] {
        let shaded = &self.objects[object];
        let material = &shaded.object.material;
        let mut surface = material.colour.map(f64::from);
        if let Some(map) = &shaded.colour {
            let texel = self.repeated(map, attributes, 0.0, |at| trilinear(map, at.uv, at.lod));
            surface = core::array::from_fn(|i| surface[i] * texel[i]);
        }
        let (Some(environment), Some(_)) = (&self.environment, shaded.plan.reflection) else { return surface };
        let look = |deviations| self.reflection(shaded, environment, attributes, deviations);
        let rough_map = shaded.bump.as_ref().filter(|_| shaded.plan.two_lobes);
        let reflection = if let Some(map) = rough_map {
            let (weight, widths) = self.law(&shaded.lobes, map, attributes);
            let [first, second] = widths.map(look);
            core::array::from_fn(|i| weight * first[i] + (1.0 - weight) * second[i])
        } else {
            look(1.0)
        };
        core::array::from_fn(|i| {
            let share = f64::from(material.reflectance[i]).clamp(0.0, 1.0);
            (1.0 - share) * surface[i] + share * reflection[i]
        })
    }

    /// The footprint of a fragment in a wrapped map of a size, texels.
    fn probes_in(&self, size: [u32; 2], attributes: &FragmentAttributes) -> ProbePlan {
        let columns = columns_in_texels(attributes.duv.map(real_pair), size);
        reference::texture(columns, 1.0, size, self.rule, self.max_probes).probes
    }

    /// The mean over the footprint of a fragment in a wrapped map, or the value at its position. `bias` ≤ 0 moves the level of
    /// detail; `sample` gives the value of a probe.
    fn repeated<const C: usize>(
        &self,
        levels: &[Map<C>],
        attributes: &FragmentAttributes,
        bias: f64,
        sample: impl Fn(&Probe) -> [f64; C],
    ) -> [f64; C] {
        let uv = attributes.uv.map(|u| f64::from(u.to_bits()) * 2_f64.powi(-32));
        if !self.filters {
            return sample(&Probe { uv, lod: 0.0, reach: 0.0 });
        }
        let size = [levels[0].width as u32, levels[0].height as u32];
        let plan = texels_to_repeats(&self.probes_in(size, attributes), size);
        let (lod, reach) = ((plan.lod + bias).max(0.0), (2.0 * plan.minor).min(1.0));
        let mut mean = [0.0; C];
        for (index, &weight) in (0..plan.count).zip(&self.weights[plan.count as usize - 1]) {
            let at = Probe { uv: add_scaled(uv, 1.0, plan.offset(index)), lod, reach };
            mean = add_scaled(mean, weight, sample(&at));
        }
        mean
    }

    /// Weight of the first lobe and the widths of both, between those of two levels.
    fn law(&self, laws: &[[f64; 3]], map: &[Map<BUMP_CHANNELS>], attributes: &FragmentAttributes) -> (f64, [f64; 2]) {
        let lod = self.probes_in([map[0].width as u32, map[0].height as u32], attributes).lod;
        let lod = (lod + bias_of(RoughnessKind::Anisotropic)).clamp(0.0, (laws.len() - 1) as f64);
        let fine = laws[lod.floor() as usize];
        let coarse = laws[lod.ceil() as usize];
        let [weight, first, second] = core::array::from_fn(|i| fine[i] + lod.fract() * (coarse[i] - fine[i]));
        (weight, [first, second])
    }

    /// Mean offset and covariance over the footprint. Within a probe b and K are interpolated, and half the variance of the ramp
    /// between its texels is roughness. Between the probes of a footprint the variance of their means counts (errata 14 and 15).
    fn bump(
        &self,
        levels: &[Map<BUMP_CHANNELS>],
        kind: RoughnessKind,
        attributes: &FragmentAttributes,
    ) -> ([f64; 2], Covariance) {
        let second_moments = |at: &Probe| {
            let [u, v, mut a, mut b, mut c] = trilinear(levels, at.uv, at.lod);
            for [d1, d2, ..] in differences(levels, at.uv, at.lod) {
                let share = at.reach * at.reach / 8.0;
                (a, b, c) = (a + share * d1 * d1, b + share * d1 * d2, c + share * d2 * d2);
            }
            [u, v, a + u * u, b + u * v, c + v * v]
        };
        let [u, v, m11, m12, m22] = self.repeated(levels, attributes, bias_of(kind), second_moments);
        ([u, v], [(m11 - u * u).max(0.0), m12 - u * v, (m22 - v * v).max(0.0)])
    }

    /// The reflection of a lobe whose deviations are multiplied by `deviations`.
    fn reflection(
        &self,
        shaded: &ShadedObject<'_>,
        environment: &[CubeMap<3>],
        attributes: &FragmentAttributes,
        deviations: f64,
    ) -> [f64; 3] {
        let Some(plan) = shaded.plan.reflection else { return [0.0; 3] };
        let (offset, spread) = match &shaded.bump {
            None => ([0.0; 2], [0.0; 3]),
            Some(map) => {
                let (offset, k) = self.bump(map, plan.roughness, attributes);
                let spread = match plan.roughness {
                    RoughnessKind::None => [0.0; 3],
                    RoughnessKind::Isotropic => [roughness::isotropic(k), 0.0, 0.0],
                    RoughnessKind::Anisotropic => roughness::decompose(k),
                };
                let spread = scaled(deviations, spread);
                (offset, spread)
            }
        };
        let tangents = match plan.frame {
            FrameSystem::MainDirection => [shaded.object.material.main_direction.to_array(), [0.0; 3]],
            FrameSystem::Natural | FrameSystem::NaturalNormalised => attributes.frame_vectors.map(real_vector),
        };
        let system = match plan.frame {
            FrameSystem::MainDirection => frame::FrameSystem::MainDirection,
            FrameSystem::Natural => frame::FrameSystem::Natural,
            FrameSystem::NaturalNormalised => frame::FrameSystem::NaturalNormalised,
        };
        let (normal, view) = (real_vector(attributes.normal), real_vector(attributes.view));
        if !plan.footprint.is_some() {
            // n and v get length 1: no result depends on it, and no square leaves the range of float64.
            let [normal, view] = [normal, view].map(|v| scaled(1.0 / norm(&v), v));
            let perturbed = if plan.bump {
                perturb::perturb(normal, &frame::frame(system, normal, tangents), offset)
            } else {
                normal
            };
            return environment[0].bilinear(&select(reflect::reflect(view, perturbed)));
        }
        let edge_texels = environment[0].faces[0].width as u32;
        let inputs = Inputs {
            normal,
            view,
            tangents,
            offset,
            roughness: spread,
            dview: attributes.dview.map(real_vector),
            dnormal: if plan.curvature { attributes.dnormal.map(real_vector) } else { [[0.0; 3]; 2] },
            edge_texels,
        };
        let options = Options {
            frame: system,
            roughness: match plan.roughness {
                RoughnessKind::None => Roughness::None,
                RoughnessKind::Isotropic => Roughness::Isotropic,
                RoughnessKind::Anisotropic => Roughness::Anisotropic,
            },
            probe_rule: self.rule,
            max_probes: self.max_probes,
        };
        let bias = bias_of(plan.roughness);
        if plan.footprint == FootprintKind::Sphere {
            let probes = self.footprints.lobe(&inputs, &options);
            return probes.map_or([0.0; 3], |probes| swept(environment, &probes, bias));
        }
        let footprint = self.footprints.footprint(&inputs, &options);
        footprint.map_or([0.0; 3], |footprint| self.assembled(environment, &footprint, bias))
    }

    /// The probes of a footprint; `bias` ≤ 0 moves their level of detail.
    fn assembled(&self, environment: &[CubeMap<3>], footprint: &ProbeRow, bias: f64) -> [f64; 3] {
        let &ProbeRow { centre, count, step, lod } = footprint;
        let lod = (lod + bias).max(0.0);
        // A filter does not use the origin of the level.
        let plan = ProbePlan { count, step, lod, minor: 0.0, capped: false, lod_unclamped: lod };
        cube_assemble(environment, &centre, &plan, &self.weights[count as usize - 1])
    }

    /// Colour of a ray that hits nothing; position in sub-pixels.
    pub(super) fn background(&self, x: i32, y: i32) -> [f64; 3] {
        match (&self.scene.background, &self.environment) {
            (Background::Colour(colour), _) => colour.map(f64::from),
            (Background::Ramp { top, bottom }, _) => {
                let down = f64::from(y) / f64::from(self.projection.height() as i32 * SUBPIXELS);
                core::array::from_fn(|i| f64::from(top[i]) + (f64::from(bottom[i]) - f64::from(top[i])) * down)
            }
            (Background::Environment, None) => [0.0; 3],
            (Background::Environment, Some(environment)) => {
                let ray = scaled(-1.0, real_vector(self.projection.ray_view(x, y)));
                if !self.filters {
                    return environment[0].bilinear(&select(ray));
                }
                let edge = environment[0].faces[0].width as u32;
                let selection = select(ray);
                let column = |d: BlockVector| {
                    let d = scaled(-1.0, real_vector(d));
                    let [ds, dt, dm] = reference::cube::face_components(selection.face, d);
                    [(ds - selection.s * dm) / selection.m, (dt - selection.t * dm) / selection.m]
                };
                let columns = self.projection.dview().map(column);
                let footprint =
                    reference::texture(columns, 0.5 * f64::from(edge), [edge; 2], self.rule, self.max_probes);
                self.assembled(environment, &ProbeRow::new(selection, &footprint.probes, footprint.axes.major), 0.0)
            }
        }
    }
}

/// Laws of the two lobes of a map on each level; one for all levels if the map has none of its own.
fn laws(pyramid: Option<&BumpPyramid>) -> Vec<[f64; 3]> {
    let laws = pyramid.map_or(&[][..], |pyramid| &pyramid.laws);
    if laws.is_empty() {
        return vec![[0.5, 1.0, 0.25]];
    }
    let numbers = |law: &Law| {
        [f64::from(law.weight) / 65536.0, f64::from(law.widths[0]) / 4096.0, f64::from(law.widths[1]) / 4096.0]
    };
    laws.iter().map(numbers).collect()
}

/// Shift of the levels of detail that gives probes the variance λ₂². It applies to footprints of rough surfaces, in the bump map
/// and in the reflection.
fn bias_of(kind: RoughnessKind) -> f64 {
    if kind == RoughnessKind::None { 0.0 } else { -0.5 * 3_f64.log2() }
}

/// The mean of probes on the sphere; `bias` ≤ 0 moves their levels of detail.
fn swept(environment: &[CubeMap<3>], probes: &[LobeProbe], bias: f64) -> [f64; 3] {
    let last_level = (environment.len() - 1) as f64;
    let mut sum = [0.0; 3];
    for LobeProbe { at, weight, lod } in probes {
        let lod = (lod.clamp(0.0, last_level) + bias).max(0.0);
        sum = add_scaled(sum, *weight, cube_trilinear(environment, at, lod));
    }
    sum
}
