#!/usr/bin/env bash
# CMSIS-DSP bilinear interpolation: the last row and column are zero, white loses a bit, and a table of -1.0 comes out as +1.0.
#
# Expected: at whole coordinates inside of the table the result is the element there, outside it is zero, in f32, q31, q15 and q7.
#   Between elements it is a mean of four of them, so a table that is the same everywhere gives this value everywhere.
# Seen: 1. The last row and the last column are zero, in all four types: of 4 x 5 elements 12 can be read back. A point a little
#   before the last element has nearly its value. arm_linear_interp of the same package does give the last element there.
#   2. Between -1 and 0, outside of the table, f32 goes on with the slope of the first two elements; the fixed-point ones are 0.
#   3. In fixed point, also at whole coordinates, positive values are too small: q7 gives 126 for 127 and 0 for 1, q15 one less,
#   q31 up to 16 less. Below zero the values are right in q7 and, but for -1, in q15.
#   4. A q31 table of -1.0 gives nearly +1.0 for most points inside: the sum comes out below -2^31 and wraps. No message.
# Versions: cmsisdsp 1.10.3 (the C library as a Python package), numpy 2.4.6.
# Why it matters: this is the function for a texture or a height map in firmware, and the package is the reference for it. With
#   coordinates that are held inside of the picture (clamp to edge) the right and the lower border turn black. -1.0 is what
#   arm_float_to_q31 gives for a component of a normal that points along an axis, and for everything below.
# Source: CMSIS-DSP, "Bilinear Interpolation": table element (x,y) is located at pTable[x + y*numCols] where x and y are integers;
#   XF = floor(x), weights 1-(x-XF) and x-XF; if (x, y) are outside of the table boundary, it returns zero output.
#   In fixed point x and y have 12 integral and 20 fractional bits. Its old issues 695 and 805 (CMSIS_5) brought the check of the
#   border, against reading past the table; the text was not changed.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install cmsisdsp==1.10.3 numpy==2.4.6
cd "$T"
nice v/bin/python - <<'PY'
import math, random, sys
from fractions import Fraction
import cmsisdsp as dsp, numpy as np

bits = {"q31": (31, np.int32), "q15": (15, np.int16), "q7": (7, np.int8)}

def bilinear(kind, rows, cols, table, x, y):
    """Fixed-point tables and results are integers; x and y are numbers with at most 20 fractional bits."""
    table = np.array(table, np.float32 if kind == "f32" else bits[kind][1])
    instance = getattr(dsp, "arm_bilinear_interp_instance_" + kind)(rows, cols, table)
    if kind != "f32":
        x, y = int(x * 2**20), int(y * 2**20)
    return getattr(dsp, "arm_bilinear_interp_" + kind)(instance, x, y)

def by_the_text(cols, table, x, y):
    xf, yf = math.floor(x), math.floor(y)
    x, y = Fraction(x) - xf, Fraction(y) - yf
    value = 0
    for j, wy in ((0, 1 - y), (1, y)):
        for i, wx in ((0, 1 - x), (1, x)):
            if wx * wy:  # an element with the weight 0 may lie outside
                value += wx * wy * int(table[(xf + i) + (yf + j) * cols])
    return value

# 1. Elements of a table with 4 rows and 5 columns, read back at their own coordinates.
rows, cols = 4, 5
for kind in ("f32", "q31", "q15", "q7"):
    one = 1 if kind == "f32" else 1 << bits[kind][0] - 7
    table = [one * (10 + x + 20 * y) for y in range(rows) for x in range(cols)]
    got = [[bilinear(kind, rows, cols, table, x, y) for x in range(cols)] for y in range(rows)]
    zeros = {(x, y) for y in range(rows) for x in range(cols) if got[y][x] == 0}
    right = sum(got[y][x] == table[x + y * cols] for y in range(rows) for x in range(cols))
    before = bilinear(kind, rows, cols, table, cols - 1 - 2**-10, rows - 1 - 2**-10) / one
    print(f"{kind}: {len(zeros)} of 20 elements read as 0, {right} exactly; x = 3.999, y = 2.999: {before:.3f}, x = 4, y = 3: {got[3][4]}")
    border = {(x, y) for y in range(rows) for x in range(cols) if x == cols - 1 or y == rows - 1}
    if zeros != border or right != (12 if kind == "f32" else 0) or not 72 < before < 74:
        sys.exit("behaviour changed: the border of the table")
line = np.array([1, 2, 3], np.float32)
last = dsp.arm_linear_interp_f32(dsp.arm_linear_interp_instance_f32(3, 0, 1.0, line), 2)
last_q15 = dsp.arm_linear_interp_q15(np.array([1000, 2000, 3000], np.int16), 2 << 20, 3)
print(f"arm_linear_interp at the last of three elements: f32 {last:g} of 3, q15 {last_q15} of 3000")
if last != 3 or last_q15 != 3000:
    sys.exit("behaviour changed: linear interpolation")

# 2. Left of the table.
for x in (-1, -0.75, -0.5, -0.25, 0):
    f32 = bilinear("f32", 2, 2, [10, 20, 10, 20], x, 0)
    q15 = bilinear("q15", 2, 2, [10000, 20000, 10000, 20000], x, 0)
    print(f"elements 10, 20 at x = 0, 1; at x = {x:5}: f32 {f32:g}, q15 {q15 / 1000:g}")
    if f32 != (0 if x == -1 else 10 + 10 * x) or q15 != (9999 if x == 0 else 0):
        sys.exit("behaviour changed: points left of the table")

# 3. Tables that are the same everywhere, and 4. the table of -1.0.
dice = random.Random(1)
points = [(0, 0), (1, 1)] + [(dice.randrange(2 << 20) / 2**20, dice.randrange(2 << 20) / 2**20) for _ in range(2000)]
for kind in ("q7", "q15", "q31"):
    scale = 1 << bits[kind][0] - 7
    errors = {}
    for value in (127 * scale, 64 * scale, 1, -1, -64 * scale):
        if {by_the_text(3, [value] * 9, x, y) for x, y in points} != {value}:
            sys.exit("the formula was typed wrongly")
        errors[value] = sorted({bilinear(kind, 3, 3, [value] * 9, x, y) - value for x, y in points})
    print(f"{kind}, same value everywhere: errors " + ", ".join(f"{v}: {e[0]} to {e[-1]}" for v, e in errors.items()))
    for value, e in errors.items():
        if kind == "q31":
            ok = -16 <= e[0] and (e[-1] < 0 or value < 0)
        else:
            ok = e == [-1] if value > 0 else e == [0] or value == -1 and e == [-1, 0] and kind == "q15"
        if not ok:
            sys.exit(f"behaviour changed: constant tables, {kind}, {value}: {e}")
low = int(dsp.arm_float_to_q31(np.array([-1.0], np.float32))[0])
results = [bilinear("q31", 3, 3, [low] * 9, x, y) / 2**31 for x, y in points]
turned = sum(r > 0.999 for r in results)
print(f"q31, -1.0 everywhere: {turned} of {len(points)} points give {max(results):.9f}, the others {min(results):.9f}")
example = bilinear("q31", 3, 3, [low] * 9, 0.3, 0.7)
print(f"  x = 0.3, y = 0.7: {example} in place of {low}")
if low != -2**31 or example < 2**31 - 16 or not len(points) / 2 < turned < len(points):
    sys.exit("behaviour changed: the table of -1.0")
PY
echo "as described"
