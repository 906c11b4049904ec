//! Testbenches of generated Verilog: vectors as packed words, and the files that the two committed testbenches read.
//!
//! `vectors/hdl/bench.v` (Icarus and other event simulators) and `vectors/hdl/verilator_bench.cpp` (Verilator) drive any pipelined module through a
//! wrapper with one vector in and one out. Fields are packed most significant first, each exactly as wide as its port.

use std::fmt::Write as _;

use thiserror::Error;

use super::verilog::{Interface, PortDescription, places, total_bits};

/// The testbench for event simulators, which reads the files of a [`Bench`].
pub const BENCH: (&str, &str) = ("bench.v", include_str!("../../../vectors/hdl/bench.v"));

/// The test for cocotb, which reads them too and drives the shell by its buses.
pub const SHELL_TEST: (&str, &str) = ("test_shell.py", include_str!("../../../vectors/templates/shell/test_shell.py"));

/// Vectors for a pipelined module.
#[derive(Clone, Debug)]
pub struct Bench<'a> {
    interface: &'a Interface,
    inputs: Vec<Vec<u32>>,
    outputs: Vec<Vec<u32>>,
}

/// Reasons why no testbench is made.
#[derive(Debug, Error)]
pub enum BenchError {
    /// An integer a port cannot hold.
    #[error("vector {vector}: {value} does not fit {port}")]
    DoesNotFit {
        /// Index of the vector.
        vector: usize,
        /// Name of the port.
        port: String,
        /// The integer.
        value: i64,
    },
    /// Fewer integers than the design has ports.
    #[error("vector {vector} has no integer for {port}")]
    Missing {
        /// Index of the vector.
        vector: usize,
        /// Name of the port.
        port: String,
    },
}

/// Integers as one packed word, 32 bits an element, least significant first.
fn pack(ports: &[PortDescription], vector: usize, values: &[i64]) -> Result<Vec<u32>, BenchError> {
    let mut word = vec![0; total_bits(ports).div_ceil(32) as usize];
    for (port, lsb) in places(ports) {
        let missing = BenchError::Missing { vector, port: port.port.clone() };
        let value = *values.get(port.place).ok_or(missing)?;
        let fits = port.format.pack(value);
        let bits = fits.ok_or_else(|| BenchError::DoesNotFit { vector, port: port.port.clone(), value })?;
        for bit in (0..port.width).filter(|bit| bits >> bit & 1 == 1) {
            word[((lsb + bit) / 32) as usize] |= 1 << ((lsb + bit) % 32);
        }
    }
    Ok(word)
}

fn pack_all(ports: &[PortDescription], vectors: &[Vec<i64>]) -> Result<Vec<Vec<u32>>, BenchError> {
    vectors.iter().enumerate().map(|(index, values)| pack(ports, index, values)).collect()
}

impl<'a> Bench<'a> {
    /// Packs the integers of the module's ports. `inputs` holds one vector an input, over all inputs of the design; `outputs` one an outcome, over
    /// all outputs.
    ///
    /// Errors: a vector has too few integers, or an integer leaves its port.
    pub fn new(interface: &'a Interface, inputs: &[Vec<i64>], outputs: &[Vec<i64>]) -> Result<Self, BenchError> {
        let (inputs, outputs) = (pack_all(&interface.inputs, inputs)?, pack_all(&interface.outputs, outputs)?);
        Ok(Self { interface, inputs, outputs })
    }

    /// Returns the name of the driven module.
    pub fn module(&self) -> &str {
        &self.interface.module
    }

