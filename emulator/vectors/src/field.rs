//! A field of a vector word, and the wire that carries it.

use roughxel_core::bundle::{self, Step};
use roughxel_core::precision::Precision;
use serde::{Deserialize, Serialize};

/// Direction of a field.
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
    /// Direction of the field.
    pub direction: Direction,
    /// Stage that makes it; `input` for inputs, `check` for the check value.
    pub stage: String,
    /// Path of the port or output of the datapath's design that carries it; empty for the check value.
    pub port: String,
    /// Place of its lowest bit in the word, a multiple of 4.
    pub lsb: u32,
    /// Bits; the bits above it, up to the next multiple of 4, are zero.
    pub width: u32,
    /// True for two's complement.
    pub signed: bool,
    /// Fraction bits: the value is the integer over 2^fraction_bits (times 2^exponent for a mantissa).
    pub fraction_bits: u32,
    /// Unit.
    pub unit: String,
    /// Largest accepted difference in last places; 0 is exact.
    pub tolerance: u32,
    /// Description of the field.
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

    /// The field's bits of an integer whose lowest `drop` bits the profile drops; `None` if it has bits that the field does not
    /// keep.
    #[inline]
    pub(super) fn bits(&self, integer: i64, drop: u32) -> Option<u32> {
        let bits = (integer >> drop) as u32 & mask(self.width);
        (self.integer(bits) << drop == integer).then_some(bits)
    }
}

/// Location of a field's integer.
#[derive(Clone, Copy, Debug)]
pub(super) enum Source {
    /// One of the ports of the design.
    Port(usize),
    /// One of its outputs.
    Output(usize),
}

/// The lowest `width` bits, 1…32.
pub(crate) const fn mask(width: u32) -> u32 {
    u32::MAX >> (32 - width)
}

/// Bits of the scalar API's mantissa that the words of a profile lack.
pub(super) fn below(mantissa: bool, p: &Precision) -> u32 {
    if mantissa { 32 - p.word_bits() } else { 0 }
}

/// The fields on the way to a wire.
pub(super) fn fields(path: &[Step]) -> impl Iterator<Item = &'static bundle::Field> {
    path.iter().filter_map(|step| match step {
        Step::Field(field) => Some(*field),
        Step::Index(_) => None,
    })
}
