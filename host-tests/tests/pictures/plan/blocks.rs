//! Blocks of a plan: those planned away are never entered.

use std::collections::BTreeMap;

use roughxel_cases::highlight::random_light;
use roughxel_cases::peak_and_horizon::{random_horizon_case, random_peak_case};
use roughxel_cases::random_fragment;
use roughxel_core::datapath::{self, TextureFootprint};
use roughxel_core::fx::Fx;
use roughxel_core::plan::{FrameSystem, HorizonKind, ReflectionPlan, SurfacePlan};
use roughxel_core::ports::{Port, PortBlock, ReflectionInput};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::scalar_api::{environment_scale, texture_scale};
use roughxel_core::signals::TexturePosition;
use roughxel_host_tests::checked::{Checked, reread, traced};
use roughxel_host_tests::space::profiles;
use roughxel_shader::{Effect, ObjectPlan};

/// Every block.
fn full(frame: FrameSystem) -> ObjectPlan {
    let reflection = ReflectionPlan { frame, ..ReflectionPlan::FULL };
    ObjectPlan {
        colour_map: true,
        texture_footprint: true,
        edges: true,
        reflection: Some(reflection),
        two_lobes: true,
        highlight: Some(reflection.surface()),
        peaks: Some(SurfacePlan { bump: false, frame, roughness: RoughnessKind::None, local: true }),
        horizon: HorizonKind::Correlated,
    }
}

/// Number of times that each block of each part is entered.
type Entered = BTreeMap<(&'static str, &'static str), usize>;

fn enter(entered: &mut Entered, part: &'static str, work: impl FnOnce()) {
    for (block, _) in traced(work).1 {
        *entered.entry((part, block)).or_default() += 1;
    }
}

/// The probes of a wrapped map of `edge` texels, as the renderer takes them.
fn fetch(input: &ReflectionInput<Checked>, plan: &ObjectPlan, (edge, rough): (u16, bool), p: &Precision) {
    if !plan.texture_footprint {
        return;
    }
    let (texture, map) = texture_scale([edge; 2]);
    let (texture, map) = (reread(&texture), reread(&map));
    let duv = input.dview.map(|d| PortBlock { mantissa: [d.mantissa[0], d.mantissa[1]], exponent: d.exponent });
    let TextureFootprint { axes, probes, .. } = datapath::texture_footprint(&duv, &texture, &map, p);
    if rough {
        datapath::probe_reach([&axes.major, &axes.minor], &probes, &texture, p);
    }
    let centre = reread(&TexturePosition::<i32> { uv: [Fx::from_raw(1 << 30); 2] });
    for index in 0..probes.count.raw().value() {
        datapath::texture_probe(&centre, &probes, Fx::lit(i64::from(index)), &texture, p);
    }
}

/// One random fragment, with a light, through the blocks of a plan, part by part as the renderer calls them.
fn shade(index: u64, plan: &ObjectPlan, p: &Precision, entered: &mut Entered) {
    let fragment = random_fragment("plan", index, p);
    let input = reread(&fragment.wires());
    let scale = reread(&environment_scale(fragment.edge_texels, p));
    let lit = random_light("plan", index, p);
    let (light, shininess) = (reread(&lit.light.wires()), reread(&lit.shininess.wires()));
    if plan.colour_map {
        enter(entered, "colour map", || fetch(&input, plan, (64, false), p));
    }
    if plan.bump_map() {
        enter(entered, "bump map", || fetch(&input, plan, (128, plan.roughness() != RoughnessKind::None), p));
    }
    if let Some(plan) = &plan.reflection {
        enter(entered, "reflection", || {
            datapath::reflection(&input, &scale, plan, p);
        });
    }
    if let Some(reflection) = plan.reflection.filter(|_| plan.two_lobes) {
        let surface = datapath::surface(&input.surface, &reflection.surface(), p);
        enter(entered, "lobe", || {
            datapath::lobe(&surface.rough, Fx::int(2), p);
        });
    }
    if let Some(plan) = &plan.highlight {
        enter(entered, "highlight", || {
            let surface = datapath::surface(&input.surface, plan, p);
            datapath::highlight(&surface, &datapath::gloss(&surface, &shininess, plan, p), &light, p);
        });
    }
    if let Some(surface) = &plan.peaks {
        let peaks = random_peak_case("plan", index, p).peaks;
        let stored = random_horizon_case("plan", index, p).horizon;
        let mut made = None;
        enter(entered, "peaks", || {
            let surface = datapath::surface(&input.surface, surface, p);
            made = Some((surface, datapath::peak_light(&surface, &light, p)));
        });
        let (surface, lit) = made.unwrap();
        let mut weights: Vec<_> = peaks.iter().map(|(_, weight)| Fx::lit(i64::from(*weight))).collect();
        if plan.horizon != HorizonKind::None {
            enter(entered, "horizon", || {
                let eye = datapath::local_components(&surface.view, &surface.frame, &surface.normal, p);
                let [light, eye] = [&lit.light, &eye].map(|local| datapath::horizon_slopes(local, p));
                weights.fill_with(|| datapath::horizon(&light, &eye, &reread(&stored.wires()), plan.horizon, p));
            });
        }
        enter(entered, "peaks", || {
            for ((peak, _), weight) in peaks.iter().zip(weights) {
                datapath::peak(&lit.direction, &reread(&peak.wires()), weight, p);
            }
        });
    }
}

