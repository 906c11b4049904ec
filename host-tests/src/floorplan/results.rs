//! Kept results of the floor plan, `vectors/hdl/floorplan.json`.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::{fs, io};

use roughxel_utilities::output::OutputFile;
use serde::{Deserialize, Serialize};

use super::cell::Plan;
use super::device::Area;
use crate::imports::workspace_root;

/// Everything that was measured.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Results {
    /// Cells by name.
    pub cells: BTreeMap<String, CellResult>,
    /// Units of float32 by name.
    pub float_units: BTreeMap<String, FloatUnit>,
    /// Operations of the float32 datapath by plan and kind.
    pub float_operations: BTreeMap<String, BTreeMap<String, u32>>,
    /// Simulated netlists by name.
    pub simulations: BTreeMap<String, Simulation>,
}

/// Figures of a cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CellResult {
    /// Name of the profile.
    pub profile: String,
    /// Effects.
    pub plan: Plan,
    /// Multipliers, or none for a flat design.
    pub multipliers: Option<u32>,
    /// Device family.
    pub target: String,
    /// Cycles from a fragment to the next.
    pub interval: u32,
    /// Cycles from a fragment to its outcome.
    pub latency: u32,
    /// Width of the stream, bits.
    pub stream: u32,
    /// Words of a fragment and of its outcome in the stream.
    pub words: [u32; 2],
    /// Hash of text, passes and version of Yosys.
    pub key: String,
    /// Hash of the netlist with the shell.
    pub netlist: String,
    /// Version of Yosys.
    pub tool: String,
    /// Cells with the shell.
    pub area: Area,
    /// Cells without the shell.
    pub alone: Area,
    /// Placements by device.
    pub placements: BTreeMap<String, Placement>,
}

/// A run of nextpnr.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Placement {
    /// Hash of netlist, device, options, seed and version.
    pub key: String,
    /// Version of nextpnr.
    pub tool: String,
    /// Seed of the placer.
    pub seed: u32,
    /// Time that it took.
    pub seconds: u64,
    /// Cells of the device by kind: used, available.
    pub used: BTreeMap<String, [u64; 2]>,
    /// End of the run.
    pub outcome: Outcome,
}

/// End of a run of nextpnr.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Outcome {
    /// The design is placed and routed.
    Placed {
        /// Clock, MHz.
        megahertz: f64,
    },
    /// The run was ended.
    OutOfTime {
        /// Minutes that it had.
        minutes: u32,
    },
    /// The design does not fit, or nextpnr fails.
    Failed {
        /// Message of nextpnr.
        reason: String,
    },
}

/// A unit of float32.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FloatUnit {
    /// Cycles from operands to the result.
    pub latency: u32,
    /// Hash of text, passes and version of Yosys.
    pub key: String,
    /// Versions of the source and of Yosys.
    pub tools: String,
    /// Cells.
    pub area: Area,
    /// Placement.
    pub placement: Placement,
}

/// A netlist in a simulator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Simulation {
    /// Hash of text, passes and version of Yosys.
    pub key: String,
    /// Versions of Yosys and of the simulator.
    pub tools: String,
    /// Vectors that were compared.
    pub vectors: u32,
    /// Message of the testbench about the first mismatch; none if all vectors are right.
    pub mismatch: Option<String>,
}

/// Path of the kept results.
pub fn file() -> PathBuf {
    workspace_root().join("vectors/hdl/floorplan.json")
}

impl Results {
    /// Reads results. A missing file has none.
    ///
    /// Errors: the file cannot be read, or is not of this form; the message names file, line and remedy.
    pub fn read(path: &Path) -> Result<Self, String> {
        let text = match fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Self::default()),
            Err(error) => return Err(format!("{}: {error}", path.display())),
        };
        serde_json::from_str(&text).map_err(|error| {
            format!("{}: {error}. Restore the file from the repository, or delete it and measure again", path.display())
        })
    }

    /// Text of the file.
    ///
    /// Errors: a number is not finite.
    pub fn text(&self) -> Result<String, String> {
        serde_json::to_string_pretty(self).map(|text| text + "\n").map_err(|e| e.to_string())
    }
}

/// Results in a file that several runs and programs change at the same time.
#[derive(Debug)]
pub struct Kept {
    path: PathBuf,
    lock: PathBuf,
}

impl Kept {
    /// Results at `path`. The file `lock` is locked while they change.
    ///
    /// Errors: the results cannot be read, or there is no folder for the lock.
    pub fn new(path: PathBuf, lock: PathBuf) -> Result<Self, String> {
        let folder = lock.parent().unwrap_or_else(|| Path::new("."));
        fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let kept = Self { path, lock };
        kept.read()?;
        Ok(kept)
    }

    /// Reads the results.
    ///
    /// Errors: those of [`Results::read`].
    pub fn read(&self) -> Result<Results, String> {
        Results::read(&self.path)
    }

    /// Changes the results as they are in the file now, and writes them.
    ///
    /// Errors: the file cannot be locked, read or written.
    pub fn change(&self, change: impl FnOnce(&mut Results)) -> Result<(), String> {
        let locked = File::create(&self.lock).and_then(|file| file.lock().map(|()| file));
        // The system ends the lock with the file.
        let _locked = locked.map_err(|e| format!("{}: {e}", self.lock.display()))?;
        let mut results = self.read()?;
        change(&mut results);
        write(&self.path, &results.text()?)
    }
}

/// Writes a file, whole or not at all.
///
/// Errors: the file cannot be written.
pub fn write(path: &Path, text: &str) -> Result<(), String> {
    let written = OutputFile::create(path).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.commit()
    });
    written.map_err(|e| format!("{}: {e}", path.display()))
}
