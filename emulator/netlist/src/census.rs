//! The census: the hardware cost of each stage, counted on the netlist with the widths that the interval walk proves.
//!
//! Widths leave out constant low zeros, so a mantissa of p fraction bits counts p + 2 bits whatever its wire. Operands of multipliers are in two's
//! complement, as multiplier blocks take them. A table is counted once a stage with the entries that can be read, however often it is read. Fixed
//! shifts, widening, narrowing, claims, sign tests, masks with a constant and inverters are wires; `delay` says how long they and the rest take. Runs
//! of a stage share nothing: this is the cost of a datapath that takes a fragment each cycle.

use std::collections::BTreeMap;

use super::delay::{arrival, block_levels};
use super::graph::{Net, Op, Table};
use super::range::{Range, Ranges};
use super::unit::{Unit, signed_digits};

/// Units of one sort and their bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Units {
    /// Number of units.
    pub count: u32,
    /// Bits of all of them.
    pub bits: u64,
}

impl Units {
    fn add(&mut self, bits: u32) {
        self.count += 1;
        self.bits += u64::from(bits);
    }

    fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.bits += other.bits;
    }
}

/// Cost of a run, a stage or a design.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Multipliers by the widths of their operands, bits in two's complement, the wider first.
    pub multipliers: BTreeMap<[u32; 2], u32>,
    /// Multipliers by a constant: width of the operand, bits in two's complement, and non-zero signed digits of the
    /// constant, at least two (one is a shift).
    pub constant_multipliers: BTreeMap<[u32; 2], u32>,
    /// Adders and subtracters of two wires, and their bits with a carry.
    pub adders: Units,
    /// Adders and subtracters with a constant: increments, complements, roundings.
    pub constant_adders: Units,
    /// Comparators, and their bits with a carry.
    pub comparators: Units,
    /// Selects, and the bits of their outcomes.
    pub selects: Units,
    /// Shifters by a count on a wire, and the selects in them: bits times bits of the count.
    pub shifters: Units,
    /// Leading-zero counters, and the bits of their operands.
    pub leading_zeros: Units,
    /// And, or and exclusive or, and their bits.
    pub logic: Units,
    /// Tables by entries and bits of an entry.
    pub tables: BTreeMap<[u32; 2], u32>,
    /// Reads of tables.
    pub lookups: u32,
    /// Operations that are wires.
    pub wires: u32,
    /// Gate levels of the critical path.
    pub levels: u32,
}

impl Cost {
    /// Multipliers of two wires.
    pub fn multiplier_count(&self) -> u32 {
        self.multipliers.values().sum()
    }

    /// Widest operands of a multiplier, bits in two's complement: the largest of the wider and of the narrower ones.
    pub fn widest_multiplier(&self) -> [u32; 2] {
        self.multipliers.keys().fold([0; 2], |widest, widths| [0, 1].map(|i| widths[i].max(widest[i])))
    }

    /// Bits of every adder, subtracter and comparator.
    pub fn carry_bits(&self) -> u64 {
        self.adders.bits + self.constant_adders.bits + self.comparators.bits
    }

    /// Bits of every table.
    pub fn rom_bits(&self) -> u64 {
        self.tables.iter().map(|([entries, width], count)| u64::from(entries * width * count)).sum()
    }

    /// Adds a parallel cost; the critical path is the longer one.
    fn merge(&mut self, other: &Self) {
        let maps = [
            (&mut self.multipliers, &other.multipliers),
            (&mut self.constant_multipliers, &other.constant_multipliers),
            (&mut self.tables, &other.tables),
        ];
        for (map, other) in maps {
            for (key, count) in other {
                *map.entry(*key).or_default() += count;
            }
        }
        let units = [
            (&mut self.adders, other.adders),
            (&mut self.constant_adders, other.constant_adders),
            (&mut self.comparators, other.comparators),
            (&mut self.selects, other.selects),
            (&mut self.shifters, other.shifters),
            (&mut self.leading_zeros, other.leading_zeros),
            (&mut self.logic, other.logic),
        ];
        for (units, other) in units {
            units.merge(&other);
        }
        self.lookups += other.lookups;
        self.wires += other.wires;
        self.levels = self.levels.max(other.levels);
    }

