//! The driver in C++, for Verilator.

use super::fields::{Fields, lines};
use crate::field::{Direction, Field};

/// The text, with the name of its file.
pub(super) const TEMPLATES: [(&str, &str); 1] =
    [("@NAME@_main.cpp", include_str!("../../../../vectors/templates/cpp/main.cpp"))];

/// Values for the places in the template.
pub(super) fn values(Fields { inputs, outputs }: &Fields) -> Vec<(&'static str, String)> {
    vec![("CPP_INPUTS", lines(inputs, entry)), ("CPP_OUTPUTS", lines(outputs, entry))]
}

fn entry(field: &Field) -> String {
    let Field { stage, name, lsb, width, signed, fraction_bits, .. } = field;
    let is_tap = field.direction == Direction::Tap;
    format!("    {{\"{stage}\", \"{name}\", {lsb}, {width}, {signed}, {fraction_bits}, {is_tap}}},")
}
