//! `MODULE_axis.v`: the streams around a design, with its constants as ports.

use super::super::format::vector;
use super::super::interface::total_bits;
use super::super::text::{filled, header};
use super::super::value::literal;
use super::description::{Shell, connections, padded};
use super::register::reset;

/// Ports of constants, after the streams.
fn constant_ports(shell: &Shell) -> String {
    let constants = shell.constants();
    if constants.is_empty() {
        return String::new();
    }
    let ports = constants.iter().map(|port| {
        let declared = format!("{}{}", vector(port.width, port.signed), port.port);
        format!(",\n  input  wire {declared}")
    });
    ",\n  input  wire constants_valid,            // the constants below count from the next fragment on\n  \
     output wire constants_taken"
        .to_owned()
        + &ports.collect::<String>()
}

/// Registers of the constants that the present fragment has.
fn constants(shell: &Shell) -> String {
    let constants = shell.constants();
    if constants.is_empty() {
        return String::new();
    }
    let values: Vec<&str> = constants.iter().map(|port| port.port.as_str()).collect();
    let resets: Vec<String> = constants.iter().map(|port| literal(reset(port).into(), port.width)).collect();
    format!(
        "
  // ---- constants: a fragment takes them with its last word ----
  reg [{}:0] constants;
  assign constants_taken = constants_valid & taken & complete;
  always @(posedge aclk)
    if (!aresetn) constants <= {{{}}};
    else if (constants_taken) constants <= {{{}}};
",
        total_bits(&constants) - 1,
        resets.join(", "),
        values.join(", ")
    )
}

/// Text of the module.
pub(super) fn text(shell: &Shell) -> String {
    let (streamed, width) = (shell.streamed(), shell.stream_bits);
    let [in_bits, out_bits] = [total_bits(&streamed), total_bits(&shell.design.outputs)];
    let [in_words, out_words] = [shell.input_words, shell.output_words];
    let about = [
        format!("AXI4-Stream around {}. {}", shell.design.module, shell.packets()),
        shell.origin.clone(),
        "The lowest word comes first. Ports are packed in their order, the first one most significant.".to_owned(),
    ];
    // Counters hold the number of words.
    let [in_count, out_count] = [in_words, out_words].map(u32::ilog2);
    let [in_literal, out_literal] = [in_count, out_count].map(|count| move |n: u32| literal(n.into(), count + 1));
    let shifted = if in_words == 1 { "s_axis_tdata" } else { "{s_axis_tdata, words[IN_WORDS*WIDTH-1:WIDTH]}" };
    let unused = if in_words * width == in_bits {
        String::new()
    } else {
        format!("\n  // Bits that fill the last word.\n  wire unused = &{{1'b0, words[IN_WORDS*WIDTH-1:{in_bits}]}};\n")
    };
    let (slice, made) = if shell.waits { (include_str!("../templates/axis_wait.v"), "made") } else { ("", "out") };
    let ports = connections(&streamed, "words")
        + &connections(&shell.constants(), "constants")
        + &connections(&shell.design.outputs, &format!("{made}_bits"));
    let values = [
        ("NAME", shell.axis.clone()),
        ("SLICE", slice.to_owned()),
        ("MADE", made.to_owned()),
        ("MODULE", format!("  {}", shell.design.module)),
        ("WIDTH", width.to_string()),
        ("IN_WORDS", in_words.to_string()),
        ("OUT_WORDS", out_words.to_string()),
        ("OUT_BITS", out_bits.to_string()),
        ("IN_COUNT", in_count.to_string()),
        ("OUT_COUNT", out_count.to_string()),
        ("IN_ZERO", in_literal(0)),
        ("IN_ONE", in_literal(1)),
        ("IN_LAST", in_literal(in_words - 1)),
        ("OUT_ZERO", out_literal(0)),
        ("OUT_ONE", out_literal(1)),
        ("OUT_ALL", out_literal(out_words)),
        ("SHIFTED", shifted.to_owned()),
        ("PADDED", padded("out_bits", out_bits, out_words * width)),
        ("SHIFT", (if out_words == 1 { "" } else { "    else if (sent) result <= result >> WIDTH;\n" }).to_owned()),
        ("UNUSED", unused),
        ("CONSTANT_PORTS", constant_ports(shell)),
        ("CONSTANTS", constants(shell)),
        ("CONNECTIONS", ports),
    ];
    header(&shell.axis, &about) + &filled(include_str!("../templates/axis.v"), &values)
}
