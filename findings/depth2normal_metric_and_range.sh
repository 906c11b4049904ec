#!/usr/bin/env bash
# depth2normal: normals of a metric depth map point away from the camera, and one sample over 1.0 makes a height map flat.
#
# Expected: 1. With a focal length, the normals of the surface that a pinhole camera sees face the
#   camera: the right side of a ball points to the right. 2. With the range "auto" the same surface has
#   the same slopes, whether its highest sample is 1.0 or 1.001, or 255 or 256.
# Seen: 1. Each normal is turned round: the right side of the ball points to the left, and 8-bit blue is
#   always over 127, so that shaded like a normal map the ball is a hollow. No usual convention of axes makes it
#   right: x, y and z all have the other sign than OpenCV's. The mode for height fields of the same
#   package has the right signs for the same ball. invert=True does not help: it takes the distance from the
#   farthest sample, so one pixel of sky makes a wall, tilted by 28 degrees, flat.
#   2. A smooth hill of height 1.0 has slopes of up to 83 degrees, of height 1.001 up to 7 degrees. The
#   same from 255 to 256, in 16 bits too. Heights are multiplied by 255, 1 or 1/257, by the highest
#   sample alone: up to 1, to 255, to 65535. Nothing is reported.
# Versions: depth2normal 2.0.1, opencv-python-headless 5.0.0.93, pillow 13.0.0, numpy 2.4.6.
# Why it matters: a normal map with both signs turned round is a bump in place of a hollow, the classic
#   mistake of a bump mapping unit; a reference must not make it. A filter that overshoots by one part in
#   thousand, or a hill of 256 m in a map of metres, changes the relief 255 times.
# Source: README and docstrings of depth2normal 2.0.1. On focal: metric distance from a pinhole camera;
#   returns the normals of that 3-D surface. On the range auto: divides by the range that the values
#   came from, steady across a sequence; strength means the same in every file.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install depth2normal==2.0.1 opencv-python-headless==5.0.0.93 \
  pillow==13.0.0 numpy==2.4.6
cd "$T"
nice v/bin/python - <<'PY'
import sys
import cv2, depth2normal, numpy as np
from PIL import Image

size, focal = 129, 100.0
centre = (size - 1) / 2
rows, columns = np.mgrid[0:size, 0:size]
rays = np.stack([(columns - centre) / focal, (rows - centre) / focal, np.ones((size, size))], -1)  # right, down, forward
camera = np.array([[focal, 0, centre], [0, focal, centre], [0, 0, 1]], "f4")

def opencv(depth):
    points = np.concatenate([rays * depth[..., None], np.zeros((size, size, 1))], -1).astype("f4")
    method = cv2.RgbdNormals_RGBD_NORMALS_METHOD_CROSS_PRODUCT
    return cv2.RgbdNormals_create(size, size, cv2.CV_32F, camera, 5, 50.0, method).apply(points)[..., :3]

def tested(depth, **more):
    return depth2normal.depth_to_normal(depth, method="sobel", **more) / 127.5 - 1

def metric(depth, **more):
    return tested(depth, depth_range="raw", focal=focal, **more)

def degrees(a, b):
    cosine = (a * b).sum(-1) / np.linalg.norm(a, axis=-1) / np.linalg.norm(b, axis=-1)
    return np.degrees(np.arccos(np.clip(cosine, -1, 1)))

def text(vector):
    return "(" + ", ".join(f"{v + 0.0:5.2f}" for v in np.round(vector, 2)) + ")"

# A ball of radius 1, its centre 3 in front of the camera, before a wall at 5.
a, b, c = (rays ** 2).sum(-1), 3 * rays[..., 2], 8.0
discriminant = b * b - a * c
seen = discriminant >= 0
distance = np.where(seen, (b - np.sqrt(np.maximum(discriminant, 0))) / a, 5.0)  # rays have z = 1: this is the depth
truth = rays * distance[..., None] - [0, 0, 3]  # outward, radius 1
got, other, field = metric(distance), opencv(distance), tested((5 - distance) * 30, depth_range="raw")
print("ball, places of the picture: normal by hand (right, down, forward) | OpenCV | depth2normal, focal | its height field")
for name, r, q in (("middle", 64, 64), ("right", 64, 84), ("left", 64, 44), ("top", 44, 64), ("bottom", 84, 64)):
    print(f"  {name:7}" + " | ".join(text(n[r, q]) for n in (truth, other, got, field)))
inside = np.hypot(columns - centre, rows - centre) < 25
print(f"largest angle to the normal by hand: OpenCV {degrees(other, truth)[inside].max():.2f} degrees, depth2normal "
      f"{degrees(got, truth)[inside].max():.2f}, depth2normal with all signs turned round {degrees(-got, truth)[inside].max():.2f}")
if degrees(other, truth)[inside].max() > 2 or degrees(-got, truth)[inside].max() > 2:
    sys.exit("behaviour changed: normals of the ball")
if not (got[64, 84, 0] < -0.3 and field[64, 84, 0] > 0.3 and (got[..., 2] >= 0).all()):
    sys.exit("behaviour changed: the two modes agree")

# A tilted wall. With invert=True it depends on one pixel in the corner.
normal = np.array([0.5, 0.2, -1.0]) / np.linalg.norm([0.5, 0.2, -1.0])
wall = -2 / (rays @ normal)
print(f"wall: normal by hand {text(normal)}, OpenCV {text(opencv(wall)[64, 64])}, depth2normal {text(metric(wall)[64, 64])}")
inverted = []
for more in (0, 10, 100):
    copy = wall.copy()
    copy[0, 0] = wall.max() + more
    inverted.append(metric(copy, invert=True)[64, 64])
    print(f"  invert=True, one corner pixel {more:3} behind the farthest part of the wall: middle {text(inverted[-1])}")
if not (inverted[0][0] > 0.4 and inverted[1][0] < 0.15 and abs(inverted[2][0]) < 0.01):
    sys.exit("behaviour changed: inverted metric depth")

# The range "auto", the default: a smooth hill, only the height of its top differs.
hill = np.exp(-((columns - centre) ** 2 + (rows - centre) ** 2) / 800)
steep = {}
for top in (0.999, 1.0, 1.001, 255.0, 256.0, 65535.0, 65536.0):
    steep[top] = np.degrees(np.arccos(tested(hill * top)[..., 2].min()))
for top in (255, 256):
    Image.fromarray(np.round(hill * top).astype("u2")).save("hill.png")
    depth2normal.convert("hill.png", "normal.png")
    steep[f"16-bit PNG, {top}"] = np.degrees(np.arccos((np.asarray(Image.open("normal.png"))[..., 2] / 127.5 - 1).min()))
print("steepest slope of the hill by the height of its top: " + "; ".join(f"{k}: {v:.0f} degrees" for k, v in steep.items()))
for top, value in steep.items():
    flat = top in (1.001, 256.0, "16-bit PNG, 256")
    if value > 10 if flat else value < 80:
        sys.exit(f"behaviour changed: the hill of height {top}")
overshoot = hill * 0.9
overshoot[0, 0] = 1.001
change = degrees(tested(overshoot), tested(hill * 0.9))[10:, 10:].max()
print(f"one corner sample of 1.001 turns normals elsewhere by up to {change:.0f} degrees")
if change < 60:
    sys.exit("behaviour changed: one sample over 1.0")
PY
echo "as described"
