#!/usr/bin/env bash
# apytypes rounds words of 64, 128, 192 bits to the wrong sign, and reads some small floats as zero.
#
# Expected: a cast with rounding to nearest gives the nearest number of the new format, at every
#   width. A float that was cast has the value of its bit pattern.
# Seen: 1. Fixed point: 0.75 with 1 integer and 63 fraction bits, cast to 4 integer bits without a
#   fraction, is -1. Half of the positive numbers come out wrong; with 8 fraction bits kept, the
#   upper half of the last step below one does. Saturation does not help: the target has room. All
#   rounding modes tried do it, the truncating one does not. The same at 128 and 192 bits; words of
#   63, 65, 127 and 129 bits are right.
#   2. Floats: a number just below the smallest normal one of the target rounds up to it. The bit
#   pattern is right, but float() of it is 0.0, and it is not equal to the same number made by
#   from_float(). For binary32 to binary16 these are 8192 numbers.
# Versions: apytypes 0.5.1, numpy 2.4.6.
# Why it matters: golden vectors come from such a library. 64 bits is where the sum of products of
#   two 32-bit numbers ends up; the bright end of a dot product turns black (or to the back side),
#   and a test of the hardware blames the hardware.
# Source: the documentation of APyFixed.cast, which is where the library says to quantize, and of
#   QuantizationMode, where RND is rounding to nearest. Neither names a limit of the width.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install apytypes==0.5.1 numpy==2.4.6
cd "$T"
nice v/bin/python - <<'PY'
import math, random, sys
from fractions import Fraction
import numpy as np
from apytypes import APyFixed, APyFixedArray, APyFloat, OverflowMode, QuantizationMode

def signed(bits, width):
    return bits - (1 << width) if bits >> (width - 1) else bits

random.seed(1)
count, wrong = 1000, {}
for width in (63, 64, 65, 127, 128, 129, 192):
    row = []
    for kept in (0, 2, 8):
        bad = 0
        for _ in range(count):
            raw = random.getrandbits(width)
            if kept == 8:  # the last step below one
                raw = (1 << (width - 1)) - 1 - random.getrandbits(width - 9)
            number = APyFixed(raw, int_bits=1, frac_bits=width - 1)
            got = number.cast(int_bits=4, frac_bits=kept, quantization=QuantizationMode.RND, overflow=OverflowMode.SAT)
            want = math.floor(Fraction(signed(raw, width), 1 << (width - 1)) * (1 << kept) + Fraction(1, 2))
            bad += signed(got.to_bits(), 4 + kept) != want
        row.append(bad)
    wrong[width] = row
    print(f"{width:3} bits: {row[0]} of {count} wrong as whole numbers, {row[1]} with 2 fraction bits; {row[2]} of {count} in the last 1/256 below one")
number = APyFixed.from_float(0.75, int_bits=1, frac_bits=63)
modes = ("TRN", "RND", "RND_ZERO", "RND_INF", "RND_MIN_INF", "RND_CONV", "RND_CONV_ODD")
results = {m: float(number.cast(int_bits=4, frac_bits=0, quantization=getattr(QuantizationMode, m))) for m in modes}
print("0.75 of 64 bits:", ", ".join(f"{m} {v:g}" for m, v in results.items()))
array = APyFixedArray.from_float([0.25, 0.75, -0.75], int_bits=1, frac_bits=63)
array = array.cast(int_bits=4, frac_bits=0, quantization=QuantizationMode.RND).to_numpy().tolist()
print("an array of 0.25, 0.75, -0.75:", array)

first, last = (np.array(v, "f4").view("u4").item() for v in (2.0**-14 * (1 - 2.0**-11), 2.0**-14))
zeros = patterns = equal = total = 0
for bits in range(first, last):
    single = np.array(bits, "u4").view("f4")
    half = APyFloat.from_float(float(single), exp_bits=8, man_bits=23).cast(exp_bits=5, man_bits=10)
    ieee = single.astype("f2")
    direct = APyFloat.from_float(float(single), exp_bits=5, man_bits=10)
    if ieee.view("u2") != 0x400:
        continue
    total += 1
    patterns += half.to_bits() == 0x400
    zeros += float(half) == 0.0
    equal += half == direct
print(f"{total} binary32 numbers round up to the smallest normal binary16 {float(ieee):.8g}: {patterns} bit patterns right, "
      f"{zeros} read as 0.0, {equal} equal to from_float()")
if any(any(row) for width, row in wrong.items() if width % 64):
    sys.exit("behaviour changed: words of other widths are wrong as well")
if not all(200 < row[0] < 300 and row[1] > 0 and row[2] > 400 for width, row in wrong.items() if width % 64 == 0):
    sys.exit("behaviour changed: words of 64, 128 or 192 bits are rounded otherwise")
if any(value != (0 if mode == "TRN" else -1) for mode, value in results.items()):
    sys.exit("behaviour changed: rounding modes")
if array != [0.0, -1.0, -1.0]:
    sys.exit("behaviour changed: arrays are rounded otherwise")
if not (total == patterns == zeros and total == 8192 and equal == 0):
    sys.exit("behaviour changed: floats that round up to the smallest normal number")
PY
echo "as described"
