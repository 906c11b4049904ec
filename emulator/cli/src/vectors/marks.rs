//! `roughxel vectors marks`.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use roughxel_vectors::{Manifest, marks};
use serde_json::json;

use super::explain::manifest_of;
use super::judge::MOST_PLACES;
use crate::console::with_progress;
use crate::{Failure, check_file, write_text};

pub(super) const LONG_HELP: &str = "\
Mark the vectors of a set in which a decision can be another one: where a face, a count of probes or a status bit is not the same in every
device whose roundings are up to --places last places off. A device that rounds in its own way (`roughxel vectors judge --tier bound`) may
decide otherwise there, and nowhere else.

With -o a line a vector in the order of the set, 1 where it is marked, else 0, which `$readmemh` reads:

  roughxel vectors marks vectors/smoke/random_standard -o random_standard_marks.hex";

/// Marked vectors that are listed.
const LISTED: usize = 10;

#[derive(Args)]
pub(crate) struct MarksArgs {
    /// The set: NAME.json, NAME.hex or NAME.bin, or the same without its extension.
    #[arg(value_name = "SET")]
    set: PathBuf,
    /// Last places that each rounding may be off.
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MOST_PLACES))]
    places: u32,
    /// A mark for each vector as text, a line each.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Result as JSON.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &MarksArgs) -> Result<(), Failure> {
    if let Some(path) = &args.output {
        check_file(path)?;
    }
    let path = manifest_of(&args.set)?;
    let manifest = Manifest::read(&path)?;
    let marks = with_progress(manifest.count, "vectors", |done| marks(&path, args.places, done))?;
    if let Some(path) = &args.output {
        write_text(path, &marks.lines(manifest.indices().start))?;
    }
    let mut out = io::stdout().lock();
    if args.json {
        writeln!(out, "{:#}", json!(marks))?;
    } else {
        writeln!(out, "{} ({}): {} of {} vectors marked", marks.set, marks.profile, marks.marked.len(), marks.count)?;
        for marked in marks.marked.iter().take(LISTED) {
            writeln!(out, "  #{}: {}", marked.index, marked.fields.join(", "))?;
        }
        if marks.marked.len() > LISTED {
            writeln!(out, "  and {} more", marks.marked.len() - LISTED)?;
        }
    }
    out.flush()?;
    Ok(())
}
