//! Testbenches in SystemVerilog, for Icarus and Verilator, and the testbench that calls the C library by DPI-C.

use roughxel_netlist::verilog::{Interface, PortDescription};

use super::fields::{Fields, column, in_comment, lines, note, numbered};
use crate::c_library::place_name;
use crate::field::{Direction, Field};
use crate::manifest::Manifest;

/// The device, which a user replaces.
pub(super) const DEVICE: &str = "@NAME@_device.sv";

/// The texts, with the name of each file.
pub(super) const TEMPLATES: [(&str, &str); 3] = [
    ("@NAME@_pkg.sv", include_str!("../../../../vectors/templates/systemverilog/pkg.sv")),
    ("@NAME@_tb.sv", include_str!("../../../../vectors/templates/systemverilog/tb.sv")),
    (DEVICE, include_str!("../../../../vectors/templates/systemverilog/device.sv")),
];

/// Testbench of whole datapaths only: the C library has no stages.
pub(super) const DPI: [(&str, &str); 1] =
    [("@NAME@_dpi.sv", include_str!("../../../../vectors/templates/systemverilog/dpi.sv"))];

/// Values for the places in the templates, without those of the device.
pub(super) fn values(fields: &Fields, manifest: &Manifest, stem: &str) -> Vec<(&'static str, String)> {
    let Fields { inputs, outputs } = fields;
    let part = |field: &Field| format!("      word[{} +: {}]", field.lsb, field.width);
    let place_of = |direction, field: &Field| place_name(manifest.datapath, direction, &field.name);
    vec![
        ("DESCRIPTION", in_comment(&manifest.description)),
        ("INPUT_MEMBERS", lines(inputs, member)),
        ("OUTPUT_MEMBERS", lines(outputs, member)),
        ("INPUT_PARTS", lines(inputs, part).replace('\n', ",\n")),
        ("OUTPUT_PARTS", lines(outputs, part).replace('\n', ",\n")),
        ("OUTPUT_PLACES", lines(outputs, place)),
        ("COMPARISONS", lines(outputs, |field| comparison(field, stem))),
        ("INPUTS", inputs.len().to_string()),
        ("KNOBS", roughxel_c::knobs_of(&manifest.profile.knobs).map(|knob| knob.to_string()).join(", ")),
        ("EFFECTS", roughxel_c::bits_of(&manifest.effects).to_string()),
        ("DATAPATH", manifest.datapath.name().into()),
        ("DATAPATH_CAPITALS", manifest.datapath.name().to_ascii_uppercase()),
        ("DRAWN", numbered(inputs, |index, field| drawn(index, field, &place_of("in", field)))),
        ("GIVEN", lines(inputs, |field| given(field, &place_of("in", field)))),
        ("RESULTS", lines(outputs, |field| result(field, &place_of("out", field)))),
        ("SHOWN", lines(inputs, shown)),
    ]
}

/// Values for the places of the device, which connects the generated Verilog or is left for the user to fill in.
///
/// Errors: the Verilog has other ports than the set has fields; the message names them.
pub(super) fn device(
    fields: &Fields,
    manifest: &Manifest,
    module: Option<&Interface>,
) -> Result<Vec<(&'static str, String)>, String> {
    let (purpose, body) = match module {
        Some(top) => {
            let purpose = "Here that is the generated Verilog in rtl; a device of your own takes its place.";
            (purpose, connected(fields, manifest, top)?)
        }
        None => ("To be filled in; until then every output is zero.", blank(fields)),
    };
    Ok(vec![("PURPOSE", purpose.into()), ("BODY", body)])
}

/// The handshake of a device without registers.
const PASSED_THROUGH: &str = "  \
  // This device has no registers; a device with registers delays valid and stops while out_ready is low.
  assign in_ready  = out_ready;
  assign out_valid = in_valid;
";

/// The body of a device for the user to fill in.
fn blank(Fields { inputs, outputs }: &Fields) -> String {
    let first = inputs.iter().find(|field| field.signed);
    let about = first.map_or_else(String::new, |field| {
        let member = format!("inputs.{}", column(field));
        format!(
            " Icarus 11 reads a signed member of a packed structure as unsigned. Products, comparisons, right shifts and\n  \
             // wider wires are then wrong; $signed({member}) is right in every simulator."
        )
    });
    let inputs = lines(inputs, |field| format!("  //   inputs.{}: {}", column(field), note(field)));
    let outputs = lines(outputs, |field| format!("  assign outputs.{} = '0;  // {}", column(field), note(field)));
    format!("{PASSED_THROUGH}\n  // The inputs.{about}\n{inputs}\n\n{outputs}")
}

