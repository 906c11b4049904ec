//! Verify: every value is recomputed from the inputs in the file, and every difference is named.

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use roughxel_utilities::crc::flipped_bit;
use serde::Serialize;

use super::VectorError;
use super::datapath::outcome;
use super::field::Field;
use super::layout::Layout;
use super::lines::{Line, Lines};
use super::manifest::Manifest;
use super::order::{Misplaced, misplaced, with_cause};
use super::part::Part;
use super::word::check_value;

/// Most mismatches that are described; all are counted.
const DESCRIBED: usize = 10;
/// Words compared at once.
const BATCH: usize = 1 << 12;

/// Result of a comparison.
#[derive(Clone, Debug, Serialize)]
pub struct Verification {
    /// The set.
    pub set: String,
    /// Its profile.
    pub profile: String,
    /// Its vectors; for a part those of the part.
    pub count: u64,
    /// The part of a set; `None` for a whole one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub part: Option<Part>,
    /// True if the file is the one of the manifest, byte for byte.
    pub hash_matches: bool,
    /// Number of vectors that differ.
    pub mismatching: u64,
    /// The first of them, at most ten.
    pub mismatches: Vec<Mismatch>,
    /// Words at a wrong position, missing or extra, if every word is right but the file is not the one of the manifest; at most
    /// ten.
    pub misplaced: Vec<Misplaced>,
}

impl Verification {
    /// Returns true if every value and the hash agree.
    pub fn passed(&self) -> bool {
        self.hash_matches && self.mismatching == 0
    }
}

/// Cause of a difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// The check value locates one flipped bit of the file.
    FlippedBit,
    /// The word is damaged in several bits; the earliest differing stage is named.
    Damaged,
    /// The word is unchanged; this version computes a different value.
    Computed,
}

/// One vector that differs.
#[derive(Clone, Debug, Serialize)]
pub struct Mismatch {
    /// The set.
    pub set: String,
    /// Index of the vector in the whole set, from 0.
    pub index: u64,
    /// Line of the file, or record, from 1.
    pub line: u64,
    /// Earliest stage that differs, or the stage of the flipped bit.
    pub stage: String,
    /// Its field.
    pub field: String,
    /// Highest differing bit of the field.
    pub bit: u32,
    /// The field's bits in the file.
    pub found: u32,
    /// The right bits.
    pub expected: u32,
    /// Cause of the difference.
    pub cause: Cause,
    /// Fields that do not follow from the inputs in the file.
    pub fields_differing: usize,
}

/// A sentence: set, index, line, stage, field, bit and the cause.
impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { set, index, line, stage, field, bit, found, expected, cause, fields_differing } = self;
        write!(f, "{set} #{index} (line {line}): stage {stage}, field {field}, bit {bit}: ")?;
        match cause {
            Cause::FlippedBit => write!(f, "flipped in the file ({found:x}, was {expected:x})"),
            Cause::Damaged => write!(
                f,
                "{found:x} in the file, {expected:x} computed; several bits of the word are damaged, {fields_differing} fields differ"
            ),
            Cause::Computed => write!(
                f,
                "{found:x} in the file, {expected:x} computed by this version; {fields_differing} fields differ"
            ),
        }
    }
}

/// The manifests of a directory, in the order of their names.
///
/// Errors: unreadable, words without their manifest, or no manifest at all.
pub fn manifests_in(directory: &Path) -> Result<Vec<PathBuf>, VectorError> {
    let error = |source| VectorError::Io { action: "read", path: directory.into(), source };
    let entries = fs::read_dir(directory).map_err(error)?;
    let mut files: Vec<_> = entries.map(|entry| entry.map(|e| e.path())).collect::<Result<_, _>>().map_err(error)?;
    files.sort();
    let has_extension = |path: &Path, extension| path.extension().is_some_and(|e| e == extension);
    let lonely = |path: &&PathBuf| {
        (has_extension(path, "hex") || has_extension(path, "bin")) && !path.with_extension("json").exists()
    };
    if let Some(path) = files.iter().find(lonely) {
        return Err(VectorError::Manifest {
            path: path.with_extension("json"),
            problem: format!("missing, though {} is there; export the set again", path.display()),
        });
    }
    files.retain(|path| has_extension(path, "json"));
    if files.is_empty() { Err(VectorError::NoSets(directory.into())) } else { Ok(files) }
}

/// The manifests that a path names: those of a directory, a manifest, or the one next to words.
///
/// Errors: those of [`manifests_in`].
pub fn manifests_of(path: &Path) -> Result<Vec<PathBuf>, VectorError> {
    match path.extension() {
        _ if path.is_dir() => manifests_in(path),
        Some(extension) if extension == "hex" || extension == "bin" => Ok(vec![path.with_extension("json")]),
        _ => Ok(vec![path.to_path_buf()]),
    }
}

