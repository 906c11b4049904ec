#!/usr/bin/env bash
# synth_ice40 -dsp loses one of three registered products that are added, and says nothing.
#
# Expected: three products in registers without an enable, and their sum, become
#   three SB_MAC16 with the adder beside them, or two with the third product added.
# Seen: two SB_MAC16. Each takes a product and its register, one also an adder; the
#   operand of that adder is the third product, whose multiplier is gone: ports C
#   and D of the block are undefined. The netlist gives x where the source gives
#   313. Exit status 0, no warning. With (* keep *) on the registers, or with an
#   enable, there are three blocks and the sum is right.
# Versions: Yosys 0.70 (pyosys 0.70 from PyPI); the same with Yosys 0.23 of Debian 12.
# Why it matters: a pipelined dot product is the heart of a graphics datapath.
#   Its register has an enable until somebody ties the ready input of the pipeline
#   to 1; then one multiplier of each dot product of three disappears, and a
#   simulation of the source cannot show it.
# Source: `yosys help synth_ice40` promises for -dsp "use iCE40 UltraPlus DSP cells
#   for large arithmetic".
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install pyosys==0.70
cd "$T"
for kind in plain kept; do
    keep=""
    [ "$kind" = kept ] && keep="(* keep *)"
    cat > "$kind.v" <<V
module dot(input clk, input signed [15:0] a, b, c, d, e, f, output signed [33:0] y);
  $keep reg signed [31:0] p, q, r;
  always @(posedge clk) begin p <= a * b; q <= c * d; r <= e * f; end
  assign y = p + q + r;
endmodule
V
done
cat > top.v <<'V'
module top(input clk, output signed [33:0] y);
  dot u(.clk(clk), .a(16'sd3), .b(16'sd5), .c(16'sd7), .d(16'sd11), .e(16'sd13), .f(16'sd17), .y(y));
endmodule
V
nice v/bin/python - <<'PY' > log.txt
import os, re, sys
import pyosys
from pyosys import libyosys as yosys

models = os.path.join(os.path.dirname(pyosys.__file__), "share", "ice40", "cells_sim.v")

def passes(files, *commands):
    design = yosys.Design()
    for name in files:
        yosys.run_pass(f"read_verilog -D NO_ICE40_DEFAULT_ASSIGNMENTS {name}", design)
    for command in commands:
        yosys.run_pass(command, design)

def value(files, name):
    passes(files, "hierarchy -top top", "proc", "flatten", "opt_clean", f"sim -clock clk -n 8 -vcd {name}.vcd")
    text = open(f"{name}.vcd").read()
    wire = re.search(r"\$var wire 34 (\S+) y", text).group(1)
    return re.findall(rf"^b(\S+) {re.escape(wire)}$", text, re.M)[-1]

results = open("results.txt", "w")
for kind in ["plain", "kept"]:
    source = value([f"{kind}.v", "top.v"], f"{kind}_source")
    passes([f"{kind}.v"], "synth_ice40 -dsp -top dot", f"tee -o {kind}.stat stat", f"write_verilog -noattr {kind}_net.v")
    blocks = re.search(r"(\d+)\s+SB_MAC16|SB_MAC16\s+(\d+)", open(f"{kind}.stat").read())
    net = value([f"{kind}_net.v", "top.v", models], f"{kind}_net")
    print(kind, "blocks", blocks.group(1) or blocks.group(2), "source", int(source, 2), "netlist", "x" if "x" in net else int(net, 2), file=results)
PY
cat results.txt
printf 'plain blocks 2 source 313 netlist x\nkept blocks 3 source 313 netlist 313\n' | diff - results.txt || { echo "behaviour changed"; exit 1; }
echo "as described"
