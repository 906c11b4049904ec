//! A vector word as text or as bytes: the fields' bits, most significant first, the check value last.
//!
//! As text it is hex digits with underscores between fields. As bytes it is the same digits, two per byte, big endian, with a
//! leading zero digit if their number is odd.
//!
//! The check value is a CRC-32 ([`crc`]) that starts with ffffffff, over the bits above it, most significant first.

use roughxel_simd::Backend;
use roughxel_utilities::crc;

use super::field::{Field, mask};
use super::layout::{CHECK_BITS, Layout};
use super::manifest::Form;

/// The digits of a word's fields, eight by eight; the last field is at the end of the last eight, zeros are before the first.
///
/// `digits` are those of all fields. For a whole word the check value is the last element.
pub(crate) fn pack(fields: &[Field], bits: &[u32], digits: u32, packed: &mut Vec<u32>) {
    packed.clear();
    let (mut waiting, mut count) = (0_u64, digits.wrapping_neg() % 8 * 4);
    for (field, &bits) in fields.iter().zip(bits) {
        let width = 4 * field.digits();
        // Fewer than 32 bits wait, and a field has at most 32.
        waiting = waiting << width | u64::from(bits);
        count += width;
        if count >= 32 {
            count -= 32;
            packed.push((waiting >> count) as u32);
        }
    }
}

/// The remainder that the zeros before the first of `digits` digits, as [`pack`] places them, turn into all ones.
const fn begun(digits: u32) -> u32 {
    crc::before_zeros(u32::MAX, digits.wrapping_neg() % 8 * 4)
}

/// The check value of the digits above it, as [`pack`] places them.
pub(crate) fn check_of(packed: &[u32], digits: u32) -> u32 {
    crc::remainder(begun(digits), packed)
}

/// The check value of a word from its fields' bits; the bits of the check value itself are not read.
pub(crate) fn check_value(layout: &Layout, bits: &[u32]) -> u32 {
    let (data, digits) = (layout.fields().len() - 1, layout.data_digits());
    let mut packed = Vec::new();
    pack(&layout.fields()[..data], &bits[..data], digits, &mut packed);
    check_of(&packed, digits)
}

/// Characters of a line with its end, or bytes of a record.
pub(crate) fn length(layout: &Layout, form: Form) -> usize {
    match form {
        Form::Hex => layout.line_length() + 1,
        Form::Bin => layout.word_bits().div_ceil(8) as usize,
    }
}

/// Words that are encoded at once: their fields fit a processor's first-level cache.
pub(crate) const CHUNK: usize = crc::COLUMNS;

/// A number of each of some words.
type Row = [u32; CHUNK];

/// Rows whose words are brought together at once.
const PIECE: usize = 4;

/// Encodes words field by field, many at a time, as text or as bytes.
pub(crate) struct Encoder {
    form: Form,
    /// Each field but the check value: its width, sign, digits before its last one from the end of the data, its digits, and its
    /// position in a line.
    places: Vec<Place>,
    /// Digits of a word above its check value.
    digits: u32,
    /// Characters of a line with its end; bytes of a record.
    length: usize,
    /// The fields' bits.
    bits: Vec<Row>,
    /// The words as [`pack`] places them, the first eight digits first, followed by the check value: whole pieces of four rows,
    /// zeros before the first.
    rows: Vec<Row>,
    /// Some rows of each word, as bytes.
    pieces: Vec<[[[u8; 4]; PIECE]; CHUNK]>,
    /// Number of waiting words.
    waiting: usize,
    /// Its instruction set.
    backend: Backend,
}

/// Position of a field.
#[derive(Clone, Copy)]
struct Place {
    width: u32,
    signed: bool,
    /// Bits below it, without those of the check value.
    below: u32,
    digits: usize,
    /// Its first character in a line.
    column: usize,
}

