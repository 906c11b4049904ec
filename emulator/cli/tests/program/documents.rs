//! `docs/cli.md` is the program's help, and the commands that documents show are commands of the program.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn roughxel(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_roughxel")).args(arguments).stdin(Stdio::null()).output().unwrap()
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn help(command: &[&str]) -> String {
    let output = roughxel(&[command, &["--help"]].concat());
    assert_eq!(output.status.code(), Some(0), "{command:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Reads the names of the commands in a help.
fn commands(help: &str) -> Vec<String> {
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names = listed.filter_map(|line| line.split_whitespace().next());
    names.filter(|name| *name != "help").map(str::to_owned).collect()
}

/// Makes the page: the help of every command. The common end of most helps appears once.
fn page() -> String {
    let program = help(&[]);
    let (_, conventions) = program.split_once("Units and formats:").expect("it says units");
    let conventions = format!("Units and formats:{conventions}");
    let mut page = "# Commands\n\nThe output of `roughxel COMMAND --help`. A test compares this page with it; see \
                    [CONTRIBUTING.md](../CONTRIBUTING.md#files-packages-documents) for the command that writes it again.\n"
        .to_owned();
    page += &format!(
        "Units, formats and exit codes at the end of the first help hold for every command.\n\n```text\n{program}```\n"
    );
    let mut add = |command: &[&str]| {
        let help = help(command);
        let own = help.strip_suffix(&conventions).unwrap_or(&help);
        let lines: Vec<&str> = own.trim_end().lines().map(str::trim_end).collect();
        let level = "#".repeat(command.len() + 1);
        page += &format!("\n{level} {}\n\n```text\n{}\n```\n", command.join(" "), lines.join("\n"));
        commands(&help)
    };
    for command in commands(&program) {
        for below in add(&[&command]) {
            add(&[&command, &below]);
        }
    }
    page
}

#[test]
fn the_page_of_commands_is_the_help_of_the_program() {
    let (path, page) = (root().join("docs/cli.md"), page());
    if std::env::var_os("ROUGHXEL_BLESS").is_some() {
        fs::write(&path, &page).unwrap();
    }
    let command = "ROUGHXEL_BLESS=1 cargo test --release -p roughxel-cli --test program documents";
    assert!(fs::read_to_string(path).unwrap_or_default() == page, "docs/cli.md is stale, run `{command}`");
}

/// Lists the documents that show commands: all but the page of commands, the changelog, and notes on old versions.
fn documents() -> Vec<PathBuf> {
    let (mut found, mut waiting) = (Vec::new(), vec![root()]);
    while let Some(folder) = waiting.pop() {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() {
                let is_source = !name.starts_with('.') && !["target", "out", "findings"].contains(&&*name);
                waiting.extend(is_source.then_some(path));
            } else if name.ends_with(".md") && !["cli.md", "CHANGELOG.md"].contains(&&*name) {
                found.push(path);
            }
        }
    }
    found
}

/// Lists the pieces of code of a document: lines of blocks, and text between backticks.
fn code(text: &str) -> Vec<&str> {
    let mut is_block = false;
    let pieces = text.lines().flat_map(|line| {
        let is_fence = line.starts_with("```");
        is_block ^= is_fence;
        if is_block { vec![line.trim()] } else { line.split('`').skip(1).step_by(2).collect() }
    });
    pieces.collect()
}

/// Reads the arguments of a piece of code that calls the program. Placeholders become values.
fn arguments<'a>(code: &'a str, commands: &[String], is_first_page: bool) -> Option<Vec<&'a str>> {
    let of_program = ["cargo run --release -- ", "cargo run --release --features flip -- ", "roughxel "];
    let line = of_program.iter().find_map(|start| code.strip_prefix(start)).or_else(|| {
        let is_command = commands.iter().any(|command| code.starts_with(&format!("{command} ")));
        (is_first_page && is_command).then_some(code)
    })?;
    let line = [" #", " && ", " > ", " | "].iter().fold(line, |line, end| line.split(end).next().unwrap_or(line));
    let value = |word: &'a str| match word.trim_matches('\'') {
        "MODE" => "footprint",
        "DESIGN" => "highlight",
        "K/N" => "1/2",
        "N" => "1",
        word => word,
    };
    Some(line.split_whitespace().filter(|word| *word != "…").map(value).collect())
}

/// Commands are parsed with `--help` added. A wrong word fails before `--help` takes effect.
#[test]
fn commands_in_documents_are_commands_of_the_program() {
    let (commands, mut count, mut wrong) = (commands(&help(&[])), 0, Vec::new());
    for path in documents() {
        let text = fs::read_to_string(&path).unwrap();
        let is_first_page = path == root().join("README.md");
        for arguments in code(&text).into_iter().filter_map(|code| arguments(code, &commands, is_first_page)) {
            count += 1;
            let output = roughxel(&[&arguments[..], &["--help"]].concat());
            if output.status.code() != Some(0) {
                let message = String::from_utf8_lossy(&output.stderr).lines().next().unwrap_or_default().to_owned();
                wrong.push(format!("{}: {}: {message}", path.display(), arguments.join(" ")));
            }
        }
    }
    assert!(count > 60, "only {count} commands found");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    for wrong in [
        &["render", "lake", "--mode", "best", "--help"][..],
        &["vectors", "exprot", "--help"],
        &["plan", "--what", "--help"],
    ] {
        assert_eq!(roughxel(wrong).status.code(), Some(2), "{wrong:?} is not seen");
    }
}

#[test]
fn the_scene_of_the_readme_is_drawn() {
    let page = fs::read_to_string(root().join("README.md")).unwrap();
    let (_, scene) = page.split_once("```toml\n").expect("the page has a scene");
    let (scene, _) = scene.split_once("```").expect("the scene ends");
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("mine.toml"), scene).unwrap();
    let mesh = "v -1 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    fs::write(directory.path().join("mesh.obj"), mesh).unwrap();
    let mut render = Command::new(env!("CARGO_BIN_EXE_roughxel"));
    render.args(["render", "mine.toml", "-o", "mine.png", "--size", "32x24"]).current_dir(directory.path());
    let output = render.output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(directory.path().join("mine.png").is_file());
}
