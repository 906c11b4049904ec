//! Precision as data: every accuracy knob of the datapath in one plain value.
//!
//! A narrower profile is the same datapath with low bits rounded away; with 14 kept bits or fewer it runs on 16-bit words. Multiplier operands are
//! mantissas of `fraction_bits + 2` bits (sign, one integer bit, fraction). With `fraction_bits = 16` the reflection datapath and the texture
//! footprint fit 18×18 multipliers, with 14 they fit 16×16 (`roughxel cost`). Texels, weights and addresses have widths of their own.

/// Method that finds the direction of the major axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisDirection {
    /// Half-angle formula with the branch that does not cancel, and one inverse root.
    Exact,
    /// Table of sines and cosines, `steps` equal steps over 90° (W97 after (20); erratum 18). Even, 2…64.
    Table {
        /// Steps over 90°; worst error 45°/steps.
        steps: u32,
    },
}

/// Rule for the probe count of an ellipse with the aspect λ₁/λ₂.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProbeRule {
    /// The next power of two.
    PowerOfTwo,
    /// The next integer.
    Ceiling,
}

/// Weights of the probes along the major axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProbeWeights {
    /// Equal weights.
    Box,
    /// Samples of the normal distribution whose standard deviation is λ₁.
    Gaussian,
}

/// Quantities that the roughness pyramid stores.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoughnessKind {
    /// Nothing: lost detail stays lost.
    None,
    /// I₁, the standard deviation along the widest direction (S97 §8).
    Isotropic,
    /// D = [[d₁, d₂], [0, d₃]] with K = D Dᵀ (S97 §8).
    Anisotropic,
}

/// Seed size and iterations of a Newton approximation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Newton {
    /// Index bits of the seed table, 6…10.
    pub seed_bits: u32,
    /// Number of iterations, 0…2; each doubles the number of good bits.
    pub steps: u32,
}

/// The accuracy knobs. Build one from a named profile or with [`Precision::checked`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Precision {
    /// Kept fraction bits p of every multiplier operand, 12…28.
    pub fraction_bits: u32,
    /// Reciprocal.
    pub reciprocal: Newton,
    /// Inverse square root.
    pub inverse_root: Newton,
    /// Direction of the major axis.
    pub direction: AxisDirection,
    /// Maximum number of probes along the major axis, 1…16.
    pub max_probes: u32,
    /// Probe count from the aspect.
    pub probe_rule: ProbeRule,
    /// Probe weights.
    pub probe_weights: ProbeWeights,
    /// Fraction bits of the level of detail, 2…12.
    pub lod_bits: u32,
    /// Fraction bits of a bilinear weight, 2…10.
    pub weight_bits: u32,
    /// Stored roughness.
    pub roughness: RoughnessKind,
    /// Bits of a stored roughness number, 4…16.
    pub roughness_bits: u32,
}

/// The named profiles, narrowest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Profile {
    /// [`Precision::NARROW`].
    Narrow,
    /// [`Precision::PAPER`].
    Paper,
    /// [`Precision::COMPACT`].
    Compact,
    /// [`Precision::STANDARD`].
    Standard,
    /// [`Precision::PRECISE`].
    Precise,
}

impl Profile {
    /// Every profile.
    pub const ALL: [Self; 5] = [Self::Narrow, Self::Paper, Self::Compact, Self::Standard, Self::Precise];

    /// Names of the profiles.
    pub const NAMES: [&'static str; 5] = ["narrow", "paper", "compact", "standard", "precise"];

    /// Name in manifests and on the command line.
    pub const fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// Knobs of the profile.
    pub const fn precision(self) -> Precision {
        match self {
            Self::Narrow => Precision::NARROW,
            Self::Paper => Precision::PAPER,
            Self::Compact => Precision::COMPACT,
            Self::Standard => Precision::STANDARD,
            Self::Precise => Precision::PRECISE,
        }
    }

    /// Finds a profile by its name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|profile| profile.name() == name)
    }
}

impl Precision {
    /// Profile of W97 and S97: ten-step angle table, power-of-two probes, 8-bit roughness.
    pub const PAPER: Self = Self {
        fraction_bits: 16,
        reciprocal: Newton { seed_bits: 8, steps: 1 },
        inverse_root: Newton { seed_bits: 8, steps: 1 },
        direction: AxisDirection::Table { steps: 10 },
        max_probes: 16,
        probe_rule: ProbeRule::PowerOfTwo,
        probe_weights: ProbeWeights::Box,
        lod_bits: 4,
        weight_bits: 6,
        roughness: RoughnessKind::Anisotropic,
        roughness_bits: 8,
    };

    /// Footprints in 18×18 multipliers.
    pub const COMPACT: Self = Self {
        direction: AxisDirection::Exact,
        probe_rule: ProbeRule::Ceiling,
        lod_bits: 6,
        weight_bits: 8,
        ..Self::PAPER
    };

    /// 16-bit words, every bit of which is in a multiplier operand.
    ///
    /// The other knobs are chosen by the distance of a frame from the same filter in float64, 58 to 74 dB (four scenes, 160×120):
    /// - A table of ten directions costs 8 to 24 dB and saves an inverse root.
    /// - Powers of two as probe counts cost nothing but a quarter more texels.
    /// - 4 bits of a weight cost 6 to 11 dB, 6 cost up to 2, 10 gain 0.2.
    /// - 5 bits of a level cost up to 6 dB. 8 gain up to 9 if no other error is left, beyond the 2^−6 to which a level is right.
    /// - 8-bit seeds with one step are within the last place; 10-bit seeds without a step cost up to 0.7 dB.
    pub const NARROW: Self = Self { fraction_bits: 14, ..Self::COMPACT };

    /// The default.
    pub const STANDARD: Self = Self {
        fraction_bits: 20,
        reciprocal: Newton { seed_bits: 10, steps: 1 },
        inverse_root: Newton { seed_bits: 10, steps: 1 },
        lod_bits: 8,
        roughness_bits: 12,
        ..Self::COMPACT
    };

    /// Profile with errors below what a picture or a 16-bit texel can show.
    pub const PRECISE: Self = Self {
        fraction_bits: 26,
        reciprocal: Newton { seed_bits: 8, steps: 2 },
        inverse_root: Newton { seed_bits: 8, steps: 2 },
        lod_bits: 12,
        weight_bits: 10,
        roughness_bits: 16,
        ..Self::STANDARD
    };

    /// Bits of a word. It is 16 if no operand keeps more than 14 fraction bits, which with sign and integer bit is such a word, else 32.
    pub const fn word_bits(&self) -> u32 {
        if self.fraction_bits <= 14 { 16 } else { 32 }
    }

    /// Fraction bits of an offset or a roughness: two fewer than a mantissa, for they reach ±8.
    pub const fn offset_bits(&self) -> u32 {
        self.fraction_bits - 2
    }
}
