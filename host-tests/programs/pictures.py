"""Rows of pictures as colour maps, normal maps and height maps."""
import os

import numpy as np
from PIL import Image

import right
from bench import bump_map, colour_map, row

# The right colours: red rises to the right, green falls, blue tells the diagonals apart. Not square, so turns are seen.
HEIGHT, WIDTH = 12, 20
Y, X = np.mgrid[0:HEIGHT, 0:WIDTH].astype(float)
RAMP = np.stack([(X + 0.5) / WIDTH, 1 - (Y + 0.5) / HEIGHT, ((X + 2 * Y) % 7) / 7], -1)
CODES16 = np.round(right.codes(RAMP) / 255 * 65535).astype("u2")
CODES8 = np.round(right.codes(RAMP)).astype("u1")
OF_CODES8 = right.linear(CODES8)
# Smooth in 8 x 8 blocks, for lossy files.
SMOOTH = np.repeat(np.repeat(right.linear([[[200, 60, 30], [40, 180, 90]], [[128, 128, 128], [250, 220, 10]]]), 16, 0), 16, 1)
SMOOTH8 = np.round(right.codes(SMOOTH)).astype("u1")
# Normals of a map that tilt in all directions.
NORMALS = right.unit(np.stack([0.6 * np.sin(X / 3), 0.5 * np.cos(Y / 2), np.ones_like(X)], -1))


def oiio_write(path, pixels, kind, **attributes):
    import OpenImageIO as oiio
    tile = attributes.pop("tile", 0)
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], kind)
    if tile:
        spec.tile_width = spec.tile_height = tile
    for key, value in attributes.items():
        spec.attribute(key.replace("_", ":", 1), value)
    out = oiio.ImageOutput.create(str(path))
    if not out.open(str(path), spec) or not out.write_image(np.ascontiguousarray(pixels)):
        raise RuntimeError(out.geterror() or oiio.geterror())
    out.close()


def exr(path, channels, compression="ZIP", **head):
    import OpenEXR
    head = {"compression": getattr(OpenEXR, compression + "_COMPRESSION"), "type": OpenEXR.scanlineimage, **head}
    with OpenEXR.File(head, {name: np.ascontiguousarray(value) for name, value in channels.items()}) as file:
        file.write(str(path))


@row("OpenEXR", "OpenEXR", "exr_half_piz.exr", "half floats, PIZ")
def _(folder):
    exr(folder / "exr_half_piz.exr", {"RGB": RAMP.astype("f2")}, "PIZ")
    return colour_map("exr_half_piz.exr", RAMP)


@row("OpenEXR", "OpenEXR", "exr_layers.exr", "colours next to a named layer, depth and a number, in one part")
def _(folder):
    zero = np.zeros((HEIGHT, WIDTH), "f4")
    exr(folder / "exr_layers.exr", {"RGB": RAMP.astype("f4"), "diffuse.R": zero, "diffuse.G": zero, "diffuse.B": zero,
                                    "Z": zero + 1e10, "id": zero.astype("u4") + 7})
    return colour_map("exr_layers.exr", RAMP)


@row("OpenEXR", "OpenEXR", "exr_depth_first.exr", "two parts, depth before colours")
def _(folder):
    import OpenEXR
    head = lambda name: {"compression": OpenEXR.ZIPS_COMPRESSION, "type": OpenEXR.scanlineimage, "name": name}
    parts = [OpenEXR.Part(head("depth"), {"Z": np.full((HEIGHT, WIDTH), 0.9, "f4")}),
             OpenEXR.Part(head("rgba"), {"RGB": RAMP.astype("f4")})]
    with OpenEXR.File(parts) as file:
        file.write(str(folder / "exr_depth_first.exr"))
    return colour_map("exr_depth_first.exr", RAMP)


@row("OpenEXR", "OpenEXR", "exr_crop.exr", "a data window inside the display window: black around")
def _(folder):
    window = (np.array([4, 3], "i4"), np.array([13, 8], "i4"))
    exr(folder / "exr_crop.exr", {"RGB": RAMP[3:9, 4:14].astype("f4")}, dataWindow=window,
        displayWindow=(np.array([0, 0], "i4"), np.array([WIDTH - 1, HEIGHT - 1], "i4")))
    inside = (X >= 4) & (X <= 13) & (Y >= 3) & (Y <= 8)
    return colour_map("exr_crop.exr", RAMP * inside[..., None])


@row("OpenEXR", "OpenEXR", "exr_overscan.exr", "a data window larger than the display window: cut off")
def _(folder):
    wide = np.pad(RAMP, ((2, 2), (3, 3), (0, 0)), constant_values=0.2)
    exr(folder / "exr_overscan.exr", {"RGB": wide.astype("f4")},
        dataWindow=(np.array([-3, -2], "i4"), np.array([WIDTH + 2, HEIGHT + 1], "i4")),
        displayWindow=(np.array([0, 0], "i4"), np.array([WIDTH - 1, HEIGHT - 1], "i4")))
    return colour_map("exr_overscan.exr", RAMP)


