#!/usr/bin/env bash
# One PFM file has three meanings by its scale, and OpenImageIO reads its own PFM upside down.
#
# Expected: readers agree on the samples of a small PFM with the scale line -2 (little endian, scale
#   factor 2) and on its rows, which run from bottom to top. What a library wrote, it reads back.
# Seen: 1. OpenCV divides the samples by the factor, OpenImageIO and Mitsuba multiply by it, Pillow
#   leaves them and keeps the factor in info["scale"]. So a sample of 3 is 1.5, 6 or 3. Saved again
#   by Pillow, the factor is 1. With the scale line -1 they agree on the samples.
#   2. OpenImageIO writes bottom to top, as its manual says for both directions. Opened without a
#   configuration, the rows are not turned on reading: ImageBuf(name) and ImageInput.open(name) give
#   the picture upside down, the one that OpenImageIO wrote too. With an empty ImageSpec as the
#   configuration it is upright, and so it is in oiiotool. No warning in any of these cases.
# Versions: opencv-python-headless 5.0.0.93, OpenImageIO 3.2.2.0, pillow 13.0.0, mitsuba 3.9.1, numpy 2.4.6.
# Why it matters: PFM is the simplest way to hand a height map or a reference picture to a test. An
#   upside-down height map keeps the slope in x and changes the sign of that in y: it looks like the
#   green channel of a normal map that was turned round. A test picture that is symmetric hides it.
# Source: Netpbm's pfm(5): the absolute value is the scale factor, it tells the units of the samples;
#   rows go from bottom to top. It does not say which way to apply it. OpenImageIO's manual, PNM:
#   by default, reading and writing of pfm flips the image; "pnm:pfmflip" has the default 1.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install opencv-python-headless==5.0.0.93 OpenImageIO==3.2.2.0 \
  pillow==13.0.0 mitsuba==3.9.1 numpy==2.4.6
cd "$T"  # Mitsuba makes a folder .drjit in HOME
HOME="$T" nice v/bin/python - <<'PY'
import subprocess, sys
import cv2, numpy as np, mitsuba as mi, OpenImageIO as oiio
from PIL import Image
mi.set_variant("scalar_rgb")

def oiio_plain(name):
    return np.asarray(oiio.ImageBuf(name).get_pixels("float"))[..., 0]

def oiio_input(name):
    return np.asarray(oiio.ImageInput.open(name).read_image("float"))[..., 0]

def oiio_config(name):
    return np.asarray(oiio.ImageBuf(name, 0, 0, oiio.ImageSpec()).get_pixels("float"))[..., 0]

readers = {"OpenCV": lambda name: cv2.imread(name, cv2.IMREAD_UNCHANGED), "Mitsuba": lambda name: np.array(mi.Bitmap(name)),
           "Pillow": lambda name: np.asarray(Image.open(name)), "OpenImageIO, ImageBuf(name)": oiio_plain,
           "OpenImageIO, ImageInput.open(name)": oiio_input, "OpenImageIO, empty ImageSpec": oiio_config}
picture = np.array([[3, 4], [1, 2]], "<f4")  # top row first; the file begins with the row 1 2
results = {}
for scale in ("-1", "-2"):
    with open("a.pfm", "wb") as f:
        f.write(f"Pf\n2 2\n{scale}\n".encode() + picture[::-1].tobytes())
    print(f"scale line {scale}, rows in the file 1 2, then 3 4; from top to bottom these are:")
    for name, read in readers.items():
        results[scale, name] = read("a.pfm").tolist()
        print(f"  {name:36}" + " | ".join(" ".join(f"{v:g}" for v in row) for row in results[scale, name]))
image = Image.open("a.pfm")
kept = image.info["scale"]
image.save("b.pfm")
saved = open("b.pfm", "rb").read().split(b"\n")[2].decode()
print(f"Pillow: info['scale'] is {kept:g}, the scale line of the saved copy {saved}")

buf = oiio.ImageBuf(oiio.ImageSpec(2, 2, 1, "float"))
buf.set_pixels(oiio.ROI(0, 2, 0, 2, 0, 1, 0, 1), picture[..., None])
if not buf.write("own.pfm"):
    sys.exit("behaviour changed: " + buf.geterror())
stored = np.frombuffer(open("own.pfm", "rb").read()[-16:], "<f4").tolist()
subprocess.run(["v/bin/oiiotool", "own.pfm", "-o", "tool.exr"], check=True)
tool = oiio_plain("tool.exr").tolist()
own = {name: read("own.pfm").tolist() for name, read in readers.items()}
print(f"OpenImageIO writes {picture.tolist()}; in the file {stored}; ImageBuf(name) reads {own['OpenImageIO, ImageBuf(name)']}, "
      f"empty ImageSpec {own['OpenImageIO, empty ImageSpec']}, oiiotool to EXR {tool}")

upright, turned = picture.tolist(), picture[::-1].tolist()
factor = {"OpenCV": 0.5, "Pillow": 1}
for name in readers:
    plain = name.endswith("(name)")
    want = picture[::-1] if plain else picture
    if results["-1", name] != want.tolist() or own[name] != want.tolist():
        sys.exit("behaviour changed: the rows of " + name)
    if results["-2", name] != (want * factor.get(name, 2)).tolist():
        sys.exit("behaviour changed: the scale of " + name)
if kept != 2 or float(saved) != -1:
    sys.exit("behaviour changed: the scale that Pillow keeps or saves")
if stored != [1, 2, 3, 4] or tool != upright:
    sys.exit("behaviour changed: the rows that OpenImageIO writes, or oiiotool")
PY
echo "as described"
