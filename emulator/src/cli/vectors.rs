//! `roughxel vectors export|merge|verify|judge|marks|explain|bench|minimise|report|distil|list|format|rom|c`.

use std::error::Error;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use miette::{Context, IntoDiagnostic};
use roughxel_core::plan::{Datapath, Effects, FrameSystem};
use roughxel_core::precision::{Precision, Profile};
use roughxel_emulator::input::open_file;
use roughxel_emulator::net::verilog::VerilogError;
use roughxel_emulator::output::write_files;
use roughxel_emulator::spelling::did_you_mean;
use roughxel_emulator::study::profile_file::NamedPrecision;
use roughxel_emulator::vectors::{
    Form, InputSource, MAX_VECTORS, Manifest, RANDOM_SETS, RandomSet, SetExport, SetInfo, Shard, StageSet, VectorError,
    VectorSet, Verification, Words, c_library_files, entries_set, hard_sets, in_page, manifests_of, rom_files, tables,
    verify,
};
use serde_json::json;

use super::bench::{self, BenchArgs};
use super::console::{complain, new_table, progress};
use super::distil::{self, DistilArgs};
use super::grade::{self, GradeArgs};
use super::judge::{self, JudgeArgs};
use super::marks::{self, MarksArgs};
use super::merge::{self, MergeArgs};
use super::minimise::{self, MinimiseArgs};
use super::{
    CONVENTIONS, Failure, ProfileArg, check_directory, effects, explain, on_one_line, parse_profile,
    remove_abandoned_in, write_text,
};

/// Vectors of a smoke set of hard cases, of one under effects that no other set is under, of the chosen and of the random ones, at most: of
/// a datapath together below a thousand.
const SMOKE_CASES: u64 = 14;
const SMOKE_ALONE: u64 = 40;
const SMOKE_CHOSEN: u64 = 400;
const SMOKE_RANDOM: u64 = 256;
/// Of each datapath the modules of stages that read tables and together show their entries alone; and the folder of these sets beside the others.
const SMOKE_STAGES: [&[&str]; 3] = [
    &["map_scale", "frame", "cube_face", "axes", "probes"],
    &["frame", "half", "highlight_spread", "highlight"],
    &["frame", "half", "local_unit", "horizon_slopes", "peaks_peak"],
];
const SMOKE_STAGES_FOLDER: &str = "stages";

#[derive(Subcommand)]
pub(super) enum VectorsCommand {
    /// Write sets of vectors: packed hex and a JSON manifest each.
    #[command(after_help = CONVENTIONS)]
    Export(ExportArgs),
    /// Join the parts of sets that `export --shard` wrote.
    #[command(long_about = merge::LONG_HELP, after_help = CONVENTIONS)]
    Merge(MergeArgs),
    /// Recompute every value of sets and compare; name set, index, stage, field and bit of each difference.
    #[command(after_help = CONVENTIONS)]
    Verify(VerifyArgs),
    /// Judge the words of a device by an acceptance tier: exact, faithful with a divider or a root of its own, within bounds.
    #[command(long_about = judge::LONG_HELP, after_help = CONVENTIONS)]
    Judge(JudgeArgs),
    /// Mark the vectors in which a device that rounds in its own way may decide otherwise.
    #[command(long_about = marks::LONG_HELP, after_help = CONVENTIONS)]
    Marks(MarksArgs),
    /// Explain one vector: every field stage by stage beside float64, and where a device's word goes wrong first.
    #[command(long_about = explain::LONG_HELP, after_help = CONVENTIONS)]
    Explain(explain::ExplainArgs),
    /// Write benches that compare a device with sets: SystemVerilog, VHDL, cocotb, a Verilator driver.
    #[command(long_about = bench::LONG_HELP, after_help = CONVENTIONS)]
    Bench(BenchArgs),
    /// Say how good sets are: which mistakes in a device they would show.
    #[command(long_about = grade::LONG_HELP, after_help = CONVENTIONS)]
    Report(GradeArgs),
    /// Write a set of few vectors that show the same mistakes as many.
    #[command(long_about = distil::LONG_HELP, after_help = CONVENTIONS)]
    Distil(DistilArgs),
    /// Find the simplest inputs that a device still gets wrong in the same stage as a vector.
    #[command(long_about = minimise::LONG_HELP, after_help = CONVENTIONS)]
    Minimise(MinimiseArgs),
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
    /// The smoke sets kept in the repository: of each datapath 400 chosen and 256 random vectors under `standard`, `compact` and
    /// `narrow`, under `standard` hard cases by name, too, and in DIR/stages the vectors for entries of tables of the stages that read them.
    #[arg(long, conflicts_with_all = ["sets", "profile", "count", "seed", "effects", "frame", "scene"])]
    smoke: bool,
    /// Words as records of bytes, NAME.bin, for programs, instead of as text, NAME.hex, for simulators.
    #[arg(long, conflicts_with = "smoke")]
    bin: bool,
    /// Inputs and outputs only, without the outcomes of stages between them.
    #[arg(long, conflicts_with = "smoke")]
    no_taps: bool,
    /// Sets of one stage instead: what goes in and out of its Verilog module (`reflect`, `columns_pixel`), or of each of its modules
    /// (`columns`), as `verilog --stage` names them. Sets whose datapath has no such stage are left out.
    #[arg(long, value_name = "NAME", conflicts_with_all = ["smoke", "no_taps"])]
    stage: Option<String>,
    /// Part K of N of each set alone, K from 1, as SET_PROFILE.KofN: a contiguous range of its vectors. `vectors merge` joins all
    /// parts to what an export without this option writes, to the byte. A set has no more parts than vectors.
    #[arg(long, value_name = "K/N", value_parser = parse_shard)]
    shard: Option<Shard>,
    /// Keep the sets that are in DIR already, whole and the same: made by this version of the program from the same options,
    /// with words of the SHA-256 in the manifest. For an export that was interrupted.
    #[arg(long)]
    resume: bool,
    /// Summary as JSON.
    #[arg(long)]
    json: bool,
}

