//! The fields of a vector word: which there are, where they lie, and how integers of ports go in and out.
//!
//! A field is a port or an outcome of the datapath's design, as the bundles of `roughxel_core::ports` declare them: name, unit, stage
//! and range come from there, in that order. A set has those that exist
//! under its effects: inputs that an operation of the recorded design reads, outcomes that are no constants, so its columns
//! are the ports of the hardware made for the same effects. A field keeps the bits its profile keeps and takes whole hex
//! digits.

use std::collections::HashMap;
use std::fmt;

use roughxel_core::bundle::{self, Keeps, Step};
use roughxel_core::design::Design;
use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::precision::Precision;
use roughxel_core::status::StatusBit;
use roughxel_net::graph::{Net, NodeId};
use roughxel_net::verilog::{Stage, StagePort, VerilogError};
use roughxel_record as record;
use serde::{Deserialize, Serialize};

use super::datapath::Computed;

/// Bits of the check value at the end of a word.
pub(crate) const CHECK_BITS: u32 = roughxel_utilities::crc::BITS;

/// Which way a field goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// Into the datapath.
    In,
    /// Between two stages.
    Tap,
    /// Out of the datapath.
    Out,
    /// Not part of the datapath: the check value of the word.
    Check,
}

/// One field of a word, as the manifest describes it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Field {
    /// Name, unique in the word.
    pub name: String,
    /// Which way it goes.
    pub direction: Direction,
    /// Stage that makes it; `input` of what goes in, `check` of the check value.
    pub stage: String,
    /// Path of the port or output of the datapath's design that carries it; empty for the check value.
    pub port: String,
    /// Place of its lowest bit in the word, a multiple of 4.
    pub lsb: u32,
    /// Bits; the bits above it, up to the next multiple of 4, are zero.
    pub width: u32,
    /// Two's complement.
    pub signed: bool,
    /// Fraction bits: the value is the integer over 2^fraction_bits (times 2^exponent for a mantissa).
    pub fraction_bits: u32,
    /// Unit.
    pub unit: String,
    /// Largest accepted difference in last places; 0 is exact.
    pub tolerance: u32,
    /// What it is.
    pub description: String,
}

impl Field {
    /// Hex digits the field takes.
    pub fn digits(&self) -> u32 {
        self.width.div_ceil(4)
    }

    /// The integer in the field's bits.
    pub(crate) fn integer(&self, bits: u32) -> i64 {
        let spare = 64 - self.width;
        let bits = u64::from(bits) << spare;
        if self.signed { bits.cast_signed() >> spare } else { (bits >> spare).cast_signed() }
    }

    /// The field's bits of an integer whose lowest `drop` bits the profile drops; `None` if it has others than the field keeps.
    #[inline]
    pub(super) fn bits(&self, integer: i64, drop: u32) -> Option<u32> {
        let bits = (integer >> drop) as u32 & mask(self.width);
        (self.integer(bits) << drop == integer).then_some(bits)
    }
}

/// Where the integer of a field is.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// Among the ports of the design.
    Port(usize),
    /// Among its outputs.
    Output(usize),
}

/// The fields of a word, most significant first, for one datapath, its effects and one profile.
#[derive(Clone, Debug)]
pub struct Layout {
    fields: Vec<Field>,
    /// Where the integer of each field but the check value comes from, and how many of its low bits the profile drops.
    sources: Vec<(Source, u32)>,
    /// The lowest and the highest integer that each of them is declared to hold.
    limits: Vec<(i64, i64)>,
    /// Ports of the design, those without a field included.
    ports: usize,
    /// Where the stage of each field stands in the pipeline.
    ranks: Vec<usize>,
    /// The stage that the fields are the ports of; `None` of a whole datapath.
    stage: Option<Stage>,
}

impl Layout {
    /// The fields of a datapath under its effects and `p`, with those between stages or without.
    pub fn new(datapath: Datapath, effects: &Effects, p: &Precision, with_taps: bool) -> Self {
        let net = record::net(Design::of(datapath), effects, p);
        let is_shown = |column: &Column| column.exists && (with_taps || column.field.direction != Direction::Tap);
        let columns: Vec<Column> = columns(&net, datapath, p).into_iter().filter(is_shown).collect();
        let limits = columns.iter().map(|column| column.limits).collect();
        let (fields, sources): (Vec<Field>, Vec<(Source, u32)>) =
            columns.into_iter().map(|column| (column.field, (column.source, column.drop))).unzip();
        // In the order in which the stages run; inputs are before, the check value after all of them.
        let mut runs: HashMap<&str, usize> = HashMap::from([("input", 0)]);
        for (rank, run) in net.runs.iter().enumerate() {
            // A stage that runs for parts of its outcome is done with the last of them: `highlight` begins before `half`, on which f depends.
            runs.insert(run.base(), rank + 1);
        }
        let rank = |field: &Field| runs.get(field.stage.as_str()).copied().unwrap_or(usize::MAX);
        Self::placed(fields, sources, limits, net.ports.len(), rank)
    }

