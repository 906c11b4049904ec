//! Netlists in a simulator: what Yosys makes of a design, on the vectors of its source.

use std::fs;
use std::path::Path;
use std::process::Command;

use roughxel_core::design::Design;
use roughxel_netlist::bench::Bench;
use roughxel_netlist::target::Target;
use roughxel_netlist::verilog::{Interface, PortDescription};
use roughxel_record as record;
use roughxel_utilities::output::write_files;

use super::cell::{Cell, Text, hash};
use super::results::Simulation;
use super::yosys::{Yosys, write_text};
use crate::designs::{expected, inputs};
use crate::simulators::verilator;

/// Models of blocks that Yosys lacks.
pub const MODELS: &str = include_str!("models.v");

/// Pass that gives the memory blocks of ECP5 the name of their model. Yosys declares them as well, without a content.
pub const OWN_MEMORIES: &str = "chtype -set ecp5_memory t:DP16KD";

/// A netlist to simulate.
#[derive(Clone, Debug)]
pub struct Variant {
    /// The design.
    pub cell: Cell,
    /// True if `out_ready` is 1 in the netlist, so that registers have no enable.
    pub is_tied: bool,
}

impl Variant {
    /// Key in the results.
    pub fn name(&self) -> String {
        format!("{}-{}", self.cell, if self.is_tied { "always-ready" } else { "stalls" })
    }

    /// Hash of everything that makes the netlist.
    ///
    /// Errors: the cell has no text, or its target is no device.
    pub fn key(&self, yosys: &Yosys, text: &Text) -> Result<String, String> {
        let passes = synthesis(self.cell.target)?.join(" ");
        Ok(hash(&[&text.hash, &passes, &yosys.version, &self.name(), MODELS]))
    }
}

/// Passes that synthesise without cells of pins, and without memory blocks of which there is no model; the last one takes the top. A memory must not ask
/// for a block either: Yosys follows its attribute in spite of `-nobram`.
fn synthesis(target: Target) -> Result<&'static [&'static str], String> {
    const NO_BLOCKS: &str = "setattr -unset ram_style -unset rom_style m:*";
    match target {
        Target::Asic => Err("nothing is synthesised for gates".to_owned()),
        Target::Ice40 => Ok(&["synth_ice40 -dsp"]),
        Target::Ecp5 => Ok(&["synth_ecp5"]),
        Target::Gowin => Ok(&[NO_BLOCKS, "synth_gowin -family gw2a -noiopads -nobram"]),
        Target::Xc7 => Ok(&[NO_BLOCKS, "synth_xilinx -family xc7 -flatten -noiopad -noclkbuf -nobram"]),
    }
}

/// Folder of the family's models below Yosys's share.
const fn models(target: Target) -> &'static str {
    match target {
        Target::Ice40 => "ice40",
        Target::Ecp5 => "ecp5",
        Target::Gowin => "gowin",
        Target::Asic | Target::Xc7 => "xilinx",
    }
}

/// Synthesises a design in a folder, and runs its netlist on about `count` vectors in Verilator. A mismatch is a result.
///
/// Errors: a tool is missing or fails.
pub fn simulate(yosys: &Yosys, variant: &Variant, count: usize, folder: &Path) -> Result<Simulation, String> {
    let text = variant.cell.text(None)?;
    let module = &text.interface.module;
    write_text(folder, text.files.iter())?;
    let top = if variant.is_tied { "tied" } else { module };
    let mut passes: Vec<String> = text.files.keys().map(|name| format!("read_verilog -defer {name}")).collect();
    if variant.is_tied {
        write(&folder.join("tied.v"), &tied(&text.interface))?;
        passes.push("read_verilog tied.v".to_owned());
    }
    passes.push(format!("hierarchy -top {top}"));
    passes.extend(synthesis(variant.cell.target)?.iter().map(|&pass| pass.to_owned()));
    if let Some(last) = passes.last_mut() {
        *last += &format!(" -top {top}");
    }
    // One module takes the place of the sources.
    passes.push(format!("rename -top {module}"));
    // A delay line is a vector that is assigned from itself. A simulator would evaluate all of it for each of its bits.
    passes.extend(["splitnets", "clean -purge", OWN_MEMORIES, "write_verilog -noattr netlist.v"].map(str::to_owned));
    yosys.run(folder, &passes)?;

    let options = variant.cell.options(None)?;
    let (effects, p) = (&options.effects, &options.precision);
    let net = record::net(Design::Reflection, effects, p);
    let all = inputs(Design::Reflection, &net, count, effects, p);
    let step = all.len().div_ceil(count.max(1)).max(1);
    let inputs: Vec<_> = all.into_iter().step_by(step).collect();
    let outputs: Vec<_> = inputs.iter().map(|ports| expected(Design::Reflection, ports, effects, p)).collect();
    let bench = Bench::new(&text.interface, &inputs, &outputs).map_err(|e| e.to_string())?;
    write_files(folder, bench.files()).map_err(|e| format!("{}: {e}", folder.display()))?;
    write(&folder.join("models.v"), MODELS)?;
    let report = run_netlist(yosys, variant, module, folder)?;
    let mismatch = (!report.starts_with("PASS")).then(|| report.lines().next().unwrap_or_default().to_owned());
    let tools = format!("{}, {}", yosys.version, verilator_version()?);
    Ok(Simulation { key: variant.key(yosys, &text)?, tools, vectors: inputs.len() as u32, mismatch })
}

