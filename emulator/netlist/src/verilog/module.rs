//! One stage of the datapath as a module.
//!
//! A wire has the bits that its range needs and that somebody reads. An adder whose lowest bits only round drops them in place (`{sum, sum_unused} =
//! …`), and a claim drops the bits that its lemma excludes. With a target depth each operation is placed at the earliest rank at which its operands
//! are ready; registers hold the bits that later ranks read.

use std::fmt::Write;
use std::path::Path;

use super::body::{Body, mask};
use super::context::{Context, Names};
use super::driver::Driver;
use super::error::VerilogError;
use super::format::{Format, vector};
use super::share::Group;
use super::text::{END, header, identifier};
use super::value::Wire;
use super::wire::Parts;
use crate::graph::{NodeId, Op, Tap};
use crate::target::Target;

/// A port of a module, named for the first run.
#[derive(Clone, Debug)]
pub(super) struct ModulePort {
    /// Place among the nodes (an output) or the inputs (an input) of a run.
    pub(super) place: usize,
    /// Name in the module.
    pub(super) name: String,
    pub(super) format: Format,
}

/// Text of a stage, and the facts that its surroundings need.
#[derive(Clone, Debug)]
pub(super) struct Module {
    pub(super) name: String,
    pub(super) text: String,
    pub(super) inputs: Vec<ModulePort>,
    pub(super) outputs: Vec<ModulePort>,
    /// Number of register ranks inside.
    pub(super) cuts: u32,
    /// Bits of those registers.
    pub(super) register_bits: u32,
    /// Modules that it has instances of.
    pub(super) parts: Parts,
}

/// Names of a group's inputs: the common part of the runs' names for them, made unique.
fn input_names(context: &Context, group: &Group, inputs: &[usize], names: &mut Names) -> Vec<String> {
    let name = |place: usize, with_run: bool| -> String {
        let of = |run: usize| context.signal(group.runs[run].inputs[place], with_run);
        let mut common: Vec<String> = of(0).split('_').map(str::to_owned).collect();
        for run in 1..group.runs.len() {
            let other = of(run);
            let other: Vec<&str> = other.split('_').collect();
            if other.len() == common.len() {
                let both = common.iter().zip(other);
                common = both.map(|(a, b)| if a == b { a.clone() } else { String::new() }).collect();
            }
        }
        common.retain(|part| !part.is_empty());
        let format = context.format(group.runs[0].inputs[place]);
        format!("{}_{format}", common.join("_"))
    };
    let short: Vec<String> = inputs.iter().map(|&place| name(place, false)).collect();
    let unique = |i: usize| short.iter().filter(|other| **other == short[i]).count() == 1;
    let chosen =
        inputs.iter().enumerate().map(|(i, &place)| if unique(i) { short[i].clone() } else { name(place, true) });
    chosen.map(|name| names.take(&name)).collect()
}

/// Name of an outcome in its module: the path, or the last part of the stage's name. The latter is a prefix of a path that starts with a digit.
fn output_name(context: &Context, id: NodeId) -> String {
    let path = identifier(context.path_of(id).map_or("", |(path, _)| path));
    let stage = context.net.node(id).stage.map_or("", |stage| context.net.runs[stage as usize].name);
    let own = stage.rsplit('.').next().unwrap_or(stage);
    let name = match path.chars().next() {
        None => own.to_owned(),
        Some(first) if first.is_ascii_digit() => format!("{own}_{path}"),
        Some(_) => path,
    };
    format!("{name}_{}", context.format(id))
}

