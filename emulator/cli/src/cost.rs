//! `roughxel cost`.

use std::collections::BTreeMap;
use std::io::{self, Write};

use clap::Args;
use roughxel_core::design::Design;
use roughxel_core::plan::Effects;
use roughxel_netlist::census::{Census, Cost, Units};
use roughxel_netlist::delay::{arrival, arrival_in_block, critical_path, levels};
use roughxel_netlist::graph::Net;
use roughxel_netlist::interval::Ranges;
use roughxel_record as record;
use serde_json::{Value, json};

use super::console::new_table;
use super::ranges::{design_help, parse_design, unproven};
use super::{Failure, Profiles, effects, parse_profiles};

pub(super) const LONG_HELP: &str = "\
Count what a design costs in hardware. Nothing is shared: a stage that runs several times counts each time.

Widths are those that the proof of `roughxel ranges` leaves, without constant low zeros.
  multipliers     by operand widths, bits in two's complement; those by a constant: bits x non-zero signed digits
  adders          adders and subtracters of two wires; `constant` ones add a constant (increments, roundings)
  bits            of adders and comparators: places with a carry; of selects, logic and counters: width
  shifters        by a count on a wire; bits are selects, width times bits of the count
  ROM             bits of every table that can be read, once a stage
  levels          gate levels of the longest path: for a stage from its inputs to its outcomes, in total from ports to
                  outputs without a register. One level is a gate of two inputs or a select. For w bits: adder
                  ceil(log2 w)+2, comparator one less, shifter bits of the count, leading zeros ceil(log2 w)+1, table
                  ceil(log2 entries), multiplier 1 + 2 x (levels of its carry-save tree) + adder; the rest is wires

Exit codes: 0 done, 1 the design is not proven and so has no widths, 2 usage.
Data goes to stdout, progress and errors to stderr.";

#[derive(Args)]
pub(super) struct CostArgs {
    /// Profile: a name, a file (TOML) or `all`.
    #[arg(long, default_value = "all", value_parser = parse_profiles, value_name = "NAME|FILE|all")]
    profile: Profiles,
    #[arg(long, default_value = "all", value_parser = effects::parse, value_name = "LIST", help = effects::HELP)]
    effects: Effects,
    #[arg(long, default_value = "reflection", value_parser = parse_design, value_name = "NAME", help = design_help())]
    design: Design,
    /// List the critical path of a stage, of one run of a stage, or of the whole design by its name: levels, operation, bits and
    /// source line.
    #[arg(long, value_name = "STAGE|DESIGN")]
    path: Option<String>,
    /// Print everything as JSON, with the cost of each run.
    #[arg(long)]
    json: bool,
}

/// Cost of a design under one profile.
struct Measured<'a> {
    profile: &'a str,
    net: Net,
    ranges: Ranges,
    census: Census,
}

pub(super) fn run(args: &CostArgs) -> Result<(), Failure> {
    let profiles = args.profile.open()?;
    let mut measured = Vec::new();
    for profile in &profiles {
        let net = record::net(args.design, &args.effects, &profile.precision);
        let ranges = Ranges::new(&net);
        if !ranges.violations.is_empty() {
            return Err(unproven(&ranges.violations));
        }
        let census = Census::new(&net, &ranges);
        measured.push(Measured { profile: &profile.name, net, ranges, census });
    }
    let mut out = io::stdout().lock();
    if let Some(name) = &args.path {
        let paths: Vec<_> = measured.iter().map(|one| path(one, args.design.name(), name)).collect::<Result<_, _>>()?;
        if args.json {
            let paths = measured.iter().zip(paths).map(|(one, path)| json!({ "profile": one.profile, "path": path }));
            writeln!(out, "{:#}", json!(paths.collect::<Vec<_>>()))?;
        } else {
            for (one, path) in measured.iter().zip(paths) {
                let mut table = new_table(["level", "operation", "bits", &format!("{name}, {}", one.profile)]);
                table.add_rows(path);
                writeln!(out, "{table}")?;
            }
        }
        return Ok(());
    }
    if args.json {
        let all: Vec<_> = measured.iter().map(|one| as_json(args.design.name(), one)).collect();
        writeln!(out, "{:#}", json!(all))?;
        return Ok(());
    }
    writeln!(out, "{}: {}", args.design.name(), args.design.description())?;
    writeln!(out, "{}", totals(&measured))?;
    if let [one] = measured.as_slice() {
        writeln!(out, "{}", stages(one))?;
    } else {
        let table = side_by_side(&measured);
        writeln!(out, "multipliers / bits of adders and comparators / bits of ROM / levels\n{table}")?;
    }
    Ok(())
}

/// Lists the steps of a critical path: level at which each is done, operation, bits, source line.
fn path(one: &Measured<'_>, design: &str, name: &str) -> Result<Vec<[String; 4]>, Failure> {
    let Measured { net, ranges, census, .. } = one;
    let run = if name == design {
        None
    } else {
        let named = (0..).zip(&net.runs).filter(|(_, run)| run.base() == name || run.instance() == name);
        let Some((slowest, _)) = named.max_by_key(|&(run, _)| census.runs[run as usize].levels) else {
            let stages: Vec<_> = census.stages.iter().map(|stage| stage.stage).collect();
            return Err(Failure::Usage(format!("`{name}` is no stage of {design}; there are {}", stages.join(", "))));
        };
        Some(slowest)
    };
    let times = if run.is_some() { arrival_in_block(net, ranges) } else { arrival(net, ranges) };
    let step = |id| {
        let op = net.node(id).op;
        let widths: Vec<_> = op.operands().map(|operand| ranges.of(operand).width().to_string()).collect();
        let level = format!("{} (+{})", times[id as usize], levels(net, ranges, id));
        [level, op.name().into(), widths.join(", "), net.origin(id)]
    };
    Ok(critical_path(net, ranges, run).into_iter().map(step).collect())
}

