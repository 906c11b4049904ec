//! The header of the C library and its SystemVerilog package, made of the layouts' columns and the library's declarations.

use std::ffi::CStr;

use roughxel_c::{EFFECTS, ERROR_BITS, ERRORS, EffectBit, VERSION};
use roughxel_core::knob::Knob;
use roughxel_core::plan::Datapath;
use roughxel_netlist::verilog::filled;

use super::field::Direction;
use super::format::{Declared, declared, number_format};

/// `roughxel.h` and `roughxel_dpi.sv`.
pub fn c_library_files() -> [(&'static str, String); 2] {
    let structures: Vec<Structure> = Datapath::ALL.into_iter().flat_map(Structure::inputs_and_outputs).collect();
    [("roughxel.h", header(&structures)), ("roughxel_dpi.sv", package(&structures))]
}

/// The inputs or outputs of a datapath.
struct Structure {
    datapath: Datapath,
    is_input: bool,
    members: Vec<Declared>,
}

impl Structure {
    fn inputs_and_outputs(datapath: Datapath) -> [Self; 2] {
        let (inputs, outputs) =
            declared(datapath).partition(|declared| declared.column.field.direction == Direction::In);
        [(true, inputs), (false, outputs)].map(|(is_input, members)| Self { datapath, is_input, members })
    }

    /// `reflection_in`.
    fn name(&self) -> String {
        format!("{}_{}", self.datapath.name(), if self.is_input { "in" } else { "out" })
    }
}

/// Format and range of a column, as a line of a comment.
fn note(declared: &Declared) -> String {
    let format = number_format(&declared.column).replace('*', "").replace('−', "-");
    let missing = match (declared.exists, declared.footprint) {
        (false, _) => ", never read",
        (true, Some(_)) | (true, None) => "",
    };
    format!("{format}, {}{missing}", range(declared))
}

/// Range of a column, in units of 1.
fn range(declared: &Declared) -> String {
    let ((low, high), fraction) = (declared.column.port_limits, declared.column.port_fraction);
    let unit = 1_i64 << fraction;
    // Declared ranges begin and end at whole numbers; the upper end is included, or the last number below it.
    if high % unit == 0 {
        format!("{} to {}", low / unit, high / unit)
    } else {
        format!("{} to below {}", low / unit, high / unit + 1)
    }
}

/// Description of a declared field in one line: text, unit, stage.
fn explained(declared: &Declared) -> String {
    let field = &declared.column.field;
    let unit = if field.unit == "1" { String::new() } else { format!(" [{}]", field.unit) };
    let stage = match field.direction {
        Direction::In => String::new(),
        Direction::Tap => format!(" (tap, stage {})", field.stage),
        Direction::Out | Direction::Check => format!(" (stage {})", field.stage),
    };
    let footprint =
        declared.footprint.map_or_else(String::new, |footprint| format!("; {}", footprint.replace('`', "")));
    format!("{}{unit}{stage}{footprint}", declared.column.text.replace('`', ""))
}

/// A name in capitals.
fn capitals(name: &str) -> String {
    name.replace('.', "_").to_ascii_uppercase()
}

/// The name of a field's index in the package: `REFLECTION_IN_NORMAL_X`; the direction is `in` or `out`.
pub(super) fn place_name(datapath: Datapath, direction: &str, field: &str) -> String {
    capitals(&format!("{}_{direction}_{field}", datapath.name()))
}

/// A knob as a member, and its range.
fn knob_member(knob: Knob) -> (String, String) {
    let values: Vec<String> =
        knob.choices().iter().enumerate().map(|(value, name)| format!("{value} {name}")).collect();
    let range = match (values.is_empty(), knob) {
        (false, _) => values.join(", "),
        (true, Knob::Direction) => "0 exact, or steps of a table: 2 to 64, an even number".into(),
        (true, _) => knob.range().into(),
    };
    (knob.name().replace('.', "_"), range)
}

/// A line for each item.
fn lines<T>(all: impl IntoIterator<Item = T>, line: impl FnMut(T) -> String) -> String {
    all.into_iter().map(line).collect::<Vec<_>>().join("\n")
}

/// The functions of the datapaths, by a template of one.
fn functions(template: &str) -> String {
    let names = Datapath::ALL.map(|datapath| [("NAME", datapath.name().into()), ("LARGE", capitals(datapath.name()))]);
    names.map(|names| filled(template, &names)).join("\n").trim_end().into()
}

fn header(structures: &[Structure]) -> String {
    let error = |(number, (name, meaning)): (usize, &(&str, &CStr))| {
        format!("#define ROUGHXEL_{name} {number} /* {} */", meaning.to_string_lossy())
    };
    let effect = |EffectBit { name, bit, description }| format!("#define ROUGHXEL_{name} {bit}u /* {description} */");
    let knob = |(name, range)| format!("  int32_t {name}; /* {range} */");
    let values = [
        ("VERSION", VERSION.to_string()),
        ("ERRORS", lines(ERRORS.iter().enumerate(), error)),
        ("ERROR_BITS", ERROR_BITS.to_string()),
        ("ERROR_MASK", ((1 << ERROR_BITS) - 1).to_string()),
        ("EFFECTS", lines(EFFECTS, effect)),
        ("KNOBS", lines(Knob::ALL.map(knob_member), knob)),
        ("STRUCTURES", lines(structures, c_structure).trim_end().into()),
        ("DATAPATHS", functions(include_str!("../../../vectors/templates/c/datapath.h"))),
    ];
    filled(include_str!("../../../vectors/templates/c/roughxel.h"), &values)
}

/// A structure of C, and its members for a macro.
fn c_structure(structure: &Structure) -> String {
    let (name, Structure { datapath, members, .. }) = (structure.name(), structure);
    let mut last = "";
    let lines = members.iter().map(|member| {
        let column = &member.column;
        // A comment for all columns of a declared field.
        let declared = column.declared.split('[').next().unwrap_or_default();
        let is_first = declared != std::mem::replace(&mut last, declared);
        let comment = if is_first { format!("  /* {} */\n", explained(member)) } else { String::new() };
        format!("{comment}  int32_t {}; /* {} */", column.field.name, note(member))
    });
    let values = [
        ("WHAT", if structure.is_input { "What goes into" } else { "What comes out of" }.into()),
        ("DATAPATH", datapath.name().into()),
        ("LARGE", capitals(&name)),
        ("NAME", name),
        ("MEMBERS", lines.collect::<Vec<_>>().join("\n")),
        ("PLACES", members.iter().map(|member| format!(" \\\n  X({})", member.column.field.name)).collect()),
    ];
    filled(include_str!("../../../vectors/templates/c/structure.h"), &values)
}

fn package(structures: &[Structure]) -> String {
    let error = |(number, (name, meaning)): (usize, &(&str, &CStr))| {
        format!("  localparam int {name} = {number};  // {}", meaning.to_string_lossy())
    };
    let effect =
        |EffectBit { name, bit, description }| format!("  localparam int unsigned {name} = {bit};  // {description}");
    let knobs = sv_places("profile", "knob", &Knob::ALL.map(knob_member));
    let places = |structure: &Structure| {
        let member = |member: &Declared| (member.column.field.name.clone(), note(member));
        let (name, members) = (structure.name(), structure.members.iter().map(member).collect::<Vec<_>>());
        sv_places(&name, &name, &members)
    };
    let values = [
        ("VERSION", VERSION.to_string()),
        ("ERRORS", lines(ERRORS.iter().enumerate(), error)),
        ("ERROR_BITS", ERROR_BITS.to_string()),
        ("EFFECTS", lines(EFFECTS, effect)),
        ("STRUCTURES", [knobs, lines(structures, places)].join("\n").trim_end().into()),
        ("DATAPATHS", functions(include_str!("../../../vectors/templates/systemverilog/datapath.sv"))),
    ];
    filled(include_str!("../../../vectors/templates/systemverilog/library.sv"), &values)
}

/// The indices of an array, and its type.
fn sv_places(name: &str, prefix: &str, members: &[(String, String)]) -> String {
    let last = members.len() - 1;
    let places = members.iter().enumerate().map(|(place, (member, note))| {
        let comma = if place == last { "" } else { "," };
        format!("    {}{comma}  // {note}\n", capitals(&format!("{prefix}_{member}")))
    });
    format!(
        "  typedef enum int {{\n{}  }} {prefix}_e;\n  localparam int {} = {};\n  typedef int {name}_t [{}];\n",
        places.collect::<String>(),
        capitals(name),
        members.len(),
        capitals(name)
    )
}
