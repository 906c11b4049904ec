//! The hardware clock: size of the reflection datapath on silicon at a precision, from the proof of its ranges.
//!
//! Everything is counted on the netlist (`roughxel cost`), so it is exact and reproducible. Lookup tables and the clock are
//! estimates and named so. They are calibrated on single stages that Yosys 0.23 and nextpnr 0.11.1 placed on an ECP5.

use std::collections::BTreeMap;

use roughxel_core::design::Design;
use roughxel_core::plan::Effects;
use roughxel_core::precision::Precision;
use roughxel_netlist::census::{Census, Cost};
use roughxel_netlist::delay::levels;
use roughxel_netlist::interval::Ranges;
use roughxel_record as record;
use serde::{Deserialize, Serialize};

/// Nanoseconds of a gate level on an ECP5 of speed grade 6, placed and routed: the median over the placed stages
/// with more than a handful of gates. Their range is 0.65 to 0.78.
const LEVEL_NS: f64 = 0.71;

/// Table bits that fit a lookup table of four inputs.
const LUT_BITS: u64 = 16;

/// Full adders: w·n of a multiplier of w by n bits, w·(digits − 1) of a multiplier by a constant, and the carry bits of adders
/// and comparators. Tables, selects and shifters are not included.
pub fn full_adders(cost: &Cost) -> u64 {
    let products = cost.multipliers.iter().map(|([w, n], count)| w * n * count);
    let by_constant = cost.constant_multipliers.iter().map(|([w, digits], count)| w * (digits - 1) * count);
    cost.carry_bits() + products.chain(by_constant).map(u64::from).sum::<u64>()
}

/// Size of the reflection datapath with all effects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HardwareFigures {
    /// Multipliers by the widths of their operands in bits, as `22x22`.
    pub multipliers: BTreeMap<String, u32>,
    /// Number of multipliers.
    pub multiplier_count: u32,
    /// [`full_adders`] of the datapath.
    pub full_adders: u64,
    /// Blocks of 18×18 bits that the multipliers fill; Yosys uses 1.02 to 1.13 times as many.
    pub blocks_18x18: u32,
    /// Lookup tables of four inputs: one for each bit of adders, comparators, selects, shifters, counters and logic, and for 16
    /// bits of tables. Yosys makes 1.03 (`paper`) to 1.28 (`precise`) times as many of the same stages.
    pub luts_estimate: u64,
    /// Bits of tables.
    pub rom_bits: u64,
    /// Gate levels from ports to outcomes without registers.
    pub levels: u32,
    /// Gate levels of the slowest unit, which no register can divide.
    pub unit_levels: u32,
    /// Clock in MHz with a register after every unit, at 0.71 ns a gate level. One fragment a cycle gives 10⁶ fragments a second
    /// for each MHz.
    pub clock_mhz_estimate: f64,
}

impl HardwareFigures {
    /// Figures of a precision. `None` if a wire is not proven to fit its word, which no precision inside its limits has.
    pub fn estimate(p: &Precision) -> Option<Self> {
        let net = record::net(Design::Reflection, &Effects::ALL, p);
        let ranges = Ranges::new(&net);
        if !ranges.violations.is_empty() {
            return None;
        }
        let census = Census::new(&net, &ranges).total;
        let Cost { multipliers, selects, shifters, leading_zeros, logic, .. } = &census;
        let unit_levels = net.iter().map(|(id, _)| levels(&net, &ranges, id)).max().unwrap_or(1);
        // An operand of 18 bits in two's complement is one block; every 17 further bits add a block.
        let blocks = |width: u32| width.saturating_sub(1).div_ceil(17).max(1);
        Some(Self {
            multipliers: multipliers.iter().map(|([a, b], count)| (format!("{a}x{b}"), *count)).collect(),
            multiplier_count: census.multiplier_count(),
            full_adders: full_adders(&census),
            blocks_18x18: multipliers.iter().map(|([a, b], count)| blocks(*a) * blocks(*b) * count).sum(),
            luts_estimate: census.carry_bits()
                + [selects, shifters, leading_zeros, logic].map(|units| units.bits).iter().sum::<u64>()
                + census.rom_bits() / LUT_BITS,
            rom_bits: census.rom_bits(),
            levels: census.levels,
            unit_levels,
            clock_mhz_estimate: 1e3 / (LEVEL_NS * f64::from(unit_levels)),
        })
    }
}