    /// The fields of a stage: the ports of its module in their order, inputs first.
    ///
    /// Errors: a port with more bits than a field can have, or with places before its binary point alone. No named profile has one.
    pub(super) fn of_stage(stage: &Stage) -> Result<Self, VerilogError> {
        let inputs = stage.inputs.iter().enumerate().map(|(place, port)| (port, Source::Port(place)));
        let outputs = stage.outputs.iter().enumerate().map(|(place, port)| (port, Source::Output(place)));
        let (mut fields, mut sources, mut limits) = (Vec::new(), Vec::new(), Vec::new());
        for (port, source) in inputs.chain(outputs) {
            fields.push(stage_field(stage, port, source)?);
            sources.push((source, port.format.zeros));
            let range = port.format.range;
            limits.push((range.low >> port.format.zeros, range.high >> port.format.zeros));
        }
        let rank = |field: &Field| match field.direction {
            Direction::In => 0,
            Direction::Tap | Direction::Out => 1,
            Direction::Check => usize::MAX,
        };
        Ok(Self { stage: Some(stage.clone()), ..Self::placed(fields, sources, limits, stage.inputs.len(), rank) })
    }

    /// The fields at their places in the word, with the check value behind them.
    fn placed(
        mut fields: Vec<Field>,
        sources: Vec<(Source, u32)>,
        limits: Vec<(i64, i64)>,
        ports: usize,
        rank: impl Fn(&Field) -> usize,
    ) -> Self {
        fields.push(Field {
            name: "check".into(),
            direction: Direction::Check,
            stage: "check".into(),
            port: String::new(),
            lsb: 0,
            width: CHECK_BITS,
            signed: false,
            fraction_bits: 0,
            unit: "1".into(),
            tolerance: 0,
            description: "CRC-32 of the bits above, see FORMAT.md".into(),
        });
        let mut lsb = 0;
        for field in fields.iter_mut().rev() {
            field.lsb = lsb;
            lsb += 4 * field.digits();
        }
        let ranks = fields.iter().map(rank).collect();
        Self { fields, sources, limits, ports, ranks, stage: None }
    }

    /// The stage that the fields are the ports of; `None` of a whole datapath.
    pub(super) fn stage(&self) -> Option<&Stage> {
        self.stage.as_ref()
    }

    /// Where the stage of a field stands in the pipeline: of several differing fields that of the earliest one is named first.
    pub(crate) fn rank(&self, field: usize) -> usize {
        self.ranks[field]
    }

    /// The fields, most significant first.
    pub fn fields(&self) -> &[Field] {
        &self.fields
    }

    /// Bits of a word, a multiple of 4.
    pub fn word_bits(&self) -> u32 {
        self.fields.iter().map(|field| 4 * field.digits()).sum()
    }

    /// Characters of a word's line, underscores included, the end of line not.
    pub(crate) fn line_length(&self) -> usize {
        self.word_bits() as usize / 4 + self.fields.len() - 1
    }

    /// The field at bit `place` of the word and the bit inside it.
    pub(crate) fn field_at(&self, place: u32) -> Option<(usize, u32)> {
        let index = self.fields.iter().position(|field| field.lsb <= place)?;
        Some((index, place - self.fields[index].lsb))
    }

    /// Digits of a word above its check value.
    pub(crate) fn data_digits(&self) -> u32 {
        (self.word_bits() - CHECK_BITS) / 4
    }

    /// The fields' bits of the integers of ports and outputs, the check value left out; or the first field that is too narrow
    /// for its integer.
    pub(crate) fn encode(&self, inputs: &[i64], outputs: &[i64]) -> Result<Vec<u32>, usize> {
        let encode_field = |(index, (field, &(source, drop))): (usize, (&Field, &(Source, u32)))| {
            let integer = match source {
                Source::Port(place) => inputs[place],
                Source::Output(place) => outputs[place],
            };
            field.bits(integer, drop).ok_or(index)
        };
        self.fields.iter().zip(&self.sources).enumerate().map(encode_field).collect()
    }

