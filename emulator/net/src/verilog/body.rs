//! The wires of a stage: which nodes need one, at which rank it is made, which of its bits somebody reads.

use std::collections::{BTreeMap, HashMap};

use super::context::Context;
use super::error::VerilogError;
use super::rom::Rom;
use super::value::{Value, View};
use crate::delay::levels;
use crate::graph::{Kind, NodeId, Op};
use crate::interval::Range;

/// What drives a wire.
#[derive(Clone, Copy)]
pub(super) enum Driver {
    /// The operation of the node.
    Op(Op),
    /// Whether a node is zero.
    IsZero(NodeId),
    /// Whether it is not.
    IsNotZero(NodeId),
}

pub(super) struct Body<'a> {
    pub(super) context: Context<'a>,
    pub(super) nodes: &'a [NodeId],
    pub(super) values: HashMap<NodeId, Value>,
    /// The stage in which a wire is made.
    pub(super) stages: HashMap<NodeId, u32>,
    /// Bits of a wire that are read in each stage.
    pub(super) reads: HashMap<NodeId, BTreeMap<u32, u64>>,
    pub(super) names: HashMap<NodeId, String>,
    pub(super) last_stage: u32,
}

/// Bits `low` up to `high`.
pub(super) fn mask(low: u32, high: u32) -> u128 {
    let upto = |n: u32| if n >= 128 { u128::MAX } else { (1 << n) - 1 };
    if high <= low { 0 } else { upto(high) & !upto(low) }
}

/// Lowest and one above the highest bit.
pub(super) fn hull(bits: u64) -> (u32, u32) {
    (bits.trailing_zeros(), 64 - bits.leading_zeros())
}

pub(super) fn top(range: Range) -> u32 {
    range.zeros + range.width()
}

impl<'a> Body<'a> {
    pub(super) fn op(&self, id: NodeId) -> Op {
        self.context.net.node(id).op
    }

    pub(super) fn range(&self, id: NodeId) -> Range {
        self.context.ranges.of(id)
    }

    pub(super) fn value(&self, id: NodeId) -> Value {
        match (self.range(id).constant(), self.values.get(&id)) {
            (Some(value), _) => Value::Constant(value),
            (None, Some(&value)) => value,
            (None, None) => Value::Bits(View::of(id)),
        }
    }

    pub(super) fn constant(&self, id: NodeId) -> Option<i64> {
        self.range(id).constant()
    }

    /// The value of a node where wires are enough.
    pub(super) fn wiring(&self, id: NodeId) -> Option<Value> {
        let bits = |id| match self.value(id) {
            Value::Bits(view) => Some(view),
            Value::Constant(_) => None,
        };
        let view = match self.op(id) {
            Op::Shl(a, k) => bits(a)?.shl(k),
            Op::Sar(a, k) => bits(a)?.sar(k),
            Op::Widen(a) | Op::Narrow(a) => bits(a)?,
            Op::Not(a) => bits(a)?.not(),
            Op::Sub(a, b) => {
                let Op::Shl(shifted, k) = self.op(b) else { return None };
                (self.op(shifted) == Op::Sar(a, k)).then(|| bits(a))??.low_bits(k)
            }
            Op::Lt(a, b) if self.constant(b) == Some(0) => bits(a)?.bit(top(self.range(a)) - 1),
            // One of the two is constant, and the outcome is not: the constant is neutral.
            Op::And(a, b) | Op::Or(a, b) if self.context.net.node(id).kind == Kind::Flag => {
                match (self.constant(a), self.constant(b)) {
                    (Some(_), None) => bits(b)?,
                    (None, Some(_)) => bits(a)?,
                    _ => return None,
                }
            }
            Op::Select(flag, a, b) => match (self.constant(flag), self.constant(a), self.constant(b)) {
                (Some(flag), ..) => return Some(self.value(if flag != 0 { a } else { b })),
                (None, Some(a), Some(0)) if a > 0 && a.count_ones() == 1 => bits(flag)?.shl(a.trailing_zeros()),
                (None, Some(0), Some(b)) if b > 0 && b.count_ones() == 1 => bits(flag)?.not().shl(b.trailing_zeros()),
                _ => return None,
            },
            _ => return None,
        };
        Some(Value::Bits(view))
    }

