//! Who may use whom: the table of `ARCHITECTURE.md` against the sources, and no circle of imports inside a package.

use std::fs;

use roughxel_host_tests::imports::{SourceFile, circles, packages, source_files, workspace_root};

/// A row of the table.
#[derive(Debug)]
struct Row {
    places: Vec<String>,
    /// None where it may use everything.
    may_use: Option<Vec<String>>,
}

/// The names in backticks of a cell, from the root and without `.rs`: a name without a folder stands in that of the name before
/// it, the first one in `folder`.
fn names(cell: &str, folder: &str) -> Vec<String> {
    let (packages, mut folder) = (packages(), folder.to_owned());
    let mut found = Vec::new();
    for name in cell.split('`').skip(1).step_by(2) {
        let is_whole = name.contains('/') || packages.iter().any(|package| package == name);
        let whole = if is_whole { name.to_owned() } else { format!("{folder}/{name}") };
        folder = whole.rsplit_once('/').map_or_else(String::new, |(folder, _)| folder.to_owned());
        found.push(whole.trim_end_matches(".rs").to_owned());
    }
    found
}

/// The rows of a text's table.
fn table(text: &str) -> Vec<Row> {
    let lines = text.lines().skip_while(|line| !line.starts_with("| place |")).skip(2);
    lines
        .take_while(|line| line.starts_with('|'))
        .map(|line| {
            let cells: Vec<&str> = line.split('|').map(str::trim).collect();
            let [_, place, _, may_use, _] = cells[..] else { panic!("{line}: place, holds, may use") };
            let places = names(place, "");
            let folder = places[0].rsplit_once('/').map_or("", |(folder, _)| folder).to_owned();
            let may_use = (may_use != "everything").then(|| names(may_use, &folder));
            Row { places, may_use }
        })
        .collect()
}

fn architecture() -> Vec<Row> {
    let text = fs::read_to_string(workspace_root().join("ARCHITECTURE.md")).expect("the architecture is written down");
    table(&text)
}

/// Whether a file is a place or lies in it: `core/src/stage` is `stage.rs` and all below `stage/`.
fn lies_in(file: &str, place: &str) -> bool {
    let rest = file.trim_end_matches(".rs").strip_prefix(place);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

/// The row of a file: that whose place says most of its path.
fn row_of<'a>(rows: &'a [Row], file: &str) -> Option<&'a Row> {
    let fits = |row: &Row| row.places.iter().filter(|place| lies_in(file, place)).map(String::len).max();
    rows.iter().filter_map(|row| Some((fits(row)?, row))).max_by_key(|(length, _)| *length).map(|(_, row)| row)
}

/// What files use and may not: `FILE:LINE uses FILE`.
fn forbidden(rows: &[Row], files: &[SourceFile]) -> Vec<String> {
    let mut found = Vec::new();
    for file in files {
        let Some(Row { places, may_use: Some(may_use) }) = row_of(rows, &file.path) else { continue };
        for (used, line) in &file.uses {
            let own = row_of(rows, used).is_some_and(|row| row.places == *places);
            if !own && !may_use.iter().any(|place| lies_in(used, place)) {
                found.push(format!("{}:{line} uses {used}", file.path));
            }
        }
    }
    found
}

#[test]
fn every_source_file_has_a_place_and_every_place_is_there() {
    let (rows, files) = (architecture(), source_files());
    let homeless: Vec<&str> =
        files.iter().map(|file| file.path.as_str()).filter(|path| row_of(&rows, path).is_none()).collect();
    assert!(homeless.is_empty(), "in no row of the table: {homeless:?}");
    for row in &rows {
        for place in row.places.iter().chain(row.may_use.iter().flatten()) {
            assert!(files.iter().any(|file| lies_in(&file.path, place)), "`{place}` is not there");
        }
    }
    for package in packages() {
        assert!(files.iter().any(|file| file.package == package), "{package} has no sources");
    }
}

#[test]
fn files_use_what_their_place_may_use() {
    let found = forbidden(&architecture(), &source_files());
    assert!(found.is_empty(), "against the table of ARCHITECTURE.md:\n{}", found.join("\n"));
}

#[test]
fn imports_inside_a_package_run_in_no_circle() {
    let found = circles(&source_files());
    assert!(found.is_empty(), "files that need each other: {found:#?}");
}

/// The files and folders that a section names in backticks: paths with a folder, and files that stand in that of the name before.
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
    let text = fs::read_to_string(workspace_root().join("ARCHITECTURE.md")).expect("the architecture is written down");
    let section = text.split_once("## How to change things").expect("it says how to change things").1;
    let named = files_named(section);
    assert!(named.len() > 40, "only {} files found", named.len());
    let gone: Vec<&String> = named.iter().filter(|name| !workspace_root().join(name).exists()).collect();
    assert!(gone.is_empty(), "not there: {gone:?}");
}

/// A file as the reader of sources gives it.
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
        let file = files.iter().find(|file| file.path == path).expect("the file is there");
        file.uses.contains_key(used)
    };
    // By a name of its own file, one that the root passes on, one behind a facade, and a path in the middle of code.
    assert!(uses("emulator/frame/src/tile.rs", "emulator/frame/src/batch.rs"));
    assert!(uses("emulator/frame/src/texture.rs", "emulator/frame/src/colour.rs"));
    assert!(uses("emulator/cli/src/demo/draw.rs", "emulator/frame/src/prepare.rs"));
    assert!(uses("emulator/cli/src/lib.rs", "emulator/cli/src/demo.rs"));
    // A macro is where its text is.
    assert!(uses("core/src/datapath/texel.rs", "core/src/staged.rs"));
    assert!(!uses("core/src/datapath/texel.rs", "core/src/lib.rs"));
    // What a macro names, names that are passed on, and tests, do not count.
    assert!(!uses("core/src/bundle.rs", "core/src/ports.rs"));
    assert!(!uses("emulator/maps/src/peak_pyramid.rs", "emulator/maps/src/peak_pyramid/build.rs"));
    assert!(!uses("emulator/scene/src/picture/compare.rs", "emulator/utilities/src/random.rs"));
}

#[test]
fn what_the_table_forbids_and_what_runs_in_a_circle_is_found() {
    let rows = table(
        "| place | holds | may use |\n|---|---|---|\n| `core/src/a.rs` | – | – |\n\
         | `core/src/b`, `c` | – | `a` |\n| `host-tests` | – | everything |\n",
    );
    let files = [
        file("core/src/a.rs", &["core/src/c.rs"]),
        file("core/src/b/deep.rs", &["core/src/a.rs", "core/src/c.rs"]),
        file("core/src/c.rs", &["core/src/b/deep.rs", "core/src/d.rs"]),
        file("host-tests/src/lib.rs", &["core/src/a.rs"]),
    ];
    assert_eq!(forbidden(&rows, &files), ["core/src/a.rs:1 uses core/src/c.rs", "core/src/c.rs:1 uses core/src/d.rs"]);
    assert_eq!(circles(&files), [["core/src/a.rs", "core/src/b/deep.rs", "core/src/c.rs"]]);
    assert_eq!(circles(&files[1..2]), [[""; 0]; 0]);
}