    /// The bits of the input fields, which a word begins with, of the integers of ports; `None` if one is too narrow for its integer.
    pub(super) fn input_bits(&self, inputs: &[i64]) -> Option<Vec<u32>> {
        let of_port = |(field, &(source, drop)): (&Field, &(Source, u32))| match source {
            Source::Port(place) => Some(field.bits(inputs[place], drop)),
            Source::Output(_) => None,
        };
        self.fields.iter().zip(&self.sources).map_while(of_port).collect()
    }

    /// Whether a field, not the check value, is declared to hold that integer.
    pub(super) fn allows(&self, field: usize, integer: i64) -> bool {
        let (low, high) = self.limits[field];
        (low..=high).contains(&integer)
    }

    /// Where the integers of each field but the check value are in a batch of vectors, with how many of their low bits drop.
    pub(super) fn rows<'a>(&self, batch: &'a Computed) -> Vec<(&'a [i32], u32)> {
        let row = |&(source, drop): &(Source, u32)| match source {
            Source::Port(place) => (batch.port(place), drop),
            Source::Output(place) => (batch.output(place), drop),
        };
        self.sources.iter().map(row).collect()
    }

    /// The fields of a datapath between the ports and behind them: place in the word, wire of the recorded design, low bits of it that drop.
    pub(super) fn outcomes(&self, net: &Net, p: &Precision) -> impl Iterator<Item = (usize, NodeId, u32)> {
        self.places().map(|(field, place, drop)| {
            let output = &net.outputs[place];
            (field, output.node, drop - below(output.mantissa, p))
        })
    }

    /// The fields that are outputs: place in the word, number of the output, low bits that drop.
    pub(super) fn places(&self) -> impl Iterator<Item = (usize, usize, u32)> {
        let output = |(field, &(source, drop)): (usize, &(Source, u32))| match source {
            Source::Port(_) => None,
            Source::Output(place) => Some((field, place, drop)),
        };
        self.sources.iter().enumerate().filter_map(output)
    }

    /// The integers of the ports in the fields' bits of a word; ports without a field are 0.
    pub(crate) fn decode(&self, bits: &[u32]) -> Vec<i64> {
        let mut inputs = vec![0; self.ports];
        for ((field, &(source, drop)), bits) in self.fields.iter().zip(&self.sources).zip(bits) {
            if let Source::Port(place) = source {
                inputs[place] = field.integer(bits & mask(field.width)) << drop;
            }
        }
        inputs
    }
}

/// Bits of a soft core's mantissa that the words of a profile do not have.
fn below(mantissa: bool, p: &Precision) -> u32 {
    if mantissa { 32 - p.word_bits() } else { 0 }
}

/// A port of a stage's module as a field, its place in the word left out.
fn stage_field(stage: &Stage, port: &StagePort, source: Source) -> Result<Field, VerilogError> {
    let StagePort { name, format, wire, path } = port;
    let (width, fraction_bits) = (format.width(), format.stored_fraction_bits());
    let (1..=32, Ok(fraction_bits)) = (width, u32::try_from(fraction_bits)) else {
        return Err(VerilogError::NoField { port: name.clone(), width, fraction_bits });
    };
    let (direction, maker) = match source {
        Source::Port(_) => (Direction::In, "input"),
        Source::Output(_) => (Direction::Out, stage.name.as_str()),
    };
    let run = match &stage.runs[..] {
        [first, _, ..] if matches!(source, Source::Port(_)) => format!(" (of {})", first.instance),
        _ => String::new(),
    };
    let texts = fields(path).map(|field| field.text.trim().trim_end_matches('.')).filter(|text| !text.is_empty());
    let description: Vec<String> = std::iter::once(format!("{wire}{run}")).chain(texts.map(str::to_owned)).collect();
    Ok(Field {
        name: name.clone(),
        direction,
        stage: maker.into(),
        port: name.clone(),
        lsb: 0,
        width,
        signed: format.signed(),
        fraction_bits,
        unit: fields(path).filter(|field| !field.unit.is_empty()).last().map_or("", |field| field.unit).into(),
        tolerance: 0,
        description: description.join(": "),
    })
}

