//! Pyramids kept on disk, by the content they were built from.
//!
//! A file is a magic line with the version of format and method, the SHA-256 of everything that a pyramid depends on, the
//! pyramid (little-endian), and the SHA-256 of all that. It is read only if all of this fits and no number is out
//! of its range; anything else (torn, truncated, foreign, of another version) counts as missing and is replaced. Files
//! appear whole ([`roughxel_scene::output`]), so two programs may share a directory.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use glam::DVec3;
use roughxel_scene::output::OutputFile;
use sha2::{Digest, Sha256};

use super::levels::{FitCounts, Horizon, Peak, PeakLevel, PeakPyramid};
use super::source::{BuildOptions, EXPONENTS, FacetWeight, MAX_PEAKS, PeakError, PeakSource, texels};
use crate::levels::level_sizes;

/// First bytes of a file; the number changes with the format and with every change of what is built.
const MAGIC: &[u8] = b"roughxel peak pyramid 3\n";
/// Bytes of a SHA-256.
const HASH: usize = 32;
/// Bytes of the counts that precede the levels.
const COUNTS: usize = 5 * 8;

/// A pyramid that may have been on disk.
#[derive(Debug)]
pub struct Cached {
    /// The same bits, wherever it came from.
    pub pyramid: PeakPyramid,
    /// Whether it was read rather than built.
    pub read: bool,
    /// Why it could not be kept for the next time; the pyramid is good all the same.
    pub not_kept: Option<io::Error>,
}

impl PeakPyramid {
    /// As [`PeakPyramid::build`], but reads the pyramid from a directory if it was built before, and keeps it there if not.
    ///
    /// The directory is made if it is missing; `progress` is not called where the pyramid is read. A cache file of the largest map
    /// with heights has 0.5 GB. Errors: those of [`PeakPyramid::build`] only.
    pub fn cached(
        directory: &Path,
        source: &PeakSource,
        options: &BuildOptions,
        progress: &(dyn Fn() + Sync),
    ) -> Result<Cached, PeakError> {
        source.check()?;
        options.check()?;
        let key = key(source, options);
        let path = path(directory, &key);
        if let Some(pyramid) = read(&path, &key, source) {
            return Ok(Cached { pyramid, read: true, not_kept: None });
        }
        let pyramid = Self::build(source, options, progress)?;
        let not_kept = write(&path, &key, &pyramid).err();
        Ok(Cached { pyramid, read: false, not_kept })
    }
}

/// Hash of everything that a pyramid depends on.
fn key(source: &PeakSource, options: &BuildOptions) -> [u8; HASH] {
    let mut hash = Sha256::new_with_prefix(MAGIC);
    hash.update(source.width.to_le_bytes());
    hash.update(source.height.to_le_bytes());
    hash.update(options.exponent.to_le_bytes());
    hash.update(options.amplitude.to_le_bytes());
    let weight = match options.weight {
        FacetWeight::Surface => 0,
        FacetWeight::Texel => 1,
    };
    hash.update([weight, u8::from(options.negate), u8::from(source.heights.is_some())]);
    for coordinate in source.normals.iter().flat_map(DVec3::to_array) {
        hash.update(coordinate.to_le_bytes());
    }
    for height in source.heights.iter().flatten() {
        hash.update(height.to_le_bytes());
    }
    hash.update(source.rows_apart.to_le_bytes());
    hash.finalize().into()
}

/// Name of the file of a key.
fn path(directory: &Path, key: &[u8; HASH]) -> PathBuf {
    let name: String = key.iter().map(|byte| format!("{byte:02x}")).collect();
    directory.join(name + ".peaks")
}

fn write(path: &Path, key: &[u8; HASH], pyramid: &PeakPyramid) -> io::Result<()> {
    let mut bytes = [MAGIC, key].concat();
    let FitCounts { fitted, seven, missed, worst_rms, worst_maximum } = pyramid.fits;
    for count in [fitted, seven, missed] {
        bytes.extend((count as u64).to_le_bytes());
    }
    for share in [worst_rms, worst_maximum] {
        bytes.extend(share.to_le_bytes());
    }
    for level in &pyramid.levels {
        for y in 0..level.height {
            for x in 0..level.width {
                let texel = level.texel(x, y);
                bytes.extend((texel.len() as u64).to_le_bytes());
                let mut number = |value: f64| bytes.extend(value.to_le_bytes());
                for peak in texel {
                    [peak.amplitude, peak.exponent].into_iter().chain(peak.normal.to_array()).for_each(&mut number);
                    for Horizon { mean, deviation, low, width } in peak.horizon.iter().flatten() {
                        [*mean, *deviation, *low, *width].into_iter().for_each(&mut number);
                    }
                }
            }
        }
    }
    let hash = Sha256::digest(&bytes);
    path.parent().map_or(Ok(()), fs::create_dir_all)?;
    let mut file = OutputFile::create(path)?;
    file.write_all(&bytes)?;
    file.write_all(&hash)?;
    file.commit()
}

