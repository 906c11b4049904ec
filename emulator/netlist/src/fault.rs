//! Faults: the measure of vector coverage. One thing in a netlist is wrong at a time, and a vector detects it if some field differs.
//!
//! A fault is a bit of a wire that is stuck, an operation that is replaced, or a table entry that is off by one last place. Wires and their bits are
//! those of the hardware, which has no wire without a reader ([`super::verilog`]). A change is no fault if a proven range hides it, if no field reads
//! the differing bits, or if both answers of a comparison lead to the same value. The simulation follows the differences from the place of a fault,
//! in the order of the netlist, until a field differs.

use std::ops::Range;

use super::graph::{Kind, Net, NodeId, Op, Table};
use super::interval::Ranges;
use super::operator_fault::{OperatorFault, Side};
use super::verilog::wire_bits;
use super::waiting::Waiting;

/// One wrong thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fault {
    /// A bit of a wire never changes.
    Stuck {
        /// The wire.
        node: NodeId,
        /// Place of the bit in the wire's integer.
        bit: u32,
        /// Value at which it is stuck; true for 1.
        high: bool,
    },
    /// An operation is replaced.
    OperatorFault {
        /// Wire of the operation.
        node: NodeId,
        /// The replacement.
        slip: OperatorFault,
    },
    /// An entry of a table is off by one of the table's last places, wherever it is read.
    Entry {
        /// Place of the table in [`Faults::tables`].
        table: u32,
        /// Index of the entry.
        index: u32,
        /// True for one more, false for one less.
        more: bool,
    },
}

/// A design with all its faults, and the wires at which they are seen.
#[derive(Clone, Debug)]
pub struct Faults<'a> {
    pub(crate) net: &'a Net,
    pub(crate) ranges: &'a Ranges,
    /// All faults.
    pub faults: Vec<Fault>,
    /// Tables of the design.
    pub tables: Vec<ReadTable>,
    /// Readers of each node.
    pub(crate) readers: Vec<Vec<NodeId>>,
    /// Bits of each node that fields show.
    pub(crate) shown: Vec<u64>,
}

/// A table of a design.
#[derive(Clone, Debug)]
pub struct ReadTable {
    /// Name, equal to that of its ROM in the hardware.
    pub name: String,
    /// Entries that its indices can name.
    pub indices: Range<u32>,
    table: Table,
    /// Last place of its entries.
    last_place: i64,
    /// Lookups of the table, each with its index.
    pub(super) lookups: Vec<(NodeId, NodeId)>,
}

impl ReadTable {
    fn new(net: &Net, ranges: &Ranges, table: Table) -> Self {
        let lookups: Vec<_> = (0..)
            .zip(&net.nodes)
            .filter_map(|(id, node)| match node.op {
                Op::Lookup(index, of) if of == table => Some((id, index)),
                _ => None,
            })
            .collect();
        let of =
            |end: fn(&super::interval::Range) -> i64| lookups.iter().map(move |&(_, index)| end(&ranges.of(index)));
        let low = of(|range| range.low).min().unwrap_or(0);
        let high = of(|range| range.high).max().unwrap_or(-1);
        let zeros = table.on_words().filter(|&entry| entry != 0).map(i32::trailing_zeros).min();
        let name = super::verilog::Rom::new(table).map_or_else(String::new, |rom| rom.name());
        Self {
            name,
            indices: low.max(0) as u32..(high + 1) as u32,
            table,
            last_place: 1 << zeros.unwrap_or(0),
            lookups,
        }
    }

    /// Entry that is one last place more or less.
    fn off_by_one(&self, entry: i64, more: bool) -> i64 {
        entry + if more { self.last_place } else { -self.last_place }
    }

    /// Wrong value that a lookup reads at an index; `None` outside the table.
    pub(super) fn wrong(&self, index: u32, more: bool) -> Option<i64> {
        Some(self.off_by_one(self.table.entry(index as usize)?.into(), more))
    }

    /// Entries that lookups of the design read if its wires hold `wires`.
    pub fn read<'a>(&'a self, wires: &'a [i64]) -> impl Iterator<Item = i64> + 'a {
        self.lookups.iter().map(|&(_, index)| wires[index as usize])
    }
}

