//! Coverage as numbers.

use serde::{Deserialize, Serialize};

/// A count and its total.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coverage {
    /// All.
    pub all: usize,
    /// Number that vectors show, meet or read.
    pub found: usize,
}

impl Coverage {
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

/// What the set shows of the mistakes that a device can have, and which decisions it takes, as `roughxel vectors coverage` counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoverageEntry {
    /// Bits of wires that are stuck.
    pub stuck: Coverage,
    /// Operations that are others.
    pub operations: Coverage,
    /// Entries of tables that are off by one last place.
    pub entries: Coverage,
    /// Flags on either side and comparisons at their limits.
    pub decisions: Coverage,
}
