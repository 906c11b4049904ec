#!/usr/bin/env bash
# MyHDL's // and % mean three different things in Python, Verilog and VHDL.
#
# Expected: MyHDL converts a block that has been simulated; the Verilog and the
#   VHDL compute what the simulation showed.
# Seen: // and % of signed signals become the operators that look alike.
#   Python's // rounds down; Verilog's / and VHDL's / round towards zero.
#   Python's % has the sign of the divisor, as VHDL's mod, but Verilog's % has
#   the sign of the dividend. For -7 and 2 the simulation gives -4 and 1, the
#   Verilog -3 and -1. In the VHDL the pair does not even belong together:
#   "/" with "mod" is -3 and 1, and 2 * -3 + 1 is not -7. No warning. "a // 2"
#   differs too, so it is no longer the shift that one may have meant.
# Versions: MyHDL 0.11.52; Yosys 0.70 (pyosys) computes the Verilog.
# Why it matters: scaling signed normals and slopes is division by a constant.
#   The error is one unit, only for negative values that do not divide evenly,
#   so it looks like a rounding detail and not like a wrong operator.
# Source: IEEE 1364-2005, 5.1.5; IEEE 1076-2008, 9.2.7; Python reference, 6.7.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install myhdl==0.11.52 pyosys==0.70
cd "$T"
cat > divmod.py <<'PY'
import re, sys
from myhdl import Signal, StopSimulation, always_comb, block, delay, instance, intbv

CASES = [(-7, 2), (7, -2), (-7, -2), (7, 2)]
narrow = lambda: Signal(intbv(0, min=-128, max=128))
wide = lambda: Signal(intbv(0, min=-256, max=256))

@block
def div_mod(a, b, q, r, half):
    @always_comb
    def logic():
        q.next = a // b
        r.next = a % b
        half.next = a // 2
    return logic

a, b = narrow(), Signal(intbv(1, min=-128, max=128))
q, r, half = wide(), wide(), wide()
seen = []

@block
def bench():
    dut = div_mod(a, b, q, r, half)
    @instance
    def drive():
        for x, y in CASES:
            a.next, b.next = x, y
            yield delay(1)
            seen.append((int(q), int(r), int(half)))
        raise StopSimulation
    return dut, drive

bench().run_sim(quiet=1)
unit = div_mod(a, b, q, r, half)
unit.convert(hdl="Verilog")
unit.convert(hdl="VHDL")
vhdl = re.findall(r"^(?:q|r|half) <= .*$", open("div_mod.vhd").read(), re.M)
print("VHDL:", *vhdl, sep="\n  ")

import pyosys.libyosys as ys
d = ys.Design()
script = "read_verilog div_mod.v\nhierarchy -top div_mod\nproc\n"
for i, (x, y) in enumerate(CASES):
    script += f"tee -q -o eval{i}.txt eval -set a 8'd{x & 255} -set b 8'd{y & 255} -show q -show r -show half div_mod\n"
open("run.ys", "w").write(script)
ys.run_pass("tee -q -o log.txt script run.ys", d)

def signed9(bits):
    v = int(bits, 2)
    return v - 512 if v & 256 else v

verilog = []
for i in range(len(CASES)):
    t = open(f"eval{i}.txt").read()
    verilog.append(tuple(signed9(re.search(rf"\\{n} = 9'([01]+)", t).group(1)) for n in ("q", "r", "half")))
for c, s, v in zip(CASES, seen, verilog):
    print(f"a, b = {c}: simulation // % a//2 = {s}, Verilog = {v}{'' if s == v else '   <- differ'}")
ok = (seen == [(-4, 1, -4), (-4, -1, 3), (3, -1, -4), (3, 1, 3)]
      and verilog == [(-3, -1, -3), (-3, 1, 3), (3, -1, -3), (3, 1, 3)]
      and " / " in vhdl[0] and " mod " in vhdl[1])
if not ok:
    sys.exit("behaviour changed: simulation and converted code relate differently now")
PY
nice v/bin/python -W ignore divmod.py
echo "as described"
