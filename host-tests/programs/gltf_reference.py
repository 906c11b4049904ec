"""A glTF model made by Blender, imported and drawn by roughxel, and compared with Cycles and with MikkTSpace normals.

    python gltf_reference.py ROUGHXEL FOLDER [--samples N] [--fit]

Four tori have a normal map and two roughnesses; their charts are plain, mirrored in u, turned by 30 and sheared by 26.6 degrees.
Blender exports the scene, and Cycles draws the same scene by paths: GGX with single scattering, as glTF 2.0 says.
PSNR is that of linear light cut at 1, over pixels that a torus fills. Exit code 1: a bar is missed.
FOLDER keeps the models, the scenes, and pictures NAME-pair.png: roughxel, Cycles, four times the difference.
With --fit, models of one roughness tell which deviation of slopes comes nearest to GGX.
"""
import argparse
import math
import re
import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

import gltf_scene as gs
import right

PSNR_BAR, ANGLE_BAR = 30.0, 0.2
FINE = 10.0  # radians of phase for a component of 1


def export(folder, name, is_bumped, rough=None):
    """The model as GLB, and the tori of Blender's scene."""
    tori = gs.build(folder, is_bumped, rough)
    bpy.ops.export_scene.gltf(filepath=str(folder / f"{name}.glb"), export_format="GLB", export_cameras=True)
    return tori


def call(*words):
    done = subprocess.run(["nice", *map(str, words)], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}\n{done.stderr}")


def draw(roughxel, folder, name, environment, mode="footprint", face_edge=512, edit=lambda text: text):
    """Linear light of the imported model in a panorama."""
    scene = folder / f"{name}.toml"
    call(roughxel, "import", folder / f"{name}.glb", "-o", scene, "--replace")
    text = edit(scene.read_text())
    scene.write_text(text.replace('generate = "sky"', f'equirectangular = "{environment}"\nface_edge = {face_edge}'))
    output = folder / f"{name}-{Path(environment).stem}.png"
    call(roughxel, "render", scene, "-o", output, "--mode", mode, "--size", f"{gs.EDGE}x{gs.EDGE}", "--no-cache")
    return right.linear(gs.read(output) * 255)


def rays():
    return right.Camera(gs.EYE, (0, 0, 0), fov_y=gs.FOV_Y, size=(gs.EDGE, gs.EDGE)).rays()


def fetch(picture, uv):
    """Bilinear texel of a repeated picture, rows from the bottom."""
    height, width = picture.shape[:2]
    x, y = uv[0] * width - 0.5, uv[1] * height - 0.5
    i, j = math.floor(x), math.floor(y)
    texel = lambda di, dj: picture[(j + dj) % height, (i + di) % width]
    lower, upper = (texel(0, d) + (x - i) * (texel(1, d) - texel(0, d)) for d in (0, 1))
    return lower + (y - j) * (upper - lower)


def normals(tori, map_=None):
    """Index of the torus (-1: none) and shading normal at the middle of each pixel, by the tangents of Blender's MikkTSpace."""
    bpy.context.view_layer.update()
    graph, scene = bpy.context.evaluated_depsgraph_get(), bpy.context.scene
    index, result = np.full((gs.EDGE, gs.EDGE), -1), np.zeros((gs.EDGE, gs.EDGE, 3))
    for torus in tori:
        torus.data.calc_tangents()
    names = [torus.name for torus in tori]
    eye = Vector(gs.to_blender(gs.EYE))
    for (row, column), ray in zip(np.ndindex(gs.EDGE, gs.EDGE), gs.to_blender(rays()).reshape(-1, 3)):
        is_hit, place, _, face, thing, _ = scene.ray_cast(graph, eye, Vector(ray))
        if not is_hit:
            continue
        data = thing.data
        loops = list(data.polygons[face].loop_indices)
        corners = np.array([data.vertices[data.loops[l].vertex_index].co for l in loops], float)
        a, b = corners[1] - corners[0], corners[2] - corners[0]
        (s, t), *_ = np.linalg.lstsq(np.stack([a, b], 1), np.array(place, float) - corners[0], rcond=None)
        mean = lambda values: np.array([1 - s - t, s, t]) @ np.array(values, float)
        n = right.unit(mean([data.loops[l].normal for l in loops]))
        if map_ is not None:
            tangent = right.unit(mean([data.loops[l].tangent for l in loops]))
            bitangent = data.loops[loops[0]].bitangent_sign * np.cross(n, tangent)
            x, y, z = fetch(map_, mean([data.uv_layers[0].data[l].uv for l in loops]))
            n = right.unit(x * tangent + y * bitangent + z * n)
        index[row, column], result[row, column] = names.index(thing.name), gs.from_blender(n)
    return index, result


def drawn_normals(roughxel, folder, name):
    """Shading normals of a mirror in three panoramas: a colour for each direction, then finer phases of its components."""
    mirror = lambda text: re.sub(r"reflectance = .*", "reflectance = 1.0", re.sub(r"roughness_map.*\n", "", text))
    look = lambda file: draw(roughxel, folder, name, file, "unfiltered", 2048, mirror)
    coarse = 2 * look("coarse.exr") - 1
    phase = np.arctan2(2 * look("sine.exr") - 1, 2 * look("cosine.exr") - 1)
    fine = (phase + 2 * np.pi * np.round((FINE * coarse - phase) / (2 * np.pi))) / FINE
    return right.unit(right.unit(fine) - rays())


