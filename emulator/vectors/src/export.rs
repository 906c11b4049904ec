//! Export: inputs through their datapath into `NAME.hex` or `NAME.bin`, then `NAME.json`.

mod stage;

use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;
use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::precision::Precision;

use super::datapath::{Computed, InputSource, Inputs};
use super::field::Field;
use super::files::{SetFiles, size_and_hash};
use super::layout::Layout;
use super::manifest::{FORMAT_VERSION, Form, Manifest, ProfileKnobs, SCHEMA, Seed};
use super::part::{Part, Shard};
use super::sets::SEED_RULE;
use super::stage::StageSet;
use super::word::{CHUNK, Encoder, length};
use super::{MAX_VECTORS, VectorError};

/// Words of a task: the wires of all stages fit a processor's cache.
const TASK: u64 = 1 << 9;
/// Bytes hashed and written at once. They stay in a processor's cache between the two, and a system writes large blocks faster
/// (measured: 2.4 GB/s with 2^16, 4 GB/s with 2^18).
const WRITE: usize = 1 << 18;

/// Properties of a set that do not depend on its vectors.
#[derive(Clone, Copy, Debug)]
pub struct SetInfo<'a> {
    /// Name: 1 to 64 lower-case letters, digits and underscores.
    pub name: &'a str,
    /// One sentence.
    pub description: &'a str,
    /// The text hashed with each index if the set is random; `None` for listed or captured fragments.
    pub seed: Option<&'a str>,
    /// The datapath.
    pub datapath: Datapath,
    /// Effects of it that are on.
    pub effects: Effects,
    /// Knobs.
    pub precision: Precision,
    /// Name of the profile: of a named one, of a profile file, or `custom`.
    pub profile: &'a str,
    /// Contents of words, and their file format.
    pub words: Words,
}

impl<'a> SetInfo<'a> {
    /// Describes a set in text, with taps and without a seed, by its name.
    pub fn new(name: &'a str, datapath: Datapath, effects: Effects, profile: &'a str, precision: Precision) -> Self {
        let words = Words::default();
        Self { name, description: name, seed: None, datapath, effects, precision, profile, words }
    }
}

impl<'a> From<&'a Manifest> for SetInfo<'a> {
    /// A set in text of the same kind as an existing one.
    fn from(Manifest { set, datapath, effects, profile, taps, .. }: &'a Manifest) -> Self {
        let words = Words { taps: *taps, form: Form::Hex };
        Self { words, ..Self::new(set, *datapath, *effects, &profile.name, profile.knobs) }
    }
}

/// Contents of the words of a set, and their file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Words {
    /// True if words have the outcomes of stages between the ports.
    pub taps: bool,
    /// Format: text or bytes.
    pub form: Form,
}

impl Default for Words {
    /// All fields, as text.
    fn default() -> Self {
        Self { taps: true, form: Form::Hex }
    }
}

