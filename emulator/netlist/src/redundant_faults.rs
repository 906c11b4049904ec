//! Redundant faults: proof that no vector can show a replaced operation, or a wrong table entry that is read at one place.
//!
//! A fault makes a difference only if its wire does, which is a condition on wires of the right design. For example, "always the first value" matters
//! only if the choice's flag is clear. The condition narrows the ranges of the wires before and after it, as long as one range follows from another.
//! If nothing is left of a range, the condition never holds. Otherwise the proof follows the difference from the fault to the fields, with ranges of
//! the wrong design. After a wire that is the same constant in both designs nothing differs.
//!
//! Backward rules assume integer operations without overflow, so a design whose ranges are not proven has no such proof. Forward ranges are those of
//! the operations themselves (folder `op`). Claims hold in the right design only, and an operation that overflows in the wrong one may give anything.
//! Four lemmas extend those of `relational_facts.rs`:
//! - A normalisation keeps the sign.
//! - If all other wires that are normalised together are smaller than half of a wire's limit, the one left is 0 or at least that half.
//! - A maximum is no smaller than its operands.
//! - A rounding of a value without bits below its last place adds nothing.

mod narrow;

use std::collections::BTreeSet;

use super::evaluate::apply_exactly;
use super::fault::{Fault, Faults};
use super::graph::{Kind, NodeId, Op};
use super::operator_fault::{OperatorFault, Side};
use super::range::{Exact, Range};
use super::relational_facts::RelationalFacts;

/// Most revisions of one condition. After them the ranges stay as they are, which is sound.
const MOST_REVISIONS: usize = 20_000;
/// Most flags on which a proof may depend one after the other, and most flags that are tried for each of them.
const MOST_FLAGS: u32 = 2;
const FLAGS_TRIED: usize = 3;

/// Bounds of wires that hold together.
type Condition = Vec<(NodeId, i128, i128)>;

/// Fault at a node.
#[derive(Clone, Copy)]
enum Wrong {
    /// Its operation is replaced.
    OperatorFault(OperatorFault),
    /// Its lookup reads this value.
    Value(i64),
}

/// Error of an empty range: the condition never holds.
struct Never;

/// Prover of redundant faults of a design, one after the other.
pub struct Prover<'a> {
    faults: &'a Faults<'a>,
    /// Facts about wires of the right design under the condition.
    right: RelationalFacts<'a>,
    /// Facts about the same wires in the wrong design.
    wrong: RelationalFacts<'a>,
    /// Nodes whose ranges differ from the proven ones.
    moved: Vec<NodeId>,
}

impl<'a> Prover<'a> {
    /// Prover for the faults of a design.
    pub fn new(faults: &'a Faults<'a>) -> Self {
        let known = || RelationalFacts::new(faults.net, faults.ranges.ranges.clone());
        Self { faults, right: known(), wrong: known(), moved: Vec::new() }
    }

    /// True if an operator fault, or a wrong entry of a table that one lookup reads, is proven redundant. It is `false` if that is not proven, and
    /// for all other faults.
    pub fn is_equal(&mut self, fault: Fault) -> bool {
        let is_proven = self.faults.ranges.violations.is_empty();
        match fault {
            Fault::OperatorFault { node, slip } => {
                let mut conditions = self.conditions(node, slip).into_iter();
                is_proven && conditions.all(|of| self.is_equal_under(node, Wrong::OperatorFault(slip), &of, MOST_FLAGS))
            }
            Fault::Entry { table, index, more } => {
                let read = &self.faults.tables[table as usize];
                let (&[(node, at)], Some(value)) = (&read.lookups[..], read.wrong(index, more)) else { return false };
                let condition = vec![(at, index.into(), index.into())];
                is_proven && self.is_equal_under(node, Wrong::Value(value), &condition, MOST_FLAGS)
            }
            Fault::Stuck { .. } => false,
        }
    }

