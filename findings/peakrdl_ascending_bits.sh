#!/usr/bin/env bash
# One SystemRDL register with fields written [0:7], nine outputs, three layouts: C, Rust and C++ do not fit the hardware.
#
# Expected: what is made of one SystemRDL file fits together. Software that writes mode = 0xB1 and gain = 0x100 with the
#   generated offsets gets these values at the outputs of the generated register block, or an exporter refuses the file.
# Seen: a range [0:7] puts the register into msb0 order: the field keeps its bits, its bit 0 is the most significant one.
#   Both register blocks (regblock and etana) do so, and the Python classes of peakrdl-python fit them. The others do not:
#   c-header, rust and ip-xact keep the place and drop the order, so each field arrives mirrored: gain 0x100 is 0x008.
#   uvm, cpp and python-simple take the number of the least significant bit for a shift to the left, so mode starts at
#   bit 7 and gain at bit 19, across its own end: mode is 0x01 and gain 0x1a0 in the hardware. None of these six
#   has the reset word of the block. As IP-XACT and back to SystemRDL, [0:7] has become [7:0],
#   so hardware made of that file has another map. No message, exit status 0 in all cases.
# Versions: systemrdl-compiler 1.33.0, peakrdl 1.5.0, peakrdl-regblock 1.3.1, peakrdl-etana 0.8.0, peakrdl-cheader 1.1.0,
#   peakrdl-uvm 2.4.0, peakrdl-cpp 0.3.0, peakrdl-rust 0.7.4, peakrdl-ipxact 3.5.0, peakrdl-systemrdl 1.0.1,
#   peakrdl_python_simple 0.2.14, peakrdl-python 4.0.0, pyosys 0.70.
# Why it matters: no keyword is needed, the order of two numbers is enough; a C or Python programmer writes ranges upwards.
#   Fields of one bit are the same in all three layouts, values such as 0x18 in two of them, so first tests pass.
# Source: SystemRDL 2.0, clause 10.7.1: both [low:high] and [high:low] are allowed, not in the same register;
#   the property msb0 says that bit fields are defined as 0:N. systemrdl-compiler, FieldNode: low and high are the positions in the register,
#   lsb and msb the ends in the order of significance. UVM 1.2, uvm_reg_field::configure: lsb_pos is the position of the
#   least significant bit, so the field takes lsb_pos to lsb_pos + size - 1. (An open issue on PeakRDL-html, 48,
#   reports its decoding of such fields; the READMEs of the exporters used here have no note on msb0.)
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install systemrdl-compiler==1.33.0 peakrdl==1.5.0 peakrdl-cli==1.5.0 peakrdl-regblock==1.3.1 \
  peakrdl-etana==0.8.0 peakrdl-cheader==1.1.0 peakrdl-uvm==2.4.0 peakrdl-cpp==0.3.0 peakrdl-rust==0.7.4 peakrdl-ipxact==3.5.0 \
  peakrdl-systemrdl==1.0.1 peakrdl-python-simple==0.2.14 peakrdl-python==4.0.0 pyosys==0.70
cd "$T"
cat > m.rdl <<'E'
addrmap m {
  reg {
    field { sw = rw; hw = r; } mode[0:7] = 8'hB1;
    field { sw = rw; hw = r; } gain[8:19] = 12'h123;
  } cfg @ 0x0;
};
E
run() { nice v/bin/peakrdl "$@" > log.txt 2>&1 || { cat log.txt; echo "behaviour changed: peakrdl $1 refuses the file"; exit 1; }
  if grep -qiE "warn|error" log.txt; then cat log.txt; echo "behaviour changed: peakrdl $1 gives a message"; exit 1; fi; }
run regblock m.rdl --cpuif passthrough -o regblock
run etana m.rdl --cpuif passthrough -o etana
run c-header m.rdl -o m.h
run uvm m.rdl -o uvm.sv
run cpp m.rdl -o m.hpp
run rust m.rdl -o rust
run ip-xact m.rdl -o m.xml
run systemrdl m.xml -o back.rdl
run python-simple m.rdl -o simple.py
run python m.rdl -o classes
nice v/bin/python - <<'PY'
import re, sys
sys.path.insert(0, "classes")
from pyosys import libyosys as ys
from peakrdl_python_simple.regif.regif import RegisterInterface
import simple
from m.lib import NormalCallbackSet
from m.reg_model.m import m_cls

widths, resets, wanted = {"mode": 8, "gain": 12}, {"mode": 0xB1, "gain": 0x123}, {"mode": 0xB1, "gain": 0x100}

def changed(what):
    sys.exit("behaviour changed: " + what)

def find(pattern, name, flags=0):
    found = re.findall(pattern, open(name).read(), flags)
    if len(found) != 1:
        changed(f"{name}, {pattern}")
    return int(found[0].replace("_", ""), 0)

# Hardware: read, write a word, read again; what do the outputs of the block show?
blocks = {"regblock": ("regblock/m_pkg.sv regblock/m.sv", "m_pkg::m__out_t h", ".hwif_out(h)", "h.cfg.mode.value", "h.cfg.gain.value"),
          "etana": ("etana/m.sv", "logic [19:0] h", ".hwif_out_cfg_mode(h[7:0]), .hwif_out_cfg_gain(h[19:8])", "h[7:0]", "h[19:8]")}