/// Exports a set into `directory`, which is made if it does not exist. The inputs are those of the datapath that `info` names.
///
/// Errors: see [`VectorError`]; no incomplete file stays, and no manifest without its words.
pub fn export<I>(info: &SetInfo<'_>, inputs: &[I], directory: &Path) -> Result<Manifest, VectorError>
where
    I: Sync,
    for<'a> &'a I: Into<Inputs>,
{
    export_with(info, inputs.len() as u64, &|index: u64| (&inputs[index as usize]).into(), directory, &|_| {})
}

/// Exports the vectors 0 to count − 1 of `input`, a batch in memory at a time; `progress` gets the number of finished vectors.
pub fn export_with(
    info: &SetInfo<'_>,
    count: u64,
    input: &dyn InputSource,
    directory: &Path,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Manifest, VectorError> {
    SetExport::new(info, count).write(input, directory, progress)
}

/// A set to export, of a datapath or of one of its stages, or a part of it.
#[derive(Clone, Debug)]
pub struct SetExport<'a> {
    info: &'a SetInfo<'a>,
    name: Cow<'a, str>,
    description: Cow<'a, str>,
    /// Vectors of the whole set.
    count: u64,
    part: Option<Part>,
    layout: Layout,
    /// The stage, for a set of a stage.
    stage: Option<&'a StageSet>,
}

impl<'a> SetExport<'a> {
    /// A whole set of `count` vectors.
    pub fn new(info: &'a SetInfo<'a>, count: u64) -> Self {
        let &SetInfo { name, description, datapath, effects, precision, words, .. } = info;
        let layout = Layout::new(datapath, &effects.restricted_to(datapath), &precision, words.taps);
        let (name, description) = (name.into(), description.into());
        Self { info, name, description, count, part: None, layout, stage: None }
    }

    /// The set of a stage that belongs to the base set of `info`, which has `count` vectors: vector i is run i mod R of base
    /// vector ⌊i / R⌋, for the R runs of the module.
    ///
    /// The name is `BASE_MODULE`; datapath, effects and profile are those of the base set, and there are no taps.
    pub fn of_stage(info: &'a SetInfo<'a>, count: u64, stage: &'a StageSet) -> Self {
        let name = format!("{}_{}", info.name, stage.name()).into();
        let count = count.saturating_mul(stage.runs().len() as u64);
        let (description, layout) = (stage.description(info).into(), stage.layout.clone());
        Self { info, name, description, count, part: None, layout, stage: Some(stage) }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Vectors of the whole set.
    pub fn whole_count(&self) -> u64 {
        self.count
    }

    /// The part of a shard; `None` if the set has fewer vectors than there are shards, and this shard gets none.
    pub fn of_shard(self, shard: Shard) -> Option<Self> {
        Part::from_shard(self.count, shard).map(|part| Self { part: Some(part), ..self })
    }

    /// The vectors, by their indices in the whole set.
    pub fn indices(&self) -> Range<u64> {
        self.part.map_or(0..self.count, |part| part.indices())
    }

    /// The set as it would be written, if it is in `directory` already: a manifest of this version of the program for the same
    /// set, seed, knobs, effects, fields and part, and words of the size and the SHA-256 in the manifest.
    pub fn present(&self, directory: &Path) -> Option<Manifest> {
        self.check().ok()?;
        let wanted = self.manifest();
        let found = Manifest::read(&directory.join(wanted.stem() + ".json")).ok()?;
        let [entry] = &found.files[..] else { return None };
        let is_same = entry.name == wanted.words_name(self.info.words.form)
            && Manifest { files: found.files.clone(), grade: found.grade, ..wanted } == found;
        let of_words = || size_and_hash(&directory.join(&entry.name)).ok();
        (is_same && of_words()? == (entry.bytes, entry.sha256.clone())).then_some(found)
    }

    /// Exports the set: vector i is `input.input(i)`, where i is an index of the whole set, or of the base set for a stage. A
    /// batch is in memory at a time; `progress` gets the number of finished vectors.
    ///
    /// Errors: see [`VectorError`]; no incomplete file stays, and no manifest without its words.
    pub fn write(
        &self,
        input: &dyn InputSource,
        directory: &Path,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Manifest, VectorError> {
        self.check()?;
        let manifest = self.manifest();
        let form = self.info.words.form;
        let mut files = SetFiles::create(&manifest, form, length(&self.layout, form), directory)?;
        // This runs inside the thread pool: from outside, each batch would wait for a thread to wake.
        rayon::scope(|_| self.write_words(input, &mut files, progress))?;
        files.commit(manifest)
    }

    /// Writes the words.
    fn write_words(
        &self,
        input: &dyn InputSource,
        files: &mut SetFiles,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<(), VectorError> {
        let (all, length) = (self.indices(), length(&self.layout, self.info.words.form));
        let rooms = Mutex::new(Vec::new());
        let make = |(first, text): (u64, &mut [u8])| {
            let vectors = first..first + (text.len() / length) as u64;
            let new = || (Computed::new(self.info.datapath), Encoder::new(&self.layout, self.info.words.form));
            let free = rooms.lock().unwrap_or_else(PoisonError::into_inner).pop();
            let mut room = free.unwrap_or_else(new);
            let (batch, words) = &mut room;
            let made = match self.stage {
                Some(stage) => stage.write(self, vectors, input, words, text),
                None => self.write_vectors(vectors, input, (batch, words), text),
            };
            rooms.lock().unwrap_or_else(PoisonError::into_inner).push(room);
            made
        };
        // Vectors computed while the previous ones are written. A few threads keep them in a cache; many threads have enough work
        // until the slowest is ready.
        let of_batch = TASK * (4 * rayon::current_num_threads() as u64).clamp(8, 32);
        // The buffer of written words is reused.
        let batch = |start: u64, mut text: Vec<u8>| -> Result<Vec<u8>, VectorError> {
            text.resize(all.end.min(start + of_batch).saturating_sub(start) as usize * length, 0);
            let tasks = text.par_chunks_mut(TASK as usize * length).enumerate();
            let made: Vec<_> = tasks.map(|(task, text)| make((start + task as u64 * TASK, text))).collect();
            made.into_iter().collect::<Result<(), _>>()?;
            Ok(text)
        };
        let (mut ready, mut spare) = (batch(all.start, Vec::new())?, Vec::new());
        for start in all.clone().step_by(of_batch as usize) {
            let write = || ready.chunks(WRITE).try_for_each(|text| files.write(text));
            let (written, next) = rayon::join(write, || batch(start + of_batch, spare));
            written?;
            (ready, spare) = (next?, ready);
            progress(all.end.min(start + of_batch) - all.start);
        }
        Ok(())
    }

    /// Errors: names that make bad file names, too few or too many vectors.
    fn check(&self) -> Result<(), VectorError> {
        let good = |c: u8| c.is_ascii_lowercase() || c.is_ascii_digit() || c == b'_';
        for name in [self.name(), self.info.profile] {
            if !(1..=64).contains(&name.len()) || !name.bytes().all(good) {
                return Err(VectorError::Name(name.into()));
            }
        }
        if !(1..=MAX_VECTORS).contains(&self.count) {
            return Err(VectorError::Size { set: self.name().into(), count: self.count });
        }
        Ok(())
    }

    /// The manifest, the words' entry left out.
    fn manifest(&self) -> Manifest {
        let info = self.info;
        let indices = self.indices();
        Manifest {
            schema: SCHEMA.into(),
            format_version: FORMAT_VERSION,
            generator: concat!("roughxel ", env!("CARGO_PKG_VERSION")).into(),
            set: self.name().into(),
            description: self.description.to_string(),
            profile: ProfileKnobs { name: info.profile.into(), knobs: info.precision },
            datapath: info.datapath,
            stage: self.stage.map(StageSet::entry),
            effects: info.effects.restricted_to(info.datapath),
            seed: info.seed.map(|name| Seed { name: name.into(), rule: SEED_RULE.into() }),
            taps: info.words.taps,
            count: indices.end - indices.start,
            part: self.part,
            word_bits: self.layout.word_bits(),
            grade: None,
            files: Vec::new(),
            fields: self.layout.fields().to_vec(),
        }
    }

    /// Writes the words of some vectors over `text`, which has their length; `batch` and `words` are buffers.
    fn write_vectors(
        &self,
        vectors: Range<u64>,
        input: &dyn InputSource,
        (batch, words): (&mut Computed, &mut Encoder),
        mut text: &mut [u8],
    ) -> Result<(), VectorError> {
        let (info, count) = (self.info, (vectors.end - vectors.start) as usize);
        batch.fill(input, vectors.clone(), &info.effects, &info.precision);
        let rows = self.layout.rows(batch);
        for first in (0..count).step_by(CHUNK) {
            if let Some((field, place)) = words.set(&rows, first, CHUNK.min(count - first)) {
                let index = vectors.start + (first + place) as u64;
                return Err(self.inexact(index, &self.layout.fields()[field]));
            }
            text = words.write(text);
        }
        Ok(())
    }

    /// The error for a vector's integer that does not fit the field.
    fn inexact(&self, index: u64, field: &Field) -> VectorError {
        VectorError::Inexact { set: self.name().into(), index, field: field.name.clone() }
    }
}