    /// True if no field differs under a condition. If that is not seen at once, both values of a flag are tried.
    fn is_equal_under(&mut self, node: NodeId, wrong: Wrong, condition: &Condition, flags: u32) -> bool {
        let mut open = Vec::new();
        let is_equal = match self.narrow(condition) {
            Ok(()) => !self.is_shown(node, wrong, &mut open),
            Err(Never) => true,
        };
        for id in self.moved.drain(..) {
            self.right.ranges[id as usize] = self.faults.ranges.of(id);
            self.wrong.ranges[id as usize] = self.faults.ranges.of(id);
        }
        self.wrong.opaque.clear();
        self.right.violations.clear();
        self.wrong.violations.clear();
        is_equal
            || flags > 0
                && open.into_iter().take(FLAGS_TRIED).any(|flag| {
                    [0, 1].into_iter().all(|set| {
                        let with_flag = [condition.as_slice(), &[(flag, set, set)]].concat();
                        self.is_equal_under(node, wrong, &with_flag, flags - 1)
                    })
                })
    }

    /// Conditions, of which one holds if the wire differs.
    fn conditions(&self, node: NodeId, slip: OperatorFault) -> Vec<Condition> {
        let of = |id: NodeId| self.right.range(id);
        let is = |id: NodeId, value: i128| (id, value, value);
        let negative = |id: NodeId| (id, i128::MIN, -1);
        let not_negative = |id: NodeId| (id, 0, i128::MAX);
        // Not zero, as far as an interval can say so.
        let not_zero = |id: NodeId| {
            let Exact { low, high, .. } = of(id);
            (id, if low == 0 { 1 } else { low }, if high == 0 { -1 } else { high })
        };
        match (slip, self.right.op(node)) {
            (OperatorFault::Always(side), Op::Select(flag, ..)) => {
                vec![vec![is(flag, i128::from(side == Side::Second))]]
            }
            (OperatorFault::Swapped, Op::Select(flag, ..)) => vec![vec![is(flag, 0)], vec![is(flag, 1)]],
            (OperatorFault::OrEqual, Op::Lt(a, b)) => {
                let (low, high) = (of(a).low.max(of(b).low), of(a).high.min(of(b).high));
                vec![vec![is(node, 0), (a, low, high), (b, low, high)]]
            }
            (OperatorFault::Swapped, Op::Lt(..)) => vec![vec![is(node, 0)], vec![is(node, 1)]],
            (OperatorFault::Unsigned(Side::First), Op::Mul(a, _) | Op::Sar(a, _) | Op::SarBy(a, _)) => {
                vec![vec![negative(a)]]
            }
            (OperatorFault::Unsigned(Side::Second), Op::Mul(_, b)) => vec![vec![negative(b)]],
            (OperatorFault::OtherGate, Op::And(a, b) | Op::Or(a, b)) if self.kind(node) == Kind::Flag => {
                vec![vec![is(a, 0), is(b, 1)], vec![is(a, 1), is(b, 0)]]
            }
            (OperatorFault::OtherGate, Op::And(a, b) | Op::Or(a, b)) => {
                let sides = [negative, not_negative];
                sides.iter().flat_map(|first| sides.iter().map(move |second| vec![first(a), second(b)])).collect()
            }
            // Both operands have a set bit.
            (OperatorFault::OtherGate, Op::Xor(a, b)) => vec![vec![not_zero(a), not_zero(b)]],
            (OperatorFault::Sign, Op::Add(_, b) | Op::Sub(_, b)) => vec![vec![not_zero(b)]],
            // Only the number with the fewest leading zeros matters: a power of two has no bits below it.
            (OperatorFault::WithoutConstant, Op::Add(a, _)) => {
                let signs = [negative(a), is(a, 0), (a, 1, i128::MAX)];
                let Some((_, count)) = self.shifted(a) else { return signs.map(|sign| vec![sign]).into() };
                let counts = [is(count, of(count).low), (count, of(count).low + 1, i128::MAX)];
                signs.iter().flat_map(|&sign| counts.map(|count| vec![sign, count])).collect()
            }
            (
                OperatorFault::Further | OperatorFault::Nearer,
                Op::Shl(a, _) | Op::Sar(a, _) | Op::ShlBy(a, _) | Op::SarBy(a, _),
            ) => {
                vec![vec![negative(a)], vec![(a, 1, i128::MAX)]]
            }
            _ => vec![Vec::new()],
        }
    }

