#!/usr/bin/env bash
# A memory that a LiteX module keeps as an attribute is put on the bus of the
# system, unasked.
#
# Expected: a memory inside a peripheral is the peripheral's own. LiteXModule
#   saves typing: an attribute that is a module becomes a submodule, one that
#   is a CSR a register.
# Seen: an attribute that is a migen Memory becomes a region of the CSR bus,
#   writable by the processor, with an address that moves those after it. If
#   its width is no power of two times 8, finalize ends with "Not a power of 2"
#   in csr_bus.py, without the name of the memory. The same module on migen's
#   Module has neither.
# Versions: litex 2024.12, migen 0.10.0.
# Why it matters: a FIFO, a table or a line buffer beside a datapath changes the
#   address map that firmware was built for, or stops the build of a width that
#   the device has.
# Source: litex/gen/fhdl/module.py and litex/soc/interconnect/csr_bus.py.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install litex==2024.12 migen==0.10.0 setuptools==75.8.0
cd "$T"
cat > run.py <<'PY'
import contextlib, io, logging, sys
logging.disable(logging.CRITICAL)
from migen import Memory, Module
from litex.build.generic_platform import Pins
from litex.build.sim import SimPlatform
from litex.gen import LiteXModule
from litex.soc.integration.soc_core import SoCMini

def outcome(base, width):
    class Buffer(base):
        def __init__(self):
            memory = Memory(width, 16)
            if base is Module:
                self.specials += memory
            self.memory = memory
    platform = SimPlatform("SIM", [("sys_clk", 0, Pins(1))])
    soc = SoCMini(platform, int(1e6))
    soc.submodules.buffer = Buffer()
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            soc.finalize()
    except ValueError as error:
        return f"ValueError: {error}"
    return sorted(name for name in soc.csr.locs if name.startswith("buffer"))

seen = {}
for base in [LiteXModule, Module]:
    for width in [32, 66]:
        seen[base.__name__, width] = outcome(base, width)
        print(f"{base.__name__}, memory of {width} bits: {seen[base.__name__, width]}")
if seen != {
    ("LiteXModule", 32): ["buffer_memory"],
    ("LiteXModule", 66): "ValueError: Not a power of 2",
    ("Module", 32): [],
    ("Module", 66): [],
}:
    sys.exit("behaviour changed: memories of modules are treated differently now")
PY
nice v/bin/python -W ignore run.py
echo "as described"