impl Place {
    /// The field's bits of words with these integers; `others` gets the bits of an integer that the field does not keep.
    #[inline(always)]
    fn bits_of(&self, integers: &[i32; CHUNK], drop: u32, bits: &mut Row, others: &mut [i32; CHUNK]) {
        let (mask, spare) = (mask(self.width), 32 - self.width);
        // An unsigned field of 32 bits has no integer below 0.
        let (sign, never) = if self.signed { (spare, 0) } else { (0, i32::MIN) };
        for word in 0..CHUNK {
            let (integer, kept) = (integers[word], (integers[word] >> drop).cast_unsigned() & mask);
            bits[word] = kept;
            others[word] |= (kept << sign).cast_signed() >> sign << drop ^ integer | integer & never;
        }
    }

    /// Returns true if the field keeps all of an integer.
    fn keeps(&self, integer: i32, drop: u32) -> bool {
        let above = u64::from((integer >> drop).cast_unsigned() & mask(self.width)) << (64 - self.width);
        let kept = if self.signed {
            above.cast_signed() >> (64 - self.width)
        } else {
            (above >> (64 - self.width)).cast_signed()
        };
        kept << drop == i64::from(integer)
    }
}

impl Encoder {
    pub(crate) fn new(layout: &Layout, form: Form) -> Self {
        let mut column = 0;
        let place = |field: &Field| {
            let digits = field.digits() as usize;
            column += digits + 1;
            let (width, signed) = (field.width, field.signed);
            Place { width, signed, below: field.lsb.wrapping_sub(CHECK_BITS), digits, column: column - digits - 1 }
        };
        let mut places: Vec<Place> = layout.fields().iter().map(place).collect();
        places.pop();
        let digits = layout.data_digits();
        let length = length(layout, form);
        let bits = vec![[0; CHUNK]; places.len()];
        let rows = vec![[0; CHUNK]; (digits.div_ceil(8) as usize + 1).next_multiple_of(PIECE)];
        let pieces = vec![[[[0; 4]; PIECE]; CHUNK]; rows.len() / PIECE];
        Self { form, places, digits, length, bits, rows, pieces, waiting: 0, backend: Backend::best() }
    }

    /// Sets all fields of the waiting words, from `count` integers of each, starting with the `first`; the profile drops their
    /// lowest bits. Returns the first field for which a word's integer has bits that the field does not keep, and that word.
    pub(crate) fn set(&mut self, rows: &[(&[i32], u32)], first: usize, count: usize) -> Option<(usize, usize)> {
        self.waiting = count;
        let others = self.backend.run(
            #[inline(always)]
            || {
                let mut others = [0; CHUNK];
                for ((place, bits), &(row, drop)) in self.places.iter().zip(&mut self.bits).zip(rows) {
                    let row = &row[first..][..count];
                    match row.first_chunk() {
                        Some(row) => place.bits_of(row, drop, bits, &mut others),
                        None => {
                            // Every field can hold 0.
                            let mut filled = [0; CHUNK];
                            filled[..count].copy_from_slice(row);
                            place.bits_of(&filled, drop, bits, &mut others);
                        }
                    }
                }
                others
            },
        );
        if others == [0; CHUNK] {
            return None;
        }
        let mut fields = self.places.iter().zip(rows).enumerate();
        fields.find_map(|(field, (place, &(row, drop)))| {
            let word = row[first..][..count].iter().position(|&integer| !place.keeps(integer, drop))?;
            Some((field, word))
        })
    }

    /// Adds a word, from its fields' bits without the check value. Range: fewer than [`CHUNK`] wait.
    pub(crate) fn push(&mut self, bits: &[u32]) {
        for (row, &bits) in self.bits.iter_mut().zip(bits) {
            row[self.waiting] = bits;
        }
        self.waiting += 1;
    }

