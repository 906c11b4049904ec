//! The words of a set's file, lines of text or records of bytes, with their numbers, and whether the file is the one its manifest was written for.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::VectorError;
use super::export::hex_digest;
use super::layout::Layout;
use super::manifest::{Form, Manifest};
use super::word::{read_record, read_word};
use crate::input::open_file;

/// Longest line: beyond every word and comment.
const MAX_LINE: u64 = 4096;

/// The words of a set, one after the other; comments are passed over.
pub(super) struct Lines {
    path: PathBuf,
    file: BufReader<File>,
    form: Form,
    record_bytes: usize,
    hash: Sha256,
    /// SHA-256 and number of words by the manifest.
    sha256: String,
    count: u64,
    /// Lines or records, and words so far.
    lines: u64,
    words: u64,
}

/// A line or a record that is a word, if it is right.
pub(super) struct Line {
    /// Index of the vector, from 0.
    pub(super) index: u64,
    /// Line or record of the file, from 1.
    pub(super) number: u64,
    /// Its bytes, without an end of line.
    text: Vec<u8>,
    form: Form,
}

impl Line {
    /// The fields' bits, padding and check value included, or what is wrong with it.
    pub(super) fn bits(&self, layout: &Layout) -> Result<Vec<u32>, String> {
        match self.form {
            Form::Hex => read_word(&self.text, layout),
            Form::Bin => read_record(&self.text, layout),
        }
    }
}

impl Lines {
    /// Opens the words of a manifest, which lie beside it.
    pub(super) fn open(manifest_path: &Path, manifest: &Manifest) -> Result<Self, VectorError> {
        let entry = &manifest.files[0];
        let path = manifest_path.with_file_name(&entry.name);
        let file = open_file(&path).map_err(|source| VectorError::Io { action: "read", path: path.clone(), source })?;
        Ok(Self {
            file: BufReader::with_capacity(1 << 16, file),
            form: manifest.form(),
            record_bytes: manifest.word_bits.div_ceil(8) as usize,
            path,
            hash: Sha256::new(),
            sha256: entry.sha256.clone(),
            count: manifest.count,
            lines: 0,
            words: 0,
        })
    }

    /// The next word; `None` at the end of the file.
    ///
    /// Errors: unreadable, a line that is too long, more words than the manifest says.
    pub(super) fn next(&mut self) -> Result<Option<Line>, VectorError> {
        loop {
            let mut text = Vec::with_capacity(512);
            let read = match self.form {
                Form::Hex => self.file.by_ref().take(MAX_LINE).read_until(b'\n', &mut text),
                Form::Bin => self.file.by_ref().take(self.record_bytes as u64).read_to_end(&mut text),
            };
            let read = read.map_err(|source| VectorError::Io { action: "read", path: self.path.clone(), source })?;
            if read == 0 {
                return Ok(None);
            }
            self.lines += 1;
            self.hash.update(&text);
            let form = self.form;
            if form == Form::Hex && text.last() == Some(&b'\n') {
                text.pop();
            } else if form == Form::Hex && read as u64 == MAX_LINE {
                return Err(self.problem(self.lines, format!("longer than {MAX_LINE} characters")));
            }
            if form == Form::Hex && text.starts_with(b"//") {
                continue;
            }
            let index = self.words;
            self.words += 1;
            if index == self.count {
                return Err(self.wrong_count());
            }
            return Ok(Some(Line { index, number: self.lines, text, form }));
        }
    }

    /// Whether the file is the one the manifest was written for, byte for byte; asked at its end.
    ///
    /// Errors: fewer words than the manifest says.
    pub(super) fn hash_matches(self) -> Result<bool, VectorError> {
        if self.words != self.count {
            return Err(self.wrong_count());
        }
        Ok(hex_digest(self.hash) == self.sha256)
    }

    /// What is wrong with a line.
    pub(super) fn problem(&self, line: u64, problem: String) -> VectorError {
        VectorError::Line { path: self.path.clone(), line, problem }
    }

    /// The file has not the words that the manifest says.
    pub(super) fn wrong_count(&self) -> VectorError {
        VectorError::Count { path: self.path.clone(), found: self.words, expected: self.count }
    }
}
