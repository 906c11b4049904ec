//! The top: one instance a run of a stage, registers at their boundaries, delay lines between paths of different length.
//!
//! Rank 0 is the registers of the inputs. A stage starts at the rank at which the last of its inputs is ready, and its outcomes are registered. All
//! outputs leave at the last rank, with their valid bit. One enable moves the whole pipeline.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fmt::Write;

use super::context::{Context, Names};
use super::error::VerilogError;
use super::format::{Format, vector};
use super::interface::{Interface, PortDescription};
use super::module::{Module, port_list};
use super::rom::DELAY;
use super::share::Group;
use super::text::{END, header, identifier};
use super::value::constant_bits;
use crate::graph::{Kind, NodeId, Op};

/// One instance in the pipeline, for the manifest and the header.
#[derive(Clone, Debug, serde::Serialize)]
pub(super) struct Placed {
    instance: String,
    module: String,
    /// Rank of the registers it reads.
    from_rank: u32,
    /// Rank of the registers it drives.
    to_rank: u32,
}

pub(super) struct Top {
    pub(super) text: String,
    pub(super) interface: Interface,
    /// Inputs of the design that no stage reads.
    pub(super) unread: Vec<PortDescription>,
    pub(super) instances: Vec<Placed>,
    pub(super) register_bits: u32,
    pub(super) uses_delay: bool,
}

/// A wire of the top that holds a node at a rank.
struct Signals<'a> {
    context: Context<'a>,
    /// Rank at which a node is in a register.
    ranks: HashMap<NodeId, u32>,
    names: HashMap<NodeId, String>,
    /// Ranks beyond the first at which a node is read.
    later: BTreeMap<NodeId, BTreeSet<u32>>,
}

impl Signals<'_> {
    fn constant(&self, id: NodeId) -> Option<i64> {
        self.context.ranges.of(id).constant()
    }

    fn read(&mut self, id: NodeId, rank: u32) {
        if self.ranks.get(&id).is_some_and(|&made| made < rank) {
            self.later.entry(id).or_default().insert(rank);
        }
    }

    /// Name of a node at a rank.
    fn at(&self, id: NodeId, rank: u32) -> String {
        let name = self.names.get(&id).map_or("", String::as_str);
        let made = self.ranks.get(&id).copied().unwrap_or(rank);
        if rank > made { format!("{name}_d{}", rank - made) } else { name.to_owned() }
    }
}

/// Names that a top has in any case.
pub(super) const TAKEN: [&str; 9] =
    ["clk", "rst", "in_valid", "in_ready", "out_valid", "out_ready", "advance", "valid", "LATENCY"];

/// Input of the top, and the name of its register.
pub(super) fn input(context: Context, names: &mut Names, place: usize) -> (PortDescription, String) {
    let port = &context.net.ports[place];
    // A port is constant only if everything joined with it is; it keeps its declared width for its driver.
    let fraction_bits = context.path_of(port.node).map_or(0, |(_, fraction_bits)| fraction_bits);
    let format = Format::new(context.ranges.of(port.node), fraction_bits, port.kind == Kind::Flag);
    let name = if port.name.is_empty() { "value" } else { &port.name };
    let base = identifier(name);
    let verilog = names.take(&format!("in_{base}_{format}"));
    let signal = names.take(&format!("{base}_{format}"));
    (PortDescription::new(name, &verilog, format, [port.low, port.high], place).declared(&port.path), signal)
}

/// Outputs of the top; a constant has no port.
pub(super) fn outputs(context: Context, names: &mut Names) -> Vec<PortDescription> {
    let net = context.net;
    let mut outputs = Vec::new();
    for (place, output) in net.outputs.iter().enumerate() {
        if net.constant(output).is_some() {
            continue;
        }
        let kind = net.node(output.node).kind;
        let range = context.ranges.of(output.node);
        let format = Format::new(range, output.fraction_bits, kind == Kind::Flag);
        let name = output.output_name();
        let verilog = names.take(&format!("out_{}_{format}", identifier(name)));
        outputs.push(PortDescription::new(name, &verilog, format, [range.low, range.high], place));
    }
    outputs
}

