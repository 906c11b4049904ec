//! The step across an edge of the cube: a smooth environment through the integer filter on both sides of its edges.

use glam::DVec3;
use roughxel_assets::Picture;
use roughxel_core::fx::Fx;
use roughxel_core::plan::{FootprintKind, ReflectionPlan};
use roughxel_core::ports::{Port, ReflectionIn, SurfaceIn};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::scalar_api::{self, environment_scale};
use roughxel_core::setup::block_vector;
use roughxel_core::signals::Probes;
use roughxel_frame::EnvironmentMap;
use roughxel_shader as shader;

use crate::reference::cube::direction_of;

/// Edge of the environment's faces, texels.
const EDGE: u32 = 64;
/// Distance from the edge, on the plane, of each of the two directions of a step. It is 16 last bits of the narrowest profile and 1/128 of a texel,
/// over which the environment itself changes by 0.1 % of its variation.
const ACROSS: f64 = 1.0 / 4096.0;
/// Places along each edge, corners included.
const PLACES: u32 = 33;
/// Samples of a face along each axis, from which its variation is taken.
const GRID: u32 = 17;
/// Number of tested eighths of a level.
const LODS: u32 = 8 * EDGE.ilog2() + 1;

/// Largest step across any of the 12 edges, as a share of the least variation inside a face at the same filter width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubeEdgeStep {
    /// One trilinear probe, at every eighth of a level down to the last.
    pub probe: f64,
    /// The whole chain, round lobes with a standard deviation of 2⁻⁸ to 2⁻⁴ (3.6°; 12° from side to side).
    ///
    /// The footprint lies on the plane of the face it is seen on: a lobe of deviation λ is shifted by about λ² towards
    /// the middle of that face, to either side of an edge.
    pub lobe: f64,
    /// Step of the whole chain for a deviation of ¼ (14°), which is too wide for a footprint on a plane.
    pub wide_lobe: f64,
    /// Footprints on the sphere, round ones and three times as long as wide, with a longer deviation of 2⁻⁸ to 1 (57°; half the sphere from
    /// side to side).
    pub lobe_on_sphere: f64,
}

/// Low frequencies in direction, 0…1, a different one in each channel.
fn smooth(direction: DVec3) -> [f32; 3] {
    let d = direction.normalize();
    [0.5 + 0.25 * (d.x + d.y - d.z), 0.5 + 0.4 * (d.x * d.y + d.z * 0.5), 0.5 + 0.5 * d.y * d.z + 0.2 * d.x]
        .map(|value| value as f32)
}

fn direction(face: usize, s: f64, t: f64) -> DVec3 {
    DVec3::from_array(direction_of(face, s, t))
}

fn environment() -> EnvironmentMap {
    let centre = |index: u32| f64::from(2 * index + 1) / f64::from(EDGE) - 1.0;
    let face = |face: usize| Picture {
        width: EDGE,
        height: EDGE,
        pixels: (0..EDGE * EDGE).map(|i| smooth(direction(face, centre(i % EDGE), centre(i / EDGE)))).collect(),
    };
    EnvironmentMap::new(&[0, 1, 2, 3, 4, 5].map(face), true)
}

/// A mirror that faces the viewer, so that the ray returns along v. Its normal turns in both directions, so that the footprint has the standard
/// deviation `radius` (tangent of the angle) along one axis, and an `aspect` of it along the other. The axis turns smoothly with the direction. A
/// radius of 0 gives no footprint.
fn fragment(direction: DVec3, radius: f64, aspect: f64, p: &Precision) -> ReflectionIn {
    let n = direction.normalize();
    let across = n.cross(DVec3::new(0.3, 0.5, 0.8)).normalize();
    let up = n.cross(across) / aspect;
    // dr = 2|n|² dn for v = n; a pixel's box has variance 1/12.
    let turn = |axis: DVec3| block_vector(axis * (0.5 * 12_f64.sqrt() * radius), p);
    ReflectionIn {
        surface: SurfaceIn { normal: block_vector(n, p), view: block_vector(n, p), ..SurfaceIn::default() },
        dnormal: [turn(across), turn(up)],
        edge_texels: EDGE as u16,
        ..ReflectionIn::default()
    }
}

/// Sample in a direction: a lobe of a standard deviation along one axis and an `aspect` of it along the other, sampled as roughness or as a pixel's
/// box; or one trilinear probe at a level with 16 fraction bits.
#[derive(Clone, Copy)]
struct LobeSample {
    kind: FootprintKind,
    radius: f64,
    aspect: f64,
    rough: bool,
    lod: Option<i32>,
}

