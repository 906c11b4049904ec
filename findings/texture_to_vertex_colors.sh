#!/usr/bin/env bash
# Colours from a texture: trimesh repeats it w/(w-1) times too wide, the two filters of pymeshlab are one pixel off, each in other places.
#
# Expected: "give each vertex the colour of the texture at its texture coordinates" has one answer in the middle of a texel. A texture of
#   w x h pixels repeats at each whole number; u = 3.5/w is the middle of column 3, and so is 1 + 3.5/w.
# Seen: 1. trimesh multiplies u by w-1 and wraps at w. From 0 to 1 the nearest pixel is right in the middle of a texel, though the first and
#   last column are only half as wide as the others. Then the picture moves by one pixel with each repetition: a texture of 8
#   columns is 1 column off at u = 1 to 2, 4 at u = 4 to 5, right again at u = 8 to 9. A checkerboard of 2 x 2 pixels is inverted in each
#   second tile. The same in v. So in to_color() of a mesh from OBJ, of one from glTF, and in sample_surface with sample_color.
#   That one interpolates as well, and is up to half a texel off within 0 to 1.
#   2. pymeshlab's compute_color_from_texture_per_vertex repeats as it should and has the right columns, but takes the row above
#   the right one; the top row is used twice, the bottom row never. Its transfer_texture_to_color_per_vertex, with the same mesh as source and
#   target, is right for u from 0 on and v up to 1. For negative u it takes the next column, for v above 1 the row below.
#   No message in any case.
# Versions: trimesh 5.2.0, pymeshlab 2025.7.post1, numpy 2.4.6, pillow 13.0.0.
# Why it matters: these calls give the expected texels of a texture unit without a renderer, tiled textures are its test for the wrap mode, and a height
#   or normal map has thin features: one row is a groove on the wrong side of an edge. Whoever compares with trimesh on a
#   large texture within 0 to 1 finds nothing. The two filters of pymeshlab differ from each other.
# Source: glTF 2.0, samplers: without wrapS and wrapT the texture repeats; images: (0, 0) is the upper left corner of the picture, so not
#   the middle of a pixel. Specification of MTL: -clamp is off unless it is given. Vulkan, texel coordinates: nearest is floor(u * w),
#   then the wrap. Docstring of trimesh's uv_to_color: the color at each of the UV coordinates. pymeshlab's list of filters: "Texture to
#   Vertex color transfer", and for the other one vertex colors are picked from a texture of the same or another mesh.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install trimesh==5.2.0 pymeshlab==2025.7.post1 numpy==2.4.6 pillow==13.0.0
cd "$T"
nice v/bin/python - <<'PY'
import sys
import numpy as np, pymeshlab, trimesh
from PIL import Image

def expect(ok, what):
    if not ok:
        sys.exit("behaviour changed: " + what)

def texture(width, height):  # red is the column, green the row, from the top
    pixels = np.zeros((height, width, 3), "u1")
    pixels[..., 0] = np.arange(width)
    pixels[..., 1] = np.arange(height)[:, None]
    Image.fromarray(pixels).save("t.png")
    open("m.mtl", "w").write("newmtl a\nKd 1 1 1\nmap_Kd t.png\n")

def write(uv):  # a triangle of its own for each point, all corners with the same texture coordinates
    lines = ["mtllib m.mtl", "usemtl a"]
    for i in range(len(uv)):
        lines += [f"v {3 * i} 0 0", f"v {3 * i + 1} 0 0", f"v {3 * i} 1 0"]
    lines += [f"vt {u:.9f} {v:.9f}" for u, v in uv]
    lines += [f"f {3 * i + 1}/{i + 1} {3 * i + 2}/{i + 1} {3 * i + 3}/{i + 1}" for i in range(len(uv))]
    open("m.obj", "w").write("\n".join(lines) + "\n")

def by_trimesh(name):
    mesh = trimesh.load(name, process=False, force="mesh")
    return mesh.visual.to_color().vertex_colors[mesh.faces[:, 0]][:, :2].astype(int)

