//! The interval walk derives the range of every wire from the declared ranges of the ports. It proves that no operation leaves its word for any
//! input.
//!
//! A range is an interval and a power of two that divides every value. The range of an operation is defined with the operation (folder `op`); facts
//! about dependent wires are in `relational_facts.rs`.

use super::graph::{Net, NodeId};
use super::range::Exact;
pub use super::range::{Range, Ranges, Violation};
use super::relational_facts::RelationalFacts;

impl Ranges {
    /// Walks a net.
    pub fn new(net: &Net) -> Self {
        let mut known = RelationalFacts::new(net, Vec::with_capacity(net.nodes.len()));
        for (id, node) in net.iter() {
            let exact = node.op.range(&mut known, id);
            let range = fitted(&mut known, id, exact);
            known.ranges.push(range);
        }
        Self { ranges: known.ranges, violations: known.violations }
    }
}

/// Exact range fitted to the wire; a violation if it does not fit.
fn fitted(known: &mut RelationalFacts, id: NodeId, exact: Exact) -> Range {
    let (kind, name) = (known.net.node(id).kind, known.op(id).name());
    let (low, high) = kind.limits();
    if exact.low < i128::from(low) || exact.high > i128::from(high) {
        known.violation(id, format!("{name} may be {} … {}, beyond {} bits", exact.low, exact.high, kind.bits()));
        return Range { low, high, zeros: 0 };
    }
    if exact.low > exact.high {
        known.violation(id, format!("{name} contradicts what is known of its operand"));
        return Range { low, high, zeros: 0 };
    }
    // Only multiples of 2^zeros occur.
    let zeros = exact.zeros.min(62);
    let (low, high) = ((-(-exact.low >> zeros) << zeros) as i64, (exact.high >> zeros << zeros) as i64);
    if low == high { Range::of(low) } else { Range { low, high, zeros } }
}
