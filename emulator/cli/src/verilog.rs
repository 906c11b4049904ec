//! `roughxel verilog`.

mod earlier;

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use roughxel_core::design::Design;
use roughxel_core::plan::{Effects, FrameSystem};
use roughxel_netlist::target::Target;
use roughxel_netlist::verilog::{Options, STREAM_BITS, Verilog, VerilogError};
use roughxel_record as record;
use roughxel_study::plan::fetches;
use roughxel_study::profile_file::NamedPrecision;
use roughxel_utilities::output::write_files;
use roughxel_vectors::shell_bench;
use serde_json::json;

use super::console::{complain, progress};
use super::effects::PlannedObject;
use super::ranges::{design_help, parse_design, unproven};
use super::{Failure, ProfileArg, check_directory, effects, parse_profile};

#[derive(Args)]
pub(super) struct VerilogArgs {
    /// Directory to write to; created if missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[arg(long, default_value = "fragment", value_parser = parse_design, value_name = "NAME", help = design_help())]
    design: Design,
    /// Profile: a name or a file (TOML).
    #[arg(long, default_value = "standard", value_parser = parse_profile, value_name = "NAME|FILE")]
    profile: ProfileArg,
    #[arg(long, default_value = "all", value_parser = effects::parse, help = effects::HELP, value_name = "LIST")]
    effects: Effects,
    /// Tangent basis.
    #[arg(long, default_value = "main", value_parser = effects::parse_frame, value_name = "main|natural|natural-normalised")]
    frame: FrameSystem,
    /// Scene file (TOML) or built-in scene. Designs are the datapaths and fetches that its objects need, each in
    /// DIR/OBJECT/DESIGN.
    #[arg(long, value_name = "SCENE", conflicts_with_all = ["design", "effects", "frame", "stage"])]
    scene: Option<String>,
    /// Write only the modules of this stage (`columns`) or of this run of it (`columns_pixel`), and what they use.
    #[arg(long, value_name = "NAME")]
    stage: Option<String>,
    /// Most logic levels between two registers: a level is a gate of two inputs, and a 32-bit adder has 7. Without this option,
    /// registers are between stages only.
    #[arg(long, value_name = "LEVELS", value_parser = clap::value_parser!(u32).range(1..=1000))]
    depth: Option<u32>,
    /// Device: what a level of `--depth` is there, and the depth without that option. `asic` counts gates, and a flat design has registers
    /// between stages only.
    #[arg(long, default_value = "asic", value_parser = parse_target, value_name = "asic|ice40|ecp5|gowin|xc7")]
    target: Target,
    /// Fold the design on this many multipliers: it takes a fragment every few cycles, and expensive operations share units. Without this
    /// option it has one for each product and takes a fragment each cycle.
    #[arg(long, value_name = "COUNT", conflicts_with = "stage", value_parser = clap::value_parser!(u32).range(1..=1024))]
    multipliers: Option<u32>,
    /// Outputs that are ports, as paths or beginnings of paths: `probes,point.st,status`. What only other outputs need is left out. Without this
    /// option the outcomes of all stages are ports.
    #[arg(long, value_delimiter = ',', conflicts_with_all = ["stage", "scene"], value_name = "LIST")]
    outputs: Vec<String>,
    /// Write a shell too: MODULE_shell.v has two AXI4-Streams with words of this many bits, and AXI4-Lite registers for the constants of an
    /// object. Project files for LiteX, FuseSoC, IP-XACT and constraints, a register map and a testbench stand beside it.
    #[arg(long, value_name = "BITS", conflicts_with = "stage", value_parser = clap::value_parser!(u32).range(i64::from(*STREAM_BITS.start())..=i64::from(*STREAM_BITS.end())))]
    stream: Option<u32>,
    /// Clock in the constraints of the shell, MHz. Without this option it follows from the levels of logic between registers.
    #[arg(long, value_name = "MHZ", requires = "stream", value_parser = parse_clock)]
    clock: Option<f64>,
    /// Prefix of the names of all modules and of the files of a shell, so that a project can hold several designs. Each shell has a folder of its own.
    #[arg(long, default_value = "", value_parser = parse_prefix, value_name = "TEXT")]
    prefix: String,
    /// Print the summary as JSON.
    #[arg(long)]
    json: bool,
}

/// Parses the name of a device.
pub(super) fn parse_target(name: &str) -> Result<Target, String> {
    let known = Target::ALL.map(Target::name).join(", ");
    Target::by_name(name).ok_or_else(|| format!("targets are {known}"))
}

/// Parses the clock of constraints.
fn parse_clock(text: &str) -> Result<f64, String> {
    let clock = text.parse().map_err(|_| "a clock is a number of MHz".to_owned())?;
    if (0.001..=10_000.0).contains(&clock) { Ok(clock) } else { Err("a clock is 0.001 to 10000 MHz".into()) }
}

