//! Reflections of photographs as heights against 1024 samples a pixel.
//!
//! `cargo run --release -p roughxel-host-tests --bin reflection-bars` takes half a minute. It prints the brightness of each band and channel over
//! the truth's, and the PSNR. `--keys KEYS` adds lines to the material, for example `--keys 'two_lobes = true'`. `--suns` prints the means over
//! twelve directions of the sun, which takes twelve times as long.
//!
//! `--world` draws the suite of the world and fills [`docs/reflections.md`](../../../docs/reflections.md) with its table and picture. It takes one
//! or two minutes and the files that `bash host-tests/programs/world.sh` fetches.

use std::path::Path;
use std::process::ExitCode;

use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use roughxel_assets::picture::{Picture, beside, write_png_srgb};
use roughxel_frame::Frame;
use roughxel_host_tests::bars::{
    Outcome, ROUGH_PHOTOGRAPHS, ReflectionFigures, SUN, Shape, World, reflection_figures, suns,
};
use roughxel_host_tests::table::table;
use roughxel_utilities::output::write_files;

const USAGE: &str = "reflection-bars [--suns] [--keys KEYS] | --world
  --suns       means over twelve directions of the sun
  --keys KEYS  further lines of the material, such as 'two_lobes = true'
  --world      the suite of the world, to docs/reflections.md";