def sampled(count):  # flat triangles, so any point of a triangle has its colour
    mesh = trimesh.load("m.obj", process=False, force="mesh")
    points, faces, colors = trimesh.sample.sample_surface(mesh, 40 * count, sample_color=True, seed=1)
    result = np.full((count, 2), -1)
    result[np.round((points[:, 0] - 0.4) / 3).astype(int)] = colors[:, :2]
    return result

def by_pymeshlab(transfer):
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh("m.obj")
    if transfer:
        meshes.load_new_mesh("m.obj")
        meshes.apply_filter("transfer_texture_to_color_per_vertex", sourcemesh=0, targetmesh=1)
    else:
        meshes.apply_filter("compute_color_from_texture_per_vertex")
    mesh = meshes.current_mesh()
    return (mesh.vertex_color_matrix() * 255).round().astype(int)[mesh.face_matrix()[:, 0]][:, :2]

width, height = 8, 4
texture(width, height)
cells = [(i, j) for j in range(height) for i in range(width)]
right = np.array(cells)
print(f"{width} x {height} pixels, middle of each texel; offset of the colours in columns and rows, without the wrap:")
for du, dv in ((0, 0), (1, 0), (4, 0), (8, 0), (-1, 0), (0, 1), (0, -2)):
    write([((i + 0.5) / width + du, 1 - (j + 0.5) / height + dv) for i, j in cells])
    ours = np.stack([np.floor(((right[:, 0] + 0.5) / width + du) * width) % width,
                     np.floor(((right[:, 1] + 0.5) / height - dv) * height) % height], 1)
    expect(np.array_equal(ours, right), "arithmetic")
    a, b, c, d = by_trimesh("m.obj"), by_pymeshlab(False), by_pymeshlab(True), sampled(len(cells))
    move = (a - right) % (width, height)
    lower = (b - right)[width:]
    next_one = (c - right) % (width, height)
    wrong = int((np.abs(d - right).max(1) > 0.5).sum())
    print(f"  tile {du:2} {dv:2}: trimesh {move.min(0)} to {move.max(0)}; sample_surface: {wrong} of {len(cells)} are another pixel; "
          f"pymeshlab compute {lower.min(0)} to {lower.max(0)}, transfer {next_one.min(0)} to {next_one.max(0)}")
    expect((move == (-du % width, dv % height)).all(), "trimesh, tile " + str((du, dv)))
    expect((lower == (0, -1)).all() and np.array_equal(b[:width], right[:width]), "pymeshlab, compute")
    expect((next_one == (du < 0, dv > 0)).all(), "pymeshlab, transfer")
    expect(wrong == 0 if (du, dv) in ((0, 0), (8, 0)) else wrong > len(cells) // 2, "sample_surface")

# Eight points in each texel of one tile: how wide is a column?
steps = (np.arange(64) + 0.5) / 64
write([(u, 0.4) for u in steps])
widths = np.bincount(by_trimesh("m.obj")[:, 0], minlength=width)
print("points out of 8 in each column, trimesh:", widths)
expect(np.bincount(by_pymeshlab(True)[:, 0]).tolist() == [8] * 8, "columns of pymeshlab")
expect(widths[0] < 6 and widths[-1] < 6 and (widths[1:-1] > 8).all(), "columns of trimesh")

# A checkerboard, through OBJ and through glTF.
texture(2, 2)
tiles = range(6)
write([(t + 0.25, 0.75) for t in tiles])
trimesh.load("m.obj", process=False, force="mesh").export("m.glb")
obj, glb, board = by_trimesh("m.obj")[:, 0], by_trimesh("m.glb")[:, 0], by_pymeshlab(True)[:, 0]
print(f"2 x 2 pixels, left column in the tiles 0 to 5: trimesh OBJ {obj}, GLB {glb}, pymeshlab transfer {board}")
expect(obj.tolist() == glb.tolist() == [0, 1] * 3 and not board.any(), "checkerboard")
PY
echo "as described"