/// `K/N`.
fn parse_shard(text: &str) -> Result<Shard, String> {
    let number = |text: &str| text.parse().ok().filter(|_| text.bytes().all(|c| c.is_ascii_digit()));
    let shard = text.split_once('/').and_then(|(k, n)| Shard::new(number(k)?, number(n)?));
    shard.ok_or_else(|| format!("a part is K/N, K from 1 to N and N at most {MAX_VECTORS}, such as 2/8"))
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
        VectorsCommand::Merge(args) => merge::run(args),
        VectorsCommand::Verify(args) => verify_all(args),
        VectorsCommand::Judge(args) => judge::run(args),
        VectorsCommand::Marks(args) => marks::run(args),
        VectorsCommand::Explain(args) => explain::run(args),
        VectorsCommand::Bench(args) => bench::run(args),
        VectorsCommand::Report(args) => grade::run(args),
        VectorsCommand::Distil(args) => distil::run(args),
        VectorsCommand::Minimise(args) => minimise::run(args),
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
    /// The stage that the sets are of.
    stage: Option<&'a str>,
    shard: Option<Shard>,
    /// Whether sets that are there stay.
    resume: bool,
    directory: &'a Path,
}

/// A set that was written, or was there.
struct Exported {
    directory: PathBuf,
    manifest: Manifest,
    kept: bool,
}

impl Export<'_> {
    /// The effects of a set.
    fn effects(&self, of_set: Effects) -> Effects {
        let frame = self.frame.unwrap_or(of_set.frame);
        Effects { frame, ..self.effects.unwrap_or(of_set) }
    }

    /// `most` vectors of a set of hard cases.
    fn cases(&self, set: &VectorSet, most: u64) -> Result<Vec<Exported>, Failure> {
        let all = set.inputs.len() as u64;
        let count = most.min(all);
        if count < all {
            complain(&format!("note: {} has {all} vectors, {count} of them are written", set.name));
        }
        let info = self.info(set.name, set.description, None, set.datapath, set.effects);
        self.write(&info, count, &|index: u64| set.part(index, count))
    }

    /// A random set.
    fn random(&self, datapath: Datapath, count: u64, seed: u64) -> Result<Vec<Exported>, Failure> {
        let (name, _, description) = RANDOM_SETS[datapath as usize];
        let seed = if seed == 0 { name.to_owned() } else { format!("{name}+{seed}") };
        let info = self.info(name, description, Some(&seed), datapath, Effects::ALL);
        self.write(&info, count, &RandomSet { datapath, seed: &seed, precision: &self.profile.precision })
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

    /// Writes a set, its part or, where it may stay and is there, nothing; or those of the modules of the stage. There are none where the
    /// part has no vectors, or the set's datapath no such stage.
    fn write(&self, info: &SetInfo<'_>, count: u64, input: &dyn InputSource) -> Result<Vec<Exported>, Failure> {
        let Some(stage) = self.stage else {
            return Ok(self.write_set(SetExport::new(info, count), input)?.into_iter().collect());
        };
        let stages = match StageSet::of(info.datapath, &info.effects, &info.precision, Some(stage)) {
            Err(VerilogError::UnknownStage { .. }) => return Ok(Vec::new()),
            stages => stages?,
        };
        let write = |stage| self.write_set(SetExport::of_stage(info, count, stage), input).transpose();
        stages.iter().filter_map(write).collect()
    }

    /// Writes a set, or what [`write`](Self::write) says in its place.
    fn write_set(&self, mut set: SetExport<'_>, input: &dyn InputSource) -> Result<Option<Exported>, Failure> {
        let directory = self.directory.to_path_buf();
        if let Some(shard) = self.shard {
            let (name, count, number) = (set.name().to_owned(), set.whole_count(), shard.number());
            let Some(part) = set.of_shard(shard) else {
                complain(&format!(
                    "note: {name} has {count} vectors and so {count} parts; there is no part {number} of it"
                ));
                return Ok(None);
            };
            set = part;
        }
        if self.resume
            && let Some(manifest) = set.present(&directory)
        {
            return Ok(Some(Exported { directory, manifest, kept: true }));
        }
        let indices = set.indices();
        let bar = progress(indices.end - indices.start, set.name());
        let manifest = set.write(input, &directory, &|done| bar.set_position(done));
        bar.finish_and_clear();
        Ok(Some(Exported { directory, manifest: manifest?, kept: false }))
    }

    /// Checks that the sets, each with its datapath and effects, have the stage: each of those that were `named`, or any of all.
    fn check_stage<'b>(
        &self,
        named: bool,
        sets: impl Iterator<Item = (&'b str, Datapath, Effects)>,
    ) -> Result<(), Failure> {
        let Some(stage) = self.stage else { return Ok(()) };
        let unknown = |who: &str, known: &[String]| {
            let hint = did_you_mean(stage, known.iter().map(String::as_str));
            Err(Failure::Usage(format!("{who} no stage `{stage}`; {hint}there are {}", known.join(", "))))
        };
        let mut all: Vec<String> = Vec::new();
        for (set, datapath, effects) in sets {
            match StageSet::of(datapath, &self.effects(effects), &self.profile.precision, Some(stage)) {
                Err(VerilogError::UnknownStage { known, .. }) if named => {
                    return unknown(&format!("set `{set}` has"), &known);
                }
                Err(VerilogError::UnknownStage { known, .. }) => {
                    all.extend(known.into_iter().filter(|name| !all.contains(name)).collect::<Vec<_>>());
                }
                sets if named => drop(sets?),
                sets => return sets.map(drop).map_err(Failure::from),
            }
        }
        if named { Ok(()) } else { unknown("the sets have", &all) }
    }
}

