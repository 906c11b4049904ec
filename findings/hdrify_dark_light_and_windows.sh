#!/usr/bin/env bash
# hdrify: Radiance files hold no light below 1/256, one shade of gray makes them unreadable, and EXR rows move with the data window.
#
# Expected: 1. A Radiance pixel has an exponent of its own, so a dark pixel is as exact as a bright one, to about 1 percent.
#   2. What the library writes it reads back. 3. The rows of an OpenEXR file are numbered from the data window, and a reader
#   gives as many rows as it says, with the picture in them.
# Seen: 1. writeHdr never uses an exponent below 2^0. All light from 0 to 1 has one scale of 255 steps: 0.02 is stored as 5/256, 0.007
#   and 0.005 are the same, and from 0.0039 down all is black in other readers. The library's own readHdr makes 0.00196 of
#   that, for 0.003 and for 0.0001 alike. Above 1 the error is below 1 percent.
#   2. So the bytes of a gray of 0.01 are 2 2 2 128, and "2 2" marks a compressed line. writeHdr does not compress. If the first
#   pixel of the picture has this gray, readHdr refuses the file and OpenCV gives no picture. OpenImageIO loses the rest of the
#   picture from any line on that begins with this gray; it has a message for that, but only if one asks for it.
#   3. readExr takes the row number in the file for the row of the picture. In a file whose data window begins at row 3, the picture
#   has the right size, 3 black rows at the top and the last 3 rows missing; at row -3 it is the other way round; from row
#   100 on it is black as a whole. Columns are right. No message for uncompressed and ZIPS;
#   with ZIP an exception at row -3.
# Versions: hdrify 1.2.1 (npm); OpenImageIO 3.2.2.0, opencv-python-headless 5.0.0.93 and numpy 2.4.6 to compare.
# Why it matters: such a file is the input of a panorama unit or of its reference. Night skies, rooms and the dark half of a panorama
#   with a sun lie below 0.05, and become flat steps. A crop of a render keeps the row numbers of the whole; black
#   rows at the top of a panorama look like a fault of the addressing at the pole.
# Source: Radiance's file formats document, picture format: one exponent byte common to the three mantissas, offset 128, so
#   dark colours have exponents below 128; new lines begin with 2 2 and the length. OpenEXR file layout: the y coordinate of a chunk
#   is that of the first scan line in it, from dataWindow.yMin on. The README of hdrify: reads and writes HDR and EXR.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install OpenImageIO==3.2.2.0 opencv-python-headless==5.0.0.93 numpy==2.4.6
cd "$T"
echo '{"private": true, "type": "module"}' > package.json
nice npm install --silent --no-audit --no-fund --no-update-notifier hdrify@1.2.1 > npm.log 2>&1 || {
  cat npm.log
  exit 1
}
nice v/bin/python - <<'PY'
import numpy as np, OpenImageIO as oiio
rows = np.repeat(np.arange(1, 9, dtype="f4")[:, None, None], 16, 1).repeat(3, 2)  # row i of 8 holds i everywhere
rows[:, 0, 0] = 0.5  # and the first column has another red
for kind in ("none", "zips", "zip"):
    for first in (0, 3, -3, 100):
        spec = oiio.ImageSpec(16, 8, 3, "float")
        spec.y = first
        spec.full_x, spec.full_y, spec.full_width, spec.full_height = 0, -8, 16, 200
        spec.attribute("compression", kind)
        out = oiio.ImageOutput.create("w.exr")
        if not out.open(f"{kind} {first}.exr", spec) or not out.write_image(rows):
            raise SystemExit(out.geterror())
        out.close()
        back = oiio.ImageBuf(f"{kind} {first}.exr")
        if back.spec().y != first or not np.array_equal(back.get_pixels("float"), rows):
            raise SystemExit("behaviour changed: OpenImageIO does not read its own file")
