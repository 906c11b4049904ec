//! The device compiled by Verilator, and its run on a frame.

use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use roughxel_frame::Frame;
use roughxel_utilities::output::{WriteError, write_files};
use thiserror::Error;

use crate::device::{Device, TOP};
use crate::job::Job;

const MAIN: &str = include_str!("templates/main.cpp");

/// Reason why there are no pixels.
#[derive(Debug, Error)]
pub enum ModelError {
    /// A program that cannot be started.
    #[error(
        "{program} cannot be started: {source}; install Verilator 5 (`apt-get install verilator`, or verilator.org) and a C++ compiler"
    )]
    Missing {
        /// Name of the program.
        program: String,
        /// Reason.
        source: io::Error,
    },
    /// Verilator or the compiler fails.
    #[error("Verilator fails; {log} says why:\n{end}")]
    Build {
        /// File with everything that was printed.
        log: String,
        /// Last lines of it.
        end: String,
    },
    /// The model ends without all pixels.
    #[error("the device does not finish the frame: {0}")]
    Run(String),
    /// A file that cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// Path of the file.
        path: String,
        /// Reason.
        source: io::Error,
    },
    /// A file that cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Counts of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Figures {
    /// Cycles from the first fragment to the last pixel.
    pub cycles: u64,
    /// Fragments.
    pub fragments: u64,
    /// Probes.
    pub probes: u64,
    /// Bilinear samples: one or two a probe.
    pub samples: u64,
    /// Requests of the cache, one or two texels each.
    pub requests: u64,
    /// Bursts of the memory, 16 texels each.
    pub bursts: u64,
}

impl Figures {
    /// Share of requests whose texels the cache held.
    pub fn hit_rate(&self) -> f64 {
        1.0 - self.bursts as f64 / self.requests.max(1) as f64
    }

    /// Count for each fragment.
    pub fn for_each_fragment(&self, count: u64) -> f64 {
        count as f64 / self.fragments.max(1) as f64
    }

    fn set(&mut self, name: &str, value: u64) {
        match name {
            "cycles" => self.cycles = value,
            "fragments" => self.fragments = value,
            "probes" => self.probes = value,
            "samples" => self.samples = value,
            "requests" => self.requests = value,
            "bursts" => self.bursts = value,
            _ => {}
        }
    }
}

/// A device compiled by Verilator.
pub struct Model {
    program: PathBuf,
}

/// Reads a file, or says which one is missing.
fn read(path: &Path) -> Result<Vec<u8>, ModelError> {
    std::fs::read(path).map_err(|source| ModelError::Read { path: path.display().to_string(), source })
}

impl Model {
    /// Writes a device below a directory, in `rtl`, and compiles it with `optimisation` (`-O1`). `log.txt` there has all that Verilator prints.
    ///
    /// Errors: Verilator is missing or fails, or a file cannot be written.
    pub fn build(device: &Device, directory: &Path, optimisation: &str) -> Result<Self, ModelError> {
        Self::build_with(device, directory, optimisation, |_| ())
    }

    /// Compiles a device like [`Self::build`], with a command that `prepare` changes.
    pub fn build_with(
        device: &Device,
        directory: &Path,
        optimisation: &str,
        prepare: impl FnOnce(&mut Command),
    ) -> Result<Self, ModelError> {
        write_files(directory, [("main.cpp", MAIN)])?;
        // The compiler runs in a directory of its own.
        let whole = std::fs::canonicalize(directory);
        let directory = &whole.map_err(|source| ModelError::Read { path: directory.display().to_string(), source })?;
        let (rtl, objects) = (directory.join("rtl"), directory.join("obj"));
        write_files(&rtl, device.files.iter().map(|(name, text)| (name.as_str(), text.as_str())))?;
        // Verilator compiles the model again if it is there already, but not that of an older device.
        let _ = std::fs::remove_dir_all(&objects);
        let program = objects.join("simulate");
        let mut command = Command::new("verilator");
        command.args(["--cc", "--exe", "--build", "-j", "0", "-O3", "--x-assign", "fast", "--x-initial", "fast"]);
        command.args([
            "-Wall",
            "--prefix",
            "Vroughxel_frame",
            "-CFLAGS",
            "-std=c++17",
            "--top-module",
            TOP,
            "-MAKEFLAGS",
        ]);
        command.arg(format!("OPT_FAST={optimisation} OPT_SLOW=-O0 OPT_GLOBAL=-O1")).arg("--Mdir").arg(&objects);
        command
            .arg("-y")
            .arg(&rtl)
            .arg("-o")
            .arg(&program)
            .arg(rtl.join(format!("{TOP}.v")))
            .arg(directory.join("main.cpp"));
        prepare(&mut command);
        let output = command.output().map_err(|source| ModelError::Missing { program: "verilator".into(), source })?;
        let printed = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
        write_files(directory, [("log.txt", printed.as_str())])?;
        if !output.status.success() {
            let log = directory.join("log.txt").display().to_string();
            let lines: Vec<_> = printed.lines().collect();
            return Err(ModelError::Build { log, end: lines[lines.len().saturating_sub(12)..].join("\n") });
        }
        Ok(Self { program })
    }

    /// Runs the device on a frame, with a memory whose first texel of a burst comes `latency` cycles after the request. Files of the job are written
    /// to `directory`. `progress` is called with the number of finished pixels.
    ///
    /// Errors: the device hangs or gives a pixel twice, or a file cannot be read or written.
    pub fn run(
        &self,
        job: &Job,
        directory: &Path,
        latency: u32,
        progress: &dyn Fn(u64),
    ) -> Result<(Frame, Figures), ModelError> {
        let files = job.files();
        write_files(directory, files.iter().map(|(name, content)| (*name, content.as_slice())))?;
        let program = self.program.display().to_string();
        let missing = |source| ModelError::Missing { program: program.clone(), source };
        let mut command = Command::new(&self.program);
        command.arg(directory).arg(latency.to_string()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().map_err(missing)?;
        let mut figures = Figures::default();
        if let Some(stdout) = child.stdout.take() {
            for line in BufReader::new(stdout).lines().map_while(Result::ok) {
                let Some((name, value)) = line.split_once(' ') else { continue };
                let Ok(value) = value.parse() else { continue };
                if name == "progress" {
                    progress(value);
                } else {
                    figures.set(name, value);
                }
            }
        }
        let mut complaint = String::new();
        if let Some(mut stderr) = child.stderr.take() {
            // What cannot be read is not told.
            let _ = stderr.read_to_string(&mut complaint);
        }
        if !child.wait().map_err(missing)?.success() {
            return Err(ModelError::Run(complaint.trim().to_owned()));
        }
        let bytes = read(&directory.join("pixels.bin"))?;
        let words = bytes.as_chunks().0.iter().map(|word| i32::from_le_bytes(*word));
        let words: Vec<i32> = words.collect();
        let pixels = words.as_chunks().0.to_vec();
        if pixels.len() != job.pixels() {
            return Err(ModelError::Run(format!("{} pixels of {}", pixels.len(), job.pixels())));
        }
        let [width, height] = job.size;
        Ok((Frame { width, height, pixels }, figures))
    }
}
