#!/usr/bin/env bash
# TIFF, WhiteIsZero: the same height map is turned over or not, depending on its number of bits and on the reader.
#
# Expected: a reader either gives the samples as stored, whatever the tag PhotometricInterpretation says, or
#   turns them so that the largest number is white. The choice does not depend on the number of bits. A copy
#   in the same format means the same picture.
# Seen: a row of white, light gray, black is stored as 0, 1/4, 1, with WhiteIsZero.
#   1. OpenCV, Pillow and OpenImageIO turn 8 bits, but neither 16 bits nor float. pyvips turns 8 and 16 bits, but
#   not float. tifffile turns none.
#   2. OpenCV gives one 16-bit file both ways: IMREAD_GRAYSCALE turns it, IMREAD_ANYDEPTH does not.
#   3. Copies of the 16-bit file by Pillow and OpenImageIO have the same numbers with BlackIsZero: now white is
#   black, for every reader. Copies of the 8-bit file mean the same as before.
#   4. npm: tiff turns float to 4294967295 - x, so that all heights from 0 to 1 are 4294967296. utif2 gives
#   transparent black for float. geotiff's readRGB gives white as 0 at 8 and at 16 bits, black as 1 and 0.
#   None of these gives a warning.
# Versions: opencv-python-headless 5.0.0.93, OpenImageIO 3.2.2.0, pillow 13.0.0, pyvips 3.2.0 with pyvips-binary
#   8.18.7, tifffile 2026.3.3, numpy 2.4.6; npm tiff 7.1.3, utif2 4.1.0, geotiff 3.0.5.
# Why it matters: a height map in 8 bits is a preview of the one in 16 bits. If one of them is turned over, hills
#   are valleys, all bump normals have x and y of the other sign, and a test that compares the two depths fails for
#   no reason in the design. ImageJ writes such files, 16 bits and float, for pictures whose table is inverted.
# Source: TIFF 6.0, PhotometricInterpretation: WhiteIsZero, for bilevel and grayscale images: 0 is imaged as white.
#   It names no number of bits. That OpenCV gives 16 bits unturned is from its issue 9550. Its imread flags differ
#   in the depth of the result, not in its meaning.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install opencv-python-headless==5.0.0.93 OpenImageIO==3.2.2.0 \
  pillow==13.0.0 pyvips==3.2.0 pyvips-binary==8.18.7 tifffile==2026.3.3 numpy==2.4.6
cd "$T"
nice npm install --silent --no-audit --no-fund --ignore-scripts tiff@7.1.3 utif2@4.1.0 geotiff@3.0.5 >/dev/null
nice v/bin/python - <<'PY'
import struct, sys
import cv2, numpy as np, OpenImageIO as oiio, pyvips, tifffile
from PIL import Image

def write(name, row, photometric):
    """A TIFF by hand: one strip, all the fields of a baseline grayscale image and SampleFormat."""
    kind = {"u": 1, "f": 3}[row.dtype.kind]
    data = 8 + 2 + 13 * 12 + 4
    fields = [(256, 3, len(row)), (257, 3, 1), (258, 3, 8 * row.itemsize), (259, 3, 1), (262, 3, photometric), (273, 4, data + 8),
              (277, 3, 1), (278, 3, 1), (279, 4, row.nbytes), (282, 5, data), (283, 5, data), (296, 3, 2), (339, 3, kind)]
    directory = b"".join(struct.pack("<HHIHH" if t == 3 else "<HHII", n, t, 1, v, *([0] if t == 3 else [])) for n, t, v in fields)
    with open(name, "wb") as f:
        f.write(b"II*\0" + struct.pack("<IH", 8, len(fields)) + directory + struct.pack("<III", 0, 72, 1) + row.tobytes())

def by_oiio(name):
    file = oiio.ImageInput.open(name)
    return file.read_image(file.spec().format)[0, :, 0]

readers = {"OpenCV": lambda name: cv2.imread(name, cv2.IMREAD_UNCHANGED)[0], "Pillow": lambda name: np.asarray(Image.open(name))[0],
           "OpenImageIO": by_oiio, "pyvips": lambda name: pyvips.Image.new_from_file(name).numpy()[0],
           "tifffile": lambda name: tifffile.imread(name)[0]}
