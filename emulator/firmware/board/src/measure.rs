//! Measurement of a program: built, run and weighed.

use std::collections::BTreeMap;
use std::path::Path;

use indicatif::{ProgressBar, ProgressStyle};

use crate::Failure;
use crate::image::Image;
use crate::target::Target;

/// Plan for which the price of an accuracy is measured.
pub const ALL_EFFECTS: &str = "reflection+bump+curvature+footprint+anisotropic";

/// Plan of [`ALL_EFFECTS`] in batches, for the program `clocks`.
pub const IN_A_BATCH: &str = "batch+bump+curvature+footprint+anisotropic";

/// Plan of the program `clocks` that fetches and filters the probes of a footprint of [`ALL_EFFECTS`].
pub const PROBE: &str = "probe+bump+curvature+footprint+anisotropic";

/// Numbers of the lines `NAME NUMBER` of a program.
pub type Numbers = BTreeMap<String, u64>;

/// Output of a program, and its image.
pub struct Measured {
    /// Numbers that it printed.
    pub numbers: Numbers,
    /// The program.
    pub image: Image,
}

/// Builds and runs a program, as [`Target::build`] reads plan and accuracy.
pub fn measure(target: Target, program: &str, plan: &str, accuracy: &str) -> Result<Measured, Failure> {
    target.build(program, plan, accuracy)?;
    measure_built(target, program)
}

/// Runs the last built program of a name.
pub fn measure_built(target: Target, program: &str) -> Result<Measured, Failure> {
    let built = target.place(program);
    let (code, output) = target.run(&built)?;
    if code != 0 {
        return Err(Failure::trouble(format!("{program} on {}: exit code {code}\n{output}", target.name())));
    }
    Ok(Measured { numbers: numbers(&output), image: Image::read(&built)? })
}

/// Numbers of the lines that end in one.
pub fn numbers(output: &str) -> Numbers {
    output
        .lines()
        .filter_map(|line| {
            let (name, number) = line.rsplit_once(' ')?;
            Some((name.to_string(), number.parse().ok()?))
        })
        .collect()
}

/// Progress bar over `programs` programs.
pub fn progress(programs: usize) -> Result<ProgressBar, Failure> {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} programs, {eta} left: {msg}");
    Ok(ProgressBar::new(programs as u64).with_style(style.map_err(Failure::trouble)?))
}

/// Writes a file whole or not at all, and prints its path.
pub fn write_whole(file: &Path, text: &str) -> Result<(), Failure> {
    let trouble = |path: &Path, error| Failure::trouble(format!("{}: {error}", path.display()));
    let mut beside = file.as_os_str().to_owned();
    beside.push(".part");
    let beside = Path::new(&beside);
    std::fs::write(beside, text).map_err(|error| trouble(beside, error))?;
    std::fs::rename(beside, file).map_err(|error| trouble(file, error))?;
    eprintln!("{}", file.display());
    Ok(())
}
