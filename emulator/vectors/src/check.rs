//! Check: acceptance tiers of a device's words. *Exact* requires every bit. *Faithful* allows every reciprocal and inverse root
//! to be off by one last place, and requires exactly what follows from it. *Bound* allows every rounding to be different
//! ([`super::bound`]).

use std::cmp::Ordering;
use std::path::Path;

use rayon::prelude::*;
use roughxel_netlist::faithful_rounding::{MOST_CHOICES, Neighbours, Verdict};
use serde::Serialize;

use super::VectorError;
use super::bound::{Bounds, Leeway};
use super::explain::{Real, digits, exponent};
use super::field::{Field, mask};
use super::lines::{Line, Lines};
use super::manifest::Manifest;
use super::outcomes::Outcomes;

/// Most vectors that are described; all are counted.
const DESCRIBED: usize = 10;
/// Vectors that are judged at once.
const BATCH: usize = 1 << 10;

/// Requirement on a device's words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Tier {
    /// Every bit.
    Exact,
    /// Every bit of the results of reciprocals and inverse roots that are each off by at most one last place.
    Faithful,
    /// Numbers within the first-order effect of roundings that are each off by at most this many last places; decisions that some
    /// such design takes.
    Bound {
        /// Last places.
        places: u32,
    },
}

impl Tier {
    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Faithful => "faithful",
            Self::Bound { .. } => "bound",
        }
    }

    /// Adjective for vectors that pass it.
    pub const fn adjective(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Faithful => "faithful",
            Self::Bound { .. } => "within bounds",
        }
    }
}

/// Result for a device's words.
#[derive(Clone, Debug, Serialize)]
pub struct CheckResult {
    /// The set.
    pub set: String,
    /// Its profile.
    pub profile: String,
    /// The requested tier.
    pub tier: Tier,
    /// Vectors.
    pub count: u64,
    /// Vectors that are right in every bit.
    pub exact: u64,
    /// Vectors that pass the tier, including exact ones.
    pub passing: u64,
    /// The first vectors that do not pass the tier, at most ten.
    pub failures: Vec<Failing>,
}

/// The first wrong field of a vector.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Failing {
    /// Index of the vector in the whole set, from 0.
    pub index: u64,
    /// Line or record of the device's file, from 1.
    pub line: u64,
    /// The first wrong stage, in the order of the pipeline; `input` if the device got other inputs.
    pub stage: String,
    /// Its first wrong field.
    pub field: String,
    /// The device's value, hex digits.
    pub got: String,
    /// The right value; under *faithful* by the device's own earlier values.
    pub expected: String,
    /// Last places that `got` may be away from `expected`, if the tier is bound and the field is a number.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub within: Option<f64>,
    /// Value of `got` in the field's unit, by the device's exponent.
    pub got_real: Real,
    /// Value of `expected`, by the exponent in the set, or under *faithful* the device's.
    pub expected_real: Real,
}

/// Judges a device's words, those of `got` in the order of the set of `manifest_path`; `progress` gets the number of finished
/// vectors.
///
/// Errors: see [`VectorError`]; among them a set that is not as it was written, more or fewer words than it has, and, where the tier is
/// faithful, a set without taps that leaves more choices of neighbours than can be followed.
pub fn check(got: &Path, manifest_path: &Path, tier: Tier, progress: &dyn Fn(u64)) -> Result<CheckResult, VectorError> {
    let manifest = Manifest::read(manifest_path)?;
    let layout = manifest.layout(manifest_path)?;
    let outcomes = Outcomes::new(&manifest, &layout);
    let freedom = match tier {
        Tier::Exact => Freedom::None,
        Tier::Faithful => {
            let fraction_bits = manifest.profile.knobs.fraction_bits;
            Freedom::Neighbours(Neighbours::new(&outcomes.net, &outcomes.nodes(), fraction_bits))
        }
        Tier::Bound { places } => Freedom::Bounds(Bounds::new(&outcomes, places)),
    };
    let check = Checker { outcomes: &outcomes, freedom };

    let mut result = CheckResult {
        set: manifest.set.clone(),
        profile: manifest.profile.name.clone(),
        tier,
        count: manifest.count,
        exact: 0,
        passing: 0,
        failures: Vec::new(),
    };
    let count = |found: &str| VectorError::Manifest {
        path: got.into(),
        problem: format!(
            "{found} words than the set, which has {}; a testbench writes one word for each vector, in the order of the set",
            manifest.count
        ),
    };
    let (mut set, mut device) = (Lines::open(manifest_path, &manifest)?, Lines::open_device(got, &manifest)?);
    let mut done = 0;
    loop {
        let expected = set.batch(BATCH)?.unwrap_or_default();
        let found = device.batch(BATCH).map_err(|error| match error {
            VectorError::Count { .. } => count("more"),
            error => error,
        })?;
        let found = found.unwrap_or_default();
        match expected.len().cmp(&found.len()) {
            Ordering::Greater => return Err(count("fewer")),
            Ordering::Less => return Err(set.wrong_count()),
            Ordering::Equal if expected.is_empty() => break,
            Ordering::Equal => done += expected.len() as u64,
        }
        let checked: Vec<_> = (expected.par_iter().zip(&found))
            .map(|(of_set, of_device)| {
                let expected = set.bits(of_set, &layout)?;
                let problem = |problem| device.problem(of_device.number, problem);
                let found = of_device.device_bits(&layout).map_err(problem)?;
                check.vector(of_device, &expected, &found).map_err(problem)
            })
            .collect::<Result<_, _>>()?;
        for (is_exact, failing) in checked {
            result.exact += u64::from(is_exact);
            result.passing += u64::from(failing.is_none());
            if let Some(failing) = failing
                && result.failures.len() < DESCRIBED
            {
                result.failures.push(failing);
            }
        }
        progress(done);
    }
    if !set.hash_matches()? {
        return Err(not_its_words(manifest_path));
    }
    Ok(result)
}

