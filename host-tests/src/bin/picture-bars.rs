//! Prints every picture bar at full size: the measured value, the required value, and whether the bar holds.
//!
//! `cargo run --release -p roughxel-host-tests --bin picture-bars` takes some minutes, most of them for the truth of the scenes (1024 samples a
//! pixel in float64). Exit code 0 if every bar holds, 1 if one does not, 2 for wrong arguments. `--size WxH` and `--samples EDGE` (along an edge of
//! the pixel) reduce it; `--bless` writes the golden digests instead.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use comfy_table::Table;
use indicatif::{ProgressBar, ProgressStyle};
use roughxel_core::precision::Precision;
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_host_tests::bars;
use roughxel_host_tests::reference::ground_plane::{GroundReference, GroundTexture};
use roughxel_host_tests::space::profiles;
use roughxel_host_tests::table::table;
use roughxel_reference_renderer as reference_renderer;
use roughxel_scene::Scene;

const USAGE: &str = "picture-bars [--size WxH] [--samples EDGE] | --bless
  --size WxH      size of the scenes' frames, default 640x480
  --samples EDGE  EDGE x EDGE samples a pixel for their truth, 1 to 64, default 32
  --bless         write the digests of the golden frames";

/// Requirement on a figure.
enum Bar {
    None,
    AtLeast(f64),
    MoreThan(f64),
    AtMost(f64),
}

/// The table, and whether all of its bars hold.
struct Report {
    table: Table,
    holds: bool,
}

impl Report {
    fn new() -> Self {
        Self { table: table(["what", "measured", "bar", ""], 1..2), holds: true }
    }

    fn add(&mut self, what: &str, figure: f64, unit: &str, bar: &Bar) {
        let (text, holds) = match *bar {
            Bar::None => ("–".to_string(), true),
            Bar::AtLeast(bar) => (format!("≥ {bar:.1} {unit}"), figure >= bar),
            Bar::MoreThan(bar) => (format!("> {bar:.2} {unit}"), figure > bar),
            Bar::AtMost(bar) => (format!("≤ {bar:.1} {unit}"), figure <= bar),
        };
        self.holds &= holds;
        let verdict = match (bar, holds) {
            (Bar::None, _) => "",
            (_, true) => "holds",
            (_, false) => "MISSED",
        };
        self.table.add_row([what, &format!("{figure:.2} {unit}"), &text, verdict]);
    }
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let outcome = match parse(&arguments) {
        Err(message) => {
            eprintln!("{message}\n{USAGE}");
            return ExitCode::from(2);
        }
        Ok(Command::Bless) => bless(),
        Ok(Command::Measure { size, edge }) => measure(size, edge),
    };
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

enum Command {
    Bless,
    Measure { size: [u32; 2], edge: u32 },
}

fn parse(arguments: &[String]) -> Result<Command, String> {
    let mut size = [640, 480];
    let mut edge = 32;
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        match argument.as_str() {
            "--bless" if arguments.len() == 1 => return Ok(Command::Bless),
            "--size" => {
                let parsed = rest.next().and_then(|text| text.split_once('x'));
                let edges = parsed.and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
                size = edges.ok_or("--size needs WxH, for example 320x240")?;
            }
            "--samples" => {
                let parsed = rest.next().and_then(|text| text.parse().ok());
                edge = parsed.filter(|edge| (1..=64).contains(edge)).ok_or("--samples needs a number from 1 to 64")?;
            }
            other => return Err(format!("unknown argument '{other}'")),
        }
    }
    Ok(Command::Measure { size, edge })
}

/// Writes the golden digests next to the tests that compare them.
fn bless() -> Result<bool, String> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(bars::GOLDEN_FRAMES);
    eprintln!("drawing the golden frames");
    let text = bars::golden_frames()?;
    std::fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))?;
    println!("wrote {}", path.display());
    Ok(true)
}

fn measure(size: [u32; 2], edge: u32) -> Result<bool, String> {
    let mut report = Report::new();
    for name in bars::SCENES {
        scene(&mut report, name, size, edge)?;
    }
    match bars::real_scenes() {
        Some(scenes) => {
            for real in scenes {
                real_scene(&mut report, real, size.map(|edge| edge.div_ceil(2)), edge)?;
            }
        }
        None => eprintln!("real scenes are left out"),
    }
    ground(&mut report)?;
    for (profile, precision) in profiles() {
        eprintln!("cube edges, {profile}");
        let step = bars::cube_edge_step(&precision);
        let bar = Bar::AtMost(100.0 * bars::CUBE_EDGE_BAR);
        report.add(&format!("cube edges, one probe, {profile}"), 100.0 * step.probe, "%", &bar);
        report.add(&format!("cube edges, lobes to 3.6°, {profile}"), 100.0 * step.lobe, "%", &bar);
        report.add(&format!("cube edges, lobe of 14°, {profile}"), 100.0 * step.wide_lobe, "%", &Bar::None);
        let wide = format!("cube edges, lobes on the sphere to 57°, {profile}");
        report.add(&wide, 100.0 * step.lobe_on_sphere, "%", &bar);
    }
    println!("{}", report.table);
    println!("{}", if report.holds { "every bar holds" } else { "a bar is missed" });
    Ok(report.holds)
}