    /// Writes the waiting words over the beginning of `text`, which has room for them, and returns the rest of it.
    pub(crate) fn write<'a>(&mut self, text: &'a mut [u8]) -> &'a mut [u8] {
        let count = std::mem::take(&mut self.waiting);
        let backend = self.backend;
        backend.run(
            #[inline(always)]
            || self.pack(),
        );
        let last = self.rows.len() - 1;
        let mut check = [begun(self.digits); CHUNK];
        crc::remainders(&self.rows[last - self.digits.div_ceil(8) as usize..last], &mut check);
        let (text, rest) = text.split_at_mut(count * self.length);
        match self.form {
            Form::Hex => {
                for (word, text) in text.chunks_exact_mut(self.length).enumerate() {
                    // Eight characters whatever the digits: an underscore follows, and the next field overwrites the rest.
                    for (place, row) in self.places.iter().zip(&self.bits) {
                        let digits = u64::from_be_bytes(hex_digits(row[word])) << (64 - 8 * place.digits);
                        text[place.column..][..8].copy_from_slice(&digits.to_be_bytes());
                        text[place.column + place.digits] = b'_';
                    }
                    text[self.length - 9..][..8].copy_from_slice(&hex_digits(check[word]));
                    text[self.length - 1] = b'\n';
                }
            }
            Form::Bin => {
                self.rows[last] = check;
                backend.run(
                    #[inline(always)]
                    || self.write_records(text),
                );
            }
        }
        rest
    }

    /// The fields' digits eight by eight.
    #[inline(always)]
    fn pack(&mut self) {
        self.rows.fill([0; CHUNK]);
        let last = self.rows.len() - 2;
        for (place, row) in self.places.iter().zip(&self.bits) {
            let (eight, shift) = (last - place.below as usize / 32, place.below % 32);
            for (packed, bits) in self.rows[eight].iter_mut().zip(row) {
                *packed |= bits << shift;
            }
            if shift as usize + 4 * place.digits > 32 {
                for (packed, bits) in self.rows[eight - 1].iter_mut().zip(row) {
                    *packed |= bits >> (32 - shift);
                }
            }
        }
    }

    /// Writes the rows record by record over `text`.
    #[inline(always)]
    fn write_records(&mut self, text: &mut [u8]) {
        for (rows, pieces) in self.rows.as_chunks::<PIECE>().0.iter().zip(&mut self.pieces) {
            for (word, piece) in pieces.iter_mut().enumerate() {
                *piece = [rows[0][word], rows[1][word], rows[2][word], rows[3][word]].map(u32::to_be_bytes);
            }
        }
        let padded = 4 * self.rows.len();
        // From the last record to the first: the leading zeros of a record overwrite the end of the record before it.
        for word in (0..text.len() / self.length).rev() {
            let text = &mut text[..(word + 1) * self.length];
            match text.len().checked_sub(padded) {
                Some(first) => {
                    for (to, pieces) in text[first..].as_chunks_mut::<{ 4 * PIECE }>().0.iter_mut().zip(&self.pieces) {
                        to.copy_from_slice(pieces[word].as_flattened());
                    }
                }
                None => {
                    let bytes = self.pieces.iter().flat_map(|pieces| pieces[word].as_flattened());
                    let bytes = bytes.skip(padded - text.len());
                    text.iter_mut().zip(bytes).for_each(|(to, &byte)| *to = byte);
                }
            }
        }
    }
}

/// Eight lower-case hex digits.
fn hex_digits(bits: u32) -> [u8; 8] {
    // A digit per byte, in three steps; letters then get the distance between the codes of 9 and a.
    let halves = u64::from(bits >> 16) << 32 | u64::from(bits & 0xffff);
    let bytes = (halves << 8 | halves) & 0x00ff_00ff_00ff_00ff;
    let digits = (bytes << 4 | bytes) & 0x0f0f_0f0f_0f0f_0f0f;
    let is_letter = (digits + 0x0606_0606_0606_0606) >> 4 & 0x0101_0101_0101_0101;
    (digits + 0x3030_3030_3030_3030 + is_letter * u64::from(b'a' - b'9' - 1)).to_be_bytes()
}