/// Slopes of the heights, root mean square.
const SLOPES: [f64; 3] = [0.1, 0.25, 0.5];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments == ["--world"] {
        return world().map_or_else(
            |error| {
                eprintln!("error: {error}");
                ExitCode::FAILURE
            },
            |()| ExitCode::SUCCESS,
        );
    }
    let (suns, rest) = match arguments.split_first() {
        Some((first, rest)) if first == "--suns" => (suns().to_vec(), rest),
        _ => (vec![SUN], &arguments[..]),
    };
    let keys = match rest {
        [] => "",
        [option, keys] if option == "--keys" => keys,
        _ => {
            eprintln!("error: wrong arguments\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    let cases: Vec<(&str, f64)> =
        ROUGH_PHOTOGRAPHS.iter().flat_map(|name| SLOPES.map(|slope| (*name, slope))).collect();
    let mean = |(name, slope): &(&str, f64)| -> Option<ReflectionFigures> {
        let of = |sun| reflection_figures(name, *slope, [keys], sun).map(|[figures]| figures);
        let figures: Option<Vec<_>> = suns.par_iter().map(|sun| of(*sun)).collect();
        figures.map(|figures| ReflectionFigures::mean(&figures))
    };
    let figures: Vec<Option<ReflectionFigures>> = cases.par_iter().map(mean).collect();
    let mut table =
        table(["heights", "slope", "red, far to near", "green", "blue", "PSNR, dB", "16 samples, dB"], 1..7);
    for ((name, slope), figures) in cases.iter().zip(figures) {
        let Some(figures) = figures else { return ExitCode::FAILURE };
        let channel = |i: usize| figures.bands.map(|band| format!("{:.2}", band[i])).join(" ");
        let [psnr, samples] = [figures.psnr, figures.psnr_of_16_samples].map(|psnr| format!("{psnr:.1}"));
        table.add_row([name.to_string(), slope.to_string(), channel(0), channel(1), channel(2), psnr, samples]);
    }
    println!("{table}");
    ExitCode::SUCCESS
}

/// Cases in the picture of the page.
const SHOWN: [(&str, Option<f64>, Shape); 3] =
    [("brick.png", Some(0.25), Shape::Plane), ("0025", None, Shape::Plane), ("grass.png", Some(0.25), Shape::Mesh)];

/// Draws the suite of the world, prints its table, and writes page and picture.
fn world() -> Result<(), String> {
    let world = World::open()?;
    let bar = ProgressBar::new(World::cases().len() as u64);
    bar.set_style(ProgressStyle::with_template("{pos}/{len} mirrors [{bar:40}] {eta}").expect("a valid template"));
    let outcomes = world.draw(&|| bar.inc(1));
    bar.finish_and_clear();
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let page = page(&outcomes);
    println!("{page}");
    write_files(&docs, [("reflections.md", page)]).map_err(|error| error.to_string())?;
    write_png_srgb(&docs.join("reflections.png"), &picture(&outcomes)).map_err(|error| error.to_string())
}

/// The page: what the suite is, a summary, and a line for each case.
fn page(outcomes: &[Outcome]) -> String {
    let mut page = String::from(INTRODUCTION);
    page += "\n| slopes | cases | law: worst band and channel | within 0.9 to 1.1 | law − one lobe, dB | law − as is, dB | better than 16 samples | texels, law ÷ one lobe |\n\
             |---|---:|---:|---:|---:|---:|---:|---:|\n";
    for slope in [Some(0.1), Some(0.25), Some(0.5), Some(1.0), None] {
        let of: Vec<&[ReflectionFigures; 3]> =
            outcomes.iter().filter(|outcome| outcome.case.rms_slope == slope).map(|outcome| &outcome.figures).collect();
        let ranges: Vec<[f64; 2]> = of.iter().map(|[.., law]| law.range()).collect();
        let least = ranges.iter().fold(f64::INFINITY, |least, range| range[0].min(least));
        let most = ranges.iter().fold(0.0, |most, range| range[1].max(most));
        let within = ranges.iter().filter(|[least, most]| *least >= 0.9 && *most <= 1.1).count();
        let better = of.iter().filter(|[.., law]| law.psnr > law.psnr_of_16_samples).count();
        let gain = |over: usize| -> f64 {
            of.iter().map(|figures| figures[2].psnr - figures[over].psnr).sum::<f64>() / of.len() as f64
        };
        page += &format!(
            "| {} | {} | {least:.2} to {most:.2} | {within} | {:+.1} | {:+.1} | {better} | {:.2} |\n",
            slope.map_or("normal maps".to_owned(), |slope| slope.to_string()),
            of.len(),
            gain(1),
            gain(0),
            of.iter().map(|[_, one_lobe, law]| law.texels / one_lobe.texels).sum::<f64>() / of.len() as f64
        );
    }
    page += "\n| bumps | slope | shape | panorama | as is | one lobe | law | dB: as is | one lobe | law | 16 samples | texels, law ÷ one lobe |\n\
             |---|---:|---|---|---:|---:|---:|---:|---:|---:|---:|---:|\n";
    for Outcome { case, figures, .. } in outcomes {
        let shape = if case.shape == Shape::Plane { "plane" } else { "mesh" };
        let slope = case.rms_slope.map_or("own".to_owned(), |slope| slope.to_string());
        let ranges = figures.map(|figures| figures.range().map(|ratio| format!("{ratio:.2}")).join(" – "));
        let psnr = figures.map(|figures| format!("{:.1}", figures.psnr));
        page += &format!(
            "| {} | {slope} | {shape} | {} | {} | {} | {:.1} | {:.2} |\n",
            case.bumps.trim_end_matches(".png"),
            case.sky,
            ranges.join(" | "),
            psnr.join(" | "),
            figures[0].psnr_of_16_samples,
            figures[2].texels / figures[1].texels
        );
    }
    page
}

/// Text above the tables.
const INTRODUCTION: &str = "# Reflections of panoramas and bumps of others

Made by `cargo run --release --bin reflection-bars -- --world`, after `bash host-tests/programs/world.sh` has fetched the files.
Panoramas and normal maps are those of the npm package @pmndrs/assets 1.7.0 (CC0), heights are photographs of the Python package scikit-image.

Each mirror of 96×72 pixels is compared with 1024 samples a pixel. The panorama is exposed so that no sample is clipped.
Brightness is that of a band of rows and a channel, over the truth; a range is that of all four bands and three channels.
A decibel is that of the exposure that gives the brightest channel of the truth the value 1.
Texels are those of the environment.

- *As is*: the material without further keys.
- *One lobe*: `bump_deviation = \"root-mean-square\"`, `two_lobes = false` (S97).
- *Law*: `bump_deviation = \"law\"`.

![Three mirrors, a row each](reflections.png)

*From left to right: 1024 samples a pixel, as is, one lobe, law, 16 samples.*
";

/// Picture of three cases, a row each: truth, filtered, 16 samples, at the exposure at which the brightest channel of one pixel in a hundred is white.
fn picture(outcomes: &[Outcome]) -> Picture {
    let shown = SHOWN.iter().filter_map(|&(bumps, slope, shape)| {
        outcomes.iter().find(|Outcome { case, .. }| (case.bumps, case.rms_slope, case.shape) == (bumps, slope, shape))
    });
    let rows = shown.map(|Outcome { pictures, .. }| {
        let mut brightest: Vec<i32> =
            pictures.truth.pixels.iter().map(|pixel| pixel.iter().copied().max().unwrap_or(0)).collect();
        brightest.sort_unstable();
        let white = f64::from(brightest[brightest.len() * 99 / 100].max(1)) / f64::from(1 << 24);
        let exposed = |frame: &Frame| {
            let mut picture = frame.picture();
            let pixels = picture.pixels.iter_mut().flatten();
            pixels.for_each(|channel| *channel = (f64::from(*channel) / white) as f32);
            picture
        };
        let [as_is, one_lobe, law] = pictures.filtered.each_ref().map(exposed);
        beside(&[&exposed(&pictures.truth), &as_is, &one_lobe, &law, &exposed(&pictures.sampled)])
    });
    let rows: Vec<Picture> = rows.collect();
    Picture {
        width: rows[0].width,
        height: rows.iter().map(|row| row.height).sum(),
        pixels: rows.into_iter().flat_map(|row| row.pixels).collect(),
    }
}
