//! # roughxel-cli
//!
//! The program `roughxel`: arguments, exit codes and error messages. Each command is a file or a folder.
//!
//! Data goes to stdout, progress and errors to stderr. Exit codes: 0 done, 1 failure, 2 usage, 3 mismatch.

mod arguments;
mod cache;
mod choose;
mod completions;
mod console;
mod cost;
pub mod demo;
mod effects;
mod eval;
mod failure;
pub mod gallery;
mod import;
mod inspect;
mod plan;
mod ranges;
mod render;
mod report;
mod scenes;
mod schedule;
mod simulate;
mod study;
mod vectors;
mod verilog;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};
use miette::MietteHandlerOpts;

use arguments::{
    CONVENTIONS, ProfileArg, Profiles, check_directory, check_file, file_stem, open_scene, parse_png, parse_profile,
    parse_profiles, parse_size, parse_threads, remove_abandoned_in, use_threads, write_text,
};
use failure::{Failure, on_one_line};

/// Antialiased bump and environment mapping in integer arithmetic: frames, golden vectors, single fragments.
#[derive(Parser)]
#[command(name = "roughxel", version, after_help = CONVENTIONS, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Draw the demonstration scenes, export vectors, and print errors and times.
    #[command(after_help = CONVENTIONS)]
    Demo(demo::DemoArgs),
    /// Draw a scene.
    #[command(after_help = CONVENTIONS)]
    Render(render::RenderArgs),
    /// Make a scene of a glTF model: its triangles, materials and maps as files that can be edited.
    #[command(long_about = import::LONG_HELP)]
    Import(import::ImportArgs),
    /// Say what a picture or a model is, how it is read, and what of it is ignored.
    #[command(long_about = inspect::LONG_HELP)]
    Inspect(inspect::InspectArgs),
    /// Export and verify golden vectors, and check devices with them.
    #[command(subcommand)]
    Vectors(vectors::VectorsCommand),
    /// Run fragments given in real numbers through the datapath.
    #[command(long_about = eval::LONG_HELP, after_help = CONVENTIONS)]
    Eval(eval::EvalArgs),
    /// Print a report.
    #[command(subcommand)]
    Report(report::ReportCommand),
    /// Prove that no wire can overflow; print declared, proven and observed ranges.
    #[command(long_about = ranges::LONG_HELP)]
    Ranges(ranges::RangesArgs),
    /// Count multipliers, adders, tables and gate levels of every stage.
    #[command(long_about = cost::LONG_HELP)]
    Cost(cost::CostArgs),
    /// Fold a design on a few multipliers: cycles a fragment, shared units, stored values.
    #[command(long_about = schedule::LONG_HELP)]
    Schedule(schedule::ScheduleArgs),
    /// Write the datapath as synthesizable Verilog: a module for each stage, a pipelined top, ROMs, a JSON manifest.
    #[command(after_help = CONVENTIONS)]
    Verilog(verilog::VerilogArgs),
    /// Draw scenes with the generated Verilog in Verilator, and compare every bit with the emulator's frames.
    #[command(long_about = simulate::LONG_HELP, after_help = CONVENTIONS)]
    Simulate(simulate::SimulateArgs),
    /// Draw the scenes of the papers next to what they are compared with, and write a page of them.
    #[command(long_about = gallery::LONG_HELP)]
    Gallery(gallery::GalleryArgs),
    /// Say which effects each object of a scene has, why, and what they cost.
    #[command(long_about = plan::LONG_HELP)]
    Plan(plan::PlanArgs),
    /// Measure what accuracy costs in time: every knob alone, on four clocks, as one page.
    #[command(long_about = study::LONG_HELP)]
    Study(study::StudyArgs),
    /// Find the cheapest profile that is accurate enough, or the most accurate within a budget.
    #[command(long_about = choose::LONG_HELP)]
    Choose(choose::ChooseArgs),
    /// List the built-in scenes.
    Scenes(scenes::ScenesArgs),
    /// Print a script that completes commands, options and names in a shell.
    #[command(long_about = completions::LONG_HELP)]
    Completions(completions::CompletionsArgs),
}

/// Parses the arguments and runs the command.
pub fn run() -> ExitCode {
    // Messages name files; a wrapped path could not be copied.
    let handler = |_: &_| -> Box<dyn miette::ReportHandler> {
        Box::new(MietteHandlerOpts::new().wrap_lines(false).terminal_links(false).build())
    };
    // This fails only if a hook is already set. That hook then serves.
    let _ = miette::set_hook(Box::new(handler));

    let outcome = match Cli::parse().command {
        Command::Demo(args) => demo::run(&args),
        Command::Render(args) => render::run(&args),
        Command::Import(args) => import::run(&args),
        Command::Inspect(args) => inspect::run(&args),
        Command::Vectors(command) => vectors::run(&command),
        Command::Eval(args) => eval::run(&args),
        Command::Report(command) => report::run(&command),
        Command::Ranges(args) => ranges::run(&args),
        Command::Cost(args) => cost::run(&args),
        Command::Schedule(args) => schedule::run(&args),
        Command::Verilog(args) => verilog::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Gallery(args) => gallery::run(&args),
        Command::Plan(args) => plan::run(&args),
        Command::Study(args) => study::run(&args),
        Command::Choose(args) => choose::run(&args),
        Command::Scenes(args) => scenes::run(&args),
        Command::Completions(args) => completions::run(&args, &mut Cli::command()),
    };
    match outcome {
        Ok(()) | Err(Failure::BrokenPipe) => ExitCode::SUCCESS,
        Err(Failure::Error(report)) => {
            // Only a diagnostic with source text is drawn.
            let text = if report.source_code().is_some() {
                format!("{report:?}")
            } else {
                format!("error: {}", on_one_line(report.chain()))
            };
            console::complain(&text);
            ExitCode::from(1)
        }
        Err(Failure::Usage(message)) => {
            let error = Cli::command().error(clap::error::ErrorKind::ValueValidation, message);
            // Nobody reads a closed stderr.
            let _ = error.print();
            ExitCode::from(2)
        }
        Err(Failure::Mismatch(message)) => {
            console::complain(&format!("mismatch: {message}"));
            ExitCode::from(3)
        }
    }
}