/// The lowest `width` bits, 1…32.
pub(crate) const fn mask(width: u32) -> u32 {
    u32::MAX >> (32 - width)
}

/// A port or an output of a design as a field, there or not.
pub(super) struct Column {
    /// The field, its place in the word left out.
    pub(super) field: Field,
    /// Path of the declared field that it is a wire of: `surface.normal`.
    pub(super) declared: String,
    /// What that is.
    pub(super) text: String,
    /// Fraction bits that a profile keeps.
    pub(super) kept: Kept,
    /// An operation reads it, or it is no constant.
    pub(super) exists: bool,
    /// The lowest and the highest integer of its port, which has `port_fraction` fraction bits.
    pub(super) port_limits: (i64, i64),
    /// Fraction bits of the port, none of them dropped.
    pub(super) port_fraction: u32,
    source: Source,
    /// The lowest and the highest integer of the field.
    limits: (i64, i64),
    /// Low bits of the wire that the profile drops.
    drop: u32,
}

/// Every port and every output of a datapath's design, in the order of its bundles.
pub(super) fn columns(net: &Net, datapath: Datapath, p: &Precision) -> Vec<Column> {
    // The integers are those of the soft core's ports: of narrower words the upper bits.
    let read = net.ports_read();
    let ports = net.ports.iter().zip(read).enumerate().map(|(place, (port, read))| {
        let mantissas = mantissas(&port.path, net.ports.iter().map(|port| &port.path[..]));
        let below = below(port.mantissa, p);
        let wire = Wire {
            path: &port.path,
            port: &port.name,
            mantissa: port.mantissa,
            fraction_bits: port.fraction_bits + below,
            limits: (port.low << below, port.high << below),
            mantissas,
        };
        wire.column(Source::Port(place), read, datapath, p)
    });
    let outputs = net.outputs.iter().zip(&net.limits).enumerate().map(|(place, (output, &(low, high)))| {
        let mantissas = mantissas(&output.path, net.outputs.iter().map(|output| &output.path[..]));
        let below = below(output.mantissa, p);
        let wire = Wire {
            path: &output.path,
            port: &output.name,
            mantissa: output.mantissa,
            fraction_bits: output.fraction_bits + below,
            limits: (low << below, high << below),
            mantissas,
        };
        wire.column(Source::Output(place), net.constant(output).is_none(), datapath, p)
    });
    ports.chain(outputs).collect()
}

/// How many fraction bits a profile keeps of a wire, p its `fraction_bits` and l its `lod_bits`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kept {
    /// l.
    Lod,
    /// p less those that the word has fewer than a mantissa.
    Fraction { less: u32 },
    /// All that it has.
    All(u32),
}

impl Kept {
    fn bits(self, p: &Precision) -> u32 {
        match self {
            Self::Lod => p.lod_bits,
            Self::Fraction { less } => p.fraction_bits.saturating_sub(less),
            Self::All(bits) => bits,
        }
    }
}

impl fmt::Display for Kept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lod => write!(f, "*l*"),
            Self::Fraction { less: 0 } => write!(f, "*p*"),
            Self::Fraction { less } => write!(f, "(*p*−{less})"),
            Self::All(bits) => write!(f, "{bits}"),
        }
    }
}

/// Fraction bits of a mantissa's port.
const MANTISSA_FRACTION: u32 = 30;

/// What is declared of a port or an output.
struct Wire<'a> {
    path: &'a [Step],
    port: &'a str,
    mantissa: bool,
    fraction_bits: u32,
    limits: (i64, i64),
    /// Mantissas of its block, where it is one of a block's wires.
    mantissas: usize,
}

