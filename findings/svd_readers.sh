#!/usr/bin/env bash
# One CMSIS-SVD file, four readers: registers at other addresses, without fields, with other values, in silence.
#
# Expected: an SVD file that is valid by the schema gives the same registers, addresses, fields and values
#   in every reader; what a reader cannot do, it says.
# Seen: svd-parser (Rust) does. cmsis-svd accepts the file with its own schemas 1.3.1 to 1.3.11, and then:
#   1. registers of a cluster in a cluster lose the outer offset: 0x14 in place of 0x54 and of 0x94, so two
#   registers have one address and one name. 2. A register with derivedFrom and no description of its
#   own gets no fields and the reset value of the device. 3. An enumerated value written 0b01 is None.
#   4. A writeConstraint from 1 to 11 is True to None. svada: 5. derivedFrom of a register is ignored, also
#   with a description: no fields, and no reset value of the model. (0b01 it refuses with an error.)
#   peakrdl-svd: 6. #10, a binary two, is 16. 7. A register with derivedFrom keeps the reset value
#   and the access of its model though it states its own.
# Versions: svd-parser 0.14.10, svd-rs 0.14.13 (cargo); cmsis-svd 0.6, svada 2.2.1, peakrdl-svd 0.1.0,
#   systemrdl-compiler 1.33.0.
# Why it matters: drivers, debugger views and register tests are made from such a file. A texture unit with
#   units and mip levels is such a nest. The wrong address is another register of the same peripheral.
#   That derivedFrom works with a description and not without one is hard to guess from a result.
# Source: CMSIS-SVD specification, "registers": addressOffset of a cluster is relative to the grouping element; nested
#   clusters since 1.3; derivedFrom: elements specified subsequently override inherited values. Schema 1.3.9,
#   description of a register: minOccurs 0; enumeratedValueDataType: 0x hexadecimal, # and 0b binary. README of
#   peakrdl-svd: nested clusters and derivedFrom of registers are among its features.
set -euo pipefail
T=$(mktemp -d)
trap 'rm -rf "$T"' EXIT
python3 -m venv "$T/v"
nice "$T/v/bin/pip" -q --disable-pip-version-check install cmsis-svd==0.6 peakrdl-svd==0.1.0 systemrdl-compiler==1.33.0 svada==2.2.1
cd "$T"
cat > tex.svd <<'XML'
<?xml version="1.0" encoding="utf-8"?>
<device schemaVersion="1.3" xmlns:xs="http://www.w3.org/2001/XMLSchema-instance" xs:noNamespaceSchemaLocation="CMSIS-SVD.xsd">
 <vendor>v</vendor><name>GPU</name><version>1.0</version><description>graphics unit</description>
 <addressUnitBits>8</addressUnitBits><width>32</width>
 <size>32</size><access>read-write</access><resetValue>0</resetValue><resetMask>0xFFFFFFFF</resetMask>
 <peripherals><peripheral>
  <name>TEX</name><description>texture unit</description><baseAddress>0x40000000</baseAddress>
  <addressBlock><offset>0</offset><size>0x1000</size><usage>registers</usage></addressBlock>
  <registers>
   <register><name>MODE</name><description>mode</description><addressOffset>0</addressOffset><resetValue>0x23</resetValue>
    <fields>
     <field><name>FORMAT</name><description>format</description><bitRange>[15:8]</bitRange>
      <enumeratedValues>
       <enumeratedValue><name>GREY</name><description>1 channel</description><value>0</value></enumeratedValue>
       <enumeratedValue><name>RGB</name><description>3 channels</description><value>0b01</value></enumeratedValue>
       <enumeratedValue><name>RGBA</name><description>4 channels</description><value>#10</value></enumeratedValue>
      </enumeratedValues></field>
     <field><name>LEVELS</name><description>levels</description><bitRange>[7:4]</bitRange>
      <writeConstraint><range><minimum>1</minimum><maximum>11</maximum></range></writeConstraint></field>
    </fields></register>
   <register derivedFrom="MODE"><name>MODE_B</name><addressOffset>4</addressOffset></register>
   <register derivedFrom="MODE"><name>MODE_C</name><description>mode when idle</description><addressOffset>8</addressOffset>
    <access>read-only</access><resetValue>0x41</resetValue></register>
   <cluster><dim>2</dim><dimIncrement>0x40</dimIncrement><name>UNIT[%s]</name><description>unit</description>
    <addressOffset>0x40</addressOffset>
    <register><name>SIZE</name><description>size</description><addressOffset>0</addressOffset>
     <fields><field><name>V</name><description>value</description><bitRange>[15:0]</bitRange></field></fields></register>
    <cluster><dim>2</dim><dimIncrement>0x10</dimIncrement><name>LEVEL[%s]</name><description>level</description>
     <addressOffset>0x10</addressOffset>
     <register><name>BASE</name><description>base</description><addressOffset>4</addressOffset>
      <fields><field><name>V</name><description>value</description><bitRange>[31:0]</bitRange></field></fields></register>
    </cluster>
   </cluster>
  </registers>
 </peripheral></peripherals>
