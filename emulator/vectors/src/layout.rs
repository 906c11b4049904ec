//! The fields of a vector word: their list and positions, and the conversion of ports' integers to and from words.
//!
//! A field is a port or an outcome of the datapath's design, as declared by the bundles of `roughxel_core::ports`: name, unit,
//! stage, range and order come from the declaration. A set has the fields that exist under its effects: inputs that an operation
//! of the netlist reads, and outcomes that are not constants. Its columns are therefore the ports of the hardware for the same
//! effects. A field keeps the bits that its profile keeps and takes whole hex digits.

use std::collections::HashMap;

use roughxel_core::design::Design;
use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::precision::Precision;
use roughxel_netlist::graph::{Net, NodeId};
use roughxel_netlist::verilog::{Stage, StagePort, VerilogError};
use roughxel_record as record;

use super::columns::{Column, columns};
use super::datapath::Computed;
use super::field::{Direction, Field, Source, below, fields, mask};

/// Bits of the check value at the end of a word.
pub(crate) const CHECK_BITS: u32 = roughxel_utilities::crc::BITS;

/// The fields of a word, most significant first, for one datapath, its effects and one profile.
#[derive(Clone, Debug)]
pub struct Layout {
    fields: Vec<Field>,
    /// Source of the integer of each field but the check value, and the number of low bits that the profile drops.
    sources: Vec<(Source, u32)>,
    /// The lowest and the highest integer that each of these fields is declared to hold.
    limits: Vec<(i64, i64)>,
    /// Ports of the design, including those without a field.
    ports: usize,
    /// Position of each field's stage in the pipeline.
    ranks: Vec<usize>,
    /// The stage whose ports are the fields; `None` for a whole datapath.
    stage: Option<Stage>,
}

impl Layout {
    /// The fields of a datapath under its effects and `p`, with fields between stages or without.
    pub fn new(datapath: Datapath, effects: &Effects, p: &Precision, with_taps: bool) -> Self {
        let net = record::net(Design::for_datapath(datapath), effects, p);
        let is_shown = |column: &Column| column.exists && (with_taps || column.field.direction != Direction::Tap);
        let columns: Vec<Column> = columns(&net, datapath, p).into_iter().filter(is_shown).collect();
        let limits = columns.iter().map(|column| column.limits).collect();
        let (fields, sources): (Vec<Field>, Vec<(Source, u32)>) =
            columns.into_iter().map(|column| (column.field, (column.source, column.drop))).unzip();
        // Order of the stages' runs; inputs are before, the check value after all of them.
        let mut runs: HashMap<&str, usize> = HashMap::from([("input", 0)]);
        for (rank, run) in net.runs.iter().enumerate() {
            // A stage that runs for parts of its outcome ends with the last of them: `highlight` begins before `half`, on which f
            // depends.
            runs.insert(run.base(), rank + 1);
        }
        let rank = |field: &Field| runs.get(field.stage.as_str()).copied().unwrap_or(usize::MAX);
        Self::placed(fields, sources, limits, net.ports.len(), rank)
    }

    /// The fields of a stage: the ports of its module in their order, inputs first.
    ///
    /// Errors: a port with more bits than a field can have, or with places only before its binary point. No named profile has
    /// one.
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

    /// The fields at their places in the word, followed by the check value.
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

    /// The stage whose ports are the fields; `None` for a whole datapath.
    pub(super) fn stage(&self) -> Option<&Stage> {
        self.stage.as_ref()
    }

    /// Position of a field's stage in the pipeline: of several differing fields that of the earliest stage is named first.
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

    /// Characters of a word's line, including underscores, without the end of line.
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

    /// The fields' bits of the integers of ports and outputs, without the check value; or the first field that is too narrow for
    /// its integer.
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

    /// The bits of the input fields, which begin a word, from the integers of ports; `None` if a field is too narrow for its
    /// integer.
    pub(super) fn input_bits(&self, inputs: &[i64]) -> Option<Vec<u32>> {
        let of_port = |(field, &(source, drop)): (&Field, &(Source, u32))| match source {
            Source::Port(place) => Some(field.bits(inputs[place], drop)),
            Source::Output(_) => None,
        };
        self.fields.iter().zip(&self.sources).map_while(of_port).collect()
    }

    /// Returns true if a field, not the check value, is declared to hold this integer.
    pub(super) fn allows(&self, field: usize, integer: i64) -> bool {
        let (low, high) = self.limits[field];
        (low..=high).contains(&integer)
    }

    /// Rows of a batch of vectors with the integers of each field but the check value, with the number of low bits that drop.
    pub(super) fn rows<'a>(&self, batch: &'a Computed) -> Vec<(&'a [i32], u32)> {
        let row = |&(source, drop): &(Source, u32)| match source {
            Source::Port(place) => (batch.port(place), drop),
            Source::Output(place) => (batch.output(place), drop),
        };
        self.sources.iter().map(row).collect()
    }

    /// The fields of a datapath between the ports and at its outputs: place in the word, wire of the netlist, number of its low
    /// bits that drop.
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

/// A port of a stage's module as a field, without its place in the word.
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
