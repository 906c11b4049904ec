//! The accuracy knobs one by one: names, ranges, and the values between which accuracy changes.
//!
//! A value is a number, the same for every kind of knob. It counts bits, steps or probes, or is the place of a choice in [`Knob::choices`]. A loop
//! over [`Knob::ALL`] therefore serves a measurement, a table or a message.

use core::fmt;

use crate::precision::{AxisDirection, Precision, ProbeRule, ProbeWeights, RoughnessKind};

/// A knob of [`Precision`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Knob {
    /// Kept fraction bits p.
    FractionBits,
    /// Index bits of the seeds of a reciprocal.
    ReciprocalSeedBits,
    /// Newton steps of a reciprocal.
    ReciprocalSteps,
    /// Index bits of the seeds of an inverse root.
    InverseRootSeedBits,
    /// Newton steps of an inverse root.
    InverseRootSteps,
    /// Direction of the major axis: 0 is exact, any other value is the number of table steps over 90°.
    Direction,
    /// Most probes.
    MaxProbes,
    /// Probe count from the aspect.
    ProbeRule,
    /// Weights of probes.
    ProbeWeights,
    /// Fraction bits of a level of detail.
    LodBits,
    /// Fraction bits of a bilinear weight.
    WeightBits,
    /// Stored roughness.
    Roughness,
    /// Bits of a stored roughness.
    RoughnessBits,
}

impl Knob {
    /// Every knob, in the order of [`Precision`].
    pub const ALL: [Self; 13] = [
        Self::FractionBits,
        Self::ReciprocalSeedBits,
        Self::ReciprocalSteps,
        Self::InverseRootSeedBits,
        Self::InverseRootSteps,
        Self::Direction,
        Self::MaxProbes,
        Self::ProbeRule,
        Self::ProbeWeights,
        Self::LodBits,
        Self::WeightBits,
        Self::Roughness,
        Self::RoughnessBits,
    ];

    /// Name, as in manifests and profile files; a part of a knob follows a dot.
    pub const fn name(self) -> &'static str {
        match self {
            Self::FractionBits => "fraction_bits",
            Self::ReciprocalSeedBits => "reciprocal.seed_bits",
            Self::ReciprocalSteps => "reciprocal.steps",
            Self::InverseRootSeedBits => "inverse_root.seed_bits",
            Self::InverseRootSteps => "inverse_root.steps",
            Self::Direction => "direction",
            Self::MaxProbes => "max_probes",
            Self::ProbeRule => "probe_rule",
            Self::ProbeWeights => "probe_weights",
            Self::LodBits => "lod_bits",
            Self::WeightBits => "weight_bits",
            Self::Roughness => "roughness",
            Self::RoughnessBits => "roughness_bits",
        }
    }

    /// Range of the values, for messages.
    pub const fn range(self) -> &'static str {
        match self {
            Self::FractionBits => "12 to 28",
            Self::ReciprocalSeedBits | Self::InverseRootSeedBits => "6 to 10",
            Self::ReciprocalSteps | Self::InverseRootSteps => "0 to 2",
            Self::Direction => "exact, or a table of 2 to 64 steps, an even number",
            Self::MaxProbes => "1 to 16",
            Self::ProbeRule => "power_of_two or ceiling",
            Self::ProbeWeights => "box or gaussian",
            Self::LodBits => "2 to 12",
            Self::WeightBits => "2 to 10",
            Self::Roughness => "none, isotropic or anisotropic",
            Self::RoughnessBits => "4 to 16",
        }
    }

    /// Names of the values of a choice, in the order of the values from 0; empty for a number.
    pub const fn choices(self) -> &'static [&'static str] {
        match self {
            Self::ProbeRule => &["power_of_two", "ceiling"],
            Self::ProbeWeights => &["box", "gaussian"],
            Self::Roughness => &["none", "isotropic", "anisotropic"],
            _ => &[],
        }
    }

    /// Values at which the knob is tried, the least accurate first.
    pub const fn values(self) -> &'static [u32] {
        match self {
            Self::FractionBits => &[12, 13, 14, 15, 16, 17, 18, 19, 20, 22, 24, 26, 28],
            Self::ReciprocalSeedBits | Self::InverseRootSeedBits => &[6, 7, 8, 9, 10],
            Self::ReciprocalSteps | Self::InverseRootSteps | Self::Roughness => &[0, 1, 2],
            Self::Direction => &[2, 4, 6, 10, 16, 32, 64, 0],
            Self::MaxProbes => &[1, 2, 3, 4, 6, 8, 12, 16],
            Self::ProbeRule | Self::ProbeWeights => &[0, 1],
            Self::LodBits => &[2, 3, 4, 5, 6, 8, 10, 12],
            Self::WeightBits => &[2, 3, 4, 5, 6, 7, 8, 9, 10],
            Self::RoughnessBits => &[4, 5, 6, 8, 10, 12, 14, 16],
        }
    }

    /// Returns true if the knob's value in a precision is in its range.
    fn is_in_range(self, p: &Precision) -> bool {
        let value = self.value_in(p);
        match self {
            Self::FractionBits => (12..=28).contains(&value),
            Self::ReciprocalSeedBits | Self::InverseRootSeedBits => (6..=10).contains(&value),
            Self::ReciprocalSteps | Self::InverseRootSteps => value <= 2,
            Self::Direction => match p.direction {
                AxisDirection::Exact => true,
                AxisDirection::Table { steps } => (2..=64).contains(&steps) && steps & 1 == 0,
            },
            Self::MaxProbes => (1..=16).contains(&value),
            Self::LodBits => (2..=12).contains(&value),
            Self::WeightBits => (2..=10).contains(&value),
            Self::RoughnessBits => (4..=16).contains(&value),
            Self::ProbeRule | Self::ProbeWeights | Self::Roughness => true,
        }
    }

    /// Value of the knob in a precision.
    pub const fn value_in(self, p: &Precision) -> u32 {
        match self {
            Self::FractionBits => p.fraction_bits,
            Self::ReciprocalSeedBits => p.reciprocal.seed_bits,
            Self::ReciprocalSteps => p.reciprocal.steps,
            Self::InverseRootSeedBits => p.inverse_root.seed_bits,
            Self::InverseRootSteps => p.inverse_root.steps,
            Self::Direction => match p.direction {
                AxisDirection::Exact => 0,
                AxisDirection::Table { steps } => steps,
            },
            Self::MaxProbes => p.max_probes,
            Self::ProbeRule => p.probe_rule as u32,
            Self::ProbeWeights => p.probe_weights as u32,
            Self::LodBits => p.lod_bits,
            Self::WeightBits => p.weight_bits,
            Self::Roughness => p.roughness as u32,
            Self::RoughnessBits => p.roughness_bits,
        }
    }

    /// A precision with another value of this knob. A place beyond the choices is the last of them.
    pub const fn with(self, value: u32, mut p: Precision) -> Precision {
        match self {
            Self::FractionBits => p.fraction_bits = value,
            Self::ReciprocalSeedBits => p.reciprocal.seed_bits = value,
            Self::ReciprocalSteps => p.reciprocal.steps = value,
            Self::InverseRootSeedBits => p.inverse_root.seed_bits = value,
            Self::InverseRootSteps => p.inverse_root.steps = value,
            Self::Direction => {
                p.direction = if value == 0 { AxisDirection::Exact } else { AxisDirection::Table { steps: value } };
            }
            Self::MaxProbes => p.max_probes = value,
            Self::ProbeRule => {
                p.probe_rule = if value == 0 { ProbeRule::PowerOfTwo } else { ProbeRule::Ceiling };
            }
            Self::ProbeWeights => {
                p.probe_weights = if value == 0 { ProbeWeights::Box } else { ProbeWeights::Gaussian };
            }
            Self::LodBits => p.lod_bits = value,
            Self::WeightBits => p.weight_bits = value,
            Self::Roughness => {
                p.roughness = match value {
                    0 => RoughnessKind::None,
                    1 => RoughnessKind::Isotropic,
                    _ => RoughnessKind::Anisotropic,
                };
            }
            Self::RoughnessBits => p.roughness_bits = value,
        }
        p
    }

    /// A value as text: a number, the name of a choice, `exact`.
    pub const fn text(self, value: u32) -> Setting {
        Setting { knob: self, value }
    }

    /// Finds a knob by its name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|knob| knob.name() == name)
    }

    /// Reads a value from its text. [`Precision::checked`] says whether it is in range.
    pub fn read(self, text: &str) -> Option<u32> {
        let choices = self.choices();
        match choices.iter().position(|name| *name == text) {
            Some(place) => Some(place as u32),
            None if self == Self::Direction && text == "exact" => Some(0),
            None if choices.is_empty() => text.parse().ok(),
            None => None,
        }
    }
}

