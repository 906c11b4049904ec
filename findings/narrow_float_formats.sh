#!/usr/bin/env bash
# Four libraries for 4- to 32-bit floats: 448 is infinity, infinity is finite, MXFP4 loses its upper quarter, 1 - 2^-24 is 1.
#
# Expected: E4M3, E5M2 and E2M1 are the formats of the OCP specifications, with 448, 57344 and 6 as
#   the largest finite numbers, infinities in E5M2 only. A block of 32 numbers that MXFP4 holds
#   exactly comes back unchanged. "IEEE 754" sums and products are the nearest numbers.
# Seen: 1. float8 takes the largest finite code for infinity: F8E4M3::INFINITY is 448 and MAX is 416, in
#   F8E5M2 57344 and 49152. from_f32(448) is_infinite(), while the real infinity of E5M2, 0x7C, and two
#   of its three NaN codes are finite and "Normal", and these NaN are equal to themselves. NaN and 0 are classified as Subnormal.
#   2. float4 takes the power of two above the largest number as the scale of an MXFP4 block, and does
#   not divide by the 4 that E2M1 reaches itself. So 0.5, 1, 1.5, 2, 3, 4, 6 come back as 0, 0, 0, 0, 4, 4, 8.
#   3. custom-float-quant keeps the upper exponent for infinity also where the format has none: 4 and 6
#   are infinite in its "OCP MXFP4", 256 to 448 in MXFP8 E4M3, 16 to 28 and 4 to 7.5 in the two of MXFP6.
#   4. bitfloat has no guard bits and cuts: 1 - 2^-24 is 1, although the result fits into 32 bits. A sum
#   in the lowest binade of normal numbers loses the leading 1: 2^-126 + 2^-128 is 2^-128, and 2^-126 * 1 is 0.
# Versions: cargo crates float8 0.7.0, float4 0.2.0 (with half 2.7.1); custom-float-quant 0.3.0, bitfloat 0.1.1;
#   for comparison ml_dtypes 0.6.0 and numpy 2.4.6.
# Why it matters: such libraries are the models for small float units and make their test vectors. With
#   float8's MAX as the limit a unit saturates one step too low; with float4's scale five of eight codes are never used.
# Source: OCP 8-bit Floating Point Specification (OFP8) 1.0, table of E4M3 and E5M2. OCP Microscaling Formats 1.0,
#   5.3 (no infinity in FP6 and FP4) and 6.3: the scale is the largest power of two up to the largest number,
#   divided by the largest power of two of the element format. README of float4: "following the OCP MX
#   specification"; of custom-float-quant: "OCP MXFP4". bitfloat: "according to IEEE 754 standard".
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install custom-float-quant==0.3.0 bitfloat==0.1.1 ml_dtypes==0.6.0 numpy==2.4.6
mkdir -p "$T/c/src"
cd "$T/c"
cat > Cargo.toml <<'TOML'
[package]
name = "narrow"
version = "0.1.0"
edition = "2021"

[dependencies]
float8 = "=0.7.0"
float4 = "=0.2.0"
half = "=2.7.1"
TOML
cat > src/main.rs <<'RS'
use float4::{E8M0, F4E2M1, MXFP4Block};
use float8::{F8E4M3, F8E5M2};

fn main() {
    // For each code: value, is_infinite, is_nan, is_finite, class, equal to itself.
    for code in 0..=255u8 {
        let x = F8E4M3::from_bits(code);
        println!("e4m3 {code} {} {} {} {} {:?} {}", x.to_f32(), x.is_infinite(), x.is_nan(), x.is_finite(), x.classify(), x == x);
        let x = F8E5M2::from_bits(code);
        println!("e5m2 {code} {} {} {} {} {:?} {}", x.to_f32(), x.is_infinite(), x.is_nan(), x.is_finite(), x.classify(), x == x);
    }
    println!("max {} {}", F8E4M3::MAX.to_f32(), F8E5M2::MAX.to_f32());
    println!("infinity {} {}", F8E4M3::INFINITY.to_f32(), F8E5M2::INFINITY.to_f32());
    println!("converted {} {}", F8E4M3::from_f32(448.0).is_infinite(), F8E5M2::from_f32(57344.0).is_infinite());
    // A block of numbers that E2M1 holds exactly, used as the documentation of MXFP4Block shows.
    let magnitudes = [0.0f32, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0];
    let data: [f32; 32] = core::array::from_fn(|i| magnitudes[i % 8]);
    for scale in [E8M0::from_f32_slice(&data), E8M0::from(1.0f64)] {
        let codes: [F4E2M1; 32] = core::array::from_fn(|i| F4E2M1::from_f64(data[i] as f64 / scale.to_f64()));
        let back = MXFP4Block::from_f32_slice(codes, scale).to_f32_array();
        println!("block {} {:?}", scale.to_f64(), &back[..8]);
    }
}
RS
nice cargo build --release --quiet
./target/release/narrow > "$T/rust.txt"
cd "$T"
nice v/bin/python - <<'PY'
import json, math, random, sys
import ml_dtypes, numpy as np
from bitfloat import F16, F32
from custom_float_quant import CustomFloat

def check(ok, what):
    if not ok:
        sys.exit("behaviour changed: " + what)

lines = [line.split(maxsplit=1) for line in open("rust.txt")]
words = {}
for key, rest in lines:
    words.setdefault(key, []).append(rest.strip())