/// One scene: against its truth, and against the same filter in float64 with every profile.
fn scene(report: &mut Report, name: &str, [width, height]: [u32; 2], edge: u32) -> Result<(), String> {
    let failed = |error: &dyn std::fmt::Display| format!("scene {name}: {error}");
    let scene = Scene::builtin(name).ok_or_else(|| failed(&"not built in"))?.map_err(|error| failed(&error))?;
    let scene = scene.with_size(width, height).map_err(|error| failed(&error))?;
    let progress = bar(&format!("{name}: {} samples a pixel", edge * edge), reference_renderer::work(&scene));
    let figures = bars::scene_figures(&scene, &Precision::STANDARD, edge, &|| progress.inc(1));
    progress.finish_and_clear();
    let figures = figures.map_err(|error| failed(&error))?;
    report.add(&format!("{name}: unfiltered"), figures.unfiltered, "dB", &Bar::None);
    report.add(&format!("{name}: isotropic"), figures.isotropic, "dB", &Bar::None);
    report.add(&format!("{name}: 16 samples a pixel"), figures.supersampled_16, "dB", &Bar::None);
    let has_bars = bars::FILTERED_SCENES.contains(&name);
    let bar = if has_bars { Bar::MoreThan(figures.supersampled_16) } else { Bar::None };
    report.add(&format!("{name}: footprint"), figures.footprint, "dB", &bar);
    let bar = if has_bars { Bar::AtLeast(bars::GAIN_BAR) } else { Bar::None };
    report.add(&format!("{name}: footprint over unfiltered"), figures.gain(), "dB", &bar);
    for (profile, precision) in profiles() {
        eprintln!("{name}: against float64, {profile}");
        let psnr = bars::psnr_against_float(&scene, Mode::Footprint, &precision).map_err(|error| failed(&error))?;
        let bar = bars::arithmetic_bar(profile).map_or(Bar::None, Bar::AtLeast);
        report.add(&format!("{name}: against float64, {profile}"), psnr, "dB", &bar);
    }
    Ok(())
}

/// A real scene at half the width and height of the others: against its truth, and how much longer 16 samples take than the filter.
fn real_scene(report: &mut Report, real: bars::RealScene, [width, height]: [u32; 2], edge: u32) -> Result<(), String> {
    let failed = |error: &dyn std::fmt::Display| format!("{}: {error}", real.name);
    let scene = real.scene.with_size(width, height).map_err(|error| failed(&error))?;
    let progress = bar(&format!("{}: {} samples a pixel", real.name, edge * edge), reference_renderer::work(&scene));
    let figures = bars::scene_figures(&scene, &Precision::STANDARD, edge, &|| progress.inc(1));
    progress.finish_and_clear();
    let figures = figures.map_err(|error| failed(&error))?;
    let seconds = |mode| -> Result<f64, String> {
        let prepared = Prepared::new(&scene, mode, &Precision::STANDARD).map_err(|error| failed(&error))?;
        let mut least = f64::INFINITY;
        for _ in 0..3 {
            let start = Instant::now();
            prepared.render(&|| ()).map_err(|error| failed(&error))?;
            least = least.min(start.elapsed().as_secs_f64());
        }
        Ok(least)
    };
    let faster = seconds(Mode::Supersampled { edge: 4 })? / seconds(Mode::Footprint)?;
    report.add(&format!("{}: 16 samples a pixel", real.name), figures.supersampled_16, "dB", &Bar::None);
    let bar = Bar::AtLeast(figures.supersampled_16 - bars::BEHIND_16_SAMPLES);
    report.add(&format!("{}: footprint", real.name), figures.footprint, "dB", &bar);
    report.add(&format!("{}: time of 16 samples over footprint", real.name), faster, "times", &Bar::None);
    Ok(())
}

fn ground(report: &mut Report) -> Result<(), String> {
    for (name, texture) in [("checker", GroundTexture::Checker), ("noise", GroundTexture::Noise { seed: 1 })] {
        eprintln!("ground plane: {name}, 4096 samples a pixel");
        let reference = GroundReference::new(texture, 4096);
        for (profile, precision) in profiles() {
            let figures = bars::ground_plane(texture, &reference, &precision);
            // The bars are those of the default profile.
            let is_default = precision == Precision::STANDARD;
            let (psnr, texels) = if is_default {
                (Bar::AtLeast(bars::GROUND_BAR), Bar::AtMost(bars::GROUND_TEXELS))
            } else {
                (Bar::None, Bar::None)
            };
            report.add(&format!("ground plane: {name}, {profile}"), figures.psnr, "dB", &psnr);
            report.add(&format!("ground plane: {name}, {profile}"), figures.texels, "texels", &texels);
        }
    }
    Ok(())
}

fn bar(what: &str, steps: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}");
    let progress = ProgressBar::new(steps).with_message(what.to_string());
    if let Ok(style) = style {
        progress.set_style(style);
    }
    // Without a terminal there is no progress bar, so name the scene at least.
    if progress.is_hidden() {
        eprintln!("{what}");
    }
    progress.enable_steady_tick(Duration::from_millis(500));
    progress
}
