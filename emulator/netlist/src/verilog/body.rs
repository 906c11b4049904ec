//! The wires of a stage as operations see them: the value of a node, and its text.

use std::collections::{BTreeMap, HashMap};

use super::context::Context;
use super::value::{Text, Value, View, Wire, constant_bits, signed_constant, view_bits};
use crate::graph::{Kind, NodeId, Op};
use crate::range::Range;
use crate::target::Target;

/// The wires of a stage.
pub(crate) struct Body<'a> {
    pub(crate) context: Context<'a>,
    pub(crate) nodes: &'a [NodeId],
    pub(crate) values: HashMap<NodeId, Value>,
    /// Rank at which a wire is made.
    pub(crate) ranks: HashMap<NodeId, u32>,
    /// Bits of a wire that are read at each rank.
    pub(crate) reads: HashMap<NodeId, BTreeMap<u32, u64>>,
    pub(crate) names: HashMap<NodeId, String>,
    pub(crate) last_rank: u32,
    /// Ranks at which the operation at hand reads wires, where they are not its own; only folded designs have such wires.
    pub(crate) registers: HashMap<NodeId, u32>,
}

/// Bits `low` up to `high`.
pub(crate) fn mask(low: u32, high: u32) -> u128 {
    let upto = |n: u32| if n >= 128 { u128::MAX } else { (1 << n) - 1 };
    if high <= low { 0 } else { upto(high) & !upto(low) }
}

/// Lowest and one above the highest bit.
pub(crate) fn hull(bits: u64) -> (u32, u32) {
    (bits.trailing_zeros(), 64 - bits.leading_zeros())
}

impl Body<'_> {
    pub(crate) fn op(&self, id: NodeId) -> Op {
        self.context.net.node(id).op
    }

    pub(crate) fn kind(&self, id: NodeId) -> Kind {
        self.context.net.node(id).kind
    }

    pub(crate) fn range(&self, id: NodeId) -> Range {
        self.context.ranges.of(id)
    }

    pub(crate) fn value(&self, id: NodeId) -> Value {
        match (self.range(id).constant(), self.values.get(&id)) {
            (Some(value), _) => Value::Constant(value),
            (None, Some(&value)) => value,
            (None, None) => Value::Bits(View::of(id)),
        }
    }

    pub(crate) fn constant(&self, id: NodeId) -> Option<i64> {
        self.range(id).constant()
    }

    /// The bits of a wire that stand for a node that is not constant.
    pub(crate) fn view(&self, id: NodeId) -> Option<View> {
        match self.value(id) {
            Value::Bits(view) => Some(view),
            Value::Constant(_) => None,
        }
    }

    /// Bits of an operand's integer that are not constant zeros, and its sign if it has one.
    pub(crate) fn all_bits(&self, id: NodeId) -> u128 {
        mask(self.range(id).zeros, self.range(id).top())
    }

    /// Bits that a comparison reads: those of the wider operand, and a sign for an unsigned operand next to a signed one.
    pub(crate) fn compared(&self, a: NodeId, b: NodeId) -> (u32, u32) {
        let (a, b) = (self.range(a), self.range(b));
        let signed = a.signed() || b.signed();
        let top = |range: Range| range.top() + u32::from(signed && !range.signed());
        // Bits below the lowest one of b make no difference. On gates a tool leaves them out.
        let low = if self.has_lookup_tables() { b.zeros } else { a.zeros.min(b.zeros) };
        (low, top(a).max(top(b)))
    }

    /// True if logic becomes lookup tables, not gates.
    pub(crate) fn has_lookup_tables(&self) -> bool {
        self.context.target != Target::Asic
    }

    /// Bits among which leading zeros are counted. On a device they are those of the word, for wires cost less than an adder behind the count.
    pub(crate) fn counted(&self, a: NodeId) -> u32 {
        let is_whole = self.range(a).signed() || self.has_lookup_tables();
        if is_whole { self.context.net.node(a).kind.bits() } else { self.range(a).top() }
    }

    /// Bits of a wire that are read at `rank` or later, registers to later ranks included.
    pub(crate) fn reads_from(&self, id: NodeId, rank: u32) -> u64 {
        let Some(reads) = self.reads.get(&id) else { return 0 };
        let now = reads.get(&rank).copied().unwrap_or(0);
        let later = reads.range(rank + 1..).fold(0, |all, (_, bits)| all | bits);
        let (low, high) = hull(later);
        now | if later == 0 { 0 } else { mask(low, high) as u64 }
    }

    /// Wire of a node at a rank. An input has all its bits, any other node the bits that are read.
    pub(crate) fn wire(&self, id: NodeId, rank: u32) -> Wire {
        let (made, range) = (self.ranks[&id], self.range(id));
        let is_input = !self.nodes.contains(&id);
        let (low, high) =
            if is_input && rank == made { (range.zeros, range.top()) } else { hull(self.reads_from(id, rank)) };
        let name = match self.names.get(&id) {
            Some(name) if rank == made => name.clone(),
            Some(name) => format!("{name}_s{rank}"),
            None => String::new(),
        };
        Wire { name, low, high, signed: range.signed() && high == range.top() }
    }

    pub(crate) fn text(&self, id: NodeId, low: u32, high: u32, rank: u32) -> Text {
        self.shifted(id, 0, low, high, rank)
    }

    /// Bits `low` up to `high` of a node times 2^k.
    pub(crate) fn shifted(&self, id: NodeId, k: u32, low: u32, high: u32, rank: u32) -> Text {
        match self.value(id) {
            Value::Constant(value) => constant_bits(value << k, low, high),
            Value::Bits(view) => {
                let rank = self.registers.get(&view.base).copied().unwrap_or(rank);
                view_bits(&view.shl(k), &self.wire(view.base, rank), low, high)
            }
        }
    }

    pub(crate) fn flag(&self, id: NodeId, rank: u32) -> String {
        self.text(id, 0, 1, rank).code
    }

    /// All bits of a node as an operand with its own sign: a factor, or the operand of a right shift.
    pub(crate) fn signed_operand(&self, id: NodeId, low: u32, high: u32, rank: u32) -> String {
        match self.value(id) {
            Value::Constant(value) => signed_constant(value, low, high),
            Value::Bits(_) => self.text(id, low, high, rank).as_signed(),
        }
    }

    /// A factor, signed if the product is.
    pub(crate) fn factor(&self, id: NodeId, signed: bool, rank: u32) -> String {
        let range = self.range(id);
        let extra = u32::from(signed && !range.signed());
        let (low, high) = (range.zeros.min(62), range.top() + extra);
        if signed { self.signed_operand(id, low, high, rank) } else { self.text(id, low, high, rank).as_unsigned() }
    }

    pub(crate) fn places(&self, count: NodeId, rank: u32) -> String {
        self.text(count, 0, self.range(count).top(), rank).code
    }
}
