//! Placement and routing with nextpnr.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use serde_json::Value;

use super::cell::hash;
use super::device::Device;
use super::results::{Outcome, Placement};
use super::tools::{installed, python, run_within, tail};

/// Starts the program of a package: its name and arguments come from the command line.
const START: &str = "\
import importlib, sys
package = importlib.import_module('yowasp_' + sys.argv[1])
sys.exit(getattr(package, 'run_' + sys.argv[1])(sys.argv[2:]))
";

/// Writes `pins.cst` for a netlist.
const PINS: &str = include_str!("pins.py");

/// A program of nextpnr.
#[derive(Clone, Debug)]
pub struct Nextpnr {
    name: &'static str,
    /// Name and version.
    pub version: String,
    is_package: bool,
}

impl Nextpnr {
    /// The Python package of a device's program, which runs as WebAssembly.
    ///
    /// Errors: it is missing.
    pub fn package(device: &Device) -> Result<Self, String> {
        let version = installed(&format!("yowasp-{}", device.program))?;
        Ok(Self { name: device.program, version, is_package: true })
    }

    /// The program of the system, which takes a third of the time.
    ///
    /// Errors: it is missing.
    pub fn system(device: &Device) -> Result<Self, String> {
        let name = device.program;
        let missing =
            || format!("{name} is not installed: install the package {name} of your system, or leave `--native` out");
        let output = Command::new(name).arg("--version").output().map_err(|_| missing())?;
        let text = [output.stdout, output.stderr].concat();
        let text = String::from_utf8_lossy(&text);
        let version = version_in(&text).ok_or_else(|| format!("{name} --version names no version: {}", text.trim()))?;
        Ok(Self { name, version: format!("{name} {version}"), is_package: false })
    }

    fn command(&self) -> Command {
        if !self.is_package {
            return Command::new(self.name);
        }
        let mut command = python();
        command.args(["-c", START, &self.name.replace('-', "_")]);
        command
    }
}

/// Version in the output of `--version`: `"nextpnr-ecp5" -- Next Generation Place and Route (Version 0.11.1)`.
pub fn version_in(output: &str) -> Option<&str> {
    let (_, rest) = output.split_once("(Version ")?;
    rest.split_once(')').map(|(version, _)| version)
}

/// Wishes for a run of nextpnr.
#[derive(Clone, Copy, Debug)]
pub struct Wish {
    /// The program of the system takes the place of the Python package.
    pub is_native: bool,
    /// Seed of the placer.
    pub seed: u32,
    /// Minutes after which a run is ended.
    pub minutes: u32,
}

impl Wish {
    /// Program for a device.
    ///
    /// Errors: it is not installed.
    pub fn program(self, device: &Device) -> Result<Nextpnr, String> {
        if self.is_native { Nextpnr::system(device) } else { Nextpnr::package(device) }
    }
}

/// Key of a placement: netlist, version of nextpnr, device, options, seed.
pub fn key(netlist_key: &str, version: &str, device: &Device, seed: u32) -> String {
    let options = device.options.join(" ");
    hash(&[netlist_key, version, &options, device.aim, &seed.to_string()])
}

/// Places and routes the `netlist.json` of a folder on a device. Everything but a missing tool is a result.
///
/// Errors: nextpnr is not installed, or a file cannot be written.
pub fn place(folder: &Path, netlist_key: &str, device: &Device, wish: Wish) -> Result<Placement, String> {
    let program = wish.program(device)?;
    let key = key(netlist_key, &program.version, device, wish.seed);
    let file = |ending: &str| format!("{}-seed{}.{ending}", device.name, wish.seed);
    let (report, log) = (folder.join(file("report.json")), folder.join(file("log")));
    if let Some(package) = device.pins {
        installed("apycula")?;
        let status = run_within(python().current_dir(folder).args(["-c", PINS]).args(package), &log, None)?;
        if !status.is_some_and(|status| status.success()) {
            return Err(format!("no pins of {} for {}: {}", device.name, folder.display(), tail(&log)));
        }
    }
    let seed = wish.seed.to_string();
    let mut command = program.command();
    command.current_dir(folder).args(device.options);
    // Names are relative: the package sees only its folder.
    command.args(["--json", "netlist.json", "--seed", &seed, "--freq", device.aim, "--timing-allow-fail"]);
    command.args(["--report", &file("report.json")]);
    let start = Instant::now();
    let limit = Duration::from_secs(60 * u64::from(wish.minutes));
    let status = run_within(&mut command, &log, Some(limit))?;
    let text = fs::read_to_string(&log).map_err(|e| format!("{}: {e}", log.display()))?;
    let used = utilisation(&text);
    let outcome = match status {
        None => Outcome::OutOfTime { minutes: wish.minutes },
        Some(status) if status.success() => {
            let megahertz = clock(&report)?;
            Outcome::Placed { megahertz }
        }
        Some(_) => Outcome::Failed { reason: reason(&text).unwrap_or_else(|| tail(&log)) },
    };
    Ok(Placement { key, tool: program.version, seed: wish.seed, seconds: start.elapsed().as_secs(), used, outcome })
}

/// Lowest clock of a report, MHz. A multiplier without registers of its own is in a domain of a constant, which has no clock.
fn clock(report: &Path) -> Result<f64, String> {
    let text = fs::read_to_string(report).map_err(|e| format!("{}: {e}", report.display()))?;
    let value: Value = serde_json::from_str(&text).map_err(|e| format!("{}: {e}", report.display()))?;
    let clocks = value["fmax"].as_object().into_iter().flatten();
    let achieved = clocks.filter_map(|(_, clock)| clock["achieved"].as_f64());
    achieved.min_by(f64::total_cmp).ok_or_else(|| format!("{}: it has no clock", report.display()))
}

/// Cells of a log's list of used ones, and how many of them the device has: `TRELLIS_COMB: 10/ 24288  0%`. Kinds that are not used are left out.
pub fn utilisation(log: &str) -> BTreeMap<String, [u64; 2]> {
    let lines = log.lines().filter_map(|line| {
        let (kind, numbers) = line.trim().strip_prefix("Info:")?.trim().split_once(':')?;
        let (used, rest) = numbers.split_once('/')?;
        let available = rest.split_whitespace().next()?;
        Some((kind.to_owned(), [used.trim().parse().ok()?, available.parse().ok()?]))
    });
    lines.filter(|(kind, [used, _])| *used > 0 && !kind.contains(' ')).collect()
}

/// First error of a log, without its prefix.
fn reason(log: &str) -> Option<String> {
    let line = log.lines().find_map(|line| line.trim().strip_prefix("ERROR:"))?;
    Some(line.trim().chars().take(160).collect())
}