    /// Files, name and content: the wrapper `MODULE_flat.v`, `bench.vh` for `bench.v`, `bench.txt` for `verilator_bench.cpp`, and the words as
    /// `inputs.hex`, `expected.hex`, `inputs.bin`, `expected.bin`.
    pub fn files(&self) -> Vec<(String, Vec<u8>)> {
        let mut files = vec![
            (format!("{}_flat.v", self.interface.module), flat(self.interface).into_bytes()),
            ("bench.vh".to_owned(), self.definitions().into_bytes()),
            ("bench.txt".to_owned(), self.description().into_bytes()),
        ];
        let words =
            [("inputs", &self.inputs, &self.interface.inputs), ("expected", &self.outputs, &self.interface.outputs)];
        for (name, words, ports) in words {
            files.push((format!("{name}.hex"), hex(words, total_bits(ports)).into_bytes()));
            let bytes = words.iter().flatten().flat_map(|word| word.to_le_bytes()).collect();
            files.push((format!("{name}.bin"), bytes));
        }
        files
    }

    /// Sizes, and the names of the wires for the report of the first mismatch.
    fn definitions(&self) -> String {
        let Interface { module, latency, inputs, outputs } = self.interface;
        let mut text = format!(
            "`define FLAT {module}_flat\n`define LATENCY {latency}\n`define IN_BITS {}\n`define OUT_BITS {}\n\
             `define INPUTS {}\n`define OUTPUTS {}\n`define EXPLAIN \\\n",
            total_bits(inputs),
            total_bits(outputs),
            self.inputs.len(),
            self.outputs.len()
        );
        for (port, lsb) in places(outputs) {
            let slice = format!("[{}:{lsb}]", lsb + port.width - 1);
            let name = &port.name;
            let _ = writeln!(
                text,
                "  if (!found && got{slice} !== wanted{slice}) begin found = 1; \
                 $display(\"vector %0d: {name} is %h, expected %h\", index, got{slice}, wanted{slice}); end \\"
            );
        }
        text + "\n"
    }

    /// Sizes, then one line an output field: name, lowest bit, width.
    fn description(&self) -> String {
        let Interface { inputs, outputs, .. } = self.interface;
        let mut text =
            format!("{} {}\n{} {}\n", total_bits(inputs), self.inputs.len(), total_bits(outputs), self.outputs.len());
        for (port, lsb) in places(outputs) {
            let _ = writeln!(text, "{} {lsb} {}", port.name, port.width);
        }
        text
    }
}

/// Words for `$readmemh`, one a line.
fn hex(words: &[Vec<u32>], bits: u32) -> String {
    let digits = bits.div_ceil(4) as usize;
    let mut text = String::with_capacity(words.len() * (digits + 1));
    for word in words {
        let all = word.iter().rev().fold(String::new(), |all, part| all + &format!("{part:08x}"));
        text += &all[all.len() - digits..];
        text.push('\n');
    }
    text
}

/// Wrapper of a module with all inputs as one vector and all outputs as another, fields most significant first.
pub fn flat(interface: &Interface) -> String {
    let Interface { module, inputs, outputs, .. } = interface;
    let mut connections: Vec<String> =
        ["clk", "rst", "in_valid", "in_ready", "out_valid", "out_ready"].map(|name| format!(".{name}({name})")).into();
    for (ports, bits) in [(inputs, "in_bits"), (outputs, "out_bits")] {
        let whole = total_bits(ports) == 1;
        connections.extend(places(ports).map(|(port, lsb)| match port.width {
            _ if whole => format!(".{}({bits})", port.port),
            1 => format!(".{}({bits}[{lsb}])", port.port),
            width => format!(".{}({bits}[{}:{lsb}])", port.port, lsb + width - 1),
        }));
    }
    let vector = |bits: u32| if bits == 1 { String::new() } else { format!("[{}:0] ", bits - 1) };
    format!(
        "// {module}_flat\n//\n// {module} with its inputs and its outputs packed, first port most significant.\n\n\
         `default_nettype none\n\n\
         module {module}_flat (\n  input  wire clk,\n  input  wire rst,\n  input  wire in_valid,\n  output wire in_ready,\n  \
         input  wire {}in_bits,\n  output wire out_valid,\n  input  wire out_ready,\n  output wire {}out_bits\n);\n\n  \
         {module} u_{module} (\n    {}\n  );\n\nendmodule\n\n`default_nettype wire\n",
        vector(total_bits(inputs)),
        vector(total_bits(outputs)),
        connections.join(",\n    ")
    )
}
