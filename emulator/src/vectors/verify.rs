//! Verify: every value recomputed from the inputs in the file, every difference named.

use std::fs;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::Serialize;
use sha2::{Digest, Sha256};

use super::VectorError;
use super::datapath::outcome;
use super::export::hex_digest;
use super::layout::{Field, Layout};
use super::manifest::{Form, Manifest};
use super::word::{check_value, locate_flip, pack, read_record, read_word};
use crate::input::open_file;

/// Most mismatches that are described; all are counted.
const DESCRIBED: usize = 10;
/// Longest line: beyond every word and comment.
const MAX_LINE: u64 = 4096;
/// Words compared at once.
const BATCH: usize = 1 << 12;

/// What a comparison found.
#[derive(Clone, Debug, Serialize)]
pub struct Verification {
    /// The set.
    pub set: String,
    /// Its profile.
    pub profile: String,
    /// Its vectors.
    pub count: u64,
    /// Whether the file is the one the manifest was written for, byte for byte.
    pub hash_matches: bool,
    /// How many vectors differ.
    pub mismatching: u64,
    /// The first of them, at most ten.
    pub mismatches: Vec<Mismatch>,
}

impl Verification {
    /// Every value and the hash agree.
    pub fn passed(&self) -> bool {
        self.hash_matches && self.mismatching == 0
    }
}

/// Why a vector differs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// The check value locates one flipped bit of the file.
    FlippedBit,
    /// The word is damaged in several bits; the earliest differing stage is named.
    Damaged,
    /// The word is as it was written; this version computes another value.
    Computed,
}

/// One vector that differs.
#[derive(Clone, Debug, Serialize)]
pub struct Mismatch {
    /// The set.
    pub set: String,
    /// Index of the vector, from 0.
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
    /// What they should be.
    pub expected: u32,
    /// Why.
    pub cause: Cause,
    /// Fields that do not follow from the inputs in the file.
    pub fields_differing: usize,
}

/// The manifests of a directory, in the order of their names.
///
/// Errors: unreadable, words without their manifest, or none at all.
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

/// Recomputes and compares the set of `manifest_path`; `progress` is told how many vectors are done.
///
/// Errors: see [`VectorError`]. Differences are no errors, they are the result.
pub fn verify(manifest_path: &Path, progress: &dyn Fn(u64)) -> Result<Verification, VectorError> {
    let manifest = Manifest::read(manifest_path)?;
    let layout = manifest.layout();
    let entry = &manifest.files[0];
    let path = manifest_path.with_file_name(&entry.name);
    let error = |source| VectorError::Io { action: "read", path: path.clone(), source };
    let line_error = |line, problem| VectorError::Line { path: path.clone(), line, problem };

    let file = BufReader::with_capacity(1 << 16, open_file(&path).map_err(error)?);
    let form = manifest.form().unwrap_or(Form::Hex);
    let mut result = Verification {
        set: manifest.set.clone(),
        profile: manifest.profile.name.clone(),
        count: manifest.count,
        hash_matches: false,
        mismatching: 0,
        mismatches: Vec::new(),
    };
    let checker = Checker { layout: &layout, manifest: &manifest, form };
    let mut words = WordReader { file, form, layout: &layout, hash: Sha256::new(), line: 0 };
    let (mut count, mut at_end) = (0_u64, false);
    while !at_end {
        let mut batch: Vec<(u64, u64, Vec<u8>)> = Vec::with_capacity(BATCH);
        while batch.len() < BATCH {
            let Some(word) = words.next().map_err(error)? else {
                at_end = true;
                break;
            };
            let word = word.map_err(|problem| line_error(words.line, problem))?;
            if count == manifest.count {
                let (found, expected) = (count + 1, manifest.count);
                return Err(VectorError::Count { path: path.clone(), found, expected });
            }
            batch.push((count, words.line, word));
            count += 1;
        }
        let compared: Vec<_> =
            batch.par_iter().map(|(index, line, text)| (*line, checker.compare(*index, *line, text))).collect();
        for (line, outcome) in compared {
            if let Some(mismatch) = outcome.map_err(|problem| line_error(line, problem))? {
                result.mismatching += 1;
                if result.mismatches.len() < DESCRIBED {
                    result.mismatches.push(mismatch);
                }
            }
        }
        progress(count);
    }
    if count != manifest.count {
        return Err(VectorError::Count { path, found: count, expected: manifest.count });
    }
    result.hash_matches = hex_digest(words.hash) == entry.sha256;
    Ok(result)
}

