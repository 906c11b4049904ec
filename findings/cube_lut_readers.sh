#!/usr/bin/env bash
# 3D tables in .cube files: white comes out black, red and blue change places, and an input range counts only sometimes.
#
# Expected: a table that gives each colour back, in steps of its input range DOMAIN_MIN to DOMAIN_MAX, changes nothing.
#   Entries may be below 0 or above 1. Red runs fastest in the file.
# Seen: OpenColorIO and colour do so. The others, without a message:
#   1. three's LUTCubeLoader, as it is after new LUTCubeLoader(), keeps the low 8 bits of each entry: 1.01 becomes 1 of
#   255 and -0.01 becomes 254, so white is black and black is white. With setType(FloatType) it does not.
#   2. color-fx takes blue as the fastest, in reading and in writing. Each table of others that it reads exchanges red and
#   blue, and so does each table that it writes, in other programs. Its own files come back right.
#   3. Input ranges: pillow-lut ignores them, with the range 0 to 4 gray 0.25 becomes 0.5. postprocessing for three reads
#   DOMAIN_MAX but not a negative DOMAIN_MIN. three reads both, but its LUTPass has no input for them.
#   4. Numbers like 1.5E-05, with a capital E: three and postprocessing leave out the line, and the entries after it move
#   up. With 1.5E-05 for 0, the entry of white is the only one left, in the place of black. The Python readers read it.
# Versions: opencolorio 2.6.0, colour-science 0.4.7, pillow-lut 1.1.0, pillow 13.0.0, color-fx 0.1.2 (with pydantic 2.14.4), numpy 2.4.6;
#   npm three 0.187.0, postprocessing 6.39.6.
# Why it matters: such a table, with interpolation, is the last step of a display pipeline and an easy one to build in
#   hardware; these readers give the memory contents and the picture to compare with. Entries a little above 1 are usual,
#   in the brightest corner of the table. An exchange of red and blue looks like a wrong byte order of the design.
# Source: the Iridas text on the format, copied in OpenColorIO's reader: DOMAIN_MIN and DOMAIN_MAX map the cube to any input
#   range, e.g. for HDR; red changes fastest, blue slowest; the data is not limited to a range, it can be under 0.0 and
#   over 1.0. three names Adobe's Cube LUT Specification 1.0 as its reference.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install opencolorio==2.6.0 colour-science==0.4.7 pillow-lut==1.1.0 \
  pillow==13.0.0 color-fx==0.1.2 opencv-python-headless==5.0.0.93 pydantic==2.14.4 typer==0.29.2 numpy==2.4.6
cd "$T"
nice npm install --silent --no-audit --no-fund --ignore-scripts three@0.187.0 postprocessing@6.39.6 >/dev/null
nice v/bin/python - <<'PY'
import itertools, os, sys, warnings
warnings.simplefilter("ignore")  # colour tells of optional packages that are not installed
import colour, numpy as np, pillow_lut, PyOpenColorIO as ocio
from color_fx.lut.apply import apply_lut_to_frame
from color_fx.lut.bake import bake_lut
from color_fx.lut.reader import read_cube
from color_fx.lut.writer import write_cube
from PIL import Image

def write(name, low, high, entry=lambda v: v, text="{:.6f}"):
    """A table of 2 x 2 x 2: its inputs are low and high, its entries entry(low) and entry(high)."""
    with open(name, "w") as f:
        f.write('TITLE "test"\nLUT_3D_SIZE 2\n')
        if (low, high) != (0, 1):
            f.write(f"DOMAIN_MIN {low} {low} {low}\nDOMAIN_MAX {high} {high} {high}\n")
        for b, g, r in itertools.product((low, high), repeat=3):
            f.write(" ".join(text.format(entry(v)) for v in (r, g, b)) + "\n")

write("plain.cube", 0, 1)
write("zero_to_4.cube", 0, 4)
write("below_0.cube", -0.5, 1.5)
write("beyond.cube", 0, 1, lambda v: 1.02 * v - 0.01)
write("tiny.cube", 0, 1, lambda v: v or 1.5e-05, "{:.6G}")
colours = np.array([[0.25, 0.5, 0.75], [1, 0.5, 0], [0.25, 0.25, 0.25], [1, 1, 1]])

def by_ocio(name):
    transform = ocio.FileTransform(os.path.abspath(name), interpolation=ocio.INTERP_TETRAHEDRAL)
    got = colours.astype("f4")
    ocio.Config.CreateRaw().getProcessor(transform).getDefaultCPUProcessor().applyRGB(got)
    return got

def by_pillow(name):
    image = Image.fromarray(np.round(colours * 255).astype("u1")[None])
    return np.asarray(image.filter(pillow_lut.load_cube_file(name)))[0] / 255

