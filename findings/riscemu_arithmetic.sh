#!/usr/bin/env bash
# riscemu: fcvt.w.s of 3.0 is 32, -7 divided by 2 is -4, and a program that stopped at an error ends with status 0.
#
# Expected: an emulator for RV32IMF converts 3 to a float and back to 3. DIV rounds towards zero, REM has the sign of the dividend,
#   division by zero gives -1 without a trap. A program that the emulator stops does not look like one that passed.
# Seen: 1. With the default settings (all instruction sets, --flen 64) fcvt.w.s and fcvt.wu.s read the double that lies in the
#   register, not the float: 1 becomes 0, 3 becomes 32, 100 becomes 2147483647; 2 stays 2. fadd.s, fmul.s, fmv.x.w and
#   comparisons are right, so is fcvt.w.d, and so is all with --flen 32. 2. DIV rounds towards minus infinity and REM has the sign of
#   the divisor: -7 / 2 is -4 and 1, 7 / -2 is -4 and -1. DIVU, REMU and the four multiplications are right.
#   Division by zero ends in Python's ZeroDivisionError. 3. After a load from an unmapped address or an instruction
#   that it does not know how to do, "Halting due to exception!" is printed and the exit status is 0, with -o fail_on_ex too.
# Versions: riscemu 2.2.7; for comparison tinyrv 0.1.0, unicorn 2.1.4 (QEMU's processor).
# Why it matters: such an emulator is a quick check of firmware before the soft core is there. fcvt.w.s is how a float gets to fixed
#   point. The quotient is wrong only if the signs differ and there is a remainder, as with texture coordinates left of zero: the
#   emulator wraps them nicely, the hardware does not. A test that never reached its end passes.
# Source: The RISC-V unprivileged specification, M extension: DIV rounds towards zero, the sign of a nonzero REM equals the sign of the
#   dividend, table of division by zero; F extension: FCVT.W.S converts the floating-point number in rs1; D extension, NaN boxing:
#   narrower values occupy the lower bits. riscemu's README: M and A extensions are emulated; --help: all sets are enabled
#   by default, FLEN defaults to 64.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install riscemu==2.2.7 tinyrv==0.1.0 unicorn==2.1.4
cd "$T"
nice v/bin/python - <<'PY'
import contextlib, io, struct, subprocess, sys
import unicorn, unicorn.riscv_const as reg
from riscemu.riscemu_main import RiscemuMain
from tinyrv.sim import sim

RESULT = 10  # register a0; the operands are in a1 and a2

def riscemu(lines, a, b, flen=64):
    source = [".text", "main:", f"li a1, {a}", f"li a2, {b}", *lines, "li a7, 93", "scall"]
    open("a.s", "w").write("\n".join(source) + "\n")
    run = RiscemuMain()
    with contextlib.redirect_stdout(io.StringIO()) as log:
        run.run_from_cli(["--flen", str(flen), "a.s"])
    if "Halting" in log.getvalue():
        sys.exit("behaviour changed: " + log.getvalue())
    return run.cpu.regs.get("a0").signed().value

def r_type(op, funct7, funct3, rd, rs1, rs2):
    return funct7 << 25 | rs2 << 20 | rs1 << 15 | funct3 << 12 | rd << 7 | op

def signed(value):
    return (value + 2**31) % 2**32 - 2**31

def by_tinyrv(words, a, b):
    machine = sim(xlen=32)
    machine.copy_in(0x1000, struct.pack(f"<{len(words)}I", *words))
    machine.pc, machine.x[11], machine.x[12] = 0x1000, signed(a), signed(b)
    with contextlib.redirect_stdout(io.StringIO()):
        for _ in words:
            machine.step()
    return signed(machine.x[RESULT])

def by_unicorn(word, a, b):
    machine = unicorn.Uc(unicorn.UC_ARCH_RISCV, unicorn.UC_MODE_RISCV32)
    machine.mem_map(0x1000, 0x1000)
    machine.mem_write(0x1000, struct.pack("<I", word))
    machine.reg_write(reg.UC_RISCV_REG_X11, a % 2**32)
    machine.reg_write(reg.UC_RISCV_REG_X12, b % 2**32)
    machine.emu_start(0x1000, 0x1004)
    return signed(machine.reg_read(reg.UC_RISCV_REG_X10))

