//! The wires of a datapath's design as fields: their declarations, and the bits that a profile keeps.

use std::fmt;

use roughxel_core::bundle::{self, Keeps, Step};
use roughxel_core::plan::Datapath;
use roughxel_core::precision::Precision;
use roughxel_core::status::StatusBit;
use roughxel_netlist::graph::Net;

use super::field::{Direction, Field, Source, below, fields};

/// A port or an output of a design as a field, present or not.
pub(super) struct Column {
    /// The field, without its place in the word.
    pub(super) field: Field,
    /// Path of the declared field that it is a wire of: `surface.normal`.
    pub(super) declared: String,
    /// Text of the declared field.
    pub(super) text: String,
    /// Fraction bits that a profile keeps.
    pub(super) kept: Kept,
    /// True if an operation reads the port, or the output is not a constant.
    pub(super) exists: bool,
    /// The lowest and the highest integer of its port, which has `port_fraction` fraction bits.
    pub(super) port_limits: (i64, i64),
    /// Fraction bits of the port, none of them dropped.
    pub(super) port_fraction: u32,
    pub(super) source: Source,
    /// The lowest and the highest integer of the field.
    pub(super) limits: (i64, i64),
    /// Low bits of the wire that the profile drops.
    pub(super) drop: u32,
}

/// Every port and every output of a datapath's design, in the order of its bundles.
pub(super) fn columns(net: &Net, datapath: Datapath, p: &Precision) -> Vec<Column> {
    let read = net.ports_read();
    let column = |source, path: &[Step], port, mantissa, fraction_bits, (low, high): (i64, i64), exists| {
        let below = below(mantissa, p);
        let mantissas = match source {
            Source::Port(_) => mantissas(path, net.ports.iter().map(|port| &port.path[..])),
            Source::Output(_) => mantissas(path, net.outputs.iter().map(|output| &output.path[..])),
        };
        let limits = (low << below, high << below);
        let wire = Wire { path, port, mantissa, fraction_bits: fraction_bits + below, limits, mantissas };
        wire.column(source, exists, datapath, p)
    };
    let ports = net.ports.iter().zip(read).enumerate().map(|(place, (of, read))| {
        let limits = (of.low, of.high);
        column(Source::Port(place), &of.path, &of.name, of.mantissa, of.fraction_bits, limits, read)
    });
    let outputs = net.outputs.iter().zip(&net.limits).enumerate().map(|(place, (of, &limits))| {
        let exists = net.constant(of).is_none();
        column(Source::Output(place), &of.path, &of.name, of.mantissa, of.fraction_bits, limits, exists)
    });
    ports.chain(outputs).collect()
}

/// Number of fraction bits that a profile keeps of a wire; p is its `fraction_bits` and l its `lod_bits`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kept {
    /// l.
    Lod,
    /// p minus `less`, the number of fraction bits that the word lacks compared with a mantissa.
    Fraction { less: u32 },
    /// All its bits.
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

/// Declaration of a port or an output.
struct Wire<'a> {
    path: &'a [Step],
    port: &'a str,
    mantissa: bool,
    fraction_bits: u32,
    limits: (i64, i64),
    /// Number of mantissas in its block, if it is a wire of a block.
    mantissas: usize,
}

impl Wire<'_> {
    fn column(&self, source: Source, exists: bool, datapath: Datapath, p: &Precision) -> Column {
        let declared = self.declared();
        let kept = match declared.map(|field| field.keeps) {
            Some(Keeps::Lod) => Kept::Lod,
            // A mantissa has two bits before its point; a word with more keeps as many fewer after it.
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
                // A part of a declared field: a mantissa or an exponent of a block.
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

    /// The innermost field with a unit; for a block this is the block.
    fn declared(&self) -> Option<&'static bundle::Field> {
        fields(self.path).filter(|field| !field.unit.is_empty()).last()
    }

    /// The path to the declared field.
    fn declared_path(&self) -> String {
        let is_declared = |step: &Step| matches!(step, Step::Field(field) if !field.unit.is_empty());
        let end = self.path.iter().rposition(is_declared).map_or(0, |place| place + 1);
        self.path[..end].iter().fold(String::new(), |path, step| match step {
            Step::Field(field) if path.is_empty() => field.name.into(),
            Step::Field(field) => format!("{path}.{}", field.name),
            Step::Index(index) => format!("{path}[{index}]"),
        })
    }

    /// Text of the declared field; for sticky bits with their names.
    fn text(&self, datapath: Datapath) -> String {
        let text = self.declared().map_or("", |field| field.text.trim());
        match fields(self.path).last() {
            Some(field) if field.name == "status" => {
                let bits = StatusBit::raised_by(datapath).map(|bit| format!("{} {}", bit.mask(), bit.name()));
                format!("{text}: {}", bits.collect::<Vec<_>>().join(", "))
            }
            _ => text.to_owned(),
        }
    }
}

/// Number of mantissas in the block of a wire.
fn mantissas<'a>(path: &[Step], all: impl Iterator<Item = &'a [Step]>) -> usize {
    let is_mantissas = |step: &Step| matches!(step, Step::Field(field) if field.name == "mantissa");
    let Some(place) = path.iter().position(is_mantissas) else { return 0 };
    all.filter(|other| other.get(..=place) == Some(&path[..=place])).count()
}

/// The name of a column: the path without the surface that begins the paths of all datapaths. A component is a letter, or its
/// number. The mantissas of a block are named by component alone, its exponent is `e`.
fn column(path: &[Step], mantissas: usize) -> String {
    let (mut name, mut letters) = (String::new(), "");
    for (place, step) in path.iter().enumerate() {
        let part = match step {
            Step::Field(field) if field.name == "surface" => continue,
            Step::Field(field) if field.name == "mantissa" => {
                // These are the components of the block itself, unless they name an array of blocks.
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
