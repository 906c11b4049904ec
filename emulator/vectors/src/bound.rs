//! Bound: the allowed distance of a device's fields from those of a set, vector by vector, if the device rounds in its own way.
//!
//! Every rounding of the design may be some last places more or less. A field that is a number may then differ by the sum of the
//! effects of each rounding alone. It may also differ by the largest effect of a comparison that can flip, plus the sum of the
//! effects of each rounding on that side. A field that is a decision may have any value that it has in such a design.

use std::collections::BTreeSet;

use roughxel_netlist::rounding::{Change, Moves, Roundings};

use super::outcomes::Outcomes;

/// A design whose roundings may be off.
pub(super) struct Bounds<'a> {
    outcomes: &'a Outcomes<'a>,
    roundings: Roundings<'a>,
    /// Last places by which each rounding may be off.
    places: u32,
    /// The role of each outcome.
    roles: Vec<Role>,
}

/// Role of an outcome.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    /// A number, in last places; for a mantissa, the position of its exponent among the outcomes.
    Number(Option<usize>),
    /// The exponent of mantissas, which is judged together with them.
    Exponent,
    /// A face, a count, flags.
    Decision,
}

/// Allowed values of an outcome of a vector.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Leeway {
    /// A distance of at most this many last places.
    Within(f64),
    /// One of these, as the bits of its field.
    OneOf(BTreeSet<u32>),
    /// Anything: the value is judged by other outcomes.
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

    /// The leeway of each outcome of the vector, in the order of the outcomes.
    pub(super) fn leeway(&self, expected: &[u32]) -> Vec<Leeway> {
        let (mut around, moves) = self.around(expected);
        self.further(expected, &moves, &mut around);
        around.leeway()
    }

    /// The first outcome of a device beyond its leeway, and the leeway.
    pub(super) fn beyond(&self, expected: &[u32], found: &[u32]) -> Option<(usize, Leeway)> {
        let (mut around, moves) = self.around(expected);
        // Nearly every word takes the same decisions and is within the reach of single roundings: no further design has to be
        // evaluated.
        around.beyond(found)?;
        self.further(expected, &moves, &mut around);
        around.beyond(found)
    }

    /// The design with each of its roundings alone.
    fn around(&self, expected: &[u32]) -> (Around<'_>, Moves) {
        let mut around = Around::new(self, expected);
        let see = &mut |number, wires: &[i64]| {
            around.see(Change::Alone(number), wires);
        };
        let moves = self.roundings.each_alone(&self.outcomes.ports(expected), i64::from(self.places), see);
        (around, moves)
    }

    /// Adds designs in which all roundings are off.
    fn further(&self, expected: &[u32], moves: &Moves, around: &mut Around<'_>) {
        let see = &mut |change, wires: &[i64]| around.see(change, wires);
        self.roundings.others(&self.outcomes.ports(expected), i64::from(self.places), moves, see);
    }

    /// The integers of the outcomes in the bits of a word.
    fn integers(&self, bits: &[u32]) -> Vec<i64> {
        let integer = |outcome| self.outcomes.field(outcome).integer(bits[outcome.field]);
        self.outcomes.list.iter().map(|&outcome| integer(outcome)).collect()
    }
}

/// A vector, and its outcomes in designs with other roundings.
struct Around<'a> {
    bounds: &'a Bounds<'a>,
    ours: Vec<i64>,
    /// Outcomes of the current design.
    theirs: Vec<i64>,
    /// The original design with its roundings, followed by others with theirs.
    designs: Vec<Near>,
    /// Possible values of a decision, as the bits of its field; for an outcome that is not a decision, its value.
    decisions: Vec<BTreeSet<u32>>,
}

impl<'a> Around<'a> {
    fn new(bounds: &'a Bounds<'a>, expected: &[u32]) -> Self {
        let ours = bounds.integers(expected);
        let decisions = bounds.outcomes.list.iter().map(|outcome| BTreeSet::from([expected[outcome.field]]));
        let designs = vec![Near::to(ours.clone(), vec![0.0; ours.len()])];
        Self { bounds, theirs: ours.clone(), designs, decisions: decisions.collect(), ours }
    }

