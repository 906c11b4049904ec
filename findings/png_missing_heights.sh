#!/usr/bin/env bash
# A PNG height map marks missing heights with one sample value (tRNS). Four of twelve readers lose the mark, two move or multiply it.
#
# Expected: the tRNS chunk of a gray or RGB PNG names one exact sample value that is transparent; here it means "no height". A reader
#   that makes an alpha channel has alpha 0 at these pixels and only there, at each bit depth, or hands the value on so that it fits.
# Seen: a map of 8 x 6 samples, two pixels (18 and 29) have the value of tRNS, the heights rise by 4 from pixel to pixel.
#   @vivaxy/png compares the high bytes only: at 16 bits all 48 heights are missing. @pdf-lib/upng, at 16 bits gray, takes byte x of the
#   row for pixel x: the hole of column 2 is in column 4, that of column 5 is nowhere. Pillow compares the original value with samples that
#   it has converted: in 16-bit RGB and 4-bit gray there is no hole after convert("RGBA"), and info["transparency"] does not fit. A copy
#   that Pillow saves from 4 bits marks height 5 of 255 in place of 5 of 15. convert("RGBA") of 16-bit gray loses the mark, too.
#   OpenCV (IMREAD_UNCHANGED) makes alpha from tRNS for RGB, but not for gray. image-js drops the mark everywhere, imagecodecs
#   drops it in spng_decode and keeps it in png_decode. No message in any of these cases.
#   imagecodecs' png_decode, pypng, pyvips, OpenImageIO, pngjs and upng-js agree on pixels 18 and 29 in all four files.
# Versions: opencv-python-headless 5.0.0.93, pillow 13.0.0, imagecodecs 2026.3.6, pypng 0.20220715.0, OpenImageIO 3.2.2.0, pyvips 3.2.0,
#   pyvips-binary 8.18.7, numpy 2.4.6; @vivaxy/png 1.3.0, @pdf-lib/upng 1.0.1, upng-js 2.1.0, pngjs 7.0.0, image-js 1.7.0 (npm).
# Why it matters: a lost mark turns a gap into a height, mostly 0 or 65535, and its rim into the steepest slope of the bump map. Marks at
#   the wrong place remove good heights. With 8-bit gray most readers are right, and a jagged test picture hides the high-byte comparison.
# Source: PNG specification 1.2, tRNS chunk: a single gray level or RGB colour, as samples of the image's bit depth; pixels of that value
#   are transparent, all others opaque. Its note: with 16-bit data both bytes have to be compared, dropping the low byte comes after.
#   README of @vivaxy/png: bit depths 1 to 16 and tRNS; README of @pdf-lib/upng: all colour types and channel depths.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install opencv-python-headless==5.0.0.93 pillow==13.0.0 imagecodecs==2026.3.6 \
  pypng==0.20220715.0 OpenImageIO==3.2.2.0 pyvips==3.2.0 pyvips-binary==8.18.7 numpy==2.4.6
cd "$T"
nice npm install --silent --no-audit --no-fund @vivaxy/png@1.3.0 @pdf-lib/upng@1.0.1 upng-js@2.1.0 pngjs@7.0.0 image-js@1.7.0
cat > read.mjs <<'JS'
import fs from "fs";
import {createRequire} from "module";
import * as imagejs from "image-js";
const require = createRequire(import.meta.url);
const {PNG} = require("pngjs"), upng = require("upng-js"), vivaxy = require("@vivaxy/png");
const pdfUpng = require("@pdf-lib/upng").default || require("@pdf-lib/upng");
const rgba = u => bytes => new Uint8Array(u.toRGBA8(u.decode(bytes))[0]);
const holes = d => [...Array(d.length / 4).keys()].filter(i => d[4 * i + 3] === 0);
const readers = {"pngjs": b => holes(PNG.sync.read(b).data), "upng-js": b => holes(rgba(upng)(b)), "@pdf-lib/upng": b => holes(rgba(pdfUpng)(b)),
                 "@vivaxy/png": b => holes(vivaxy.decode(b).data),
                 "image-js": b => { const i = imagejs.decode(new Uint8Array(b)); return i.alpha ? "alpha" : "no alpha"; }};
const out = {};
for (const file of process.argv.slice(2)) {
  out[file] = {};
  for (const name in readers)
    if (!(name === "image-js" && file === "gray4.png"))  // that is an error: incorrect data size
      out[file][name] = readers[name](fs.readFileSync(file));
}
console.log(JSON.stringify(out));
JS
nice v/bin/python - <<'PY'
import json, struct, subprocess, sys, zlib
import cv2, imagecodecs, numpy as np, OpenImageIO as oiio, png, pyvips
from PIL import Image

def chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