@row("OpenEXR", "OpenEXR", "exr_signed_normals.exr", "a normal map of signed floats, channels X, Y, Z", 3)
def _(folder):
    exr(folder / "exr_signed_normals.exr", {name: NORMALS[..., c].astype("f4") for c, name in enumerate("XYZ")})
    return bump_map(folder, "exr_signed_normals.exr", NORMALS)


@row("OpenImageIO", "OpenImageIO", "oiio_tiled.exr", "tiles of 16, decreasing lines", 2)
def _(folder):
    oiio_write(folder / "oiio_tiled.exr", RAMP.astype("f4"), "half", tile=16, compression="zip", openexr_lineOrder="decreasingY")
    return colour_map("oiio_tiled.exr", RAMP)


@row("OpenImageIO", "OpenImageIO", "oiio_acescg.exr", "chromaticities of AP1, brought to Rec. 709", 3)
def _(folder):
    # Rec. 709 to AP1 with D65 as white of both, so no adaptation takes part.
    primaries = lambda xy: np.array([[x, y, 1 - x - y] for x, y in xy]).T
    def to_xyz(red, green, blue, white):
        columns = primaries([red, green, blue])
        return columns * np.linalg.solve(columns, np.array([white[0], white[1], 1 - sum(white)]) / white[1])
    d65 = (0.3127, 0.329)
    ap1 = [(0.713, 0.293), (0.165, 0.83), (0.128, 0.044), d65]
    rec709 = [(0.64, 0.33), (0.3, 0.6), (0.15, 0.06), d65]
    matrix = np.linalg.solve(to_xyz(*ap1), to_xyz(*rec709))
    import OpenImageIO as oiio
    pixels = (RAMP @ matrix.T).astype("f4")
    spec = oiio.ImageSpec(WIDTH, HEIGHT, 3, "float")
    spec.attribute("chromaticities", oiio.TypeDesc("float[8]"), [float(v) for xy in ap1 for v in xy])
    out = oiio.ImageOutput.create(str(folder / "oiio_acescg.exr"))
    out.open(str(folder / "oiio_acescg.exr"), spec)
    out.write_image(pixels)
    out.close()
    return colour_map("oiio_acescg.exr", RAMP)


@row("OpenImageIO", "OpenImageIO", "oiio_predictor.tif", "TIFF of 16 bits, tiles, LZW with predictor 2", 1.5)
def _(folder):
    oiio_write(folder / "oiio_predictor.tif", CODES16, "uint16", tile=16, compression="lzw", tiff_zipquality=6, predictor=2)
    return colour_map("oiio_predictor.tif", RAMP)


@row("OpenImageIO", "OpenImageIO", "oiio_16.png", "16-bit PNG with alpha = 1", 1.5)
def _(folder):
    oiio_write(folder / "oiio_16.png", np.dstack([CODES16, np.full((HEIGHT, WIDTH), 65535, "u2")]), "uint16")
    return colour_map("oiio_16.png", RAMP)


@row("OpenImageIO", "OpenImageIO", "oiio_linear.png", "PNG in linear light that says so (gAMA)", 1.5)
def _(folder):
    oiio_write(folder / "oiio_linear.png", np.round(RAMP * 65535).astype("u2"), "uint16", oiio_ColorSpace="lin_rec709_scene")
    return colour_map("oiio_linear.png", RAMP)


@row("OpenCV", "opencv-python-headless", "cv_16.png", "16-bit PNG", 1.5)
def _(folder):
    import cv2
    cv2.imwrite(str(folder / "cv_16.png"), CODES16[..., ::-1])
    return colour_map("cv_16.png", RAMP)


@row("OpenCV", "opencv-python-headless", "cv.jpg", "JPEG without subsampled chroma, blocks of one colour", 3)
def _(folder):
    import cv2
    cv2.imwrite(str(folder / "cv.jpg"), SMOOTH8[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 98, cv2.IMWRITE_JPEG_SAMPLING_FACTOR, 0x111111])
    return colour_map("cv.jpg", SMOOTH)


@row("OpenCV", "opencv-python-headless", "cv.hdr", "Radiance HDR", 2)
def _(folder):
    import cv2
    cv2.imwrite(str(folder / "cv.hdr"), RAMP[..., ::-1].astype("f4"))
    return colour_map("cv.hdr", RAMP)


@row("OpenCV", "opencv-python-headless", "cv_float.tif", "TIFF of floats in linear light", 1.5)
def _(folder):
    import cv2
    cv2.imwrite(str(folder / "cv_float.tif"), RAMP[..., ::-1].astype("f4"))
    return colour_map("cv_float.tif", RAMP)


@row("OpenCV", "opencv-python-headless", "cv_normals.png", "16-bit normal map, green up", 3)
def _(folder):
    import cv2
    cv2.imwrite(str(folder / "cv_normals.png"), np.round((NORMALS + 1) / 2 * 65535).astype("u2")[..., ::-1])
    return bump_map(folder, "cv_normals.png", NORMALS)


