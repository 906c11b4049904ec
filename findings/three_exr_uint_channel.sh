#!/usr/bin/env bash
# An unused integer channel in an EXR makes three.js read wrong colours.
#
# Expected: a part with R, G, B as float and an object number "id" as UINT is
#   plain OpenEXR. A loader that wants the colours skips "id". If it could not
#   cope with the type, it would say so, as it does when R is UINT itself.
# Seen: the colours are right without compression and with ZIPS (one line in a
#   block). With ZIP (16 lines in a block) EXRLoader counts a UINT sample as 0
#   bytes, not 4, when it steps from line to line. The first line of each block
#   is right; all others are taken from the wrong place, across channels and
#   sample borders: 90 % of a picture of 20 lines. No error, no warning.
# Versions: three 0.187.0 (EXRLoader); OpenEXR 3.5.3 writes, OpenImageIO
#   3.2.2.0 and OpenEXR itself read the same file right.
# Why it matters: environments and reference pictures from a renderer often
#   carry a number or mask channel beside the light. A viewer built on three.js
#   then shows noise where an integer pipeline reads the picture as it is.
# Source: OpenEXR file layout, channel list: pixel types UINT (4 bytes), HALF
#   (2), FLOAT (4); any mix in one part is allowed.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install OpenEXR==3.5.3 OpenImageIO==3.2.2.0 numpy==2.4.6
cd "$T"
echo '{"private":true,"type":"module"}' > package.json
nice npm install --silent --no-audit --no-fund three@0.187.0
nice v/bin/python - <<'PY'
import json
import numpy as np, OpenEXR, OpenImageIO as oiio
h, w = 20, 64
g = np.linspace(0, 1, h * w, dtype="f4").reshape(h, w)
rgb = {"R": g, "G": g / 2, "B": g / 4}
for comp in ("NO", "ZIPS", "ZIP"):
    for tag, more in (("plain", {}), ("id", {"id": np.full((h, w), 7, "u4")})):
        name = f"{tag}_{comp}.exr"
        head = {"compression": getattr(OpenEXR, comp + "_COMPRESSION"), "type": OpenEXR.scanlineimage}
        with OpenEXR.File(head, {k: v.copy() for k, v in {**rgb, **more}.items()}) as f:
            f.write(name)
        inp = oiio.ImageInput.open(name)
        px = np.asarray(inp.read_image(0, 0, 0, 3, "float"))
        assert np.array_equal(px, np.stack([g, g / 2, g / 4], -1)), name
        inp.close()
json.dump([float(x) for x in g[10, 3] * np.array([1, .5, .25], "f4")], open("want.json", "w"))
print("OpenImageIO reads all six files right")
PY
cat > read.mjs <<'JS'
import fs from 'node:fs';
import { FloatType } from 'three';
import { EXRLoader } from 'three/addons/loaders/EXRLoader.js';
const h = 20, w = 64;
let bad = {};
console.warn = (...m) => { console.log('warning:', ...m); bad.warned = true; };
for (const tag of ['plain', 'id']) for (const comp of ['NO', 'ZIPS', 'ZIP']) {
  const raw = fs.readFileSync(`${tag}_${comp}.exr`);
  const loader = new EXRLoader();
  loader.setDataType(FloatType);
  const r = loader.parse(raw.buffer.slice(raw.byteOffset, raw.byteOffset + raw.length));
  let wrong = 0, n = r.data.length / (w * h);
  for (let i = 0; i < w * h; i++) {
    const y = h - 1 - Math.floor(i / w), v = (y * w + i % w) / (w * h - 1);
    for (let c = 0; c < 3; c++) if (!(Math.abs(r.data[i * n + c] - v / [1, 2, 4][c]) < 1e-6)) wrong++;
  }
  bad[`${tag}_${comp}`] = wrong;
  const k = ((h - 1 - 10) * w + 3) * n;
  console.log(`${tag}_${comp}.exr: ${wrong} of ${3 * w * h} samples wrong, pixel (3, 10) =`,
    Array.from(r.data.slice(k, k + 3), (x) => Number(x).toPrecision(5)).join(' '));
}
console.log('right at (3, 10):', JSON.parse(fs.readFileSync('want.json')).map((x) => x.toPrecision(5)).join(' '));
const ok = !bad.warned && bad.plain_NO + bad.plain_ZIP + bad.plain_ZIPS + bad.id_NO
  + bad.id_ZIPS === 0 && bad.id_ZIP > 3 * w * (h - 2) * 0.9;
if (!ok) { console.error('behaviour changed: EXRLoader treats the UINT channel differently'); process.exit(1); }
JS
nice timeout 120 node read.mjs
echo "as described"