/// Words that are each right but not those of the manifest.
pub(super) fn not_its_words(manifest_path: &Path) -> VectorError {
    let problem = "the words next to it are not those that it was written for, so nothing can be checked against them; see `roughxel vectors verify`, or \
                   export the set again";
    VectorError::Manifest { path: manifest_path.into(), problem: problem.into() }
}

/// What vectors are judged by.
struct Checker<'a> {
    outcomes: &'a Outcomes<'a>,
    freedom: Freedom<'a>,
}

/// Freedom of a device's implementation.
enum Freedom<'a> {
    None,
    Neighbours(Neighbours<'a>),
    Bounds(Bounds<'a>),
}

/// Whether a vector is exact, and where it does not pass the tier.
type VectorResult = (bool, Option<Failing>);

impl Checker<'_> {
    /// A vector, or why it cannot be judged.
    fn vector(&self, line: &Line, expected: &[u32], found: &[u32]) -> Result<VectorResult, String> {
        if let Some(place) = self.outcomes.other_input(expected, found) {
            return Ok((false, Some(self.failing(line, place, found, expected[place], expected))));
        }
        let mut places = self.outcomes.list.iter().map(|outcome| outcome.field);
        let Some(wrong) = places.find(|&place| expected[place] != found[place]) else {
            return Ok((true, None));
        };
        let failing = match &self.freedom {
            Freedom::None => Some(self.failing(line, wrong, found, expected[wrong], expected)),
            Freedom::Neighbours(neighbours) => self.by_neighbours(neighbours, line, expected, found)?,
            Freedom::Bounds(bounds) => self.by_bounds(bounds, line, expected, found),
        };
        Ok((false, failing))
    }

    fn by_neighbours(
        &self,
        neighbours: &Neighbours<'_>,
        line: &Line,
        expected: &[u32],
        found: &[u32],
    ) -> Result<Option<Failing>, String> {
        let Outcomes { list, .. } = self.outcomes;
        let is_right = |place: usize, value: i64| {
            let outcome = list[place];
            self.outcomes.field(outcome).bits(value, outcome.drop) == Some(found[outcome.field])
        };
        match neighbours.judge(&self.outcomes.ports(expected), is_right) {
            Verdict::Right => Ok(None),
            Verdict::Wrong { place, value } => {
                let outcome = list[place];
                let bits = outcome.bits(self.outcomes.field(outcome), value);
                Ok(Some(self.failing(line, outcome.field, found, bits, found)))
            }
            Verdict::TooMany { place } => Err(format!(
                "vector #{}: before field {} there are more than {MOST_CHOICES} choices of neighbours; check it with a set with the outcomes of all stages \
                 (export without --no-taps), or stage by stage (export --stage)",
                line.index,
                self.outcomes.field(list[place]).name
            )),
        }
    }

    fn by_bounds(&self, bounds: &Bounds<'_>, line: &Line, expected: &[u32], found: &[u32]) -> Option<Failing> {
        let (place, leeway) = bounds.beyond(expected, found)?;
        let field = self.outcomes.list[place].field;
        let within = match leeway {
            Leeway::Within(most) => Some(most),
            Leeway::OneOf(_) | Leeway::Any => None,
        };
        Some(Failing { within, ..self.failing(line, field, found, expected[field], expected) })
    }

    /// A wrong field; the exponent of the expected value is that of the word `beside`.
    fn failing(&self, line: &Line, place: usize, found: &[u32], bits: u32, beside: &[u32]) -> Failing {
        let fields = self.outcomes.layout.fields();
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
            within: None,
            got_real: real(found[place], found),
            expected_real: real(bits, beside),
        }
    }
}
