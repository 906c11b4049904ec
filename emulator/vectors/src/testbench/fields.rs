//! Names, notes and lines of fields, for the testbenches of all languages.

use crate::field::{Direction, Field};

/// The fields of a set.
#[derive(Clone, Debug)]
pub(super) struct Fields {
    /// Fields in the order of the word.
    pub(super) inputs: Vec<Field>,
    /// Taps and outputs, earliest stage first.
    pub(super) outputs: Vec<Field>,
}

/// A line per field.
pub(super) fn lines(fields: &[Field], line: impl Fn(&Field) -> String) -> String {
    fields.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// A line per field, with its number from 0.
pub(super) fn numbered(fields: &[Field], line: impl Fn(usize, &Field) -> String) -> String {
    fields.iter().enumerate().map(|(index, field)| line(index, field)).collect::<Vec<_>>().join("\n")
}

/// A text for a comment: one line of ASCII, which every tool accepts.
pub(super) fn in_comment(text: &str) -> String {
    text.chars().map(|c| if c == ' ' || c.is_ascii_graphic() { c } else { '?' }).collect()
}

/// Reserved words of SystemVerilog or VHDL that look like the name of a field.
const RESERVED: &str = "\
    abs access after alias all always and architecture array assert assign assume attribute begin bind bit block body break buf buffer \
    bus byte case cell checker class component config configuration constant context continue cover cross default design disable do \
    edge else end entity enum event exit export extern file final first_match for force fork function generate generic global group \
    guarded if impure in inertial initial inout input inside instance int integer interface is label large let library linkage literal \
    local logic loop map matches medium mod new next not null of on open or others out output package parameter port priority process \
    property pure range record register release rem report return select sequence signal small strong table type weak wire";

/// A name in SystemVerilog, VHDL and Python: it begins with a letter, has single underscores between other characters, and is not
/// a reserved word of these languages.
pub(super) fn identifier(name: &str) -> String {
    let parts: Vec<&str> = name.split('_').filter(|part| !part.is_empty()).collect();
    let joined = parts.join("_");
    if joined.starts_with(|c: char| c.is_ascii_lowercase()) && !RESERVED.split(' ').any(|word| word == joined) {
        joined
    } else {
        format!("the_{joined}")
    }
}

/// The name of a field in a structure.
pub(super) fn column(field: &Field) -> String {
    identifier(&field.name)
}

/// Format, port and tap mark, for a comment.
pub(super) fn note(field: &Field) -> String {
    let Field { signed, width, fraction_bits, port, direction, .. } = field;
    let letter = if *signed { 'I' } else { 'U' };
    let whole = i64::from(*width) - i64::from(*fraction_bits);
    let fraction = if *fraction_bits == 0 { String::new() } else { format!("F{fraction_bits}") };
    let tap = if *direction == Direction::Tap { " (tap)" } else { "" };
    format!("{letter}{whole}{fraction}, {port}{tap}")
}
