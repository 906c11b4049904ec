"""Blender's scene of a glTF model: four tori with a normal map and two roughnesses; Cycles draws it by paths.

Axes are those of glTF, y up; `to_blender` turns them.
"""
import math
import struct
import zlib

import bpy
import numpy as np
from mathutils import Vector

import right

EDGE = 256
EYE, FOV_Y = np.array([1.2, 0.8, 9.0]), 34.0
COLOUR = (0.95, 0.8, 0.55)
CHARTS = {"plain": [[1, 0], [0, 1]], "mirrored": [[-1, 0], [0, 1]],
          "turned": [[math.cos(math.pi / 6), -0.5], [0.5, math.cos(math.pi / 6)]], "sheared": [[1, 0.5], [0, 1]]}
PLACES = [(-1.3, 1.3), (1.3, 1.3), (-1.3, -1.3), (1.3, -1.3)]


def to_blender(points):
    points = np.asarray(points, float)
    return np.stack([points[..., 0], -points[..., 2], points[..., 1]], -1)


def from_blender(points):
    points = np.asarray(points, float)
    return np.stack([points[..., 0], points[..., 2], -points[..., 1]], -1)


# ---- maps -------------------------------------------------------------------------------------------------------------

def bumps(size=256):
    """Unit normals of smooth waves, v upwards: (row from the bottom, column, 3). Root mean square slope 0.11."""
    v, u = np.meshgrid(*[(np.arange(size) + 0.5) / size * 2 * np.pi] * 2, indexing="ij")
    slope_u = 0.12 * np.cos(2 * u + v) - 0.06 * np.sin(3 * u)
    slope_v = 0.06 * np.cos(2 * u + v) + 0.08 * np.cos(2 * v - 1)
    return right.unit(np.stack([-slope_u, -slope_v, np.ones_like(u)], -1))


def roughness(size=64):
    """Two values in broad stripes that run askew over the map."""
    v, u = np.meshgrid(*[(np.arange(size) + 0.5) / size * 2 * np.pi] * 2, indexing="ij")
    return np.where(np.sin(u + v) > 0, 0.35, 0.15)


