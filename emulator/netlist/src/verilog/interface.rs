//! Ports of the written modules, as the manifest lists them.

use roughxel_core::bundle::{Step, is_constant};
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
    /// True for an input that keeps its value for all fragments of an object: a shell has a register for it.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub constant: bool,
    /// Meaning of the port, as its bundles declare it; empty if they do not.
    #[serde(skip)]
    pub text: String,
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
            constant: false,
            text: String::new(),
            format,
            place,
        }
    }

    /// The port as the fields on a path declare it.
    pub(super) fn declared(self, path: &[Step]) -> Self {
        let texts = path.iter().filter_map(|step| match step {
            Step::Field(field) => Some(field.text.trim().trim_end_matches('.')),
            Step::Index(_) => None,
        });
        let mut said: Vec<&str> = Vec::new();
        for text in texts {
            // A text that begins with the one before it says it again.
            said.pop_if(|before| text.starts_with(&**before));
            said.push(text);
        }
        Self { constant: is_constant(path), text: said.join(": "), ..self }
    }
}

/// Bits of all ports together.
pub(crate) fn total_bits(ports: &[PortDescription]) -> u32 {
    ports.iter().map(|port| port.width).sum()
}

/// Ports with the place of their lowest bit in one vector, first port most significant.
pub(crate) fn places(ports: &[PortDescription]) -> impl Iterator<Item = (&PortDescription, u32)> {
    let mut above = total_bits(ports);
    ports.iter().map(move |port| {
        above -= port.width;
        (port, above)
    })
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
