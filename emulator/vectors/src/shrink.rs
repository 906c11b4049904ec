//! Shrinking: the simplest inputs for which a device is still wrong in the stage in which it is wrong for a vector.
//!
//! Many simplifications of the inputs are tried at once, each as a candidate; the device's testbench compares a batch of
//! candidates in one run. Candidates that are still wrong are combined as far as possible, until no simpler candidate is wrong.

mod shape;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use thiserror::Error;

use super::VectorError;
use super::datapath::Inputs;
use super::explain::Vector;
use super::export::{SetExport, SetInfo};
use super::layout::Layout;
use super::manifest::Manifest;
use super::testbench::{Device, Testbench, TestbenchError};
use shape::{Change, Shape, bits_of, changed};

/// Candidates in a run. A testbench is compiled for a number of vectors, so every run has this many.
const BATCH: usize = 64;
/// Depth of nested folders that are copied with a testbench.
const DEPTH: u32 = 16;

/// Reason why a vector cannot be minimised.
#[derive(Debug, Error)]
pub enum ShrinkError {
    /// The set or that of the testbench cannot be read, or the result not written.
    #[error(transparent)]
    Set(#[from] VectorError),
    /// The word of the set does not follow from its inputs, so it says nothing about a device.
    #[error("{0}: the word is damaged: export the set again")]
    Damaged(String),
    /// The testbench is of other words.
    #[error(
        "{}: the testbench is of {bench} and its words have other fields than those of {set}: make one of this set with \
         `roughxel vectors bench`",
        .directory.display()
    )]
    OtherSet {
        /// Folder of the testbench.
        directory: PathBuf,
        /// The set of the testbench.
        bench: String,
        /// The set of the vector.
        set: String,
    },
    /// The testbench cannot be copied.
    #[error("cannot copy {}", .path.display())]
    Copy {
        /// The file or folder.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// The testbench cannot be written for candidates.
    #[error(transparent)]
    Testbench(#[from] TestbenchError),
    /// The shell cannot be started.
    #[error("cannot run sh for {}", .path.display())]
    Shell {
        /// The script.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// The testbench cannot make the comparison.
    #[error("{}: the testbench fails with {tool}:\n{output}", .directory.display())]
    Run {
        /// Folder of the testbench.
        directory: PathBuf,
        /// The tool.
        tool: String,
        /// The end of its output.
        output: String,
    },
}

/// Options of a run of the testbench.
#[derive(Clone, Debug)]
pub struct ShrinkOptions {
    /// What `run.sh` calls the tool.
    pub tool: String,
    /// True to compare only the outputs of the datapath, for a device that does not show its stages.
    pub outputs_only: bool,
    /// Most runs of the testbench.
    pub runs: u32,
}

/// The simplest vector that was found.
#[derive(Clone, Debug)]
pub struct Shrunk {
    /// Its set.
    set: String,
    description: String,
    manifest: Manifest,
    inputs: Inputs,
    /// Every input field that changed: name, hex digits before and after.
    pub simplified: Vec<[String; 3]>,
    /// The first wrong stage, before and after.
    pub stage: String,
    /// The device's value of each wrong field, as `FIELD=HEX`; fields with bits that are neither 0 nor 1 are left out.
    pub got: Vec<String>,
    /// Runs of the testbench.
    pub runs: u32,
    /// True if no simpler vector is wrong; false if the limit of runs was reached.
    pub is_minimal: bool,
}

impl Shrunk {
    /// Writes it as a set of one vector, `SET_min_PROFILE`, into `directory`; returns the path of its manifest.
    ///
    /// Errors: see [`VectorError`].
    pub fn write(&self, directory: &Path) -> Result<PathBuf, VectorError> {
        let info =
            SetInfo { name: &self.set, description: &self.description, seed: None, ..SetInfo::from(&self.manifest) };
        let manifest = SetExport::new(&info, 1).write(&|_: u64| self.inputs, directory, &|_| {})?;
        Ok(directory.join(manifest.stem() + ".json"))
    }
}

/// Minimises vector `index` of the set of `manifest_path` for the device in `directory`, which [`Testbench::write`] made for a set
/// with the same fields. The testbench runs in a copy below `directory/build`, which is removed afterwards. `progress` gets the
/// number of runs.
///
/// `None` where the device gets the vector right. Errors: see [`ShrinkError`].
pub fn shrink(
    manifest_path: &Path,
    index: u64,
    directory: &Path,
    options: &ShrinkOptions,
    progress: &dyn Fn(u32),
) -> Result<Option<Shrunk>, ShrinkError> {
    let vector = Vector::read(manifest_path, index)?;
    if let Some(mismatch) = vector.mismatch() {
        return Err(ShrinkError::Damaged(mismatch.to_string()));
    }
    let manifest = vector.manifest();
    if manifest.stage.is_some() {
        let problem =
            "a set of one stage; shrink a vector of its datapath, whose testbench takes the stage's module in `rtl`";
        return Err(VectorError::Manifest { path: manifest_path.into(), problem: problem.into() }.into());
    }
    let of_bench = Manifest::read(&directory.join("set.json"))?;
    if (of_bench.datapath, of_bench.effects, of_bench.taps) != (manifest.datapath, manifest.effects, manifest.taps)
        || of_bench.profile != manifest.profile
        || of_bench.stage.is_some()
    {
        let (directory, bench, set) = (directory.into(), of_bench.stem(), manifest.stem());
        return Err(ShrinkError::OtherSet { directory, bench, set });
    }
    let shape = Shape::new(vector.layout());
    let original = shape.integers(vector.bits());
    let mut runner = Runner::new(of_bench, vector.layout(), directory, options, progress)?;

    let Some(first) = runner.run(std::slice::from_ref(&original))?.swap_remove(0) else { return Ok(None) };
    let stage = first.stage.clone();
    let (mut simplest, mut wrong) = (original.clone(), first);
    let mut is_minimal = false;
    while runner.may_run() {
        let changes = shape.changes(&simplest);
        let mut good = Vec::new();
        for batch in changes.chunks(BATCH) {
            if !runner.may_run() {
                break;
            }
            let candidates: Vec<_> = batch.iter().map(|change| changed(&simplest, change)).collect();
            let outcomes = runner.run(&candidates)?.into_iter().zip(batch.iter().zip(candidates));
            good.extend(outcomes.filter_map(|(wrong, (change, candidate))| {
                let wrong = wrong.filter(|wrong| wrong.stage == stage)?;
                Some((shape.complexity(&candidate), change.clone(), candidate, wrong))
            }));
        }
        good.sort_by_key(|(complexity, ..)| *complexity);
        let Some((_, change, candidate, of_candidate)) = good.first().cloned() else {
            is_minimal = runner.may_run();
            break;
        };
        (simplest, wrong) = (candidate, of_candidate);
        // All single changes that stay wrong, combined: as many of them as are still wrong; the next change is left out.
        let (mut together, mut rest) = (change, &good[1..]);
        while !rest.is_empty() && runner.may_run() {
            let before = simplest.clone();
            let mut unions: Vec<Change> = Vec::new();
            for (_, change, ..) in rest.iter().take(BATCH) {
                let known = unions.last().unwrap_or(&together);
                let is_new = |(field, _): &&(usize, i64)| known.iter().all(|(other, _)| other != field);
                let union = known.iter().chain(change.iter().filter(is_new)).copied().collect();
                unions.push(union);
            }
            let candidates: Vec<_> = unions.iter().map(|union| changed(&before, union)).collect();
            let outcomes = runner.run(&candidates)?;
            let is_wrong = |wrong: &Option<Wrong>| wrong.as_ref().is_some_and(|wrong| wrong.stage == stage);
            let last = outcomes.iter().rposition(is_wrong);
            if let Some(last) = last {
                together.clone_from(&unions[last]);
                simplest.clone_from(&candidates[last]);
                wrong = outcomes.into_iter().nth(last).flatten().unwrap_or(wrong);
            }
            rest = &rest[rest.len().min(last.map_or(0, |last| last + 1) + 1)..];
        }
    }

    let inputs = shape.fields.iter().zip(original.iter().zip(&simplest));
    let simplified = inputs.filter(|(_, (was, is))| was != is).map(|(field, (was, is))| {
        let digits = |integer: i64| format!("{:0digits$x}", bits_of(field, integer), digits = field.digits() as usize);
        [field.name.clone(), digits(*was), digits(*is)]
    });
    Ok(Some(Shrunk {
        set: format!("{}_min", manifest.set),
        description: format!(
            "vector #{index} of {} as simple as it still goes wrong in stage {stage} of a device",
            manifest.stem()
        ),
        simplified: simplified.collect(),
        inputs: shape.inputs(manifest, &simplest),
        manifest: manifest.clone(),
        stage,
        got: wrong.got,
        runs: runner.runs,
        is_minimal,
    }))
}

/// A testbench's report of a wrong vector.
#[derive(Clone, Debug)]
struct Wrong {
    /// The earliest stage.
    stage: String,
    /// `FIELD=HEX` of each wrong field with known bits.
    got: Vec<String>,
}

/// A copy of a testbench.
struct Runner<'a> {
    of_bench: Manifest,
    shape: Shape<'a>,
    directory: &'a Path,
    copy: PathBuf,
    options: &'a ShrinkOptions,
    progress: &'a dyn Fn(u32),
    runs: u32,
}

impl Drop for Runner<'_> {
    fn drop(&mut self) {
        // The copy is below `build`, a folder for temporary files.
        let _ = fs::remove_dir_all(&self.copy);
    }
}

