#!/usr/bin/env bash
# Two mesh readers out of four give relative indices of OBJ other points, in silence.
#
# Expected: in an OBJ file, -1 is the point read last before the face, -2 the
#   one before it. Readers turn them into absolute indices where they stand. A
#   reader that cannot says so.
# Seen: a file has points, a face, further points and a face, both "-3 -2 -1".
#   trimesh counts from the end of the whole file: both triangles are the second
#   one. meshio takes 1 off each index, whatever its sign, and keeps -4, -3, -2.
#   numpy counts those from the end, too: both triangles are twice the same one
#   that joins the two, also in the STL that meshio writes. Neither warns.
#   PyVista (VTK) and PyMeshLab read both triangles.
# Versions: meshio 5.3.5, trimesh 5.2.0, numpy 2.4.6, pyvista 0.49.1,
#   pymeshlab 2025.7.post1.
# Why it matters: writers that stream parts, and files put together from several
#   by `cat`, use relative indices. A file of one part passes in trimesh, so its
#   tests do, too. The count of triangles stays right in both.
# Source: Wavefront's OBJ specification (Advanced Visualizer manual, Appendix B1),
#   on negative reference numbers: -1 is the last vertex above the statement.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install meshio==5.3.5 trimesh==5.2.0 pymeshlab==2025.7.post1 pyvista==0.49.1 numpy==2.4.6
cd "$T"
cat > a.obj <<'OBJ'
v 0 0 0
v 1 0 0
v 0 1 0
f -3 -2 -1
v 0 0 5
v 1 0 5
v 0 1 5
f -3 -2 -1
OBJ
nice v/bin/python - <<'PY'
import sys
import numpy as np, meshio, trimesh, pymeshlab, pyvista

right = [[0, 1, 2], [3, 4, 5]]
s = pymeshlab.MeshSet()
s.load_new_mesh("a.obj")
others = {"PyVista": pyvista.read("a.obj").faces.reshape(-1, 4)[:, 1:].tolist(),
          "PyMeshLab": s.current_mesh().face_matrix().tolist()}
for name, faces in others.items():
    print(f"{name}: {faces}")
loaded = trimesh.load("a.obj", process=False)
print(f"trimesh: {loaded.faces.tolist()}, its triangles have the z {loaded.triangles[..., 2].tolist()}")
mesh = meshio.read("a.obj")
faces = mesh.cells_dict["triangle"].tolist()
print(f"meshio: {faces}, its triangles have the z {mesh.points[faces][..., 2].tolist()}; right is [[0, 0, 0], [5, 5, 5]]")
meshio.write("a.stl", mesh)
solid = trimesh.load("a.stl", process=False).triangles[..., 2].tolist()
print(f"the STL that meshio writes: z {solid}")
if any(faces_ != right for faces_ in others.values()):
    sys.exit("behaviour changed: a second opinion differs")
if loaded.triangles[..., 2].tolist() != [[5, 5, 5]] * 2:
    sys.exit("behaviour changed: trimesh reads relative indices in another way")
if faces != [[-4, -3, -2]] * 2 or solid != [[0, 5, 5]] * 2:
    sys.exit("behaviour changed: meshio reads relative indices in another way")
PY
echo "as described"
