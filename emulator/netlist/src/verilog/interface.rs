//! Ports of the written modules, as the manifest lists them.

use serde::Serialize;

use super::format::Format;

/// A port of the top.
#[derive(Clone, Debug, Serialize)]
pub struct PortDescription {
    /// Path in the bundle: `normal.mantissa[0]`.
    pub name: String,
    /// Name in Verilog.
    pub port: String,
    /// Bits.
    pub width: u32,
    /// True if the top bit is a sign.
    pub signed: bool,
    /// Binary point: value = integer / 2^fraction_bits, with the dropped zeros in the integer.
    pub fraction_bits: u32,
    /// Constant low zeros without a wire: the port carries `integer >> dropped_zeros`.
    pub dropped_zeros: u32,
    /// Smallest integer.
    pub low: i64,
    /// Largest integer.
    pub high: i64,
    /// Format of the port.
    #[serde(skip)]
    pub format: Format,
    /// Place among the ports or the outputs of the design, whose integers a testbench takes.
    #[serde(skip)]
    pub place: usize,
}

impl PortDescription {
    pub(super) fn new(name: &str, port: &str, format: Format, [low, high]: [i64; 2], place: usize) -> Self {
        Self {
            name: name.to_owned(),
            port: port.to_owned(),
            width: format.width(),
            signed: format.signed(),
            fraction_bits: format.fraction_bits,
            dropped_zeros: format.zeros,
            low,
            high,
            format,
            place,
        }
    }
}

/// Ports of a pipelined module. In addition it has `clk`, `rst` and the handshake `in_valid`, `in_ready`, `out_valid`, `out_ready`.
#[derive(Clone, Debug, Serialize)]
pub struct Interface {
    /// Name of the module.
    pub module: String,
    /// Cycles from an accepted input to its output.
    pub latency: u32,
    /// Inputs in the order of their bundle; an input that no stage reads has no port.
    pub inputs: Vec<PortDescription>,
    /// Outputs in the order of the pipeline; a constant has no port.
    pub outputs: Vec<PortDescription>,
}