@row("tifffile", "tifffile", "tifffile_planes.tif", "big-endian TIFF of 16 bits, a plane for each channel, deflate", 1.5)
def _(folder):
    import tifffile
    tifffile.imwrite(folder / "tifffile_planes.tif", np.moveaxis(CODES16, -1, 0), byteorder=">", photometric="rgb",
                     planarconfig="separate", compression="zlib")
    return colour_map("tifffile_planes.tif", RAMP)


@row("tifffile", "tifffile", "tifffile_predictor3.tif", "TIFF of floats in linear light, predictor 3", 1.5)
def _(folder):
    import tifffile
    tifffile.imwrite(folder / "tifffile_predictor3.tif", RAMP.astype("f4"), photometric="rgb", compression="zlib", predictor=3)
    return colour_map("tifffile_predictor3.tif", RAMP)


@row("imageio", "imageio", "imageio.tif", "TIFF of 8 bits", 1.5)
def _(folder):
    import imageio.v3 as iio
    iio.imwrite(folder / "imageio.tif", CODES8)
    return colour_map("imageio.tif", OF_CODES8)


@row("imageio", "imageio", "imageio.bmp", "BMP")
def _(folder):
    import imageio.v3 as iio
    iio.imwrite(folder / "imageio.bmp", CODES8)
    return colour_map("imageio.bmp", OF_CODES8)


@row("Pillow", "pillow", "pillow_palette.png", "PNG with a palette of 2 bits", 1.5)
def _(folder):
    image = Image.fromarray((X.astype(int) % 4).astype("u1"), "P")
    colours = np.array([[10, 200, 30], [250, 0, 0], [0, 60, 250], [128, 128, 128]], "u1")
    image.putpalette(colours.tobytes())
    image.save(folder / "pillow_palette.png", bits=2)
    return colour_map("pillow_palette.png", right.linear(colours[X.astype(int) % 4]))


@row("Pillow", "pillow", "pillow_grey.png", "PNG of one channel and alpha", 1.5)
def _(folder):
    Image.fromarray(CODES8[..., 0]).convert("LA").save(folder / "pillow_grey.png")
    return colour_map("pillow_grey.png", np.repeat(OF_CODES8[..., :1], 3, -1))


@row("Pillow", "pillow", "pillow_progressive.jpg", "progressive JPEG, subsampled chroma, blocks of one colour", 4)
def _(folder):
    Image.fromarray(SMOOTH8).save(folder / "pillow_progressive.jpg", quality=95, progressive=True, subsampling=2)
    scene, want, sure = colour_map("pillow_progressive.jpg", SMOOTH)
    # Decoders may interpolate chroma: the pixels next to another block do not count.
    sure[15:17] = sure[:, 15:17] = False
    return scene, want, sure


@row("Pillow", "pillow", "pillow_turned.jpg", "JPEG with an orientation (EXIF 6)", 4)
def _(folder):
    wide = SMOOTH8[:16]
    tags = Image.Exif()
    tags[0x0112] = 6
    Image.fromarray(np.ascontiguousarray(np.rot90(wide, 1))).save(folder / "pillow_turned.jpg", quality=95, subsampling=0, exif=tags)
    return colour_map("pillow_turned.jpg", right.linear(wide))


@row("Pillow", "pillow", "pillow_cmyk.jpg", "JPEG in CMYK", 4)
def _(folder):
    Image.fromarray(SMOOTH8).convert("CMYK").save(folder / "pillow_cmyk.jpg", quality=95)
    return colour_map("pillow_cmyk.jpg", SMOOTH)


@row("Pillow", "pillow", "pillow.webp", "WebP without loss", 1.5)
def _(folder):
    Image.fromarray(CODES8).save(folder / "pillow.webp", lossless=True)
    return colour_map("pillow.webp", OF_CODES8)


@row("Pillow", "pillow", "pillow_bc5.dds", "DDS of two channels (BC5) as a normal map", 6)
def _(folder):
    normals = np.broadcast_to(right.unit([0.3, -0.4, 0.866]), (16, 16, 3))
    Image.fromarray(np.round((normals + 1) / 2 * 255).astype("u1")).save(folder / "pillow_bc5.dds", pixel_format="BC5")
    return bump_map(folder, "pillow_bc5.dds", normals)


@row("three.js", "three", "three_flat.ktx2", "KTX2 of floats, not a cube; its rows go upwards, but it says downwards", 2)
def _(folder):
    # KTX 2.0: without the key KTXorientation, row 0 is the top one.
    return colour_map("three_flat.ktx2", right.panorama(256, 128)[::-1])


def prepare(folder):
    """Pictures that go into the models of scenes.mjs."""
    import shapes
    bump = np.round((right.unit(shapes.BUMP) + 1) / 2 * 255).astype("u1")
    Image.fromarray(np.broadcast_to(bump, (8, 8, 3)).copy()).save(os.path.join(folder, "bump_for_gltf.png"))
    Image.fromarray(np.full((8, 8, 3), 255, "u1")).save(os.path.join(folder, "colours_for_gltf.png"))
