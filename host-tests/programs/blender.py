"""Files by Blender (bpy) and Open3D, which need an older numpy than the others. The shapes are said again in meshes.py."""
import json
import math
import os
import sys

import bpy
import numpy as np
import open3d

import shapes

os.chdir(sys.argv[1])


def empty():
    bpy.ops.wm.read_factory_settings(use_empty=True)


def add(name, vertices, faces, smooth=None, place=(0, 0, 0), turn=(0, 0, 0), scale=(1, 1, 1)):
    """An object from points of a y-up world; Blender's is z-up."""
    data = bpy.data.meshes.new(name)
    data.from_pydata([(x, -z, y) for x, y, z in vertices], [], [list(f) for f in faces])
    if smooth is not None:
        data.polygons.foreach_set("use_smooth", smooth)
    thing = bpy.data.objects.new(name, data)
    thing.location, thing.rotation_euler, thing.scale = place, turn, scale
    bpy.context.scene.collection.objects.link(thing)
    return thing


# Two objects, the first a concave polygon.
empty()
add("L", *shapes.letter())
add("square", *shapes.square((0.9, 0.9, 0), 0.4))
bpy.ops.wm.obj_export(filepath="blender_two.obj", export_normals=False, export_materials=False)

# A tube with flat caps: its normals stand in smoothing groups alone.
empty()
vertices, faces = shapes.tube()
tube = add("tube", vertices, faces, smooth=[len(f) == 4 for f in faces])
bpy.context.view_layer.objects.active = tube
tube.select_set(True)
bpy.ops.object.shade_smooth_by_angle(angle=math.radians(50))
bpy.ops.wm.obj_export(filepath="blender_smooth.obj", export_normals=False, export_smooth_groups=True, export_materials=False)
bpy.ops.wm.obj_export(filepath="blender_normals.obj", export_normals=True, export_materials=False)

# A ball, moved and scaled by its node, as GLB; then the same as PLY and STL.
empty()
bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=5, radius=1)
bpy.ops.object.shade_smooth()
bpy.context.object.location, bpy.context.object.scale = (0.5, 0, -0.25), (0.75, 0.75, 0.75)
bpy.ops.export_scene.gltf(filepath="blender_node.glb", export_format="GLB", export_materials="NONE")
bpy.ops.wm.ply_export(filepath="blender.ply")
bpy.ops.wm.stl_export(filepath="blender.stl")
bpy.ops.wm.usd_export(filepath="blender.usdc")

# A sheared chart with a normal map and a roughness, as GLB.
empty()
pixels = np.ones((8, 8, 4), "f4")
pixels[..., :3] = (np.array(shapes.BUMP) + 1) / 2
image = bpy.data.images.new("bump", 8, 8, float_buffer=False)
image.colorspace_settings.name = "Non-Color"
image.pixels.foreach_set(pixels.ravel())
image.filepath_raw, image.file_format = os.path.abspath("bump_of_blender.png"), "PNG"
image.save()
image.pack()
vertices, faces = shapes.square((0, 0, 0), 1)
chart = add("chart", vertices, faces)
layer = chart.data.uv_layers.new(name="UVMap")
layer.data.foreach_set("uv", np.array(shapes.SHEARED, "f4").ravel())
material = bpy.data.materials.new("bumpy")
material.use_nodes = True
nodes, links = material.node_tree.nodes, material.node_tree.links
texture, bump = nodes.new("ShaderNodeTexImage"), nodes.new("ShaderNodeNormalMap")
texture.image = image
links.new(texture.outputs["Color"], bump.inputs["Color"])
shader = next(n for n in nodes if n.type == "BSDF_PRINCIPLED")
links.new(bump.outputs["Normal"], shader.inputs["Normal"])
shader.inputs["Roughness"].default_value, shader.inputs["Metallic"].default_value = 0.0, 1.0
shader.inputs["Base Color"].default_value = (1, 1, 1, 1)
chart.data.materials.append(material)
bpy.ops.export_scene.gltf(filepath="blender_sheared.glb", export_format="GLB", export_tangents=False)

# The test surroundings, drawn by Cycles through a panoramic camera, with passes.
empty()
scene = bpy.context.scene
scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 64, False
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 128, 64, 100
scene.cycles.pixel_filter_type = "BOX"
camera = bpy.data.cameras.new("camera")
camera.type, camera.panorama_type = "PANO", "EQUIRECTANGULAR"
thing = bpy.data.objects.new("camera", camera)
thing.rotation_euler = (math.pi / 2, 0, 0)
scene.collection.objects.link(thing)
scene.camera = thing
world = bpy.data.worlds.new("world")
scene.world = world
world.use_nodes = True
nodes, links = world.node_tree.nodes, world.node_tree.links
place, split, join = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeSeparateXYZ"), nodes.new("ShaderNodeCombineXYZ")
links.new(place.outputs["Generated"], split.inputs[0])
back = next(n for n in nodes if n.type == "BACKGROUND")
# (x, y, z) of a y-up world is (x, z, -y) of Blender's; the colour is (direction + 1) / 2.
for axis, (source, factor) in enumerate([("X", 0.5), ("Z", 0.5), ("Y", -0.5)]):
    sum_ = nodes.new("ShaderNodeMath")
    sum_.operation = "MULTIPLY_ADD"
    sum_.inputs[1].default_value, sum_.inputs[2].default_value = factor, 0.5
    links.new(split.outputs[source], sum_.inputs[0])
    links.new(sum_.outputs[0], join.inputs[axis])
links.new(join.outputs[0], back.inputs[0])
view = scene.view_layers[0]
view.use_pass_z = view.use_pass_normal = True
settings = scene.render.image_settings
if hasattr(settings, "media_type"):
    settings.media_type = "MULTI_LAYER_IMAGE"
settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "16"
scene.render.filepath = os.path.abspath("blender_layers.exr")
bpy.ops.render.render(write_still=True)
if hasattr(settings, "media_type"):
    settings.media_type = "IMAGE"
settings.file_format, settings.color_depth, settings.color_mode = "OPEN_EXR", "32", "RGBA"
scene.render.filepath = os.path.abspath("blender_panorama.exr")
bpy.ops.render.render(write_still=True)
settings.file_format = "HDR"
settings.color_mode = "RGB"
scene.render.filepath = os.path.abspath("blender_panorama.hdr")
bpy.ops.render.render(write_still=True)

# Open3D: a ball and a torus of triangles.
ball = open3d.geometry.TriangleMesh.create_sphere(radius=1.0, resolution=60)
ball.compute_vertex_normals()
open3d.io.write_triangle_mesh("open3d_ball.obj", ball)
open3d.io.write_triangle_mesh("open3d_ball.glb", ball)
open3d.io.write_triangle_mesh("open3d_ball.ply", ball)

json.dump({"bpy": bpy.app.version_string, "open3d": open3d.__version__}, open("blender.json", "w"))