impl LobeSample {
    /// One probe at the place of its footprint.
    const PROBE: Self = Self { kind: FootprintKind::Face, radius: 0.0, aspect: 1.0, rough: false, lod: None };
}

struct Sampler<'a> {
    map: EnvironmentMap,
    p: &'a Precision,
}

impl Sampler<'_> {
    fn sample(&self, direction: DVec3, footprint: LobeSample) -> [f64; 3] {
        let LobeSample { kind, radius, aspect, rough, lod } = footprint;
        let roughness = RoughnessKind::None;
        let plan = ReflectionPlan { bump: false, roughness, footprint: kind, ..ReflectionPlan::FULL };
        let input = fragment(direction, radius, aspect, self.p).wires();
        let scale = environment_scale(EDGE as u16, self.p);
        let stages = scalar_api::reflection(&input, &scale, &plan, self.p);
        let probes = Probes { lod: lod.map_or(stages.probes.lod, Fx::from_raw), ..stages.probes };
        let sample = match kind {
            FootprintKind::Sphere => self.map.sample_sphere(&stages.sweep, rough, self.p),
            FootprintKind::None | FootprintKind::Face => {
                self.map.sample(&shader::FaceFootprint { point: stages.point, probes }, rough, self.p)
            }
        };
        sample.map(|channel| channel.raw().into())
    }

    /// Largest step over least variation.
    fn step(&self, footprint: LobeSample) -> f64 {
        let place = |index: u32, count: u32| 2.0 * f64::from(index) / f64::from(count - 1) - 1.0;
        let mut least_variation = f64::INFINITY;
        let mut largest_step = 0.0_f64;
        for face in 0..6 {
            let mut range = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
            for i in 0..GRID * GRID {
                let at = direction(face, place(i % GRID, GRID), place(i / GRID, GRID));
                let colour = self.sample(at, footprint);
                for channel in 0..3 {
                    range[0][channel] = range[0][channel].min(colour[channel]);
                    range[1][channel] = range[1][channel].max(colour[channel]);
                }
            }
            let variation = (0..3).map(|channel| range[1][channel] - range[0][channel]).fold(0.0, f64::max);
            least_variation = least_variation.min(variation);
            for index in 0..PLACES {
                let along = place(index, PLACES);
                for (s, t, ds, dt) in
                    [(-1.0, along, -1.0, 0.0), (1.0, along, 1.0, 0.0), (along, -1.0, 0.0, -1.0), (along, 1.0, 0.0, 1.0)]
                {
                    let edge = direction(face, s, t);
                    let inwards = direction(face, 0.0, 0.0) * ACROSS;
                    let outwards = (direction(face, s + ds, t + dt) - edge) * ACROSS;
                    let [inside, outside] = [edge + inwards, edge + outwards].map(|d| self.sample(d, footprint));
                    for channel in 0..3 {
                        largest_step = largest_step.max((inside[channel] - outside[channel]).abs());
                    }
                }
            }
        }
        largest_step / least_variation
    }
}

/// Measures the steps with a profile.
pub fn cube_edge_step(profile: &Precision) -> CubeEdgeStep {
    let sampler = Sampler { map: environment(), p: profile };
    let largest = |footprints: &mut dyn Iterator<Item = LobeSample>| {
        footprints.map(|footprint| sampler.step(footprint)).fold(0.0, f64::max)
    };
    let lobes = |radius: f64| [false, true].map(|rough| LobeSample { radius, rough, ..LobeSample::PROBE });
    CubeEdgeStep {
        probe: largest(
            &mut (0..LODS).map(|eighths| LobeSample { lod: Some((eighths << 13) as i32), ..LobeSample::PROBE }),
        ),
        lobe: largest(&mut (8..=16).flat_map(|halves| lobes(2_f64.powf(-0.5 * f64::from(halves))))),
        wide_lobe: largest(&mut lobes(0.25).into_iter()),
        lobe_on_sphere: largest(&mut (0..=16).flat_map(|halves| {
            let radius = 2_f64.powf(-0.5 * f64::from(halves));
            let kind = FootprintKind::Sphere;
            let lobe = |aspect, rough| LobeSample { kind, radius, aspect, rough, lod: None };
            [lobe(1.0, false), lobe(1.0, true), lobe(3.0, false), lobe(3.0, true)]
        })),
    }
}
