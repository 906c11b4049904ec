//! Description of a shell: its modules, words and registers.

use serde::Serialize;

use super::super::interface::{Interface, PortDescription, places, total_bits};
use super::super::stepper::LAST;
use super::super::value::literal;
use super::register::{Register, map};

/// Widths of a stream's words, bits.
pub const STREAM_BITS: std::ops::RangeInclusive<u32> = 8..=1024;

/// A shell around a design.
#[derive(Clone, Debug, Serialize)]
pub struct Shell {
    /// Name of the outermost module: both streams and the registers.
    pub module: String,
    /// Name of the module with the streams alone, whose constants are ports.
    pub axis: String,
    /// Name of the module that drives the shell and has the ports of the design.
    pub bfm: String,
    /// Bits of a word.
    pub stream_bits: u32,
    /// Words of a fragment.
    pub input_words: u32,
    /// Words of its outcome.
    pub output_words: u32,
    /// Frequency in the constraints, MHz.
    pub clock_mhz: f64,
    /// Inputs of a fragment, from the most significant bit of its words down, by their names in the manifest.
    pub inputs: Vec<String>,
    /// Registers in the order of their offsets.
    pub registers: Vec<Register>,
    /// Interface of the module that drives the shell: testbenches of the design take it instead of the design.
    #[serde(skip)]
    pub driven: Interface,
    /// The design.
    #[serde(skip)]
    pub(super) design: Interface,
    /// Design, profile and effects in a sentence.
    #[serde(skip)]
    pub(super) origin: String,
    /// True if an outcome waits in a register before it becomes words. A pipeline moves as a whole, so that its enable must not depend on a word.
    #[serde(skip)]
    pub(super) waits: bool,
    /// Release of the generator, for files that have a version.
    #[serde(skip)]
    pub(super) version: &'static str,
}

/// A part of a vector, `vector[high:low]`, of one bit `vector[low]`.
pub(super) fn slice(vector: &str, low: u32, width: u32) -> String {
    if width == 1 { format!("{vector}[{low}]") } else { format!("{vector}[{}:{low}]", low + width - 1) }
}

/// Connections of ports to bits of a vector, first port most significant.
pub(super) fn connections(ports: &[PortDescription], vector: &str) -> String {
    places(ports).map(|(port, low)| format!(",\n    .{}({})", port.port, slice(vector, low, port.width))).collect()
}

/// An expression with zeros above it.
pub(super) fn padded(expression: &str, bits: u32, width: u32) -> String {
    if bits == width { expression.to_owned() } else { format!("{{{}, {expression}}}", literal(0, width - bits)) }
}

impl Shell {
    /// The shell of a design with words of `stream_bits`. `text` is the Verilog of the design, whose hash is in a register; a pipeline takes a fragment
    /// each cycle.
    pub(crate) fn new(
        design: &Interface,
        is_pipeline: bool,
        text: &str,
        stream_bits: u32,
        clock_mhz: f64,
        origin: &str,
    ) -> Self {
        let mut design = design.clone();
        // A packet has at least a word: a design of constants alone takes them from the stream.
        if design.inputs.iter().all(|port| port.constant) {
            design.inputs.iter_mut().for_each(|port| port.constant = false);
        }
        let words = |ports: &[PortDescription]| total_bits(ports).div_ceil(stream_bits).max(1);
        let streamed: Vec<_> = design.inputs.iter().filter(|port| !port.constant).cloned().collect();
        let (input_words, output_words) = (words(&streamed), words(&design.outputs));
        let registers = map(&design, text);
        let name = |suffix: &str| format!("{}_{suffix}", design.module);
        // A register is written in a few cycles while the words of a fragment come.
        let latency = design.latency + 2 * (input_words + output_words) + 8 * registers.len() as u32;
        Self {
            module: name("shell"),
            axis: name("axis"),
            bfm: name("bfm"),
            stream_bits,
            input_words,
            output_words,
            clock_mhz,
            inputs: streamed.iter().map(|port| port.name.clone()).collect(),
            registers,
            driven: Interface { module: name("bfm"), latency, ..design.clone() },
            // With one word to an outcome it would halve the rate.
            waits: is_pipeline && output_words > 1,
            design,
            origin: origin.to_owned(),
            version: env!("CARGO_PKG_VERSION"),
        }
    }

    /// Packets of the streams in a sentence.
    pub(super) fn packets(&self) -> String {
        let words = |count: u32| if count == 1 { "1 word".to_owned() } else { format!("{count} words") };
        let (input, output, bits) = (words(self.input_words), words(self.output_words), self.stream_bits);
        if self.design.outputs.iter().any(|port| port.name == LAST) {
            let last = "is 1 in the last probe";
            return format!(
                "A footprint is {input} of {bits} bits, each of its probes a packet of {output}. Output `{LAST}` {last}."
            );
        }
        format!("A fragment is {input} of {bits} bits, its outcome {output}.")
    }

    /// Inputs that come with each fragment.
    pub(super) fn streamed(&self) -> Vec<PortDescription> {
        self.design.inputs.iter().filter(|port| !port.constant).cloned().collect()
    }

    /// Inputs that registers hold.
    pub(super) fn constants(&self) -> Vec<PortDescription> {
        self.design.inputs.iter().filter(|port| port.constant).cloned().collect()
    }
}
