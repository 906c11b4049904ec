#!/usr/bin/env bash
# Veriloggen's fixed-point types: 1.5 times 2 is 0, 3 divided by 2 is 1, and 1 < 2 is false.
#
# Expected: a generator with fixed-point variables of width 32 and point 16 writes Verilog whose
#   product, quotient and comparison are those of the numbers, apart from the last bit.
# Seen: the product is "a * b >>> 16" in an output of 32 bits. Verilog multiplies at the width of
#   the output, so the upper half is gone before the shift: every product of 0.5 or more is wrong.
#   The quotient is divided first and shifted left afterwards, so it has no fraction. The result of a
#   comparison counts as a number with 16 fraction bits, and is shifted right by 16 on its way to an
#   ordinary one-bit output: it is constant 0. In a clocked block these three are the same; assign()
#   besides aligns twice: a wire of point 8 gets 256 times the number of point 16. No message.
#   Sums and differences are right, and so is the product in an output of 48 bits.
# Versions: veriloggen 2.3.0, pyverilog 1.3.0, pyosys 0.70 (it evaluates the generated Verilog).
# Why it matters: these types stand for a datapath without alignment by hand. The Verilog is legal,
#   and a test of products below 0.5 passes.
# Source: veriloggen.types.fixed (the README does not name these types); IEEE 1364-2005, 5.4.1 and table
#   5-22: the operands of * have the width of the assignment, the result of < has one bit.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install veriloggen==2.3.0 pyverilog==1.3.0 pyosys==0.70
cd "$T"
cat > fixed_point.py <<'PY'
import re, sys
from veriloggen import Module, Posedge
from veriloggen.types import fixed
import pyosys.libyosys as ys

WIDTH, POINT = 32, 16
m = Module("unit")
clock = m.Input("clock")
a, b = (fixed.FixedInput(m, name, WIDTH, POINT) for name in "ab")
for name, value in {"product": a * b, "quotient": a / b, "sum": a + b, "difference": a - b}.items():
    fixed.FixedOutput(m, name, WIDTH, POINT).assign(value)
fixed.FixedOutput(m, "wide", 48, POINT).assign(a * b)
fixed.FixedOutput(m, "narrow", 24, 8).assign(a)
m.Output("less").assign(a < b)
product, quotient = (fixed.FixedOutputReg(m, "clocked_" + n, WIDTH, POINT) for n in ("product", "quotient"))
narrow, less = fixed.FixedOutputReg(m, "clocked_narrow", 24, 8), m.OutputReg("clocked_less")
m.Always(Posedge(clock))(product(a * b), quotient(a / b), narrow(a), less(a < b))
text = m.to_verilog()
open("unit.v", "w").write(text)
lines = {n: re.search(rf"\b{n} <?= (.*);", text).group(1) for n in
         ("product", "quotient", "less", "narrow", "clocked_product", "clocked_quotient", "clocked_less", "clocked_narrow")}
for name, line in lines.items():
    print(f"{name} = {line if len(line) < 60 else line[:28] + ' ... ' + line[-22:]}")

pairs = [(1.5, 2.0), (3.0, 2.0), (1.0, 2.0), (-1.5, 0.5), (0.25, 0.5), (0.25, 0.125)]
shown = ("product", "wide", "quotient", "sum", "difference", "narrow", "less")
script = "read_verilog unit.v\nhierarchy -top unit\nproc\n"
for i, (x, y) in enumerate(pairs):
    sets = " ".join(f"-set {n} 32'd{int(v * 65536) & 0xFFFFFFFF}" for n, v in (("a", x), ("b", y)))
    script += f"tee -q -o eval{i}.txt eval {sets} {' '.join('-show ' + n for n in shown)} unit\n"
open("run.ys", "w").write(script)
ys.run_pass("tee -q -o log.txt script run.ys", ys.Design())
print()

def value(log, name):
    # Yosys writes short 32-bit numbers in decimal and all others as WIDTH'BITS.
    bits, decimal = re.search(rf"\\{name} = (?:\d+'([01]+)|(\d+))\.", log).groups()
    number = int(decimal) if decimal else int(bits, 2) - (1 << len(bits) if bits[0] == "1" and len(bits) > 1 else 0)
    return number / {"narrow": 256, "less": 1}.get(name, 65536)

wrong = dict.fromkeys(shown, 0)
for i, (x, y) in enumerate(pairs):
    log = open(f"eval{i}.txt").read()
    got = {n: value(log, n) for n in shown}
    want = {"product": x * y, "wide": x * y, "quotient": x / y, "sum": x + y, "difference": x - y, "narrow": x, "less": int(x < y)}
    print(f"{x:g} and {y:g}: " + ", ".join(f"{n} {got[n]:g}" + ("" if got[n] == want[n] else f" (not {want[n]:g})") for n in shown))
    for n in shown:
        wrong[n] += got[n] != want[n]
print(f"wrong, of {len(pairs)}: " + ", ".join(f"{n} {w}" for n, w in wrong.items()))
if any(lines["clocked_" + n] != lines[n] for n in ("product", "quotient", "less")) or lines["clocked_narrow"] != "a >>> 8":
    sys.exit("behaviour changed: clocked and continuous assignments relate differently")
if wrong != {"product": 4, "wide": 0, "quotient": 4, "sum": 0, "difference": 0, "narrow": 6, "less": 4}:
    sys.exit("behaviour changed: some operations are wrong that were right, or the other way round")
PY
nice v/bin/python -W ignore fixed_point.py
echo "as described"
