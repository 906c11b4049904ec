//! Entries of tables.

use super::operation::Operation;
use crate::graph::{Kind, NodeId, Table};
use crate::range::{Exact, Ranges};
use crate::relational_facts::RelationalFacts;
use crate::unit::Unit;
use crate::verilog::body::Body;
use crate::verilog::rom::Rom;

/// Entry of a table at an index: an instance of a ROM (`verilog/module.rs`).
pub(super) struct Lookup(pub NodeId, pub Table);

impl Lookup {
    fn entry(&self, index: i64) -> Option<i32> {
        usize::try_from(index).ok().and_then(|index| self.1.entry(index))
    }
}

impl Operation for Lookup {
    #[inline(always)]
    fn value(&self, _: Kind, _: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128 {
        self.entry(operand(self.0)).unwrap_or(0).into()
    }
    fn is_defined(&self, _: Kind, operand: impl Fn(NodeId) -> i64) -> bool {
        self.entry(operand(self.0)).is_some()
    }
    fn range(&self, known: &mut RelationalFacts, id: NodeId) -> Exact {
        let index = known.range(self.0);
        let last = self.1.entries.len() as i128 - 1;
        if index.low < 0 || index.high > last {
            known.violation(id, format!("lookup at {} … {} in a table of {}", index.low, index.high, last + 1));
        }
        let (first, last) = (index.low.clamp(0, last) as usize, index.high.clamp(0, last) as usize);
        let entries = self.1.on_words().skip(first).take(last - first + 1);
        let zeros = entries.clone().filter(|entry| *entry != 0).map(i32::trailing_zeros).min();
        Exact::corners(entries.map(i128::from), zeros.unwrap_or(63))
    }
    fn unit(&self, ranges: &Ranges, _: NodeId) -> Unit {
        let index = ranges.of(self.0);
        Unit::Table { entries: (index.high - index.low + 1) as u32 }
    }
    fn span(&self, _: &Body, _: u32, high: u32) -> (u32, u32) {
        let entries = Rom::format(self.1);
        (entries.zeros, high.max(entries.range.top()))
    }
    fn reads(&self, body: &Body, _: u128, _: u32, _: u32) -> Vec<(NodeId, u128)> {
        vec![(self.0, body.all_bits(self.0))]
    }
}
