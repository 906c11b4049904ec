"""Gives each port of the top in netlist.json a pin of a Gowin package and writes pins.cst: nextpnr places no pins of this family itself.

Arguments: family and package, as Apycula names them. The clock is on a clock pin, other ports are on pins without a second function.
"""

import json, os, sys
import apycula
from apycula import chipdb
family, package = sys.argv[1:3]
pins = chipdb.load_chipdb(os.path.join(os.path.dirname(apycula.__file__), family + ".msgpack.xz")).pinout[family][package]
clocks = [pin for pin, (_, functions) in sorted(pins.items()) if any(name.startswith("GCLKT") for name in functions)]
others = [pin for pin, (_, functions) in sorted(pins.items()) if not functions]
modules = json.load(open("netlist.json"))["modules"].values()
top = next(module for module in modules if int(module["attributes"].get("top", "0"), 2))
with open("pins.cst", "w") as file:
    for name, port in top["ports"].items():
        bits = [name] if len(port["bits"]) == 1 else [f"{name}[{i}]" for i in range(len(port["bits"]))]
        for bit in bits:
            print(f'IO_LOC "{bit}" {(clocks if name == "aclk" else others).pop()};', file=file)
