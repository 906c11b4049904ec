"""Rows of the table: each writes a file with another program, and says what its picture has to be."""
import os
import re
import subprocess
from importlib.metadata import version
from pathlib import Path

import numpy as np
from PIL import Image

import right

ROWS = []

# Keys by which a scene takes files of these kinds.
GLTF_OBJECT = 'shape = "mesh"\npath = "{}"\n'
CUBE_ENVIRONMENT = 'cube = "{}"\n'

# A refusal has to name the kind of the file, or the feature that is not read, by one of these words.
KINDS = {"glb": "glTF|KHR_", "gltf": "glTF|KHR_", "ply": "PLY", "stl": "STL", "usda": "USD", "usdc": "USD", "tif": "TIFF", "jpg": "JPEG",
         "bmp": "BMP", "webp": "WebP", "dds": "DDS", "ktx2": "KTX2"}


class Row:
    def __init__(self, program, package, file, compared, limit, is_imported, make):
        self.program, self.package, self.file, self.compared = program, package, file, compared
        self.limit, self.is_imported, self.make = limit, is_imported, make

    def version(self, versions):
        return versions.get(self.package) or version(self.package)


def row(program, package, file, compared, limit=2.0, is_imported=False):
    """Registers a row. Its function writes `file` in the folder and gives (scene, right codes, sure pixels).

    `is_imported`: the objects of the scene are those that `roughxel import` makes of the file.
    """
    def register(make):
        ROWS.append(Row(program, package, file, compared, limit, is_imported, make))
        return make
    return register


def mirror_scene(folder, camera, what):
    """Scene of one mirror in the test surroundings on black."""
    surroundings(folder)
    return (camera.text() + '[background]\ncolour = [0, 0, 0]\n[environment]\nequirectangular = "around.exr"\n'
            f"face_edge = 256\n[[object]]\n{what}")


def surroundings(folder):
    import OpenEXR
    if not (folder / "around.exr").exists():
        head = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
        with OpenEXR.File(head, {"RGB": right.panorama(512, 256)}) as file:
            file.write(str(folder / "around.exr"))


def mesh(folder, file, camera, triangles, normals=None, margin=0.02):
    """A mirror of this shape; without normals it is flat."""
    normals = right.flat(triangles) if normals is None else normals
    want, sure = right.mirrored(camera, lambda shift: right.hit_triangles(camera, shift, triangles, normals), margin)
    what = GLTF_OBJECT.format(file) if file.endswith(("glb", "gltf")) else f'shape = "mesh"\npath = "{file}"\n'
    return mirror_scene(folder, camera, what + "material = { reflectance = 1 }\n"), want, sure


def ball(folder, file, camera, centre, radius, margin=0.6):
    """A mirror ball; the margin in pixels allows for its facets."""
    want, sure = right.mirrored(camera, lambda shift: right.hit_ball(camera, shift, centre, radius), margin)
    what = GLTF_OBJECT.format(file) if file.endswith(("glb", "gltf")) else f'shape = "mesh"\npath = "{file}"\n'
    return mirror_scene(folder, camera, what + "material = { reflectance = 1 }\n"), want, sure


def from_above(width, height):
    """Camera that shows a plane of width / height x 1 units, a pixel for each texel."""
    distance = 100.0
    return right.Camera((0, distance, 0), (0, 0, 0), (0, 0, -1), 2 * np.degrees(np.arctan(0.5 / distance)), (width, height))


def colour_map(file, linear):
    """The picture as a colour map, a pixel for each texel."""
    height, width = linear.shape[:2]
    scene = (from_above(width, height).text() + "[background]\ncolour = [0, 0, 0]\n[[object]]\nshape = \"plane\"\n"
             f"size = [{width / height:.9f}, 1.0]\nmaterial = {{ colour_map = {{ path = \"{file}\" }} }}\n")
    return scene, right.codes(linear), np.ones((height, width), bool)


def bump_map(folder, file, normals):
    """The picture as a normal map on a mirror plane: u is +x, v is -z, up is +y."""
    height, width = normals.shape[:2]
    camera = from_above(width, height)
    normals = right.unit(np.stack([normals[..., 0], normals[..., 2], -normals[..., 1]], -1))
    rays = camera.rays()
    out = rays - 2 * (rays * normals).sum(-1, keepdims=True) * normals
    what = (f'shape = "plane"\nsize = [{width / height:.9f}, 1.0]\n'
            f'material = {{ reflectance = 1, normal_map = {{ path = "{file}" }} }}\n')
    return mirror_scene(folder, camera, what), right.codes(right.light(out)), np.ones((height, width), bool)


def environment(key, light=right.light, direction=(1, 0.4, -0.7)):
    """The environment alone, in one direction that tells all mirrored and turned ones apart."""
    camera = right.Camera((0, 0, 0), direction, fov_y=90.0, size=(48, 48))
    scene = camera.text() + f"[background]\nenvironment = true\n[environment]\n{key}"
    return scene, right.codes(light(camera.rays())), np.ones((48, 48), bool)


def panorama(file, light=right.light):
    return environment(f'equirectangular = "{file}"\nface_edge = 256\n', light)


def run(*command):
    return subprocess.run(command, capture_output=True, text=True, timeout=600, env={**os.environ, "NO_COLOR": "1"})


def judge(roughxel, folder, row):
    """(difference, verdict, remark) of a row."""
    scene, want, sure = row.make(folder)
    if not (folder / row.file).exists():
        return "–", "not tried", "no such package for this Python"
    text, picture = folder / "scene.toml", folder / "drawn.png"
    text.write_text(scene)
    picture.unlink(missing_ok=True)
    if row.is_imported:
        done = run(roughxel, "import", str(folder / row.file), "-o", str(folder / "imported.toml"), "--replace")
        if done.returncode == 0:
            objects = (folder / "imported.toml").read_text().partition("[[object]]")
            text.write_text(scene.partition("[[object]]")[0] + objects[1] + objects[2])
    if not row.is_imported or done.returncode == 0:
        done = run(roughxel, "render", str(text), "-o", str(picture), "--mode", "unfiltered", "--no-cache")
    said = re.sub(re.escape(str(folder)) + "/?", "", done.stderr)
    if done.returncode != 0:
        is_named = re.search(KINDS.get(row.file.rsplit(".")[-1], ""), said)
        return "–", ("refused" if is_named else "UNNAMED") if done.returncode == 1 else "FAILED", first_sentence(said)
    warning = next((first_sentence(line) for line in said.splitlines() if "warning" in line), "")
    drawn = np.asarray(Image.open(picture).convert("RGB"), float)
    away = np.abs(drawn - want).max(-1)[sure]
    share = (away > row.limit).mean()
    difference = f"{away.max():.1f} of {row.limit:g}"
    return (difference, "right", warning) if share == 0 else (difference, "WRONG", f"{share:.0%} of the pixels; {warning}".rstrip("; "))


def first_sentence(said):
    """The part of a message that names the mistake: without the place, in one line, at most 150 letters."""
    line = " ".join("".join(c if c.isascii() and c.isprintable() or c in "×²" else " " for c in said.split("╭─")[0]).split())
    line = re.sub(r"^(× ?|error: |warning: |scene\.toml(:\d+)*: ?)+", "", line).replace("|", "/")
    return line if len(line) <= 150 else line[:147].rsplit(" ", 1)[0] + " ..."


def folder_of(path):
    folder = Path(path).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    return folder