</device>
XML
mkdir src
cat > Cargo.toml <<'TOML'
[package]
name = "reader"
version = "0.1.0"
edition = "2021"
[profile.dev]
debug = false
[dependencies]
svd-parser = { version = "=0.14.10", features = ["expand"] }
svd-rs = "=0.14.13"
TOML
cat > src/main.rs <<'RUST'
use svd_parser::{expand, expand_properties, parse, svd::RegisterInfo};

fn main() {
    let mut device = expand(&parse(&std::fs::read_to_string("tex.svd").unwrap()).unwrap()).unwrap();
    expand_properties(&mut device);
    for r in device.peripherals[0].all_registers() {
        let r: &RegisterInfo = r;
        let access = r.properties.access.unwrap().as_str();
        println!("R {} {} {} {access}", r.name, r.address_offset, r.properties.reset_value.unwrap());
        for f in r.fields() {
            println!("F {} {}", r.name, f.name);
            for v in f.enumerated_values.iter().flat_map(|e| &e.values) {
                println!("E {} {}", v.name, v.value.unwrap());
            }
        }
    }
}
RUST
CARGO_TARGET_DIR="$T/t" nice cargo run -q > rust.txt
nice v/bin/python - <<'PY'
import sys
import svd
from cmsis_svd.parser import SVD_SCHEMA_VERSIONS, SVDParser
from peakrdl_svd.importer import SVDImporter
from systemrdl import RDLCompiler
from systemrdl.node import RegNode

base = 0x40000000
right = {base + 0x40 + 0x40 * unit + 0x10 + 0x10 * level + 4 for unit in (0, 1) for level in (0, 1)}  # the four BASE registers
values = {"GREY": 0, "RGB": 1, "RGBA": 2}

def show(reader, bases, modes, enum):
    print(f"{reader}\n  BASE at {sorted(hex(a) for a in bases)}\n  " + "\n  ".join(f"{k}: {v}" for k, v in modes.items()) + f"\n  {enum}")

fields = ["FORMAT", "LEVELS"]
want = {"MODE": (fields, "0x23", "read-write"), "MODE_B": (fields, "0x23", "read-write"), "MODE_C": (fields, "0x41", "read-only")}

# svd-parser
lines = [line.split() for line in open("rust.txt")]
registers = {line[1]: line for line in lines if line[0] == "R"}
bases = [base + int(line[2]) for name, line in registers.items() if name.endswith("BASE")]
modes = {n: (sorted(line[2] for line in lines if line[:2] == ["F", n]), hex(int(registers[n][3])), registers[n][4]) for n in want}
enum = {line[1]: int(line[2]) for line in lines if line[0] == "E"}
show("svd-parser", bases, modes, enum)
if set(bases) != right or modes != want or enum != values:
    sys.exit("behaviour changed: svd-parser")

