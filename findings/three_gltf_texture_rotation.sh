#!/usr/bin/env bash
# three: a rotated texture, written as glTF and read back by the same release, tiles along the other axis and loses its centre.
#
# Expected: GLTFExporter and GLTFLoader of one release are inverse to each other for what glTF can hold, and KHR_texture_transform
#   holds an offset, a rotation and a scale. With these a rotation about any centre can be written, as a rotation and an offset.
# Seen: 1. three rotates first and then multiplies by repeat, glTF scales first and then rotates. The loader of this release
#   translates between the two, the exporter copies the numbers. A normal map with repeat (4, 1) and a quarter turn lies 4 times
#   along v, and comes back 4 times along u. With an eighth turn its tiles come back skewed.
#   2. The centre is dropped: a rotation about (0.5, 0.5) becomes one about (0, 0); repeat with a centre is moved as well.
#   3. A matrix that was set directly (matrixAutoUpdate false) is dropped as a whole. No warning in any case.
#   With equal scales and no centre all is right. Babylon.js reads the exported files as three's own loader does.
# Versions: three 0.187.0, @babylonjs/core 9.28.0, @babylonjs/loaders 9.28.0 (all npm).
# Why it matters: glTF is how a model with its normal map gets from such a program to a reference renderer or a test of hardware.
#   The grooves then run along the other axis, and nothing says that the file is not what was on the screen.
#   A model that was loaded from glTF is written again as it was, so a test with loaded models passes.
# Source: KHR_texture_transform: the matrix is translation * rotation * scale. three's documentation of Texture: center is the
#   point of the rotation; matrixAutoUpdate is set to false to give the matrix by oneself. The documentation of GLTFExporter lists
#   KHR_texture_transform as supported, and no limit of it.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
cd "$T"
echo '{"private": true, "type": "module"}' > package.json
nice npm install --silent --no-audit --no-fund --no-update-notifier three@0.187.0 @babylonjs/core@9.28.0 @babylonjs/loaders@9.28.0 > npm.log 2>&1 || {
  cat npm.log
  exit 1
}
cat > check.js <<'JS'
// What a browser has and Node has not: every picture becomes the same PNG of one pixel; only its transform is of interest here.
const png = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==";
globalThis.ImageData = class {};
globalThis.ProgressEvent = class extends Event {};
globalThis.OffscreenCanvas = class {
  getContext() { return { translate() {}, scale() {}, putImageData() {}, drawImage() {} }; }
  src = png;
};
globalThis.FileReader = class {
  async readAsDataURL(blob) {
    this.result = `data:${blob.type};base64,${Buffer.from(await blob.arrayBuffer()).toString("base64")}`;
    this.onloadend();
  }
};
const THREE = await import("three");
const { GLTFExporter } = await import("three/addons/exporters/GLTFExporter.js");
const { GLTFLoader } = await import("three/addons/loaders/GLTFLoader.js");
const { NullEngine } = await import("@babylonjs/core/Engines/nullEngine.js");
const { Logger } = await import("@babylonjs/core/Misc/logger.js");
const { Scene } = await import("@babylonjs/core/scene.js");
const { AppendSceneAsync } = await import("@babylonjs/core/Loading/sceneLoader.js");
await import("@babylonjs/loaders/glTF/2.0/index.js");
Logger.LogLevels = Logger.ErrorLogLevel;

const picture = () => new THREE.DataTexture(new Uint8Array(64).fill(128), 4, 4);
const warnings = [];
console.warn = (...text) => warnings.push(text.join(" "));
const rows = (texture) => {  // u' = a u + b v + c, then the same for v'
  if (texture.matrixAutoUpdate) texture.updateMatrix();
  const e = texture.matrix.elements;
  return [e[0], e[3], e[6], e[1], e[4], e[7]];
};
const same = (a, b) => a.every((value, i) => Math.abs(value - b[i]) < 1e-4);
const text = (m) => "[" + m.map((value) => +value.toFixed(3) + 0).join(" ") + "]";
const fail = (message) => { console.log("behaviour changed: " + message); process.exit(1); };

async function exported(normalMap) {
  const material = new THREE.MeshStandardMaterial({ normalMap, normalScale: new THREE.Vector2(1, -1) });
  return new GLTFExporter().parseAsync(new THREE.Mesh(new THREE.PlaneGeometry(1, 1), material), { binary: false });
}

async function readByThree(gltf) {
  const loader = new GLTFLoader();
  loader.register(() => ({ name: "picture", loadTexture: async () => picture() }));
  let found;
  (await loader.parseAsync(JSON.stringify(gltf), "")).scene.traverse((node) => { found ??= node.material?.normalMap; });
  return found;
}

async function readByBabylon(gltf) {
  const scene = new Scene(new NullEngine());
  await AppendSceneAsync("data:" + JSON.stringify(gltf), scene, { pluginExtension: ".gltf" });
  const m = scene.materials[0].bumpTexture.getTextureMatrix().asArray();
  return [m[0], m[4], m[8], m[1], m[5], m[9]];
}

const turn = Math.PI / 2;
const cases = [
  ["repeat (4, 1)", true, (t) => t.repeat.set(4, 1)],
  ["turn 90", true, (t) => { t.rotation = turn; }],
  ["repeat (2, 2), turn 30, offset (0.1, 0.2)", true, (t) => { t.repeat.set(2, 2); t.rotation = turn / 3; t.offset.set(0.1, 0.2); }],
  ["repeat (4, 1), turn 90", false, (t) => { t.repeat.set(4, 1); t.rotation = turn; }],
  ["repeat (4, 1), turn 45", false, (t) => { t.repeat.set(4, 1); t.rotation = turn / 2; }],
  ["turn 90, centre (0.5, 0.5)", false, (t) => { t.rotation = turn; t.center.set(0.5, 0.5); }],
  ["repeat (3, 3), centre (0.5, 0.5)", false, (t) => { t.repeat.set(3, 3); t.center.set(0.5, 0.5); }],
  ["matrix of a scale by 2, set directly", false, (t) => { t.matrixAutoUpdate = false; t.matrix.makeScale(2, 2); }],
];
for (const [name, right, set] of cases) {
  const texture = picture();
  set(texture);
  const before = rows(texture);
  const gltf = await exported(texture);
  const again = await readByThree(gltf);
  const after = rows(again);
  const babylon = await readByBabylon(gltf);
  const stored = gltf.materials[0].normalTexture.extensions?.KHR_texture_transform ?? {};
  console.log(`${name}: ${text(before)}; read back ${text(after)}, Babylon ${text(babylon)}${same(before, after) ? "" : " DIFFERENT"}`);
  // By hand: scale, then rotation (positive from u towards -v), then offset.
  const [sx, sy] = stored.scale ?? [1, 1], [tx, ty] = stored.offset ?? [0, 0], angle = stored.rotation ?? 0;
  const c = Math.cos(angle), s = Math.sin(angle);
  if (!same(after, [sx * c, sy * s, tx, -sx * s, sy * c, ty]) || !same(babylon, after)) fail("the readers do not agree with the extension's text");
  if (same(before, after) !== right) fail(name);
  if (right) continue;
  const twice = await readByThree(await exported(again));
  if (!same(rows(twice), after)) fail("a loaded texture is no longer written as it was");
}
if (warnings.length) fail("there are warnings: " + warnings);
console.log("warnings: none");
process.exit(0);
JS
nice node check.js
echo "as described"
