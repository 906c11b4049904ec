//! Testbenches that compare a device with a set in Icarus, Verilator (SystemVerilog or C++), GHDL and cocotb.
//!
//! The texts are the files of `vectors/templates`, with `@NAMES@` in the places that depend on the set. All values come from the
//! fields of the manifest; each language has a file. Outputs are in the order in which the stages run.

mod cocotb;
mod cpp;
mod fields;
mod systemverilog;
mod vhdl;

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use roughxel_core::design::Design;
use roughxel_netlist::bench::BenchError;
use roughxel_netlist::target::Target;
use roughxel_netlist::verilog::{Interface, Options, Stage, Verilog, VerilogError, filled};
use roughxel_record as record;
use roughxel_utilities::input::open_file;
use roughxel_utilities::output::{OutputFile, WriteError, write_files};
use thiserror::Error;

use super::VectorError;
use super::c_library::c_library_files;
use super::field::{Direction, Field};
use super::lines::is_whole;
use super::manifest::Manifest;
use super::order::{misplaced, with_cause};
use super::shell::{BenchFiles, shell_bench};
use fields::{Fields, identifier};

/// Script that runs the testbench in any of the tools, with the name of its file.
const RUN: (&str, &str) = ("run.sh", include_str!("../../../vectors/templates/run.sh"));

/// The page of a directory of testbenches.
pub const TESTBENCH_README: &str = include_str!("../../../vectors/templates/benches.md");

/// Form of generated Verilog; without anything it is flat, for gates and without a shell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HardwareForm {
    /// Multipliers on which the design is folded.
    pub multipliers: Option<u32>,
    /// Device for which levels are counted.
    pub target: Target,
    /// Bits of the words of a shell, through which the testbench drives the design.
    pub stream: Option<u32>,
}

/// Device that the SystemVerilog testbench drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Device {
    /// The generated Verilog of the set's datapath or stage, effects and profile, in `rtl`.
    Generated,
    /// The generated Verilog of the set's datapath in a form of its own.
    Formed(HardwareForm),
    /// A skeleton with a line per field.
    Blank,
}

/// Reason why there is no testbench.
#[derive(Debug, Error)]
pub enum TestbenchError {
    /// The set cannot be read.
    #[error(transparent)]
    Set(#[from] VectorError),
    /// The words are not those of the manifest.
    #[error(
        "{}: its SHA-256 is not the one in {}{order}; the file was changed: export the set again (`roughxel vectors verify` says which \
         words differ)",
        .words.display(), .manifest.display()
    )]
    Damaged {
        /// The hex file.
        words: PathBuf,
        /// The manifest.
        manifest: PathBuf,
        /// Words that are out of order; begins with a semicolon.
        order: String,
    },
    /// The generated Verilog has other ports than the set has fields.
    #[error("{}: {problem}; `--device blank` makes a testbench with an empty device", .manifest.display())]
    Ports {
        /// The manifest.
        manifest: PathBuf,
        /// The differing ports.
        problem: String,
    },
    /// The datapath cannot be written as Verilog under the set's profile.
    #[error("no Verilog for {}", .manifest.display())]
    Verilog {
        /// The manifest.
        manifest: PathBuf,
        /// The error of the Verilog.
        source: VerilogError,
    },
    /// The shell has no testbench of its own.
    #[error("no testbench of the shell for {}", .manifest.display())]
    Bench {
        /// The manifest.
        manifest: PathBuf,
        /// The error of the testbench.
        source: BenchError,
    },
    /// A form of a whole datapath for a set of one stage.
    #[error("{}: a stage is combinational, so it is not folded and has no shell", .0.display())]
    StageForm(PathBuf),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// The testbench of one set.
#[derive(Clone, Debug)]
pub struct Testbench {
    manifest: Manifest,
    manifest_path: PathBuf,
    words_path: PathBuf,
    fields: Fields,
    /// The module of the stage, if the set is of a stage.
    stage: Option<Interface>,
}

