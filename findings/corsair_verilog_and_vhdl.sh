#!/usr/bin/env bash
# Corsair: one register map gives other registers in Verilog than in VHDL, and its AXI-Lite slave loses or doubles responses.
#
# Expected: the Verilog and the VHDL that are generated from one register map do the same. In a field "write 1 to clear" of several bits
#   each bit that is written as 1 is cleared, or the whole field. An AXI-Lite slave gives one response for each write.
# Seen: 1. rw1c and rw1s with more than one bit: in Verilog any 1 in a byte clears (sets) all bits of the field in that byte, in VHDL only the
#   lowest bit of that part is looked at. 2 written to 4 pending events leaves 0 in Verilog and 15 in VHDL; 13 in neither. A field
#   over two bytes is cleared in part by both.
#   2. rw with hardware "io" and roc with "i": in Verilog the input is copied in each clock. In VHDL it is copied only in the clock of a
#   write (roc: read), in place of the data written, so the hardware's value does not arrive.
#   3. AXI-Lite (the VHDL has the same statements): two writes while BREADY is low are both done, but only one gets a response.
#   A write to a queue ("q") that is full gets two responses, the first before the queue took the data, if address and data come in
#   different clocks. If BREADY is low then, BVALID falls again without a handshake.
#   Generator and Yosys say nothing.
# Versions: corsair 1.0.4, jinja2 3.1.6, pyosys 0.70. The VHDL processes are translated line by line into Verilog here; GHDL 2.0.0
#   shows the same values.
# Why it matters: the tool exists so that hardware, software and documentation agree. An interrupt handler that writes back the events that it
#   saw clears those that it did not see, or none, depending on the language of the project. A lost response stops a master
#   for good, a spare one confirms the wrong write. Masters with one write at a time that raise address, data and BREADY together do not see it.
# Source: Corsair's documentation, register map: rw1c "when 1 is written field is cleared", rw1s; any combination of the options i, o, c, s, l, a
#   is allowed; AXI-Lite: refer to the protocol. AMBA AXI (IHI0022): AXI4-Lite supports several outstanding transactions, a slave
#   can restrict that by its handshakes; VALID stays until READY.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install corsair==1.0.4 jinja2==3.1.6 pyosys==0.70
cd "$T"
nice v/bin/python - <<'PY'
import re, sys
from corsair import BitField, Register, RegisterMap, config, generators
from pyosys import libyosys as ys

def changed(what):
    sys.exit("behaviour changed: " + what)

setup = config.default_globcfg()
setup.update(data_width=32, address_width=16)
config.set_globcfg(setup)

def regmap(*registers):
    result = RegisterMap()
    for address, name, *fields in registers:
        result.add_registers(Register(name, "demonstration", address).add_bitfields([BitField(**field) for field in fields]))
    result.validate()
    return result

def simulate(clocks, *files):
    """The ports of the module top after each rising edge."""
    ys.Design().run_pass(f"tee -q read_verilog {' '.join(files)} top.v; tee -q prep -flatten -top top; "
                         f"tee -q sim -q -clock clk -reset rst -rstlen 2 -n {clocks} -vcd out.vcd")
    names, now, rows = {}, {}, []
    for line in open("out.vcd"):
        words = line.split()
        if line.startswith("$var"):
            names.setdefault(words[4].split("[")[0], words[3])
        elif line[0] == "b":
            now[words[1]] = words[0][1:]
        elif line[0] in "01xz":
            now[words[0][1:]] = words[0][0]
        if line[0] == "#" and now.get(names["clk"]) == "1":
            rows.append({name: now.get(code, "x") for name, code in names.items()})
    return rows

# Fields in both languages, on Corsair's own local bus.
fields = {"low": dict(width=4, lsb=0, access="rw1c", hardware="os", reset=15),
          "wide": dict(width=12, lsb=4, access="rw1c", hardware="os", reset=0xFFF),
          "mask": dict(width=4, lsb=16, access="rw1s", hardware="oc"),
          "level": dict(width=8, lsb=0, access="rw", hardware="io"),
          "count": dict(width=8, lsb=8, access="roc", hardware="io")}
for name, field in fields.items():
    field.update(name=name.upper(), description="demonstration")
events, values = ("low", "wide", "mask"), ("level", "count")
rmap = regmap((0, "IRQ", *(fields[n] for n in events)), (4, "VAL", *(fields[n] for n in values)))
generators.Verilog(rmap, "regs.v", interface="lb").generate()
generators.Vhdl(rmap, "regs.vhd", interface="lb").generate()
vhdl = open("regs.vhd").read()

