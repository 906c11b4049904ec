//! The command line: arguments, exit codes and how errors look. Each command is a file of its own.
//!
//! Data goes to stdout, progress and errors to stderr. Exit codes: 0 done, 1 failure, 2 usage, 3 mismatch.

mod cache;
mod console;
mod cost;
mod demo;
mod effects;
mod eval;
mod gallery;
mod plan;
mod ranges;
mod render;
mod report;
mod scenes;
mod vectors;
mod verilog;

use std::error::Error;
use std::io;
use std::path::Path;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};
use miette::{LabeledSpan, MietteDiagnostic, MietteHandlerOpts, NamedSource, Report};
use roughxel_core::precision::{PROFILE_NAMES, Precision};
use roughxel_emulator::scene::{Scene, SceneError};

/// Shown at the end of every command's help.
const CONVENTIONS: &str = "\
Units and formats:
  vectors      n, v, h, p_u, p_v may have any length; v points from the surface to the eye
  derivatives  per pixel: d/dx one pixel to the right, d/dy one pixel DOWN
  s, t         on a cube face, -1 to 1, s to the right, t down; faces 0-5: +x -x +y -y +z -z (Vulkan)
  lambda, step in units of s, t (half faces); K in half faces squared; lod in levels
  mantissas    I2F30 (two's complement, 30 fraction bits) times 2^exponent (16-bit integer)
  offsets      b, d, step: I4F28, -8 to 8; lod: I16F16
  profiles     paper, compact (both keep 16 fraction bits), standard (20), precise (26)

Exit codes: 0 done, 1 failure, 2 usage, 3 mismatch.
Data goes to stdout, progress and errors to stderr. NO_COLOR is respected.";

/// Antialiased bump and environment mapping in integer arithmetic: frames, golden vectors, single fragments.
#[derive(Parser)]
#[command(name = "roughxel", version, after_help = CONVENTIONS, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Draw the demonstration scenes, export vectors and print a table of errors and times.
    #[command(after_help = CONVENTIONS)]
    Demo(demo::DemoArgs),
    /// Draw a scene.
    #[command(after_help = CONVENTIONS)]
    Render(render::RenderArgs),
    /// Export and verify golden vectors.
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
    /// Write the datapath as synthesizable Verilog: a module a block, a pipelined top, ROMs, a JSON manifest.
    #[command(after_help = CONVENTIONS)]
    Verilog(verilog::VerilogArgs),
    /// Draw the scenes of the papers, each beside what it is compared with, and a page of all of them.
    #[command(long_about = gallery::LONG_HELP)]
    Gallery(gallery::GalleryArgs),
    /// Say which effects each object of a scene has, why, and what they cost.
    #[command(long_about = plan::LONG_HELP)]
    Plan(plan::PlanArgs),
    /// List the built-in scenes.
    Scenes(scenes::ScenesArgs),
}

/// Why a command ends without success.
enum Failure {
    /// Something went wrong: exit code 1.
    Error(Report),
    /// The arguments contradict each other or name what is not there: exit code 2.
    Usage(String),
    /// A comparison failed and has been described: exit code 3.
    Mismatch(String),
    /// Whoever read the output has had enough: no failure at all.
    BrokenPipe,
}

/// A library error, with its chain of causes; a diagnostic with source text comes in by [`Failure::Error`].
impl<E: Error + Send + Sync + 'static> From<E> for Failure {
    fn from(error: E) -> Self {
        let mut cause: Option<&(dyn Error + 'static)> = Some(&error);
        while let Some(e) = cause {
            if e.downcast_ref::<io::Error>().is_some_and(|e| e.kind() == io::ErrorKind::BrokenPipe) {
                return Self::BrokenPipe;
            }
            cause = e.source();
        }
        Self::Error(Report::from_err(error))
    }
}

/// A scene's error, drawn with its line where it has one.
fn scene_failure(error: SceneError) -> Failure {
    let Some(fault) = error.fault() else { return error.into() };
    let label = LabeledSpan::at(fault.span.clone(), fault.message.clone());
    let place = format!("{}:{}:{}: {}", fault.file, fault.line, fault.column, fault.message);
    let diagnostic = MietteDiagnostic::new(place).with_label(label).with_help(fault.help.clone());
    Failure::Error(Report::new(diagnostic).with_source_code(NamedSource::new(&fault.file, fault.text.to_string())))
}