def hardware(block, word):
    files, declaration, ports, mode, gain = blocks[block]
    open("top.sv", "w").write(f"""module top(input clk, input rst, output logic [31:0] data, output [7:0] mode, output [11:0] gain);
logic [3:0] n; logic [31:0] rd; logic ack; {declaration};
always_ff @(posedge clk) if (rst) n <= 0; else n <= n + 1;
always_ff @(posedge clk) if (ack) data <= rd;
m dut(.clk, .rst, .s_cpuif_req(n == 2 || n == 4 || n == 6), .s_cpuif_req_is_wr(n == 4), .s_cpuif_addr('0), .s_cpuif_wr_data(32'd{word}),
  .s_cpuif_wr_biten('1), .s_cpuif_req_stall_wr(), .s_cpuif_req_stall_rd(), .s_cpuif_rd_ack(ack), .s_cpuif_rd_err(),
  .s_cpuif_rd_data(rd), .s_cpuif_wr_ack(), .s_cpuif_wr_err(), {ports});
assign mode = {mode}, gain = {gain};
endmodule
""")
    ys.Design().run_pass(f"tee -q read_slang {files} top.sv --top top; tee -q prep -flatten -top top; "
                         "tee -q sim -q -clock clk -reset rst -rstlen 2 -n 12 -vcd out.vcd")
    names, seen = {}, {"data": [], "mode": [], "gain": []}
    for words in map(str.split, open("out.vcd")):
        if words[:1] == ["$var"]:
            names.setdefault(words[3], words[4])
        elif len(words) == 2 and words[0][0] == "b" and "x" not in words[0] and names.get(words[1]) in seen:
            seen[names[words[1]]].append(int(words[0][1:], 2))
    return seen["data"][0], {"mode": seen["mode"][-1], "gain": seen["gain"][-1]}, (seen["mode"][0], seen["gain"][0])

# Software: the word for mode = 0xB1 and gain = 0x100 by each output, and the word after reset.
class Bus(RegisterInterface):
    word = 0
    def _get(self, address):
        return self.word
    def _set(self, address, value):
        self.word = value & 0xFFFFFFFF

def by_classes(model, bus, attribute, values):
    bus.word = 0
    for name, value in values.items():
        attribute(model.cfg, name, value)
    return bus.word

bus = Bus(32)
plain = simple.mAddrmap(register_interface=bus)
bus2 = Bus(32)
full = m_cls(callbacks=NormalCallbackSet(read_callback=lambda addr, width, accesswidth: bus2.word,
                                         write_callback=lambda addr, width, accesswidth, data: setattr(bus2, "word", data)))
shifts = {
    "c-header": {n: find(rf"M__CFG__{n.upper()}_bp (\d+)", "m.h") for n in widths},
    "rust": {n: find(rf"{n.upper()}_OFFSET: usize = (\d+)", "rust/components/m/cfg.rs") for n in widths},
    "ip-xact": {n: find(rf"<ipxact:name>{n}</ipxact:name>\s*<ipxact:bitOffset>(\d+)<", "m.xml") for n in widths},
    "uvm": {n: find(rf"{n}\.configure\(this, {w}, (\d+), \"RW\"", "uvm.sv") for n, w in widths.items()},
    "cpp": {n: find(rf"class MCfgReg_{n}_Field {{\s*public:\s*static constexpr std::uint8_t LSB = (\d+)", "m.hpp") for n in widths}}
words = {}
for name, shift in shifts.items():
    words[name] = [sum(v << shift[n] for n, v in values.items()) & 0xFFFFFFFF for values in (resets, wanted)]
words["python-simple"] = [by_classes(plain, bus, setattr, v) for v in (resets, wanted)]
words["python"] = [by_classes(full, bus2, lambda reg, n, value: getattr(reg, n).write(value), v) for v in (resets, wanted)]
if find(r"Self\((0x[0-9A-F_]+)\)", "rust/components/m/cfg.rs") != words["rust"][0] or \
        find(r"state_\(ctx, reg_offset, 32, 1, detail::reg_storage_t\{static_cast<data_t>\((0x[0-9A-F]+)ull", "m.hpp") != words["cpp"][0]:
    changed("the reset words in the Rust or C++ output")

mirrored, shifted = {"mode": 0x8D, "gain": 0x008}, {"mode": 0x01, "gain": 0x1A0}
expect = {"python": wanted, "c-header": mirrored, "rust": mirrored, "ip-xact": mirrored,
          "uvm": shifted, "cpp": shifted, "python-simple": shifted}
for name, (reset_word, word) in words.items():
    got = [hardware(block, word) for block in blocks]
    if got[0] != got[1] or got[0][2] != (0xB1, 0x123):
        changed("the two register blocks differ")
    print(f"{name:13} reset {reset_word:#010x} (bus: {got[0][0]:#010x}); mode 0xb1, gain 0x100 is written as {word:#010x}, the hardware has "
          f"mode {got[0][1]['mode']:#04x}, gain {got[0][1]['gain']:#05x}")
    if got[0][1] != expect[name] or (reset_word == got[0][0]) != (name == "python"):
        changed(name)
mirror = [sum((v >> i & 1) << (widths[n] - 1 - i) for i in range(widths[n])) for n, v in resets.items()]
if got[0][0] != mirror[0] | mirror[1] << 8:
    changed("the register block is not in msb0 order")
back = re.findall(r"(mode|gain)(\[\d+:\d+\])", open("back.rdl").read())
print("SystemRDL to IP-XACT to SystemRDL: mode[0:7], gain[8:19] became " + ", ".join(map("".join, back)))
if back != [("mode", "[7:0]"), ("gain", "[19:8]")] or "msb0" in open("back.rdl").read():
    changed("the IP-XACT round trip")
PY
echo "as described"
