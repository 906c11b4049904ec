//! One source, several backends: a checked, counting backend of the datapath gives the bits of the scalar one, and no operation leaves its wire,
//! for any bit pattern at any port.
//!
//! This second backend shows that `Word` suits lanes and a netlist: nothing in a stage knows what a word is. Its checks are in
//! [`roughxel_host_tests::checked`].

use fixed::types::U0F32;
use rayon::prelude::*;
use roughxel_cases::stimulus::within;
use roughxel_cases::{hard_case_sets, random_fragment};
use roughxel_core::block::Block;
use roughxel_core::bundle::{Bundle, End};
use roughxel_core::datapath::{Reflection, TextureFootprint};
use roughxel_core::design::{
    Design, Deviation, Edge, EnvironmentProbeInput, MapFootprintInput, ProbeReachInput, Recorded, RepeatAddressInput,
    ScaledReflectionInput, SphereProbeInput, TextureProbeInput, Visitor,
};
use roughxel_core::elementary;
use roughxel_core::fx::Fx;
use roughxel_core::plan::{Effects, FootprintKind, ReflectionPlan};
use roughxel_core::ports::{BlockPair, Port, ReflectionIn, TextureIn};
use roughxel_core::precision::{AxisDirection, Newton, Precision, ProbeRule, ProbeWeights, RoughnessKind};
use roughxel_core::probe_list::texture_probes;
use roughxel_core::scalar_api::{self, environment_scale, texture_scale};
use roughxel_core::signals::TexturePosition;
use roughxel_core::stage::moments::to_roughness;
use roughxel_host_tests::checked::{Checked, Integers, OperationCounts, reread};
use roughxel_host_tests::designs::same_when_checked;
use roughxel_host_tests::space::{any_exponent, any_fragment, any_vectors, any_word, plans, profiles, whole_or};
use roughxel_netlist::integers::{integers_at, integers_on};
use roughxel_utilities::random::SplitMix64;

/// Compares every integer of every stage of a fragment, then of its probes of either kind. Returns the operations of the stages.
fn compare(fragment: &ReflectionIn, plan: &ReflectionPlan, p: &Precision) -> OperationCounts {
    let effects = &(*plan).into();
    let same = |design, ports: Vec<i64>| same_when_checked(design, &ports, effects, p).1;
    let (fragment, map) = (fragment.wires(), environment_scale(fragment.edge_texels, p));
    let edge_texels = Fx::from_raw(fragment.edge_texels.raw().clamp(1, 16384));
    same(Design::MapScale, integers_at(&Edge { edge_texels }, p));
    let counts = same(Design::Reflection, integers_at(&ScaledReflectionInput { fragment, map }, p));
    let Reflection { point, probes, sweep, .. } = scalar_api::reflection(&fragment, &map, plan, p);
    for index in (0..probes.count.raw()).map(Fx::from_raw) {
        same(Design::EnvironmentProbe, integers_at(&EnvironmentProbeInput { point, probes, index }, p));
    }
    for index in (0..sweep.count.raw()).map(Fx::from_raw) {
        let last_level = map.last_level;
        same(Design::SphereProbe, integers_at(&SphereProbeInput { sweep, index, last_level }, p));
    }
    counts
}

/// Compares the texture footprint, its reach, the places of its probes, and their addresses on every level of a map of `size`.
fn compare_texture(fragment: &TextureIn, size: [u16; 2], p: &Precision) {
    let same = |design, ports: Vec<i64>| same_when_checked(design, &ports, &Effects::ALL, p);
    let scale = texture_scale(size);
    let ((texture, map), duv) = (scale, fragment.duv.wires());
    same(Design::Texture, integers_at(&MapFootprintInput { duv, texture, map }, p));
    let TextureFootprint { axes, probes, .. } = fragment.footprint(&scale, p);
    let [major, minor] = [axes.major, axes.minor].map(|sigma| Deviation { m: sigma.m, e: sigma.e });
    same(Design::ProbeReach, integers_at(&ProbeReachInput { major, minor, probes, texture }, p));
    let centre = TexturePosition { uv: fragment.uv.wires() };
    for (index, probe) in (0..).zip(texture_probes(&centre, &probes, &texture, p)) {
        let (index, place) = (Fx::from_raw(index), probe.place);
        same(Design::TextureProbe, integers_at(&TextureProbeInput { centre, probes, index, texture }, p));
        assert!(place.uv.iter().all(|u| (0..1 << 32).contains(&u.raw())), "a position is a fraction: {place:?}");
        for level in 0..=map.last_level.raw() {
            let size = texture.size.map(|edge| Fx::from_raw((edge.raw() >> level).max(1)));
            same(Design::RepeatAddress, integers_at(&RepeatAddressInput { place, size }, p));
        }
    }
}

