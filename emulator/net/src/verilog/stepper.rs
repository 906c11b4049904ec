//! The probe stepper: a small state machine that walks the probes of a footprint through the generated step.
//!
//! It takes a footprint, presents indices 0 … N − 1 to the step, one a cycle, and marks the last. Footprints follow
//! each other without a gap.

use std::fmt::Write;

use super::error::VerilogError;
use super::format::{Format, vector};
use super::interface::{Interface, PortDescription};
use super::module::port_list;
use super::pipeline::{Top, handshake_ports};
use super::rom::DELAY;
use super::text::{END, header};
use super::value::literal;
use crate::interval::Range;

/// The ports that make a design a step.
const INDEX: &str = "index";
const COUNT: &str = "probes.count";
/// Handed on with every probe.
const LOD: &str = "probes.lod";

/// The stepper around a step; `None` where the design is none.
pub(super) fn stepper(top: &Top, origin: &str) -> Result<Option<(Interface, String)>, VerilogError> {
    let step = &top.interface;
    let named = |ports: &[PortDescription], name: &str| ports.iter().find(|port| port.name == name).cloned();
    let input = |name| named(&step.inputs, name);
    // The step has no use for the level of detail, but what reads its probes has.
    let (Some(index), Some(count), Some(lod)) = (input(INDEX), input(COUNT), named(&top.unread, LOD)) else {
        return Ok(None);
    };

    let module = format!("{}_stepper", step.module);
    let mut inputs: Vec<_> = step.inputs.iter().filter(|port| port.name != INDEX).cloned().collect();
    inputs.push(lod.clone());
    let mut outputs = step.outputs.clone();
    let end = outputs.len();
    let lod_name = format!("out_lod_{}", lod.format);
    outputs.push(PortDescription::new("lod", &lod_name, lod.format, [lod.low, lod.high], end));
    let flag = Format::new(Range { low: 0, high: 1, zeros: 0 }, 0, true);
    outputs.push(PortDescription::new("last", "out_last_flag", flag, [0, 1], end + 1));

    let about = [
        format!("State machine around {}: one footprint in, its probes 0 to N - 1 out, one a cycle.", step.module),
        origin.to_owned(),
        format!(
            "The first probe leaves {} cycles after its footprint was taken, while out_ready is high.",
            step.latency + 1
        ),
    ];
    let mut text = header(&module, &about);
    writeln!(text, "module {module} (")?;
    let mut lines = handshake_ports();
    let declared = |port: &PortDescription| format!("{}{}", vector(port.width, port.signed), port.port);
    lines.extend(inputs.iter().map(|port| (format!("input  wire {}", declared(port)), port.name.clone())));
    lines.extend(outputs.iter().map(|port| (format!("output wire {}", declared(port)), port.name.clone())));
    port_list(&mut text, &lines);

    let held = |port: &PortDescription| port.port.replacen("in_", "held_", 1);
    // One bit more than the index, so that its successor is compared.
    let wide = count.width.max(index.width + 1);
    let widened = |name: &str, width: u32| match wide - width {
        0 => name.to_owned(),
        pad => format!("{{{}, {name}}}", literal(0, pad)),
    };
    let (index_bits, index_zero, index_one) =
        (vector(index.width, false), literal(0, index.width), literal(1, index.width));
    write!(
        text,
        ");

  reg busy;
  reg {index_bits}index;
"
    )?;
    for port in &inputs {
        writeln!(text, "  reg {}{};", vector(port.width, port.signed), held(port))?;
    }
    let held_count = held(&count);
    write!(
        text,
        "
  wire step_ready;
  wire step = busy & step_ready;
  wire last = {} + {} == {};
  assign in_ready = ~busy | (step & last);

  always @(posedge clk)
    if (rst) busy <= 1'b0;
    else if (in_ready) busy <= in_valid;

  always @(posedge clk)
    if (in_ready) begin
      index <= {index_zero};
",
        widened("index", index.width),
        literal(1, wide),
        widened(&held_count, count.width),
    )?;
    for port in &inputs {
        writeln!(text, "      {} <= {};", held(port), port.port)?;
    }
    write!(
        text,
        "    end else if (step) begin
      index <= index + {index_one};
    end

  {} u_step (
    .clk(clk),
    .rst(rst),
    .in_valid(busy),
    .in_ready(step_ready),
    .out_valid(out_valid),
    .out_ready(out_ready)",
        step.module
    )?;
    for port in &step.inputs {
        let from = if port.name == INDEX { "index".to_owned() } else { held(port) };
        write!(text, ",\n    .{}({from})", port.port)?;
    }
    for port in &step.outputs {
        write!(text, ",\n    .{}({})", port.port, port.port)?;
    }
    write!(
        text,
        "
  );

  // Beside the step, as long as it takes.
  {DELAY} #(.WIDTH({}), .CYCLES({})) delay_lod_last (
    .clk(clk), .enable(step_ready),
    .in({{{}, last}}),
    .out({{out_lod_{}, out_last_flag}})
  );
{END}",
        lod.width + 1,
        step.latency,
        held(&lod),
        lod.format
    )?;
    let interface = Interface { module, latency: step.latency + 1, inputs, outputs };
    Ok(Some((interface, text)))
}
