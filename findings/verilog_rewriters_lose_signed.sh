#!/usr/bin/env bash
# Two Python rewriters of Verilog change signed arithmetic to unsigned.
#
# Expected: parsing a module and writing it out again keeps what it computes.
# Seen: (1) In "input signed [7:0] a, b" both ports are signed; b takes over
#   what stands before a. Pyverilog keeps the direction and the width for b,
#   but not "signed". One unsigned operand makes the whole product unsigned:
#   -3 * -5 gives -2033 in 16 bits instead of 15.
#   (2) hdlConvertor drops the s of a based literal: -8'sd3 becomes -8'd3. So
#   a * -8'sd3 turns unsigned as well: -5 gives -753 instead of 15.
#   Neither prints a warning, and the results are good Verilog.
# Versions: pyverilog 1.3.0; hdlConvertor-binary 2.3 with hdlConvertorAst 1.2;
#   Yosys 0.70 (pyosys) computes the modules before and after.
# Why it matters: both are used to instrument, split or rename generated RTL.
#   A datapath of signed normals passes lint and fails only on negative input.
# Source: IEEE 1364-2005, 12.3.4 (list_of_port_declarations: names that follow
#   share the declaration) and 5.5.1 (rules for signed expressions).
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install pyverilog==1.3.0 ply==3.11 jinja2==3.1.6 \
  hdlConvertor-binary==2.3 hdlConvertorAst==1.2 pyosys==0.70
cd "$T"
cat > ports.v <<'V'
module ports(input signed [7:0] a, b, output signed [15:0] y);
  assign y = a * b;
endmodule
V
cat > literal.v <<'V'
module literal(input signed [7:0] a, output signed [15:0] y);
  assign y = a * -8'sd3;
endmodule
V
cat > rewrite.py <<'PY'
import io, re, sys
from pyverilog.ast_code_generator.codegen import ASTCodeGenerator
from pyverilog.vparser.parser import VerilogParser
from hdlConvertor import HdlConvertor
from hdlConvertorAst.language import Language
from hdlConvertorAst.to.verilog.verilog2005 import ToVerilog2005
import pyosys.libyosys as ys

ast = VerilogParser(outputdir=".").parse(open("ports.v").read())
open("ports_out.v", "w").write(ASTCodeGenerator().visit(ast))
ctx = HdlConvertor().parse(["literal.v"], Language.VERILOG, [], hierarchyOnly=False, debug=False)
out = io.StringIO()
ToVerilog2005(out).visit_HdlContext(ctx)
open("literal_out.v", "w").write(out.getvalue())

def compute(path, top, sets):
    d = ys.Design()
    args = " ".join(f"-set {n} 8'd{v & 255}" for n, v in sets.items())
    open("run.ys", "w").write(f"read_verilog {path}\nproc\ntee -q -o eval.txt eval {args} -show y {top}\n")
    ys.run_pass("tee -q -o log.txt script run.ys", d)
    v = int(re.search(r"\\y = 16'([01]+)", open("eval.txt").read()).group(1), 2)
    return v - 65536 if v & 32768 else v

tidy = lambda s: " ".join(s.split())
print("pyverilog:   ", tidy(open("ports_out.v").read()))
print("hdlConvertor:", tidy(open("literal_out.v").read()))
p = [compute(f, "ports", {"a": -3, "b": -5}) for f in ("ports.v", "ports_out.v")]
l = [compute(f, "literal", {"a": -5}) for f in ("literal.v", "literal_out.v")]
print(f"-3 * -5:   {p[0]} before pyverilog, {p[1]} after")
print(f"-5 * -8'sd3: {l[0]} before hdlConvertor, {l[1]} after")
if p != [15, -2033] or l != [15, -753]:
    sys.exit("behaviour changed: a rewriter keeps the sign now, or loses something else")
PY
nice v/bin/python rewrite.py 2> err.txt || { cat err.txt; exit 1; }
echo "as described"
