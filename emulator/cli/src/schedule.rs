//! `roughxel schedule`.

use std::io::{self, Write};

use clap::Args;
use roughxel_core::design::Design;
use roughxel_core::plan::{Effects, FrameSystem};
use roughxel_netlist::target::Target;
use roughxel_netlist::verilog::{FoldSummary, Folded, Options, VerilogError};
use roughxel_record as record;
use serde_json::json;

use super::console::new_table;
use super::ranges::{design_help, parse_design, unproven};
use super::verilog::parse_target;
use super::{Failure, ProfileArg, effects, parse_profile};

pub(super) const LONG_HELP: &str = "\
Show how a design is folded on a few multipliers: how often it takes a fragment, and what it needs for that.

  interval    cycles from a fragment to the next; in brackets the least that the multipliers allow
  latency     cycles from an accepted fragment to its output
  busy        share of the cycles in which the multipliers have operands
  units       shared hardware besides multipliers: normalisers, shifters by a count, tables
  glue        operations with hardware of their own: adders, comparators, selects, logic
  values      registers that hold a value from one cycle to later ones

`roughxel verilog --multipliers COUNT` writes the design and its slot table.

Exit codes: 0 done, 1 the design is not proven and so has no widths, 2 usage.
Data goes to stdout, progress and errors to stderr.";

#[derive(Args)]
pub(super) struct ScheduleArgs {
    /// Multipliers: a comma list, one schedule each.
    #[arg(long, default_value = "1,2,4,8,16,32", value_delimiter = ',', value_name = "COUNTS", value_parser = clap::value_parser!(u32).range(1..=1024))]
    multipliers: Vec<u32>,
    /// Profile: a name or a file (TOML).
    #[arg(long, default_value = "standard", value_parser = parse_profile, value_name = "NAME|FILE")]
    profile: ProfileArg,
    #[arg(long, default_value = "all", value_parser = effects::parse, value_name = "LIST", help = effects::HELP)]
    effects: Effects,
    /// Tangent basis.
    #[arg(long, default_value = "main", value_parser = effects::parse_frame, value_name = "main|natural|natural-normalised")]
    frame: FrameSystem,
    #[arg(long, default_value = "reflection", value_parser = parse_design, value_name = "NAME", help = design_help())]
    design: Design,
    /// Device: what a level of `--depth` is there, and the depth without that option. `asic` counts gates.
    #[arg(long, default_value = "asic", value_parser = parse_target, value_name = "asic|ice40|ecp5|gowin|xc7")]
    target: Target,
    /// Most logic levels in a cycle.
    #[arg(long, value_name = "LEVELS", value_parser = clap::value_parser!(u32).range(1..=1000))]
    depth: Option<u32>,
    /// Outputs that are ports, as paths or beginnings of paths: `probes,point.st,status`. What only other outputs need takes no cycle. Without this
    /// option the outcomes of all stages are ports.
    #[arg(long, value_delimiter = ',', value_name = "LIST")]
    outputs: Vec<String>,
    /// List every use of a unit: unit, phase, cycle, run of a repeated stage, operation.
    #[arg(long)]
    slots: bool,
    /// Print everything as JSON.
    #[arg(long)]
    json: bool,
}

/// Share of the cycles in which the units of a kind have operands, per cent.
fn busy(summary: &FoldSummary, kind: usize) -> f64 {
    summary.units.get(kind).map_or(0.0, |kind| f64::from(100 * kind.uses) / f64::from(kind.units * summary.interval))
}

/// Units whose name begins with a word: how many, and for how many uses.
fn units(summary: &FoldSummary, word: &str) -> String {
    let of_kind = summary.units.iter().filter(|kind| kind.name.contains(word));
    let (units, uses) = of_kind.fold((0, 0), |(units, uses), kind| (units + kind.units, uses + kind.uses));
    if uses == 0 { String::new() } else { format!("{units} ({uses})") }
}

pub(super) fn run(args: &ScheduleArgs) -> Result<(), Failure> {
    let profile = args.profile.open()?;
    let effects = Effects { frame: args.frame, ..args.effects };
    let net = record::net(args.design, &effects, &profile.precision);
    let fold = |&multipliers: &u32| {
        let options = Options {
            multipliers: Some(multipliers),
            depth: args.depth,
            target: args.target,
            outputs: args.outputs.clone(),
            ..Options::new(&profile.name, profile.precision, effects)
        };
        match Folded::from_net(net.clone(), &options) {
            Err(VerilogError::Unproven(violations)) => Err(unproven(&violations)),
            Err(error @ VerilogError::UnknownOutput(_)) => Err(Failure::Usage(error.to_string())),
            other => Ok((multipliers, other?)),
        }
    };
    let folded = args.multipliers.iter().map(fold).collect::<Result<Vec<_>, Failure>>()?;
    let mut out = io::stdout().lock();
    if args.json {
        let schedules = folded.iter().map(|(multipliers, folded)| {
            let mut schedule = json!({ "multipliers": multipliers, "summary": folded.summary() });
            if args.slots {
                schedule["slots"] = json!(folded.slots());
            }
            schedule
        });
        writeln!(out, "{:#}", json!(schedules.collect::<Vec<_>>()))?;
        return Ok(());
    }
    writeln!(out, "{}, profile {}", args.design.name(), profile.name)?;
    let mut table = new_table([
        "multipliers",
        "interval",
        "latency",
        "busy",
        "normalisers (uses)",
        "shifters (uses)",
        "tables (uses)",
        "glue",
        "values",
    ]);
    for (multipliers, folded) in &folded {
        let summary = folded.summary();
        table.add_row([
            multipliers.to_string(),
            format!("{} ({})", summary.interval, summary.bound),
            summary.latency.to_string(),
            format!("{:.0} %", busy(&summary, 0)),
            units(&summary, "normaliser"),
            units(&summary, "shifter"),
            units(&summary, "table"),
            summary.glue.to_string(),
            summary.values.to_string(),
        ]);
    }
    writeln!(out, "{table}")?;
    for (multipliers, folded) in folded.iter().filter(|_| args.slots) {
        writeln!(out, "\n{multipliers} multipliers. {}", folded.slot_table())?;
    }
    Ok(())
}
