//! Units of float32 for comparison: add, multiply, divide and square root of the package `zkf`, which is Verilog under the Apache licence.
//!
//! The units round to nearest and have no NaN and no subnormal numbers, so units of all of IEEE 754 are larger. Each takes operands every cycle.

use std::collections::BTreeMap;
use std::fs;

use roughxel_netlist::target::Target;

use super::cell::hash;
use super::device::Device;
use super::place::{self, Wish};
use super::results::FloatUnit;
use super::tools::{folder, installed};
use super::yosys::{self, Yosys};

/// A unit.
#[derive(Clone, Copy, Debug)]
pub struct Unit {
    /// Name in results: the operation.
    pub name: &'static str,
    /// Module of the package.
    module: &'static str,
    /// Its parameters besides the format: registers in every place that the package offers for one.
    parameters: &'static str,
    /// Connections besides operands a and b.
    connections: &'static str,
    /// Cycles to the result.
    latency: u32,
}

/// Every unit.
pub const UNITS: [Unit; 4] = [
    Unit {
        name: "add",
        module: "zkf_add",
        parameters: ".STAGE_INPUT(1), .STAGE_DECODE(1), .STAGE_ALIGN(1), .STAGE_NORMALIZE(1), .STAGE_PACK(1), .STAGE_OUTPUT(1)",
        connections: "",
        latency: 10,
    },
    Unit {
        name: "mul",
        module: "zkf_mul",
        parameters: ".WMULTIPLIER(18), .STAGE_INPUT(1), .STAGE_PRODUCT(2), .STAGE_PACK(1), .STAGE_OUTPUT(1)",
        connections: "",
        latency: 6,
    },
    Unit {
        name: "div",
        module: "zkf_divsqrt",
        parameters: ".MODE(0), .STAGE_INPUT(1), .STAGE_DECODE(1), .STAGE_PACK(1), .STAGE_OUTPUT(1)",
        connections: ", .op_sqrt(1'b0), .error()",
        latency: 15,
    },
    Unit {
        name: "sqrt",
        module: "zkf_divsqrt",
        parameters: ".MODE(1), .STAGE_INPUT(1), .STAGE_DECODE(1), .STAGE_PACK(1), .STAGE_OUTPUT(1)",
        connections: ", .op_sqrt(1'b1), .error()",
        latency: 15,
    },
];

impl Unit {
    /// Module `float_NAME` with the latency as a parameter, which the package checks.
    fn wrapper(&self) -> String {
        let Self { name, module, parameters, connections, latency } = self;
        format!(
            "module float_{name} (input wire clk, input wire rst, input wire in_valid, input wire [31:0] a, input wire [31:0] b,\n  \
             output wire out_valid, output wire [31:0] y);\n  \
             {module} #(.WEXP(8), .WMAN(24), {parameters}, .LATENCY({latency})) u (\n    \
             .clk(clk), .rst(rst), .in_valid(in_valid), .a(a), .b(b), .out_valid(out_valid), .y(y){connections});\nendmodule\n"
        )
    }
}

/// Synthesises a unit for ECP5 and places it on the smallest device. `None` if `known` is the outcome.
///
/// Errors: a tool is missing or fails.
pub fn measure(yosys: &Yosys, unit: &Unit, wish: Wish, known: Option<&FloatUnit>) -> Result<Option<FloatUnit>, String> {
    let source = installed("zkf")?;
    let sources = folder().join("tools/zkf/rtl");
    let entries = fs::read_dir(&sources).map_err(|e| format!("{}: {e}", sources.display()))?;
    let mut files = BTreeMap::new();
    for path in entries.flatten().map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|e| e == "v")) {
        let text = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        files.insert(path.file_name().unwrap_or_default().to_string_lossy().into_owned(), text);
    }
    let module = format!("float_{}", unit.name);
    files.insert(format!("{module}.v"), unit.wrapper());
    let parts: Vec<&str> = files.iter().flat_map(|(name, text)| [name.as_str(), text]).collect();
    let key = yosys::key(yosys, &hash(&parts), &module, Target::Ecp5)?;
    let device = Device::by_name("LFE5U-25F").ok_or("LFE5U-25F is no device of the list")?;
    let version = wish.program(device)?.version;
    let key_of_placement = place::key(&key, &version, device, wish.seed);
    if known.is_some_and(|known| known.key == key && known.placement.key == key_of_placement) {
        return Ok(None);
    }
    let (folder, area) = yosys::synthesise(yosys, &key, &files.iter().collect::<Vec<_>>(), &module, Target::Ecp5)?;
    let placement = place::place(&folder, &key, device, wish)?;
    Ok(Some(FloatUnit { latency: unit.latency, tools: format!("{source}, {}", yosys.version), key, area, placement }))
}
