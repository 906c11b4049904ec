#!/usr/bin/env bash
# Light projected to nine numbers by two little packages: a basis that is not one (spherical-harmonics in
# Rust), and high dynamic range that is 255 times too dark (cubemap-sh in npm).
#
# Expected: coefficients in the usual real basis, up to the known choice of sign for odd m. What is projected
#   and evaluated again by another library of the same basis gives back 1 + x, or the lower half.
# Seen: 1. spherical-harmonics computes the Legendre factor with (1 - x^2) to the power m / 2 in whole numbers,
#   so sin(theta) is missing for m = 1, and with a factorial where the double factorial belongs, so m = 2 is
#   doubled. x has the coefficient 2.411 for 2.047, x z 1.348 for 0.915, x y and x^2 - y^2 exactly twice theirs.
#   2. Its project_sparse_samples puts every direction below the horizon on the horizon: fitting 1 + z, a
#   function of the basis, gives 0.18 for 3.54 in the mean and 5.73 for 2.05 in z.
#   3. cubemap-sh knows Float32Array faces as linear and skips the gamma for them, but divides them by 255
#   all the same: a white room of 1.0 gets 1/255 of the light of one of bytes.
#   4. It takes the directions from the texels' outer corners (column 0 is at -1, the last at +1) and the
#   areas from their centres: one bright texel moves by 8 degrees with 4 x 4 faces, 2 with 16 x 16; 1 x 1
#   faces give NaN.
# Versions: spherical-harmonics 0.1.0, rand 0.6.5 (cargo), cubemap-sh 0.2.1, three 0.187.0 (npm).
# Why it matters: nine coefficients are how an environment map gets into a shader or into a table of a light
#   unit. The errors keep the look of plausible light: direction and contrast are off, not the form.
# Source: both call their output spherical harmonics coefficients; cubemap-sh "in linear color space", its own
#   comment calls Float32Array faces HDR. Sloan, "Stupid Spherical Harmonics (SH) Tricks", appendix: the nine
#   polynomials; they are orthonormal, so x has sqrt(4 pi / 3) = 2.0467 and x y has sqrt(4 pi / 15) = 0.9153.
#   three projects and evaluates with them, as a second opinion. OpenGL 4.6, section 8.14: the centre
#   of texel i of n is at (i + 1/2) / n.
set -euo pipefail

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
mkdir src
cat > Cargo.toml <<'TOML'
[package]
name = "harmonics"
version = "0.1.0"
edition = "2021"

[dependencies]
spherical-harmonics = "=0.1.0"
rand = "=0.6.5"

[profile.dev]
debug = false
TOML
cat > src/main.rs <<'RUST'
use rand::{rngs::StdRng, SeedableRng};
use spherical_harmonics::{project_fn, project_sparse_samples};

type Direction = (f32, f32, f32);

