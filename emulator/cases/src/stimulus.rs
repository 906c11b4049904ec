//! Stimulus: integers for the ports of a design.
//!
//! Values at ports inside the datapath that a fragment determines come from the datapath itself, on the scalar backend. Values that no fragment
//! determines are random and favour the ends of their range.

use glam::DVec3;
use roughxel_core::datapath::{self, Surface};
use roughxel_core::design::{
    Design, Deviation, Edge, EnvironmentProbeInput, FaceAddressInput, FaceTexelsInput, HorizonInput, LevelsInput,
    LocalInput, MapFootprintInput, ProbeReachInput, RepeatAddressInput, ScaledReflectionInput, SphereProbeInput,
    StoredPeakInput, TextureProbeInput,
};
use roughxel_core::fx::{Control, Fx};
use roughxel_core::plan::{Effects, FootprintKind, ReflectionPlan};
use roughxel_core::ports::{HighlightInput, LIGHT, PeakInput, Port, PortBlock, ReflectionIn, SHARE};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::scalar_api::{environment_scale, reflection, texture_scale};
use roughxel_core::setup::{self, stored_horizon, stored_peak};
use roughxel_core::signals::{PeakSum, TexturePosition};
use roughxel_core::stage::enter::enter;
use roughxel_core::width::on_words;
use roughxel_netlist::graph::Net;
use roughxel_netlist::integers::integers_at;
use roughxel_shader::PackedPeak;
use roughxel_utilities::exp2::exp2;
use roughxel_utilities::random::SplitMix64;

