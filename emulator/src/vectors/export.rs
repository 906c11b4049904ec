//! Export: inputs through their datapath into `NAME.hex` or `NAME.bin`, then `NAME.json`.

use std::fs;
use std::io::{self, Write};
use std::ops::Range;
use std::path::Path;

use rayon::prelude::*;
use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::precision::Precision;
use sha2::{Digest, Sha256};

use super::datapath::{Batch, Inputs};
use super::layout::Layout;
use super::manifest::{FORMAT_VERSION, FileEntry, Form, Manifest, ProfileKnobs, SCHEMA, Seed, StageEntry};
use super::word::{check_of, pack, write_record, write_word};
use super::{MAX_VECTORS, VectorError};
use crate::output::OutputFile;

/// How [`crate::random::SplitMix64::for_element`] finds the numbers of one vector.
const SEED_RULE: &str = "splitmix64(fnv1a64(name) xor index * 9e3779b97f4a7c15)";

/// Words of a task: the wires of all stages stay in a processor's cache.
const TASK: u64 = 1 << 9;
/// Words computed before they are written, while those before them are.
const BATCH: u64 = 1 << 14;

/// What is known of a set before its vectors are.
#[derive(Clone, Copy, Debug)]
pub struct SetInfo<'a> {
    /// Name: 1 to 64 lower-case letters, digits and underscores.
    pub name: &'a str,
    /// One sentence.
    pub description: &'a str,
    /// The text hashed with each index where the set is random; `None` for listed or captured fragments.
    pub seed: Option<&'a str>,
    /// The datapath.
    pub datapath: Datapath,
    /// Effects of it that are on.
    pub effects: Effects,
    /// Knobs.
    pub precision: Precision,
    /// Name of the profile: of a named one, of a profile file, or `custom`.
    pub profile: &'a str,
    /// What words hold, and how they are written.
    pub words: Words,
}

/// What the words of a set hold, and how they are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Words {
    /// With the outcomes of stages between the ports.
    pub taps: bool,
    /// As text or as bytes.
    pub form: Form,
}

impl Default for Words {
    /// Everything, as text.
    fn default() -> Self {
        Self { taps: true, form: Form::Hex }
    }
}

impl SetInfo<'_> {
    /// Name of the set's files without extension: set and profile, so that one directory holds several profiles.
    pub fn file_stem(&self) -> String {
        format!("{}_{}", self.name, self.profile)
    }
}

