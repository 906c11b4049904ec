#!/usr/bin/env bash
# Yosys since 0.64: an unconditional assignment loses against an `if` before it, when both stand inside another `if`.
#
# Expected: of several nonblocking assignments to one register in one block the last one that is executed counts. In
#   `if (a) begin if (b) r <= x; r <= y; end` the register gets y whenever a is 1, and x never.
# Seen: read_verilog of Yosys 0.70 makes `if (a) r <= b ? x : y` of it, as if the two lines were in the other order. Yosys 0.63 is right.
#   The same in an else branch, in a case, for a part of a register and with `<=` in a combinational block. Not concerned: blocks where
#   this is not nested, branches that assigned the register before the inner `if`, and blocking assignments. No warning; synth, prep, sim
#   and formal proofs all start from the same wrong netlist, so they agree with each other.
#   Of 150 registers with random nested assignments, written by Migen, dozens differ from Migen's own simulator, none with Yosys 0.63.
# Versions: pyosys 0.70 (wrong) and 0.63 (right), migen 0.10.0. 0.64, 0.66, 0.68 and 0.69 are wrong too; 0.58 and 0.62 are right.
# Why it matters: "last assignment wins" is how generators such as Migen and LiteX, and translators from VHDL, express priority. The
#   chip does something else than each simulator shows, and a design that worked fails after an update of Yosys.
# Source: IEEE 1800-2017, 4.6 (determinism): nonblocking assignments are performed in the order the statements were executed, with the
#   example of a last assignment that wins; IEEE 1364-2005, 11.4.1, the same. A comment in Yosys's frontends/ast/genrtlil.cc says it about
#   "a = 23; if (b) a = 42; a = 0;": the first two are to be removed. Newer sources skip that when the bits are not in a list of assigned ones.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install migen==0.10.0
for version in 0.63 0.70; do
  nice "$T/v/bin/pip" -q --disable-pip-version-check install --no-deps --target "$T/$version" pyosys==$version
done
cd "$T"
cat > blocks.v <<'V'
module blocks(input clk, input [1:0] c, input [7:0] x, y, output reg [7:0] nested, otherwise, selected, part, comb,
              output reg [7:0] top, before, blocking);
  wire a = c[0], b = c[1];
  always @(posedge clk) if (a) begin if (b) nested <= x; nested <= y; end
  always @(posedge clk) if (!a) otherwise <= 0; else begin if (b) otherwise <= x; otherwise <= y; end
  always @(posedge clk) case (c[0]) 1: begin case (b) 1: selected <= x; endcase selected <= y; end endcase
  always @(posedge clk) if (a) begin if (b) part[3:0] <= x[3:0]; part <= y; end
  always @* begin comb <= 0; if (a) begin if (b) comb <= x; comb <= y; end end
  always @(posedge clk) begin if (b) top <= x; top <= y; end
  always @(posedge clk) if (a) begin before <= 0; if (b) before <= x; before <= y; end
  always @(posedge clk) if (a) begin if (b) blocking = x; blocking = y; end
