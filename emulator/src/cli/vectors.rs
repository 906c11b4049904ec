//! `roughxel vectors export|verify|list`.

use std::error::Error;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use roughxel_core::plan::ReflectionPlan;
use roughxel_core::precision::Precision;
use roughxel_emulator::study::cases::{CaseSet, hard_case_sets, random_fragment};
use roughxel_emulator::vectors::{
    Cause, MAX_VECTORS, Manifest, Mismatch, SetInfo, VectorError, Verification, export_with, manifests_in, verify,
};
use serde_json::json;

use super::console::{complain, new_table, progress};
use super::{CONVENTIONS, Failure, ProfileArg, on_one_line, parse_profile};

const RANDOM: &str = "random";
const RANDOM_DESCRIPTION: &str = "seeded random fragments: plausible ones, and bit patterns at corner exponents";
/// Vectors of a smoke set: at most, and of the random one.
const SMOKE_MOST: u64 = 1000;
const SMOKE_RANDOM: u64 = 256;

#[derive(Subcommand)]
pub(super) enum VectorsCommand {
    /// Write sets of vectors: packed hex and a JSON manifest each.
    #[command(after_help = CONVENTIONS)]
    Export(ExportArgs),
    /// Recompute every value of sets and compare; name set, index, stage, field and bit of each difference.
    #[command(after_help = CONVENTIONS)]
    Verify(VerifyArgs),
    /// List the sets that can be exported.
    List(ListArgs),
}

