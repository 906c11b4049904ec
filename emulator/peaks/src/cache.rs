//! Pyramids kept on disk, keyed by the content that they are built from.
//!
//! A file is a magic line with the version of format and method, the SHA-256 of everything that a pyramid depends on, the
//! pyramid (little-endian), and the SHA-256 of these bytes. A file is read only if all parts fit and every number is in
//! range. Any other file (torn, truncated, foreign, of a different version) counts as missing and is replaced. Files
//! appear whole ([`roughxel_utilities::output`]), so two programs may share a directory.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use glam::DVec3;
use roughxel_utilities::output::OutputFile;
use sha2::{Digest, Sha256};

use super::build::{Part, Parts, Texels};
use super::levels::{FitCounts, Horizon, Peak, PeakLevel, PeakPyramid, Steps};
use super::source::{BuildOptions, EXPONENTS, MAX_PEAKS, PeakError, PeakSource, texels};
use roughxel_scene::Edges;
use roughxel_scene::levels::level_sizes;

/// First bytes of a file. The number changes with the format and with every change of the built content.
const MAGIC: &[u8] = b"roughxel peak pyramid 6\n";
/// First bytes of a part of a pyramid. The key of the pyramid is also in the file, and with it the number of [`MAGIC`].
const PART_MAGIC: &[u8] = b"roughxel part of peaks 1\n";
/// Bytes of a SHA-256.
const HASH: usize = 32;
/// A pyramid that may come from disk.
#[derive(Debug)]
pub struct Cached {
    /// The pyramid: the same bits, wherever it comes from.
    pub pyramid: PeakPyramid,
    /// True if it was read rather than built.
    pub read: bool,
    /// Reason why it could not be kept for the next time; the pyramid is good all the same.
    pub not_kept: Option<io::Error>,
    /// Number of its texels that may take a fit and that an interrupted build had kept.
    pub resumed: u64,
    /// Damaged files of an interrupted build; their content is fitted again.
    pub damaged: Vec<PathBuf>,
}

impl Cached {
    /// A pyramid that is not from disk.
    pub(super) fn new(pyramid: PeakPyramid) -> Self {
        Self { pyramid, read: false, not_kept: None, resumed: 0, damaged: Vec::new() }
    }
}

impl PeakPyramid {
    /// Reads the pyramid from a directory if it was built before; otherwise builds it as [`PeakPyramid::build`] does and keeps it there.
    ///
    /// The directory is made if it is missing. An interrupted build leaves its finished parts there, and the next build takes them: the pyramid
    /// has the same bits. A cache file of the largest map with heights has 0.5 GB. Errors: those of [`PeakPyramid::build`] only.
    pub fn cached(
        directory: &Path,
        source: &PeakSource,
        options: &BuildOptions,
        progress: &(dyn Fn(Steps) + Sync),
    ) -> Result<Cached, PeakError> {
        source.check()?;
        options.check()?;
        let key = key(source, options);
        let path = path(directory, &key);
        if let Some(pyramid) = read(&path, &key, source) {
            progress(Steps::Found(source.steps()));
            return Ok(Cached { read: true, ..Cached::new(pyramid) });
        }
        let mut parts = KeptParts::new(path.with_extension("parts"), key, source.heights.is_some());
        let pyramid = Self::build_in_parts(source, options, progress, &mut parts)?;
        let not_kept = write(&path, &key, &pyramid).err();
        if not_kept.is_none() {
            parts.remove();
        }
        Ok(Cached { not_kept, resumed: parts.resumed, damaged: parts.damaged, ..Cached::new(pyramid) })
    }
}

/// Parts of a pyramid on disk.
struct KeptParts {
    directory: PathBuf,
    key: [u8; HASH],
    with_horizon: bool,
    /// True if parts can be written. A read-only directory is reported when the pyramid itself is not kept.
    writable: bool,
    resumed: u64,
    damaged: Vec<PathBuf>,
}

impl KeptParts {
    fn new(directory: PathBuf, key: [u8; HASH], with_horizon: bool) -> Self {
        Self { directory, key, with_horizon, writable: true, resumed: 0, damaged: Vec::new() }
    }

    fn path(&self, part: Part) -> PathBuf {
        self.directory.join(format!("{}-{}.part", part.level, part.first))
    }

    /// First bytes of a part's file, up to the counts.
    fn head(&self, part: Part) -> Vec<u8> {
        let place = [part.level, part.first, part.texels].map(|number| (number as u64).to_le_bytes());
        [PART_MAGIC, &self.key, place.as_flattened()].concat()
    }

    /// Removes all parts.
    fn remove(&self) {
        // Remaining files are replaced or do no harm.
        let _ = fs::remove_dir_all(&self.directory);
    }
}

