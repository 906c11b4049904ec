"""Drives @NAME@_device with every vector of the set @SET@ in cocotb and compares every field.

`python3 test_@NAME@.py` builds and runs it in Icarus; cocotb 2. Environment: STOP (10), OUTPUTS_ONLY, STALLS (0 or 1), TIMEOUT
(10000 cycles), BUILD (build/cocotb), GOT (a file, for all words that the device gives) are those of run.sh.
"""
import os
import random
import sys
from pathlib import Path

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

sys.path.insert(0, str(Path(__file__).resolve().parent))
import roughxel_vectors

HERE = Path(__file__).resolve().parent
NAME = "@NAME@"
# The order of the packed structure: earliest stage first.
OUTPUTS = """
@PYTHON_OUTPUTS@
""".split()


def setting(name, default):
    """A number of the environment."""
    return int(os.environ.get(name) or default)


@cocotb.test()
async def every_vector(dut):
    """Every field of every vector is right."""
    vectors = roughxel_vectors.VectorSet(HERE / "set.json", HERE / "words.hex", OUTPUTS)
    stop, timeout = setting("STOP", 10), setting("TIMEOUT", 10000)
    outputs_only, stalls = setting("OUTPUTS_ONLY", 0), setting("STALLS", 0)
    pauses = random.Random(1)
    path = os.environ.get("GOT")
    try:
        got = open(path, "w", encoding="ascii") if path else None
    except OSError as error:
        print(f"ERROR {path} cannot be written: {error.strerror}")
        raise AssertionError("no file for the words") from error

    dut.rst.value = 1
    dut.in_valid.value = 0
    dut.out_ready.value = 0
    Clock(dut.clk, 2, "ns").start()
    for _ in range(3):
        await FallingEdge(dut.clk)
    dut.rst.value = 0

    taken = checked = wrong = idle = 0
    # What is driven between a falling edge and the next is what the rising edge between them takes.
    while checked < len(vectors) or idle <= 100:
        is_valid = taken < len(vectors) and not (stalls and pauses.random() < 0.125)
        is_ready = not (stalls and pauses.random() < 0.25)
        dut.in_valid.value = int(is_valid)
        dut.out_ready.value = int(is_ready)
        if is_valid:
            dut.inputs.value = vectors.inputs(taken)
        await RisingEdge(dut.clk)
        if is_valid and str(dut.in_ready.value) == "1":
            taken += 1
        idle += 1
        if is_ready and str(dut.out_valid.value) == "1":
            idle = 0
            if checked == len(vectors):
                print(f"ERROR an output after the last of {checked} vectors")
                raise AssertionError("too many outputs")
            outputs = str(dut.outputs.value).lower()
            if got:
                print(vectors.with_outputs(checked, outputs), file=got)
            lines = vectors.differences(checked, outputs, outputs_only)
            checked += 1
            if lines:
                wrong += 1
                if wrong <= stop:
                    print(*lines, sep="\n")
                if wrong == stop and not got:
                    print(f"FAIL @SET@: {wrong} of {checked} vectors differ, stopped there")
                    raise AssertionError("vectors differ")
        if idle > timeout:
            print(f"ERROR only {checked} of {len(vectors)} outputs came: none for {timeout} cycles")
            raise AssertionError("the outputs stopped")
        await FallingEdge(dut.clk)
    if got:
        got.close()
    print(f"FAIL @SET@: {wrong} of {checked} vectors differ" if wrong else f"PASS @SET@: {checked} vectors", flush=True)
    assert wrong == 0, "vectors differ"


def main():
    """Builds the device and runs the test in Icarus; True where it passed."""
    from cocotb_tools.check_results import get_results
    from cocotb_tools.runner import get_runner

    build = os.environ.get("BUILD") or HERE / "build" / "cocotb"
    runner = get_runner("icarus")
    runner.build(
        sources=[HERE / f"{NAME}_pkg.sv", HERE / f"{NAME}_device.sv", *sorted((HERE / "rtl").glob("*.*v"))],
        hdl_toplevel=f"{NAME}_device", build_args=["-g2012"], build_dir=build, timescale=("1ns", "1ns"), always=True)
    results = runner.test(
        test_module=f"test_{NAME}", hdl_toplevel=f"{NAME}_device", hdl_toplevel_lang="verilog", build_dir=build,
        test_dir=HERE, plusargs=["+stalls"] if setting("STALLS", 0) else [], results_xml=str(Path(build) / "results.xml"), timescale=("1ns", "1ns"))
    tests, failed = get_results(Path(results))
    return tests > 0 and failed == 0


if __name__ == "__main__":
    sys.exit(0 if main() else 1)
