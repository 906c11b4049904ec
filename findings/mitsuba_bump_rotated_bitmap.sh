#!/usr/bin/env bash
# Mitsuba: turn a height map that is not square by to_uv, and the heights are right, the bumps are not.
#
# Expected: the slopes of a bump map are the slopes of its heights. A height map of 64 x 16 pixels that is
#   turned by 90 degrees with to_uv bumps like the same picture turned beforehand (16 x 64, no to_uv).
# Seen: eval_1, the height, is the same in both. eval_1_grad, the slope, is not: after the turn the slope along u
#   is multiplied by the width of the picture in place of the height, and the one along v the other way round.
#   Here one is 4 times too large and the other 4 times too small, and the normal of the bumpmap BSDF is 18 degrees off.
#   At 30 degrees a slope of -0.004 becomes -0.335. Square pictures, a to_uv that only scales, and a half turn are right.
#   No message.
# Versions: mitsuba 3.9.1, numpy 2.4.6.
# Why it matters: Mitsuba is the reference for the shading of a bump map unit, and it gives the slopes themselves.
#   A strip of 4:1 is usual for brick and wood grain, turning it is what to_uv is for. Tests with square pictures pass. A
#   color texture turned the same way stays right, so color and bumps no longer fit.
# Source: Mitsuba 3, plugin reference, bitmap: to_uv is a matrix that is applied to UV values. Interface of Texture,
#   eval_1_grad: the gradient of the monochromatic value with respect to u and v. By the chain rule the derivatives by
#   pixels have to be multiplied by the resolution first and by the transposed matrix then.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install mitsuba==3.9.1 numpy==2.4.6
cd "$T"  # Mitsuba makes a folder .drjit in HOME
HOME="$T" nice v/bin/python - <<'PY'
import sys
import mitsuba as mi, numpy as np
mi.set_variant("scalar_rgb")

def bitmap(heights, turn=0, scale=(1, 1)):
    to_uv = mi.ScalarTransform4f().rotate([0, 0, 1], turn).scale([*scale, 1])
    return {"type": "bitmap", "bitmap": mi.Bitmap(heights[..., None].copy()), "raw": True, "to_uv": to_uv}

def at(uv):
    si = mi.SurfaceInteraction3f()
    si.uv = uv
    return si

def by_hand(heights, turn, scale, uv):
    """Bilinear interpolation, repeated; pixel centres at one half."""
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    u, v = np.array([[c, -s], [s, c]]) @ (np.array(uv, float) * scale)
    rows, columns = heights.shape
    x, y = u * columns - 0.5, v * rows - 0.5
    x0, y0 = int(np.floor(x)), int(np.floor(y))
    h = lambda j, i: float(heights[j % rows, i % columns])
    top = (1 - x + x0) * h(y0, x0) + (x - x0) * h(y0, x0 + 1)
    return (1 - y + y0) * top + (y - y0) * ((1 - x + x0) * h(y0 + 1, x0) + (x - x0) * h(y0 + 1, x0 + 1))

def slopes_by_hand(heights, turn, scale, uv, step=1e-5):
    return np.array([(by_hand(heights, turn, scale, uv + d) - by_hand(heights, turn, scale, uv - d)) / (2 * step) for d in step * np.eye(2)])

def shading_normal(texture, uv):
    """The bumpmap BSDF around a white diffuse one gives the cosine between the normal and three directions."""
    bsdf = {"type": "bumpmap", "bump": texture, "use_shadowing_function": False,
            "inner": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 1.0}}}
    scene = mi.load_dict({"type": "scene", "plane": {"type": "rectangle", "bsdf": bsdf}})
    si = scene.ray_intersect(mi.Ray3f(mi.Point3f(2 * uv[0] - 1, 2 * uv[1] - 1, 3), mi.Vector3f(0, 0, -1)))
    ways = np.array([[0, 0, 1], [0.28, 0, 0.96], [0, 0.28, 0.96]])
    return np.linalg.solve(ways, [np.pi * si.bsdf().eval(mi.BSDFContext(), si, mi.Vector3f(*w))[0] for w in ways])

def picture(rows, columns):
    y, x = (np.mgrid[0:rows, 0:columns] + 0.5) / np.array([rows, columns])[:, None, None]
    return (0.5 + 0.1 * np.sin(2 * np.pi * x) + 0.05 * np.cos(2 * np.pi * y)).astype("f4")

strip, square = picture(16, 64), picture(64, 64)
cases = {"64 x 16": (strip, 0, (1, 1)), "64 x 16, scaled by 2 and 3": (strip, 0, (2, 3)), "64 x 16, turned by 180": (strip, 180, (1, 1)),
         "64 x 64, turned by 30": (square, 30, (1, 1)), "64 x 64, turned by 90": (square, 90, (1, 1)),
         "16 x 64, turned beforehand": (np.rot90(strip), 0, (1, 1)),
         "64 x 16, turned by 90": (strip, 90, (1, 1)), "64 x 16, turned by 30": (strip, 30, (1, 1))}
uv = np.array([0.37, 0.21])
wrong, got, right = [], {}, {}
for name, case in cases.items():
    texture = mi.load_dict(bitmap(*case))
    height, slope = texture.eval_1(at(uv)), np.array(texture.eval_1_grad(at(uv)), float)
    wanted = slopes_by_hand(*case, uv)
    if abs(height - by_hand(*case, uv)) > 1e-5:
        sys.exit("behaviour changed: the height of " + name)
    n = shading_normal(bitmap(*case), uv)
    # The rectangle is 2 wide and 2 high, so a slope by u or v is twice the one in space.
    if np.abs(-2 * n[:2] / n[2] - slope).max() > 1e-3:
        sys.exit("behaviour changed: the bumpmap BSDF does not follow eval_1_grad")
    true = np.array([*(-wanted / 2), 1]) / np.linalg.norm([*(-wanted / 2), 1])
    angle = np.degrees(np.arccos(min(1, n @ true / np.linalg.norm(n))))
    print(f"{name:28} height {height:.4f}, slopes by u and v {slope.round(4)}, by hand {wanted.round(4)}, normal off by {angle:.1f} degrees")
    got[name], right[name] = slope, wanted
    if np.abs(slope - wanted).max() > 2e-3:
        wrong.append(name)
if wrong != ["64 x 16, turned by 90", "64 x 16, turned by 30"]:
    sys.exit(f"behaviour changed: wrong slopes for {wrong}")
if np.abs(right["64 x 16, turned by 90"] - got["16 x 64, turned beforehand"]).max() > 2e-3:
    sys.exit("behaviour changed: the picture that was turned beforehand")
factors = got["64 x 16, turned by 90"] / right["64 x 16, turned by 90"]
if np.abs(factors / [4, 0.25] - 1).max() > 0.01:
    sys.exit(f"behaviour changed: factors {factors}")
print(f"turned by 90: the slopes are {factors[0]:.2f} and {factors[1]:.2f} times the right ones")
PY
echo "as described"
