//! Condensing: few vectors of many that show the same mistakes.
//!
//! The order is: vectors needed to show operator faults, vectors for table entries and bins, then, up to the requested number,
//! those that show most of the remaining stuck bits. Any operation may be wrong, but few entries of a table are. The next vector
//! is always the one that shows most of the missing mistakes (a greedy cover, within ln n of the smallest one). Candidates are
//! the vectors that were the first to show something.

use std::cmp::Reverse;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use roughxel_netlist::bins::Bins;
use roughxel_netlist::fault::{Effect, Fault, Faults, Simulator};
use roughxel_netlist::interval::Ranges;
use serde::Serialize;

use super::VectorError;
use super::coverage::{Hunt, Proofs, is_of_one_design, read_words};
use super::datapath::Inputs;
use super::manifest::Manifest;
use super::outcomes::Outcomes;

/// Kinds of mistakes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mistake {
    /// A wrong operation; it includes decisions and limits that have to be met.
    Operation,
    /// An entry of a table is off by a last place.
    Entry,
    /// A bit of a wire never changes.
    Stuck,
}

impl Mistake {
    /// Every kind.
    pub const ALL: [Self; 3] = [Self::Operation, Self::Entry, Self::Stuck];

    fn from_fault(fault: &Fault) -> Self {
        match fault {
            Fault::OperatorFault { .. } => Self::Operation,
            Fault::Entry { .. } => Self::Entry,
            Fault::Stuck { .. } => Self::Stuck,
        }
    }
}

/// Requirements on the few vectors.
#[derive(Clone, Copy, Debug)]
pub struct Wanted<'a> {
    /// Largest number of vectors.
    pub most: usize,
    /// Sets that the vectors supplement: mistakes that those sets show are not looked for.
    pub beside: &'a [PathBuf],
    /// Mistakes that the vectors have to show.
    pub mistakes: &'a [Mistake],
}

/// A vector of a set.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Picked {
    /// The set, or its seed; the published random sets are named by their seed.
    pub set: String,
    /// Index of the vector, from 0.
    pub index: u64,
}

/// Few vectors of many.
#[derive(Clone, Debug)]
pub struct Condensed {
    /// The manifest of one of the sets, for what they have in common.
    pub of: Manifest,
    /// The vectors, those that show most first.
    pub picked: Vec<Picked>,
    /// Their ports.
    pub inputs: Vec<Inputs>,
}

/// A vector that may be picked.
struct Candidate {
    picked: Picked,
    /// Bits of its fields.
    bits: Vec<u32>,
    /// True if it was the first to show something that has to be shown.
    has_to: bool,
}

