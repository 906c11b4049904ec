//! The two files of a set during writing, and hashes of files.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use roughxel_utilities::input::open_file;
use roughxel_utilities::output::OutputFile;
use sha2::{Digest, Sha256};

use super::VectorError;
use super::manifest::{FileEntry, Form, Manifest};

/// The words of a set during writing; dropped without [`SetFiles::commit`] they leave no trace.
pub(super) struct SetFiles {
    words: OutputFile,
    hash: Sha256,
    bytes: u64,
    words_path: PathBuf,
    json_path: PathBuf,
}

impl SetFiles {
    /// Opens the words of a future manifest, each of `length` bytes, in `directory`, which is made if it does not exist.
    pub(super) fn create(
        manifest: &Manifest,
        form: Form,
        length: usize,
        directory: &Path,
    ) -> Result<Self, VectorError> {
        fs::create_dir_all(directory).map_err(cannot_write(directory))?;
        let (words_path, json_path) =
            (directory.join(manifest.words_name(form)), directory.join(manifest.stem() + ".json"));
        let words = OutputFile::create(&words_path).map_err(cannot_write(&words_path))?;
        words.reserve(manifest.count * length as u64).map_err(cannot_write(&words_path))?;
        let mut files = Self { words, hash: Sha256::new(), bytes: 0, words_path, json_path };
        if form == Form::Hex {
            files.write(title(manifest).as_bytes())?;
        }
        Ok(files)
    }

    pub(super) fn write(&mut self, bytes: &[u8]) -> Result<(), VectorError> {
        self.hash.update(bytes);
        self.bytes += bytes.len() as u64;
        self.words.write_all(bytes).map_err(cannot_write(&self.words_path))
    }

    /// Puts words and manifest in their places; returns the manifest with the words' entry.
    ///
    /// A manifest is never next to words that are not its own: an older manifest is removed first, the new one is written last.
    pub(super) fn commit(self, manifest: Manifest) -> Result<Manifest, VectorError> {
        let Self { words, hash, bytes, words_path, json_path } = self;
        let name = words_path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let manifest = Manifest { files: vec![FileEntry { name, bytes, sha256: hex_digest(hash) }], ..manifest };
        let (json, text) = prepared(&json_path, &manifest)?;
        remove_other(&json_path, &text).map_err(cannot_write(&json_path))?;
        words.commit().map_err(cannot_write(&words_path))?;
        json.commit().map_err(cannot_write(&json_path))?;
        Ok(manifest)
    }
}

/// Replaces a manifest whole or not at all.
pub(super) fn write_manifest(path: &Path, manifest: &Manifest) -> Result<(), VectorError> {
    prepared(path, manifest)?.0.commit().map_err(cannot_write(path))
}

/// A manifest during writing, and its text.
fn prepared(path: &Path, manifest: &Manifest) -> Result<(OutputFile, Vec<u8>), VectorError> {
    let mut text = serde_json::to_vec_pretty(manifest).map_err(|e| cannot_write(path)(e.into()))?;
    text.push(b'\n');
    let write = || {
        let mut json = OutputFile::create(path)?;
        json.write_all(&text)?;
        Ok(json)
    };
    Ok((write().map_err(cannot_write(path))?, text))
}

/// Removes an existing manifest, unless it has that text.
fn remove_other(path: &Path, text: &[u8]) -> io::Result<()> {
    let remove = || {
        let is_same = fs::metadata(path)?.len() == text.len() as u64 && fs::read(path)? == text;
        // A link is resolved, as for the new manifest.
        if is_same { Ok(()) } else { fs::remove_file(fs::canonicalize(path)?) }
    };
    match fs::metadata(path) {
        Ok(metadata) if metadata.is_file() => match remove() {
            // A concurrent export was faster.
            Err(gone) if gone.kind() == io::ErrorKind::NotFound => Ok(()),
            done => done,
        },
        _ => Ok(()),
    }
}

fn cannot_write(path: &Path) -> impl Fn(io::Error) -> VectorError {
    move |source| VectorError::Io { action: "write", path: path.into(), source }
}

/// The first line of a hex file.
fn title(manifest: &Manifest) -> String {
    let Manifest { set, profile, count, word_bits, part, .. } = manifest;
    let part = part.map_or_else(String::new, |part| format!("part {} of {}, ", part.number, part.of));
    format!(
        "// roughxel vectors: set {set}, profile {}, {part}{count} words of {word_bits} bits, fields in {}.json\n",
        profile.name,
        manifest.stem()
    )
}

/// Size and SHA-256 of a file.
pub(super) fn size_and_hash(path: &Path) -> io::Result<(u64, String)> {
    let mut hash = Sha256::new();
    let bytes = io::copy(&mut open_file(path)?, &mut Hasher(&mut hash))?;
    Ok((bytes, hex_digest(hash)))
}

/// A hash as a writer.
struct Hasher<'a>(&'a mut Sha256);

impl Write for Hasher<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A hash in lower-case hex.
pub(super) fn hex_digest(hash: Sha256) -> String {
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