impl Module {
    /// Writes the module of a group. `leaves` returns true if any run's node is read outside its stage.
    pub(super) fn new(context: Context, group: &Group, leaves: impl Fn(NodeId) -> bool) -> Result<Self, VerilogError> {
        let first = &group.runs[0];
        let net = context.net;
        let fixed = |id: NodeId| context.ranges.of(id).constant().is_some();
        let inputs: Vec<usize> = (0..first.inputs.len()).filter(|&place| !fixed(first.inputs[place])).collect();
        let input_ids: Vec<NodeId> = inputs.iter().map(|&place| first.inputs[place]).collect();
        let tapped = net.taps.iter().filter(|tap| tap.stage == Some(first.stage));
        let mut outputs: Vec<usize> = Vec::new();
        for tap in tapped {
            let Some(place) = first.nodes.iter().position(|&id| id == tap.node) else { continue };
            let leaves = group.runs.iter().any(|run| leaves(run.nodes[place]));
            if leaves && !fixed(tap.node) && !outputs.contains(&place) {
                outputs.push(place);
            }
        }

        let output_ids: Vec<NodeId> = outputs.iter().map(|&place| first.nodes[place]).collect();
        let mut body = Body::new(context, &first.nodes, &input_ids, &output_ids)?;

        let mut names = Names::default();
        for taken in ["clk", "enable", "unused"] {
            names.take(taken);
        }
        let inputs: Vec<ModulePort> = input_names(&context, group, &inputs, &mut names)
            .into_iter()
            .zip(inputs)
            .map(|(name, place)| ModulePort { place, name, format: context.format(first.inputs[place]) })
            .collect();
        let outputs: Vec<ModulePort> = outputs
            .into_iter()
            .map(|place| {
                let name = names.take(&output_name(&context, first.nodes[place]));
                ModulePort { place, name, format: context.format(first.nodes[place]) }
            })
            .collect();
        let mut module = Self {
            name: context.named(&group.name),
            text: String::new(),
            inputs,
            outputs,
            cuts: body.last_rank,
            register_bits: 0,
            parts: Parts::default(),
        };
        module.name_wires(&mut body, group, &mut names);
        module.write(&body, group)?;
        Ok(module)
    }

    fn name_wires(&self, body: &mut Body, group: &Group, names: &mut Names) {
        let (net, first) = (body.context.net, &group.runs[0]);
        for port in &self.inputs {
            body.names.insert(first.inputs[port.place], port.name.clone());
        }
        for port in &self.outputs {
            let id = first.nodes[port.place];
            // An outcome that is made at the last rank is its port.
            if body.ranks.get(&id) == Some(&body.last_rank) {
                body.names.insert(id, port.name.clone());
            }
        }
        let mut number = 0;
        for &id in &first.nodes {
            if !body.reads.contains_key(&id) || body.names.contains_key(&id) {
                continue;
            }
            let tapped = net.taps.iter().any(|tap| tap.node == id && tap.stage == Some(first.stage));
            let name = if tapped {
                names.take(&format!("{}_tap", output_name(&body.context, id)))
            } else {
                let kind = match body.driver(id) {
                    Driver::IsZero(_) => "is_zero",
                    Driver::IsNotZero(_) => "is_not_zero",
                    Driver::Op(op) => op.name(),
                };
                names.take(&format!("n{number}_{kind}"))
            };
            number += 1;
            body.names.insert(id, name);
        }
    }

