//! Finished units of a study, kept line by line.

use std::collections::HashMap;
use std::fs::{self, File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};

use super::Settings;
use crate::StudyError;

/// Finished units of a study in a file of JSON lines. The first line names the study and the program.
#[derive(Debug)]
pub struct Parts {
    path: PathBuf,
    kept: Mutex<(File, HashMap<String, Value>)>,
}

/// The first line.
#[derive(Serialize, Deserialize, PartialEq)]
struct Origin {
    settings: Settings,
    /// SHA-256 of the program.
    program: String,
}

/// Every other line.
#[derive(Serialize, Deserialize)]
struct Part {
    unit: String,
    value: Value,
}

impl Parts {
    /// Name of the file in the study's directory: one for each kind of study, so that none drops units of a different kind.
    pub fn file_name(settings: &Settings) -> String {
        format!("study.{}.parts.jsonl", settings.name)
    }

    /// Opens the parts in a directory, or starts anew if they are of a different study or program.
    ///
    /// Errors: the directory cannot be written to.
    pub fn open(directory: &Path, settings: &Settings) -> Result<Self, StudyError> {
        let path = directory.join(Self::file_name(settings));
        let origin = Origin { settings: settings.clone(), program: own_digest() };
        let known = File::open(&path).ok().and_then(|file| read(file, &origin));
        let is_new = known.is_none();
        let file = |source| StudyError::File { action: "write", path: path.clone(), source };
        let mut options = OpenOptions::new();
        let opened = if is_new { options.write(true).create(true).truncate(true) } else { options.append(true) };
        let mut opened = opened.open(&path).map_err(file)?;
        if is_new {
            line(&mut opened, &origin).map_err(file)?;
        }
        Ok(Self { path, kept: Mutex::new((opened, known.unwrap_or_default())) })
    }

    /// Number of finished units.
    pub fn count(&self) -> usize {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner).1.len()
    }

    /// Returns true if a unit is finished.
    pub fn has(&self, unit: &str) -> bool {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner).1.contains_key(unit)
    }

    /// A finished unit.
    pub(super) fn get<T: for<'de> Deserialize<'de>>(&self, unit: &str) -> Option<T> {
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        T::deserialize(kept.1.get(unit)?).ok()
    }

    /// Keeps a unit at once.
    pub(super) fn keep<T: Serialize>(&self, unit: &str, value: &T) -> Result<(), StudyError> {
        let error = |source| StudyError::File { action: "write", path: self.path.clone(), source };
        let value = serde_json::to_value(value).map_err(|broken| error(broken.into()))?;
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let part = Part { unit: unit.into(), value };
        line(&mut kept.0, &part).map_err(error)?;
        kept.1.insert(part.unit, part.value);
        Ok(())
    }

    /// Removes the file: the study is written.
    pub fn remove(self) -> Result<(), StudyError> {
        fs::remove_file(&self.path).map_err(|source| StudyError::File { action: "remove", path: self.path, source })
    }
}

/// The units of a file of this origin; an incomplete last line is ignored.
fn read(file: File, origin: &Origin) -> Option<HashMap<String, Value>> {
    let mut lines = BufReader::new(file).lines();
    let first: Origin = serde_json::from_str(&lines.next()?.ok()?).ok()?;
    if first != *origin {
        return None;
    }
    let parts = lines.map_while(Result::ok).filter_map(|line| serde_json::from_str::<Part>(&line).ok());
    Some(parts.map(|part| (part.unit, part.value)).collect())
}

/// Writes one line, as a whole as far as the system allows: in one call. It starts on a new line even if the last one is
/// incomplete.
fn line(file: &mut File, value: &impl Serialize) -> std::io::Result<()> {
    let is_first = file.metadata()?.len() == 0;
    let text = format!("{}{}\n", if is_first { "" } else { "\n" }, serde_json::to_string(value)?);
    file.write_all(text.as_bytes())?;
    file.flush()
}

/// SHA-256 of the running program: a different build measures anew.
fn own_digest() -> String {
    let program = std::env::current_exe().and_then(fs::read).unwrap_or_default();
    Sha256::digest(program).iter().map(|byte| format!("{byte:02x}")).collect()
}