impl Testbench {
    /// Reads the manifest of a set and checks the hash of its words.
    ///
    /// Errors: the set cannot be read or its name is no file name, or its words are damaged. Nothing is written.
    pub fn new(manifest_path: &Path) -> Result<Self, TestbenchError> {
        let manifest = Manifest::read(manifest_path)?;
        let good = |c: u8| c.is_ascii_lowercase() || c.is_ascii_digit() || c == b'_';
        if !(1..=64).contains(&manifest.set.len()) || !manifest.set.bytes().all(good) {
            return Err(VectorError::Name(manifest.set).into());
        }
        if let Some(part) = manifest.part {
            let problem = format!(
                "it is part {} of {} of a set; testbenches are of whole ones: join the parts with `roughxel vectors merge`",
                part.number, part.of
            );
            return Err(VectorError::Manifest { path: manifest_path.into(), problem }.into());
        }
        let missing = || VectorError::Manifest {
            path: manifest_path.into(),
            problem: "lists no file of words (NAME.hex), which simulators read; export the set again without --bin"
                .into(),
        };
        let entry = manifest.files.iter().find(|file| file.name.ends_with(".hex")).ok_or_else(missing)?;
        let words_path = manifest_path.with_file_name(&entry.name);
        let layout = manifest.layout(manifest_path)?;
        let is_whole = is_whole(manifest_path, &manifest, &layout);
        if !is_whole.map_err(|error| with_cause(error, manifest_path, &manifest, &layout))? {
            let order = misplaced(manifest_path, &manifest, &layout);
            return Err(TestbenchError::Damaged {
                words: words_path,
                manifest: manifest_path.into(),
                order: order.iter().map(|misplaced| format!("; {misplaced}")).collect(),
            });
        }

        let fields = |wanted: &[Direction]| -> Vec<(usize, Field)> {
            let of = manifest.fields.iter().enumerate().filter(|(_, field)| wanted.contains(&field.direction));
            of.map(|(index, field)| (layout.rank(index), field.clone())).collect()
        };
        let inputs = fields(&[Direction::In]);
        let mut outputs = fields(&[Direction::Tap, Direction::Out]);
        // A stage that is off passes its input on: its field counts as a field of the next stage.
        for index in (1..outputs.len()).rev() {
            if outputs[index - 1].0 == usize::MAX {
                outputs[index - 1].0 = outputs[index].0;
            }
        }
        // The fields of a stage stay in the word's order.
        outputs.sort_by_key(|(rank, _)| *rank);
        let [inputs, outputs] = [inputs, outputs].map(|fields| fields.into_iter().map(|(_, field)| field).collect());
        let stage = layout.stage().map(Stage::interface);
        let fields = Fields { inputs, outputs };
        Ok(Self { manifest, manifest_path: manifest_path.into(), words_path, fields, stage })
    }

    /// Set and profile, as in the names of the set's files: the folder of the testbench.
    pub fn stem(&self) -> String {
        format!("{}_{}", self.manifest.set, self.manifest.profile.name)
    }

    /// Vectors of the set.
    pub fn count(&self) -> u64 {
        self.manifest.count
    }

    /// Writes the testbench into `directory`, which is made if it does not exist. Existing devices stay, unless `replace`; their
    /// names are returned.
    ///
    /// Errors: the Verilog cannot be made or has other ports than the set, in which case nothing is written; or a file cannot be
    /// written.
    pub fn write(&self, directory: &Path, device: Device, replace: bool) -> Result<Vec<String>, TestbenchError> {
        let verilog = match device {
            Device::Generated => Some(self.verilog(HardwareForm::default())?),
            Device::Formed(form) if self.stage.is_none() => Some(self.verilog(form)?),
            Device::Formed(_) => return Err(TestbenchError::StageForm(self.manifest_path.clone())),
            Device::Blank => None,
        };
        let (verilog, bench) = verilog.unzip();
        let values = self.values(verilog.as_ref())?;
        let name = self.name();
        let devices = [systemverilog::DEVICE, vhdl::DEVICE].map(|file| file.replace("@NAME@", &name));
        let kept: Vec<String> = devices.into_iter().filter(|file| !replace && directory.join(file).exists()).collect();

        let rtl = verilog.iter().flat_map(Verilog::in_order);
        write_files(directory, rtl.map(|(file, text)| (format!("rtl/{file}"), text)))?;
        let bench = bench.into_iter().flatten();
        write_files(directory, bench.map(|(file, bytes)| (format!("rtl/{file}"), bytes)))?;
        let dpi = if self.stage.is_none() { &systemverilog::DPI[..] } else { &[] };
        let languages = [&systemverilog::TEMPLATES[..], &vhdl::TEMPLATES, &cpp::TEMPLATES, &cocotb::TEMPLATES, dpi];
        let texts = languages.concat().into_iter().chain([RUN]);
        let texts = texts.map(|(file, text)| (file.replace("@NAME@", &name), filled(text, &values)));
        write_files(directory, texts.filter(|(file, _)| !kept.contains(file)))?;
        if self.stage.is_none() {
            write_files(directory, c_library_files())?;
        }
        self.write_words(directory)?;
        Ok(kept)
    }

