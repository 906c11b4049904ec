//! Ranges of wires: intervals of multiples of a power of two.

use std::fmt;

use super::graph::NodeId;

/// Range of a wire: multiples of 2^`zeros` from `low` to `high`.
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

    /// Returns the value if it is the only one.
    pub fn constant(&self) -> Option<i64> {
        (self.low == self.high).then_some(self.low)
    }

    /// True if a value is in the range.
    pub fn contains(&self, value: i64) -> bool {
        (self.low..=self.high).contains(&value) && value.trailing_zeros() >= self.zeros.min(63)
            || value == 0 && self.low <= 0 && self.high >= 0
    }

    /// Bits of a two's complement word that holds every value without its constant low zeros; unsigned if nothing is negative.
    pub fn width(&self) -> u32 {
        let (low, high) = (self.low >> self.zeros, self.high >> self.zeros);
        if low >= 0 { (64 - high.leading_zeros()).max(1) } else { 65 - (high.max(-1 - low)).leading_zeros() }
    }

    /// One above the highest bit, a sign included, with the constant low zeros.
    pub fn top(&self) -> u32 {
        self.zeros + self.width()
    }

    /// True if negative values occur.
    pub fn signed(&self) -> bool {
        self.low < 0
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} … {}", self.low, self.high)
    }
}

/// Exact interval, before it is known to fit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exact {
    pub(crate) low: i128,
    pub(crate) high: i128,
    pub(crate) zeros: u32,
}

impl Exact {
    pub(crate) fn of(range: Range) -> Self {
        Self { low: range.low.into(), high: range.high.into(), zeros: range.zeros }
    }

    pub(crate) fn corners(values: impl IntoIterator<Item = i128>, zeros: u32) -> Self {
        let (mut low, mut high) = (i128::MAX, i128::MIN);
        for value in values {
            (low, high) = (low.min(value), high.max(value));
        }
        Self { low, high, zeros: zeros.min(63) }
    }

    pub(crate) fn hull(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high), zeros: self.zeros.min(other.zeros) }
    }

    pub(crate) fn within(self, low: i128, high: i128) -> Self {
        Self { low: self.low.max(low), high: self.high.min(high), zeros: self.zeros }
    }
}

/// Ranges of the wires of a net, as far as they are sound, with every violation found.
#[derive(Clone, Debug)]
pub struct Ranges {
    /// One range a node. After a violation the wire is taken to hold anything.
    pub ranges: Vec<Range>,
    /// Operations that could leave their word; an empty list is the proof.
    pub violations: Vec<Violation>,
}

impl Ranges {
    /// Range of a node.
    pub fn of(&self, id: NodeId) -> Range {
        self.ranges[id as usize]
    }
}

/// An operation that could leave its word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// The node.
    pub node: NodeId,
    /// Operation and its possible values.
    pub problem: String,
    /// Source line and stage.
    pub origin: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.origin, self.problem)
    }
}

pub(crate) fn difference(a: Exact, b: Exact) -> Exact {
    Exact { low: a.low - b.high, high: a.high - b.low, zeros: a.zeros.min(b.zeros) }
}

/// Smallest power of two 2^n with every value in −2^n ..= 2^n − 1.
pub(crate) fn power_above(range: Exact) -> i128 {
    let magnitude = range.high.max(-1 - range.low).max(0);
    1 << (128 - magnitude.leading_zeros())
}
