#!/usr/bin/env bash
# nosis, "correctness-first" synthesis for the ECP5: adders have no carry, |a is a[0], signed products are unsigned.
#
# Expected: a netlist that computes what the Verilog says. The manual puts correctness over optimization, maps ADD to
#   carry chains and sign extension to wires, and has --verify to check equivalence after each pass.
# Seen, with exit status 0 and without a message, also with --verify:
#   1. a + b is a ^ b, so 1 + 1 is 0. In a CCU2C the low four bits of INIT say where a carry begins. nosis writes 0x6666:
#      a ^ b both for the sum and there, and no carry ever begins. Its own simulation model of CCU2C takes the carry from
#      A & B, whatever INIT says; with that model the same netlist is right.
#   2. |a, &a and ^a of 8 bits are a[0]. !a and a && b are wrong too.
#   3. A signed product has SIGNEDA and SIGNEDB tied to 0 and its operands filled up with 0: -1 * -1 is 65025.
#   4. y = a of a signed 4-bit number leaves the upper 4 of 8 bits undriven, and a >>> 2 all of them.
#   5. always @* y = s ? a : b; becomes 8 flip-flops with their clock tied to 0: the output never changes.
#      With always_comb there are none.
#   Right are: a bit by a variable index, unsigned products, signed and unsigned comparisons of equal widths.
# Versions: nosis 0.1.2, pyslang 8.1.0; pyosys 0.70 (cell models of the ECP5; its own synth_ecp5 passes each check here).
# Why it matters: a bump mapper is sums and signed products. The checks that come with the tool look at the stage
#   before the cells, or use a cell that is kinder than the chip's. Nothing later would notice: nextpnr takes a netlist
#   as it is.
# Source: nosis's README, Stage 5 (Technology Mapping) and Design Principles; for CCU2C Yosys's ecp5/ccu2c_sim.vh and
#   lattice/arith_map_ccu2c.v (INIT 0x96AA with D = 1); for the Verilog IEEE 1800-2017, 9.2.2, 10.7, 11.4 and 11.8.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install nosis==0.1.2 pyslang==8.1.0 pyosys==0.70
cd "$T"
nice v/bin/python - <<'PY'
import json, os, re, subprocess, sys
from collections import Counter
from pyosys import libyosys as ys
from nosis.postsynth import generate_cell_models

