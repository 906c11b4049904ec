//! Units of hardware: what the operations of a graph come down to, sized by proven ranges. `census` counts them, `delay` times them.

use super::range::Range;

/// What an operation takes in hardware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A port or a constant.
    Nothing,
    /// Bits of other wires.
    Wires,
    /// A mask with a constant: wires, for whose outcome later gates wait a level all the same.
    Mask,
    /// Adder or subtracter, with a constant or of two wires.
    Adder {
        /// Bits in which there is a carry.
        bits: u32,
        /// Whether an operand is constant.
        constant: bool,
    },
    /// Comparator.
    Comparator {
        /// Bits in which there is a carry.
        bits: u32,
    },
    /// Multiplier of two wires with these ranges.
    Multiplier([Range; 2]),
    /// Multiplier by a constant of at least two signed digits.
    ConstantMultiplier {
        /// The constant.
        by: i64,
        /// The range of the other operand.
        operand: Range,
    },
    /// Shifter by a count on a wire.
    Shifter {
        /// Bits of the wire.
        bits: u32,
        /// Bits of the count.
        places: u32,
    },
    /// Counter of leading zeros.
    LeadingZeros {
        /// Bits of the operand.
        bits: u32,
    },
    /// Read of a table.
    Table {
        /// Entries that can be read.
        entries: u32,
    },
    /// And, or, exclusive or.
    Logic {
        /// Bits of the outcome.
        bits: u32,
    },
    /// Choice between two wires.
    Select {
        /// Bits of the outcome.
        bits: u32,
    },
}

/// Non-zero digits of a constant in canonical signed digits: rows of a multiplier by it.
pub fn signed_digits(constant: i64) -> u32 {
    let n = i128::from(constant).abs();
    // Digits of n in that form are where n and 3n differ.
    (n ^ (3 * n)).count_ones()
}
