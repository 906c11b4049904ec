//! Ambiguous vectors: those of a set in which a decision can differ if a device rounds in its own way.

use std::path::Path;

use rayon::prelude::*;
use serde::Serialize;

use super::VectorError;
use super::bound::{Bounds, Leeway};
use super::lines::Lines;
use super::manifest::Manifest;
use super::outcomes::Outcomes;

/// Vectors that are looked at at once.
const BATCH: usize = 1 << 10;

/// Marks of a set.
#[derive(Clone, Debug, Serialize)]
pub struct Ambiguous {
    /// The set.
    pub set: String,
    /// Its profile.
    pub profile: String,
    /// Vectors.
    pub count: u64,
    /// Last places by which each rounding may be off.
    pub places: u32,
    /// The vectors that are marked.
    pub marked: Vec<AmbiguousVector>,
}

/// A vector with decisions that can differ.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct AmbiguousVector {
    /// Index of the vector in the whole set, from 0.
    pub index: u64,
    /// Fields that can differ.
    pub fields: Vec<String>,
}

impl Ambiguous {
    /// A line a vector in the order of the set, 1 where it is marked, else 0, for `$readmemh`.
    pub fn lines(&self, first: u64) -> String {
        let mut lines = vec![b'0'; self.count as usize];
        self.marked.iter().for_each(|marked| lines[(marked.index - first) as usize] = b'1');
        let digits = lines.iter().map(|&digit| [char::from(digit), '\n']);
        let title = format!(
            "// {} {}: 1 where decisions may be others, roundings {} last places off\n",
            self.set, self.profile, self.places
        );
        title.chars().chain(digits.flatten()).collect()
    }
}

/// Marks the vectors of a set; `progress` gets the number of finished vectors.
///
/// Errors: see [`VectorError`].
pub fn ambiguous(manifest_path: &Path, places: u32, progress: &dyn Fn(u64)) -> Result<Ambiguous, VectorError> {
    let manifest = Manifest::read(manifest_path)?;
    let layout = manifest.layout(manifest_path)?;
    let outcomes = Outcomes::new(&manifest, &layout);
    let bounds = Bounds::new(&outcomes, places);
    let mut marked = Vec::new();
    let mut lines = Lines::open(manifest_path, &manifest)?;
    let mut done = 0;
    while let Some(batch) = lines.batch(BATCH)? {
        done += batch.len() as u64;
        let of_batch: Vec<AmbiguousVector> = batch
            .par_iter()
            .map(|line| {
                let leeway = bounds.leeway(&lines.bits(line, &layout)?);
                let open = leeway.iter().zip(&outcomes.list).filter(|(leeway, _)| match leeway {
                    Leeway::OneOf(decisions) => decisions.len() > 1,
                    Leeway::Within(_) | Leeway::Any => false,
                });
                let fields = open.map(|(_, &outcome)| outcomes.field(outcome).name.clone()).collect();
                Ok(AmbiguousVector { index: line.index, fields })
            })
            .collect::<Result<_, VectorError>>()?;
        marked.extend(of_batch.into_iter().filter(|marked| !marked.fields.is_empty()));
        progress(done);
    }
    if !lines.hash_matches()? {
        return Err(super::check::not_its_words(manifest_path));
    }
    let (set, profile) = (manifest.set.clone(), manifest.profile.name.clone());
    Ok(Ambiguous { set, profile, count: manifest.count, places, marked })
}
