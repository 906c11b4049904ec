//! `roughxel verilog`.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use roughxel_core::plan::{FrameSystem, ReflectionPlan};
use roughxel_emulator::net::design::Design;
use roughxel_emulator::net::verilog::{Options, Verilog, VerilogError};
use roughxel_emulator::output::write_files;
use serde_json::json;

use super::ranges::{design_help, parse_design, unproven};
use super::{Failure, ProfileArg, effects, parse_profile};

#[derive(Args)]
pub(super) struct VerilogArgs {
    /// Directory; made if it is not there.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[arg(long, default_value = "reflection", value_parser = parse_design, value_name = "NAME", help = design_help())]
    design: &'static Design,
    /// Profile.
    #[arg(long, default_value = "standard", value_parser = parse_profile, value_name = "NAME")]
    profile: ProfileArg,
    #[arg(long, default_value = "all", value_parser = effects::parse, help = effects::HELP, value_name = "LIST")]
    effects: ReflectionPlan,
    /// How the tangent frame is found.
    #[arg(long, default_value = "main", value_parser = parse_frame, value_name = "main|natural|natural-normalised")]
    frame: FrameSystem,
    /// Only the modules of this stage (`columns`) or block (`columns_pixel`), and what they use.
    #[arg(long, value_name = "NAME")]
    stage: Option<String>,
    /// Most levels of logic between two registers; none has registers between blocks only. A level is a gate of two
    /// inputs; a 32-bit adder has 7.
    #[arg(long, value_name = "LEVELS", value_parser = clap::value_parser!(u32).range(1..=1000))]
    depth: Option<u32>,
    /// Put before the names of modules, so that two designs can be in one project.
    #[arg(long, default_value = "", value_parser = parse_prefix, value_name = "TEXT")]
    prefix: String,
    /// Summary as JSON.
    #[arg(long)]
    json: bool,
}

fn parse_frame(name: &str) -> Result<FrameSystem, String> {
    match name {
        "main" => Ok(FrameSystem::MainDirection),
        "natural" => Ok(FrameSystem::Natural),
        "natural-normalised" => Ok(FrameSystem::NaturalNormalised),
        _ => Err("frames are main, natural, natural-normalised".into()),
    }
}

/// Text a Verilog name can start with.
fn parse_prefix(text: &str) -> Result<String, String> {
    let letter = |c: char| c.is_ascii_alphabetic() || c == '_';
    let first = text.chars().next().is_none_or(letter);
    let valid = first && text.chars().all(|c| letter(c) || c.is_ascii_digit());
    if valid { Ok(text.to_owned()) } else { Err("a prefix is letters, digits and `_`, no digit first".into()) }
}

pub(super) fn run(args: &VerilogArgs) -> Result<(), Failure> {
    let options = Options {
        profile: args.profile.name.clone(),
        precision: args.profile.precision,
        plan: ReflectionPlan { frame: args.frame, ..args.effects },
        depth: args.depth,
        stage: args.stage.clone(),
        prefix: args.prefix.clone(),
    };
    let verilog = match Verilog::new(args.design, &options) {
        Err(VerilogError::Unproven(violations)) => return Err(unproven(&violations)),
        Err(error @ VerilogError::UnknownStage { .. }) => return Err(Failure::Usage(error.to_string())),
        other => other?,
    };
    write_files(&args.output, verilog.in_order())?;

    let mut out = io::stdout().lock();
    let (directory, files) = (args.output.display(), verilog.files.len());
    if args.json {
        let names: Vec<_> = verilog.files.keys().collect();
        let (top, stepper) = (&verilog.top, &verilog.stepper);
        let summary = json!({ "directory": directory.to_string(), "files": names, "top": top, "stepper": stepper });
        writeln!(out, "{summary:#}")?;
        return Ok(());
    }
    match &verilog.top {
        Some(top) => writeln!(
            out,
            "{directory}: {files} files, top {}, latency {} cycles, {} register bits",
            top.module, top.latency, verilog.register_bits
        )?,
        None => writeln!(out, "{directory}: {files} files")?,
    }
    Ok(())
}
