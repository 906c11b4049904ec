//! `roughxel vectors merge`.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use roughxel_vectors::parts_of;
use serde_json::json;

use crate::console::with_progress;
use crate::{Failure, check_directory, remove_abandoned_in};

pub(super) const LONG_HELP: &str = "\
Join the parts of sets that `export --shard` wrote. The result equals an export without --shard, to the byte.

  roughxel vectors export random --count 4000000 --shard 1/2 -o parts   # on one machine
  roughxel vectors export random --count 4000000 --shard 2/2 -o parts   # on another machine
  roughxel vectors merge parts -o sets

Every part of a set must be present once. All parts must agree in set, seed, profile, effects, fields and program version, and the words of
each must have the SHA-256 of its manifest. Nothing is recomputed: `vectors verify` does that, for parts too.";

#[derive(Args)]
pub(crate) struct MergeArgs {
    /// Directories of parts, or single parts (NAME.KofN.json, .hex or .bin). Whole sets in a directory are ignored.
    #[arg(required = true, value_name = "DIR|PART")]
    parts: Vec<PathBuf>,
    /// Directory to write to; created if missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Print the summary as JSON.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &MergeArgs) -> Result<(), Failure> {
    check_directory(&args.output)?;
    let sets = parts_of(&args.parts)?;
    remove_abandoned_in(&args.output);
    let mut written = Vec::new();
    for parts in &sets {
        let manifest = with_progress(parts.count(), &parts.stem(), |done| parts.merge(&args.output, done))?;
        written.push((parts.len(), manifest));
    }
    let mut out = io::stdout().lock();
    if args.json {
        let list = written.iter().map(|(parts, manifest)| {
            json!({ "set": manifest.set, "profile": manifest.profile.name, "parts": parts, "count": manifest.count,
                "files": manifest.files })
        });
        let directory = args.output.display().to_string();
        writeln!(out, "{:#}", json!({ "directory": directory, "sets": list.collect::<Vec<_>>() }))?;
    } else {
        for (parts, manifest) in &written {
            let path = args.output.join(&manifest.files[0].name);
            writeln!(out, "{}: {} vectors of {parts} parts in {}", manifest.stem(), manifest.count, path.display())?;
        }
    }
    Ok(())
}
