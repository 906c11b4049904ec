//! `roughxel vectors shrink`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use roughxel_vectors::{ShrinkError, ShrinkOptions, Vector, shrink};
use serde_json::json;

use super::explain::{describe, manifest_of, split, unreadable};
use crate::console::{complain, new_table, with_progress};
use crate::{Failure, check_directory};

pub(super) const LONG_HELP: &str = "\
Find the simplest inputs that a device still gets wrong in the same stage as a vector. Simple inputs have many zero fields, few bits in the
others, and small exponents. The device is the one in a testbench that `vectors bench` wrote for a set with the same fields. A copy of the
testbench is compiled once and runs on 64 candidates at a time.

  roughxel vectors bench vectors/smoke/random_standard.json -o benches      # with the device in benches/random_standard
  roughxel vectors shrink 'vectors/smoke/random_standard#3' --bench benches/random_standard -o DIR

DIR gets the vector as a set of one, SET_min_PROFILE. It is printed as `vectors explain` prints it, with the wrong fields of the device and
what was simplified. Candidates stay within the declared ranges of the ports.

Exit code 3: the device gets the vector right, so there is nothing to shrink.";

#[derive(Args)]
pub(crate) struct ShrinkArgs {
    /// Set (NAME, NAME.json, NAME.hex or NAME.bin) and index of the vector, from 0.
    #[arg(value_name = "SET#INDEX")]
    set: String,
    /// Index of the vector, if the first argument is the set alone.
    #[arg(long, value_name = "INDEX")]
    index: Option<u64>,
    /// Folder of the testbench with the device in it.
    #[arg(long, value_name = "DIR")]
    bench: PathBuf,
    /// Tool that runs the testbench, as its run.sh names it.
    #[arg(long, value_parser = ["icarus", "verilator", "cpp", "ghdl", "cocotb"], default_value = "icarus")]
    tool: String,
    /// Compare only the outputs of the datapath, for a device that does not show its stages.
    #[arg(long)]
    outputs_only: bool,
    /// Most runs of the testbench.
    #[arg(long, default_value_t = 200, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    runs: u32,
    /// Directory of the result; created if missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Print the result as JSON.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &ShrinkArgs) -> Result<(), Failure> {
    let (set, index) = split(&args.set, args.index)?;
    let manifest = manifest_of(Path::new(set))?;
    check_directory(&args.output)?;
    let options = ShrinkOptions { tool: args.tool.clone(), outputs_only: args.outputs_only, runs: args.runs };
    let runs = u64::from(args.runs);
    let shrunk = with_progress(runs, "testbench runs at most", |done| {
        shrink(&manifest, index, &args.bench, &options, &|runs| done(runs.into()))
    });
    let shrunk = shrunk.map_err(|error| match error {
        ShrinkError::Set(error) => unreadable(error),
        ShrinkError::OtherSet { .. } => Failure::Usage(error.to_string()),
        error => error.into(),
    })?;
    let Some(shrunk) = shrunk else {
        return Err(Failure::Mismatch(format!(
            "the device in {} gets vector #{index} of {set} right: there is nothing to shrink",
            args.bench.display()
        )));
    };

    let path = shrunk.write(&args.output)?;
    let vector = Vector::read(&path, 0)?;
    let device = vector.device_word(&shrunk.got)?;
    let explanation = vector.explain(Some(&device));
    let mut out = io::stdout().lock();
    if args.json {
        let simplified = shrunk.simplified.iter();
        let simplified = simplified.map(|[field, was, is]| json!({ "field": field, "was": was, "is": is }));
        writeln!(
            out,
            "{:#}",
            json!({
                "manifest": path.display().to_string(), "stage": shrunk.stage, "runs": shrunk.runs,
                "minimal": shrunk.is_minimal, "simplified": simplified.collect::<Vec<_>>(),
                "explanation": explanation
            })
        )?;
    } else {
        describe(&mut out, &explanation, Some(&device), None)?;
        let mut table = new_table(["simplified", "was", "is"]);
        for row in &shrunk.simplified {
            table.add_row(row);
        }
        writeln!(out, "{table}")?;
        writeln!(out, "{}: stage {} goes wrong; {} testbench runs", path.display(), shrunk.stage, shrunk.runs)?;
    }
    if !shrunk.is_minimal {
        complain(&format!("note: stopped after {} runs; more may be simpler (--runs)", shrunk.runs));
    }
    Ok(())
}
