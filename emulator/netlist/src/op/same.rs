//! Operations that keep the integer: widening, narrowing and claims.

use super::operation::Operation;
use crate::graph::{Kind, NodeId};
use crate::range::Exact;
use crate::relational_facts::RelationalFacts;
use crate::verilog::body::Body;
use crate::verilog::value::Value;

/// A word as a wide wire, or a wide wire as a word: bits of the operand.
pub(super) struct Resized(pub NodeId);

impl Operation for Resized {
    #[inline(always)]
    fn value(&self, _: Kind, _: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128 {
        operand(self.0).into()
    }
    fn range(&self, known: &mut RelationalFacts, _: NodeId) -> Exact {
        known.range(self.0)
    }
    fn wiring(&self, body: &Body, _: NodeId) -> Option<Value> {
        Some(Value::Bits(body.view(self.0)?))
    }
    fn reads(&self, _: &Body, bits: u128, _: u32, _: u32) -> Vec<(NodeId, u128)> {
        vec![(self.0, bits)]
    }
}

/// The operand, claimed to be in low ..= high by a lemma: a wire of fewer bits.
pub(super) struct Claim {
    pub of: NodeId,
    pub low: i64,
    pub high: i64,
}

impl Operation for Claim {
    #[inline(always)]
    fn value(&self, _: Kind, _: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128 {
        operand(self.of).into()
    }
    fn range(&self, known: &mut RelationalFacts, _: NodeId) -> Exact {
        known.range(self.of).within(self.low.into(), self.high.into())
    }
    fn reads(&self, _: &Body, bits: u128, _: u32, _: u32) -> Vec<(NodeId, u128)> {
        vec![(self.of, bits)]
    }
    fn expression(&self, body: &Body, first: u32, last: u32, rank: u32) -> String {
        body.text(self.of, first, last, rank).code
    }
}
