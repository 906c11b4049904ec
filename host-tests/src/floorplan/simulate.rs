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
use crate::simulators::hdl;

/// Models of blocks that Yosys lacks.
pub const MODELS: &str = include_str!("models.v");

/// Pass that gives the memory blocks of ECP5 the name of their model. Yosys declares them as well, without a content.
pub const OWN_MEMORIES: &str = "chtype -set ecp5_memory t:DP16KD";

/// File of models that families of Lattice share.
const COMMON: &str = "common_sim.vh";

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
        Ok(hash(&[&text.hash, command(self.cell.target)?, &yosys.version, &self.name(), MODELS]))
    }
}

/// Command that synthesises without cells of pins, and without memory blocks of which there is no model.
fn command(target: Target) -> Result<&'static str, String> {
    match target {
        Target::Asic => Err("nothing is synthesised for gates".to_owned()),
        Target::Ice40 => Ok("synth_ice40 -dsp"),
        Target::Ecp5 => Ok("synth_ecp5"),
        Target::Gowin => Ok("synth_gowin -family gw2a -noiopads -nobram"),
        Target::Xc7 => Ok("synth_xilinx -family xc7 -flatten -noiopad -noclkbuf -nobram"),
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

/// Synthesises a design in a folder, and runs its netlist on about `count` vectors in Icarus. A mismatch is a result.
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
    passes.push(format!("{} -top {top}", command(variant.cell.target)?));
    // One module takes the place of the sources.
    passes.push(format!("rename -top {module}"));
    // A delay line is a vector that is assigned from itself. Icarus 11 would evaluate all of it for each of its bits. It aborts on some netlists
    // of which every vector is split.
    passes.extend(["splitnets */w:*.line", "clean -purge"].map(str::to_owned));
    passes.extend([OWN_MEMORIES, "write_verilog -noattr netlist.v"].map(str::to_owned));
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
    let report = icarus(yosys, variant, module, folder)?;
    let mismatch = (!report.contains("PASS") || report.contains("FAIL"))
        .then(|| report.lines().next().unwrap_or("the testbench prints nothing").to_owned());
    let tools = format!("{}, {}", yosys.version, icarus_version()?);
    Ok(Simulation { key: variant.key(yosys, &text)?, tools, vectors: inputs.len() as u32, mismatch })
}

/// Output of the testbench.
fn icarus(yosys: &Yosys, variant: &Variant, module: &str, folder: &Path) -> Result<String, String> {
    let target = variant.cell.target;
    let share = yosys.share.join(models(target));
    // Icarus has `$error` among statements only. The copy comes first among the folders of includes, but not for Yosys.
    let copies = folder.join("models");
    fs::create_dir_all(&copies).map_err(|e| format!("{}: {e}", copies.display()))?;
    if let Ok(common) = fs::read_to_string(share.join(COMMON)) {
        write(&copies.join(COMMON), &common.replace("\t$error(", "\tinitial $error("))?;
    }
    let mut compile = Command::new("iverilog");
    // Models of iCE40 have inputs with default values, which the language of the testbench lacks.
    compile.args(["-g2012", "-s", "bench", "-DNO_ICE40_DEFAULT_ASSIGNMENTS", "-DNO_INCLUDES", "-o", "bench.vvp"]);
    compile.args(["-I", "models", "-I", ".", "-I"]).arg(&share).arg(hdl("bench.v"));
    compile.args([&format!("{module}_flat.v"), "netlist.v"]).arg(share.join("cells_sim.v"));
    if matches!(target, Target::Ecp5 | Target::Gowin) {
        compile.arg("models.v");
    }
    output(compile.current_dir(folder))?;
    let mut run = Command::new("vvp");
    run.args(["-N", "bench.vvp"]).args((!variant.is_tied).then_some("+stalls"));
    output(run.current_dir(folder))
}

fn icarus_version() -> Result<String, String> {
    let text = output(Command::new("iverilog").arg("-V"))?;
    Ok(text.lines().next().unwrap_or_default().split(" (").next().unwrap_or_default().trim().to_owned())
}

/// Output of a program that ends well.
fn output(command: &mut Command) -> Result<String, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command.output().map_err(|e| format!("{name}: {e}. Install the package iverilog of your system"))?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    if output.status.success() {
        return Ok(text(&output.stdout));
    }
    let errors = text(&output.stderr);
    Err(format!("{name} fails: {}", errors.lines().next().unwrap_or_default()))
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