/// A precision anywhere within the limits of [`Precision::checked`], with weight on their ends.
fn any_precision(random: &mut SplitMix64) -> Precision {
    let mut within = |low: u64, high: u64| -> u32 {
        let value = match random.below(4) {
            0 => low,
            1 => high,
            _ => low + random.below(high - low + 1),
        };
        value as u32
    };
    let mut newton = || Newton { seed_bits: within(6, 10), steps: within(0, 2) };
    let (reciprocal, inverse_root) = (newton(), newton());
    let precision = Precision {
        fraction_bits: within(12, 28),
        reciprocal,
        inverse_root,
        direction: match within(0, 1) {
            0 => AxisDirection::Exact,
            _ => AxisDirection::Table { steps: 2 * within(1, 32) },
        },
        max_probes: within(1, 16),
        probe_rule: if within(0, 1) == 0 { ProbeRule::PowerOfTwo } else { ProbeRule::Ceiling },
        probe_weights: if within(0, 1) == 0 { ProbeWeights::Box } else { ProbeWeights::Gaussian },
        lod_bits: within(2, 12),
        weight_bits: within(2, 10),
        roughness: RoughnessKind::Anisotropic,
        roughness_bits: within(4, 16),
    };
    precision.checked().expect("the generator stays inside the limits")
}

#[test]
fn backends_agree_on_every_hard_case_under_every_plan() {
    let plans = plans();
    // A dozen plans each, three without a full run; the sets hold enough fragments for every plan to meet every kind of case.
    let each = whole_or(12, 3);
    for (_, p) in profiles() {
        for set in hard_case_sets(&p) {
            set.cases.par_iter().enumerate().for_each(|(index, fragment)| {
                compare(fragment, &set.plan, &p);
                for plan in plans.iter().cycle().skip(index).step_by(6).take(each) {
                    compare(fragment, plan, &p);
                }
            });
        }
    }
}

#[test]
fn backends_agree_on_random_fragments() {
    for (_, p) in profiles() {
        (0..whole_or(20_000_u64, 4000)).into_par_iter().for_each(|index| {
            compare(&random_fragment("readings", index, &p), &ReflectionPlan::FULL, &p);
        });
        let plans = plans();
        (0..50 * plans.len() as u64).into_par_iter().for_each(|index| {
            let plan = &plans[index as usize % plans.len()];
            compare(&random_fragment("readings under every plan", index, &p), plan, &p);
        });
    }
}

#[test]
fn no_wire_overflows_at_the_corners_of_the_ports() {
    let plans = plans();
    for (name, p) in profiles() {
        (0..whole_or(60_000_u64, 10_000)).into_par_iter().for_each(|index| {
            let mut random = SplitMix64::for_element(name, index);
            let plan = plans[random.below(plans.len() as u64) as usize];
            compare(&any_fragment(&mut random), &plan, &p);
        });
    }
}

#[test]
fn no_wire_overflows_at_any_precision_that_can_be_built() {
    let plans = plans();
    (0..whole_or(60_000_u64, 20_000)).into_par_iter().for_each(|index| {
        let mut random = SplitMix64::for_element("any precision", index);
        let p = any_precision(&mut random);
        let plan = plans[random.below(plans.len() as u64) as usize];
        compare(&any_fragment(&mut random), &plan, &p);
        compare(&random_fragment("any precision", index, &p), &plan, &p);
    });
}

#[test]
fn texture_footprints_agree_for_every_map_size_and_port() {
    let sizes = [1, 2, 3, 5, 64, 1000, 1023, 4096, 16383, 16384, 0, u16::MAX];
    for (name, p) in profiles() {
        (0..whole_or(12_000_u64, 2000)).into_par_iter().for_each(|index| {
            let mut random = SplitMix64::for_element(name, index);
            let duv = any_vectors::<2>(&mut random).map(|vector| {
                let [x, y, _] = vector.mantissa;
                BlockPair { mantissa: [x, y], exponent: vector.exponent }
            });
            let uv = [(); 2].map(|()| U0F32::from_bits(any_word(&mut random) as u32));
            let size = [(); 2].map(|()| match random.below(4) {
                0 => random.next_u64() as u16,
                _ => sizes[random.below(sizes.len() as u64) as usize],
            });
            compare_texture(&TextureIn { uv, duv }, size, &p);
        });
    }
}

#[test]
fn elementary_functions_stay_on_their_wires_at_and_beyond_the_ends_of_their_domains() {
    (0..400_u64).into_par_iter().for_each(|index| {
        let mut random = SplitMix64::for_element("elementary", index);
        let p = any_precision(&mut random);
        let one = 1 << 30;
        let near = [0, one >> 2, one >> 1, one].into_iter().flat_map(|end| [-16, -1, 0, 1, 16].map(|step| end + step));
        let inside = (0..400).map(|_| random.below(1 << 30) as i32);
        for x in near.chain(inside.collect::<Vec<_>>()) {
            let (scalar, checked) = (Fx::<i32, 2>::from_raw(x), Fx::from_raw(Checked::new(x)));
            let pairs = [
                (elementary::half_reciprocal(scalar, &p).raw(), elementary::half_reciprocal(checked, &p).raw()),
                (elementary::half_inverse_root(scalar, &p).raw(), elementary::half_inverse_root(checked, &p).raw()),
                (elementary::log2(scalar, &p).raw(), elementary::log2(checked, &p).raw()),
            ];
            for (expected, got) in pairs {
                assert_eq!(expected, got.value(), "at {x} with {p:?}");
            }
            // ±64 with 24 fraction bits.
            let exponent = x.clamp(-one, one);
            let expected = elementary::exp2::<i32>(Fx::from_raw(exponent), &p);
            let got = elementary::exp2::<Checked>(Fx::from_raw(Checked::new(exponent)), &p);
            assert_eq!(Integers::from_bundle(&expected), Integers::from_bundle(&got));
        }
    });
}

