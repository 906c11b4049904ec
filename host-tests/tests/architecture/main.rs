//! Import rules: `places.toml` against the sources, every Cargo.toml and the map of `ARCHITECTURE.md`. There is no circle of imports inside a
//! package.

mod places;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

use roughxel_host_tests::imports::{SourceFile, circles, packages, source_files, workspace_root};
use roughxel_host_tests::tokens::tokens;

use places::{Places, lies_in, place_of};

fn the_places() -> Places {
    Places::read(include_str!("places.toml"))
}

fn text_of(file: impl AsRef<Path>) -> String {
    let path = workspace_root().join(file);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The files below a folder with this ending, from the root of the workspace, without build products.
fn files_below(folder: &str, ending: &str) -> Vec<String> {
    let (mut found, mut waiting) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(folder) = waiting.pop() {
        for entry in fs::read_dir(workspace_root().join(&folder)).expect("the folder exists") {
            let entry = entry.expect("a folder can be read");
            let path = format!("{folder}/{}", entry.file_name().to_string_lossy());
            if entry.path().is_dir() {
                if entry.file_name() != "target" {
                    waiting.push(path);
                }
            } else if path.ends_with(ending) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// The Rust files of a package: sources, tests, examples, build script.
fn rust_files(places: &Places, folder: &str) -> Vec<String> {
    let is_its = |file: &String| places.package_of(file).is_some_and(|package| package.folder == folder);
    files_below(folder, ".rs").into_iter().filter(is_its).collect()
}

/// The dependency tables of a Cargo.toml, including those of a target.
fn dependencies(manifest: &toml::Table) -> BTreeSet<String> {
    let kinds = ["dependencies", "dev-dependencies", "build-dependencies"];
    let of_targets = manifest.get("target").and_then(toml::Value::as_table).into_iter().flat_map(toml::Table::values);
    let all = of_targets.filter_map(toml::Value::as_table).chain([manifest]);
    let tables = all.flat_map(|table| kinds.map(|kind| table.get(kind).and_then(toml::Value::as_table)));
    tables.flatten().flat_map(toml::Table::keys).cloned().collect()
}

/// The Cargo.toml of every package by its folder, and the folder of every package by its name.
fn manifests(places: &Places) -> (BTreeMap<&str, toml::Table>, BTreeMap<String, &str>) {
    let read = |folder: &str| text_of(format!("{folder}/Cargo.toml")).parse::<toml::Table>().expect("the file is TOML");
    let manifests: BTreeMap<&str, toml::Table> =
        places.packages.iter().map(|package| (package.folder.as_str(), read(&package.folder))).collect();
    let name = |manifest: &toml::Table| manifest["package"]["name"].as_str().expect("a package has a name").to_owned();
    let folders = manifests.iter().map(|(folder, manifest)| (name(manifest), *folder)).collect();
    (manifests, folders)
}

#[test]
fn every_source_file_has_a_place_and_every_place_is_there() {
    let (places, files) = (the_places(), source_files());
    let of_files = places.places();
    let homeless: Vec<&str> =
        files.iter().map(|file| file.path.as_str()).filter(|path| place_of(&of_files, path).is_none()).collect();
    assert!(homeless.is_empty(), "in no place: {homeless:?}");
    for place in &of_files {
        for name in place.files.iter().chain(&place.uses) {
            assert!(files.iter().any(|file| lies_in(&file.path, name)), "`{name}` is not there");
        }
    }
    for package in packages() {
        assert!(files.iter().any(|file| file.package == package), "{package} has no sources");
    }
}

#[test]
fn every_package_is_listed() {
    let places = the_places();
    let listed = |own_workspace: bool| -> BTreeSet<&str> {
        let packages = places.packages.iter().filter(|package| package.own_workspace == own_workspace);
        packages.map(|package| package.folder.as_str()).collect()
    };
    let members = packages();
    assert_eq!(listed(false), members.iter().map(String::as_str).collect());
    let manifests = ["core", "emulator", "host-tests"].map(|folder| files_below(folder, "/Cargo.toml")).concat();
    let all: BTreeSet<&str> = manifests.iter().filter_map(|file| file.strip_suffix("/Cargo.toml")).collect();
    assert_eq!(listed(false).union(&listed(true)).copied().collect::<BTreeSet<_>>(), all);
}

/// Unit tests of a library whose manifest has `test = false` would never run.
#[test]
fn a_library_that_is_not_tested_has_no_unit_tests() {
    let places = the_places();
    let (manifests, _) = manifests(&places);
    for (folder, manifest) in manifests {
        let is_tested = manifest.get("lib").and_then(|lib| lib.get("test")).and_then(toml::Value::as_bool);
        let files = if is_tested == Some(false) { files_below(&format!("{folder}/src"), ".rs") } else { Vec::new() };
        for file in files {
            assert!(
                !text_of(&file).lines().any(|line| line.trim() == "#[cfg(test)]"),
                "{file}: nothing runs its tests"
            );
        }
    }
}

#[test]
fn files_use_what_their_place_may_use() {
    let found = the_places().forbidden(&source_files());
    assert!(found.is_empty(), "against places.toml:\n{}", found.join("\n"));
}

#[test]
fn no_arrow_runs_up() {
    let places = the_places();
    let found = places.upwards();
    assert!(found.is_empty(), "{found:#?}");
    let floors = places.packages.iter().map(|package| {
        let top = package.folder.split('/').next();
        ["core", "emulator", "host-tests"].iter().position(|floor| top == Some(floor)).expect("the package has a layer")
    });
    assert!(floors.is_sorted(), "core, emulator, host-tests: in this order");
}

#[test]
fn every_manifest_names_the_packages_that_it_may_use_and_sources_name_all_of_them() {
    let places = the_places();
    let (manifests, folders) = manifests(&places);
    for package in &places.packages {
        let used: BTreeMap<String, &str> = dependencies(&manifests[package.folder.as_str()])
            .into_iter()
            .filter_map(|name| folders.get(&name).map(|folder| (name, *folder)))
            .collect();
        let by_manifest: BTreeSet<&str> = used.values().copied().collect();
        let by_places: BTreeSet<&str> = package.uses.iter().map(String::as_str).collect();
        assert_eq!(by_manifest, by_places, "{}: Cargo.toml and places.toml", package.folder);
        let sources = rust_files(&places, &package.folder).into_iter().flat_map(|file| tokens(&text_of(file)));
        let named: BTreeSet<String> = sources.map(|token| token.text).collect();
        for name in used.keys() {
            assert!(named.contains(&name.replace('-', "_")), "{}: nothing uses {name}", package.folder);
        }
    }
}

/// The files that a source includes: texts, and modules by their paths.
fn included(file: &str, text: &str) -> Vec<String> {
    let of = |(mark, before): (&str, &str)| -> Vec<String> {
        let literal = |rest: &str| {
            let quoted = rest.strip_prefix(before)?.trim_start().strip_prefix('"')?;
            Some(quoted.split_once('"')?.0.to_owned())
        };
        text.split(mark).skip(1).filter_map(literal).collect()
    };
    let folder = Path::new(file).parent().expect("a file is in a folder");
    let normal = |name: String| {
        let mut path = PathBuf::new();
        for part in folder.join(name).components() {
            match part {
                Component::ParentDir => assert!(path.pop(), "{file} includes what is outside"),
                part => path.push(part),
            }
        }
        path.to_string_lossy().replace('\\', "/")
    };
    [("include_str!", "("), ("include_bytes!", "("), ("#[path", " =")]
        .map(of)
        .concat()
        .into_iter()
        .map(normal)
        .collect()
}

#[test]
fn what_is_included_lies_in_no_package_above() {
    let places = the_places();
    let mut count = 0;
    for (rank, package) in places.packages.iter().enumerate() {
        for file in rust_files(&places, &package.folder) {
            for other in included(&file, &text_of(&file)) {
                assert!(workspace_root().join(&other).is_file(), "{file}: {other} is not there");
                let above = places.package_of(&other).filter(|of| places.rank(&of.folder) > Some(rank));
                assert!(above.is_none(), "{file} includes {other}");
                count += 1;
            }
        }
    }
    assert!(count > 40, "only {count} files found");
}

#[test]
fn the_map_of_the_architecture_is_that_of_the_places() {
    let line = |package: &places::Package| format!("| [`{0}`]({0}) | {1} |\n", package.folder, package.holds);
    let map: String = the_places().packages.iter().map(line).collect();
    let map = format!("| package | holds |\n|---|---|\n{map}");
    assert!(text_of("ARCHITECTURE.md").contains(&map), "the map in ARCHITECTURE.md is not this one:\n{map}");
}

#[test]
fn imports_inside_a_package_run_in_no_circle() {
    let found = circles(&source_files());
    assert!(found.is_empty(), "files that need each other: {found:#?}");
}

/// The files and folders that a section names in backticks: paths with a folder, and files in the folder of the preceding name.
fn files_named(section: &str) -> Vec<String> {
    let mut folder = String::new();
    let mut found = Vec::new();
    for name in section.split('`').skip(1).step_by(2) {
        if name.contains(' ') {
            continue;
        }
        let ends_as_file = [".rs", ".md", ".toml"].iter().any(|end| name.ends_with(end));
        let is_path = name.contains('/');
        if !ends_as_file && !is_path {
            continue;
        }
        let in_root = workspace_root().join(name).exists();
        let whole = if is_path || in_root || folder.is_empty() { name.to_owned() } else { format!("{folder}/{name}") };
        let last = whole.trim_end_matches('/');
        folder = if whole.ends_with('/') || !ends_as_file {
            last
        } else {
            last.rsplit_once('/').map_or("", |(folder, _)| folder)
        }
        .to_owned();
        found.push(whole);
    }
    found
}

#[test]
fn what_to_change_names_files_that_are_there() {
    let text = text_of("CONTRIBUTING.md");
    let (_, section) = text.split_once("## How to change things").expect("the document has the section");
    let named = files_named(section);
    assert!(named.len() > 40, "only {} files found", named.len());
    let gone: Vec<&String> = named.iter().filter(|name| !workspace_root().join(name).exists()).collect();
    assert!(gone.is_empty(), "not there: {gone:?}");
}

/// A file as the source reader returns it.
fn file(path: &str, uses: &[&str]) -> SourceFile {
    SourceFile {
        path: path.to_owned(),
        package: "core".to_owned(),
        uses: uses.iter().map(|used| ((*used).to_owned(), 1)).collect(),
        needs: uses.iter().map(|used| (*used).to_owned()).collect(),
    }
}

#[test]
fn the_reader_finds_what_files_use() {
    let files = source_files();
    let uses = |path: &str, used: &str| {
        let file = files.iter().find(|file| file.path == path).expect("the file exists");
        file.uses.contains_key(used)
    };
    // By a name of its own file, a name that the root re-exports, a name after a facade, and a path in the middle of code.
    assert!(uses("emulator/frame/src/tile.rs", "emulator/frame/src/prepare.rs"));
    assert!(uses("emulator/frame/src/texture.rs", "emulator/frame/src/colour.rs"));
    assert!(uses("emulator/cli/src/demo/draw.rs", "emulator/frame/src/prepare.rs"));
    assert!(uses("emulator/cli/src/lib.rs", "emulator/cli/src/demo.rs"));
    // A macro belongs to the file with its text.
    assert!(uses("core/src/datapath/texel.rs", "core/src/staged.rs"));
    assert!(!uses("core/src/datapath/texel.rs", "core/src/lib.rs"));
    // Names after `$crate` in a macro, re-exported names, and tests do not count.
    assert!(!uses("core/src/bundle.rs", "core/src/ports.rs"));
    assert!(!uses("emulator/peaks/src/lib.rs", "emulator/peaks/src/build.rs"));
    assert!(!uses("emulator/assets/src/picture/compare.rs", "emulator/utilities/src/random.rs"));
}

#[test]
fn what_is_forbidden_what_runs_up_and_what_runs_in_a_circle_is_found() {
    let places = Places::read(
        r#"
        [[package]]
        folder = "core"
        holds = ""
        uses = []
        [[package.place]]
        files = ["a"]
        holds = ""
        uses = []
        [[package.place]]
        files = ["b", "c"]
        holds = ""
        uses = ["a"]
        [[package]]
        folder = "core/d"
        holds = ""
        uses = ["core", "host-tests"]
        [[package]]
        folder = "host-tests"
        holds = ""
        uses = ["core"]
        [[package.place]]
        files = ["lib"]
        holds = ""
        uses = ["core", "core/d"]
        "#,
    );
    let files = [
        file("core/src/a.rs", &["core/src/c.rs"]),
        file("core/src/b/deep.rs", &["core/src/a.rs", "core/src/c.rs"]),
        file("core/src/c.rs", &["core/src/b/deep.rs", "core/d/src/lib.rs"]),
        file("core/d/src/lib.rs", &[]),
        file("host-tests/src/lib.rs", &["core/src/a.rs", "core/d/src/lib.rs"]),
    ];
    assert_eq!(
        places.forbidden(&files),
        ["core/src/a.rs:1 uses core/src/c.rs", "core/src/c.rs:1 uses core/d/src/lib.rs"]
    );
    assert_eq!(places.upwards(), ["core/d uses host-tests", "host-tests/src/lib uses core/d"]);
    assert_eq!(circles(&files), [["core/src/a.rs", "core/src/b/deep.rs", "core/src/c.rs"]]);
    assert_eq!(circles(&files[1..2]), [[""; 0]; 0]);
    let source = "include_str!(\"../../vectors/x.txt\") include_bytes!(concat!(\"y\")) #[path = \"z.rs\"] mod z;";
    assert_eq!(included("core/src/a.rs", source), ["vectors/x.txt", "core/src/z.rs"]);
    let manifest = "[dependencies]\na.workspace = true\n[target.'cfg(unix)'.dev-dependencies]\nb = \"1\"";
    assert_eq!(dependencies(&manifest.parse().expect("the file is TOML")), ["a", "b"].map(String::from).into());
}