impl<'a> Runner<'a> {
    fn new(
        of_bench: Manifest,
        layout: &'a Layout,
        directory: &'a Path,
        options: &'a ShrinkOptions,
        progress: &'a dyn Fn(u32),
    ) -> Result<Self, ShrinkError> {
        let copy = directory.join(format!("build/shrink-{}", std::process::id()));
        let runner = Self { of_bench, shape: Shape::new(layout), directory, copy, options, progress, runs: 0 };
        copy_folder(directory, &runner.copy, DEPTH)?;
        Ok(runner)
    }

    fn may_run(&self) -> bool {
        self.runs < self.options.runs
    }

    /// What the device makes of at most [`BATCH`] candidates; `None` of those that it gets right.
    fn run(&mut self, candidates: &[Vec<i64>]) -> Result<Vec<Option<Wrong>>, ShrinkError> {
        let info = SetInfo { description: "candidates", ..SetInfo::from(&self.of_bench) };
        // A testbench has a fixed number of vectors.
        let input = |index: u64| {
            let integers = candidates.get(index as usize).unwrap_or(&candidates[0]);
            self.shape.inputs(&self.of_bench, integers)
        };
        let sets = self.copy.join("candidates");
        let manifest = SetExport::new(&info, BATCH as u64).write(&input, &sets, &|_| {})?;
        let bench = Testbench::new(&sets.join(manifest.stem() + ".json"))?;
        let is_first = self.runs == 0;
        if is_first {
            bench.write(&self.copy, Device::Blank, false)?;
        } else {
            bench.write_words(&self.copy)?;
        }
        let text = self.said(is_first)?;
        self.runs += 1;
        (self.progress)(self.runs);

        let mut outcomes: Vec<Option<Wrong>> = vec![None; candidates.len()];
        let name = bench.stem();
        for line in text.lines() {
            let Some((index, stage, field, got)) = difference(line, &name) else { continue };
            let Some(outcome) = outcomes.get_mut(index) else { continue };
            let wrong = outcome.get_or_insert_with(|| Wrong { stage: stage.into(), got: Vec::new() });
            if got.bytes().all(|c| c.is_ascii_hexdigit()) {
                wrong.got.push(format!("{field}={got}"));
            }
        }
        Ok(outcomes)
    }

