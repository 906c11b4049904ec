//! Folded designs are the datapath on fewer units: the same bits, from the schedule in integers and from its Verilog.

use std::fs;
use std::process::Command;

use rayon::prelude::*;
use roughxel_core::design::Design;
use roughxel_core::plan::{Effects, FootprintKind};
use roughxel_core::precision::RoughnessKind;
use roughxel_host_tests::designs::{expected, inputs};
use roughxel_host_tests::simulators::{have, run};
use roughxel_host_tests::space::{is_full_run, profiles, whole_or};
use roughxel_netlist::interval::Range;
use roughxel_netlist::target::Target;
use roughxel_netlist::unit::{Unit, signed_digits, signed_powers};
use roughxel_netlist::verilog::{Fault, Folded, Machine, Options};
use roughxel_record as record;
use roughxel_utilities::random::SplitMix64;

use super::rtl::{Case, FULL, options};

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
    Folded::from_net(net, options).expect("the design is proven")
}

/// Fragments of the design that differ from the scalar backend when the schedule runs them in a row.
fn wrong(machine: &Machine, inputs: &[Vec<i64>], outputs: &[Vec<i64>]) -> usize {
    let given = machine.run(inputs);
    assert_eq!(given.len(), inputs.len());
    let differs = |(given, wanted): &(&Vec<Option<i64>>, &Vec<i64>)| {
        given.iter().zip(wanted.iter()).any(|(given, wanted)| *given != Some(*wanted))
    };
    given.iter().zip(outputs).filter(differs).count()
}

#[test]
fn the_schedule_gives_the_scalar_bits_in_hardly_more_cycles_than_the_multipliers_need_in_every_profile_and_plan() {
    let mut cases = Vec::new();
    let most = whole_or(100_000, 3000);
    for (profile, _) in profiles() {
        for (plan, effects) in PLANS {
            cases.extend([1, 2, 4, 8, 16, 32].map(|multipliers| (profile, plan, effects, multipliers)));
        }
    }
    cases.into_par_iter().for_each(|(profile, plan, effects, multipliers)| {
        let options = folded_options(profile, effects, multipliers);
        let net = record::net(Design::Reflection, &options.effects, &options.precision);
        // A schedule does not depend on values, so many fragments are for the largest plan alone.
        let count = if plan == "full" && multipliers == 8 { most } else { 100 };
        let inputs = inputs(Design::Reflection, &net, count, &options.effects, &options.precision);
        let inputs: Vec<_> = if count == 100 { inputs.into_iter().step_by(20).collect() } else { inputs };
        let outputs: Vec<_> = inputs
            .iter()
            .map(|ports| expected(Design::Reflection, ports, &options.effects, &options.precision))
            .collect();
        let folded = fold(Design::Reflection, &options);
        let (machine, summary) = (folded.machine(), folded.summary());
        assert!(summary.interval <= summary.bound + summary.bound / 4, "{profile} {plan} {multipliers}: {summary:?}");
        assert_eq!(machine.conflicts(), 0, "{profile} {plan} {multipliers}");
        assert_eq!(wrong(&machine, &inputs, &outputs), 0, "{profile} {plan} {multipliers}");
    });
}

#[test]
fn normalisers_of_one_wire_are_those_of_several_and_take_their_exponents() {
    let summary = fold(Design::Reflection, &folded_options("narrow", FULL, 8)).summary();
    let uses = summary.units.iter().filter(|unit| unit.name.starts_with("normaliser")).map(|unit| unit.uses);
    // Some have four wires, three, two, most have one.
    assert!(uses.clone().max() >= Some(41) && uses.sum::<u32>() == 48, "{summary:?}");
    // Each would have three operations for its exponent.
    assert!(summary.glue < 560, "{summary:?}");
}

