//! The interval walk: from the declared range of every port, the range of every wire, and with it a proof that no
//! operation leaves its word for any input.
//!
//! A range is an interval and a power of two that divides every value. Plain intervals know nothing of correlation, so
//! five patterns are recognised, each an exact lemma about integers:
//! `select(x < y, …)` knows the comparison in its branches (min, max, absolute value, |x| ≤ y);
//! `x − ((x >> k) << k)` is the remainder, in [0, 2^k);
//! `x ^ (x >> w − 1)` is the one's complement magnitude, in [0, max(high, −1 − low)];
//! `x << (clz(m) − 1)` fits its wire where m is an `or` of magnitudes with that of x among them (block
//! normalisation); and a sum Σ wᵢ·tᵢ with wᵢ ≥ 0 whose weights sum to a constant c, as polynomials in wires, lies
//! within c times the hull of the tᵢ (interpolation). Everything else that intervals cannot find is a claim in the
//! source, with a lemma that is a test.

use std::collections::BTreeMap;
use std::fmt;

use super::graph::{Net, NodeId, Op};

/// What a wire can hold: multiples of 2^`zeros` from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Range {
    /// Smallest value.
    pub low: i64,
    /// Largest value.
    pub high: i64,
    /// Low bits that are always zero; 63 for the constant 0.
    pub zeros: u32,
}

impl Range {
    /// One value.
    pub fn of(value: i64) -> Self {
        Self { low: value, high: value, zeros: value.trailing_zeros().min(63) }
    }

    /// Whether it is one value only.
    pub fn constant(&self) -> Option<i64> {
        (self.low == self.high).then_some(self.low)
    }

    /// Whether a value is in it.
    pub fn contains(&self, value: i64) -> bool {
        (self.low..=self.high).contains(&value) && value.trailing_zeros() >= self.zeros.min(63)
            || value == 0 && self.low <= 0 && self.high >= 0
    }

    /// Bits of a two's complement word that holds every value without its constant low zeros; unsigned where nothing
    /// is negative.
    pub fn width(&self) -> u32 {
        let (low, high) = (self.low >> self.zeros, self.high >> self.zeros);
        if low >= 0 { (64 - high.leading_zeros()).max(1) } else { 65 - (high.max(-1 - low)).leading_zeros() }
    }

    /// Whether negative values occur.
    pub fn signed(&self) -> bool {
        self.low < 0
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} … {}", self.low, self.high)
    }
}

/// An operation that could leave its word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// The node.
    pub node: NodeId,
    /// Operation and what it may come to.
    pub problem: String,
    /// Source line and stage.
    pub origin: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.origin, self.problem)
    }
}

/// An exact interval before it is known to fit.
#[derive(Clone, Copy, Debug)]
struct Exact {
    low: i128,
    high: i128,
    zeros: u32,
}

impl Exact {
    fn of(range: Range) -> Self {
        Self { low: range.low.into(), high: range.high.into(), zeros: range.zeros }
    }

    fn corners(values: impl IntoIterator<Item = i128>, zeros: u32) -> Self {
        let (mut low, mut high) = (i128::MAX, i128::MIN);
        for value in values {
            (low, high) = (low.min(value), high.max(value));
        }
        Self { low, high, zeros: zeros.min(63) }
    }

    fn hull(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high), zeros: self.zeros.min(other.zeros) }
    }

    fn within(self, low: i128, high: i128) -> Self {
        Self { low: self.low.max(low), high: self.high.min(high), zeros: self.zeros }
    }
}

/// The ranges of a net's wires, or of as many as are sound, with every violation found.
#[derive(Clone, Debug)]
pub struct Ranges {
    /// One range a node. After a violation the wire is taken to hold anything.
    pub ranges: Vec<Range>,
    /// Operations that could leave their word; empty is the proof.
    pub violations: Vec<Violation>,
}

impl Ranges {
    /// Walks a net.
    pub fn new(net: &Net) -> Self {
        let mut walk = Walk { net, ranges: Vec::with_capacity(net.nodes.len()), violations: Vec::new() };
        for id in 0..net.nodes.len() as NodeId {
            let exact = walk.exact(id);
            let range = walk.fitted(id, exact);
            walk.ranges.push(range);
        }
        Self { ranges: walk.ranges, violations: walk.violations }
    }

