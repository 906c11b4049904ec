#!/usr/bin/env bash
# Three RISC-V models from PyPI: loads keep one byte with NumPy 2, a stored -1 is not -1, calls miss the function, `sh` clears half a word.
#
# Expected: programs of plain RV32I instructions end with the same registers and memory in each model, as in the reference emulator.
# Seen: 1. tinyfive accepts NumPy 2 ("numpy>1.20.0"), but joins the bytes of a word by uint8 << 8, which is 0 there. LW, LH and LHU give
#   the lowest byte alone, FLW of -2.25 gives 0.0, and so do the functions that read arrays back. Instructions are fetched that way, so
#   the first example for machine code in its documentation, 6 * 7 = 42, ends with 0. No message: the low byte alone is a legal one.
#   2. riscv-emulator keeps -1 as 4294967295 after addi and as -1 after lw: stored and loaded again, `beq` finds it different.
#   `jalr ra, ra, offset`, the second half of every far call, uses the new ra: it jumps to its own pc + 4 + offset.
#   A jump to itself, the usual end of a program, goes on with the next word.
#   3. Its assembler loses an instruction on the line of a label ("loop: addi ..."): the rest moves up, the label stays.
#   4. riscv-model: `sh` writes the whole word: its other half becomes 0, and at the upper half the value goes to the lower one.
#   `srai` of a negative number is a logical shift, `sltiu rd, rs, -1` is 0 for 0.
# Versions: tinyfive 1.0.0, numpy 2.4.6, riscv-emulator 0.1.1, riscv-model 0.6.6; reference unicorn 2.1.4.
# Why it matters: such models serve as references for soft cores and for code that runs on them; riscv-model is meant for "automated
#   testing and verification", though its README adds "not very useful yet". tinyfive's loads are right below 256, and its examples use such numbers.
# Source: RISC-V unprivileged specification, RV32I: LW loads a 32-bit value; BEQ compares registers of XLEN bits; JALR's target is
#   rs1 plus the immediate, with the lowest bit cleared, and AUIPC with JALR reaches any 32-bit address; SH stores the low 16 bits; SRAI
#   copies the sign bit; SLTIU sign-extends its immediate, then compares as unsigned. NumPy 2 migration guide: Python integers are weak,
#   so np.uint8(1) << 8 stays a uint8. tinyfive's README, example 1.3.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install tinyfive==1.0.0 numpy==2.4.6 riscv-emulator==0.1.1 riscv-model==0.6.6 unicorn==2.1.4
cd "$T"
nice v/bin/python - <<'PY'
import contextlib, io, sys
import numpy as np
from riscv_emulator import assemble
from riscv_emulator.emulator import emulator
from riscvmodel.code import decode
from riscvmodel.model import Model
from riscvmodel.variant import RV32I
from tinyfive.machine import machine
from unicorn import Uc, UC_ARCH_RISCV, UC_MODE_RISCV32
from unicorn.riscv_const import UC_RISCV_REG_PC, UC_RISCV_REG_X0

def changed(what):
    sys.exit("behaviour changed: " + what)

def check(title, got, want):
    print(f"{title}: {got}")
    if got != want:
        changed(f"{title}, expected {want}")

def reference(words, steps, registers=(), memory=()):
    """Registers, program counter and the word at 1024 after so many instructions, by Unicorn."""
    uc = Uc(UC_ARCH_RISCV, UC_MODE_RISCV32)
    uc.mem_map(0, 0x10000)
    uc.mem_write(0, b"".join(w.to_bytes(4, "little") for w in words))
    for address, word in memory:
        uc.mem_write(address, (word & 0xFFFFFFFF).to_bytes(4, "little"))
    for i, value in registers:
        uc.reg_write(UC_RISCV_REG_X0 + i, value & 0xFFFFFFFF)
    uc.emu_start(0, 0xFFFC, count=steps)
    x = [uc.reg_read(UC_RISCV_REG_X0 + i) & 0xFFFFFFFF for i in range(32)]
    return x, uc.reg_read(UC_RISCV_REG_PC), int.from_bytes(uc.mem_read(1024, 4), "little")

# 1. tinyfive
LW, LH, LHU = 0x40002303, 0x40001303, 0x40005303  # to x6 from 1024(x0)
for value, name, code, want in ((0x12345678, "LW", LW, 0x78), (0x12345678, "LHU", LHU, 0x78), (-2, "LW", LW, 0xFE), (-2, "LH", LH, 0xFE), (100, "LW", LW, 100)):
    m = machine(4000)
    m.write_i32(value, 1024)
    getattr(m, name)(6, 1024, 0)
    right = reference([code], 1, memory=[(1024, value)])[0][6]
    check(f"tinyfive, {name} of {value & 0xFFFFFFFF:#010x}, right is {right:#010x}", hex(int(m.x[6]) & 0xFFFFFFFF), hex(want))
    if (want == right) != (value == 100):
        changed("the right value of a load")
m = machine(4000)
m.write_f32_vec(np.array([1.5, -2.25, 1e-3], "f4"), 0)
if m.mem[:12].tobytes() != np.array([1.5, -2.25, 1e-3], "<f4").tobytes():
    changed("tinyfive's write_f32_vec")
