//! Bound: how far a device's fields may be from those of a set where the device rounds in its own way, vector by vector.
//!
//! Every rounding of the design may be some last places more or less. A field that is a number may then differ by the sum of what each rounding
//! alone makes of it, and by what a comparison that can turn does at most; a field that is a decision may be what it is in some such design.

use std::collections::BTreeSet;

use super::outcomes::Outcomes;
use crate::net::rounding::{Change, Roundings};

/// A design whose roundings may be off.
pub(super) struct Bounds<'a> {
    outcomes: &'a Outcomes<'a>,
    roundings: Roundings<'a>,
    /// Last places that each may be off.
    places: u32,
    /// What each outcome is.
    roles: Vec<Role>,
}

/// What an outcome is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    /// A number, in last places; a mantissa with the place of its exponent among the outcomes.
    Number(Option<usize>),
    /// The exponent of mantissas, which are judged with it.
    Exponent,
    /// A face, a count, flags.
    Decision,
}

/// What an outcome of a vector may be.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Leeway {
    /// So many last places away.
    Within(f64),
    /// One of these, as the bits of its field.
    OneOf(BTreeSet<u32>),
    /// Anything: what it means is judged elsewhere.
    Any,
}

impl<'a> Bounds<'a> {
    pub(super) fn new(outcomes: &'a Outcomes<'a>, places: u32) -> Self {
        let roundings = Roundings::new(&outcomes.net, &outcomes.nodes());
        let paths: Vec<_> = outcomes.list.iter().map(|&outcome| outcomes.path(outcome)).collect();
        let place = |path: &String| paths.iter().position(|(other, _)| other == path);
        let exponents: Vec<Option<usize>> = paths.iter().map(|(_, exponent)| place(exponent.as_ref()?)).collect();
        let role = |(place, &outcome)| match exponents[place] {
            Some(of) => Role::Number(Some(of)),
            None if exponents.contains(&Some(place)) => Role::Exponent,
            None if outcomes.field(outcome).fraction_bits == 0 => Role::Decision,
            None => Role::Number(None),
        };
        let roles = outcomes.list.iter().enumerate().map(role).collect();
        Self { outcomes, roundings, places, roles }
    }

    /// What each outcome of the vector may be, in the order of the outcomes.
    pub(super) fn leeway(&self, expected: &[u32]) -> Vec<Leeway> {
        let Outcomes { list, .. } = self.outcomes;
        let ours = self.integers(expected);
        let mut decisions: Vec<BTreeSet<u32>> =
            list.iter().map(|outcome| BTreeSet::from([expected[outcome.field]])).collect();
        let zero = || vec![0.0_f64; list.len()];
        // The sum over roundings, the larger way of the one at hand, the most of designs that are off everywhere.
        let (mut sum, mut alone, mut together) = (zero(), (0, zero()), zero());
        let mut theirs = ours.clone();
        self.roundings.each(&self.outcomes.ports(expected), i64::from(self.places), &mut |change, wires| {
            for (integer, outcome) in theirs.iter_mut().zip(list) {
                *integer = wires[outcome.node as usize] >> outcome.drop;
            }
            let of = match change {
                Change::Alone(number) => {
                    if alone.0 != number {
                        add_to(&mut sum, &mut alone.1);
                        alone.0 = number;
                    }
                    &mut alone.1
                }
                Change::Together => &mut together,
            };
            for (place, outcome) in list.iter().enumerate().filter(|&(place, _)| theirs[place] != ours[place]) {
                if self.roles[place] == Role::Decision {
                    decisions[place].insert(outcome.bits(self.outcomes.field(*outcome), theirs[place] << outcome.drop));
                }
            }
            for (place, most) in of.iter_mut().enumerate() {
                *most = most.max(self.apart(place, &theirs, &ours));
            }
        });
        add_to(&mut sum, &mut alone.1);
        let numbers = sum.iter().zip(&together).map(|(sum, together)| sum + together + f64::from(self.places));
        let leeway = |((role, number), decision)| match role {
            &Role::Number(_) => Leeway::Within(number),
            Role::Decision => Leeway::OneOf(decision),
            Role::Exponent => Leeway::Any,
        };
        self.roles.iter().zip(numbers).zip(decisions).map(leeway).collect()
    }

    /// The first outcome of a device that is beyond its leeway.
    pub(super) fn beyond(&self, expected: &[u32], found: &[u32], leeway: &[Leeway]) -> Option<usize> {
        let (ours, theirs) = (self.integers(expected), self.integers(found));
        (0..leeway.len()).find(|&place| match &leeway[place] {
            Leeway::Within(most) => self.apart(place, &theirs, &ours) > *most,
            Leeway::OneOf(decisions) => !decisions.contains(&found[self.outcomes.list[place].field]),
            Leeway::Any => false,
        })
    }

    /// The integers of the outcomes in the bits of a word.
    fn integers(&self, bits: &[u32]) -> Vec<i64> {
        let integer = |outcome| self.outcomes.field(outcome).integer(bits[outcome.field]);
        self.outcomes.list.iter().map(|&outcome| integer(outcome)).collect()
    }

    /// How far an outcome is from ours, in last places at our exponent; 0 of what is no number.
    fn apart(&self, place: usize, theirs: &[i64], ours: &[i64]) -> f64 {
        match self.roles[place] {
            Role::Number(None) => (theirs[place] - ours[place]).abs() as f64,
            // Zero has the smallest exponent of all.
            Role::Number(Some(_)) if theirs[place] == 0 => ours[place].abs() as f64,
            Role::Number(Some(exponent)) => {
                let places = (theirs[exponent] - ours[exponent]) as f64;
                (theirs[place] as f64 * places.exp2() - ours[place] as f64).abs()
            }
            Role::Exponent | Role::Decision => 0.0,
        }
    }
}

/// Adds what one rounding does and forgets it.
fn add_to(sum: &mut [f64], of_one: &mut [f64]) {
    for (sum, of_one) in sum.iter_mut().zip(of_one) {
        *sum += std::mem::take(of_one);
    }
}
