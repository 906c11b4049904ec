//! Observation: what the wires of a net carry for given fragments, beside what the interval walk says they may.
//!
//! An interval is proven for every pattern of bits at every port; what real fragments put on the wire shows how much of
//! it is meant for cases that do not occur. A value outside the proven range would be an error of the walk.

use glam::DVec3;
use roughxel_core::datapath::{self, HighlightInput};
use roughxel_core::fx::Fx;
use roughxel_core::plan::ReflectionPlan;
use roughxel_core::ports::{ReflectionIn, environment_scale, texture_scale};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::setup::{self, stored_horizon, stored_peak};
use roughxel_core::signals::{LIGHT, PeakSum, PortBlock, SHARE, TexturePosition};
use roughxel_core::stage::enter::enter;

use super::design::{
    Edge, EnvironmentProbeInput, FaceAddressInput, FragmentInput, HorizonInput, LevelsInput, LocalInput, PeakInput,
    RepeatAddressInput, TextureInput, TextureProbeInput,
};
use super::graph::{Net, NodeId};
use super::interval::{Range, Ranges};
use super::record::integers;
use crate::random::SplitMix64;

/// What one wire has carried.
#[derive(Clone, Copy, Debug)]
struct Seen {
    low: i64,
    high: i64,
    /// Every bit that was ever set.
    bits: i64,
}

/// What the wires of a net have carried so far.
#[derive(Clone, Debug)]
pub struct Observed {
    /// Evaluations so far.
    pub evaluations: u64,
    seen: Vec<Seen>,
    wires: Vec<i64>,
}

impl Observed {
    /// Nothing yet.
    pub fn new(net: &Net) -> Self {
        let seen = vec![Seen { low: i64::MAX, high: i64::MIN, bits: 0 }; net.nodes.len()];
        Self { evaluations: 0, seen, wires: Vec::new() }
    }

    /// Computes every wire of `net`, the one it was made for, from the integers of the ports and keeps what they carry.
    /// The wires are returned, one a node.
    pub fn evaluate(&mut self, net: &Net, ports: &[i64]) -> &[i64] {
        net.evaluate(ports, &mut self.wires);
        self.evaluations += 1;
        for (seen, &value) in self.seen.iter_mut().zip(&self.wires) {
            *seen = Seen { low: seen.low.min(value), high: seen.high.max(value), bits: seen.bits | value };
        }
        &self.wires
    }

    /// The range of what a wire has carried; `None` before the first evaluation.
    pub fn of(&self, id: NodeId) -> Option<Range> {
        let Seen { low, high, bits } = *self.seen.get(id as usize)?;
        let range = Range { low, high, zeros: bits.trailing_zeros().min(62) };
        (low <= high).then_some(if low == high { Range::of(low) } else { range })
    }

    /// The first wire that has left its proven range. There is none, or the interval walk is wrong.
    pub fn first_outside(&self, ranges: &Ranges) -> Option<NodeId> {
        (0..self.seen.len() as NodeId).find(|&id| {
            let proven = ranges.of(id);
            self.of(id).is_some_and(|seen| {
                seen.low < proven.low || seen.high > proven.high || seen.zeros < proven.zeros.min(62)
            })
        })
    }
}

