//! Pipelines for the devices of FPGAs.

use roughxel_core::design::Design;
use roughxel_host_tests::simulators::have;
use roughxel_netlist::target::Target;
use roughxel_netlist::verilog::Options;
use roughxel_record as record;

use super::folded::PLANS;
use super::rtl::{Case, FULL, options};

const DEVICES: [Target; 4] = [Target::Ice40, Target::Ecp5, Target::Gowin, Target::Xc7];

#[test]
fn a_pipeline_for_each_device_lints_clean_and_gives_the_scalar_bits() {
    for target in DEVICES {
        // A mirror, whose stages are those of every plan.
        let options = Options { target, ..options("narrow", PLANS[2].1, None) };
        let case = Case::new(Design::Reflection, 200, &options);
        if have("verilator") {
            case.written.lint();
        }
        if have("iverilog") {
            case.written.icarus(&case.bench());
        }
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
