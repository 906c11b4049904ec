"""Drives the shell of this folder in cocotb with the fragments of `bench`: registers by AXI4-Lite, words by AXI4-Stream.

`python3 bench/test_shell.py` builds and runs it in Icarus; cocotb 2. GAPS=1 in the environment adds random gaps to both streams.
"""
import os
import random
import sys
from pathlib import Path

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import roughxel_shell

SHELL = roughxel_shell.Shell(next(HERE.parent.glob("*.json")))
GAPS = os.environ.get("GAPS", "0") == "1"
# Cycles without a word after which the test gives up.
TIMEOUT = 10000


async def offer(dut, channel):
    """Holds `valid` of a channel from a falling edge to the one after the transfer."""
    valid, ready = getattr(dut, f"{channel}valid"), getattr(dut, f"{channel}ready")
    valid.value = 1
    for _ in range(TIMEOUT):
        await RisingEdge(dut.aclk)
        is_taken = str(ready.value) == "1"
        await FallingEdge(dut.aclk)
        if is_taken:
            valid.value = 0
            return
    raise AssertionError(f"{channel}ready stays low")


async def answer(dut, channel):
    """Waits for `valid` of a channel whose `ready` is high; the values of its signals."""
    for _ in range(TIMEOUT):
        await RisingEdge(dut.aclk)
        if str(getattr(dut, f"{channel}valid").value) == "1":
            names = ("resp", "data") if channel == "s_axi_r" else ("resp",)
            values = [int(getattr(dut, f"{channel}{name}").value) for name in names]
            await FallingEdge(dut.aclk)
            return values
    raise AssertionError(f"{channel}valid stays low")


async def write(dut, offset, word):
    """Writes a register; its response."""
    dut.s_axi_awaddr.value, dut.s_axi_wdata.value, dut.s_axi_wstrb.value = offset, word, 15
    data = cocotb.start_soon(offer(dut, "s_axi_w"))
    await offer(dut, "s_axi_aw")
    await data
    return (await answer(dut, "s_axi_b"))[0]


async def read(dut, offset):
    """Reads a register; its response and its word."""
    dut.s_axi_araddr.value = offset
    await offer(dut, "s_axi_ar")
    return await answer(dut, "s_axi_r")


async def send(dut, words, pauses):
    """Sends the words of a fragment."""
    for place, word in enumerate(words):
        while GAPS and pauses.random() < 0.3:
            await FallingEdge(dut.aclk)
        dut.s_axis_tdata.value, dut.s_axis_tlast.value = word, int(place + 1 == len(words))
        await offer(dut, "s_axis_t")


async def receive(dut, count, pauses):
    """Words of `count` outcomes, a list for each."""
    outcomes, words, idle = [], [], 0
    while len(outcomes) < count:
        is_ready = not (GAPS and pauses.random() < 0.3)
        dut.m_axis_tready.value = int(is_ready)
        await RisingEdge(dut.aclk)
        idle += 1
        if is_ready and str(dut.m_axis_tvalid.value) == "1":
            words.append(int(dut.m_axis_tdata.value))
            assert int(dut.m_axis_tlast.value) == int(len(words) == SHELL.output_words), f"tlast at word {len(words)}"
            idle = 0
        if len(words) == SHELL.output_words:
            outcomes.append(words)
            words = []
        assert idle < TIMEOUT, f"only {len(outcomes)} of {count} outcomes came"
        await FallingEdge(dut.aclk)
    return outcomes


@cocotb.test()
async def every_fragment(dut):
    """Every output of every fragment is right."""
    inputs, expected = SHELL.fragments("bench")
    for name in ("s_axis_tvalid", "m_axis_tready", "s_axi_awvalid", "s_axi_wvalid", "s_axi_arvalid"):
        getattr(dut, name).value = 0
    dut.s_axi_bready.value = dut.s_axi_rready.value = 1
    dut.aresetn.value = 0
    Clock(dut.aclk, 10, "ns").start()
    for _ in range(3):
        await FallingEdge(dut.aclk)
    dut.aresetn.value = 1

    ident = SHELL.registers["ident"]
    assert await read(dut, ident["offset"]) == [0, ident["reset"]], "hardware and manifest are of different designs"
    received = cocotb.start_soon(receive(dut, len(expected), random.Random(1)))
    writes, pauses = [], random.Random(2)
    for fragment in inputs:
        if SHELL.writes(fragment) != writes:
            writes = SHELL.writes(fragment)
            for offset, word in writes:
                assert await write(dut, offset, word) == 0, f"no register at {offset}"
        await send(dut, SHELL.words(fragment), pauses)
    wrong = 0
    for index, (words, outputs) in enumerate(zip(await received, expected)):
        outcome = SHELL.outcome(words)
        names = [name for name in outputs if outcome[name] != outputs[name]]
        wrong += bool(names)
        for name in names[:3]:
            print(f"fragment {index}: {name} is {outcome[name]}, expected {outputs[name]}")
    print(f"{'FAIL' if wrong else 'PASS'} {SHELL.module}: {wrong} of {len(expected)} outcomes differ", flush=True)
    assert wrong == 0


def main():
    """Builds the shell and runs the test in Icarus; True if it passed."""
    from cocotb_tools.check_results import get_results
    from cocotb_tools.runner import get_runner

    runner, build = get_runner("icarus"), HERE / "build"
    runner.build(sources=SHELL.sources(), hdl_toplevel=SHELL.module, build_dir=build, timescale=("1ns", "1ps"), always=True)
    results = runner.test(test_module="test_shell", hdl_toplevel=SHELL.module, hdl_toplevel_lang="verilog", build_dir=build,
                          test_dir=HERE, results_xml=str(build / "results.xml"), timescale=("1ns", "1ps"))
    tests, failed = get_results(Path(results))
    return tests > 0 and failed == 0


if __name__ == "__main__":
    sys.exit(0 if main() else 1)
