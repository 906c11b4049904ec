//! Stimulus: integers for the ports of a design.
//!
//! What a fragment leads to at ports inside the datapath comes from the datapath itself, in the scalar reading; what no
//! fragment decides is random and favours the ends of its range.

use glam::DVec3;
use roughxel_core::datapath::{self, HighlightInput, LitPeakInput};
use roughxel_core::fx::Fx;
use roughxel_core::plan::Effects;
use roughxel_core::ports::{self, ReflectionIn, environment_scale, texture_scale};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::setup::{self, stored_horizon, stored_peak};
use roughxel_core::signals::{LIGHT, PeakSum, PortBlock, SHARE, TexturePosition};
use roughxel_core::stage::enter::enter;

use crate::net::design::{
    Edge, EnvironmentProbeInput, FaceAddressInput, HorizonInput, LevelsInput, LocalInput, PeakInput,
    RepeatAddressInput, TextureInput, TextureProbeInput,
};
use crate::net::graph::Net;
use crate::net::record::integers;
use crate::random::SplitMix64;

/// Integers for the ports of a design, in the order of [`Net::ports`]: those a fragment leads to (a list for every probe and
/// level it touches), or, behind the memories, random ones that favour the ends of the declared ranges.
///
/// `random` makes what a fragment does not have: the size of a texture, texels and weights. Where ports belong together
/// (a probe's index is below its count) they come from the datapath.
pub fn port_values(
    design: &str,
    net: &Net,
    fragment: &ReflectionIn,
    effects: &Effects,
    p: &Precision,
    random: &mut SplitMix64,
) -> Vec<Vec<i64>> {
    let plan = &effects.reflection();
    let map = environment_scale(fragment.edge_texels, p);
    let wires = fragment.wires(map);
    // A texture of any shape, with the fragment's first derivatives as those of its coordinates.
    let (texture, texture_map) = texture_scale([0; 2].map(|_| {
        let most = 16384 >> random.below(14);
        1 + random.below(most) as u16
    }));
    let duv = wires.dview.map(|d| PortBlock { mantissa: [d.mantissa[0], d.mantissa[1]], exponent: d.exponent });
    match design {
        "fragment" => vec![integers(&fragment.fragment())],
        "reflection" => vec![integers(&wires)],
        // A light has any direction: that of the first derivative is as good as another.
        "highlight" => {
            let m = setup::shininess(random.uniform(0.0, 13.0).exp2()).wires();
            vec![integers(&HighlightInput { surface: wires.surface(), light: wires.dview[0], shininess: m })]
        }
        "lit_peak" => {
            let mut any = |low, high| random.uniform(low, high);
            let normal = DVec3::new(any(-1.0, 1.0), any(-1.0, 1.0), any(0.0, 1.0));
            let peak = stored_peak(normal, any(-10.0, 6.0).exp2(), any(0.0, 13.0).exp2()).wires();
            let mut four = |low, high| [(); 4].map(|()| any(low, high));
            let horizon = stored_horizon(four(-1.0, 2.0), four(-0.2, 0.6)).wires();
            let weight = Fx::lit(random.below(1 << (SHARE + 1)) as i64);
            vec![integers(&LitPeakInput { surface: wires.surface(), light: wires.dview[0], peak, horizon, weight })]
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
            let stages = ports::reflection(&wires, plan, p);
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
            let stages = ports::reflection(&wires, plan, p);
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