#[test]
fn products_of_a_sum_are_added_up_behind_a_multiplier() {
    let options = folded_options("narrow", FULL, 8);
    let verilog = record::verilog(Design::Reflection, &options).expect("the design is proven");
    let text = &verilog.files["roughxel_reflection.v"];
    assert_eq!(text.matches("// Sums of products.").count(), 8);
    // An adder of two products is left only where they are not aligned, or read elsewhere, too.
    let adders = text.lines().filter(|line| line.contains("_add = ") || line.contains("_sub = "));
    let of_products = adders.filter(|line| line.matches("_mul").count() > 2).count();
    assert!(of_products <= 2, "{of_products} adders of two products");
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
            assert_eq!(wrong(&folded.machine(), &inputs, &outputs), 0, "{} on {multipliers}", design.name());
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
    let machine = folded.machine();
    let steps: Vec<usize> = (0..machine.step_count()).step_by(whole_or(1, 7)).collect();
    // Most faults show in a few fragments, so all run only where these show none.
    let shows = |faulty: &Machine, count: usize| wrong(faulty, &inputs[..count], &outputs[..count]) != 0;
    for kind in [Fault::Slot, Fault::Operand, Fault::Wait] {
        let missed: Vec<usize> = steps
            .par_iter()
            .copied()
            .filter(|&step| {
                let faulty = machine.clone().with_fault(kind(step));
                !shows(&faulty, 4) && !shows(&faulty, inputs.len())
            })
            .collect();
        let missed: Vec<String> = missed.into_iter().map(|step| machine.step_origin(step)).collect();
        assert!(missed.is_empty(), "{:?} of {} steps: not found {missed:#?}", kind(0), steps.len());
    }
}

#[test]
fn a_constant_is_the_sum_of_its_signed_powers() {
    let mut random = SplitMix64::for_element("signed powers", 0);
    let wide = (0..1000).map(|_| random.next_u64().cast_signed() >> 8);
    for constant in (-5000..=5000).chain(wide) {
        let powers = signed_powers(constant);
        let sum: i128 = powers.iter().map(|&(negative, k)| if negative { -(1 << k) } else { 1 << k }).sum();
        assert_eq!(sum, i128::from(constant), "{powers:?}");
        assert_eq!(powers.len() as u32, signed_digits(constant), "{constant}");
        // No two digits are neighbours, so none can be left out.
        assert!(powers.windows(2).all(|pair| pair[1].1 > pair[0].1 + 1), "{constant}: {powers:?}");
    }
}

#[test]
fn levels_on_a_device_are_those_of_the_table() {
    let word = Range { low: -32768, high: 32767, zeros: 0 };
    let table = [
        (Unit::Adder { bits: 24, constant: false }, 2),
        (Unit::Adder { bits: 25, constant: true }, 3),
        (Unit::Comparator { bits: 16 }, 3),
        (Unit::Multiplier([word, word]), 7),
        (Unit::ConstantMultiplier { by: 0b101_0101, operand: word }, 4),
        (Unit::Shifter { bits: 30, places: 5 }, 5),
        (Unit::LeadingZeros { bits: 31 }, 5),
        (Unit::Table { entries: 128 }, 5),
        (Unit::Table { entries: 1024 }, 5),
        (Unit::Table { entries: 64 }, 3),
        (Unit::Table { entries: 8 }, 1),
        (Unit::Select { bits: 16 }, 1),
        (Unit::Wires, 0),
    ];
    for (unit, levels) in table {
        assert_eq!(Target::Ecp5.levels(unit, 7), levels, "{unit:?}");
    }
    assert_eq!([1, 2, 4, 26, 64].map(|wires| Target::Ecp5.choice(wires)), [0, 2, 2, 4, 4]);
    assert_eq!(Target::Asic.choice(26), 5);
}

