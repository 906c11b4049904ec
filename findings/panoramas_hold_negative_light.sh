#!/usr/bin/env bash
# The panoramas of a package for web renderers hold light below zero, in one a
# ninth of all light, in a ring around the sun.
#
# Expected: a photographed environment is at least zero everywhere. A few
#   values just below zero come from noise or from a change of primaries.
# Seen: all 18 panoramas have pixels below zero. In `sky` eleven pixels within
#   four pixels of the sun reach -3394, beside a sun of 22672; together they are
#   11 % of the light above zero. In `park` it is 9 %, in `esplanade` 9 %.
#   The files are 512x256, half floats, DWAB. The compression is not the cause:
#   a sun of 20000 that OpenEXR compresses the same way stays above zero. The
#   rings are those of a sharpening filter that made the pictures smaller.
# Versions: @pmndrs/assets 1.7.0 (npm), read with OpenEXR 3.5.3.
# Why it matters: whoever clamps at zero brightens the scene by a ninth. Whoever
#   keeps the values gets negative reflections in mirrors, and a filter of the
#   environment, or an importance table made of its pixels, has negative weights.
# Source: the README of the package says that all assets are resized, optimized
#   and compressed (CC0). It names no filter.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install OpenEXR==3.5.3 numpy==2.4.6
cd "$T"
npm pack --silent @pmndrs/assets@1.7.0 >/dev/null
tar xzf pmndrs-assets-1.7.0.tgz
nice v/bin/python - <<'PY'
import base64, pathlib, re, sys
import numpy as np, OpenEXR

def check(holds, what):
    if not holds:
        sys.exit("behaviour changed: " + what)

def read(name):
    with OpenEXR.File(name) as file:
        return file.channels()["RGB"].pixels.astype(np.float64)

seen = {}
for module in sorted(pathlib.Path("package/hdri").glob("*.exr.js")):
    name = module.name.split(".")[0]
    picture = re.search(r"base64,([A-Za-z0-9+/=]+)", module.read_text())[1]
    pathlib.Path("picture.exr").write_bytes(base64.b64decode(picture))
    light = read("picture.exr")
    share = -light[light < 0].sum() / light[light > 0].sum()
    dark = np.argwhere((light < 0).any(axis=2))
    sun = np.unravel_index(light.max(axis=2).argmax(), light.shape[:2])
    seen[name] = (light.min(), light.max(), share, len(dark), int(abs(dark - sun).max()))
    print(f"{name:10} {light.min():8.1f} to {light.max():8.1f}, {len(dark):4} pixels below zero, {100 * share:5.2f} % of the light above zero")
check(len(seen) == 18 and all(least < 0 for least, *_ in seen.values()), "not all 18 panoramas are below zero somewhere")
least, most, share, count, far = seen["sky"]
check((least, most, count) == (-3394, 22672, 11) and 0.11 < share < 0.111 and far <= 4, f"sky is {seen['sky']}")
check(all(0.085 < seen[name][2] < 0.095 for name in ("park", "esplanade")), "other shares in park and esplanade")

sky = np.full((64, 64, 3), 0.3, np.float16)
sky[30:32, 30:32] = 20000
header = {"compression": OpenEXR.DWAB_COMPRESSION, "type": OpenEXR.scanlineimage}
OpenEXR.File(header, {"RGB": sky}).write("sun.exr")
check(read("sun.exr").min() > 0.29, "DWAB makes light below zero")
print("a sun of 20000 through DWAB: nothing below", read("sun.exr").min())
PY