fn export(args: &ExportArgs) -> Result<(), Failure> {
    let mut written = Vec::new();
    let ExportArgs { effects, frame, output, .. } = args;
    check_directory(output)?;
    let profile = &args.profile.open()?;
    let words = Words { taps: !args.no_taps, form: if args.bin { Form::Bin } else { Form::Hex } };
    let (stage, shard, resume) = (args.stage.as_deref(), args.shard, args.resume);
    let export = Export { profile, effects: *effects, frame: *frame, words, stage, shard, resume, directory: output };
    if args.smoke {
        smoke(&export, &mut written)?;
    } else if let Some(scene) = &args.scene {
        for object in effects::planned_objects(scene, &profile.precision)? {
            for (datapath, effects) in object.plan.datapaths() {
                let directory = output.join(&object.directory).join(datapath.name());
                let export =
                    Export { effects: Some(effects), frame: Some(effects.frame), directory: &directory, ..export };
                chosen(args, &export, |of| of == datapath, &mut written)?;
            }
        }
        if let (Some(stage), true) = (stage, written.is_empty()) {
            complain(&format!(
                "no object of the scene has a datapath with the stage `{stage}`, so there are no vectors"
            ));
        } else if written.is_empty() {
            complain("no object of the scene reflects or shines, so there are no vectors");
        }
    } else {
        chosen(args, &export, |_| true, &mut written)?;
    }
    let kept = written.iter().filter(|set| set.kept).count();
    if args.resume {
        complain(&format!("note: {kept} of {} sets were there, whole and the same, and are kept", written.len()));
    }
    let mut out = io::stdout().lock();
    if args.json {
        let sets: Vec<_> = written.iter().map(summary).collect();
        writeln!(out, "{:#}", json!({ "directory": output.display().to_string(), "sets": sets }))?;
    } else {
        let mut table = new_table(["set", "datapath", "profile", "vectors", "bits a word", "file"]);
        for Exported { directory, manifest, .. } in &written {
            let Manifest { set, datapath, profile, count, word_bits, files, .. } = manifest;
            let file = directory.strip_prefix(output).unwrap_or(directory).join(&files[0].name);
            let [count, bits, file] = [count.to_string(), word_bits.to_string(), file.display().to_string()];
            table.add_row([set.as_str(), datapath.name(), &profile.name, &count, &bits, &file]);
        }
        writeln!(out, "{table}")?;
    }
    Ok(())
}