/// Lines of the list of ports of a top, with its handshake.
pub(super) fn port_lines(inputs: &[PortDescription], outputs: &[PortDescription]) -> Vec<(String, String)> {
    let mut lines = handshake_ports();
    for (way, ports) in [("input ", inputs), ("output", outputs)] {
        lines.extend(ports.iter().map(|port| {
            let declared = vector(port.format.width(), port.format.signed());
            (format!("{way} wire {declared}{}", port.port), format!("{}: {}", port.name, port.format.describe()))
        }));
    }
    lines
}

/// Writes the top `name` over the modules of the groups.
pub(super) fn top(
    context: Context,
    name: &str,
    description: &str,
    groups: &[Group],
    modules: &[Module],
) -> Result<Top, VerilogError> {
    let net = context.net;
    let mut names = Names::default();
    for taken in TAKEN {
        names.take(taken);
    }
    let mut inputs = Vec::new();
    let mut signals = Signals { context, ranks: HashMap::new(), names: HashMap::new(), later: BTreeMap::new() };
    for place in 0..net.ports.len() {
        let (input, signal) = input(context, &mut names, place);
        signals.names.insert(net.ports[place].node, signal);
        signals.ranks.insert(net.ports[place].node, 0);
        inputs.push(input);
    }

    // Stages in the order of execution; every input comes from an earlier one.
    let mut runs: Vec<(u32, usize, usize)> = Vec::new();
    for (group, Group { runs: of_group, .. }) in groups.iter().enumerate() {
        runs.extend(of_group.iter().enumerate().map(|(run, of)| (of.stage, group, run)));
    }
    runs.sort_unstable();
    let mut instances = Vec::new();
    let mut read_outside: BTreeSet<NodeId> = net.outputs.iter().map(|output| output.node).collect();
    for &(_, group, run) in &runs {
        read_outside.extend(modules[group].inputs.iter().map(|port| groups[group].runs[run].inputs[port.place]));
    }
    for &(stage, group, run) in &runs {
        let (module, run) = (&modules[group], &groups[group].runs[run]);
        let of = |place: usize| run.inputs[place];
        let ranks = module.inputs.iter().map(|port| signals.ranks.get(&of(port.place)).copied().unwrap_or(0));
        let from_rank = ranks.max().unwrap_or(0);
        for port in &module.inputs {
            signals.read(of(port.place), from_rank);
        }
        let to_rank = from_rank + module.cuts + 1;
        for port in &module.outputs {
            let id = run.nodes[port.place];
            let signal = names.take(&format!("{}_{}", context.signal(id, true), port.format));
            signals.names.insert(id, signal);
            signals.ranks.insert(id, to_rank);
        }
        let instance = net.runs[stage as usize].instance();
        instances.push(Placed { instance, module: module.name.clone(), from_rank, to_rank });
    }
    let nodes = net.outputs.iter().map(|output| output.node);
    let last = nodes.clone().filter_map(|id| signals.ranks.get(&id)).copied().max().unwrap_or(0);
    for id in nodes {
        if signals.constant(id).is_none() {
            signals.read(id, last);
        }
    }
    let outputs = outputs(context, &mut names);

    let is_read = net.ports_read();
    let (inputs, unread): (Vec<_>, Vec<_>) = inputs.into_iter().partition(|port| is_read[port.place]);

    let latency = last + 1;
    let mut text = top_header(context, name, description, latency, &instances);
    text += &format!("module {name} (\n");
    text += &port_list(&port_lines(&inputs, &outputs));
    text += ");\n\n";
    text += &format!(
        "  // Cycles from an accepted input to its output, while out_ready is high.\n  localparam LATENCY = {latency};\n"
    );
    text += &valid_chain(latency);

    let mut register_bits = latency;
    // Rank 0.
    text += "\n  // ---- inputs: rank 0 ----\n";
    let rank_0 = |port: &PortDescription| signals.at(net.ports[port.place].node, 0);
    for port in &inputs {
        register_bits += port.width;
        writeln!(text, "  reg {}{};", vector(port.width, port.signed), rank_0(port))?;
    }
    text += &registers(inputs.iter().map(|port| (rank_0(port), port.port.clone())));
    let mut uses_delay = delays(&mut text, &signals, net.ports.iter().map(|port| port.node), "inputs")?;

    for (&(stage, group, run), placed) in runs.iter().zip(&instances) {
        let (module, run) = (&modules[group], &groups[group].runs[run]);
        let Placed { instance, from_rank, to_rank, .. } = placed;
        writeln!(text, "\n  // ---- {instance}: rank {from_rank} to {to_rank} ----")?;
        let mut connections = Vec::new();
        if module.cuts > 0 {
            connections.push(".clk(clk)".to_owned());
            connections.push(".enable(advance)".to_owned());
            register_bits += module.register_bits;
        }
        for port in &module.inputs {
            connections.push(format!(".{}({})", port.name, signals.at(run.inputs[port.place], *from_rank)));
        }
        let mut moves = Vec::new();
        let mut outcomes = Vec::new();
        for port in &module.outputs {
            let id = run.nodes[port.place];
            let declared = vector(port.format.width(), port.format.signed());
            let signal = signals.at(id, *to_rank);
            if read_outside.contains(&id) {
                writeln!(text, "  wire {declared}{signal}_next;\n  reg {declared}{signal};")?;
                connections.push(format!(".{}({signal}_next)", port.name));
                moves.push((signal.clone(), format!("{signal}_next")));
                register_bits += port.format.width();
                outcomes.push(id);
            } else {
                // A different run of the module needs this outcome, this one does not.
                writeln!(text, "  wire {declared}{signal}_unused;")?;
                connections.push(format!(".{}({signal}_unused)", port.name));
            }
        }
        let connections = connections.join(",\n    ");
        writeln!(text, "  {} u_{instance} (\n    {connections}\n  );", module.name)?;
        text += &registers(moves.into_iter());
        uses_delay |= delays(&mut text, &signals, outcomes.into_iter(), &net.runs[stage as usize].instance())?;
    }
    writeln!(text, "\n  // ---- outputs: rank {last} ----")?;
    for port in &outputs {
        let (output, format) = (&net.outputs[port.place], port.format);
        let value = match signals.constant(output.node) {
            Some(value) => constant_bits(value, format.zeros, format.zeros + format.width()).code,
            None => signals.at(output.node, last),
        };
        writeln!(text, "  assign {} = {value};", port.port)?;
    }
    text += END;
    for (id, ranks) in &signals.later {
        let most = ranks.last().copied().unwrap_or(0);
        register_bits += context.format(*id).width() * (most - signals.ranks.get(id).copied().unwrap_or(most));
    }
    let interface = Interface { module: name.to_owned(), latency, inputs, outputs };
    Ok(Top { text, interface, unread, instances, register_bits, uses_delay })
}