/// Parses a prefix of Verilog names.
fn parse_prefix(text: &str) -> Result<String, String> {
    let letter = |c: char| c.is_ascii_alphabetic() || c == '_';
    let first = text.chars().next().is_none_or(letter);
    let valid = first && text.chars().all(|c| letter(c) || c.is_ascii_digit());
    if valid { Ok(text.to_owned()) } else { Err("a prefix is letters, digits and `_`, no digit first".into()) }
}

pub(super) fn run(args: &VerilogArgs) -> Result<(), Failure> {
    let profile = &args.profile.open()?;
    check_directory(&args.output)?;
    let mut written = Vec::new();
    match &args.scene {
        None => {
            let effects = Effects { frame: args.frame, ..args.effects };
            written.push(write(args, profile, args.design, effects, &args.output)?);
        }
        Some(scene) => {
            let objects = effects::planned_objects(scene, &profile.precision)?;
            let of_object = |object: &PlannedObject| {
                let datapaths =
                    object.plan.datapaths().map(|(datapath, effects)| (Design::for_datapath(datapath), effects));
                let fetches = fetches(&object.plan, object.is_bright).into_iter().map(|design| (design, Effects::NONE));
                datapaths.chain(fetches).collect::<Vec<_>>()
            };
            let designs: Vec<_> = objects.iter().map(of_object).collect();
            let bar = progress(designs.iter().map(Vec::len).sum::<usize>() as u64, scene);
            for (object, designs) in objects.iter().zip(designs) {
                for (design, effects) in designs {
                    let directory = args.output.join(&object.directory).join(design.name());
                    written.push(write(args, profile, design, effects, &directory)?);
                    bar.inc(1);
                }
            }
            bar.finish_and_clear();
            if written.is_empty() {
                complain("no object of the scene needs a datapath or a map");
            }
        }
    }
    let mut out = io::stdout().lock();
    if args.json {
        let summaries: Vec<_> = written.iter().map(|(directory, verilog)| summary(directory, verilog)).collect();
        match (&args.scene, summaries.as_slice()) {
            (None, [one]) => writeln!(out, "{one:#}")?,
            _ => writeln!(out, "{:#}", json!(summaries))?,
        }
        return Ok(());
    }
    for (directory, verilog) in &written {
        let (directory, files) = (directory.display(), verilog.files.len());
        match &verilog.top {
            Some(top) => writeln!(
                out,
                "{directory}: {files} files, top {}, latency {} cycles, {} register bits",
                top.module, top.latency, verilog.register_bits
            )?,
            None => writeln!(out, "{directory}: {files} files")?,
        }
    }
    Ok(())
}

/// Writes a design into a directory.
fn write(
    args: &VerilogArgs,
    profile: &NamedPrecision,
    design: Design,
    effects: Effects,
    directory: &Path,
) -> Result<(PathBuf, Verilog), Failure> {
    let options = Options {
        profile: profile.name.clone(),
        precision: profile.precision,
        effects,
        depth: args.depth,
        target: args.target,
        multipliers: args.multipliers,
        outputs: args.outputs.clone(),
        stream: args.stream,
        clock: args.clock,
        stage: args.stage.clone(),
        prefix: args.prefix.clone(),
    };
    let verilog = match record::verilog(design, &options) {
        Err(VerilogError::Unproven(violations)) => return Err(unproven(&violations)),
        Err(error @ (VerilogError::UnknownStage { .. } | VerilogError::UnknownOutput(_))) => {
            return Err(Failure::Usage(error.to_string()));
        }
        other => other?,
    };
    let bench = shell_bench(design, &options, &verilog)?;
    let manifest = verilog.files.keys().find(|name| name.ends_with(".json"));
    let earlier = manifest.map_or_else(BTreeSet::new, |name| earlier::files(directory, name));
    let sources = verilog.in_order().map(|(name, text)| (name.to_owned(), text.as_bytes()));
    let bench = bench.iter().map(|(name, bytes)| (name.clone(), bytes.as_slice()));
    write_files(directory, bench.chain(sources))?;
    let removed = earlier::remove(directory, earlier, verilog.files.keys().map(String::as_str))?;
    if removed > 0 {
        complain(&format!("{}: {removed} files of the design that was there before were removed", directory.display()));
    }
    Ok((directory.to_path_buf(), verilog))
}

fn summary(directory: &Path, verilog: &Verilog) -> serde_json::Value {
    let names: Vec<_> = verilog.files.keys().collect();
    let Verilog { top, stepper, shell, .. } = verilog;
    json!({ "directory": directory.display().to_string(), "files": names, "top": top, "stepper": stepper, "shell": shell })
}
