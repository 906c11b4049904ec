//! `roughxel vectors export|verify|explain|bench|list|format|rom|c`.

use std::error::Error;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use miette::{Context, IntoDiagnostic};
use roughxel_core::plan::{Datapath, Effects, FrameSystem};
use roughxel_core::precision::{Precision, Profile};
use roughxel_emulator::input::open_file;
use roughxel_emulator::output::{OutputFile, write_files};
use roughxel_emulator::study::profile_file::NamedPrecision;
use roughxel_emulator::vectors::{
    Form, Inputs, MAX_VECTORS, Manifest, RANDOM_SETS, SetInfo, VectorError, VectorSet, Verification, Words,
    c_library_files, export_with, hard_sets, in_page, manifests_of, random_set, rom_files, tables, verify,
};
use serde_json::json;

use super::bench::{self, BenchArgs};
use super::console::{complain, new_table, progress};
use super::{CONVENTIONS, Failure, ProfileArg, check_directory, effects, explain, on_one_line, parse_profile};

/// Vectors of a smoke set of reflections, of lights, and of the random ones, at most.
const SMOKE_REFLECTIONS: u64 = 1000;
const SMOKE_LIGHTS: u64 = 200;
const SMOKE_RANDOM: u64 = 256;

#[derive(Subcommand)]
pub(super) enum VectorsCommand {
    /// Write sets of vectors: packed hex and a JSON manifest each.
    #[command(after_help = CONVENTIONS)]
    Export(ExportArgs),
    /// Recompute every value of sets and compare; name set, index, stage, field and bit of each difference.
    #[command(after_help = CONVENTIONS)]
    Verify(VerifyArgs),
    /// Explain one vector: every field stage by stage beside float64, and where a device's word goes wrong first.
    #[command(long_about = explain::LONG_HELP, after_help = CONVENTIONS)]
    Explain(explain::ExplainArgs),
    /// Write benches that compare a device with sets: SystemVerilog, VHDL, cocotb, a Verilator driver.
    #[command(long_about = bench::LONG_HELP, after_help = CONVENTIONS)]
    Bench(BenchArgs),
    /// List the sets that can be exported.
    List(ListArgs),
    /// Print the tables of fields in vectors/FORMAT.md, as the datapaths declare their ports.
    #[command(long_about = FORMAT_HELP)]
    Format(FormatArgs),
    /// Write the tables of the arithmetic, a hex file each, as vectors/SPEC.md describes them.
    #[command(after_help = CONVENTIONS)]
    Rom(RomArgs),
    /// Write the header of the C library and its SystemVerilog package of DPI-C imports, as the datapaths declare their ports.
    #[command(after_help = CONVENTIONS)]
    C(CArgs),
}

const FORMAT_HELP: &str = "\
Print the tables of fields in vectors/FORMAT.md, as the datapaths declare their ports.

A row is a declared field of a datapath: its columns in a word, the path of its port, direction,
stage, format, unit, what it is. Formats: I signed, U unsigned, bits before the point, F bits behind
it; p is the profile's fraction_bits, l its lod_bits.

Exit codes: 0 done, 1 the page cannot be read or written, or has no place for the tables, 2 usage.";