def translated(signal):
    """The VHDL process of a signal as a Verilog process."""
    process = [p for p in re.findall(r"process \(clk\) begin\n.*?end process;", vhdl, re.S) if f"\n    {signal} <= \"" in p]
    if len(process) != 1:
        changed("the VHDL of " + signal)
    text = re.sub(r" *--.*", "", process[0])
    for pattern, replacement in ((r"process \(clk\) begin", "always @(posedge clk) begin"), (r"end (process|if);", "end"),
                                 (r"if rising_edge\(clk\) then", "if (1) begin"), (r"\bthen\b", "begin"), (r"\bels(if|e\b)", r"end els\1"),
                                 (r"\belsif\b", "else if"), (r"\belse\n", "else begin\n"), (r"\band\b", "&&"),
                                 (r"\((\d+) downto (\d+)\)", r"[\1:\2]"), (r"\b(wstrb|wdata)\((\d+)\)", r"\1[\2]"),
                                 (r" = '([01])'", r" == 1'b\1"), (r"\(others => '0'\)", "0"), (r"\(others => '1'\)", "~0"),
                                 (r'"([01]+)"', lambda m: f"{len(m[1])}'b{m[1]}")):
        text = re.sub(pattern, replacement, text)
    return text.replace("<=", "=")  # one register in each process, so this is the same; Yosys 0.70 mistakes two "<=" inside an "if"

def run_fields(field, address, data):
    signals = {n: f"csr_{'irq' if n in events else 'val'}_{n}" for n in fields}
    top = f"""module top(input clk, input rst, {", ".join(f"output [{f['width'] - 1}:0] v_{n}, output reg [{f['width'] - 1}:0] h_{n}"
                                                          for n, f in fields.items())});
reg [7:0] n; always @(posedge clk) if (rst) n <= 0; else n <= n + 1;
wire [15:0] waddr = {address}, raddr = 0; wire [31:0] wdata = {data}; wire [3:0] wstrb = 15; wire wen = n == 2, ren = 0;
wire csr_irq_low_set = 0, csr_irq_wide_set = 0, csr_irq_mask_clr = 0;
wire [7:0] csr_val_level_in = n < 5 ? 8'h77 : 8'h11, csr_val_count_in = 8'h55;
wire csr_irq_wen = wen && waddr == 0, csr_val_wen = wen && waddr == 4, csr_val_ren = 0, csr_val_ren_ff = 0;
regs verilog(.clk(clk), .rst(rst), .waddr(waddr), .wdata(wdata), .wen(wen), .wstrb(wstrb), .raddr(raddr), .ren(ren),
  {", ".join(f".{s}_in({s}_in)" for s in (signals["level"], signals["count"]))}, .csr_irq_low_set(csr_irq_low_set),
  .csr_irq_wide_set(csr_irq_wide_set), .csr_irq_mask_clr(csr_irq_mask_clr), {", ".join(f".{s}_out(v_{n})" for n, s in signals.items())});
"""
    for name, signal in signals.items():
        top += translated(signal + "_ff").replace(signal + "_ff", "h_" + name) + "\n"
    open("top.v", "w").write(top + "endmodule\n")
    rows = [row for row in simulate(12, "regs.v") if "x" not in row["v_" + field] + row["h_" + field]]
    return [(int(row["v_" + field], 2), int(row["h_" + field], 2)) for row in rows]

tests = [("low, 4 events pending, 2 written", "low", 0, 0x2, 0xD, (0, 15)), ("low, 4 events pending, 1 written", "low", 0, 0x1, 0xE, (0, 0)),
         ("wide, 12 events pending, 0x002 written", "wide", 0, 0x20, 0xFFD, (0xFF0, 0xFFF)),
         ("wide, 12 events pending, 0x800 written", "wide", 0, 0x8000, 0x7FF, (0x00F, 0xFFF)),
         ("wide, 12 events pending, 0x001 written", "wide", 0, 0x10, 0xFFE, (0xFF0, 0xFF0)),
         ("mask, no bit set, 4 written", "mask", 0, 0x40000, 4, (15, 0))]
for title, field, address, data, bits, want in tests:
    got = run_fields(field, address, data)[-1]
    print(f"{title}: Verilog {got[0]:#x}, VHDL {got[1]:#x} (bit by bit it is {bits:#x})")
    if got != want:
        changed(title)
