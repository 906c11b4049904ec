//! The sets there are: every hard case of each datapath, and seeded random ones.

use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::ports::{HighlightIn, PeakIn, ReflectionIn};
use roughxel_core::precision::Precision;

use super::datapath::Inputs;
use super::manifest::Manifest;
use crate::cases::highlight::{highlight_sets, random_light};
use crate::cases::lit_peak::{lit_peak_sets, random_lit_peak};
use crate::cases::{CaseSet, hard_case_sets, random_fragment};

/// The random set of each datapath: its name, and what it holds.
pub const RANDOM_SETS: [(&str, Datapath, &str); 3] = [
    ("random", Datapath::Reflection, "seeded random fragments: plausible ones, and bit patterns at corner exponents"),
    ("random_highlight", Datapath::Highlight, "seeded random lights on rough surfaces, and bit patterns"),
    ("random_peak", Datapath::Peak, "seeded random lights on peaks under horizons, and bit patterns"),
];

/// How [`crate::random::SplitMix64::for_element`] finds the numbers of one vector.
pub(super) const SEED_RULE: &str = "splitmix64(fnv1a64(name) xor index * 9e3779b97f4a7c15)";

/// Inputs of a listed set.
#[derive(Clone, Debug)]
pub enum Cases {
    /// Fragments that reflect.
    Reflection(Vec<ReflectionIn>),
    /// Lights on surfaces.
    Highlight(Vec<HighlightIn>),
    /// Lights on peaks.
    Peak(Vec<PeakIn>),
}

impl Cases {
    /// Their datapath.
    pub const fn datapath(&self) -> Datapath {
        match self {
            Self::Reflection(_) => Datapath::Reflection,
            Self::Highlight(_) => Datapath::Highlight,
            Self::Peak(_) => Datapath::Peak,
        }
    }

    /// How many.
    pub fn count(&self) -> u64 {
        let count = match self {
            Self::Reflection(cases) => cases.len(),
            Self::Highlight(cases) => cases.len(),
            Self::Peak(cases) => cases.len(),
        };
        count as u64
    }

    /// The ports of one; `index` is below the count.
    pub fn inputs(&self, index: u64) -> Inputs {
        let index = index as usize;
        match self {
            Self::Reflection(cases) => (&cases[index]).into(),
            Self::Highlight(cases) => (&cases[index]).into(),
            Self::Peak(cases) => (&cases[index]).into(),
        }
    }
}

/// A named set of hard cases and the effects they go through.
#[derive(Clone, Debug)]
pub struct VectorSet {
    /// Short name, also that of its files.
    pub name: &'static str,
    /// What the set holds.
    pub description: &'static str,
    /// Effects that are on.
    pub effects: Effects,
    /// Its inputs.
    pub cases: Cases,
}

impl VectorSet {
    /// The ports of vector `index` of `count`, which are all of its cases or some of them, evenly spread.
    pub fn spread(&self, index: u64, count: u64) -> Inputs {
        self.cases.inputs(index * self.cases.count() / count)
    }
}

/// Where the inputs of an exported set come from.
pub(super) enum Source {
    /// A seed.
    Seed(String),
    /// The list of its hard cases.
    Listed(VectorSet),
}

impl Source {
    /// That of a set; `None` of captured fragments, or where another version had other cases.
    pub(super) fn of(manifest: &Manifest) -> Option<Self> {
        if let Some(seed) = &manifest.seed {
            return (seed.rule == SEED_RULE).then(|| Self::Seed(seed.name.clone()));
        }
        let is_it = |set: &VectorSet| set.name == manifest.set && set.cases.datapath() == manifest.datapath;
        let set = hard_sets(&manifest.profile.knobs).into_iter().find(is_it)?;
        (manifest.whole_count() <= set.cases.count()).then_some(Self::Listed(set))
    }

    /// The ports of a vector, by its index in the whole set.
    pub(super) fn inputs(&self, index: u64, manifest: &Manifest) -> Inputs {
        match self {
            Self::Seed(seed) => random_set(manifest.datapath, seed, index, &manifest.profile.knobs),
            Self::Listed(set) => set.spread(index, manifest.whole_count()),
        }
    }
}

/// Every set of hard cases, datapath by datapath.
pub fn hard_sets(p: &Precision) -> Vec<VectorSet> {
    fn vectors<C, P: Into<Effects>>(
        sets: Vec<CaseSet<C, P>>,
        cases: fn(Vec<C>) -> Cases,
    ) -> impl Iterator<Item = VectorSet> {
        sets.into_iter().map(move |CaseSet { name, description, cases: all, plan }| VectorSet {
            name,
            description,
            effects: plan.into(),
            cases: cases(all),
        })
    }
    let reflections = vectors(hard_case_sets(p), Cases::Reflection);
    let highlights = vectors(highlight_sets(p), Cases::Highlight);
    let peaks = vectors(lit_peak_sets(p), Cases::Peak);
    reflections.chain(highlights).chain(peaks).collect()
}

/// Input `index` of a datapath's random set with that seed.
pub fn random_set(datapath: Datapath, seed: &str, index: u64, p: &Precision) -> Inputs {
    match datapath {
        Datapath::Reflection => (&random_fragment(seed, index, p)).into(),
        Datapath::Highlight => (&random_light(seed, index, p)).into(),
        Datapath::Peak => (&random_lit_peak(seed, index, p)).into(),
    }
}
