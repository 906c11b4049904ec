//! `roughxel vectors export`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use roughxel_core::plan::{Datapath, Effects, FrameSystem};
use roughxel_core::precision::Profile;
use roughxel_netlist::verilog::VerilogError;
use roughxel_study::profile_file::NamedPrecision;
use roughxel_utilities::suggestions::did_you_mean;
use roughxel_vectors::{
    Form, InputSource, MAX_VECTORS, Manifest, RANDOM_SETS, RandomSet, RandomSetSummary, SetExport, SetInfo, Shard,
    StageSet, VectorSet, Words, entries_set, hard_sets,
};
use serde_json::json;

use crate::console::{complain, new_table, with_progress};
use crate::{Failure, ProfileArg, check_directory, effects, parse_profile, remove_abandoned_in};

/// Most vectors of a smoke set of hard cases. All smoke sets of a datapath have fewer than a thousand vectors together.
const SMOKE_CASES: u64 = 14;
/// Most vectors of a smoke set under effects that no other set has.
const SMOKE_ALONE: u64 = 40;
/// Most vectors of a smoke set of chosen vectors.
const SMOKE_CHOSEN: u64 = 400;
/// Vectors of a random smoke set.
const SMOKE_RANDOM: u64 = 256;
/// Stage modules of each datapath that read tables and together show every entry on their own.
const SMOKE_STAGES: [&[&str]; 3] = [
    &["map_scale", "frame", "cube_face", "axes", "probes"],
    &["frame", "half", "highlight_spread", "highlight"],
    &["frame", "half", "local_unit", "horizon_slopes", "peaks_peak"],
];
/// Folder of the sets of [`SMOKE_STAGES`], next to the other smoke sets.
const SMOKE_STAGES_FOLDER: &str = "stages";

#[derive(Args)]
pub(crate) struct ExportArgs {
    /// Sets, as `vectors list` names them. The default is all.
    #[arg(value_name = "SET")]
    sets: Vec<String>,
    /// Directory to write to; created if missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Profile: a name or a file (TOML).
    #[arg(long, default_value = "standard", value_parser = parse_profile, value_name = "NAME|FILE")]
    profile: ProfileArg,
    /// Effects in place of those that each set is made for. They decide which fields a set has.
    #[arg(long, value_parser = effects::parse, value_name = "LIST", long_help = effects::HELP)]
    effects: Option<Effects>,
    /// Tangent basis in place of the one that each set is made for.
    #[arg(long, value_parser = effects::parse_frame, value_name = "main|natural|natural-normalised")]
    frame: Option<FrameSystem>,
    /// Scene file (TOML) or built-in scene. Sets are those of the datapaths and effects that its objects need, in
    /// DIR/OBJECT/DATAPATH.
    #[arg(long, value_name = "SCENE", conflicts_with_all = ["effects", "frame"])]
    scene: Option<String>,
    /// Vectors of each random set.
    #[arg(long, default_value_t = 1000, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=MAX_VECTORS))]
    count: u64,
    /// Seed of the random sets. The published sets have seed 0.
    #[arg(long, default_value_t = 0, value_name = "N")]
    seed: u64,
    /// Write the smoke sets of the repository: for each datapath 400 chosen and 256 random vectors under `standard`, `compact` and
    /// `narrow`. Under `standard` also hard cases by name, and in DIR/stages the table-entry vectors of the stages that read tables.
    #[arg(long, conflicts_with_all = ["sets", "profile", "count", "seed", "effects", "frame", "scene"])]
    smoke: bool,
    /// Write words as byte records for programs, NAME.bin, instead of text for simulators, NAME.hex.
    #[arg(long, conflicts_with = "smoke")]
    bin: bool,
    /// Write inputs and outputs only, without the outcomes of the stages between them.
    #[arg(long, conflicts_with = "smoke")]
    no_taps: bool,
    /// Write sets of one stage: the inputs and outputs of its Verilog module (`reflect`, `columns_pixel`), or of each of its modules
    /// (`columns`), as `verilog --stage` names them. Sets whose datapath lacks the stage are left out.
    #[arg(long, value_name = "NAME", conflicts_with_all = ["smoke", "no_taps"])]
    stage: Option<String>,
    /// Write only part K of N of each set, K from 1: a contiguous range of its vectors, as SET_PROFILE.KofN. `vectors merge` joins
    /// the parts to the exact bytes of a whole export; a set has no more parts than vectors.
    #[arg(long, value_name = "K/N", value_parser = parse_shard)]
    shard: Option<Shard>,
    /// Continue an interrupted export: keep sets in DIR that are whole and the same. They are of this program version and the same
    /// options, and their words have the SHA-256 of the manifest.
    #[arg(long)]
    resume: bool,
    /// Print the summary as JSON.
    #[arg(long)]
    json: bool,
}

/// Parses `K/N`.
fn parse_shard(text: &str) -> Result<Shard, String> {
    let number = |text: &str| text.parse().ok().filter(|_| text.bytes().all(|c| c.is_ascii_digit()));
    let shard = text.split_once('/').and_then(|(k, n)| Shard::new(number(k)?, number(n)?));
    shard.ok_or_else(|| format!("a part is K/N, K from 1 to N and N at most {MAX_VECTORS}, such as 2/8"))
}

