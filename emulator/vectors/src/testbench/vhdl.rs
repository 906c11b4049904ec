//! Testbenches in VHDL, for GHDL; the playback also drives VHDL devices under cocotb.

use super::fields::{Fields, column, lines, note};
use crate::field::{Direction, Field};

/// The device, which a user replaces.
pub(super) const DEVICE: &str = "@NAME@_device.vhd";

/// The texts, with the name of each file.
pub(super) const TEMPLATES: [(&str, &str); 4] = [
    ("@NAME@_pkg.vhd", include_str!("../../../../vectors/templates/vhdl/pkg.vhd")),
    ("@NAME@_tb.vhd", include_str!("../../../../vectors/templates/vhdl/tb.vhd")),
    (DEVICE, include_str!("../../../../vectors/templates/vhdl/device.vhd")),
    ("@NAME@_playback.vhd", include_str!("../../../../vectors/templates/vhdl/playback.vhd")),
];

/// Values for the places in the templates.
pub(super) fn values(Fields { inputs, outputs }: &Fields) -> Vec<(&'static str, String)> {
    let assignment = |field: &Field| format!("  outputs.{} <= (others => '0');  -- {}", column(field), note(field));
    vec![
        ("VHDL_INPUT_MEMBERS", lines(inputs, member)),
        ("VHDL_OUTPUT_MEMBERS", lines(outputs, member)),
        ("VHDL_INPUT_PARTS", lines(inputs, part)),
        ("VHDL_OUTPUT_PARTS", lines(outputs, part)),
        ("VHDL_OUTPUT_PLACES", lines(outputs, place)),
        ("VHDL_COMPARISONS", lines(outputs, comparison)),
        ("VHDL_INPUT_LIST", lines(inputs, |field| format!("  --   inputs.{}: {}", column(field), note(field)))),
        ("VHDL_ASSIGNMENTS", lines(outputs, assignment)),
        ("FIRST_OUTPUT", outputs.first().map_or_else(String::new, column)),
    ]
}

fn type_of(field: &Field) -> &'static str {
    if field.signed { "signed" } else { "unsigned" }
}

fn member(field: &Field) -> String {
    format!("    {} : {}({} downto 0);  -- {}", column(field), type_of(field), field.width - 1, note(field))
}

fn part(field: &Field) -> String {
    let (high, low) = (field.lsb + field.width - 1, field.lsb);
    format!("    result.{} := {}(word({high} downto {low}));", column(field), type_of(field))
}

fn place(field: &Field) -> String {
    let (high, low) = (field.lsb + field.width - 1, field.lsb);
    format!("    result({high} downto {low}) := std_ulogic_vector(outputs.{});", column(field))
}

fn comparison(field: &Field) -> String {
    let (Field { name, stage, signed, fraction_bits, .. }, column) = (field, column(field));
    let is_tap = field.direction == Direction::Tap;
    format!(
        "    field(\"{stage}\", \"{name}\", {is_tap}, {signed}, {fraction_bits},\n          \
         std_ulogic_vector(expected.{column}), std_ulogic_vector(got.{column}));"
    )
}
