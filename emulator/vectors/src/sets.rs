//! The sets: every hard case of each datapath, and seeded random ones.

use std::ops::Range;

use roughxel_cases::corners::{
    CORNERS, fragment_corners, fragment_far, highlight_corners, highlight_far, peak_corners, peak_far,
};
use roughxel_cases::highlight::{self, highlight_sets, random_light, random_lights};
use roughxel_cases::limits::{fragment_limits, highlight_limits, peak_limits};
use roughxel_cases::lit_peak::{self, lit_peak_sets, random_lit_peak, random_lit_peaks};
use roughxel_cases::{CaseSet, FOOTPRINT_LEVEL, FOOTPRINT_SWAP, hard_case_sets, random_fragment, random_fragments};
use roughxel_core::plan::{Datapath, Effects, ReflectionPlan};
use roughxel_core::precision::Precision;

use super::datapath::{InputSource, Inputs, Ports};
use super::manifest::Manifest;

/// Name and contents of the random set of a datapath.
#[derive(Clone, Copy, Debug)]
pub struct RandomSetSummary {
    /// Name of the set with seed 0, which is also its seed.
    pub name: &'static str,
    /// The datapath.
    pub datapath: Datapath,
    /// Contents of the set.
    pub description: &'static str,
}

/// The random set of each datapath, in the order of [`Datapath::ALL`].
pub const RANDOM_SETS: [RandomSetSummary; 3] = [
    RandomSetSummary {
        name: "random",
        datapath: Datapath::Reflection,
        description: "seeded random fragments: plausible ones, and bit patterns at corner exponents",
    },
    RandomSetSummary {
        name: "random_highlight",
        datapath: Datapath::Highlight,
        description: "seeded random lights on rough surfaces, and bit patterns",
    },
    RandomSetSummary {
        name: "random_peak",
        datapath: Datapath::Peak,
        description: "seeded random lights on peaks under horizons, and bit patterns",
    },
];

/// Rule by which [`roughxel_utilities::random::SplitMix64::for_element`] finds the numbers of one vector, and version of the
/// inputs made of them.
pub(super) const SEED_RULE: &str = "splitmix64(fnv1a64(name) xor index * 9e3779b97f4a7c15), inputs 2";

/// The vectors of all other sets and of 200 000 random ones that show most mistakes, those that show most first, for each datapath: name
/// of the set, and a line a vector. Made by `roughxel vectors condense` under `standard` (vectors/README.md has the commands).
const CHOSEN: [(&str, Datapath, &str); 3] = [
    ("chosen", Datapath::Reflection, include_str!("../../../vectors/chosen/reflection.txt")),
    ("chosen_highlight", Datapath::Highlight, include_str!("../../../vectors/chosen/highlight.txt")),
    ("chosen_peak", Datapath::Peak, include_str!("../../../vectors/chosen/peak.txt")),
];

/// Vectors of the other sets and of millions of random ones that show every entry of every table off by a last place, as far as
/// possible. Made in the same way.
const ENTRIES: [(&str, Datapath, &str); 3] = [
    ("entries", Datapath::Reflection, include_str!("../../../vectors/chosen/entries_reflection.txt")),
    ("entries_highlight", Datapath::Highlight, include_str!("../../../vectors/chosen/entries_highlight.txt")),
    ("entries_peak", Datapath::Peak, include_str!("../../../vectors/chosen/entries_peak.txt")),
];

/// Name of the set that shows every entry of every table of a datapath off by a last place.
pub const fn entries_set(datapath: Datapath) -> &'static str {
    ENTRIES[datapath as usize].0
}

/// Contents of the sets of ports at their limits.
const LIMITS: &str =
    "exponents to both ends of 16 bits and far apart, mantissas of few bits or none, most negative words, any edge";

/// A named set of hard cases and the effects that they use.
#[derive(Clone, Debug)]
pub struct VectorSet {
    /// Short name, also that of its files.
    pub name: &'static str,
    /// Contents of the set.
    pub description: &'static str,
    /// Effects that are on.
    pub effects: Effects,
    /// Its datapath.
    pub datapath: Datapath,
    /// Inputs of its ports.
    pub inputs: Vec<Inputs>,
    /// True if its first vectors are its best.
    pub best_first: bool,
    /// Number of its vectors that show as many operator faults as all of them: none if each is for an entry of a table, two if
    /// all are of one kind.
    pub enough: u64,
}

impl VectorSet {
    /// Vector `index` of `count`, at most all: the first vectors if they are the best, else spread evenly.
    pub fn part(&self, index: u64, count: u64) -> Inputs {
        let all = self.inputs.len() as u64;
        self.inputs[if self.best_first { index } else { index * all / count } as usize]
    }
}

/// Source of the inputs of an exported set.
pub(super) enum Source {
    /// A seed.
    Seed(String),
    /// The list of its hard cases.
    Listed(VectorSet),
}

impl Source {
    /// The source of a set; `None` for captured fragments, for a stage alone, or if a different version had other cases.
    pub(super) fn from_manifest(manifest: &Manifest) -> Option<Self> {
        if manifest.stage.is_some() {
            return None;
        }
        if let Some(seed) = &manifest.seed {
            return (seed.rule == SEED_RULE).then(|| Self::Seed(seed.name.clone()));
        }
        let is_it = |set: &VectorSet| set.name == manifest.set && set.datapath == manifest.datapath;
        let set = hard_sets(&manifest.profile.knobs).into_iter().find(is_it)?;
        (manifest.whole_count() <= set.inputs.len() as u64).then_some(Self::Listed(set))
    }