    fn kind(&self, id: NodeId) -> Kind {
        self.faults.net.node(id).kind
    }

    /// Narrows the ranges of all wires that a condition restricts.
    fn narrow(&mut self, condition: &Condition) -> Result<(), Never> {
        let mut waiting = BTreeSet::new();
        for &(id, low, high) in condition {
            self.meet(id, low, high, &mut waiting)?;
        }
        for _ in 0..MOST_REVISIONS {
            let Some(id) = waiting.pop_first() else { break };
            let exact = self.right_range(id);
            self.meet(id, exact.low, exact.high, &mut waiting)?;
            self.narrow_operands(id, &mut waiting)?;
        }
        Ok(())
    }

    /// Intersects the range of a wire with bounds. If that narrows the range, the wire and its readers wait for a new look.
    fn meet(&mut self, id: NodeId, low: i128, high: i128, waiting: &mut BTreeSet<NodeId>) -> Result<(), Never> {
        let old = self.right.ranges[id as usize];
        let exact = Exact::of(old).within(low, high);
        // Only multiples of 2^zeros occur.
        let zeros = old.zeros.min(62);
        let (low, high) = (-(-exact.low >> zeros) << zeros, exact.high >> zeros << zeros);
        if low > high {
            return Err(Never);
        }
        let (low, high) = (low as i64, high as i64);
        let new = if low == high { Range::of(low) } else { Range { low, high, zeros: old.zeros } };
        if new != old {
            self.right.ranges[id as usize] = new;
            self.moved.push(id);
            waiting.insert(id);
            waiting.extend(&self.faults.readers[id as usize]);
            // The largest of the wires that are normalised together depends on all of them.
            if let Op::ShlBy(_, count) = self.right.op(id) {
                waiting.extend(&self.faults.readers[count as usize]);
            }
        }
        Ok(())
    }

    /// Range of a wire of the right design from its operands.
    fn right_range(&mut self, id: NodeId) -> Exact {
        let op = self.right.op(id);
        let now = self.right.range(id);
        match op {
            Op::Port(_) | Op::Lit(_) => now,
            Op::ShlBy(x, count) if self.right.normalises(x, count) => {
                let (of, half) = (self.right.range(x), 1_i128 << (self.kind(id).bits() - 2));
                let is_largest = self.is_largest(x, count);
                let low = if of.low > 0 && is_largest {
                    half
                } else if of.low >= 0 {
                    0
                } else {
                    i128::MIN
                };
                let high = if of.high < 0 && is_largest {
                    -half
                } else if of.high < 0 {
                    -1
                } else {
                    i128::MAX
                };
                let zero = of.low == 0 && of.high == 0;
                if zero { now.within(0, 0) } else { now.within(low, high) }
            }
            Op::Sub(a, b) if self.is_at_least(a, b) => forward(&mut self.right, op, id).within(0, i128::MAX),
            op => forward(&mut self.right, op, id),
        }
    }

    /// True if wire `a` is no smaller than `b` because it is a maximum with it.
    fn is_at_least(&self, a: NodeId, b: NodeId) -> bool {
        a == b
            || match self.right.op(a) {
                Op::Select(flag, x, y) if matches!(self.right.op(flag), Op::Lt(p, q) if (p, q) == (y, x)) => {
                    self.is_at_least(x, b) || self.is_at_least(y, b)
                }
                Op::Select(_, x, y) => self.is_at_least(x, b) && self.is_at_least(y, b),
                _ => false,
            }
    }

