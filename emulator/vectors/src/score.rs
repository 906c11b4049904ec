//! Scores: what sets show, as numbers.

use serde::{Deserialize, Serialize};

/// How many of how many.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Score {
    /// All.
    pub all: usize,
    /// Those that vectors show, meet or read.
    pub found: usize,
}

impl Score {
    pub(super) fn count(&mut self, found: bool) {
        self.all += 1;
        self.found += usize::from(found);
    }

    /// Found ones in a hundred; 100 of none.
    pub fn percent(&self) -> f64 {
        if self.all == 0 { 100.0 } else { 100.0 * self.found as f64 / self.all as f64 }
    }

    /// Both together.
    pub fn and(self, other: Self) -> Self {
        Self { all: self.all + other.all, found: self.found + other.found }
    }
}

/// What the set shows of the mistakes that a device can have, and which decisions it takes, as `roughxel vectors report` counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GradeEntry {
    /// Bits of wires that are stuck.
    pub stuck: Score,
    /// Operations that are others.
    pub operations: Score,
    /// Entries of tables that are off by one last place.
    pub entries: Score,
    /// Flags on either side and comparisons at their limits.
    pub decisions: Score,
}
