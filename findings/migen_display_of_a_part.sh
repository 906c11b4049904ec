#!/usr/bin/env bash
# migen prints a part of a signal by writing the name of a Python object into
# the Verilog.
#
# Expected: Display("byte %d", word[:8]) prints the low byte of a signal, or
#   the conversion says that it cannot. Every other statement takes a slice, a
#   sum or a constant wherever it takes a signal.
# Seen: the conversion ends without a message. The Verilog has
#   $display("byte %d", <migen.fhdl.structure._Slice object at 0x...>);
#   and the next tool reports a syntax error in a generated file, far from the
#   line that is the cause. Sums are written the same way. The Verilog writer
#   of LiteX does it, too.
# Versions: migen 0.10.0, litex 2024.12.
# Why it matters: a device that prints what a soft core stores prints bytes.
#   The way out is a signal of its own: byte = Signal(8); byte.eq(word).
# Source: migen/fhdl/verilog.py and litex/gen/fhdl/verilog.py of the packages.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install migen==0.10.0 litex==2024.12 setuptools==75.8.0
cd "$T"
nice v/bin/python - <<'PY'
import re, sys
from migen import ClockDomain, Display, Module, Signal
from migen.fhdl import verilog as of_migen
from litex.build.sim import SimPlatform
from litex.build.generic_platform import Pins
from litex.gen.fhdl import verilog as of_litex

def port(shown):
    """A module that prints, each clock, what a function makes of its input."""
    module, word = Module(), Signal(32, name="word")
    module.clock_domains.cd_sys = ClockDomain()
    module.sync += Display("byte %d", shown(word))
    return module, {word}

writers = {
    "migen": lambda module, ports: str(of_migen.convert(module, ports)),
    "litex": lambda module, ports: str(of_litex.convert(module, ports, platform=SimPlatform("SIM", [("sys_clk", 0, Pins(1))]))),
}
for name, convert in writers.items():
    for shown, what in [(lambda word: word, "signal"), (lambda word: word[:8], "slice"), (lambda word: word + 1, "sum")]:
        line = re.search(r"\$display.*", convert(*port(shown)))[0]
        line = re.sub(r"0x[0-9a-f]+", "0x...", line)
        print(f"{name}, {what}: {line}")
        if ("object at" in line) != (what != "signal"):
            sys.exit("behaviour changed: a part of a signal is printed now")
PY
echo "as described"
