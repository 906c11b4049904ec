//! The committed sets and tables are what the program writes.

use std::fs;
use std::path::{Path, PathBuf};

use roughxel_vectors::{Manifest, manifests_in};
use serde_json::Value;

use super::fixture::{Folder, repository, roughxel};

#[test]
fn the_committed_smoke_sets_verify() {
    let [smoke, stages] = ["vectors/smoke", "vectors/smoke/stages"].map(|folder| repository().join(folder));
    roughxel(&["vectors", "verify", smoke.to_str().unwrap(), stages.to_str().unwrap()]).ends(0);
}

#[test]
fn the_smoke_command_writes_the_committed_sets() {
    // Coverage is written afterwards.
    let without_coverage = |name: &str, bytes: Vec<u8>| {
        if !name.ends_with(".json") {
            return bytes;
        }
        let mut manifest: Value = serde_json::from_slice(&bytes).unwrap();
        manifest.as_object_mut().unwrap().remove("grade");
        manifest.to_string().into_bytes()
    };
    writes_what_is_committed("vectors export --smoke", "vectors/smoke", without_coverage);
}

#[test]
fn the_committed_sets_say_how_good_they_are() {
    let committed = repository().join("vectors/smoke");
    let directory = Folder::new();
    let folders = [committed.clone(), committed.join("stages")];
    let manifests: Vec<PathBuf> = folders.iter().flat_map(|folder| manifests_in(folder).unwrap()).collect();
    let name = |path: &PathBuf| path.file_stem().unwrap().to_str().unwrap().to_owned();
    // Random sets and hard cases of each datapath.
    let sample = [
        "random_narrow",
        "chosen_highlight_narrow",
        "random_peak_compact",
        "cube_edges_standard",
        "entries_cube_face_standard",
    ];
    let is_all = std::env::var_os("ROUGHXEL_FULL").is_some();
    let wanted = |path: &&PathBuf| is_all || sample.contains(&name(path).as_str());
    let manifests: Vec<&PathBuf> = manifests.iter().filter(wanted).collect();
    assert!(manifests.len() >= sample.len());
    for path in &manifests {
        for extension in ["hex", "json"] {
            let file = format!("{}.{extension}", name(path));
            fs::copy(path.with_extension(extension), directory.join(&file)).unwrap();
        }
    }
    directory.done("vectors coverage . --write");
    for path in manifests {
        let name = name(path);
        let [theirs, ours] = [path, &directory.join(&format!("{name}.json"))].map(|path| fs::read(path).unwrap());
        assert!(theirs == ours, "{name}: run `roughxel vectors coverage vectors/smoke vectors/smoke/stages --write`");
        assert!(Manifest::read(path).unwrap().grade.is_some());
    }
    directory.done("vectors verify .");
}

#[test]
fn the_rom_command_writes_the_committed_tables() {
    writes_what_is_committed("vectors rom", "vectors/rom", |_, bytes| bytes);
}

/// Runs a command with `-o`. It must write exactly the files of a folder of the repository, subfolders included.
///
/// `compared` selects what is compared of each file.
fn writes_what_is_committed(command: &str, folder: &str, compared: impl Fn(&str, Vec<u8>) -> Vec<u8>) {
    let directory = Folder::new();
    directory.done(&format!("{command} -o ."));
    let files = |path: &Path| -> Vec<PathBuf> {
        let inside = |folder: &Path| -> Vec<PathBuf> {
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect()
        };
        let (folders, mut files): (Vec<_>, Vec<_>) = inside(path).into_iter().partition(|path| path.is_dir());
        files.extend(folders.iter().flat_map(|folder| inside(folder)));
        let mut names: Vec<_> = files.iter().map(|file| file.strip_prefix(path).unwrap().to_owned()).collect();
        names.sort();
        names
    };
    let committed = repository().join(folder);
    assert_eq!(files(directory.path()), files(&committed));
    for name in files(&committed) {
        // `assert_eq` would print the files.
        let [theirs, ours] = [&committed, directory.path()]
            .map(|at| compared(name.to_str().unwrap(), fs::read(at.join(&name)).unwrap()));
        let same = theirs == ours;
        assert!(same, "{name:?}: run `roughxel {command} -o {folder}`");
    }
}