def psnr(drawn, reference, mask):
    return -10 * np.log10(np.mean((np.clip(drawn, 0, 1) - np.clip(reference, 0, 1))[mask] ** 2))


def inside(index):
    """Pixels whose neighbours show the same torus."""
    padded = np.pad(index, 1, constant_values=-1)
    around = [np.roll(padded, (y, x), (0, 1))[1:-1, 1:-1] for y in (-1, 0, 1) for x in (-1, 0, 1)]
    return (index >= 0) & np.all([other == index for other in around], axis=0)


def rooms(directions):
    """Dark room with three lamps whose edges are soft: the tails of a lobe show."""
    lamp = lambda axis, width: 1 / (1 + np.exp((width - directions @ right.unit(axis)) / 0.02))
    lamps = [(lamp((-0.5, 0.7, 0.6), 0.93), (0.9, 0.85, 0.8)), (lamp((0.9, 0.1, 0.4), 0.97), (0.5, 0.7, 0.95)),
             (lamp((0.1, -0.8, 0.7), 0.95), (0.9, 0.5, 0.3))]
    return 0.03 + sum(light[..., None] * np.array(colour) for light, colour in lamps)


def fit(roughxel, folder, samples):
    """Prints the deviation of slopes, in parts of alpha, that comes nearest to GGX, with one lobe and with two."""
    gs.write_panorama(folder / "rooms.exr", rooms)
    for alpha in [0.02, 0.05, 0.1, 0.2, 0.3]:
        mask = inside(normals(export(folder, "even", False, math.sqrt(alpha)))[0])
        for environment in ["sky.exr", "rooms.exr"]:
            reference = gs.cycles(folder, environment, "even-reference.exr", samples)
            for lobes, factors in [("false", [0.5, 0.6, 1 / math.sqrt(2), 0.8, 0.9, 1.0, 1.15]), ("true", [1.0, 1.15, 1.3, 1.5, 1.75, 2.0, 2.3])]:
                figures = []
                for factor in factors:
                    keys = f'roughness_map = {{ generate = "uniform", along = {factor * alpha}, across = {factor * alpha} }}\ntwo_lobes = {lobes}'
                    drawn = draw(roughxel, folder, "even", environment, edit=lambda text: re.sub("roughness_map.*", keys, text))
                    figures.append(psnr(drawn, reference, mask))
                best = factors[int(np.argmax(figures))]
                print(f"alpha {alpha:g}, {environment}, two_lobes = {lobes}: best {best:.3g} alpha; "
                      + ", ".join(f"{factor:.3g}: {figure:.2f} dB" for factor, figure in zip(factors, figures)), flush=True)
    return 0


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("roughxel", type=lambda path: Path(path).resolve())
    parser.add_argument("folder", type=lambda path: Path(path).resolve())
    parser.add_argument("--samples", type=int, default=256, help="paths for each pixel")
    parser.add_argument("--fit", action="store_true")
    asked = parser.parse_args()
    folder = asked.folder
    folder.mkdir(parents=True, exist_ok=True)
    gs.write_png(folder / "rough.png", np.stack([0 * gs.roughness() + 1, gs.roughness(), 0 * gs.roughness() + 1], -1), 8)
    for name, light in [("sky", gs.sky), ("coarse", right.light), ("sine", lambda d: (np.sin(FINE * d) + 1) / 2),
                        ("cosine", lambda d: (np.cos(FINE * d) + 1) / 2)]:
        gs.write_panorama(folder / f"{name}.exr", light)
    if asked.fit:
        return fit(asked.roughxel, folder, asked.samples)
    missed = 0
    coded = np.round(255 * (gs.bumps() + 1) / 2) / 255
    for name, bits, map_ in [("smooth", None, None), ("bumpy", 16, gs.bumps()), ("bumpy-8-bits", 8, 2 * coded - 1)]:
        if bits:
            gs.write_png(folder / "bumps.png", (gs.bumps() + 1) / 2, bits)
        tori = export(folder, name, bits is not None)
        index, want = normals(tori, map_)
        mask = inside(index)
        got = drawn_normals(asked.roughxel, folder, name)
        angle = np.degrees(2 * np.arcsin(np.linalg.norm(got - want, axis=-1) / 2))
        reference = gs.cycles(folder, "sky.exr", f"{name}-reference.exr", asked.samples)
        drawn = draw(asked.roughxel, folder, name, "sky.exr")
        pair = np.concatenate([drawn, reference, 4 * np.abs(drawn - np.clip(reference, 0, 1))], 1)
        gs.write_png(folder / f"{name}-pair.png", right.codes(pair)[::-1] / 255, 8)
        print(f"{name}: background {psnr(drawn, reference, index < 0):.2f} dB, "
              f"brightness {np.clip(drawn, 0, 1)[mask].mean() / np.clip(reference, 0, 1)[mask].mean():.4f} of the reference")
        for number, chart in enumerate(gs.CHARTS):
            here = mask & (index == number)
            off, figure = angle[here], psnr(drawn, reference, here)
            is_right = figure >= PSNR_BAR and off.max() <= ANGLE_BAR
            missed += not is_right
            print(f"  {chart}: PSNR {figure:.2f} dB; normals of {here.sum()} pixels: median {np.median(off):.3f}, "
                  f"95 % {np.percentile(off, 95):.3f}, largest {off.max():.3f} degrees: {'right' if is_right else 'MISSED'}", flush=True)
        print(f"  all: PSNR {psnr(drawn, reference, mask):.2f} dB, largest {angle[mask].max():.3f} degrees", flush=True)
    return 1 if missed else 0


sys.exit(main())
