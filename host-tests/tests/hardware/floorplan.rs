//! The floor plan: page and picture are what the kept results say, operations are those of the float32 datapath, a netlist gives the scalar bits.

use std::collections::BTreeMap;
use std::fs;
use std::process::Command;

use roughxel_cases::random_fragment;
use roughxel_core::precision::Precision;
use roughxel_core::status::StatusBit;
use roughxel_f32_baseline::math::Std;
use roughxel_f32_baseline::{Environment, Fragment, formulas::Careful};
use roughxel_host_tests::floorplan::cell::{Cell, Plan, hash};
use roughxel_host_tests::floorplan::device::{DEVICES, Device};
use roughxel_host_tests::floorplan::place::{Nextpnr, utilisation, version_in};
use roughxel_host_tests::floorplan::results::{self, Results};
use roughxel_host_tests::floorplan::simulate::{MODELS, OWN_MEMORIES, Variant, run_netlist, simulate};
use roughxel_host_tests::floorplan::yosys::{Yosys, hash_without_places};
use roughxel_host_tests::floorplan::{operations, page, picture, tools};
use roughxel_host_tests::simulators::have;
use roughxel_netlist::target::Target;
use roughxel_utilities::random::SplitMix64;

fn kept() -> Results {
    Results::read(&results::file()).expect("the committed results")
}

