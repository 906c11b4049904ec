//! Judge: a device's words by acceptance tiers. *Exact* is every bit; *faithful* lets every reciprocal and inverse root be a neighbour of ours, one
//! last place away, and asks for exactly what follows from it.

use std::path::Path;

use rayon::prelude::*;
use roughxel_core::design::Design;
use serde::Serialize;

use super::VectorError;
use super::datapath::Inputs;
use super::explain::{Real, digits, exponent};
use super::layout::{Direction, Field, Layout, mask};
use super::lines::{Line, Lines};
use super::manifest::Manifest;
use crate::net::graph::{Net, NodeId};
use crate::net::neighbour::{MOST_CHOICES, Neighbours, Verdict};

/// Most vectors that are described; all are counted.
const DESCRIBED: usize = 10;
/// Vectors that are judged at once.
const BATCH: usize = 1 << 10;

/// What a device has to give.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Tier {
    /// Every bit.
    Exact,
    /// Every bit of what follows from reciprocals and inverse roots that are each one last place away at most.
    Faithful,
}

impl Tier {
    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Faithful => "faithful",
        }
    }
}

/// How a device's words are.
#[derive(Clone, Debug, Serialize)]
pub struct Judgement {
    /// The set.
    pub set: String,
    /// Its profile.
    pub profile: String,
    /// The tier that was asked for.
    pub tier: Tier,
    /// Vectors.
    pub count: u64,
    /// Those that are right in every bit.
    pub exact: u64,
    /// Those that are faithful, exact ones included; `None` where the tier is exact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub faithful: Option<u64>,
    /// The first ones that do not pass the tier, at most ten.
    pub failures: Vec<Failing>,
}

impl Judgement {
    /// Vectors that pass the tier.
    pub fn passing(&self) -> u64 {
        self.faithful.unwrap_or(self.exact)
    }
}

/// The first wrong field of a vector.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Failing {
    /// Index of the vector in the whole set, from 0.
    pub index: u64,
    /// Line or record of the device's file, from 1.
    pub line: u64,
    /// The first stage that is wrong, in the order of the pipeline; `input` where the device was given other inputs.
    pub stage: String,
    /// Its first wrong field.
    pub field: String,
    /// What the device gave, hex digits.
    pub got: String,
    /// What it should have given; under *faithful* by the device's own values before it.
    pub expected: String,
    /// Value of `got` in the field's unit, by the device's exponent.
    pub got_real: Real,
    /// Value of `expected`, by the exponent that the set has, or under *faithful* the device's.
    pub expected_real: Real,
}

/// Judges a device's words, those of `got` in the order of the set of `manifest_path`; `progress` is told how many vectors are done.
///
/// Errors: see [`VectorError`]; among them a set that is not as it was written, more or fewer words than it has, and, where the tier is
/// faithful, a set without taps that leaves more choices of neighbours than can be followed.
pub fn judge(got: &Path, manifest_path: &Path, tier: Tier, progress: &dyn Fn(u64)) -> Result<Judgement, VectorError> {
    let manifest = Manifest::read(manifest_path)?;
    let layout = manifest.layout(manifest_path)?;
    let recorded;
    let (net, mut outcomes): (&Net, Vec<(usize, NodeId, u32)>) = match layout.stage() {
        Some(stage) => {
            let (net, nodes) = stage.operations();
            (net, layout.places().map(|(field, place, drop)| (field, nodes[place], drop)).collect())
        }
        None => {
            recorded = Net::of(Design::of(manifest.datapath), &manifest.effects, &manifest.profile.knobs);
            (&recorded, layout.outcomes(&recorded, &manifest.profile.knobs).collect())
        }
    };
    outcomes.sort_by_key(|&(field, ..)| layout.rank(field));
    let nodes: Vec<NodeId> = outcomes.iter().map(|&(_, node, _)| node).collect();
    let neighbours = Neighbours::new(net, &nodes, manifest.profile.knobs.fraction_bits);
    let judge = Judge { manifest: &manifest, layout: &layout, outcomes: &outcomes, neighbours: &neighbours, tier };

    let mut judgement = Judgement {
        set: manifest.set.clone(),
        profile: manifest.profile.name.clone(),
        tier,
        count: manifest.count,
        exact: 0,
        faithful: (tier == Tier::Faithful).then_some(0),
        failures: Vec::new(),
    };
    let count = |found: &str| VectorError::Manifest {
        path: got.into(),
        problem: format!(
            "{found} words than the set, which has {}; a bench writes one word for each vector, in the order of the set",
            manifest.count
        ),
    };
    let (mut set, mut device) = (Lines::open(manifest_path, &manifest)?, Lines::open_device(got, &manifest)?);
    let (mut done, mut at_end) = (0, false);
    while !at_end {
        let mut batch: Vec<(Line, Line)> = Vec::with_capacity(BATCH);
        while batch.len() < BATCH && !at_end {
            let expected = set.next()?;
            let found = device.next().map_err(|error| match error {
                VectorError::Count { .. } => count("more"),
                error => error,
            })?;
            match (expected, found) {
                (Some(expected), Some(found)) => batch.push((expected, found)),
                (None, None) => at_end = true,
                (Some(_), None) => return Err(count("fewer")),
                (None, Some(_)) => return Err(set.wrong_count()),
            }
        }
        done += batch.len() as u64;
        let judged: Vec<_> = batch
            .par_iter()
            .map(|(of_set, of_device)| {
                let expected = of_set.bits(&layout).map_err(|problem| set.problem(of_set.number, problem))?;
                let found =
                    of_device.device_bits(&layout).map_err(|problem| device.problem(of_device.number, problem))?;
                judge.vector(of_device, &expected, &found).map_err(|problem| device.problem(of_device.number, problem))
            })
            .collect::<Result<_, _>>()?;
        for (is_exact, failing) in judged {
            judgement.exact += u64::from(is_exact);
            if let (Some(faithful), None) = (&mut judgement.faithful, &failing) {
                *faithful += 1;
            }
            if let Some(failing) = failing
                && judgement.failures.len() < DESCRIBED
            {
                judgement.failures.push(failing);
            }
        }
        progress(done);
    }
    if !set.hash_matches()? {
        let problem = "the words beside it are not those that it was written for, so nothing can be judged by them; see `roughxel vectors verify`, or \
                       export the set again";
        return Err(VectorError::Manifest { path: manifest_path.into(), problem: problem.into() });
    }
    Ok(judgement)
}