fn direction(phi: f32, theta: f32) -> Direction {
    (theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

fn main() {
    let mut random = StdRng::seed_from_u64(1);
    let functions: [(&str, fn(Direction) -> f32); 7] = [
        ("1", |_| 1.0),
        ("z", |d| d.2),
        ("x", |d| d.0),
        ("x z", |d| d.0 * d.2),
        ("x y", |d| d.0 * d.1),
        ("x^2 - y^2", |d| d.0 * d.0 - d.1 * d.1),
        ("1 + x", |d| 1.0 + d.0),
    ];
    for (title, f) in functions {
        println!("{title};{:?}", project_fn(2, 40000, &mut random, |phi, theta| f(direction(phi, theta))));
    }
    // evenly spread directions
    let dirs: Vec<Direction> = (0..1000)
        .map(|i| direction(i as f32 * 2.399_963_2, (1.0 - (2.0 * i as f32 + 1.0) / 1000.0f32).acos()))
        .collect();
    let values = dirs.iter().map(|d| 1.0 + d.2).collect();
    println!("fit of 1 + z;{:?}", project_sparse_samples(2, &dirs, &values));
}
RUST
cargo run -q > rust.txt 2> cargo.log || { tail -n 5 cargo.log >&2; exit 1; }

npm init -y > /dev/null
nice npm install --silent --no-audit --no-fund --no-update-notifier --ignore-scripts cubemap-sh@0.2.1 three@0.187.0 > npm.log 2>&1 ||
  { cat npm.log >&2; exit 1; }
cat > run.mjs <<'JS'
import { readFileSync } from "node:fs";
import project from "cubemap-sh";
import { SphericalHarmonics3, Vector3 } from "three";

function check(good, what) {
  if (!good) { console.error("behaviour changed: " + what); process.exit(1); }
}

// 1, 2. the Rust crate; indices 1, 3, 5 and 7 hold odd m, whose sign is a matter of choice
const rust = Object.fromEntries(readFileSync("rust.txt", "utf8").trim().split("\n").map((line) => {
  const [title, list] = line.split(";");
  return [title, JSON.parse(list).map((c, k) => (k % 2 ? -c : c))];
}));
function byThree(f) {
  const sum = new Array(9).fill(0);
  const basis = new Array(9).fill(0);
  const count = 4000;
  for (let i = 0; i < count; i++) {
    const d = new Vector3().setFromSphericalCoords(1, Math.acos(1 - (2 * i + 1) / count), i * 2.3999632);
    SphericalHarmonics3.getBasisAt(d, basis);
    basis.forEach((b, k) => { sum[k] += f(d) * b * 4 * Math.PI / count; });
  }
  return sum;
}
const pi = Math.PI;
for (const [title, index, right, factor, f] of [
  ["1", 0, Math.sqrt(4 * pi), 1, () => 1],
  ["z", 2, Math.sqrt(4 * pi / 3), 1, (d) => d.z],
  ["x", 3, Math.sqrt(4 * pi / 3), 3 * pi / 8, (d) => d.x],
  ["x z", 7, Math.sqrt(4 * pi / 15), 15 * pi / 32, (d) => d.x * d.z],
  ["x y", 4, Math.sqrt(4 * pi / 15), 2, (d) => d.x * d.y],
  ["x^2 - y^2", 8, Math.sqrt(16 * pi / 15), 2, (d) => d.x * d.x - d.y * d.y],
]) {
  const got = rust[title][index];
  const peer = byThree(f)[index];
  console.log(`${title}: right ${right.toFixed(4)}, three ${peer.toFixed(4)}, spherical-harmonics ${got.toFixed(4)}`);
  check(Math.abs(peer - right) < 0.005, "three differs from the polynomials");
  check(Math.abs(got / right - factor) < 0.01, "another factor for " + title);
}
const meant = new SphericalHarmonics3();
rust["1 + x"].forEach((c, k) => meant.coefficients[k].setScalar(c));
const dark = meant.getAt(new Vector3(-1, 0, 0), new Vector3()).x;
console.log(`1 + x projected by spherical-harmonics, evaluated by three at -x: ${dark.toFixed(3)} in place of 0`);
check(dark < -0.15, "1 + x comes back");
const fit = rust["fit of 1 + z"];
console.log(`fit of 1 + z: mean ${fit[0].toFixed(3)} (right 3.545), z ${fit[2].toFixed(3)} (right 2.047)`);
check(fit[0] < 1 && fit[2] > 4, "directions below the horizon are kept");

// 3, 4. cubemap-sh
const room = (Kind, white, n) => Array.from({ length: 6 }, () => new Kind(n * n * 4).fill(white));
const bytes = project(room(Uint8Array, 255, 16), 16, 4)[0][0];
const floats = project(room(Float32Array, 1, 16), 16, 4)[0][0];
console.log(`white room, mean: bytes of 255 ${bytes.toFixed(4)}, floats of 1.0 ${floats.toFixed(6)}, ratio ${(bytes / floats).toFixed(2)}`);
check(Math.abs(bytes - 0.9856) < 0.001 && Math.abs(bytes / floats - 255) < 0.01, "floats are not divided by 255");

// one bright texel in the +X face: u runs along -z, v along -y
for (const [n, least] of [[2, 18], [4, 8], [16, 1.7], [128, 0.2]]) {
  const faces = room(Float32Array, 0, n);
  const row = n / 2 - 1;
  faces[0].fill(255, row * n * 4, row * n * 4 + 4);
  const sh = project(faces, n, 4);
  const found = [1, 2, 3].map((k) => sh[k][0]);
  const right = [1, 1 - (2 * row + 1) / n, 1 - 1 / n];
  const dot = found.reduce((sum, v, k) => sum + v * right[k], 0) / Math.hypot(...found) / Math.hypot(...right);
  const angle = Math.acos(dot) * 180 / Math.PI;
  console.log(`${n} x ${n} faces: a texel at the edge of +X is moved by ${angle.toFixed(2)} degrees`);
  check(angle > least, "texels are where they belong");
}
const single = project(room(Float32Array, 1, 1), 1, 4);
console.log(`1 x 1 faces: ${single.slice(1, 4).map((c) => c[0]).join(" ")}`);
check(single.slice(1, 4).every((c) => Number.isNaN(c[0])), "1 x 1 faces work");
JS
node run.mjs
echo "as described"
