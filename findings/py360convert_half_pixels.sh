#!/usr/bin/env bash
# py360convert: cube faces are sampled from edge to edge, looked up half a pixel beside, and never come back in place.
#
# Expected: panorama to cube map and back gives the panorama, a little blurred. Where a pixel lies is
#   the same in both directions.
# Seen: e2c reads the panorama at pixel centres, but the outermost columns of a face lie on its very
#   edge (45 degrees), so neighbouring faces repeat them and a pixel is wider than 1/face_w. c2e takes
#   a third rule for the faces, and a fourth for the panorama: its first and last column are the same
#   direction, its first row is the pole. Together the picture moves by about half a face pixel in
#   both directions, 4 degrees on average with 16 x 16 faces. A cube made with pixel centres does not
#   come out in place either. The shift adds up: after four round trips it is about four times as large.
# Versions: py360convert 1.0.4, numpy 2.4.6, scipy 1.17.1, pillow 13.0.0.
# Why it matters: a panorama is often cut into small faces for an environment mapper. The faces, and
#   the expected pictures made from them, are off by a fixed angle that looks like a wrong rounding
#   of the address in the hardware.
# Source: the README calls what c2e(e2c()) changes blurring from resampling twice; the
#   documentation of uv2coor in utils.py puts the panorama's pixels at (0.5, 0.5) to (h-0.5, w-0.5).
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install py360convert==1.0.4 numpy==2.4.6 scipy==1.17.1 pillow==13.0.0
cd "$T"
nice v/bin/python - <<'PY'
import sys
import numpy as np
import py360convert

H, W = 256, 512
row, column = np.meshgrid((np.arange(H) + 0.5) / H, (np.arange(W) + 0.5) / W, indexing="ij")
longitude, latitude = (column - 0.5) * 2 * np.pi, (0.5 - row) * np.pi
# Every pixel of this panorama holds the direction that it is seen in: x right, y up, z front.
panorama = np.stack([np.cos(latitude) * np.sin(longitude), np.sin(latitude), np.cos(latitude) * np.cos(longitude)], -1)

def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)

def degrees(a, b):
    return np.degrees(np.arccos(np.clip((unit(a) * unit(b)).sum(-1), -1, 1)))

def back(cube):
    return py360convert.c2e(cube, H, W, mode="bilinear", cube_format="dict")

def centred(n):
    """The six faces with exact directions at pixel centres, in the orientation of cube_format "dict"."""
    r = (np.arange(n) + 0.5) / n * 2 - 1
    x, y = np.meshgrid(r, -r)
    o = np.ones_like(x)
    faces = {"F": (x, y, o), "R": (o, y, -x), "B": (-x, y, -o), "L": (-o, y, x), "U": (x, o, -y), "D": (x, -o, y)}
    return {name: unit(np.stack(face, -1)) for name, face in faces.items()}

ok = True
for n in (16, 64):
    cube = py360convert.e2c(panorama, face_w=n, mode="bilinear", cube_format="dict")
    left, right = (np.degrees(np.arctan2(cube["F"][n // 2, i, 0], cube["F"][n // 2, i, 2])) for i in (0, n - 1))
    repeated = degrees(cube["F"][:, -1], cube["R"][:, 0]).max()
    print(f"faces of {n}: columns of the front from {left:.2f} to {right:.2f} degrees, pixel centres would end at "
          f"{np.degrees(np.arctan(1 - 1 / n)):.2f}; its last column and the first of the right face: {repeated:.3f} degrees apart")
    ok &= abs(right - 45) < 0.05 and abs(left + 45) < 0.05 and repeated < 0.05
    pixel = np.degrees(2 / n)
    for name, source in (("e2c, then c2e", cube), ("exact cube, then c2e", centred(n))):
        result = unit(back(source))
        off = degrees(result, panorama)
        at = (slice(H // 2 - 16, H // 2 + 16), slice(W // 2 - 32, W // 2 + 32))
        across = (np.degrees(np.arctan2(result[..., 0], result[..., 2])) - np.degrees(longitude))[at].mean() / pixel
        down = (np.degrees(latitude) - np.degrees(np.arcsin(result[..., 1])))[at].mean() / pixel
        print(f"  {name}: {off.mean():.2f} degrees off on average, {off.max():.2f} at most; "
              f"in front {across:.2f} face pixels across, {down:.2f} down")
        ok &= 0.35 < across < 0.6 and 0.35 < down < 0.6
edge = back(centred(16))
print(f"c2e: first and last column {degrees(edge[:, 0], edge[:, -1]).max():.3f} degrees apart, pixels are {360 / W:.2f} wide; "
      f"first row spans {degrees(edge[0], edge[0, :1]).max():.3f} degrees")
ok &= degrees(edge[:, 0], edge[:, -1]).max() < 0.1
again, trips = panorama, []
for _ in range(4):
    again = unit(back(py360convert.e2c(again, face_w=64, mode="bilinear", cube_format="dict")))
    trips.append(degrees(again, panorama)[H // 2 - 16:H // 2 + 16, W // 2 - 32:W // 2 + 32].mean())
print("faces of 64, four round trips, front:", ", ".join(f"{t:.2f}" for t in trips), "degrees off")
ok &= trips[3] > 3 * trips[0]
if not ok:
    sys.exit("behaviour changed: cube faces lie elsewhere")
PY
echo "as described"
