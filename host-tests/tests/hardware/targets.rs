//! Pipelines for the devices of FPGAs.

use rayon::prelude::*;
use roughxel_core::bundle::{Field, Keeps, Per, Step};
use roughxel_core::design::Design;
use roughxel_core::precision::Profile;
use roughxel_host_tests::simulators::have;
use roughxel_netlist::bench::Bench;
use roughxel_netlist::builder::{self, NamedWire};
use roughxel_netlist::graph::{Kind, NodeId, Op};
use roughxel_netlist::target::Target;
use roughxel_netlist::verilog::{Options, Verilog};
use roughxel_record as record;
use roughxel_utilities::random::SplitMix64;

use super::rtl::{Case, FULL, Written, options};

const DEVICES: [Target; 4] = [Target::Ice40, Target::Ecp5, Target::Gowin, Target::Xc7];

#[test]
fn a_pipeline_for_each_device_lints_clean_and_gives_the_scalar_bits() {
    let cases: [(Target, &str); 4] =
        [(Target::Ice40, "narrow"), (Target::Ecp5, "standard"), (Target::Gowin, "compact"), (Target::Xc7, "paper")];
    cases.into_par_iter().for_each(|(target, profile)| {
        let options = Options { target, ..options(profile, FULL, None) };
        let case = Case::new(Design::Reflection, 60, &options);
        if have("verilator") {
            case.written.lint();
        }
        if have("iverilog") {
            case.written.icarus(&case.bench());
        }
    });
}

#[test]
fn a_default_depth_is_enough_for_every_profile_on_every_device() {
    let profiles: Vec<&str> = Profile::ALL.iter().map(|profile| profile.name()).collect();
    let cases = DEVICES.into_iter().flat_map(|target| profiles.iter().map(move |profile| (target, *profile)));
    cases.collect::<Vec<_>>().into_par_iter().for_each(|(target, profile)| {
        for multipliers in [None, Some(8)] {
            let options = Options { target, multipliers, ..options(profile, FULL, None) };
            let written = record::verilog(Design::Reflection, &options).map(drop);
            written.unwrap_or_else(|error| panic!("{profile} on {}, {multipliers:?}: {error}", target.name()));
        }
    });
}

/// Place in a list of ports or outcomes.
fn path(place: usize) -> Vec<Step> {
    const LIST: Field = Field {
        name: "list",
        text: "",
        unit: "",
        stage: "",
        leaves: true,
        keeps: Keeps::Fraction,
        components: "",
        per: Per::Fragment,
    };
    vec![Step::Field(&LIST), Step::Index(place)]
}

fn on(target: Target) -> Options {
    Options { target, ..options("standard", FULL, None) }
}

/// Simulates the operations that `stage` records on ports of these kinds and ranges, and returns the text of the top. The evaluated netlist gives the
/// expected outcomes.
fn simulate(
    options: &Options,
    ports: &[(Kind, (i64, i64))],
    inputs: &[Vec<i64>],
    stage: impl Fn(&[NodeId]) -> Vec<NodeId>,
) -> String {
    let named = |nodes: &[NodeId]| {
        let wire =
            |(place, &node): (usize, &NodeId)| NamedWire { path: path(place), node, mantissa: false, fraction_bits: 0 };
        nodes.iter().enumerate().map(wire).collect::<Vec<_>>()
    };
    builder::begin();
    let port = |(place, &(kind, range))| builder::port(path(place), kind, false, 0, range);
    let read: Vec<NodeId> = ports.iter().enumerate().map(port).collect();
    builder::enter("operations");
    let made = stage(&read);
    builder::leave(named(&made));
    let net = builder::end(named(&made));

    let mut values = Vec::new();
    let mut outcomes = Vec::new();
    for ports in inputs {
        net.evaluate(ports, &mut values);
        outcomes.push(net.outputs.iter().map(|output| values[output.node as usize]).collect());
    }
    let written = Written::from_verilog(Verilog::new(Design::MapScale, net, options).expect("the design is proven"));
    let top = written.verilog.top.as_ref().expect("a top");
    written.icarus(&Bench::new(top, inputs, &outcomes).expect("the ports hold the vectors"));
    written.verilog.files[&format!("{}.v", top.module)].clone()
}

