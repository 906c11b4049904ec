//! Ports and constants.

use super::operation::Operation;
use crate::graph::{Kind, NodeId};
use crate::range::{Exact, Range, Ranges};
use crate::relational_facts::RelationalFacts;
use crate::unit::Unit;
use crate::verilog::body::Body;

/// A port by its number. The evaluator sets it.
pub(super) struct Port(pub u32);

impl Operation for Port {
    #[inline(always)]
    fn value(&self, _: Kind, _: impl Fn(NodeId) -> Kind, _: impl Fn(NodeId) -> i64) -> i128 {
        0
    }
    fn range(&self, known: &mut RelationalFacts, _: NodeId) -> Exact {
        let port = &known.net.ports[self.0 as usize];
        Exact { low: port.low.into(), high: port.high.into(), zeros: port.zeros }
    }
    fn unit(&self, _: &Ranges, _: NodeId) -> Unit {
        Unit::Nothing
    }
    fn reads(&self, _: &Body, _: u128, _: u32, _: u32) -> Vec<(NodeId, u128)> {
        Vec::new()
    }
}

/// A constant.
pub(super) struct Lit(pub i64);

impl Operation for Lit {
    #[inline(always)]
    fn value(&self, _: Kind, _: impl Fn(NodeId) -> Kind, _: impl Fn(NodeId) -> i64) -> i128 {
        self.0.into()
    }
    fn range(&self, _: &mut RelationalFacts, _: NodeId) -> Exact {
        Exact::of(Range::of(self.0))
    }
    fn unit(&self, _: &Ranges, _: NodeId) -> Unit {
        Unit::Nothing
    }
    fn reads(&self, _: &Body, _: u128, _: u32, _: u32) -> Vec<(NodeId, u128)> {
        Vec::new()
    }
}
