//! The methods that are compared, and the data kept of a member of a family.

use roughxel_core::precision::{Precision, Profile};

use super::float::Float;

/// A method of the comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    /// Floating point.
    Float(Float),
    /// The datapath.
    Profile(Profile),
}

pub(super) const COMPARED: [Method; 7] = [
    Method::Float(Float::Plain),
    Method::Float(Float::Careful),
    Method::Float(Float::Micromath),
    Method::Profile(Profile::Narrow),
    Method::Profile(Profile::Paper),
    Method::Profile(Profile::Standard),
    Method::Profile(Profile::Precise),
];

/// Names of the methods, in the order of the curves of a case.
pub const METHODS: [&str; COMPARED.len()] =
    [Float::Plain.name(), Float::Careful.name(), Float::Micromath.name(), "narrow", "paper", "standard", "precise"];

impl Method {
    /// The precision whose ports the method gets.
    pub(super) const fn precision(self) -> Precision {
        match self {
            Self::Float(_) => Precision::PRECISE,
            Self::Profile(profile) => profile.precision(),
        }
    }
}

/// One member of a family.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Error in the unit of its case.
    pub(super) error: f64,
    /// True if the documented fallback holds for it.
    pub(super) fallback: bool,
}

impl Sample {
    /// The worst error, and true if any sample has the fallback. The larger of a number and NaN is the number, so errors are
    /// bounded first.
    pub(super) fn merge(self, other: Self) -> Self {
        Self { error: self.error.max(other.error), fallback: self.fallback | other.fallback }
    }
}