impl Parts for KeptParts {
    fn find(&mut self, part: Part) -> Option<Texels> {
        let path = self.path(part);
        if !path.exists() {
            return None;
        }
        let texels = read_sealed(&path, &self.head(part), part.texels as u64, self.with_horizon, |numbers| {
            let fits = numbers.fits(part.texels)?;
            let peaks: Option<_> = (0..part.texels).map(|_| numbers.texel(MAX_PEAKS, self.with_horizon)).collect();
            Some(Texels { peaks: peaks?, fits })
        });
        match &texels {
            Some(_) => self.resumed += part.texels as u64,
            None => self.damaged.push(path),
        }
        texels
    }

    fn keep(&mut self, part: Part, texels: &Texels) {
        if !self.writable {
            return;
        }
        let mut bytes = self.head(part);
        put_fits(&mut bytes, &texels.fits);
        texels.peaks.iter().for_each(|texel| put_texel(&mut bytes, texel));
        self.writable = write_sealed(&self.path(part), &bytes).is_ok();
    }
}

/// Hash of everything that a pyramid depends on.
fn key(source: &PeakSource, options: &BuildOptions) -> [u8; HASH] {
    let mut hash = Sha256::new_with_prefix(MAGIC);
    hash.update(source.width.to_le_bytes());
    hash.update(source.height.to_le_bytes());
    hash.update(options.exponent.to_le_bytes());
    hash.update(options.amplitude.to_le_bytes());
    hash.update([options.weight as u8, u8::from(options.negate), u8::from(source.heights.is_some())]);
    for coordinate in source.normals.iter().flat_map(DVec3::to_array) {
        hash.update(coordinate.to_le_bytes());
    }
    for height in source.heights.iter().flatten() {
        hash.update(height.to_le_bytes());
    }
    hash.update(source.rows_apart.to_le_bytes());
    if source.edges == Edges::Open {
        hash.update(b"open");
    }
    hash.finalize().into()
}

/// Path of the file of a key.
fn path(directory: &Path, key: &[u8; HASH]) -> PathBuf {
    let name: String = key.iter().map(|byte| format!("{byte:02x}")).collect();
    directory.join(name + ".peaks")
}

fn write(path: &Path, key: &[u8; HASH], pyramid: &PeakPyramid) -> io::Result<()> {
    let mut bytes = [MAGIC, key].concat();
    put_fits(&mut bytes, &pyramid.fits);
    pyramid.levels.iter().flat_map(PeakLevel::texels).for_each(|texel| put_texel(&mut bytes, texel));
    write_sealed(path, &bytes)
}

fn put_fits(bytes: &mut Vec<u8>, fits: &FitCounts) {
    let FitCounts { fitted, seven, missed, worst_rms, worst_maximum } = *fits;
    for count in [fitted, seven, missed] {
        bytes.extend((count as u64).to_le_bytes());
    }
    for share in [worst_rms, worst_maximum] {
        bytes.extend(share.to_le_bytes());
    }
}

fn put_texel(bytes: &mut Vec<u8>, texel: &[Peak]) {
    bytes.extend((texel.len() as u64).to_le_bytes());
    let mut number = |value: f64| bytes.extend(value.to_le_bytes());
    for peak in texel {
        [peak.amplitude, peak.exponent].into_iter().chain(peak.normal.to_array()).for_each(&mut number);
        for Horizon { mean, deviation, low, width } in peak.horizon.iter().flatten() {
            [*mean, *deviation, *low, *width].into_iter().for_each(&mut number);
        }
    }
}

/// Writes a file followed by the hash of its bytes, whole or not at all.
fn write_sealed(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let hash = Sha256::digest(bytes);
    path.parent().map_or(Ok(()), fs::create_dir_all)?;
    let mut file = OutputFile::create(path)?;
    file.write_all(bytes)?;
    file.write_all(&hash)?;
    file.commit()
}