    /// True if `x` has the highest bit of the wires that `count` normalises: all others hold less than half of their limit after the shift.
    fn is_largest(&self, x: NodeId, count: NodeId) -> bool {
        let Op::Sub(zeros, _) = self.right.op(count) else { return false };
        let Op::LeadingZeros(of) = self.right.op(zeros) else { return false };
        let half = 1_i128 << (self.kind(of).bits() - 2);
        let mut trees = vec![of];
        while let Some(tree) = trees.pop() {
            if let Op::Or(a, b) = self.right.op(tree) {
                trees.extend([a, b]);
                continue;
            }
            let Some(other) = self.right.magnitude_of(tree) else { return false };
            let is_small = |&shifted: &NodeId| {
                let Exact { low, high, .. } = self.right.range(shifted);
                self.right.op(shifted) == Op::ShlBy(other, count) && low >= -half && high < half
            };
            if other != x && !self.faults.readers[count as usize].iter().any(is_small) {
                return false;
            }
        }
        true
    }

    /// Places by which `a` is shifted to the right, and the count on a wire of the left shift before.
    fn shifted(&self, a: NodeId) -> Option<(u32, NodeId)> {
        let Op::Sar(of, places) = self.right.op(a) else { return None };
        let Op::ShlBy(_, count) = self.right.op(of) else { return None };
        Some((places, count))
    }

    /// Low bits of a wire of the right design that are zero.
    fn zeros(&self, id: NodeId) -> u32 {
        let own = self.right.ranges[id as usize].zeros;
        let through = match self.right.op(id) {
            Op::Sar(of, places) => self.zeros(of).saturating_sub(places),
            Op::ShlBy(x, count) => self.right.ranges[x as usize].zeros + self.right.range(count).low.max(0) as u32,
            _ => 0,
        };
        own.max(through)
    }

    /// True if an added constant makes no difference: it is less than the last place of the other operand, and only bits from that place on are read.
    fn rounds_nothing(&self, node: NodeId, wrong: Wrong) -> bool {
        let (Wrong::OperatorFault(OperatorFault::WithoutConstant), Op::Add(a, c)) = (wrong, self.right.op(node)) else {
            return false;
        };
        let (zeros, added) = (self.zeros(a), self.right.range(c));
        let reads_above = |&reader: &NodeId| matches!(self.right.op(reader), Op::Sar(of, k) if of == node && k <= zeros && added.high < 1 << k);
        added.low >= 0
            && self.faults.shown[node as usize] == 0
            && self.faults.readers[node as usize].iter().all(reads_above)
    }

    /// True if some field may differ under the condition. `open` are flags that do not differ and choose after the fault.
    fn is_shown(&mut self, node: NodeId, wrong: Wrong, open: &mut Vec<NodeId>) -> bool {
        for &id in &self.moved {
            self.wrong.ranges[id as usize] = self.right.ranges[id as usize];
        }
        self.wrong.opaque.push(node);
        if self.rounds_nothing(node, wrong) {
            return false;
        }
        let (mut waiting, mut differs) = (BTreeSet::from([node]), BTreeSet::new());
        while let Some(id) = waiting.pop_first() {
            let range = if id == node { self.wrong_value(node, wrong) } else { self.wrong_range(id) };
            let right = self.right.ranges[id as usize].constant();
            if right.is_some() && right == range.constant() {
                continue;
            }
            if id != node {
                let is_flag = |of: &NodeId| self.kind(*of) == Kind::Flag && !differs.contains(of);
                let is_open = |of: &NodeId| self.right.ranges[*of as usize].constant().is_none() && !open.contains(of);
                let found: Vec<_> = self.faults.net.node(id).op.operands().filter(is_flag).filter(is_open).collect();
                open.extend(found);
            }
            if self.faults.shown[id as usize] != 0 {
                return true;
            }
            differs.insert(id);
            self.wrong.ranges[id as usize] = range;
            self.moved.push(id);
            waiting.extend(&self.faults.readers[id as usize]);
        }
        false
    }

