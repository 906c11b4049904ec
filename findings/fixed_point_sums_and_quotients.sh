#!/usr/bin/env bash
# Two fixed-point models for hardware: 7 + 15 is -10, and 0 divided by a small number is 0.5.
#
# Expected: 1. fixedpoint: a sum is exact, its manual says that overflow is not possible.
#   2. spfpm: a quotient is off by at most one step, the last place of the format.
# Seen: 1. The sum of a signed and an unsigned number has one bit too few: a signed 7 of 4 bits plus 15
#   is -10, a plain Python int or float as the second number gives the same. Of all 256 sums of a
#   signed and an unsigned number of 4 bits 28 have the wrong sign. The default alerts raise nothing and
#   say nothing (at most that the rounding rules differ). The difference of the same two numbers is right.
#   2. Before the division one half is added, but one half of a step of the dividend, not one half of
#   the divisor. So each quotient is moved by 1/2 of a step divided by the divisor: 0 / 2^-12 is 0.5
#   with 12 fraction bits, 0 / 2^-64 is 0.5 with 64 (the default), 1 / 0.25 is 4.000488, 0.25 / 0.25
#   is not 1, and 0 / -2 is not 0. The vector (0.006, 0.008) by its length 0.01 is (0.622, 0.817)
#   in place of (0.610, 0.805). sqrt() divides too: sqrt(0.25) is not 0.5. Release 1.6 is the same.
# Versions: fixedpoint 1.0.1, spfpm 1.8.0; for comparison pyfixed 0.1.1 (with mpmath 1.4.1, numpy 2.4.6).
# Why it matters: these are the reference models that testbenches of dividers, filters and normal
#   map units are compared with. Tests with both numbers signed, or with divisors near 1, pass.
# Source: fixedpoint's manual, "Arithmetic", Addition: any combination of signed and unsigned numbers
#   can be added, the operator is always full-precision, "Overflow is not possible"; its table gives mixed
#   sums one bit, mixed differences two. spfpm's module text: the error of 21 / 10 with 64 bits is about 1/2^64.
#   An open issue there tells of one step with negative divisors only.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install fixedpoint==1.0.1 spfpm==1.8.0 pyfixed==0.1.1 mpmath==1.4.1 numpy==2.4.6
cd "$T"
nice v/bin/python - 2>messages <<'PY' || { cat messages; exit 1; }
import math, sys
from fractions import Fraction
from fixedpoint import FixedPoint
from FixedPoint import FXfamily, FXnum
from pyfixed import Fixed

def check(ok, what):
    if not ok:
        sys.exit("behaviour changed: " + what)

# 1. Sums of a signed and an unsigned number.
seven = FixedPoint(7, signed=True, m=4, n=0)
for other in (15, 15.0):
    total = seven + other
    print(f"fixedpoint: 7 + {other!r} = {float(total):g} in {total.qformat}, {other!r} + 7 = {float(other + seven):g}")
    check(float(total) == float(other + seven) == -10 and total.qformat == "Q5.0", "a sum with a plain number")
other = Fixed(15, fraction_bits=0, integer_bits=4, sign=False)
peer = Fixed(7, fraction_bits=0, integer_bits=6, sign=True) + other
print(f"pyfixed:    7 + 15 = {float(peer):g}")
check(float(peer) == 22, "pyfixed")
wrong_sums = wrong_differences = same_kind = 0
for a in range(-8, 8):
    for b in range(16):
        # one rounding rule for both, so that there is no difference to be told about
        x = FixedPoint(a, signed=True, m=4, n=0, rounding="nearest")
        y = FixedPoint(b, signed=False, m=4, n=0, rounding="nearest")
        check(float(x) == a and float(y) == b, "the inputs")
        wrong_sums += float(x + y) != a + b
        wrong_differences += float(x - y) != a - b
        check((float(x + y) == a + b) == (a + b < 16), "which sums are wrong")
        z = FixedPoint(b - 8, signed=True, m=4, n=0, rounding="nearest")
        same_kind += float(x + z) != a + b - 8
