//! Sums, differences, comparisons, products.

use super::operation::Operation;
use crate::graph::{Kind, NodeId, Op};
use crate::range::{Exact, Range, Ranges, difference};
use crate::relational_facts::RelationalFacts;
use crate::unit::{Unit, signed_digits, signed_powers};
use crate::verilog::body::{Body, mask};
use crate::verilog::value::{Value, constant_bits};

/// An adder or subtracter of this many bits; wires if no bit has work to do.
fn adder(ranges: &Ranges, bits: u32, operands: [NodeId; 2]) -> Unit {
    let constant = operands.iter().any(|&operand| ranges.of(operand).constant().is_some());
    if bits == 0 { Unit::Wires } else { Unit::Adder { bits, constant } }
}

/// a + b.
pub(super) struct Add(pub NodeId, pub NodeId);

impl Operation for Add {
    #[inline(always)]
    fn value(&self, _: Kind, _: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128 {
        i128::from(operand(self.0)) + i128::from(operand(self.1))
    }
    fn range(&self, known: &mut RelationalFacts, id: NodeId) -> Exact {
        known.convex_sum(id).unwrap_or_else(|| {
            let (a, b) = (known.range(self.0), known.range(self.1));
            Exact { low: a.low + b.low, high: a.high + b.high, zeros: a.zeros.min(b.zeros) }
        })
    }
    /// Adder from the lowest bit at which both operands have wires.
    fn unit(&self, ranges: &Ranges, id: NodeId) -> Unit {
        let from = ranges.of(self.0).zeros.max(ranges.of(self.1).zeros);
        adder(ranges, ranges.of(id).top().saturating_sub(from), [self.0, self.1])
    }
    fn span(&self, body: &Body, low: u32, high: u32) -> (u32, u32) {
        // No carry comes from below the lowest bit at which both operands have wires.
        (low.min(body.range(self.0).zeros.max(body.range(self.1).zeros)), high)
    }
    fn reads(&self, _: &Body, _: u128, first: u32, last: u32) -> Vec<(NodeId, u128)> {
        [self.0, self.1].map(|operand| (operand, mask(first, last))).into()
    }
    fn expression(&self, body: &Body, first: u32, last: u32, rank: u32) -> String {
        let text = |id| body.text(id, first, last, rank).code;
        match body.constant(self.1) {
            Some(c) if c < 0 => format!("{} - {}", text(self.0), constant_bits(-c, first, last).code),
            _ => format!("{} + {}", text(self.0), text(self.1)),
        }
    }
}

/// a − b.
pub(super) struct Sub(pub NodeId, pub NodeId);

impl Operation for Sub {
    #[inline(always)]
    fn value(&self, _: Kind, _: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128 {
        i128::from(operand(self.0)) - i128::from(operand(self.1))
    }
    fn range(&self, known: &mut RelationalFacts, _: NodeId) -> Exact {
        known.remainder(self.0, self.1).unwrap_or_else(|| difference(known.range(self.0), known.range(self.1)))
    }
    /// Subtracter from the lowest bit at which the second operand has a wire. A remainder of a power of two needs none.
    fn unit(&self, ranges: &Ranges, id: NodeId) -> Unit {
        adder(ranges, ranges.of(id).top().saturating_sub(ranges.of(self.1).zeros), [self.0, self.1])
    }
    /// Wires of a remainder of a power of two.
    fn wiring(&self, body: &Body, _: NodeId) -> Option<Value> {
        let Op::Shl(shifted, k) = body.op(self.1) else { return None };
        let is_remainder = body.op(shifted) == Op::Sar(self.0, k);
        Some(Value::Bits(is_remainder.then(|| body.view(self.0))??.low_bits(k)))
    }
    fn span(&self, body: &Body, low: u32, high: u32) -> (u32, u32) {
        (low.min(body.range(self.1).zeros), high)
    }
    fn reads(&self, _: &Body, _: u128, first: u32, last: u32) -> Vec<(NodeId, u128)> {
        [self.0, self.1].map(|operand| (operand, mask(first, last))).into()
    }
    fn expression(&self, body: &Body, first: u32, last: u32, rank: u32) -> String {
        let text = |id| body.text(id, first, last, rank).code;
        if body.constant(self.0) == Some(0) {
            format!("-{}", text(self.1))
        } else {
            format!("{} - {}", text(self.0), text(self.1))
        }
    }
}

/// a < b, signed; a flag.
pub(super) struct Lt(pub NodeId, pub NodeId);

impl Operation for Lt {
    #[inline(always)]
    fn value(&self, _: Kind, _: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128 {
        i128::from(operand(self.0) < operand(self.1))
    }
    fn range(&self, known: &mut RelationalFacts, _: NodeId) -> Exact {
        let (a, b) = (known.range(self.0), known.range(self.1));
        Exact { low: i128::from(a.high < b.low), high: i128::from(a.low < b.high), zeros: 0 }
    }
    /// Comparator from the lowest bit at which the second operand has a wire. An unsigned operand next to a signed one gets a sign.
    fn unit(&self, ranges: &Ranges, _: NodeId) -> Unit {
        let (a, b) = (ranges.of(self.0), ranges.of(self.1));
        let signed = a.signed() || b.signed();
        let top = |range: Range| range.top() + u32::from(signed && !range.signed());
        match top(a).max(top(b)).saturating_sub(b.zeros) {
            0 => Unit::Wires,
            // The difference with 0 is the operand itself, which has a sign already.
            _ if b.constant() == Some(0) => Unit::Wires,
            bits => Unit::Comparator { bits },
        }
    }
    /// Wires of a sign test.
    fn wiring(&self, body: &Body, _: NodeId) -> Option<Value> {
        let is_sign = body.constant(self.1) == Some(0);
        Some(Value::Bits(is_sign.then(|| body.view(self.0))??.bit(body.range(self.0).top() - 1)))
    }
    fn reads(&self, body: &Body, _: u128, _: u32, _: u32) -> Vec<(NodeId, u128)> {
        let (low, high) = body.compared(self.0, self.1);
        [self.0, self.1].map(|operand| (operand, mask(low, high))).into()
    }
    fn expression(&self, body: &Body, _: u32, _: u32, rank: u32) -> String {
        let (low, high) = body.compared(self.0, self.1);
        let signed = [self.0, self.1].iter().any(|&id| body.range(id).signed());
        if let Some(constant) = body.constant(self.1)
            && let Some(text) = below_constant(body, self.0, constant, [low, high], signed, rank)
        {
            return text;
        }
        let [a, b] = [self.0, self.1].map(|id| {
            if signed { body.signed_operand(id, low, high, rank) } else { body.text(id, low, high, rank).as_unsigned() }
        });
        format!("{a} < {b}")
    }
}

/// Largest number of runs of equal bits in a constant that lookup tables compare.
const MOST_RUNS: usize = 5;

/// Comparison of bits `low` up to `high` of a wire with a constant, in tables of four inputs: a carry chain would take one for each bit. `None` on gates,
/// where tools do the same, or if the constant has many runs of equal bits.
fn below_constant(
    body: &Body,
    id: NodeId,
    constant: i64,
    [low, high]: [u32; 2],
    signed: bool,
    rank: u32,
) -> Option<String> {
    // The sign counts the other way round.
    let top = high - u32::from(signed);
    let bit = |at: u32| constant >> at.min(63) & 1 == 1;
    let mut runs: Vec<(u32, u32)> = Vec::new();
    for at in low..top {
        match runs.last_mut() {
            Some((_, end)) if bit(*end - 1) == bit(at) => *end = at + 1,
            _ => runs.push((at, at + 1)),
        }
    }
    if !body.has_lookup_tables() || runs.len() > MOST_RUNS {
        return None;
    }
    let mut text = String::new();
    for (first, end) in runs {
        let bits = body.text(id, first, end, rank).code;
        let [all, any] = if end - first == 1 { ["", ""] } else { ["&", "|"] };
        text = match (bit(first), text.is_empty()) {
            (true, true) => format!("~{all}{bits}"),
            (true, false) => format!("~{all}{bits} | ({text})"),
            (false, true) => return None,
            (false, false) => format!("~{any}{bits} & ({text})"),
        };
    }
    if signed {
        let sign = body.text(id, top, high, rank).code;
        text = match (constant < 0, text.is_empty()) {
            (_, true) => return None,
            (true, false) => format!("{sign} & ({text})"),
            (false, false) => format!("{sign} | ({text})"),
        };
    }
    Some(text)
}

/// a · b of two words, wide.
pub(super) struct Mul(pub NodeId, pub NodeId);

impl Operation for Mul {
    #[inline(always)]
    fn value(&self, _: Kind, _: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128 {
        i128::from(operand(self.0)) * i128::from(operand(self.1))
    }
    fn range(&self, known: &mut RelationalFacts, _: NodeId) -> Exact {
        let (x, y) = (known.range(self.0), known.range(self.1));
        let corners = [x.low * y.low, x.low * y.high, x.high * y.low, x.high * y.high];
        let product = Exact::corners(corners, x.zeros + y.zeros);
        if self.0 == self.1 { product.within(0, i128::MAX) } else { product }
    }
    fn unit(&self, ranges: &Ranges, _: NodeId) -> Unit {
        let (a, b) = (ranges.of(self.0), ranges.of(self.1));
        let (by, operand) = match (a.constant(), b.constant()) {
            (None, None) => return Unit::Multiplier([a, b]),
            (Some(by), _) => (by, b),
            (None, Some(by)) => (by, a),
        };
        // One digit is a shift.
        if signed_digits(by) < 2 { Unit::Wires } else { Unit::ConstantMultiplier { by, operand } }
    }
    fn span(&self, body: &Body, _: u32, high: u32) -> (u32, u32) {
        let (a, b) = (body.range(self.0), body.range(self.1));
        let first = a.zeros + b.zeros;
        (first, high.max(first + a.width().max(b.width())))
    }
    fn reads(&self, body: &Body, _: u128, _: u32, _: u32) -> Vec<(NodeId, u128)> {
        [self.0, self.1].map(|operand| (operand, body.all_bits(operand))).into()
    }
    /// A product; with a constant it is a sum of shifted operands, so that no tool takes a multiplier for it.
    fn expression(&self, body: &Body, first: u32, last: u32, rank: u32) -> String {
        let (by, operand) = match (body.constant(self.0), body.constant(self.1)) {
            (Some(by), _) => (by, self.1),
            (None, Some(by)) => (by, self.0),
            (None, None) => {
                let signed = [self.0, self.1].iter().any(|&id| body.range(id).signed());
                let [a, b] = [self.0, self.1].map(|id| body.factor(id, signed, rank));
                return format!("{a} * {b}");
            }
        };
        signed_powers(by).into_iter().fold(String::new(), |sum, (negative, k)| {
            let term = body.shifted(operand, k, first, last, rank).code;
            match (sum.is_empty(), negative) {
                (true, false) => term,
                (true, true) => format!("-{term}"),
                (false, false) => format!("{sum} + {term}"),
                (false, true) => format!("{sum} - {term}"),
            }
        })
    }
}
