#!/usr/bin/env bash
# rp2040js: in the emulated Cortex-M0+, 0 < INT64_MAX is false, INT64_MAX + 1 does not overflow, and a rounding shift by 0 changes the number.
#
# Expected: the flags of the Thumb instructions are those of the architecture manual. Another emulator, Unicorn, agrees with it.
#   Each lane of the RP2040's interpolator has its own FORCE_MSB.
# Seen: 1. SBCS and ADCS add the carry to one operand before they compute V. If that operand is 0x7fffffff, V is inverted, whatever
#   the other one is. So the two-instruction comparison of 64-bit numbers that compilers write says that 0 is not less than
#   2^63 - 1. 2^63 - 1 plus 1 does not overflow, and 2^63 - 1 plus -1 does. The sums themselves are right.
#   2. LSRS, ASRS and RORS by a register that holds 0 put bit 31 into C, which should stay. A shift that rounds with the last bit
#   shifted out (shift, then add the carry) adds 1 to a number with bit 31 set. LSLS by 33 to 255 puts some bit of the number into C
#   in place of 0.
#   3. FORCE_MSB of lane 1 does nothing; lane 1 takes the bits of lane 0. A pointer into flash is one into the ROM. No message.
# Versions: rp2040js 1.4.1 (npm); for comparison unicorn 2.1.4 with keystone-engine 0.9.2 as assembler.
# Why it matters: firmware for the Pico is tested in this emulator, in the browser and in continuous integration. Limits of fixed-point
#   numbers with 64 bits, saturation and time-outs of "never" (INT64_MAX) take the other branch there. The interpolator is the
#   Pico's texture unit: lane 1 is often the row. The project compared itself with real chips in 2021 and closed the issues about
#   flags of these instructions (ADCS, SBCS, shifts), so a reader trusts them.
# Source: ARMv6-M Architecture Reference Manual (DDI 0419): AddWithCarry computes V from the sum of both operands and the carry;
#   Shift_C with amount 0 returns the carry that came in; LSL_C extends the operand by zeros. RP2040 datasheet, 2.3.1,
#   INTERP0_CTRL_LANE1, FORCE_MSB: ORed into bits 29:28 of the lane result.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install unicorn==2.1.4 keystone-engine==0.9.2
cd "$T"
nice npm install --silent --no-audit --no-fund --no-save --prefix "$T" rp2040js@1.4.1 > npm.log
cat > reference.py <<'PY'
import json, sys
import keystone, unicorn
from unicorn import arm_const as arm

BASE = 0x20000000
MASK = 0xFFFFFFFF
machine = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
machine.ctl_set_cpu_model(arm.UC_CPU_ARM_CORTEX_M0)
machine.mem_map(BASE, 0x1000)
assembler = keystone.Ks(keystone.KS_ARCH_ARM, keystone.KS_MODE_THUMB)
regs = (arm.UC_ARM_REG_R0, arm.UC_ARM_REG_R1, arm.UC_ARM_REG_R2, arm.UC_ARM_REG_R3)

def signed(value):
    return value - (value >> 31 << 32)

def by_the_manual(name, a, b, flags):
    carry, overflow = flags >> 1 & 1, flags & 1
    amount = b & 255
    if name in ("adcs", "sbcs"):
        b ^= MASK if name == "sbcs" else 0
        total = a + b + carry
        carry, result = total >> 32, total & MASK
        overflow = int(signed(result) != signed(a) + signed(b) + (flags >> 1 & 1))
    elif amount == 0:
        result = a
    elif name == "lsls":
        wide = a << amount
        carry, result = wide >> 32 & 1, wide & MASK
    elif name == "rors":
        turn = amount % 32
        result = (a >> turn | a << 32 - turn) & MASK
        carry = result >> 31
    else:
        value = signed(a) if name == "asrs" else a
        carry, result = value >> amount - 1 & 1, value >> amount & MASK
    return result, (result >> 31) << 3 | (result == 0) << 2 | carry << 1 | overflow

def run(name, values, flags):
    start = BASE + 64 * list(code).index(name)
    for reg, value in zip(regs, values):
        machine.reg_write(reg, value)
    machine.reg_write(arm.UC_ARM_REG_XPSR, flags << 28 | 1 << 24)
    machine.emu_start(start | 1, start + len(code[name]))
    return machine.reg_read(regs[0]), machine.reg_read(arm.UC_ARM_REG_XPSR) >> 28

branch = "; %s yes; movs r0, #0; b end; yes: movs r0, #1; end:"
sources = {"less": "subs r0, r0, r2; sbcs r1, r3" + branch % "blt", "overflows": "adds r0, r0, r2; adcs r1, r3" + branch % "bvs",
           "rounded shift": "movs r2, #0; adds r2, #0; lsrs r0, r1; adcs r0, r2"}
for name in ("adcs", "sbcs", "lsls", "lsrs", "asrs", "rors", "cmp", "cmn", "ands", "eors", "orrs", "bics", "mvns", "muls", "tst"):
    sources[name] = f"{name} r0, r1"
code = {name: bytes(assembler.asm(text)[0]) for name, text in sources.items()}
for number, words in enumerate(code.values()):
    machine.mem_write(BASE + 64 * number, words + b"\x00\xbf")  # one place for each, Unicorn keeps what it translated
edges = [0, 1, 2, 31, 32, 33, 63, 64, 128, 255, 256, 0x1234, 0x7FFFFFFE, 0x7FFFFFFF, 0x80000000, 0x80000001, 0xDEADBEEF, 0xFFFFFFFF]
top = (1 << 63) - 1

