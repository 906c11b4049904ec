//! Observation: values that the wires of a net carry for given fragments, next to the ranges of the interval walk.
//!
//! An interval is proven for every pattern of bits at every port. The observed values show how much of it serves cases that do not occur. A value
//! outside the proven range would be an error of the walk.

use super::graph::{Net, NodeId};
use super::interval::{Range, Ranges};

/// Values that one wire has carried.
#[derive(Clone, Copy, Debug)]
struct Seen {
    low: i64,
    high: i64,
    /// Every bit that was ever set.
    bits: i64,
}

/// Values that the wires of a net have carried so far.
#[derive(Clone, Debug)]
pub struct Observed {
    /// Evaluations so far.
    pub evaluations: u64,
    seen: Vec<Seen>,
    wires: Vec<i64>,
}

impl Observed {
    /// An observation without evaluations.
    pub fn new(net: &Net) -> Self {
        let seen = vec![Seen { low: i64::MAX, high: i64::MIN, bits: 0 }; net.nodes.len()];
        Self { evaluations: 0, seen, wires: Vec::new() }
    }

    /// Computes every wire of `net` from the integers of the ports, and records the values. `net` is the one of `new`. Returns the wires, one a node.
    pub fn evaluate(&mut self, net: &Net, ports: &[i64]) -> &[i64] {
        net.evaluate(ports, &mut self.wires);
        self.evaluations += 1;
        for (seen, &value) in self.seen.iter_mut().zip(&self.wires) {
            *seen = Seen { low: seen.low.min(value), high: seen.high.max(value), bits: seen.bits | value };
        }
        &self.wires
    }

    /// Range of the values of a wire; `None` before the first evaluation.
    pub fn of(&self, id: NodeId) -> Option<Range> {
        let Seen { low, high, bits } = *self.seen.get(id as usize)?;
        let range = Range { low, high, zeros: bits.trailing_zeros().min(62) };
        (low <= high).then_some(if low == high { Range::of(low) } else { range })
    }

    /// First wire outside its proven range. There is none, unless the interval walk is wrong.
    pub fn first_outside(&self, ranges: &Ranges) -> Option<NodeId> {
        (0..self.seen.len() as NodeId).find(|&id| {
            let proven = ranges.of(id);
            self.of(id).is_some_and(|seen| {
                seen.low < proven.low || seen.high > proven.high || seen.zeros < proven.zeros.min(62)
            })
        })
    }
}
