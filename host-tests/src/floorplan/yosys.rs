//! Yosys: scripts of passes, run by the Python package or by the program of the system.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use roughxel_netlist::target::Target;
use serde_json::Value;

use super::cell::{Text, hash};
use super::device::{Area, synthesis};
use super::tools::{folder, installed, python, run_within, tail};

/// Runs each line of a script as a pass.
const PASSES: &str = "\
import sys
from pyosys import libyosys as yosys
design = yosys.Design()
for line in open(sys.argv[1]):
    yosys.run_pass(line.strip(), design)
";

/// An installation of Yosys.
#[derive(Clone, Debug)]
pub struct Yosys {
    /// Name and version.
    pub version: String,
    is_package: bool,
    /// Folder of its models of cells.
    pub share: PathBuf,
}

impl Yosys {
    /// The Python package.
    ///
    /// Errors: it is missing.
    pub fn package() -> Result<Self, String> {
        Ok(Self { version: installed("pyosys")?, is_package: true, share: folder().join("tools/pyosys/share") })
    }

    /// The program of the system. `None` if it is missing.
    pub fn system() -> Option<Self> {
        let output = Command::new("yosys").arg("-V").output().ok()?;
        let version = String::from_utf8_lossy(&output.stdout).split(" (").next()?.trim().to_owned();
        let data = Command::new("yosys-config").arg("--datdir").output().ok();
        let data = data.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned());
        let share = data.filter(|path| !path.is_empty()).unwrap_or_else(|| "/usr/share/yosys".to_owned()).into();
        Some(Self { version, is_package: false, share })
    }

    /// Runs passes in a folder.
    ///
    /// Errors: a pass fails; the message has the end of the log.
    pub fn run(&self, folder: &Path, passes: &[String]) -> Result<(), String> {
        let (script, log) = (folder.join("script.ys"), folder.join("yosys.log"));
        fs::write(&script, passes.join("\n") + "\n").map_err(|e| format!("{}: {e}", script.display()))?;
        let mut command = if self.is_package {
            let mut command = python();
            command.args(["-c", PASSES]);
            command
        } else {
            let mut command = Command::new("yosys");
            command.arg("-s");
            command
        };
        let status = run_within(command.arg(&script).current_dir(folder), &log, None)?;
        if status.is_some_and(|status| status.success()) {
            return Ok(());
        }
        Err(format!("{} fails in {}: {}", self.version, folder.display(), tail(&log)))
    }
}

/// A netlist that is kept for its key.
#[derive(Clone, Debug)]
pub struct Netlist {
    /// Hash of text, passes and version.
    pub key: String,
    /// Hash of the netlist itself, see [`content`].
    pub content: String,
    /// Folder of `netlist.json`, below [`folder`].
    pub folder: PathBuf,
    /// Cells with the shell.
    pub area: Area,
    /// Cells without the shell.
    pub alone: Area,
}

fn command(target: Target) -> Result<&'static str, String> {
    synthesis(target).ok_or_else(|| format!("target {} is no device: nothing is synthesised for gates", target.name()))
}

/// Key of a module's netlist.
///
/// Errors: the target is no device.
pub fn key(yosys: &Yosys, hash_of_text: &str, module: &str, target: Target) -> Result<String, String> {
    Ok(hash(&[hash_of_text, module, command(target)?, &yosys.version]))
}

/// Hash of the `netlist.json` of a folder. The places in the text that its parts come from do not count: text of another order may give the same
/// netlist, whose placement took an hour.
///
/// Errors: the file cannot be read.
pub fn content(folder: &Path) -> Result<String, String> {
    let path = folder.join("netlist.json");
    let text = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    Ok(hash_without_places(&text))
}

/// Hash of a netlist in JSON, a key in a line, see [`content`].
pub fn hash_without_places(netlist: &str) -> String {
    let is_place = |line: &str| line.split_once("\": \"").is_some_and(|(key, _)| key.ends_with("src"));
    let lines: Vec<&str> = netlist.lines().filter(|line| !is_place(line)).collect();
    hash(&lines)
}

/// Statistics of a netlist in a file.
///
/// Errors: the file is missing or has no cells.
pub fn area_in(file: &Path, target: Target) -> Result<Area, String> {
    let text = fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()))?;
    let json = text.find('{').map_or("", |start| &text[start..]);
    let statistics: Value = serde_json::from_str(json).map_err(|e| format!("{}: {e}", file.display()))?;
    Area::read(&statistics, target).ok_or_else(|| format!("{}: it has no cells", file.display()))
}

/// Writes the files of a text to a new folder.
///
/// Errors: the folder or a file cannot be written.
pub fn write_text<'a>(folder: &Path, files: impl Iterator<Item = (&'a String, &'a String)>) -> Result<(), String> {
    fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    for (name, text) in files {
        let path = folder.join(name);
        fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    Ok(())
}

/// Synthesises a module of sources in the folder `KEY` unless that is done, and returns its cells.
///
/// Errors: a file cannot be written, or Yosys fails.
pub fn synthesise(
    yosys: &Yosys,
    key: &str,
    files: &[(&String, &String)],
    module: &str,
    target: Target,
) -> Result<(PathBuf, Area), String> {
    let folder = folder().join("netlists").join(key);
    let statistics = folder.join("stat.json");
    if !statistics.exists() {
        write_text(&folder, files.iter().copied())?;
        let mut passes: Vec<String> = files.iter().map(|(name, _)| format!("read_verilog -defer {name}")).collect();
        passes.push(format!("{} -top {module} -json netlist.json", command(target)?));
        passes.push("tee -q -o stat.part stat -json".to_owned());
        yosys.run(&folder, &passes)?;
        let part = folder.join("stat.part");
        fs::rename(&part, &statistics).map_err(|e| format!("{}: {e}", part.display()))?;
    }
    let area = area_in(&statistics, target)?;
    Ok((folder, area))
}

/// Synthesises a cell in its shell, and without it.
///
/// Errors: a file cannot be written, or Yosys fails.
pub fn netlist(yosys: &Yosys, text: &Text, target: Target) -> Result<Netlist, String> {
    let (shell, top) = (text.shell(), &text.interface.module);
    let files: Vec<_> = text.files.iter().collect();
    let [key, key_alone] = [&shell, top].map(|module| key(yosys, &text.hash, module, target));
    let (key, key_alone) = (key?, key_alone?);
    let (folder, area) = synthesise(yosys, &key, &files, &shell, target)?;
    let (_, alone) = synthesise(yosys, &key_alone, &files, top, target)?;
    Ok(Netlist { key, content: content(&folder)?, folder, area, alone })
}