/// Few vectors of sets of one design. `progress` gets the number of finished vectors, including those of the sets that they
/// supplement.
///
/// Errors: see [`VectorError`]; sets of several designs.
pub fn condense(
    first: &Path,
    others: &[PathBuf],
    Wanted { most, beside, mistakes }: Wanted<'_>,
    progress: &dyn Fn(u64),
) -> Result<Condensed, VectorError> {
    let of = Manifest::read(first)?;
    let mut sets = vec![(first, of.clone())];
    for path in others.iter().chain(beside) {
        let manifest = Manifest::read(path)?;
        if !is_of_one_design(&of, &manifest) {
            let problem = format!(
                "datapath, effects, profile or columns are not those of {}; condense sets of one kind at a time",
                first.display()
            );
            return Err(VectorError::Manifest { path: path.clone(), problem });
        }
        sets.push((path, manifest));
    }

    if of.stage.is_some() {
        let problem = "a set of one stage; condense the datapath's, and export the stage of what is left".into();
        return Err(VectorError::Manifest { path: first.into(), problem });
    }
    let layout = of.layout(first)?;
    let outcomes = Outcomes::new(&of, &layout);
    let ranges = Ranges::new(&outcomes.net);
    let faults = Faults::new(&outcomes.net, &ranges, outcomes.shown());
    let bins = Bins::new(&outcomes.net, &ranges, &faults.tables);
    let wires = |bits: &Vec<u32>| {
        let mut wires = Vec::new();
        outcomes.net.evaluate(&outcomes.ports(bits), &mut wires);
        wires
    };
    let still = Still { faults: &faults, bins: mistakes.contains(&Mistake::Operation).then_some(&bins) };
    let (has_to, stuck): (Vec<Fault>, Vec<Fault>) = (faults.faults.iter())
        .filter(|fault| mistakes.contains(&Mistake::from_fault(fault)))
        .partition(|fault| Mistake::from_fault(fault) != Mistake::Stuck);
    let (mut has_to, mut stuck) = (still.looking_for(&has_to), still.looking_for(&stuck).without_bins());
    let mut done = 0;
    let (sets, beside) = sets.split_at(1 + others.len());
    for (path, manifest) in beside {
        read_words(path, manifest, &layout, &mut |_, batch| {
            let wires: Vec<_> = batch.iter().map(wires).collect();
            has_to.show(&wires);
            stuck.show(&wires);
            done += batch.len() as u64;
            progress(done);
        })?;
    }
    if !beside.is_empty() {
        has_to.only_what_can_be_shown();
        stuck.only_what_can_be_shown();
    }
    let met_beside = has_to.met.clone();

    // Vectors that are the first of all to show something.
    let mut candidates: Vec<Candidate> = Vec::new();
    for (path, manifest) in sets {
        read_words(path, manifest, &layout, &mut |index, batch| {
            let wires: Vec<_> = batch.iter().map(wires).collect();
            let shown = has_to.show(&wires).into_iter().zip(stuck.show(&wires));
            let set = manifest.seed.as_ref().map_or(&manifest.set, |seed| &seed.name);
            for (place, ((has_to, stuck), bits)) in shown.zip(batch).enumerate() {
                if has_to + stuck > 0 {
                    let picked = Picked { set: set.clone(), index: index + place as u64 };
                    candidates.push(Candidate { picked, bits: bits.clone(), has_to: has_to > 0 });
                }
            }
            done += batch.len() as u64;
            progress(done);
        })?;
    }
    let (has_to, stuck) = (has_to.seen(), stuck.seen());

    let needed: Vec<usize> = (0..candidates.len()).filter(|&place| candidates[place].has_to).collect();
    let shown = needed.par_iter().map_init(
        || Simulator::new(&faults),
        |simulator, &place| still.shown(simulator, &has_to, &met_beside, &wires(&candidates[place].bits)),
    );
    let is_operation = |number: usize| matches!(has_to.get(number), Some(Fault::OperatorFault { .. }));
    let mut chosen: Vec<usize> =
        cover(&shown.collect::<Vec<_>>(), &is_operation, most).into_iter().map(|place| needed[place]).collect();

    let mut looking = still.looking_for(&stuck).without_bins();
    for &place in &chosen {
        looking.show(&[wires(&candidates[place].bits)]);
    }
    let mut rest: Vec<(usize, usize)> = Vec::new();
    for place in (0..candidates.len()).rev().filter(|place| !chosen.contains(place)) {
        rest.push((looking.show(&[wires(&candidates[place].bits)])[0], place));
    }
    rest.retain(|&(shown, _)| shown > 0);
    rest.sort_by_key(|&(shown, place)| (Reverse(shown), place));
    chosen.extend(rest.into_iter().map(|(_, place)| place));
    chosen.truncate(most);
    let inputs = chosen
        .iter()
        .map(|&place| Inputs::from_integers(of.datapath, &layout.decode(&candidates[place].bits)))
        .collect();
    let picked = chosen.iter().map(|&place| candidates[place].picked.clone()).collect();
    Ok(Condensed { of, picked, inputs })
}

/// A design with mistakes that are not shown yet.
#[derive(Clone, Copy)]
struct Still<'a> {
    faults: &'a Faults<'a>,
    /// Bins to meet besides operator faults, if those are wanted.
    bins: Option<&'a Bins<'a>>,
}

