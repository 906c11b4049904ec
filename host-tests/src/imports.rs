//! Imports between the files of the workspace, read from the sources.
//!
//! Modules are found as the compiler finds them, from the roots of each package. A path, in a `use` or in the middle of code, leads to the file of
//! the module that has the named item. If a module only re-exports a name (`pub use`), the path leads to the file that defines it. Names after
//! `$crate` in a macro do not count, because only callers of the macro need them. Tests inside modules do not count either, because they may look
//! at anything.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fs;
use std::path::{Path, PathBuf};

use crate::tokens::{Token, tokens};

/// A source file of a package's `src`.
#[derive(Clone, Debug)]
pub struct SourceFile {
    /// Path from the root of the workspace, such as `core/src/word.rs`.
    pub path: String,
    /// Folder of the package.
    pub package: String,
    /// Files of the workspace that this file uses, with the first line that uses each.
    pub uses: BTreeMap<String, usize>,
    /// Files of the same package that this file uses, apart from names that it only re-exports.
    pub needs: BTreeSet<String>,
}

/// A module and the contents of its source.
#[derive(Default)]
struct Module {
    path: String,
    package: String,
    parent: Option<usize>,
    children: HashMap<String, usize>,
    /// Targets of the names of its `use` lines.
    names: HashMap<String, Vec<String>>,
    paths: Vec<Named>,
}

/// A path in the source.
struct Named {
    segments: Vec<String>,
    line: usize,
    passed_on: bool,
}

/// The root of the workspace.
pub fn workspace_root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Folders of the packages, as the workspace lists them.
///
/// # Panics
/// If the workspace cannot be read.
pub fn packages() -> Vec<String> {
    let manifest = read(&workspace_root().join("Cargo.toml"));
    let list =
        manifest.split_once("\nmembers = [").and_then(|(_, rest)| rest.split_once(']')).expect("list of members").0;
    list.split('"').skip(1).step_by(2).map(str::to_owned).collect()
}

/// The source files of all packages with the files that they use.
///
/// # Panics
/// If a source cannot be read.
pub fn source_files() -> Vec<SourceFile> {
    let root = workspace_root();
    let (mut modules, mut libraries) = (Vec::new(), HashMap::new());
    for package in packages() {
        let manifest = read(&root.join(&package).join("Cargo.toml"));
        let name = manifest.split('"').nth(1).expect("a package has a name").replace('-', "_");
        let source = root.join(&package).join("src");
        if source.join("lib.rs").is_file() {
            libraries.insert(name, add(&mut modules, &root, &package, &source.join("lib.rs"), &source, None));
        }
        if source.join("main.rs").is_file() {
            add(&mut modules, &root, &package, &source.join("main.rs"), &source, None);
        }
        for program in files_in(&source.join("bin")) {
            let folder = program.with_extension("");
            add(&mut modules, &root, &package, &program, &folder, None);
        }
    }
    (0..modules.len()).map(|index| source_file(&modules, &libraries, index)).collect()
}

