//! Tools of the floor plan: Python packages in a folder of their own, with their versions.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};
use std::thread;
use std::time::{Duration, Instant};

use crate::imports::workspace_root;

/// Packages and their versions.
const REQUIREMENTS: &str = include_str!("requirements.txt");

/// Remedy for a missing package.
const REMEDY: &str = "pip3 install --target target/floorplan/tools -r host-tests/src/floorplan/requirements.txt";

/// Time between two looks at a running program.
const LOOK: Duration = Duration::from_millis(100);

/// Folder of everything that a run leaves: tools, texts, netlists, logs.
pub fn folder() -> PathBuf {
    workspace_root().join("target/floorplan")
}

/// Returns the version of a package in `requirements.txt`.
///
/// Errors: the file does not name the package.
pub fn version(package: &str) -> Result<&'static str, String> {
    let lines = REQUIREMENTS.lines().filter_map(|line| line.split_once("=="));
    let found = lines.into_iter().find(|(name, _)| *name == package).map(|(_, version)| version);
    found.ok_or_else(|| {
        format!("{package} is not in host-tests/src/floorplan/requirements.txt: add it with its version")
    })
}

/// Checks that a package is installed in its version, and returns `PACKAGE VERSION`.
///
/// Errors: it is missing, or another version is there. The message has the command that installs it.
pub fn installed(package: &str) -> Result<String, String> {
    let (folder, wanted) = (folder().join("tools"), version(package)?);
    let start = format!("{}-", package.replace('-', "_"));
    let entries = fs::read_dir(&folder).into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let found = names.filter_map(|name| Some(name.strip_prefix(&start)?.strip_suffix(".dist-info")?.to_owned()));
    let found: Vec<String> = found.collect();
    if found.iter().any(|version| version == wanted) {
        return Ok(format!("{package} {wanted}"));
    }
    let state = if found.is_empty() {
        "is missing".to_owned()
    } else {
        format!("has version {} instead of {wanted}", found.join(" and "))
    };
    Err(format!("{package} {state} in {}. Run in the root of the repository: {REMEDY}", folder.display()))
}

/// Python with the folder of tools as its first place for packages.
pub fn python() -> Command {
    let mut command = Command::new("python3");
    command.env("PYTHONPATH", folder().join("tools"));
    command
}

/// Runs a program with its output in `log`. Returns `None` if it is ended because it takes longer than `limit`.
///
/// Errors: the log cannot be written, or the program cannot be started.
pub fn run_within(command: &mut Command, log: &Path, limit: Option<Duration>) -> Result<Option<ExitStatus>, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = File::create(log).map_err(|e| format!("{}: {e}", log.display()))?;
    let errors = output.try_clone().map_err(|e| format!("{}: {e}", log.display()))?;
    let mut child = command.stdout(output).stderr(errors).spawn().map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => format!("{name} is not installed: install the package {name} of your system"),
        _ => format!("{name}: {error}"),
    })?;
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait().map_err(|e| format!("{name}: {e}"))? {
            return Ok(Some(status));
        }
        if limit.is_some_and(|limit| start.elapsed() >= limit) {
            // It may have ended by itself since.
            let _ = child.kill();
            child.wait().map_err(|e| format!("{name}: {e}"))?;
            return Ok(None);
        }
        thread::sleep(LOOK);
    }
}

/// Last lines of a log, for a message.
pub fn tail(log: &Path) -> String {
    let text = fs::read_to_string(log).unwrap_or_default();
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    lines[lines.len().saturating_sub(3)..].join("; ")
}
