//! `roughxel vectors minimise`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use roughxel_vectors::{MinimiseError, MinimiseOptions, Vector, minimise};
use serde_json::json;

use super::explain::{describe, manifest_of, split, unreadable};
use crate::console::{complain, new_table, with_progress};
use crate::{Failure, check_directory};

pub(super) const LONG_HELP: &str = "\
Find the simplest inputs that a device still gets wrong in the same stage as a vector: as many fields zero, as few bits in the
others and as small exponents as it goes. The device is the one in a bench that `vectors bench` wrote for a set with the
same fields; the bench is compiled once and then runs on 64 candidates at a time, in a copy.

  roughxel vectors bench vectors/smoke/random_standard.json -o benches      # with the device in benches/random_standard
  roughxel vectors minimise 'vectors/smoke/random_standard#3' --bench benches/random_standard -o DIR

DIR gets the vector as a set of one, SET_min_PROFILE; it is printed as `vectors explain` prints it, with the fields of
the device that are wrong and what was simplified. Candidates stay within the declared ranges of the ports.

Exit code 3 where the device gets the vector right: there is nothing to minimise.";

#[derive(Args)]
pub(crate) struct MinimiseArgs {
    /// Set and index of the vector, from 0. The set is NAME.json, NAME.hex or NAME.bin, or the same without its extension.
    #[arg(value_name = "SET#INDEX")]
    set: String,
    /// Index of the vector; then the first argument is the set alone.
    #[arg(long, value_name = "INDEX")]
    index: Option<u64>,
    /// Folder of the bench with the device in it.
    #[arg(long, value_name = "DIR")]
    bench: PathBuf,
    /// What runs the bench, as its run.sh calls it.
    #[arg(long, value_parser = ["icarus", "verilator", "cpp", "ghdl", "cocotb"], default_value = "icarus")]
    tool: String,
    /// Compare what leaves the datapath alone, for a device that does not show its stages.
    #[arg(long)]
    outputs_only: bool,
    /// Most runs of the bench.
    #[arg(long, default_value_t = 200, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    runs: u32,
    /// Directory of the result; made if it is not there.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Result as JSON.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &MinimiseArgs) -> Result<(), Failure> {
    let (set, index) = split(&args.set, args.index)?;
    let manifest = manifest_of(Path::new(set))?;
    check_directory(&args.output)?;
    let options = MinimiseOptions { tool: args.tool.clone(), outputs_only: args.outputs_only, runs: args.runs };
    let runs = u64::from(args.runs);
    let minimised = with_progress(runs, "runs of the bench at most", |done| {
        minimise(&manifest, index, &args.bench, &options, &|runs| done(runs.into()))
    });
    let minimised = minimised.map_err(|error| match error {
        MinimiseError::Set(error) => unreadable(error),
        MinimiseError::OtherSet { .. } => Failure::Usage(error.to_string()),
        error => error.into(),
    })?;
    let Some(minimised) = minimised else {
        return Err(Failure::Mismatch(format!(
            "the device in {} gets vector #{index} of {set} right: there is nothing to minimise",
            args.bench.display()
        )));
    };

    let path = minimised.write(&args.output)?;
    let vector = Vector::read(&path, 0)?;
    let device = vector.device_word(&minimised.got)?;
    let explanation = vector.explain(Some(&device));
    let mut out = io::stdout().lock();
    if args.json {
        let simplified = minimised.simplified.iter();
        let simplified = simplified.map(|[field, was, is]| json!({ "field": field, "was": was, "is": is }));
        writeln!(
            out,
            "{:#}",
            json!({
                "manifest": path.display().to_string(), "stage": minimised.stage, "runs": minimised.runs,
                "minimal": minimised.is_minimal, "simplified": simplified.collect::<Vec<_>>(),
                "explanation": explanation
            })
        )?;
    } else {
        describe(&mut out, &explanation, Some(&device), None)?;
        let mut table = new_table(["simplified", "was", "is"]);
        for row in &minimised.simplified {
            table.add_row(row);
        }
        writeln!(out, "{table}")?;
        writeln!(
            out,
            "{}: stage {} goes wrong; {} runs of the bench",
            path.display(),
            minimised.stage,
            minimised.runs
        )?;
    }
    if !minimised.is_minimal {
        complain(&format!("note: stopped after {} runs; more may be simpler (--runs)", minimised.runs));
    }
    Ok(())
}
