#!/usr/bin/env bash
# Four readers of VCD files: signals with a shared identifier are empty or missing, the last step is lost, equal dumps differ.
#
# Expected: in a VCD file several names may have one identifier, equal names may stand in several
#   scopes, and a value may be shorter than its variable: then it is extended to the left, with 0 after
#   0 or 1, with x after x, with z after z. Readers give each name its changes, and two dumps of the same changes are equal.
# Seen: 1. pyDigitalWaveTools gives the changes to the first name of an identifier. Each other name gets
#   an empty list, in the JSON output too: the clock of all submodules is missing.
#   2. vcd2df leaves out each signal whose name was used in another scope, whatever its identifier, and
#   all changes of the last time step. A real number and an unknown value are the integer -1.
#   3. vcd-tools compares the text: a dump with "bx" and one with "bxxxxxxxx" differ, so do x01 and xxxxxx01,
#   1z and 0000001z. The last two are not even marked as unknown values. Zeros are extended properly.
#   4. simplify-vcd drops all changes at time 0, so a signal that is 1 from the start is not in the output;
#   cutting the start away keeps the state of the signals of one time step only. x becomes 0, names become a, b, c.
#   Nothing warns of what is lost, and the exit status is 0.
# Versions: pyDigitalWaveTools 1.2, vcd2df 1.0 (pandas 3.1.1, numpy 2.4.6), vcd-tools 0.3.0, simplify-vcd 1.1.0
#   (click 8.3.3); for comparison pywellen 0.25.7 and vcdvcd 2.6.0.
# Why it matters: a port and the net at it have one identifier in dumps of most simulators. Icarus Verilog shortens
#   values, Verilator does not: a comparison of the two reports differences where the designs agree.
# Source: IEEE 1364-2005, 18.2.2 and its table of left extension, 18.2.3.7 (same identifier for several
#   references); the same in IEEE 1800-2023, 21.7.2. README of vcd-tools: "diff two VCD files"; of
#   pyDigitalWaveTools: "parse VCD (std 2009) files". simplify-vcd's README warns of more complicated files; these have single bits only.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install pyDigitalWaveTools==1.2 vcd2df==1.0 pandas==3.1.1 numpy==2.4.6 \
  vcd-tools==0.3.0 simplify-vcd==1.1.0 click==8.3.3 pywellen==0.25.7 vcdvcd==2.6.0
cd "$T"
cat > short.vcd <<'VCD'
$timescale 1 ns $end
$scope module top $end
$var wire 1 ! clk $end
$var wire 8 " data [7:0] $end
$scope module sub $end
$var wire 1 ! clk $end
$var wire 8 # data [7:0] $end
$var real 64 % gain $end
$upscope $end
$upscope $end
$enddefinitions $end
#0
$dumpvars
0!
bx "
b0 #
r0.5 %
$end
#5
1!
b101 "
bz #
#10
0!
bx01 "
b11111111 #
r1.5 %
#15
1!
b1z "
VCD
# The same changes with all bits written.
sed -e 's/^bx "/bxxxxxxxx "/; s/^b101 "/b00000101 "/; s/^bx01 "/bxxxxxx01 "/; s/^b1z "/b0000001z "/' \
  -e 's/^b0 #/b00000000 #/; s/^bz #/bzzzzzzzz #/' short.vcd > long.vcd
cat > bits.vcd <<'VCD'
$timescale 1 ns $end
$scope module top $end
$var wire 1 p enable $end
$var wire 1 q clk $end
$var wire 1 r ready $end
$var wire 1 s late $end
$upscope $end
$enddefinitions $end
#0
1p
0q
0r
0s
#10
1q
1r
#20
0q
#30
1q
xs
#40
0q
VCD
v/bin/simplify-vcd bits.vcd all.vcd
v/bin/simplify-vcd --truncate-before=25ns bits.vcd cut.vcd
nice v/bin/python - <<'PY'
import json, sys
import pywellen, vcd_tools
from pyDigitalWaveTools.vcd.parser import VcdParser
from vcd2df import vcd2df
from vcdvcd import VCDVCD

def check(ok, what):
    if not ok:
        sys.exit("behaviour changed: " + what)

def bits(value, width):
    if isinstance(value, int):
        return format(value, f"0{width}b")
    return value if isinstance(value, float) else value.rjust(width, "0" if value[0] in "01" else value[0])