#[derive(Args)]
pub(super) struct ExportArgs {
    /// Sets, as `vectors list` names them; none is all.
    #[arg(value_name = "SET")]
    sets: Vec<String>,
    /// Directory; made if it is not there.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Profile: a name, or a file (TOML).
    #[arg(long, default_value = "standard", value_parser = parse_profile, value_name = "NAME|FILE")]
    profile: ProfileArg,
    /// Effects that are on instead of those that each set is made for. The fields of a set are those of its effects.
    #[arg(long, value_parser = effects::parse, value_name = "LIST", long_help = effects::HELP)]
    effects: Option<Effects>,
    /// How the tangent frame is found, instead of the way each set is made for.
    #[arg(long, value_parser = effects::parse_frame, value_name = "main|natural|natural-normalised")]
    frame: Option<FrameSystem>,
    /// Sets of the datapaths that the objects of a scene call for, with their effects, in DIR/OBJECT/DATAPATH: scene file
    /// (TOML), or the name of a built-in scene.
    #[arg(long, value_name = "SCENE", conflicts_with_all = ["effects", "frame"])]
    scene: Option<String>,
    /// Vectors of each random set.
    #[arg(long, default_value_t = 1000, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=MAX_VECTORS))]
    count: u64,
    /// Other random sets than the published ones, which are seed 0.
    #[arg(long, default_value_t = 0, value_name = "N")]
    seed: u64,
    /// The smoke sets kept in the repository: hard cases and 256 random vectors of each datapath under `standard`, 256
    /// random vectors of each under `compact` and `narrow`.
    #[arg(long, conflicts_with_all = ["sets", "profile", "count", "seed", "effects", "frame", "scene"])]
    smoke: bool,
    /// Words as records of bytes, NAME.bin, for programs, instead of as text, NAME.hex, for simulators.
    #[arg(long, conflicts_with = "smoke")]
    bin: bool,
    /// Inputs and outputs only, without the outcomes of stages between them.
    #[arg(long, conflicts_with = "smoke")]
    no_taps: bool,
    /// Summary as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
pub(super) struct VerifyArgs {
    /// Directories of sets, or single ones (NAME.json, NAME.hex or NAME.bin).
    #[arg(required = true, value_name = "DIR|MANIFEST")]
    paths: Vec<PathBuf>,
    /// Result as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
pub(super) struct ListArgs {
    /// List as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
pub(super) struct FormatArgs {
    /// Put the tables into this page instead, between its marks; the page is replaced whole or not at all.
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
}

#[derive(Args)]
pub(super) struct RomArgs {
    /// Directory; made if it is not there.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

#[derive(Args)]
pub(super) struct CArgs {
    /// Directory; made if it is not there.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

pub(super) fn run(command: &VectorsCommand) -> Result<(), Failure> {
    match command {
        VectorsCommand::Format(args) => format(args),
        VectorsCommand::Rom(args) => rom(args),
        VectorsCommand::C(args) => c(args),
        VectorsCommand::Export(args) => export(args),
        VectorsCommand::Verify(args) => verify_all(args),
        VectorsCommand::Explain(args) => explain::run(args),
        VectorsCommand::Bench(args) => bench::run(args),
        VectorsCommand::List(args) => list(args),
    }
}

/// What is exported of the listed sets, and how.
struct Export<'a> {
    profile: &'a NamedPrecision,
    /// Effects instead of those of each set.
    effects: Option<Effects>,
    frame: Option<FrameSystem>,
    words: Words,
    directory: &'a Path,
}

impl Export<'_> {
    /// The effects of a set.
    fn effects(&self, of_set: Effects) -> Effects {
        let frame = self.frame.unwrap_or(of_set.frame);
        Effects { frame, ..self.effects.unwrap_or(of_set) }
    }

    /// `most` vectors of a set of hard cases, evenly spread.
    fn cases(&self, set: &VectorSet, most: u64) -> Result<Manifest, VectorError> {
        let all = set.cases.count();
        let count = most.min(all);
        if count < all {
            complain(&format!("note: {} has {all} vectors, {count} of them are written", set.name));
        }
        let info = self.info(set.name, set.description, None, set.cases.datapath(), set.effects);
        self.write(&info, count, &|index| set.cases.inputs(index * all / count))
    }

    /// A random set.
    fn random(&self, datapath: Datapath, count: u64, seed: u64) -> Result<Manifest, VectorError> {
        let (name, _, description) = RANDOM_SETS[datapath as usize];
        let seed = if seed == 0 { name.to_owned() } else { format!("{name}+{seed}") };
        let info = self.info(name, description, Some(&seed), datapath, Effects::ALL);
        self.write(&info, count, &|index| random_set(datapath, &seed, index, &self.profile.precision))
    }

    fn info<'b>(
        &'b self,
        name: &'b str,
        description: &'b str,
        seed: Option<&'b str>,
        datapath: Datapath,
        effects: Effects,
    ) -> SetInfo<'b> {
        let NamedPrecision { name: profile, precision, .. } = self.profile;
        let effects = self.effects(effects);
        SetInfo { name, description, seed, datapath, effects, precision: *precision, profile, words: self.words }
    }

