//! `roughxel study`.

use std::fs;
use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use roughxel_study::measurement::{self, Parts, Settings, Study};
use roughxel_study::{StudyError, report};

use super::console::{complain, progress};
use super::{Failure, check_directory};

pub(super) const LONG_HELP: &str = "\
Measure what accuracy costs in time: every knob of a profile alone, the named profiles, word widths and modes, against float64, \
float32 and several samples a pixel.

Accuracy   worst, mean and 99.9 % error of every stage; PSNR and SSIM of frames against the same filter in float64, the filter of
           `standard` in float64, and 1024 samples a pixel; errors near every degeneracy
Time       host: nanoseconds per fragment and per pixel, scalar and SIMD, as ratios to `standard`, measured in turns with it
           hardware: multipliers, lookup tables and gate levels of the reflection datapath, from the proof of its ranges
           soft core: clocks per fragment on twelve cores and instructions on three processors, as `cargo firmware price
           --knobs` predicted and counted them
           memory: texels per pixel, bytes of maps

Writes study.json, index.html (one self-contained page without scripts) and the two plots of docs/performance.md as SVG. An interrupted study
continues where it stopped. Times that the load of other programs spoilt are marked.

Exit codes: 0 done, 1 failure, 2 usage.
Data goes to stdout, progress and errors to stderr.";

#[derive(Args)]
pub(super) struct StudyArgs {
    /// Draw frames of 160x120: less than three minutes on two cores. This is the default.
    #[arg(long, conflicts_with = "full")]
    quick: bool,
    /// Draw frames of 320x240 and measure a million fragments of each named profile. The command first says how long it takes.
    #[arg(long)]
    full: bool,
    /// Directory to write to; created if missing.
    #[arg(short, long, default_value = "study", value_name = "DIR")]
    output: PathBuf,
    /// Measure nothing: write page, tables and plots of this study.json.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["quick", "full"])]
    from: Option<PathBuf>,
    /// Also print study.json.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &StudyArgs) -> Result<(), Failure> {
    let settings = if args.full { Settings::full() } else { Settings::quick() };
    let directory = args.output.as_path();
    check_directory(directory)?;
    fs::create_dir_all(directory).map_err(|source| StudyError::File {
        action: "make",
        path: directory.to_path_buf(),
        source,
    })?;
    if let Some(file) = &args.from {
        let study = Study::read(file)?;
        let written = report::write(&study, directory)?;
        return tell(&study, &written, args.json);
    }
    let points = measurement::settings();
    let parts = Parts::open(directory, &settings)?;
    match parts.count() {
        0 if args.full => complain(&measurement::forecast(&settings)?),
        0 => {}
        kept => complain(&format!("{kept} measurements of an interrupted study are kept")),
    }
    let bar = progress(measurement::work(&settings, &points), "");
    let study = measurement::run(&settings, &points, &parts, &|what: &str, done: u64| {
        if done == 0 {
            bar.set_message(what.to_string());
        }
        bar.inc(done);
    })?;
    bar.set_message("page");
    let written = report::write(&study, directory)?;
    parts.remove()?;
    bar.finish_and_clear();

    tell(&study, &written, args.json)
}

/// Prints the results and the paths of the written files.
fn tell(study: &Study, written: &[PathBuf], json: bool) -> Result<(), Failure> {
    let loaded = study.loaded();
    if loaded > 0 {
        complain(&format!(
            "warning: {loaded} times were measured while other programs ran, and are marked; repeat the study on a quiet machine"
        ));
    }
    let mut out = io::stdout().lock();
    if json {
        writeln!(out, "{}", report::json(study))?;
        return Ok(());
    }
    writeln!(out, "{}", summary(study))?;
    for path in written {
        writeln!(out, "{}", path.display())?;
    }
    Ok(())
}

/// Builds the table of the named profiles: error, picture quality, and cost on each clock.
fn summary(study: &Study) -> comfy_table::Table {
    let (headings, rows) = report::profiles(study);
    let mut table = super::console::new_table([""]);
    table.set_header(headings);
    table.add_rows(rows);
    table
}