/// 2^bits.
const fn power(bits: u32) -> u64 {
    1 << bits
}

/// Effect of a fault under some vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Effect {
    /// The wire has the same value as without the fault.
    None,
    /// The wire differs, but no field does.
    Masked,
    /// A field differs.
    Seen,
}

impl<'a> Faults<'a> {
    /// All faults of a net with its proven ranges. `shown` lists the nodes with bits that a field shows.
    pub fn new(net: &'a Net, ranges: &'a Ranges, shown: impl IntoIterator<Item = (NodeId, u64)>) -> Self {
        let mut readers = vec![Vec::new(); net.nodes.len()];
        let mut tables: Vec<ReadTable> = Vec::new();
        for (id, node) in net.iter() {
            for operand in node.op.operands() {
                readers[operand as usize].push(id);
            }
            if let Op::Lookup(_, table) = node.op
                && tables.iter().all(|known| known.table != table)
            {
                tables.push(ReadTable::new(net, ranges, table));
            }
        }
        let mut bits = vec![0; net.nodes.len()];
        for (id, of_field) in shown {
            bits[id as usize] |= of_field;
        }
        let mut all = Self { net, ranges, faults: Vec::new(), tables, readers, shown: bits };
        all.faults = all.listed();
        all
    }

    fn listed(&self) -> Vec<Fault> {
        let mut faults = Vec::new();
        let (wires, wanted) = (wire_bits(self.net, self.ranges), self.wanted());
        for (id, node) in self.net.iter() {
            let (bits, wanted, range) = (wires[id as usize], wanted[id as usize], self.ranges.of(id));
            // The sign stands for every bit above it.
            let reaches = |bit: u32| {
                if range.signed() && bit + 1 == range.top() { wanted >> bit != 0 } else { wanted >> bit & 1 == 1 }
            };
            let places = (0..63).filter(|&bit| bits >> bit & 1 == 1 && reaches(bit));
            faults.extend(places.flat_map(|bit| [false, true].map(|high| Fault::Stuck { node: id, bit, high })));
            // A shift by a constant only picks bits; any other operation has a wire.
            let is_written = match node.op {
                Op::Shl(..) | Op::Sar(..) => range.constant().is_none(),
                _ => bits != 0,
            };
            if is_written && wanted != 0 {
                let slips = OperatorFault::of(self.net, self.ranges, node.op).into_iter();
                let slips = slips.filter(|&slip| !self.makes_no_difference(id, slip, wanted));
                faults.extend(slips.map(|slip| Fault::OperatorFault { node: id, slip }));
            }
        }
        for (table, read) in (0..).zip(&self.tables) {
            let both = |index| [false, true].map(|more| Fault::Entry { table, index, more });
            faults.extend(read.indices.clone().flat_map(both));
        }
        faults
    }

    /// Bits of every node's 64-bit integer that can make a difference to a bit that a field shows.
    pub(super) fn wanted(&self) -> Vec<u64> {
        let mut wanted = self.shown.clone();
        for (id, node) in self.net.iter().rev() {
            // Bits above the wire's own are copies of its sign.
            let (bits, width) = (wanted[id as usize], node.kind.bits());
            let own =
                if width < 64 && bits >> width != 0 { bits & (power(width) - 1) | power(width - 1) } else { bits };
            wanted[id as usize] = own;
            if own == 0 {
                continue;
            }
            let upto = u64::MAX >> own.leading_zeros();
            let constant = |id: NodeId| match self.net.node(id).op {
                Op::Lit(value) => Some(value as u64),
                _ => None,
            };
            let mut want = |operand: NodeId, bits: u64| wanted[operand as usize] |= bits;
            match node.op {
                Op::Port(_) | Op::Lit(_) => {}
                Op::Add(a, b) | Op::Sub(a, b) | Op::Mul(a, b) => {
                    want(a, upto);
                    want(b, upto);
                }
                Op::Shl(a, k) => want(a, own >> k),
                Op::Sar(a, k) => want(a, own << k | if own.leading_zeros() < k { 1 << 63 } else { 0 }),
                Op::And(a, b) => {
                    want(a, own & constant(b).unwrap_or(u64::MAX));
                    want(b, own & constant(a).unwrap_or(u64::MAX));
                }
                Op::Or(a, b) | Op::Xor(a, b) => {
                    want(a, own);
                    want(b, own);
                }
                Op::Not(a) | Op::Widen(a) | Op::Narrow(a) | Op::Claim { of: a, .. } => want(a, own),
                Op::Select(flag, a, b) => {
                    want(flag, 1);
                    want(a, own);
                    want(b, own);
                }
                Op::Lt(..) | Op::ShlBy(..) | Op::SarBy(..) | Op::LeadingZeros(_) | Op::Lookup(..) => {
                    node.op.operands().for_each(|operand| want(operand, u64::MAX));
                }
            }
        }
        wanted
    }