/// Integers for the ports of a design, in the order of [`Net::ports`]: those a fragment leads to (a list for every probe and
/// level it touches), or, behind the memories, random ones that favour the ends of the declared ranges.
///
/// `random` makes what a fragment does not have: the size of a texture, texels and weights. Where ports belong together
/// (a probe's index is below its count) they come from the datapath.
pub fn port_values(
    design: &str,
    net: &Net,
    fragment: &ReflectionIn,
    plan: &ReflectionPlan,
    p: &Precision,
    random: &mut SplitMix64,
) -> Vec<Vec<i64>> {
    let map = environment_scale(fragment.edge_texels, p);
    let wires = fragment.wires(map);
    // A texture of any shape, with the fragment's first derivatives as those of its coordinates.
    let (texture, texture_map) = texture_scale([0; 2].map(|_| {
        let most = 16384 >> random.below(14);
        1 + random.below(most) as u16
    }));
    let duv = wires.dview.map(|d| PortBlock { mantissa: [d.mantissa[0], d.mantissa[1]], exponent: d.exponent });
    match design {
        "fragment" => vec![integers(&FragmentInput::new(fragment))],
        "reflection" => vec![integers(&wires)],
        // A light has any direction: that of the first derivative is as good as another.
        "highlight" => {
            let m = setup::shininess(random.uniform(0.0, 13.0).exp2()).wires();
            vec![integers(&HighlightInput { surface: wires.surface(), light: wires.dview[0], shininess: m })]
        }
        "map_scale" => vec![integers(&Edge { edge_texels: Fx::lit(fragment.edge_texels.clamp(1, 16384).into()) })],
        "texture" => vec![integers(&TextureInput { duv, texture, map: texture_map })],
        "texture_probe" | "repeat_address" => {
            let probes = datapath::texture_footprint(&duv, &texture, &texture_map, p).probes;
            let centre = TexturePosition { uv: [0; 2].map(|_| Fx::lit(random.below(1 << 32) as i64)) };
            let indices = (0..probes.count.raw()).map(Fx::from_raw);
            if design == "texture_probe" {
                let input = |index| TextureProbeInput { centre, probes, index, texture };
                return indices.map(|index| integers(&input(index))).collect();
            }
            let level = probes.lod.floor_shr(16).raw();
            let size = texture.size.map(|edge| Fx::from_raw((edge.raw() >> level).max(1)));
            let place = |index| datapath::texture_probe(&centre, &probes, index, &texture, p).place;
            indices.map(|index| integers(&RepeatAddressInput { place: place(index), size })).collect()
        }
        "environment_probe" | "face_address" | "levels" => {
            let stages = datapath::reflection(&wires, plan, p);
            let (point, probes) = (stages.point, stages.probes);
            if design == "levels" {
                return vec![integers(&LevelsInput { lod: probes.lod, rough: plan.roughness != RoughnessKind::None })];
            }
            let indices = (0..probes.count.raw()).map(Fx::from_raw);
            if design == "environment_probe" {
                return indices.map(|index| integers(&EnvironmentProbeInput { point, probes, index })).collect();
            }
            let edge =
                Fx::from_raw((i32::from(fragment.edge_texels.clamp(1, 16384)) >> (probes.lod.raw() >> 16)).max(1));
            let place = |index| datapath::environment_probe(&point, &probes, index, p).place;
            indices.map(|index| integers(&FaceAddressInput { place: place(index), edge })).collect()
        }
        // Light and eye have any direction: the view and its derivatives are as good as others.
        "local" | "peak" | "horizon" => {
            let stages = datapath::reflection(&wires, plan, p);
            let (frame, normal) = (stages.frame, stages.normal);
            let directions = [stages.view, enter(&wires.dview[0], p), enter(&wires.dview[1], p)];
            if design == "local" {
                return directions.map(|direction| integers(&LocalInput { direction, frame, normal })).into();
            }
            let [_, light, eye] = directions.map(|d| datapath::local_components(&d, &frame, &normal, p));
            if design == "horizon" {
                let mut four = |low, high| [(); 4].map(|()| random.uniform(low, high));
                let horizon = stored_horizon(four(-1.0, 2.0), four(-0.2, 0.6)).wires();
                return vec![integers(&HorizonInput { light, eye, horizon })];
            }
            let h = datapath::local_direction(&directions[0], &frame, &normal, p);
            let exponent = random.uniform(0.0, 13.0).exp2();
            let near = DVec3::from_array(h.unit.map(|m| f64::from(m.raw()) + random.uniform(-1e8, 1e8)));
            let peak = stored_peak(near, random.uniform(-10.0, 6.0).exp2(), exponent).wires();
            let sum = PeakSum { light: Fx::lit(random.below(64 << LIGHT) as i64), saturated: random.below(2) == 1 };
            vec![integers(&PeakInput { h, peak, weight: Fx::lit(random.below((1 << SHARE) + 1) as i64), sum })]
        }
        _ => vec![net.ports.iter().map(|port| within(port.low, port.high, random)).collect()],
    }
}

/// A number from `low` to `high`, often one of the two, zero or a power of two.
pub fn within(low: i64, high: i64, random: &mut SplitMix64) -> i64 {
    let span = high.wrapping_sub(low) as u64;
    let any = low.wrapping_add(if span == u64::MAX { random.next_u64() } else { random.below(span + 1) } as i64);
    match random.below(8) {
        0 => low,
        1 => high,
        2 => 0.clamp(low, high),
        3 => (1_i64 << random.below(63)).clamp(low, high),
        4 => (-1_i64 << random.below(63)).clamp(low, high),
        _ => any,
    }
}
