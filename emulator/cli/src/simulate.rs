//! `roughxel simulate`.

use std::error::Error;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use miette::miette;
use roughxel_assets::picture::write_png_codes;
use roughxel_core::plan::ReflectionPlan;
use roughxel_frame::plan::Mode;
use roughxel_frame::{Frame, Prepared};
use roughxel_hardware_frame::{CACHE_LINES, Device, DeviceOptions, Figures, Footprint, Job, Model};
use roughxel_netlist::target::Target;
use roughxel_peaks::ScenePeaks;
use roughxel_scene::Scene;
use roughxel_study::profile_file::NamedPrecision;
use serde_json::json;

use super::console::{complain, progress};
use super::verilog::parse_target;
use super::{Failure, ProfileArg, check_directory, file_stem, open_scene, parse_profile, parse_size};

pub(super) const LONG_HELP: &str = "\
Draw scenes with the generated Verilog in Verilator, and compare every bit with the emulator's frames.

The device is one module: the reflection folded on a few multipliers, the probes of its footprint, a texture
cache in front of a memory with a latency, the filter, the blend, and the sum of a pixel's fragments. The
emulator gives it fragments whose colour and bump maps are sampled already. DIR/SCENE gets the Verilog in
`rtl`, the C++ program around it, the fragments, the texels and what Verilator printed; DIR/SCENE.png is the
picture. Highlights, peaks, two lobes and environments brighter than 64 x white are refused.

Verilator 5 and a C++ compiler are needed.";

#[derive(Args)]
pub(super) struct SimulateArgs {
    /// Scene files (TOML) or built-in scenes.
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<String>,
    /// Directory to write to; created if missing.
    #[arg(short, long, default_value = "simulated", value_name = "DIR")]
    output: PathBuf,
    /// Profile: a name or a file (TOML).
    #[arg(long, default_value = "standard", value_parser = parse_profile, value_name = "NAME|FILE")]
    profile: ProfileArg,
    /// Size in pixels.
    #[arg(long, default_value = "160x120", value_parser = parse_size, value_name = "WxH")]
    size: [u32; 2],
    /// Multipliers of the reflection. The probes and the filter have a few more.
    #[arg(long, default_value_t = 8, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=1024))]
    multipliers: u32,
    /// Device for which levels of logic are counted.
    #[arg(long, default_value = "asic", value_parser = parse_target, value_name = "asic|ice40|ecp5|gowin|xc7")]
    target: Target,
    /// Latency of the memory: cycles from a request to the first texel of its burst.
    #[arg(long, default_value_t = 30, value_name = "CYCLES", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    latency: u32,
    /// Clock for the figures, MHz.
    #[arg(long, default_value_t = 60, value_name = "MHZ", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    clock: u32,
    /// Print the figures as JSON.
    #[arg(long)]
    json: bool,
}

/// A frame that the device drew.
struct Drawn {
    name: String,
    picture: PathBuf,
    size: [u32; 2],
    footprint: Footprint,
    /// Cycles from a fragment to the next in the reflection.
    interval: u32,
    /// Multipliers of all designs.
    multipliers: u32,
    /// Number of fragments that reflect.
    reflecting: usize,
    figures: Figures,
    /// Seconds to compile the device and to run it.
    seconds: [f64; 2],
    /// Pixels that differ from the emulator's frame, and the first of them.
    different: usize,
    first: Option<[usize; 2]>,
}

/// A frame that is ready to be drawn.
struct Ready<'a> {
    scene: &'a Scene,
    prepared: Prepared<'a>,
    device: Device,
    job: Job,
}

pub(super) fn run(args: &SimulateArgs) -> Result<(), Failure> {
    check_directory(&args.output)?;
    let profile = args.profile.open()?;
    let stems: Vec<_> = args.scenes.iter().map(|scene| file_stem(scene)).collect();
    if let Some((_, stem)) = stems.iter().enumerate().find(|(index, stem)| stems[..*index].contains(stem)) {
        return Err(Failure::Usage(format!("two scenes are `{stem}`; draw them into different directories with -o")));
    }
    // Every scene is checked before the first device is compiled.
    let scenes = args.scenes.iter().map(|scene| open_scene(scene, Some(args.size))).collect::<Result<Vec<_>, _>>()?;
    let ready = scenes.iter().map(|scene| Ready::new(args, scene, &profile)).collect::<Result<Vec<_>, _>>()?;
    let mut drawn = Vec::new();
    for (ready, stem) in ready.iter().zip(stems) {
        let one = ready.draw(args, &args.output.join(stem))?;
        if !args.json {
            print(&one, args, &profile)?;
        }
        drawn.push(one);
    }
    if args.json {
        let list: Vec<_> = drawn.iter().map(|one| figures(one, args, &profile)).collect();
        writeln!(io::stdout().lock(), "{:#}", json!(list))?;
    }
    let wrong = drawn.iter().find_map(|one| Some((one, one.first?)));
    match wrong {
        None => Ok(()),
        Some((one, [x, y])) => Err(Failure::Mismatch(format!(
            "{}: {} pixels differ from the emulator's frame, the first one at column {x}, row {y}",
            one.name, one.different
        ))),
    }
}

