//! `roughxel ranges`.

use std::io::{self, Write};

use clap::Args;
use miette::miette;
use roughxel_cases::stimulus::port_values;
use roughxel_cases::{hard_case_sets, random_fragment};
use roughxel_core::design::Design;
use roughxel_core::plan::Effects;
use roughxel_core::ports::ReflectionIn;
use roughxel_core::precision::Precision;
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_netlist::graph::{Kind, Net, Tap};
use roughxel_netlist::interval::{Range, Ranges, Violation};
use roughxel_netlist::observe::Observed;
use roughxel_record as record;
use roughxel_utilities::random::SplitMix64;
use serde_json::{Value, json};

use super::console::{complain, new_table, progress};
use super::{Failure, Profiles, effects, open_scene, parse_profiles, parse_size};

pub(super) const LONG_HELP: &str = "\
Prove that no wire can overflow, for any bits at any port, and print the range of every named wire.

A row is an outcome of a stage. Intervals are values: the integer on the wire divided by 2^fraction.
  wire          stage and place in its outcome; `fraction` is its number of fraction bits
  proven        interval proven on the netlist; `bits` is its width in two's complement (a flag: 1)
  declared      bits of the wire: 32, or 64 for a wide one; `slack` is declared minus proven bits
  frame, sets   intervals observed over the fragments of a frame, and over all sets of hard cases and the random set;
                `observed bits` is the width of both together. Designs other than the reflection datapath get the
                ports that follow from a fragment; ports that follow from memories are random

Exit codes: 0 no wire can overflow; 1 one can: the source line of each is on stderr; 2 usage; 3 a value was observed
outside its proven interval.
Data goes to stdout, progress and errors to stderr.";

/// Makes the help of every `--design`.
pub(super) fn design_help() -> String {
    format!("Design: {}", design_names())
}

fn design_names() -> String {
    Design::ALL.iter().map(|design| design.name()).collect::<Vec<_>>().join(", ")
}

#[derive(Args)]
pub(super) struct RangesArgs {
    /// Profile: a name, a file (TOML) or `all`.
    #[arg(long, default_value = "standard", value_parser = parse_profiles, value_name = "NAME|FILE|all")]
    profile: Profiles,
    #[arg(long, default_value = "all", value_parser = effects::parse, value_name = "LIST", help = effects::HELP)]
    effects: Effects,
    #[arg(long, default_value = "reflection", value_parser = parse_designs, value_name = "NAME|all", help = design_help())]
    design: Designs,
    /// Scene of the frame: a file (TOML) or a built-in scene.
    #[arg(long, default_value = "lake", value_name = "SCENE")]
    scene: String,
    /// Size of the frame in pixels. Each reflecting pixel is observed.
    #[arg(long, default_value = "80x60", value_parser = parse_size, value_name = "WxH")]
    size: [u32; 2],
    /// Fragments of the random set.
    #[arg(long, default_value_t = 10_000, value_name = "N", value_parser = clap::value_parser!(u64).range(0..=1_000_000_000))]
    random: u64,
    /// Print the table as JSON, with integers instead of values.
    #[arg(long)]
    json: bool,
}

/// Designs of `--design`: one or all.
#[derive(Clone, Debug)]
struct Designs(Vec<Design>);

pub(super) fn parse_design(name: &str) -> Result<Design, String> {
    Design::by_name(name).ok_or_else(|| format!("designs are {}", design_names()))
}

fn parse_designs(name: &str) -> Result<Designs, String> {
    if name == "all" { Ok(Designs(Design::ALL.to_vec())) } else { parse_design(name).map(|one| Designs(vec![one])) }
}

/// Writes the violations of a design without proof to stderr and makes the failure.
pub(super) fn unproven(violations: &[Violation]) -> Failure {
    for violation in violations {
        complain(&format!("error: {violation}"));
    }
    let count = violations.len();
    Failure::Error(miette!("{count} operations may leave their wires"))
}

/// A design under one profile, with the observed ranges.
struct Surveyed<'a> {
    profile: &'a str,
    design: Design,
    net: Net,
    ranges: Ranges,
    frame: Observed,
    sets: Observed,
}

pub(super) fn run(args: &RangesArgs) -> Result<(), Failure> {
    let profiles = args.profile.open()?;
    let scene = open_scene(&args.scene, Some(args.size))?;

    let mut surveyed = Vec::new();
    for profile in &profiles {
        let p = &profile.precision;
        let pixels = scene.camera.width as usize * scene.camera.height as usize;
        let captured = Prepared::new(&scene, Mode::Footprint, p)?.capture(pixels)?;
        let frame: Vec<_> = captured.into_iter().map(|(fragment, _)| fragment).collect();
        let mut sets: Vec<_> = hard_case_sets(p).into_iter().flat_map(|set| set.cases).collect();
        sets.extend((0..args.random).map(|index| random_fragment("random", index, p)));
        let total = args.design.0.len() * (frame.len() + sets.len());
        let bar = progress(total as u64, &profile.name);
        for &design in &args.design.0 {
            let net = record::net(design, &args.effects, p);
            let ranges = Ranges::new(&net);
            let observe = |fragments: &[ReflectionIn], name| {
                let seen = observe(design, &net, fragments, &args.effects, p, name);
                bar.inc(fragments.len() as u64);
                seen
            };
            let (frame, sets) = (observe(&frame, "frame"), observe(&sets, "sets"));
            surveyed.push(Surveyed { profile: &profile.name, design, net, ranges, frame, sets });
        }
        bar.finish_and_clear();
    }

    let mut out = io::stdout().lock();
    if args.json {
        writeln!(out, "{:#}", json!(surveyed.iter().map(as_json).collect::<Vec<_>>()))?;
    } else {
        for one in &surveyed {
            writeln!(out, "{}\n{}", as_table(one), summary(one))?;
        }
    }
    out.flush()?;

    for one in &surveyed {
        let outside =
            [&one.frame, &one.sets].into_iter().find_map(|seen| Some((seen, seen.first_outside(&one.ranges)?)));
        if let Some((seen, id)) = outside {
            let observed = seen.of(id).map_or(String::new(), |range| range.to_string());
            let [proven, line] = [one.ranges.of(id).to_string(), one.net.origin(id)];
            return Err(Failure::Mismatch(format!("{line}: observed {observed}, outside the proven {proven}")));
        }
    }
    let violations: Vec<_> = surveyed.iter().flat_map(|one| one.ranges.violations.clone()).collect();
    if violations.is_empty() { Ok(()) } else { Err(unproven(&violations)) }
}

