#!/usr/bin/env bash
# LiteX runs a Verilator simulation that fails, and its program ends as if it
# had passed.
#
# Expected: builder.build(run=True) raises, or the Python program ends with the
#   status of the simulation.
# Seen: the call of the simulation stands in a bare "except: pass". A Verilator
#   program that ends with status 3 ($fatal, an assertion, an abort) gives None
#   and no message. With interactive=False there is not even a warning.
#   A missing program is no error either: the shell's status is dropped alike.
# Versions: litex 2024.12, migen 0.10.0.
# Why it matters: a testbench that says its verdict by the exit status, as all
#   others of this field do, is green in CI whatever it found. The verdict has
#   to be read from what the simulation printed.
# Source: litex/build/sim/verilator.py of the package.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install litex==2024.12 migen==0.10.0 setuptools==75.8.0
cd "$T"
mkdir obj_dir
cat > run.py <<'PY'
import os, stat, sys
from litex.build.sim.verilator import _run_sim

def outcome(program):
    path = "obj_dir/Vsim"
    if os.path.exists(path):
        os.remove(path)
    if program is not None:
        with open(path, "w") as file:
            file.write(program)
        os.chmod(path, os.stat(path).st_mode | stat.S_IEXEC)
    try:
        return repr(_run_sim("sim", interactive=False))
    except BaseException as error:
        return f"raises {type(error).__name__}"

# The program stands for one that Verilator made.
seen = {name: outcome(program) for name, program in [
    ("passes", "#!/bin/sh\nexit 0\n"),
    ("fails with status 3", "#!/bin/sh\nexit 3\n"),
    ("is not there", None),
]}
for name, result in seen.items():
    print(f"a simulation that {name}: {result}")
if set(seen.values()) != {"None"}:
    sys.exit("behaviour changed: a failed simulation is seen now")
PY
nice v/bin/python -W ignore run.py
echo "as described"
