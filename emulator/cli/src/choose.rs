//! `roughxel choose`.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{ArgGroup, Args};
use roughxel_core::knob::Knob;
use roughxel_core::precision::Profile;
use roughxel_netlist::verilog::knobs;
use roughxel_study::Subject;
use roughxel_study::choose::{Aim, Candidate, Clock, Meter, NoChoice, candidates, choose, measure, next_cheaper};
use roughxel_study::frame_meter::{Against, FrameMeter};
use roughxel_study::profile_file::{NamedPrecision, name_of_file, write_profile};
use roughxel_study::soft_core::{Machine, TARGETS, cores};
use serde_json::{Value, json};

use super::cache::CacheArgs;
use super::console::{new_table, progress};
use super::{Failure, check_file, open_scene, parse_size, use_threads};

pub(super) const LONG_HELP: &str = "\
Find the cheapest profile that is accurate enough, or the most accurate within a budget, and write its file.

Candidates are the named profiles and a grid: 12 to 28 kept fraction bits, with tables, levels and weights to match; direction of
the major axis exact, from 10 or 32 steps; 1 to 16 probes, a power of two or not; roughness isotropic or not.

  accuracy     PSNR of frames in linear light, of the worst scene, against the same frames in float64. `filter` compares
               with the filter of `standard` (error of the integers), `samples` with 1024 samples a pixel (error of
               filter and integers)
  host         time of a frame divided by that in `standard`, median of pairs drawn in turn, on the worst scene
  hardware     full adders of the designs that the largest object's fragments and fetches use: w x n for a multiplier of
               w by n bits, w x (digits - 1) for one by a constant, carry bits of adders and comparators. Tables and
               selects do not count
  softcore     clocks or instructions of a pixel on the processor of --core: a reflection with all effects, alone or in a
               batch, whichever takes less, and its probes with their texels. Clocks are predicted, within 10 % of the
               Verilog of the core. Cores differ in what multipliers, shifts and cache misses take, so they rank profiles
               differently: name the nearest one
  memory       texels of a pixel; each map and level counts separately

Accuracy decides between equal costs, and cost between equal accuracy. On the clock host, figures differ between runs.

Exit codes: 0 done, 1 failure, 2 usage, 3 no profile is accurate or cheap enough: the nearest is printed, no file is written.
Data goes to stdout, progress and errors to stderr.";

#[derive(Args)]
#[command(group(ArgGroup::new("aim").required(true).args(["psnr", "budget"])))]
pub(super) struct ChooseArgs {
    /// Choose the cheapest profile with at least this accuracy of the worst scene, in dB.
    #[arg(long, value_parser = parse_positive, value_name = "DB")]
    psnr: Option<f64>,
    /// Choose the most accurate profile with at most this cost, in the unit of the clock.
    #[arg(long, value_parser = parse_positive, value_name = "COST")]
    budget: Option<f64>,
    /// Scene file (TOML) or built-in scene. Repeat it for more scenes.
    #[arg(long, default_values = ["lake", "zebra", "globe"], value_name = "SCENE")]
    scene: Vec<String>,
    /// Cost to count: host, hardware, softcore or memory.
    #[arg(long, default_value_t = Clock::Hardware, value_name = "CLOCK")]
    clock: Clock,
    /// Processor of the clock softcore: a soft core, whose clocks count, or a processor, whose instructions count. Without it
    /// vexriscv-standard, the usual core of LiteX.
    #[arg(long, value_parser = machines(), value_name = "NAME")]
    core: Option<Machine>,
    /// Frames to compare with: filter or samples.
    #[arg(long, default_value_t = Against::Filter, value_name = "TRUTH")]
    against: Against,
    /// Size of the frames in pixels.
    #[arg(long, default_value = "160x120", value_parser = parse_size, value_name = "WxH")]
    size: [u32; 2],
    /// Profile file to write. Its name becomes that of the profile.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Number of threads, at most one per core.
    #[arg(long, value_name = "N", value_parser = super::parse_threads)]
    threads: Option<usize>,
    #[command(flatten)]
    cache: CacheArgs,
    /// Print everything as JSON.
    #[arg(long)]
    json: bool,
}

/// Cores and processors with their descriptions.
fn machines() -> impl TypedValueParser<Value = Machine> {
    let cores = cores().iter().map(|core| PossibleValue::new(&*core.name).help(&*core.about));
    let processors = TARGETS.map(|target| PossibleValue::new(target).help("instructions, counted in QEMU"));
    PossibleValuesParser::new(cores.chain(processors)).try_map(|name| name.parse::<Machine>())
}

fn parse_positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "give a number above 0".into())
}