#[test]
fn registers_of_products_are_kept_on_ice40_where_yosys_loses_them() {
    let text = |target, multipliers| {
        let options = Options { target, multipliers, ..options("narrow", PLANS[2].1, None) };
        let files = record::verilog(Design::Reflection, &options).expect("the design is proven").files;
        files.into_values().collect::<Vec<_>>().join("\n")
    };
    let flat = text(Target::Ice40, None);
    let products = flat.lines().filter(|line| line.contains("(* keep *) reg") && line.contains("_mul_s"));
    // Two of the sixteen products of a mirror end their stage, whose outcome is in a register of the top.
    assert!(products.count() >= 14);
    assert!(text(Target::Ice40, Some(2)).contains("(* keep_hierarchy *)\nmodule multiplier"));
    assert!(!text(Target::Ecp5, None).contains("keep"));
}

#[test]
fn a_folded_design_is_the_same_text_every_time() {
    for target in [Target::Asic, Target::Ecp5] {
        let options = Options { target, ..folded_options("narrow", FULL, 4) };
        let write = || record::verilog(Design::Reflection, &options).expect("the design is proven").files;
        assert_eq!(write(), write());
    }
}

#[test]
fn a_design_that_is_folded_for_a_device_gives_the_scalar_bits() {
    let inputs_of = |options: &Options| {
        let net = record::net(Design::Reflection, &options.effects, &options.precision);
        let all = inputs(Design::Reflection, &net, 60, &options.effects, &options.precision);
        all.into_iter().step_by(20).collect::<Vec<_>>()
    };
    let gates = fold(Design::Reflection, &folded_options("narrow", FULL, 8)).summary();
    for target in Target::ALL.into_iter().filter(|&target| target != Target::Asic) {
        let options = Options { target, ..folded_options("narrow", FULL, 8) };
        let inputs = inputs_of(&options);
        let outputs: Vec<_> = inputs
            .iter()
            .map(|ports| expected(Design::Reflection, ports, &options.effects, &options.precision))
            .collect();
        let folded = fold(Design::Reflection, &options);
        assert_eq!(wrong(&folded.machine(), &inputs, &outputs), 0, "{}", target.name());
        assert_eq!(folded.summary().interval, gates.interval, "{}", target.name());
    }
}

#[test]
fn a_depth_below_the_deepest_operation_names_the_least_one() {
    for multipliers in [None, Some(8)] {
        let at = |depth| Options { depth: Some(depth), multipliers, ..options("narrow", FULL, None) };
        let error = record::verilog(Design::Reflection, &at(4)).expect_err("an adder has more levels").to_string();
        let least: u32 = error.rsplit(' ').next().and_then(|word| word.parse().ok()).expect("a number");
        assert!(record::verilog(Design::Reflection, &at(least - 1)).is_err(), "{error}");
        assert!(record::verilog(Design::Reflection, &at(least)).is_ok(), "{error}");
    }
}

