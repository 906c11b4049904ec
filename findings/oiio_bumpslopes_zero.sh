#!/usr/bin/env bash
# OpenImageIO's make_texture writes a bump texture of nothing but zeros and calls that a success.
#
# Expected: make_texture(MakeTxBumpWithSlopes, "height.exr", "out.exr") writes six channels: height,
#   two slopes and their products. If it cannot, it returns False and geterror() says why.
# Seen: it returns True, geterror() is empty, the channel names are right, and all six channels of all
#   levels are 0. A height map needs two settings: "maketx:bumpformat" and "maketx:slopefilter". A
#   normal map needs "maketx:bumpformat" and "maketx:bumprange". With one of the two, or an ImageBuf in
#   place of the file name, the zeros stay. From Python there is no message, not even with
#   "maketx:verbose". The programs fill the settings in: maketx --bumpslopes and oiiotool -obump give
#   the right texture, and so hide that the call cannot do without them.
# Versions: OpenImageIO 3.2.2.0.
# Why it matters: a bump map of zeros is a flat surface, and a flat surface is a legal picture. The
#   lighting is right, the bumps are missing, and one looks for them in the hardware that reads the
#   texture. A conversion script that checks the returned value and the error text sees nothing.
# Source: imagebufalgo.h, make_texture: it returns false if an error occurred, "maketx:bumpformat" has
#   "auto" as the default. In maketexture.cpp bump_to_bumpslopes() does without the default: an empty
#   word is an error that goes to the stream for messages.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install OpenImageIO==3.2.2.0 numpy==2.4.6
cd "$T"
nice v/bin/python - <<'PY'
import os, subprocess, sys
import numpy as np, OpenImageIO as oiio

N = 32
y, x = np.mgrid[0:N, 0:N] / N * 2 * np.pi
height = (0.5 + 0.25 * np.sin(x) + 0.25 * np.cos(2 * y)).astype("f4")[..., None]
normal = np.stack([0.5 + 0.2 * np.sin(x), 0.5 + 0.2 * np.cos(y), 0.9 + 0 * x], -1).astype("f4")
for name, data in (("height.exr", height), ("normal.exr", normal)):
    buf = oiio.ImageBuf(oiio.ImageSpec(N, N, data.shape[2], "float"))
    buf.set_pixels(oiio.ROI(0, N, 0, N, 0, 1, 0, data.shape[2]), np.ascontiguousarray(data))
    buf.write(name)

def largest(name):
    """The largest magnitude of each channel, over all levels."""
    levels = oiio.ImageBuf(name).nmiplevels
    every = [np.asarray(oiio.ImageBuf(name, 0, i).get_pixels("float")).reshape(-1, 6) for i in range(levels)]
    return np.abs(np.concatenate(every)).max(0), levels

def show(what, name):
    top, levels = largest(name)
    print(f"{what:66} {levels} levels, largest " + " ".join(f"{v:.3g}" for v in top))
    return "zeros" if not top.any() else "slopes" if top[:3].all() and top[1] < 1 else "other"

form, slope, span = "maketx:bumpformat", "maketx:slopefilter", "maketx:bumprange"
cases = [("height", {}, "zeros"), ("height", {form: "auto"}, "zeros"), ("height", {form: "height"}, "zeros"),
         ("height", {slope: "sobel"}, "zeros"), ("height", {"maketx:verbose": 1}, "zeros"),
         ("height", {form: "auto", slope: "sobel"}, "slopes"), ("height", {form: "height", slope: "centraldiff"}, "slopes"),
         ("normal", {}, "zeros"), ("normal", {form: "normal"}, "zeros"), ("normal", {form: "normal", slope: "sobel"}, "zeros"),
         ("normal", {form: "normal", span: "auto"}, "slopes")]
ok = True
for source, settings, want in cases:
    config = oiio.ImageSpec()
    for key, value in settings.items():
        config.attribute(key, value)
    done = oiio.ImageBufAlgo.make_texture(oiio.MakeTxBumpWithSlopes, source + ".exr", "out.exr", config)
    error = oiio.geterror()
    words = ", ".join(f"{k.split(':')[1]} {v}" for k, v in settings.items()) or "no settings"
    ok &= show(f"{source}: {words}: {done}, error {error!r};", "out.exr") == want and done is True and error == ""
    os.remove("out.exr")
buf = oiio.ImageBuf("height.exr")
done = oiio.ImageBufAlgo.make_texture(oiio.MakeTxBumpWithSlopes, buf, "out.exr")
ok &= show(f"height as an ImageBuf: {done}, errors {oiio.geterror()!r} {buf.geterror()!r};", "out.exr") == "zeros" and done is True
for command in (["maketx", "--bumpslopes", "height.exr", "-o", "maketx.exr"], ["oiiotool", "height.exr", "-obump", "tool.exr"]):
    run = subprocess.run(["v/bin/" + command[0]] + command[1:])
    ok &= show(f"{' '.join(command)}: status {run.returncode};", command[-1]) == "slopes" and run.returncode == 0
if not ok:
    sys.exit("behaviour changed: which calls write zeros, or what they report")
PY
echo "as described"
