//! Folded designs are the datapath on fewer units: the same bits, from the schedule in integers and from its Verilog.

use std::fs;

use rayon::prelude::*;
use roughxel_core::design::Design;
use roughxel_core::plan::{Effects, FootprintKind};
use roughxel_core::precision::RoughnessKind;
use roughxel_host_tests::simulators::have;
use roughxel_host_tests::space::{is_full_run, profiles, whole_or};
use roughxel_netlist::verilog::{Fault, Folded, Options};
use roughxel_record as record;

use super::rtl::{Case, FULL, expected, inputs, options};

/// Plans of a reflection: all effects, footprints of smooth texels, a mirror.
const PLANS: [(&str, Effects); 3] = [
    ("full", FULL),
    ("footprint", Effects { roughness: RoughnessKind::None, ..FULL }),
    ("mirror", Effects { footprint: FootprintKind::None, ..Effects::NONE }),
];

fn folded_options(profile: &str, effects: Effects, multipliers: u32) -> Options {
    Options { multipliers: Some(multipliers), ..options(profile, effects, None) }
}

fn fold(design: Design, options: &Options) -> Folded {
    let net = record::net(design, &options.effects, &options.precision);
    Folded::of(net, options).expect("the design is proven")
}

/// Fragments of the design that differ from the scalar backend when the schedule runs them in a row.
fn wrong(folded: &Folded, fault: Option<Fault>, inputs: &[Vec<i64>], outputs: &[Vec<i64>]) -> usize {
    let machine = folded.machine();
    let machine = fault.map_or(machine.clone(), |fault| machine.with_fault(fault));
    let given = machine.run(inputs);
    assert_eq!(given.len(), inputs.len());
    let differs = |(given, wanted): &(&Vec<Option<i64>>, &Vec<i64>)| {
        given.iter().zip(wanted.iter()).any(|(given, wanted)| *given != Some(*wanted))
    };
    given.iter().zip(outputs).filter(differs).count()
}

#[test]
fn the_schedule_gives_the_scalar_bits_in_every_profile_and_plan() {
    let mut cases = Vec::new();
    for (profile, _) in profiles() {
        for (plan, effects) in PLANS {
            cases.extend([1, 2, 4, 8, 16, 32].map(|multipliers| (profile, plan, effects, multipliers)));
        }
    }
    cases.into_par_iter().for_each(|(profile, plan, effects, multipliers)| {
        let options = folded_options(profile, effects, multipliers);
        let net = record::net(Design::Reflection, &options.effects, &options.precision);
        // A schedule does not depend on values, so many fragments are for the largest plan alone.
        let count = if plan == "full" && multipliers == 8 { whole_or(100_000, 3000) } else { 100 };
        let inputs = inputs(Design::Reflection, &net, count, &options.effects, &options.precision);
        let inputs: Vec<_> = if count == 100 { inputs.into_iter().step_by(20).collect() } else { inputs };
        let outputs: Vec<_> = inputs
            .iter()
            .map(|ports| expected(Design::Reflection, ports, &options.effects, &options.precision))
            .collect();
        let folded = fold(Design::Reflection, &options);
        assert_eq!(folded.machine().conflicts(), 0, "{profile} {plan} {multipliers}");
        assert_eq!(wrong(&folded, None, &inputs, &outputs), 0, "{profile} {plan} {multipliers}");
    });
}

#[test]
fn a_fragment_takes_hardly_more_cycles_than_the_multipliers_need() {
    for (profile, _) in profiles() {
        for (plan, effects) in PLANS {
            for multipliers in [1, 2, 4, 8, 16, 32] {
                let summary = fold(Design::Reflection, &folded_options(profile, effects, multipliers)).summary();
                let bound = summary.bound;
                assert!(summary.interval <= bound + bound / 4, "{profile} {plan} {multipliers}: {summary:?}");
            }
        }
    }
}

#[test]
fn every_design_can_be_folded() {
    Design::ALL.par_iter().for_each(|&design| {
        for multipliers in [1, 3] {
            let options = folded_options("narrow", FULL, multipliers);
            let net = record::net(design, &options.effects, &options.precision);
            let inputs: Vec<_> =
                inputs(design, &net, 60, &options.effects, &options.precision).into_iter().take(200).collect();
            let outputs: Vec<_> =
                inputs.iter().map(|ports| expected(design, ports, &options.effects, &options.precision)).collect();
            let folded = fold(design, &options);
            assert_eq!(wrong(&folded, None, &inputs, &outputs), 0, "{} on {multipliers}", design.name());
        }
    });
}

