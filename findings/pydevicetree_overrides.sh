#!/usr/bin/env bash
# pydevicetree: a board file cannot override, 010 is ten, expressions are Python's, and an alias hides paths that contain its name.
#
# Expected: a devicetree source that is right for dtc gives the same nodes and numbers in the Python library for it. In particular
#   a later "&unit { ... };" replaces values and deletes what it says. What the library cannot do, it says.
# Seen, all without a message: 1. A property that is given again keeps its first value: status stays "disabled", a clock stays at the
#   old rate. So it does with a second "/ { ... };". New properties are added. /delete-property/ and /delete-node/ in the later
#   block do nothing. The tree written by to_dts() has both values, old one first.
#   2. Octal numbers are read as decimal: 010 is 10, not 8. Expressions go to Python: (7 / 2) is 3.5, comparisons are False and True
#   with another precedence, (1 | 2 == 2) is False and not 1; (2 * (3 + 4)) are six cells: 3, "+", 4, 3, "+", 4.
#   3. If an alias has the name "uart", get_by_path("/soc/uart@100") is None: the alias is replaced wherever its letters are.
# Versions: pydevicetree 0.0.13; for comparison devicetree 0.0.2 (Zephyr's dtlib). Debian's dtc 1.6.1 agrees with dtlib.
# Why it matters: pydevicetree is SiFive's library that makes memory maps, linker scripts and headers for RISC-V soft cores. The usual form
#   of a tree is a file for the chip with units that are disabled and a file for the board that enables them and sets clocks.
#   A divider of 3.5 or a register offset of six cells gets into a header as it is.
# Source: Devicetree Specification 0.2, which the README names as what the library parses, chapter 6: C-style integers; arithmetic,
#   bitwise, logical and relational operators; previously defined nodes and properties may be deleted. NodeReference in the library:
#   "to extend the definition of a previously-defined Node". Its issue 45 (open) asks about joined lists of properties.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install pydevicetree==0.0.13 devicetree==0.0.2
cd "$T"
nice v/bin/python - <<'PY'
import sys
from devicetree import dtlib
from pydevicetree import Devicetree

def read(text):
    source = "/dts-v1/;\n" + text
    open("a.dts", "w").write(source)
    return Devicetree.from_dts(source), dtlib.DT("a.dts")

def value(tree, path, name):
    fields = tree.get_by_path(path).get_fields(name)
    return None if fields is None else list(fields)

def reference(tree, path, name):
    node = tree.get_node(path)
    return node.props[name].value if name in node.props else None

def cells(*numbers):
    return b"".join((n % 2**32).to_bytes(4, "big") for n in numbers)

# 1. Later blocks.
chip = """/ { tex: tex@1000 { status = "disabled"; clock = <1000000>; gamma; lut { size = <256>; }; }; };
"""
changes = 'status = "okay"; clock = <5000000>; fifo = <16>; /delete-property/ gamma; /delete-node/ lut;'
for title, board in (("&tex { ... };", "&tex { " + changes + " };\n"), ("a second / { ... };", "/ { tex@1000 { " + changes + " }; };\n")):
    tree, zephyr = read(chip + board)
    seen = {name: value(tree, "/tex@1000", name) for name in ("status", "clock", "gamma", "fifo")}
    right = {name: reference(zephyr, "/tex@1000", name) for name in seen}
    lut, lut_right = tree.get_by_path("/tex@1000/lut") is not None, "lut" in zephyr.get_node("/tex@1000").nodes
    print(f"{title}  pydevicetree {seen}, lut {lut}\n  dtlib {right}, lut {lut_right}")
    if right != {"status": b"okay\0", "clock": cells(5000000), "gamma": None, "fifo": cells(16)} or lut_right:
        sys.exit("behaviour changed: dtlib")
    if seen != {"status": ["disabled"], "clock": [1000000], "gamma": [], "fifo": [16]} or not lut:
        sys.exit("behaviour changed: later blocks")
written = tree.to_dts()
print("  written: " + "; ".join(line.strip(" \t;") for line in written.splitlines() if "status" in line or "clock" in line))
if written.count("status") != 2 or written.index("disabled") > written.index("okay"):
    sys.exit("behaviour changed: to_dts")
tree, zephyr = read("/ { n { p = <1>; /delete-property/ p; q = <2>; }; };")  # in the same block it does work
if value(tree, "/n", "p") is not None or reference(zephyr, "/n", "p") is not None:
    sys.exit("behaviour changed: deleting in the same block")

# 2. Numbers. The right values are worked out by hand.
for text, want, right in (("16", [16], [16]), ("0x10", [16], [16]), ("(1 << 4 + 2)", [64], [64]), ("010", [10], [8]), ("(0x10 | 010)", [26], [24]),
                          ("(7 / 2)", [3.5], [3]), ("(24000000 / 115200)", [24000000 / 115200], [208]), ("(3 < 2) (2 <= 2)", [False, True], [0, 1]),
                          ("(1 | 2 == 2)", [False], [1]), ("(4 & 6 != 0)", [True], [0]), ("(2 * (3 + 4))", [3, "+", 4, 3, "+", 4], [14])):
    tree, zephyr = read("/ { n { p = <" + text + ">; }; };")
    seen, other = value(tree, "/n", "p"), reference(zephyr, "/n", "p")
    if other != cells(*right):
        sys.exit("behaviour changed: dtlib " + text)
    print(f"<{text}>: pydevicetree {seen}, dtlib {right}")
    if seen != want or [type(v) for v in seen] != [type(v) for v in want]:
        sys.exit("behaviour changed: " + text)

# 3. Aliases.
for alias in ("console", "uart"):
    tree, zephyr = read("/ { aliases { " + alias + ' = "/soc/uart@100"; }; soc { uart@100 { p = <5>; }; }; };')
    direct, by_alias = tree.get_by_path("/soc/uart@100"), tree.get_by_path(alias)
    print(f"alias {alias}: get_by_path('/soc/uart@100') {direct and direct.get_path()}, get_by_path('{alias}') {by_alias and by_alias.get_path()}")
    if reference(zephyr, "/soc/uart@100", "p") != cells(5) or by_alias is None:
        sys.exit("behaviour changed: aliases")
    if (direct is None) != (alias == "uart"):
        sys.exit("behaviour changed: paths that contain the name of an alias")
PY
echo "as described"
