//! The header of the C library and its SystemVerilog package, made of the layouts' columns and of what the library declares.

use std::fmt::Write;

use roughxel_c::{EFFECTS, ERROR_BITS, ERRORS, VERSION};
use roughxel_core::knob::Knob;
use roughxel_core::plan::Datapath;

use super::format::{Declared, declared, number_format};
use super::layout::Direction;

/// `roughxel.h` and `roughxel_dpi.sv`.
pub fn c_library_files() -> [(&'static str, String); 2] {
    let structures: Vec<Structure> = Datapath::ALL.into_iter().flat_map(Structure::of).collect();
    [("roughxel.h", header(&structures)), ("roughxel_dpi.sv", package(&structures))]
}

/// What goes into a datapath, or what comes out.
struct Structure {
    datapath: Datapath,
    is_input: bool,
    members: Vec<Declared>,
}

impl Structure {
    fn of(datapath: Datapath) -> [Self; 2] {
        let (inputs, outputs) =
            declared(datapath).partition(|declared| declared.column.field.direction == Direction::In);
        [(true, inputs), (false, outputs)].map(|(is_input, members)| Self { datapath, is_input, members })
    }

    /// `reflection_in`.
    fn name(&self) -> String {
        format!("{}_{}", self.datapath.name(), if self.is_input { "in" } else { "out" })
    }
}

/// A column that is a line of a comment: format and range.
fn note(declared: &Declared) -> String {
    let format = number_format(&declared.column).replace('*', "").replace('−', "-");
    let missing = match (declared.exists, declared.footprint) {
        (false, _) => ", never read",
        (true, Some(_)) | (true, None) => "",
    };
    format!("{format}, {}{missing}", range(declared))
}

/// What it may be, in units of 1.
fn range(declared: &Declared) -> String {
    let ((low, high), fraction) = (declared.column.port_limits, declared.column.port_fraction);
    let unit = 1_i64 << fraction;
    // Declared ranges begin and end at whole numbers, the upper end among them or the last number below it.
    if high % unit == 0 {
        format!("{} to {}", low / unit, high / unit)
    } else {
        format!("{} to below {}", low / unit, high / unit + 1)
    }
}

/// What a declared field is, in one line: text, unit, stage.
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

/// The name of the place of a field in the package: `REFLECTION_IN_NORMAL_X`; the direction is `in` or `out`.
pub(super) fn place_name(datapath: Datapath, direction: &str, field: &str) -> String {
    capitals(&format!("{}_{direction}_{field}", datapath.name()))
}

/// A knob as a member, and what it may be.
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

const HEADER: &str = "\
/* The scalar datapaths of roughxel: what a device has to compute, to the bit.
 *
 * `roughxel vectors c` writes this file; vectors/README.md says how the library is built, vectors/SPEC.md what it computes.
 *
 * A member of a structure is a field of a vector word, with its name, in its order: the integer that the profile keeps, over
 * 2^fraction bits (vectors/FORMAT.md). Beside each stand its format and its range: I signed, U unsigned, bits before the point,
 * F fraction bits; p is fraction_bits of the profile, l its lod_bits. The value of a mantissa is times 2^e. Inputs that the effects
 * leave out are not read, outcomes that they leave out are constants. What is read has to be in its range all the same: 0 always is.
 *
 * Every function returns ROUGHXEL_OK or an error, and then writes nothing: its kind in the lowest ROUGHXEL_ERROR_BITS bits, and
 * above them the place of the member or knob that is wrong, from 0. No function keeps state, allocates or ends the program; all may
 * be called from any thread. What is written may not overlap what is read. */

#ifndef ROUGHXEL_H
#define ROUGHXEL_H

#include <stdint.h>

#ifdef __cplusplus
extern \"C\" {
#endif

";

fn header(structures: &[Structure]) -> String {
    let mut text = HEADER.to_owned();
    let _ = writeln!(
        text,
        "/* Of this header; roughxel_version() is that of the library. */\n#define ROUGHXEL_VERSION {VERSION}\n"
    );
    for (number, (name, meaning)) in ERRORS.iter().enumerate() {
        let _ = writeln!(text, "#define ROUGHXEL_{name} {number} /* {} */", meaning.to_string_lossy());
    }
    let _ = writeln!(
        text,
        "#define ROUGHXEL_ERROR_BITS {ERROR_BITS}\n#define ROUGHXEL_ERROR_KIND(error) ((error) & {})\n\
         #define ROUGHXEL_ERROR_PLACE(error) ((error) >> {ERROR_BITS})\n\n\
         /* Effects that are on, a sum of: */",
        (1 << ERROR_BITS) - 1
    );
    for (name, bit, meaning) in EFFECTS {
        let _ = writeln!(text, "#define ROUGHXEL_{name} {bit}u /* {meaning} */");
    }
    text += "\n/* The accuracy. */\ntypedef struct roughxel_profile {\n";
    for knob in Knob::ALL {
        let (name, range) = knob_member(knob);
        let _ = writeln!(text, "  int32_t {name}; /* {range} */");
    }
    text += "} roughxel_profile;\n";
    for structure in structures {
        text += &c_structure(structure);
    }
    text += "
/* ROUGHXEL_VERSION of the library. */
int32_t roughxel_version(void);
/* What an error is: one line, never freed. */
const char *roughxel_error_text(int32_t error);
/* The knobs of the profile narrow, paper, compact, standard or precise. Errors: NULL, PROFILE. */
int32_t roughxel_profile_named(const char *name, roughxel_profile *profile);
";
    for datapath in Datapath::ALL {
        let name = datapath.name();
        let _ = write!(
            text,
            "
/* The {name} datapath. Errors: NULL, KNOB, EFFECTS, INPUT. Effects that it does not have change nothing. */
int32_t roughxel_{name}(const roughxel_profile *profile, uint32_t effects,
                        const roughxel_{name}_in *inputs, roughxel_{name}_out *outputs);
/* The lowest and the highest number of each of its inputs. Errors: NULL, KNOB. */
int32_t roughxel_{name}_input_range(const roughxel_profile *profile,
                                    roughxel_{name}_in *low, roughxel_{name}_in *high);
"
        );
    }
    text += "\n#ifdef __cplusplus\n}\n#endif\n\n#endif\n";
    text
}

/// A structure of C, and its members for a macro.
fn c_structure(structure: &Structure) -> String {
    let (name, Structure { datapath, members, .. }) = (structure.name(), structure);
    let what = if structure.is_input { "What goes into" } else { "What comes out of" };
    let mut text = format!("\n/* {what} the {} datapath. */\ntypedef struct roughxel_{name} {{\n", datapath.name());
    let mut last = "";
    for member in members {
        let column = &member.column;
        // A comment for all columns of a declared field.
        let declared = column.declared.split('[').next().unwrap_or_default();
        if declared != last {
            let _ = writeln!(text, "  /* {} */", explained(member));
            last = declared;
        }
        let _ = writeln!(text, "  int32_t {}; /* {} */", column.field.name, note(member));
    }
    let _ = writeln!(text, "}} roughxel_{name};");
    let names: String = members.iter().map(|member| format!(" \\\n  X({})", member.column.field.name)).collect();
    let _ =
        write!(text, "/* X(member) for each, in order. */\n#define ROUGHXEL_{}_MEMBERS(X){names}\n", capitals(&name));
    text
}

const PACKAGE: &str = "\
// roughxel_dpi: the scalar datapaths of roughxel as functions of SystemVerilog, by DPI-C from the C library.
//
// `roughxel vectors c` writes this file; roughxel.h beside it says what every number is, vectors/README.md how the library is built
// and linked. Structures of the header are arrays of int here, their members places with names. Every function returns OK or an
// error: its kind in the lowest ERROR_BITS bits, above them the place of the number that is wrong. With an error what it would have
// written means nothing.

package roughxel_dpi;

";

fn package(structures: &[Structure]) -> String {
    let mut text = PACKAGE.to_owned();
    let _ = writeln!(
        text,
        "  // Of this package; roughxel_version() is that of the library.\n  localparam int VERSION = {VERSION};\n"
    );
    for (number, (name, meaning)) in ERRORS.iter().enumerate() {
        let _ = writeln!(text, "  localparam int {name} = {number};  // {}", meaning.to_string_lossy());
    }
    let _ = writeln!(text, "  localparam int ERROR_BITS = {ERROR_BITS};\n\n  // Effects that are on, a sum of:");
    for (name, bit, meaning) in EFFECTS {
        let _ = writeln!(text, "  localparam int unsigned {name} = {bit};  // {meaning}");
    }
    let knobs: Vec<_> = Knob::ALL.into_iter().map(knob_member).collect();
    text += &sv_places("profile", "knob", &knobs);
    for structure in structures {
        let members: Vec<_> =
            structure.members.iter().map(|member| (member.column.field.name.clone(), note(member))).collect();
        let name = structure.name();
        text += &sv_places(&name, &name, &members);
    }
    text += "
  import \"DPI-C\" function int roughxel_version();
  import \"DPI-C\" function string roughxel_error_text(input int error);
  import \"DPI-C\" function int roughxel_profile_named(input string name, output int profile [PROFILE]);
";
    for datapath in Datapath::ALL {
        let (name, large) = (datapath.name(), capitals(datapath.name()));
        let _ = write!(
            text,
            "
  import \"DPI-C\" function int roughxel_{name}(input int profile [PROFILE], input int unsigned effects,
    input int inputs [{large}_IN], output int outputs [{large}_OUT]);
  import \"DPI-C\" function int roughxel_{name}_input_range(input int profile [PROFILE],
    output int low [{large}_IN], output int high [{large}_IN]);
"
        );
    }
    text += include_str!("../../../vectors/templates/systemverilog/random.sv");
    text += "\nendpackage\n";
    text
}

/// The places of an array, and its type.
fn sv_places(name: &str, prefix: &str, members: &[(String, String)]) -> String {
    let last = members.len() - 1;
    let places = members.iter().enumerate().map(|(place, (member, note))| {
        let comma = if place == last { "" } else { "," };
        format!("    {}{comma}  // {note}\n", capitals(&format!("{prefix}_{member}")))
    });
    format!(
        "\n  typedef enum int {{\n{}  }} {prefix}_e;\n  localparam int {} = {};\n  typedef int {name}_t [{}];\n",
        places.collect::<String>(),
        capitals(name),
        members.len(),
        capitals(name)
    )
}
