//! What every operation says of itself.

use crate::graph::{Kind, NodeId};
use crate::range::{Exact, Ranges};
use crate::relational_facts::RelationalFacts;
use crate::unit::Unit;
use crate::verilog::body::Body;
use crate::verilog::value::Value;

/// An operation with its operands.
pub(super) trait Operation {
    /// The exact integer, of operands that are given, on a wire of the kind `kind`. What is not defined is as in the scalar reading: a
    /// shift count modulo the width of the wire, 0 for what is not in a table.
    fn value(&self, kind: Kind, kind_of: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128;

    /// Whether a shift count is below the width of the wire, an index inside its table.
    fn is_defined(&self, _kind: Kind, _operand: impl Fn(NodeId) -> i64) -> bool {
        true
    }

    /// What the wire of node `id` can hold, before it is known to fit; what is not defined is a violation.
    fn range(&self, known: &mut RelationalFacts, id: NodeId) -> Exact;

    /// The unit of hardware that node `id` takes, its widths from proven ranges.
    fn unit(&self, _ranges: &Ranges, _id: NodeId) -> Unit {
        Unit::Wires
    }

    /// What stands for node `id` in the text where wires are enough.
    fn wiring(&self, _body: &Body, _id: NodeId) -> Option<Value> {
        None
    }

    /// Lowest and one above the highest bit that is computed to deliver bits `low` up to `high`.
    fn span(&self, _body: &Body, low: u32, high: u32) -> (u32, u32) {
        (low, high)
    }

    /// The bits of each operand that are read to deliver `bits`, for which `first` up to `last` are computed.
    fn reads(&self, body: &Body, bits: u128, first: u32, last: u32) -> Vec<(NodeId, u128)>;

    /// The right-hand side that computes bits `first` up to `last` at a rank; none where there is no wire, or an instance drives it.
    fn expression(&self, _body: &Body, _first: u32, _last: u32, _rank: u32) -> String {
        String::new()
    }
}