/// Options of an export that hold for all its sets.
struct Export<'a> {
    profile: &'a NamedPrecision,
    /// Effects in place of those of each set.
    effects: Option<Effects>,
    frame: Option<FrameSystem>,
    words: Words,
    /// Stage that the sets are of.
    stage: Option<&'a str>,
    shard: Option<Shard>,
    /// True if existing sets are kept.
    resume: bool,
    directory: &'a Path,
}

/// A set that was written or kept.
struct Exported {
    directory: PathBuf,
    manifest: Manifest,
    kept: bool,
}

impl Export<'_> {
    /// Effects of a set, with the options applied.
    fn effects(&self, of_set: Effects) -> Effects {
        let frame = self.frame.unwrap_or(of_set.frame);
        Effects { frame, ..self.effects.unwrap_or(of_set) }
    }

    /// Exports the first `most` vectors of a set of hard cases.
    fn cases(&self, set: &VectorSet, most: u64) -> Result<Vec<Exported>, Failure> {
        let all = set.inputs.len() as u64;
        let count = most.min(all);
        if count < all {
            complain(&format!("note: {} has {all} vectors, {count} of them are written", set.name));
        }
        let info = self.info(set.name, set.description, None, set.datapath, set.effects);
        self.write(&info, count, &|index: u64| set.part(index, count))
    }

    /// Exports a random set.
    fn random(&self, datapath: Datapath, count: u64, seed: u64) -> Result<Vec<Exported>, Failure> {
        let RandomSetSummary { name, description, .. } = RANDOM_SETS[datapath as usize];
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

    /// Writes a set or its part, or one set for each module of the stage. A set that is kept is not written.
    ///
    /// Returns no sets if the part has no vectors or the set's datapath lacks the stage.
    fn write(&self, info: &SetInfo<'_>, count: u64, input: &dyn InputSource) -> Result<Vec<Exported>, Failure> {
        let Some(stage) = self.stage else {
            return Ok(self.write_set(SetExport::new(info, count), input)?.into_iter().collect());
        };
        let stages = match StageSet::select(info.datapath, &info.effects, &info.precision, Some(stage)) {
            Err(VerilogError::UnknownStage { .. }) => return Ok(Vec::new()),
            stages => stages?,
        };
        let write = |stage| self.write_set(SetExport::of_stage(info, count, stage), input).transpose();
        stages.iter().filter_map(write).collect()
    }

    /// Writes a set or its part, or keeps it. Returns `None` if the part has no vectors.
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
        let count = indices.end - indices.start;
        let manifest = with_progress(count, set.name(), |done| set.write(input, &directory, done))?;
        Ok(Some(Exported { directory, manifest, kept: false }))
    }

    /// Checks that the sets, each with its datapath and effects, have the stage. Each `named` set must have it; of all sets, one must.
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
            match StageSet::select(datapath, &self.effects(effects), &self.profile.precision, Some(stage)) {
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

pub(super) fn run(args: &ExportArgs) -> Result<(), Failure> {
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

/// Exports the sets of the command line whose datapath `of` accepts.
fn chosen(
    args: &ExportArgs,
    export: &Export<'_>,
    of: impl Fn(Datapath) -> bool,
    written: &mut Vec<Exported>,
) -> Result<(), Failure> {
    let cases = hard_sets(&export.profile.precision);
    let names = || cases.iter().map(|set| set.name).chain(RANDOM_SETS.map(|set| set.name));
    if let Some(unknown) = args.sets.iter().find(|wanted| !names().any(|name| name == wanted.as_str())) {
        let names: Vec<_> = names().collect();
        return Err(Failure::Usage(format!("set `{unknown}` is unknown; there are {}", names.join(", "))));
    }
    let wanted = |name: &str| args.sets.is_empty() || args.sets.iter().any(|set| set == name);
    if args.scene.is_none() {
        let of_cases = cases.iter().map(|set| (set.name, set.datapath, set.effects));
        let of_random = RANDOM_SETS.map(|set| (set.name, set.datapath, Effects::ALL));
        let sets = of_cases.chain(of_random).filter(|(name, ..)| wanted(name));
        export.check_stage(!args.sets.is_empty(), sets)?;
    }
    remove_abandoned_in(export.directory);
    for set in cases.iter().filter(|set| wanted(set.name) && of(set.datapath)) {
        written.extend(export.cases(set, MAX_VECTORS)?);
    }
    for set in RANDOM_SETS.iter().filter(|set| wanted(set.name) && of(set.datapath)) {
        written.extend(export.random(set.datapath, args.count, args.seed)?);
    }
    Ok(())
}

/// Exports the smoke sets of the repository. Of the options only shard, resume and directory count.
fn smoke(options: &Export<'_>, written: &mut Vec<Exported>) -> Result<(), Failure> {
    remove_abandoned_in(options.directory);
    for named in [Profile::Standard, Profile::Compact, Profile::Narrow] {
        let profile = &named.into();
        let export = Export { profile, ..*options };
        let sets = hard_sets(&profile.precision);
        for set in sets.iter().filter(|set| set.best_first || named == Profile::Standard && set.enough > 0) {
            let is_alone = set.effects.restricted_to(set.datapath) != Effects::ALL.restricted_to(set.datapath);
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
                let stages = StageSet::select(datapath, &info.effects, &info.precision, None)?;
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
