//! A vector word as text: hex digits, fields separated by underscores, the check value last.
//!
//! The check value is a CRC-32 (polynomial 04c11db7, not reflected, start ffffffff, no final inversion) over the
//! bits above it, most significant first. The polynomial is primitive, so in words below 2^32 bits every single
//! flipped bit leaves another remainder and can be located.

use super::layout::{CHECK_BITS, Field, Layout};

const POLYNOMIAL: u32 = 0x04c1_1db7;

/// The remainder after one more hex digit, from the remainder's top four bits and the digit.
const BY_DIGIT: [u32; 16] = {
    let mut table = [0; 16];
    let mut digit = 0;
    while digit < 16 {
        let mut remainder = (digit as u32) << 28;
        let mut bit = 0;
        while bit < 4 {
            remainder = next_remainder(remainder);
            bit += 1;
        }
        table[digit] = remainder;
        digit += 1;
    }
    table
};

/// x · remainder modulo the polynomial.
const fn next_remainder(remainder: u32) -> u32 {
    remainder << 1 ^ if remainder >> 31 == 1 { POLYNOMIAL } else { 0 }
}

/// The check value of the fields above it.
pub(crate) fn check_value(fields: &[Field], bits: &[u32]) -> u32 {
    let data = fields.iter().zip(bits).filter(|(field, _)| field.stage != "check");
    data.fold(u32::MAX, |remainder, (field, &bits)| {
        (0..field.digits()).rev().fold(remainder, |remainder, digit| {
            let index = remainder >> 28 ^ (bits >> (4 * digit) & 15);
            remainder << 4 ^ BY_DIGIT[index as usize]
        })
    })
}

/// Which bit of a word of `word_bits` was flipped, if one was: the word's own place whose remainder is `syndrome`,
/// the exclusive or of the check value found and the one computed.
pub(crate) fn locate_flip(syndrome: u32, word_bits: u32) -> Option<u32> {
    if syndrome.count_ones() == 1 {
        return Some(syndrome.trailing_zeros());
    }
    // A data bit just above the check value has the remainder x^32, the next one x^33, …
    let mut remainder = POLYNOMIAL;
    for place in CHECK_BITS..word_bits {
        if remainder == syndrome {
            return Some(place);
        }
        remainder = next_remainder(remainder);
    }
    None
}

/// Appends the word of the fields' `bits` (check value included) to `line`.
pub(crate) fn write_word(line: &mut Vec<u8>, fields: &[Field], bits: &[u32]) {
    for (index, (field, &bits)) in fields.iter().zip(bits).enumerate() {
        if index > 0 {
            line.push(b'_');
        }
        line.extend((0..field.digits()).rev().map(|digit| b"0123456789abcdef"[(bits >> (4 * digit) & 15) as usize]));
    }
}

/// The fields' bits of a line, padding included, or what is wrong with it.
pub(crate) fn read_word(line: &[u8], layout: &Layout) -> Result<Vec<u32>, String> {
    if line.len() != layout.line_length() {
        let digits = line.iter().filter(|c| c.is_ascii_hexdigit()).count();
        let expected = layout.word_bits() / 4;
        return Err(format!(
            "{} characters with {digits} hex digits, but a word of this set has {} with {expected}",
            line.len(),
            layout.line_length(),
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