/// Parses the numbers after the head of a sealed file of `texels` texels; `None` for any mistake.
fn read_sealed<T>(
    path: &Path,
    head: &[u8],
    texels: u64,
    with_horizon: bool,
    parse: impl FnOnce(&mut Numbers<'_>) -> Option<T>,
) -> Option<T> {
    let peak = 5 + if with_horizon { 16 } else { 0 };
    let longest = (head.len() + HASH) as u64 + 8 * (5 + texels * (1 + MAX_PEAKS as u64 * peak));
    let mut bytes = Vec::new();
    // A longer file is truncated, so its hash differs.
    File::open(path).ok()?.take(longest + 1).read_to_end(&mut bytes).ok()?;
    let (content, hash) = bytes.split_last_chunk::<HASH>()?;
    if Sha256::digest(content)[..] != hash[..] {
        return None;
    }
    let (numbers, rest) = content.strip_prefix(head)?.as_chunks();
    let mut numbers = Numbers(numbers.iter());
    let parsed = parse(&mut numbers)?;
    (rest.is_empty() && numbers.0.len() == 0).then_some(parsed)
}

/// Pyramid of a file; `None` for any mistake.
fn read(path: &Path, key: &[u8; HASH], source: &PeakSource) -> Option<PeakPyramid> {
    let (head, with_horizon) = ([MAGIC, key].concat(), source.heights.is_some());
    read_sealed(path, &head, all_texels(source), with_horizon, |numbers| parse(numbers, source))
}

/// Number of texels of all levels.
fn all_texels(source: &PeakSource) -> u64 {
    source.normals.len() as u64 + source.upper_levels().map(texels).sum::<u64>()
}

/// Remaining numbers of a file.
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

    /// Counts of at most `most` fits.
    fn fits(&mut self, most: usize) -> Option<FitCounts> {
        Some(FitCounts {
            fitted: self.count(most)?,
            seven: self.count(most)?,
            missed: self.count(most)?,
            worst_rms: self.real(0.0..=f64::MAX)?,
            worst_maximum: self.real(0.0..=f64::MAX)?,
        })
    }

    /// A texel of at most `most` peaks.
    fn texel(&mut self, most: usize, with_horizon: bool) -> Option<Vec<Peak>> {
        let peaks = self.count(most)?;
        (0..peaks).map(|_| peak(self, with_horizon)).collect()
    }
}

/// A pyramid from its numbers, each within the range it has in a pyramid.
fn parse(numbers: &mut Numbers<'_>, source: &PeakSource) -> Option<PeakPyramid> {
    let fits = numbers.fits(all_texels(source) as usize)?;
    let mut levels = Vec::new();
    for (width, height) in level_sizes(source.width, source.height) {
        let most = if levels.is_empty() { 1 } else { MAX_PEAKS };
        let texel = |_| numbers.texel(most, source.heights.is_some());
        let texels: Option<Vec<_>> = (0..width * height).map(texel).collect();
        levels.push(PeakLevel::new(width, height, texels?.into_iter()));
    }
    Some(PeakPyramid { levels, fits })
}