readers = {"OpenColorIO": by_ocio, "colour": lambda name: colour.read_LUT(name).apply(colours), "pillow-lut": by_pillow,
           "color-fx": lambda name: apply_lut_to_frame(colours[None], read_cube(name))[0]}
for table in ("plain", "zero_to_4", "below_0", "beyond", "tiny"):
    right = 1.02 * colours - 0.01 if table == "beyond" else colours
    for name, read in readers.items():
        got = read(table + ".cube")
        print(f"{table:10} {name:11}", " | ".join(" ".join(f"{v:.2f}" for v in row) for row in got))
        if name == "pillow-lut" and table in ("zero_to_4", "below_0"):
            ok = np.abs(got[2] - (0.5 if table == "zero_to_4" else 0)).max() < 0.01
        elif name in ("pillow-lut", "color-fx"):  # these clip the result
            ok = np.abs(got[:, ::-1 if name == "color-fx" else 1] - np.clip(right, 0, 1)).max() < 0.005
        else:
            ok = np.abs(got - right).max() < 1e-4
        if not ok:
            sys.exit(f"behaviour changed: {name}, {table}")

write_cube(bake_lut(lambda samples: samples * [0.5, 1, 1], size=2), "own.cube")
red = np.array([[1, 0, 0]], "f4")
back = apply_lut_to_frame(red[None], read_cube("own.cube"))[0]
colours = red
other = [by_ocio("own.cube"), colour.read_LUT("own.cube").apply(red)]
print("color-fx writes a table that halves red; red becomes: color-fx", back.tolist(), "others", [o.round(6).tolist() for o in other])
if not np.allclose(back, [0.5, 0, 0]) or any(not np.allclose(o, [0, 0, 1], atol=1e-6) for o in other):
    sys.exit("behaviour changed: the tables that color-fx writes")
PY
cat > t.mjs <<'JS'
import fs from "fs";
import { FloatType } from "three";
import { LUTCubeLoader } from "three/examples/jsm/loaders/LUTCubeLoader.js";
import { LUTPass } from "three/examples/jsm/postprocessing/LUTPass.js";
import { LUTCubeLoader as OtherLoader } from "postprocessing";
const want = {  // entries for black, for red and for white; the input range
  plain: ["0 0 0, 255 0 0, 255 255 255; 0 to 1", "0 0 0, 1 0 0, 1 1 1; 0 to 1", "0 0 0, 1 0 0, 1 1 1; 0 to 1"],
  zero_to_4: ["0 0 0, 252 0 0, 252 252 252; 0 to 4", "0 0 0, 4 0 0, 4 4 4; 0 to 4", "0 0 0, 4 0 0, 4 4 4; 0 to 4"],
  below_0: ["129 129 129, 126 129 129, 126 126 126; -0.5 to 1.5", "-0.5 -0.5 -0.5, 1.5 -0.5 -0.5, 1.5 1.5 1.5; -0.5 to 1.5",
    "-0.5 -0.5 -0.5, 1.5 -0.5 -0.5, 1.5 1.5 1.5; 0 to 1.5"],
  beyond: ["254 254 254, 1 254 254, 1 1 1; 0 to 1", "-0.01 -0.01 -0.01, 1.01 -0.01 -0.01, 1.01 1.01 1.01; 0 to 1",
    "-0.01 -0.01 -0.01, 1.01 -0.01 -0.01, 1.01 1.01 1.01; 0 to 1"],
  tiny: ["255 255 255, 0 0 0, 0 0 0; 0 to 1", "1 1 1, 0 0 0, 0 0 0; 0 to 1", "1 1 1, 0 0 0, 0 0 0; 0 to 1"],
};
let ok = true;
for (const [name, expected] of Object.entries(want)) {
  const text = fs.readFileSync(name + ".cube", "utf8");
  const results = [new LUTCubeLoader().parse(text), new LUTCubeLoader().setType(FloatType).parse(text), new OtherLoader().parse(text)];
  results.forEach((table, i) => {
    const data = (table.texture3D ?? table).image.data;
    const at = n => [...data.slice(4 * n, 4 * n + 3)].map(v => +v.toFixed(4)).join(" ");
    const got = `${at(0)}, ${at(1)}, ${at(7)}; ${table.domainMin.x} to ${table.domainMax.x}`;
    console.log(`${name.padEnd(10)} ${["three", "three, FloatType", "postprocessing"][i].padEnd(16)} black, red, white: ${got}`);
    ok &&= got == expected[i];
  });
}
const inputs = Object.keys(new LUTPass().uniforms).sort().join(" ");
console.log("inputs of three's LUTPass:", inputs);
if (!ok || inputs != "intensity lut lutSize tDiffuse") {
  console.log("behaviour changed: the tables of the npm packages");
  process.exit(1);
}
JS
nice node t.mjs
echo "as described"
