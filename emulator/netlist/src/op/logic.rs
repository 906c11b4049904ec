//! Bitwise logic, also of flags, and the choice between two wires.

use super::operation::Operation;
use crate::graph::{Kind, NodeId};
use crate::range::{Exact, Ranges, power_above};
use crate::relational_facts::RelationalFacts;
use crate::unit::Unit;
use crate::verilog::body::Body;
use crate::verilog::value::Value;

/// The other operand of `and` or `or` of a flag with a constant. The outcome is not constant, so the constant is neutral.
fn other_flag(body: &Body, id: NodeId, a: NodeId, b: NodeId) -> Option<Value> {
    if body.kind(id) != Kind::Flag {
        return None;
    }
    match (body.constant(a), body.constant(b)) {
        (Some(_), None) => body.view(b).map(Value::Bits),
        (None, Some(_)) => body.view(a).map(Value::Bits),
        _ => None,
    }
}

/// Bits of `a` and `b` that are read if a constant decides all but `open(constant)`.
fn beside(body: &Body, [a, b]: [NodeId; 2], bits: u128, open: impl Fn(u128) -> u128) -> Vec<(NodeId, u128)> {
    let read = |other| body.constant(other).map_or(bits, |constant| bits & open(i128::from(constant) as u128));
    vec![(a, read(b)), (b, read(a))]
}

fn between(body: &Body, sign: char, operands: [NodeId; 2], first: u32, last: u32, rank: u32) -> String {
    let [a, b] = operands.map(|id| body.text(id, first, last, rank).code);
    format!("{a} {sign} {b}")
}

/// Bitwise and.
pub(super) struct And(pub NodeId, pub NodeId);

