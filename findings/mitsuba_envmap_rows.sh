#!/usr/bin/env bash
# Mitsuba 3 reads the columns of a panorama as pixels and its rows as samples
# that reach from pole to pole.
#
# Expected: an `envmap` of H rows holds bands of equal height, so the middle of
#   row y lies at (y + 1/2) * 180/H degrees from the zenith, just as the middle
#   of column x lies at (x + 1/2) * 360/W degrees. Columns do.
# Seen: row y lies at y * 180/(H - 1) degrees. The first row is the zenith
#   itself and the last one the nadir; the horizon is right. A sun in row 4 of
#   32 stands 2.1 degrees too high, and what it lights is as wrong.
# Versions: mitsuba 3.9.1, variant scalar_rgb.
# Why it matters: whoever compares reflections of a panorama with Mitsuba as
#   the reference compares two geometries. They differ by up to half a row, at
#   the poles, and not at all where most people look first.
# Source: the manual's page of `envmap` names no position of rows. A report of
#   single bright pixels in wrong places (mitsuba3, issue 469) is closed.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install mitsuba==3.9.1 drjit==1.5.0 numpy==2.4.6
cd "$T"
nice v/bin/python - <<'PY'
import math, sys
import numpy as np, mitsuba as mi

mi.set_variant("scalar_rgb")
W, H = 64, 32
# Red: the column, green: the row, each plus one half where its middle should be. So a look-up says where it looked.
panorama = np.ones((H, W, 3), np.float32)
panorama[:, :, 0] = np.arange(W)[None, :] + 0.5
panorama[:, :, 1] = np.arange(H)[:, None] + 0.5
sky = mi.load_dict({"type": "scene", "sky": {"type": "envmap", "bitmap": mi.Bitmap(panorama)}}).environment()

def found(x, y):
    """Column and row that a look-up finds, x and y pixels from the upper left corner."""
    turn, down = 2 * math.pi * x / W, math.pi * y / H
    ray = mi.SurfaceInteraction3f()
    ray.wi = mi.Vector3f(-math.sin(down) * math.sin(turn), -math.cos(down), math.sin(down) * math.cos(turn))
    return [float(light) for light in sky.eval(ray)][:2]

print("looked up, found, of the columns:")
for x in (4.5, 16, 32, 48, 59.5):
    column, _ = found(x, 16)
    print(f"  {x:6.2f} {column:6.2f}")
    if abs(column - x) > 0.01:
        sys.exit("behaviour changed: columns are no longer pixels")
print("looked up, found, degrees apart, of the rows:")
for y in (0.01, 4.5, 8, 16, 24, 27.5, 31.99):
    _, row = found(32, y)
    print(f"  {y:6.2f} {row:6.2f} {(row - y) * 180 / H:+5.2f}")
    if abs(row - (0.5 + y / H * (H - 1))) > 0.01:
        sys.exit("behaviour changed: rows no longer reach from pole to pole")
PY
echo "as described"
