//! The words of a set's file, lines of text or records of bytes, with their numbers, and the test that the file is the one of its
//! manifest.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use roughxel_utilities::input::open_file;
use sha2::{Digest, Sha256};

use super::files::hex_digest;
use super::layout::Layout;
use super::manifest::{Form, Manifest};
use super::word::{read_device_word, read_record, read_word};
use super::{MAX_VECTORS, VectorError};

/// Longest line: beyond the length of every word and comment.
const MAX_LINE: u64 = 4096;

/// The words of a set in order; comments are skipped.
pub(super) struct Lines {
    path: PathBuf,
    file: BufReader<File>,
    form: Form,
    record_bytes: usize,
    hash: Sha256,
    /// SHA-256 in the manifest.
    sha256: String,
    /// Words in the manifest, and the most that are read.
    count: u64,
    most: u64,
    /// Index of the first vector.
    first: u64,
    /// Lines or records, bytes and words so far.
    lines: u64,
    bytes: u64,
    words: u64,
}

/// A line or a record that should be a word.
pub(super) struct Line {
    /// Index of the vector in the whole set, from 0.
    pub(super) index: u64,
    /// Line or record of the file, from 1.
    pub(super) number: u64,
    /// Its bytes, without an end of line.
    text: Vec<u8>,
    /// Offset of these bytes in the file.
    offset: u64,
    /// True if the file ends with it, without an end of line or of a record.
    is_last: bool,
    form: Form,
}

impl Line {
    /// The bits of a device's word as in [`Self::bits`]; its digits may be of either case and without underscores.
    pub(super) fn device_bits(&self, layout: &Layout) -> Result<Vec<u32>, String> {
        let bits = match self.form {
            Form::Hex => read_device_word(&self.text, layout),
            Form::Bin => read_record(&self.text, layout),
        };
        bits.map_err(|problem| self.cause(problem))
    }

    /// The fields' bits, including padding and check value, or the fault of the line.
    pub(super) fn bits(&self, layout: &Layout) -> Result<Vec<u32>, String> {
        let bits = match self.form {
            Form::Hex => read_word(&self.text, layout),
            Form::Bin => read_record(&self.text, layout),
        };
        bits.map_err(|problem| self.cause(problem))
    }

    /// Its bytes as in a set, with the end of line if there is one.
    pub(super) fn written(mut self) -> Vec<u8> {
        if self.form == Form::Hex {
            self.text.push(b'\n');
        }
        self.text
    }

    /// The cause of a line that is no word, if it is known.
    fn cause(&self, problem: String) -> String {
        let end = self.offset + self.text.len() as u64;
        if let Some(binary) = (self.form == Form::Hex).then(|| binary_in(&self.text, self.offset)).flatten() {
            binary
        } else if self.form == Form::Hex && self.text.last() == Some(&b'\r') {
            "ends in CR LF, but the lines of a set end in LF: a transfer as text changed the file. Copy it as binary, or take \
             away every CR (tr -d '\\r')"
                .into()
        } else if self.is_last {
            format!(
                "{problem}; the file ends at byte {end}, in the middle of a word: it is cut short. Export the set again"
            )
        } else {
            problem
        }
    }
}

/// Returns true if the words of a set are those of its manifest.
///
/// Errors: unreadable, a line that is no word, more or fewer words than in the manifest.
pub(super) fn is_whole(manifest_path: &Path, manifest: &Manifest, layout: &Layout) -> Result<bool, VectorError> {
    let mut lines = Lines::open(manifest_path, manifest)?;
    while let Some(line) = lines.next()? {
        lines.bits(&line, layout)?;
    }
    lines.hash_matches()
}

/// The first byte that is in no text of words.
fn binary_in(text: &[u8], offset: u64) -> Option<String> {
    let text = text.strip_suffix(b"\r").unwrap_or(text);
    let place = text.iter().position(|byte| !(b' '..=b'~').contains(byte) && *byte != b'\t')?;
    let at = offset + place as u64;
    Some(format!(
        "byte {at} of the file is {:02x}, which no text of words has: the file is binary or damaged (words as bytes \
         are a file NAME.bin). Export the set again",
        text[place]
    ))
}

/// Returns true if a record looks like text: many bytes of the numbers in a word are not letters.
fn is_text(record: &[u8]) -> bool {
    record.iter().all(|byte| byte.is_ascii_graphic() || byte.is_ascii_whitespace())
}

