//! `NAME.json`: contents of a set, its origin, and the hash of its words.

use std::fs;
use std::io::Read;
use std::ops::Range;
use std::path::Path;

use roughxel_core::plan::{Datapath, Effects, FootprintKind, FrameSystem, HorizonKind};
use roughxel_core::precision::{AxisDirection, Newton, Precision, ProbeRule, ProbeWeights, RoughnessKind};
use roughxel_study::profile_file::{NameError, NamedPrecision};
use roughxel_utilities::input::open_file;
use serde::{Deserialize, Serialize};

use super::coverage_count::CoverageEntry;
use super::field::Field;
use super::layout::Layout;
use super::part::Part;
use super::{MAX_VECTORS, VectorError, stage};

/// Value of `schema`.
pub const SCHEMA: &str = "roughxel-vectors";
/// Value of `format_version`.
pub const FORMAT_VERSION: u32 = 3;
/// Largest manifest that is read.
const MAX_MANIFEST_BYTES: u64 = 1 << 20;

/// A set's manifest.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// [`SCHEMA`].
    pub schema: String,
    /// [`FORMAT_VERSION`].
    pub format_version: u32,
    /// Program and version that wrote it.
    pub generator: String,
    /// Name of the set.
    pub set: String,
    /// Contents of the set.
    pub description: String,
    /// Profile.
    pub profile: ProfileKnobs,
    /// The datapath.
    #[serde(with = "DatapathDef")]
    pub datapath: Datapath,
    /// The stage whose ports are the fields; `None` for a set of the whole datapath.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stage: Option<StageEntry>,
    /// Effects that are on; those of other datapaths are off.
    #[serde(with = "EffectsDef")]
    pub effects: Effects,
    /// Source of random fragments.
    pub seed: Option<Seed>,
    /// True if words also have the outcomes of stages between the ports.
    #[serde(default = "has_taps", skip_serializing_if = "Clone::clone")]
    pub taps: bool,
    /// Vectors.
    pub count: u64,
    /// The part of a set; `None` for a whole one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<Part>,
    /// Bits of a word.
    pub word_bits: u32,
    /// Coverage of the set; `None` if it was not graded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grade: Option<CoverageEntry>,
    /// The files of the set; there is one, the words.
    pub files: Vec<FileEntry>,
    /// The fields of a word, most significant first.
    pub fields: Vec<Field>,
}

/// Default of the key `taps`: manifests with taps omit it.
const fn has_taps() -> bool {
    true
}

/// Returns true if a file name has the extension of a form.
fn has_extension(name: &str, form: Form) -> bool {
    Path::new(name).extension().is_some_and(|extension| extension == form.extension())
}

/// A profile with every knob.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProfileKnobs {
    /// Name of a named profile with these knobs, of a profile file, or `custom`.
    pub name: String,
    /// Its knobs.
    #[serde(with = "PrecisionDef")]
    pub knobs: Precision,
}

/// A stage with a set of its own.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StageEntry {
    /// The Verilog module whose ports the fields are.
    pub module: String,
    /// Its runs, a vector each, one base vector after the other.
    pub runs: Vec<String>,
}

/// Rule that reproduces a seeded set's fragments.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Seed {
    /// The text that is hashed with the index of the vector.
    pub name: String,
    /// The hash.
    pub rule: String,
}

/// File format of words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A line of hex digits each, for `$readmemh`.
    Hex,
    /// A record of bytes each, big endian.
    Bin,
}

impl Form {
    /// Extension of the file.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Hex => "hex",
            Self::Bin => "bin",
        }
    }
}

/// A file of the set.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileEntry {
    /// Its name, in the manifest's directory.
    pub name: String,
    /// Its size.
    pub bytes: u64,
    /// Its SHA-256 in hex.
    pub sha256: String,
}

