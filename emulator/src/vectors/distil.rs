//! Distil: few vectors of many that show the same mistakes.
//!
//! First come those that are needed for operations that are others, then those for entries of tables and bins, then, up to the number that is
//! asked for, those that show most of the stuck bits left: any operation may be wrong, and of entries of a table few are. Always the vector that shows most of what is still missing is next (a greedy cover, within
//! ln n of the smallest one), among those that were the first to show something.

use std::cmp::Reverse;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::Serialize;

use super::VectorError;
use super::datapath::Inputs;
use super::grade::{Hunt, is_of_one_design, read_words};
use super::manifest::Manifest;
use super::outcomes::Outcomes;
use crate::net::bins::Bins;
use crate::net::fault::{Effect, Fault, Faults, Simulator};
use crate::net::interval::Ranges;

/// A vector of a set.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Picked {
    /// The set.
    pub set: String,
    /// Index of the vector, from 0.
    pub index: u64,
}

/// Few vectors of many.
#[derive(Clone, Debug)]
pub struct Distilled {
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
    /// It showed something first that has to be shown.
    has_to: bool,
}

/// At most `most` vectors of sets of one design; `progress` is told how many vectors are done.
///
/// Errors: see [`VectorError`]; sets of several designs.
pub fn distil(first: &Path, others: &[PathBuf], most: usize, progress: &dyn Fn(u64)) -> Result<Distilled, VectorError> {
    let of = Manifest::read(first)?;
    let mut sets = vec![(first, of.clone())];
    for path in others {
        let manifest = Manifest::read(path)?;
        if !is_of_one_design(&of, &manifest) {
            let problem = format!(
                "datapath, effects, profile or columns are not those of {}; distil sets of one kind at a time",
                first.display()
            );
            return Err(VectorError::Manifest { path: path.clone(), problem });
        }
        sets.push((path, manifest));
    }

    if of.stage.is_some() {
        let problem = "a set of one stage; distil the datapath's, and export the stage of what is left".into();
        return Err(VectorError::Manifest { path: first.into(), problem });
    }
    let layout = of.layout(first)?;
    let outcomes = Outcomes::of(&of, &layout);
    let ranges = Ranges::new(&outcomes.net);
    let faults = Faults::new(&outcomes.net, &ranges, outcomes.shown());
    let bins = Bins::new(&outcomes.net, &ranges, &faults.tables);
    let wires = |bits: &Vec<u32>| {
        let mut wires = Vec::new();
        outcomes.net.evaluate(&outcomes.ports(bits), &mut wires);
        wires
    };
    let still = Still { faults: &faults, bins: &bins };
    let (has_to, stuck): (Vec<Fault>, Vec<Fault>) =
        faults.faults.iter().partition(|fault| !matches!(fault, Fault::Stuck { .. }));

    // What shows something first, of all.
    let (mut has_to, mut stuck) = (still.of(&has_to), still.of(&stuck).without_bins());
    let mut candidates: Vec<Candidate> = Vec::new();
    let mut done = 0;
    for (path, manifest) in &sets {
        read_words(path, manifest, &layout, &mut |index, batch| {
            let wires: Vec<_> = batch.iter().map(wires).collect();
            let shown = has_to.show(&wires).into_iter().zip(stuck.show(&wires));
            for (place, ((has_to, stuck), bits)) in shown.zip(batch).enumerate() {
                if has_to + stuck > 0 {
                    let picked = Picked { set: manifest.set.clone(), index: index + place as u64 };
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
        |simulator, &place| still.shown(simulator, &has_to, &wires(&candidates[place].bits)),
    );
    let is_operation = |number: usize| matches!(has_to.get(number), Some(Fault::Slip { .. }));
    let mut chosen: Vec<usize> =
        cover(&shown.collect::<Vec<_>>(), &is_operation, most).into_iter().map(|place| needed[place]).collect();

    let mut looking = still.of(&stuck).without_bins();
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
    let inputs = chosen.iter().map(|&place| Inputs::of(of.datapath, &layout.decode(&candidates[place].bits))).collect();
    let picked = chosen.iter().map(|&place| candidates[place].picked.clone()).collect();
    Ok(Distilled { of, picked, inputs })
}

/// A design in which something is still looked for.
#[derive(Clone, Copy)]
struct Still<'a> {
    faults: &'a Faults<'a>,
    bins: &'a Bins<'a>,
}

impl<'a> Still<'a> {
    /// Of some faults, and of bins.
    fn of(self, faults: &[Fault]) -> Looking<'a> {
        let hunt = Hunt::new(self.faults, faults.iter().copied());
        Looking { all: faults.to_vec(), hunt, bins: self.bins, met: vec![false; self.bins.bins.len()] }
    }

    /// Places of the faults that a vector shows, and behind them those of the bins that it meets.
    fn shown(self, simulator: &mut Simulator, faults: &[Fault], wires: &[i64]) -> Vec<usize> {
        let is_seen = |&place: &usize| simulator.effect(faults[place], wires) == Effect::Seen;
        let mut shown: Vec<usize> = (0..faults.len()).filter(is_seen).collect();
        let first = shown.len();
        self.bins.met(wires, |bin| shown.push(faults.len() + bin));
        // An entry is met as often as it is read.
        shown[first..].sort_unstable();
        shown.dedup();
        shown
    }
}

/// Rows of few that hold all numbers which any row holds, those of the `first` numbers before the others: always the one with most that none
/// before it had, the first of equals. At most `most` of them.
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

/// What is looked for.
struct Looking<'a> {
    all: Vec<Fault>,
    hunt: Hunt<'a>,
    bins: &'a Bins<'a>,
    met: Vec<bool>,
}

impl Looking<'_> {
    fn without_bins(mut self) -> Self {
        self.met.fill(true);
        self
    }

    /// How much each of these vectors is the first to show.
    fn show(&mut self, wires: &[Vec<i64>]) -> Vec<usize> {
        let mut shown = self.hunt.show(wires);
        for (shown, wires) in shown.iter_mut().zip(wires) {
            self.bins.met(wires, |bin| *shown += usize::from(!std::mem::replace(&mut self.met[bin], true)));
        }
        shown
    }

    /// The faults that were shown.
    fn seen(&self) -> Vec<Fault> {
        let unseen: HashSet<Fault> = self.hunt.unseen.iter().map(|&(fault, _)| fault).collect();
        self.all.iter().copied().filter(|fault| !unseen.contains(fault)).collect()
    }
}