impl Wire<'_> {
    fn column(&self, source: Source, exists: bool, datapath: Datapath, p: &Precision) -> Column {
        let declared = self.declared();
        let kept = match declared.map(|field| field.keeps) {
            Some(Keeps::Lod) => Kept::Lod,
            // A mantissa has two bits before its point; a word that has more keeps as many fewer behind it.
            _ if self.mantissa => Kept::Fraction { less: MANTISSA_FRACTION.saturating_sub(self.fraction_bits) },
            _ => Kept::All(self.fraction_bits),
        };
        let drop = self.fraction_bits - kept.bits(p).min(self.fraction_bits);
        let (low, high) = (self.limits.0 >> drop, self.limits.1 >> drop);
        let signed = low < 0;
        let width = 64 - (high.max(!low)).leading_zeros() + u32::from(signed);
        let stage = declared.map_or("", |field| field.stage);
        let direction = match declared {
            _ if stage.is_empty() => Direction::In,
            Some(field) if field.leaves => Direction::Out,
            _ => Direction::Tap,
        };
        let text = self.text(datapath);
        let field = Field {
            name: column(self.path, self.mantissas),
            direction,
            stage: if stage.is_empty() { "input" } else { stage }.into(),
            port: self.port.into(),
            lsb: 0,
            width,
            signed,
            fraction_bits: self.fraction_bits - drop,
            unit: declared.map_or("", |field| field.unit).into(),
            tolerance: 0,
            description: match fields(self.path).last() {
                // A part of what is declared: a mantissa or an exponent of a block.
                Some(part) if part.unit.is_empty() => format!("{text}: {}", part.text.trim()),
                _ => text.clone(),
            },
        };
        let (port_limits, port_fraction, limits) = (self.limits, self.fraction_bits, (low, high));
        Column {
            field,
            declared: self.declared_path(),
            text,
            kept,
            exists,
            port_limits,
            port_fraction,
            source,
            limits,
            drop,
        }
    }

    /// The innermost field with a unit: of a block that is the block.
    fn declared(&self) -> Option<&'static bundle::Field> {
        fields(self.path).filter(|field| !field.unit.is_empty()).last()
    }

    /// The path to it.
    fn declared_path(&self) -> String {
        let is_declared = |step: &Step| matches!(step, Step::Field(field) if !field.unit.is_empty());
        let end = self.path.iter().rposition(is_declared).map_or(0, |place| place + 1);
        self.path[..end].iter().fold(String::new(), |path, step| match step {
            Step::Field(field) if path.is_empty() => field.name.into(),
            Step::Field(field) => format!("{path}.{}", field.name),
            Step::Index(index) => format!("{path}[{index}]"),
        })
    }

    /// What it is declared to be, of sticky bits with their names.
    fn text(&self, datapath: Datapath) -> String {
        let text = self.declared().map_or("", |field| field.text.trim());
        match fields(self.path).last() {
            Some(field) if field.name == "status" => {
                let bits = StatusBit::of(datapath).map(|bit| format!("{} {}", bit.mask(), bit.name()));
                format!("{text}: {}", bits.collect::<Vec<_>>().join(", "))
            }
            _ => text.to_owned(),
        }
    }
}

/// How many mantissas the block of a wire has.
fn mantissas<'a>(path: &[Step], all: impl Iterator<Item = &'a [Step]>) -> usize {
    let is_mantissas = |step: &Step| matches!(step, Step::Field(field) if field.name == "mantissa");
    let Some(place) = path.iter().position(is_mantissas) else { return 0 };
    all.filter(|other| other.get(..=place) == Some(&path[..=place])).count()
}

/// The fields on the way to a wire.
fn fields(path: &[Step]) -> impl Iterator<Item = &'static bundle::Field> {
    path.iter().filter_map(|step| match step {
        Step::Field(field) => Some(*field),
        Step::Index(_) => None,
    })
}

/// The name of a column: the path without the surface that all datapaths begin with; a component is a letter, or its number; of a
/// block its mantissas are their components alone, its exponent is `e`.
fn column(path: &[Step], mantissas: usize) -> String {
    let (mut name, mut letters) = (String::new(), "");
    for (place, step) in path.iter().enumerate() {
        let part = match step {
            Step::Field(field) if field.name == "surface" => continue,
            Step::Field(field) if field.name == "mantissa" => {
                // The components of the block itself, unless they name an array of blocks.
                let is_array = matches!(path[place - 1], Step::Index(_));
                letters = match (letters, mantissas) {
                    (given, _) if !given.is_empty() && !is_array => given,
                    (_, 1) => "m",
                    (_, 2) => "st",
                    _ => "xyz",
                };
                continue;
            }
            Step::Field(field) if field.name == "exponent" && !field.unit.is_empty() => field.name.to_owned(),
            Step::Field(field) if field.name == "exponent" => "e".into(),
            Step::Field(field) => {
                letters = field.components;
                field.name.to_owned()
            }
            Step::Index(index) => letters.get(*index..=*index).map_or_else(|| index.to_string(), str::to_owned),
        };
        if !name.is_empty() {
            name.push('_');
        }
        name.push_str(&part);
    }
    name
}