    /// The range of a node.
    pub fn of(&self, id: NodeId) -> Range {
        self.ranges[id as usize]
    }
}

struct Walk<'a> {
    net: &'a Net,
    ranges: Vec<Range>,
    violations: Vec<Violation>,
}

/// Powers of nodes with their coefficient; the empty product is the constant term.
type Polynomial = BTreeMap<Vec<NodeId>, i128>;

/// The most terms of a polynomial the walk multiplies out: weights of interpolation have at most eight.
const MOST_TERMS: usize = 32;

impl Walk<'_> {
    fn op(&self, id: NodeId) -> Op {
        self.net.node(id).op
    }

    fn range(&self, id: NodeId) -> Exact {
        Exact::of(self.ranges[id as usize])
    }

    fn violation(&mut self, node: NodeId, problem: String) {
        self.violations.push(Violation { node, problem, origin: self.net.origin(node) });
    }

    /// The exact range as one of the wire; a violation where it is not.
    fn fitted(&mut self, id: NodeId, exact: Exact) -> Range {
        let kind = self.net.node(id).kind;
        let (low, high) = kind.limits();
        if exact.low < i128::from(low) || exact.high > i128::from(high) {
            let name = self.op(id).name();
            self.violation(id, format!("{name} may be {} … {}, beyond {} bits", exact.low, exact.high, kind.bits()));
            return Range { low, high, zeros: 0 };
        }
        if exact.low > exact.high {
            self.violation(id, format!("{} contradicts what is known of its operand", self.op(id).name()));
            return Range { low, high, zeros: 0 };
        }
        // Only multiples of 2^zeros occur.
        let zeros = exact.zeros.min(62);
        let (low, high) = ((-(-exact.low >> zeros) << zeros) as i64, (exact.high >> zeros << zeros) as i64);
        if low == high { Range::of(low) } else { Range { low, high, zeros } }
    }

    fn exact(&mut self, id: NodeId) -> Exact {
        let node = *self.net.node(id);
        let bits = node.kind.bits();
        match node.op {
            Op::Port(port) => {
                let port = &self.net.ports[port as usize];
                Exact { low: port.low.into(), high: port.high.into(), zeros: 0 }
            }
            Op::Lit(value) => Exact::of(Range::of(value)),
            Op::Add(a, b) => self.convex_sum(id).unwrap_or_else(|| {
                let (a, b) = (self.range(a), self.range(b));
                Exact { low: a.low + b.low, high: a.high + b.high, zeros: a.zeros.min(b.zeros) }
            }),
            Op::Sub(a, b) => self.remainder(a, b).unwrap_or_else(|| difference(self.range(a), self.range(b))),
            Op::Mul(a, b) => {
                let (x, y) = (self.range(a), self.range(b));
                let product =
                    Exact::corners([x.low * y.low, x.low * y.high, x.high * y.low, x.high * y.high], x.zeros + y.zeros);
                if a == b { product.within(0, i128::MAX) } else { product }
            }
            Op::Shl(a, k) => {
                self.places(id, k.into(), k.into(), bits);
                let a = self.range(a);
                Exact { low: a.low << k, high: a.high << k, zeros: (a.zeros + k).min(63) }
            }
            Op::Sar(a, k) => {
                self.places(id, k.into(), k.into(), bits);
                let a = self.range(a);
                Exact { low: a.low >> k, high: a.high >> k, zeros: a.zeros.saturating_sub(k) }
            }
            Op::ShlBy(a, k) => {
                let (x, count) = (self.range(a), self.range(k));
                let (least, most) = self.places(id, count.low, count.high, bits);
                if self.normalises(a, k) {
                    let (low, high) = node.kind.limits();
                    return Exact { low: low.into(), high: high.into(), zeros: x.zeros };
                }
                Exact::corners([x.low << least, x.low << most, x.high << least, x.high << most], x.zeros + least)
            }
            Op::SarBy(a, k) => {
                let (x, count) = (self.range(a), self.range(k));
                let (least, most) = self.places(id, count.low, count.high, bits);
                Exact::corners(
                    [x.low >> least, x.low >> most, x.high >> least, x.high >> most],
                    x.zeros.saturating_sub(most),
                )
            }
            Op::And(a, b) => {
                let (a, b) = (self.range(a), self.range(b));
                let zeros = a.zeros.max(b.zeros);
                match (a.low >= 0, b.low >= 0) {
                    (true, true) => Exact { low: 0, high: a.high.min(b.high), zeros },
                    (true, false) => Exact { low: 0, high: a.high, zeros },
                    (false, true) => Exact { low: 0, high: b.high, zeros },
                    (false, false) => {
                        Exact { low: -power_above(a).max(power_above(b)), high: a.high.max(b.high), zeros }
                    }
                }
            }
            Op::Or(a, b) => {
                let (a, b) = (self.range(a), self.range(b));
                let (zeros, power) = (a.zeros.min(b.zeros), power_above(a).max(power_above(b)));
                let low = if a.low >= 0 && b.low >= 0 { a.low.max(b.low) } else { -power };
                Exact { low, high: power - 1, zeros }
            }
            Op::Xor(a, b) => self.magnitude(id).unwrap_or_else(|| {
                let (a, b) = (self.range(a), self.range(b));
                let (zeros, power) = (a.zeros.min(b.zeros), power_above(a).max(power_above(b)));
                Exact { low: if a.low >= 0 && b.low >= 0 { 0 } else { -power }, high: power - 1, zeros }
            }),
            Op::Not(a) => {
                let a = self.range(a);
                Exact { low: 1 - a.high, high: 1 - a.low, zeros: 0 }
            }
            Op::Lt(a, b) => {
                let (a, b) = (self.range(a), self.range(b));
                Exact { low: i128::from(a.high < b.low), high: i128::from(a.low < b.high), zeros: 0 }
            }
            Op::Select(flag, a, b) => {
                let flag_range = self.range(flag);
                let mut branches = Vec::new();
                if flag_range.high == 1 {
                    branches.extend(self.in_branch(a, flag, true));
                }
                if flag_range.low == 0 {
                    branches.extend(self.in_branch(b, flag, false));
                }
                let hull = branches.into_iter().reduce(Exact::hull);
                hull.unwrap_or_else(|| self.range(a).hull(self.range(b)))
            }
            Op::LeadingZeros(a) => {
                let width = self.net.node(a).kind.bits();
                let a = self.range(a);
                let zeros = |value: i128| i128::from(width) - i128::from(128 - value.leading_zeros());
                let low = if a.high < 0 { 0 } else { zeros(a.high) };
                if a.low < 0 {
                    Exact { low: 0, high: if a.high < 0 { 0 } else { width.into() }, zeros: 0 }
                } else {
                    Exact { low, high: zeros(a.low), zeros: 0 }
                }
            }
            Op::Widen(a) | Op::Narrow(a) => self.range(a),
            Op::Claim { of, low, high, .. } => self.range(of).within(low.into(), high.into()),
            Op::Lookup(a, table) => {
                let index = self.range(a);
                let last = table.0.len() as i128 - 1;
                if index.low < 0 || index.high > last {
                    self.violation(id, format!("lookup at {} … {} in a table of {}", index.low, index.high, last + 1));
                }
                let (first, last) = (index.low.clamp(0, last) as usize, index.high.clamp(0, last) as usize);
                let entries = &table.0[first..=last];
                let zeros = entries.iter().filter(|entry| **entry != 0).map(|entry| entry.trailing_zeros()).min();
                Exact::corners(entries.iter().map(|&entry| entry.into()), zeros.unwrap_or(63))
            }
        }
    }

    /// Shift counts of a wire of `bits`, cut to what it allows; a violation where they are not below its width.
    fn places(&mut self, id: NodeId, low: i128, high: i128, bits: u32) -> (u32, u32) {
        let last = i128::from(bits) - 1;
        if low < 0 || high > last {
            let name = self.op(id).name();
            self.violation(id, format!("{name} by {low} … {high} places of {bits}"));
        }
        (low.clamp(0, last) as u32, high.clamp(0, last) as u32)
    }

    /// What `value` can be where `flag` is (not) set: the flag's comparison is known there. `None`: never.
    fn in_branch(&self, value: NodeId, flag: NodeId, set: bool) -> Option<Exact> {
        let mut known = Vec::new();
        self.facts(flag, set, &mut known);
        let range = self.refined(value, &known);
        (range.low <= range.high).then_some(range)
    }

    /// Bounds that hold where `flag` is (not) set.
    fn facts(&self, flag: NodeId, set: bool, known: &mut Vec<(NodeId, i128, i128)>) {
        match self.op(flag) {
            Op::Not(inner) => self.facts(inner, !set, known),
            Op::And(a, b) if set => {
                self.facts(a, true, known);
                self.facts(b, true, known);
            }
            Op::Or(a, b) if !set => {
                self.facts(a, false, known);
                self.facts(b, false, known);
            }
            Op::Lt(a, b) => {
                let (x, y) = (self.range(a), self.range(b));
                let bounds = if set {
                    [(a, i128::MIN, y.high - 1), (b, x.low + 1, i128::MAX)]
                } else {
                    [(a, y.low, i128::MAX), (b, i128::MIN, x.high)]
                };
                for (node, low, high) in bounds {
                    known.push((node, low, high));
                    known.extend(self.absolute_of(node).filter(|_| high < i128::MAX).map(|of| (of, -high, high)));
                }
            }
            _ => {}
        }
    }

    /// The range of a node under known bounds, through differences and shifts of a bounded node.
    fn refined(&self, id: NodeId, known: &[(NodeId, i128, i128)]) -> Exact {
        let bounded = known.iter().filter(|(node, ..)| *node == id);
        let direct = bounded.fold(self.range(id), |range, &(_, low, high)| range.within(low, high));
        match self.op(id) {
            Op::Sub(a, b) if self.op(a) == Op::Lit(0) => {
                let exact = difference(self.refined(a, known), self.refined(b, known));
                direct.within(exact.low, exact.high)
            }
            _ => direct,
        }
    }

    /// `x` of `select(x < 0, 0 − x, x)`.
    fn absolute_of(&self, id: NodeId) -> Option<NodeId> {
        let Op::Select(flag, negated, x) = self.op(id) else { return None };
        let (Op::Lt(of, zero), Op::Sub(from, taken)) = (self.op(flag), self.op(negated)) else { return None };
        ([of, taken] == [x; 2] && [zero, from].map(|id| self.op(id)) == [Op::Lit(0); 2]).then_some(x)
    }

    /// `x − ((x >> k) << k)` in [0, 2^k).
    fn remainder(&self, a: NodeId, b: NodeId) -> Option<Exact> {
        let Op::Shl(shifted, k) = self.op(b) else { return None };
        match self.op(shifted) {
            Op::Sar(x, places) if x == a && places == k => {
                Some(Exact { low: 0, high: (1 << k) - 1, zeros: self.range(a).zeros.min(k) }.within(0, i128::MAX))
            }
            _ => None,
        }
    }

    /// `x` of `x ^ (x >> bits − 1)`.
    fn magnitude_of(&self, id: NodeId) -> Option<NodeId> {
        let Op::Xor(x, sign) = self.op(id) else { return None };
        match self.op(sign) {
            Op::Sar(of, places) if of == x && places == self.net.node(id).kind.bits() - 1 => Some(x),
            _ => None,
        }
    }

    fn magnitude(&self, id: NodeId) -> Option<Exact> {
        let x = self.range(self.magnitude_of(id)?);
        let low = if x.low > 0 {
            x.low
        } else if x.high < -1 {
            -1 - x.high
        } else {
            0
        };
        Some(Exact { low, high: x.high.max(-1 - x.low), zeros: 0 })
    }

    /// Whether `x << count` is a normalisation: count = clz(m) − 1 with the magnitude of `x` in the or-tree m.
    fn normalises(&self, x: NodeId, count: NodeId) -> bool {
        let Op::Sub(zeros, one) = self.op(count) else { return false };
        let Op::LeadingZeros(magnitudes) = self.op(zeros) else { return false };
        let same_wire = self.net.node(magnitudes).kind == self.net.node(x).kind;
        same_wire && self.op(one) == Op::Lit(1) && self.or_holds(magnitudes, x)
    }

    fn or_holds(&self, tree: NodeId, x: NodeId) -> bool {
        match self.op(tree) {
            // A clear sign bit in every leaf is what makes the count positive.
            Op::Or(a, b) => {
                self.or_holds(a, x) && self.range(b).low >= 0 || self.or_holds(b, x) && self.range(a).low >= 0
            }
            _ => self.magnitude_of(tree) == Some(x),
        }
    }

    /// A sum of products with weights that are not negative and sum to a constant.
    fn convex_sum(&self, id: NodeId) -> Option<Exact> {
        let mut products = Vec::new();
        self.products(id, &mut products).then_some(())?;
        if products.len() < 2 {
            return None;
        }
        // Either factor may be the weight.
        (0..1 << products.len().min(5)).find_map(|choice: u32| {
            let mut total = Polynomial::new();
            let mut hull: Option<Exact> = None;
            for (i, &(a, b)) in products.iter().enumerate() {
                let (weight, value) = if choice >> i & 1 == 0 { (b, a) } else { (a, b) };
                if self.range(weight).low < 0 {
                    return None;
                }
                add_into(&mut total, &self.polynomial(weight)?, 1);
                let value = self.range(value);
                hull = Some(hull.map_or(value, |hull| hull.hull(value)));
            }
            total.retain(|_, coefficient| *coefficient != 0);
            let sum = match total.len() {
                0 => 0,
                1 => *total.get(&Vec::new())?,
                _ => return None,
            };
            let hull = hull?;
            let plain = products.iter().map(|&(a, b)| self.range(a).zeros + self.range(b).zeros).min();
            Some(Exact { low: hull.low * sum, high: hull.high * sum, zeros: plain.unwrap_or(0).min(62) })
        })
    }

    /// The factors of every term of a sum of products; false where a term is something else.
    fn products(&self, id: NodeId, found: &mut Vec<(NodeId, NodeId)>) -> bool {
        match self.op(id) {
            Op::Add(a, b) => self.products(a, found) && self.products(b, found),
            Op::Mul(a, b) => {
                found.push((a, b));
                found.len() <= 5
            }
            _ => false,
        }
    }

    /// A node as a polynomial in others, multiplied out.
    fn polynomial(&self, id: NodeId) -> Option<Polynomial> {
        let single = || Polynomial::from([(vec![id], 1)]);
        let result = match self.op(id) {
            Op::Lit(value) => Polynomial::from([(Vec::new(), value.into())]),
            Op::Add(a, b) | Op::Sub(a, b) => {
                let sign = if matches!(self.op(id), Op::Add(..)) { 1 } else { -1 };
                let mut sum = self.polynomial(a)?;
                add_into(&mut sum, &self.polynomial(b)?, sign);
                sum
            }
            Op::Mul(a, b) => {
                let (a, b) = (self.polynomial(a)?, self.polynomial(b)?);
                let mut product = Polynomial::new();
                for (x, c) in &a {
                    for (y, d) in &b {
                        let mut powers = [x.as_slice(), y.as_slice()].concat();
                        powers.sort_unstable();
                        *product.entry(powers).or_default() += c.checked_mul(*d)?;
                    }
                }
                product
            }
            Op::Widen(a) | Op::Narrow(a) => self.polynomial(a)?,
            Op::Shl(a, k) => {
                let mut shifted = Polynomial::new();
                add_into(&mut shifted, &self.polynomial(a)?, 1 << k);
                shifted
            }
            _ => single(),
        };
        (result.len() <= MOST_TERMS).then_some(result)
    }
}

fn add_into(sum: &mut Polynomial, other: &Polynomial, factor: i128) {
    for (powers, coefficient) in other {
        *sum.entry(powers.clone()).or_default() += coefficient * factor;
    }
}

fn difference(a: Exact, b: Exact) -> Exact {
    Exact { low: a.low - b.high, high: a.high - b.low, zeros: a.zeros.min(b.zeros) }
}

/// The smallest power of two 2^n with every value in −2^n ..= 2^n − 1.
fn power_above(range: Exact) -> i128 {
    let magnitude = range.high.max(-1 - range.low).max(0);
    1 << (128 - magnitude.leading_zeros())
}
