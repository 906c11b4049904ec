//! Coverage bins: events that vectors should meet in a design. They are both values of every flag, the two integers at which every comparison turns
//! over, and every entry of every table. Proven ranges exclude impossible bins.

use super::fault::ReadTable;
use super::graph::{Net, NodeId, Op};
use super::interval::Ranges;
use super::verilog::wire_bits;

/// An event that a vector meets or misses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Bin {
    /// A flag is set, or clear.
    Flag {
        /// The flag.
        node: NodeId,
        /// True for set.
        set: bool,
    },
    /// a = b in a comparison a < b.
    Tie {
        /// The comparison.
        node: NodeId,
    },
    /// a = b − 1 in a comparison a < b.
    Below {
        /// The comparison.
        node: NodeId,
    },
    /// An entry of a table is read.
    Entry {
        /// Index of the table.
        table: u32,
        /// Index of the entry.
        index: u32,
    },
}

/// Coverage bins of a design.
#[derive(Clone, Debug)]
pub struct Bins<'a> {
    net: &'a Net,
    tables: &'a [ReadTable],
    /// Bins of flags and comparisons, then the entries of the tables, table by table.
    pub bins: Vec<Bin>,
    /// Place of the first entry of each table among the bins.
    entries: Vec<usize>,
}

impl<'a> Bins<'a> {
    /// Bins of a net with its proven ranges and its tables.
    pub fn new(net: &'a Net, ranges: &Ranges, tables: &'a [ReadTable]) -> Self {
        let wires = wire_bits(net, ranges);
        let mut bins = Vec::new();
        for (node, of) in net.iter().filter(|&(id, _)| wires[id as usize] != 0) {
            if ranges.of(node).constant().is_some()
                || !matches!(of.op, Op::Lt(..) | Op::And(..) | Op::Or(..) | Op::Xor(..))
            {
                continue;
            }
            if of.kind.bits() == 1 {
                bins.extend([false, true].map(|set| Bin::Flag { node, set }));
            }
            if let Op::Lt(a, b) = of.op {
                let (a, b) = (ranges.of(a), ranges.of(b));
                let step = |apart: i64| a.low <= b.high - apart && a.high >= b.low - apart;
                bins.extend(step(0).then_some(Bin::Tie { node }));
                // Multiples of 2^k are never one apart.
                bins.extend((step(1) && a.zeros.min(b.zeros) == 0).then_some(Bin::Below { node }));
            }
        }
        let mut entries = Vec::new();
        for (table, read) in (0..).zip(tables) {
            entries.push(bins.len());
            bins.extend(read.indices.clone().map(|index| Bin::Entry { table, index }));
        }
        Self { net, tables, bins, entries }
    }

    /// Calls `bin` with the place of every bin that a vector meets; the vector's wires hold `wires`. An entry is reported once a read.
    pub fn met(&self, wires: &[i64], mut bin: impl FnMut(usize)) {
        let of = |id: NodeId| wires[id as usize];
        let first_entry = self.entries.first().copied().unwrap_or(self.bins.len());
        for (place, &of_net) in self.bins[..first_entry].iter().enumerate() {
            let apart = |node: NodeId, by: i64| matches!(self.net.node(node).op, Op::Lt(a, b) if of(b) - of(a) == by);
            let is_met = match of_net {
                Bin::Flag { node, set } => (of(node) != 0) == set,
                Bin::Tie { node } => apart(node, 0),
                Bin::Below { node } => apart(node, 1),
                Bin::Entry { .. } => false,
            };
            if is_met {
                bin(place);
            }
        }
        for (table, &first) in self.tables.iter().zip(&self.entries) {
            for index in table.read(wires) {
                if (i64::from(table.indices.start)..i64::from(table.indices.end)).contains(&index) {
                    bin(first + (index - i64::from(table.indices.start)) as usize);
                }
            }
        }
    }

    /// Text of a bin: `core/src/stage/cube_face.rs:31 in cube_face: lt, operands equal`.
    pub fn text(&self, bin: Bin) -> String {
        let of =
            |node: NodeId, what: &str| format!("{}: {} {what}", self.net.origin(node), self.net.node(node).op.name());
        match bin {
            Bin::Flag { node, set } => of(node, if set { "set" } else { "not set" }),
            Bin::Tie { node } => of(node, "of equal operands"),
            Bin::Below { node } => of(node, "by one"),
            Bin::Entry { table, index } => format!("table {}: entry {index}", self.tables[table as usize].name),
        }
    }
}
