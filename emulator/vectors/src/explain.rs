//! Explain: every field of one vector, stage by stage, next to the float64 reference, and the first wrong field of a device's
//! word.
//!
//! The values are those that this version computes from the inputs in the file. The reference's values for the same inputs are in
//! [`float64`] alone: a datapath that it does not know has explanations without them.

mod float64;
mod real;

use std::path::Path;

use roughxel_core::plan::Datapath;
use roughxel_core::ports::{HighlightIn, HighlightInput, PeakIn, PeakInput, Port, ReflectionIn, ReflectionInput};
use roughxel_core::status::StatusBit;
use roughxel_utilities::suggestions::did_you_mean;
use serde::Serialize;
use thiserror::Error;

pub use self::float64::Decision;
use self::float64::{Float64, Taken};
pub use self::real::Real;
use super::VectorError;
use super::datapath::wires;
use super::field::{Direction, Field};
use super::layout::Layout;
use super::lines::Lines;
use super::manifest::Manifest;
use super::order::{Misplaced, misplaced, with_cause};
use super::verify::{Checker, Mismatch};
use super::word::{check_value, read_device_word};

/// One vector of a set.
#[derive(Clone, Debug)]
pub struct Vector {
    manifest: Manifest,
    layout: Layout,
    index: u64,
    line: u64,
    /// The fields' bits in the file.
    found: Vec<u32>,
    /// The bits that follow from the inputs in the file.
    expected: Vec<u32>,
    /// Difference of the word in the file.
    mismatch: Option<Mismatch>,
    hash_matches: bool,
    misplaced: Vec<Misplaced>,
}

/// A device's word: the bits of each field that it gave, in the word's order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceWord(Vec<Option<u32>>);

/// A device's word that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct DeviceWordError(String);

/// Every field of a vector.
#[derive(Clone, Debug, Serialize)]
pub struct Explanation {
    /// The set.
    pub set: String,
    /// Its profile.
    pub profile: String,
    /// Its datapath.
    pub datapath: &'static str,
    /// Index of the vector in the whole set, from 0.
    pub index: u64,
    /// Line of the hex file, from 1.
    pub line: u64,
    /// The fields in the order of the pipeline, inputs first; fields of one stage in the word's order.
    pub fields: Vec<Explained>,
    /// The module, if the set is of a stage.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stage: Option<String>,
    /// Names of the sticky bits that are set; none for the set of a stage.
    pub status: Vec<&'static str>,
    /// Decisions of the datapath and of the reference.
    pub decisions: Vec<Decision>,
    /// First difference of the compared word; `None` if it is right, or there is none.
    pub wrong: Option<Wrong>,
}

/// One field.
#[derive(Clone, Debug, Serialize)]
pub struct Explained {
    /// Stage that makes it; `input` for inputs, `check` for the check value.
    pub stage: String,
    /// Name.
    pub field: String,
    /// Direction of the field.
    pub direction: Direction,
    /// Place of its lowest bit in the word.
    pub lsb: u32,
    /// Bits.
    pub width: u32,
    /// Unit.
    pub unit: String,
    /// Its digits in the word.
    pub raw: String,
    /// Its integer, with its sign.
    pub integer: i64,
    /// Its value in its unit: exponents of blocks undone, codes decoded.
    pub real: Real,
    /// The reference's value, if it has one.
    pub float64: Option<Real>,
    /// Value less reference, in last places of the field; `None` for a block of zeros if the reference is not zero.
    pub error: Option<f64>,
    /// Field of the compared word, if there is one with this field.
    pub got: Option<Got>,
}

/// A field of the word that was compared.
#[derive(Clone, Debug, Serialize)]
pub struct Got {
    /// Its digits in the word.
    pub raw: String,
    /// Its integer, with its sign; bits above the width are dropped.
    pub integer: i64,
    /// The highest bit that differs; `None` if the field is right.
    pub wrong_bit: Option<u32>,
}