# 1. An integer to float, arithmetic, and back.
to_float = [r_type(0x53, 0x68, 7, 1, 11, 0), r_type(0x53, 0x68, 7, 2, 12, 0)]
steps = {"a": ([], []), "a + b": (["fadd.s ft1, ft1, ft2"], [r_type(0x53, 0x00, 7, 1, 1, 2)]),
         "a * b": (["fmul.s ft1, ft1, ft2"], [r_type(0x53, 0x08, 7, 1, 1, 2)])}
print("floats: a, b, what, riscemu, with --flen 32, its bits, tinyrv")
for a, b in ((1, 2), (3, 2), (5, 2), (-7, 2), (100, 7)):
    for what, (assembly, words) in steps.items():
        begin = ["fcvt.s.w ft1, a1", "fcvt.s.w ft2, a2", *assembly]
        seen = riscemu(begin + ["fcvt.w.s a0, ft1"], a, b)
        narrow = riscemu(begin + ["fcvt.w.s a0, ft1"], a, b, 32)
        raw = riscemu(begin + ["fmv.x.w a0, ft1"], a, b)
        right = by_tinyrv(to_float + words + [r_type(0x53, 0x60, 1, RESULT, 1, 0)], a, b)
        by_hand = {"a": a, "a + b": a + b, "a * b": a * b}[what]
        print(f"  {a:4} {b:2}  {what:5} {seen:8} {narrow:5}  {raw % 2**32:08x} {right:5}")
        if right != by_hand or narrow != by_hand or struct.unpack("<f", struct.pack("<i", raw))[0] != by_hand:
            sys.exit("behaviour changed: what was right")
        # The bits of the float, taken as the upper half of a double, held within 32 bits.
        as_double = struct.unpack("<d", struct.pack("<Ii", 0, raw))[0]
        if seen != int(min(max(as_double, -2**31), 2**31 - 1)) or (seen == by_hand) != (by_hand == 2):
            sys.exit("behaviour changed: fcvt.w.s")
if riscemu(["fcvt.s.w ft1, a1", "fcvt.wu.s a0, ft1"], 3, 0) != 32 or riscemu(["fcvt.d.w ft1, a1", "fcvt.w.d a0, ft1"], 3, 0) != 3:
    sys.exit("behaviour changed: fcvt.wu.s or fcvt.w.d")

# 2. The eight instructions of the M extension.
names = ("mul", "mulh", "mulhsu", "mulhu", "div", "divu", "rem", "remu")
values = (1, 2, 3, 7, 1000, 2**31 - 1, -1, -2, -7, -1000, -2**31)
for funct3, name in enumerate(names):
    word = r_type(0x33, 1, funct3, RESULT, 11, 12)
    wrong = []
    for a in values:
        for b in values:
            seen, right = riscemu([f"{name} a0, a1, a2"], a, b), by_unicorn(word, a, b)
            if right != by_tinyrv([word], a, b):
                sys.exit("behaviour changed: unicorn and tinyrv differ")
            if seen != right:
                wrong.append((a, b, seen, right))
                if seen != (a // b if name == "div" else a % b) or a * b > 0 or a % b == 0:
                    sys.exit("behaviour changed: another error in " + name)
    examples = "".join(f"; {a} {name} {b} is {s}, not {r}" for a, b, s, r in wrong if abs(a) == 7 and abs(b) == 2)
    print(f"{name:6} {len(wrong):2} of {len(values)**2} pairs wrong{examples}")
    if bool(wrong) != (name in ("div", "rem")):
        sys.exit("behaviour changed: " + name)

# 3. Exit statuses on the command line.
programs = {"exit(3.0 as an integer)": "li a1, 3\nfcvt.s.w ft1, a1\nfcvt.w.s a0, ft1", "exit(7)": "li a0, 7",
            "load from address 4, exit(7)": "li a1, 4\nlw a0, 0(a1)\nli a0, 7",
            "fsgnj.s, exit(7)": "fsgnj.s ft1, ft1, ft1\nli a0, 7"}
statuses = []
for name, body in programs.items():
    open("b.s", "w").write(f".text\nmain:\n{body}\nli a7, 93\nscall\n")
    for options in ([], ["-o", "fail_on_ex"]):
        p = subprocess.run([sys.executable, "-m", "riscemu", *options, "b.s"], capture_output=True, text=True, stdin=subprocess.DEVNULL)
        statuses.append(p.returncode)
        print(f"status {p.returncode:2}: {' '.join(options + [name])}" + (", printed: Halting due to exception!" if "Halting" in p.stdout else ""))
if statuses != [32, 32, 7, 7, 0, 0, 0, 0]:
    sys.exit("behaviour changed: exit statuses")
PY
echo "as described"
