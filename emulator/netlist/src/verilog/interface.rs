//! The ports of what is written, as its manifest lists them.

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
    /// Whether the top bit is a sign.
    pub signed: bool,
    /// Binary point: value = integer / 2^fraction_bits, of the integer with its dropped zeros.
    pub fraction_bits: u32,
    /// Constant low zeros without a wire: the port carries `integer >> dropped_zeros`.
    pub dropped_zeros: u32,
    /// Smallest integer.
    pub low: i64,
    /// Largest integer.
    pub high: i64,
    /// The same as a format.
    #[serde(skip)]
    pub format: Format,
    /// Place among the ports or the outputs of the design, whose integers a bench takes.
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

/// The ports of a pipelined module. Beside these it has `clk`, `rst` and the handshake `in_valid`, `in_ready`,
/// `out_valid`, `out_ready`.
#[derive(Clone, Debug, Serialize)]
pub struct Interface {
    /// Name of the module.
    pub module: String,
    /// Cycles from an accepted input to its output.
    pub latency: u32,
    /// Inputs in the order of their bundle; what no stage reads has no port.
    pub inputs: Vec<PortDescription>,
    /// Outputs in the order of the pipeline; a constant has no port.
    pub outputs: Vec<PortDescription>,
}
