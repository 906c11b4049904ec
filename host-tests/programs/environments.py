"""Rows of surroundings: each is looked at in one direction that no mirrored or turned picture passes."""
import numpy as np

import right
from bench import CUBE_ENVIRONMENT, environment, panorama, row
from pictures import exr, oiio_write


@row("Blender", "bpy", "blender_panorama.exr", "a panorama by Cycles, float RGBA", 3)
def _(folder):
    return panorama("blender_panorama.exr")


@row("Blender", "bpy", "blender_panorama.hdr", "the same as Radiance HDR", 8)
def _(folder):
    return panorama("blender_panorama.hdr")


@row("Blender", "bpy", "blender_layers.exr", "the same as OpenEXR MultiLayer with depth and normals", 3)
def _(folder):
    return panorama("blender_layers.exr")


@row("three.js", "three", "three_half.exr", "a panorama of half floats by its exporter", 2)
def _(folder):
    return panorama("three_half.exr")


@row("three.js", "three", "three_float.exr", "a panorama of floats by its exporter", 2)
def _(folder):
    return panorama("three_float.exr")


@row("OpenImageIO", "OpenImageIO", "oiio.hdr", "a panorama as Radiance HDR", 8)
def _(folder):
    oiio_write(folder / "oiio.hdr", right.panorama(256, 128), "float")
    return panorama("oiio.hdr")


@row("OpenImageIO", "OpenImageIO", "oiio_latlong.exr", "a mipmapped texture by make_texture; its seam and poles are on the edge", 3)
def _(folder):
    import OpenImageIO as oiio
    settings = oiio.ImageSpec()
    settings.attribute("maketx:fileformatname", "openexr")
    whole = oiio.ImageBuf(right.panorama(256, 128))
    if not oiio.ImageBufAlgo.make_texture(oiio.MakeTxEnvLatl, whole, str(folder / "oiio_latlong.exr"), settings):
        raise RuntimeError(oiio.geterror())
    return panorama("oiio_latlong.exr")


def upper_half(directions):
    directions = right.unit(directions)
    return np.where(directions[..., 1:2] > 0, right.light(directions), 0)


@row("OpenEXR", "OpenEXR", "exr_sky.exr", "a panorama cropped to the sky: black below", 3)
def _(folder):
    exr(folder / "exr_sky.exr", {"RGB": right.panorama(256, 128)[:64]},
        dataWindow=(np.array([0, 0], "i4"), np.array([255, 63], "i4")),
        displayWindow=(np.array([0, 0], "i4"), np.array([255, 127], "i4")))
    scene, want, sure = panorama("exr_sky.exr", upper_half)
    # A face has 256 texels over 90 degrees; its texels around the horizon mix both.
    height = right.Camera((0, 0, 0), (1, 0.4, -0.7), fov_y=90.0, size=(48, 48)).rays()[..., 1]
    return scene, want, np.abs(height) > 0.03


@row("OpenEXR", "OpenEXR", "exr_cube.exr", "a cube in OpenEXR's own layout (envmap)", 3)
def _(folder):
    # Six faces from top to bottom, as ImfEnvmap.h says; the outer samples lie on the edges of the cube.
    import OpenEXR
    edge = 64
    a = 1 - np.arange(edge) * 2 / (edge - 1)
    x, y = np.meshgrid(a, a)
    one = np.ones_like(x)
    faces = [(one, y, -x), (-one, y, x), (-x, one, y), (-x, -one, -y), (x, y, one), (-x, y, -one)]
    whole = np.concatenate([right.light(np.stack(face, -1)) for face in faces]).astype("f4")
    try:
        exr(folder / "exr_cube.exr", {"RGB": whole}, envmap=OpenEXR.ENVMAP_CUBE)
    except (AttributeError, TypeError):
        exr(folder / "exr_cube.exr", {"RGB": whole})
    return environment(CUBE_ENVIRONMENT.format("exr_cube.exr") + 'layout = "openexr"\n')


@row("ktx-parse", "ktx-parse", "ktx_cube.ktx2", "a cube of half floats, six faces in Vulkan's order", 2)
def _(folder):
    return environment(CUBE_ENVIRONMENT.format("ktx_cube.ktx2"))