    /// Counts one unit; tables are counted once a run.
    fn count(&mut self, unit: Unit) {
        match unit {
            Unit::Nothing => {}
            Unit::Wires | Unit::Mask => self.wires += 1,
            Unit::Adder { bits, constant: true } => self.constant_adders.add(bits),
            Unit::Adder { bits, constant: false } => self.adders.add(bits),
            Unit::Comparator { bits } => self.comparators.add(bits),
            Unit::Multiplier(operands) => {
                let [v, w] = operands.map(signed_width);
                *self.multipliers.entry([v.max(w), v.min(w)]).or_default() += 1;
            }
            Unit::ConstantMultiplier { by, operand } => {
                *self.constant_multipliers.entry([signed_width(operand), signed_digits(by)]).or_default() += 1;
            }
            Unit::Shifter { bits, places } => self.shifters.add(bits * places),
            Unit::LeadingZeros { bits } => self.leading_zeros.add(bits),
            Unit::Table { .. } => self.lookups += 1,
            Unit::Logic { bits } => self.logic.add(bits),
            Unit::Select { bits } => self.selects.add(bits),
        }
    }
}

/// Bits in two's complement without constant low zeros.
fn signed_width(range: Range) -> u32 {
    range.width() + u32::from(!range.signed())
}

/// All runs of one stage.
#[derive(Clone, Debug)]
pub struct StageCost {
    /// Name of the stage.
    pub stage: &'static str,
    /// Number of its runs.
    pub runs: u32,
    /// Cost of all runs together, with the critical path of the slowest.
    pub cost: Cost,
}

/// Census of a net.
#[derive(Clone, Debug)]
pub struct Census {
    /// Every run of a stage, in the order of [`Net::runs`].
    pub runs: Vec<Cost>,
    /// Every stage, in the order of its first run.
    pub stages: Vec<StageCost>,
    /// Cost of the design; its critical path leads from ports to outputs without a register.
    pub total: Cost,
}

impl Census {
    /// Counts a net.
    pub fn new(net: &Net, ranges: &Ranges) -> Self {
        let mut runs = vec![Cost::default(); net.runs.len()];
        let mut total = Cost::default();
        // First and last entry read, and the widest entry, of every table of every run.
        let mut tables: Vec<(Option<u32>, Table, i64, i64, u32)> = Vec::new();
        for (id, node) in net.iter() {
            let cost = node.stage.map_or(&mut total, |run| &mut runs[run as usize]);
            cost.count(node.op.unit(ranges, id));
            if let Op::Lookup(index, table) = node.op {
                let (index, width) = (ranges.of(index), ranges.of(id).width());
                match tables.iter_mut().find(|known| (known.0, known.1) == (node.stage, table)) {
                    Some((_, _, low, high, widest)) => {
                        (*low, *high, *widest) = (index.low.min(*low), index.high.max(*high), width.max(*widest));
                    }
                    None => tables.push((node.stage, table, index.low, index.high, width)),
                }
            }
        }
        for (run, _, low, high, width) in tables {
            let cost = run.map_or(&mut total, |run| &mut runs[run as usize]);
            *cost.tables.entry([(high - low + 1) as u32, width]).or_default() += 1;
        }
        for (cost, levels) in runs.iter_mut().zip(block_levels(net, ranges)) {
            cost.levels = levels;
        }
        let mut stages: Vec<StageCost> = Vec::new();
        for (run, cost) in net.runs.iter().zip(&runs) {
            total.merge(cost);
            match stages.iter_mut().find(|known| known.stage == run.base()) {
                Some(stage) => {
                    stage.runs += 1;
                    stage.cost.merge(cost);
                }
                None => stages.push(StageCost { stage: run.base(), runs: 1, cost: cost.clone() }),
            }
        }
        let times = arrival(net, ranges);
        total.levels = net.outputs.iter().map(|output| times[output.node as usize]).max().unwrap_or(0);
        Self { runs, stages, total }
    }
}