    /// Output of the testbench.
    fn said(&self, compile: bool) -> Result<String, ShrinkError> {
        let script = self.copy.join("run.sh");
        let mut command = Command::new("sh");
        command.arg("run.sh").arg(&self.options.tool).args(["--stop", &(BATCH + 1).to_string()]);
        if self.options.outputs_only {
            command.arg("--outputs-only");
        }
        if !compile {
            command.arg("--built");
        }
        let output = command.current_dir(&self.copy).stdin(Stdio::null()).output();
        let output = output.map_err(|source| ShrinkError::Shell { path: script, source })?;
        let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        if matches!(output.status.code(), Some(0 | 3)) {
            return Ok(text);
        }
        let lines: Vec<&str> = text.lines().collect();
        Err(ShrinkError::Run {
            directory: self.directory.into(),
            tool: self.options.tool.clone(),
            output: lines[lines.len().saturating_sub(20)..].join("\n"),
        })
    }
}

/// Index, stage, field and hex digits of the device of a line `SET #3: stage reflect, field reflected_x: expected 1f = 31, got 2f = 47`.
fn difference<'a>(line: &'a str, set: &str) -> Option<(usize, &'a str, &'a str, &'a str)> {
    let (index, rest) = line.trim_start().strip_prefix(set)?.strip_prefix(" #")?.split_once(": stage ")?;
    let (stage, rest) = rest.split_once(", field ")?;
    let (field, rest) = rest.split_once(": expected ")?;
    let (_, got) = rest.split_once(", got ")?;
    Some((index.parse().ok()?, stage, field, got.split_whitespace().next()?))
}

