//! Whole frames on another family of processors: front end, maps, datapath and filters of the emulator, as digests.

use std::ffi::OsStr;

use crate::Failure;
use crate::target::{Target, root};

/// Scenes to draw. Together they have colour textures, bumps with roughness, environments, curvature, footprints of both kinds, edges, highlights and
/// peaks from a map. Fitted peaks and skies of many waves would take minutes.
const SCENES: [&str; 7] = ["highlight", "mesh", "shapes", "silk", "spheres-sphere", "three-normals", "velvet"];

/// Part of the frames of a scene, three of 20: unfiltered in `narrow`, 4 samples in `paper`, footprints in `standard`.
const PART: &str = "7";

/// Draws frames and compares their digests with the committed digests of the host.
pub fn run(target: Target) -> Result<(), Failure> {
    let Some(program) =
        target.build_hosted(&["--package", "roughxel-frame", "--example", "golden"], "examples/golden")?
    else {
        println!("{:12} frames SKIPPED: rustup has no standard library for {}", "", target.name());
        return Ok(());
    };
    let list = root().join("host-tests/golden/frames.txt");
    let options = [list.as_os_str(), OsStr::new("--part"), OsStr::new(PART)];
    let arguments: Vec<&OsStr> = options.into_iter().chain(SCENES.map(OsStr::new)).collect();
    let (code, text) = target.run_with(&program, &arguments)?;
    println!("{:12} {} scenes: {}", "", SCENES.len(), text.lines().last().unwrap_or_default());
    match code {
        0 => Ok(()),
        3 => Err(Failure::broken(format!("frames on {}:\n{text}", target.name()))),
        other => Err(Failure::trouble(format!("frames on {}: exit code {other}\n{text}", target.name()))),
    }
}