def write(name, samples, depth, missing):
    """An uncompressed-filter PNG of a gray or RGB array, with a tRNS chunk."""
    h, w, c = samples.shape
    rows = samples.reshape(h, w * c)
    if depth == 4:
        rows = rows[:, ::2] << 4 | rows[:, 1::2]
    rows = rows.astype(">u2" if depth == 16 else "u1")
    head = struct.pack(">IIBBBBB", w, h, depth, 2 if c == 3 else 0, 0, 0, 0)
    data = zlib.compress(b"".join(b"\0" + row.tobytes() for row in rows))
    open(name, "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"tRNS", np.array(missing, ">u2").tobytes())
                           + chunk(b"IDAT", data) + chunk(b"IEND", b""))

def with_hole(samples):
    samples = samples.reshape(48, -1)
    samples[29] = samples[18]
    return samples.reshape(6, 8, -1)

i = np.arange(48)
four = np.where(i % 16 == 5, 6, i % 16)
four[18] = 5
files = {"gray16.png": (with_hole(0x7600 + 4 * i), 16), "gray8.png": (with_hole(100 + i), 8), "gray4.png": (with_hole(four), 4),
         "rgb16.png": (with_hole(np.stack([0x8000 + 4 * i, 0x80FF - 4 * i, np.full(48, 0xFF00)], 1)), 16)}
for name, (samples, depth) in files.items():
    write(name, samples, depth, samples[2, 2])

def holes(array):
    array = np.asarray(array)
    return np.flatnonzero(array[..., -1] == 0).tolist() if array.ndim == 3 and array.shape[2] in (2, 4) else "no alpha"

def pypng(name):
    w, h, rows, info = png.Reader(name).asDirect()
    return np.array([list(row) for row in rows]).reshape(h, w, -1)

def by_info(name):
    image = Image.open(name)
    array = np.asarray(image)
    return np.flatnonzero((array.reshape(48, -1) == np.array(image.info["transparency"])).all(1)).tolist()

def pillow_copy(name):
    Image.open(name).save("copy.png")
    return holes(pypng("copy.png"))

readers = {"imagecodecs.png_decode": lambda n: holes(imagecodecs.png_decode(open(n, "rb").read())), "pypng": lambda n: holes(pypng(n)),
           "pyvips": lambda n: holes(pyvips.Image.new_from_file(n).numpy()),
           "OpenImageIO": lambda n: holes(oiio.ImageBuf(n).get_pixels("uint16")),
           "OpenCV, IMREAD_UNCHANGED": lambda n: holes(cv2.imread(n, cv2.IMREAD_UNCHANGED)),
           "Pillow, RGBA": lambda n: holes(Image.open(n).convert("RGBA")), "Pillow, info": by_info, "Pillow, copy": pillow_copy}
node = json.loads(subprocess.run(["node", "read.mjs", *files], check=True, capture_output=True, text=True).stdout)
right, none, every = [18, 29], [], list(range(48))
differ = {("OpenCV, IMREAD_UNCHANGED", "gray16.png"): "no alpha", ("OpenCV, IMREAD_UNCHANGED", "gray8.png"): "no alpha",
          ("OpenCV, IMREAD_UNCHANGED", "gray4.png"): "no alpha", ("Pillow, RGBA", "gray16.png"): none, ("Pillow, RGBA", "gray4.png"): none,
          ("Pillow, RGBA", "rgb16.png"): none, ("Pillow, info", "gray4.png"): none, ("Pillow, info", "rgb16.png"): none,
          ("Pillow, copy", "gray4.png"): none, ("Pillow, copy", "rgb16.png"): none, ("@vivaxy/png", "gray16.png"): every,
          ("@vivaxy/png", "rgb16.png"): every, ("@pdf-lib/upng", "gray16.png"): [20], ("image-js", "gray16.png"): "no alpha",
          ("image-js", "gray8.png"): "no alpha", ("image-js", "rgb16.png"): "no alpha"}
bad = False
for name in files:
    print(f"{name}, tRNS {files[name][0][2, 2].tolist()}, right is {right}:")
    got = {reader: read(name) for reader, read in readers.items()} | node[name]
    for reader, pixels in got.items():
        print(f"  {reader:25}" + (str(pixels) if len(pixels) < 12 else f"{len(pixels)} of 48 pixels"))
        if pixels != differ.get((reader, name), right):
            print("  behaviour changed, expected", differ.get((reader, name), right))
            bad = True
pillow_copy("gray4.png")
copy = Image.open("copy.png")
print(f"Pillow's copy of gray4.png: {copy.mode}, sample {np.asarray(copy)[2, 2]}, tRNS {copy.info['transparency']}")
eight = open("gray8.png", "rb").read()
print("8-bit gray: imagecodecs.spng_decode", imagecodecs.spng_decode(eight).shape, "png_decode", imagecodecs.png_decode(eight).shape)
if bad or np.asarray(copy)[2, 2] != 85 or copy.info["transparency"] != 5 or imagecodecs.spng_decode(eight).ndim != 2:
    sys.exit("behaviour changed")
PY
echo "as described"
