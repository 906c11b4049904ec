//! Devices for which hardware is written: how many levels of logic an operation takes there, and how many fit between two registers.
//!
//! On gates a level is a gate of two inputs (the unit-delay model of [`super::delay`]). On an FPGA it is a lookup table of four inputs with the wire
//! to it, some 1.1 ns on an ECP5: a carry chain is hardly longer than that, and a product takes a cycle between the registers of a DSP block.
//!
//! | operation | levels on an FPGA |
//! |---|---|
//! | add, sub | 2; 3 above 24 bits |
//! | lt | 3: the end of a carry chain goes through one more table |
//! | mul | a whole cycle |
//! | mul by a constant of d digits | 2 for each level of an adder tree of d rows |
//! | shift by a count | a select for each bit of the count |
//! | leading zeros of w bits | ⌈log₂ w⌉ |
//! | table of n entries | ⌈log₂ n⌉ − 3, at least 1; above 64 entries it is a block memory: 5, behind the edge that reads it |
//! | and, or, xor, select | 1 |
//! | choice among n wires by the phase | ⌈½ log₂ n⌉ + 1 |

use super::delay::{log2_above, unit_levels};
use super::unit::{Unit, signed_digits};

/// A kind of device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Target {
    /// Gates of two inputs.
    #[default]
    Asic,
    /// Lattice iCE40.
    Ice40,
    /// Lattice ECP5.
    Ecp5,
    /// Gowin GW1N and GW2A.
    Gowin,
    /// AMD 7 series.
    Xc7,
}

impl Target {
    /// Every target.
    pub const ALL: [Self; 5] = [Self::Asic, Self::Ice40, Self::Ecp5, Self::Gowin, Self::Xc7];

    /// Name in options and manifests.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Asic => "asic",
            Self::Ice40 => "ice40",
            Self::Ecp5 => "ecp5",
            Self::Gowin => "gowin",
            Self::Xc7 => "xc7",
        }
    }

    /// Target of a name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|target| target.name() == name)
    }

    /// True if lookup tables can be small memories whose read needs no clock.
    pub const fn has_small_memories(self) -> bool {
        matches!(self, Self::Ecp5 | Self::Gowin | Self::Xc7)
    }

    /// Most levels in a cycle of a folded design, unless the user gives another number. A footprint of `narrow` on two multipliers routes at 82 MHz
    /// with six on an ECP5, at 70 MHz with seven.
    pub const fn folded_depth(self) -> u32 {
        match self {
            Self::Asic => 24,
            Self::Ice40 | Self::Ecp5 => 6,
            Self::Gowin => 7,
            Self::Xc7 => 10,
        }
    }

    /// Most levels between two registers of a flat design, unless the user gives another number; `None` has registers between stages only. Six on an
    /// ECP5 route a mirror at 100 MHz, seven at 93 MHz.
    pub const fn flat_depth(self) -> Option<u32> {
        match self {
            Self::Asic => None,
            _ => Some(self.folded_depth()),
        }
    }

    /// Time of a level with its wire, for the clock that constraints ask for unless the user gives another, ns. Measured on an ECP5: a folded
    /// footprint of 6 levels runs at 82 MHz. The others are in proportion to the delays of their lookup tables; a gate is one of a 130 nm library.
    const fn level_ns(self) -> f64 {
        match self {
            Self::Asic => 0.1,
            Self::Ice40 => 4.0,
            Self::Ecp5 => 2.0,
            Self::Gowin => 2.5,
            Self::Xc7 => 1.0,
        }
    }

    /// Clock for a design with at most `depth` levels between registers, whole MHz; 50 MHz if their number is not bounded.
    pub fn clock_mhz(self, depth: Option<u32>) -> f64 {
        depth.map_or(50.0, |depth| (1000.0 / (f64::from(depth) * self.level_ns())).floor().max(1.0))
    }

    /// Levels of a unit, if at most `depth` fit between two registers.
    pub fn levels(self, unit: Unit, depth: u32) -> u32 {
        if self == Self::Asic {
            return unit_levels(unit);
        }
        match unit {
            Unit::Nothing | Unit::Wires => 0,
            Unit::Adder { bits, .. } => 2 + u32::from(bits > 24),
            Unit::Comparator { .. } => 3,
            Unit::Multiplier(_) => depth,
            Unit::ConstantMultiplier { by, .. } => 2 * log2_above(signed_digits(by)),
            Unit::Shifter { places, .. } => places,
            Unit::LeadingZeros { bits } => log2_above(bits).max(1),
            Unit::Table { .. } if self.is_clocked(unit) => 5,
            Unit::Table { entries } => log2_above(entries).saturating_sub(3).max(1),
            Unit::Mask | Unit::Logic { .. } | Unit::Select { .. } => 1,
        }
    }

    /// True if a clock edge is between the operands of a unit and its outcome: a block memory is read at an edge.
    pub fn is_clocked(self, unit: Unit) -> bool {
        self != Self::Asic && matches!(unit, Unit::Table { entries } if entries > 64)
    }

    /// Levels of a choice among some wires by the phase.
    pub fn choice(self, wires: u32) -> u32 {
        match self {
            Self::Asic => log2_above(wires),
            _ if wires < 2 => 0,
            _ => log2_above(wires).div_ceil(2) + 1,
        }
    }
}
