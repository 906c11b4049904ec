//! Number formats on vectors of wires: exactly the bits that a proven range needs, without constant low zeros.

use std::fmt;

use crate::interval::Range;

/// The format of a port or a wire: the stored integer is `value >> zeros`.
///
/// Its short name is that of the `fixed` crate: `i2f16` is signed with 2 integer bits (the sign among them) and 16
/// fraction bits, `u0f8` unsigned; `n` stands for a minus sign (`i9fn2`: two zeros dropped above the binary point).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Format {
    /// Range of the integer, before zeros are dropped.
    pub range: Range,
    /// Low bits that are always zero and have no wire.
    pub zeros: u32,
    /// Binary point of the integer before zeros are dropped.
    pub fraction_bits: u32,
    /// True for one bit that is no number.
    pub flag: bool,
}

impl Format {
    /// The format of a range.
    pub fn new(range: Range, fraction_bits: u32, flag: bool) -> Self {
        // Every bit of the constant 0 is a constant zero; one is kept, at the binary point.
        let zeros = if range.constant() == Some(0) { fraction_bits } else { range.zeros };
        Self { range, zeros, fraction_bits, flag }
    }

    /// Bits on the wires.
    pub fn width(&self) -> u32 {
        self.range.width()
    }

    /// True if the top bit is a sign.
    pub fn signed(&self) -> bool {
        self.range.signed()
    }

    /// Binary point of the stored integer.
    pub fn stored_fraction_bits(&self) -> i32 {
        self.fraction_bits as i32 - self.zeros as i32
    }

    /// Stored bits of an integer; `None` if the wires cannot hold it.
    pub fn pack(&self, value: i64) -> Option<u64> {
        let stored = value >> self.zeros;
        let mask = u64::MAX >> (64 - self.width().min(64));
        let bits = stored as u64 & mask;
        (stored << self.zeros == value && self.unpack(bits) == value).then_some(bits)
    }

    /// Integer of stored bits.
    pub fn unpack(&self, bits: u64) -> i64 {
        let above = 64 - self.width().min(64);
        let stored = if self.signed() { (bits << above) as i64 >> above } else { bits as i64 };
        stored << self.zeros
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.flag {
            return f.write_str("flag");
        }
        let fraction = self.stored_fraction_bits();
        let number = |n: i32| if n < 0 { format!("n{}", -n) } else { n.to_string() };
        let sign = if self.signed() { 'i' } else { 'u' };
        write!(f, "{sign}{}f{}", number(self.width() as i32 - fraction), number(fraction))
    }
}

/// Vector in a declaration: `signed [17:0]`, `[3:0]`, or nothing for a single bit without a sign, with a space after it.
pub(super) fn vector(width: u32, signed: bool) -> String {
    match (width, signed) {
        (1, false) => String::new(),
        (_, true) => format!("signed [{}:0] ", width - 1),
        _ => format!("[{}:0] ", width - 1),
    }
}

/// A real number in a few digits.
fn real(x: f64) -> String {
    let text = format!("{x:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if x != 0.0 && x.abs() < 0.01 || x.abs() >= 1e7 { format!("{x:.3e}") } else { text.to_owned() }
}

impl Format {
    /// Range of the wire, for a comment: `-65536 .. 65536 in 2^-16: -1 .. 1`.
    pub(super) fn describe(&self) -> String {
        if self.flag {
            return "0 or 1".into();
        }
        let Range { low, high, .. } = self.range;
        let (low, high) = (low >> self.zeros, high >> self.zeros);
        let ends = if low == high { low.to_string() } else { format!("{low} .. {high}") };
        let fraction = self.stored_fraction_bits();
        if fraction == 0 {
            return ends;
        }
        let value = |x: i64| real(x as f64 * f64::from(-fraction).exp2());
        let values = if low == high { value(low) } else { format!("{} .. {}", value(low), value(high)) };
        format!("{ends} in 2^{}: {values}", -fraction)
    }
}
