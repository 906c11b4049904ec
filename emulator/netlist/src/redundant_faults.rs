//! Proof that an operation may be another one, or an entry of a table that is read at one place: faults that no vector can show.
//!
//! A fault makes a difference only where its wire does, and that is a condition on wires of the right design: a choice is always the first
//! value, which matters where its flag is not set. From such a condition the ranges of the wires before and behind it are narrowed, as long as
//! one follows from another. Where nothing is left of a range the condition never holds. Otherwise what differs is followed
//! from the fault to the fields, with ranges of its own: behind a wire that is the same constant in both designs nothing differs.
//!
//! Backwards every rule is that of an integer operation without overflow, so a design whose ranges are not proven has no such proof; forwards
//! ranges are those that operations give themselves (the folder `op`). Claims hold in the right design only, and what overflows in the wrong one may be anything. Four
//! lemmas more than in `known.rs`: a normalisation keeps the sign; where all others of the wires that are normalised together are smaller than half of
//! what a wire holds, the one left is 0 or at least that half; a maximum is no smaller than what it is the maximum of; and a rounding
//! of what has no bits below its last place adds nothing.

mod narrow;

use std::collections::BTreeSet;

use super::evaluate::apply_exactly;
use super::fault::{Fault, Faults};
use super::graph::{Kind, NodeId, Op};
use super::operator_fault::{OperatorFault, Side};
use super::range::{Exact, Range};
use super::relational_facts::RelationalFacts;

/// Revisions of one condition; behind them ranges are what they are, which is sound.
const MOST_REVISIONS: usize = 20_000;
/// Flags on which a proof may depend one after the other, and how many are tried for each of them.
const MOST_FLAGS: u32 = 2;
const FLAGS_TRIED: usize = 3;

/// Bounds of wires that hold together.
type Condition = Vec<(NodeId, i128, i128)>;

/// What is wrong at a node.
#[derive(Clone, Copy)]
enum Wrong {
    /// Its operation.
    OperatorFault(OperatorFault),
    /// What it reads.
    Value(i64),
}

/// Nothing is left of a range: the condition never holds.
struct Never;

/// Proves faults of a design equal, one after the other.
pub struct Prover<'a> {
    faults: &'a Faults<'a>,
    /// What wires hold under the condition.
    right: RelationalFacts<'a>,
    /// What they hold in the wrong design then.
    wrong: RelationalFacts<'a>,
    /// Nodes whose ranges are not those of the proof.
    moved: Vec<NodeId>,
}

impl<'a> Prover<'a> {
    /// For the faults of a design.
    pub fn new(faults: &'a Faults<'a>) -> Self {
        let known = || RelationalFacts::new(faults.net, faults.ranges.ranges.clone());
        Self { faults, right: known(), wrong: known(), moved: Vec::new() }
    }

    /// Whether an operation may be another one in this way, or an entry of a table that one lookup reads; `false` where that is not proven, and of
    /// all other faults.
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

    /// Whether no field differs under a condition; where that is not seen at once, whether it is so with a flag set and without.
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

    /// Conditions of which one holds wherever the wire differs.
    fn conditions(&self, node: NodeId, slip: OperatorFault) -> Vec<Condition> {
        let of = |id: NodeId| self.right.range(id);
        let is = |id: NodeId, value: i128| (id, value, value);
        let negative = |id: NodeId| (id, i128::MIN, -1);
        let not_negative = |id: NodeId| (id, 0, i128::MAX);
        // Not zero, as far as an interval says so.
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
            // Both have a bit that is set.
            (OperatorFault::OtherGate, Op::Xor(a, b)) => vec![vec![not_zero(a), not_zero(b)]],
            (OperatorFault::Sign, Op::Add(_, b) | Op::Sub(_, b)) => vec![vec![not_zero(b)]],
            // The number with fewest leading zeros alone, for a power of two has no bits below it.
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

    /// Narrows the ranges of all wires that a condition says something of.
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

    /// A wire is known to be within bounds. Whatever touches it is looked at again where that is news.
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
            // Which of the wires that are normalised together is the largest follows from the others.
            if let Op::ShlBy(_, count) = self.right.op(id) {
                waiting.extend(&self.faults.readers[count as usize]);
            }
        }
        Ok(())
    }

    /// What a wire of the right design holds by what its operands hold.
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

    /// Whether a wire is no smaller than another one because it is a maximum with it.
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

    /// Whether of the wires that are normalised by `count` all but `x` hold less than half of what they could then, so that `x` has the highest bit.
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

    /// The places by which `a` is shifted to the right, and the count on a wire by which it was shifted to the left before.
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

    /// Whether a constant that is added makes no difference, because it is less than the last place of what it is added to and only bits from there on
    /// are read.
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

    /// Whether some field may differ under the condition; `open` are flags that do not differ and choose behind the fault.
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

    /// What a wire holds in the wrong design by what its operands hold there.
    fn wrong_range(&mut self, id: NodeId) -> Range {
        match self.faults.net.node(id).op {
            Op::Claim { of, .. } => self.wrong.ranges[of as usize],
            op => self.wrapped(id, |known| forward(known, op, id)),
        }
    }

    /// What the wire of a fault holds.
    fn wrong_value(&mut self, node: NodeId, wrong: Wrong) -> Range {
        let slip = match wrong {
            Wrong::OperatorFault(slip) => slip,
            Wrong::Value(value) => return Range::of(value),
        };
        let op = self.faults.net.node(node).op;
        if let (OperatorFault::Unsigned(Side::First), Op::Sar(a, k)) = (slip, op)
            && self.wrong.range(a).high < 0
        {
            // The sign is a bit like others, so what is negative is that much more.
            let (Exact { low, high, .. }, bit) = (self.wrong.range(a), 1_i128 << self.faults.ranges.of(a).top());
            return self.wrapped(node, |_| Exact { low: (low + bit) >> k, high: (high + bit) >> k, zeros: 0 });
        }
        if let (OperatorFault::Nearer, Op::ShlBy(_, count)) = (slip, op)
            && self.right.range(count).low > 0
        {
            // What is shifted by a place at least is even: half of it.
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

    /// A range of the wrong design on its wire: all that the wire holds where it overflows or is not defined, and then no lemma knows the node.
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

/// What the wire of a node holds by what the operands of `op` hold: what it computes where each of them is constant.
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

/// All that a wire holds.
fn full(kind: Kind) -> Range {
    let (low, high) = kind.limits();
    Range { low, high, zeros: 0 }
}
