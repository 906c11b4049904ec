//! Files of an earlier design in a folder into which one of the same name is written.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use roughxel_netlist::verilog::sha256;
use serde_json::Value;

/// Most bytes of a file that is read; the manifest of a reflection of `precise` has 87 kB.
const MOST_BYTES: u64 = 1 << 24;

/// Content of a file; `None` for a link, for anything else that has a name, and for a file that is too large or cannot be read.
fn content(path: &Path) -> Option<Vec<u8>> {
    let data = fs::symlink_metadata(path).ok()?;
    if data.is_file() && data.len() <= MOST_BYTES { fs::read(path).ok() } else { None }
}

/// Files that a manifest lists, with their SHA-256; none if it is of something else than Verilog, `None` if it cannot be read.
fn listed(manifest: &Path) -> Option<Vec<(PathBuf, String)>> {
    let manifest: Value = serde_json::from_slice(&content(manifest)?).ok()?;
    if manifest["schema"] != "roughxel-verilog" {
        return Some(Vec::new());
    }
    let files = manifest["files"].as_array()?.iter();
    files.map(|file| Some((file["name"].as_str()?.into(), file["sha256"].as_str()?.to_owned()))).collect()
}

/// True for a name in a folder or in folders below it, on no way through a link.
fn is_inside(directory: &Path, name: &Path) -> bool {
    let folders = name.ancestors().skip(1).filter(|folder| !folder.as_os_str().is_empty());
    let is_folder = |folder: &Path| fs::symlink_metadata(directory.join(folder)).is_ok_and(|data| data.is_dir());
    name.components().all(|part| matches!(part, Component::Normal(_))) && folders.into_iter().all(is_folder)
}

/// Files of the design whose manifest, with a given name, is in a folder: those that no other manifest there lists and nobody has changed. There are
/// none if another manifest cannot be read, for it may list them. The paths are relative.
pub(super) fn files(directory: &Path, manifest: &str) -> BTreeSet<PathBuf> {
    let Some(own) = listed(&directory.join(manifest)) else { return BTreeSet::new() };
    let entries = fs::read_dir(directory).into_iter().flatten().flatten().map(|entry| entry.path());
    let is_other = |path: &PathBuf| {
        path.file_name().is_some_and(|name| name != manifest) && path.extension().is_some_and(|end| end == "json")
    };
    let others: Option<Vec<_>> = entries.filter(is_other).map(|path| listed(&path)).collect();
    let Some(others) = others else { return BTreeSet::new() };
    let others: BTreeSet<PathBuf> = others.into_iter().flatten().map(|(name, _)| name).collect();
    let own = own.into_iter().filter(|(name, hash)| {
        !others.contains(name)
            && is_inside(directory, name)
            && content(&directory.join(name)).is_some_and(|bytes| sha256(&bytes) == *hash)
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
