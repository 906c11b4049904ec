//! Export: inputs through their datapath into `NAME.hex`, then `NAME.json`.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use rayon::prelude::*;
use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::precision::Precision;
use sha2::{Digest, Sha256};

use super::datapath::{Inputs, outcome};
use super::layout::Layout;
use super::manifest::{FORMAT_VERSION, FileEntry, Manifest, ProfileKnobs, SCHEMA, Seed};
use super::word::{check_value, write_word};
use super::{MAX_VECTORS, VectorError};
use crate::output::OutputFile;

/// How [`crate::random::SplitMix64::for_element`] finds the numbers of one vector.
const SEED_RULE: &str = "splitmix64(fnv1a64(name) xor index * 9e3779b97f4a7c15)";

/// Words computed at once.
const BATCH: u64 = 1 << 13;

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
    let (hex_path, json_path) = (directory.join(format!("{stem}.hex")), directory.join(format!("{stem}.json")));
    let error = |path: &Path| {
        let path = path.to_path_buf();
        move |source: io::Error| VectorError::Io { action: "write", path, source }
    };
    fs::create_dir_all(directory).map_err(error(directory))?;

    let effects = info.effects.of(info.datapath);
    let layout = Layout::new(info.datapath, &effects, &info.precision);
    let mut hex = Hashed::new(OutputFile::create(&hex_path).map_err(error(&hex_path))?);
    let title = format!(
        "// roughxel vectors: set {}, profile {}, {count} words of {} bits, fields in {stem}.json\n",
        info.name,
        info.profile,
        layout.word_bits()
    );
    hex.write(title.as_bytes()).map_err(error(&hex_path))?;
    for start in (0..count).step_by(BATCH as usize) {
        let lines: Vec<_> = (start..count.min(start + BATCH))
            .into_par_iter()
            .map(|index| {
                vector_line(&layout, info, &input(index)).map_err(|field| VectorError::Inexact {
                    set: info.name.into(),
                    index,
                    field: layout.fields()[field].name.clone(),
                })
            })
            .collect();
        for line in lines {
            hex.write(&line?).map_err(error(&hex_path))?;
        }
        progress(count.min(start + BATCH));
    }

    let file_name = format!("{stem}.hex");
    let Hashed { file, hash, bytes } = hex;
    let manifest = Manifest {
        schema: SCHEMA.into(),
        format_version: FORMAT_VERSION,
        generator: concat!("roughxel ", env!("CARGO_PKG_VERSION")).into(),
        set: info.name.into(),
        description: info.description.into(),
        profile: ProfileKnobs { name: info.profile.into(), knobs: info.precision },
        datapath: info.datapath,
        effects,
        seed: info.seed.map(|name| Seed { name: name.into(), rule: SEED_RULE.into() }),
        count,
        word_bits: layout.word_bits(),
        files: vec![FileEntry { name: file_name, bytes, sha256: hex_digest(hash) }],
        fields: layout.fields().to_vec(),
    };
    let mut json = OutputFile::create(&json_path).map_err(error(&json_path))?;
    serde_json::to_writer_pretty(&mut json, &manifest).map_err(|e| error(&json_path)(e.into()))?;
    json.write_all(b"\n").map_err(error(&json_path))?;
    // The manifest last: a set whose words are not in place has none, or one whose hash tells.
    file.commit().map_err(error(&hex_path))?;
    json.commit().map_err(error(&json_path))?;
    Ok(manifest)
}

/// The line of one vector, or the field that cannot hold its port.
fn vector_line(layout: &Layout, info: &SetInfo<'_>, Inputs(inputs): &Inputs) -> Result<Vec<u8>, usize> {
    let outputs = outcome(info.datapath, inputs, &info.effects, &info.precision);
    let mut bits = layout.encode(inputs, &outputs)?;
    bits.push(check_value(layout.fields(), &bits));
    let mut line = Vec::with_capacity(layout.line_length() + 1);
    write_word(&mut line, layout.fields(), &bits);
    line.push(b'\n');
    Ok(line)
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
