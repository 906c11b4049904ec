//! `roughxel vectors report`.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use roughxel_vectors::{Alarm, Grade, Manifest, Score, grade, manifests_of, write_grades};
use serde_json::json;

use crate::Failure;
use crate::console::{new_table, with_progress};

pub(super) const LONG_HELP: &str = "\
Say how good sets are: which mistakes in a device they would show.

Sets of the same datapath or stage, effects and profile are graded together, with --write each alone. Every bit of every wire of the hardware is stuck at 0 and at 1,
every operation is another one (a sum a difference, a shift one place further, a comparison with `or equal`, a rounding left out, a
sign taken as a bit, a clamp that never or always acts), every entry of every table is one last place more and less: a fault at a time,
followed through the recorded design until a field of some vector differs.

  stuck, operations  faults of a stage that a field shows, of all of them
  decisions          flags seen set and not set; comparisons a < b seen at a = b and at a = b - 1, as far as ranges allow
  read, off by one   entries of a table that vectors read; those whose last place they would miss, up and down

A fault that proven ranges exclude is none, nor is an entry of a table that no value it is looked up by shows. Of what no vector shows some makes no difference to any output; --unseen lists all of it,
`masked` where its own wire differed and no field did.";

#[derive(Args)]
pub(crate) struct ReportArgs {
    /// Directories of sets, or single ones (NAME.json, NAME.hex or NAME.bin).
    #[arg(required = true, value_name = "DIR|MANIFEST")]
    paths: Vec<PathBuf>,
    /// List the faults that no field shows, and the bins that no vector meets.
    #[arg(long)]
    unseen: bool,
    /// Grade each set alone and write into its manifest, as `grade`, what it shows.
    #[arg(long)]
    write: bool,
    /// Everything as JSON: unseen faults, unmet bins, ranges of fields, and the vectors that showed something first.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &ReportArgs) -> Result<(), Failure> {
    let mut manifests = Vec::new();
    for path in &args.paths {
        manifests.extend(manifests_of(path)?);
    }
    let counts = manifests.iter().map(|path| Manifest::read(path).map(|manifest| manifest.count));
    let on_all = if args.write { write_grades } else { grade };
    let grades = with_progress(counts.sum::<Result<_, _>>()?, "faults", |done| on_all(&manifests, done))?;
    let mut out = io::stdout().lock();
    if args.json {
        return Ok(writeln!(out, "{:#}", json!({ "grades": grades }))?);
    }
    for grade in &grades {
        describe(&mut out, grade, args.unseen)?;
    }
    Ok(())
}

fn describe(out: &mut impl Write, grade: &Grade, unseen: bool) -> io::Result<()> {
    let Grade { datapath, stage, profile, taps, sets, vectors, stages, tables, decisions, .. } = grade;
    let taps = if *taps { "" } else { ", no taps" };
    let of = stage.as_ref().map_or_else(|| (*datapath).to_owned(), |stage| format!("stage {stage} of {datapath}"));
    writeln!(out, "{of}, {profile}{taps}: {vectors} vectors of {}", sets.join(", "))?;
    let mut table = new_table(["stage", "stuck", "", "operations", ""]);
    let cells = |score: &Score| [format!("{} of {}", score.found, score.all), format!("{:.1} %", score.percent())];
    for stage in stages {
        let ([stuck, stuck_percent], [slips, slips_percent]) = (cells(&stage.stuck), cells(&stage.slips));
        table.add_row([stage.stage.clone(), stuck, stuck_percent, slips, slips_percent]);
    }
    writeln!(out, "{table}")?;
    if !tables.is_empty() {
        let mut table = new_table(["table", "read", "", "off by one", ""]);
        for of in tables {
            let ([read, read_percent], [entries, entries_percent]) = (cells(&of.read), cells(&of.entries));
            table.add_row([of.table.clone(), read, read_percent, entries, entries_percent]);
        }
        writeln!(out, "{table}")?;
    }
    let faults = grade.faults();
    writeln!(
        out,
        "faults {} of {} ({:.2} %), decisions {} of {} ({:.1} %)",
        faults.found,
        faults.all,
        faults.percent(),
        decisions.found,
        decisions.all,
        decisions.percent()
    )?;
    let constant: Vec<_> = grade.alarms.iter().filter_map(Alarm::constant).collect();
    match constant.len() {
        0 => {}
        1 => writeln!(out, "alarm: field {} is the same in every vector", constant[0])?,
        n => writeln!(out, "alarm: {n} fields are the same in every vector: {}", constant.join(", "))?,
    }
    for alarm in &grade.alarms {
        if let Alarm::Repeated { vectors } = alarm {
            writeln!(out, "alarm: {vectors} vectors have the inputs of another one")?;
        }
    }
    if unseen {
        for fault in &grade.unseen {
            writeln!(out, "unseen{} {}", if fault.masked { " (masked)" } else { "" }, fault.fault)?;
        }
        for bin in &grade.unmet {
            writeln!(out, "unmet {bin}")?;
        }
    }
    writeln!(out)
}
