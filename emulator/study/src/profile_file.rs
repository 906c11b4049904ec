//! Profile files: a precision under a name, as TOML; `emulator/profiles.md` describes the keys.
//!
//! Keys are the names of the knobs ([`Knob::name`]), so reading and writing are loops over [`Knob::ALL`]. Errors name file, line,
//! column, the knob and its range.

use std::fmt::Write as _;
use std::io::{self, Read as _, Write as _};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use roughxel_core::knob::Knob;
use roughxel_core::precision::{Precision, Profile};
use roughxel_scene::Fault;
use roughxel_utilities::input::{open_file, without_mark};
use roughxel_utilities::output::{OutputFile, WriteError};
use roughxel_utilities::suggestions::closest;
use thiserror::Error;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Largest profile file that is read, bytes.
pub const MAX_PROFILE_BYTES: u64 = 1 << 20;
/// Most characters of a profile's name.
pub const MAX_NAME: usize = 40;

/// Description of a valid name, for messages.
const NAMES: &str = "1 to 40 lower-case letters, digits and underscores";
/// The key of a direction from a table, whose value is the steps; `direction` itself is "exact".
const TABLE: &str = "direction.table";

/// A precision under a name that can be part of a file name. It is not the name of a profile with other knobs.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct NamedPrecision {
    /// Its name: 1 to [`MAX_NAME`] lower-case letters, digits and underscores.
    pub name: String,
    /// Its knobs.
    pub precision: Precision,
}

impl NamedPrecision {
    /// Names a precision.
    ///
    /// Errors: a name with other characters, too long, or of a profile whose knobs are others.
    pub fn new(name: &str, precision: Precision) -> Result<Self, NameError> {
        if !is_name(name) {
            return Err(NameError::Characters(name.into()));
        }
        match Profile::by_name(name) {
            Some(profile) if profile.precision() != precision => Err(NameError::Taken(profile)),
            _ => Ok(Self { name: name.into(), precision }),
        }
    }
}

impl From<Profile> for NamedPrecision {
    fn from(profile: Profile) -> Self {
        Self { name: profile.name().into(), precision: profile.precision() }
    }
}

/// Reason why a profile cannot have a name.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NameError {
    /// Characters that are not valid in every file name.
    #[error("`{0}` is not a profile name: use {NAMES}")]
    Characters(String),
    /// A named profile has other knobs.
    #[error("profile `{}` has other knobs", .0.name())]
    Taken(Profile),
}

/// Reason why a profile file cannot be used.
#[derive(Debug, Error)]
pub enum ProfileError {
    /// The file is missing or may not be read.
    #[error("cannot read the profile file {}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// Larger than any profile.
    #[error("{}: is larger than 1 MiB (is it a profile file?)", .0.display())]
    TooLarge(PathBuf),
    /// Bytes that are not text.
    #[error("{}: is not UTF-8 text (save the profile file as UTF-8)", .0.display())]
    NoText(PathBuf),
    /// Not TOML, an unknown key, a value of a wrong type or out of its range.
    #[error("{0}")]
    Fault(Box<Fault>),
}

/// Reads a profile file. Missing knobs come from its `base`, or without one from `standard`. Without a `name` it has the file's
/// name.
///
/// Errors: see [`ProfileError`]; at most [`MAX_PROFILE_BYTES`] are read.
pub fn read_profile(path: &Path) -> Result<NamedPrecision, ProfileError> {
    let unreadable = |source| ProfileError::Unreadable { path: path.into(), source };
    let file = open_file(path).map_err(unreadable)?;
    if file.metadata().map_err(unreadable)?.len() > MAX_PROFILE_BYTES {
        return Err(ProfileError::TooLarge(path.into()));
    }
    let mut content = Vec::new();
    file.take(MAX_PROFILE_BYTES).read_to_end(&mut content).map_err(unreadable)?;
    let text = String::from_utf8(content).map_err(|_| ProfileError::NoText(path.into()))?;
    parse_profile(&path.display().to_string(), &text).map_err(ProfileError::Fault)
}

/// Reads a profile from its text. `label`, the path of its file, is in errors; its stem names the profile if the text does not.
pub fn parse_profile(label: &str, text: &str) -> Result<NamedPrecision, Box<Fault>> {
    Source { label, text: without_mark(text).into() }.profile()
}

