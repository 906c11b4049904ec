#!/usr/bin/env bash
# Radiance HDR: four writers turn light a little below zero into bright light: pure Rec.2020 green comes out violet.
#
# Expected: the format has no sign. A writer that gets a component below zero stores 0, as Radiance itself does,
#   or refuses the picture. A component of -0.01 is not brighter than one of 0.
# Seen: OpenCV, OpenImageIO, Mitsuba and imagecodecs keep the low 8 bits of the negative mantissa. Beside a red and green of
#   1, blue -0.005 becomes 0, blue -0.01 becomes 1.99 and blue -0.5 becomes 1.5. OpenImageIO's own colour conversion makes of the
#   green of Rec.2020 (-0.59, 1.13, -0.10) in Rec.709; written as .hdr and read again it is (1.41, 1.13, 1.91), violet. The four
#   files read the same. Only where no component is above zero the pixel is black.
#   A published panorama (esplanade, 5054 samples below zero) gets 1002 samples above 0.1 from them, the brightest 249.
#   All writers report success, none gives a message. hdrify, a writer in JavaScript, stores 0.
# Versions: opencv-python-headless 5.0.0.93, OpenImageIO 3.2.2.0, mitsuba 3.9.1, imagecodecs 2026.3.6, numpy 2.4.6;
#   hdrify 1.2.1, @pmndrs/assets 1.7.0 (npm). On x86-64: C leaves this conversion undefined, other processors may give 0.
# Why it matters: EXR panoramas have such samples, from resampling around the sun or from a wider gamut, and a converter to .hdr
#   makes coloured sparks of them. They look like a fault of the filter or of the fixed point arithmetic that reads the panorama.
# Source: Radiance, src/common/color.c, setcolr: each mantissa is set to 0 unless the component is above 0.
#   A colour outside the gamut fits into the second kind of the format, 32-bit_rle_xyze: CIE XYZ has no negative values.
set -euo pipefail
if [ "$(uname -m)" != x86_64 ]; then
  echo "this was seen on x86-64 only" >&2
  exit 1
fi
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
cd "$T"
python3 -m venv v
nice v/bin/pip -q --disable-pip-version-check install opencv-python-headless==5.0.0.93 OpenImageIO==3.2.2.0 mitsuba==3.9.1 \
  imagecodecs==2026.3.6 numpy==2.4.6
echo '{"private": true, "type": "module"}' > package.json
nice npm install --silent --no-audit --no-fund --no-update-notifier hdrify@1.2.1 > npm.log 2>&1 || {
  cat npm.log >&2
  exit 1
}
npm pack --silent @pmndrs/assets@1.7.0 > npm.log
tar xzf pmndrs-assets-1.7.0.tgz package/hdri/esplanade.exr.js
cat > green.js <<'JS'
import fs from 'node:fs'
import { writeHdr } from 'hdrify'
const data = new Float32Array(16 * 8 * 4)
for (let i = 0; i < data.length; i += 4) data.set([-0.5876, 1.1329, -0.1006, 1], i)
fs.writeFileSync('hdrify.hdr', writeHdr({ width: 16, height: 8, data, linearColorSpace: 'linear-rec709', metadata: {} }))
JS
nice node green.js
# Mitsuba makes a folder .drjit in HOME.
HOME="$T" nice v/bin/python - <<'PY'
import base64, math, pathlib, re, sys
import cv2, imagecodecs, mitsuba as mi, numpy as np, OpenImageIO as oiio
mi.set_variant("scalar_rgb")

def by_opencv(light, name):
    return cv2.imwrite(name, np.ascontiguousarray(light[..., ::-1]))

def by_oiio(light, name):
    height, width, _ = light.shape
    buf = oiio.ImageBuf(oiio.ImageSpec(width, height, 3, "float"))
    buf.set_pixels(oiio.ROI(0, width, 0, height, 0, 1, 0, 3), light)
    return buf.write(name)

def by_mitsuba(light, name):
    mi.Bitmap(light).write(name)
    return True

def by_imagecodecs(light, name):
    pathlib.Path(name).write_bytes(imagecodecs.rgbe_encode(light, header=True, rle=False))
    return True

writers = {"OpenCV": by_opencv, "OpenImageIO": by_oiio, "Mitsuba": by_mitsuba, "imagecodecs": by_imagecodecs}

def read(name):
    return np.asarray(oiio.ImageBuf(name).get_pixels("float"))[..., :3]

def flat(color):
    return np.full((8, 16, 3), color, np.float32)

def wrapped(color):
    """What is read if the low 8 bits of each mantissa are kept."""
    most = max(color)
    if most <= 0:
        return [0, 0, 0]
    scale = 256 / 2 ** math.frexp(most)[1]
    return [(int(c * scale) & 255) / scale for c in color]

def show(color):
    return "(" + ", ".join(f"{c:.3g}" for c in color) + ")"

print("written -> read again, the same from " + ", ".join(writers))
for color in ((1, 1, 0), (1, 1, -0.005), (1, 1, -0.01), (1, 1, -0.5), (0.25, -0.25, -0.001), (-0.1, -0.2, 0), (-1, -1, -1)):
    for title, write in writers.items():
        if not write(flat(color), "a.hdr"):
            sys.exit(f"behaviour changed: {title} does not write {color}")
        got = read("a.hdr")[7, 15]
        if np.abs(got - wrapped(color)).max() > 1e-6:
            sys.exit(f"behaviour changed: {title} writes {color} as {got}")
    print(f"  {show(color)} -> {show(got)}")

green = oiio.ImageBuf(oiio.ImageSpec(16, 8, 3, "float"))
oiio.ImageBufAlgo.fill(green, (0.0, 1.0, 0.0))
converted = oiio.ImageBufAlgo.colorconvert(green, "lin_rec2020", "lin_rec709")
if converted.has_error or not converted.write("green.hdr"):
    sys.exit("behaviour changed: " + converted.geterror())
before, after = converted.getpixel(15, 7)[:3], read("green.hdr")[7, 15].tolist()
clamped = read("hdrify.hdr")[7, 15].tolist()
print(f"OpenImageIO: Rec.2020 green is {show(before)} in Rec.709, as .hdr {show(after)}; hdrify writes {show(clamped)}")
if np.abs(np.array(before) - (-0.5876, 1.1329, -0.1006)).max() > 1e-3 or np.abs(np.array(after) - wrapped(before)).max() > 1e-6:
    sys.exit("behaviour changed: the green of Rec.2020")
if clamped[0] != 0 or clamped[2] != 0 or abs(clamped[1] - 1.13) > 0.01:
    sys.exit("behaviour changed: hdrify")

text = pathlib.Path("package/hdri/esplanade.exr.js").read_text()
pathlib.Path("esplanade.exr").write_bytes(base64.b64decode(re.search(r"base64,([A-Za-z0-9+/=]+)", text)[1]))
light = np.ascontiguousarray(read("esplanade.exr"))
dark = light < 0
for title, write in writers.items():
    if not write(light, "p.hdr"):
        sys.exit(f"behaviour changed: {title} does not write the panorama")
    got = read("p.hdr")[dark]
    seen = int(dark.sum()), int((got > 0.1).sum()), float(got.max())
    print(f"esplanade by {title}: {seen[0]} samples below zero, of these {seen[1]} read as more than 0.1, the brightest as {seen[2]:.0f}")
    if seen != (5054, 1002, 249):
        sys.exit(f"behaviour changed: the panorama by {title}")
PY
echo "as described"