/// Checks that no operation is outside every stage: such an operation of the composer has no module.
pub(super) fn check_blocks(context: Context) -> Result<(), VerilogError> {
    let outside =
        context.net.iter().find(|(_, node)| node.stage.is_none() && !matches!(node.op, Op::Lit(_) | Op::Port(_)));
    match outside {
        Some((id, _)) => Err(VerilogError::OutsideBlocks(context.net.origin(id))),
        None => Ok(()),
    }
}

/// Clock, reset and handshake.
pub(super) fn handshake_ports() -> Vec<(String, String)> {
    [
        ("input  wire clk", ""),
        ("input  wire rst", "synchronous; clears the valid bits, not the data"),
        ("input  wire in_valid", "an input is there"),
        ("output wire in_ready", "it is taken at this edge"),
        ("output wire out_valid", "an output is there"),
        ("input  wire out_ready", "it is taken at this edge; low stalls everything behind it"),
    ]
    .map(|(port, about)| (port.to_owned(), about.to_owned()))
    .to_vec()
}

fn top_header(context: Context, name: &str, description: &str, latency: u32, instances: &[Placed]) -> String {
    let mut about = vec![
        format!("{description}."),
        context.origin.to_owned(),
        String::new(),
        format!("Fully pipelined: one input a cycle, latency {latency} cycles. While out_valid is high and out_ready low"),
        "nothing moves.".into(),
        match context.depth {
            Some(depth) => format!("Registers between stages and inside them: at most {depth} levels of logic between two."),
            None => "Registers between stages only: each stage is one cloud of logic.".into(),
        },
        String::new(),
        "A port is named PATH_FORMAT. Formats: iMfN signed, uMfN unsigned, M integer bits (a sign is one of them) and N".into(),
        "fraction bits, n for a minus sign: value = integer / 2^N. Comments give the integers a wire can hold.".into(),
        String::new(),
        "Ranks of registers:".into(),
    ];
    let width = instances.iter().map(|placed| placed.instance.len()).max().unwrap_or(0);
    for Placed { instance, module, from_rank, to_rank } in instances {
        let of = if module == instance { String::new() } else { format!("  ({module})") };
        about.push(format!("  {instance:width$}  {from_rank:3} to {to_rank:3}{of}"));
    }
    header(name, &about)
}

