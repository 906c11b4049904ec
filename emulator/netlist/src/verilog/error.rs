//! Errors of designs that cannot be written.

use std::fmt;

use thiserror::Error;

use crate::graph::UnknownOutput;
use crate::interval::Violation;

/// Reasons why nothing was written.
#[derive(Debug, Error)]
pub enum VerilogError {
    /// The interval proof fails.
    #[error("the interval proof fails at {} operations, first: {}", .0.len(), .0.first().map_or_else(String::new, ToString::to_string))]
    Unproven(Vec<Violation>),
    /// One operation is deeper than the target.
    #[error(
        "{origin}: {operation} has {levels} levels, which a depth of {depth} cannot cut; the least depth of this design is {least}"
    )]
    TooDeep {
        /// Name of the operation.
        operation: &'static str,
        /// Levels of the operation.
        levels: u32,
        /// Target depth.
        depth: u32,
        /// Least depth at which no operation is too deep.
        least: u32,
        /// Source line and stage.
        origin: String,
    },
    /// An operation that is part of no stage.
    #[error("{0}: an operation outside every stage has no module")]
    OutsideBlocks(String),
    /// A table that is not in the datapath.
    #[error("{0}: a table without a name")]
    UnknownTable(String),
    /// A stage that the design does not have.
    #[error("there is no stage `{name}`; there are {}", .known.join(", "))]
    UnknownStage {
        /// Requested name.
        name: String,
        /// Modules of the design.
        known: Vec<String>,
    },
    /// An output that the design does not have.
    #[error(transparent)]
    UnknownOutput(#[from] UnknownOutput),
    /// A port of a stage's module that a field of a vector cannot hold.
    #[error(
        "port {port} has {width} bits, {fraction_bits} of them behind the binary point; a vector's field has 1 to 32, and none or more"
    )]
    NoField {
        /// Name of the port.
        port: String,
        /// Bits of the port.
        width: u32,
        /// Bits after its binary point.
        fraction_bits: i32,
    },
    /// A failure to format the text.
    #[error("cannot format the text")]
    Format(#[from] fmt::Error),
}
