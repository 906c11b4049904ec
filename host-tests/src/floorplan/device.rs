//! Devices on which designs are placed, and names of the cells of their families.

use roughxel_netlist::target::Target;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A device that nextpnr knows.
#[derive(Clone, Copy, Debug)]
pub struct Device {
    /// Name in options and results.
    pub name: &'static str,
    /// Family.
    pub target: Target,
    /// Program that places and routes. Its Python package is `yowasp-PROGRAM`.
    pub program: &'static str,
    /// Options that select device, package and speed grade.
    pub options: &'static [&'static str],
    /// Clock that the placer aims at, MHz.
    pub aim: &'static str,
    /// Family and package as Apycula names them, if the program places no pins itself.
    pub pins: Option<[&'static str; 2]>,
}

/// Every device, the smallest of a family first.
pub const DEVICES: [Device; 5] = [
    Device {
        name: "LFE5U-25F",
        target: Target::Ecp5,
        program: "nextpnr-ecp5",
        options: &["--25k", "--package", "CABGA256", "--speed", "6", "--lpf-allow-unconstrained"],
        aim: "100",
        pins: None,
    },
    Device {
        name: "LFE5U-45F",
        target: Target::Ecp5,
        program: "nextpnr-ecp5",
        options: &["--45k", "--package", "CABGA256", "--speed", "6", "--lpf-allow-unconstrained"],
        aim: "100",
        pins: None,
    },
    Device {
        name: "LFE5U-85F",
        target: Target::Ecp5,
        program: "nextpnr-ecp5",
        options: &["--85k", "--package", "CABGA381", "--speed", "6", "--lpf-allow-unconstrained"],
        aim: "100",
        pins: None,
    },
    Device {
        name: "iCE40UP5K",
        target: Target::Ice40,
        program: "nextpnr-ice40",
        options: &["--up5k", "--package", "sg48", "--pcf-allow-unconstrained"],
        aim: "24",
        pins: None,
    },
    Device {
        name: "GW2A-18",
        target: Target::Gowin,
        program: "nextpnr-himbaechel-gowin",
        options: &["--device", "GW2A-LV18PG256C8/I7", "--vopt", "family=GW2A-18", "--vopt", "cst=pins.cst"],
        aim: "100",
        pins: Some(["GW2A-18", "PBGA256"]),
    },
];

impl Device {
    /// Device of a name.
    pub fn by_name(name: &str) -> Option<&'static Self> {
        DEVICES.iter().find(|device| device.name == name)
    }
}

/// Bits of a word of the stream around a design. iCE40UP5K has 39 pins in its package, other devices some 200.
pub const fn stream_bits(target: Target) -> u32 {
    match target {
        Target::Ice40 => 8,
        _ => 32,
    }
}

/// Command of Yosys that synthesises a module for a family, without its name. `None` for gates.
pub const fn synthesis(target: Target) -> Option<&'static str> {
    match target {
        Target::Asic => None,
        Target::Ice40 => Some("synth_ice40 -dsp"),
        Target::Ecp5 => Some("synth_ecp5"),
        Target::Gowin => Some("synth_gowin -family gw2a"),
        Target::Xc7 => Some("synth_xilinx -family xc7 -flatten"),
    }
}

/// Names of a family's cells: lookup tables, carry cells, multipliers, memories in lookup tables, memory blocks, registers. A name is the beginning
/// of one.
pub const fn cell_names(target: Target) -> [&'static [&'static str]; 6] {
    match target {
        Target::Asic => [&[]; 6],
        Target::Ice40 => [&["SB_LUT4"], &["SB_CARRY"], &["SB_MAC16"], &[], &["SB_RAM40"], &["SB_DFF"]],
        Target::Ecp5 => [&["LUT4"], &["CCU2C"], &["MULT18X18D"], &["TRELLIS_DPR16X4"], &["DP16KD"], &["TRELLIS_FF"]],
        Target::Gowin => [&["LUT"], &["ALU"], &["MULT"], &["RAM16"], &["SDP", "DP", "SP", "pROM"], &["DFF"]],
        Target::Xc7 => [&["LUT"], &["CARRY4"], &["DSP48E1"], &["RAM16", "RAM32", "RAM64", "SRL"], &["RAMB"], &["FD"]],
    }
}

/// Cells of a netlist.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Area {
    /// Lookup tables.
    pub luts: u64,
    /// Carry cells: 1 bit on iCE40 and Gowin, 2 on ECP5, 4 on 7 series.
    pub carries: u64,
    /// Multiplier blocks.
    pub multipliers: u64,
    /// Memories and shift registers in lookup tables.
    pub memories: u64,
    /// Memory blocks.
    pub blocks: u64,
    /// Registers.
    pub registers: u64,
}

impl Area {
    /// Reads the output of `stat -json`. `None` if it has no cells.
    pub fn read(statistics: &Value, target: Target) -> Option<Self> {
        let cells = statistics["design"]["num_cells_by_type"].as_object()?;
        let [luts, carries, multipliers, memories, blocks, registers] = cell_names(target).map(|names| {
            let named = cells.iter().filter(|(name, _)| names.iter().any(|wanted| name.starts_with(wanted)));
            named.filter_map(|(_, count)| count.as_u64()).sum()
        });
        Some(Self { luts, carries, multipliers, memories, blocks, registers })
    }
}
