//! Drivers of the wires of a stage, the ranks at which they are made, and the bits that somebody reads.

use std::collections::HashMap;

use super::body::{Body, hull};
use super::context::Context;
use super::error::VerilogError;
use super::value::{Value, literal};
use crate::graph::{NodeId, Op};

/// Driver of a wire.
#[derive(Clone, Copy)]
pub(super) enum Driver {
    /// The operation of the node.
    Op(Op),
    /// Test of a node for zero.
    IsZero(NodeId),
    /// Test of a node for not zero.
    IsNotZero(NodeId),
}

impl<'a> Body<'a> {
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

    /// Lowest and one above the highest bit that is computed to deliver bits `low` up to `high`.
    pub(super) fn span(&self, driver: Driver, low: u32, high: u32) -> (u32, u32) {
        match driver {
            Driver::Op(op) => op.span(self, low, high),
            Driver::IsZero(_) | Driver::IsNotZero(_) => (low, high),
        }
    }

    /// Bits of the operands that are read to deliver `bits`.
    pub(super) fn operands(&self, driver: Driver, bits: u64) -> Vec<(NodeId, u128)> {
        let (low, high) = hull(bits);
        let (first, last) = self.span(driver, low, high);
        match driver {
            Driver::Op(op) => op.reads(self, bits.into(), first, last),
            Driver::IsZero(x) | Driver::IsNotZero(x) => vec![(x, self.all_bits(x))],
        }
    }

    /// The right-hand side that computes bits `first` up to `last`.
    pub(super) fn expression(&self, driver: Driver, first: u32, last: u32, rank: u32) -> String {
        let (x, sign) = match driver {
            Driver::Op(op) => return op.expression(self, first, last, rank),
            Driver::IsZero(x) => (x, "=="),
            Driver::IsNotZero(x) => (x, "!="),
        };
        let (low, high) = (self.range(x).zeros, self.range(x).top());
        format!("{} {sign} {}", self.text(x, low, high, rank).code, literal(0, high - low))
    }

    /// Marks bits of a node as read at a rank.
    pub(super) fn read(&mut self, id: NodeId, bits: u128, rank: u32) {
        let Value::Bits(view) = self.value(id) else { return };
        let range = self.range(view.base);
        let mut wanted = 0_u64;
        for p in (0..128).filter(|p| bits >> p & 1 == 1) {
            let bit = p - view.shift;
            if view.limit.is_some_and(|limit| p >= limit) || bit < view.cut || bit < range.zeros as i32 {
                continue;
            }
            if bit < range.top() as i32 {
                wanted |= 1 << bit;
            } else if range.signed() {
                wanted |= 1 << (range.top() - 1);
            }
        }
        if wanted != 0 {
            *self.reads.entry(view.base).or_default().entry(rank).or_default() |= wanted;
        }
    }

    /// Levels of a wire's operation.
    pub(super) fn levels(&self, id: NodeId) -> u32 {
        let of = match (self.driver(id), self.op(id)) {
            // Only the comparison counts, for it does not need the sign.
            (Driver::IsZero(_), Op::And(_, comparison)) => comparison,
            _ => id,
        };
        self.context.levels(of)
    }

    /// Body with the wires of these nodes, with these inputs and outputs.
    ///
    /// Errors: a single operation is deeper than the target depth.
    pub(super) fn new(
        context: Context<'a>,
        nodes: &'a [NodeId],
        inputs: &[NodeId],
        outputs: &[NodeId],
    ) -> Result<Self, VerilogError> {
        let mut body = Self::placed(context, nodes, inputs)?;
        body.demand(outputs);
        Ok(body)
    }

    /// Body with the wires of these nodes, of which nobody reads anything yet.
    ///
    /// Errors: a single operation is deeper than the target depth.
    pub(super) fn placed(context: Context<'a>, nodes: &'a [NodeId], inputs: &[NodeId]) -> Result<Self, VerilogError> {
        let mut body = Self {
            context,
            nodes,
            values: HashMap::new(),
            ranks: HashMap::new(),
            reads: HashMap::new(),
            names: HashMap::new(),
            last_rank: 0,
            registers: HashMap::new(),
        };
        body.place(inputs)?;
        Ok(body)
    }

    /// Resolves every node to a value and places every wire at a rank.
    pub(super) fn place(&mut self, inputs: &[NodeId]) -> Result<(), VerilogError> {
        // First rank at which a wire can be read, and levels before it there.
        let mut arrivals: HashMap<NodeId, (u32, u32)> = HashMap::new();
        for &input in inputs {
            self.ranks.insert(input, 0);
            arrivals.insert(input, (0, 0));
        }
        for &id in self.nodes {
            if self.constant(id).is_some() {
                continue;
            }
            if let Some(value) = self.op(id).wiring(self, id) {
                self.values.insert(id, value);
                continue;
            }
            let operands = self.operands(self.driver(id), 1).into_iter();
            let bases = operands.filter_map(|(operand, _)| match self.value(operand) {
                Value::Bits(view) => Some(view.base),
                Value::Constant(_) => None,
            });
            let (mut rank, before) = bases.map(|base| arrivals[&base]).max().unwrap_or((0, 0));
            let levels = self.levels(id);
            let mut arrival = (rank, before + levels);
            if let Some(depth) = self.context.depth {
                if levels > depth {
                    let origin = self.context.net.origin(id);
                    let least = self.context.least_depth();
                    return Err(VerilogError::TooDeep { operation: self.op(id).name(), levels, depth, least, origin });
                }
                if self.context.is_clocked(id) {
                    arrival = (rank + 1, levels);
                } else if before + levels > depth {
                    rank += 1;
                    arrival = (rank, levels);
                }
            }
            self.ranks.insert(id, rank);
            arrivals.insert(id, arrival);
            self.last_rank = self.last_rank.max(arrival.0);
        }
        Ok(())
    }

    /// Finds the bits of every wire that somebody reads, from the outputs backwards.
    pub(super) fn demand(&mut self, outputs: &[NodeId]) {
        for &output in outputs {
            self.read(output, self.all_bits(output), self.last_rank);
        }
        for &id in self.nodes.iter().rev() {
            let Some(reads) = self.reads.get(&id) else { continue };
            let bits = reads.values().fold(0, |all, bits| all | bits);
            let rank = self.ranks[&id];
            for (operand, bits) in self.operands(self.driver(id), bits) {
                self.read(operand, bits, rank);
            }
        }
    }
}
