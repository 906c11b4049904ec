#!/usr/bin/env bash
# Yosys: with -nobram five of seven FPGA commands still make block memories, if a memory has the attribute ram_style.
#
# Expected: -nobram gives a netlist without block memories. The help texts say so without a condition: "do not use block RAM cells in
#   output netlist", or the names of the cells. Two commands, synth_intel_alm and synth_gatemate, do it.
# Seen: a memory of 512 words of 18 bits with (* ram_style = "block" *) becomes a block memory in the five others, with exit status 0 and
#   without a warning; the log has a line "forced mapping to block RAM". A table with rom_style is the same. Without the attribute all seven
#   keep the promise. -nolutram is the same: with (* ram_style = "distributed" *) a Gowin netlist has lookup tables as memory. By hand, too,
#   for the time it takes: synth_xilinx, synth_anlogic, synth_nanoxplore and synth_microchip make block memories.
# Versions: pyosys 0.70.
# Why it matters: the option is given where a block memory cannot be used: there is no model of it for a simulation of the netlist, or a part of
#   the device is reserved. Yosys declares some of these cells without a content, so the simulation runs, and what they give is undefined.
# Source: Yosys, help of synth_gowin, synth_ice40, synth_nexus and the others, option -nobram and -nolutram.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install pyosys==0.70
cd "$T"
nice v/bin/python - <<'PY'
import os, re, sys
from pyosys import libyosys as ys

RING = """module top(input clk, write, input [8:0] to, from, input [17:0] in, output reg [17:0] out);
  %s reg [17:0] memory [0:511];
  always @(posedge clk) begin if (write) memory[to] <= in; out <= memory[from]; end
endmodule"""
TABLE = """module top(input clk, input [8:0] from, output reg [17:0] out);
  %s reg [17:0] memory [0:511];
  integer i;
  initial for (i = 0; i < 512; i = i + 1) memory[i] = 731 * i;
  always @(posedge clk) out <= memory[from];
endmodule"""
COMMANDS = {"gowin": "DPX9B|SPX9|SDPX9B", "ecp5": "DP16KD", "ice40": "SB_RAM40_4K", "nexus": "PDPSC16K",
            "efinix": "EFX_RAM_5K", "intel_alm": "MISTRAL_M10K", "gatemate": "CC_BRAM"}
KEEP = {"intel_alm", "gatemate"}


def netlist(text, command):
    with open("t.v", "w") as f:
        f.write(text)
    sys.stdout.flush()
    out, null = os.dup(1), os.open("yosys.log", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(null, 1)
    try:
        design = ys.Design()
        for step in ("read_verilog t.v", "synth_" + command + " -top top", "write_verilog -noattr o.v"):
            ys.run_pass(step, design)
    finally:
        os.dup2(out, 1)
        os.close(out)
        os.close(null)
    with open("yosys.log") as f:
        log = f.read()
    with open("o.v") as f:
        return set(re.findall(r"^  ([A-Za-z]\w*) (?:#\(|_|\\)", f.read(), re.M)), log


def check(what, is_right):
    if not is_right:
        print("behaviour changed:", what)
        sys.exit(1)


def blocks(found, cells):
    return sorted(cell for cell in found if re.fullmatch(f"(?:{cells})\\w*", cell))


for command, cells in COMMANDS.items():
    plain, _ = netlist(RING % "", command + " -nobram")
    styled, log = netlist(RING % '(* ram_style = "block" *)', command + " -nobram")
    check(f"{command} without the attribute: {plain}", not blocks(plain, cells))
    check(f"{command}: {styled}", bool(blocks(styled, cells)) == (command not in KEEP))
    check(f"{command}: a warning about the option", "nobram" not in "".join(re.findall("Warning.*", log)))
    print(f"synth_{command} -nobram, ram_style = block: {', '.join(blocks(styled, cells)) or 'none'}", flush=True)
styled, _ = netlist(TABLE % '(* rom_style = "block" *)', "ice40 -nobram")
check(f"table: {styled}", blocks(styled, "SB_RAM40_4K"))
print("synth_ice40 -nobram, rom_style = block: SB_RAM40_4K")
for command, cell in (("gowin", "RAM16SDP4"),):
    option = "-nobram -nolutram"
    styled, _ = netlist(RING % '(* ram_style = "distributed" *)', f"{command} {option}")
    check(f"{command} {option}: {styled}", cell in styled)
    print(f"synth_{command} {option}, ram_style = distributed: {cell}", flush=True)
PY
