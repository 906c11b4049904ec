//! `roughxel vectors verify`.

use std::error::Error;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use roughxel_vectors::{Manifest, VectorError, Verification, manifests_of, verify};
use serde_json::json;

use crate::console::{complain, with_progress};
use crate::{Failure, on_one_line};

#[derive(Args)]
pub(crate) struct VerifyArgs {
    /// Directories of sets, or single sets (NAME.json, NAME.hex or NAME.bin).
    #[arg(required = true, value_name = "DIR|MANIFEST")]
    paths: Vec<PathBuf>,
    /// Print the result as JSON.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &VerifyArgs) -> Result<(), Failure> {
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
    with_progress(count, &manifest.display().to_string(), |done| verify(manifest, done))
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
