"""Rows of meshes."""
import numpy as np

import right
import shapes
from bench import ball, mesh, mirror_scene, row

FRONT = right.from_front(2.0, (48, 48))
ASKEW = right.Camera((60, 90, 120), (0, 0, 0), fov_y=1.5, size=(64, 64))
TWO = shapes.letter_triangles() + shapes.box_triangles(0.5, 0.5, 1.3, 1.3)


@row("Blender", "bpy", "blender_two.obj", "silhouettes of a concave polygon and a second object")
def _(folder):
    return mesh(folder, "blender_two.obj", FRONT, TWO)


@row("Blender", "bpy", "blender_smooth.obj", "normals from smoothing groups alone: round sides, flat caps")
def _(folder):
    return mesh(folder, "blender_smooth.obj", ASKEW, *shapes.tube_triangles())


@row("Blender", "bpy", "blender_normals.obj", "the same tube with written normals")
def _(folder):
    return mesh(folder, "blender_normals.obj", ASKEW, *shapes.tube_triangles())


# The node of the ball: 0.75 of the size, at Blender's (0.5, 0, -0.25).
@row("Blender", "bpy", "blender_node.glb", "a smooth ball, scaled and moved by its node", 6)
def _(folder):
    return ball(folder, "blender_node.glb", FRONT, (0.5, -0.25, 0), 0.75)


@row("Blender", "bpy", "blender_sheared.glb", "normal map on a sheared chart: MikkTSpace's frame", 3, is_imported=True)
def _(folder):
    return bumpy_square(folder, "blender_sheared.glb", shapes.box_triangles(-1, -1, 1, 1), (1, 0, 0), (0, 1, 0))


@row("Blender", "bpy", "blender.ply", "a smooth ball", 6)
def _(folder):
    return ball(folder, "blender.ply", FRONT, (0.5, 0, -0.25), 0.75)


@row("Blender", "bpy", "blender.stl", "a smooth ball", 6)
def _(folder):
    return ball(folder, "blender.stl", FRONT, (0.5, 0, -0.25), 0.75)


@row("Blender", "bpy", "blender.usdc", "a smooth ball", 6)
def _(folder):
    return ball(folder, "blender.usdc", FRONT, (0.5, 0, -0.25), 0.75)


@row("Open3D", "open3d", "open3d_ball.obj", "a ball with written normals", 4)
def _(folder):
    return ball(folder, "open3d_ball.obj", FRONT, (0, 0, 0), 1)


@row("Open3D", "open3d", "open3d_ball.glb", "a ball of glTF", 4)
def _(folder):
    return ball(folder, "open3d_ball.glb", FRONT, (0, 0, 0), 1)


@row("trimesh", "trimesh", "trimesh_box.obj", "flat faces of a turned box")
def _(folder):
    return trimesh_box(folder, "trimesh_box.obj")


@row("trimesh", "trimesh", "trimesh_box.glb", "flat faces of a turned box")
def _(folder):
    return trimesh_box(folder, "trimesh_box.glb")


@row("trimesh", "trimesh", "trimesh_box.ply", "flat faces of a turned box")
def _(folder):
    return trimesh_box(folder, "trimesh_box.ply")


def trimesh_box(folder, file):
    import trimesh
    box = trimesh.creation.box(extents=(1, 2, 0.5))
    turn = trimesh.transformations.euler_matrix(0.4, -0.6, 0.2)
    box.apply_transform(turn)
    box.unmerge_vertices()
    box.export(folder / file, **({"include_normals": True} if file.endswith("obj") else {}))
    return mesh(folder, file, FRONT, box_faces((1, 2, 0.5), turn[:3, :3]))


def box_faces(size, matrix, centre=(0, 0, 0)):
    """Triangles of a box around `centre` after a linear map."""
    triangles = []
    for axis in range(3):
        for side in (1, -1):
            a, b = np.zeros(3), np.zeros(3)
            a[(axis + 1) % 3], b[(axis + 2) % 3] = size[(axis + 1) % 3] / 2, size[(axis + 2) % 3] / 2
            middle = np.array(centre, float)
            middle[axis] += side * size[axis] / 2
            p = [middle - a * side - b, middle + a * side - b, middle + a * side + b, middle - a * side + b]
            p = [matrix @ corner for corner in p]
            triangles += [[p[0], p[1], p[2]], [p[0], p[2], p[3]]]
    return triangles


@row("PyMeshLab", "pymeshlab", "pymeshlab_ball.obj", "a ball without normals, colours after the coordinates of vertices", 4)
def _(folder):
    import pymeshlab
    meshes = pymeshlab.MeshSet()
    meshes.create_sphere(radius=1, subdiv=6)
    meshes.compute_color_by_function_per_vertex()
    meshes.save_current_mesh(str(folder / "pymeshlab_ball.obj"), save_vertex_color=True, save_vertex_normal=False)
    return ball(folder, "pymeshlab_ball.obj", FRONT, (0, 0, 0), 1)


@row("PyMeshLab", "pymeshlab", "pymeshlab_letter.obj", "a concave polygon as two polygons with faux edges removed")
def _(folder):
    import pymeshlab
    vertices, faces = shapes.letter()
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(np.array(vertices, float), face_list_of_indices=[np.array(faces[0], "i4")]))
    meshes.save_current_mesh(str(folder / "pymeshlab_letter.obj"), save_vertex_normal=False, save_polygonal=True)
    return mesh(folder, "pymeshlab_letter.obj", FRONT, shapes.letter_triangles())


