"""A LiteX system on chip with a generated shell, verilated: golden vectors go in by CSRs and a stream, every word that comes out is compared.

    roughxel verilog --profile narrow --multipliers 8 --stream 32 -o ecp5
    python3 host-tests/litex/simulate.py ecp5 vectors/smoke/random_narrow.json -o build

LiteX 2024.12, migen 0.10.0, pythondata-misc-tapcfg, Verilator, and the headers of libevent, json-c and zlib. Exit code 0: no word differs.
"""
import argparse
import importlib.util
import re
import subprocess
import sys
from pathlib import Path

from migen import Cat, ClockDomain, Display, Finish, If, Memory, Module, Signal

from litex.build.generic_platform import Pins
from litex.build.sim import SimPlatform
from litex.build.sim.config import SimConfig
from litex.soc.integration.builder import Builder
from litex.soc.integration.soc_core import SoCMini
from litex.soc.interconnect import wishbone

ROOT = Path(__file__).resolve().parents[2]
FREQUENCY = int(1e6)
# What the script of the bench says: write a register, send a word, send the last word of a fragment, end.
WRITE, SEND, LAST, END = range(4)


def module_of(path):
    """A Python file as a module."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Clock(Module):
    """The clock of the simulation, without a reset after the start."""

    def __init__(self, pin):
        self.clock_domains.cd_sys = ClockDomain()
        started = Signal(4)
        self.clock_domains.cd_por = ClockDomain(reset_less=True)
        self.comb += [self.cd_sys.clk.eq(pin), self.cd_por.clk.eq(pin), self.cd_sys.rst.eq(started != 15)]
        self.sync.por += If(started != 15, started.eq(started + 1))


class Bench(Module):
    """Plays a script of bus writes and words, with random gaps, and compares the words of the outcomes."""

    def __init__(self, sink, source, script, expected, width):
        self.bus = bus = wishbone.Interface(data_width=32, adr_width=32, addressing="byte")
        self.script, self.expected = Memory(2 + 32 + width, len(script), init=script), Memory(width, len(expected), init=expected)
        play, check = self.script.get_port(async_read=True), self.expected.get_port(async_read=True)
        self.specials += self.script, self.expected, play, check
        noise, offered = Signal(16, reset=0xACE1), Signal()
        self.sync += noise.eq(Cat(noise[15] ^ noise[13] ^ noise[12] ^ noise[10], noise[:15]))

        operation, address, data = Signal(2), Signal(32), Signal(width)
        self.comb += [
            Cat(data, address, operation).eq(play.dat_r),
            bus.adr.eq(address), bus.dat_w.eq(data), bus.sel.eq(0xF), bus.we.eq(1),
            sink.data.eq(data), sink.last.eq(operation == LAST),
        ]
        is_word = (operation == SEND) | (operation == LAST)
        self.comb += [
            bus.cyc.eq(operation == WRITE), bus.stb.eq(operation == WRITE),
            sink.valid.eq(is_word & (offered | noise[3])),
        ]
        self.sync += [
            offered.eq(sink.valid & ~sink.ready),
            If((bus.cyc & bus.ack) | (sink.valid & sink.ready), play.adr.eq(play.adr + 1)),
        ]
        wrong, idle, done = Signal(32), Signal(32), Signal(32)
        self.comb += source.ready.eq(noise[7])
        self.sync += [
            idle.eq(idle + 1),
            If(source.valid & source.ready,
                idle.eq(0), done.eq(done + 1), check.adr.eq(check.adr + 1),
                If(source.data != check.dat_r,
                    wrong.eq(wrong + 1),
                    If(wrong < 10, Display("word %d is %x, expected %x", done, source.data, check.dat_r)))),
            If((done == len(expected)) & (idle > 200),
                Display("END %d words, %d differ", done, wrong), Finish()),
            If(idle > 20000, Display("STOPPED after %d words", done), Finish()),
        ]


class System(SoCMini):
    """The shell of a folder as `shell`, and the bench as the master of the bus."""

    def __init__(self, folder, script, expected, width):
        platform = SimPlatform("SIM", [("sys_clk", 0, Pins(1)), ("sys_rst", 0, Pins(1))])
        self.crg = Clock(platform.request("sys_clk"))
        SoCMini.__init__(self, platform, FREQUENCY, ident="", with_ctrl=False)
        path = next(folder.glob("*_litex.py"))
        classes = [value for value in vars(module_of(path)).values()
                   if isinstance(value, type) and value.__module__ == path.stem]
        self.shell = classes[0](platform)
        self.bench = Bench(self.shell.sink, self.shell.source, script, expected, width)
        self.bus.add_master(name="bench", master=self.bench.bus)


def registers(folder, build):
    """Address of each CSR, from a system that is not run."""
    system = System(folder, [0, 0], [0, 0], 32)
    Builder(system, output_dir=str(build), compile_software=False, compile_gateware=False,
            csr_csv=str(build / "csr.csv")).build(run=False, sim_config=SimConfig("sys_clk", FREQUENCY))
    lines = (build / "csr.csv").read_text(encoding="ascii").splitlines()
    rows = [line.split(",") for line in lines if line.startswith("csr_register,shell_")]
    return {row[1][len("shell_"):]: int(row[2], 0) for row in rows}


def main():
    """Builds and runs; True if no word differs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="what `roughxel verilog --stream` wrote")
    parser.add_argument("sets", type=Path, nargs="+", help="manifests of vector sets of this design, profile and effects")
    parser.add_argument("-o", "--output", type=Path, default=Path("build"), help="folder to build in")
    args = parser.parse_args()
    sys.path.insert(0, str(args.folder))
    sys.path.insert(0, str(ROOT / "vectors/templates/cocotb"))
    import roughxel_shell
    import roughxel_vectors

    shell = roughxel_shell.Shell(next(args.folder.glob("*.json")))
    addresses = registers(args.folder, args.output / "map")
    script, expected, before, count = [], [], None, 0
    width = shell.stream_bits

    def say(operation, address, data):
        script.append(operation << (32 + width) | address << width | data)

    def write(name, value):
        say(WRITE, addresses[name], value)

    for path in args.sets:
        vectors = roughxel_vectors.VectorSet(path, path.with_suffix(".hex"))
        for index in range(len(vectors)):
            inputs, outputs = shell.of_set(vectors, index)
            constants = {register["name"]: port.bits(inputs.get(port.name, 0)) for port, register in shell.constants}
            if constants and constants != before:
                for name, value in constants.items():
                    write(name, value)
                write("take", 1)
                before = constants
            words = shell.words(inputs)
            for place, word in enumerate(words):
                say(LAST if place + 1 == len(words) else SEND, 0, word)
            packed = roughxel_shell._pack(shell.outputs, outputs)
            expected += [packed >> (width * place) & ((1 << width) - 1) for place in range(shell.output_words)]
            count += 1
    say(END, 0, 0)

    system = System(args.folder, script, expected, width)
    builder = Builder(system, output_dir=str(args.output), compile_software=False)
    builder.build(run=False, sim_config=SimConfig("sys_clk", FREQUENCY), opt_level="O1")
    gateware = args.output / "gateware"
    subprocess.run(["bash", "build_sim.sh"], cwd=gateware, check=True, stdout=subprocess.DEVNULL)
    # LiteX's own run ignores the exit code and what the program prints.
    run = subprocess.run(["obj_dir/Vsim"], cwd=gateware, capture_output=True, text=True, check=False)
    end = re.search(r"END +(\d+) words, +(\d+) differ", run.stdout)
    passed = end is not None and int(end[1]) == len(expected) and int(end[2]) == 0
    if not passed:
        print(run.stdout)
    differ = end[2] if end else "unknown"
    print(f"{'PASS' if passed else 'FAIL'} {shell.module} in LiteX: {count} fragments, {len(expected)} words, {differ} differ")
    return passed


if __name__ == "__main__":
    sys.exit(0 if main() else 1)