/// Formats units as `count (bits)`.
fn units(units: Units) -> String {
    if units.count == 0 { String::new() } else { format!("{} ({})", units.count, units.bits) }
}

fn number(count: u64) -> String {
    if count == 0 { String::new() } else { count.to_string() }
}

/// Name of a figure, heading of its narrow column, and its text.
type Figure = (&'static str, &'static str, fn(&Cost) -> String);

const FIGURES: [Figure; 12] = [
    ("multipliers", "mul", |cost| number(cost.multiplier_count().into())),
    ("multipliers by a constant", "mul\nconst", |cost| number(cost.constant_multipliers.values().sum::<u32>().into())),
    ("adders (bits)", "add", |cost| units(cost.adders)),
    ("adders of a constant (bits)", "add\nconst", |cost| units(cost.constant_adders)),
    ("comparators (bits)", "compare", |cost| units(cost.comparators)),
    ("selects (bits)", "select", |cost| units(cost.selects)),
    ("shifters (bits)", "shift", |cost| units(cost.shifters)),
    ("leading-zero counters (bits)", "zeros", |cost| units(cost.leading_zeros)),
    ("logic (bits)", "logic", |cost| units(cost.logic)),
    ("ROM bits", "ROM\nbits", |cost| number(cost.rom_bits())),
    ("ROM reads", "ROM\nreads", |cost| number(cost.lookups.into())),
    ("levels", "levels", |cost| number(cost.levels.into())),
];

/// Builds the table of totals: a row for each figure, multipliers by width first, and a column for each profile.
fn totals(measured: &[Measured<'_>]) -> comfy_table::Table {
    let mut table = new_table([""]);
    table.set_header(["total"].into_iter().chain(measured.iter().map(|one| one.profile)));
    let mut widths = BTreeMap::new();
    for one in measured {
        widths.extend(one.census.total.multipliers.keys().map(|widths| (*widths, ())));
    }
    let row = |name: String, figure: &dyn Fn(&Cost) -> String| {
        std::iter::once(name).chain(measured.iter().map(|one| figure(&one.census.total))).collect::<Vec<_>>()
    };
    for [wide, narrow] in widths.into_keys().rev() {
        let count = |cost: &Cost| number(cost.multipliers.get(&[wide, narrow]).copied().unwrap_or(0).into());
        table.add_row(row(format!("multipliers {wide} x {narrow}"), &count));
    }
    for (name, _, figure) in FIGURES {
        table.add_row(row(name.into(), &figure));
    }
    table
}

/// Builds the table of one profile: a row for each stage and a column for each figure.
fn stages(one: &Measured<'_>) -> comfy_table::Table {
    let mut table = new_table([""]);
    table.set_header([one.profile, "runs"].into_iter().chain(FIGURES.map(|(_, heading, _)| heading)));
    for stage in &one.census.stages {
        let figures = FIGURES.iter().map(|(.., figure)| figure(&stage.cost));
        table.add_row([stage.stage.to_string(), stage.runs.to_string()].into_iter().chain(figures));
    }
    table
}

/// Builds the table of several profiles: a row for each stage and a column for each profile.
fn side_by_side(measured: &[Measured<'_>]) -> comfy_table::Table {
    let mut table = new_table([""]);
    table.set_header(["stage", "runs"].into_iter().chain(measured.iter().map(|one| one.profile)));
    let Some(first) = measured.first() else { return table };
    for (index, stage) in first.census.stages.iter().enumerate() {
        let cells = measured.iter().map(|one| {
            let cost = &one.census.stages[index].cost;
            format!("{} / {} / {} / {}", cost.multiplier_count(), cost.carry_bits(), cost.rom_bits(), cost.levels)
        });
        table.add_row([stage.stage.to_string(), stage.runs.to_string()].into_iter().chain(cells));
    }
    table
}

fn as_json(design: &str, one: &Measured<'_>) -> Value {
    let Measured { profile, net, census, .. } = one;
    let stages = census
        .stages
        .iter()
        .map(|stage| json!({ "stage": stage.stage, "runs": stage.runs, "cost": cost_json(&stage.cost) }));
    let runs = net.runs.iter().zip(&census.runs);
    let runs = runs.map(|(run, cost)| json!({ "run": run.instance(), "cost": cost_json(cost) }));
    json!({
        "design": design,
        "profile": profile,
        "total": cost_json(&census.total),
        "stages": stages.collect::<Vec<_>>(),
        "runs": runs.collect::<Vec<_>>(),
    })
}

fn cost_json(cost: &Cost) -> Value {
    let list = |map: &BTreeMap<[u32; 2], u32>, names: [&str; 2]| -> Vec<Value> {
        map.iter().map(|([a, b], count)| json!({ names[0]: a, names[1]: b, "count": count })).collect()
    };
    let units = |units: Units| json!({ "count": units.count, "bits": units.bits });
    json!({
        "multipliers": list(&cost.multipliers, ["bits", "by_bits"]),
        "constant_multipliers": list(&cost.constant_multipliers, ["bits", "digits"]),
        "adders": units(cost.adders),
        "constant_adders": units(cost.constant_adders),
        "comparators": units(cost.comparators),
        "selects": units(cost.selects),
        "shifters": units(cost.shifters),
        "leading_zeros": units(cost.leading_zeros),
        "logic": units(cost.logic),
        "tables": list(&cost.tables, ["entries", "bits"]),
        "rom_bits": cost.rom_bits(),
        "lookups": cost.lookups,
        "wires": cost.wires,
        "levels": cost.levels,
    })
}
