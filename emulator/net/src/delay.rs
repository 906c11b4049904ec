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

use super::graph::{Net, NodeId, Op};
use super::interval::Ranges;

/// ⌈log₂ n⌉ of n ≥ 1; 0 of 0.
fn log2_above(n: u32) -> u32 {
    n.next_power_of_two().ilog2()
}

/// Bits of an adder, subtracter or comparator that has work to do: from the lowest bit in which the second operand
/// is not constantly zero (of an addition, both) to the highest of the outcome. 0 where wires are enough: the remainder
/// of a power of two, two's complement of the sign bit alone. `None` for other operations.
pub fn carry_bits(net: &Net, ranges: &Ranges, id: NodeId) -> Option<u32> {
    let top = |id| ranges.of(id).width() + ranges.of(id).zeros;
    let bits = match net.node(id).op {
        Op::Add(a, b) => top(id).saturating_sub(ranges.of(a).zeros.max(ranges.of(b).zeros)),
        Op::Sub(_, b) => top(id).saturating_sub(ranges.of(b).zeros),
        // The difference with 0 is the operand itself; its sign is there.
        Op::Lt(_, b) if ranges.of(b).constant() == Some(0) => 0,
        Op::Lt(a, b) => {
            let signed = ranges.of(a).signed() || ranges.of(b).signed();
            let bits = |id| top(id) + u32::from(signed && !ranges.of(id).signed());
            bits(a).max(bits(b)).saturating_sub(ranges.of(b).zeros)
        }
        _ => return None,
    };
    Some(bits)
}

/// Non-zero digits of a constant in canonical signed digits: rows of a multiplier by it.
pub fn signed_digits(constant: i64) -> u32 {
    let n = i128::from(constant).abs();
    // Digits of n in that form are where n and 3n differ.
    (n ^ (3 * n)).count_ones()
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
    if bits == 0 { 0 } else { log2_above(bits) + 2 }
}

/// Entries of its table that a lookup can read.
pub fn entries_read(ranges: &Ranges, index: NodeId) -> u32 {
    let index = ranges.of(index);
    (index.high - index.low + 1) as u32
}

/// Gate levels of one operation, from its operands to its wire.
pub fn levels(net: &Net, ranges: &Ranges, id: NodeId) -> u32 {
    let range = |id| ranges.of(id);
    match net.node(id).op {
        Op::Port(_) | Op::Lit(_) | Op::Shl(..) | Op::Sar(..) | Op::Not(_) => 0,
        Op::Widen(_) | Op::Narrow(_) | Op::Claim { .. } => 0,
        Op::Add(..) | Op::Sub(..) => adder_levels(carry_bits(net, ranges, id).unwrap_or(0)),
        Op::Lt(..) => adder_levels(carry_bits(net, ranges, id).unwrap_or(0)).saturating_sub(1),
        Op::Mul(a, b) => {
            let [w, v] = [range(a).width(), range(b).width()];
            match (range(a).constant(), range(b).constant()) {
                (None, None) => 1 + 2 * carry_save_levels(w.min(v)) + adder_levels(w + v),
                (Some(constant), _) | (_, Some(constant)) => match signed_digits(constant) {
                    0 | 1 => 0,
                    rows => 2 * carry_save_levels(rows) + adder_levels(w + v),
                },
            }
        }
        Op::ShlBy(_, count) | Op::SarBy(_, count) => range(count).width(),
        Op::LeadingZeros(a) => log2_above(range(a).width()) + 1,
        Op::Lookup(index, _) => log2_above(entries_read(ranges, index)),
        Op::And(..) | Op::Or(..) | Op::Xor(..) | Op::Select(..) => 1,
    }
}

/// When each wire is there, in levels from the ports.
pub fn arrival(net: &Net, ranges: &Ranges) -> Vec<u32> {
    arrival_where(net, ranges, |_, _| true)
}

/// When each wire is there, in levels from the inputs of its stage: ports, and wires of other stages.
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

/// A critical path of a stage, from its inputs to its last outcome, or of the whole net from the ports: the nodes on it
/// that take any time, first to last.
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
