#!/usr/bin/env bash
# Two mesh libraries out of four move normals like points when a mesh is made wider.
#
# Expected: a transformation M of a mesh moves its points by M and its normals
#   by the inverse transpose of M, made to unit length, so they stay at right
#   angles to the surface. A normal that a library writes is a unit vector.
# Seen: a face with the normal (1, 1, 0) / sqrt 2 is made four times as wide.
#   trimesh and PyVista give (0.243, 0.970, 0). Open3D gives (2.828, 0.707, 0),
#   62 degrees off, in both of its mesh classes and for point clouds, and writes
#   that as `vn`. PyMeshLab replaces the given unit normal by a sum weighted by
#   angles (length pi / 2) and makes (7.05, 1.76, 0) of it: 62 degrees off, too.
#   No warning.
# Versions: open3d 0.20.0 (numpy 1.26.4), pymeshlab 2025.7.post1, trimesh 5.2.0,
#   pyvista 0.49.1 with vtk 9.7.2 (numpy 2.4.6).
# Why it matters: a reader that takes `vn` as it is shades such a mesh like
#   another shape; an exporter that makes metres of uneven units does it to all.
#   A uniform scale and a turn are right but for the length, so tests pass.
# Source: the rule for normals: K. Turkowski, "Transformations of Surface Normal
#   Vectors" (Apple technical report 22, 1990). Open3D's help says
#   of transform() that it applies a 4 x 4 matrix to the coordinates, and for its
#   tensor class that it transforms points and normals.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
for name in a b; do python3 -m venv "$T/$name"; done
nice "$T/a/bin/pip" -q --disable-pip-version-check install trimesh==5.2.0 pymeshlab==2025.7.post1 pyvista==0.49.1 vtk==9.7.2 numpy==2.4.6
nice "$T/b/bin/pip" -q --disable-pip-version-check install open3d==0.20.0 numpy==1.26.4
cd "$T"
cat > shared.py <<'PY'
import sys
import numpy as np

M = np.diag([4.0, 1, 1, 1])
P = np.array([[0, 0, 0], [-1, 1, 0], [0, 0, 1.0]])
F = np.array([[0, 1, 2]])
N = np.tile(np.array([1, 1, 0]) / 2 ** 0.5, (3, 1))
RIGHT = np.array([0.25, 1, 0]) / np.hypot(0.25, 1)
across = np.cross(*(P[1:] - P[0]))
assert np.allclose(across / np.linalg.norm(across), N[0])

def show(name, normal, want):
    normal = np.asarray(normal, float)
    length = np.linalg.norm(normal)
    angle = np.degrees(np.arccos(np.clip(normal @ RIGHT / length, -1, 1)))
    print(f"{name}: {np.round(normal, 3).tolist()}, length {length:.3f}, {angle:.1f} degrees from the right one")
    if abs(angle - want[0]) > 0.1 or abs(length - want[1]) > 0.01:
        sys.exit("behaviour changed: " + name)
PY
cat > a.py <<'PY'
from shared import *
import trimesh, pyvista, pymeshlab
m = trimesh.Trimesh(P, F, process=False, vertex_normals=N)
m.apply_transform(M)
show("trimesh", m.vertex_normals[0], (0, 1))
m = pyvista.PolyData(P, [3, 0, 1, 2])
m.point_data["Normals"] = N
m.point_data.active_normals_name = "Normals"
show("PyVista", m.transform(M, inplace=False).point_data["Normals"][0], (0, 1))
s = pymeshlab.MeshSet()
s.add_mesh(pymeshlab.Mesh(P, F, v_normals_matrix=N))
before = np.linalg.norm(s.current_mesh().vertex_normal_matrix()[0])
s.set_matrix(transformmatrix=M)
assert np.allclose(s.current_mesh().vertex_matrix()[1], [-4, 1, 0])
after = s.current_mesh().vertex_normal_matrix()[0]
print(f"PyMeshLab before: length {before:.3f}")
show("PyMeshLab", after, (61.93, 7.270))
PY
cat > b.py <<'PY'
from shared import *
import open3d
points, faces = open3d.utility.Vector3dVector(P), open3d.utility.Vector3iVector(F)
m = open3d.geometry.TriangleMesh(points, faces)
m.vertex_normals = open3d.utility.Vector3dVector(N)
t = open3d.t.geometry.TriangleMesh.from_legacy(m)
m.transform(M)
show("Open3D", m.vertex_normals[0], (61.93, 2.915))
t.transform(M)
show("Open3D, tensor class", t.vertex.normals.numpy()[0], (61.93, 2.915))
cloud = open3d.geometry.PointCloud(points)
cloud.normals = open3d.utility.Vector3dVector(N)
cloud.transform(M)
show("Open3D, cloud", cloud.normals[0], (61.93, 2.915))
open3d.io.write_triangle_mesh("m.obj", m)
line = next(line for line in open("m.obj") if line.startswith("vn "))
print("as written by Open3D:", line.strip())
if not np.allclose([float(x) for x in line.split()[1:]], [2.828427, 0.707107, 0], atol=1e-5):
    sys.exit("behaviour changed: Open3D writes another normal")
PY
nice a/bin/python a.py
nice b/bin/python b.py
echo "as described"
