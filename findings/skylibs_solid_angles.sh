#!/usr/bin/env bash
# skylibs: solid angles of a panorama change by asking for the mean light, and those of a mirror ball add up to 1.77 spheres.
#
# Expected: solidAngles() gives the solid angle of each pixel. They add up to 4 pi for an environment that covers all directions.
#   A method that is called get... leaves the environment map, its answers and the arrays of the caller as they were.
# Seen: 1. After getMeanLightVectors the solid angles of the same object add up to 1, not 12.57: the method divides the array
#   that the object keeps. blur() uses it, so the same call makes a map of ones to 1.0 before, and to 0.08 after. The caller's
#   normals are divided too, by the largest sum of absolute values in a column.
#   2. In the format "sphere", the picture of a mirror ball, all pixels have the same solid angle, 4 times their area. Pixels on
#   the rim get up to 23 times that (64 x 64), 45 times (128 x 128): the sum is 1.7 to 1.8 times 4 pi at all sizes. A pixel corner
#   outside of the ball is taken for the direction of the middle of the ball, opposite to the rim. Light that is the same all
#   around then has a mean vector of 0.56 for the side behind the ball and 0.14 for the front, in place of 1/4 everywhere.
#   blur() of such a map is NaN everywhere, as the solid angles outside of the ball are NaN.
#   3. toIntensity(colorspace="sRGB") is the same as "linear", whatever the picture: the name is compared after lower(), with the
#   capital letters in. No message in any of these cases.
# Versions: skylibs 0.7.7, numpy 2.4.6, scipy 1.17.1, scikit-image 0.26.0.
# Why it matters: weights of pixels are what the diffuse light and the harmonics of an environment map are made from. A reference
#   that is 12 times too dark only if another method ran before is found late; a light from behind that the rim adds looks real.
# Source: skylibs, docstring of solidAngles: the solid angle subtended by each pixel; of toIntensity: colorspace is either "sRGB"
#   or "linear". By hand: at the radius r = sin(a) of the ball the direction turns by 2a, so the solid angle of a ring is
#   sin(2a) 2 da per angle around, its area sin(a) cos(a) da; the quotient is 4 everywhere.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install skylibs==0.7.7 numpy==2.4.6 scipy==1.17.1 scikit-image==0.26.0
cd "$T"
nice v/bin/python 2> log.txt - <<'PY' || { cat log.txt; exit 1; }
import sys
import numpy as np
from envmap import EnvironmentMap

SPHERE = 4 * np.pi
def ones(form, rows):
    columns = {"latlong": 2 * rows, "angular": rows, "sphere": rows}[form]
    return EnvironmentMap(np.ones((rows, columns, 3), "f4"), form)

def check(text, right):
    if not right:
        sys.exit("behaviour changed: " + text)

# 1. Asking for the mean light.
sky = ones("latlong", 32)
colatitude = np.linspace(0, np.pi, 33)
by_hand = np.repeat((np.cos(colatitude[:-1]) - np.cos(colatitude[1:]))[:, None], 64, axis=1) * 2 * np.pi / 64
before = sky.solidAngles().copy()
check("solid angles of a panorama", np.abs(before / by_hand - 1).max() < 0.01 and abs(before.sum() - SPHERE) < 1e-6)
blurred = float(sky.copy().blur(1).data.mean())
normals = np.array([[0, 2.0], [1, 1], [0, 1]])
sky.getMeanLightVectors(normals)
after = sky.solidAngles()
blurred_after = float(sky.copy().blur(1).data.mean())
print(f"panorama of ones: solid angles add up to {before.sum():.4f}, after getMeanLightVectors to {after.sum():.4f}; "
      f"blur(1) makes it {blurred:.4f}, after that {blurred_after:.4f}")
print(f"the caller's normals (0, 1, 0) and (2, 1, 1) are now {normals.T.tolist()}")
check("solid angles after getMeanLightVectors", abs(after.sum() - 1) < 1e-6 and np.allclose(after * SPHERE, before))
check("blur after getMeanLightVectors", abs(blurred - 1) < 1e-3 and abs(blurred_after * SPHERE - 1) < 1e-2)
check("the caller's normals", normals.T.tolist() == [[0, 0.25, 0], [0.5, 0.25, 0.25]])

# 2. The mirror ball.
for rows in (32, 64, 128, 256):
    ball = ones("sphere", rows)
    angles, each = ball.solidAngles(), 4 * (2 / rows) ** 2
    corners = np.hypot(*np.meshgrid(np.linspace(-1, 1, rows + 1), np.linspace(-1, 1, rows + 1)))
    whole = np.maximum.reduce([corners[:-1, :-1], corners[1:, :-1], corners[:-1, 1:], corners[1:, 1:]]) <= 1
    rim = ~whole & ~np.isnan(angles)
    print(f"mirror ball {rows} x {rows}: {np.nansum(angles) / SPHERE:.3f} times 4 pi, {np.sum(~np.isnan(angles)) * each / SPHERE:.3f} by hand; "
          f"{rim.sum()} pixels on the rim have {angles[rim].sum():.2f}, by hand {rim.sum() * each:.2f}, one {angles[rim].max() / each:.1f} times too much; "
          f"the other pixels {angles[whole].sum() / (each * whole.sum()):.3f} times")
    check("the mirror ball", 1.7 < np.nansum(angles) / SPHERE < 1.85 and abs(angles[whole].sum() / (each * whole.sum()) - 1) < 0.01)
    # The same pixels by a second way: add the directions up, each at 4 times its area. In a full sphere they cancel out.
    x, y, z, inside = ball.worldCoordinates()
    check("the equal areas of the mirror ball", abs(np.sum(z[inside])) < 0.01 * inside.sum())
axes = np.array([[0, 1.0, 0, 0], [0, 0, 1, 0], [1, 0, 0, -1]])
light = {form: np.linalg.norm(ones(form, 64).getMeanLightVectors(axes.copy()), axis=0) for form in ("latlong", "sphere")}
print("light of the same brightness all around, mean vector for normals z, x, y, -z (1/4 by hand): "
      + "; ".join(f"{form} {lengths.round(3).tolist()}" for form, lengths in light.items()))
check("mean light of a panorama", np.abs(light["latlong"] - 0.25).max() < 0.005)
check("mean light of the mirror ball", light["sphere"][0] > 0.5 and light["sphere"][3] < 0.16)
blurred = ones("sphere", 32).blur(1).data
print(f"blur(1) makes {np.isnan(blurred).sum()} of the {blurred.size} numbers of the ball of ones NaN")
check("blur of the mirror ball", np.isnan(blurred).all())
other = ones("angular", 128).solidAngles()
print(f"for comparison, the format angular, 128 x 128: {np.nansum(other) / SPHERE:.4f} times 4 pi")
check("the format angular", abs(np.nansum(other) / SPHERE - 1) < 0.001)

# 3. Intensity.
grey = {space: float(EnvironmentMap(np.full((2, 4, 3), (0.2, 0.5, 0.8), "f4"), "latlong").toIntensity(colorspace=space).data.mean())
        for space in ("linear", "sRGB", "srgb")}
weights = np.array([0.2126, 0.7152, 0.0722])
wanted = float(weights @ np.array([0.2, 0.5, 0.8]) ** 2.2) ** (1 / 2.2)
print(f"intensity of (0.2, 0.5, 0.8): {grey}, by way of a power of 2.2 it would be {wanted:.4f}")
check("toIntensity", grey["sRGB"] == grey["linear"] == grey["srgb"] and abs(wanted - grey["linear"]) > 0.01)
PY
echo "as described"
