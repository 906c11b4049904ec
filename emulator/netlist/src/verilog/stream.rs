//! The AXI4-Stream shell: a design of hundreds of ports behind two streams of words.
//!
//! A fragment is a packet of words, its lowest bits first; ports are packed as testbenches pack them, the first one most significant. So a stream of
//! words of 32 bits is the file `inputs.bin` of a testbench, and what comes back is `expected.bin`.

use super::interface::{Interface, PortDescription};
use super::text::{filled, header};
use super::value::literal;

/// Widths of a stream's words, bits.
pub const STREAM_BITS: std::ops::RangeInclusive<u32> = 8..=1024;

fn total(ports: &[PortDescription]) -> u32 {
    ports.iter().map(|port| port.width).sum()
}

/// Connections of ports to bits of a vector, first port most significant.
fn connections(ports: &[PortDescription], vector: &str) -> String {
    let mut above = total(ports);
    let connected = ports.iter().map(|port| {
        let end = above - 1;
        above -= port.width;
        let bits = if port.width == 1 { format!("{vector}[{end}]") } else { format!("{vector}[{end}:{above}]") };
        format!(",\n    .{}({bits})", port.port)
    });
    connected.collect()
}

/// Name and text of the shell around a design, with words of this many bits.
pub(super) fn shell(design: &Interface, width: u32, origin: &str) -> (String, String) {
    let name = format!("{}_axis", design.module);
    let [in_bits, out_bits] = [total(&design.inputs), total(&design.outputs)];
    let [in_words, out_words] = [in_bits.div_ceil(width).max(1), out_bits.div_ceil(width).max(1)];
    let about = [
        format!(
            "AXI4-Stream around {}: a fragment is {in_words} words of {width} bits, its outcome {out_words}.",
            design.module
        ),
        origin.to_owned(),
        "The lowest word comes first. Ports are packed in their order, the first one most significant.".to_owned(),
    ];
    // Counters hold the number of words.
    let [in_count, out_count] = [in_words, out_words].map(|words| words.ilog2());
    let [in_literal, out_literal] = [in_count, out_count].map(|count| move |n: u32| literal(n.into(), count + 1));
    let shifted = if in_words == 1 {
        "s_axis_tdata".to_owned()
    } else {
        "{s_axis_tdata, words[IN_WORDS*WIDTH-1:WIDTH]}".to_owned()
    };
    let pad = out_words * width - out_bits;
    let padded = if pad == 0 { "out_bits".to_owned() } else { format!("{{{}, out_bits}}", literal(0, pad)) };
    let unread = in_words * width - in_bits;
    let unused = if unread == 0 {
        String::new()
    } else {
        format!("\n  // Bits that fill the last word.\n  wire unused = &{{1'b0, words[IN_WORDS*WIDTH-1:{in_bits}]}};\n")
    };
    let values = [
        ("NAME", name.clone()),
        ("MODULE", format!("  {}", design.module)),
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
        ("SHIFTED", shifted),
        ("PADDED", padded),
        ("UNUSED", unused),
        ("CONNECTIONS", connections(&design.inputs, "words") + &connections(&design.outputs, "out_bits")),
    ];
    let text = header(&name, &about) + &filled(include_str!("templates/axis.v"), &values);
    (name, text)
}