impl Manifest {
    /// Reads a manifest and checks everything that does not need the words: schema, version, profile, layout, count.
    ///
    /// Errors: unreadable, larger than 1 MiB, not JSON of this schema (with line and column), or made by a version whose profiles
    /// or fields differ.
    pub fn read(path: &Path) -> Result<Self, VectorError> {
        let error = |source| VectorError::Io { action: "read", path: path.into(), source };
        let problem = |problem: String| VectorError::Manifest { path: path.into(), problem };
        if fs::metadata(path).map_err(error)?.len() > MAX_MANIFEST_BYTES {
            return Err(problem("larger than 1 MiB, which no manifest is".into()));
        }
        let mut text = Vec::new();
        let file = open_file(path).map_err(error)?;
        file.take(MAX_MANIFEST_BYTES).read_to_end(&mut text).map_err(error)?;

        // Schema and version come first: another version may have other keys.
        let version: Version =
            serde_json::from_slice(&text).map_err(|e| problem(format!("no vector manifest: {e}")))?;
        if version.schema != SCHEMA {
            return Err(problem(format!("schema `{}` is unknown; this program reads `{SCHEMA}`", version.schema)));
        }
        if version.format_version != FORMAT_VERSION {
            let found = version.format_version;
            return Err(problem(format!("format version {found} is unknown; this program reads {FORMAT_VERSION}")));
        }
        let manifest: Self = serde_json::from_slice(&text).map_err(|e| problem(format!("broken manifest: {e}")))?;
        manifest.check().map_err(problem)?;
        Ok(manifest)
    }

    fn check(&self) -> Result<(), String> {
        let ProfileKnobs { name, knobs } = &self.profile;
        knobs
            .checked()
            .map_err(|knob| format!("profile `{name}`: knob {knob} is out of its range, {}", knob.range()))?;
        NamedPrecision::new(name, *knobs).map_err(|error| match error {
            NameError::Taken(_) => format!("{error} in this version; export the set again"),
            NameError::Characters(_) => error.to_string(),
        })?;
        if !(1..=MAX_VECTORS).contains(&self.count) {
            return Err(format!("count {} is not in 1 to {MAX_VECTORS}", self.count));
        }
        if let Some(part) = self.part {
            part.check(self.count)?;
        }
        let [file] = &self.files[..] else {
            return Err(format!("{} files listed, format {FORMAT_VERSION} has one", self.files.len()));
        };
        if file.name.is_empty() || file.name.starts_with('.') || file.name.contains(['/', '\\']) {
            return Err(format!("file name `{}` is not a plain name in the manifest's directory", file.name));
        }
        if ![Form::Hex, Form::Bin].into_iter().any(|form| has_extension(&file.name, form)) {
            return Err(format!("file `{}` is neither .hex nor .bin", file.name));
        }
        if self.effects != self.effects.restricted_to(self.datapath) {
            return Err(format!("effects that the datapath `{}` does not have are on", self.datapath.name()));
        }
        self.check_fields(&self.own_layout()?)
    }

    /// Name of its files without extension: set and profile, so that one directory holds several profiles, and the part.
    pub fn stem(&self) -> String {
        format!("{}{}", self.whole_stem(), self.part.map_or_else(String::new, |part| part.suffix()))
    }

    /// Stem of the whole set.
    pub(super) fn whole_stem(&self) -> String {
        format!("{}_{}", self.set, self.profile.name)
    }

    /// Name of the file of its words.
    pub(super) fn words_name(&self, form: Form) -> String {
        format!("{}.{}", self.stem(), form.extension())
    }

    /// Vectors of the whole set.
    pub(super) fn whole_count(&self) -> u64 {
        self.part.map_or(self.count, |part| part.whole_count)
    }

    /// The vectors, by their indices in the whole set.
    pub fn indices(&self) -> Range<u64> {
        self.part.map_or(0..self.count, |part| part.indices())
    }

    /// File format of its words.
    pub(super) fn form(&self) -> Form {
        // A manifest that was read names a file with one of the two extensions.
        if has_extension(&self.files[0].name, Form::Bin) { Form::Bin } else { Form::Hex }
    }

    /// The layout of its words.
    ///
    /// Errors: a stage that this version does not have; a manifest that was read names none.
    pub(super) fn layout(&self, path: &Path) -> Result<Layout, VectorError> {
        self.own_layout().map_err(|problem| VectorError::Manifest { path: path.into(), problem })
    }