fn text_of(path: &std::path::Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn page_and_picture_are_those_of_the_kept_results() {
    let results = kept();
    let remedy = "run `cargo run --release -p roughxel-host-tests --bin floorplan -- --page`";
    assert_eq!(text_of(&results::file()), results.text().expect("finite numbers"), "{remedy}");
    assert_eq!(text_of(&page::file()), page::text(&results), "{remedy}");
    assert_eq!(text_of(&picture::file()), picture::svg(&results).expect("the study"), "{remedy}");
}

/// A design whose text has another order may have the same netlist, and a placement takes up to hours.
#[test]
fn a_netlist_is_the_same_wherever_its_parts_come_from() {
    let netlist = |place: &str, kind: &str| {
        let places = format!("    \"src\": \"a.v:{place}\",\n    \"cell_src\": \"b.v:{place}\"\n");
        format!("{{\n  \"attributes\": {{\n{places}  }},\n  \"type\": \"{kind}\"\n}}\n")
    };
    let hash = |place, kind| hash_without_places(&netlist(place, kind));
    assert_eq!(hash("1.1-1.5", "LUT4"), hash("2.3-2.7", "LUT4"));
    assert_ne!(hash("1.1-1.5", "LUT4"), hash("1.1-1.5", "LUT3"));
}

#[test]
fn every_simulated_netlist_is_right() {
    let simulations = kept().simulations;
    for (name, simulation) in &simulations {
        assert_eq!(simulation.mismatch, None, "{name}");
        assert!(simulation.vectors >= 100, "{name}: {} vectors", simulation.vectors);
    }
    // A footprint has rings in memory blocks.
    let targets = ["ecp5", "gowin", "ice40", "xc7"];
    let mirrors =
        targets.iter().flat_map(|target| ["2", "flat"].map(|count| format!("narrow-mirror-{count}-{target}")));
    let large = [
        "narrow-footprint-2-ecp5",
        "narrow-footprint-2-gowin",
        "narrow-footprint-2-xc7",
        "narrow-all-6-ecp5",
        "narrow-all-6-gowin",
        "narrow-all-8-xc7",
        "compact-all-6-ecp5",
    ];
    for design in mirrors.chain(large.map(str::to_owned)) {
        for ready in ["stalls", "always-ready"] {
            let name = format!("{design}-{ready}");
            assert!(simulations.contains_key(&name), "{name} was not simulated");
        }
    }
}

#[test]
fn results_that_cannot_be_read_name_file_and_remedy() {
    let directory = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a temporary directory");
    let path = directory.path().join("floorplan.json");
    assert_eq!(Results::read(&path), Ok(Results::default()));
    let text = text_of(&results::file());
    let mut random = SplitMix64::for_element("floorplan", 0);
    let mut place = || (random.next_u64() % text.len() as u64) as usize;
    for round in 0..300 {
        let mut bytes = text.clone().into_bytes();
        if round % 2 == 0 {
            bytes.truncate(place());
        } else {
            bytes[place()] = place() as u8;
        }
        fs::write(&path, bytes).expect("a file can be written");
        // A changed digit or letter of a name is another result.
        if let Err(message) = Results::read(&path) {
            assert!(message.contains("floorplan.json"), "{message}");
            assert!(round % 2 == 1 || message.contains("line") && message.contains("measure again"), "{message}");
        }
    }
}

#[test]
fn used_cells_are_read_from_any_log() {
    let log = "Info: Device utilisation:\nInfo: \t          TRELLIS_IO:      40/    197    20%\nInfo: \t    DCCA:  0/ 56  0%\n\
               Info:     Total LUT4s:     22851/24288    94%\nInfo: \tTRELLIS_COMB: 30000/24288 123%\n";
    let expected = [("TRELLIS_IO", [40, 197]), ("TRELLIS_COMB", [30_000, 24_288])];
    let expected: BTreeMap<String, [u64; 2]> =
        expected.into_iter().map(|(kind, counts)| (kind.to_owned(), counts)).collect();
    assert_eq!(utilisation(log), expected);
    for end in 0..log.len() {
        assert!(utilisation(&log[..end]).len() <= 2);
    }
}

#[test]
fn every_tool_has_a_version_and_a_missing_one_names_the_command() {
    let programs = DEVICES.map(|device| format!("yowasp-{}", device.program));
    for package in programs.iter().map(String::as_str).chain(["pyosys", "zkf"]) {
        assert!(tools::version(package).is_ok(), "{package}");
    }
    let missing = tools::installed("wasmtime-of-another-name").expect_err("there is no such package");
    assert!(missing.contains("requirements.txt"), "{missing}");
    let other = Device { program: "nextpnr-of-another-name", ..DEVICES[0] };
    let missing = Nextpnr::system(&other).expect_err("there is no such program");
    assert!(missing.contains("install the package nextpnr-of-another-name"), "{missing}");
    assert!(missing.contains("--native"), "{missing}");
}

#[test]
fn a_program_says_its_version() {
    let line = "\"nextpnr-ecp5\" -- Next Generation Place and Route (Version 0.11.1+dfsg-5+b1)\n";
    assert_eq!(version_in(line), Some("0.11.1+dfsg-5+b1"));
    assert_eq!(version_in("nextpnr-ecp5: unknown option"), None);
}

#[test]
fn hashes_tell_texts_apart() {
    assert_eq!(hash(&["ab", "c"]), hash(&["ab", "c"]));
    assert_ne!(hash(&["ab", "c"]), hash(&["a", "bc"]));
    assert_ne!(hash(&["ab"]), hash(&["ab", ""]));
}

#[test]
fn a_frame_is_the_largest_that_is_filled_thirty_times_a_second() {
    assert_eq!(page::frame(640.0 * 480.0 * 30.0), Some([640, 480]));
    assert_eq!(page::frame(640.0 * 480.0 * 30.0 - 1.0), Some([480, 320]));
    assert_eq!(page::frame(1.0), None);
}

#[test]
fn counted_operations_give_the_results_of_the_float32_datapath() {
    let fragments = (0..).map(|index| random_fragment("floorplan", index, &Precision::STANDARD));
    let fragments = fragments.filter(Fragment::in_range).take(2000);
    let mut compared = 0;
    for ports in fragments {
        let edge = u32::from(ports.edge_texels).next_power_of_two();
        let (rough, environment) = (Fragment::from(&ports), Environment::new(edge));
        let smooth = Fragment { roughness: glam::Vec3::ZERO, ..rough };
        let flat = Fragment { offset: glam::Vec2::ZERO, ..smooth };
        let [of_rough, of_smooth, of_flat] =
            [rough, smooth, flat].map(|fragment| environment.reflect::<Std, Careful>(&fragment));
        let zeros = StatusBit::NormalZero.mask() | StatusBit::ViewZero.mask();
        if of_flat.status & zeros == 0 {
            assert_eq!(operations::reflect_mirror(&flat).st, of_flat.st.to_array());
        }
        for (fragment, wanted, is_rough) in [(smooth, of_smooth, false), (rough, of_rough, true)] {
            // Degenerate fragments have choices that are not counted.
            if wanted.status != 0 {
                continue;
            }
            let outcome = operations::reflect_footprint(&fragment, is_rough, edge);
            assert_eq!(outcome.st, wanted.st.to_array());
            assert_eq!(outcome.step, wanted.step.to_array());
            assert_eq!(outcome.lod.to_bits(), wanted.lod.to_bits(), "{outcome:?} {wanted:?}");
            compared += 1;
        }
    }
    assert!(compared > 1000, "{compared} footprints");
}

#[test]
fn kept_counts_of_operations_are_those_of_the_formulas() {
    assert_eq!(kept().float_operations, operations::of_plans());
}

#[test]
fn an_ice40_netlist_of_a_folded_mirror_gives_the_scalar_bits_and_one_that_lost_a_product_does_not() {
    if !have("yosys") || !have("verilator") {
        return;
    }
    let yosys = Yosys::system().expect("yosys answers");
    let cell = Cell { profile: "narrow".to_owned(), plan: Plan::Mirror, multipliers: Some(2), target: Target::Ice40 };
    let directory = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a temporary directory");
    let variant = Variant { cell, is_tied: false };
    let simulation = simulate(&yosys, &variant, 60, directory.path()).expect("the tools run");
    assert_eq!(simulation.mismatch, None);
    assert!(simulation.vectors > 50, "{}", simulation.vectors);
    // The outputs of the first multiplier are not driven any more, as in `findings/yosys_ice40_sum_of_products.sh`.
    let (module, path) = ("roughxel_reflection", directory.path().join("netlist.v"));
    let netlist = text_of(&path);
    let begin = netlist.find("SB_MAC16 #(").expect("a product is in a multiplier");
    let end = begin + netlist[begin..].find("\n  );\n").expect("the instance ends") + 6;
    fs::write(&path, [&netlist[..begin], &netlist[end..]].concat()).expect("the folder takes files");
    let report = run_netlist(&yosys, &variant, module, directory.path()).expect("the tools run");
    assert!(report.contains("expected"), "{report}");
}

/// A ring of two words and a table, as a folded design has them in block memories.
const MEMORIES: &str = "
module memories (
  input wire clk, enable, input wire [1:0] place, next, input wire [39:0] in, input wire [7:0] index,
  output reg [39:0] out, output reg [15:0] entry
);
  (* ram_style = \"block\", no_rw_check *) reg [39:0] memory [0:3];
  (* rom_style = \"block\" *) reg [15:0] table_ [0:255];
  integer i;
  initial for (i = 0; i < 256; i = i + 1) table_[i] = 40503 * i;
  always @(posedge clk)
    if (enable) begin
      memory[place] <= in;
      out <= memory[next];
      entry <= table_[index];
    end
endmodule
";

/// Compares the netlist of the memories with their source, and then reads a word while it is written.
const MEMORIES_BENCH: &str = "
module bench;
  reg clk = 0, enable = 0;
  reg [1:0] place, next;
  reg [39:0] in;
  reg [7:0] index;
  wire [39:0] out, wanted;
  wire [15:0] entry, wanted_entry;
  memories source (.clk(clk), .enable(enable), .place(place), .next(next), .in(in), .index(index), .out(wanted), .entry(wanted_entry));
  netlist device (.clk(clk), .enable(enable), .place(place), .next(next), .in(in), .index(index), .out(out), .entry(entry));
  integer cycle, wrong = 0;
  initial begin
    for (cycle = 0; cycle < 2000; cycle = cycle + 1) begin
      enable = cycle < 4 || $random;
      place = cycle;
      next = place + 1 + $unsigned($random) % 3;
      in = {$random, $random};
      index = $random;
      #1 clk = 1;
      #1 clk = 0;
      if (cycle > 8 && (out !== wanted || entry !== wanted_entry)) wrong = wrong + 1;
    end
    enable = 1;
    next = place;
    #1 clk = 1;
    #1 if (out !== 40'bx) wrong = wrong + 1;
    if (wrong == 0) $display(\"PASS\"); else $display(\"%0d are wrong\", wrong);
  end
endmodule
";

#[test]
fn the_model_of_a_memory_block_of_ecp5_is_what_yosys_makes_of_a_memory() {
    if !have("yosys") || !have("iverilog") {
        return;
    }
    let directory = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a temporary directory");
    let folder = directory.path();
    for (name, text) in [("memories.v", MEMORIES), ("bench.v", MEMORIES_BENCH), ("models.v", MODELS)] {
        fs::write(folder.join(name), text).expect("the folder takes files");
    }
    let passes = ["read_verilog memories.v", "synth_ecp5 -top memories", "rename -top netlist", OWN_MEMORIES];
    let passes = passes.into_iter().chain(["write_verilog -noattr netlist.v"]).map(str::to_owned);
    Yosys::system().expect("yosys answers").run(folder, &passes.collect::<Vec<_>>()).expect("the passes run");
    let netlist = text_of(&folder.join("netlist.v"));
    assert_eq!(netlist.matches("ecp5_memory #(").count(), 3, "two blocks of 36 bits and one for the table");
    let sources = ["bench.v", "memories.v", "netlist.v", "models.v"];
    let mut compile = Command::new("iverilog");
    compile.args(["-g2012", "-s", "bench", "-o", "b"]).args(sources).current_dir(folder);
    assert!(compile.status().expect("iverilog runs").success());
    let output = Command::new("vvp").args(["-N", "b"]).current_dir(folder).output().expect("vvp runs");
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "PASS");
}