/// The first difference of a compared word.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Wrong {
    /// The earliest stage that differs.
    pub stage: String,
    /// Its first field that differs.
    pub field: String,
    /// The field's highest differing bit; from its width on, one of the bits that have to be zero.
    pub bit: u32,
    /// The field's bits in the compared word.
    pub found: u32,
    /// The right bits.
    pub expected: u32,
    /// Bits of the field.
    pub width: u32,
    /// Number of fields that differ.
    pub fields_differing: usize,
}

impl Vector {
    /// Reads vector `index` of the set of `manifest_path`. The whole file is read, so that its faults are reported as in
    /// [`verify`](super::verify()).
    ///
    /// Errors: see [`VectorError`]. A word that differs is no error, see [`Vector::mismatch`].
    pub fn read(manifest_path: &Path, index: u64) -> Result<Self, VectorError> {
        let manifest = Manifest::read(manifest_path)?;
        let (layout, indices) = (manifest.layout(manifest_path)?, manifest.indices());
        if !indices.contains(&index) {
            return Err(VectorError::Index { path: manifest_path.into(), index, indices });
        }
        let vector = Self::read_at(manifest_path, manifest.clone(), layout.clone(), index);
        vector.map_err(|error| with_cause(error, manifest_path, &manifest, &layout))
    }

    fn read_at(manifest_path: &Path, manifest: Manifest, layout: Layout, index: u64) -> Result<Self, VectorError> {
        let mut lines = Lines::open(manifest_path, &manifest)?;
        let checker = Checker { layout: &layout, manifest: &manifest };
        let mut wanted = None;
        while let Some(line) = lines.next()? {
            let bits = lines.bits(&line, &layout)?;
            if line.index == index {
                wanted = Some((line, bits));
            }
        }
        let (line, found) = wanted.ok_or_else(|| lines.wrong_count())?;
        let mismatch = checker.compare(&line).map_err(|problem| lines.problem(line.number, problem))?;
        let hash_matches = lines.hash_matches()?;
        let misplaced = if hash_matches { Vec::new() } else { misplaced(manifest_path, &manifest, &layout) };
        let (expected, _) = checker.expected(&found);
        Ok(Self { layout, index, line: line.number, found, expected, mismatch, hash_matches, misplaced, manifest })
    }

    /// The manifest of its set.
    pub(super) fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The layout of its words.
    pub(super) fn layout(&self) -> &Layout {
        &self.layout
    }

    /// The fields' bits in the file.
    pub(super) fn bits(&self) -> &[u32] {
        &self.found
    }

    /// Difference of the word in the file from the word of its inputs; `None` if it is right.
    pub fn mismatch(&self) -> Option<&Mismatch> {
        self.mismatch.as_ref()
    }

    /// Returns true if the file of the set is the one its manifest was written for, byte for byte.
    pub fn hash_matches(&self) -> bool {
        self.hash_matches
    }

    /// Words out of order in the file, if it is not the one of the manifest; at most ten.
    pub fn misplaced(&self) -> &[Misplaced] {
        &self.misplaced
    }

    /// A device's word: whole, in the set's format with its underscores or without, or `FIELD=HEX` for each field that the device
    /// has. Digits may be of either case.
    ///
    /// Errors: neither of the two forms, or a mixture; more or fewer digits than a word has, an unknown field, an input, a field
    /// twice, more bits than a field has.
    pub fn device_word(&self, parts: &[impl AsRef<str>]) -> Result<DeviceWord, DeviceWordError> {
        let parts: Vec<&str> = parts.iter().map(|part| part.as_ref().trim()).collect();
        let word = match parts[..] {
            [word] if !word.contains('=') => self.whole_word(word),
            _ => self.fields_given(&parts),
        };
        word.map(DeviceWord).map_err(DeviceWordError)
    }

    fn whole_word(&self, text: &str) -> Result<Vec<Option<u32>>, String> {
        let bits = read_device_word(text.as_bytes(), &self.layout);
        let single = if text.contains('_') { "" } else { "; for single fields write FIELD=HEX" };
        Ok(bits.map_err(|problem| format!("{problem}{single}"))?.into_iter().map(Some).collect())
    }