/// What vectors are judged by.
struct Judge<'a> {
    manifest: &'a Manifest,
    layout: &'a Layout,
    /// Outcomes in the order of the pipeline: field, wire, low bits of it that drop.
    outcomes: &'a [(usize, NodeId, u32)],
    neighbours: &'a Neighbours<'a>,
    tier: Tier,
}

impl Judge<'_> {
    /// Whether a vector is exact, and where it does not pass the tier; or why it cannot be judged.
    fn vector(&self, line: &Line, expected: &[u32], found: &[u32]) -> Result<(bool, Option<Failing>), String> {
        let fields = self.layout.fields();
        let is_input = |field: &Field| field.direction == Direction::In;
        let input = (0..fields.len()).find(|&place| is_input(&fields[place]) && expected[place] != found[place]);
        let wrong = self.outcomes.iter().map(|&(place, ..)| place).find(|&place| expected[place] != found[place]);
        if let Some(place) = input.or(wrong.filter(|_| self.tier == Tier::Exact)) {
            return Ok((false, Some(self.failing(line, place, found, expected[place], expected))));
        }
        if wrong.is_none() {
            return Ok((true, None));
        }
        let inputs = self.layout.decode(expected);
        let ports = match self.layout.stage() {
            Some(_) => inputs,
            None => Inputs::of(self.manifest.datapath, &inputs).recorded(&self.manifest.profile.knobs),
        };
        let is_right = |place: usize, value: i64| {
            let (field, _, drop) = self.outcomes[place];
            fields[field].bits(value, drop) == Some(found[field])
        };
        match self.neighbours.judge(&ports, is_right) {
            Verdict::Right => Ok((false, None)),
            Verdict::Wrong { place, value } => {
                let (field, _, drop) = self.outcomes[place];
                let bits = (value >> drop) as u32 & mask(fields[field].width);
                Ok((false, Some(self.failing(line, field, found, bits, found))))
            }
            Verdict::TooMany { place } => Err(format!(
                "vector #{}: before field {} there are more than {MOST_CHOICES} choices of neighbours; judge it by a set with the outcomes of all stages \
                 (export without --no-taps), or stage by stage (export --stage)",
                line.index, fields[self.outcomes[place].0].name
            )),
        }
    }

    /// A wrong field; the exponent of what was expected is that of the word `beside`.
    fn failing(&self, line: &Line, place: usize, found: &[u32], bits: u32, beside: &[u32]) -> Failing {
        let fields = self.layout.fields();
        let field = &fields[place];
        let real = |bits: u32, word: &[u32]| {
            let integer = |(field, &bits): (&Field, &u32)| field.integer(bits & mask(field.width));
            let integers: Vec<i64> = fields.iter().zip(word).map(integer).collect();
            let unit = exponent(fields, field, &integers) - field.fraction_bits as i32;
            Real::new(field.integer(bits & mask(field.width)) as f64, unit)
        };
        Failing {
            index: line.index,
            line: line.number,
            stage: field.stage.clone(),
            field: field.name.clone(),
            got: digits(field, found[place]),
            expected: digits(field, bits),
            got_real: real(found[place], found),
            expected_real: real(bits, beside),
        }
    }
}
