//! Golden vectors on another family of processors: the program writes the committed sets there, byte for byte.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::Path;

use crate::Failure;
use crate::target::{Target, root};

/// Words of the sets in a folder and of the sets of stages in it, by file name.
fn words(folder: &Path) -> Result<BTreeMap<String, Vec<u8>>, Failure> {
    let mut words = BTreeMap::new();
    for folder in [folder, &folder.join("stages")] {
        let trouble = |error: std::io::Error| Failure::trouble(format!("{}: {error}", folder.display()));
        for entry in std::fs::read_dir(folder).map_err(trouble)? {
            let path = entry.map_err(trouble)?.path();
            if path.extension() == Some(OsStr::new("hex")) {
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                words.insert(name, std::fs::read(&path).map_err(trouble)?);
            }
        }
    }
    Ok(words)
}

/// Exports the sets of `vectors/smoke` and compares them with the committed ones.
pub fn run(target: Target) -> Result<(), Failure> {
    let Some(program) = target.build_hosted(&["--bin", "roughxel"], "roughxel")? else {
        println!("{:12} vectors SKIPPED: rustup has no standard library for {}", "", target.name());
        return Ok(());
    };
    // A new folder, so that no earlier file can be taken for a result.
    let folder = root().join("target/firmware-vectors");
    if folder.exists() {
        std::fs::remove_dir_all(&folder).map_err(Failure::trouble)?;
    }
    let arguments =
        ["vectors", "export", "--smoke", "--output"].map(OsStr::new).into_iter().chain([folder.as_os_str()]);
    let (code, text) = target.run_with(&program, &arguments.collect::<Vec<_>>())?;
    if code != 0 {
        return Err(Failure::trouble(format!("vectors on {}: exit code {code}\n{text}", target.name())));
    }
    let [committed, written] = [root().join("vectors/smoke"), folder].map(|folder| words(&folder));
    let (committed, written) = (committed?, written?);
    let names = committed.keys().chain(written.keys().filter(|name| !committed.contains_key(*name)));
    let differing: Vec<&str> =
        names.filter(|name| committed.get(*name) != written.get(*name)).map(String::as_str).collect();
    println!("{:12} {} sets, {} differ", "", committed.len(), differing.len());
    if differing.is_empty() {
        return Ok(());
    }
    Err(Failure::broken(format!(
        "vectors on {} are not those of vectors/smoke: {}",
        target.name(),
        differing.join(", ")
    )))
}
