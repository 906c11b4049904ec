//! Leading zero bits.

use super::operation::Operation;
use crate::graph::{Kind, NodeId};
use crate::range::{Exact, Ranges};
use crate::relational_facts::RelationalFacts;
use crate::unit::Unit;
use crate::verilog::body::{Body, mask};

/// Leading zero bits of a wire as wide as the operand's kind: an instance of a counter (`verilog/rom.rs`).
pub(super) struct LeadingZeros(pub NodeId);

impl Operation for LeadingZeros {
    #[inline(always)]
    fn value(&self, _: Kind, kind_of: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128 {
        let zeros = operand(self.0).leading_zeros();
        // The integer of a narrower wire is on 64 bits. A negative one has no leading zeros, any other has the extra bits too.
        zeros.saturating_sub(i64::BITS - kind_of(self.0).bits()).into()
    }
    fn range(&self, known: &mut RelationalFacts, _: NodeId) -> Exact {
        let width = known.net.node(self.0).kind.bits();
        let a = known.range(self.0);
        let zeros = |value: i128| i128::from(width) - i128::from(128 - value.leading_zeros());
        let low = if a.high < 0 { 0 } else { zeros(a.high) };
        if a.low < 0 {
            Exact { low: 0, high: if a.high < 0 { 0 } else { width.into() }, zeros: 0 }
        } else {
            Exact { low, high: zeros(a.low), zeros: 0 }
        }
    }
    fn unit(&self, ranges: &Ranges, _: NodeId) -> Unit {
        Unit::LeadingZeros { bits: ranges.of(self.0).width() }
    }
    fn span(&self, _: &Body, _: u32, high: u32) -> (u32, u32) {
        (0, high)
    }
    fn reads(&self, body: &Body, _: u128, _: u32, _: u32) -> Vec<(NodeId, u128)> {
        vec![(self.0, mask(0, body.counted(self.0)))]
    }
}