/// Kept bits of [`Precision::grid`].
const GRID_WIDTHS: [u32; 9] = [12, 14, 16, 18, 20, 22, 24, 26, 28];
/// Directions of [`Precision::grid`].
const GRID_DIRECTIONS: [u32; 3] = [10, 32, 0];

impl Precision {
    /// The value itself if every knob is in its range, else the first knob that is not.
    pub fn checked(self) -> Result<Self, Knob> {
        match Knob::ALL.into_iter().find(|knob| !knob.is_in_range(&self)) {
            Some(knob) => Err(knob),
            None => Ok(self),
        }
    }

    /// A profile between the named ones: `fraction_bits`, in 12…28. All else is as in the narrowest of [`Precision::NARROW`], [`Precision::COMPACT`],
    /// [`Precision::STANDARD`] and [`Precision::PRECISE`] that keeps at least as many bits, or as in the last of them.
    pub const fn of_width(fraction_bits: u32) -> Self {
        let wider = match fraction_bits {
            ..=14 => Self::NARROW,
            15..=16 => Self::COMPACT,
            17..=20 => Self::STANDARD,
            _ => Self::PRECISE,
        };
        Self { fraction_bits, ..wider }
    }

    /// Settings to choose from, narrowest first: profiles of even widths 12…28 ([`Precision::of_width`]). Each comes with directions by tables of 10
    /// and of 32 steps and exact, and each of those with both rules for probes.
    pub fn grid() -> impl Iterator<Item = Self> {
        let directed = |p| GRID_DIRECTIONS.into_iter().map(move |value| Knob::Direction.with(value, p));
        let ruled = |p| Knob::ProbeRule.values().iter().map(move |value| Knob::ProbeRule.with(*value, p));
        GRID_WIDTHS.into_iter().map(Self::of_width).flat_map(directed).flat_map(ruled)
    }
}

impl fmt::Display for Knob {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A knob at a value, for printing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Setting {
    /// The knob.
    pub knob: Knob,
    /// Value of the knob.
    pub value: u32,
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.knob.choices().get(self.value as usize), self.knob, self.value) {
            (Some(name), ..) => f.write_str(name),
            (None, Knob::Direction, 0) => f.write_str("exact"),
            (None, _, value) => write!(f, "{value}"),
        }
    }
}