# svada; the value 0b01 is written as #01 for it
text = open("tex.svd").read()
open("tex2.svd", "w").write(text.replace("0b01", "#01"))
registers = {str(r.path): r for r in svd.parse("tex2.svd")["TEX"].register_iter(leaf_only=True)}
bases = [base + r.offset for name, r in registers.items() if name.endswith("BASE")]
modes = {n: (sorted(str(k) for k in registers[n].fields), hex(registers[n].reset_content), registers[n].access.value) for n in want}
enum = dict(registers["MODE"].fields["FORMAT"].enums)
show("svada", bases, modes, enum)
lost = {"MODE_B": ([], "0x0", "read-write"), "MODE_C": ([], "0x41", "read-only")}
if set(bases) != right or modes != want | lost or enum != values:
    sys.exit("behaviour changed: svada")
try:
    list(svd.parse("tex.svd")["TEX"].register_iter(leaf_only=True))
    sys.exit("behaviour changed: svada and 0b01")
except ValueError as error:
    print(f"  with 0b01: {error}")

# cmsis-svd
versions = [v for v in SVD_SCHEMA_VERSIONS if v.startswith("1.3")]
for version in versions:
    valid, message = SVDParser.validate_xml_file("tex.svd", schema_version=version, schema_version_detection=False)
    if not valid:
        sys.exit("behaviour changed: not valid by schema " + version + message)
tex = SVDParser.for_xml_file("tex.svd").get_device().get_peripherals()[0]
registers = {r.name: r for r in tex.get_registers()}
bases = [(r.name, base + r.address_offset) for r in tex.get_registers() if r.name.endswith("BASE")]
modes = {n: (sorted(f.name for f in registers[n].get_fields()), hex(registers[n].reset_value), registers[n].access.value)
         for n in want}
form, levels = sorted(registers["MODE"].get_fields(), key=lambda f: f.name)
enum = {e.name: e.value for e in form.enumerated_values[0].enumerated_values}
limit = levels.write_constraint.range
show(f"cmsis-svd, the file is valid by {len(versions)} schemas", [a for _, a in bases], modes, enum)
print(f"  the same names and addresses for both units: {bases}\n  LEVELS from {limit.minimum} to {limit.maximum}")
if bases != [("LEVEL[0]_BASE", base + 0x14), ("LEVEL[1]_BASE", base + 0x24)] * 2:
    sys.exit("behaviour changed: addresses of nested clusters in cmsis-svd")
if modes != want | {"MODE_B": ([], "0x0", "read-write")} or enum != values | {"RGB": None}:
    sys.exit("behaviour changed: derived registers or enumerated values in cmsis-svd")
if (limit.minimum, limit.maximum) != (True, None):
    sys.exit("behaviour changed: writeConstraint in cmsis-svd")

# peakrdl-svd
compiler = RDLCompiler()
SVDImporter(compiler).import_file("tex.svd")
registers = {n.get_path(): n for n in compiler.elaborate().top.descendants(unroll=True) if isinstance(n, RegNode)}
bases = [n.absolute_address for path, n in registers.items() if path.endswith("BASE")]
modes, enum = {}, {}
for name in want:
    parts = list(registers["GPU.TEX." + name].fields())
    reset = sum(f.get_property("reset") << f.low for f in parts)  # the bits of the fields, 0xFFF0
    modes[name] = (sorted(f.inst_name for f in parts), hex(reset), {f.get_property("sw").name for f in parts})
    enum |= {m.name: m.value for f in parts if f.get_property("encode") for m in f.get_property("encode")}
show("peakrdl-svd", bases, modes, enum)
if set(bases) != right or modes != {name: (fields, "0x20", {"rw"}) for name in want} or enum != values | {"RGBA": 16}:
    sys.exit("behaviour changed: peakrdl-svd")
PY
echo "as described"