/// Recomputes and compares the set of `manifest_path`; `progress` gets the number of finished vectors.
///
/// Errors: see [`VectorError`]. Differences are results, not errors.
pub fn verify(manifest_path: &Path, progress: &dyn Fn(u64)) -> Result<Verification, VectorError> {
    let manifest = Manifest::read(manifest_path)?;
    let layout = manifest.layout(manifest_path)?;
    let result = compared(manifest_path, &manifest, &layout, progress);
    let mut result = result.map_err(|error| with_cause(error, manifest_path, &manifest, &layout))?;
    // Changed words have been named.
    if !result.hash_matches && result.mismatching == 0 {
        result.misplaced = misplaced(manifest_path, &manifest, &layout);
    }
    Ok(result)
}

/// Compares everything except the order of the words.
fn compared(
    manifest_path: &Path,
    manifest: &Manifest,
    layout: &Layout,
    progress: &dyn Fn(u64),
) -> Result<Verification, VectorError> {
    let mut lines = Lines::open(manifest_path, manifest)?;
    let mut result = Verification {
        set: manifest.set.clone(),
        profile: manifest.profile.name.clone(),
        count: manifest.count,
        part: manifest.part,
        hash_matches: false,
        mismatching: 0,
        mismatches: Vec::new(),
        misplaced: Vec::new(),
    };
    let checker = Checker { layout, manifest };
    let mut count = 0;
    while let Some(batch) = lines.batch(BATCH)? {
        count += batch.len() as u64;
        let compared: Vec<_> = batch.par_iter().map(|line| (line.number, checker.compare(line))).collect();
        for (number, outcome) in compared {
            if let Some(mismatch) = outcome.map_err(|problem| lines.problem(number, problem))? {
                result.mismatching += 1;
                if result.mismatches.len() < DESCRIBED {
                    result.mismatches.push(mismatch);
                }
            }
        }
        progress(count);
    }
    result.hash_matches = lines.hash_matches()?;
    Ok(result)
}

/// Recomputes the words of a set.
pub(super) struct Checker<'a> {
    /// Layout of its words.
    pub(super) layout: &'a Layout,
    /// Manifest of the set.
    pub(super) manifest: &'a Manifest,
}

impl Checker<'_> {
    /// Compares one line with the word of its inputs; an error describes a line that is no word.
    pub(super) fn compare(&self, line: &Line) -> Result<Option<Mismatch>, String> {
        let fields = self.layout.fields();
        let found = line.bits(self.layout)?;
        let (expected, unfit) = self.expected(&found);
        if unfit.is_none() && found == expected {
            return Ok(None);
        }
        let &Line { index, number: line, .. } = line;

        let mismatch = |field: &Field, difference: u32, found: u32, cause, fields_differing| Mismatch {
            set: self.manifest.set.clone(),
            index,
            line,
            stage: field.stage.clone(),
            field: field.name.clone(),
            bit: difference.checked_ilog2().unwrap_or(0),
            found,
            expected: found ^ difference,
            cause,
            fields_differing,
        };
        // The check value is compared with the word that contains it, not with the expected one.
        let data = fields.len() - 1;
        let differing: Vec<_> = (0..data).filter(|&i| found[i] != expected[i] || unfit == Some(i)).collect();
        let syndrome = check_value(self.layout, &found) ^ found[data];
        let flipped = if syndrome == 0 { None } else { flipped_bit(syndrome, self.layout.word_bits()) };
        if let Some((at, bit)) = flipped.and_then(|place| self.layout.field_at(place)) {
            return Ok(Some(mismatch(&fields[at], 1 << bit, found[at], Cause::FlippedBit, differing.len())));
        }
        let cause = if syndrome == 0 { Cause::Computed } else { Cause::Damaged };
        let first = differing.iter().copied().min_by_key(|&i| self.layout.rank(i)).unwrap_or(data);
        let difference = if first == data { syndrome } else { found[first] ^ expected[first] };
        Ok(Some(mismatch(&fields[first], difference, found[first], cause, differing.len())))
    }

    /// The word that belongs to the inputs of `found`, and the field that its value does not fit, if any.
    pub(super) fn expected(&self, found: &[u32]) -> (Vec<u32>, Option<usize>) {
        let inputs = self.layout.decode(found);
        let Manifest { datapath, effects, profile, .. } = self.manifest;
        let outputs = match self.layout.stage() {
            Some(stage) => stage.outcome(&inputs, &mut Vec::new()),
            None => outcome(*datapath, &inputs, effects, &profile.knobs),
        };
        let mut unfit = None;
        let mut bits = self.layout.encode(&inputs, &outputs).unwrap_or_else(|field| {
            unfit = Some(field);
            found[..found.len() - 1].to_vec()
        });
        bits.push(check_value(self.layout, &bits));
        (bits, unfit)
    }
}