    pub(super) fn driver(&self, id: NodeId) -> Driver {
        let natural = |id| self.range(id).low >= 0;
        match self.op(id) {
            Op::Lt(a, b) if self.constant(b) == Some(1) && natural(a) => Driver::IsZero(a),
            Op::Lt(a, b) if self.constant(a) == Some(0) && natural(b) => Driver::IsNotZero(b),
            Op::And(a, b) => match (self.op(a), self.op(b)) {
                (Op::Not(negative), Op::Lt(x, one)) if self.constant(one) == Some(1) => match self.op(negative) {
                    Op::Lt(y, zero) if x == y && self.constant(zero) == Some(0) => Driver::IsZero(x),
                    _ => Driver::Op(self.op(id)),
                },
                _ => Driver::Op(self.op(id)),
            },
            op => Driver::Op(op),
        }
    }

    /// Lowest and one above the highest bit an operation computes to deliver bits `low` up to `high`.
    pub(super) fn span(&self, driver: Driver, low: u32, high: u32) -> (u32, u32) {
        let range = |id| self.range(id);
        match driver {
            // No carry comes from below the lowest bit in which both operands have wires.
            Driver::Op(Op::Add(a, b)) => (low.min(range(a).zeros.max(range(b).zeros)), high),
            Driver::Op(Op::Sub(_, b)) => (low.min(range(b).zeros), high),
            Driver::Op(Op::Mul(a, b)) => {
                let first = range(a).zeros + range(b).zeros;
                (first, high.max(first + range(a).width().max(range(b).width())))
            }
            Driver::Op(Op::LeadingZeros(_)) => (0, high),
            Driver::Op(Op::Lookup(_, table)) => {
                let entries = Rom::format(table);
                (entries.zeros, high.max(top(entries.range)))
            }
            Driver::Op(Op::ShlBy(x, count)) => {
                (range(x).zeros.max(low.saturating_sub(range(count).high.clamp(0, 63) as u32)), high)
            }
            Driver::Op(Op::SarBy(x, _)) => (low, high.max(top(range(x)))),
            Driver::Op(_) | Driver::IsZero(_) | Driver::IsNotZero(_) => (low, high),
        }
    }

    /// Bits of an operand's integer that are not constant zeros, and its sign where there is one.
    pub(super) fn all_bits(&self, id: NodeId) -> u128 {
        mask(self.range(id).zeros, top(self.range(id)))
    }

    /// The bits of its operands an operation reads to deliver `bits`.
    pub(super) fn operands(&self, driver: Driver, bits: u64) -> Vec<(NodeId, u128)> {
        let (low, high) = hull(bits);
        let (first, last) = self.span(driver, low, high);
        let bits = u128::from(bits);
        let op = match driver {
            Driver::IsZero(x) | Driver::IsNotZero(x) => return vec![(x, self.all_bits(x))],
            Driver::Op(op) => op,
        };
        match op {
            Op::Port(_) | Op::Lit(_) => Vec::new(),
            Op::Add(a, b) | Op::Sub(a, b) => vec![(a, mask(first, last)), (b, mask(first, last))],
            Op::And(a, b) | Op::Or(a, b) | Op::Xor(a, b) => {
                let read = |other: NodeId| match (op, self.constant(other)) {
                    (Op::And(..), Some(c)) => bits & i128::from(c) as u128,
                    (Op::Or(..), Some(c)) => bits & !i128::from(c) as u128,
                    _ => bits,
                };
                vec![(a, read(b)), (b, read(a))]
            }
            Op::Select(flag, a, b) => vec![(flag, 1), (a, bits), (b, bits)],
            Op::Lt(a, b) => {
                let (low, high) = self.compared(a, b);
                vec![(a, mask(low, high)), (b, mask(low, high))]
            }
            Op::ShlBy(x, count) => vec![(x, mask(first, last)), (count, self.all_bits(count))],
            Op::SarBy(x, count) => vec![(x, mask(first, top(self.range(x)))), (count, self.all_bits(count))],
            Op::Claim { of, .. } => vec![(of, bits)],
            Op::LeadingZeros(a) => vec![(a, mask(0, self.counted(a)))],
            Op::Mul(a, b) => vec![(a, self.all_bits(a)), (b, self.all_bits(b))],
            Op::Lookup(a, _) => vec![(a, self.all_bits(a))],
            Op::Shl(a, _) | Op::Sar(a, _) | Op::Not(a) | Op::Widen(a) | Op::Narrow(a) => vec![(a, bits)],
        }
    }

    /// Bits a comparison looks at: those of the wider operand, and a sign for an unsigned one beside a signed one.
    pub(super) fn compared(&self, a: NodeId, b: NodeId) -> (u32, u32) {
        let (a, b) = (self.range(a), self.range(b));
        let signed = a.signed() || b.signed();
        let top = |range: Range| top(range) + u32::from(signed && !range.signed());
        (a.zeros.min(b.zeros), top(a).max(top(b)))
    }

