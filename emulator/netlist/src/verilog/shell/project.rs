//! Project files: constraints of the clock, and a core for FuseSoC.

use super::description::Shell;

/// Lines of a YAML list of files.
fn list(files: &[&str]) -> String {
    files.iter().map(|file| format!("      - {file}\n")).collect()
}

/// Constraints of the clock, name and text: SDC, LPF for ECP5, XDC for AMD. No path is false, for there is one clock.
pub(super) fn constraints(shell: &Shell) -> [(String, String); 3] {
    let (design, frequency) = (&shell.design.module, shell.clock_mhz);
    let period = 1000.0 / frequency;
    let about = format!("# {}: one clock of {frequency} MHz, no false paths.\n", shell.module);
    let clock = format!("create_clock -name aclk -period {period:.3} [get_ports {{aclk}}]\n");
    let lpf = format!("FREQUENCY PORT \"aclk\" {frequency} MHZ;\n");
    [
        (format!("{design}.sdc"), about.clone() + &clock),
        (format!("{design}.lpf"), about.clone() + &lpf),
        (format!("{design}.xdc"), about + &clock),
    ]
}

/// CAPI2 core with targets `lint`, `sim` and `synth`.
pub(super) fn core(shell: &Shell, sources: &[&str]) -> String {
    let (design, top) = (&shell.design.module, &shell.module);
    format!(
        "CAPI=2:

name: roughxel:generated:{design}:{version}
description: \"{origin}\"

filesets:
  rtl:
    files:
{sources}    file_type: verilogSource
  bench:
    files:
      - {bfm}.v
      - bench/{bfm}_flat.v
      - bench/bench.v
      - bench/bench.vh: {{is_include_file: true}}
    file_type: verilogSource
  vectors:
    files:
      - bench/inputs.hex: {{copyto: inputs.hex}}
      - bench/expected.hex: {{copyto: expected.hex}}
    file_type: user
  ecp5:
    files:
      - {design}.lpf
    file_type: LPF

targets:
  default: &default
    filesets: [rtl]
    toplevel: {top}
  lint:
    <<: *default
    flow: lint
    flow_options:
      tool: verilator
      verilator_options: [-Wall]
  sim:
    flow: sim
    flow_options:
      tool: icarus
      iverilog_options: [-g2005, -DEXIT_CODE]
    filesets: [rtl, bench, vectors]
    toplevel: bench
    parameters: [stalls=true]
  synth:
    flow: trellis
    flow_options:
      nextpnr_options: [--25k, --package, CABGA381, --lpf-allow-unconstrained, --timing-allow-fail]
    filesets: [rtl, ecp5]
    toplevel: {top}

parameters:
  stalls:
    datatype: bool
    paramtype: plusarg
    description: Words have random gaps
",
        version = shell.version,
        origin = shell.origin,
        sources = list(sources),
        bfm = shell.bfm,
    )
}