    /// Adds a design. Returns true if it leads elsewhere: it takes a decision that no design before it takes, or is farther off
    /// than all of them allow.
    fn see(&mut self, change: Change, wires: &[i64]) -> bool {
        let Outcomes { list, .. } = self.bounds.outcomes;
        for (integer, outcome) in self.theirs.iter_mut().zip(list) {
            *integer = wires[outcome.node as usize] >> outcome.drop;
        }
        let mut elsewhere = false;
        for (place, outcome) in list.iter().enumerate().filter(|&(place, _)| self.theirs[place] != self.ours[place]) {
            if self.bounds.roles[place] == Role::Decision {
                let field = self.bounds.outcomes.field(*outcome);
                elsewhere |= self.decisions[place].insert(outcome.bits(field, self.theirs[place] << outcome.drop));
            }
        }
        let off = |from: &[i64]| (0..list.len()).map(|place| self.apart(place, &self.theirs, from)).collect::<Vec<_>>();
        match (change, self.designs.last()) {
            (Change::Alone(number), Some(design)) => {
                let off = off(&design.integers);
                self.designs.last_mut().into_iter().for_each(|design| design.alone(number, &off));
            }
            _ => {
                let off = off(&self.ours);
                elsewhere |= off.iter().enumerate().any(|(place, &off)| off > self.within(place));
                self.designs.push(Near::to(self.theirs.clone(), off));
            }
        }
        elsewhere
    }

    /// The first outcome of a device beyond its leeway, and the leeway.
    fn beyond(&self, found: &[u32]) -> Option<(usize, Leeway)> {
        let theirs = self.bounds.integers(found);
        self.leeway().into_iter().enumerate().find(|&(place, ref leeway)| match leeway {
            Leeway::Within(most) => self.apart(place, &theirs, &self.ours) > *most,
            Leeway::OneOf(decisions) => !decisions.contains(&found[self.bounds.outcomes.list[place].field]),
            Leeway::Any => false,
        })
    }

    fn leeway(&self) -> Vec<Leeway> {
        let leeway = |(place, role): (usize, &Role)| match role {
            Role::Number(_) => Leeway::Within(self.within(place)),
            Role::Decision => Leeway::OneOf(self.decisions[place].clone()),
            Role::Exponent => Leeway::Any,
        };
        self.bounds.roles.iter().enumerate().map(leeway).collect()
    }

    /// Largest error of a number: by the original roundings, plus the reach of the farthest other design with its roundings.
    fn within(&self, place: usize) -> f64 {
        let reach = |designs: &[Near]| designs.iter().map(|design| design.reach(place)).fold(0.0, f64::max);
        let (ours, others) = self.designs.split_at(1);
        reach(ours) + reach(others) + f64::from(self.bounds.places)
    }

    /// Distance of an outcome in two designs, in last places at the exponent of the original; 0 if it is not a number.
    fn apart(&self, place: usize, theirs: &[i64], others: &[i64]) -> f64 {
        let exponent = match self.bounds.roles[place] {
            Role::Number(exponent) => exponent,
            Role::Exponent | Role::Decision => return 0.0,
        };
        let real = |of: &[i64]| match exponent {
            // Zero has the smallest exponent.
            Some(exponent) if of[place] != 0 => of[place] as f64 * ((of[exponent] - self.ours[exponent]) as f64).exp2(),
            _ => of[place] as f64,
        };
        (real(theirs) - real(others)).abs()
    }
}

/// A design, and the effect of its roundings on its outcomes.
struct Near {
    integers: Vec<i64>,
    /// Distance of its outcomes from the original, and the sum of the effects of its roundings.
    reach: Vec<f64>,
    /// The number of the current rounding, and its effect in the direction in which it is larger.
    number: usize,
    most: Vec<f64>,
}

impl Near {
    fn to(integers: Vec<i64>, off: Vec<f64>) -> Self {
        let most = vec![0.0; off.len()];
        Self { integers, reach: off, number: 0, most }
    }

    /// Adds the distance that one rounding alone causes.
    fn alone(&mut self, number: usize, off: &[f64]) {
        if self.number != number {
            self.number = number;
            self.reach.iter_mut().zip(&mut self.most).for_each(|(reach, most)| *reach += std::mem::take(most));
        }
        self.most.iter_mut().zip(off).for_each(|(most, off)| *most = most.max(*off));
    }

    /// Largest distance of an outcome from the original.
    fn reach(&self, place: usize) -> f64 {
        self.reach[place] + self.most[place]
    }
}