/// The pyramid of a file; `None` for whatever is wrong with it.
fn read(path: &Path, key: &[u8; HASH], source: &PeakSource) -> Option<PeakPyramid> {
    let file = File::open(path).ok()?;
    let metadata = file.metadata().ok()?;
    // The file is as long as its peaks; no pyramid of this size is longer than this.
    let texels = all_texels(source);
    let peak = 8 * (5 + if source.heights.is_some() { 16 } else { 0 });
    let longest = (MAGIC.len() + 2 * HASH + COUNTS) as u64 + texels * (8 + MAX_PEAKS as u64 * peak);
    if !metadata.is_file() || metadata.len() > longest {
        return None;
    }
    let mut bytes = Vec::with_capacity(metadata.len() as usize);
    file.take(longest).read_to_end(&mut bytes).ok()?;
    let (content, hash) = bytes.split_last_chunk::<HASH>()?;
    if Sha256::digest(content)[..] != hash[..] {
        return None;
    }
    let (numbers, rest) = content.strip_prefix(MAGIC)?.strip_prefix(key)?.as_chunks();
    let mut numbers = Numbers(numbers.iter());
    let pyramid = parse(&mut numbers, source)?;
    (rest.is_empty() && numbers.0.len() == 0).then_some(pyramid)
}

/// Texels of all levels.
fn all_texels(source: &PeakSource) -> u64 {
    source.normals.len() as u64 + source.upper_levels().map(texels).sum::<u64>()
}

/// Numbers of a file that are still to be read.
struct Numbers<'a>(std::slice::Iter<'a, [u8; 8]>);

impl Numbers<'_> {
    fn count(&mut self, most: usize) -> Option<usize> {
        let count = usize::try_from(u64::from_le_bytes(*self.0.next()?)).ok()?;
        (count <= most).then_some(count)
    }

    fn real(&mut self, range: RangeInclusive<f64>) -> Option<f64> {
        let value = f64::from_le_bytes(*self.0.next()?);
        range.contains(&value).then_some(value)
    }
}

/// A pyramid from its numbers, each within the range it has in a pyramid.
fn parse(numbers: &mut Numbers<'_>, source: &PeakSource) -> Option<PeakPyramid> {
    let most = all_texels(source) as usize;
    let fits = FitCounts {
        fitted: numbers.count(most)?,
        seven: numbers.count(most)?,
        missed: numbers.count(most)?,
        worst_rms: numbers.real(0.0..=f64::MAX)?,
        worst_maximum: numbers.real(0.0..=f64::MAX)?,
    };
    let mut levels = Vec::new();
    for (width, height) in level_sizes(source.width, source.height) {
        let mut texels = Vec::with_capacity(width as usize * height as usize);
        for _ in 0..width * height {
            let peaks = numbers.count(if levels.is_empty() { 1 } else { MAX_PEAKS })?;
            let texel: Option<Vec<Peak>> = (0..peaks).map(|_| peak(numbers, source.heights.is_some())).collect();
            texels.push(texel?);
        }
        levels.push(PeakLevel::new(width, height, texels.into_iter()));
    }
    Some(PeakPyramid { levels, fits })
}