fn peak(numbers: &mut Numbers<'_>, with_horizon: bool) -> Option<Peak> {
    let amplitude = numbers.real(0.0..=f64::MAX)?;
    let exponent = numbers.real(EXPONENTS)?;
    let mut coordinate = || numbers.real(-1.0..=1.0);
    let normal = DVec3::new(coordinate()?, coordinate()?, coordinate()?);
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
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::super::build::tests::{OPTIONS, hills};
    use super::super::source::FacetWeight;
    use super::*;

    /// The pyramid, true if it was read, and the number of fitted texels.
    fn cached(directory: &Path, source: &PeakSource, options: &BuildOptions) -> (PeakPyramid, bool, u64) {
        let (fitted, found) = (AtomicU64::new(0), AtomicU64::new(0));
        let cached = PeakPyramid::cached(directory, source, options, &|steps| {
            match steps {
                Steps::Fitted(done) => fitted.fetch_add(done, Ordering::Relaxed),
                Steps::Found(done) => found.fetch_add(done, Ordering::Relaxed),
            };
        });
        let cached = cached.expect("the source is good");
        let (fitted, found) = (fitted.into_inner(), found.into_inner());
        assert!(cached.not_kept.is_none());
        assert_eq!(fitted + found, source.steps());
        assert_eq!(found, if cached.read { source.steps() } else { cached.resumed });
        (cached.pyramid, cached.read, fitted)
    }

    /// Builds until `after` texels are fitted, then is interrupted.
    fn interrupted(directory: &Path, source: &PeakSource, after: u64) {
        let fitted = AtomicU64::new(0);
        let progress = |steps: Steps| {
            let Steps::Fitted(done) = steps else { return };
            assert!(fitted.fetch_add(done, Ordering::Relaxed) + done < after, "the interruption of this test");
        };
        let built = std::panic::catch_unwind(|| PeakPyramid::cached(directory, source, &OPTIONS, &progress));
        assert!(built.is_err(), "it was not interrupted");
    }

    /// Content of the only entry of a directory, a file.
    fn only_file(directory: &Path) -> Vec<u8> {
        let names: Vec<PathBuf> =
            fs::read_dir(directory).expect("a directory").map(|entry| entry.expect("an entry").path()).collect();
        let [name] = &names[..] else { panic!("{names:?}") };
        fs::read(name).expect("a file")
    }

    #[test]
    fn an_interrupted_build_goes_on_to_the_same_bytes() {
        // Levels of 272, 64, 16, 4 texels and one texel: the first has two parts. One in eight of its texels takes a
        // fit.
        let mut source = hills(68, 64);
        for (index, normal) in source.normals.iter_mut().enumerate() {
            if (index % 68 / 4 + index / 68 / 4) % 8 > 0 {
                *normal = DVec3::Z;
            }
        }
        let [whole, directory] = [(); 2].map(|()| tempfile::tempdir().expect("a directory"));
        cached(whole.path(), &source, &OPTIONS);
        let wanted = only_file(whole.path());
        // Interruptions in the first part, in the second, in the next level, and in the level after it.
        for (after, kept) in [(9, 0), (260, 256), (30, 272), (70, 336)] {
            interrupted(directory.path(), &source, after);
            let parts = path(directory.path(), &key(&source, &OPTIONS)).with_extension("parts");
            let found = fs::read_dir(&parts).map_or(0, Iterator::count);
            assert_eq!(found, [0, 256, 272, 336].iter().filter(|texels| **texels < kept).count(), "after {after}");
        }
        let (_, read, fitted) = cached(directory.path(), &source, &OPTIONS);
        assert!(!read && fitted == source.steps() - 336, "{fitted}");
        assert!(only_file(directory.path()) == wanted, "different bytes, or remaining parts");
    }

    #[test]
    fn damaged_parts_are_told_of_and_fitted_again() {
        let directory = tempfile::tempdir().expect("a directory");
        let source = hills(16, 16);
        let (wanted, ..) = cached(directory.path(), &source, &OPTIONS);
        let pyramid = path(directory.path(), &key(&source, &OPTIONS));
        fs::remove_file(&pyramid).expect("the file is there");
        // The level of 16 texels is kept.
        interrupted(directory.path(), &source, 17);
        let place = pyramid.with_extension("parts").join("2-0.part");
        let good = fs::read(&place).expect("a part is kept");
        let mut changed = good.clone();
        changed[good.len() / 2] ^= 1;
        let resealed = |content: &[u8]| [content, &Sha256::digest(content)[..]].concat();
        // A whole part, but of a different level.
        let mut moved = good[..good.len() - HASH].to_vec();
        moved[PART_MAGIC.len() + HASH] += 1;
        for bad in [&good[..good.len() / 2], &[], &changed, &[&good[..], &[0]].concat(), &resealed(&moved)] {
            fs::create_dir_all(place.parent().expect("a directory")).expect("the directory can be made");
            fs::write(&place, bad).expect("the file can be written");
            let cached = PeakPyramid::cached(directory.path(), &source, &OPTIONS, &|_| ()).expect("the source is good");
            assert_eq!((cached.damaged, cached.resumed), (vec![place.clone()], 0));
            assert_eq!(cached.pyramid, wanted);
            fs::remove_file(&pyramid).expect("the file is there");
        }
        fs::create_dir_all(place.parent().expect("a directory")).expect("the directory can be made");
        fs::write(&place, good).expect("the file can be written");
        let cached = PeakPyramid::cached(directory.path(), &source, &OPTIONS, &|_| ()).expect("the source is good");
        assert_eq!((cached.damaged, cached.resumed, cached.pyramid), (Vec::new(), 16, wanted));
    }

    #[test]
    fn a_pyramid_comes_back_with_the_same_bits() {
        let directory = tempfile::tempdir().expect("a directory");
        for source in [hills(4, 3), PeakSource { heights: None, ..hills(3, 5) }] {
            let (built, read, steps) = cached(directory.path(), &source, &OPTIONS);
            assert!(!read && steps == source.steps() && (built.fits.fitted > 0) == source.heights.is_none());
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
        source_with(&|source| source.edges = Edges::Open);
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
        // A whole file, but of a different map.
        let other = PeakSource { heights: None, ..hills(4, 4) };
        cached(directory.path(), &other, &OPTIONS);
        bad.push(fs::read(super::path(directory.path(), &key(&other, &OPTIONS))).expect("the file is there"));
        // Files with a valid hash and invalid content: one number too many, and an exponent out of range.
        let resealed = |content: &[u8]| [content, &Sha256::digest(content)[..]].concat();
        let content = &good[..good.len() - HASH];
        bad.push(resealed(&[content, &[0; 8]].concat()));
        let mut exponent = content.to_vec();
        let place = MAGIC.len() + HASH + 5 * 8 + 16;
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
            let cached = PeakPyramid::cached(place, &hills(2, 2), &OPTIONS, &|_| ()).expect("the source is good");
            assert!(!cached.read && cached.not_kept.is_some());
        }
    }
}
