#!/usr/bin/env bash
# Babylon.js: one environment gives two diffuse lights. Its spherical polynomial, the form that .env files
# keep, contains the cosine twice, and changes of it never reach the shader.
#
# Expected: SphericalHarmonics and SphericalPolynomial are two ways to write the same function of the
#   normal; FromHarmonics changes the form, not the light. What is scaled gets scaled.
# Seen: 1. ConvertCubeMapToSphericalPolynomial multiplies the bands by 1, 2/3 and 1/4 (cosine lobe, divided
#   by pi), then FromHarmonics does it again: its factors 1.02333, 0.858086 .. are those of Ramamoorthi and
#   Hanrahan, made for radiance. So the polynomial has 4/9 and 1/16. Under a sky of 1 above and 0 below,
#   a face that looks down gets 0.167 in place of 0, one that looks up 0.833 in place of 1.
#   The harmonics kept inside the same object are right, and so is the default shader that uses them.
#   A material with useSphericalHarmonics = false evaluates the polynomial.
#   2. The coefficients x .. xy are public, and so are scaleInPlace and addAmbient. With the default
#   shader they do nothing: it takes preScaledHarmonics, which keeps the old harmonics.
#   3. preScaledHarmonics changes the harmonics that were handed to FromHarmonics: made again from the
#   same harmonics after that, the polynomial of a white room is 0.28 in place of 1.
# Versions: @babylonjs/core 9.28.0, three 0.187.0 (npm).
# Why it matters: the `irradiance` entry of a .env file is this polynomial. A renderer or a lighting table
#   in hardware that evaluates it as named gets flat light; the mean is right, so nothing looks broken.
#   Babylon itself turns it back with the inverse factors and hides the second cosine.
# Source: comments of the library: the harmonics after the two conversions represent "outgoing radiance";
#   CubeMapToSphericalPolynomialTools: "the first 3 orders .. used in the lighting". It says of
#   useSphericalHarmonics that harmonics are closer to the truth, but of no second convolution. Ramamoorthi
#   and Hanrahan, "An Efficient Representation for Irradiance Environment Maps", equations 9 and 13:
#   the constants apply to coefficients of radiance. The right values here: a sum over the cube's
#   texels of light times cosine, and three's SphericalHarmonics3. The shader's own text is run.
set -euo pipefail

dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
npm init -y > /dev/null
nice npm install --silent --no-audit --no-fund --no-update-notifier --ignore-scripts @babylonjs/core@9.28.0 three@0.187.0 > npm.log 2>&1 ||
  { cat npm.log >&2; exit 1; }
cat > run.mjs <<'JS'
import { CubeMapToSphericalPolynomialTools } from "@babylonjs/core/Misc/HighDynamicRange/cubemapToSphericalPolynomial.js";
import { SphericalHarmonics, SphericalPolynomial } from "@babylonjs/core/Maths/sphericalPolynomial.js";
import { UploadEnvSpherical } from "@babylonjs/core/Misc/environmentTextureTools.js";
import { harmonicsFunctions } from "@babylonjs/core/Shaders/ShadersInclude/harmonicsFunctions.js";
import { SphericalHarmonics3, Vector3 } from "three";

function check(good, what) {
  if (!good) { console.error("behaviour changed: " + what); process.exit(1); }
}

// both branches of the fragment shader, for the red channel; the uniforms are members of u
const bodies = [...harmonicsFunctions.shader.matchAll(/computeEnvironmentIrradiance\(vec3 normal\)\s*\{([^}]*)\}/g)].map((m) => m[1]);
check(bodies.length === 2, "the shader has other branches");
const [harmonicShader, polynomialShader] = bodies.map((body) =>
  new Function("normal", "u", body.replace(/\b(vec3|float) (?=\w+=)/g, "const ").replace(/\.rgb/g, "").replace(/\bv(Spherical\w+)/g, "u.$1")));

// the uniforms, as materialHelper.functions.js binds them
function byHarmonics(p, [x, y, z]) {
  const h = p.preScaledHarmonics;
  const u = {};
  for (const name of ["l00", "l1_1", "l10", "l11", "l2_2", "l2_1", "l20", "l21", "l22"]) u["Spherical" + name.toUpperCase()] = h[name].x;
  return harmonicShader({ x, y, z }, u);
}
function byPolynomial(p, [x, y, z]) {
  return polynomialShader({ x, y, z }, {
    SphericalX: p.x.x, SphericalY: p.y.x, SphericalZ: p.z.x, SphericalXX_ZZ: p.xx.x - p.zz.x, SphericalYY_ZZ: p.yy.x - p.zz.x,
    SphericalZZ: p.zz.x, SphericalXY: p.xy.x, SphericalYZ: p.yz.x, SphericalZX: p.zx.x });
}