    /// The ports of a vector, by its index in the whole set.
    pub(super) fn inputs(&self, index: u64, manifest: &Manifest) -> Inputs {
        match self {
            Self::Seed(seed) => random_set(manifest.datapath, seed, index, &manifest.profile.knobs),
            Self::Listed(set) => set.part(index, manifest.whole_count()),
        }
    }
}

/// Every set of hard cases, datapath by datapath.
pub fn hard_sets(p: &Precision) -> Vec<VectorSet> {
    fn vectors<C, P: Into<Effects>>(sets: Vec<CaseSet<C, P>>, datapath: Datapath) -> impl Iterator<Item = VectorSet>
    where
        for<'a> &'a C: Into<Inputs>,
    {
        sets.into_iter().map(move |CaseSet { name, description, cases, plan }| VectorSet {
            name,
            description,
            effects: plan.into(),
            datapath,
            inputs: cases.iter().map(Into::into).collect(),
            best_first: false,
            enough: match name {
                FOOTPRINT_LEVEL => 0,
                FOOTPRINT_SWAP => 2,
                _ => u64::MAX,
            },
        })
    }
    let (limits, corners) = (LIMITS, CORNERS);
    let (mut reflections, mut highlights, mut peaks) = (hard_case_sets(p), highlight_sets(p), lit_peak_sets(p));
    let set = |name, description, cases| CaseSet { name, description, cases, plan: ReflectionPlan::FULL };
    reflections.push(set("fragment_limits", limits, fragment_limits(p)));
    reflections.push(set("fragment_corners", corners, fragment_corners(p)));
    reflections.push(fragment_far(p));
    let set = |name, description, cases| CaseSet { name, description, cases, plan: highlight::FULL };
    highlights.push(set("highlight_limits", limits, highlight_limits(p)));
    highlights.push(set("highlight_corners", corners, highlight_corners(p)));
    highlights.push(highlight_far(p));
    let set = |name, description, cases| CaseSet { name, description, cases, plan: lit_peak::FULL };
    peaks.push(set("peak_limits", limits, peak_limits(p)));
    peaks.push(set("peak_corners", corners, peak_corners(p)));
    peaks.push(peak_far(p));
    let mut sets: Vec<VectorSet> = vectors(reflections, Datapath::Reflection)
        .chain(vectors(highlights, Datapath::Highlight))
        .chain(vectors(peaks, Datapath::Peak))
        .collect();
    let listed = |lists: [(&'static str, Datapath, &str); 3], description, best_first| {
        let set = |(name, datapath, list)| {
            let inputs = chosen(datapath, list, &sets, p);
            let effects = Effects::ALL;
            VectorSet {
                name,
                description,
                effects,
                datapath,
                inputs,
                best_first,
                enough: if best_first { u64::MAX } else { 0 },
            }
        };
        lists.map(set)
    };
    let most = listed(CHOSEN, "vectors of the other sets that show most mistakes, those that show most first", true);
    let entries = listed(ENTRIES, "vectors that show every entry of every table off by a last place", false);
    sets.extend(entries.into_iter().chain(most));
    sets
}

/// The listed vectors of other sets of a datapath. A line has the name of a set, or the seed of a random one, and an index in it.
fn chosen(datapath: Datapath, list: &str, sets: &[VectorSet], p: &Precision) -> Vec<Inputs> {
    let random = RANDOM_SETS[datapath as usize].name;
    let inputs = |line: &str| {
        let (set, index) = line.split_once(' ')?;
        let index = index.parse().ok()?;
        if set.split('+').next() == Some(random) {
            return Some(random_set(datapath, set, index, p));
        }
        sets.iter().find(|of| of.name == set)?.inputs.get(index as usize).copied()
    };
    // A test ensures that no line is lost.
    list.lines().filter_map(inputs).collect()
}

/// Input `index` of a datapath's random set with that seed.
pub fn random_set(datapath: Datapath, seed: &str, index: u64, p: &Precision) -> Inputs {
    match datapath {
        Datapath::Reflection => (&random_fragment(seed, index, p)).into(),
        Datapath::Highlight => (&random_light(seed, index, p)).into(),
        Datapath::Peak => (&random_lit_peak(seed, index, p)).into(),
    }
}

/// A datapath's random set with a seed; its vectors are [`random_set`]'s, made in parallel if many are wanted.
#[derive(Clone, Copy, Debug)]
pub struct RandomSet<'a> {
    /// The datapath.
    pub datapath: Datapath,
    /// The text hashed with each index.
    pub seed: &'a str,
    /// Knobs.
    pub precision: &'a Precision,
}

impl InputSource for RandomSet<'_> {
    fn input(&self, index: u64) -> Inputs {
        random_set(self.datapath, self.seed, index, self.precision)
    }

    fn fill(&self, indices: Range<u64>, ports: &mut Ports) {
        match (self.datapath, ports) {
            (Datapath::Reflection, Ports::Reflection(columns)) => {
                random_fragments(self.seed, indices, self.precision, columns);
            }
            (Datapath::Highlight, Ports::Highlight(columns)) => {
                random_lights(self.seed, indices, self.precision, columns);
            }
            (Datapath::Peak, Ports::Peak(columns)) => random_lit_peaks(self.seed, indices, self.precision, columns),
            (datapath, _) => panic!("a set of `{}` in one of a different datapath", datapath.name()),
        }
    }
}