/// Exports a set into `directory`, which is made if it is not there. The inputs are those of the datapath that `info` names.
///
/// Errors: see [`VectorError`]; nothing half-written stays, and no manifest without its words.
pub fn export<I>(info: &SetInfo<'_>, inputs: &[I], directory: &Path) -> Result<Manifest, VectorError>
where
    I: Sync,
    for<'a> &'a I: Into<Inputs>,
{
    export_with(info, inputs.len() as u64, &|index| (&inputs[index as usize]).into(), directory, &|_| {})
}

/// Exports the vectors of `input(0) … input(count − 1)`, a batch in memory at a time; `progress` is told how many are done.
pub fn export_with(
    info: &SetInfo<'_>,
    count: u64,
    input: &(dyn Fn(u64) -> Inputs + Sync),
    directory: &Path,
    progress: &dyn Fn(u64),
) -> Result<Manifest, VectorError> {
    let layout = Layout::new(info.datapath, &info.effects.of(info.datapath), &info.precision, info.words.taps);
    write_set(info, &layout, None, count, &|vectors| written(&layout, info, vectors, input), directory, progress)
}

/// Writes a set of `count` words; `words_of` makes those of some vectors as they are written.
///
/// Errors: see [`VectorError`].
pub(super) fn write_set(
    info: &SetInfo<'_>,
    layout: &Layout,
    stage: Option<StageEntry>,
    count: u64,
    words_of: &(dyn Fn(Range<u64>) -> Result<Vec<u8>, VectorError> + Sync),
    directory: &Path,
    progress: &dyn Fn(u64),
) -> Result<Manifest, VectorError> {
    let good = |c: u8| c.is_ascii_lowercase() || c.is_ascii_digit() || c == b'_';
    for name in [info.name, info.profile] {
        if !(1..=64).contains(&name.len()) || !name.bytes().all(good) {
            return Err(VectorError::Name(name.into()));
        }
    }
    if !(1..=MAX_VECTORS).contains(&count) {
        return Err(VectorError::Size { set: info.name.into(), count });
    }
    let stem = info.file_stem();
    let file_name = format!("{stem}.{}", info.words.form.extension());
    let (words_path, json_path) = (directory.join(&file_name), directory.join(format!("{stem}.json")));
    let error = |path: &Path| {
        let path = path.to_path_buf();
        move |source: io::Error| VectorError::Io { action: "write", path, source }
    };
    fs::create_dir_all(directory).map_err(error(directory))?;

    let mut words = Hashed::new(OutputFile::create(&words_path).map_err(error(&words_path))?);
    if info.words.form == Form::Hex {
        let title = format!(
            "// roughxel vectors: set {}, profile {}, {count} words of {} bits, fields in {stem}.json\n",
            info.name,
            info.profile,
            layout.word_bits()
        );
        words.write(title.as_bytes()).map_err(error(&words_path))?;
    }
    let batch = |start: u64| -> Vec<Result<Vec<u8>, VectorError>> {
        let vectors = start..count.min(start + BATCH);
        let tasks: Vec<_> =
            vectors.clone().step_by(TASK as usize).map(|first| first..vectors.end.min(first + TASK)).collect();
        tasks.into_par_iter().map(words_of).collect()
    };
    let mut ready = batch(0);
    for start in (0..count).step_by(BATCH as usize) {
        let write = || -> Result<(), VectorError> {
            for task in ready {
                words.write(&task?).map_err(error(&words_path))?;
            }
            Ok(())
        };
        let (done, next) = rayon::join(write, || batch(start + BATCH));
        done?;
        ready = next;
        progress(count.min(start + BATCH));
    }

    let Hashed { file, hash, bytes } = words;
    let manifest = Manifest {
        schema: SCHEMA.into(),
        format_version: FORMAT_VERSION,
        generator: concat!("roughxel ", env!("CARGO_PKG_VERSION")).into(),
        set: info.name.into(),
        description: info.description.into(),
        profile: ProfileKnobs { name: info.profile.into(), knobs: info.precision },
        datapath: info.datapath,
        stage,
        effects: info.effects.of(info.datapath),
        seed: info.seed.map(|name| Seed { name: name.into(), rule: SEED_RULE.into() }),
        taps: info.words.taps,
        count,
        word_bits: layout.word_bits(),
        files: vec![FileEntry { name: file_name, bytes, sha256: hex_digest(hash) }],
        fields: layout.fields().to_vec(),
    };
    let mut json = OutputFile::create(&json_path).map_err(error(&json_path))?;
    serde_json::to_writer_pretty(&mut json, &manifest).map_err(|e| error(&json_path)(e.into()))?;
    json.write_all(b"\n").map_err(error(&json_path))?;
    // The manifest last: a set whose words are not in place has none, or one whose hash tells.
    file.commit().map_err(error(&words_path))?;
    json.commit().map_err(error(&json_path))?;
    Ok(manifest)
}

/// The words of some vectors as they are written.
fn written(
    layout: &Layout,
    info: &SetInfo<'_>,
    vectors: Range<u64>,
    input: &(dyn Fn(u64) -> Inputs + Sync),
) -> Result<Vec<u8>, VectorError> {
    let batch = Batch::of(info.datapath, vectors.clone().map(input), &info.effects, &info.precision);
    let (fields, rows) = (layout.fields(), layout.rows(&batch));
    let mut text = Vec::with_capacity((vectors.end - vectors.start) as usize * (layout.line_length() + 1));
    let (mut bits, mut packed) = (Vec::with_capacity(fields.len()), Vec::new());
    for (place, index) in vectors.enumerate() {
        bits.clear();
        for (field, &(row, drop)) in fields.iter().zip(&rows) {
            bits.push(field.bits(row[place].into(), drop).ok_or_else(|| VectorError::Inexact {
                set: info.name.into(),
                index,
                field: field.name.clone(),
            })?);
        }
        append_word(&mut text, layout, &mut bits, &mut packed, info.words.form);
    }
    Ok(text)
}

/// Appends a word as it is written, from its fields' bits without the check value; `packed` is overwritten.
pub(super) fn append_word(text: &mut Vec<u8>, layout: &Layout, bits: &mut Vec<u32>, packed: &mut Vec<u32>, form: Form) {
    let (fields, digits) = (layout.fields(), layout.data_digits());
    pack(fields, bits, digits, packed);
    let check = check_of(packed, digits);
    match form {
        Form::Hex => {
            bits.push(check);
            write_word(text, fields, bits);
            text.push(b'\n');
        }
        Form::Bin => {
            packed.push(check);
            write_record(text, packed, digits);
        }
    }
}

/// A file and the hash of what went into it.
struct Hashed {
    file: OutputFile,
    hash: Sha256,
    bytes: u64,
}

impl Hashed {
    fn new(file: OutputFile) -> Self {
        Self { file, hash: Sha256::new(), bytes: 0 }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.hash.update(bytes);
        self.bytes += bytes.len() as u64;
        self.file.write_all(bytes)
    }
}

/// A hash in lower-case hex.
pub(crate) fn hex_digest(hash: Sha256) -> String {
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
