//! `roughxel vectors bench`.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use roughxel_netlist::target::Target;
use roughxel_netlist::verilog::STREAM_BITS;
use roughxel_utilities::output::write_files;
use roughxel_vectors::{Device, HardwareForm, TESTBENCH_README, Testbench, manifests_of};
use serde_json::json;

use crate::console::complain;
use crate::verilog::parse_target;
use crate::{Failure, check_directory};

pub(super) const LONG_HELP: &str = "\
Write testbenches that compare a device with sets: SystemVerilog, VHDL, cocotb, a Verilator driver.

DIR/SET gets packages and testbenches in SystemVerilog (Icarus, Verilator) and VHDL (GHDL), a test for
cocotb, a C++ driver for Verilator, the words, and run.sh, which runs any of them:

  roughxel vectors export random --count 64 --profile compact -o sets
  roughxel vectors bench sets/random_compact.json -o benches
  sh benches/random_compact/run.sh icarus

A testbench prints every field that differs, with set, index, stage, expected and actual value, in hex and
as a number. The earliest stage comes first. SET_device.sv (SET_device.vhd) is the device: replace it with
yours. As written it connects the generated Verilog in rtl; in VHDL it is blank. For a set of one stage
(`vectors export --stage`) the device is the module of that stage.";

#[derive(Args)]
pub(crate) struct BenchArgs {
    /// Directories of sets, or single sets (NAME.json or NAME.hex).
    #[arg(required = true, value_name = "SET")]
    sets: Vec<PathBuf>,
    /// Directory to write to; created if missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Contents of SET_device.sv: the generated Verilog of the set's datapath or stage, effects and profile, or a skeleton with one
    /// line per field.
    #[arg(long, value_enum, default_value = "generated")]
    device: DeviceArg,
    /// Fold the generated design on this many multipliers, as `roughxel verilog` does.
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=1024))]
    multipliers: Option<u32>,
    /// Device for which the generated design is written.
    #[arg(long, default_value = "asic", value_parser = parse_target, value_name = "asic|ice40|ecp5|gowin|xc7")]
    target: Target,
    /// Drive the generated design through its shell, with words of this many bits: registers and words instead of ports.
    #[arg(long, value_name = "BITS", value_parser = clap::value_parser!(u32).range(i64::from(*STREAM_BITS.start())..=i64::from(*STREAM_BITS.end())))]
    stream: Option<u32>,
    /// Overwrite SET_device.sv and SET_device.vhd. Without it, existing ones are kept.
    #[arg(long)]
    replace_device: bool,
    /// Print the summary as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum DeviceArg {
    Generated,
    Blank,
}

pub(super) fn run(args: &BenchArgs) -> Result<(), Failure> {
    check_directory(&args.output)?;
    // Every set is checked before the first testbench is written.
    let mut benches: Vec<Testbench> = Vec::new();
    for path in &args.sets {
        for manifest in manifests_of(path)? {
            let bench = Testbench::new(&manifest)?;
            if benches.iter().any(|known| known.stem() == bench.stem()) {
                let problem = format!("two sets are `{}`; give them different directories with -o", bench.stem());
                return Err(Failure::Usage(problem));
            }
            benches.push(bench);
        }
    }
    let form = HardwareForm { multipliers: args.multipliers, target: args.target, stream: args.stream };
    let is_plain = form == HardwareForm::default();
    let device = match args.device {
        DeviceArg::Generated if is_plain => Device::Generated,
        DeviceArg::Generated => Device::Formed(form),
        DeviceArg::Blank if is_plain => Device::Blank,
        DeviceArg::Blank => {
            let problem = "`--device blank` has no generated design: leave out --multipliers, --target and --stream";
            return Err(Failure::Usage(problem.into()));
        }
    };
    write_files(&args.output, [("README.md", TESTBENCH_README)])?;
    for bench in &benches {
        let directory = args.output.join(bench.stem());
        for kept in bench.write(&directory, device, args.replace_device)? {
            let path = directory.join(kept);
            complain(&format!(
                "note: {} is there and stays as it is (--replace-device writes it again)",
                path.display()
            ));
        }
    }
    let mut out = io::stdout().lock();
    if args.json {
        let list = benches.iter().map(|bench| json!({ "bench": bench.stem(), "count": bench.count() }));
        let directory = args.output.display().to_string();
        writeln!(out, "{:#}", json!({ "directory": directory, "benches": list.collect::<Vec<_>>() }))?;
    } else {
        for bench in &benches {
            let script = args.output.join(bench.stem()).join("run.sh");
            writeln!(out, "{}: {} vectors; sh {} TOOL", bench.stem(), bench.count(), script.display())?;
        }
    }
    Ok(())
}