def pair(value):
    return [value & MASK, value >> 32 & MASK]

tests = []
for a in (0, 1, 1 << 40, -1, top - 1):
    tests.append(["less", f"{a} < {top}", pair(a) + pair(top), 0])
for a, b in ((top, 1), (top, -1), (top - 1, 1), (1, top)):
    tests.append(["overflows", f"{a} + {b}", pair(a) + pair(b), 0])
for a, n in ((5, 1), (7, 2), (0x80000000, 31), (0x80000000, 0), (0xFFFFFF00, 0), (0x7FFFFF00, 0)):
    tests.append(["rounded shift", f"{a:#x} by {n}", [a, n, 0, 0], 0])
for name in list(sources)[3:]:
    for a in edges:
        for b in edges:
            for flags in (0, 2, 13, 15):
                tests.append([name, "", [a, b, 0, 0], flags])
for test in tests:
    name, text, values, flags = test
    test.append(run(name, values, flags))
    if name in ("adcs", "sbcs", "lsls", "lsrs", "asrs", "rors") and test[-1] != by_the_manual(name, *values[:2], flags):
        sys.exit("behaviour changed: unicorn does not follow the manual, " + name)
    true = {"less": lambda: int(text.split(" < ")[0]) < top, "overflows": lambda: not -top - 1 <= eval(text) <= top,
            "rounded shift": lambda: (values[0] + (1 << values[1] >> 1)) >> values[1]}
    if name in true and test[-1][0] != true[name]():
        sys.exit("behaviour changed: unicorn, " + name + " " + text)
json.dump([{name: list(text) for name, text in code.items()}, tests], open("tests.json", "w"))
PY
nice v/bin/python reference.py
cat > emulator.cjs <<'JS'
const { RP2040 } = require("rp2040js");
const [code, tests] = JSON.parse(require("fs").readFileSync("tests.json"));
const chip = new RP2040(), core = chip.core, base = 0x20000000;
function changed(what) { console.log("behaviour changed: " + what); process.exit(1); }
const wrong = {}, count = {};
for (const [name, text, values, flags, [want, wantFlags]] of tests) {
  code[name].forEach((byte, i) => chip.writeUint8(base + i, byte));
  values.forEach((value, i) => { core.registers[i] = value; });
  core.APSR = flags << 28;
  core.PC = base;
  while (core.PC !== base + code[name].length) core.executeInstruction();
  const got = core.registers[0], gotFlags = core.APSR >>> 28;
  if (text) {
    const show = name === "rounded shift" ? v => "0x" + v.toString(16) : v => v ? "true" : "false";
    console.log(`${name}, ${text}: ${show(got)}` + (got === want ? "" : `, right is ${show(want)}`));
    (wrong[name] ??= []).push(got !== want);
    continue;
  }
  count[name] = (count[name] ?? 0) + 1;
  if (got !== want) changed("a result of " + name);
  const [a, b] = values, carry = flags >> 1 & 1, shift = b & 255, bad = gotFlags ^ wantFlags;
  const inverted = name === "adcs" ? a === 0x7fffffff && carry : name === "sbcs" && b === 0x7fffffff && !carry;
  const possible = name === "lsls" ? shift > 32 : ["lsrs", "asrs", "rors"].includes(name) && shift === 0;
  if (inverted ? bad !== 1 : possible ? bad & ~2 : bad) changed(`the flags of ${name} ${a} ${b} ${flags}`);
  if (bad) wrong[name] = (wrong[name] ?? 0) + 1;
}
for (const name in count) console.log(`${name}: flags wrong in ${wrong[name] ?? 0} of ${count[name]} cases`);
if (wrong.less.join() !== "true,true,true,false,true") changed("comparisons");
if (wrong.overflows.join() !== "true,true,false,false") changed("overflow");
if (wrong["rounded shift"].join() !== "false,false,false,true,true,false") changed("shifts");
for (const name of ["adcs", "sbcs", "lsls", "lsrs", "asrs", "rors"]) if (!wrong[name]) changed("no fault in " + name);

const sio = 0xd0000000, accum0 = 0x80, accum1 = 0x84, base0 = 0x88, base1 = 0x8c, peek0 = 0xa0, peek1 = 0xa4, ctrl0 = 0xac, ctrl1 = 0xb0;
const lanes = [];
for (const [force0, force1] of [[0, 0], [1, 0], [0, 1], [2, 1]]) {
  for (const [reg, value] of [[accum0, 0x10], [accum1, 0x20], [base0, 0x100], [base1, 0x200], [ctrl0, 31 << 10 | force0 << 19],
    [ctrl1, 31 << 10 | force1 << 19]]) chip.writeUint32(sio + reg, value);
  const lane = [peek0, peek1].map(reg => (chip.readUint32(sio + reg) >>> 0).toString(16));
  console.log(`interpolator, FORCE_MSB ${force0} and ${force1}: lanes ${lane.join(" and ")}, right is ` +
    `${((force0 << 28 | 0x110) >>> 0).toString(16)} and ${((force1 << 28 | 0x220) >>> 0).toString(16)}`);
  lanes.push(lane.join());
}
if (lanes.join(" ") !== "110,220 10000110,10000220 110,220 20000110,20000220") changed("FORCE_MSB");
JS
nice node emulator.cjs
echo "as described"
