#!/usr/bin/env bash
# Four half float converters of npm: 131072 becomes -0, 0.99999 becomes 0.9995, and a promise about infinity is not kept.
#
# Expected: a number becomes the nearest half float (binary16), a tie the even one; above 65519.99
#   infinity or, if the package clamps, 65504. A number never changes its sign.
# Seen: 1. float16: above 65535 the exponent runs into the sign bit. 100000 is NaN, 131072 is -0,
#   200000 is -0.000032, and -131072 is 0x10000, 17 bits. Each tie goes up, not to the even one.
#   2. three and Babylon.js cut: a number always becomes the lower neighbour, also just below the upper.
#   0.99999 becomes 0.9995, the unit vector (0.6, 0.8, 0) is 0.9996 long, and light is only lost.
#   Babylon.js says nothing, three warns only of numbers above 65504.
#   3. fp16 rounds to float first, and then again. 1.0014648 becomes the farther neighbour. Its
#   test for loss says "inexact", with the promise "never infinity", for 65520 to 65535.9: these are stored as infinity.
# Versions: npm packages float16 0.0.1, fp16 1.0.0, three 0.187.0, @babylonjs/core 9.28.0; for
#   comparison @petamoriken/float16 3.9.3 and a search for the nearest number in this script.
# Why it matters: half floats hold HDR panoramas, normal maps and vertex data; suns have 100000 and
#   more. A hardware unit that rounds as IEEE 754 says differs in the last bit from a picture made here.
# Source: IEEE 754-2019, 4.3.1 and 7.4 (roundTiesToEven, overflow). README of fp16: conversion has the
#   IEEE 754 default rounding; Precision.Inexact never rounds to infinity. float16: "Encode and decode
#   float16", its decoder is right. The documentation of three and Babylon.js gives no rounding rule.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
cd "$T"
echo '{"private": true, "type": "module"}' > package.json
nice npm install --silent --no-audit --no-fund --ignore-scripts float16@0.0.1 fp16@1.0.0 three@0.187.0 @babylonjs/core@9.28.0 \
  @petamoriken/float16@3.9.3
cat > run.mjs <<'JS'
import float16 from "float16";
import { setFloat16, getFloat16Precision, Precision } from "fp16";
import { DataUtils } from "three";
import { ToHalfFloat } from "@babylonjs/core/Misc/halfFloat.js";
import { setFloat16 as otherSet, getFloat16 as otherGet } from "@petamoriken/float16";

function check(ok, what) {
  if (!ok) { console.log("behaviour changed: " + what); process.exit(1); }
}
const view = new DataView(new ArrayBuffer(4));
let warnings = 0;
console.warn = () => warnings++;
const encode = {
  float16: (x) => float16.float16ToByte(x),
  three: (x) => DataUtils.toHalfFloat(x),
  "Babylon.js": (x) => ToHalfFloat(x),
  fp16: (x) => { setFloat16(view, 0, x); return view.getUint16(0); },
  petamoriken: (x) => { otherSet(view, 0, x); return view.getUint16(0); },
};

// Decoding by the definition of the format.
function decode(bits) {
  const sign = bits & 0x8000 ? -1 : 1, e = bits >> 10 & 31, m = bits & 1023;
  if (e === 31) return m ? NaN : sign * Infinity;
  return sign * (e ? (1024 + m) * 2 ** (e - 25) : m * 2 ** -24);
}
for (let bits = 0; bits < 65536; bits++) {
  view.setUint16(0, bits);
  check(Object.is(decode(bits), otherGet(view, 0)) && Object.is(decode(bits), float16.byteToFloat16(bits)), "decoding");
}

console.log("number".padStart(12) + Object.keys(encode).map((k) => k.padStart(24)).join(""));
for (const x of [0.99999, 1.0014648, 1.00048828125, 65504, 65520, 100000, 131072, 200000, -131072]) {
  const cells = Object.values(encode).map((f) => {
    const bits = f(x);
    return bits > 65535 ? "0x" + bits.toString(16) : Object.is(decode(bits), -0) ? "-0" : String(+decode(bits).toPrecision(6));
  });
  console.log(String(x).padStart(12) + cells.map((c) => c.padStart(24)).join(""));
}
check(Number.isNaN(decode(encode.float16(100000))) && encode.float16(131072) === 0x8000 && encode.float16(-131072) === 0x10000,
  "large numbers in float16");
check(decode(encode.float16(200000)) < 0 && decode(encode.float16(200000)) > -0.001, "200000 in float16");

// All neighbours a and b, with numbers between them. The nearest one, a tie to the even code; the differences are exact.
function nearest(x, a) {
  const low = x - decode(a), high = decode(a + 1) - x;
  return low < high || (low === high && a % 2 === 0) ? a : a + 1;
}
const count = {};
let total = 0;
for (let a = 0; a < 0x7BFF; a++) {
  const step = decode(a + 1) - decode(a), middle = decode(a) + step / 2;
  const inputs = { exact: decode(a), quarter: decode(a) + step / 4, tie: middle, "three quarters": decode(a) + step * 0.75,
    "above tie": middle * (1 + 2 ** -40), "below tie": middle * (1 - 2 ** -40) };
  for (const [kind, x] of Object.entries(inputs)) {
    total++;
    const right = nearest(x, a);
    for (const [name, f] of Object.entries(encode)) {
      const got = f(x);
      if (got !== right) {
        count[name] ??= {};
        count[name][kind] = (count[name][kind] ?? 0) + 1;
        check(got === a || got === a + 1, "the result is no neighbour");
        if (name === "three" || name === "Babylon.js") check(got === a, name + " rounds up now");
      }
    }
  }
}
console.log(`wrong of ${total} positive numbers up to 65504, by their place between two half floats (31743 of each kind):`);
for (const name in encode) console.log("  " + name.padEnd(12) + JSON.stringify(count[name] ?? "none"));
check(!count.petamoriken, "the package for comparison");
check(JSON.stringify(count.three) === JSON.stringify(count["Babylon.js"]) && count.three["three quarters"] === 31743 && !count.three.quarter,
  "rounding in three or Babylon.js");
check(count.fp16["above tie"] > 15000 && !count.fp16.tie && count.float16.tie > 15000 && !count.float16["above tie"], "rounding in fp16 or float16");

warnings = 0;
const vector = [0.6, 0.8, 0].map((v) => decode(encode.three(v)));
const ramp = Array.from({ length: 10000 }, (_, i) => (i + 0.5) / 10000);
const mean = (f) => ramp.reduce((sum, x) => sum + decode(f(x)) / x, 0) / ramp.length;
console.log(`three and Babylon.js: (0.6, 0.8, 0) has the length ${Math.hypot(...vector).toFixed(5)}, three's warnings: ${warnings}`);
console.log(`mean of stored / given over a ramp: three ${mean(encode.three).toFixed(6)}, petamoriken ${mean(encode.petamoriken).toFixed(6)}`);
check(Math.hypot(...vector) < 0.9998 && warnings === 0 && mean(encode.three) < 0.99975 && Math.abs(mean(encode.petamoriken) - 1) < 1e-5, "the loss");

const said = Object.keys(Precision).find((k) => Precision[k] === getFloat16Precision(65520));
console.log(`fp16: getFloat16Precision(65520) is ${said}, stored is ${decode(encode.fp16(65520))}`);
check(said === "Inexact" && decode(encode.fp16(65520)) === Infinity, "the promise of fp16");
JS
nice node run.mjs
echo "as described"