@row("meshio", "meshio", "meshio_letter.obj", "two objects' squares and triangles without normals")
def _(folder):
    import meshio
    points, cells, want = [], [], []
    for left, bottom, edge in [(-1.5, -1.5, 1), (0.25, 0.25, 0.75)]:
        points += [(left, bottom, 0), (left + edge, bottom, 0), (left + edge, bottom + edge, 0), (left, bottom + edge, 0)]
        want += shapes.box_triangles(left, bottom, left + edge, bottom + edge)
    cells = [("quad", np.array([[0, 1, 2, 3]])), ("triangle", np.array([[4, 5, 6], [4, 6, 7]]))]
    meshio.write(folder / "meshio_letter.obj", meshio.Mesh(np.array(points), cells))
    return mesh(folder, "meshio_letter.obj", FRONT, want)


@row("PyVista", "pyvista", "pyvista_ball.obj", "a ball with VTK's normals and texture coordinates", 4)
def _(folder):
    import pyvista
    thing = pyvista.Sphere(radius=1, theta_resolution=120, phi_resolution=120)
    thing.save(folder / "pyvista_ball.obj")
    return ball(folder, "pyvista_ball.obj", FRONT, (0, 0, 0), 1)


@row("Pixar USD", "usd-core", "usd_square.usda", "a square")
def _(folder):
    from pxr import Usd, UsdGeom
    stage = Usd.Stage.CreateNew(str(folder / "usd_square.usda"))
    thing = UsdGeom.Mesh.Define(stage, "/square")
    vertices, faces = shapes.square((0, 0, 0), 1)
    thing.CreatePointsAttr(vertices)
    thing.CreateFaceVertexCountsAttr([4])
    thing.CreateFaceVertexIndicesAttr(list(faces[0]))
    stage.Save()
    return mesh(folder, "usd_square.usda", FRONT, shapes.box_triangles(-1, -1, 1, 1))


# The same transforms as in scenes.mjs.
def three_box(folder, file):
    a, b = np.pi / 6, np.pi / 5
    about_x = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    about_y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    return mesh(folder, file, FRONT, box_faces((1, 1, 1), about_x @ about_y @ np.diag([1.5, 1, 1]), (0.25, 0, 0)))


@row("three.js", "three", "three_box.obj", "a box under a scaled and turned group")
def _(folder):
    return three_box(folder, "three_box.obj")


@row("three.js", "three", "three_box.glb", "the same with its nodes")
def _(folder):
    return three_box(folder, "three_box.glb")


def bumpy_square(folder, file, triangles, along, above):
    """A square mirror in the plane z = 0 whose normal map says BUMP everywhere, in this frame."""
    x, y, z = right.unit(shapes.BUMP)
    normal = x * np.array(along, float) + y * np.array(above, float) + z * np.array([0.0, 0, 1])
    return mesh(folder, file, FRONT, triangles, np.tile(normal, (len(triangles), 3, 1)))


# The node turns u to +y and the picture's up to -x; the square is at y from -0.5 to 1.5 before its scale of 0.5 along u.
@row("glTF Transform", "@gltf-transform/core", "transform_square.glb", "quantized square, normal map, tangents, two nodes", 4,
     is_imported=True)
def _(folder):
    return bumpy_square(folder, "transform_square.glb", shapes.box_triangles(-1, -0.25, 1, 0.75), (0, 1, 0), (-1, 0, 0))


@row("glTF Transform", "@gltf-transform/core", "transform_floats.glb", "the same square in floats", 4, is_imported=True)
def _(folder):
    return bumpy_square(folder, "transform_floats.glb", shapes.box_triangles(-1, -0.25, 1, 0.75), (0, 1, 0), (-1, 0, 0))


@row("pygltflib", "pygltflib", "pygltflib_square.gltf", "a square in JSON with its buffer as base64, byte indices")
def _(folder):
    import pygltflib as g
    vertices, _ = shapes.square((0.25, -0.25, 0), 1)
    points = np.array(vertices, "f4").tobytes()
    indices = np.array([0, 1, 2, 0, 2, 3], "u1").tobytes()
    model = g.GLTF2(
        scene=0, scenes=[g.Scene(nodes=[0])], nodes=[g.Node(mesh=0)],
        meshes=[g.Mesh(primitives=[g.Primitive(attributes=g.Attributes(POSITION=0), indices=1)])],
        accessors=[g.Accessor(bufferView=0, componentType=g.FLOAT, count=4, type=g.VEC3, min=[-0.75, -1.25, 0], max=[1.25, 0.75, 0]),
                   g.Accessor(bufferView=1, componentType=g.UNSIGNED_BYTE, count=6, type=g.SCALAR)],
        bufferViews=[g.BufferView(buffer=0, byteLength=48), g.BufferView(buffer=0, byteOffset=48, byteLength=6)],
        buffers=[g.Buffer(byteLength=54)])
    model.set_binary_blob(points + indices)
    model.convert_buffers(g.BufferFormat.DATAURI)
    model.save(str(folder / "pygltflib_square.gltf"))
    return mesh(folder, "pygltflib_square.gltf", FRONT, shapes.box_triangles(-0.75, -1.25, 1.25, 0.75))