impl Operation for And {
    #[inline(always)]
    fn value(&self, _: Kind, _: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128 {
        (operand(self.0) & operand(self.1)).into()
    }
    fn range(&self, known: &mut RelationalFacts, _: NodeId) -> Exact {
        let (a, b) = (known.range(self.0), known.range(self.1));
        let zeros = a.zeros.max(b.zeros);
        match (a.low >= 0, b.low >= 0) {
            (true, true) => Exact { low: 0, high: a.high.min(b.high), zeros },
            (true, false) => Exact { low: 0, high: a.high, zeros },
            (false, true) => Exact { low: 0, high: b.high, zeros },
            (false, false) => Exact { low: -power_above(a).max(power_above(b)), high: a.high.max(b.high), zeros },
        }
    }
    fn unit(&self, ranges: &Ranges, id: NodeId) -> Unit {
        let constant = [self.0, self.1].iter().any(|&operand| ranges.of(operand).constant().is_some());
        if constant { Unit::Mask } else { Unit::Logic { bits: ranges.of(id).width() } }
    }
    fn wiring(&self, body: &Body, id: NodeId) -> Option<Value> {
        other_flag(body, id, self.0, self.1)
    }
    fn reads(&self, body: &Body, bits: u128, _: u32, _: u32) -> Vec<(NodeId, u128)> {
        beside(body, [self.0, self.1], bits, |constant| constant)
    }
    fn expression(&self, body: &Body, first: u32, last: u32, rank: u32) -> String {
        between(body, '&', [self.0, self.1], first, last, rank)
    }
}

/// Bitwise or.
pub(super) struct Or(pub NodeId, pub NodeId);

impl Operation for Or {
    #[inline(always)]
    fn value(&self, _: Kind, _: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128 {
        (operand(self.0) | operand(self.1)).into()
    }
    fn range(&self, known: &mut RelationalFacts, _: NodeId) -> Exact {
        let (a, b) = (known.range(self.0), known.range(self.1));
        let (zeros, power) = (a.zeros.min(b.zeros), power_above(a).max(power_above(b)));
        let low = if a.low >= 0 && b.low >= 0 { a.low.max(b.low) } else { -power };
        let high = if a.high < 0 || b.high < 0 { -1 } else { power - 1 };
        Exact { low, high, zeros }
    }
    fn unit(&self, ranges: &Ranges, id: NodeId) -> Unit {
        Unit::Logic { bits: ranges.of(id).width() }
    }
    fn wiring(&self, body: &Body, id: NodeId) -> Option<Value> {
        other_flag(body, id, self.0, self.1)
    }
    fn reads(&self, body: &Body, bits: u128, _: u32, _: u32) -> Vec<(NodeId, u128)> {
        beside(body, [self.0, self.1], bits, |constant| !constant)
    }
    fn expression(&self, body: &Body, first: u32, last: u32, rank: u32) -> String {
        between(body, '|', [self.0, self.1], first, last, rank)
    }
}

/// Bitwise exclusive or.
pub(super) struct Xor(pub NodeId, pub NodeId);

impl Operation for Xor {
    #[inline(always)]
    fn value(&self, _: Kind, _: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128 {
        (operand(self.0) ^ operand(self.1)).into()
    }
    fn range(&self, known: &mut RelationalFacts, id: NodeId) -> Exact {
        known.magnitude(id).unwrap_or_else(|| {
            let (a, b) = (known.range(self.0), known.range(self.1));
            let (zeros, power) = (a.zeros.min(b.zeros), power_above(a).max(power_above(b)));
            Exact { low: if a.low >= 0 && b.low >= 0 { 0 } else { -power }, high: power - 1, zeros }
        })
    }
    fn unit(&self, ranges: &Ranges, id: NodeId) -> Unit {
        Unit::Logic { bits: ranges.of(id).width() }
    }
    fn reads(&self, _: &Body, bits: u128, _: u32, _: u32) -> Vec<(NodeId, u128)> {
        vec![(self.0, bits), (self.1, bits)]
    }
    fn expression(&self, body: &Body, first: u32, last: u32, rank: u32) -> String {
        between(body, '^', [self.0, self.1], first, last, rank)
    }
}

/// Not of a flag.
pub(super) struct Not(pub NodeId);

impl Operation for Not {
    #[inline(always)]
    fn value(&self, _: Kind, _: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128 {
        (operand(self.0) ^ 1).into()
    }
    fn range(&self, known: &mut RelationalFacts, _: NodeId) -> Exact {
        let a = known.range(self.0);
        Exact { low: 1 - a.high, high: 1 - a.low, zeros: 0 }
    }
    fn wiring(&self, body: &Body, _: NodeId) -> Option<Value> {
        Some(Value::Bits(body.view(self.0)?.not()))
    }
    fn reads(&self, _: &Body, bits: u128, _: u32, _: u32) -> Vec<(NodeId, u128)> {
        vec![(self.0, bits)]
    }
}

/// Flag, value if it is set, value if it is clear.
pub(super) struct Select(pub NodeId, pub NodeId, pub NodeId);

impl Operation for Select {
    #[inline(always)]
    fn value(&self, _: Kind, _: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128 {
        operand(if operand(self.0) != 0 { self.1 } else { self.2 }).into()
    }
    fn range(&self, known: &mut RelationalFacts, _: NodeId) -> Exact {
        let Self(flag, a, b) = *self;
        let flag_range = known.range(flag);
        let mut branches = Vec::new();
        if flag_range.high == 1 {
            branches.extend(known.in_branch(a, flag, true));
        }
        if flag_range.low == 0 {
            branches.extend(known.in_branch(b, flag, false));
        }
        let hull = branches.into_iter().reduce(Exact::hull);
        hull.unwrap_or_else(|| known.range(a).hull(known.range(b)))
    }
    fn unit(&self, ranges: &Ranges, id: NodeId) -> Unit {
        Unit::Select { bits: ranges.of(id).width() }
    }
    fn wiring(&self, body: &Body, _: NodeId) -> Option<Value> {
        let Self(flag, a, b) = *self;
        let view = match (body.constant(flag), body.constant(a), body.constant(b)) {
            (Some(flag), ..) => return Some(body.value(if flag != 0 { a } else { b })),
            (None, Some(a), Some(0)) if a > 0 && a.count_ones() == 1 => body.view(flag)?.shl(a.trailing_zeros()),
            (None, Some(0), Some(b)) if b > 0 && b.count_ones() == 1 => body.view(flag)?.not().shl(b.trailing_zeros()),
            _ => return None,
        };
        Some(Value::Bits(view))
    }
    fn reads(&self, _: &Body, bits: u128, _: u32, _: u32) -> Vec<(NodeId, u128)> {
        vec![(self.0, 1), (self.1, bits), (self.2, bits)]
    }
    fn expression(&self, body: &Body, first: u32, last: u32, rank: u32) -> String {
        let [a, b] = [self.1, self.2].map(|id| body.text(id, first, last, rank).code);
        let flag = body.flag(self.0, rank);
        match flag.strip_prefix('~') {
            Some(flag) => format!("{flag} ? {b} : {a}"),
            None => format!("{flag} ? {a} : {b}"),
        }
    }
}
