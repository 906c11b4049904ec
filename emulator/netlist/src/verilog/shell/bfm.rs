//! `MODULE_bfm.v`: a module with the ports of the design that drives its shell, so that every testbench of the design runs the shell.

use super::super::interface::{places, total_bits};
use super::super::module::port_list;
use super::super::pipeline::port_lines;
use super::super::text::{filled, header};
use super::super::value::literal;
use super::description::{Shell, padded, slice};
use super::register::ADDRESS_BITS;

/// Values of the registers in the order of their writes, the last one most significant: the take, then constants from the highest offset down.
fn image(shell: &Shell) -> (u32, String) {
    let constants = shell.constants();
    let values = constants.iter().rev().map(|port| padded(&port.port, port.width, 32));
    let parts: Vec<String> = std::iter::once(literal(1, 32)).chain(values).collect();
    (parts.len() as u32, format!("{{{}}}", parts.join(", ")))
}

/// Text of the module.
pub(super) fn text(shell: &Shell) -> String {
    let (design, width) = (&shell.design, shell.stream_bits);
    let streamed = shell.streamed();
    let has_constants = streamed.len() < design.inputs.len();
    let (writes, image) = if has_constants { image(shell) } else { (1, literal(0, 32)) };
    let ports = format!("module {} (\n{});\n", shell.bfm, port_list(&port_lines(&design.inputs, &design.outputs)));
    let names: Vec<&str> = streamed.iter().map(|port| port.port.as_str()).collect();
    let sending = padded(&format!("{{{}}}", names.join(", ")), total_bits(&streamed), shell.input_words * width);
    let outputs = places(&design.outputs);
    let outputs = outputs.map(|(port, low)| format!("  assign {} = {};\n", port.port, slice("got", low, port.width)));
    let got = if shell.output_words == 1 { "m_data" } else { "{m_data, got[OUT_WORDS*WIDTH-1:WIDTH]}" };
    let flag = |value: bool, yes: &str, no: &str| if value { yes.to_owned() } else { no.to_owned() };
    let values = [
        ("PORTS", ports),
        ("WIDTH", width.to_string()),
        ("IN_WORDS", shell.input_words.to_string()),
        ("OUT_WORDS", shell.output_words.to_string()),
        ("WRITES", writes.to_string()),
        ("IMAGE", image),
        ("DIFFERS", flag(has_constants, "image != written", "1'b0")),
        ("FIRST", flag(has_constants, "0", "WRITES")),
        ("HAS_WRITES", flag(has_constants, "1'b1", "1'b0")),
        ("SENDING", sending),
        ("SHIFT", flag(shell.input_words > 1, " else if (s_fire) sending <= sending >> WIDTH;", "")),
        ("OUTPUTS", outputs.collect()),
        ("GOT", got.to_owned()),
        ("SHELL", shell.module.clone()),
        ("ADDRESS_BITS", ADDRESS_BITS.to_string()),
    ];
    let about = [
        format!("The ports of {}, for testbenches: a fragment goes through {}.", design.module, shell.module),
        shell.origin.clone(),
        "Registers are written if a constant differs from that of the fragment before. With +stalls, words have gaps."
            .to_owned(),
    ];
    header(&shell.bfm, &about) + &filled(include_str!("../templates/bfm.v"), &values)
}
