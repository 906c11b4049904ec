//! The probe stepper: a small state machine that steps through the probes of a footprint with the generated step.
//!
//! It takes a footprint, presents indices 0 … N − 1 to the step, one a cycle, and marks the last. Footprints follow each other without a gap.

use super::context::Context;
use super::format::{Format, vector};
use super::interface::{Interface, PortDescription};
use super::module::port_list;
use super::pipeline::handshake_ports;
use super::rom::DELAY;
use super::text::{filled, header};
use super::value::literal;
use crate::interval::Range;

/// Ports that make a design a step.
const INDEX: &str = "index";
const COUNT: &str = "probes.count";
/// Output of a stepper that marks the last probe of a footprint.
pub(super) const LAST: &str = "last";
/// Port that accompanies every probe.
const LOD: &str = "probes.lod";

/// Stepper around a step with this many outputs, ports or not; `None` if the design is no step.
pub(super) fn stepper(
    step: &Interface,
    unread: &[PortDescription],
    end: usize,
    context: Context,
) -> Option<(Interface, String)> {
    let named = |ports: &[PortDescription], name: &str| ports.iter().find(|port| port.name == name).cloned();
    let input = |name| named(&step.inputs, name);
    // The step does not read the level of detail, but the reader of its probes does.
    let (Some(index), Some(count), Some(lod)) = (input(INDEX), input(COUNT), named(unread, LOD)) else {
        return None;
    };

    let module = format!("{}_stepper", step.module);
    let mut inputs: Vec<_> = step.inputs.iter().filter(|port| port.name != INDEX).cloned().collect();
    inputs.push(lod.clone());
    let mut outputs = step.outputs.clone();
    let lod_name = format!("out_lod_{}", lod.format);
    outputs.push(PortDescription::new("lod", &lod_name, lod.format, [lod.low, lod.high], end));
    let flag = Format::new(Range { low: 0, high: 1, zeros: 0 }, 0, true);
    outputs.push(PortDescription::new(LAST, "out_last_flag", flag, [0, 1], end + 1));

    let about = [
        format!("State machine around {}: one footprint in, its probes 0 to N - 1 out, one a cycle.", step.module),
        context.origin.to_owned(),
        format!(
            "The first probe leaves {} cycles after its footprint was taken, while out_ready is high.",
            step.latency + 1
        ),
    ];
    let mut lines = handshake_ports();
    let declared = |port: &PortDescription| format!("{}{}", vector(port.width, port.signed), port.port);
    lines.extend(inputs.iter().map(|port| (format!("input  wire {}", declared(port)), port.name.clone())));
    lines.extend(outputs.iter().map(|port| (format!("output wire {}", declared(port)), port.name.clone())));

    let held = |port: &PortDescription| port.port.replacen("in_", "held_", 1);
    // One bit more than the index, so that its successor is compared.
    let wide = count.width.max(index.width + 1);
    let widened = |name: &str, width: u32| match wide - width {
        0 => name.to_owned(),
        pad => format!("{{{}, {name}}}", literal(0, pad)),
    };
    let register = |port: &PortDescription| format!("  reg {}{};\n", vector(port.width, port.signed), held(port));
    let taken = |port: &PortDescription| format!("      {} <= {};\n", held(port), port.port);
    let from = |port: &PortDescription| if port.name == INDEX { "index".to_owned() } else { held(port) };
    let connected = step.inputs.iter().map(|port| (&port.port, from(port)));
    let connected = connected.chain(step.outputs.iter().map(|port| (&port.port, port.port.clone())));
    let values = [
        ("MODULE", module.clone()),
        ("DELAY", context.named(DELAY)),
        ("PORTS", port_list(&lines)),
        ("INDEX_BITS", vector(index.width, false)),
        ("HELD", inputs.iter().map(register).collect()),
        ("INDEX", widened("index", index.width)),
        ("ONE", literal(1, wide)),
        ("COUNT", widened(&held(&count), count.width)),
        ("INDEX_ZERO", literal(0, index.width)),
        ("TAKEN", inputs.iter().map(taken).collect()),
        ("INDEX_ONE", literal(1, index.width)),
        ("STEP", step.module.clone()),
        ("CONNECTIONS", connected.map(|(port, wire)| format!(",\n    .{port}({wire})")).collect()),
        ("LOD_WIDTH", (lod.width + 1).to_string()),
        ("LATENCY", step.latency.to_string()),
        ("LOD", held(&lod)),
        ("OUT_LOD", lod_name),
    ];
    let text = header(&module, &about) + &filled(include_str!("templates/stepper.v"), &values);
    let interface = Interface { module, latency: step.latency + 1, inputs, outputs };
    Some((interface, text))
}