    /// Writes words and manifest alone, into a testbench for the same number of vectors of the same fields.
    ///
    /// Errors: a file cannot be read or written.
    pub(super) fn write_words(&self, directory: &Path) -> Result<(), TestbenchError> {
        let files = [(&self.words_path, "words.hex"), (&self.manifest_path, "set.json")];
        files.into_iter().try_for_each(|(from, to)| copy(from, &directory.join(to)))
    }

    /// The stem as a name in SystemVerilog, VHDL and Python.
    fn name(&self) -> String {
        identifier(&self.stem())
    }

    /// The Verilog of the set's datapath or stage, with the set's effects and profile, and the files of its shell's own testbench.
    fn verilog(&self, form: HardwareForm) -> Result<(Verilog, BenchFiles), TestbenchError> {
        let Manifest { datapath, effects, profile, .. } = &self.manifest;
        let stage = self.stage.as_ref().map(|stage| stage.module.clone());
        let HardwareForm { multipliers, target, stream } = form;
        let options = Options::new(&profile.name, profile.knobs, *effects);
        let options = Options { stage, multipliers, target, stream, ..options };
        let error = |source| TestbenchError::Verilog { manifest: self.manifest_path.clone(), source };
        let design = Design::for_datapath(*datapath);
        let verilog = record::verilog(design, &options).map_err(error)?;
        let bench = shell_bench(design, &options, &verilog);
        let bench = bench.map_err(|source| TestbenchError::Bench { manifest: self.manifest_path.clone(), source })?;
        Ok((verilog, bench))
    }

    /// Value of each `@NAME@`.
    ///
    /// Errors: the Verilog has other ports than the set.
    fn values(&self, verilog: Option<&Verilog>) -> Result<Vec<(&'static str, String)>, TestbenchError> {
        let (stem, Self { manifest, fields, .. }) = (self.stem(), self);
        let bits = |fields: &[Field]| fields.iter().map(|field| field.width).sum::<u32>().to_string();
        let entry = manifest.files.iter().find(|file| file.name.ends_with(".hex"));
        let of_all = vec![
            ("NAME", self.name()),
            ("SET", stem.clone()),
            ("COUNT", manifest.count.to_string()),
            ("WORD_BITS", manifest.word_bits.to_string()),
            ("INPUT_BITS", bits(&fields.inputs)),
            ("OUTPUT_BITS", bits(&fields.outputs)),
            ("SHA256", entry.map_or_else(String::new, |file| file.sha256.clone())),
        ];
        let module = verilog.and_then(|verilog| self.stage.as_ref().or(verilog.driven()));
        let error = |problem| TestbenchError::Ports { manifest: self.manifest_path.clone(), problem };
        let device = systemverilog::device(fields, manifest, module).map_err(error)?;
        let texts = systemverilog::values(fields, manifest, &stem);
        Ok([of_all, texts, device, vhdl::values(fields), cpp::values(fields), cocotb::values(fields)].concat())
    }
}

/// Copies a file; the copy appears whole or not at all.
fn copy(from: &Path, to: &Path) -> Result<(), TestbenchError> {
    let mut source = open_file(from).map_err(|source| VectorError::Io { action: "read", path: from.into(), source })?;
    let write = |source: &mut File| {
        let mut file = OutputFile::create(to)?;
        io::copy(source, &mut file)?;
        file.commit()
    };
    Ok(write(&mut source).map_err(|source| WriteError { path: to.into(), source })?)
}