    /// Range of a wire in the wrong design from its operands there.
    fn wrong_range(&mut self, id: NodeId) -> Range {
        match self.faults.net.node(id).op {
            Op::Claim { of, .. } => self.wrong.ranges[of as usize],
            op => self.wrapped(id, |known| forward(known, op, id)),
        }
    }

    /// Range of the faulty wire.
    fn wrong_value(&mut self, node: NodeId, wrong: Wrong) -> Range {
        let slip = match wrong {
            Wrong::OperatorFault(slip) => slip,
            Wrong::Value(value) => return Range::of(value),
        };
        let op = self.faults.net.node(node).op;
        if let (OperatorFault::Unsigned(Side::First), Op::Sar(a, k)) = (slip, op)
            && self.wrong.range(a).high < 0
        {
            // The sign is a bit like others, so a negative value is larger by that bit.
            let (Exact { low, high, .. }, bit) = (self.wrong.range(a), 1_i128 << self.faults.ranges.of(a).top());
            return self.wrapped(node, |_| Exact { low: (low + bit) >> k, high: (high + bit) >> k, zeros: 0 });
        }
        if let (OperatorFault::Nearer, Op::ShlBy(_, count)) = (slip, op)
            && self.right.range(count).low > 0
        {
            // A value that is shifted by at least one place is even, so half of it is exact.
            let Exact { low, high, .. } = self.right.range(node);
            return self.wrapped(node, |_| Exact { low: -(-low >> 1), high: high >> 1, zeros: 0 });
        }
        let moved = |k: u32| if slip == OperatorFault::Further { k + 1 } else { k - 1 };
        let instead = match (slip, op) {
            (OperatorFault::OrEqual, _) => Op::Lit(1),
            (OperatorFault::WithoutConstant, Op::Add(a, _)) => Op::Widen(a),
            (OperatorFault::Further | OperatorFault::Nearer, Op::Shl(a, k)) if k > 0 => Op::Shl(a, moved(k)),
            (OperatorFault::Further | OperatorFault::Nearer, Op::Sar(a, k)) if k > 0 => Op::Sar(a, moved(k)),
            _ => match slip.instead(op) {
                Some(instead) => instead,
                None => return full(self.kind(node)),
            },
        };
        self.wrapped(node, |known| forward(known, instead, node))
    }

    /// Range of the wrong design on its wire. If the operation overflows or is undefined, it is the full range, and no lemma applies to the node.
    fn wrapped(&mut self, id: NodeId, range: impl FnOnce(&mut RelationalFacts) -> Exact) -> Range {
        let exact = range(&mut self.wrong);
        let (low, high) = self.kind(id).limits();
        let fits = exact.low >= i128::from(low) && exact.high <= i128::from(high) && exact.low <= exact.high;
        if !fits || !self.wrong.violations.is_empty() {
            self.wrong.violations.clear();
            self.wrong.opaque.push(id);
            return full(self.kind(id));
        }
        let (low, high) = (exact.low as i64, exact.high as i64);
        if low == high { Range::of(low) } else { Range { low, high, zeros: exact.zeros.min(62) } }
    }
}

/// Range of a node's wire from the operands of `op`, or its exact value if each operand is constant.
fn forward(known: &mut RelationalFacts, op: Op, id: NodeId) -> Exact {
    let constant = |id: NodeId| known.ranges[id as usize].constant();
    if op.operands().all(|id| constant(id).is_some()) {
        let value =
            apply_exactly(op, known.net.node(id).kind, |id| known.net.node(id).kind, |id| constant(id).unwrap_or(0));
        if let Some(value) = value {
            return Exact::of(Range::of(value));
        }
    }
    op.range(known, id)
}

/// Full range of a wire.
fn full(kind: Kind) -> Range {
    let (low, high) = kind.limits();
    Range { low, high, zeros: 0 }
}
