#!/usr/bin/env bash
# DigitalJS: "Simplify diagram" turns a decoder into zeros, and a division by zero gives the dividend.
#
# Expected: DigitalJS simulates what Yosys read. transformCircuit, which its web page does by default as "Simplify
#   diagram", says that it reduces the number of components and improves readability; it keeps the function.
# Seen, without a message, with the netlist from the Yosys script that yosys2digitaljs itself prepares:
#   1. y = 0; y[s] = 1; is right as it comes, and 0 for every s but 0 once it is simplified. y = a; y[s] = d; can then
#      set a bit, but clear no bit but y[0]. Yosys makes the mask as 1 shifted right by the signed number -s. The constant
#      1 is drawn into the shift, and then the shift amount counts as unsigned: one flag "signed" is left of two, and
#      it is the AND of both operands' flags.
#   2. x / 0 and x % 0 are x, the dividend, in both. A comment in the source says "as in IEEE Verilog"; but there the
#      result is x, the unknown value, which the simulator has.
# Versions: digitaljs 0.14.2, yosys2digitaljs 0.10.3, 3vl 1.0.1 (npm); pyosys 0.70.
# Why it matters: decoders, bit maps and write enables are written this way. Somebody learns or debugs with a picture
#   whose logic is not that of the source. A divider whose divisor can be 0 looks defined and is not.
# Source: the tooltip of "Simplify diagram" in DigitalJS Online; IEEE 1800-2017, 11.4.3 (a zero as the second operand of
#   / or %: all bits of the result are x). Yosys's eval agrees with the standard in each row here.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
cd "$T"
python3 -m venv v
nice v/bin/pip -q --disable-pip-version-check install pyosys==0.70
echo '{"private": true}' > package.json
nice npm install --ignore-scripts --no-audit --no-fund --silent digitaljs@0.14.2 yosys2digitaljs@0.10.3 3vl@1.0.1
cat > t.v <<'EOV'
module bitwrite(input [3:0] a, input [1:0] s, input d, output reg [3:0] y);
  always @* begin y = a; y[s] = d; end
endmodule
module decoder(input [1:0] s, output reg [3:0] y);
  always @* begin y = 0; y[s] = 1; end
endmodule
module quotient(input signed [3:0] x, n, output signed [3:0] y);
  assign y = x / n;
endmodule
module remainder(input signed [3:0] x, n, output signed [3:0] y);
  assign y = x % n;
endmodule
EOV
node -e 'console.log(require("yosys2digitaljs/core").prepare_yosys_script(["t.v"], {}).replace(/\\/g, ""))' > script.txt
cat > yosys.py <<'PY'
import json
import os
import re
from pyosys import libyosys as ys
keep = os.dup(1)
os.dup2(os.open("yosys.log", os.O_WRONLY | os.O_CREAT), 1)
inputs = {"bitwrite": "a,s,d", "decoder": "s", "quotient": "x,n", "remainder": "x,n"}
source = re.findall(r"module (\w+).*?endmodule", open("t.v").read(), re.S)
text = open("t.v").read()
script = open("script.txt").read().strip().split("; ")
out = {}
for name in source:
    with open("t.v", "w") as f:
        f.write(re.search(rf"module {name}\b.*?endmodule\n", text, re.S)[0])
    design = ys.Design()
    for command in [c for c in script if c] + [f"write_json {name}.json", f"tee -q -o {name}.txt eval -table {inputs[name]} -show y {name}"]:
        ys.run_pass(command, design)
    rows = re.findall(r"^((?: +\d+'[01x]+)+) \| +\d+'([01x]+)$", open(f"{name}.txt").read(), re.M)
    out[name] = [[[v.split("'")[1] for v in row.split()], y] for row, y in rows]
with open("table.json", "w") as f:
    json.dump({"inputs": inputs, "rows": out}, f)
os.dup2(keep, 1)
print("script:", "; ".join(c for c in script if c))
PY
nice v/bin/python yosys.py
cat > sim.js <<'JS'
const fs = require("fs");
const {yosys2digitaljs} = require("yosys2digitaljs/core");
const {HeadlessCircuit, transform} = require("digitaljs");
const {Vector3vl} = require("3vl");
const changed = what => { console.error("behaviour changed: " + what); process.exit(1); };
const {inputs, rows} = JSON.parse(fs.readFileSync("table.json"));
const int = (bits, signed) => parseInt(bits, 2) - (signed && bits[0] === "1" ? 2 ** bits.length : 0);
const bin = (value, width) => (((value % 2 ** width) + 2 ** width) % 2 ** width).toString(2).padStart(width, "0");

// What IEEE 1800 says, worked out here; Yosys must agree with it in each row.
const right = {
  bitwrite: ([a, s, d]) => bin(int(a) & ~(1 << int(s)) | int(d) << int(s), 4),
  decoder: ([s]) => bin(1 << int(s), 4),
  quotient: ([x, n]) => int(n) ? bin(Math.trunc(int(x, true) / int(n, true)), 4) : "xxxx",
  remainder: ([x, n]) => int(n) ? bin(int(x, true) % int(n, true), 4) : "xxxx"};
// What DigitalJS makes of it: [plain, simplified].
const seen = {
  bitwrite: [right.bitwrite, ([a, s, d]) => bin(int(a) & ~(int(s) ? 0 : 1) | int(d) << int(s), 4)],
  decoder: [right.decoder, ([s]) => int(s) ? "0000" : "0001"],
  quotient: Array(2).fill(v => int(v[1]) ? right.quotient(v) : v[0]),
  remainder: Array(2).fill(v => int(v[1]) ? right.remainder(v) : v[0])};

for (const [name, table] of Object.entries(rows)) {
  const netlist = () => yosys2digitaljs(JSON.parse(fs.readFileSync(name + ".json")));
  const plain = netlist(), simple = transform.transformCircuit(netlist());
  [plain, simple].forEach((data, which) => {
    const circuit = new HeadlessCircuit(data);
    let wrong = 0, example = "";
    for (const [values, yosys] of table) {
      const expected = right[name](values);
      if (yosys.padStart(expected.length, yosys) !== expected) {
        console.error("Yosys does not agree:", name, values, yosys);
        process.exit(1);
      }
      inputs[name].split(",").forEach((port, i) => circuit.findInputByNet(port).setInput(Vector3vl.fromBin(values[i], values[i].length)));
      for (let step = 0; circuit.hasPendingEvents; step++) {
        if (step > 1000) changed(name + " does not settle");
        circuit.updateGates();
      }
      const got = circuit.findOutputByNet("y").getOutput().toBin();
      if (got !== seen[name][which](values)) changed(name + " " + values + " is " + got);
      if (got !== expected) { wrong++; example = `${inputs[name]} = ${values.join(", ")}: ${got}, right is ${expected}`; }
    }
    console.log(`${name}, ${which ? "simplified" : "plain"}: ${wrong} of ${table.length} rows wrong` + (wrong ? `; ${example}` : ""));
    if ((wrong > 0) !== (!["bitwrite", "decoder"].includes(name) || which === 1)) changed(name);
  });
  const shifts = data => Object.values(data.devices).filter(d => /^Shift/.test(d.type)).map(d => d.type + " " + JSON.stringify(d.signed));
  if (name === "decoder") console.log("shifts, plain:     ", ...shifts(plain), "\nshifts, simplified:", ...shifts(simple));
}
JS
nice node sim.js
echo "as described"