PY
cat > a.mjs <<'JS'
import fs from 'fs'
import { readExr, readHdr, writeHdr } from 'hdrify'
const picture = (...values) => ({
  width: 16, height: 8, linearColorSpace: 'linear-rec709',
  data: Float32Array.from({ length: 16 * 8 * 4 }, (_, i) => i % 4 === 3 ? 1 : values[i >> 2 < 2 ? 0 : values.length - 1])
})
const result = { gray: {}, rows: {} }
for (const light of [100, 10, 0.5, 0.02, 0.007, 0.005, 0.003, 0.0001]) {
  const file = writeHdr(picture(1, light)) // first pixel 1, so that the file can be read
  fs.writeFileSync(`${light}.hdr`, file)
  const data = readHdr(file).data
  result.gray[light] = [[...file.slice(-4)], data[data.length - 4]]
}
const whole = writeHdr(picture(0.01))
fs.writeFileSync('whole.hdr', whole)
result.first = [...whole.slice(-16 * 8 * 4, -16 * 8 * 4 + 4)]
try {
  result.whole = readHdr(whole).data[0]
} catch (error) {
  result.whole = error.message
}
for (const kind of ['none', 'zips', 'zip']) {
  for (const first of kind === 'zip' ? [0, 3, 100] : [0, 3, -3, 100]) {
    const image = readExr(new Uint8Array(fs.readFileSync(`${kind} ${first}.exr`)))
    result.rows[`${kind} ${first}`] = Array.from({ length: image.height }, (_, y) => image.data[(y * image.width + 1) * 4])
  }
}
fs.writeFileSync('result.json', JSON.stringify(result))
JS
nice node a.mjs
nice v/bin/python - <<'PY'
import json, sys
import cv2, numpy as np, OpenImageIO as oiio

def expect(ok, what):
    if not ok:
        sys.exit("behaviour changed: " + what)

result = json.load(open("result.json"))
print("light -> bytes in the file, read by hdrify, OpenImageIO, OpenCV; Radiance's own rule would store")
for light, (stored, own) in result["gray"].items():
    value = float(light)
    other = oiio.ImageBuf(light + ".hdr").getpixel(15, 7)[0]
    third = float(cv2.imread(light + ".hdr", cv2.IMREAD_UNCHANGED)[7, 15, 0])
    mantissa, exponent = np.frexp(value)
    right = [int(mantissa * 256)] * 3 + [int(exponent) + 128]
    print(f"  {light:6} -> {stored}, {own:.5f}, {other:.5f}, {third:.5f}; {right}")
    expect(stored[3] >= 128 and abs(other - third) <= 0.005 * value, "an exponent below 128, or the other readers differ")
    if value > 1:
        expect(abs(other - value) < 0.01 * value and stored[3] == right[3], "light above 1")
    elif value < 0.0039:
        expect(other == 0 and abs(own - 0.5 / 255) < 1e-6, "light below 1/256")
expect(result["gray"]["0.007"] == result["gray"]["0.005"], "0.007 and 0.005")

buf = oiio.ImageBuf("whole.hdr")
buf.read()
message = buf.geterror()
no_picture = cv2.imread("whole.hdr", cv2.IMREAD_UNCHANGED) is None
print(f"all pixels 0.01: first bytes {result['first']}; hdrify: {result['whole']}; OpenImageIO: {message.splitlines()[:1]}; OpenCV: no picture {no_picture}")
expect(result["first"] == [2, 2, 2, 128] and isinstance(result["whole"], str) and "scanline width" in result["whole"], "the gray of 0.01")
expect(no_picture and "wrong scanline width" in message, "the gray of 0.01 in other readers")

print("EXR, row i of 8 holds the number i; data window begins at row:")
want = {"0": [1, 2, 3, 4, 5, 6, 7, 8], "3": [0, 0, 0, 1, 2, 3, 4, 5], "-3": [4, 5, 6, 7, 8, 0, 0, 0], "100": [0] * 8}
for name, rows in result["rows"].items():
    print(f"  {name:9} {rows}")
    expect(rows == want[name.split()[1]], "rows of " + name)
PY
echo "as described"
