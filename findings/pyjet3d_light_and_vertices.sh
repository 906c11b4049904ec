#!/usr/bin/env bash
# pyjet3d: diffuse light follows the square of the cosine, vertices become whole numbers, and the front side is clockwise.
#
# Expected: 1. A white surface that the light meets at an angle of 60 degrees has half of the full
#   brightness, at 45 degrees 71 %: Lambert's law, in all three shading modes. 2. A mesh that takes
#   floats keeps them: a square of half width 1.9 is nearly two times one of 1.0. 3. Triangles whose
#   vertices run counter-clockwise, as the viewer sees them, are the front faces.
# Seen: 1. Brightness is the square of the cosine: 24 % at 60 degrees, 49 % at 45, 6 % at 75 in place of
#   26 %. FLAT, GOURAUD and PHONG agree. With the cosine squared by hand all values are right to
#   within 4 of 255, so the directions are right. Point lights have it too, while ambient light and
#   the light's intensity are linear.
#   2. Coordinates are rounded to whole numbers: half widths of 0.6, 1.0 and 1.4 give one picture, 1.5
#   and 1.9 that of 2.0, and 0.4 vanishes. A sphere of radius 1 is a solid with at most 26 corners.
#   3. With x to the right and y up on the screen, the counter-clockwise triangle is culled, the clockwise
#   one is drawn; the triangle in the docstring that explains the rule is clockwise. No message.
# Versions: pyjet3d 0.3.2, numpy 2.4.6.
# Why it matters: it is one of few integer rasterisers with a Python interface, made for microcontrollers,
#   so it invites comparison with a fixed point lighting unit. A unit that is right differs by a quarter
#   of full scale at 45 degrees. Meshes from glTF are in metres: most of their details round to zero.
# Source: docstring of Scene.addMesh and README of pyjet3d 0.3.2: vertices are sequences of floats;
#   counter-clockwise winding is front facing. Jet's header Material.hpp: with specular 0 GOURAUD and
#   PHONG have a physically plausible response of 1.0; its renderer calls the value Lambert brightness.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install pyjet3d==0.3.2 numpy==2.4.6
cd "$T"
nice v/bin/python - <<'PY'
import sys
import numpy as np, pyjet3d as jet

SIZE = 256

def scene(distance):
    s = jet.Scene(SIZE, SIZE)
    camera = jet.Camera()
    camera.setPosition(0, 0, -distance)  # it looks along z
    camera.setFOV(90, SIZE)  # a point at distance d from the axis is 128 * d / depth pixels from the middle
    camera.nearPlane, camera.farPlane = 1, 8192
    s.setCamera(camera)
    s.thread_count = 1
    return s, camera

def draw(points, triangles, distance, shading="UNLIT", culled=False, normal=None, light=None, ambient=0, point=None):
    s, camera = scene(distance)
    material = jet.Material(0xFFFF)
    material.shadingMode = getattr(jet.ShadingMode, shading)
    mesh = jet.Mesh(points, triangles, [normal] * len(points) if normal else [])
    if not culled:
        mesh.cullingMode = jet.CullingMode.NO_CULLING
    s.addMesh(mesh, material)
    if light:
        azimuth, elevation, intensity = light
        s.setDirectionalLight(jet.DirectionalLight(azimuth=azimuth, elevation=elevation, r=255, g=255, b=255, intensity=intensity))
    if shading != "UNLIT":
        s.setAmbientLight(jet.AmbientLight(ambient, ambient, ambient))
    if point:
        s.addPointLight(point)
    s.render()
    return np.frombuffer(s.get_framebuffer_rgb888(), "u1").reshape(SIZE, SIZE, 3)[..., 1].astype(int)  # green has 6 bits

def square(half):
    return [(-half, -half, 0), (-half, half, 0), (half, half, 0), (half, -half, 0)], [(0, 1, 2), (0, 2, 3)]

# 1. A square that faces the camera; azimuth 270 and elevation 0 is light from the camera's side.
facing = dict(normal=(0, 0, -1), distance=500)
print("angle of the light, Lambert's cosine of 255, its square | FLAT GOURAUD PHONG")
worst = {"cosine": 0, "square": 0}
for angle in (0, 15, 30, 45, 60, 75):
    cosine = np.cos(np.radians(angle))
    got = [draw(*square(100), shading=mode, light=(270, angle, 255), **facing)[128, 128] for mode in ("FLAT", "GOURAUD", "PHONG")]
    print(f"  {angle:2} degrees  {255 * cosine:5.0f} {255 * cosine ** 2:5.0f} | " + " ".join(f"{v:5}" for v in got))
    worst["cosine"] = max(worst["cosine"], max(abs(v - 255 * cosine) for v in got))
    worst["square"] = max(worst["square"], max(abs(v - 255 * cosine ** 2) for v in got))
