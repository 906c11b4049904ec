//! Merge: the parts of a set, joined to the files of the whole export, byte for byte.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use thiserror::Error;

use super::VectorError;
use super::files::SetFiles;
use super::lines::{Lines, is_whole};
use super::manifest::Manifest;
use super::order::{misplaced, with_cause};
use super::part::Part;
use super::verify::manifests_of;
use super::word::length;

/// Reason why parts cannot be joined.
#[derive(Debug, Error)]
pub enum MergeError {
    /// A part cannot be read, or the set cannot be written.
    #[error(transparent)]
    Set(#[from] VectorError),
    /// No parts to join.
    #[error("{}: no part of a set here (`roughxel vectors export --shard K/N` writes them)", .0.display())]
    NoParts(PathBuf),
    /// Parts of a set are missing.
    #[error("set {stem}: {} missing: export with the options of the others and `--shard {}/{of}`", listed(missing, *of), missing[0])]
    Missing {
        /// Set and profile.
        stem: String,
        /// Their numbers, from 1.
        missing: Vec<u64>,
        /// Parts of the set.
        of: u64,
    },
    /// A part that exists twice.
    #[error("part {number} of {of} exists twice: {} and {}; name one of them", .first.display(), .second.display())]
    Twice {
        /// Its number, from 1.
        number: u64,
        /// Parts of the set.
        of: u64,
        /// The first manifest.
        first: PathBuf,
        /// The second manifest.
        second: PathBuf,
    },
    /// Parts are not of the same set.
    #[error(
        "{}: `{key}` is not that of {}: they are not parts of one export; take one of them away or export it again with the \
         options of the others",
        .path.display(), .other.display()
    )]
    Different {
        /// The manifest of a part.
        path: PathBuf,
        /// The first part's.
        other: PathBuf,
        /// Key of the manifest.
        key: String,
    },
    /// The words of a part are not those of its manifest.
    #[error(
        "{}: the SHA-256 of its words is not the one in it{order}; part {} of {} was changed: export it again with `--shard {}/{}`",
        .manifest.display(), .part.number, .part.of, .part.number, .part.of
    )]
    Damaged {
        /// Its manifest.
        manifest: PathBuf,
        /// The part.
        part: Part,
        /// Words that are out of order; begins with a semicolon.
        order: String,
    },
}

/// The numbers, at most ten, and a verb.
fn listed(missing: &[u64], of: u64) -> String {
    let numbers: Vec<String> = missing.iter().take(10).map(u64::to_string).collect();
    let more = if missing.len() > 10 { format!(" and {} more", missing.len() - 10) } else { String::new() };
    let (parts, verb) = if missing.len() == 1 { ("part", "is") } else { ("parts", "are") };
    format!("{parts} {}{more} of {of} {verb}", numbers.join(", "))
}

/// All parts of one set, in order.
#[derive(Clone, Debug)]
pub struct Parts {
    parts: Vec<(PathBuf, Manifest, Part)>,
}

/// The sets whose parts are at `paths`, in the order of their names. Paths are directories, in which whole sets are skipped, or
/// single parts (NAME.json, NAME.hex or NAME.bin).
///
/// Errors: a path without parts, or an unreadable one; a part that is missing or exists twice; parts of different exports.
pub fn parts_of(paths: &[impl AsRef<Path>]) -> Result<Vec<Parts>, MergeError> {
    let mut sets: BTreeMap<String, Vec<(PathBuf, Manifest, Part)>> = BTreeMap::new();
    let mut known = BTreeSet::new();
    for path in paths.iter().map(AsRef::as_ref) {
        let mut has_parts = false;
        for manifest_path in manifests_of(path)? {
            let manifest = Manifest::read(&manifest_path)?;
            let Some(part) = manifest.part else { continue };
            has_parts = true;
            // A part named by itself and by its directory is one part.
            let real = fs::canonicalize(&manifest_path).unwrap_or_else(|_| manifest_path.clone());
            if known.insert(real) {
                sets.entry(manifest.whole_stem()).or_default().push((manifest_path, manifest, part));
            }
        }
        if !has_parts {
            return Err(MergeError::NoParts(path.into()));
        }
    }
    sets.into_values().map(Parts::new).collect()
}