m.FLW_S(1, 4, 0)
check("tinyfive, FLW of -2.25", float(m.f[1]), 0.0)
check("tinyfive, 1.5, -2.25, 0.001 written and read back", [f"{v:.3g}" for v in m.read_f32_vec(0, 3).tolist()], ["0", "0", "1.56e-43"])
m = machine(mem_size=4000)
m.write_i32(6, 0)
m.write_i32(7, 4)
m.pc = 80
for line in (("lw", 11, 0, 0), ("lw", 12, 4, 0), ("mul", 10, 11, 12)):
    m.asm(*line)
text = io.StringIO()
with contextlib.redirect_stdout(text):
    m.exe(start=80, instructions=3)
code = [int.from_bytes(m.mem[80 + i:84 + i].tobytes(), "little") for i in (0, 4, 8)]
check("tinyfive, machine code for 6 * 7, right is 42", (int(m.x[10]), text.getvalue()), (0, ""))
check("the same code in the reference", reference(code, 3, memory=[])[0][10] if code == [0x2583, 0x402603, 0x2C58533] else code, 0x2583 * 0x402603 % 2**32)

# 2. and 3. riscv-emulator, with its own assembler; the program stops at a word 0
def run(source, limit=50):
    open("p.s", "w").write(source)
    assemble("p.s")
    code = open("p.bin", "rb").read()
    e = emulator(0x4000)
    e.load_program("p.bin")
    steps = 0
    while steps < limit and (word := int.from_bytes(e.memory[e.pc:e.pc + 4], "little")):
        e.execute(word)
        steps += 1
    return [int.from_bytes(code[i:i + 4], "little") for i in range(0, len(code), 4)], [v & 0xFFFFFFFF for v in e.rg], steps, e.rg

equal = "addi x5, x0, -1\nsw x5, 1024(x0)\nlw x6, 1024(x0)\naddi x7, x0, 1\nbeq x5, x6, 8\naddi x7, x0, 2\naddi x8, x0, 3\n"
words, x, steps, raw = run(equal)
check("riscv-emulator, -1 and -1 from memory", (raw[5], raw[6]), (4294967295, -1))
check("  beq: x7 (1 is equal), right is " + str(reference(words, 6)[0][7]), (x[7], reference(words, 6)[0][7]), (2, 1))
call = "auipc ra, 0\njalr ra, ra, 16\n" + "".join(f"addi x{r}, x0, 5\n" for r in (7, 8, 9, 10, 11))
words, x, steps, _ = run(call)
right = reference(words, 5)[0]
check("riscv-emulator, auipc and jalr to 16: registers set, right is x9 x10 x11", [i for i in range(7, 12) if x[i]], [11])
if [i for i in range(7, 12) if right[i]] != [9, 10, 11]:
    changed("the reference for a call")
words, x, steps, _ = run("addi x5, x0, 1\nend:\njal x0, end\naddi x6, x0, 9\n")
check("riscv-emulator, jump to itself: x6 is set", (x[6], steps, reference(words, 30)[:2][1]), (9, 3, 4))
loop = "addi x5, x0, 3\nloop:{}addi x6, x6, 10\naddi x5, x5, -1\nbne x5, x0, loop\naddi x7, x0, 5\n"
separate, together = run(loop.format("\n")), run(loop.format(" "))
check("riscv-emulator's assembler, loop with the label on its own line: x6", (separate[1][6], reference(separate[0], 11)[0][6]), (30, 30))
check("  with the label before the instruction", together[1][6], 0)
check("  the words", [f"{w:08x}" for w in together[0]], [f"{separate[0][i]:08x}" for i in (0, 2)] + ["fe029ee3", f"{separate[0][4]:08x}", "00000000"])

# 4. riscv-model
def model(word, x5, x6=0):
    m = Model(RV32I)
    m.state.memory.memory[256] = 0x81828384
    m.state.intreg[5], m.state.intreg[6] = x5, x6
    m.state.intreg.commit()
    m.issue(decode(word))
    return m.state.intreg[7].unsigned(), m.state.memory.memory[256]

for title, word, x5, x6, want, right in (("sh 0x1234 to the lower half of 0x81828384", 0x00629023, 1024, 0x1234, 0x1234, 0x81821234),
                                         ("sh 0x1234 to the upper half", 0x00629123, 1024, 0x1234, 0x1234, 0x12348384)):
    got, ref = model(word, x5, x6)[1], reference([word], 1, [(5, x5), (6, x6)], [(1024, 0x81828384)])[2]
    check(f"riscv-model, {title}, right is {right:#010x}", (hex(got), hex(ref)), (hex(want), hex(right)))
for title, word, x5, want, right in (("srai of -8 by 1", 0x4012D393, -8, 0x7FFFFFFC, 0xFFFFFFFC), ("srli of -8 by 1", 0x0012D393, -8, 0x7FFFFFFC, 0x7FFFFFFC),
                                     ("sltiu of 0 and -1", 0xFFF2B393, 0, 0, 1), ("sltiu of 0 and 5", 0x0052B393, 0, 1, 1)):
    got, ref = model(word, x5)[0], reference([word], 1, [(5, x5)])[0][7]
    check(f"riscv-model, {title}, right is {right:#x}", (hex(got), hex(ref)), (hex(want), hex(right)))
PY
echo "as described"