    fn own_layout(&self) -> Result<Layout, String> {
        match &self.stage {
            None => Ok(Layout::new(self.datapath, &self.effects, &self.profile.knobs, self.taps)),
            Some(_) if !self.taps => Err("`taps` is false, but the set of a stage has none".into()),
            Some(StageEntry { module, runs }) => {
                stage::layout(self.datapath, &self.effects, &self.profile.knobs, module, runs)
            }
        }
    }

    fn check_fields(&self, layout: &Layout) -> Result<(), String> {
        // Texts may change without a new format; data on the position and meaning of bits may not.
        let essence = |f: &Field| {
            (f.direction, f.stage.clone(), f.port.clone(), [f.lsb, f.width], f.signed, f.fraction_bits, f.tolerance)
        };
        // Names are compared before places: an extra field moves all fields before it.
        for (index, ours) in layout.fields().iter().enumerate() {
            let Some(theirs) = self.fields.get(index) else {
                return Err(format!("field `{}` is missing", ours.name));
            };
            if theirs.name != ours.name {
                return Err(format!(
                    "field {index} is `{}`, but format {FORMAT_VERSION} has `{}` there for these effects",
                    theirs.name, ours.name
                ));
            }
        }
        if let Some(extra) = self.fields.get(layout.fields().len()) {
            return Err(format!("field `{}` is unknown in format {FORMAT_VERSION}", extra.name));
        }
        let mut pairs = self.fields.iter().zip(layout.fields());
        if let Some((_, ours)) = pairs.find(|(theirs, ours)| essence(theirs) != essence(ours)) {
            return Err(format!("field `{}` has a different layout than in format {FORMAT_VERSION}", ours.name));
        }
        if self.word_bits != layout.word_bits() {
            return Err(format!("word_bits is {}, but the fields take {}", self.word_bits, layout.word_bits()));
        }
        Ok(())
    }
}

/// The keys of every version.
#[derive(Deserialize)]
struct Version {
    schema: String,
    format_version: u32,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "Datapath", rename_all = "snake_case")]
enum DatapathDef {
    Reflection,
    Highlight,
    Peak,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "Effects", deny_unknown_fields)]
struct EffectsDef {
    bump: bool,
    #[serde(with = "FrameSystemDef")]
    frame: FrameSystem,
    #[serde(with = "RoughnessKindDef")]
    roughness: RoughnessKind,
    curvature: bool,
    #[serde(with = "FootprintKindDef")]
    footprint: FootprintKind,
    #[serde(with = "HorizonKindDef")]
    horizon: HorizonKind,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "FootprintKind", rename_all = "snake_case")]
enum FootprintKindDef {
    None,
    Face,
    Sphere,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "HorizonKind", rename_all = "snake_case")]
enum HorizonKindDef {
    None,
    Correlated,
    Product,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "FrameSystem", rename_all = "snake_case")]
enum FrameSystemDef {
    MainDirection,
    Natural,
    NaturalNormalised,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "Precision", deny_unknown_fields)]
struct PrecisionDef {
    fraction_bits: u32,
    #[serde(with = "NewtonDef")]
    reciprocal: Newton,
    #[serde(with = "NewtonDef")]
    inverse_root: Newton,
    #[serde(with = "AxisDirectionDef")]
    direction: AxisDirection,
    max_probes: u32,
    #[serde(with = "ProbeRuleDef")]
    probe_rule: ProbeRule,
    #[serde(with = "ProbeWeightsDef")]
    probe_weights: ProbeWeights,
    lod_bits: u32,
    weight_bits: u32,
    #[serde(with = "RoughnessKindDef")]
    roughness: RoughnessKind,
    roughness_bits: u32,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "Newton", deny_unknown_fields)]
struct NewtonDef {
    seed_bits: u32,
    steps: u32,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "AxisDirection", rename_all = "snake_case")]
enum AxisDirectionDef {
    Exact,
    Table { steps: u32 },
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "ProbeRule", rename_all = "snake_case")]
enum ProbeRuleDef {
    PowerOfTwo,
    Ceiling,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "ProbeWeights", rename_all = "snake_case")]
enum ProbeWeightsDef {
    Box,
    Gaussian,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "RoughnessKind", rename_all = "snake_case")]
enum RoughnessKindDef {
    None,
    Isotropic,
    Anisotropic,
}