// cube map faces: direction of a rising column, of a rising row, and of the face
const n = 32;
const axes = {
  right: [[0, 0, -1], [0, -1, 0], [1, 0, 0]], left: [[0, 0, 1], [0, -1, 0], [-1, 0, 0]],
  up: [[1, 0, 0], [0, 0, 1], [0, 1, 0]], down: [[1, 0, 0], [0, 0, -1], [0, -1, 0]],
  front: [[1, 0, 0], [0, -1, 0], [0, 0, 1]], back: [[-1, 0, 0], [0, -1, 0], [0, 0, -1]],
};
function environment(light) {
  const cube = { size: n, format: 5, type: 1, gammaSpace: false };
  const texels = [];
  for (const [name, [s, t, m]] of Object.entries(axes)) {
    const face = cube[name] = new Float32Array(n * n * 4).fill(1);
    for (let j = 0; j < n; j++) for (let i = 0; i < n; i++) {
      const [u, v] = [(2 * i + 1) / n - 1, (2 * j + 1) / n - 1];
      const d = [0, 1, 2].map((k) => s[k] * u + t[k] * v + m[k]);
      const r = Math.hypot(...d);
      const unit = d.map((c) => c / r);
      const value = light(unit);
      face.fill(value, (j * n + i) * 4, (j * n + i) * 4 + 3);
      texels.push([unit, value, 4 / (n * n) / r ** 3]);
    }
  }
  return [cube, texels];
}
function bySum(texels, normal) {
  return texels.reduce((sum, [d, value, area]) => sum + value * area * Math.max(0, d[0] * normal[0] + d[1] * normal[1] + d[2] * normal[2]), 0) / Math.PI;
}
function byThree(texels, normal) {
  const sh = new SphericalHarmonics3();
  const basis = new Array(9).fill(0);
  for (const [d, value, area] of texels) {
    SphericalHarmonics3.getBasisAt(new Vector3(...d), basis);
    basis.forEach((b, k) => { sh.coefficients[k].x += b * value * area; });
  }
  return sh.getIrradianceAt(new Vector3(...normal), new Vector3()).x / Math.PI;
}

const h = Math.SQRT1_2;
const normals = [[0, 1, 0], [0, -1, 0], [1, 0, 0], [h, 0, h]];
const lights = {
  "sky 1, ground 0": (d) => (d[1] > 0 ? 1 : 0),
  "1 + x": (d) => 1 + d[0],
  "1 + x z": (d) => 1 + d[0] * d[2],
};
const text = (row) => row.map((v) => v.toFixed(3)).join(" ");
let sky;
for (const [title, light] of Object.entries(lights)) {
  const [cube, texels] = environment(light);
  const p = CubeMapToSphericalPolynomialTools.ConvertCubeMapToSphericalPolynomial(cube);
  sky ??= p;
  const rows = [bySum, byThree].map((f) => normals.map((v) => f(texels, v)));
  rows.push(normals.map((v) => byHarmonics(p, v)), normals.map((v) => byPolynomial(p, v)));
  console.log(`${title}: normals up, down, x, x + z`);
  ["sum over texels", "three", "Babylon's harmonics", "Babylon's polynomial"].forEach((name, k) => console.log(`  ${name.padEnd(21)} ${text(rows[k])}`));
  const worst = (a, b) => Math.max(...a.map((v, k) => Math.abs(v - b[k])));
  check(worst(rows[0], rows[1]) < 0.01 && worst(rows[0], rows[2]) < 0.01, "the harmonics are not right");
  check(worst(rows[0], rows[3]) > 0.09, "the polynomial is right");
}
const [, texels] = environment((d) => 1 + d[0]);
const twice = CubeMapToSphericalPolynomialTools.ConvertCubeMapToSphericalPolynomial(environment((d) => 2 + d[0] + d[0] * d[1])[0]);
console.log(`2 + x + x y: coefficient of x is ${twice.x.x.toFixed(4)} (2/3 is right, 4/9 the square), of x y ${twice.xy.x.toFixed(4)} (1/4 and 1/16)`);
check(Math.abs(twice.x.x - 4 / 9) < 0.002 && Math.abs(twice.xy.x - 1 / 16) < 0.002, "the factors are no squares");

// what a .env file keeps, and what Babylon makes of it
const entry = Object.fromEntries(["x", "y", "z", "xx", "yy", "zz", "yz", "zx", "xy"].map((k) => [k, sky[k].asArray()]));
const texture = {};
UploadEnvSpherical(texture, { version: 2, width: 1, imageType: "image/png", specular: { mipmaps: [] }, irradiance: entry });
const loaded = texture._sphericalPolynomial;
console.log(`irradiance of a .env with that sky: as written ${text(normals.map((v) => byPolynomial(loaded, v)))}, shown by Babylon ${
  text(normals.map((v) => byHarmonics(loaded, v)))}`);
check(Math.abs(byHarmonics(loaded, [0, -1, 0])) < 0.01 && byPolynomial(loaded, [0, -1, 0]) > 0.15, "the .env entry");

// 2. scaling and adding
const before = byHarmonics(sky, [0, 1, 0]);
sky.scaleInPlace(3);
sky.addAmbient({ r: 5, g: 5, b: 5 });
const after = [byHarmonics(sky, [0, 1, 0]), byPolynomial(sky, [0, 1, 0])];
console.log(`scaled by 3 and 5 added, face up: ${before.toFixed(3)} becomes ${after[0].toFixed(3)} by the default shader, ${after[1].toFixed(3)} by the other`);
check(after[0] === before && after[1] > 7, "changes reach the shader");

// 3. the caller's harmonics
const white = new SphericalHarmonics();
for (const [d, , area] of texels) white.addLight({ x: d[0], y: d[1], z: d[2] }, { r: 1, g: 1, b: 1 }, area);
white.convertIncidentRadianceToIrradiance();
white.convertIrradianceToLambertianRadiance();
const first = SphericalPolynomial.FromHarmonics(white);
const one = byPolynomial(first, [0, 1, 0]);
first.preScaledHarmonics;
const again = byPolynomial(SphericalPolynomial.FromHarmonics(white), [0, 1, 0]);
console.log(`white room: ${one.toFixed(3)}, from the same harmonics after preScaledHarmonics was read ${again.toFixed(3)}`);
check(Math.abs(one - 1) < 0.01 && Math.abs(again - 0.282) < 0.01, "the harmonics are copied");
JS
node run.mjs
echo "as described"