print(f"largest difference from the cosine {worst['cosine']:.0f}, from its square {worst['square']:.0f}, of 255")
if worst["square"] > 5 or worst["cosine"] < 55:
    sys.exit("behaviour changed: brightness by angle")
# The same by turning the surface, the light stays: normals at 3-4-5 angles.
for x, z in ((3, 4), (4, 3)):
    v = draw(*square(100), shading="PHONG", normal=(x / 5, 0, -z / 5), distance=500, light=(270, 0, 255))[128, 128]
    print(f"  the normal turned to ({x / 5}, 0, -{z / 5}): {v}; the cosine gives {255 * z / 5:.0f}, its square {255 * (z / 5) ** 2:.0f}")
    if abs(v - 255 * (z / 5) ** 2) > 5:
        sys.exit("behaviour changed: brightness by the normal")
linear = [draw(*square(100), shading="FLAT", light=(270, 0, i), **facing)[128, 128].item() for i in (255, 128, 64)]
soft = [draw(*square(100), shading="FLAT", ambient=a, **facing)[128, 128].item() for a in (128, 64)]
print(f"light intensity 255, 128, 64: {linear}; ambient light 128, 64: {soft}")
if max(abs(np.array(linear) - (255, 128, 64)).max(), abs(np.array(soft) - (128, 64)).max()) > 6:
    sys.exit("behaviour changed: intensity")
for offset in (0, 100, 200):
    lamp = jet.PointLight(offset, 0, -100, 255, 255, 255, 0, 4000)
    v = draw(*square(60), shading="PHONG", point=lamp, **facing)[128, 128]
    length = np.hypot(offset, 100)
    fade, cosine = 1 - length / 4000, 100 / length
    print(f"  point light, {offset} to the side of 100: {v}; cosine {255 * fade * cosine:.0f}, square {255 * fade * cosine ** 2:.0f}")
    if abs(v - 255 * fade * cosine ** 2) > 12:
        sys.exit("behaviour changed: point light")

# 2. Squares of a small half width, seen from a distance of 10: half the picture's width is 128 * half / 10 pixels.
seen = {}
for half in (0.4, 0.6, 1.0, 1.4, 1.5, 1.9, 2.0):
    columns = np.nonzero(draw(*square(half), distance=10).any(0))[0]
    seen[half] = len(columns)
print("columns of a square by its half width (exact): " + ", ".join(f"{h}: {n} ({25.6 * h:.0f})" for h, n in seen.items()))
if seen[0.4] != 0 or not seen[0.6] == seen[1.0] == seen[1.4] or not seen[1.5] == seen[1.9] == seen[2.0] or seen[1.4] >= seen[1.5]:
    sys.exit("behaviour changed: coordinates that are no whole numbers")

# 3. Where are x and y on the screen, and which winding is drawn?
for name, middle in (("x = 100", (100, 0)), ("y = 100", (0, 100))):
    p = [(a + middle[0], b + middle[1], 0) for a, b in ((0, 20), (20, -20), (-20, -20))]
    rows, columns = np.nonzero(draw(p, [(0, 1, 2)], distance=500))
    print(f"{name} is at column {columns.mean():.0f}, row {rows.mean():.0f} of {SIZE} (row 0 is the top)")
    if (columns.mean() > 140) != (middle[0] > 0) or (rows.mean() < 116) != (middle[1] > 0):
        sys.exit("behaviour changed: axes of the screen")
clockwise = [(0, 120, 0), (120, -120, 0), (-120, -120, 0)]  # top, bottom right, bottom left: the one of the docstring
counts = {}
for name, points in (("clockwise", clockwise), ("counter-clockwise", clockwise[::-1])):
    (ax, ay), (bx, by), (cx, cy) = (p[:2] for p in points)
    area = ((bx - ax) * (cy - ay) - (cx - ax) * (by - ay)) / 2  # positive is counter-clockwise with y up
    counts[name] = int((draw(points, [(0, 1, 2)], distance=500, culled=True) > 0).sum())
    print(f"{name} (signed area {area:.0f}): {counts[name]} pixels")
    if (area > 0) != (name != "clockwise"):
        sys.exit("the demonstration is wrong")
if counts["clockwise"] < 1000 or counts["counter-clockwise"] != 0:
    sys.exit("behaviour changed: the winding of front faces")
PY
echo "as described"
