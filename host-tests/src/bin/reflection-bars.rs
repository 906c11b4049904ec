//! Reflections of photographs as heights against 1024 samples a pixel.
//!
//! `cargo run --release -p roughxel-host-tests --bin reflection-bars` takes half a minute. It prints the brightness of each band and channel over
//! the truth's, and the PSNR. `--keys KEYS` adds lines to the material, for example `--keys 'two_lobes = true'`. `--suns` prints the means over
//! twelve directions of the sun, which takes twelve times as long.

use std::process::ExitCode;

use rayon::prelude::*;
use roughxel_host_tests::bars::{ROUGH_PHOTOGRAPHS, ReflectionFigures, SUN, reflection_figures, suns};
use roughxel_host_tests::table::table;

const USAGE: &str = "reflection-bars [--suns] [--keys KEYS]
  --suns       means over twelve directions of the sun
  --keys KEYS  further lines of the material, such as 'two_lobes = true'";

/// Slopes of the heights, root mean square.
const SLOPES: [f64; 3] = [0.1, 0.25, 0.5];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
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
