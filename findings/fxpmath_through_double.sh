#!/usr/bin/env bash
# fxpmath multiplies exactly and then narrows through float64, unmarked.
#
# Expected: a fixed-point library with "extended precision" and a flag for
#   inexact results narrows a 64-bit product in integers, and reads back the
#   hexadecimal text that it wrote.
# Seen: products of two 32-bit numbers are exact. Narrowing such a product
#   (fxp-s64/60 to fxp-s62/58, rounding='floor') goes through a float64: most
#   results differ from a shift, by up to 64 units. x.hex() writes every bit;
#   Fxp(x.hex(), like x) returns another number (raw=True is needed), with the
#   flag "inaccuracy" off.
# Versions: fxpmath 0.4.10, numpy 2.4.6.
# Why it matters: golden vectors for a datapath are often made with such a
#   library. Words of at most 53 bits agree with the hardware, the first wide
#   accumulator does not, and the error looks like a rounding fault in the RTL.
# Source: fxpmath's README promises arbitrary word sizes and extended precision;
#   it names the inaccuracy flag as the way to notice a precision error.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install fxpmath==0.4.10 numpy==2.4.6
cd "$T"
nice v/bin/python - <<'PY'
import random, sys
from fxpmath import Fxp

def raw(bits, width, fraction):
    number = Fxp(None, True, width, fraction)
    number.set_val(bits, raw=True)
    return number

random.seed(1)
count, products, narrowed, narrow_errors, texts, text_errors, unmarked = 300, 0, 0, [], 0, [], 0
for _ in range(count):
    x, y = random.randrange(-2**31, 2**31), random.randrange(-2**31, 2**31)
    product = raw(x, 32, 30) * raw(y, 32, 30)
    products += int(product.val) == x * y
    error = int(Fxp(product, True, 62, 58, rounding="floor").val) - (x * y >> 2)
    narrowed += error != 0
    narrow_errors.append(abs(error))
    bits = random.randrange(0, 2**62)
    number = raw(bits, 64, 60)
    assert int(number.hex(), 16) == bits, "the text has every bit"
    again = Fxp(number.hex(), True, 64, 60)
    error = int(again.val) - bits
    texts += error != 0
    text_errors.append(abs(error))
    unmarked += error != 0 and not again.status["inaccuracy"]
print(f"products of fxp-s32/30: {products} of {count} exact, {product.dtype}")
print(f"narrowed to fxp-s62/58 by floor: {narrowed} of {count} are no shift by two, off by up to {max(narrow_errors)}")
print(f"hex() read back: {texts} of {count} changed, by up to {max(text_errors)}; {unmarked} of them without the flag")
short = raw(0x0123456789ABCD, 56, 52)
print(f"one of 53 significant bits: {short.hex()} read back differs by {int(Fxp(short.hex(), True, 56, 52).val) - 0x0123456789ABCD}")
if products != count or product.dtype != "fxp-s64/60":
    sys.exit("behaviour changed: products are no longer exact")
if not (narrowed > 200 and 32 <= max(narrow_errors) <= 128 and texts > 200 and unmarked == texts):
    sys.exit("behaviour changed: narrowing or reading text no longer goes through float64")
PY
echo "as described"