def wellen(name):
    return {v.full_name: [(t, bits(x, v.bitwidth or 1)) for t, x in v.tv] for v in pywellen.Waveform(name).all_vars()}

# By hand, from the text of the standard.
clk = [(0, "0"), (5, "1"), (10, "0"), (15, "1")]
right = {"top.clk": clk, "top.data": [(0, "xxxxxxxx"), (5, "00000101"), (10, "xxxxxx01"), (15, "0000001z")], "top.sub.clk": clk,
         "top.sub.data": [(0, "00000000"), (5, "zzzzzzzz"), (10, "11111111")], "top.sub.gain": [(0, 0.5), (10, 1.5)]}
check(wellen("short.vcd") == wellen("long.vcd") == right, "pywellen")
read = VCDVCD("short.vcd")
other = {s.split("[")[0]: [(t, float(x) if "gain" in s else bits(x, int(read[s].size))) for t, x in read[s].tv] for s in read.signals}
check(other == right, "vcdvcd")
print("pywellen and vcdvcd read all five signals, from both files the same")

# 1. pyDigitalWaveTools
def flat(node, path=()):
    if "children" in node:
        return {k: v for child in node["children"] for k, v in flat(child, path + (node["name"],)).items()}
    return {".".join(path[1:] + (node["name"],)): node["data"]}

parser = VcdParser()
with open("short.vcd") as f:
    parser.parse(f)
tree = flat(json.loads(json.dumps(parser.scope.toJson())))
print("pyDigitalWaveTools, number of changes:", {k: len(v) for k, v in tree.items()})
check({k: len(v) for k, v in tree.items()} == {k: 0 if k == "top.sub.clk" else len(v) for k, v in right.items()}, "pyDigitalWaveTools")

# 2. vcd2df
frame = vcd2df("short.vcd")
print("vcd2df:")
print(frame.to_string())
check(list(frame.index) == ["clk", "data", "gain"] and list(frame.columns) == ["#0", "#5", "#10"], "rows and columns of vcd2df")
check(frame.loc["gain"].tolist() == [-1, -1, -1] and frame.loc["data"].tolist() == [-1, 5, -1], "values of vcd2df")

# 3. vcd-tools
result = vcd_tools.compare("short.vcd", "long.vcd")
print("vcd-tools, the same changes written short and long: passed", result["passed"])
for m in result["mismatches"]:
    print(f"  {m['signal']} at {m['time']}: {m['value1']} and {m['value2']}, is_unknown {m['is_unknown']}")
check(not result["passed"] and result["total_mismatches"] == 4, "the comparison of vcd-tools")
check([m["is_unknown"] for m in result["mismatches"] if "1" in m["value1"]] == [False, False], "marks of vcd-tools")
check(not vcd_tools.compare("short.vcd", "long.vcd", ignore_unknown=True)["passed"], "the comparison with ignore_unknown")
check(vcd_tools.compare("short.vcd", "short.vcd")["passed"], "vcd-tools with one file")

# 4. simplify-vcd keeps the identifiers and gives new names.
names = {"p": "enable", "q": "clk", "r": "ready", "s": "late"}
def by_code(name):
    waves, codes, time = {}, {}, 0
    for line in open(name):
        word = line.split()
        if word[0] == "$var":
            codes[word[3]] = word[4]
        elif word[0][0] == "#":
            time = int(word[0][1:])
        elif word[0][0] in "01xz":
            waves.setdefault(names[word[0][1:]], []).append((time, word[0][0]))
    return codes, waves

given = {v: wellen("bits.vcd")["top." + v] for v in names.values()}
codes, whole = by_code("all.vcd")
print("simplify-vcd, given:     ", given)
print("simplify-vcd, result:    ", whole, "new names", sorted(codes.values()))
check("enable" not in whole and not set(codes.values()) & set(names.values()), "signals that are constant from time 0")
check(whole["ready"] == [(10, "1")] and whole["late"] == [(30, "0")], "x and time 0")
cut = by_code("cut.vcd")[1]
print("simplify-vcd, from 25 ns:", cut)
# ready is 1 at 25 ns; the last step before the cut changed clk only.
check(given["ready"][-1] == (10, "1") and "ready" not in cut and "enable" not in cut and cut["clk"][0] == (0, "0"), "the state at the cut")
PY
echo "as described"