/// The body that connects the generated top, or the module of a stage: a port for each field, and no other port. Taps that are
/// not in the set stay open.
fn connected(fields: &Fields, manifest: &Manifest, top: &Interface) -> Result<String, String> {
    let inputs = paired(&fields.inputs, &top.inputs)?;
    let (compared, open): (Vec<_>, Vec<_>) = top
        .outputs
        .iter()
        .cloned()
        .partition(|port| manifest.taps || fields.outputs.iter().any(|field| field.port == port.name));
    let outputs = paired(&fields.outputs, &compared)?;
    let wire = |port: &PortDescription| {
        let sign = if port.signed { "signed " } else { "" };
        format!("  wire {sign}[{}:0] {}", port.width - 1, port.port)
    };
    let mut text = String::new();
    for (field, port) in &inputs {
        let of_field = signed(field, &format!("inputs.{}", column(field)));
        let value = shifted(&of_field, field.width, port.width, scale(field, port));
        text += &format!("{} = {value};\n", wire(port));
    }
    for (_, port) in &outputs {
        text += &format!("{};\n", wire(port));
    }
    let ports = inputs.iter().chain(&outputs).map(|(_, port)| port.port.as_str());
    let (instance, handshake) = match manifest.stage {
        Some(_) => ("stage", &[][..]),
        None => ("datapath", &["clk", "rst", "in_valid", "in_ready", "out_valid", "out_ready"][..]),
    };
    if manifest.stage.is_some() {
        text += &format!("\n{PASSED_THROUGH}");
    }
    let connected = handshake.iter().copied().chain(ports).map(|name| format!(".{name}({name})"));
    let connections: Vec<String> = connected.chain(open.iter().map(|port| format!(".{}()", port.port))).collect();
    text += &format!("\n  {} {instance} (\n    {}\n  );\n", top.module, connections.join(",\n    "));
    for (field, port) in &outputs {
        let value = shifted(&port.port, port.width, field.width, -scale(field, port));
        text += &format!("\n  assign outputs.{} = {value};", column(field));
    }
    Ok(text)
}

/// Each port with its field.
fn paired<'a>(
    fields: &'a [Field],
    ports: &'a [PortDescription],
) -> Result<Vec<(&'a Field, &'a PortDescription)>, String> {
    if let Some(field) = fields.iter().find(|field| ports.iter().all(|port| port.name != field.port)) {
        let Field { name, port, .. } = field;
        return Err(format!("field {name} is that of port {port}, which the generated Verilog does not have"));
    }
    let of_port = |port: &'a PortDescription| {
        let field = fields.iter().find(|field| field.port == port.name);
        field
            .map(|field| (field, port))
            .ok_or_else(|| format!("port {} of the generated Verilog has no field in the set", port.name))
    };
    ports.iter().map(of_port).collect()
}

/// Number of zeros that the port has below the field; negative if the field has zeros that the port lacks.
fn scale(field: &Field, port: &PortDescription) -> i64 {
    i64::from(port.fraction_bits) - i64::from(field.fraction_bits) - i64::from(port.dropped_zeros)
}

/// An expression of SystemVerilog times 2^`places`, with `to` bits instead of `from`, with its sign.
fn shifted(expression: &str, from: u32, to: u32, places: i64) -> String {
    // A left shift widens first; a right shift narrows last.
    let sized = |text: String| if from == to { text } else { format!("{to}'({text})") };
    match places {
        0 => sized(expression.into()),
        up @ 1.. => format!("{} <<< {up}", sized(expression.into())),
        down => sized(format!("{expression} >>> {}", -down)),
    }
}

/// An expression of SystemVerilog with the sign of its field; not every tool knows the sign of a member.
fn signed(field: &Field, expression: &str) -> String {
    if field.signed { format!("$signed({expression})") } else { expression.into() }
}

fn member(field: &Field) -> String {
    let sign = if field.signed { "signed " } else { "" };
    format!("    logic {sign}[{}:0] {};  // {}", field.width - 1, column(field), note(field))
}

fn place(field: &Field) -> String {
    format!("    with_outputs[{} +: {}] = outputs.{};", field.lsb, field.width, column(field))
}

fn comparison(field: &Field, stem: &str) -> String {
    let (Field { name, stage, fraction_bits, .. }, column) = (field, column(field));
    let compared = if field.direction == Direction::Tap { "!outputs_only && " } else { "" };
    let [expected, got] = ["expected", "got"].map(|word| {
        let member = format!("{word}.{column}");
        format!("{member}, number(64'({}), {fraction_bits})", signed(field, &member))
    });
    format!(
        "      if ({compared}expected.{column} !== got.{column}) begin\n        compare = compare + 1;\n        if (!silent) \
         $display(\"{stem} #%0d: stage {stage}, field {name}: expected %h = %.10g, got %h = %.10g\", index,\n                 \
         {expected}, {got});\n      end"
    )
}

/// Every second time all fields, else one.
fn drawn(index: usize, field: &Field, place: &str) -> String {
    format!(
        "    if (which == {index} || which >= INPUTS) drawn.{} = {}'(random_input({place}));",
        column(field),
        field.width
    )
}

fn given(field: &Field, place: &str) -> String {
    format!("    given[{place}] = 32'({});", signed(field, &format!("inputs.{}", column(field))))
}

fn result(field: &Field, place: &str) -> String {
    format!("    computed.{} = {}'(results[{place}]);", column(field), field.width)
}

fn shown(field: &Field) -> String {
    format!("    $write(\" {}=%h\", inputs.{});", field.name, column(field))
}
