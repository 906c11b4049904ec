//! The reading for small processors, on a large one: the same bits as the scalar reading, whatever comes in.

use proptest::prelude::*;
use roughxel_cases::highlight::{highlight_sets, random_light};
use roughxel_cases::lit_peak::{lit_peak_sets, random_lit_peak};
use roughxel_cases::{hard_case_sets, random_fragment};
use roughxel_core::bundle::Value;
use roughxel_core::datapath::{self, Reflection};
use roughxel_core::fx::Fx;
use roughxel_core::plan::{Datapath, Effects, HorizonKind, PeakPlan, ReflectionPlan, SurfacePlan};
use roughxel_core::ports::{HighlightIn, HighlightInput, PeakIn, PeakInput, Port, ReflectionIn, ReflectionInput};
use roughxel_core::precision::Precision;
use roughxel_core::signals::MapScale;
use roughxel_core::small::{Full, Half, WideFull, WideHalf, leading_zeros_by_table, product_by_adds, product_by_table};
use roughxel_core::soft_core;
use roughxel_core::width::{IntegerCount, IntegerWord, of_ports, to_ports};
use roughxel_core::word::{WideWire, Word};
use roughxel_host_tests::space::{effects, profiles, whole_or};
use roughxel_net::integers::integers as net_integers;

#[test]
fn leading_zeros_by_table_are_those_of_the_processor() {
    for place in 0..32 {
        for low in 0..1 << 16 {
            // Every number of 16 bits at every place, above others.
            let x = (low << place) | ((1 << place) - 1);
            assert_eq!(leading_zeros_by_table(x), x.leading_zeros(), "{x:#x}");
        }
    }
    assert_eq!(leading_zeros_by_table(0), 32);
}

#[test]
fn products_by_table_are_exact() {
    // Both halves of one factor take every value beside every value of either half of the other.
    for a in i16::MIN..=i16::MAX {
        for b in [0, 1, -1, 255, 256, -256, i16::MIN, i16::MAX, 0x5a5a, !a, a.rotate_left(8)] {
            assert_eq!(product_by_table(a.into(), b.into()), i32::from(a) * i32::from(b), "{a} {b}");
        }
    }
    for halves in 0..=u16::MAX {
        let [a, b] = halves.to_be_bytes();
        for (a, b) in [(i16::from(a), i16::from(b)), (i16::from(a as i8) << 8, i16::from(b as i8) << 8)] {
            assert_eq!(product_by_table(a.into(), b.into()), i32::from(a) * i32::from(b), "{a} {b}");
        }
    }
}

/// Integers of every size, both signs.
fn of_every_size() -> impl Strategy<Value = i64> {
    (any::<i64>(), 0..64).prop_map(|(integer, places)| integer >> places)
}

proptest! {
    #[test]
    fn products_by_adds_are_exact(a in any::<i32>(), b in of_every_size()) {
        for (a, b) in [(a, b as i32), (i32::MIN, b as i32), (a, i32::MIN), (i32::MIN, i32::MIN), (a, 0)] {
            prop_assert_eq!(product_by_adds(a, b), i64::from(a) * i64::from(b));
        }
    }

    #[test]
    fn wide_wires_are_rounded_as_in_the_scalar_reading(word in any::<i32>(), places in 0_u32..31, rest in any::<i64>(), drop in 1_u32..32, up in 0_u32..20) {
        // Every wide wire whose rounded word is one, with any bits behind: those of 4 map units and more are the step of a large circle.
        let word = word >> places >> up << up;
        let wide = (i64::from(word) << drop).saturating_add(rest >> (64 - drop));
        if i64::from(word) + (1 << up) <= i64::from(i32::MAX) {
            prop_assert_eq!(Full::round(WideFull(wide), drop, up).0, i32::round(wide, drop, up));
        }
        let (word, drop, up) = (word >> 16 >> up.min(3) << up.min(3), drop.min(16), up.min(3));
        let wide = (word << drop).saturating_add((rest >> (64 - drop)) as i32);
        if word + (1 << up) <= i32::from(i16::MAX) {
            prop_assert_eq!(Half::round(WideHalf(wide), drop, up).0, i32::from(i16::round(wide, drop, up)));
        }
    }

    #[test]
    fn blocks_are_normalised_as_in_the_scalar_reading(wide in prop::array::uniform3(of_every_size()), places in 0_u32..32, up in 0_u32..19) {
        for wide in [wide, wide.map(|w| w >> places), [wide[0], 0, 0], [-1, 0, wide[2] >> 63], [0; 3], [i64::MIN; 3], [i64::MAX >> places, wide[0], 0], [i64::MAX >> places >> 32; 3]] {
            let (words, zeros, all_zero) = WideFull::normalised(wide.map(WideFull), 33, up);
            let scalar = i64::normalised(wide, 33, up);
            prop_assert_eq!((words.map(|word| word.0), zeros.0, all_zero), scalar);

            let narrow = wide.map(|w| (w >> 32) as i32);
            for drop in [17, 16] {
                let up = up.min(3);
                let (words, zeros, all_zero) = WideHalf::normalised(narrow.map(WideHalf), drop, up);
                let (scalar, scalar_zeros, scalar_all_zero) = i32::normalised(narrow, drop, up);
                let scalar = (scalar.map(i32::from), scalar_zeros, scalar_all_zero);
                // Without a bit before the point the largest number rounds up beyond the word of 16 bits.
                if drop == 17 {
                    prop_assert_eq!((words.map(|word| word.0), zeros.0, all_zero), scalar);
                }
            }
        }
    }
}