print(f"fixedpoint: of 256 pairs of Q4.0 and UQ4.0 {wrong_sums} sums are wrong, {wrong_differences} differences; of pairs of Q4.0 {same_kind} sums")
check((wrong_sums, wrong_differences, same_kind) == (28, 0, 0), "the number of wrong sums")
slope = FixedPoint(1.75, signed=True, m=2, n=6)   # a slope and an 8-bit height
height = FixedPoint(2.5, signed=False, m=2, n=6, rounding="convergent")
print(f"fixedpoint: {float(slope)} + {float(height)} = {float(slope + height)}, minus {float(slope - height)}")
check(float(slope + height) == -3.75 and float(slope - height) == -0.75, "a sum with fraction bits")

# 2. Quotients.
def exact(x):
    return Fraction(x.scaledval, x.family.scale)

twelve, default = FXfamily(12), FXfamily()
rows = ((twelve(0), twelve(2.0 ** -12)), (twelve(1), twelve(2.0 ** -12)), (twelve(1), twelve(0.25)), (twelve(0.25), twelve(0.25)),
        (twelve(0), twelve(-2)), (twelve(3), twelve(2)), (default(0), FXnum(1, default) >> 64))
for a, b in rows:
    steps = (exact(a / b) - exact(a) / exact(b)) * a.family.scale
    print(f"spfpm, {a.family.fraction_bits} bits: {float(a):g} / {float(b):g} = {float(a / b):.7g}, off by {float(steps):.6g} steps")
check(exact(rows[0][0] / rows[0][1]) == Fraction(1, 2) and exact(rows[6][0] / rows[6][1]) == Fraction(1, 2), "0 divided by the smallest number")
check(exact(rows[1][0] / rows[1][1]) == Fraction(8193, 2) and rows[4][0] / rows[4][1] != 0 and rows[5][0] / rows[5][1] == 1.5, "quotients")
peer = Fixed(0, fraction_bits=12, integer_bits=14) / Fixed(1, fraction_bits=12, integer_bits=14, internal=True)
quarter = Fixed(1, fraction_bits=12, integer_bits=14) / Fixed(0.25, fraction_bits=12, integer_bits=14)
print(f"pyfixed, 12 bits: 0 / 2^-12 = {float(peer):g}, 1 / 0.25 = {float(quarter):g}")
check(float(peer) == 0 and float(quarter) == 4, "pyfixed")
for divisor in (1, 2 ** -2, 2 ** -4, 2 ** -6, 2 ** -8):
    d = twelve(divisor)
    errors = [abs(exact(FXnum._rawbuild(twelve, n) / d) - Fraction(n, 4096) / exact(d)) * 4096 for n in range(0, 4096, 5)]
    print(f"  divisor {divisor:<10g}: largest error of 820 quotients {float(max(errors)):g} steps")
    # the rule: the error is half a step over the divisor, all these quotients are exact in the format
    check(max(errors) == math.floor(Fraction(1, 2) / exact(d)), "the size of the error")
x, y, length = twelve(0.006), twelve(0.008), twelve(0.01)
parts = float(x / length), float(y / length)
right = float(exact(x) / exact(length)), float(exact(y) / exact(length))
print(f"spfpm, 12 bits: (0.006, 0.008) / 0.01 is ({parts[0]:.4f}, {parts[1]:.4f}), of the same inputs exactly ({right[0]:.4f}, {right[1]:.4f})")
check(0.011 < parts[0] - right[0] < 0.0125 and 0.011 < parts[1] - right[1] < 0.0125, "a vector")
roots = {f: float(FXfamily(f)(0.25).sqrt()) for f in (8, 12, 16)}
print("spfpm, sqrt(0.25) with 8, 12, 16 bits: " + ", ".join(f"{r:.7g}" for r in roots.values()))
check(roots[12] == 0.5 + 2.0 ** -12, "square roots")
PY
if [ -s messages ]; then
  cat messages
  echo "behaviour changed: there are messages now"
  exit 1
fi
echo "as described"