endmodule
module bench(input clk, input rst, output [7:0] nested, otherwise, selected, part, comb, top, before, blocking);
  reg [7:0] n;
  always @(posedge clk) if (rst) n <= 0; else n <= n + 1;
  blocks b(clk, 2'b11, 8'h33, 8'h77, nested, otherwise, selected, part, comb, top, before, blocking);
endmodule
V
cat > by_migen.py <<'PY'
import json, random
from migen import If, Module, Signal, run_simulation
from migen.fhdl import verilog

def statements(n, register, depth):
    result = []
    for _ in range(random.randint(1, 3)):
        if depth == 3 or depth and random.random() < 0.4:
            result.append(register.eq(random.randint(1, 255)))
        else:
            choice = If(n[random.randrange(3)], *statements(n, register, depth + 1))
            result.append(choice.Else(*statements(n, register, depth + 1)) if random.random() < 0.4 else choice)
    return result

def build():
    random.seed(1)
    design, n = Module(), Signal(4, name="n")
    registers = [Signal(8, name=f"r{i}") for i in range(150)]
    design.sync += n.eq(n + 1)
    for register in registers:
        design.sync += statements(n, register, 0)
    return design, n, registers

design, n, registers = build()
open("migen.v", "w").write(str(verilog.convert(design, {n, *registers})))
design, n, registers = build()
rows = []

def watch():
    for _ in range(12):
        row = {"n": (yield n)}
        for i, register in enumerate(registers):
            row[f"r{i}"] = yield register
        rows.append(row)
        yield

run_simulation(design, watch())
json.dump(rows, open("migen.json", "w"))
PY
nice v/bin/python by_migen.py
cat > by_yosys.py <<'PY'
import json, re, sys
from pyosys import libyosys as ys

def simulate(file, top, clk, rst):
    """The values after each rising edge with the reset off."""
    ys.Design().run_pass(f"tee -q read_verilog {file}; tee -q prep -flatten -top {top}; "
                         f"tee -q sim -q -clock {clk} -reset {rst} -rstlen 2 -n 20 -vcd out.vcd")
    names, now, rows = {}, {}, []
    for line in open("out.vcd"):
        words = line.split()
        if line.startswith("$var"):
            names.setdefault(words[4].split("[")[0], words[3])
        elif line[0] == "b":
            now[words[1]] = words[0][1:]
        elif line[0] in "01xz":
            now[words[0][1:]] = words[0][0]
        if line[0] == "#" and now.get(names[clk]) == "1":
            rows.append({name: int(now[code], 2) if "x" not in now.get(code, "x") else None for name, code in names.items()})
    return rows

design = ys.Design()
design.run_pass("tee -q read_verilog blocks.v; tee -q hierarchy -top blocks; tee -q proc; tee -q opt; tee -q write_verilog -noattr out.v")
text = open("out.v").read()
last = simulate("blocks.v", "bench", "clk", "rst")[-1]
rows = simulate("migen.v", "top", "sys_clk", "sys_rst")
print(json.dumps({"version": text.split("Yosys ")[1].split(" ")[0],
                  "lines": [line.strip() for line in text.split("\n") if re.search("nested <=|assign _", line)],
                  "values": {name: last[name] for name in ("nested", "otherwise", "selected", "part", "comb", "top", "before", "blocking")},
                  "rows": rows}))
PY
cat > compare.py <<'PY'
import json, subprocess, sys

results = {}
for version in ("0.63", "0.70"):
    run = subprocess.run([sys.executable, "by_yosys.py"], env={"PYTHONPATH": version}, capture_output=True, text=True, check=True)
    results[version] = json.loads(run.stdout.splitlines()[-1])
    if "arning" in run.stdout + run.stderr:
        sys.exit("behaviour changed: a warning")
migen = json.load(open("migen.json"))
names = [name for name in migen[0] if name != "n"]
wrong = {}
for version, result in results.items():
    print(f"Yosys {result['version']}: {' '.join(result['lines'])}; then, with a and b 1, x 33, y 77:",
          ", ".join(f"{name} {value:x}" for name, value in result["values"].items()))
    rows = result["rows"]
    start = max(i for i, row in enumerate(rows) if row["n"] == 0 and i < 6)  # the last clock of the reset
    pairs = list(zip(migen, rows[start:]))
    if len(pairs) < 12 or any(a["n"] != b["n"] for a, b in pairs):
        sys.exit("behaviour changed: the clocks of the two simulations")
    wrong[version] = [name for name in names if any(a[name] != b[name] for a, b in pairs)]
    print(f"  random registers of Migen that differ from Migen's simulator: {len(wrong[version])} of {len(names)}")
if set(results["0.63"]["values"].values()) != {0x77} or wrong["0.63"]:
    sys.exit("behaviour changed: Yosys 0.63")
want = dict(results["0.63"]["values"], nested=0x33, otherwise=0x33, selected=0x33, part=0x73, comb=0x33)
if results["0.70"]["values"] != want or len(wrong["0.70"]) < 10:
    sys.exit("behaviour changed: Yosys 0.70")
PY
nice v/bin/python compare.py
echo "as described"