/// What the reading makes of a fragment: every stage, the ports, every probe.
#[inline(never)]
fn reflection_on<W: IntegerWord>(input: &ReflectionInput<i32>, plan: &ReflectionPlan, p: &Precision) -> Vec<i64> {
    let input = of_ports::<W, _>(input);
    let map = datapath::map_scale::<W>(input.edge_texels, p);
    let stages = datapath::reflection(&input, &map, plan, p);
    let mut integers = net_integers(&to_ports::<W, _>(&stages));
    integers.extend(left_on::<W>(&stages));
    integers.extend(probes_on::<W>(&stages, &map, p));
    integers
}

/// The same in the scalar reading, on words of that width.
fn scalar_reflection_on<W: IntegerWord>(
    input: &ReflectionInput<i32>,
    plan: &ReflectionPlan,
    p: &Precision,
) -> Vec<i64> {
    let map = soft_core::environment_scale(input.edge_texels.raw() as u16, p);
    let stages = soft_core::reflection(input, &map, plan, p);
    let mut integers = net_integers(&stages);
    let (stages, map) = (of_ports::<W, _>(&stages), of_ports::<W, _>(&map));
    integers.extend(left_on::<W>(&stages));
    integers.extend(probes_on::<W>(&stages, &map, p));
    integers
}

/// The ports of its outcomes.
#[inline(never)]
fn left_on<W: IntegerWord>(stages: &Reflection<W>) -> Vec<i64> {
    net_integers(&to_ports::<W, _>(&datapath::reflection::leave(stages)))
}

/// All its probes, of either kind.
#[inline(never)]
fn probes_on<W: IntegerWord>(stages: &Reflection<W>, map: &MapScale<W>, p: &Precision) -> Vec<i64> {
    let mut integers = Vec::new();
    let index = |index: i32| of_ports::<W, _>(&Value(Fx::from_raw(index))).0;
    for i in 0..stages.sweep.count.raw().integer() {
        let probe = datapath::sphere_probe(&stages.sweep, index(i), map.last_level, p);
        integers.extend(net_integers(&to_ports::<W, _>(&probe)));
    }
    for i in 0..stages.probes.count.raw().integer().min(16) {
        let probe = datapath::environment_probe(&stages.point, &stages.probes, index(i), p);
        integers.extend(net_integers(&to_ports::<W, _>(&probe)));
    }
    integers
}

#[inline(never)]
fn highlight_on<W: IntegerWord>(input: &HighlightInput<i32>, plan: &SurfacePlan, p: &Precision) -> Vec<i64> {
    let lit = datapath::lit_surface(&of_ports::<W, _>(input), plan, p);
    net_integers(&to_ports::<W, _>(&datapath::leave_highlight(&lit)))
}

#[inline(never)]
fn lit_peak_on<W: IntegerWord>(input: &PeakInput<i32>, plan: &PeakPlan, p: &Precision) -> Vec<i64> {
    net_integers(&to_ports::<W, _>(&datapath::lit_peak(&of_ports::<W, _>(input), plan, p)))
}

/// The small reading and the scalar one.
fn compare(
    (reflection, light, peak): (&ReflectionInput<i32>, &HighlightInput<i32>, &PeakInput<i32>),
    effects: &Effects,
    profile: &str,
    p: &Precision,
) {
    let plans = (&effects.reflection(), &effects.highlight(), &effects.peak());
    let [small, scalar] = if p.word_bits() == 16 {
        [reflection_on::<Half>(reflection, plans.0, p), scalar_reflection_on::<i16>(reflection, plans.0, p)]
    } else {
        [reflection_on::<Full>(reflection, plans.0, p), scalar_reflection_on::<i32>(reflection, plans.0, p)]
    };
    assert_eq!(small, scalar, "{profile}, {effects:?}, {reflection:?}");
    let [small_light, small_peak] = if p.word_bits() == 16 {
        [highlight_on::<Half>(light, plans.1, p), lit_peak_on::<Half>(peak, plans.2, p)]
    } else {
        [highlight_on::<Full>(light, plans.1, p), lit_peak_on::<Full>(peak, plans.2, p)]
    };
    let scalar = net_integers(&soft_core::highlight(light, plans.1, p));
    assert_eq!(small_light, scalar, "{profile}, {effects:?}, {light:?}");
    let scalar = net_integers(&soft_core::lit_peak(peak, plans.2, p));
    assert_eq!(small_peak, scalar, "{profile}, {effects:?}, {peak:?}");
}

#[test]
fn hard_cases_have_the_bits_of_the_scalar_reading() {
    for (profile, p) in profiles() {
        let (light, peak) = (HighlightIn::default().wires(), PeakIn::default().wires());
        for set in hard_case_sets(&p) {
            for case in set.cases {
                compare((&case.wires(), &light, &peak), &set.plan.into(), profile, &p);
            }
        }
        let reflection = ReflectionIn::default().wires();
        for set in highlight_sets(&p) {
            for case in set.cases {
                compare((&reflection, &case.wires(), &peak), &set.plan.into(), profile, &p);
            }
        }
        for set in lit_peak_sets(&p) {
            for case in set.cases {
                compare((&reflection, &light, &case.wires()), &set.plan.into(), profile, &p);
            }
        }
    }
}

#[test]
fn random_fragments_have_the_bits_of_the_scalar_reading_in_every_plan() {
    for (profile, p) in profiles() {
        let plans = effects(Some(Datapath::Reflection));
        for index in 0..whole_or(200_000, 4_000) {
            let mut plan = plans[index as usize % plans.len()];
            plan.horizon = [HorizonKind::Correlated, HorizonKind::Product, HorizonKind::None][index as usize % 3];
            let (reflection, light, peak) = (
                random_fragment("small", index, &p).wires(),
                random_light("small", index, &p).wires(),
                random_lit_peak("small", index, &p).wires(),
            );
            compare((&reflection, &light, &peak), &plan, profile, &p);
        }
    }
}
