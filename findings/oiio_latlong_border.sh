#!/usr/bin/env bash
# maketx gives one panorama two geometries: the file type decides where its
# samples lie, and OpenEXR output replaces the seam and the poles.
#
# Expected: make_texture(MakeTxEnvLatl) prepares an ordinary panorama, with a
#   sample in the middle of each pixel, for look-ups. Its finest level keeps
#   the pixels, in whatever format it is written.
# Seen: written as TIFF it does. Written as OpenEXR (from the same pixels) the
#   outer samples count as lying on the edge of the picture. Nothing is
#   resampled for it: the first and the last column become their mean, and the
#   first and the last row become the mean of each. Directions move by up to
#   half a pixel, most at the seam. A sun of one pixel in the first column is
#   two half-bright suns, at both ends of the picture. No warning; the file
#   says "oiio:sampleborder 1".
# Versions: OpenImageIO 3.2.2.0.
# Why it matters: whoever takes a prepared EXR as a panorama, or the finest
#   level of one as a reference for reflections, compares two geometries. With
#   64 columns the greatest difference is 2.8 degrees.
# Source: OpenImageIO's manual names oiio:sampleborder as metadata of textures,
#   and OpenEXR's own latitude-longitude maps have samples on the edge. That a
#   converter claims it without a resampling is named by neither.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install OpenImageIO==3.2.2.0 numpy==2.4.6
cd "$T"
nice v/bin/python - <<'PY'
import math, sys
import numpy as np, OpenImageIO as oiio

W, H = 64, 32
# Red: the column, plus one half where its centre is; so a look-up says where it looked. Green: a sun in column 0.
panorama = np.zeros((H, W, 3), np.float32)
panorama[:, :, 0] = np.arange(W)[None, :] + 0.5
panorama[16, 0, 1] = 1

def prepared(name, kind):
    settings = oiio.ImageSpec()
    settings.attribute("maketx:fileformatname", kind)
    if not oiio.ImageBufAlgo.make_texture(oiio.MakeTxEnvLatl, oiio.ImageBuf(panorama), name, settings):
        sys.exit("behaviour changed: " + oiio.geterror())
    file = oiio.ImageInput.open(name)
    return np.asarray(file.read_image("float")), file.spec().getattribute("oiio:sampleborder") or 0

def column(name, u):
    """The column that a look-up finds on the horizon, u turns from the left edge."""
    turn = 2 * math.pi * u
    direction = (math.sin(turn), 0.0, -math.cos(turn))
    return textures.environment(name, oiio.TextureOpt(), direction, (0, 0, 0), (0, 0, 0), 3)[0]

textures = oiio.TextureSystem()
seen = {}
for name, kind in [("panorama.tif", "tiff"), ("panorama.exr", "openexr")]:
    level, border = prepared(name, kind)
    changed = int((level[:, :, 0] != panorama[:, :, 0]).sum())
    places = [(u, round(column(name, u), 3)) for u in (0.125, 0.25, 0.5, 0.75, 0.875)]
    suns = [(int(x), float(level[16, x, 1])) for x in np.flatnonzero(level[16, :, 1])]
    seen[kind] = (border, changed, places, suns)
    print(f"{kind}: sampleborder {border}, {changed} of {W * H} pixels changed, suns (column, light) {suns}")
    print("  looked up at  " + "  ".join(f"{u * W:6.2f}" for u, _ in places))
    print("  found column  " + "  ".join(f"{x:6.2f}" for _, x in places))
if seen["tiff"][:2] != (0, 0) or seen["tiff"][3] != [(0, 1.0)]:
    sys.exit("behaviour changed: TIFF output is no longer the picture itself")
border, changed, places, suns = seen["openexr"]
if border != 1 or changed != 2 * H + 2 * (W - 2) or suns != [(0, 0.5), (W - 1, 0.5)]:
    sys.exit("behaviour changed: OpenEXR output keeps its seam and poles now")
if any(abs(x - (0.5 + u * (W - 1))) > 0.01 for u, x in places):
    sys.exit("behaviour changed: look-ups in OpenEXR output no longer stretch the picture to its edges")
PY
echo "as described"