    /// True if an operator fault leaves every field as it is, by ranges and by the wanted bits of its wire.
    fn makes_no_difference(&self, id: NodeId, slip: OperatorFault, wanted: u64) -> bool {
        let range = |id| self.ranges.of(id);
        let none_from = |bit: u32| bit >= 64 || wanted >> bit == 0;
        match (slip, self.net.node(id).op) {
            // A sign that is read as a value bit adds 2^top.
            (OperatorFault::Unsigned(_), Op::Sar(a, k)) => none_from(range(a).top() - k.min(range(a).top())),
            (OperatorFault::Unsigned(_), Op::SarBy(a, count)) => {
                none_from(range(a).top() - (range(count).high as u32).min(range(a).top()))
            }
            (OperatorFault::Unsigned(Side::First), Op::Mul(a, b)) => none_from(range(a).top() + range(b).zeros),
            (OperatorFault::Unsigned(Side::Second), Op::Mul(a, b)) => none_from(range(b).top() + range(a).zeros),
            // Only signs are left.
            (OperatorFault::Further, Op::Sar(a, k)) => range(a).signed() && k + 1 >= range(a).top(),
            (OperatorFault::Nearer, Op::Sar(a, k)) => range(a).signed() && k >= range(a).top(),
            (OperatorFault::OrEqual, Op::Lt(a, b)) => {
                let apart = range(a).high < range(b).low || range(b).high < range(a).low;
                apart || self.readers[id as usize].iter().all(|&reader| self.is_same_at_tie(reader, id, [a, b]))
            }
            _ => false,
        }
    }

    /// True if a reader of the comparison a < b has the same integer for either answer at a = b. Examples are a minimum, a maximum, a magnitude and a
    /// value clamped to limits.
    fn is_same_at_tie(&self, reader: NodeId, comparison: NodeId, [a, b]: [NodeId; 2]) -> bool {
        let op = |id: NodeId| self.net.node(id).op;
        let Op::Select(flag, x, y) = op(reader) else { return false };
        let is_zero = |id: NodeId| op(id) == Op::Lit(0);
        let negative =
            |of: NodeId, id: NodeId| matches!(op(id), Op::Sub(zero, of_that) if is_zero(zero) && of_that == of);
        let magnitude = |of: NodeId| (negative(of, x) && y == of) || (negative(of, y) && x == of);
        let constant = |id: NodeId| match op(id) {
            Op::Lit(value) => Some(value),
            _ => None,
        };
        // At a tie both operands equal the constant.
        let at_tie = |id: NodeId| if id == a || id == b { constant(a).or(constant(b)) } else { constant(id) };
        let either = |id: NodeId| {
            let inner = match op(id) {
                Op::Select(flag, x, y) => match op(flag) {
                    Op::Lt(c, d) => at_tie(c).zip(at_tie(d)).map(|(c, d)| if c < d { x } else { y }),
                    _ => None,
                },
                _ => None,
            };
            let id = inner.unwrap_or(id);
            id == a || id == b
        };
        flag == comparison && (either(x) && either(y) || is_zero(b) && magnitude(a) || is_zero(a) && magnitude(b))
    }

