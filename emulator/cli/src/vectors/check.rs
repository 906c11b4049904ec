//! `roughxel vectors check`.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use roughxel_vectors::{CheckResult, Failing, Manifest, Tier, check};
use serde_json::json;

use super::explain::manifest_of;
use crate::Failure;
use crate::console::with_progress;

pub(super) const LONG_HELP: &str = "\
Check the words of a device by an acceptance tier.

  exact     every bit of every field is that of the set
  faithful  each reciprocal 1/2x and inverse root 1/2√x of the datapath (SPEC.md) may be one last place of the profile more or less than
            ours, still in [½, 1]; everything computed from them is exact
  bound     each rounding may be up to --places last places more or less. A number may differ by the sum of the effects of each rounding
            alone in that vector, plus --places. A decision (face, probe count, status) may be that of any such device
            (`roughxel vectors ambiguous` lists the vectors with more than one)

GOT has the words of a device in the order of the set: the same fields, inputs included. Words are text with or without underscores, or byte
records in a file NAME.bin. The check value of a word may be anything.

Tier faithful checks operations. It follows the stage outcomes of a word in the order of the pipeline. A vector passes if some choice of
neighbours gives all of them. The stage that is named is the first whose outcome does not follow from the device's own earlier values. A set
without taps may leave too many choices; the command then says so.";

#[derive(Args)]
pub(crate) struct CheckArgs {
    /// Words of the device.
    #[arg(value_name = "GOT")]
    got: PathBuf,
    /// Set that the device was given: NAME.json, NAME.hex, NAME.bin, or NAME.
    #[arg(long, value_name = "SET")]
    set: PathBuf,
    /// Acceptance tier.
    #[arg(long, value_enum, default_value = "exact")]
    tier: TierArg,
    /// Last places that each rounding may be off, for tier bound.
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MOST_PLACES))]
    places: u32,
    /// Print the result as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum TierArg {
    Exact,
    Faithful,
    Bound,
}

/// Most last places that a rounding may be off. Beyond that, a first-order bound says nothing about 16-bit words.
pub(super) const MOST_PLACES: i64 = 64;

pub(super) fn run(args: &CheckArgs) -> Result<(), Failure> {
    let tier = match args.tier {
        TierArg::Exact => Tier::Exact,
        TierArg::Faithful => Tier::Faithful,
        TierArg::Bound => Tier::Bound { places: args.places },
    };
    let manifest = manifest_of(&args.set)?;
    let count = Manifest::read(&manifest)?.count;
    let result = with_progress(count, tier.name(), |done| check(&args.got, &manifest, tier, done))?;
    let mut out = io::stdout().lock();
    if args.json {
        writeln!(out, "{:#}", json!(result))?;
    } else {
        describe(&mut out, &result)?;
    }
    out.flush()?;
    let (count, failing) = (result.count, result.count - result.passing);
    if failing > 0 {
        return Err(Failure::Mismatch(format!("{failing} of {count} vectors are not {}", tier.adjective())));
    }
    Ok(())
}

fn describe(out: &mut impl Write, result: &CheckResult) -> io::Result<()> {
    let CheckResult { set, profile, tier, count, exact, passing, failures } = result;
    writeln!(out, "{set} ({profile}): {count} vectors")?;
    writeln!(out, "exact    {exact} of {count}")?;
    match tier {
        Tier::Exact => {}
        Tier::Faithful => writeln!(out, "faithful {passing} of {count}")?,
        Tier::Bound { places } => {
            writeln!(
                out,
                "bound    {passing} of {count}, roundings {places} last place{} off",
                if *places == 1 { "" } else { "s" }
            )?;
        }
    }
    for Failing { index, line, stage, field, got, expected, within, got_real, expected_real } in failures {
        let within = within.map_or_else(String::new, |places| format!(" within {places:.1} last places"));
        writeln!(
            out,
            "  {set} #{index} (line {line}): stage {stage}, field {field}: got {got} ({got_real}), expected {expected} ({expected_real}){within}"
        )?;
    }
    let more = count - passing - failures.len() as u64;
    if more > 0 {
        writeln!(out, "  and {more} more")?;
    }
    Ok(())
}
