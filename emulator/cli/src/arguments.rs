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

/// Text at the end of most commands' help.
pub(super) const CONVENTIONS: &str = "\
Units and formats:
  vectors      n, v, h, p_u, p_v may have any length; v points from the surface to the eye
  derivatives  per pixel: d/dx one pixel to the right, d/dy one pixel DOWN
  s, t         on a cube face, -1 to 1, s to the right, t down; faces 0-5: +x -x +y -y +z -z (Vulkan)
  lambda, step in units of s, t (half faces); K in half faces squared; lod in levels
  mantissas    I2F30 (two's complement, 30 fraction bits) times 2^exponent (16-bit integer)
  offsets      b, d, step: I4F28, -8 to 8; lod: I16F16
  profiles     narrow (14 kept fraction bits, on 16-bit words), paper, compact (both 16), standard (20), precise (26);
               or a TOML file: a path, or a name that ends in .toml. It holds the knobs that differ from its `base`
               (standard), such as fraction_bits = 18; emulator/profiles.md lists the keys

Exit codes: 0 done, 1 failure, 2 usage, 3 mismatch.
Data goes to stdout, progress and errors to stderr. NO_COLOR is respected.";

/// Opens a built-in scene or a scene file, at another size if one is given. Its warnings go to stderr.
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
    /// A named profile.
    Named(Profile),
    /// A file that is not read yet. An error in it is not an error of usage.
    File(PathBuf),
}

impl ProfileArg {
    /// Opens the profile: name and knobs.
    pub(super) fn open(&self) -> Result<NamedPrecision, Failure> {
        match self {
            Self::Named(profile) => Ok((*profile).into()),
            Self::File(path) => read_profile(path).map_err(profile_failure),
        }
    }
}

/// Parses a profile's name or path.
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
    /// Every named profile.
    All,
    /// One profile.
    One(ProfileArg),
}

impl Profiles {
    /// Opens the profiles: names and knobs.
    pub(super) fn open(&self) -> Result<Vec<NamedPrecision>, Failure> {
        match self {
            Self::All => Ok(Profile::ALL.map(NamedPrecision::from).to_vec()),
            Self::One(profile) => Ok(vec![profile.open()?]),
        }
    }
}

/// Parses `all`, or a profile's name or path.
pub(super) fn parse_profiles(text: &str) -> Result<Profiles, String> {
    if text == "all" { Ok(Profiles::All) } else { parse_profile(text).map(Profiles::One) }
}

/// Parses `WIDTHxHEIGHT` in pixels: each up to 16384, at most 2^26 pixels in all.
pub(super) fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let number = |text: &str| text.parse::<u32>().ok().filter(|edge| (1..=16384).contains(edge));
    let size = text.split_once(['x', 'X']).and_then(|(width, height)| Some([number(width)?, number(height)?]));
    size.filter(|[width, height]| width * height <= 1 << 26)
        .ok_or_else(|| "a size is WIDTHxHEIGHT, each from 1 to 16384 and at most 2^26 pixels, such as 640x400".into())
}

/// Parses the path of a picture to write. Pictures are PNG, so an extension must be `png`.
pub(super) fn parse_png(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match path.extension() {
        Some(ending) if !ending.eq_ignore_ascii_case("png") => {
            Err("pictures are written as PNG alone: end the name in .png, and convert the picture afterwards".into())
        }
        _ => Ok(path),
    }
}

/// Refuses a file that cannot be written, before the work starts.
pub(super) fn check_file(path: &Path) -> Result<(), WriteError> {
    OutputFile::check(path).map_err(|source| WriteError { path: path.into(), source })
}

/// Refuses a directory that cannot be written to or created, before the work starts.
pub(super) fn check_directory(path: &Path) -> Result<(), WriteError> {
    output::check_directory(path).map_err(|source| WriteError { path: path.into(), source })
}

/// Writes a text file, which appears whole or not at all.
pub(super) fn write_text(path: &Path, text: &str) -> Result<(), WriteError> {
    let write = || {
        let mut file = OutputFile::create(path)?;
        file.write_all(text.as_bytes())?;
        file.commit()
    };
    write().map_err(|source| WriteError { path: path.into(), source })
}

/// Removes the temporary files that killed runs left in a directory, and says so.
pub(super) fn remove_abandoned_in(directory: &Path) {
    let Removed { files, bytes } = output::remove_abandoned(directory);
    if files > 0 {
        let directory = directory.display();
        complain(&format!("note: removed from {directory} what interrupted runs left: {files} files, {bytes} bytes"));
    }
}

/// Parses a number of threads, 1 to 1024.
pub(super) fn parse_threads(text: &str) -> Result<usize, String> {
    let threads = text.parse().ok().filter(|threads| (1..=1024).contains(threads));
    threads.ok_or_else(|| "a number of threads is from 1 to 1024".into())
}

/// Sets the number of threads of the program, at most one per core. `None` means one per core.
///
/// Surplus threads only look for work: on two cores, 1024 threads take 47 times as long as two.
pub(super) fn use_threads(threads: Option<usize>) -> Result<(), Failure> {
    let cores = std::thread::available_parallelism().map_or(usize::MAX, NonZero::get);
    match threads {
        Some(threads) => Ok(rayon::ThreadPoolBuilder::new().num_threads(threads.min(cores)).build_global()?),
        None => Ok(()),
    }
}

/// Makes a name part of a file name: at most 40 lower-case letters, digits and underscores.
pub(super) fn file_stem(name: &str) -> String {
    let name = Path::new(name).file_stem().map_or(name.into(), |stem| stem.to_string_lossy());
    let good = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    name.chars().map(good).take(40).collect()
}