/// Returns true if a block of a part exists only for an effect.
fn is_of(effect: Effect, part: &str, block: &str) -> bool {
    let tangents_of_roughness = ["enter.roughness", "roughness", "columns.roughness", "highlight.spread"];
    match effect {
        Effect::ColourTexture => part == "colour map",
        // Without bumps there is no roughness, and without both no tangent basis; peaks have their own.
        Effect::Bump => {
            let perturbed = ["enter.tangent", "frame", "enter.offset", "perturb"].contains(&block);
            ["bump map", "lobe"].contains(&part)
                || ["reflection", "highlight"].contains(&part) && (perturbed || tangents_of_roughness.contains(&block))
        }
        Effect::Roughness => part == "lobe" || block == "probes.reach" || tangents_of_roughness.contains(&block),
        Effect::Environment => ["reflection", "lobe"].contains(&part),
        Effect::TwoLobes => part == "lobe",
        Effect::Footprint => {
            let footprint = ["enter.dview", "enter.dnormal", "columns.pixel", "ellipse", "axes", "probes"];
            ["colour map", "bump map", "lobe"].contains(&part)
                || part == "reflection" && footprint.contains(&block)
                || tangents_of_roughness.contains(&block)
        }
        // The block of the front end.
        Effect::Edges => false,
        Effect::Curvature => block == "enter.dnormal",
        Effect::Highlight => part == "highlight",
        // Effects that depend on them are removed with them.
        Effect::Peaks => ["peaks", "horizon"].contains(&part),
        Effect::Horizon => part == "horizon",
    }
}

#[test]
fn blocks_planned_away_are_entered_zero_times() {
    for (name, p) in profiles() {
        for frame in [FrameSystem::MainDirection, FrameSystem::Natural, FrameSystem::NaturalNormalised] {
            let count = |plan: &ObjectPlan| {
                let mut entered = Entered::new();
                (0..48).for_each(|index| shade(index, plan, &p, &mut entered));
                entered
            };
            let full = full(frame);
            let with = count(&full);
            for effect in Effect::ALL {
                let without = count(&full.without(effect));
                let (of_it, others): (Entered, Entered) = with
                    .iter()
                    .map(|(key, count)| (*key, *count))
                    .partition(|((part, block), _)| is_of(effect, part, block));
                assert!(
                    of_it.values().sum::<usize>() > 0 || effect == Effect::Edges,
                    "{name}, {frame:?}: nothing is entered for {}",
                    effect.name()
                );
                // Equal maps: the blocks of the effect are not entered, every other block as often as with it.
                assert_eq!(without, others, "{name}, {frame:?}, without {}", effect.name());
            }
            let nothing = Effect::ALL.into_iter().fold(full, ObjectPlan::without);
            assert_eq!(count(&nothing), Entered::new());
        }
    }
}
