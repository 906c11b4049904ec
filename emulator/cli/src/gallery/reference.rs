//! Reference of a scene, and its file between runs.
//!
//! A file `KEY.frame` is `roughxel frame KEY DIGEST`, a line end, then width, height and the channels as big-endian 32-bit words. KEY is the
//! SHA-256 of everything that the frame depends on: text of the scene, size, samples, program version, and the digest of the same frame with one
//! sample a pixel. A program that computes different pixels thus has a different key. A file with a wrong length, key or digest is drawn again.

use std::fmt::Write as _;
use std::fs;
use std::io::{self, Write as _};
use std::path::Path;
use std::time::{Duration, Instant};

use roughxel_core::precision::Precision;
use roughxel_frame::Frame;
use roughxel_frame::plan::Mode;
use roughxel_peaks::ScenePeaks;
use roughxel_scene::{Scene, builtin_text};
use roughxel_utilities::output::{OutputFile, WriteError};
use sha2::{Digest, Sha256};

use super::drawn::{GalleryError, Settings};
use super::prepared::{prepare, render};

/// Directory of the files, below the directory of the gallery.
const DIRECTORY: &str = ".reference";

/// Profile of the reference, independent of that of the columns.
const PROFILE: Precision = Precision::PRECISE;

/// Draws or reads the reference of the built-in scene `name`. The drawing time is `None` if a file was read.
pub(super) fn reference(
    scene: &Scene,
    name: &str,
    peaks: &ScenePeaks,
    settings: &Settings,
    directory: &Path,
    progress: &(dyn Fn() + Sync),
) -> Result<(Frame, Option<Duration>), GalleryError> {
    let directory = directory.join(DIRECTORY);
    let key = key(scene, name, peaks, settings)?;
    let path = directory.join(format!("{key}.frame"));
    if let Some(frame) = read(&path, &key, settings.size) {
        return Ok((frame, None));
    }
    let prepared = prepare(scene, Mode::Supersampled { edge: settings.reference_edge }, &PROFILE, peaks)?;
    let start = Instant::now();
    let frame = render(scene, &prepared, progress)?;
    let time = start.elapsed();
    let written = fs::create_dir_all(&directory).and_then(|()| write(&path, &key, &frame));
    written.map_err(|source| WriteError { path, source })?;
    Ok((frame, Some(time)))
}

/// Makes the key of a reference, 64 hexadecimal digits.
fn key(scene: &Scene, name: &str, peaks: &ScenePeaks, settings: &Settings) -> Result<String, GalleryError> {
    let once = render(scene, &prepare(scene, Mode::Unfiltered, &PROFILE, peaks)?, &|| ())?.digest();
    let [width, height] = settings.size.map(|edge| edge.to_string());
    let edge = settings.reference_edge.to_string();
    let mut hash = Sha256::new();
    for part in [env!("CARGO_PKG_VERSION"), builtin_text(name).unwrap_or(name), &width, &height, &edge, &once] {
        hash.update((part.len() as u64).to_be_bytes());
        hash.update(part);
    }
    Ok(hash.finalize().iter().fold(String::new(), |mut text, byte| {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    }))
}

fn header(key: &str, digest: &str) -> String {
    format!("roughxel frame {key} {digest}\n")
}

fn write(path: &Path, key: &str, frame: &Frame) -> io::Result<()> {
    let mut file = OutputFile::create(path)?;
    file.write_all(header(key, &frame.digest()).as_bytes())?;
    for edge in [frame.width, frame.height] {
        file.write_all(&edge.to_be_bytes())?;
    }
    for channel in frame.pixels.iter().flatten() {
        file.write_all(&channel.to_be_bytes())?;
    }
    file.commit()
}

/// Reads the frame of a file, if the file is whole and has the key.
fn read(path: &Path, key: &str, size: [u32; 2]) -> Option<Frame> {
    let [width, height] = size;
    let pixels = width as usize * height as usize;
    let header_bytes = header(key, &"0".repeat(64)).len();
    let bytes = header_bytes + 4 * (2 + 3 * pixels);
    // The length is checked before memory is allocated.
    if fs::metadata(path).ok()?.len() != bytes as u64 {
        return None;
    }
    let file = fs::read(path).ok()?;
    let (found, words) = file.split_at_checked(header_bytes)?;
    let words: Vec<i32> = words.as_chunks().0.iter().map(|word| i32::from_be_bytes(*word)).collect();
    let (edges, channels) = words.split_at_checked(2)?;
    let frame = Frame { width, height, pixels: channels.as_chunks().0.to_vec() };
    let is_whole = edges == [width as i32, height as i32]
        && frame.pixels.len() == pixels
        && found == header(key, &frame.digest()).as_bytes();
    is_whole.then_some(frame)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> Frame {
        Frame { width: 3, height: 2, pixels: (0..6).map(|i| [i, -i, i << 20]).collect() }
    }

    #[test]
    fn a_kept_frame_is_read_back_and_no_damaged_or_foreign_one_is() {
        let directory = tempfile::tempdir().unwrap();
        let (path, key) = (directory.path().join("a.frame"), "5".repeat(64));
        assert_eq!(read(&path, &key, [3, 2]), None);
        write(&path, &key, &frame()).unwrap();
        assert_eq!(read(&path, &key, [3, 2]), Some(frame()));
        assert_eq!(read(&path, &"6".repeat(64), [3, 2]), None);
        assert_eq!(read(&path, &key, [2, 3]), None);
        assert_eq!(read(&path, &key, [3, 3]), None);

        let whole = fs::read(&path).unwrap();
        for length in 0..whole.len() {
            fs::write(&path, &whole[..length]).unwrap();
            assert_eq!(read(&path, &key, [3, 2]), None, "{length}");
        }
        for index in 0..whole.len() {
            let mut damaged = whole.clone();
            damaged[index] ^= 1;
            fs::write(&path, &damaged).unwrap();
            assert_eq!(read(&path, &key, [3, 2]), None, "{index}");
        }
    }
}
