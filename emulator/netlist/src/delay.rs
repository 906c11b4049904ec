//! The unit-delay model: gate levels of an operation, of a stage and of a design.
//!
//! A level is one gate of two inputs or one select; inverters and wires are free. Widths are those of the proven ranges
//! without constant low zeros.
//!
//! | operation | levels |
//! |---|---|
//! | add, sub of w bits (parallel prefix) | ⌈log₂ w⌉ + 2: generate and propagate, prefix tree, sum |
//! | lt of w bits; with 0, which is the sign bit | ⌈log₂ w⌉ + 1; 0 |
//! | mul of w × v bits, w ≤ v | 1 + 2·d(w) + ⌈log₂(w + v)⌉ + 2: partial products, carry-save tree of d levels, sum |
//! | mul by a constant | without partial products; a row a non-zero signed digit (one row is a shift) |
//! | shift by a count | bits of the count |
//! | leading zeros of w bits | ⌈log₂ w⌉ + 1 |
//! | table of n entries that can be read | ⌈log₂ n⌉ |
//! | and, or, xor, select | 1 |

use super::graph::{Net, NodeId};
use super::range::{Range, Ranges};
use super::unit::{Unit, signed_digits};

/// ⌈log₂ n⌉ of n ≥ 1; 0 of 0.
pub(super) fn log2_above(n: u32) -> u32 {
    n.next_power_of_two().ilog2()
}

/// Levels of full adders that bring `rows` rows to two (Dadda): 3 rows take 1, 4 take 2, 6 take 3, 9 take 4, …
fn carry_save_levels(rows: u32) -> u32 {
    let mut levels = 0;
    let mut reach = 2;
    while reach < rows {
        reach = reach * 3 / 2;
        levels += 1;
    }
    levels
}

fn adder_levels(bits: u32) -> u32 {
    log2_above(bits) + 2
}

/// Gate levels of one operation, from its operands to its wire.
pub fn levels(net: &Net, ranges: &Ranges, id: NodeId) -> u32 {
    unit_levels(net.node(id).op.unit(ranges, id))
}

/// Gate levels of a unit.
pub(super) fn unit_levels(unit: Unit) -> u32 {
    match unit {
        Unit::Nothing | Unit::Wires => 0,
        Unit::Adder { bits, .. } => adder_levels(bits),
        Unit::Comparator { bits } => adder_levels(bits) - 1,
        Unit::Multiplier(operands) => {
            let [w, v] = operands.map(|operand| operand.width());
            1 + 2 * carry_save_levels(w.min(v)) + adder_levels(w + v)
        }
        Unit::ConstantMultiplier { by, operand } => {
            2 * carry_save_levels(signed_digits(by)) + adder_levels(operand.width() + Range::of(by).width())
        }
        Unit::Shifter { places, .. } => places,
        Unit::LeadingZeros { bits } => log2_above(bits) + 1,
        Unit::Table { entries } => log2_above(entries),
        Unit::Mask | Unit::Logic { .. } | Unit::Select { .. } => 1,
    }
}

/// Arrival times of the wires, in levels from the ports.
pub fn arrival(net: &Net, ranges: &Ranges) -> Vec<u32> {
    arrival_where(net, ranges, |_, _| true)
}

/// Arrival times of the wires, in levels from the inputs of their stage: ports, and wires of other stages.
pub fn arrival_in_block(net: &Net, ranges: &Ranges) -> Vec<u32> {
    arrival_where(net, ranges, |user, operand| net.node(user).stage == net.node(operand).stage)
}

fn arrival_where(net: &Net, ranges: &Ranges, counts: impl Fn(NodeId, NodeId) -> bool) -> Vec<u32> {
    let mut times: Vec<u32> = Vec::with_capacity(net.nodes.len());
    for (id, node) in net.iter() {
        let operands = node.op.operands().filter(|&operand| counts(id, operand));
        let inputs = operands.map(|operand| times[operand as usize]).max().unwrap_or(0);
        times.push(inputs + levels(net, ranges, id));
    }
    times
}

/// Levels of every run of a stage, from its inputs to its last outcome, in the order of [`Net::runs`].
pub fn block_levels(net: &Net, ranges: &Ranges) -> Vec<u32> {
    let times = arrival_in_block(net, ranges);
    let mut levels = vec![0; net.runs.len()];
    for (node, &time) in net.nodes.iter().zip(&times) {
        if let Some(stage) = node.stage {
            let level = &mut levels[stage as usize];
            *level = time.max(*level);
        }
    }
    levels
}

/// Critical path of a stage from its inputs to its last outcome, or of the whole net from the ports. It lists the nodes that take any time, first to
/// last.
pub fn critical_path(net: &Net, ranges: &Ranges, stage: Option<u32>) -> Vec<NodeId> {
    let counts = |id: &NodeId| stage.is_none() || net.node(*id).stage == stage;
    let times = if stage.is_some() { arrival_in_block(net, ranges) } else { arrival(net, ranges) };
    let last = net.iter().map(|(id, _)| id).filter(counts).max_by_key(|&id| times[id as usize]);
    let mut path = Vec::new();
    let mut at = last;
    while let Some(id) = at {
        let own = levels(net, ranges, id);
        if own > 0 {
            path.push(id);
        }
        let before = times[id as usize] - own;
        let mut operands = net.node(id).op.operands().filter(counts);
        at = operands.find(|&operand| before > 0 && times[operand as usize] == before);
    }
    path.reverse();
    path
}