#[derive(Args)]
pub(super) struct ExportArgs {
    /// Sets, as `vectors list` names them; none is all.
    #[arg(value_name = "SET")]
    sets: Vec<String>,
    /// Directory; made if it is not there.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Profile.
    #[arg(long, default_value = "standard", value_parser = parse_profile, value_name = "NAME")]
    profile: ProfileArg,
    /// Vectors of the random set.
    #[arg(long, default_value_t = 1000, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=MAX_VECTORS))]
    count: u64,
    /// Another random set than the published one, which is seed 0.
    #[arg(long, default_value_t = 0, value_name = "N")]
    seed: u64,
    /// The smoke sets kept in the repository: every hard case and 256 random vectors under `standard`, 256 random
    /// vectors under `compact`.
    #[arg(long, conflicts_with_all = ["sets", "profile", "count", "seed"])]
    smoke: bool,
    /// Summary as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
pub(super) struct VerifyArgs {
    /// Directories of sets, or single ones (NAME.json or NAME.hex).
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

pub(super) fn run(command: &VectorsCommand) -> Result<(), Failure> {
    match command {
        VectorsCommand::Export(args) => export(args),
        VectorsCommand::Verify(args) => verify_all(args),
        VectorsCommand::List(args) => list(args),
    }
}

fn export(args: &ExportArgs) -> Result<(), Failure> {
    let mut written = Vec::new();
    if args.smoke {
        for set in hard_case_sets(&Precision::STANDARD) {
            written.push(export_cases(&set, &parse_smoke("standard")?, SMOKE_MOST, &args.output)?);
        }
        for profile in ["standard", "compact"] {
            written.push(export_random(SMOKE_RANDOM, 0, &parse_smoke(profile)?, &args.output)?);
        }
    } else {
        let cases = hard_case_sets(&args.profile.precision);
        let known = |name: &str| name == RANDOM || cases.iter().any(|set| set.name == name);
        if let Some(unknown) = args.sets.iter().find(|name| !known(name)) {
            let names: Vec<_> = cases.iter().map(|set| set.name).chain([RANDOM]).collect();
            return Err(Failure::Usage(format!("set `{unknown}` is unknown; there are {}", names.join(", "))));
        }
        let wanted = |name: &str| args.sets.is_empty() || args.sets.iter().any(|set| set == name);
        for set in cases.iter().filter(|set| wanted(set.name)) {
            written.push(export_cases(set, &args.profile, MAX_VECTORS, &args.output)?);
        }
        if wanted(RANDOM) {
            written.push(export_random(args.count, args.seed, &args.profile, &args.output)?);
        }
    }
    let mut out = io::stdout().lock();
    if args.json {
        let sets: Vec<_> = written.iter().map(summary).collect();
        writeln!(out, "{:#}", json!({ "directory": args.output.display().to_string(), "sets": sets }))?;
    } else {
        let mut table = new_table(["set", "profile", "vectors", "bits a word", "file"]);
        for manifest in &written {
            let Manifest { set, profile, count, word_bits, files, .. } = manifest;
            table.add_row([set, &profile.name, &count.to_string(), &word_bits.to_string(), &files[0].name]);
        }
        writeln!(out, "{table}")?;
    }
    Ok(())
}

fn summary(manifest: &Manifest) -> serde_json::Value {
    let Manifest { set, profile, count, word_bits, files, .. } = manifest;
    json!({ "set": set, "profile": profile.name, "count": count, "word_bits": word_bits, "files": files })
}

fn parse_smoke(profile: &str) -> Result<ProfileArg, Failure> {
    parse_profile(profile).map_err(Failure::Usage)
}

/// The first `most` vectors of a set of hard cases.
fn export_cases(set: &CaseSet, profile: &ProfileArg, most: u64, directory: &Path) -> Result<Manifest, VectorError> {
    let info = SetInfo {
        name: set.name,
        description: set.description,
        seed: None,
        plan: set.plan,
        precision: profile.precision,
        profile: &profile.name,
    };
    let count = most.min(set.fragments.len() as u64);
    if count < set.fragments.len() as u64 {
        complain(&format!("note: {} has {} vectors, the first {count} are written", set.name, set.fragments.len()));
    }
    let bar = progress(count, set.name);
    let manifest = export_with(&info, count, |i| set.fragments[i as usize], directory, &|done| bar.set_position(done));
    bar.finish_and_clear();
    manifest
}

fn export_random(count: u64, seed: u64, profile: &ProfileArg, directory: &Path) -> Result<Manifest, VectorError> {
    let seed_name = if seed == 0 { RANDOM.to_string() } else { format!("{RANDOM}+{seed}") };
    let info = SetInfo {
        name: RANDOM,
        description: RANDOM_DESCRIPTION,
        seed: Some(&seed_name),
        plan: ReflectionPlan::FULL,
        precision: profile.precision,
        profile: &profile.name,
    };
    let bar = progress(count, RANDOM);
    let fragment = |index| random_fragment(&seed_name, index, &profile.precision);
    let manifest = export_with(&info, count, fragment, directory, &|done| bar.set_position(done));
    bar.finish_and_clear();
    manifest
}

fn verify_all(args: &VerifyArgs) -> Result<(), Failure> {
    let (mut results, mut broken) = (Vec::new(), Vec::new());
    for path in &args.paths {
        let manifests = match path.extension() {
            _ if path.is_dir() => manifests_in(path),
            Some(extension) if extension == "hex" => Ok(vec![path.with_extension("json")]),
            _ => Ok(vec![path.clone()]),
        };
        match manifests {
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
        writeln!(out, "  {}", sentence(mismatch))?;
    }
    let described = mismatches.len() as u64;
    if *mismatching > described {
        writeln!(out, "  and {} more", mismatching - described)?;
    }
    Ok(())
}

fn sentence(mismatch: &Mismatch) -> String {
    let Mismatch { set, index, line, stage, field, bit, found, expected, cause, fields_differing } = mismatch;
    let place = format!("{set} #{index} (line {line}): stage {stage}, field {field}, bit {bit}");
    match cause {
        Cause::FlippedBit => format!("{place}: flipped in the file ({found:x}, was {expected:x})"),
        Cause::Damaged => format!(
            "{place}: {found:x} in the file, {expected:x} computed; several bits of the word are damaged, \
             {fields_differing} fields differ"
        ),
        Cause::Computed => format!(
            "{place}: {found:x} in the file, {expected:x} computed by this version; {fields_differing} fields differ"
        ),
    }
}

fn list(args: &ListArgs) -> Result<(), Failure> {
    let cases = hard_case_sets(&Precision::STANDARD);
    let rows = cases.iter().map(|set| (set.name, set.fragments.len().to_string(), set.description));
    let rows = rows.chain([(RANDOM, "--count".to_string(), RANDOM_DESCRIPTION)]);
    let mut out = io::stdout().lock();
    if args.json {
        let sets = rows.map(|(set, count, description)| {
            json!({ "set": set, "count": count.parse::<u64>().ok(), "description": description })
        });
        writeln!(out, "{:#}", json!(sets.collect::<Vec<_>>()))?;
    } else {
        let mut table = new_table(["set", "vectors", "what"]);
        for (set, count, description) in rows {
            table.add_row([set, &count, description]);
        }
        writeln!(out, "{table}")?;
    }
    Ok(())
}
