//! Reflections of photographs as heights against 256 samples a pixel.
//!
//! `cargo run --release -p roughxel-host-tests --bin reflection-bars` takes half a minute. It prints the brightness of each band and channel over
//! the truth's, and the PSNR. `--keys KEYS` adds lines to the material, for example `--keys 'two_lobes = true'`.

use std::process::ExitCode;

use rayon::prelude::*;
use roughxel_host_tests::bars::{ROUGH_PHOTOGRAPHS, ReflectionFigures, reflection_figures};
use roughxel_host_tests::table::table;

const USAGE: &str = "reflection-bars [--keys KEYS]
  --keys KEYS  further lines of the material, such as 'two_lobes = true'";

/// Slopes of the heights, root mean square.
const SLOPES: [f64; 3] = [0.1, 0.25, 0.5];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let keys = match &arguments[..] {
        [] => "",
        [option, keys] if option == "--keys" => keys,
        _ => {
            eprintln!("error: wrong arguments\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    let cases: Vec<(&str, f64)> =
        ROUGH_PHOTOGRAPHS.iter().flat_map(|name| SLOPES.map(|slope| (*name, slope))).collect();
    let figures: Vec<Option<ReflectionFigures>> =
        cases.par_iter().map(|(name, slope)| reflection_figures(name, *slope, keys)).collect();
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