/// Runs the netlist in a folder of [`simulate`], and returns the output of the testbench: the first word is `PASS`, or the first line names the mismatch.
///
/// Verilator knows 0 and 1 only. What would be x is 0 in a first run, 1 in a second, and a drawn bit in a third. An output that is x is wrong in the first
/// or in the second.
///
/// Errors: Verilator or the compiler is missing or fails.
pub fn run_netlist(yosys: &Yosys, variant: &Variant, module: &str, folder: &Path) -> Result<String, String> {
    let target = variant.cell.target;
    let share = yosys.share.join(models(target));
    let (mut build, program) = verilator(folder, module, "OPT_FAST=-O0 VM_PARALLEL_BUILDS=0");
    build.args(["--x-assign", "unique", "--x-initial", "unique", "-Wno-fatal", "-Wno-lint", "-Wno-UNOPTFLAT"]);
    // Models of iCE40 have inputs with default values.
    build.args(["-DNO_ICE40_DEFAULT_ASSIGNMENTS", "-DNO_INCLUDES"]).arg(format!("-I{}", share.display()));
    build.arg(folder.join("netlist.v")).arg(share.join("cells_sim.v"));
    if matches!(target, Target::Ecp5 | Target::Gowin) {
        build.arg(folder.join("models.v"));
    }
    output(&mut build, &[0])?;
    let mut report = String::new();
    for undefined in 0..3 {
        let mut run = Command::new(&program);
        run.arg(folder).arg(if variant.is_tied { "1" } else { "stalls" });
        run.arg(format!("+verilator+rand+reset+{undefined}")).arg("+verilator+seed+1");
        // 3: a mismatch.
        report = output(&mut run, &[0, 3])?;
        if !report.starts_with("PASS") {
            break;
        }
    }
    Ok(report)
}

fn verilator_version() -> Result<String, String> {
    let text = output(Command::new("verilator").arg("--version"), &[0])?;
    Ok(text.split(' ').take(2).collect::<Vec<_>>().join(" "))
}

/// Output of a program that ends with one of these exit codes.
fn output(command: &mut Command, good: &[i32]) -> Result<String, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command.output().map_err(|e| format!("{name}: {e}. Install the package verilator of your system"))?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    if output.status.code().is_some_and(|code| good.contains(&code)) {
        return Ok(text(&output.stdout));
    }
    let errors = text(&output.stderr);
    let first = errors.lines().find(|line| line.contains("rror")).or(errors.lines().next());
    Err(format!("{name} fails: {}", first.unwrap_or_default()))
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))
}

/// Module with the ports of a design, in which the receiver is always ready.
fn tied(interface: &Interface) -> String {
    let Interface { module, inputs, outputs, .. } = interface;
    let declare = |direction: &str, ports: &[PortDescription]| -> String {
        ports.iter().map(|port| format!(", {direction} [{}:0] {}", port.width - 1, port.port)).collect()
    };
    let connections = inputs.iter().chain(outputs).map(|port| format!(", .{0}({0})", port.port));
    format!(
        "module tied (input clk, input rst, input in_valid, output in_ready, output out_valid, input out_ready{}{});\n  \
         {module} u (.clk(clk), .rst(rst), .in_valid(in_valid), .in_ready(in_ready), .out_valid(out_valid), .out_ready(1'b1){});\nendmodule\n",
        declare("input", inputs),
        declare("output", outputs),
        connections.collect::<String>()
    )
}
