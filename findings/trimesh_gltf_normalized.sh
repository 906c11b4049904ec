#!/usr/bin/env bash
# trimesh reads normalized integers of glTF as they lie in the file.
#
# Expected: core glTF 2.0 allows texture coordinates and vertex colours as
#   unsigned short with "normalized": true; then c stands for c / 65535. A
#   reader that takes such a file gives the same mesh as from floats.
# Seen: texture coordinates come out as 65535 instead of 1. The flip of v is
#   done in 16 bits and wraps: v = 0.5 (32768) becomes 32769. Of a colour only
#   the low byte is kept: half intensity (32768) is 0, and 256 (nearly black)
#   is 0 while 255 (darker still) is full intensity. No warning.
# Versions: trimesh 5.2.0, numpy 2.4.6; @gltf-transform/core 4.5.1 reads the
#   same file right and serves as second opinion.
# Why it matters: mesh optimizers write normalized shorts by default. A bump or
#   normal map is then sampled at 65535 times the coordinate, which after
#   wrapping looks like noise, not like a missing feature.
# Source: glTF 2.0, 3.6.2.2 (accessor data types, normalized) and 3.7.2.1
#   (TEXCOORD_n and COLOR_n may be normalized unsigned byte or short).
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install trimesh==5.2.0 numpy==2.4.6 pillow==12.3.0
cd "$T"
echo '{"private":true,"type":"module"}' > package.json
nice npm install --silent --no-audit --no-fund @gltf-transform/core@4.5.1
cat > make.py <<'PY'
import json, struct, sys
import numpy as np

def write(name, prim_attr, arrays):
    blob, views, acc, attrs = b"", [], [], {}
    for (semantic, kind, ctype, norm), a in zip(prim_attr, arrays):
        raw = a.tobytes()
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(raw)})
        e = {"bufferView": len(views) - 1, "componentType": ctype, "count": len(a), "type": kind}
        if norm:
            e["normalized"] = True
        if semantic == "POSITION":
            e["min"], e["max"] = a.min(0).tolist(), a.max(0).tolist()
        attrs[semantic] = len(acc)
        acc.append(e)
        blob += raw
    doc = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
           "materials": [{"pbrMetallicRoughness": {}}],
           "meshes": [{"primitives": [{"attributes": attrs, "material": 0}]}],
           "buffers": [{"byteLength": len(blob)}], "bufferViews": views, "accessors": acc}
    if "COLOR_0" in attrs:
        del doc["meshes"][0]["primitives"][0]["material"], doc["materials"]
    j = json.dumps(doc).encode()
    j += b" " * (-len(j) % 4)
    blob += b"\0" * (-len(blob) % 4)
    with open(name, "wb") as f:
        f.write(struct.pack("<4sII", b"glTF", 2, 28 + len(j) + len(blob)))
        f.write(struct.pack("<I4s", len(j), b"JSON") + j + struct.pack("<I4s", len(blob), b"BIN\0") + blob)

P = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4")
UV = np.array([[0, 0], [65535, 0], [0, 32768]], "<u2")
C = np.array([[32768, 65535, 0, 65535], [256, 65535, 0, 65535], [255, 65535, 0, 65535]], "<u2")
pos = ("POSITION", "VEC3", 5126, False)
write("uv_short.glb", [pos, ("TEXCOORD_0", "VEC2", 5123, True)], [P, UV])
write("uv_float.glb", [pos, ("TEXCOORD_0", "VEC2", 5126, False)], [P, (UV / 65535).astype("<f4")])
write("color_short.glb", [pos, ("COLOR_0", "VEC4", 5123, True)], [P, C])
PY
cat > read.py <<'PY'
import sys
import trimesh
load = lambda n: trimesh.load(n, force="mesh", process=False)
short, flt = load("uv_short.glb").visual.uv, load("uv_float.glb").visual.uv
col = load("color_short.glb").visual.vertex_colors
print("trimesh, uv from floats:           ", [[round(float(x), 4) for x in r] for r in flt])
print("trimesh, uv from normalized shorts:", [[round(float(x), 4) for x in r] for r in short])
print("trimesh, red of 32768, 256, 255:   ", [int(c[0]) for c in col], " right: [128, 1, 1]")
ok = short[1][0] == 65535 and short[2][1] == 32769 and abs(flt[2][1] - 0.5) < 1e-4 \
     and [int(c[0]) for c in col] == [0, 0, 255]
if not ok:
    sys.exit("behaviour changed: trimesh no longer gives raw integers here")
PY
cat > second.mjs <<'JS'
import { NodeIO } from '@gltf-transform/core';
const at = async (file, name) => {
  const prim = (await new NodeIO().read(file)).getRoot().listMeshes()[0].listPrimitives()[0];
  const a = prim.getAttribute(name);
  return [0, 1, 2].map((i) => a.getElement(i, []));
};
const uv = await at('uv_short.glb', 'TEXCOORD_0');
const red = (await at('color_short.glb', 'COLOR_0')).map((c) => Math.round(c[0] * 255));
console.log('gltf-transform, uv:', JSON.stringify(uv), 'red:', JSON.stringify(red));
if (uv[1][0] !== 1 || Math.abs(uv[2][1] - 0.5) > 1e-4 || red.join() !== '128,1,1') {
  console.error('behaviour changed: the second reader disagrees'); process.exit(1);
}
JS
nice v/bin/python make.py
nice node second.mjs
nice v/bin/python read.py
echo "as described"
