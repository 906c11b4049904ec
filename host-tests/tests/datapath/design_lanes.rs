//! Datapaths in lanes give the bits of the scalar backend on every port and tap: the basis of an export of vectors.

use roughxel_cases::highlight::{highlight_sets, random_light};
use roughxel_cases::lit_peak::{lit_peak_sets, random_lit_peak};
use roughxel_cases::{CaseSet, hard_case_sets, random_fragment};
use roughxel_core::bundle::Bundle;
use roughxel_core::design::Form;
use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::ports::Port;
use roughxel_core::precision::Precision;
use roughxel_core::scalar_api;
use roughxel_host_tests::space::{effects, in_turn, whole_or};
use roughxel_shader::{Batch, LitPeaks, LitSurfaces, Reflections, Shader};

use super::lanes::{made_by_all, profiles};

/// All effects together, and single choices of them; in a short run, some with each profile.
fn tried(datapath: Datapath, profile: &str) -> impl Iterator<Item = Effects> {
    let some = effects(Some(datapath)).into_iter().enumerate().filter(move |&(index, _)| in_turn(index, profile));
    [Effects::ALL.restricted_to(datapath)].into_iter().chain(some.map(|(_, effects)| effects))
}

/// Compares the results of all backends for random inputs and hard cases with those of the datapath for each input, wire by wire.
fn hold<P, Plan, O>(
    (datapath, profile, p): (Datapath, &str, &Precision),
    random: impl Fn(&str, u64, &Precision) -> P,
    sets: Vec<CaseSet<P, Plan>>,
    run: impl Fn(&Batch<P::Wires>, &Effects, Shader<'_>, &mut Batch<O>),
    of_one: impl Fn(&P::Wires, &Effects) -> O,
) where
    P: Port<Wires: Form + Bundle<i32, In<i32> = P::Wires>>,
    O: Form,
{
    // Not a multiple of the lane count: the last group is not full.
    let random = (0..whole_or(4003, 203)).map(|i| random("design lanes", i, p));
    let hard = sets.into_iter().flat_map(|set| set.cases);
    let inputs: Batch<P::Wires> = random.chain(hard).map(|case| case.wires()).collect();
    for effects in tried(datapath, profile) {
        let expected = Batch::from_iter(inputs.iter().map(|input| of_one(&input, &effects)));
        let context = &|| format!("{profile}, {effects:?}");
        made_by_all(&expected, p, context, |shader, outputs| run(&inputs, &effects, shader, outputs));
    }
}

#[test]
fn whole_datapaths_in_lanes_give_the_scalar_bits_on_every_tap() {
    for (profile, p) in profiles() {
        hold(
            (Datapath::Reflection, profile, &p),
            random_fragment,
            hard_case_sets(&p),
            |inputs, effects, shader, outputs| {
                Reflections { inputs, plan: &effects.reflection() }.run(shader, outputs);
            },
            |input, effects| scalar_api::fragment(input, &effects.reflection(), &p),
        );
        hold(
            (Datapath::Highlight, profile, &p),
            random_light,
            highlight_sets(&p),
            |inputs, effects, shader, outputs| LitSurfaces { inputs, plan: &effects.highlight() }.run(shader, outputs),
            |input, effects| scalar_api::highlight(input, &effects.highlight(), &p),
        );
        hold(
            (Datapath::Peak, profile, &p),
            random_lit_peak,
            lit_peak_sets(&p),
            |inputs, effects, shader, outputs| LitPeaks { inputs, plan: &effects.peak() }.run(shader, outputs),
            |input, effects| scalar_api::lit_peak(input, &effects.peak(), &p),
        );
    }
}