    /// Place and kind of a fault: `core/src/stage/reflect.rs:84 in reflect: add without its constant`.
    pub fn text(&self, fault: Fault) -> String {
        match fault {
            Fault::Stuck { node, bit, high } => {
                let name = self.net.node(node).op.name();
                format!("{}: bit {bit} of {name} stuck at {}", self.place(node), u32::from(high))
            }
            Fault::OperatorFault { node, slip } => {
                format!("{}: {} {slip}", self.place(node), self.net.node(node).op.name())
            }
            Fault::Entry { table, index, more } => {
                let name = &self.tables[table as usize].name;
                format!("table {name}: entry {index} one last place {}", if more { "more" } else { "less" })
            }
        }
    }

    fn place(&self, node: NodeId) -> String {
        match self.net.node(node).op {
            Op::Port(port) => format!("port {}", self.net.ports[port as usize].name),
            _ => self.net.origin(node),
        }
    }

    /// Run of the stage that holds a fault, as an index of [`Net::runs`]; `None` for a port or a table.
    pub fn run(&self, fault: Fault) -> Option<u32> {
        match fault {
            Fault::Stuck { node, .. } | Fault::OperatorFault { node, .. } => self.net.node(node).stage,
            Fault::Entry { .. } => None,
        }
    }
}

/// Wires that differ under a fault; one simulator serves any number of faults in turn.
#[derive(Clone, Debug)]
pub struct Simulator<'a> {
    faults: &'a Faults<'a>,
    /// Number of the simulation in which a node differed last, and its integer then.
    differs: Vec<(u64, i64)>,
    simulation: u64,
    /// Nodes to compute.
    waiting: Waiting,
}

impl<'a> Simulator<'a> {
    /// Simulator of the faults of a design.
    pub fn new(faults: &'a Faults<'a>) -> Self {
        let nodes = faults.net.nodes.len();
        Self { faults, differs: vec![(0, 0); nodes], simulation: 0, waiting: Waiting::new(nodes) }
    }

    /// Effect of a fault if the wires of the right design hold `right`.
    pub fn effect(&mut self, fault: Fault, right: &[i64]) -> Effect {
        let Self { faults, differs, simulation, waiting } = self;
        *simulation += 1;
        let now = *simulation;
        let mut effect = Effect::None;
        match fault {
            Fault::Stuck { node, .. } | Fault::OperatorFault { node, .. } => waiting.add(node),
            Fault::Entry { table, index, .. } => {
                for &(id, at) in &faults.tables[table as usize].lookups {
                    if right[at as usize] == i64::from(index) {
                        waiting.add(id);
                    }
                }
            }
        }
        while let Some(id) = waiting.first() {
            let place = id as usize;
            let of = |id: NodeId| match differs[id as usize] {
                (then, value) if then == now => value,
                _ => right[id as usize],
            };
            let value = faults.value(fault, id, right, of);
            if value == right[place] {
                continue;
            }
            differs[place] = (now, value);
            effect = Effect::Masked;
            if (value ^ right[place]) as u64 & faults.shown[place] != 0 {
                waiting.clear();
                return Effect::Seen;
            }
            for &reader in &faults.readers[place] {
                waiting.add(reader);
            }
        }
        effect
    }
}

impl Faults<'_> {
    /// Integer of a node under a fault, from its operands.
    pub(super) fn value(&self, fault: Fault, id: NodeId, right: &[i64], of: impl Fn(NodeId) -> i64) -> i64 {
        let node = self.net.node(id);
        let as_is = || match node.op {
            Op::Port(_) => right[id as usize],
            op => node.kind.cut(op.value(node.kind, |id| self.net.node(id).kind, &of) as i64),
        };
        match (fault, node.op) {
            (Fault::Stuck { node: at, bit, high }, _) if at == id => {
                let range = self.ranges.of(id);
                let (value, place) = (as_is(), 1_i64 << bit);
                let value = if high { value | place } else { value & !place };
                // The sign is a bit like others; the bits above it are copies.
                let spare = 64 - range.top();
                if node.kind != Kind::Flag && range.signed() { value << spare >> spare } else { value }
            }
            (Fault::OperatorFault { node: at, slip }, _) if at == id => slip.value(self.net, self.ranges, id, of),
            (Fault::Entry { table, index, more }, Op::Lookup(at, read))
                if read == self.tables[table as usize].table && of(at) == i64::from(index) =>
            {
                self.tables[table as usize].off_by_one(as_is(), more)
            }
            _ => as_is(),
        }
    }
}