/// The valid bits and the enable.
fn valid_chain(latency: u32) -> String {
    let next = if latency == 1 { "in_valid".to_owned() } else { "{valid[LATENCY-2:0], in_valid}".to_owned() };
    format!(
        "
  reg  [LATENCY-1:0] valid;
  wire advance = out_ready | ~valid[LATENCY-1];
  assign in_ready  = advance;
  assign out_valid = valid[LATENCY-1];
  always @(posedge clk)
    if (rst) valid <= {{LATENCY{{1'b0}}}};
    else if (advance) valid <= {next};
"
    )
}

fn registers(moves: impl Iterator<Item = (String, String)>) -> String {
    let lines: String = moves.map(|(to, from)| format!("      {to} <= {from};\n")).collect();
    if lines.is_empty() {
        return lines;
    }
    format!("  always @(posedge clk)\n    if (advance) begin\n{lines}    end\n")
}

/// Delay lines of nodes of one stage: one for every pair of ranks, with all its wires.
fn delays(
    text: &mut String,
    signals: &Signals,
    nodes: impl Iterator<Item = NodeId>,
    of: &str,
) -> Result<bool, VerilogError> {
    let mut lines: BTreeMap<(u32, u32), Vec<NodeId>> = BTreeMap::new();
    for id in nodes {
        let Some(ranks) = signals.later.get(&id) else { continue };
        let mut from = signals.ranks.get(&id).copied().unwrap_or(0);
        for &rank in ranks {
            let line = lines.entry((from, rank)).or_default();
            if !line.contains(&id) {
                line.push(id);
            }
            from = rank;
        }
    }
    for ((from, to), ids) in &lines {
        let mut width = 0;
        for &id in ids {
            let format = signals.context.format(id);
            width += format.width();
            writeln!(text, "  wire {}{};", vector(format.width(), format.signed()), signals.at(id, *to))?;
        }
        // Yosys 0.23 does not take a concatenation of one signed wire at a port.
        let list = |rank: u32| {
            let names: Vec<_> = ids.iter().map(|&id| signals.at(id, rank)).collect();
            if let [alone] = &names[..] { alone.clone() } else { format!("{{{}}}", names.join(", ")) }
        };
        writeln!(
            text,
            "  {} #(.WIDTH({width}), .CYCLES({})) delay_{of}_{from}_to_{to} (\n    .clk(clk), .enable(advance),\n    \
             .in({}),\n    .out({})\n  );",
            signals.context.named(DELAY),
            to - from,
            list(*from),
            list(*to)
        )?;
    }
    Ok(!lines.is_empty())
}
