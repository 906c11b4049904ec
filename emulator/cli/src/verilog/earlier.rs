//! Files of an earlier design in a folder into which one of the same name is written.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

use serde_json::Value;
use sha2::{Digest, Sha256};

/// Most bytes of a manifest; the largest design has 400 kB.
const MOST_BYTES: u64 = 1 << 24;

/// Files that a manifest lists, with their SHA-256; none if it is no manifest of Verilog.
fn listed(manifest: &Path) -> Vec<(PathBuf, String)> {
    let mut text = String::new();
    let read = File::open(manifest).and_then(|file| file.take(MOST_BYTES).read_to_string(&mut text));
    let manifest = read.ok().and_then(|_| serde_json::from_str::<Value>(&text).ok()).unwrap_or_default();
    if manifest["schema"] != "roughxel-verilog" {
        return Vec::new();
    }
    let files = manifest["files"].as_array().into_iter().flatten();
    let entries = files.map(|file| Some((file["name"].as_str()?.into(), file["sha256"].as_str()?.to_owned())));
    entries.flatten().collect()
}

/// True if a file has the content that a manifest gives it.
fn is_unchanged(path: &Path, sha256: &str) -> bool {
    let Ok(bytes) = fs::read(path) else { return false };
    let hex = Sha256::digest(bytes).iter().fold(String::new(), |mut hex, byte| {
        // Writing to a string cannot fail.
        let _ = write!(hex, "{byte:02x}");
        hex
    });
    hex == sha256
}

/// Files of the design whose manifest, with a given name, is in a folder: those that no other manifest there lists and nobody has changed. The paths
/// are relative.
pub(super) fn files(directory: &Path, manifest: &str) -> BTreeSet<PathBuf> {
    let own = listed(&directory.join(manifest));
    if own.is_empty() {
        return BTreeSet::new();
    }
    let entries = fs::read_dir(directory).into_iter().flatten().flatten().map(|entry| entry.file_name());
    let others =
        entries.filter(|name| name != manifest && Path::new(name).extension().is_some_and(|end| end == "json"));
    let others: BTreeSet<PathBuf> =
        others.flat_map(|name| listed(&directory.join(name))).map(|(name, _)| name).collect();
    let is_inside = |path: &Path| path.components().all(|part| matches!(part, Component::Normal(_)));
    let own = own.into_iter().filter(|(name, sha256)| {
        is_inside(name) && !others.contains(name) && is_unchanged(&directory.join(name), sha256)
    });
    own.map(|(name, _)| name).collect()
}

/// Removes files of an earlier design that the new one does not have. Returns their number.
///
/// Errors: a file cannot be removed; the message names it.
pub(super) fn remove<'a>(
    directory: &Path,
    earlier: BTreeSet<PathBuf>,
    new: impl Iterator<Item = &'a str>,
) -> io::Result<usize> {
    let new: BTreeSet<&Path> = new.map(Path::new).collect();
    let left: Vec<PathBuf> = earlier.into_iter().filter(|name| !new.contains(name.as_path())).collect();
    for name in &left {
        let path = directory.join(name);
        fs::remove_file(&path).map_err(|e| io::Error::new(e.kind(), format!("{}: {e}", path.display())))?;
    }
    Ok(left.len())
}