pub(super) fn run(args: &ChooseArgs) -> Result<(), Failure> {
    use_threads(args.threads)?;
    let (clock, output) = (args.clock, &args.output);
    if args.core.is_some() && clock != Clock::SoftCore {
        return Err(Failure::Usage(format!("--core belongs to the clock softcore; --clock is {clock}")));
    }
    let machine = args.core.unwrap_or_default();
    // Name and file are checked before minutes of work.
    let name = name_of_file(output);
    if Profile::by_name(&name).is_some() {
        return Err(Failure::Usage(format!("`{name}` is the name of a profile; give the file another name")));
    }
    check_file(output)?;

    let subjects = args.scene.iter().map(|scene| {
        let scene = open_scene(scene, Some(args.size))?;
        let peaks = args.cache.peaks(&scene, true)?;
        Ok(Subject::new(scene, peaks))
    });
    let subjects = subjects.collect::<Result<Vec<_>, Failure>>()?;
    let bar = progress(FrameMeter::work(&subjects), "float64");
    let meter = FrameMeter::new(&subjects, args.against, machine, &|| bar.inc(1))?;
    bar.finish_and_clear();

    let aim = args.psnr.map(Aim::Psnr).or(args.budget.map(Aim::Budget)).unwrap_or(Aim::Psnr(f64::NAN));
    let candidates = candidates();
    let count = candidates.len() as u64;
    let bars = [progress(count, &format!("cost, {clock}")), progress(count, "accuracy")];
    let cost = |p: &_| {
        bars[0].inc(1);
        meter.cost(clock, p)
    };
    let psnr = |p: &_| {
        bars[1].inc(1);
        meter.psnr(p)
    };
    let measured = measure(&candidates, aim, clock, cost, psnr);
    bars.iter().for_each(indicatif::ProgressBar::finish_and_clear);
    let chosen = choose(&measured, aim, clock).map_err(|none| match none {
        NoChoice::Unknown(_) => none.into(),
        NoChoice::Missed { .. } => Failure::Mismatch(none.to_string()),
    })?;
    let on_all_clocks = |candidate: &Candidate| {
        let cost = |of| candidate.cost_on(of).or_else(|| meter.cost(of, &candidate.precision));
        Candidate { cost: Clock::ALL.map(cost), ..candidate.clone() }
    };
    let next = next_cheaper(&measured, chosen, clock).map(on_all_clocks);
    let chosen = on_all_clocks(chosen);

    let comments = comments(args, machine, &chosen);
    write_profile(output, &NamedPrecision::new(&name, chosen.precision)?, &comments)?;
    let mut out = io::stdout().lock();
    if args.json {
        let result = json!({
            "profile": output.display().to_string(), "psnr_db": args.psnr, "budget": args.budget, "clock": clock.name(),
            "softcore": { "core": machine.name(), "unit": machine.unit() },
            "scenes": args.scene, "against": args.against.to_string(), "candidates": count, "measured": measured.len(),
            "chosen": as_json(&chosen), "next_cheaper": next.as_ref().map(as_json),
        });
        writeln!(out, "{result:#}")?;
        return Ok(());
    }
    writeln!(out, "{}: {}", output.display(), comments.join("; "))?;
    writeln!(out, "{}", table(machine, &chosen, next.as_ref()))?;
    match (next, args.psnr) {
        (Some(next), Some(bar)) if next.psnr < bar => {
            writeln!(out, "The next cheaper one misses the bar by {:.2} dB.", bar - next.psnr)?;
        }
        _ => {}
    }
    writeln!(out, "{} of {count} profiles were measured.", measured.len())?;
    Ok(())
}

/// Makes the comment lines at the head of the file: what was chosen and why.
fn comments(args: &ChooseArgs, machine: Machine, chosen: &Candidate) -> Vec<String> {
    let (clock, [width, height]) = (named(args.clock, machine), args.size);
    let aim = match (args.psnr, args.budget) {
        (Some(bar), _) => format!("the cheapest on the clock {clock} of at least {bar} dB"),
        (_, budget) => format!("the most accurate of at most {} on the clock {clock}", budget.unwrap_or_default()),
    };
    let found = format!("{:.2} dB against {}, cost {}", chosen.psnr, args.against, figure(chosen.cost_on(args.clock)));
    let same = chosen.name.iter().map(|name| format!("the knobs of {name}"));
    [aim, format!("{}, {width}x{height}: {found}", args.scene.join(", "))].into_iter().chain(same).collect()
}

/// Name of a clock, with the unit of a soft core.
fn named(clock: Clock, machine: Machine) -> String {
    if clock == Clock::SoftCore { format!("{clock} ({machine})") } else { clock.to_string() }
}

fn figure(cost: Option<f64>) -> String {
    match cost {
        None => "not known".into(),
        Some(cost) if cost.fract() == 0.0 => format!("{cost}"),
        Some(cost) => format!("{cost:.3}"),
    }
}

/// Builds the table of knobs and figures, one per row.
fn table(machine: Machine, chosen: &Candidate, next: Option<&Candidate>) -> comfy_table::Table {
    let mut table = new_table(["", "chosen", "next cheaper"]);
    let mut row = |name: &str, text: &dyn Fn(&Candidate) -> String| {
        table.add_row([name.to_owned(), text(chosen), next.map_or_else(String::new, text)]);
    };
    for knob in Knob::ALL {
        row(knob.name(), &|of| knob.text(knob.value_in(&of.precision)).to_string());
    }
    row("PSNR", &|of| format!("{:.2} dB", of.psnr));
    for clock in Clock::ALL {
        row(&named(clock, machine), &|of| figure(of.cost_on(clock)));
    }
    table
}

fn as_json(candidate: &Candidate) -> Value {
    let costs = Clock::ALL.map(|clock| (clock.name().to_owned(), json!(candidate.cost_on(clock))));
    json!({
        "name": candidate.name, "psnr_db": candidate.psnr, "knobs": knobs(&candidate.precision),
        "cost": Value::Object(costs.into_iter().collect()),
    })
}