/// The words of a file, one after the other, and the hash of what was read.
struct WordReader<'a, R> {
    file: R,
    form: Form,
    layout: &'a Layout,
    hash: Sha256,
    /// Lines or records read.
    line: u64,
}

impl<R: BufRead> WordReader<'_, R> {
    /// The next word without its end of line, or what is wrong with it; `None` at the end.
    fn next(&mut self) -> io::Result<Option<Result<Vec<u8>, String>>> {
        match self.form {
            Form::Hex => loop {
                let mut line = Vec::with_capacity(self.layout.line_length() + 1);
                let read = self.file.by_ref().take(MAX_LINE).read_until(b'\n', &mut line)?;
                if read == 0 {
                    return Ok(None);
                }
                self.line += 1;
                self.hash.update(&line);
                if line.last() == Some(&b'\n') {
                    line.pop();
                } else if read as u64 == MAX_LINE {
                    return Ok(Some(Err(format!("longer than {MAX_LINE} characters"))));
                }
                if !line.starts_with(b"//") {
                    return Ok(Some(Ok(line)));
                }
            },
            Form::Bin => {
                let mut record = Vec::with_capacity(self.layout.record_bytes());
                self.file.by_ref().take(self.layout.record_bytes() as u64).read_to_end(&mut record)?;
                self.line += u64::from(!record.is_empty());
                self.hash.update(&record);
                Ok((!record.is_empty()).then_some(Ok(record)))
            }
        }
    }
}

struct Checker<'a> {
    layout: &'a Layout,
    manifest: &'a Manifest,
    form: Form,
}

impl Checker<'_> {
    /// Compares one line with what its inputs give; an error says what is wrong with a line that is no word.
    fn compare(&self, index: u64, line: u64, text: &[u8]) -> Result<Option<Mismatch>, String> {
        let fields = self.layout.fields();
        let found = match self.form {
            Form::Hex => read_word(text, self.layout)?,
            Form::Bin => read_record(text, self.layout)?,
        };
        let (expected, unfit) = self.expected(&found);
        if unfit.is_none() && found == expected {
            return Ok(None);
        }

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
        // The check value is compared with the word it stands in, not with the expected one.
        let data = fields.len() - 1;
        let differing: Vec<_> = (0..data).filter(|&i| found[i] != expected[i] || unfit == Some(i)).collect();
        let syndrome = self.check_value(&found) ^ found[data];
        let flipped = if syndrome == 0 { None } else { locate_flip(syndrome, self.layout.word_bits()) };
        if let Some((at, bit)) = flipped.and_then(|place| self.layout.field_at(place)) {
            return Ok(Some(mismatch(&fields[at], 1 << bit, found[at], Cause::FlippedBit, differing.len())));
        }
        let cause = if syndrome == 0 { Cause::Computed } else { Cause::Damaged };
        let first = differing.iter().copied().min_by_key(|&i| self.layout.rank(i)).unwrap_or(data);
        let difference = if first == data { syndrome } else { found[first] ^ expected[first] };
        Ok(Some(mismatch(&fields[first], difference, found[first], cause, differing.len())))
    }

    /// The word that belongs to the inputs of `found`, and the field its value does not fit, if any.
    fn expected(&self, found: &[u32]) -> (Vec<u32>, Option<usize>) {
        let inputs = self.layout.decode(found);
        let Manifest { datapath, effects, profile, .. } = self.manifest;
        let outputs = outcome(*datapath, &inputs, effects, &profile.knobs);
        let mut unfit = None;
        let mut bits = self.layout.encode(&inputs, &outputs).unwrap_or_else(|field| {
            unfit = Some(field);
            found[..found.len() - 1].to_vec()
        });
        bits.push(self.check_value(&bits));
        (bits, unfit)
    }

    /// The check value of the fields above it.
    fn check_value(&self, bits: &[u32]) -> u32 {
        let (data, digits) = (self.layout.fields().len() - 1, self.layout.data_digits());
        let mut packed = Vec::new();
        pack(&self.layout.fields()[..data], &bits[..data], digits, &mut packed);
        check_value(&packed, digits)
    }
}
