//! The choice of a precision: the cheapest that reaches an accuracy, or the most accurate within a budget.
//!
//! ```text
//!  candidates ─► cost ─► by cost ─► psnr, the cheapest first, no more than the aim needs ─► choose
//! ```

use std::cmp::Ordering;
use std::fmt;
use std::str::FromStr;

use roughxel_core::precision::{Precision, Profile, RoughnessKind};
use thiserror::Error;

/// Kind of cost of a precision, and its machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Clock {
    /// Time of a frame on this machine.
    Host,
    /// Size of the hardware.
    Hardware,
    /// Time of a fragment on a small processor.
    SoftCore,
    /// Reads of memory.
    Memory,
}

impl Clock {
    /// Every clock.
    pub const ALL: [Self; 4] = [Self::Host, Self::Hardware, Self::SoftCore, Self::Memory];

    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        ["host", "hardware", "softcore", "memory"][self as usize]
    }
}

impl fmt::Display for Clock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Clock {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let named = Self::ALL.into_iter().find(|clock| clock.name() == text);
        named.ok_or_else(|| format!("clocks are {}", Self::ALL.map(Self::name).join(", ")))
    }
}

/// A precision with its known figures.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Its knobs.
    pub precision: Precision,
    /// The named profile that it is.
    pub name: Option<String>,
    /// Accuracy, dB: the worst of the scenes.
    pub psnr: f64,
    /// Costs in the order of [`Clock::ALL`], each in its own unit; `None` if unknown.
    pub cost: [Option<f64>; 4],
}

impl Candidate {
    /// Its cost on a clock; NaN counts as unknown.
    pub fn cost_on(&self, clock: Clock) -> Option<f64> {
        self.cost[clock as usize].filter(|cost| !cost.is_nan())
    }
}

/// A source of figures of a precision.
pub trait Meter {
    /// Its cost on a clock, in the unit of the clock; `None` if unknown.
    fn cost(&self, clock: Clock, p: &Precision) -> Option<f64>;

    /// Its accuracy, dB.
    fn psnr(&self, p: &Precision) -> f64;
}

/// Goal of a choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    /// The cheapest with at least this accuracy, dB.
    Psnr(f64),
    /// The most accurate with at most this cost, in the unit of the clock.
    Budget(f64),
}

impl Aim {
    /// Returns true if the figures meet the aim; false for NaN.
    fn is_met(self, psnr: f64, cost: f64) -> bool {
        match self {
            Self::Psnr(bar) => psnr >= bar,
            Self::Budget(most) => cost <= most && !psnr.is_nan(),
        }
    }
}

/// Reason why there is no choice.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoChoice {
    /// No candidate's cost is known.
    #[error("the cost on the clock {0} is not known")]
    Unknown(Clock),
    /// No candidate meets the aim.
    #[error("{}", missed(*aim, *clock, nearest))]
    Missed {
        /// The aim of the choice.
        aim: Aim,
        /// The clock of the costs.
        clock: Clock,
        /// The most accurate candidate, or with a budget the cheapest.
        nearest: Box<Candidate>,
    },
}

/// Distance of the nearest candidate from an aim.
fn missed(aim: Aim, clock: Clock, nearest: &Candidate) -> String {
    match aim {
        Aim::Psnr(bar) => {
            let best = nearest.psnr;
            format!("none reaches {bar} dB; the most accurate has {best:.2} dB, {:.2} dB less", bar - best)
        }
        Aim::Budget(most) => {
            let cost = nearest.cost_on(clock).unwrap_or(f64::NAN);
            format!(
                "none costs at most {most} on the clock {clock}; the cheapest costs {cost:.6}, {:.2} times that",
                cost / most
            )
        }
    }
}

/// Orders NaN after every number.
fn ascending(a: f64, b: f64) -> Ordering {
    a.is_nan().cmp(&b.is_nan()).then(a.partial_cmp(&b).unwrap_or(Ordering::Equal))
}

/// Orders the higher number first.
fn descending(a: f64, b: f64) -> Ordering {
    a.is_nan().cmp(&b.is_nan()).then(b.partial_cmp(&a).unwrap_or(Ordering::Equal))
}

