//! Runs of the program with output and exit code, and a folder for each test.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// Makes the command of the program with arguments and an empty stdin.
pub(super) fn program(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_roughxel"));
    command.args(arguments).stdin(Stdio::null());
    command
}

/// Runs the program.
pub(super) fn roughxel(arguments: &[&str]) -> Run {
    Run::output(&mut program(arguments))
}

/// Output and exit code of a run.
#[derive(Debug)]
pub(super) struct Run {
    pub(super) code: Option<i32>,
    pub(super) out: String,
    pub(super) err: String,
}

impl Run {
    pub(super) fn output(command: &mut Command) -> Self {
        Self::left(command.output().unwrap())
    }

    /// Runs a command that reads a text from stdin.
    pub(super) fn reading(command: &mut Command, input: &str) -> Self {
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        // The program may end before it reads everything.
        let _ = child.stdin.take().unwrap().write_all(input.as_bytes());
        Self::left(child.wait_with_output().unwrap())
    }

    fn left(Output { status, stdout, stderr }: Output) -> Self {
        let [out, err] = [stdout, stderr].map(|text| String::from_utf8(text).unwrap());
        assert!(!err.contains("panicked"), "{err}");
        Self { code: status.code(), out, err }
    }

    /// Asserts the exit code.
    #[track_caller]
    pub(super) fn ends(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "{}{}", self.out, self.err);
        self
    }

    /// Asserts that stdout has each part.
    #[track_caller]
    pub(super) fn prints(self, parts: &[&str]) -> Self {
        parts.iter().for_each(|part| assert!(self.out.contains(part), "`{part}` is not in: {}", self.out));
        self
    }

    /// Asserts that stderr has each part.
    #[track_caller]
    pub(super) fn complains(self, parts: &[&str]) -> Self {
        parts.iter().for_each(|part| assert!(self.err.contains(part), "`{part}` is not in: {}", self.err));
        self
    }

    /// Parses stdout as JSON. The run must end with 0.
    #[track_caller]
    pub(super) fn json(self) -> Value {
        serde_json::from_str(&self.ends(0).out).unwrap()
    }
}

/// A temporary folder for a test.
pub(super) struct Folder(TempDir);

impl Folder {
    pub(super) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(super) fn path(&self) -> &Path {
        self.0.path()
    }

    pub(super) fn join(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    /// Path of a file in the folder, as an argument.
    pub(super) fn file(&self, name: &str) -> String {
        self.join(name).to_str().unwrap().to_owned()
    }

    /// Makes the command of the program in the folder. Arguments of the line have no blanks.
    pub(super) fn program(&self, line: &str) -> Command {
        let mut command = program(&line.split_whitespace().collect::<Vec<_>>());
        command.current_dir(self.path());
        command
    }

    /// Runs the program in the folder.
    pub(super) fn run(&self, line: &str) -> Run {
        Run::output(&mut self.program(line))
    }

    /// Runs the program in the folder and asserts that it ends with 0.
    #[track_caller]
    pub(super) fn done(&self, line: &str) -> Run {
        self.run(line).ends(0)
    }

    /// Asserts that each line ends with its code and that stderr has its part.
    #[track_caller]
    pub(super) fn refuses(&self, cases: &[(&str, i32, &str)]) {
        cases.iter().for_each(|(line, code, part)| drop(self.run(line).ends(*code).complains(&[part])));
    }

    pub(super) fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.join(name)).unwrap()
    }

    pub(super) fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        std::fs::write(self.join(name), contents).unwrap();
    }
}

/// Root of the repository.
pub(super) fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Reads the words of a set in text, without the title.
pub(super) fn words(path: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(path).unwrap();
    text.lines().filter(|line| !line.starts_with("//")).map(str::to_owned).collect()
}
