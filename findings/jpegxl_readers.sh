#!/usr/bin/env bash
# One lossless JPEG XL file, four readers: half floats are cut to 0..1, 10 bits are 1023 or 65535, flat pictures are "corrupt".
#
# Expected: readers of the same codec library agree on lossless samples. A reader that says that it finds the
#   sample type by itself keeps half floats over 1. What a library wrote without loss, it reads back.
# Seen: 1. A panorama in half floats: pyjpegxl gives uint16 with everything below 0 and over 1 cut off;
#   30 is 65535, and so is 1. Asked for float32 it gives 30. It reads 32-bit floats right. The Pillow plugin
#   gives 8-bit RGB, cut off the same way and rounded down, without a warning; the same picture with one
#   channel keeps all its floats there, and warns that half becomes single. imagecodecs and OpenImageIO are right.
#   2. A height map with 10 bits: sample 266 is 266 in imagecodecs, and 17040 in Pillow and pyjpegxl, all
#   as uint16. Nothing in the array tells them apart.
#   3. OpenImageIO calls each file of less than 128 bytes corrupt. A flat 64 x 64 height map has 29
#   bytes, a black 256 x 256 picture of its own, without loss, 100. It writes it and does not open it.
# Versions: imagecodecs 2026.3.6, pyjpegxl 0.3.0, pillow-jxl-plugin 1.3.8, pillow 13.0.0, OpenImageIO 3.2.2.0, numpy 2.4.6.
# Why it matters: panoramas converted from OpenEXR hold half floats, and their lamps and suns are over 1. Slopes of
#   a height map become 64 times as steep with another reader. Test pictures are flat tiles, black or
#   masks, so a test of a tool chain fails with the simplest ones only.
# Source: docstring of pyjpegxl.decode_to_numpy: without a dtype the source's bit depth is found (uint8,
#   uint16, or float32). ISO/IEC 18181-1 and libjxl's format overview: samples have 1 to 31 integer bits
#   or are floats; the signature is 2 bytes (FF 0A), or 12 bytes of a container. There is no minimum size.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install imagecodecs==2026.3.6 pyjpegxl==0.3.0 pillow-jxl-plugin==1.3.8 \
  pillow==13.0.0 OpenImageIO==3.2.2.0 numpy==2.4.6
cd "$T"
cat > read.py <<'PY'
import sys, warnings
import numpy as np

# Each reader has its own process: every package brings its own copy of the codec library.
reader, name, result = sys.argv[1:4]
with warnings.catch_warnings(record=True) as messages:
    warnings.simplefilter("always")
    data = open(name, "rb").read()
    if reader == "imagecodecs":
        import imagecodecs
        pixels = imagecodecs.jpegxl_decode(data)
    elif reader == "OpenImageIO":
        import OpenImageIO as oiio
        image = oiio.ImageInput.open(name)
        if image is None:
            sys.exit(oiio.geterror())
        pixels = np.asarray(image.read_image("float"))  # integers become 0..1
        image.close()
    elif reader == "Pillow":
        import pillow_jxl
        from PIL import Image
        pixels = np.asarray(Image.open(name))
    else:
        import pyjpegxl
        pixels = pyjpegxl.decode_to_numpy(data, **({"dtype": "float32"} if "float32" in reader else {}))[1]
np.save(result, pixels.reshape(*pixels.shape[:2], -1))
print("; ".join(str(m.message) for m in messages if "bit" in str(m.message)))
PY
nice v/bin/python - <<'PY'
import subprocess, sys
import imagecodecs, numpy as np, OpenImageIO as oiio

def run(reader, name):
    done = subprocess.run([sys.executable, "read.py", reader, name, "pixels.npy"], capture_output=True, text=True)
    if done.returncode:
        return None, done.stderr.strip()
    return np.load("pixels.npy"), done.stdout.strip()

def show(reader, pixels, message, places):
    values = ", ".join(str(pixels[y, x].tolist()) for y, x in places)
    print(f"  {reader:18} {pixels.dtype}: {values}" + (f"  (warning: {message})" if message else ""))

def write(name, array, **more):
    data = imagecodecs.jpegxl_encode(array, lossless=True, **more)
    open(name, "wb").write(data)
    return len(data)

rng = np.random.default_rng(1)
readers = ("imagecodecs", "OpenImageIO", "Pillow", "pyjpegxl", "pyjpegxl float32")
places = ((0, 0), (0, 1), (0, 2))