/// The built-in scene of that name or the scene in that file, at another size where one is given; its warnings are told.
fn open_scene(name: &str, size: Option<[u32; 2]>) -> Result<Scene, Failure> {
    let scene = Scene::open(name).map_err(scene_failure)?;
    for warning in &scene.warnings {
        console::complain(&format!("warning: {warning}"));
    }
    Ok(match size {
        Some([width, height]) => scene.with_size(width, height)?,
        None => scene,
    })
}

/// Parses the arguments and runs the command.
pub(crate) fn run() -> ExitCode {
    // Messages name files; a wrapped path could not be copied.
    let handler = |_: &_| -> Box<dyn miette::ReportHandler> {
        Box::new(MietteHandlerOpts::new().wrap_lines(false).terminal_links(false).build())
    };
    // Fails only if a hook is there already, and then that one does.
    let _ = miette::set_hook(Box::new(handler));

    let outcome = match Cli::parse().command {
        Command::Demo(args) => demo::run(&args),
        Command::Render(args) => render::run(&args),
        Command::Vectors(command) => vectors::run(&command),
        Command::Eval(args) => eval::run(&args),
        Command::Report(command) => report::run(&command),
        Command::Ranges(args) => ranges::run(&args),
        Command::Cost(args) => cost::run(&args),
        Command::Verilog(args) => verilog::run(&args),
        Command::Gallery(args) => gallery::run(&args),
        Command::Plan(args) => plan::run(&args),
        Command::Scenes(args) => scenes::run(&args),
    };
    match outcome {
        Ok(()) | Err(Failure::BrokenPipe) => ExitCode::SUCCESS,
        Err(Failure::Error(report)) => {
            // Only a diagnostic with source text has something to draw.
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
            // A closed stderr leaves nobody to tell.
            let _ = error.print();
            ExitCode::from(2)
        }
        Err(Failure::Mismatch(message)) => {
            console::complain(&format!("mismatch: {message}"));
            ExitCode::from(3)
        }
    }
}

/// Errors, each the cause of the one before; a cause that is already part of the text is not repeated.
fn on_one_line<'a>(errors: impl Iterator<Item = &'a (dyn Error + 'static)>) -> String {
    errors.map(ToString::to_string).fold(String::new(), |text, cause| {
        if text.contains(&cause) {
            text
        } else if text.is_empty() {
            cause
        } else {
            format!("{text}: {cause}")
        }
    })
}

/// A named profile, as a command-line argument.
#[derive(Clone, Debug)]
struct ProfileArg {
    name: String,
    precision: Precision,
}

fn parse_profile(name: &str) -> Result<ProfileArg, String> {
    match Precision::by_name(name) {
        Some(precision) => Ok(ProfileArg { name: name.into(), precision }),
        None => Err(format!("profiles are {}", PROFILE_NAMES.join(", "))),
    }
}

/// `WIDTHxHEIGHT` in pixels, each up to 16384 and 2^26 together.
fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let number = |text: &str| text.parse::<u32>().ok().filter(|edge| (1..=16384).contains(edge));
    let size = text.split_once(['x', 'X']).and_then(|(width, height)| Some([number(width)?, number(height)?]));
    size.filter(|[width, height]| width * height <= 1 << 26)
        .ok_or_else(|| "a size is WIDTHxHEIGHT, each from 1 to 16384 and at most 2^26 pixels, such as 640x400".into())
}

/// A number of threads, 1 to 1024.
fn parse_threads(text: &str) -> Result<usize, String> {
    let threads = text.parse().ok().filter(|threads| (1..=1024).contains(threads));
    threads.ok_or_else(|| "a number of threads is from 1 to 1024".into())
}

/// Sets the number of threads of the whole program; none leaves it to the machine.
fn use_threads(threads: Option<usize>) -> Result<(), Failure> {
    match threads {
        Some(threads) => Ok(rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?),
        None => Ok(()),
    }
}

/// A name as part of a file name: lower-case letters, digits and underscores, at most 40.
fn file_stem(name: &str) -> String {
    let name = Path::new(name).file_stem().map_or(name.into(), |stem| stem.to_string_lossy());
    let good = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    name.chars().map(good).take(40).collect()
}