def yosys(*passes):
    sys.stdout.flush()
    keep, null = os.dup(1), os.open("yosys.log", os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(null, 1)
    try:
        design = ys.Design()
        for command in passes:
            ys.run_pass(command, design)
    finally:
        os.dup2(keep, 1)
        os.close(keep)
        os.close(null)

# MULT18X18D without registers, as the family's guide to its DSP blocks describes it; Yosys has no model of it.
pins = lambda name, n: ", ".join(f"{name}{i}" for i in range(n))
bits = lambda name, n: "{" + ", ".join(f"{name}{i}" for i in reversed(range(n))) + "}"
names = ["REG_INPUTA_CLK", "REG_INPUTB_CLK", "REG_OUTPUT_CLK", "REG_PIPELINE_CLK", "SOURCEB_MODE", "MULT_BYPASS",
                    "GSR", "RESETMODE", "CLK0_DIV", "CLK1_DIV", "CLK2_DIV", "CLK3_DIV", "HIGHSPEED_CLK"]
more = ", ".join(f"CLK{i}, CE{i}, RST{i}" for i in range(4))
with open("mult.v", "w") as f:
    f.write("module MULT18X18D #(" + ", ".join(f'parameter {n} = ""' for n in names) + f""") (
  input {pins("A", 18)}, {pins("B", 18)}, {pins("C", 18)}, {more}, SIGNEDA, SIGNEDB, SOURCEA, SOURCEB, output {pins("P", 36)});
  wire signed [18:0] a = {{SIGNEDA & A17, {bits("A", 18)[1:-1]}}}, b = {{SIGNEDB & B17, {bits("B", 18)[1:-1]}}};
  wire signed [37:0] p = a * b;
  assign {bits("P", 36)} = p[35:0];
endmodule
""")
# The model of CCU2C that nosis brings with it, under the name of the cell.
with open("kind.v", "w") as f:
    f.write(re.search(r"module CCU2C_SIM.*?endmodule", generate_cell_models(), re.S)[0].replace("CCU2C_SIM", "CCU2C"))
CELLS = ["read_verilog -D NO_INCLUDES +/ecp5/common_sim.vh", "read_verilog mult.v"]
CCU2C = "read_verilog +/ecp5/ccu2c_sim.vh"

def same(netlist, ccu2c=CCU2C):
    yosys(*CELLS, ccu2c, f"read_json {netlist}", "hierarchy -top t", "proc", "flatten", "opt_clean", "rename t gate", "design -stash n",
          "read_verilog -sv c.v", "prep -top t", "rename t gold", "design -copy-from n gate", "miter -equiv -flatten gold gate miter",
          "tee -q -o sat.txt sat -prove trigger 0 miter")
    text = open("sat.txt").read()
    if ("SUCCESS!" in text) == ("FAIL!" in text):
        sys.exit("no verdict of Yosys")
    return "SUCCESS!" in text

def nosis(ports, body, *options):
    with open("c.v", "w") as f:
        f.write(f"module t({ports});\n  {body}\nendmodule\n")
    run = subprocess.run(["v/bin/nosis", "c.v", "--top", "t", "-o", "c.json", *options], capture_output=True, text=True)
    if run.returncode:
        sys.exit("behaviour changed: exit status " + str(run.returncode) + run.stderr)
    if re.search("warning|error|not equivalent", run.stdout + run.stderr, re.I):
        sys.exit("behaviour changed: a message: " + run.stdout + run.stderr)
    return json.load(open("c.json"))["modules"]["t"]

cases = [
    ("input [7:0] a, b, output [7:0] y", "assign y = a + b;", False),
    ("input [7:0] a, output y", "assign y = |a;", False),
    ("input [7:0] a, output y", "assign y = &a;", False),
    ("input [7:0] a, output y", "assign y = ^a;", False),
    ("input [7:0] a, output y", "assign y = !a;", False),
    ("input [7:0] a, b, output y", "assign y = a && b;", False),
    ("input signed [7:0] a, b, output signed [15:0] y", "assign y = a * b;", False),
    ("input signed [3:0] a, output signed [7:0] y", "assign y = a;", False),
    ("input signed [7:0] a, output signed [7:0] y", "assign y = a >>> 2;", False),
    ("input [7:0] a, b, output [15:0] y", "assign y = a * b;", True),
    ("input signed [7:0] a, b, output y", "assign y = a < b;", True),
    ("input [7:0] a, b, output y", "assign y = a < b;", True),
    ("input [7:0] a, input [2:0] s, output y", "assign y = a[s];", True)]
net = {}
for ports, body, right in cases:
    for options in ((), ("--verify",)):
        net[ports, body] = nosis(ports, body, *options)
        if same("c.json") != right:
            sys.exit("behaviour changed: " + body + f" ({ports})")
    yosys("read_verilog -sv c.v", "synth_ecp5 -top t -json control.json")
    control = json.load(open("control.json"))
    control["modules"] = {"t": control["modules"]["t"]}
    json.dump(control, open("control.json", "w"))
    if not same("control.json"):
        sys.exit("the control fails: synth_ecp5, " + body)
    cells = dict(Counter(c["type"] for c in net[ports, body]["cells"].values()))
    print(f"{body:20}" + ("right" if right else "WRONG") + f"  {cells or 'wires only'}   ({ports})")

def wires(key):
    ports = net[cases[key][:2]]["ports"]
    driven = set(ports["a"]["bits"]) | {"0", "1"}
    return [ports["a"]["bits"].index(b) if b in ports["a"]["bits"] else "undriven" if b not in driven else b
            for b in ports["y"]["bits"]]
reduced = [wires(k) for k in (1, 2, 3)]
print(f"|a, &a, ^a: the output is the bit of a with the number {reduced}; y = a: {wires(7)}; a >>> 2: {wires(8)}")
if reduced != [[0]] * 3 or wires(7) != [0, 1, 2, 3] + ["undriven"] * 4 or wires(8) != ["undriven"] * 8:
    sys.exit("behaviour changed: wires")

mul = next(iter(net[cases[6][:2]]["cells"].values()))["connections"]
product = 0xff * 0xff
print(f"signed product: SIGNEDA {mul['SIGNEDA']}, A8 to A17 {sorted({mul[f'A{i}'][0] for i in range(8, 18)})}: -1 * -1 is {product}")
if mul["SIGNEDA"] != ["0"] or mul["SIGNEDB"] != ["0"] or any(mul[f"{p}{i}"] != ["0"] for p in "AB" for i in range(8, 18)):
    sys.exit("behaviour changed: the signed product")

# One cell of the adder by hand: sum = lut ^ carry in, carry out = lut ? carry in : low four bits of INIT at (B, A).
nosis(*cases[0][:2])
inits = {c["parameters"]["INIT0"] for c in json.load(open("c.json"))["modules"]["t"]["cells"].values()}
init = int(inits.pop(), 2)
def adder(a, b):
    carry, out = 0, 0
    for i in range(8):
        index = (b >> i & 1) * 2 + (a >> i & 1)
        lut = init >> index & 1
        out |= (lut ^ carry) << i
        carry = carry if lut else init >> index & 1
    return out
print(f"adder, INIT 0x{init:04x}: 1 + 1 = {adder(1, 1)}, 3 + 1 = {adder(3, 1)}, 200 + 100 = {adder(200, 100)}, "
      f"pairs of bytes with the right sum: {sum(adder(a, b) == (a + b) % 256 for a in range(256) for b in range(256))} of 65536")
if inits or init != 0x6666 or adder(1, 1) != 0 or any(adder(a, b) != a ^ b for a in range(256) for b in range(256)):
    sys.exit("behaviour changed: the adder")
kind = same("c.json", "read_verilog kind.v")
print("the same adder with nosis's own model of CCU2C:", "right" if kind else "WRONG")
if not kind:
    sys.exit("behaviour changed: nosis's own model")

ports = "input [7:0] a, b, input s, output reg [7:0] y"
comb = nosis(ports, "always_comb y = s ? a : b;") and same("c.json")
print("always_comb y = s ? a : b;", "right" if comb else "WRONG")
cells = nosis(ports, "always @* y = s ? a : b;")["cells"].values()
flip = [c["connections"]["CLK"] for c in cells if c["type"] == "TRELLIS_FF"]
print(f"always @* y = s ? a : b; WRONG {dict(Counter(c['type'] for c in cells))}, clock of the flip-flops: {flip[:1]}")
if not comb or flip != [["0"]] * 8:
    sys.exit("behaviour changed: always @*")
PY
echo "as described"
