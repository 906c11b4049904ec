"""A LiteX system on chip with VexRiscv and an SDRAM, verilated: it runs bare programs from the SDRAM and prints what they print.

    python3 system.py program.hex --variant standard --l2 0 -o build

An image has a 32-bit word a line, from the first address of the SDRAM on. `cargo firmware system` makes images, and starts this file with its
packages.
"""
import argparse
import subprocess
import sys
from pathlib import Path

from migen import ClockDomain, Display, Finish, If, Module, Signal

from litedram.modules import MT48LC16M16
from litedram.phy.model import SDRAMPHYModel
from litex.build.generic_platform import Pins
from litex.build.sim import SimPlatform
from litex.build.sim.config import SimConfig
from litex.soc.integration.soc import SoCRegion
from litex.soc.integration.soc_core import SoCCore
from litex.soc.interconnect import wishbone

# The controller counts the times of the SDRAM in clocks of this frequency.
FREQUENCY = int(50e6)
ORIGIN = 0x40000000
# Devices of the program: see `src/bare.rs`.
FINISHER, SERIAL = 0x00100000, 0x10000000
BEGIN, END, FINISH = 1, 2, 0x5555
# A simulation that takes longer is stuck; the tile takes four minutes.
HOUR = 3600


class Clock(Module):
    """The clock of the simulation, with a reset at the start."""

    def __init__(self, pin):
        self.clock_domains.cd_sys = ClockDomain()
        self.clock_domains.cd_por = ClockDomain(reset_less=True)
        started = Signal(4)
        self.comb += [self.cd_sys.clk.eq(pin), self.cd_por.clk.eq(pin), self.cd_sys.rst.eq(started != 15)]
        self.sync.por += If(started != 15, started.eq(started + 1))


class Device(Module):
    """A device that takes stores at once. `stored` is high for a clock, with `data`."""

    def __init__(self):
        self.bus = bus = wishbone.Interface(data_width=32, adr_width=32, addressing="word")
        self.stored, self.data = Signal(), Signal(32)
        self.sync += bus.ack.eq(bus.cyc & bus.stb & ~bus.ack)
        self.comb += [self.stored.eq(bus.cyc & bus.stb & bus.ack & bus.we), self.data.eq(bus.dat_w)]


class Serial(Device):
    """A serial port that prints each byte as a line `byte N`."""

    def __init__(self):
        Device.__init__(self)
        byte = Signal(8)
        self.comb += byte.eq(self.data)
        self.sync += If(self.stored, Display("byte %d", byte))


class Finisher(Device):
    """Sums clocks between marks, and ends the simulation."""

    def __init__(self):
        Device.__init__(self)
        clock, begun, clocks = Signal(64), Signal(64), Signal(64)
        self.sync += [
            clock.eq(clock + 1),
            If(self.stored & (self.data == BEGIN), begun.eq(clock)),
            If(self.stored & (self.data == END), clocks.eq(clocks + clock - begun)),
            If(self.stored & (self.data == FINISH), Display("clocks %d", clocks), Finish()),
        ]


class System(SoCCore):
    """VexRiscv, SDRAM, and the two devices of the program."""

    mem_map = {**SoCCore.mem_map, "main_ram": ORIGIN}

    def __init__(self, words, variant, l2):
        platform = SimPlatform("SIM", [("sys_clk", 0, Pins(1)), ("sys_rst", 0, Pins(1))])
        self.crg = Clock(platform.request("sys_clk"))
        SoCCore.__init__(self, platform, FREQUENCY, ident="", with_uart=False, with_ctrl=False,
                         cpu_type="vexriscv", cpu_variant=variant, cpu_reset_address=ORIGIN,
                         integrated_rom_size=0, integrated_sram_size=0)
        module = MT48LC16M16(FREQUENCY, "1:1")
        self.sdrphy = SDRAMPHYModel(module, data_width=32, clk_freq=FREQUENCY, verbosity=0, init=words)
        self.add_sdram("sdram", phy=self.sdrphy, module=module, l2_cache_size=l2)
        for name, device, origin in [("serial", Serial(), SERIAL), ("finisher", Finisher(), FINISHER)]:
            setattr(self.submodules, name, device)
            self.bus.add_slave(name, device.bus, SoCRegion(origin=origin, size=0x1000))


def text_of(output):
    """What the program printed, from the lines of the devices, and the line `clocks`."""
    text = bytearray()
    for line in output.splitlines():
        kind, _, number = line.partition(" ")
        if kind == "byte":
            text.append(int(number))
        elif kind == "clocks":
            text += f"clocks {int(number)}\n".encode()
    return text.decode()


def main():
    """Builds one model, and runs each program on it. Prints what the program prints, `clocks`, those between its marks, and a line `end`."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("images", type=Path, nargs="+", help="memories of programs, a word a line")
    parser.add_argument("--variant", default="standard", help="variant of VexRiscv, as LiteX names it")
    parser.add_argument("--l2", type=int, default=0, help="bytes of the level 2 cache before the SDRAM, 0 for none")
    parser.add_argument("-o", "--output", type=Path, default=Path("build"), help="folder to build in")
    args = parser.parse_args()
    gateware = args.output / "gateware"
    gateware.mkdir(parents=True, exist_ok=True)
    for image in args.images:
        words = [int(line, 16) for line in image.read_text(encoding="ascii").split()]
        system = System(words, args.variant, args.l2)
        # LiteX's own builder wants the packages of its BIOS, which nothing runs here.
        system.platform.output_dir = str(args.output)
        system.finalize()
        system.build(build_dir=str(gateware), run=False, sim_config=SimConfig("sys_clk", FREQUENCY), opt_level="O3")
        if image == args.images[0]:
            built = subprocess.run(["bash", "build_sim.sh"], cwd=gateware, check=False, stdout=subprocess.DEVNULL)
            if built.returncode != 0:
                sys.exit("the model cannot be built: it needs Debian's verilator libevent-dev libjson-c-dev zlib1g-dev")
        # The model reads the words of the SDRAM from files when it starts.
        ran = subprocess.run(["obj_dir/Vsim"], cwd=gateware, stdout=subprocess.PIPE, text=True, check=True, timeout=HOUR)
        print(text_of(ran.stdout) + "end", flush=True)


if __name__ == "__main__":
    main()