impl Lines {
    /// Opens the words of a manifest, which are in the same directory.
    pub(super) fn open(manifest_path: &Path, manifest: &Manifest) -> Result<Self, VectorError> {
        Self::at(manifest_path.with_file_name(&manifest.files[0].name), manifest.form(), manifest)
    }

    /// Opens words of a device with the fields of a manifest: records of bytes in a file NAME.bin, else text.
    pub(super) fn open_device(path: &Path, manifest: &Manifest) -> Result<Self, VectorError> {
        let is_bin = path.extension().is_some_and(|extension| extension == Form::Bin.extension());
        Self::at(path.into(), if is_bin { Form::Bin } else { Form::Hex }, manifest)
    }

    fn at(path: PathBuf, form: Form, manifest: &Manifest) -> Result<Self, VectorError> {
        let file = open_file(&path).map_err(|source| VectorError::Io { action: "read", path: path.clone(), source })?;
        Ok(Self {
            file: BufReader::with_capacity(1 << 16, file),
            form,
            record_bytes: manifest.word_bits.div_ceil(8) as usize,
            path,
            hash: Sha256::new(),
            sha256: manifest.files[0].sha256.clone(),
            count: manifest.count,
            most: manifest.count,
            first: manifest.indices().start,
            lines: 0,
            bytes: 0,
            words: 0,
        })
    }

    /// Opens the words of a manifest, and reads extra words, up to twice the most of a set.
    pub(super) fn open_longer(manifest_path: &Path, manifest: &Manifest) -> Result<Self, VectorError> {
        Ok(Self { most: 2 * MAX_VECTORS, ..Self::open(manifest_path, manifest)? })
    }

    /// The next word; `None` at the end of the file.
    ///
    /// Errors: unreadable, a line that is too long, more words than in the manifest.
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
            let (form, offset) = (self.form, self.bytes);
            self.lines += 1;
            self.bytes += read as u64;
            self.hash.update(&text);
            let mut is_last = false;
            if form == Form::Hex && text.last() == Some(&b'\n') {
                text.pop();
            } else if form == Form::Hex && read as u64 == MAX_LINE {
                let too_long = || format!("longer than {MAX_LINE} characters");
                return Err(self.problem(self.lines, binary_in(&text, offset).unwrap_or_else(too_long)));
            } else {
                is_last = form == Form::Hex || read < self.record_bytes;
            }
            if form == Form::Bin && offset == 0 && is_text(&text) {
                let problem = "the file is text, but this one has to be records of bytes (words as text are a file \
                               NAME.hex). Export the set again";
                return Err(self.problem(1, problem.into()));
            }
            if form == Form::Hex && text.starts_with(b"//") {
                continue;
            }
            let index = self.first + self.words;
            self.words += 1;
            if self.words > self.most {
                return Err(self.wrong_count());
            }
            return Ok(Some(Line { index, number: self.lines, text, offset, is_last, form }));
        }
    }

    /// Returns true if the file is the one of the manifest, byte for byte; called at its end.
    ///
    /// Errors: fewer words than in the manifest.
    pub(super) fn hash_matches(self) -> Result<bool, VectorError> {
        if self.words != self.count {
            return Err(self.wrong_count());
        }
        Ok(hex_digest(self.hash) == self.sha256)
    }

    /// Reads at most `most` further words; `None` at the end.
    pub(super) fn batch(&mut self, most: usize) -> Result<Option<Vec<Line>>, VectorError> {
        let mut batch = Vec::with_capacity(most);
        while batch.len() < most
            && let Some(line) = self.next()?
        {
            batch.push(line);
        }
        Ok(Some(batch).filter(|batch| !batch.is_empty()))
    }

    /// Reads the fields of a word.
    pub(super) fn bits(&self, line: &Line, layout: &Layout) -> Result<Vec<u32>, VectorError> {
        line.bits(layout).map_err(|problem| self.problem(line.number, problem))
    }

    /// The error for a line.
    pub(super) fn problem(&self, line: u64, problem: String) -> VectorError {
        VectorError::Line { path: self.path.clone(), line, problem }
    }

    /// The error for a file with a different number of words than in the manifest.
    pub(super) fn wrong_count(&self) -> VectorError {
        VectorError::Count { path: self.path.clone(), found: self.words, expected: self.count, cause: String::new() }
    }
}
