//! Facts of the interval walk while it derives the next wire: the ranges so far, and facts that plain intervals miss because they ignore correlation.
//!
//! Five patterns are recognised, each an exact lemma about integers:
//! - `select(x < y, …)` knows the comparison in its branches (min, max, absolute value, |x| ≤ y).
//! - `x − ((x >> k) << k)` is the remainder, in [0, 2^k).
//! - `x ^ (x >> w − 1)` is the one's complement magnitude, in [0, max(high, −1 − low)].
//! - `x << (clz(m) − 1)` fits its wire if m is an `or` of magnitudes with that of x among them (block normalisation).
//! - A sum Σ wᵢ·tᵢ with wᵢ ≥ 0 whose weights sum to a constant c, as polynomials in wires, lies within c times the hull of the tᵢ (interpolation).
//!
//! Everything else that intervals cannot find is a claim in the source, with a lemma that is a test.

use std::collections::BTreeMap;

use super::graph::{Net, NodeId, Op};
use super::range::{Exact, Range, Violation, difference};

/// Facts known before a wire is made.
pub(crate) struct RelationalFacts<'a> {
    pub(crate) net: &'a Net,
    /// Ranges of the earlier nodes.
    pub(crate) ranges: Vec<Range>,
    pub(crate) violations: Vec<Violation>,
    /// Faulty nodes: they differ from their operation, so no pattern may see through them.
    pub(crate) opaque: Vec<NodeId>,
}

/// Powers of nodes with their coefficient; the empty product is the constant term.
type Polynomial = BTreeMap<Vec<NodeId>, i128>;

/// Most terms of a polynomial that the walk multiplies out: weights of interpolation have at most eight.
const MOST_TERMS: usize = 32;

impl<'a> RelationalFacts<'a> {
    /// Facts with the ranges of the first nodes of a net.
    pub(crate) fn new(net: &'a Net, ranges: Vec<Range>) -> Self {
        Self { net, ranges, violations: Vec::new(), opaque: Vec::new() }
    }

    /// Operation of a node; for an opaque one a port that does not exist.
    pub(crate) fn op(&self, id: NodeId) -> Op {
        if self.opaque.contains(&id) { Op::Port(u32::MAX) } else { self.net.node(id).op }
    }

    /// Exact range of a node.
    pub(crate) fn range(&self, id: NodeId) -> Exact {
        Exact::of(self.ranges[id as usize])
    }

    /// Notes that a node can leave its wire, or is not defined.
    pub(crate) fn violation(&mut self, node: NodeId, problem: String) {
        self.violations.push(Violation { node, problem, origin: self.net.origin(node) });
    }

    /// Counts by which node `id` shifts, clamped to the range that its wire allows. Counts that are not below the wire's width are a violation.
    pub(crate) fn places(&mut self, id: NodeId, low: i128, high: i128) -> (u32, u32) {
        let bits = self.net.node(id).kind.bits();
        let last = i128::from(bits) - 1;
        if low < 0 || high > last {
            let name = self.op(id).name();
            self.violation(id, format!("{name} by {low} … {high} places of {bits}"));
        }
        (low.clamp(0, last) as u32, high.clamp(0, last) as u32)
    }

    /// Range of `value` if `flag` is (not) set: the flag's comparison is known then. `None`: never.
    pub(crate) fn in_branch(&self, value: NodeId, flag: NodeId, set: bool) -> Option<Exact> {
        let mut known = Vec::new();
        self.facts(flag, set, &mut known);
        let range = self.refined(value, &known);
        (range.low <= range.high).then_some(range)
    }

    /// Bounds that hold if `flag` is (not) set.
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

    /// Range of a node under known bounds, through differences and shifts of a bounded node.
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

    /// Operand `x` of `select(x < 0, 0 − x, x)`.
    pub(crate) fn absolute_of(&self, id: NodeId) -> Option<NodeId> {
        let Op::Select(flag, negated, x) = self.op(id) else { return None };
        let (Op::Lt(of, zero), Op::Sub(from, taken)) = (self.op(flag), self.op(negated)) else { return None };
        ([of, taken] == [x; 2] && [zero, from].map(|id| self.op(id)) == [Op::Lit(0); 2]).then_some(x)
    }

    /// Range [0, 2^k) of a remainder `x − ((x >> k) << k)`.
    pub(crate) fn remainder(&self, a: NodeId, b: NodeId) -> Option<Exact> {
        let Op::Shl(shifted, k) = self.op(b) else { return None };
        match self.op(shifted) {
            Op::Sar(x, places) if x == a && places == k => {
                Some(Exact { low: 0, high: (1 << k) - 1, zeros: self.range(a).zeros.min(k) }.within(0, i128::MAX))
            }
            _ => None,
        }
    }

    /// Operand `x` of `x ^ (x >> bits − 1)`.
    pub(crate) fn magnitude_of(&self, id: NodeId) -> Option<NodeId> {
        let Op::Xor(x, sign) = self.op(id) else { return None };
        match self.op(sign) {
            Op::Sar(of, places) if of == x && places == self.net.node(id).kind.bits() - 1 => Some(x),
            _ => None,
        }
    }

    /// Range of `x ^ (x >> bits − 1)`.
    pub(crate) fn magnitude(&self, id: NodeId) -> Option<Exact> {
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

    /// True if `x << count` is a normalisation: count = clz(m) − 1 with the magnitude of `x` in the or-tree m.
    pub(crate) fn normalises(&self, x: NodeId, count: NodeId) -> bool {
        let Op::Sub(zeros, one) = self.op(count) else { return false };
        let Op::LeadingZeros(magnitudes) = self.op(zeros) else { return false };
        let same_wire = self.net.node(magnitudes).kind == self.net.node(x).kind;
        same_wire && self.op(one) == Op::Lit(1) && self.or_holds(magnitudes, x)
    }

    fn or_holds(&self, tree: NodeId, x: NodeId) -> bool {
        match self.op(tree) {
            // A clear sign bit in every leaf makes the count positive.
            Op::Or(a, b) => {
                self.or_holds(a, x) && self.range(b).low >= 0 || self.or_holds(b, x) && self.range(a).low >= 0
            }
            _ => self.magnitude_of(tree) == Some(x),
        }
    }

    /// Range of a sum of products with non-negative weights that sum to a constant.
    pub(crate) fn convex_sum(&self, id: NodeId) -> Option<Exact> {
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

    /// Collects the factors of every term of a sum of products; false if a term is something else.
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

    /// Node as a polynomial in others, multiplied out.
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