# 1. Light in half floats, three channels and one, and in single floats.
light = rng.uniform(0, 100, (64, 64, 3)).astype("f2")
light[0, 0], light[0, 1], light[0, 2] = (0.25, 0.5, 1), (-0.5, 0.75, 30), (100, 1, 1.5)
cut = np.clip(light.astype("f8"), 0, 1)
write("half.jxl", light)
print(f"half floats, {', '.join(str(light[p].tolist()) for p in places)}:")
for reader in readers:
    pixels, message = run(reader, "half.jxl")
    show(reader, pixels, message, places)
    if reader == "pyjpegxl":
        same = pixels.dtype == np.uint16 and np.abs(pixels - 65535 * cut).max() <= 1
    elif reader == "Pillow":
        same = pixels.dtype == np.uint8 and np.abs(pixels - 255 * cut).max() <= 1 and not message
    else:
        same = np.array_equal(pixels, light)
    if not same:
        sys.exit("behaviour changed: half floats in " + reader)
write("gray.jxl", light[..., :1].copy()[..., 0])
pixels, message = run("Pillow", "gray.jxl")
print("one channel of it:")
show("Pillow", pixels, message, places)
if not np.array_equal(pixels, light[..., :1]) or "32" not in message:
    sys.exit("behaviour changed: one channel of half floats in Pillow")
write("single.jxl", light.astype("f4"))
pixels, message = run("pyjpegxl", "single.jxl")
print("as 32-bit floats:")
show("pyjpegxl", pixels, message, places)
if pixels.dtype != np.float32 or not np.array_equal(pixels, light.astype("f4")):
    sys.exit("behaviour changed: 32-bit floats in pyjpegxl")

# 2. Heights with 10 bits.
heights = rng.integers(0, 1024, (64, 64)).astype("u2")
heights[0, 0], heights[0, 1], heights[0, 2] = 0, 266, 1023
write("ten.jxl", heights, bitspersample=10)
print("10 bits, 0, 266, 1023:")
for reader in readers[:4]:
    pixels, message = run(reader, "ten.jxl")
    show(reader, pixels, message, places)
    scale = {"imagecodecs": 1, "OpenImageIO": 1 / 1023}.get(reader, 65535 / 1023)
    if np.abs(pixels[..., 0] - heights * scale).max() > (0.5 if scale > 1 else 1e-4):
        sys.exit("behaviour changed: 10 bits in " + reader)

# 3. Small files.
opened = {}
for filled in range(1, 200, 3):  # the more random samples, the larger the file
    picture = np.zeros((16, 16), "u1")
    picture.ravel()[:filled] = rng.integers(0, 256, filled)
    size = write("small.jxl", picture)
    image = oiio.ImageInput.open("small.jxl")
    if image is not None:
        image.close()
    opened[size] = image is not None
    oiio.geterror()
largest = max(s for s, ok in opened.items() if not ok)
smallest = min(s for s, ok in opened.items() if ok)
print(f"{len(opened)} files of {min(opened)} to {max(opened)} bytes: OpenImageIO opens none of up to {largest}, all from {smallest} on")
if not largest < 128 <= smallest:
    sys.exit("behaviour changed: small files")
size = write("flat.jxl", np.full((64, 64), 128, "u1"))
for reader in readers[:4]:
    pixels, message = run(reader, "flat.jxl")
    print(f"  flat, 64 x 64, {size} bytes, {reader}: " + (f"all {pixels[0, 0].tolist()}" if pixels is not None else message))
    if (pixels is None) != (reader == "OpenImageIO"):
        sys.exit("behaviour changed: a flat picture in " + reader)
spec = oiio.ImageSpec(256, 256, 3, "uint8")
spec.attribute("compression", "jpegxl:100")
out = oiio.ImageOutput.create("own.jxl")
if not (out.open("own.jxl", spec) and out.write_image(np.zeros((256, 256, 3), "u1")) and out.close()):
    sys.exit("behaviour changed: OpenImageIO does not write the file")
size = len(open("own.jxl", "rb").read())
own, message = run("OpenImageIO", "own.jxl")
other, _ = run("imagecodecs", "own.jxl")
print(f"OpenImageIO wrote a black picture, {size} bytes, and reads: {message if own is None else own.shape}; imagecodecs reads {other.shape}")
if own is not None or other.shape != (256, 256, 3) or other.any():
    sys.exit("behaviour changed: OpenImageIO and its own file")
PY
echo "as described"