/// The fields' bits of a record, including padding, or its fault.
pub(crate) fn read_record(record: &[u8], layout: &Layout) -> Result<Vec<u32>, String> {
    let digit = |place: u32| u32::from(record[record.len() - 1 - place as usize / 2] >> (4 * (place % 2)) & 15);
    let digits = layout.word_bits() / 4;
    if record.len() != digits.div_ceil(2) as usize {
        return Err(format!("{} bytes, but a word of this set has {}", record.len(), digits.div_ceil(2)));
    }
    if digits % 2 == 1 && digit(digits) != 0 {
        return Err(format!("the first digit is {:x}, but words of {digits} digits begin with a zero", digit(digits)));
    }
    let bits =
        |field: &Field| (0..field.digits()).rev().fold(0, |bits, place| bits << 4 | digit(field.lsb / 4 + place));
    Ok(layout.fields().iter().map(bits).collect())
}

/// The message for the first field with a wrong number of digits, if the line has fields at all.
fn odd_field(line: &[u8], layout: &Layout) -> String {
    let mut parts = line.split(|&c| c == b'_').zip(layout.fields());
    match parts.find(|(part, field)| part.len() != field.digits() as usize) {
        Some((part, field)) if line.contains(&b'_') => {
            format!("; field {} has {} of {} digits", field.name, part.len(), field.digits())
        }
        _ => String::new(),
    }
}

/// The fields' bits of a line, including padding, or its fault.
pub(crate) fn read_word(line: &[u8], layout: &Layout) -> Result<Vec<u32>, String> {
    if line.len() != layout.line_length() {
        let digits = line.iter().filter(|c| c.is_ascii_hexdigit()).count();
        let expected = layout.word_bits() / 4;
        return Err(format!(
            "{} characters with {digits} hex digits, but a word of this set has {} with {expected}{}",
            line.len(),
            layout.line_length(),
            odd_field(line, layout),
        ));
    }
    let mut at = 0;
    let mut bits = Vec::with_capacity(layout.fields().len());
    for (index, field) in layout.fields().iter().enumerate() {
        if index > 0 {
            if line[at] != b'_' {
                let found = char::from(line[at]);
                return Err(format!(
                    "column {}: {found:?} where an underscore comes before field {}",
                    at + 1,
                    field.name
                ));
            }
            at += 1;
        }
        let mut value = 0;
        for _ in 0..field.digits() {
            let digit = match line[at] {
                c @ b'0'..=b'9' => c - b'0',
                c @ b'a'..=b'f' => c - b'a' + 10,
                c => {
                    let (column, found) = (at + 1, char::from(c));
                    return Err(format!(
                        "column {column}: {found:?} in field {} is no lower-case hex digit",
                        field.name
                    ));
                }
            };
            value = value << 4 | u32::from(digit);
            at += 1;
        }
        bits.push(value);
    }
    Ok(bits)
}

/// The fields' bits of a device's word; digits are of either case, with underscores between fields or none at all.
pub(crate) fn read_device_word(text: &[u8], layout: &Layout) -> Result<Vec<u32>, String> {
    let lower = text.to_ascii_lowercase();
    if lower.contains(&b'_') {
        return read_word(&lower, layout);
    }
    let digits = layout.word_bits() / 4;
    let text = String::from_utf8_lossy(&lower);
    if let Some(place) = text.chars().position(|c| !c.is_ascii_hexdigit()) {
        return Err(format!("character {} of the word is no hex digit", place + 1));
    }
    if text.len() != digits as usize {
        return Err(format!("{} hex digits, but a word of this set has {digits}", text.len()));
    }
    let mut rest = &text[..];
    let mut bits = Vec::with_capacity(layout.fields().len());
    for field in layout.fields() {
        let (digits, after) = rest.split_at(field.digits() as usize);
        bits.push(u32::from_str_radix(digits, 16).map_err(|error| error.to_string())?);
        rest = after;
    }
    Ok(bits)
}
