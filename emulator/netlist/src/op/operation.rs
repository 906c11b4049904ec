//! Properties of every operation.

use crate::graph::{Kind, NodeId};
use crate::range::{Exact, Ranges};
use crate::relational_facts::RelationalFacts;
use crate::unit::Unit;
use crate::verilog::body::Body;
use crate::verilog::value::Value;

/// An operation with its operands.
pub(super) trait Operation {
    /// Exact integer of an operation on a wire of the kind `kind`, from its operands. Undefined cases follow the scalar backend: a shift count is
    /// modulo the width of the wire, and an index outside a table reads 0.
    fn value(&self, kind: Kind, kind_of: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128;

    /// True if a shift count is below the width of the wire and an index is inside its table.
    fn is_defined(&self, _kind: Kind, _operand: impl Fn(NodeId) -> i64) -> bool {
        true
    }

    /// Exact range of the wire of node `id`, before it is known to fit; an undefined case is a violation.
    fn range(&self, known: &mut RelationalFacts, id: NodeId) -> Exact;

    /// Unit of hardware that node `id` takes, its widths from proven ranges.
    fn unit(&self, _ranges: &Ranges, _id: NodeId) -> Unit {
        Unit::Wires
    }

    /// Value of node `id` in the text, if wires are enough.
    fn wiring(&self, _body: &Body, _id: NodeId) -> Option<Value> {
        None
    }

    /// Lowest and one above the highest bit that is computed to deliver bits `low` up to `high`.
    fn span(&self, _body: &Body, low: u32, high: u32) -> (u32, u32) {
        (low, high)
    }

    /// Bits of each operand that are read to deliver `bits`, for which `first` up to `last` are computed.
    fn reads(&self, body: &Body, bits: u128, first: u32, last: u32) -> Vec<(NodeId, u128)>;

    /// Right-hand side that computes bits `first` up to `last` at a rank; `None` if there is no wire, or if an instance drives it.
    fn expression(&self, _body: &Body, _first: u32, _last: u32, _rank: u32) -> String {
        String::new()
    }
}