/// Writes a profile file with every knob; it appears whole or not at all. Comments, one a line, come first.
///
/// Errors: the file cannot be written.
pub fn write_profile(path: &Path, profile: &NamedPrecision, comments: &[String]) -> Result<(), WriteError> {
    let write = || {
        let mut file = OutputFile::create(path)?;
        file.write_all(profile_text(profile, comments).as_bytes())?;
        file.commit()
    };
    write().map_err(|source| WriteError { path: path.into(), source })
}

/// The text of a profile file, each knob with its range.
pub fn profile_text(profile: &NamedPrecision, comments: &[String]) -> String {
    let mut text = String::new();
    for line in comments.iter().flat_map(|comment| comment.lines()) {
        // TOML has no control characters in comments.
        text += format!("# {}", line.replace(char::is_control, " ")).trim_end();
        text.push('\n');
    }
    let mut line = |key: &str, value: String, comment: &str| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{:<30} # {comment}", format!("{key} = {value}"));
    };
    line("name", format!("{:?}", profile.name), "in names of files");
    for knob in Knob::ALL {
        let value = knob.value_in(&profile.precision);
        let setting = knob.text(value).to_string();
        let (key, is_number) = match knob {
            Knob::Direction if value > 0 => (TABLE, true),
            Knob::Direction => (knob.name(), false),
            _ => (knob.name(), knob.choices().is_empty()),
        };
        line(key, if is_number { setting } else { format!("{setting:?}") }, knob.range());
    }
    text
}

/// Returns true if a profile may have this name.
pub fn is_name(name: &str) -> bool {
    (1..=MAX_NAME).contains(&name.len()) && name.bytes().all(is_name_byte)
}

const fn is_name_byte(c: u8) -> bool {
    c.is_ascii_lowercase() || c.is_ascii_digit() || c == b'_'
}

/// The name of a profile from that of its file: characters that no name has become underscores.
pub fn name_of_file(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let good = |c: char| u8::try_from(c.to_ascii_lowercase()).ok().filter(|c| is_name_byte(*c)).map_or('_', char::from);
    stem.chars().map(good).take(MAX_NAME).collect()
}

/// A key with its value: `reciprocal = { steps = 1 }` has the path `reciprocal.steps`.
struct Entry<'a> {
    path: String,
    key: Range<usize>,
    value: &'a Spanned<DeValue<'a>>,
}

/// All entries of a table, including those of nested tables.
fn entries<'a>(prefix: &str, table: &'a DeTable<'a>, found: &mut Vec<Entry<'a>>) {
    for (key, value) in table {
        let path = format!("{prefix}{}", key.get_ref());
        match value.get_ref() {
            DeValue::Table(inner) => entries(&format!("{path}."), inner, found),
            _ => found.push(Entry { path, key: key.span(), value }),
        }
    }
}

/// Every valid key.
fn keys() -> impl Iterator<Item = &'static str> {
    ["name", "base", TABLE].into_iter().chain(Knob::ALL.map(Knob::name))
}

/// The text of a profile file with what its errors need.
struct Source<'a> {
    label: &'a str,
    text: Arc<str>,
}

