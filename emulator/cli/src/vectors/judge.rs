//! `roughxel vectors judge`.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use roughxel_vectors::{Failing, Judgement, Manifest, Tier, judge};
use serde_json::json;

use super::explain::manifest_of;
use crate::Failure;
use crate::console::with_progress;

pub(super) const LONG_HELP: &str = "\
Judge the words of a device by an acceptance tier.

  exact     every bit of every field is that of the set
  faithful  each reciprocal 1/2x and inverse root 1/2√x of the datapath (SPEC.md) may be one last place of the profile more or less than
            ours, still in [½, 1]; whatever follows from them is exact
  bound     whatever the datapath rounds may be up to --places last places more or less. A number may then differ by the sum of what each
            rounding alone makes of it in that vector, plus --places of its own; a decision (face, count of probes, status) may be what it is
            in some such device (`roughxel vectors marks` lists where there is more than one)

GOT has the words of a device in the order of the set: the same fields, inputs included, as text with or without underscores, or, in a
file NAME.bin, as records of bytes. The check value of a word may be anything.

Faithful is judged on the operations themselves: the outcomes of stages that a word has are asked in the order of the pipeline, and a vector
passes if some choice of neighbours gives all of them. So the stage that is named is the first one whose outcome does not follow from
the device's own values before it. Of a set without taps there may be too many choices; then the command says so.";

#[derive(Args)]
pub(crate) struct JudgeArgs {
    /// Words of the device.
    #[arg(value_name = "GOT")]
    got: PathBuf,
    /// The set that the device was given: NAME.json, NAME.hex or NAME.bin, or the same without its extension.
    #[arg(long, value_name = "SET")]
    set: PathBuf,
    /// What the device has to give.
    #[arg(long, value_enum, default_value = "exact")]
    tier: TierArg,
    /// Last places that each rounding may be off, of tier bound.
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MOST_PLACES))]
    places: u32,
    /// Result as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum TierArg {
    Exact,
    Faithful,
    Bound,
}

/// Most last places that a rounding may be off: beyond, first order says nothing of words of 16 bits.
pub(super) const MOST_PLACES: i64 = 64;

pub(super) fn run(args: &JudgeArgs) -> Result<(), Failure> {
    let tier = match args.tier {
        TierArg::Exact => Tier::Exact,
        TierArg::Faithful => Tier::Faithful,
        TierArg::Bound => Tier::Bound { places: args.places },
    };
    let manifest = manifest_of(&args.set)?;
    let count = Manifest::read(&manifest)?.count;
    let judgement = with_progress(count, tier.name(), |done| judge(&args.got, &manifest, tier, done))?;
    let mut out = io::stdout().lock();
    if args.json {
        writeln!(out, "{:#}", json!(judgement))?;
    } else {
        describe(&mut out, &judgement)?;
    }
    out.flush()?;
    let (count, failing) = (judgement.count, judgement.count - judgement.passing);
    if failing > 0 {
        return Err(Failure::Mismatch(format!("{failing} of {count} vectors are not {}", tier.adjective())));
    }
    Ok(())
}

fn describe(out: &mut impl Write, judgement: &Judgement) -> io::Result<()> {
    let Judgement { set, profile, tier, count, exact, passing, failures } = judgement;
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
