"""@MODULE@ in LiteX: two streams of words, and a CSR for each constant.

@ORIGIN@

    self.filter = @CLASS@(platform)
    self.comb += [dma_reader.source.connect(self.filter.sink), self.filter.source.connect(dma_writer.sink)]

@PACKETS@ `last` of a stream is on the last word of a packet. roughxel_shell.py packs and unpacks words.
"""
from pathlib import Path

from migen import ClockSignal, If, Instance, ResetSignal, Signal

from litex.gen import LiteXModule
from litex.soc.interconnect import stream
from litex.soc.interconnect.csr import CSRField, CSRStatus, CSRStorage

HERE = Path(__file__).resolve().parent
SOURCES = [
@SOURCES@]


class @CLASS@(LiteXModule):
    """The design with its streams; constants count from the next fragment on after `take` is written."""

    def __init__(self, platform):
        self.sink = sink = stream.Endpoint([("data", @WIDTH@)])
        self.source = source = stream.Endpoint([("data", @WIDTH@)])
@CSRS@
        self.specials += Instance(
            "@AXIS@",
            i_aclk=ClockSignal("sys"),
            i_aresetn=~ResetSignal("sys"),
            i_s_axis_tvalid=sink.valid,
            o_s_axis_tready=sink.ready,
            i_s_axis_tdata=sink.data,
            i_s_axis_tlast=sink.last,
            o_m_axis_tvalid=source.valid,
            i_m_axis_tready=source.ready,
            o_m_axis_tdata=source.data,
            o_m_axis_tlast=source.last,
@PORTS@        )
        for file in SOURCES:
            platform.add_source(str(HERE / file))