fn peak(numbers: &mut Numbers<'_>, with_horizon: bool) -> Option<Peak> {
    let amplitude = numbers.real(0.0..=f64::MAX)?;
    let exponent = numbers.real(EXPONENTS)?;
    let mut normal = DVec3::ZERO;
    for axis in 0..3 {
        normal[axis] = numbers.real(-1.0..=1.0)?;
    }
    let mut horizon = with_horizon.then_some([Horizon::default(); 4]);
    for side in horizon.iter_mut().flatten() {
        *side = Horizon {
            mean: numbers.real(0.0..=f64::MAX)?,
            deviation: numbers.real(0.0..=f64::MAX)?,
            low: numbers.real(f64::MIN..=f64::MAX)?,
            width: numbers.real(0.0..=f64::MAX)?,
        };
    }
    Some(Peak { amplitude, normal, exponent, horizon })
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::super::build::tests::{OPTIONS, hills};
    use super::*;

    /// The pyramid, whether it was read, and how often progress was reported.
    fn cached(directory: &Path, source: &PeakSource, options: &BuildOptions) -> (PeakPyramid, bool, usize) {
        let steps = AtomicUsize::new(0);
        let cached = PeakPyramid::cached(directory, source, options, &|| {
            steps.fetch_add(1, Ordering::Relaxed);
        });
        let cached = cached.expect("the source is good");
        assert!(cached.not_kept.is_none());
        (cached.pyramid, cached.read, steps.into_inner())
    }

    #[test]
    fn a_pyramid_comes_back_with_the_same_bits() {
        let directory = tempfile::tempdir().expect("a directory");
        for source in [hills(4, 3), PeakSource { heights: None, ..hills(3, 5) }] {
            let (built, read, steps) = cached(directory.path(), &source, &OPTIONS);
            assert!(!read && steps as u64 == source.steps() && built.fits.fitted > 0);
            assert_eq!(cached(directory.path(), &source, &OPTIONS), (built, true, 0));
        }
    }

    #[test]
    fn what_a_pyramid_depends_on_is_in_its_key() {
        let (source, options) = (hills(4, 4), OPTIONS);
        let mut keys = vec![key(&source, &options)];
        let mut source_with = |change: &dyn Fn(&mut PeakSource)| {
            let mut source = source.clone();
            change(&mut source);
            keys.push(key(&source, &options));
        };
        source_with(&|source| source.normals[3].x += 1e-12);
        source_with(&|source| source.heights = None);
        source_with(&|source| source.heights.iter_mut().for_each(|heights| heights[15] += 1e-9));
        source_with(&|source| (source.width, source.height) = (2, 8));
        source_with(&|source| source.rows_apart = 2.0);
        for options in [
            BuildOptions { exponent: 41.0, ..options },
            BuildOptions { amplitude: 0.5, ..options },
            BuildOptions { weight: FacetWeight::Texel, ..options },
            BuildOptions { negate: true, ..options },
        ] {
            keys.push(key(&source, &options));
        }
        let count = keys.len();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), count);
    }

    #[test]
    fn torn_foreign_and_changed_files_are_rebuilt() {
        let directory = tempfile::tempdir().expect("a directory");
        let source = hills(4, 4);
        let (built, ..) = cached(directory.path(), &source, &OPTIONS);
        let path = path(directory.path(), &key(&source, &OPTIONS));
        let good = fs::read(&path).expect("the file is there");
        let mut bad: Vec<Vec<u8>> = (0..good.len()).step_by(37).map(|length| good[..length].to_vec()).collect();
        for place in (0..good.len()).step_by(41) {
            let mut changed = good.clone();
            changed[place] ^= 1;
            bad.push(changed);
        }
        bad.push([&good[..], &[0]].concat());
        bad.push(vec![0; 1 << 20]);
        // A file that is whole, but of another map.
        let other = PeakSource { heights: None, ..hills(4, 4) };
        cached(directory.path(), &other, &OPTIONS);
        bad.push(fs::read(super::path(directory.path(), &key(&other, &OPTIONS))).expect("the file is there"));
        // A hash that fits what should not be there: one number too many, and an exponent out of range.
        let resealed = |content: &[u8]| [content, &Sha256::digest(content)[..]].concat();
        let content = &good[..good.len() - HASH];
        bad.push(resealed(&[content, &[0; 8]].concat()));
        let mut exponent = content.to_vec();
        let place = MAGIC.len() + HASH + COUNTS + 16;
        assert_eq!(exponent[place..place + 8], OPTIONS.exponent.to_le_bytes());
        exponent[place..place + 8].copy_from_slice(&f64::NAN.to_le_bytes());
        bad.push(resealed(&exponent));
        for bytes in bad {
            fs::write(&path, &bytes).expect("the file can be written");
            assert!(read(&path, &key(&source, &OPTIONS), &source).is_none(), "{} bytes", bytes.len());
        }
        assert!(!cached(directory.path(), &source, &OPTIONS).1);
        assert_eq!(fs::read(&path).expect("the file is there"), good, "the bad file was replaced");
        assert_eq!(cached(directory.path(), &source, &OPTIONS).0, built);
    }

    #[test]
    fn a_directory_is_made_and_one_that_cannot_be_costs_only_the_next_time() {
        let directory = tempfile::tempdir().expect("a directory");
        let missing = directory.path().join("missing/and/below");
        assert!(!cached(&missing, &hills(2, 2), &OPTIONS).1 && cached(&missing, &hills(2, 2), &OPTIONS).1);
        let file = directory.path().join("file");
        fs::write(&file, "").expect("the file can be written");
        for place in [&file, &file.join("below")] {
            let cached = PeakPyramid::cached(place, &hills(2, 2), &OPTIONS, &|| ()).expect("the source is good");
            assert!(!cached.read && cached.not_kept.is_some());
        }
    }
}