    fn write(
        &self,
        info: &SetInfo<'_>,
        count: u64,
        input: &(dyn Fn(u64) -> Inputs + Sync),
    ) -> Result<Manifest, VectorError> {
        let bar = progress(count, info.name);
        let manifest = export_with(info, count, input, self.directory, &|done| bar.set_position(done));
        bar.finish_and_clear();
        manifest
    }
}

fn export(args: &ExportArgs) -> Result<(), Failure> {
    let mut written = Vec::new();
    let ExportArgs { effects, frame, output, .. } = args;
    check_directory(output)?;
    let profile = &args.profile.open()?;
    let words = Words { taps: !args.no_taps, form: if args.bin { Form::Bin } else { Form::Hex } };
    let export = Export { profile, effects: *effects, frame: *frame, words, directory: output };
    if args.smoke {
        smoke(output, &mut written)?;
    } else if let Some(scene) = &args.scene {
        for object in effects::planned_objects(scene, &profile.precision)? {
            for (datapath, effects) in object.plan.datapaths() {
                let directory = output.join(&object.directory).join(datapath.name());
                let export =
                    Export { effects: Some(effects), frame: Some(effects.frame), directory: &directory, ..export };
                chosen(args, &export, |of| of == datapath, &mut written)?;
            }
        }
        if written.is_empty() {
            complain("no object of the scene reflects or shines, so there are no vectors");
        }
    } else {
        chosen(args, &export, |_| true, &mut written)?;
    }
    let mut out = io::stdout().lock();
    if args.json {
        let sets: Vec<_> = written.iter().map(|(_, manifest)| summary(manifest)).collect();
        writeln!(out, "{:#}", json!({ "directory": output.display().to_string(), "sets": sets }))?;
    } else {
        let mut table = new_table(["set", "datapath", "profile", "vectors", "bits a word", "file"]);
        for (directory, manifest) in &written {
            let Manifest { set, datapath, profile, count, word_bits, files, .. } = manifest;
            let file = directory.strip_prefix(output).unwrap_or(directory).join(&files[0].name);
            let [count, bits, file] = [count.to_string(), word_bits.to_string(), file.display().to_string()];
            table.add_row([set.as_str(), datapath.name(), &profile.name, &count, &bits, &file]);
        }
        writeln!(out, "{table}")?;
    }
    Ok(())
}

/// Sets that were written, with their directories.
type Written = Vec<(PathBuf, Manifest)>;

/// The sets of the command line, of the wanted datapaths.
fn chosen(
    args: &ExportArgs,
    export: &Export<'_>,
    of: impl Fn(Datapath) -> bool,
    written: &mut Written,
) -> Result<(), Failure> {
    let cases = hard_sets(&export.profile.precision);
    let names = || cases.iter().map(|set| set.name).chain(RANDOM_SETS.map(|(name, ..)| name));
    if let Some(unknown) = args.sets.iter().find(|wanted| !names().any(|name| name == wanted.as_str())) {
        let names: Vec<_> = names().collect();
        return Err(Failure::Usage(format!("set `{unknown}` is unknown; there are {}", names.join(", "))));
    }
    let wanted = |name: &str| args.sets.is_empty() || args.sets.iter().any(|set| set == name);
    let mut add = |manifest| written.push((export.directory.to_path_buf(), manifest));
    for set in cases.iter().filter(|set| wanted(set.name) && of(set.cases.datapath())) {
        add(export.cases(set, MAX_VECTORS)?);
    }
    for (_, datapath, _) in RANDOM_SETS.iter().filter(|(name, datapath, _)| wanted(name) && of(*datapath)) {
        add(export.random(*datapath, args.count, args.seed)?);
    }
    Ok(())
}

/// The sets kept in the repository.
fn smoke(directory: &Path, written: &mut Written) -> Result<(), Failure> {
    let mut add = |manifest| written.push((directory.to_path_buf(), manifest));
    for named in [Profile::Standard, Profile::Compact, Profile::Narrow] {
        let profile = &named.into();
        let export = Export { profile, effects: None, frame: None, words: Words::default(), directory };
        for set in hard_sets(&profile.precision).iter().filter(|_| named == Profile::Standard) {
            let is_reflection = set.cases.datapath() == Datapath::Reflection;
            add(export.cases(set, if is_reflection { SMOKE_REFLECTIONS } else { SMOKE_LIGHTS })?);
        }
        for datapath in Datapath::ALL {
            add(export.random(datapath, SMOKE_RANDOM, 0)?);
        }
    }
    Ok(())
}

fn summary(manifest: &Manifest) -> serde_json::Value {
    let Manifest { set, profile, count, word_bits, files, .. } = manifest;
    json!({ "set": set, "profile": profile.name, "count": count, "word_bits": word_bits, "files": files })
}

fn verify_all(args: &VerifyArgs) -> Result<(), Failure> {
    let (mut results, mut broken) = (Vec::new(), Vec::new());
    for path in &args.paths {
        match manifests_of(path) {
            Ok(manifests) => {
                for manifest in manifests {
                    match verify_one(&manifest) {
                        Ok(result) => results.push((manifest, result)),
                        Err(error) => broken.push(error),
                    }
                }
            }
            Err(error) => broken.push(error),
        }
    }

    let mut out = io::stdout().lock();
    if args.json {
        let sets = results.iter().map(|(path, result)| {
            json!({ "manifest": path.display().to_string(), "passed": result.passed(), "result": result })
        });
        let errors: Vec<_> = broken.iter().map(with_causes).collect();
        writeln!(out, "{:#}", json!({ "sets": sets.collect::<Vec<_>>(), "errors": errors }))?;
    } else {
        for (path, result) in &results {
            describe(&mut out, path, result)?;
        }
    }
    out.flush()?;

    let failed = results.iter().filter(|(_, result)| !result.passed()).count();
    // A set that cannot be read outranks one that differs: the run is not complete.
    let total = results.len() + broken.len();
    if let Some(last) = broken.pop() {
        for error in broken {
            complain(&format!("error: {}", with_causes(&error)));
        }
        return Err(last.into());
    }
    if failed > 0 {
        return Err(Failure::Mismatch(format!("{failed} of {total} sets differ")));
    }
    Ok(())
}

fn verify_one(manifest: &Path) -> Result<Verification, VectorError> {
    let count = Manifest::read(manifest)?.count;
    let bar = progress(count, &manifest.display().to_string());
    let result = verify(manifest, &|done| bar.set_position(done));
    bar.finish_and_clear();
    result
}

fn with_causes(error: &VectorError) -> String {
    on_one_line(std::iter::successors(Some(error as &(dyn Error + 'static)), |&error| error.source()))
}

fn describe(out: &mut impl Write, path: &Path, result: &Verification) -> io::Result<()> {
    let Verification { set, profile, count, hash_matches, mismatching, mismatches } = result;
    if result.passed() {
        return writeln!(out, "ok       {set} ({profile}): {count} vectors");
    }
    let hash = if *hash_matches { "the file's SHA-256 is right" } else { "the file's SHA-256 differs, too" };
    match mismatching {
        0 => writeln!(
            out,
            "differs  {set} ({profile}): every vector is right, but the SHA-256 of the file is not the one in {}",
            path.display()
        )?,
        n => writeln!(out, "differs  {set} ({profile}): {n} of {count} vectors; {hash}")?,
    }
    for mismatch in mismatches {
        writeln!(out, "  {mismatch}")?;
    }
    let described = mismatches.len() as u64;
    if *mismatching > described {
        writeln!(out, "  and {} more", mismatching - described)?;
    }
    Ok(())
}

fn list(args: &ListArgs) -> Result<(), Failure> {
    let cases = hard_sets(&Precision::STANDARD);
    let rows = cases.iter().map(|set| (set.name, set.cases.datapath(), set.cases.count().to_string(), set.description));
    let random = RANDOM_SETS.map(|(name, datapath, description)| (name, datapath, "--count".to_owned(), description));
    let rows = rows.chain(random);
    let mut out = io::stdout().lock();
    if args.json {
        let sets = rows.map(|(set, datapath, count, description)| {
            let count = count.parse::<u64>().ok();
            json!({ "set": set, "datapath": datapath.name(), "count": count, "description": description })
        });
        writeln!(out, "{:#}", json!(sets.collect::<Vec<_>>()))?;
    } else {
        let mut table = new_table(["set", "datapath", "vectors", "what"]);
        for (set, datapath, count, description) in rows {
            table.add_row([set, datapath.name(), &count, description]);
        }
        writeln!(out, "{table}")?;
    }
    Ok(())
}

fn format(args: &FormatArgs) -> Result<(), Failure> {
    let Some(path) = &args.write else {
        return Ok(io::stdout().lock().write_all(tables().as_bytes())?);
    };
    let failed = |what: &str| format!("cannot {what} {}", path.display());
    let page = open_file(path).and_then(io::read_to_string);
    let page = page.into_diagnostic().wrap_err_with(|| failed("read")).map_err(Failure::Error)?;
    let page =
        in_page(&page).into_diagnostic().wrap_err_with(|| failed("put the tables into")).map_err(Failure::Error)?;
    let write = || {
        let mut file = OutputFile::create(path)?;
        file.write_all(page.as_bytes())?;
        file.commit()
    };
    write().into_diagnostic().wrap_err_with(|| failed("write")).map_err(Failure::Error)
}

fn rom(args: &RomArgs) -> Result<(), Failure> {
    check_directory(&args.output)?;
    let files = rom_files();
    let count = files.len();
    write_files(&args.output, files)?;
    Ok(writeln!(io::stdout().lock(), "{count} tables in {}", args.output.display())?)
}

fn c(args: &CArgs) -> Result<(), Failure> {
    check_directory(&args.output)?;
    let files = c_library_files();
    let names = files.each_ref().map(|(name, _)| *name).join(" and ");
    write_files(&args.output, files)?;
    Ok(writeln!(io::stdout().lock(), "{names} in {}", args.output.display())?)
}
