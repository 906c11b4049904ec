//! Units of hardware that the operations of a netlist need, sized by proven ranges. `census` counts them, `delay` times them.

use super::range::Range;

/// Hardware of an operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A port or a constant.
    Nothing,
    /// Bits of other wires.
    Wires,
    /// A mask with a constant: wires, but later gates still wait one level for its outcome.
    Mask,
    /// Adder or subtracter, with a constant or of two wires.
    Adder {
        /// Bits with a carry.
        bits: u32,
        /// True if an operand is constant.
        constant: bool,
    },
    /// Comparator.
    Comparator {
        /// Bits with a carry.
        bits: u32,
    },
    /// Multiplier of two wires with these ranges.
    Multiplier([Range; 2]),
    /// Multiplier by a constant of at least two signed digits.
    ConstantMultiplier {
        /// The constant.
        by: i64,
        /// Range of the other operand.
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
    // Non-zero digits are at the bits in which n and 3n differ.
    (n ^ (3 * n)).count_ones()
}

/// Canonical signed digits of a constant, lowest first: it is the sum of ±2^k; true for a minus sign.
pub fn signed_powers(constant: i64) -> Vec<(bool, u32)> {
    let (n, triple) = (i128::from(constant), 3 * i128::from(constant));
    let digits = n ^ triple;
    // A digit at bit k + 1 of 3n stands for 2^k; it is negative where n itself has the bit above.
    (1..127).filter(|bit| digits >> bit & 1 == 1).map(|bit| (n >> bit & 1 == 1, bit - 1)).collect()
}