# 1. float8 against the tables of ml_dtypes.
for key, dtype, last in (("e4m3", ml_dtypes.float8_e4m3fn, 448), ("e5m2", ml_dtypes.float8_e5m2, 57344)):
    table = np.arange(256, dtype="u1").view(dtype).astype("f4")
    check(float(ml_dtypes.finfo(dtype).max) == last, "ml_dtypes")
    wrong = []
    for row in words[key]:
        code, value, inf, nan, finite, kind, same = row.split()
        right = float(table[int(code)])
        check(np.float32(value) == right or math.isnan(right) and value == "NaN", "values of codes in float8")
        asked = (inf == "true", nan == "true", finite == "true", same == "true")
        if asked != (math.isinf(right), math.isnan(right), math.isfinite(right), not math.isnan(right)):
            wrong.append(int(code))
            if int(code) < 128:
                print(f"float8, {key.upper()}, code 0x{int(code):02x}, value {value}: is_infinite {inf}, is_nan {nan}, is_finite {finite}, "
                      f"{kind}, equal to itself {same}")
    check(wrong == {"e4m3": [0x7E, 0xFE], "e5m2": [0x7B, 0x7C, 0x7D, 0x7F, 0xFB, 0xFC, 0xFD, 0xFF]}[key], "the codes that float8 takes wrongly")
    kinds = {row.split()[0]: row.split()[5] for row in words[key]}
    check(kinds["0"] == kinds["127" if key == "e4m3" else "126"] == "Subnormal", "classes of 0 and NaN in float8")
print(f"float8: MAX {words['max'][0]}, INFINITY {words['infinity'][0]} (E4M3, E5M2), largest number is_infinite {words['converted'][0]}")
check((words["max"], words["infinity"], words["converted"]) == (["416 49152"], ["448 57344"], ["true true"]), "constants of float8")

# 2. float4, and the scale by the specification, for comparison.
magnitudes = [0, 0.5, 1, 1.5, 2, 3, 4, 6]
specified = 2.0 ** (math.floor(math.log2(6)) - 2)
for row in words["block"]:
    scale, back = row.split(" ", 1)
    print(f"float4: block of {magnitudes}, scale {scale}: {back}")
back = [json.loads(row.split(" ", 1)[1]) for row in words["block"]]
check(back[0] == [0, 0, 0, 0, 0, 4, 4, 8] and words["block"][0].startswith("8 "), "the scale of float4")
check(specified == 1 and back[1] == magnitudes, "the block with the specified scale")

# 3. custom-float-quant against ml_dtypes: all finite numbers of each format.
for name, dtype, codes, lost in (
        ("mxfp4_e2m1", ml_dtypes.float4_e2m1fn, 16, [4, 6]), ("mxfp6_e2m3", ml_dtypes.float6_e2m3fn, 64, [4 + i / 2 for i in range(8)]),
        ("mxfp6_e3m2", ml_dtypes.float6_e3m2fn, 64, [16, 20, 24, 28]), ("mxfp8_e4m3", ml_dtypes.float8_e4m3fn, 256, list(range(256, 449, 32))),
        ("mxfp8_e5m2", ml_dtypes.float8_e5m2, 256, [])):
    quantizer = CustomFloat.from_preset(name)
    values = np.arange(codes, dtype="u1").view(dtype).astype("f8")
    values = values[np.isfinite(values)]
    got = quantizer.quantize_array(values)
    infinite = sorted(set(np.abs(values[np.isinf(got)]).tolist()))
    check(infinite == lost and np.array_equal(got[np.isfinite(got)], values[np.isfinite(got)]), "infinite numbers in " + name)
    print(f"custom-float-quant, {name}: largest {quantizer.max_finite_value:g}, in the format {values.max():g}, infinite {infinite}")

# 4. bitfloat against numpy, which has IEEE 754's rounding for both formats.
def pair(cls, dtype, unsigned, a, b):
    x, y = (cls.from_int(int(np.array([v], dtype).view(unsigned)[0])) for v in (a, b))
    return x, y

for a, sign, b in ((1, "-", 2.0 ** -24), (2.0 ** -126, "+", 2.0 ** -128), (2.0 ** -127, "+", 2.0 ** -127), (2.0 ** -126, "*", 1), (1, "/", 3)):
    x, y = pair(F32, "f4", "u4", a, b)
    operation = {"-": lambda p, q: p - q, "+": lambda p, q: p + q, "*": lambda p, q: p * q, "/": lambda p, q: p / q}[sign]
    got, right = operation(x, y).to_float(), float(operation(np.float32(a), np.float32(b)))
    print(f"bitfloat, F32: {a:g} {sign} {b:g} = {got:.9g}, IEEE 754 {right:.9g}")
    check(got != right, f"bitfloat {a} {sign} {b}")
random.seed(1)
total, wrong = 0, dict.fromkeys("+*/", 0)
with np.errstate(all="ignore"):
    for _ in range(3000):
        a, b = (np.array([random.getrandbits(16)], "u2").view("f2")[0] for _ in range(2))
        if not (np.isfinite(a) and np.isfinite(b) and b):
            continue
        total += 1
        x, y = pair(F16, "f2", "u2", a, b)
        for sign, got, right in (("+", x + y, a + b), ("*", x * y, a * b), ("/", x / y, a / b)):
            value = got.to_float()
            wrong[sign] += value != float(right) and not (math.isnan(value) and np.isnan(right))
print(f"bitfloat, F16: of {total} random pairs wrong " + ", ".join(f"{k} {100 * v / total:.0f} %" for k, v in wrong.items()))
check(all(v > total / 5 for v in wrong.values()), "random numbers in bitfloat")
PY
echo "as described"