#[test]
fn a_wrong_slot_a_wrong_operand_and_a_missing_wait_are_found() {
    let options = folded_options("narrow", FULL, 8);
    let net = record::net(Design::Reflection, &options.effects, &options.precision);
    let inputs: Vec<_> = inputs(Design::Reflection, &net, 40, &options.effects, &options.precision)
        .into_iter()
        .step_by(whole_or(5, 20))
        .take(200)
        .collect();
    let outputs: Vec<_> =
        inputs.iter().map(|ports| expected(Design::Reflection, ports, &options.effects, &options.precision)).collect();
    let folded = fold(Design::Reflection, &options);
    let steps: Vec<usize> = (0..folded.machine().step_count()).step_by(whole_or(1, 7)).collect();
    for kind in [Fault::Slot, Fault::Operand, Fault::Wait] {
        let missed: Vec<usize> = steps
            .par_iter()
            .copied()
            .filter(|&step| wrong(&folded, Some(kind(step)), &inputs, &outputs) == 0)
            .collect();
        let missed: Vec<String> = missed.into_iter().map(|step| folded.machine().step_origin(step)).collect();
        assert!(missed.is_empty(), "{:?} of {} steps: not found {missed:#?}", kind(0), steps.len());
    }
}

#[test]
fn folded_designs_lint_clean_and_give_the_scalar_bits_in_icarus() {
    let mut cases = vec![("narrow", FULL, 8), ("compact", PLANS[1].1, 4), ("standard", PLANS[2].1, 1)];
    if is_full_run() {
        let profiles = profiles().into_iter().flat_map(|(profile, _)| PLANS.map(|(_, effects)| (profile, effects)));
        cases = profiles.flat_map(|(profile, effects)| [1, 2, 8, 32].map(|k| (profile, effects, k))).collect();
    }
    cases.into_par_iter().for_each(|(profile, effects, multipliers)| {
        let mut case = Case::new(Design::Reflection, 40, &folded_options(profile, effects, multipliers));
        if have("verilator") {
            case.written.lint();
        }
        if have("iverilog") {
            let step = case.inputs.len().div_ceil(150);
            case.inputs = case.inputs.into_iter().step_by(step).collect();
            case.outputs = case.outputs.into_iter().step_by(step).collect();
            case.written.icarus(&case.bench());
        }
    });
}

#[test]
fn a_verilated_folded_reflection_gives_the_scalar_bits() {
    if !have("verilator") {
        return;
    }
    for arguments in [&[][..], &["stalls"]] {
        Case::new(Design::Reflection, whole_or(20_000, 500), &folded_options("narrow", FULL, 8)).verilate(arguments);
    }
}

/// Text with the nth line that holds a word changed.
fn changed(text: &str, word: &str, nth: usize, change: impl Fn(&str) -> String) -> String {
    let mut seen = 0;
    let lines = text.lines().map(|line| {
        let is_it = line.contains(word);
        seen += usize::from(is_it);
        if is_it && seen == nth + 1 { change(line) } else { line.to_owned() }
    });
    lines.collect::<Vec<_>>().join("\n") + "\n"
}

#[test]
fn faults_in_the_text_of_a_folded_design_are_found() {
    if !have("iverilog") {
        return;
    }
    let mut case = Case::new(Design::Reflection, 40, &folded_options("narrow", PLANS[2].1, 2));
    case.inputs.truncate(100);
    case.outputs.truncate(100);
    let path = case.written.path().join("roughxel_reflection.v");
    let text = fs::read_to_string(&path).expect("the top was written");
    let interval = case.written.verilog.fold.as_ref().expect("it is folded").interval;
    let next = |line: &str, word: &str| {
        let at = line.find(word).expect("the line has the word") + word.len();
        let end = at + line[at..].find(']').expect("an index ends");
        let phase: u32 = line[at..end].parse().expect("a phase");
        format!("{}{}{}", &line[..at], (phase + 1) % interval, &line[end..])
    };
    for nth in [1, 4, 6] {
        // An operand is chosen, and a register takes its value, in a phase that is not its own.
        for word in ["{16{phase[", "if (take["] {
            let wrong = changed(&text, word, nth, |line| {
                next(line, word.trim_start_matches("{16{").trim_start_matches("if ("))
            });
            assert!(wrong != text, "{word} {nth}");
            fs::write(&path, wrong).expect("the top can be written");
            let report = case.written.simulate(&case.bench());
            assert!(report.contains("FAIL"), "{word} {nth}: {report}");
        }
    }
}
