//! The backend for small processors, on a large one: the same bits as the scalar backend, for any input.

use roughxel_cases::highlight::{highlight_sets, random_light};
use roughxel_cases::lit_peak::{lit_peak_sets, random_lit_peak};
use roughxel_cases::{hard_case_sets, random_fragment};
use roughxel_core::datapath::Reflection;
use roughxel_core::design::{Design, EnvironmentProbeInput, Of, Recorded, ScaledReflectionInput, SphereProbeInput};
use roughxel_core::fx::Fx;
use roughxel_core::plan::{Datapath, Effects, HorizonKind};
use roughxel_core::ports::{Port, ReflectionIn};
use roughxel_core::precision::Precision;
use roughxel_core::scalar_api;
use roughxel_core::small::{Full, Half};
use roughxel_core::width::{IntegerWord, of_ports, to_ports};
use roughxel_host_tests::space::{effects, profiles, whole_or};
use roughxel_netlist::integers::integers;

/// Runs a design in a backend, from ports to ports.
#[inline(never)]
fn on<W: IntegerWord, D: Recorded>(input: &D::Input, effects: &Effects, p: &Precision) -> Vec<i64> {
    integers(&to_ports::<W, _>(&D::run::<W>(&of_ports::<W, _>(input), effects, p)))
}

/// Compares the small backend with the scalar one.
fn same<const DESIGN: usize>(input: &<Of<DESIGN> as Recorded>::Input, effects: &Effects, p: &Precision)
where
    Of<DESIGN>: Recorded,
{
    let [small, scalar] = if p.word_bits() == 16 {
        [on::<Half, Of<DESIGN>>(input, effects, p), on::<i16, Of<DESIGN>>(input, effects, p)]
    } else {
        [on::<Full, Of<DESIGN>>(input, effects, p), on::<i32, Of<DESIGN>>(input, effects, p)]
    };
    assert_eq!(small, scalar, "{}, {p:?}, {effects:?}, {:?}", Design::ALL[DESIGN].name(), integers(input));
}

/// Compares a fragment: every stage, the ports, every probe of either kind.
fn same_reflection(fragment: &ReflectionIn, effects: &Effects, p: &Precision) {
    let (fragment, map) = (fragment.wires(), scalar_api::environment_scale(fragment.edge_texels, p));
    same::<{ Design::Fragment as usize }>(&fragment, effects, p);
    same::<{ Design::Reflection as usize }>(&ScaledReflectionInput { fragment, map }, effects, p);
    let stages = scalar_api::reflection(&fragment, &map, &effects.reflection(), p);
    let (Reflection { point, probes, sweep, .. }, last_level) = (stages, map.last_level);
    for index in (0..probes.count.raw().min(16)).map(Fx::from_raw) {
        same::<{ Design::EnvironmentProbe as usize }>(&EnvironmentProbeInput { point, probes, index }, effects, p);
    }
    for index in (0..sweep.count.raw()).map(Fx::from_raw) {
        same::<{ Design::SphereProbe as usize }>(&SphereProbeInput { sweep, index, last_level }, effects, p);
    }
}

#[test]
fn hard_cases_have_the_bits_of_the_scalar_backend() {
    for (_, p) in profiles() {
        for set in hard_case_sets(&p) {
            set.cases.iter().for_each(|case| same_reflection(case, &set.plan.into(), &p));
        }
        for set in highlight_sets(&p) {
            let same = same::<{ Design::Highlight as usize }>;
            set.cases.iter().for_each(|case| same(&case.wires(), &set.plan.into(), &p));
        }
        for set in lit_peak_sets(&p) {
            let same = same::<{ Design::LitPeak as usize }>;
            set.cases.iter().for_each(|case| same(&case.wires(), &set.plan.into(), &p));
        }
    }
}

#[test]
fn random_fragments_have_the_bits_of_the_scalar_backend_in_every_plan() {
    for (_, p) in profiles() {
        let plans = effects(Some(Datapath::Reflection));
        for index in 0..whole_or(200_000, 4_000) {
            let mut plan = plans[index as usize % plans.len()];
            plan.horizon = [HorizonKind::Correlated, HorizonKind::Product, HorizonKind::None][index as usize % 3];
            same_reflection(&random_fragment("small", index, &p), &plan, &p);
            same::<{ Design::Highlight as usize }>(&random_light("small", index, &p).wires(), &plan, &p);
            same::<{ Design::LitPeak as usize }>(&random_lit_peak("small", index, &p).wires(), &plan, &p);
        }
    }
}