/// Copies a testbench and its folders, without what was built.
fn copy_folder(from: &Path, to: &Path, depth: u32) -> Result<(), ShrinkError> {
    let error = |path: &Path| {
        let path = path.to_path_buf();
        move |source| ShrinkError::Copy { path, source }
    };
    fs::create_dir_all(to).map_err(error(to))?;
    for entry in fs::read_dir(from).map_err(error(from))? {
        let entry = entry.map_err(error(from))?;
        let (path, place) = (entry.path(), to.join(entry.file_name()));
        let metadata = fs::metadata(&path).map_err(error(&path))?;
        if metadata.is_file() {
            fs::copy(&path, &place).map_err(error(&path))?;
        } else if metadata.is_dir() && entry.file_name() != "build" && depth > 0 {
            copy_folder(&path, &place, depth - 1)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use roughxel_core::plan::{Datapath, Effects};
    use roughxel_core::precision::Precision;

    use super::shape::upper_bits;
    use super::*;
    use crate::random_set;

    #[test]
    fn upper_bits_are_those_of_the_size() {
        assert_eq!([0, 1, 2, 9].map(|kept| upper_bits(0b1011, kept)), [0, 0b1000, 0b1010, 0b1011]);
        assert_eq!((upper_bits(-0b1011, 2), upper_bits(0, 3)), (-0b1010, 0));
    }

    #[test]
    fn lines_of_benches_are_read() {
        let line = "set_narrow #3: stage reflect, field reflected_x: expected 1f = 31, got 2f = 47";
        assert_eq!(difference(line, "set_narrow"), Some((3, "reflect", "reflected_x", "2f")));
        assert_eq!(difference(line, "other"), None);
        assert_eq!(difference("FAIL set_narrow: 3 of 64 vectors differ", "set_narrow"), None);
    }

    #[test]
    fn every_change_is_simpler_and_can_be_exported() {
        for datapath in Datapath::ALL {
            let p = Precision::STANDARD;
            let layout = Layout::new(datapath, &Effects::ALL.restricted_to(datapath), &p, true);
            let shape = Shape::new(&layout);
            for index in 0..20 {
                let ports = random_set(datapath, "test", index, &p).integers();
                let integers = shape.integers(&layout.input_bits(&ports).unwrap());
                let changes = shape.changes(&integers);
                assert!(changes.len() > BATCH);
                for change in changes {
                    let candidate = changed(&integers, &change);
                    assert!(shape.complexity(&candidate) < shape.complexity(&integers));
                    assert!((0..candidate.len()).all(|place| layout.allows(place, candidate[place])));
                    let bits: Vec<u32> =
                        shape.fields.iter().zip(&candidate).map(|(field, &integer)| bits_of(field, integer)).collect();
                    assert_eq!(shape.integers(&bits), candidate);
                }
            }
        }
    }

    #[test]
    fn nothing_is_simpler_than_zero() {
        let layout = Layout::new(Datapath::Peak, &Effects::ALL.restricted_to(Datapath::Peak), &Precision::NARROW, true);
        let shape = Shape::new(&layout);
        assert!(shape.changes(&vec![0; shape.fields.len()]).is_empty());
    }
}