rows = {"8": np.array([0, 64, 255], "u1"), "16": np.array([0, 16448, 65535], "<u2"), "float": np.array([0, 0.25, 1], "<f4")}
turned = {bits: (1 if bits == "float" else np.iinfo(row.dtype).max) - row for bits, row in rows.items()}
want = {"OpenCV": "8", "Pillow": "8", "OpenImageIO": "8", "pyvips": "8 16", "tifffile": ""}
for bits, row in rows.items():
    write(f"black{bits}.tif", row, 1)
    write(f"white{bits}.tif", row, 0)
    for name, read in readers.items():
        if not np.array_equal(read(f"black{bits}.tif"), row):
            sys.exit(f"behaviour changed: {name} does not read BlackIsZero, {bits} bits, as it is stored")
        got = read(f"white{bits}.tif")
        print(f"{bits:5} stored {row.tolist()}, WhiteIsZero, {name:12} {got.tolist()}")
        if got.dtype != row.dtype or not np.array_equal(got, turned[bits] if bits in want[name].split() else row):
            sys.exit(f"behaviour changed: {name}, {bits} bits")

gray = cv2.imread("white16.tif", cv2.IMREAD_GRAYSCALE)[0].tolist()
deep = cv2.imread("white16.tif", cv2.IMREAD_GRAYSCALE | cv2.IMREAD_ANYDEPTH)[0].tolist()
print("OpenCV, 16 bits: IMREAD_GRAYSCALE", gray, "- with IMREAD_ANYDEPTH", deep)
if gray != turned["8"].tolist() or deep != rows["16"].tolist():
    sys.exit("behaviour changed: the two modes of OpenCV")

for bits in ("8", "16"):
    Image.open(f"white{bits}.tif").save(f"pillow{bits}.tif")
    if not oiio.ImageBuf(f"white{bits}.tif").write(f"oiio{bits}.tif"):
        sys.exit("behaviour changed: OpenImageIO does not write")
    for name in ("pillow", "oiio"):
        page = tifffile.TiffFile(f"{name}{bits}.tif").pages[0]
        copy = page.asarray()[0]
        print(f"copy by {name}, {bits} bits: {page.photometric.name}, stored {copy.tolist()}")
        same = page.photometric == 1 and np.array_equal(copy, turned[bits])
        over = page.photometric == 1 and np.array_equal(copy, rows[bits])
        if not (same if bits == "8" else over):
            sys.exit("behaviour changed: the copy by " + name)
PY
cat > t.mjs <<'JS'
import fs from "fs";
import { decode } from "tiff";
import UTIF from "utif2";
import { fromArrayBuffer } from "geotiff";
async function readers(name) {
  const bytes = new Uint8Array(fs.readFileSync(name));
  const page = UTIF.decode(bytes.buffer)[0];
  UTIF.decodeImage(bytes.buffer, page);
  const geo = await (await fromArrayBuffer(bytes.buffer)).getImage();
  const rgb = await geo.readRGB({ interleave: true });
  return { tiff: [...decode(bytes)[0].data], utif2: [...UTIF.toRGBA8(page)], geotiff: [...rgb].filter((_, i) => i % 3 == 0) };
}
const rgba = (...v) => v.flatMap(x => [x, x, x, 255]);
const want = {
  black8: { tiff: [0, 64, 255], utif2: rgba(0, 64, 255), geotiff: [0, 64, 255] },
  black16: { tiff: [0, 16448, 65535], utif2: rgba(0, 64, 255), geotiff: [0, 64, 255] },
  blackfloat: { tiff: [0, 0.25, 1], utif2: rgba(0, 64, 255) },
  white8: { tiff: [255, 191, 0], utif2: rgba(255, 191, 0), geotiff: [0, 192, 1] },
  white16: { tiff: [65535, 49087, 0], utif2: rgba(255, 191, 0), geotiff: [0, 191, 0] },
  whitefloat: { tiff: [4294967296, 4294967296, 4294967296], utif2: Array(12).fill(0) },
};
for (const [name, each] of Object.entries(want)) {
  const got = await readers(name + ".tif");
  for (const [reader, values] of Object.entries(each)) {
    console.log(`npm ${reader.padEnd(7)} ${name.padEnd(10)} ${got[reader].join(" ")}`);
    if (got[reader].join() != values.join()) {
      console.log(`behaviour changed: ${reader}, ${name}`);
      process.exit(1);
    }
  }
}
JS
nice node t.mjs
echo "as described"