    /// Bits among which leading zeros are counted.
    pub(super) fn counted(&self, a: NodeId) -> u32 {
        if self.range(a).signed() { self.context.net.node(a).kind.bits() } else { top(self.range(a)) }
    }

    /// Marks bits of a node as read in a stage.
    pub(super) fn read(&mut self, id: NodeId, bits: u128, stage: u32) {
        let Value::Bits(view) = self.value(id) else { return };
        let range = self.range(view.base);
        let mut wanted = 0_u64;
        for p in (0..128).filter(|p| bits >> p & 1 == 1) {
            let bit = p - view.shift;
            if view.limit.is_some_and(|limit| p >= limit) || bit < view.cut || bit < range.zeros as i32 {
                continue;
            }
            if bit < top(range) as i32 {
                wanted |= 1 << bit;
            } else if range.signed() {
                wanted |= 1 << (top(range) - 1);
            }
        }
        if wanted != 0 {
            *self.reads.entry(view.base).or_default().entry(stage).or_default() |= wanted;
        }
    }

    /// Bits of a wire read in `stage` or later, the registers to later stages included.
    pub(super) fn reads_from(&self, id: NodeId, stage: u32) -> u64 {
        let Some(reads) = self.reads.get(&id) else { return 0 };
        let now = reads.get(&stage).copied().unwrap_or(0);
        let later = reads.range(stage + 1..).fold(0, |all, (_, bits)| all | bits);
        let (low, high) = hull(later);
        now | if later == 0 { 0 } else { mask(low, high) as u64 }
    }

    /// Levels of a wire's operation.
    pub(super) fn levels(&self, id: NodeId) -> u32 {
        let net = self.context.net;
        let of = match (self.driver(id), self.op(id)) {
            // The comparison alone: the sign is not needed for it.
            (Driver::IsZero(_), Op::And(_, comparison)) => comparison,
            _ => id,
        };
        levels(net, self.context.ranges, of)
    }

    /// The wires of these nodes with these inputs and outputs.
    ///
    /// Errors: an operation alone is deeper than the target depth.
    pub(super) fn new(
        context: Context<'a>,
        nodes: &'a [NodeId],
        inputs: &[NodeId],
        outputs: &[NodeId],
    ) -> Result<Self, VerilogError> {
        let mut body = Self {
            context,
            nodes,
            values: HashMap::new(),
            stages: HashMap::new(),
            reads: HashMap::new(),
            names: HashMap::new(),
            last_stage: 0,
        };
        body.place(inputs)?;
        body.demand(outputs);
        Ok(body)
    }

    /// Resolves every node to a value and places every wire in a stage.
    pub(super) fn place(&mut self, inputs: &[NodeId]) -> Result<(), VerilogError> {
        let mut arrival: HashMap<NodeId, u32> = HashMap::new();
        for &input in inputs {
            self.stages.insert(input, 0);
            arrival.insert(input, 0);
        }
        for &id in self.nodes {
            if self.constant(id).is_some() {
                continue;
            }
            if let Some(value) = self.wiring(id) {
                self.values.insert(id, value);
                continue;
            }
            let bases: Vec<NodeId> = self
                .operands(self.driver(id), 1)
                .into_iter()
                .filter_map(|(operand, _)| match self.value(operand) {
                    Value::Bits(view) => Some(view.base),
                    Value::Constant(_) => None,
                })
                .collect();
            let mut stage = bases.iter().map(|base| self.stages[base]).max().unwrap_or(0);
            let there = bases.iter().filter(|base| self.stages[base] == stage).map(|base| arrival[base]);
            let levels = self.levels(id);
            let mut time = there.max().unwrap_or(0) + levels;
            if let Some(depth) = self.context.depth {
                if levels > depth {
                    let origin = self.context.net.origin(id);
                    return Err(VerilogError::TooDeep { operation: self.op(id).name(), levels, depth, origin });
                }
                if time > depth {
                    (stage, time) = (stage + 1, levels);
                }
            }
            self.stages.insert(id, stage);
            arrival.insert(id, time);
            self.last_stage = self.last_stage.max(stage);
        }
        Ok(())
    }

    /// Finds the bits of every wire that somebody reads, from the outputs back.
    pub(super) fn demand(&mut self, outputs: &[NodeId]) {
        for &output in outputs {
            self.read(output, self.all_bits(output), self.last_stage);
        }
        for &id in self.nodes.iter().rev() {
            let Some(reads) = self.reads.get(&id) else { continue };
            let bits = reads.values().fold(0, |all, bits| all | bits);
            let stage = self.stages[&id];
            for (operand, bits) in self.operands(self.driver(id), bits) {
                self.read(operand, bits, stage);
            }
        }
    }
}