    fn fields_given(&self, parts: &[&str]) -> Result<Vec<Option<u32>>, String> {
        let fields = self.layout.fields();
        let mut bits = vec![None; fields.len()];
        for part in parts {
            let Some((name, digits)) = part.split_once('=') else {
                return Err(format!("`{part}` with other parts is not FIELD=HEX; a whole word is given once, alone"));
            };
            let outcomes = || fields.iter().filter(|field| matches!(field.direction, Direction::Tap | Direction::Out));
            let Some(place) = fields.iter().position(|field| field.name == name) else {
                let names = || outcomes().map(|field| field.name.as_str());
                let all: Vec<_> = names().collect();
                let hint = did_you_mean(name, names());
                return Err(format!("field `{name}` is unknown; {hint}this set has {}", all.join(", ")));
            };
            let field = &fields[place];
            match field.direction {
                Direction::Tap | Direction::Out => {}
                Direction::In => return Err(format!("field `{name}` is an input, which a device is given")),
                Direction::Check => return Err("the check value belongs to a whole word".into()),
            }
            let is_hex = !digits.is_empty() && digits.chars().all(|c| c.is_ascii_hexdigit());
            let value = u32::from_str_radix(digits, 16).ok().filter(|_| is_hex);
            let value = value.filter(|value| u64::from(*value) >> field.width == 0).ok_or_else(|| {
                format!("`{digits}` is not a hex number of the {} bits of field `{name}`", field.width)
            })?;
            if bits[place].replace(value).is_some() {
                return Err(format!("field `{name}` is given twice"));
            }
        }
        Ok(bits)
    }

    /// Every field, compared with a device's word. Without a device's word, a differing word of the file takes its place.
    pub fn explain(&self, device: Option<&DeviceWord>) -> Explanation {
        let fields = self.layout.fields();
        let of_file = || self.found.iter().copied().map(Some).collect();
        let got = match device {
            Some(DeviceWord(got)) => got.clone(),
            None if self.mismatch.is_some() => of_file(),
            None => vec![None; fields.len()],
        };
        let integers: Vec<i64> = fields.iter().zip(&self.expected).map(|(field, &bits)| field.integer(bits)).collect();
        let integer_of = |name: &str| fields.iter().position(|field| field.name == name).map(|place| integers[place]);
        // A single stage has no reference.
        let float64 = match self.layout.stage() {
            Some(_) => Float64::default(),
            None => self.float64(&Taken(&integer_of)),
        };

        let mut order: Vec<usize> = (0..fields.len()).collect();
        order.sort_by_key(|&place| self.layout.rank(place));
        let explained = order.iter().map(|&place| {
            let field = &fields[place];
            let exponent = exponent(fields, field, &integers);
            let unit = exponent - field.fraction_bits as i32;
            let float64_value = float64.value(&field.name);
            let error = float64_value.map(|real| integers[place] as f64 - real.in_units(unit));
            // A block of zeros has exponent 0 whatever its size would be, so it has no last place.
            let error = error.filter(|&error| error == 0.0 || !self.is_zero_block(field, &integers));
            Explained {
                stage: field.stage.clone(),
                field: field.name.clone(),
                direction: field.direction,
                lsb: field.lsb,
                width: field.width,
                unit: field.unit.clone(),
                raw: digits(field, self.expected[place]),
                integer: integers[place],
                real: float64.code(&field.name).unwrap_or(Real::new(integers[place] as f64, unit)),
                float64: float64_value,
                error,
                got: got[place].map(|bits| Got {
                    raw: digits(field, bits),
                    integer: field.integer(bits & super::field::mask(field.width)),
                    wrong_bit: self.difference(place, bits, &got).checked_ilog2(),
                }),
            }
        });
        let explained: Vec<Explained> = explained.collect();
        let status = integer_of("status").unwrap_or(0);
        let Manifest { set, profile, datapath, .. } = &self.manifest;
        Explanation {
            set: set.clone(),
            profile: profile.name.clone(),
            datapath: datapath.name(),
            index: self.index,
            line: self.line,
            fields: explained,
            stage: self.manifest.stage.as_ref().map(|stage| stage.module.clone()),
            status: StatusBit::raised_by(*datapath)
                .filter(|bit| status & i64::from(bit.mask()) != 0)
                .map(StatusBit::name)
                .collect(),
            decisions: float64.decisions,
            wrong: self.wrong(&order, &got),
        }
    }

