//! Rules for documents: short sentences, sizes, links with existing targets, a card for each package. Doc comments begin with a noun or a verb.
//!
//! `cargo test --release -p roughxel-host-tests --test documents -- --nocapture` prints every measure.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Component, Path, PathBuf};

use roughxel_host_tests::imports::workspace_root;
use roughxel_host_tests::performance;

/// Documents that a command writes: their words are those of the program.
const GENERATED: [&str; 5] = [
    "docs/cli.md",
    "docs/programs.md",
    "emulator/firmware/PRICE.md",
    "emulator/study/results/tables.md",
    "vectors/hdl/FLOORPLAN.md",
];

/// Largest size of a document in bytes.
const SIZES: [(&str, usize); 3] =
    [("README.md", 6 << 10), ("ARCHITECTURE.md", 10 << 10), ("vectors/README.md", 5 << 10)];

/// Largest size of a decision in bytes: a page.
const DECISION: usize = 4 << 10;

/// Largest median and 90th percentile of the words in a document's sentences.
const WORDS: (usize, usize) = (16, 30);

/// Folders of the project: other folders in the root are written by programs.
const FOLDERS: [&str; 6] = ["core", "docs", "emulator", "findings", "host-tests", "vectors"];

/// Files of the project with this ending, as paths from the root, without hidden folders and build products.
fn files(ending: &str) -> Vec<String> {
    let (root, mut found, mut waiting) = (workspace_root(), Vec::new(), vec![PathBuf::new()]);
    while let Some(folder) = waiting.pop() {
        for entry in fs::read_dir(root.join(&folder)).expect("the folder exists") {
            let entry = entry.expect("a folder can be read");
            let (name, path) = (entry.file_name().to_string_lossy().into_owned(), folder.join(entry.file_name()));
            let is_foreign = folder.as_os_str().is_empty() && entry.path().is_dir() && !FOLDERS.contains(&&*name);
            if name.starts_with('.') || name == "target" || is_foreign {
                continue;
            } else if entry.path().is_dir() {
                waiting.push(path);
            } else if name.ends_with(ending) {
                found.push(path.to_string_lossy().replace('\\', "/"));
            }
        }
    }
    found.sort();
    found
}