#[test]
fn folded_designs_lint_clean_and_give_the_scalar_bits_in_icarus() {
    // On an ECP5 values wait in rings, too.
    let mut cases = vec![
        ("narrow", FULL, 8, Target::Asic),
        ("narrow", FULL, 6, Target::Ecp5),
        ("compact", PLANS[1].1, 4, Target::Gowin),
        ("standard", PLANS[2].1, 1, Target::Asic),
    ];
    if is_full_run() {
        let profiles = profiles().into_iter().flat_map(|(profile, _)| PLANS.map(|(_, effects)| (profile, effects)));
        let cells = [(1, Target::Asic), (2, Target::Asic), (8, Target::Asic), (8, Target::Xc7), (32, Target::Asic)];
        let cells = |(profile, effects)| cells.map(|(multipliers, target)| (profile, effects, multipliers, target));
        cases.extend(profiles.flat_map(cells));
    }
    cases.into_par_iter().for_each(|(profile, effects, multipliers, target)| {
        let options = Options { target, ..folded_options(profile, effects, multipliers) };
        let mut case = Case::new(Design::Reflection, 40, &options);
        let has_rings = case.written.verilog.files.contains_key("roughxel_ring.v");
        assert_eq!(has_rings, target.has_small_memories(), "{profile} {multipliers} {}", target.name());
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

/// Module with the ports of a testbench that sends each input through the AXI4-Stream shell as words, and gathers the words of each output.
fn adapter(flat: &str, shell: &str, [in_bits, out_bits]: [u32; 2], width: u32) -> String {
    let (ins, outs) = (in_bits.div_ceil(width), out_bits.div_ceil(width));
    format!(
        "module {flat} (input wire clk, input wire rst, input wire in_valid, output wire in_ready, input wire [{}:0] in_bits,
  output wire out_valid, input wire out_ready, output wire [{}:0] out_bits);
  reg [{}:0] sending; integer left = 0;
  // The first word ends its packet too early and is dropped.
  reg early = {ins} > 1;
  reg [{}:0] got; integer have = 0;
  wire s_ready, m_valid, m_last;
  wire [{}:0] m_data;
  assign in_ready = left == 0 && !early;
  wire m_ready = have < {outs};
  assign out_valid = have == {outs};
  assign out_bits = got[{}:0];
  always @(posedge clk) begin
    if (rst) left <= 0;
    else if (in_valid && in_ready) begin sending <= in_bits; left <= {ins}; end
    else if (early) early <= !s_ready;
    else if (left != 0 && s_ready) begin sending <= sending >> {width}; left <= left - 1; end
    if (rst) have <= 0;
    else if (out_valid && out_ready) have <= 0;
    else if (m_valid && m_ready) begin
      got <= (got >> {width}) | ({{{{{}{{1'b0}}}}, m_data}} << {});
      have <= have + 1;
      if (m_last != (have == {}) ) $display(\"FAIL: tlast\");
    end
  end
  {shell} dut (.aclk(clk), .aresetn(~rst), .s_axis_tvalid(early || left != 0), .s_axis_tready(s_ready), .s_axis_tdata(sending[{}:0]),
    .s_axis_tlast(early || left == 1), .m_axis_tvalid(m_valid), .m_axis_tready(m_ready), .m_axis_tdata(m_data), .m_axis_tlast(m_last));
endmodule
",
        in_bits - 1,
        out_bits - 1,
        ins * width - 1,
        outs * width - 1,
        width - 1,
        out_bits - 1,
        (outs - 1) * width,
        (outs - 1) * width,
        outs - 1,
        width - 1
    )
}

#[test]
fn a_stream_of_words_gives_the_scalar_bits() {
    if !have("iverilog") {
        return;
    }
    for (multipliers, width) in [(Some(2), 32), (Some(1), 8), (None, 64)] {
        let options = Options { multipliers, stream: Some(width), ..options("narrow", PLANS[2].1, None) };
        let mut case = Case::new(Design::Reflection, 40, &options);
        case.inputs.truncate(60);
        case.outputs.truncate(60);
        let (top, shell) = ("roughxel_reflection", "roughxel_reflection_axis");
        if have("verilator") {
            let mut command = Command::new("verilator");
            command.args(["--lint-only", "-Wall", "--top-module", shell, "-y"]).arg(case.written.path());
            run(command.arg(case.written.path().join(format!("{shell}.v"))));
        }
        let interface = case.written.verilog.top.as_ref().expect("a top");
        let bits = [&interface.inputs, &interface.outputs].map(|ports| ports.iter().map(|port| port.width).sum());
        // The testbench finds the adapter in the place of its own wrapper.
        let bench = case.bench();
        let mut files = bench.files();
        for (name, content) in &mut files {
            if *name == format!("{top}_flat.v") {
                *content = adapter(&format!("{top}_flat"), shell, bits, width).into_bytes();
            }
        }
        let report = case.written.simulate_files(files);
        assert!(report.contains("PASS") && !report.contains("FAIL"), "{multipliers:?} {width}: {report}");
    }
}
