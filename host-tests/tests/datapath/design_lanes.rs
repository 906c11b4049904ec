//! Whole datapaths in lanes give the bits of the scalar backend on every port and tap: what an export of vectors stands on.

use roughxel_cases::highlight::{highlight_sets, random_light};
use roughxel_cases::lit_peak::{lit_peak_sets, random_lit_peak};
use roughxel_cases::{hard_case_sets, random_fragment};
use roughxel_core::bundle::Bundle;
use roughxel_core::design::Form;
use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::ports::{HighlightInput, PeakInput, Port, ReflectionInput};
use roughxel_core::precision::Precision;
use roughxel_core::soft_core;
use roughxel_host_tests::space::{effects, in_turn, whole_or};
use roughxel_net::integers::integers;
use roughxel_shader::{Batch, LitPeaks, LitSurfaces, Reflections, Shader};

use super::lanes::{lanes, profiles};

/// Compares what lanes make of every input with the scalar backend, wire by wire.
fn same<I: Form + Bundle<i32, In<i32> = I>, O: Form>(
    inputs: &Batch<I>,
    of_lanes: impl Fn(Shader<'_>, &mut Batch<O>),
    p: &Precision,
    of_one: impl Fn(&I) -> O,
    what: &str,
) {
    let mut outputs = Batch::default();
    for backend in lanes() {
        of_lanes(Shader::new(backend, p), &mut outputs);
        for (index, (input, output)) in inputs.iter().zip(outputs.iter()).enumerate() {
            assert_eq!(integers(&output), integers(&of_one(&input)), "{what} #{index}, {backend:?}");
        }
    }
}

/// All effects together, and single choices of them, in a short run some with each profile.
fn tried(datapath: Datapath, profile: &str) -> impl Iterator<Item = Effects> {
    let some = effects(Some(datapath)).into_iter().enumerate().filter(move |&(index, _)| in_turn(index, profile));
    [Effects::ALL.of(datapath)].into_iter().chain(some.map(|(_, effects)| effects))
}

#[test]
fn whole_datapaths_in_lanes_give_the_scalar_bits_on_every_tap() {
    // Not a multiple of the lanes: the last group is not full.
    let count = whole_or(4003, 203);
    for (profile, p) in profiles() {
        let fragments = (0..count).map(|i| random_fragment("design lanes", i, &p).wires());
        let hard = hard_case_sets(&p).into_iter().flat_map(|set| set.cases).map(|case| case.wires());
        let fragments: Batch<ReflectionInput<i32>> = fragments.chain(hard).collect();
        for effects in tried(Datapath::Reflection, profile) {
            let plan = effects.reflection();
            same(
                &fragments,
                |shader, outputs| Reflections { inputs: &fragments, plan: &plan }.run(shader, outputs),
                &p,
                |input| soft_core::fragment(input, &plan, &p),
                profile,
            );
        }
        let lights = (0..count).map(|i| random_light("design lanes", i, &p).wires());
        let hard = highlight_sets(&p).into_iter().flat_map(|set| set.cases).map(|case| case.wires());
        let lights: Batch<HighlightInput<i32>> = lights.chain(hard).collect();
        for effects in tried(Datapath::Highlight, profile) {
            let plan = effects.highlight();
            same(
                &lights,
                |shader, outputs| LitSurfaces { inputs: &lights, plan: &plan }.run(shader, outputs),
                &p,
                |input| soft_core::highlight(input, &plan, &p),
                profile,
            );
        }
        let peaks = (0..count).map(|i| random_lit_peak("design lanes", i, &p).wires());
        let hard = lit_peak_sets(&p).into_iter().flat_map(|set| set.cases).map(|case| case.wires());
        let peaks: Batch<PeakInput<i32>> = peaks.chain(hard).collect();
        for effects in tried(Datapath::Peak, profile) {
            let plan = effects.peak();
            same(
                &peaks,
                |shader, outputs| LitPeaks { inputs: &peaks, plan: &plan }.run(shader, outputs),
                &p,
                |input| soft_core::lit_peak(input, &plan, &p),
                profile,
            );
        }
    }
}