    fn write(&mut self, body: &Body, group: &Group) -> Result<(), VerilogError> {
        let context = body.context;
        let first = &group.runs[0];
        let mut wires = String::new();
        let mut unused: Vec<String> = Vec::new();
        for port in &self.inputs {
            let id = first.inputs[port.place];
            let wire = body.wire(id, 0);
            unused.extend(unread(&wire, body.reads_from(id, 0)));
        }
        for rank in 0..=body.last_rank {
            if body.last_rank > 0 {
                writeln!(wires, "\n  // ---- rank {rank} ----")?;
            }
            let mut line = None;
            for &id in &first.nodes {
                if body.ranks.get(&id) != Some(&rank) || !body.reads.contains_key(&id) {
                    continue;
                }
                let own = context.line(id);
                if own.is_some() && line != own {
                    writeln!(wires, "\n  // {}", own.as_deref().unwrap_or_default())?;
                    line = own;
                }
                self.wire(&mut wires, body, group, id, rank)?;
                unused.extend(unread(&body.wire(id, rank), body.reads_from(id, rank)));
            }
            if rank < body.last_rank {
                unused.extend(self.registers(&mut wires, body, &first.nodes, rank)?);
            }
        }
        let assigned: Vec<&ModulePort> =
            self.outputs.iter().filter(|port| body.names.get(&first.nodes[port.place]) != Some(&port.name)).collect();
        if !assigned.is_empty() {
            writeln!(wires)?;
        }
        for port in assigned {
            let text = body.text(first.nodes[port.place], port.format.zeros, port.format.range.top(), body.last_rank);
            writeln!(wires, "  assign {} = {};", port.name, text.code)?;
        }
        if !unused.is_empty() {
            writeln!(wires, "\n  // Bits nobody reads.")?;
            wires.push_str(&sink("unused", &unused));
        }
        self.text = self.frame(body, group, &wires)?;
        Ok(())
    }

    /// Header, ports and end around the wires.
    fn frame(&self, body: &Body, group: &Group, wires: &str) -> Result<String, VerilogError> {
        let context = body.context;
        let net = context.net;
        let first = &group.runs[0];
        let stage = &net.runs[first.stage as usize];
        let files = first.nodes.iter().map(|&id| net.node(id).at.file());
        let mut sources: Vec<&str> = files.filter(|file| Path::new(file).is_relative()).collect();
        sources.sort_unstable();
        sources.dedup();
        let runs: Vec<String> = group.runs.iter().map(|run| net.runs[run.stage as usize].instance()).collect();
        let mut about = vec![
            format!("Stage {}: {}", stage.name, summary(stage.name)),
            format!("Source: {}", sources.join(", ")),
            format!("Instances: {}", runs.join(", ")),
            context.origin.to_owned(),
        ];
        match (context.depth, self.cuts) {
            (None, _) => about.push("Combinational.".into()),
            (Some(depth), 0) => about.push(format!("Combinational, at most {depth} levels.")),
            (Some(depth), cuts) => about.push(format!(
                "Pipelined: outcomes follow their inputs by {cuts} cycles with enable high, at most {depth} levels each."
            )),
        }
        let mut text = header(&self.name, &about);
        writeln!(text, "module {} (", self.name)?;
        let mut lines: Vec<(String, String)> = Vec::new();
        if self.cuts > 0 {
            lines.push(("input  wire clk".into(), String::new()));
            lines.push(("input  wire enable".into(), String::new()));
        }
        for port in &self.inputs {
            let declared = vector(port.format.width(), port.format.signed());
            lines.push((format!("input  wire {declared}{}", port.name), port.format.describe()));
        }
        for port in &self.outputs {
            let declared = vector(port.format.width(), port.format.signed());
            let id = first.nodes[port.place];
            let (path, _) = context.path_of(id).unwrap_or_default();
            let path = if path.is_empty() { stage.name } else { path };
            lines.push((format!("output wire {declared}{}", port.name), context.about(id, path)));
        }
        text += &port_list(&lines);
        text.push_str(");\n");
        text.push_str(wires);
        text.push_str(END);
        Ok(text)
    }

    /// Declares and drives the wire of a node.
    fn wire(
        &mut self,
        text: &mut String,
        body: &Body,
        group: &Group,
        id: NodeId,
        rank: u32,
    ) -> Result<(), VerilogError> {
        let context = body.context;
        let wire = body.wire(id, rank);
        let is_port = self.outputs.iter().any(|port| port.name == wire.name);
        let about = if is_port {
            String::new()
        } else {
            let own = |tap: &&Tap| tap.node == id && tap.stage == Some(group.runs[0].stage);
            let tap = context.net.taps.iter().find(own);
            tap.map_or_else(String::new, |tap| format!(" // tap {}", context.about(id, &tap.name)))
        };
        self.parts.drive(text, body, id, rank, is_port, &about)
    }

