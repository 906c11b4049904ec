#!/usr/bin/env bash
# OpenImageIO stands two of the eight orientations of Radiance pictures on their heads.
#
# Expected: the size line of a Radiance picture says in which order its pixels
#   come. The first axis is the slow one: "+X 3 +Y 2" is columns from the left
#   to the right, each from the bottom to the top. A reader gives an Orientation
#   by which reorient() makes the picture upright.
# Seen: six of the eight orders come out upright. For "+X w +Y h" and
#   "-X w -Y h" OpenImageIO says Orientation 6 and 8, and has the two exchanged:
#   the upright picture is turned by 180 degrees. No warning.
# Versions: OpenImageIO 3.2.2.0.
# Why it matters: a quarter turn is what a panorama from a tilted camera or from
#   Radiance's protate has. A sky turned by 180 degrees lights a scene from
#   below, and its colours are still plausible.
# Source: Radiance's resolu.h and pix2loc() in resolu.c: the first axis is the
#   major one, X goes to the right, Y upwards. Its manual of file formats says
#   that +X M +Y N "has been rotated" clockwise; so it is made upright by a turn
#   to the left, EXIF's Orientation 8 (row 0 is the left side, column 0 the
#   bottom). ExifTool's table of Radiance tags has the same two exchanged.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install OpenImageIO==3.2.2.0 numpy==2.4.6
cd "$T"
nice v/bin/python - <<'PY'
import sys
import numpy as np, OpenImageIO as oiio

upright = np.array([[0, 1, 2], [3, 4, 5]])
h, w = upright.shape

def stored(slow, fast):
    """The pixels in the order that the line names: the slow axis first; +Y goes upwards."""
    place = {"+X": range(w), "-X": range(w)[::-1], "-Y": range(h), "+Y": range(h)[::-1]}
    return [upright[b, a] if slow[1] == "X" else upright[a, b] for a in place[slow] for b in place[fast]]

wrong = []
for slow, fast in [(a, b) for a in ("-Y", "+Y", "+X", "-X") for b in ("+X", "-X", "-Y", "+Y") if a[1] != b[1]]:
    size = {"X": w, "Y": h}
    line = f"{slow} {size[slow[1]]} {fast} {size[fast[1]]}"
    with open("a.hdr", "wb") as f:
        f.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + line.encode() + b"\n")
        f.write(b"".join(bytes([10 * int(v), 10 * int(v), 128, 128]) for v in stored(slow, fast)))
    picture = oiio.ImageBuf("a.hdr")
    turned = oiio.ImageBufAlgo.reorient(picture).get_pixels("float")[..., 0]
    seen = np.round(turned * 25.6).astype(int)
    is_right = np.array_equal(seen, upright)
    print(f"{line}: Orientation {picture.orientation}, upright {seen.tolist()}", "" if is_right else "<- wrong")
    if not is_right:
        wrong.append((line, picture.orientation, np.array_equal(seen, upright[::-1, ::-1])))
if wrong != [("+X 3 +Y 2", 6, True), ("-X 3 -Y 2", 8, True)]:
    sys.exit("behaviour changed: the orders that come out turned are " + str(wrong))
PY
echo "as described"
