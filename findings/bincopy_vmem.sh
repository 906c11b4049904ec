#!/usr/bin/env bash
# bincopy and $readmemh: words without an address vanish, a last half word moves, and ELF and HEX give different memories.
#
# Expected: 1. A memory file for $readmemh needs no @address: its words start at the first one of the memory.
#   2. What bincopy writes as VMEM with 32-bit words, $readmemh puts where the bytes were, also the bytes
#   of a last word that is not full. 3. One program, as ELF and as Intel HEX, becomes the same VMEM file.
# Seen: 1. bincopy drops all words before the first @. A file without @ is read as nothing, no error;
#   `bincopy convert` writes an empty file and ends with status 0. 2. The last word is written
#   with fewer digits. $readmemh fills it up with zeros from the left, so its bytes 55 66 stand two places
#   behind their own. 3. With 32-bit words, addresses in HEX count words, those in ELF count bytes: of eight
#   contiguous words the second four land at word 16 when the program comes as HEX. The VMEM file is
#   legal, the words between are never set. With 8-bit words both agree.
# Versions: bincopy 20.1.1, hexrec 0.5.1, pyosys 0.70 (reads the file with $readmemh).
# Why it matters: VMEM is how a program or a texture gets into a block RAM. Hand-written and generated files
#   often have no @. Case 2 strikes only sizes that do not divide by four, so the first tests pass. In
#   case 3 the reset code still runs if it is short: the first 16 bytes are at their places.
# Source: IEEE 1364-2005, 17.2.9 "Loading memory data from a file": without addresses, loading begins at the
#   lowest address; each number is one word. Intel's HEX specification of 1988: load offsets count bytes.
#   bincopy's documentation: word_size_bits is the number of bits per word, no more.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install bincopy==20.1.1 hexrec==0.5.1 pyosys==0.70
cd "$T"
nice v/bin/python - <<'PY'
import re, struct, subprocess, sys
import bincopy, hexrec
from pyosys import libyosys as ys

def readmemh(text):
    """The memory after $readmemh, as {word: hex digits}, from the $meminit cells that Yosys makes."""
    open("m.hex", "w").write(text)
    open("m.v", "w").write('module m(input [4:0] a, output [31:0] q); reg [31:0] mem[0:31]; initial $readmemh("m.hex", mem);'
                           " assign q = mem[a]; endmodule\n")
    design = ys.Design()
    design.run_pass("tee -q read_verilog m.v; tee -q proc; tee -q write_rtlil m.il")
    words = {}
    for cell in re.findall(r"cell \$meminit_v2.*?\n  end", open("m.il").read(), re.S):
        count = int(re.search(r"WORDS (\d+)", cell)[1])
        first = int(re.search(r"ADDR (\d+)", cell)[1])
        data = re.search(r"DATA (?:\d+'([01]+)|(\d+))", cell)
        value = int(data[1], 2) if data[1] else int(data[2])
        for i in range(count):
            words[first + i] = f"{value >> 32 * i & 0xFFFFFFFF:08x}"
    return words

def memory(segments):
    """The words of a bincopy file, as {word: hex digits}."""
    data = {s.minimum_address + i: b for s in segments for i, b in enumerate(s.data)}
    return {w: "".join(f"{data[4 * w + k]:02x}" if 4 * w + k in data else "--" for k in range(4)) for w in sorted({a // 4 for a in data})}

# 1. Words before the first @.
text = "11111111 22222222\n@4 33333333\n"
right = readmemh(text)
read = bincopy.BinFile(word_size_bits=32)
read.add_verilog_vmem(text)
print(f"{text!r}\n  $readmemh: {right}\n  bincopy:   {memory(read.segments)}")
if right != {0: "11111111", 1: "22222222", 4: "33333333"} or memory(read.segments) != {4: "33333333"}:
    sys.exit("behaviour changed: words before the first @")
open("plain.hex", "w").write("11111111 22222222\n")
if readmemh("11111111 22222222\n") != {0: "11111111", 1: "22222222"}:
    sys.exit("behaviour changed: $readmemh of a file without @")
run = subprocess.run(["v/bin/bincopy", "convert", "-i", "verilog_vmem", "-o", "binary", "plain.hex", "plain.bin"],
                     capture_output=True, text=True)
size = len(open("plain.bin", "rb").read())
print(f"bincopy convert of a file without @: status {run.returncode}, {size} bytes, it says {(run.stdout + run.stderr).strip()!r}")
if run.returncode != 0 or size != 0 or "rror" in run.stdout + run.stderr:
    sys.exit("behaviour changed: a file without @")

# 2. Six bytes in 32-bit words.
part = bincopy.BinFile(word_size_bits=32)
part.add_binary(bytes.fromhex("112233445566"))
text = part.as_verilog_vmem()
got = readmemh(text)
print(f"bytes 11 22 33 44 55 66: bincopy writes {text!r}, $readmemh: {got}, the bytes are {memory(part.segments)}")
if got != {0: "11223344", 1: "00005566"} or memory(part.segments) != {0: "11223344", 1: "5566----"}:
    sys.exit("behaviour changed: a last word that is not full")

# 3. A program of 32 bytes at address 0, as ELF (RISC-V, 32 bits) and as Intel HEX.
code = b"".join(bytes([n]) * 4 for n in range(1, 9))
names = b"\0.text\0.shstrtab\0"
section = lambda name, kind, flags, offset, size: struct.pack("<10I", name, kind, flags, 0, offset, size, 0, 0, 4, 0)
elf = (b"\x7fELF\x01\x01\x01" + bytes(9) + struct.pack("<HHIIIIIHHHHHH", 2, 243, 1, 0, 52, 136, 0, 52, 32, 1, 40, 3, 2)
       + struct.pack("<8I", 1, 84, 0, 0, 32, 32, 5, 4) + code + names.ljust(20, b"\0")
       + section(0, 0, 0, 0, 0) + section(1, 1, 6, 84, 32) + section(7, 3, 0, 116, len(names)))
image = hexrec.IhexFile.from_bytes(code)
image.maxdatalen = 16
image.save("p.hex")
ihex = open("p.hex").read()
results = {}
for bits in (32, 8):
    for kind in ("ELF", "HEX"):
        program = bincopy.BinFile(word_size_bits=bits)
        program.add_elf(elf) if kind == "ELF" else program.add_ihex(ihex)
        results[kind, bits] = program.as_verilog_vmem()
        print(f"{kind}, {bits} bits: {results[kind, bits]!r}")
want = {n: f"{n + 1:02x}" * 4 for n in range(8)}
moved = {n if n < 4 else n + 12: word for n, word in want.items()}
if readmemh(results["ELF", 32]) != want or readmemh(results["HEX", 32]) != moved:
    sys.exit("behaviour changed: ELF and HEX with 32-bit words")
if results["ELF", 8].split() != results["HEX", 8].split():
    sys.exit("behaviour changed: ELF and HEX with 8-bit words")
PY
echo "as described"