/// The sets of the command line, of the wanted datapaths.
fn chosen(
    args: &ExportArgs,
    export: &Export<'_>,
    of: impl Fn(Datapath) -> bool,
    written: &mut Vec<Exported>,
) -> Result<(), Failure> {
    let cases = hard_sets(&export.profile.precision);
    let names = || cases.iter().map(|set| set.name).chain(RANDOM_SETS.map(|(name, ..)| name));
    if let Some(unknown) = args.sets.iter().find(|wanted| !names().any(|name| name == wanted.as_str())) {
        let names: Vec<_> = names().collect();
        return Err(Failure::Usage(format!("set `{unknown}` is unknown; there are {}", names.join(", "))));
    }
    let wanted = |name: &str| args.sets.is_empty() || args.sets.iter().any(|set| set == name);
    if args.scene.is_none() {
        let of_cases = cases.iter().map(|set| (set.name, set.datapath, set.effects));
        let of_random = RANDOM_SETS.map(|(name, datapath, _)| (name, datapath, Effects::ALL));
        let sets = of_cases.chain(of_random).filter(|(name, ..)| wanted(name));
        export.check_stage(!args.sets.is_empty(), sets)?;
    }
    remove_abandoned_in(export.directory);
    for set in cases.iter().filter(|set| wanted(set.name) && of(set.datapath)) {
        written.extend(export.cases(set, MAX_VECTORS)?);
    }
    for (_, datapath, _) in RANDOM_SETS.iter().filter(|(name, datapath, _)| wanted(name) && of(*datapath)) {
        written.extend(export.random(*datapath, args.count, args.seed)?);
    }
    Ok(())
}

/// The sets kept in the repository: of the options those that say which part, whether sets stay, and where.
fn smoke(options: &Export<'_>, written: &mut Vec<Exported>) -> Result<(), Failure> {
    remove_abandoned_in(options.directory);
    for named in [Profile::Standard, Profile::Compact, Profile::Narrow] {
        let profile = &named.into();
        let export = Export { profile, ..*options };
        let sets = hard_sets(&profile.precision);
        for set in sets.iter().filter(|set| set.best_first || named == Profile::Standard && set.enough > 0) {
            let is_alone = set.effects.of(set.datapath) != Effects::ALL.of(set.datapath);
            let most = match is_alone {
                _ if set.best_first => SMOKE_CHOSEN,
                true => SMOKE_ALONE,
                false => SMOKE_CASES,
            };
            written.extend(export.cases(set, most.min(set.enough))?);
        }
        for datapath in Datapath::ALL {
            written.extend(export.random(datapath, SMOKE_RANDOM, 0)?);
        }
        if named == Profile::Standard {
            let directory = &options.directory.join(SMOKE_STAGES_FOLDER);
            check_directory(directory)?;
            remove_abandoned_in(directory);
            let export = Export { directory, ..export };
            for set in sets.iter().filter(|set| set.name == entries_set(set.datapath)) {
                let (count, datapath) = (set.inputs.len() as u64, set.datapath);
                let info = export.info(set.name, set.description, None, datapath, set.effects);
                let stages = StageSet::of(datapath, &info.effects, &info.precision, None)?;
                for stage in stages.iter().filter(|stage| SMOKE_STAGES[datapath as usize].contains(&stage.name())) {
                    let input = |index: u64| set.part(index, count);
                    written.extend(export.write_set(SetExport::of_stage(&info, count, stage), &input)?);
                }
            }
        }
    }
    Ok(())
}

fn summary(set: &Exported) -> serde_json::Value {
    let Exported { manifest: Manifest { set, profile, count, part, word_bits, files, .. }, kept, .. } = set;
    let mut summary = json!({
        "set": set, "profile": profile.name, "count": count, "word_bits": word_bits, "files": files, "kept": kept
    });
    if let Some(part) = part {
        summary["part"] = json!(part);
    }
    summary
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
    let Verification { set, profile, count, part, hash_matches, mismatching, mismatches, misplaced } = result;
    let of = part.map_or_else(String::new, |part| format!(", part {} of {}", part.number, part.of));
    if result.passed() {
        return writeln!(out, "ok       {set} ({profile}{of}): {count} vectors");
    }
    let hash = if *hash_matches { "the file's SHA-256 is right" } else { "the file's SHA-256 differs, too" };
    match mismatching {
        0 if misplaced.is_empty() => writeln!(
            out,
            "differs  {set} ({profile}{of}): every vector is right, but the SHA-256 of the file is not the one in {}",
            path.display()
        )?,
        0 => writeln!(out, "differs  {set} ({profile}{of}): every vector is right, but not in its place")?,
        n => writeln!(out, "differs  {set} ({profile}{of}): {n} of {count} vectors; {hash}")?,
    }
    for misplaced in misplaced {
        writeln!(out, "  {misplaced}")?;
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
    let rows = cases.iter().map(|set| (set.name, set.datapath, set.inputs.len().to_string(), set.description));
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
    Ok(write_text(path, &page)?)
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
