//! Arguments that several commands take.

use std::io::Write;
use std::num::NonZero;
use std::path::{Path, PathBuf, is_separator};

use roughxel_core::precision::Profile;
use roughxel_scene::Scene;
use roughxel_study::profile_file::{NamedPrecision, read_profile};
use roughxel_utilities::output::{self, OutputFile, Removed, WriteError};
use roughxel_utilities::suggestions::closest;

use super::console::{complain, map_progress};
use super::failure::{Failure, profile_failure, scene_failure};

/// ShadedColour at the end of every command's help.
pub(super) const CONVENTIONS: &str = "\
Units and formats:
  vectors      n, v, h, p_u, p_v may have any length; v points from the surface to the eye
  derivatives  per pixel: d/dx one pixel to the right, d/dy one pixel DOWN
  s, t         on a cube face, -1 to 1, s to the right, t down; faces 0-5: +x -x +y -y +z -z (Vulkan)
  lambda, step in units of s, t (half faces); K in half faces squared; lod in levels
  mantissas    I2F30 (two's complement, 30 fraction bits) times 2^exponent (16-bit integer)
  offsets      b, d, step: I4F28, -8 to 8; lod: I16F16
  profiles     narrow (14 kept fraction bits, on words of 16), paper, compact (both 16), standard (20), precise (26);
               or a file (TOML): a path, or a name that ends in .toml, with the knobs that are not those of its
               `base` (standard), such as fraction_bits = 18; its keys are in emulator/profiles.md

Exit codes: 0 done, 1 failure, 2 usage, 3 mismatch.
Data goes to stdout, progress and errors to stderr. NO_COLOR is respected.";

/// The built-in scene of that name or the scene in that file, at another size where one is given; its warnings are told.
pub(super) fn open_scene(name: &str, size: Option<[u32; 2]>) -> Result<Scene, Failure> {
    let bar = map_progress(name);
    let scene = Scene::open_with(name, &bar);
    bar.finish();
    let scene = scene.map_err(scene_failure)?;
    for warning in &scene.warnings {
        complain(&format!("warning: {warning}"));
    }
    Ok(match size {
        Some([width, height]) => scene.with_size(width, height)?,
        None => scene,
    })
}

/// A profile as a command-line argument.
#[derive(Clone, Debug)]
pub(super) enum ProfileArg {
    /// A named one.
    Named(Profile),
    /// A file, not read yet: what is wrong in it is no error of usage.
    File(PathBuf),
}

impl ProfileArg {
    /// Its name and knobs.
    pub(super) fn open(&self) -> Result<NamedPrecision, Failure> {
        match self {
            Self::Named(profile) => Ok((*profile).into()),
            Self::File(path) => read_profile(path).map_err(profile_failure),
        }
    }
}

pub(super) fn parse_profile(text: &str) -> Result<ProfileArg, String> {
    if let Some(profile) = Profile::by_name(text) {
        return Ok(ProfileArg::Named(profile));
    }
    let path = Path::new(text);
    if text.contains(is_separator) || path.extension().is_some_and(|extension| extension == "toml") {
        return Ok(ProfileArg::File(path.into()));
    }
    let meant = closest(text, Profile::NAMES).map_or_else(String::new, |name| format!("; did you mean `{name}`?"));
    Err(format!("profiles are {}, or a file (a path, or a name that ends in .toml){meant}", Profile::NAMES.join(", ")))
}

/// Profiles as one command-line argument.
#[derive(Clone, Debug)]
pub(super) enum Profiles {
    /// Every named one.
    All,
    /// One.
    One(ProfileArg),
}

impl Profiles {
    /// Their names and knobs.
    pub(super) fn open(&self) -> Result<Vec<NamedPrecision>, Failure> {
        match self {
            Self::All => Ok(Profile::ALL.map(NamedPrecision::from).to_vec()),
            Self::One(profile) => Ok(vec![profile.open()?]),
        }
    }
}

pub(super) fn parse_profiles(text: &str) -> Result<Profiles, String> {
    if text == "all" { Ok(Profiles::All) } else { parse_profile(text).map(Profiles::One) }
}

/// `WIDTHxHEIGHT` in pixels, each up to 16384 and 2^26 together.
pub(super) fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let number = |text: &str| text.parse::<u32>().ok().filter(|edge| (1..=16384).contains(edge));
    let size = text.split_once(['x', 'X']).and_then(|(width, height)| Some([number(width)?, number(height)?]));
    size.filter(|[width, height]| width * height <= 1 << 26)
        .ok_or_else(|| "a size is WIDTHxHEIGHT, each from 1 to 16384 and at most 2^26 pixels, such as 640x400".into())
}

/// A picture to write: what it is must be what its name says.
pub(super) fn parse_png(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match path.extension() {
        Some(ending) if !ending.eq_ignore_ascii_case("png") => {
            Err("pictures are written as PNG alone: end the name in .png, and convert the picture afterwards".into())
        }
        _ => Ok(path),
    }
}

/// Refuses a file that cannot be written, before the work that it is for.
pub(super) fn check_file(path: &Path) -> Result<(), WriteError> {
    OutputFile::check(path).map_err(|source| WriteError { path: path.into(), source })
}

/// Refuses a directory that cannot be written to or made, before the work that it is for.
pub(super) fn check_directory(path: &Path) -> Result<(), WriteError> {
    output::check_directory(path).map_err(|source| WriteError { path: path.into(), source })
}

/// Writes a text; the file appears whole or not at all.
pub(super) fn write_text(path: &Path, text: &str) -> Result<(), WriteError> {
    let write = || {
        let mut file = OutputFile::create(path)?;
        file.write_all(text.as_bytes())?;
        file.commit()
    };
    write().map_err(|source| WriteError { path: path.into(), source })
}

/// Removes what runs that were killed left in a directory, and says so.
pub(super) fn remove_abandoned_in(directory: &Path) {
    let Removed { files, bytes } = output::remove_abandoned(directory);
    if files > 0 {
        let directory = directory.display();
        complain(&format!("note: removed from {directory} what interrupted runs left: {files} files, {bytes} bytes"));
    }
}

/// A number of threads, 1 to 1024.
pub(super) fn parse_threads(text: &str) -> Result<usize, String> {
    let threads = text.parse().ok().filter(|threads| (1..=1024).contains(threads));
    threads.ok_or_else(|| "a number of threads is from 1 to 1024".into())
}

/// Sets the number of threads of the whole program, at most one for each core; none leaves it to the machine.
///
/// More than cores only look for work that others have: 1024 on two of them took 47 times as long as two.
pub(super) fn use_threads(threads: Option<usize>) -> Result<(), Failure> {
    let cores = std::thread::available_parallelism().map_or(usize::MAX, NonZero::get);
    match threads {
        Some(threads) => Ok(rayon::ThreadPoolBuilder::new().num_threads(threads.min(cores)).build_global()?),
        None => Ok(()),
    }
}

/// A name as part of a file name: lower-case letters, digits and underscores, at most 40.
pub(super) fn file_stem(name: &str) -> String {
    let name = Path::new(name).file_stem().map_or(name.into(), |stem| stem.to_string_lossy());
    let good = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    name.chars().map(good).take(40).collect()
}
