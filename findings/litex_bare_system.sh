#!/usr/bin/env bash
# A LiteX system with a processor, and without LiteX's own software, meets two
# errors that do not name their cause.
#
# Expected: a system whose program lies in its memory needs no UART, no timer
#   and no BIOS. SoCCore has arguments that leave the first two out, and the
#   builder has compile_software=False.
# Seen: without UART and timer nothing interrupts, and elaboration ends with
#   "max() arg is an empty sequence". With a timer, the builder still asks for
#   the C library of the BIOS, which it does not compile: ImportError.
#   system.finalize() and system.build() without the builder write the design.
# Versions: litex 2024.12, migen 0.10.0, pythondata-cpu-vexriscv
#   1.0.1.post407.
# Why it matters: whoever measures a bare program in a system looks for the
#   error in the program, or installs a C library that nothing uses.
# Source: litex/soc/integration/soc.py and builder.py of the package.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install migen==0.10.0 litex==2024.12 setuptools==75.8.0 \
    pythondata-cpu-vexriscv==1.0.1.post407 pythondata-misc-tapcfg==0.0.post517
cd "$T"
nice v/bin/python - 2>log <<'PY'
import os, sys
from migen import ClockDomain, Module
from litex.build.generic_platform import Pins
from litex.build.sim import SimPlatform
from litex.build.sim.config import SimConfig
from litex.soc.integration.builder import Builder
from litex.soc.integration.soc_core import SoCCore

class Clock(Module):
    def __init__(self, pin):
        self.clock_domains.cd_sys = ClockDomain()
        self.comb += [self.cd_sys.clk.eq(pin), self.cd_sys.rst.eq(0)]

def system(with_timer):
    platform = SimPlatform("SIM", [("sys_clk", 0, Pins(1)), ("sys_rst", 0, Pins(1))])
    soc = SoCCore(platform, int(1e6), ident="", with_uart=False, with_timer=with_timer, cpu_type="vexriscv",
                  cpu_reset_address=0x10000000, integrated_rom_size=0, integrated_sram_size=0x1000, integrated_sram_init=[0x6F])
    soc.submodules.crg = Clock(platform.request("sys_clk"))
    return soc

def outcome(what, build):
    try:
        build()
        text = "written"
    except Exception as error:
        text = f"{type(error).__name__}: {' '.join(str(error).split())}"
    print(f"{what}: {text[:110]}")
    return text

def with_builder():
    Builder(system(True), output_dir="b", compile_software=False, compile_gateware=False).build(
        run=False, sim_config=SimConfig("sys_clk", 1000000))

def without_builder():
    soc = system(True)
    soc.finalize()
    soc.build(build_dir="g", run=False, sim_config=SimConfig("sys_clk", 1000000))

first = outcome("no UART, no timer", lambda: system(False).finalize())
second = outcome("a timer, compile_software=False", with_builder)
third = outcome("a timer, no builder", without_builder)
if "empty" not in first or "picolibc" not in second or third != "written" or not os.path.exists("g/sim.v"):
    sys.exit("behaviour changed: a bare system builds, or fails otherwise")
PY
echo "as described"
