#!/usr/bin/env bash
# np2hw: the generated Verilog and the NumPy function it was made from differ where NumPy wraps.
#
# Expected: np2hw turns a NumPy function on a picture into streaming Verilog. Its documentation calls the
#   function the specification, the hardware and the reference at once: width and sign follow NumPy, a uint8
#   value wraps unless it was widened first, and what cannot be traced faithfully is refused with an error.
# Seen: the first operation on the pixels does wrap. Four kinds of ordinary models, all of traced operators, give other
#   numbers in the Verilog, without a message: 1. a difference of uint8 pixels, halved: for -1 NumPy has 127,
#   the hardware -1; for +128 NumPy has 64, the hardware -64. It wraps to 8 bits, but to signed ones.
#   2. A difference of uint16 pixels, clipped to 0..255: of -255 NumPy makes 65281 and 255, the hardware 0.
#   3. (x // 2) * 3 // 4 on uint8: 31 and 95 for 255, the product does not wrap after a shift. 4. A uint8 register
#   of 200 added to uint8 pixels, halved: 99 and 227 for 255. With int16 or uint16 such models agree.
# Versions: np2hw 0.6.1, numpy 2.4.6, pyosys 0.70 (simulates the Verilog).
# Why it matters: differences of unsigned heights are the slopes of a bump map, and a brightness register is case 4. The
#   picture from the reference passes for what the hardware does; here they differ in a third of the pixels to two thirds.
#   A smooth or dark test picture does not show it, for nothing wraps there.
# Source: np2hw's README, "Faithful dtypes"; in its repository docs/streaming-and-bitwidths.md: the effective width is the smaller one of natural
#   and declared width, "a uint8 value wraps (mod 256) unless you widen it first"; docs/parameters.md: reference and
#   RTL stay bit-identical; docs/supported-ops.md: - * // on pixels, + and clip are traced. The same docs also
#   say that a subtraction gives a signed result. NumPy: integer arithmetic of fixed-width types is modular.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install np2hw==0.6.1 numpy==2.4.6 pyosys==0.70
cd "$T"
nice v/bin/python - <<'PY'
import sys
import numpy as np
from np2hw import Image2D, Param, generate, to_ir
from pyosys import libyosys as ys

picture = np.array([[0, 255, 1, 254, 10, 200, 100, 90], [255, 0, 255, 128, 127, 3, 60, 61]], np.uint8)
rows, cols = picture.shape

def hardware(model, register=None, value=0):
    """The numbers that leave the generated Verilog when the picture is streamed through it."""
    registers = [] if register is None else [register]
    _, out = to_ir(model, Image2D("picture", cols, rows, bits=8), *registers)
    meta = generate(out, module_name="model")
    stream = meta["interface"]["output"]
    bits = stream["data_bits"]
    pixels = "".join(f"{p:02x}" for p in picture.ravel()[::-1].tolist())
    port = "" if register is None else f".param_{register.name}({register.bits}'d{value}), "
    open("model.v", "w").write(meta["verilog"] + f"""
module top(input clk, input rst, output valid, output [{bits - 1}:0] data);
  reg [7:0] n;
  wire [{8 * picture.size - 1}:0] pixels = {8 * picture.size}'h{pixels};
  always @(posedge clk) if (rst) n <= 0; else n <= n + 1;
  model #(.WIDTH({cols}), .HEIGHT({rows})) m(.clk(clk), .rst(rst), .in_valid(n < {picture.size}), .in_sof(n == 0), .in_data(pixels[8*n +: 8]),
    {port}.out_valid(valid), .out_ready(1'b1), .out_data(data));
endmodule
""")
    ys.Design().run_pass("tee -q read_verilog model.v; tee -q prep -flatten -top top; "
                         "tee -q sim -q -clock clk -reset rst -rstlen 2 -n 40 -vcd out.vcd")
    names, now, numbers = {}, {}, []
    for line in open("out.vcd"):  # one sample at each rising edge
        words = line.split()
        if line.startswith("$var"):
            names.setdefault(words[4].split("[")[0], words[3])
        elif line[0] == "b":
            now[words[1]] = words[0][1:]
        elif line[0] in "01xz":
            now[words[0][1:]] = words[0][0]
        if line[0] == "#" and now.get(names["clk"]) == "1" and now.get(names["valid"]) == "1":
            number = int(now[names["data"]], 2)
            numbers.append(number - (1 << bits) if stream.get("signed") and number >> bits - 1 else number)
    return np.array(numbers)

print("picture", picture.tolist())
offset = Param("offset", np.uint8)
wide = Param("offset", np.int16)
tests = [
    # title, model, register, True if both are to agree and else what the Verilog computes, on large integers
    ("two pixels added, uint8", lambda x: x[:, 1:] + x[:, :-1], None, True),
    ("three times, uint8", lambda x: x * 3, None, True),
    ("slope, halved, int16", lambda x: (x.astype(np.int16)[:, 2:] - x.astype(np.int16)[:, :-2]) // 2, None, True),
    ("slope, clipped, int16", lambda x: (x.astype(np.int16)[:, 2:] - x.astype(np.int16)[:, :-2]).clip(0, 255), None, True),
    ("(x // 2) * 3 // 4, uint16", lambda x: (x.astype(np.uint16) // 2) * 3 // 4, None, True),
    ("(x + offset) // 2, int16", lambda x, offset: (x.astype(np.int16) + offset) // 2, wide, True),
    ("slope, halved, uint8", lambda x: (x[:, 2:] - x[:, :-2]) // 2, None,
     lambda x: (x[:, 2:] - x[:, :-2]).astype(np.int8) // 2),
    ("slope, clipped, uint16", lambda x: (x.astype(np.uint16)[:, 2:] - x.astype(np.uint16)[:, :-2]).clip(0, 255), None,
     lambda x: (x[:, 2:] - x[:, :-2]).clip(0, 255)),
    ("(x // 2) * 3 // 4, uint8", lambda x: (x // 2) * 3 // 4, None, lambda x: (x // 2) * 3 // 4),
    ("(x + offset) // 2, uint8", lambda x, offset: (x + offset) // 2, offset, lambda x: (x + 200) // 2),
]
for title, model, register, same in tests:
    typed = [] if register is None else [(np.int16 if register is wide else np.uint8)(200)]
    numpy = model(picture, *typed).ravel().astype(int)
    verilog = hardware(model, register, 200)
    if len(verilog) != len(numpy):
        sys.exit(f"behaviour changed: {len(verilog)} pixels for {len(numpy)}: {title}")
    wrong = numpy != verilog
    print(f"{title}: {wrong.sum()} of {len(numpy)} pixels differ")
    if wrong.any():
        print(f"  NumPy   {numpy.tolist()}\n  Verilog {verilog.tolist()}")
    if wrong.any() == (same is True):
        sys.exit("behaviour changed: " + title)
    if callable(same) and not np.array_equal(verilog, same(picture.astype(int)).ravel()):
        sys.exit("behaviour changed: other numbers in " + title)
PY
echo "as described"