impl<'a> Still<'a> {
    /// Starts the search for some faults, and for bins.
    fn looking_for(self, faults: &[Fault]) -> Looking<'a> {
        let hunt = Hunt::new(self.faults, faults.iter().copied());
        let met = vec![false; self.bins.map_or(0, |bins| bins.bins.len())];
        Looking { of: self.faults, all: faults.to_vec(), hunt, bins: self.bins, met }
    }

    /// Indices of the faults that a vector shows, followed by those of the bins that it meets and that were not in `met`.
    fn shown(self, simulator: &mut Simulator, faults: &[Fault], met: &[bool], wires: &[i64]) -> Vec<usize> {
        let is_seen = |&place: &usize| simulator.effect(faults[place], wires) == Effect::Seen;
        let mut shown: Vec<usize> = (0..faults.len()).filter(is_seen).collect();
        let first = shown.len();
        if let Some(bins) = self.bins {
            bins.met(wires, |bin| {
                if !met[bin] {
                    shown.push(faults.len() + bin);
                }
            });
        }
        // An entry is met each time it is read.
        shown[first..].sort_unstable();
        shown.dedup();
        shown
    }
}

/// Few rows that together hold all numbers of all rows, those of the `first` numbers before the others. The next row is always
/// the one with most new numbers, the first of equals. At most `most` rows.
fn cover(rows: &[Vec<usize>], first: &dyn Fn(usize) -> bool, most: usize) -> Vec<usize> {
    let numbers = rows.iter().flatten().max().map_or(0, |&last| last + 1);
    let mut holders = vec![Vec::new(); numbers];
    for (row, held) in rows.iter().enumerate() {
        for &number in held {
            holders[number].push(row);
        }
    }
    let count = |row: &Vec<usize>| (row.iter().filter(|&&number| first(number)).count(), row.len());
    let mut new: Vec<(usize, usize)> = rows.iter().map(count).collect();
    let mut chosen = Vec::new();
    while chosen.len() < most {
        let Some(best) = (0..rows.len()).max_by_key(|&row| (new[row], Reverse(row))).filter(|&row| new[row].1 > 0)
        else {
            break;
        };
        chosen.push(best);
        for &number in &rows[best] {
            for row in std::mem::take(&mut holders[number]) {
                new[row].0 -= usize::from(first(number));
                new[row].1 -= 1;
            }
        }
    }
    chosen
}

/// State of a search.
struct Looking<'a> {
    of: &'a Faults<'a>,
    all: Vec<Fault>,
    hunt: Hunt<'a>,
    bins: Option<&'a Bins<'a>>,
    met: Vec<bool>,
}

impl Looking<'_> {
    fn without_bins(self) -> Self {
        Self { bins: None, ..self }
    }

    /// Forgets faults that have been shown, and drops those proven to be equal.
    fn only_what_can_be_shown(&mut self) {
        let mut proofs = Proofs::default();
        let equal = proofs.equal(self.of, &self.hunt.unseen);
        self.hunt.unseen.retain(|(fault, _)| !equal.contains(fault));
        self.all = self.hunt.unseen.iter().map(|&(fault, _)| fault).collect();
    }

    /// Number of faults and bins that each of these vectors is the first to show.
    fn show(&mut self, wires: &[Vec<i64>]) -> Vec<usize> {
        let mut shown = self.hunt.show(wires);
        for (shown, wires) in shown.iter_mut().zip(wires) {
            let Some(bins) = self.bins else { continue };
            bins.met(wires, |bin| *shown += usize::from(!std::mem::replace(&mut self.met[bin], true)));
        }
        shown
    }

    /// The faults that were shown.
    fn seen(&self) -> Vec<Fault> {
        let unseen: HashSet<Fault> = self.hunt.unseen.iter().map(|&(fault, _)| fault).collect();
        self.all.iter().copied().filter(|fault| !unseen.contains(fault)).collect()
    }
}
