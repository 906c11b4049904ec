//! Modules to synthesise, and their results.

use std::path::PathBuf;

use serde_json::Value;

/// Cells after synthesis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Area {
    pub(super) luts: u64,
    pub(super) carries: u64,
    pub(super) multipliers: u64,
    pub(super) registers: u64,
}

impl Area {
    /// Reads the output of `stat -json`.
    pub(super) fn read(statistics: &Value) -> Option<Self> {
        let cells = statistics["design"]["num_cells_by_type"].as_object()?;
        let of = |names: &[&str]| {
            let named = cells.iter().filter(|(name, _)| names.iter().any(|wanted| name.starts_with(wanted)));
            named.filter_map(|(_, count)| count.as_u64()).sum()
        };
        Some(Self {
            luts: of(&["SB_LUT4", "LUT4"]),
            carries: of(&["SB_CARRY", "CCU2C"]),
            multipliers: of(&["SB_MAC16", "MULT18X18D"]),
            registers: of(&["SB_DFF", "TRELLIS_FF"]),
        })
    }

    /// Logic cells that the module takes at least.
    pub(super) fn cells(&self) -> u64 {
        // A carry of ECP5 is two bits of adder with their two tables.
        self.luts.max(self.registers) + 2 * self.carries
    }
}

/// A module to synthesise: its name, its ports and every source it needs.
#[derive(Clone, Debug)]
pub(super) struct Module {
    /// Design that contains the module.
    pub(super) design: String,
    pub(super) name: String,
    /// True if the module has a clock.
    pub(super) clocked: bool,
    pub(super) inputs: Vec<(String, u64)>,
    pub(super) outputs: Vec<(String, u64)>,
    pub(super) sources: PathBuf,
    /// Hash of the sources.
    pub(super) hash: String,
}

/// Result of one module.
#[derive(Clone, Debug)]
pub(super) struct Outcome {
    pub(super) ice40: Area,
    pub(super) ice40_clock: Clock,
    pub(super) ecp5: Area,
    pub(super) ecp5_clock: Clock,
}

/// Megahertz of several seeds, or the reason for having none.
#[derive(Clone, Debug)]
pub(super) enum Clock {
    Reached {
        device: &'static str,
        megahertz: Vec<f64>,
    },
    TooLarge,
    /// The module has more cells than the given limit.
    NotPlaced,
    Failed(String),
}

/// Arguments of the command line.
pub(super) struct Arguments {
    pub(super) seeds: u64,
    /// Logic cells of the largest module to place.
    pub(super) place: u64,
    pub(super) profiles: Vec<String>,
    pub(super) output: PathBuf,
}