    /// Values of the reference for the inputs.
    fn float64(&self, taken: &Taken<'_>) -> Float64 {
        let Manifest { datapath, effects, profile, .. } = &self.manifest;
        let (inputs, p) = (self.layout.decode(&self.expected), &profile.knobs);
        match datapath {
            Datapath::Reflection => {
                let fragment = ReflectionIn::from_wires(&wires::<ReflectionInput<i32>>(&inputs));
                float64::of_reflection(&fragment, effects, p, taken)
            }
            Datapath::Highlight => {
                let light = HighlightIn::from_wires(&wires::<HighlightInput<i32>>(&inputs));
                float64::of_highlight(&light, effects, p, taken)
            }
            Datapath::Peak => {
                let light = PeakIn::from_wires(&wires::<PeakInput<i32>>(&inputs));
                float64::of_peak(&light, effects, p, taken)
            }
        }
    }

    /// Returns true if a field is a mantissa of a block with an exponent whose mantissas are all zero.
    fn is_zero_block(&self, field: &Field, integers: &[i64]) -> bool {
        let mut of_block = self.layout.fields().iter().zip(integers).filter(|(other, _)| block(other) == block(field));
        exponent_field(self.layout.fields(), field).is_some() && of_block.all(|(_, &integer)| integer == 0)
    }

    /// The differing bits of a field of a compared word.
    fn difference(&self, place: usize, bits: u32, got: &[Option<u32>]) -> u32 {
        let fields = self.layout.fields();
        let difference = bits ^ self.expected[place];
        if fields[place].direction != Direction::Check {
            return difference;
        }
        // The check value is right if it belongs to the word that contains it, or was copied from the set.
        let word: Option<Vec<u32>> = got.iter().copied().collect();
        match word.map(|word| bits ^ check_value(&self.layout, &word)) {
            Some(0) => 0,
            _ => difference,
        }
    }

    fn wrong(&self, order: &[usize], got: &[Option<u32>]) -> Option<Wrong> {
        let fields = self.layout.fields();
        let differs = |&place: &usize| {
            let bits = got[place]?;
            let bit = self.difference(place, bits, got).checked_ilog2()?;
            Some((place, bits, bit))
        };
        let mut differing = order.iter().filter_map(differs);
        let (place, found, bit) = differing.next()?;
        let Field { stage, name, width, .. } = &fields[place];
        Some(Wrong {
            stage: stage.clone(),
            field: name.clone(),
            bit,
            found,
            expected: self.expected[place],
            width: *width,
            fields_differing: 1 + differing.count(),
        })
    }
}

/// The exponent that belongs to a field: for a mantissa that of its block, if the block has one; else 0. `integers` are those of
/// all fields.
pub(super) fn exponent(fields: &[Field], field: &Field, integers: &[i64]) -> i32 {
    // An exponent has 16 bits.
    exponent_field(fields, field).map_or(0, |place| integers[place] as i32)
}

/// The place of the exponent that belongs to a field.
fn exponent_field(fields: &[Field], field: &Field) -> Option<usize> {
    let port = format!("{}.exponent", block(field)?);
    fields.iter().position(|field| field.port == port)
}

/// The path of the block whose mantissa a field is.
fn block(field: &Field) -> Option<&str> {
    field.port.rsplit_once(".mantissa[").map(|(block, _)| block)
}

/// The digits of a field.
pub(super) fn digits(field: &Field, bits: u32) -> String {
    format!("{bits:0digits$x}", digits = field.digits() as usize)
}
