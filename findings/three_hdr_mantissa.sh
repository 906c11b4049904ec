#!/usr/bin/env bash
# One Radiance HDR pixel has three values, depending on who reads it.
#
# Expected: the four bytes R, G, B, E of a Radiance picture stand for one
#   colour. The mantissa has 8 bits, so readers divide by 256.
# Seen: OpenCV and OpenImageIO give m / 256 * 2^(E-128). three.js divides by 255
#   instead. libvips adds one half, (m + 0.5) / 256 * 2^(E-128), as Radiance
#   itself does. So three.js is 0.39 % brighter than OpenCV in all pixels, and
#   libvips is brighter by 0.2 % where the mantissa is 255 and by 50 % where it
#   is 1 (the weak channels of a saturated light). In half float, its default,
#   three.js also cuts at 65504: a sun of 131072 loses half its light, without
#   a warning.
# Versions: opencv-python-headless 5.0.0.93, OpenImageIO 3.2.2.0,
#   pyvips 3.2.0 with pyvips-binary 8.18.7, three 0.187.0 (HDRLoader).
# Why it matters: a test of an environment mapper that compares with pictures
#   of another program to one code in 8 bits (0.4 %) fails on the reader alone.
#   White (1.0) as written by OpenCV is 1.0039 in three.js.
# Source: G. Ward, "Real Pixels", Graphics Gems II, and Radiance's color.c (the
#   half); m / 256 follows B. Walter's rgbe.c. 255 follows neither.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install opencv-python-headless==5.0.0.93 OpenImageIO==3.2.2.0 numpy==2.4.6 \
  pyvips==3.2.0 pyvips-binary==8.18.7 cffi==2.0.0
cd "$T"
echo '{"private":true,"type":"module"}' > package.json
nice npm install --silent --no-audit --no-fund three@0.187.0
nice v/bin/python - <<'PY'
import json, sys
import numpy as np, cv2, pyvips, OpenImageIO as oiio
px = [(128, 1, 255, 129), (255, 255, 1, 128), (128, 64, 32, 146), (200, 100, 50, 120)]
with open("a.hdr", "wb") as f:
    f.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 4\n" + b"".join(bytes(p) for p in px))
cv2.imwrite("white.hdr", np.ones((1, 4, 3), "f4"))
a = cv2.imread("a.hdr", cv2.IMREAD_UNCHANGED)[0, :, ::-1]
inp = oiio.ImageInput.open("a.hdr")
b = np.asarray(inp.read_image("float"))[0]
want = np.array([[m * 2.0 ** (p[3] - 136) for m in p[:3]] for p in px])
ward = np.array([[(m + 0.5) * 2.0 ** (p[3] - 136) for m in p[:3]] for p in px])
raw = pyvips.Image.new_from_memory(b"".join(bytes(p) for p in px), 4, 1, 4, "uchar")
v = raw.copy(interpretation="scrgb").copy(coding="rad", interpretation="scrgb").rad2float()
v = np.array([v(x, 0) for x in range(4)])
if not np.array_equal(v, ward):
    sys.exit("behaviour changed: libvips no longer adds one half")
if not (np.array_equal(a, want) and np.array_equal(b, want)):
    sys.exit("behaviour changed: OpenCV or OpenImageIO no longer reads m / 256")
json.dump({"div256": a.tolist(), "half": v.tolist(), "px": px}, open("ref.json", "w"))
PY
cat > read.mjs <<'JS'
import fs from 'node:fs';
import { DataUtils, FloatType } from 'three';
import { HDRLoader } from 'three/addons/loaders/HDRLoader.js';
const ref = JSON.parse(fs.readFileSync('ref.json'));
const parse = (file, type) => {
  const raw = fs.readFileSync(file), l = new HDRLoader();
  if (type !== undefined) l.setDataType(type);
  return l.parse(raw.buffer.slice(raw.byteOffset, raw.byteOffset + raw.length)).data;
};
const f = parse('a.hdr', FloatType), half = parse('a.hdr');
const n = f.length / 4;
let ok = true;
ref.px.forEach((p, i) => {
  const t = [0, 1, 2].map((c) => f[i * n + c]);
  const s = (v) => v.map((x) => x.toPrecision(6)).join(' ');
  console.log(`bytes ${p.join(' ')}: OpenCV, OpenImageIO ${s(ref.div256[i])} | three.js ${s(t)} | libvips ${s(ref.half[i])}`);
  for (let c = 0; c < 3; c++) ok &&= Math.abs(t[c] / ref.div256[i][c] - 256 / 255) < 1e-6;
});
const white = parse('white.hdr', FloatType)[0];
const cut = DataUtils.fromHalfFloat(half[2 * n]);
console.log(`1.0 written by OpenCV is ${white.toPrecision(6)} in three.js; 131072 is ${cut} in its default type`);
ok &&= Math.abs(white - 256 / 255) < 1e-6 && cut === 65504;
if (!ok) { console.error('behaviour changed: three.js no longer divides by 255, or no longer cuts at 65504'); process.exit(1); }
JS
nice node read.mjs
echo "as described"
