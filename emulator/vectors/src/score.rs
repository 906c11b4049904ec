//! Scores: coverage as numbers.

use serde::{Deserialize, Serialize};

/// A count and its total.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Score {
    /// Total number.
    pub all: usize,
    /// Number that vectors show, meet or read.
    pub found: usize,
}

impl Score {
    pub(super) fn count(&mut self, found: bool) {
        self.all += 1;
        self.found += usize::from(found);
    }

    /// Found ones in per cent; 100 if the total is 0.
    pub fn percent(&self) -> f64 {
        if self.all == 0 { 100.0 } else { 100.0 * self.found as f64 / self.all as f64 }
    }

    /// Sum of two scores.
    pub fn and(self, other: Self) -> Self {
        Self { all: self.all + other.all, found: self.found + other.found }
    }
}

/// Coverage of the mistakes that a device can have, and of decisions, as counted by `roughxel vectors report`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GradeEntry {
    /// Stuck bits of wires.
    pub stuck: Score,
    /// Operator faults.
    pub operations: Score,
    /// Table entries off by one last place.
    pub entries: Score,
    /// Flags on each side and comparisons at their limits.
    pub decisions: Score,
}