def write_png(path, values, bits):
    """RGB from 0 to 1, rows from the bottom."""
    top = (2 ** bits) - 1
    codes = np.round(np.clip(values[::-1], 0, 1) * top).astype(">u2" if bits == 16 else "u1")
    raw = b"".join(b"\0" + row.tobytes() for row in codes)
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    head = struct.pack(">IIBBBBB", codes.shape[1], codes.shape[0], bits, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


def write_panorama(path, light, width=2048):
    """Light of each direction by longitude and latitude; -z in the middle, +x to its right."""
    height = width // 2
    lon, lat = np.meshgrid(((np.arange(width) + 0.5) / width * 2 - 1) * np.pi, ((np.arange(height) + 0.5) / height - 0.5) * np.pi)
    directions = np.stack([np.sin(lon) * np.cos(lat), np.sin(lat), -np.cos(lon) * np.cos(lat)], -1)
    pixels = np.ones((height, width, 4), "f4")
    pixels[..., :3] = light(directions)
    image = bpy.data.images.new(path.stem, width, height, float_buffer=True)
    image.pixels.foreach_set(pixels.ravel())
    image.file_format = "OPEN_EXR"
    image.save(filepath=str(path))
    bpy.data.images.remove(image)


def read(path):
    """Pixels of a picture as its file has them, rows from the top."""
    image = bpy.data.images.load(str(path))
    if path.suffix == ".png":
        image.colorspace_settings.name = "Non-Color"  # Blender would encode floats for it
    pixels = np.empty(image.size[0] * image.size[1] * 4, "f4")
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(image.size[1], image.size[0], 4)[::-1, :, :3].astype(float)
    bpy.data.images.remove(image)
    return pixels


def sky(directions):
    """Smooth light: each direction has a colour of its own; a broad window of 2.5 and bands by longitude."""
    x, y, z = np.moveaxis(directions, -1, 0)
    window = np.exp(6 * (directions @ right.unit([-0.5, 0.7, 0.6]) - 1))
    bands = np.cos(5 * np.arctan2(x, -z)) * (1 - y * y)
    return np.stack([0.35 + 0.2 * x + 2.2 * window + 0.1 * bands, 0.35 + 0.2 * y + 1.8 * window, 0.4 + 0.25 * z + window - 0.1 * bands], -1)


# ---- Blender's scene --------------------------------------------------------------------------------------------------

def torus(name, place, chart, material, around=128, across=64):
    """Triangles; u goes around the ring, v around the tube: 5 and 2 repeats of the maps before `chart`."""
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    theta, phi = i / around * 2 * np.pi, j / across * 2 * np.pi
    ring = 0.8 + 0.36 * np.cos(phi)
    points = np.stack([ring * np.cos(theta) + place[0], ring * np.sin(theta) + place[1], 0.36 * np.sin(phi)], -1).reshape(-1, 3)
    corners = np.stack([np.stack([i + di, j + dj], -1).reshape(-1, 2) for di, dj in [(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)]], 1)
    corners = corners.reshape(-1, 3, 2)
    data = bpy.data.meshes.new(name)
    data.from_pydata(to_blender(points).tolist(), [], (corners[..., 0] % around * across + corners[..., 1] % across).tolist())
    uv = (corners * [5 / around, 2 / across]) @ np.transpose(chart)
    data.uv_layers.new(name="UVMap").data.foreach_set("uv", uv.astype("f4").ravel())
    data.polygons.foreach_set("use_smooth", [True] * len(data.polygons))
    data.materials.append(material)
    thing = bpy.data.objects.new(name, data)
    # Neither renderer shows one torus in another.
    thing.visible_glossy = thing.visible_shadow = False
    bpy.context.scene.collection.objects.link(thing)
    return thing


def metal(folder, is_bumped, rough):
    """A metal; `rough` is None for the map of two values."""
    material = bpy.data.materials.new("metal")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader = next(n for n in nodes if n.type == "BSDF_PRINCIPLED")
    shader.distribution = "GGX"
    shader.inputs["Base Color"].default_value = (*COLOUR, 1)
    shader.inputs["Metallic"].default_value = 1

    def texture(file):
        node = nodes.new("ShaderNodeTexImage")
        node.image = bpy.data.images.load(str(folder / file))
        node.image.colorspace_settings.name = "Non-Color"
        return node.outputs["Color"]

    if rough is None:
        parts = nodes.new("ShaderNodeSeparateColor")
        links.new(texture("rough.png"), parts.inputs[0])
        links.new(parts.outputs["Green"], shader.inputs["Roughness"])
        links.new(parts.outputs["Blue"], shader.inputs["Metallic"])
    else:
        shader.inputs["Roughness"].default_value = rough
    if is_bumped:
        bump = nodes.new("ShaderNodeNormalMap")
        links.new(texture("bumps.png"), bump.inputs["Color"])
        links.new(bump.outputs["Normal"], shader.inputs["Normal"])
    return material


def build(folder, is_bumped, rough):
    """The scene; returns the tori."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    material = metal(folder, is_bumped, rough)
    tori = [torus(name, place, chart, material) for (name, chart), place in zip(CHARTS.items(), PLACES)]
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit, camera.angle = "VERTICAL", math.radians(FOV_Y)
    eye = bpy.data.objects.new("camera", camera)
    eye.location = Vector(to_blender(EYE))
    eye.rotation_euler = (-eye.location).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(eye)
    scene.camera = eye
    scene.render.resolution_x = scene.render.resolution_y = EDGE
    return tori


def cycles(folder, environment, output, samples):
    """Linear light of Blender's scene in a panorama."""
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    nodes, links = scene.world.node_tree.nodes, scene.world.node_tree.links
    place, turn, picture = (nodes.new("ShaderNode" + kind) for kind in ("TexCoord", "Mapping", "TexEnvironment"))
    # The middle of the picture is +x of Blender's and has to be +y, which is -z of glTF's.
    turn.inputs["Rotation"].default_value[2] = -math.pi / 2
    picture.image = bpy.data.images.load(str(folder / environment))
    links.new(place.outputs["Generated"], turn.inputs[0])
    links.new(turn.outputs[0], picture.inputs[0])
    links.new(picture.outputs[0], next(n for n in nodes if n.type == "BACKGROUND").inputs[0])
    scene.render.engine = "CYCLES"
    options = {"samples": samples, "use_adaptive_sampling": False, "use_denoising": False, "pixel_filter_type": "BOX", "blur_glossy": 0,
               "sample_clamp_indirect": 0, "max_bounces": 1, "seed": 7}
    for key, value in options.items():
        setattr(scene.cycles, key, value)
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    scene.render.filepath = str(folder / output)
    bpy.ops.render.render(write_still=True)
    return read(folder / output)