/// Integers for the ports of a design, in the order of [`Net::ports`]. A fragment determines them, with a list for every probe and level that it
/// touches. After the memories they are random and favour the ends of the declared ranges.
///
/// `random` makes the inputs that a fragment does not have: the size of a texture, texels and weights. Ports that depend on each other (a probe's
/// index is below its count) come from the datapath.
pub fn port_values(
    design: Design,
    net: &Net,
    fragment: &ReflectionIn,
    effects: &Effects,
    p: &Precision,
    random: &mut SplitMix64,
) -> Vec<Vec<i64>> {
    let plan = &effects.reflection();
    let map = environment_scale(fragment.edge_texels, p);
    let wires = fragment.wires();
    // A texture of any shape, with the fragment's first derivatives as those of its coordinates.
    let (texture, texture_map) = texture_scale([0; 2].map(|_| {
        let most = 16384 >> random.below(14);
        1 + random.below(most) as u16
    }));
    let duv = wires.dview.map(|d| PortBlock { mantissa: [d.mantissa[0], d.mantissa[1]], exponent: d.exponent });
    let edge = |lod: Control<i32, 16>| {
        Fx::from_raw((i32::from(fragment.edge_texels.clamp(1, 16384)) >> (lod.raw() >> 16)).max(1))
    };
    let share = |random: &mut SplitMix64, most: u64| Control::<i32, SHARE>::lit(random.below(most) as i64);
    match design {
        Design::Fragment => vec![integers_at(&wires, p)],
        Design::Reflection => vec![integers_at(&ScaledReflectionInput { fragment: wires, map }, p)],
        // A light has any direction, so the first derivative serves.
        Design::Highlight => {
            let shininess = setup::shininess(exp2(random.uniform(0.0, 13.0))).wires();
            vec![integers_at(&HighlightInput { surface: wires.surface, light: wires.dview[0], shininess }, p)]
        }
        Design::LitPeak => {
            let mut any = |low, high| random.uniform(low, high);
            let normal = DVec3::new(any(-1.0, 1.0), any(-1.0, 1.0), any(0.0, 1.0));
            let peak = stored_peak(normal, exp2(any(-10.0, 6.0)), exp2(any(0.0, 13.0))).wires();
            let mut four = |low, high| [(); 4].map(|()| any(low, high));
            let horizon = stored_horizon(four(-1.5, 1.5), four(-0.6, 2.0)).wires();
            let weight = share(random, 1 << 17);
            vec![integers_at(&PeakInput { surface: wires.surface, light: wires.dview[0], peak, horizon, weight }, p)]
        }
        Design::MapScale => {
            vec![integers_at(&Edge { edge_texels: Fx::int(fragment.edge_texels.clamp(1, 16384).into()) }, p)]
        }
        Design::Texture => vec![integers_at(&MapFootprintInput { duv, texture, map: texture_map }, p)],
        Design::ProbeReach | Design::TextureProbe | Design::RepeatAddress => {
            let (duv, texture, map) = (&duv, &texture, &texture_map);
            let footprint = on_words!(p, |duv, texture, map| datapath::texture_footprint(duv, texture, map, p));
            let (axes, probes) = (footprint.axes, footprint.probes);
            if design == Design::ProbeReach {
                let [major, minor] = [axes.major, axes.minor].map(|sigma| Deviation { m: sigma.m, e: sigma.e });
                return vec![integers_at(&ProbeReachInput { major, minor, probes, texture: *texture }, p)];
            }
            let centre = TexturePosition { uv: [0; 2].map(|_| Fx::lit(random.below(1 << 32) as i64)) };
            let indices = (0..probes.count.raw()).map(Fx::from_raw);
            if design == Design::TextureProbe {
                let input = |index| TextureProbeInput { centre, probes, index, texture: *texture };
                return indices.map(|index| integers_at(&input(index), p)).collect();
            }
            let level = probes.lod.index(0).raw();
            let size = texture.size.map(|edge| Fx::from_raw((edge.raw() >> level).max(1)));
            let place = |index| datapath::texture_probe(&centre, &probes, index, texture, p).place;
            indices.map(|index| integers_at(&RepeatAddressInput { place: place(index), size }, p)).collect()
        }
        Design::EnvironmentProbe | Design::FaceAddress | Design::FaceTexels | Design::Levels => {
            let stages = reflection(&wires, &map, plan, p);
            let (point, probes) = (stages.point, stages.probes);
            if design == Design::Levels {
                return vec![integers_at(
                    &LevelsInput { lod: probes.lod, rough: plan.roughness != RoughnessKind::None },
                    p,
                )];
            }
            let indices = (0..probes.count.raw()).map(Fx::from_raw);
            if design == Design::EnvironmentProbe {
                return indices.map(|index| integers_at(&EnvironmentProbeInput { point, probes, index }, p)).collect();
            }
            let edge = edge(probes.lod);
            let (point, probes) = (&point, &probes);
            let place =
                |index| on_words!(p, |point, probes| datapath::environment_probe(point, probes, index, p)).place;
            let input = |index| {
                let place = place(index);
                if design == Design::FaceAddress {
                    return integers_at(&FaceAddressInput { place, edge }, p);
                }
                let address = datapath::texel::face_address::<i32>(&place, edge, p);
                integers_at(&FaceTexelsInput { face: place.face, address, edge }, p)
            };
            indices.map(input).collect()
        }
        Design::SphereProbe => {
            let plan = ReflectionPlan { footprint: FootprintKind::Sphere, ..*plan };
            let sweep = reflection(&wires, &map, &plan, p).sweep;
            let last_level = map.last_level;
            let indices = (0..sweep.count.raw()).map(Fx::from_raw);
            indices.map(|index| integers_at(&SphereProbeInput { sweep, index, last_level }, p)).collect()
        }
        // Light and eye have any direction, so the view and its derivatives serve.
        Design::Local | Design::Peak | Design::Horizon => {
            let surface = &reflection(&wires, &map, plan, p).surface;
            let Surface { frame, normal, view, .. } = *surface;
            let [first, second] = &wires.dview;
            let [first, second] = on_words!(p, |first, second| [enter(first, p), enter(second, p)]);
            let directions = &[view, first, second];
            if design == Design::Local {
                return directions.map(|direction| integers_at(&LocalInput { direction, frame, normal }, p)).into();
            }
            let [_, light, eye] = on_words!(p, |surface, directions| {
                directions.map(|d| datapath::local_components(&d, &surface.frame, &surface.normal, p))
            });
            if design == Design::Horizon {
                let mut four = |low, high| [(); 4].map(|()| random.uniform(low, high));
                let horizon = stored_horizon(four(-1.5, 1.5), four(-0.6, 2.0)).wires();
                return vec![integers_at(&HorizonInput { light, eye, horizon }, p)];
            }
            let half = on_words!(p, |surface| {
                datapath::local_direction(&surface.view, &surface.frame, &surface.normal, p)
            });
            let exponent = exp2(random.uniform(0.0, 13.0));
            let near = DVec3::from_array(half.unit.map(|m| f64::from(m.raw()) + random.uniform(-1e8, 1e8)));
            let peak = stored_peak(near, exp2(random.uniform(-10.0, 6.0)), exponent).wires();
            let light = Control::<i32, LIGHT>::lit(random.below(64 << 24) as i64);
            let sum = PeakSum { light, saturated: random.below(2) == 1 };
            let words = PackedPeak::from(&peak).words();
            vec![integers_at(&StoredPeakInput { half, words, weight: share(random, (1 << 16) + 1), sum }, p)]
        }
        Design::BumpTexel
        | Design::BumpRamp
        | Design::BumpProbe
        | Design::Bump
        | Design::Corner
        | Design::BrightTexel
        | Design::BrightCorner
        | Design::ColourSample
        | Design::WordSample
        | Design::ProbeSum
        | Design::ProbeMean
        | Design::Colour
        | Design::Modulated
        | Design::LobeLaw
        | Design::Lobe
        | Design::Lobes
        | Design::Blend
        | Design::BrightBlend
        | Design::PixelSum
        | Design::Pixel => vec![net.ports.iter().map(|port| within(port.low, port.high, random)).collect()],
    }
}

/// Number from `low` to `high`, often one of the two, zero or a power of two.
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