/// Observes the wires of a design for fragments.
fn observe(
    design: Design,
    net: &Net,
    fragments: &[ReflectionIn],
    effects: &Effects,
    p: &Precision,
    name: &str,
) -> Observed {
    let mut seen = Observed::new(net);
    for (index, fragment) in (0..).zip(fragments) {
        let mut random = SplitMix64::for_element(name, index);
        for ports in port_values(design, net, fragment, effects, p, &mut random) {
            seen.evaluate(net, &ports);
        }
    }
    seen
}

/// Counts the bits of a range in two's complement, low zeros included.
fn bits(range: Range, kind: Kind) -> u32 {
    let magnitude = 64 - range.high.max(-1 - range.low).max(0).leading_zeros();
    if kind == Kind::Flag { 1 } else { magnitude + 1 }
}

/// Counts the bits of a wire that both observations need.
fn seen_bits(one: &Surveyed<'_>, tap: &Tap) -> Option<u32> {
    let kind = one.net.node(tap.node).kind;
    [&one.frame, &one.sets].iter().filter_map(|seen| Some(bits(seen.of(tap.node)?, kind))).max()
}

fn slack(one: &Surveyed<'_>, tap: &Tap) -> u32 {
    let kind = one.net.node(tap.node).kind;
    kind.bits() - bits(one.ranges.of(tap.node), kind)
}

fn as_table(one: &Surveyed<'_>) -> comfy_table::Table {
    let title = format!("{}, {}", one.design.name(), one.profile);
    let mut table =
        new_table([&title, "fraction", "declared", "proven", "bits", "slack", "frame", "sets", "observed bits"]);
    for tap in &one.net.taps {
        let kind = one.net.node(tap.node).kind;
        let interval = |range: Range| {
            let value = |raw: i64| raw as f64 / f64::from(tap.fraction_bits).exp2();
            if range.low == range.high {
                short(value(range.low))
            } else {
                format!("{} … {}", short(value(range.low)), short(value(range.high)))
            }
        };
        let seen = |seen: &Observed| seen.of(tap.node).map_or(String::new(), interval);
        let proven = one.ranges.of(tap.node);
        table.add_row([
            one.net.tap_name(tap),
            tap.fraction_bits.to_string(),
            kind.bits().to_string(),
            interval(proven),
            bits(proven, kind).to_string(),
            slack(one, tap).to_string(),
            seen(&one.frame),
            seen(&one.sets),
            seen_bits(one, tap).map_or(String::new(), |bits| bits.to_string()),
        ]);
    }
    table
}

/// Formats a value with six decimals, or with four digits if it is smaller than that.
fn short(value: f64) -> String {
    let decimals = format!("{value:.6}");
    match decimals.trim_end_matches('0').trim_end_matches('.') {
        "0" | "-0" if value != 0.0 => format!("{value:.3e}"),
        text => text.into(),
    }
}

fn summary(one: &Surveyed<'_>) -> String {
    let words = || one.net.taps.iter().filter(|tap| one.net.node(tap.node).kind != Kind::Flag);
    let tightest = words().min_by_key(|tap| slack(one, tap));
    let tightest = tightest
        .map_or(String::new(), |tap| format!("; least slack {} bits: {}", slack(one, tap), one.net.tap_name(tap)));
    let verdict = match one.ranges.violations.len() {
        0 => "none can overflow".to_string(),
        count => format!("{count} MAY OVERFLOW"),
    };
    format!(
        "{}, {}: {} wires, {verdict}; {} named{tightest}; observed {} times in a frame, {} times over the sets",
        one.design.name(),
        one.profile,
        one.net.nodes.len(),
        one.net.taps.len(),
        one.frame.evaluations,
        one.sets.evaluations
    )
}

fn as_json(one: &Surveyed<'_>) -> Value {
    let interval = |range: Range| json!({ "low": range.low, "high": range.high, "zeros": range.zeros });
    let taps = one.net.taps.iter().map(|tap| {
        let kind = one.net.node(tap.node).kind;
        let proven = one.ranges.of(tap.node);
        json!({
            "wire": one.net.tap_name(tap),
            "fraction_bits": tap.fraction_bits,
            "declared_bits": kind.bits(),
            "proven": interval(proven),
            "proven_bits": bits(proven, kind),
            "slack_bits": slack(one, tap),
            "frame": one.frame.of(tap.node).map(interval),
            "sets": one.sets.of(tap.node).map(interval),
            "observed_bits": seen_bits(one, tap),
            "line": one.net.origin(tap.node),
        })
    });
    let violations = one.ranges.violations.iter().map(|v| json!({ "line": v.origin, "problem": v.problem }));
    json!({
        "design": one.design.name(),
        "profile": one.profile,
        "wires": one.net.nodes.len(),
        "frame_evaluations": one.frame.evaluations,
        "set_evaluations": one.sets.evaluations,
        "violations": violations.collect::<Vec<_>>(),
        "taps": taps.collect::<Vec<_>>(),
    })
}