/// Groups of files in a package, each of which needs all others of its group, directly or indirectly.
pub fn circles(files: &[SourceFile]) -> Vec<Vec<String>> {
    let needs: BTreeMap<&str, &BTreeSet<String>> = files.iter().map(|file| (file.path.as_str(), &file.needs)).collect();
    let reached: BTreeMap<&str, BTreeSet<&str>> = needs
        .keys()
        .map(|start| {
            let (mut found, mut waiting) = (BTreeSet::new(), vec![*start]);
            while let Some(next) = waiting.pop() {
                for used in needs.get(next).into_iter().copied().flatten() {
                    if found.insert(used.as_str()) {
                        waiting.push(used);
                    }
                }
            }
            (*start, found)
        })
        .collect();
    let groups: BTreeSet<Vec<String>> = reached
        .iter()
        .filter(|(path, found)| found.contains(*path))
        .map(|(path, found)| {
            found
                .iter()
                .filter(|other| reached.get(*other).is_some_and(|back| back.contains(path)))
                .map(|other| (*other).to_owned())
                .collect()
        })
        .collect();
    groups.into_iter().collect()
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Rust files of a folder; none if there is no folder.
fn files_in(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten();
    let paths = entries.map(|entry| entry.expect("a folder can be read").path());
    let mut files: Vec<PathBuf> = paths.filter(|path| path.extension().is_some_and(|end| end == "rs")).collect();
    files.sort();
    files
}

/// Reads a module and all modules below it, whose files are in `folder`.
fn add(
    modules: &mut Vec<Module>,
    root: &Path,
    package: &str,
    file: &Path,
    folder: &Path,
    parent: Option<usize>,
) -> usize {
    let path = file.strip_prefix(root).expect("below the root").to_string_lossy().replace('\\', "/");
    let tokens = without_tests(tokens(&read(file)));
    let index = modules.len();
    let (names, paths) = named(&tokens);
    modules.push(Module { path, package: package.to_owned(), parent, children: HashMap::new(), names, paths });
    for place in tokens.windows(3) {
        if place[0].text == "mod" && place[2].text == ";" {
            let name = &place[1].text;
            let child =
                add(modules, root, package, &folder.join(name).with_extension("rs"), &folder.join(name), Some(index));
            modules[index].children.insert(name.clone(), child);
        }
    }
    index
}

/// The tokens without items marked `#[cfg(test)]`.
fn without_tests(tokens: Vec<Token>) -> Vec<Token> {
    let mark = ["#", "[", "cfg", "(", "test", ")", "]"];
    let (mut kept, mut i) = (Vec::new(), 0);
    while i < tokens.len() {
        let here = tokens[i..].iter().map(|token| token.text.as_str());
        if !here.take(mark.len()).eq(mark) {
            kept.push(tokens[i].clone());
            i += 1;
            continue;
        }
        // An item ends with its first semicolon or its first block.
        i += mark.len();
        let mut depth = 0;
        while let Some(token) = tokens.get(i) {
            i += 1;
            match token.text.as_str() {
                "{" | "(" | "[" => depth += 1,
                ")" | "]" => depth -= 1,
                "}" => depth -= 1,
                _ => {}
            }
            if depth == 0 && matches!(token.text.as_str(), ";" | "}") {
                break;
            }
        }
    }
    kept
}

/// Returns the names that the `use` lines define, and all paths of two names or more.
fn named(tokens: &[Token]) -> (HashMap<String, Vec<String>>, Vec<Named>) {
    let text = |i: usize| tokens.get(i).map_or("", |token| token.text.as_str());
    let (mut names, mut paths, mut i) = (HashMap::new(), Vec::new(), 0);
    while i < tokens.len() {
        let line = tokens[i].line;
        if text(i) == "use" {
            let passed_on = i > 0 && matches!(text(i - 1), "pub" | ")");
            let mut leaves = Vec::new();
            i = tree(tokens, i + 1, &[], &mut leaves);
            for (segments, name) in leaves {
                if let Some(name) = name {
                    names.insert(name, segments.clone());
                }
                paths.push(Named { segments, line, passed_on });
            }
            continue;
        }
        let is_first = is_name(text(i)) && !(i > 0 && text(i - 1) == ":" && text(i.wrapping_sub(2)) == ":");
        if is_first && text(i + 1) == ":" && text(i + 2) == ":" {
            let in_macro = i > 0 && text(i - 1) == "$";
            let mut segments = vec![text(i).to_owned()];
            while text(i + 1) == ":" && text(i + 2) == ":" && is_name(text(i + 3)) {
                segments.push(text(i + 3).to_owned());
                i += 3;
            }
            // Names after `$crate` in a macro are needed by its callers.
            if !in_macro {
                paths.push(Named { segments, line, passed_on: false });
            }
        }
        i += 1;
    }
    // An exported macro belongs to the root by its path, to this file by its text.
    for place in tokens.windows(3).filter(|place| place[0].text == "macro_rules") {
        names.remove(&place[2].text);
    }
    (names, paths)
}

fn is_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// Reads one tree of a `use` from token `i`: its leaves with their names. Returns the index of the token after it.
fn tree(tokens: &[Token], mut i: usize, before: &[String], leaves: &mut Vec<(Vec<String>, Option<String>)>) -> usize {
    let text = |i: usize| tokens.get(i).map_or("", |token| token.text.as_str());
    let mut segments = before.to_vec();
    loop {
        match text(i) {
            ":" => i += 1,
            "{" => {
                i += 1;
                while !matches!(text(i), "}" | "") {
                    i = tree(tokens, i, &segments, leaves);
                    i += usize::from(text(i) == ",");
                }
                return i + 1;
            }
            // Glob import of a module: the module itself.
            "*" => {
                leaves.push((segments, None));
                return i + 1;
            }
            "as" => {
                leaves.push((segments, Some(text(i + 1).to_owned())));
                return i + 2;
            }
            name if is_name(name) => {
                if name != "self" || segments.is_empty() {
                    segments.push(name.to_owned());
                }
                i += 1;
            }
            _ => {
                let name = segments.last().cloned();
                leaves.push((segments, name));
                return i;
            }
        }
    }
}

/// The module that contains the target of a path, seen from the module `at`; `None` for paths that leave the workspace.
fn resolve(modules: &[Module], libraries: &HashMap<String, usize>, at: usize, path: &[String]) -> Option<usize> {
    let (first, mut rest) = path.split_first()?;
    let top = |mut module: usize| {
        while let Some(parent) = modules[module].parent {
            module = parent;
        }
        module
    };
    let mut module = match first.as_str() {
        "crate" => top(at),
        "self" => at,
        "super" => modules[at].parent?,
        name => match modules[at].children.get(name) {
            Some(child) => *child,
            None => *libraries.get(name)?,
        },
    };
    while let Some((name, after)) = rest.split_first() {
        if name == "super" {
            module = modules[module].parent?;
        } else if let Some(child) = modules[module].children.get(name) {
            module = *child;
        } else if let Some(behind) = modules[module].names.get(name) {
            let whole: Vec<String> = behind.iter().chain(after).cloned().collect();
            return resolve(modules, libraries, module, &whole);
        } else {
            break;
        }
        rest = after;
    }
    Some(module)
}

fn source_file(modules: &[Module], libraries: &HashMap<String, usize>, index: usize) -> SourceFile {
    let module = &modules[index];
    let (mut uses, mut needs) = (BTreeMap::new(), BTreeSet::new());
    for Named { segments, line, passed_on } in &module.paths {
        let Some(used) = resolve(modules, libraries, index, segments).filter(|used| *used != index) else { continue };
        let used = &modules[used];
        let is_own = used.package == module.package;
        if is_own && !passed_on {
            needs.insert(used.path.clone());
        }
        if !(is_own && *passed_on) {
            uses.entry(used.path.clone()).or_insert(*line);
        }
    }
    SourceFile { path: module.path.clone(), package: module.package.clone(), uses, needs }
}