impl Source<'_> {
    fn fault(&self, span: Range<usize>, message: String, help: String) -> Box<Fault> {
        Box::new(Fault::new(self.label, &self.text, span, message, help))
    }

    fn profile(&self) -> Result<NamedPrecision, Box<Fault>> {
        let root = DeTable::parse(&self.text).map_err(|error| {
            let help = "every key is described in emulator/profiles.md";
            self.fault(error.span().unwrap_or(0..0), error.message().replace('\n', "; "), help.into())
        })?;
        let mut found = Vec::new();
        entries("", root.get_ref(), &mut found);
        // The first fault of the text is reported, whatever the order of a table in memory.
        found.sort_by_key(|entry| entry.key.start);
        let at = |path: &str| found.iter().find(|entry| entry.path == path);

        let mut precision = at("base").map_or(Ok(Precision::STANDARD), |entry| self.base(entry))?;
        for entry in found.iter().filter(|entry| !["name", "base"].contains(&entry.path.as_str())) {
            precision = self.with(entry, precision)?;
        }
        let (name, span) = match at("name") {
            None => (name_of_file(Path::new(self.label)), 0..0),
            Some(entry) => (self.text_of(entry, NAMES)?.to_owned(), entry.value.span()),
        };
        NamedPrecision::new(&name, precision).map_err(|error| {
            let help = match error {
                NameError::Characters(_) => format!("choose {NAMES}"),
                NameError::Taken(_) => "give another name: name = \"…\"".into(),
            };
            self.fault(span, error.to_string(), help)
        })
    }

    /// The knobs of the named profile that the file starts from.
    fn base(&self, entry: &Entry<'_>) -> Result<Precision, Box<Fault>> {
        let known = Profile::NAMES.join(", ");
        let name = self.text_of(entry, &known)?;
        Profile::by_name(name).map(Profile::precision).ok_or_else(|| {
            let help = closest(name, Profile::NAMES).map_or_else(|| format!("choose {known}"), did_you_mean);
            self.fault(entry.value.span(), format!("no named profile `{name}`"), help)
        })
    }

    /// A precision with the knob of an entry.
    fn with(&self, entry: &Entry<'_>, precision: Precision) -> Result<Precision, Box<Fault>> {
        let Entry { path, value, .. } = entry;
        let is_table = path == TABLE;
        let known = Knob::ALL.into_iter().find(|knob| knob.name() == path);
        let knob = known.or(is_table.then_some(Knob::Direction)).ok_or_else(|| self.unknown(entry))?;
        let setting = match value.get_ref() {
            // A table of zero steps would be a second way to write "exact".
            DeValue::Integer(number) if is_table || (knob.choices().is_empty() && knob != Knob::Direction) => {
                let number = u32::from_str_radix(number.as_str(), number.radix()).ok();
                number.filter(|&number| number > 0 || !is_table)
            }
            DeValue::String(text) if knob == Knob::Direction && !is_table => (text == "exact").then_some(0),
            DeValue::String(text) if !knob.choices().is_empty() => {
                (0..).zip(knob.choices()).find(|(_, choice)| *choice == text).map(|(place, _)| place)
            }
            _ => return Err(self.wrong_type(entry, knob.range())),
        };
        setting.and_then(|setting| knob.with(setting, precision).checked().ok()).ok_or_else(|| {
            let message = format!("`{path}` is {}, which is out of range", self.written(value));
            self.fault(value.span(), message, format!("choose {}", knob.range()))
        })
    }

    fn unknown(&self, entry: &Entry<'_>) -> Box<Fault> {
        let path = &entry.path;
        let parts: Vec<_> =
            keys().filter(|key| key.strip_prefix(path.as_str()).is_some_and(|rest| rest.starts_with('.'))).collect();
        if !parts.is_empty() {
            return self.fault(entry.value.span(), format!("`{path}` has parts"), format!("give {}", parts.join(", ")));
        }
        let all = || format!("known are {}", keys().collect::<Vec<_>>().join(", "));
        let help = closest(path, keys()).map_or_else(all, did_you_mean);
        self.fault(entry.key.clone(), format!("unknown key `{path}`"), help)
    }

    fn wrong_type(&self, entry: &Entry<'_>, wanted: &str) -> Box<Fault> {
        let Entry { path, value, .. } = entry;
        let (written, kind) = (self.written(value), value.get_ref().type_str());
        self.fault(
            value.span(),
            format!("`{path}` is {written}, of the wrong type ({kind})"),
            format!("choose {wanted}"),
        )
    }

    /// The text of an entry, or the fault.
    fn text_of<'a>(&self, entry: &Entry<'a>, wanted: &str) -> Result<&'a str, Box<Fault>> {
        entry.value.get_ref().as_str().ok_or_else(|| self.wrong_type(entry, wanted))
    }

    /// The start of a value as it stands in the file.
    fn written(&self, value: &Spanned<DeValue<'_>>) -> String {
        let text = self.text.get(value.span()).unwrap_or_default();
        text.chars().take(MAX_NAME).map(|c| if c.is_control() { ' ' } else { c }).collect()
    }
}

/// A suggestion for a misspelt word.
fn did_you_mean(word: &str) -> String {
    format!("did you mean `{word}`?")
}