impl Parts {
    fn new(mut parts: Vec<(PathBuf, Manifest, Part)>) -> Result<Self, MergeError> {
        parts.sort_by(|a, b| a.2.number.cmp(&b.2.number).then_with(|| a.0.cmp(&b.0)));
        let (first_path, first, Part { of, .. }) = &parts[0];
        for (path, manifest, _) in &parts[1..] {
            if let Some(key) = difference(first, manifest) {
                return Err(MergeError::Different { path: path.clone(), other: first_path.clone(), key });
            }
        }
        if let Some([a, b]) = parts.array_windows().find(|[a, b]| a.2.number == b.2.number) {
            let (first, second) = (a.0.clone(), b.0.clone());
            return Err(MergeError::Twice { number: a.2.number, of: *of, first, second });
        }
        let is_there = |number: &u64| parts.binary_search_by_key(number, |(_, _, part)| part.number).is_ok();
        let missing: Vec<u64> = (1..=*of).filter(|number| !is_there(number)).collect();
        if !missing.is_empty() {
            return Err(MergeError::Missing { stem: first.whole_stem(), missing, of: *of });
        }
        Ok(Self { parts })
    }

    /// Set and profile, as in the names of the set's files.
    pub fn stem(&self) -> String {
        self.parts[0].1.whole_stem()
    }

    /// Number of parts; never 0.
    #[expect(clippy::len_without_is_empty, reason = "a set without parts is none")]
    pub fn len(&self) -> usize {
        self.parts.len()
    }

    /// Vectors of the whole set.
    pub fn count(&self) -> u64 {
        self.parts[0].2.whole_count
    }

    /// Joins the parts to a set in `directory`, which is made if it does not exist. Words and manifest are those of the whole
    /// export, byte for byte. A word is in memory at a time; `progress` gets the number of finished vectors.
    ///
    /// Errors: words that are not those of their manifest, or that cannot be read or written; no incomplete file stays.
    pub fn merge(&self, directory: &Path, progress: &dyn Fn(u64)) -> Result<Manifest, MergeError> {
        let (path, first, _) = &self.parts[0];
        let whole = Manifest { part: None, count: self.count(), files: Vec::new(), grade: None, ..first.clone() };
        let (layout, form) = (whole.layout(path)?, first.form());
        let mut files = SetFiles::create(&whole, form, length(&layout, form), directory)?;
        for (path, manifest, part) in &self.parts {
            let mut join = || -> Result<bool, VectorError> {
                let mut lines = Lines::open(path, manifest)?;
                while let Some(line) = lines.next()? {
                    if line.index % PROGRESS == 0 {
                        progress(line.index);
                    }
                    files.write(&line.written())?;
                }
                // Right words need no check of their lines; for others the error names the line that is no word.
                Ok(lines.hash_matches()? || is_whole(path, manifest, &layout)?)
            };
            if !join().map_err(|error| with_cause(error, path, manifest, &layout))? {
                let order = misplaced(path, manifest, &layout);
                let order = order.iter().map(|misplaced| format!("; {misplaced}")).collect();
                return Err(MergeError::Damaged { manifest: path.clone(), part: *part, order });
            }
        }
        Ok(files.commit(whole)?)
    }
}

/// Words between two reports of progress.
const PROGRESS: u64 = 1 << 12;

/// The first key in which the manifests of two parts of one set differ and must not differ.
fn difference(a: &Manifest, b: &Manifest) -> Option<String> {
    let of_whole =
        |manifest: &Manifest| Manifest { part: None, count: 0, files: Vec::new(), grade: None, ..manifest.clone() };
    let extension = |manifest: &Manifest| manifest.form().extension();
    if a.part.map(|part| part.of) != b.part.map(|part| part.of) {
        return Some("part.of".into());
    } else if a.whole_count() != b.whole_count() {
        return Some("part.whole_count".into());
    } else if extension(a) != extension(b) {
        return Some("files".into());
    } else if of_whole(a) == of_whole(b) {
        return None;
    }
    let value = |manifest| serde_json::to_value(of_whole(manifest)).unwrap_or_default();
    let (Value::Object(a), Value::Object(b)) = (value(a), value(b)) else { return Some("fields".into()) };
    // Fields follow from other keys; a key that one manifest lacks is of an option that most sets do not use.
    let differing = |key: &&String| a.get(*key) != b.get(*key) && !["fields", "word_bits"].contains(&key.as_str());
    Some(a.keys().chain(b.keys()).find(differing).map_or_else(|| "fields".into(), String::clone))
}