for title, field, address, data, want in (
        ("level, reset to 0, 0x33 written, input 0x77, later 0x11", "level", 4, 0x33, ((0, 0x77, 0x33, 0x77, 0x11), (0, 0x77))),
        ("level, reset to 0, not written, input 0x77, later 0x11", "level", 0, 0, ((0, 0x77, 0x11), (0,))),
        ("count, reset to 0, not read, input 0x55", "count", 0, 0, ((0, 0x55), (0,)))):
    got = [[value for i, value in enumerate(trace) if i == 0 or trace[i - 1] != value] for trace in zip(*run_fields(field, address, data))]
    print(title + ": " + ", ".join(f"{name} {' '.join(f'{value:#x}' for value in trace)}" for name, trace in zip(("Verilog", "VHDL"), got)))
    if tuple(map(tuple, got)) != want:
        changed(title)

# The AXI-Lite slave: registers A and B, and a queue whose ready comes late.
word = dict(name="V", description="demonstration", width=32, lsb=0)
generators.Verilog(regmap((0, "A", dict(word, access="rw", hardware="o")), (4, "B", dict(word, access="rw", hardware="o")),
                          (8, "Q", dict(word, access="wo", hardware="q"))), "axil.v", interface="axil").generate()
cases = [  # title, writes, address, clock from which: address valid, data valid, BREADY, queue ready; responses, BVALID withdrawn
    ("two writes, BREADY always", 2, "done ? 4 : 0", 0, 0, 0, 0, (2, 0)), ("two writes, BREADY from clock 10", 2, "done ? 4 : 0", 0, 0, 10, 0, (1, 0)),
    ("queue, address and data together", 1, "8", 0, 0, 0, 8, (1, 0)), ("queue, data two clocks later", 1, "8", 0, 2, 0, 8, (2, 0)),
    ("queue, address two clocks later", 1, "8", 2, 0, 0, 8, (2, 0)), ("queue, data later, BREADY from clock 12", 1, "8", 0, 2, 12, 8, (1, 1))]
for title, writes, address, aw, w, b, q, want in cases:
    open("top.v", "w").write(f"""
module top(input clk, input rst, output reg [3:0] done, data, resp, taken, withdrawn, output [31:0] a, b, output bvalid);
reg [7:0] n; reg waiting; wire awready, wready, wen;
wire awvalid = done < {writes} && n >= {aw}, wvalid = data < {writes} && n >= {w}, bready = n >= {b}, ready = n >= {q};
axil slave(.clk(clk), .rst(rst), .axil_awaddr(16'd0 + ({address})), .axil_awprot(3'b0), .axil_awvalid(awvalid), .axil_awready(awready),
  .axil_wdata(32'd11 * (data + 1)), .axil_wstrb(4'hf), .axil_wvalid(wvalid), .axil_wready(wready), .axil_bvalid(bvalid), .axil_bready(bready),
  .axil_araddr(16'b0), .axil_arprot(3'b0), .axil_arvalid(1'b0), .axil_rready(1'b1),
  .csr_a_v_out(a), .csr_b_v_out(b), .csr_q_v_wready(ready), .csr_q_v_wen(wen));
always @(posedge clk) if (rst) begin n <= 0; done <= 0; data <= 0; resp <= 0; taken <= 0; withdrawn <= 0; waiting <= 0; end else begin
  n <= n + 1;
  if (awvalid && awready) done <= done + 1;
  if (wvalid && wready) data <= data + 1;
  if (bvalid && bready) resp <= resp + 1;
  if (wen && ready) taken <= taken + 1;
  waiting <= bvalid && !bready;
  if (waiting && !bvalid) withdrawn <= withdrawn + 1;
end
endmodule
""")
    rows = simulate(30, "axil.v")
    last = {name: int(bits, 2) for name, bits in rows[-1].items() if re.fullmatch("[01]+", bits)}
    print(f"AXI-Lite, {title}: {last['done']} addresses and {last['data']} data taken, A {last['a']}, B {last['b']}, queue {last['taken']}, "
          f"{last['resp']} responses, BVALID withdrawn {last['withdrawn']} times; BVALID {''.join(r['bvalid'] for r in rows)}")
    stored = (last["a"], last["b"], last["taken"])
    if (last["done"], last["data"]) != (writes, writes) or stored != ((11, 22, 0) if writes == 2 else (0, 0, 1)):
        changed("the writes, " + title)
    if (last["resp"], last["withdrawn"]) != want:
        changed(title)
PY
echo "as described"