/// The ends of the ranges of a design's ports.
struct Ends<'a>(&'a Precision);

impl Visitor for Ends<'_> {
    type Outcome = [Vec<i64>; 2];
    fn visit<D: Recorded>(self) -> [Vec<i64>; 2] {
        [End::Low, End::High].map(|end| match self.0.word_bits() {
            16 => integers_on(&D::Input::limit::<i16>(end)),
            _ => integers_on(&D::Input::limit::<i32>(end)),
        })
    }
}

/// Designs after memories: any integers in their ranges may meet at their ports.
const OF_TEXELS: [Design; 21] = [
    Design::BumpTexel,
    Design::BumpRamp,
    Design::BumpProbe,
    Design::Bump,
    Design::Levels,
    Design::Corner,
    Design::BrightTexel,
    Design::BrightCorner,
    Design::ColourSample,
    Design::WordSample,
    Design::ProbeSum,
    Design::ProbeMean,
    Design::Colour,
    Design::Modulated,
    Design::LobeLaw,
    Design::Lobe,
    Design::Lobes,
    Design::Blend,
    Design::BrightBlend,
    Design::PixelSum,
    Design::Pixel,
];

#[test]
fn designs_behind_memories_agree_over_their_whole_ranges() {
    for design in OF_TEXELS {
        (0..60_000_u64).into_par_iter().for_each(|index| {
            let mut random = SplitMix64::for_element(design.name(), index);
            let p = any_precision(&mut random);
            let [low, high] = design.visit(Ends(&p));
            let ports: Vec<i64> = low.into_iter().zip(high).map(|(l, h)| within(l, h, &mut random)).collect();
            same_when_checked(design, &ports, &Effects::ALL, &p);
        });
    }
}

#[test]
fn blocks_of_any_exponent_become_a_roughness() {
    let end = 1 << 30;
    let mut random = SplitMix64::for_element("roughness", 0);
    for _ in 0..60_000 {
        let (m, e) = (any_word(&mut random).clamp(-end, end), any_exponent(&mut random));
        let block = Block::<i32, 1> { m: [Fx::from_raw(m)], e: Fx::lit(e.into()) };
        assert_eq!(to_roughness(block).raw(), to_roughness(reread(&block)).raw().value(), "{block:?}");
    }
}

#[test]
fn a_block_that_is_off_costs_nothing() {
    let full = ReflectionPlan::FULL;
    let fragment = random_fragment("operation counts", 1, &Precision::STANDARD);
    let cost = |plan: &ReflectionPlan, p: &Precision| compare(&fragment, plan, p);
    for (name, p) in profiles() {
        let all = cost(&full, &p);
        println!("{name:8} {all}");
        let less = [
            ("bump", ReflectionPlan { bump: false, ..full }),
            ("isotropic", ReflectionPlan { roughness: RoughnessKind::Isotropic, ..full }),
            ("roughness", ReflectionPlan { roughness: RoughnessKind::None, ..full }),
            ("curvature", ReflectionPlan { curvature: false, ..full }),
            ("footprint", ReflectionPlan { footprint: FootprintKind::None, ..full }),
        ];
        for (effect, plan) in less {
            let without = cost(&plan, &p);
            println!("  without {effect:9} {:5} of {}", without.hardware(), all.hardware());
            assert!(without.hardware() < all.hardware(), "{effect} is still there: {without}");
            assert!(without.count("mul") <= all.count("mul"));
        }
        let bare = ReflectionPlan {
            bump: false,
            roughness: RoughnessKind::None,
            curvature: false,
            footprint: FootprintKind::None,
            ..full
        };
        // A mirror without any effect needs no tangent basis: 12 products for r, 2 for s and t, 2 in a Newton step.
        let mirror = cost(&bare, &p);
        println!("  plain mirror      {:5} of {}", mirror.hardware(), all.hardware());
        assert_eq!(mirror.count("mul"), 14 + 2 * u64::from(p.reciprocal.steps));
        assert!(mirror.hardware() * 5 < all.hardware());
    }
}

#[test]
fn the_cost_of_a_plan_does_not_depend_on_the_fragment() {
    for (name, p) in profiles() {
        for plan in plans() {
            let cost = compare(&random_fragment(name, 0, &p), &plan, &p);
            for index in 1..20 {
                assert_eq!(cost, compare(&random_fragment(name, index, &p), &plan, &p), "no branch on data");
            }
        }
    }
}
