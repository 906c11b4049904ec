//! The lines of a set's hex file: words with their numbers, and whether the file is the one its manifest was written for.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::VectorError;
use super::export::hex_digest;
use super::manifest::Manifest;
use crate::input::open_file;

/// Longest line: beyond every word and comment.
const MAX_LINE: u64 = 4096;

/// The words of a set, one after the other; comments are passed over.
pub(super) struct Lines {
    path: PathBuf,
    file: BufReader<File>,
    hash: Sha256,
    /// SHA-256 and number of words by the manifest.
    sha256: String,
    count: u64,
    /// Lines and words so far.
    lines: u64,
    words: u64,
}

/// A line that is a word, if it is right.
pub(super) struct Line {
    /// Index of the vector, from 0.
    pub(super) index: u64,
    /// Line of the file, from 1.
    pub(super) number: u64,
    /// Its text without the end of line.
    pub(super) text: Vec<u8>,
}

impl Lines {
    /// Opens the words of a manifest, which lie beside it.
    pub(super) fn open(manifest_path: &Path, manifest: &Manifest) -> Result<Self, VectorError> {
        let entry = &manifest.files[0];
        let path = manifest_path.with_file_name(&entry.name);
        let file = open_file(&path).map_err(|source| VectorError::Io { action: "read", path: path.clone(), source })?;
        Ok(Self {
            file: BufReader::with_capacity(1 << 16, file),
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
            let read = self.file.by_ref().take(MAX_LINE).read_until(b'\n', &mut text);
            let read = read.map_err(|source| VectorError::Io { action: "read", path: self.path.clone(), source })?;
            if read == 0 {
                return Ok(None);
            }
            self.lines += 1;
            self.hash.update(&text);
            if text.last() == Some(&b'\n') {
                text.pop();
            } else if read as u64 == MAX_LINE {
                return Err(self.problem(self.lines, format!("longer than {MAX_LINE} characters")));
            }
            if text.starts_with(b"//") {
                continue;
            }
            let index = self.words;
            self.words += 1;
            if index == self.count {
                return Err(self.wrong_count());
            }
            return Ok(Some(Line { index, number: self.lines, text }));
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

    fn wrong_count(&self) -> VectorError {
        VectorError::Count { path: self.path.clone(), found: self.words, expected: self.count }
    }
}