fn text_of(path: &str) -> String {
    fs::read_to_string(workspace_root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The lines of a document outside of code blocks, with their numbers.
fn lines_outside_code(text: &str) -> Vec<(usize, &str)> {
    let mut is_code = false;
    let outside = |&(_, line): &(usize, &str)| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    };
    (1..).zip(text.lines()).filter(outside).collect()
}

/// A line without its code and the addresses of its links: inline code is one word.
fn plain(line: &str) -> String {
    let without_code: Vec<&str> =
        line.split('`').enumerate().map(|(place, part)| if place % 2 == 1 { "code" } else { part }).collect();
    let mut parts = without_code.concat();
    while let Some(start) = parts.find("](") {
        let end = parts[start..].find(')').map_or(parts.len(), |end| start + end + 1);
        parts.replace_range(start..end, "]");
    }
    parts.replace(['[', ']', '*'], "")
}

/// The paragraphs of a document, without headings, tables, pictures, comments and code; each item of a list is one paragraph.
fn paragraphs(text: &str) -> Vec<String> {
    let mut paragraphs = vec![String::new()];
    let mut before = 0;
    for (number, line) in lines_outside_code(text) {
        let line = line.trim();
        let is_item = line.starts_with("- ") || line.split_once(". ").is_some_and(|(n, _)| n.parse::<u8>().is_ok());
        let is_prose = !line.is_empty() && !["#", "|", "![", "<!--"].iter().any(|start| line.starts_with(start));
        if !is_prose || is_item || number > before + 1 {
            paragraphs.push(String::new());
        }
        before = number;
        if is_prose {
            let last = paragraphs.last_mut().expect("there is a paragraph");
            *last = format!("{last} {}", plain(line.trim_start_matches("- ")));
        }
    }
    paragraphs
}

/// The word counts of the sentences: a sentence ends at a word that ends with a full stop, a question mark or an exclamation mark.
fn sentences(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for paragraph in paragraphs(text) {
        let mut words: Vec<&str> = Vec::new();
        let mut finish = |words: &mut Vec<&str>| {
            let counted = words.iter().filter(|word| word.contains(char::is_alphanumeric)).count();
            if counted > 0 {
                found.push((counted, words.join(" ")));
            }
            words.clear();
        };
        for word in paragraph.split_whitespace() {
            words.push(word);
            if word.trim_end_matches([')', '"', '”']).ends_with(['.', '?', '!']) {
                finish(&mut words);
            }
        }
        finish(&mut words);
    }
    found
}

/// The value that `percent` of the numbers do not exceed.
fn quantile(sorted: &[usize], percent: usize) -> usize {
    sorted[(sorted.len() * percent).div_ceil(100).saturating_sub(1)]
}

/// Packages with a card: the folders of every Cargo.toml.
fn packages() -> Vec<String> {
    files("Cargo.toml").iter().filter_map(|file| file.strip_suffix("/Cargo.toml").map(str::to_owned)).collect()
}

#[test]
fn the_measure_counts_the_words_of_sentences_and_nothing_else() {
    let text = "# Head\n\nOne `two and three` four. Five [six](seven eight.md) – seven!\n\n| a | b |\n\n- Item\n  goes on.\n- Next\n\n```\nlet x;\n```\n";
    let counts: Vec<usize> = sentences(text).iter().map(|(words, _)| *words).collect();
    assert_eq!(counts, [3, 3, 3, 1]);
    assert_eq!(
        (quantile(&[1, 2, 3, 4], 50), quantile(&[1, 2, 3, 4, 5, 6, 7, 8, 9, 10], 90), quantile(&[7], 90)),
        (2, 9, 7)
    );
}

/// Decisions are measured together, and so are cards of packages; every other document is measured alone.
#[test]
fn sentences_of_documents_are_short() {
    let cards: Vec<String> = packages().iter().map(|folder| format!("{folder}/README.md")).collect();
    let mut groups: BTreeMap<String, Vec<(usize, String)>> = BTreeMap::new();
    for path in files(".md").into_iter().filter(|path| !GENERATED.contains(&path.as_str())) {
        let group = if path.starts_with("docs/decisions/") {
            "docs/decisions"
        } else if cards.contains(&path) {
            "cards of packages"
        } else {
            path.as_str()
        };
        groups.entry(group.to_owned()).or_default().extend(sentences(&text_of(&path)));
    }
    let mut too_long = Vec::new();
    for (group, mut found) in groups {
        found.sort();
        let counts: Vec<usize> = found.iter().map(|(words, _)| *words).collect();
        let (half, nine_in_ten) = (quantile(&counts, 50), quantile(&counts, 90));
        println!("{group}: {} sentences, median {half}, 90th percentile {nine_in_ten}", counts.len());
        if half > WORDS.0 || nine_in_ten > WORDS.1 {
            let longest: Vec<String> =
                found.iter().rev().take(5).map(|(words, text)| format!("  {words}: {text}")).collect();
            too_long.push(format!("{group}: median {half}, 90th percentile {nine_in_ten}\n{}", longest.join("\n")));
        }
    }
    assert!(too_long.is_empty(), "more than {WORDS:?} words:\n{}", too_long.join("\n"));
}

/// Largest number of characters in a line of prose.
const LINE: usize = 160;

#[test]
fn lines_of_prose_are_wrapped() {
    for path in files(".md").into_iter().filter(|path| !GENERATED.contains(&path.as_str())) {
        let text = text_of(&path);
        for (number, line) in lines_outside_code(&text) {
            let is_prose = !["|", "![", "#"].iter().any(|start| line.trim_start().starts_with(start));
            assert!(!is_prose || line.chars().count() <= LINE, "{path}:{number}: more than {LINE} characters");
        }
    }
}

#[test]
fn documents_are_as_small_as_they_promise() {
    let decisions = files(".md").into_iter().filter(|path| path.starts_with("docs/decisions/"));
    let decisions: Vec<String> = decisions.filter(|path| !path.ends_with("/README.md")).collect();
    assert!(decisions.len() > 30, "only {} decisions found", decisions.len());
    let limits = SIZES.iter().map(|&(path, most)| (path.to_owned(), most));
    for (path, most) in limits.chain(decisions.into_iter().map(|path| (path, DECISION))) {
        let size = text_of(&path).len();
        assert!(size <= most, "{path}: {size} bytes, more than {most}");
    }
}

/// The addresses of the links and pictures of a document.
fn links(text: &str) -> Vec<String> {
    let links_of = |line: &str| -> Vec<String> {
        let without_code: String =
            line.split('`').enumerate().filter(|(place, _)| place % 2 == 0).map(|(_, part)| part).collect();
        let parts = without_code.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
        parts.map(|(address, _)| address.to_owned()).collect()
    };
    lines_outside_code(text).into_iter().flat_map(|(_, line)| links_of(line)).collect()
}

/// The anchor of a heading, in GitHub's form.
fn anchor(heading: &str) -> String {
    let kept = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = kept.chars().filter(|&c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

#[test]
fn local_links_lead_to_files_and_headings_that_are_there() {
    let (mut wrong, mut count) = (Vec::new(), 0);
    for path in files(".md") {
        for link in links(&text_of(&path)) {
            if link.contains("://") {
                continue;
            }
            count += 1;
            let (file, heading) = link.split_once('#').map_or((link.as_str(), None), |(file, head)| (file, Some(head)));
            let folder = Path::new(&path).parent().expect("a file is in a folder");
            let target = if file.is_empty() { PathBuf::from(&path) } else { folder.join(file) };
            let inside = target.components().try_fold(0_i32, |depth, part| {
                let depth = depth + if part == Component::ParentDir { -1 } else { 1 };
                (depth >= 0).then_some(depth)
            });
            if inside.is_none() || !workspace_root().join(&target).exists() {
                wrong.push(format!("{path}: {link}"));
            } else if let Some(heading) = heading {
                let text = fs::read_to_string(workspace_root().join(&target)).expect("a document");
                let lines = lines_outside_code(&text);
                if !lines.iter().any(|(_, line)| line.starts_with('#') && anchor(line) == heading) {
                    wrong.push(format!("{path}: {link}"));
                }
            }
        }
    }
    assert!(count > 100, "only {count} links found");
    assert!(wrong.is_empty(), "not there:\n{}", wrong.join("\n"));
}

/// The pieces of code of a document: lines of blocks, and text between backticks in a line.
fn code(text: &str) -> Vec<&str> {
    let mut is_block = false;
    let pieces = text.lines().flat_map(|line| {
        let is_fence = line.trim_start().starts_with("```");
        is_block ^= is_fence;
        if is_block { vec![line.trim()] } else { line.split('`').skip(1).step_by(2).collect() }
    });
    pieces.collect()
}

#[test]
fn files_that_documents_name_are_there() {
    let (mut gone, mut count) = (Vec::new(), 0);
    for path in files(".md").into_iter().filter(|path| !GENERATED.contains(&path.as_str())) {
        let text = text_of(&path);
        let is_path = |code: &&str| FOLDERS.iter().any(|folder| code.starts_with(&format!("{folder}/")));
        for name in code(&text).into_iter().filter(is_path).filter(|code| !code.contains([' ', '*'])) {
            count += 1;
            if !workspace_root().join(name).exists() {
                gone.push(format!("{path}: {name}"));
            }
        }
    }
    assert!(count > 150, "only {count} files found");
    assert!(gone.is_empty(), "not there:\n{}", gone.join("\n"));
}

/// `cargo … -p PACKAGE --bench NAME`: the package is in the workspace, and has a target of that name. Names in capitals are placeholders.
#[test]
fn cargo_commands_of_documents_name_packages_and_targets_that_are_there() {
    let manifests: Vec<String> = packages().iter().map(|folder| format!("{folder}/Cargo.toml")).collect();
    let names: BTreeMap<String, &str> = manifests
        .iter()
        .map(|path| {
            let text = text_of(path);
            let name = text.split("name = \"").nth(1).and_then(|rest| rest.split('"').next()).expect("a name");
            (name.to_owned(), path.trim_end_matches("Cargo.toml"))
        })
        .collect();
    let (mut wrong, mut count) = (Vec::new(), 0);
    for path in files(".md") {
        let text = text_of(&path);
        for line in code(&text).into_iter().filter(|code| code.contains("cargo ")) {
            let words: Vec<&str> = line.split_whitespace().collect();
            let after = |option: &str| words.iter().position(|word| *word == option).and_then(|at| words.get(at + 1));
            let Some(package) = after("-p") else { continue };
            count += 1;
            let Some(folder) = names.get(*package) else {
                wrong.push(format!("{path}: {line}: no package {package}"));
                continue;
            };
            for (option, places) in [
                ("--bin", ["src/bin"; 2]),
                ("--bench", ["benches", "."]),
                ("--test", ["tests"; 2]),
                ("--example", ["examples"; 2]),
            ] {
                let Some(name) = after(option).filter(|name| !name.chars().all(char::is_uppercase)) else { continue };
                let is_there = |place: &str| {
                    let place = workspace_root().join(folder).join(place);
                    place.join(format!("{name}.rs")).exists() || place.join(name).join("main.rs").exists()
                };
                if !places.into_iter().any(is_there) {
                    wrong.push(format!("{path}: {line}: no {option} {name}"));
                }
            }
        }
    }
    assert!(count > 10, "only {count} commands found");
    assert!(wrong.is_empty(), "not there:\n{}", wrong.join("\n"));
}

#[test]
fn every_package_has_a_card_and_every_decision_stands_in_the_index() {
    for folder in packages() {
        let lines = text_of(&format!("{folder}/README.md")).lines().filter(|line| !line.trim().is_empty()).count();
        assert!(lines >= 5, "{folder}/README.md: {lines} lines");
    }
    let (index, text) = ("docs/decisions/README.md", text_of("docs/decisions/README.md"));
    let listed = links(&text);
    for path in files(".md").into_iter().filter(|path| path.starts_with("docs/decisions/") && path != index) {
        let name = path.rsplit('/').next().expect("a name");
        assert_eq!(listed.iter().filter(|link| *link == name).count(), 1, "{name} in {index}");
        let text = text_of(&path);
        for heading in ["# ", "## Context", "## Decision", "## Consequences"] {
            assert!(text.lines().any(|line| line.starts_with(heading)), "{path}: no heading {heading}");
        }
    }
}

#[test]
fn every_table_of_measured_figures_is_filled_by_a_command() {
    let (page, results) = (text_of("docs/performance.md"), performance::read().expect("results are readable"));
    for (name, section) in &results {
        let filled = performance::filled(&page, name, section).expect("markers are there");
        assert!(filled == page, "{name} differs from performance.json; run the binary performance with --fill");
        assert!(section.rows.iter().all(|row| row.len() == section.columns.len()), "{name}: rows of one length");
    }
    let mut inside = None;
    for line in page.lines() {
        if let Some(marker) = line.strip_prefix("<!-- ").and_then(|line| line.strip_suffix(" -->")) {
            let name = marker.split([':', ' ']).next_back().expect("a last word");
            let is_end = marker.starts_with("end of ");
            assert_eq!(inside, is_end.then_some(name), "{line}");
            assert!(is_end || marker.starts_with("study: ") || results.contains_key(name), "{name}: no results");
            inside = (!is_end).then_some(name);
        }
        assert!(inside.is_some() || !line.starts_with('|'), "a table without a command: {line}");
    }
}

/// First words that make a doc comment start without a noun or a verb.
const NO_HEAD: [&str; 30] = [
    "What", "Which", "Who", "Whose", "Where", "When", "Whether", "How", "Of", "In", "On", "At", "By", "For", "From",
    "With", "Without", "To", "As", "If", "While", "Those", "That", "These", "Both", "It", "They", "There", "Here",
    "Beside",
];

/// Largest share of doc comments without a head, per cent.
const MOST_WITHOUT_A_HEAD: f64 = 2.0;

#[test]
fn doc_comments_begin_with_a_noun_or_a_verb() {
    let (mut all, mut without) = (0_u32, 0_u32);
    for path in files(".rs") {
        let text = text_of(&path);
        let mut was_doc = false;
        for line in text.lines().map(str::trim_start) {
            let doc = line.strip_prefix("///").or_else(|| line.strip_prefix("//!"));
            if let (Some(doc), false) = (doc, was_doc) {
                let words: Vec<&str> = doc.split_whitespace().take(2).collect();
                let has_none = words.first().is_some_and(|word| NO_HEAD.contains(&word.trim_end_matches([',', ':'])));
                all += 1;
                without += u32::from(has_none || words == ["The", "same"]);
            }
            was_doc = doc.is_some();
        }
    }
    let share = 100.0 * f64::from(without) / f64::from(all);
    println!("{without} of {all} doc comments have no head: {share:.1} %");
    assert!(share <= MOST_WITHOUT_A_HEAD, "{share:.1} % of doc comments have no head");
}