#[test]
fn comparisons_with_every_constant_are_right_for_every_value() {
    if !have("iverilog") {
        return;
    }
    let word = Kind::Wire(32);
    let inputs: Vec<Vec<i64>> = (-40..=40).map(|x| vec![x, x + 40]).collect();
    for target in [Target::Asic, Target::Ecp5] {
        simulate(&on(target), &[(word, (-40, 40)), (word, (0, 80))], &inputs, |ports| {
            let below =
                |port, constant| builder::node(Op::Lt(port, builder::node(Op::Lit(constant), word)), Kind::Flag);
            let signed = (-39..=40).map(|constant| below(ports[0], constant));
            signed.chain((1..=80).map(|constant| below(ports[1], constant))).collect()
        });
    }
}

/// Counts for all values of 15 bits, and for values of every size with any bits on wider wires.
#[test]
fn leading_zeros_of_words_are_counted_on_every_target() {
    if !have("iverilog") {
        return;
    }
    let mut random = SplitMix64::for_element("leading zeros", 0);
    let ports = [16, 32, 64].map(|bits| (Kind::Wire(bits), (0, i64::MAX >> (64 - bits))));
    let inputs: Vec<Vec<i64>> = (0..1 << 15)
        .map(|small: i64| {
            let any = random.next_u64() as i64 & i64::MAX;
            vec![small, (any >> 32) >> (small % 32), any >> (small % 64)]
        })
        .collect();
    for target in [Target::Asic, Target::Ecp5] {
        simulate(&on(target), &ports, &inputs, |ports| {
            ports.iter().map(|&port| builder::node(Op::LeadingZeros(port), Kind::Wire(32))).collect()
        });
    }
}

/// Module texts of a reflection with all effects.
fn texts(target: Target) -> Vec<String> {
    let options = Options { target, ..options("narrow", FULL, None) };
    record::verilog(Design::Reflection, &options).expect("the design is proven").files.into_values().collect()
}

#[test]
fn comparisons_with_constants_of_few_runs_take_no_carry_chain() {
    let is_constant = |right: &str| right.split_once('\'').is_some_and(|(width, _)| width.parse::<u32>().is_ok());
    let compared = |target| {
        let texts = texts(target);
        let rights = texts.iter().flat_map(|text| text.lines()).filter_map(|line| line.split_once(" < "));
        rights.filter(|(_, right)| is_constant(right)).count()
    };
    assert!(compared(Target::Asic) > 50);
    assert_eq!(DEVICES.map(compared), [0; 4]);
}

/// Names and keywords of a line.
fn names(line: &str) -> impl DoubleEndedIterator<Item = &str> {
    line.split(|character: char| !character.is_ascii_alphanumeric() && character != '_')
}

#[test]
fn an_entry_of_a_block_memory_goes_through_a_register_before_anybody_reads_it() {
    let mut seen = 0;
    for text in texts(Target::Ecp5) {
        let memories = ["rom_reciprocal", "rom_inverse_root", "rom_log2 "];
        let reads = text.lines().filter(|line| memories.iter().any(|rom| line.trim_start().starts_with(rom)));
        for line in reads.filter(|line| line.contains(".index(")) {
            let port = line.split_once(".entry(").expect("an entry").1;
            let entry = names(port).rfind(|name| name.ends_with("_lookup")).expect("a wire");
            let reads = |line: &&str| line.contains('=') && names(line).any(|name| name == entry);
            let readers: Vec<&str> = text.lines().filter(reads).collect();
            let [reader] = readers[..] else { panic!("{entry}: {readers:?}") };
            assert!(reader.trim_start().starts_with(&format!("{entry}_s")) && reader.contains("<="), "{reader}");
            seen += 1;
        }
    }
    assert!(seen >= 5, "{seen} reads of block memories");
}

#[track_caller]
fn doubled(wire: NodeId) -> NodeId {
    builder::node(Op::Add(wire, wire), Kind::Wire(32))
}

#[test]
fn an_operation_of_a_line_outside_the_project_is_written_in_a_folded_design() {
    if !have("iverilog") {
        return;
    }
    let inputs: Vec<Vec<i64>> = (-20..20).map(|x| vec![x]).collect();
    let folded = Options { multipliers: Some(1), ..on(Target::Asic) };
    // The iterator calls `doubled` itself, so the line is one of the standard library.
    let text = simulate(&folded, &[(Kind::Wire(32), (-20, 20))], &inputs, |ports| {
        ports.iter().copied().map(doubled).collect()
    });
    assert!(text.contains("; // cycle "), "{text}");
}
