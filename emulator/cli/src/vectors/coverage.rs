//! `roughxel vectors coverage`.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use roughxel_vectors::{Alarm, Coverage, CoverageReport, Manifest, coverage, manifests_of, write_coverage};
use serde_json::json;

use crate::Failure;
use crate::console::{new_table, with_progress};

pub(super) const LONG_HELP: &str = "\
Measure the coverage of sets: which faults of a device they show.

Sets of the same datapath or stage, effects and profile are measured together. With --write each set is measured alone. One fault at a time
is followed through the netlist until a field of some vector differs:

  stuck bit    each bit of each wire is 0, or 1
  operation    a sum is a difference, a shift goes one place further, a comparison includes equality, a rounding is left out,
               a sign is read as a bit, or a clamp never or always acts
  table entry  each entry of each table is one last place more, or less

Columns:
  stuck, operations  faults of a stage that a field shows, of all of them
  decisions          flags seen set and not set; comparisons a < b seen at a = b and at a = b - 1, as far as ranges allow
  read, off by one   table entries that vectors read; entry faults that a field shows, up and down

A fault that proven ranges exclude is not counted. An entry fault is not counted if no value that is looked up shows it. Some faults that no
vector shows make no difference to any output. --unseen lists all of them, with `masked` if the wire of the fault differed and no field did.";

#[derive(Args)]
pub(crate) struct CoverageArgs {
    /// Directories of sets, or single sets (NAME.json, NAME.hex or NAME.bin).
    #[arg(required = true, value_name = "DIR|MANIFEST")]
    paths: Vec<PathBuf>,
    /// List the faults that no field shows and the bins that no vector meets.
    #[arg(long)]
    unseen: bool,
    /// Measure each set alone and write its coverage into its manifest, under the key `grade`.
    #[arg(long)]
    write: bool,
    /// Print everything as JSON: unseen faults, unmet bins, field ranges, and the vectors that first showed something.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &CoverageArgs) -> Result<(), Failure> {
    let mut manifests = Vec::new();
    for path in &args.paths {
        manifests.extend(manifests_of(path)?);
    }
    let counts = manifests.iter().map(|path| Manifest::read(path).map(|manifest| manifest.count));
    let on_all = if args.write { write_coverage } else { coverage };
    let reports = with_progress(counts.sum::<Result<_, _>>()?, "faults", |done| on_all(&manifests, done))?;
    let mut out = io::stdout().lock();
    if args.json {
        return Ok(writeln!(out, "{:#}", json!({ "grades": reports }))?);
    }
    for report in &reports {
        describe(&mut out, report, args.unseen)?;
    }
    Ok(())
}

fn describe(out: &mut impl Write, report: &CoverageReport, unseen: bool) -> io::Result<()> {
    let CoverageReport { datapath, stage, profile, taps, sets, vectors, stages, tables, decisions, .. } = report;
    let taps = if *taps { "" } else { ", no taps" };
    let of = stage.as_ref().map_or_else(|| (*datapath).to_owned(), |stage| format!("stage {stage} of {datapath}"));
    writeln!(out, "{of}, {profile}{taps}: {vectors} vectors of {}", sets.join(", "))?;
    let mut table = new_table(["stage", "stuck", "", "operations", ""]);
    let cells = |count: &Coverage| [format!("{} of {}", count.found, count.all), format!("{:.1} %", count.percent())];
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
    let faults = report.faults();
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
    let constant: Vec<_> = report.alarms.iter().filter_map(Alarm::constant).collect();
    match constant.len() {
        0 => {}
        1 => writeln!(out, "alarm: field {} is the same in every vector", constant[0])?,
        n => writeln!(out, "alarm: {n} fields are the same in every vector: {}", constant.join(", "))?,
    }
    for alarm in &report.alarms {
        if let Alarm::Repeated { vectors } = alarm {
            writeln!(out, "alarm: {vectors} vectors have the inputs of another one")?;
        }
    }
    if unseen {
        for fault in &report.unseen {
            writeln!(out, "unseen{} {}", if fault.masked { " (masked)" } else { "" }, fault.fault)?;
        }
        for bin in &report.unmet {
            writeln!(out, "unmet {bin}")?;
        }
    }
    writeln!(out)
}