    /// Registers from a rank to the next: all earlier values that are still read. Names the bits that nobody reads.
    fn registers(
        &mut self,
        text: &mut String,
        body: &Body,
        nodes: &[NodeId],
        rank: u32,
    ) -> Result<Vec<String>, VerilogError> {
        let inputs = body.names.keys().filter(|id| !nodes.contains(id));
        let mut inputs: Vec<NodeId> = inputs.copied().collect();
        inputs.sort_unstable();
        let carried: Vec<NodeId> = inputs
            .into_iter()
            .chain(nodes.iter().copied())
            .filter(|id| body.ranks.get(id).is_some_and(|&made| made <= rank))
            .filter(|&id| body.reads_from(id, rank + 1) != 0)
            .collect();
        writeln!(text)?;
        let mut moves = String::new();
        let mut unused = Vec::new();
        for id in carried {
            let (from, to) = (body.wire(id, rank), body.wire(id, rank + 1));
            // Yosys 0.23 to 0.70 lose a product whose register iCE40's DSP blocks take together with an adder.
            let is_taken = rank == body.ranks[&id] && matches!(body.op(id), Op::Mul(..));
            let keep = if is_taken && body.context.target == Target::Ice40 { "(* keep *) " } else { "" };
            writeln!(text, "  {keep}reg {}{};", vector(to.width(), to.signed), to.name)?;
            writeln!(moves, "      {} <= {};", to.name, from.slice(to.low, to.high))?;
            self.register_bits += to.width();
            unused.extend(unread(&to, body.reads_from(id, rank + 1)));
        }
        writeln!(text, "  always @(posedge clk)\n    if (enable) begin\n{moves}    end")?;
        Ok(unused)
    }
}

/// Ranges of bits of a wire that are not read.
pub(super) fn unread(wire: &Wire, reads: u64) -> Vec<String> {
    let missing = mask(wire.low, wire.high) as u64 & !reads;
    let mut parts = Vec::new();
    let mut from = wire.low;
    while from < wire.high {
        if missing >> from & 1 == 0 {
            from += 1;
            continue;
        }
        let upto = (from..wire.high).find(|bit| missing >> bit & 1 == 0).unwrap_or(wire.high);
        parts.push(wire.slice(from, upto));
        from = upto;
    }
    parts.reverse();
    parts
}

/// Wire that reads the unread bits, so that a linter knows they are meant.
pub(super) fn sink(name: &str, unread: &[String]) -> String {
    let mut text = format!("  wire {name} = &{{1'b0");
    let mut column = text.len();
    for wire in unread {
        text.push(',');
        column += wire.len() + 2;
        if column > 110 {
            text += "\n    ";
            column = wire.len() + 4;
        } else {
            text.push(' ');
        }
        text += wire;
    }
    text + "};\n"
}

/// Lines of a list of ports, comments in a column.
pub(super) fn port_list(lines: &[(String, String)]) -> String {
    let column = lines.iter().map(|(port, _)| port.len()).max().unwrap_or(0).min(60) + 1;
    let line = |(index, (port, about)): (usize, &(String, String))| {
        let comma = if index + 1 < lines.len() { "," } else { "" };
        let line = format!("{port}{comma}");
        if about.is_empty() { format!("  {line}\n") } else { format!("  {line:column$} // {about}\n") }
    };
    lines.iter().enumerate().map(line).collect()
}

/// Short description of a stage: that of its own name, or of the part before the dot.
fn summary(stage: &str) -> &'static str {
    let lines = || include_str!("stages.txt").lines().filter_map(|line| line.split_once(' '));
    let of = |name: &str| lines().find(|(known, _)| *known == name).map(|(_, text)| text.trim_start());
    of(stage).or_else(|| of(stage.split('.').next()?)).unwrap_or("a stage of the datapath")
}
