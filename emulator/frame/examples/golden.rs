//! Draws whole frames on this processor and compares their digests with a list.
//!
//! `golden LIST [--part N] SCENE…` draws the lines of `host-tests/golden/frames.txt` that belong to these built-in scenes.
//! `--part N` draws every N-th line of each scene only, for machines on which a frame takes long. `cargo firmware frames` runs
//! this program on a different family of processors.
//!
//! Exit codes: 0 all digests are equal, 1 a list or scene is missing or cannot be drawn, 3 some digests differ.

use std::fs;
use std::process::ExitCode;

use rayon::prelude::*;
use roughxel_core::precision::Profile;
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_peaks::ScenePeaks;
use roughxel_scene::Scene;

/// A line of the list.
struct Golden<'a> {
    scene: &'a str,
    profile: &'a str,
    mode: &'a str,
    digest: &'a str,
}

impl<'a> Golden<'a> {
    fn parse(line: &'a str) -> Option<Self> {
        let mut words = line.split_whitespace();
        let mut next = || words.next();
        Some(Self { scene: next()?, profile: next()?, mode: next()?, digest: next()? })
    }

    /// Draws the frame; true if its digest is that of the list.
    fn is_drawn(&self, scene: &Scene, peaks: &ScenePeaks) -> Result<bool, String> {
        let failed = |what: &dyn std::fmt::Display| format!("{} {} {}: {what}", self.scene, self.profile, self.mode);
        let profile = Profile::by_name(self.profile).ok_or_else(|| failed(&"no such profile"))?;
        let mode: Mode = self.mode.parse().map_err(|error| failed(&error))?;
        let prepared = Prepared::with_peaks(scene, mode, &profile.precision(), peaks);
        let frame = prepared.and_then(|prepared| prepared.render(&|| ()));
        let digest = frame.map_err(|error| failed(&error))?.digest();
        let equal = digest == self.digest;
        if !equal {
            println!("{}", failed(&format_args!("{digest}, not {}", self.digest)));
        }
        Ok(equal)
    }
}

/// The size that the first line of a list states: `# SHA-256 of 64x48 frames …`.
fn size_of(list: &str) -> Option<[u32; 2]> {
    let words = list.lines().next()?.split_whitespace();
    let (width, height) = words.filter_map(|word| word.split_once('x')).next()?;
    Some([width.parse().ok()?, height.parse().ok()?])
}

/// Numbers of frames drawn and of frames that differ.
fn run() -> Result<(usize, usize), String> {
    let mut arguments = std::env::args().skip(1).peekable();
    let file = arguments.next().ok_or("golden LIST [--part N] SCENE…")?;
    let part = match arguments.next_if(|argument| argument == "--part") {
        Some(_) => arguments.next().and_then(|part| part.parse().ok()).ok_or("--part needs a number")?,
        None => 1,
    };
    let list = fs::read_to_string(&file).map_err(|error| format!("{file}: {error}"))?;
    let [width, height] = size_of(&list).ok_or_else(|| format!("{file}: its first line has no size"))?;
    let (mut drawn, mut differ) = (0, 0);
    for name in arguments {
        let failed = |what: &dyn std::fmt::Display| format!("scene {name}: {what}");
        let scene = Scene::builtin(&name).ok_or_else(|| failed(&"not built in"))?.map_err(|error| failed(&error))?;
        let scene = scene.with_size(width, height).map_err(|error| failed(&error))?;
        let peaks = ScenePeaks::new(&scene, true, None, &|_| ()).map_err(|error| failed(&error))?;
        let lines = list.lines().filter(|line| !line.starts_with('#')).filter_map(Golden::parse);
        let golden: Vec<Golden<'_>> = lines.filter(|golden| golden.scene == name).step_by(part).collect();
        if golden.is_empty() {
            return Err(failed(&"the list has no line of it"));
        }
        let equal: Result<Vec<bool>, String> =
            golden.par_iter().map(|golden| golden.is_drawn(&scene, &peaks)).collect();
        let equal = equal?;
        drawn += equal.len();
        differ += equal.iter().filter(|equal| !**equal).count();
    }
    Ok((drawn, differ))
}

fn main() -> ExitCode {
    match run() {
        Ok((drawn, differ)) => {
            println!("{drawn} frames, {differ} differ");
            ExitCode::from(if differ == 0 { 0 } else { 3 })
        }
        Err(what) => {
            eprintln!("{what}");
            ExitCode::FAILURE
        }
    }
}
