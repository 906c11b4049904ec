//! Which reading computes the reflection datapath: the bits are the same, the time is not.

use std::fmt;
use std::str::FromStr;

use roughxel_core::datapath::{self, ReflectionInput};
use roughxel_core::plan::ReflectionPlan;
use roughxel_core::precision::Precision;

use super::batch::{Batch, Footprint};
use super::target::InstructionSet;

/// A way to compute the reflection datapath of many fragments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// One fragment after the other.
    Scalar,
    /// Lanes, with an instruction set of this machine.
    Lanes(InstructionSet),
}

impl Reading {
    /// The fastest on this machine.
    pub fn best() -> Self {
        InstructionSet::best().map_or(Self::Scalar, Self::Lanes)
    }

    /// What fetching needs of every fragment, in their order.
    pub fn footprints(
        self,
        inputs: &[ReflectionInput<i32>],
        plan: &ReflectionPlan,
        p: &Precision,
    ) -> Vec<Footprint<i32>> {
        match self {
            Self::Scalar => inputs.iter().map(|input| Footprint::of(&datapath::reflection(input, plan, p))).collect(),
            Self::Lanes(set) => Batch::new(inputs).footprints(set, plan, p),
        }
    }
}

impl fmt::Display for Reading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scalar => f.write_str("scalar"),
            Self::Lanes(set) => write!(f, "{set}"),
        }
    }
}

impl FromStr for Reading {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let lanes = InstructionSet::available().map(Self::Lanes);
        let readings: Vec<Self> = std::iter::once(Self::Scalar).chain(lanes).collect();
        readings.iter().copied().find(|reading| reading.to_string() == text).ok_or_else(|| {
            let names: Vec<String> = readings.iter().map(Self::to_string).collect();
            format!("'{text}' is no reading of this machine: use {}", names.join(", "))
        })
    }
}
