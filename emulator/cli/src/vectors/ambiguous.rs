//! `roughxel vectors ambiguous`.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use roughxel_vectors::{Manifest, ambiguous};
use serde_json::json;

use super::check::MOST_PLACES;
use super::explain::manifest_of;
use crate::console::with_progress;
use crate::{Failure, check_file, write_text};

pub(super) const LONG_HELP: &str = "\
List the vectors of a set in which a decision is ambiguous: a face, a probe count or a status bit differs among devices whose roundings are
up to --places last places off. A device with other roundings (`roughxel vectors check --tier bound`) may decide otherwise in these vectors only.

With -o, FILE gets one line per vector in the order of the set, for `$readmemh`: 1 if the vector is ambiguous, else 0.

  roughxel vectors ambiguous vectors/smoke/random_standard -o random_standard_ambiguous.hex";

/// Most vectors that are listed.
const LISTED: usize = 10;

#[derive(Args)]
pub(crate) struct AmbiguousArgs {
    /// Set: NAME.json, NAME.hex, NAME.bin, or NAME.
    #[arg(value_name = "SET")]
    set: PathBuf,
    /// Last places that each rounding may be off.
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MOST_PLACES))]
    places: u32,
    /// Write 0 or 1 for each vector to this text file, one line each.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Print the result as JSON.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &AmbiguousArgs) -> Result<(), Failure> {
    if let Some(path) = &args.output {
        check_file(path)?;
    }
    let path = manifest_of(&args.set)?;
    let manifest = Manifest::read(&path)?;
    let ambiguous = with_progress(manifest.count, "vectors", |done| ambiguous(&path, args.places, done))?;
    if let Some(path) = &args.output {
        write_text(path, &ambiguous.lines(manifest.indices().start))?;
    }
    let mut out = io::stdout().lock();
    if args.json {
        writeln!(out, "{:#}", json!(ambiguous))?;
    } else {
        writeln!(
            out,
            "{} ({}): {} of {} vectors are ambiguous",
            ambiguous.set,
            ambiguous.profile,
            ambiguous.marked.len(),
            ambiguous.count
        )?;
        for marked in ambiguous.marked.iter().take(LISTED) {
            writeln!(out, "  #{}: {}", marked.index, marked.fields.join(", "))?;
        }
        if ambiguous.marked.len() > LISTED {
            writeln!(out, "  and {} more", ambiguous.marked.len() - LISTED)?;
        }
    }
    out.flush()?;
    Ok(())
}