impl<'a> Ready<'a> {
    /// Prepares a scene, its device and its fragments.
    fn new(args: &SimulateArgs, scene: &'a Scene, profile: &NamedPrecision) -> Result<Self, Failure> {
        // Scenes with peaks are refused.
        let prepared = Prepared::with_peaks(scene, Mode::Footprint, &profile.precision, &ScenePeaks::default())?;
        let plans: Vec<ReflectionPlan> = prepared.reflection_plans().collect();
        let options = DeviceOptions {
            profile: profile.name.clone(),
            precision: profile.precision,
            multipliers: args.multipliers,
            target: args.target,
        };
        let of_scene = |error: &dyn Error| Failure::Error(miette!("scene {}: {error}", scene.name));
        let device = Device::new(&plans, &options).map_err(|error| of_scene(&error))?;
        let bar = progress(prepared.work(), &format!("{}: fragments", scene.name));
        let job = Job::new(&prepared, args.size, &device, &|| bar.inc(1)).map_err(|error| of_scene(&error))?;
        bar.finish_and_clear();
        Ok(Self { scene, prepared, device, job })
    }

    /// Draws the frame with the device and with the emulator.
    fn draw(&self, args: &SimulateArgs, directory: &Path) -> Result<Drawn, Failure> {
        let Self { scene, prepared, device, job } = self;
        complain(&format!("{}: Verilator compiles the device; this takes about a minute", scene.name));
        let start = Instant::now();
        let model = Model::build(device, directory, "-O1")?;
        let compiling = start.elapsed().as_secs_f64();
        let bar = progress(job.pixels() as u64, &format!("{}: pixels", scene.name));
        let start = Instant::now();
        let (frame, figures) = model.run(job, directory, args.latency, &|done| bar.set_position(done))?;
        let running = start.elapsed().as_secs_f64();
        bar.finish_and_clear();

        let picture = directory.with_extension("png");
        write_png_codes(&picture, args.size, &frame.srgb_codes())?;
        let golden = prepared.render(&|| ())?;
        let width = args.size[0] as usize;
        let (different, first) = differences(&frame, &golden);
        Ok(Drawn {
            name: scene.name.clone(),
            picture,
            size: args.size,
            footprint: device.footprint,
            interval: device.interval(),
            multipliers: device.multipliers(),
            reflecting: job.reflecting,
            figures,
            seconds: [compiling, running],
            different,
            first: first.map(|index| [index % width, index / width]),
        })
    }
}

/// Number of pixels that differ, and the index of the first one.
fn differences(frame: &Frame, golden: &Frame) -> (usize, Option<usize>) {
    let pairs = frame.pixels.iter().zip(&golden.pixels).enumerate();
    let mut different = pairs.filter(|(_, (a, b))| a != b).map(|(index, _)| index);
    let first = different.next();
    (different.count() + usize::from(first.is_some()), first)
}

fn kind(footprint: Footprint) -> &'static str {
    match footprint {
        Footprint::Face => "face",
        Footprint::Sphere => "sphere",
    }
}

/// Fragments a second at a clock in MHz.
fn rate(figures: &Figures, clock: u32) -> f64 {
    f64::from(clock) * 1e6 * figures.fragments as f64 / figures.cycles.max(1) as f64
}

fn print(one: &Drawn, args: &SimulateArgs, profile: &NamedPrecision) -> Result<(), Failure> {
    let (figures, [width, height]) = (&one.figures, one.size);
    let each = |count| figures.for_each_fragment(count);
    let [compiling, running] = one.seconds;
    let verdict = if one.different == 0 { "equal".to_owned() } else { format!("{} pixels differ", one.different) };
    let mut out = io::stdout().lock();
    writeln!(out, "{}: {width}x{height}, {}, golden frame: {verdict}", one.picture.display(), profile.name)?;
    writeln!(
        out,
        "  device     footprints on the {}, {} multipliers, a reflection every {} cycles",
        kind(one.footprint),
        one.multipliers,
        one.interval
    )?;
    writeln!(out, "  fragments  {}, of which {} reflect", figures.fragments, one.reflecting)?;
    writeln!(
        out,
        "  cycles     {}: {:.1} a fragment, {:.2} million fragments/s at {} MHz",
        figures.cycles,
        each(figures.cycles),
        rate(figures, args.clock) / 1e6,
        args.clock
    )?;
    writeln!(
        out,
        "  a fragment {:.2} probes, {:.2} bilinear samples, {:.2} requests of one or two texels",
        each(figures.probes),
        each(figures.samples),
        each(figures.requests)
    )?;
    writeln!(
        out,
        "  cache      {:.2} % hits in {CACHE_LINES} lines of 4x4 texels, {:.3} bursts of 16 texels a fragment, latency {} cycles",
        100.0 * figures.hit_rate(),
        each(figures.bursts),
        args.latency
    )?;
    writeln!(out, "  time       {compiling:.0} s to compile, {running:.1} s to run")?;
    Ok(())
}

fn figures(one: &Drawn, args: &SimulateArgs, profile: &NamedPrecision) -> serde_json::Value {
    let Figures { cycles, fragments, probes, samples, requests, bursts } = one.figures;
    json!({
        "scene": one.name, "profile": profile.name, "width": one.size[0], "height": one.size[1],
        "picture": one.picture.display().to_string(), "footprint": kind(one.footprint), "multipliers": one.multipliers,
        "interval": one.interval, "fragments": fragments, "reflecting": one.reflecting, "cycles": cycles, "probes": probes,
        "samples": samples, "requests": requests, "bursts": bursts, "hit_rate": one.figures.hit_rate(), "latency": args.latency,
        "clock_mhz": args.clock, "fragments_per_second": rate(&one.figures, args.clock), "different_pixels": one.different,
        "compile_s": one.seconds[0], "run_s": one.seconds[1],
    })
}