/// The candidate that meets the aim best on a clock: the cheapest, or the most accurate. The other figure decides between equal
/// ones, then a named one wins, then the first.
///
/// Errors: costs are not known on this clock, or no candidate meets the aim.
pub fn choose(candidates: &[Candidate], aim: Aim, clock: Clock) -> Result<&Candidate, NoChoice> {
    let by_cost = |a: &Candidate, b: &Candidate| {
        let cost = |of: &Candidate| of.cost_on(clock).unwrap_or(f64::NAN);
        ascending(cost(a), cost(b))
    };
    let by_psnr = |a: &Candidate, b: &Candidate| descending(a.psnr, b.psnr);
    let by_name = |a: &Candidate, b: &Candidate| b.name.is_some().cmp(&a.name.is_some());
    let cheapest = |a: &&Candidate, b: &&Candidate| by_cost(a, b).then(by_psnr(a, b)).then(by_name(a, b));
    let best = |a: &&Candidate, b: &&Candidate| by_psnr(a, b).then(by_cost(a, b)).then(by_name(a, b));

    let known = || candidates.iter().filter(|candidate| candidate.cost_on(clock).is_some());
    let fits = |candidate: &&Candidate| candidate.cost_on(clock).is_some_and(|cost| aim.is_met(candidate.psnr, cost));
    let (chosen, nearest) = match aim {
        Aim::Psnr(_) => (known().filter(fits).min_by(cheapest), known().min_by(best)),
        Aim::Budget(_) => (known().filter(fits).min_by(best), known().min_by(cheapest)),
    };
    chosen.ok_or_else(|| match nearest {
        Some(nearest) => NoChoice::Missed { aim, clock, nearest: Box::new(nearest.clone()) },
        None => NoChoice::Unknown(clock),
    })
}

/// Measures only the precisions that [`choose`] needs for the choice it makes among all. Returns them by cost, with the cost on
/// this clock alone.
///
/// For an accuracy, these are the precisions up to the first that reaches it, and those of equal cost. For a budget, they are all
/// within it, or the cheapest if none is.
pub fn measure(
    precisions: &[Precision],
    aim: Aim,
    clock: Clock,
    mut cost: impl FnMut(&Precision) -> Option<f64>,
    mut psnr: impl FnMut(&Precision) -> f64,
) -> Vec<Candidate> {
    let priced = precisions.iter().filter_map(|p| Some((*p, cost(p).filter(|cost| !cost.is_nan())?)));
    let mut priced: Vec<(Precision, f64)> = priced.collect();
    priced.sort_by(|(_, a), (_, b)| ascending(*a, *b));
    let cheapest = priced.first().map_or(f64::NAN, |(_, cost)| *cost);
    // No precision of higher cost has to be measured.
    let mut most = match aim {
        Aim::Psnr(_) => f64::INFINITY,
        Aim::Budget(budget) => budget.max(cheapest),
    };
    let mut measured = Vec::new();
    for (precision, cost) in priced {
        if cost > most {
            break;
        }
        let psnr = psnr(&precision);
        if matches!(aim, Aim::Psnr(_)) && aim.is_met(psnr, cost) {
            most = cost;
        }
        let mut costs = [None; 4];
        costs[clock as usize] = Some(cost);
        let name = Profile::ALL.into_iter().find(|profile| profile.precision() == precision);
        measured.push(Candidate { precision, name: name.map(|profile| profile.name().into()), psnr, cost: costs });
    }
    measured
}

/// The next cheaper candidate than the chosen one on a clock, the most accurate of several: it shows the cost of the aim.
pub fn next_cheaper<'a>(candidates: &'a [Candidate], chosen: &Candidate, clock: Clock) -> Option<&'a Candidate> {
    let most = chosen.cost_on(clock)?;
    let cost = |candidate: &Candidate| candidate.cost_on(clock).unwrap_or(f64::NAN);
    let cheaper = candidates.iter().filter(|candidate| cost(candidate) < most);
    cheaper.min_by(|a, b| descending(cost(a), cost(b)).then(descending(a.psnr, b.psnr)))
}

/// [`Precision::grid`] with 1 to 16 probes and isotropic roughness or not, every combination, in addition to the named profiles,
/// which come first. No precision is in the list twice.
pub fn candidates() -> Vec<Precision> {
    let mut all = Profile::ALL.map(Profile::precision).to_vec();
    let counted = |p| [1, 2, 4, 8, 16].map(|max_probes| Precision { max_probes, ..p });
    let rough =
        |p| [RoughnessKind::Isotropic, RoughnessKind::Anisotropic].map(|roughness| Precision { roughness, ..p });
    for one in Precision::grid().flat_map(counted).flat_map(rough) {
        if !all.contains(&one) {
            all.push(one);
        }
    }
    all
}

#[cfg(test)]
mod tests;
