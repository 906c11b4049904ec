//! The folded top as Verilog: a ring of phases, units with the choice of their operands, glue, and registers between cycles.
//!
//! Register n of a wire is called `NAME_sN`. It takes its value at the end of the phases in which the wire, or register n − 1, has it.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fmt::Write;

use super::super::body::{Body, mask};
use super::super::context::{Context, Names};
use super::super::error::VerilogError;
use super::super::format::vector;
use super::super::interface::Interface;
use super::super::module::{port_list, sink};
use super::super::pipeline::{TAKEN, input, outputs, port_lines};
use super::super::text::{END, header};
use super::super::value::{View, Wire, constant_bits, view_bits};
use super::super::wire::Parts;
use super::compound::{Content, PRODUCT, SUM};
use super::folded::Folded;
use super::schedule::stride;
use super::tasks::{Task, bits_of};
use super::units::{Hardware, UnitKind};
use crate::graph::NodeId;

/// Text of the top, and the facts that its surroundings need.
pub(super) struct Top {
    pub(super) text: String,
    pub(super) interface: Interface,
    pub(super) register_bits: u32,
    pub(super) parts: Parts,
    /// True if a value waits in a ring.
    pub(super) uses_ring: bool,
}

/// Sources of one operand of one unit: text to the phases in which it is read.
pub(super) type Sources = BTreeMap<String, BTreeSet<u32>>;

/// Text under way.
pub(super) struct Writer<'a> {
    pub(super) folded: &'a Folded,
    pub(super) body: Body<'a>,
    /// Assignments of wires.
    pub(super) wires: String,
    parts: Parts,
    /// Sources of the operands: kind, unit, place.
    pub(super) operands: BTreeMap<(usize, u32, usize), Sources>,
    /// Operands that are zero for some use.
    zeros: BTreeSet<(usize, u32, usize)>,
    /// Products that the accumulator of a unit takes, by the phase in which it does.
    pub(super) sums: BTreeMap<(usize, u32), BTreeMap<u32, Term>>,
    /// Outcomes of the units, with the bits that somebody reads.
    pub(super) results: BTreeMap<(usize, u32, usize), (Wire, u128)>,
    pub(super) register_bits: u32,
    pub(super) uses_ring: bool,
}

/// Choice of a value by the phase: an and-or of the sources. It is zero in other phases, if that is `needed` or there are several sources.
fn choice(width: u32, sources: &Sources, needed: bool) -> String {
    if let ([(alone, _)], false) = (&sources.iter().collect::<Vec<_>>()[..], needed) {
        return (*alone).clone();
    }
    let terms = sources.iter().map(|(text, phases)| {
        let at: Vec<String> = phases.iter().map(|phase| format!("phase[{phase}]")).collect();
        let at = if let [alone] = &at[..] { alone.clone() } else { format!("({})", at.join(" | ")) };
        if width == 1 { format!("({at} & {text})") } else { format!("({{{width}{{{at}}}}} & {text})") }
    });
    terms.collect::<Vec<_>>().join("\n    | ")
}

/// Product that an accumulator takes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term {
    /// True if it begins a sum.
    is_first: bool,
    /// True if it is subtracted.
    is_negative: bool,
}

/// Text of the accumulator of a multiplier, whose product has some bits. It holds a sum from its last product to the first one of the next sum.
fn accumulator(name: &str, product_bits: u32, bits: u32, terms: &BTreeMap<u32, Term>) -> String {
    let phases = |of: &str, wanted: fn(&Term) -> bool| {
        let phases = terms.iter().filter(|(_, term)| wanted(term)).map(|(phase, _)| format!("{of}[{phase}]"));
        let phases = phases.collect::<Vec<_>>().join(" | ");
        if phases.is_empty() { "1'b0".to_owned() } else { phases }
    };
    let product = match bits.checked_sub(product_bits) {
        None => format!("{name}_out{PRODUCT}[{}:0]", bits - 1),
        Some(0) => format!("{name}_out{PRODUCT}"),
        Some(above) => {
            format!("{{{{{above}{{{name}_out{PRODUCT}[{}]}}}}, {name}_out{PRODUCT}}}", product_bits - 1)
        }
    };
    format!(
        "  // Sums of products.
  wire {name}_first = {};
  wire {name}_minus = {};
  wire [{bits}:0] {name}_sum =
    {{{name}_out{SUM} & {{{bits}{{~{name}_first}}}}, 1'b1}} + {{{product} ^ {{{bits}{{{name}_minus}}}}, {name}_minus}};
  always @(posedge clk)
    if ({}) {name}_out{SUM} <= {name}_sum[{bits}:1];
",
        phases("phase", |term| term.is_first),
        phases("phase", |term| term.is_negative),
        phases("take", |_| true)
    )
}

impl Writer<'_> {
    fn interval(&self) -> u32 {
        self.folded.schedule.interval
    }

    /// Text of bits of a node as it is read in a cycle.
    fn read(&mut self, id: NodeId, cycle: u32, low: u32, high: u32) -> String {
        self.at(id, cycle);
        self.body.text(id, low, high, 0).code
    }

    /// Makes the text that follows read a node in a cycle.
    fn at(&mut self, id: NodeId, cycle: u32) {
        if let Some(base) = super::tasks::base(&self.body, id) {
            let register = self.folded.schedule.register(&self.folded.shape, base, cycle);
            self.body.registers.insert(base, register);
        }
    }

    fn task(&mut self, task: Task) -> Result<(), VerilogError> {
        let folded = self.folded;
        let cycle = folded.schedule.cycles[&task];
        self.body.registers.clear();
        match task {
            Task::Glue(id) => {
                for &read in &folded.tasks.reads[&task] {
                    self.at(read, cycle);
                }
                let line = self.body.context.line(id).map_or_else(String::new, |line| format!("{line}, "));
                let about = format!(" // {line}cycle {cycle}");
                self.parts.drive(&mut self.wires, &self.body, id, 0, false, &about)?;
            }
            Task::Choice(id) => {
                let wire = self.body.wire(id, 0);
                let apart = stride(self.interval(), folded.shape.copies[id as usize]);
                let mut chosen = Sources::new();
                for (run, &source) in (0..).zip(folded.shape.sources(id)) {
                    let time = cycle + run * apart;
                    let text = self.read(source, time, wire.low, wire.high);
                    chosen.entry(text).or_default().insert(time % self.interval());
                }
                let declared = format!("{}{}", vector(wire.width(), wire.signed), wire.name);
                writeln!(self.wires, "  wire {declared} =\n    {};", choice(wire.width(), &chosen, false))?;
            }
            Task::Use(kind, number) => {
                let of_kind = &folded.kinds[kind];
                let own = &of_kind.uses[number];
                let units = &folded.schedule.bound[&(kind, number)];
                let apart = stride(self.interval(), units.len() as u32);
                let of_zeros = own.inputs.iter().enumerate().filter(|(_, content)| **content == Content::Constant(0));
                for (place, _) in of_zeros {
                    self.zeros.extend(units.iter().map(|&unit| (kind, unit, place)));
                }
                for (place, id) in own.reads() {
                    let (slot, port) = own.port(place);
                    let Some((low, high)) = of_kind.operand(port, self.body.range(id)) else { continue };
                    let cycle = folded.schedule.slot_cycle(task, slot);
                    let text = self.read(id, cycle, low, high);
                    for (run, &unit) in (0..).zip(units) {
                        let phase = (cycle + run * apart) % self.interval();
                        let sources = self.operands.entry((kind, unit, port)).or_default();
                        sources.entry(text.clone()).or_default().insert(phase);
                    }
                }
                self.outcomes(kind, number, units)?;
            }
        }
        Ok(())
    }

    /// Wires of the outcomes of a use.
    fn outcomes(&mut self, kind: usize, number: usize, units: &[u32]) -> Result<(), VerilogError> {
        let folded = self.folded;
        let of_kind = &folded.kinds[kind];
        let own = &of_kind.uses[number];
        let task = Task::Use(kind, number);
        let cycle = folded.schedule.last_slot(task) + of_kind.latency_of(own);
        let apart = stride(self.interval(), units.len() as u32);
        for (run, &unit) in (0..).zip(units) {
            for (slot, &is_negative) in own.signs.iter().enumerate() {
                // The product is there when the accumulator takes it.
                let made = folded.schedule.slot_cycle(task, slot) + of_kind.latency() + run * apart;
                let is_first = folded.schedule.slot_cycle(task, slot) == folded.schedule.cycles[&task];
                let term = Term { is_first, is_negative };
                let phase = made % self.interval();
                self.sums.entry((kind, unit)).or_default().insert(phase, term);
            }
        }
        for (place, range, id) in of_kind.outcomes(own) {
            if bits_of(&self.body, id).is_none() {
                continue;
            }
            let wire = self.body.wire(id, 0);
            let mut sources = Sources::new();
            for (run, &unit) in (0..).zip(units) {
                let name = format!("{}_{unit}_out{place}", of_kind.name);
                let unit_wire = match of_kind.hardware {
                    Hardware::Multiplier { widths: [a, b], sum_bits } => {
                        // The products of a sum have as many.
                        let operands = own.reads().take(2);
                        let zeros: u32 = operands.map(|(_, id)| self.body.range(id).zeros.min(62)).sum();
                        let bits = if place == SUM { sum_bits } else { a + b };
                        Wire { name, low: zeros, high: zeros + bits, signed: true }
                    }
                    Hardware::Module(_) => Wire { name, low: range.zeros, high: range.top(), signed: range.signed() },
                };
                let text = view_bits(&View::of(id), &unit_wire, wire.low, wire.high).code;
                let (first, end) = (unit_wire.low, unit_wire.high);
                let read = mask(wire.low.max(first), wire.high.min(end)) >> first;
                // Bits above the highest one are its copies.
                let sign = if wire.high > end { 1 << (end - 1 - first) } else { 0 };
                let plain = Wire { low: 0, high: end - first, ..unit_wire };
                self.results.entry((kind, unit, place)).or_insert((plain, 0)).1 |= read | sign;
                sources.entry(text).or_default().insert((cycle + run * apart) % self.interval());
            }
            let declared = format!("{}{}", vector(wire.width(), wire.signed), wire.name);
            let name = folded.shape.net.origin(own.first());
            writeln!(
                self.wires,
                "  wire {declared} =\n    {}; // {name}, cycle {cycle}",
                choice(wire.width(), &sources, false)
            )?;
        }
        Ok(())
    }

    /// Units with the registers of their operands.
    fn units(&mut self) -> Result<(String, String), VerilogError> {
        let folded = self.folded;
        let (mut declared, mut text) = (String::new(), String::new());
        for (kind, of_kind) in folded.kinds.iter().enumerate() {
            for unit in 0..folded.schedule.units[kind] {
                let name = format!("{}_{unit}", of_kind.name);
                let mut connections = vec![".clk(clk)".to_owned(), ".enable(advance)".to_owned()];
                let mut choices = String::new();
                let mut used = false;
                for place in 0..of_kind.ports() {
                    let Some((width, signed)) = of_kind.port(place) else { continue };
                    let Some(sources) = self.operands.get(&(kind, unit, place)) else {
                        if let Hardware::Module(module) = &of_kind.hardware {
                            let port = module.inputs.iter().find(|port| port.place == place);
                            connections.extend(port.map(|port| format!(".{}({width}'d0)", port.name)));
                        }
                        continue;
                    };
                    used = true;
                    let value = choice(width, sources, self.zeros.contains(&(kind, unit, place)));
                    match &of_kind.hardware {
                        Hardware::Multiplier { .. } => {
                            let port = ["a", "b"][place];
                            writeln!(choices, "  wire {}{name}_{port} =\n    {value};", vector(width, true))?;
                            connections.push(format!(".{port}({name}_{port})"));
                        }
                        Hardware::Module(module) => {
                            let Some(port) = module.inputs.iter().find(|port| port.place == place) else { continue };
                            writeln!(choices, "  reg {}{name}_in{place};", vector(width, signed))?;
                            writeln!(
                                choices,
                                "  always @(posedge clk)\n    if (advance) {name}_in{place} <=\n    {value};"
                            )?;
                            connections.push(format!(".{}({name}_in{place})", port.name));
                            self.register_bits += width;
                        }
                    }
                }
                if !used {
                    continue;
                }
                text += &choices;
                match &of_kind.hardware {
                    Hardware::Multiplier { widths: [a, b], sum_bits } => {
                        writeln!(declared, "  wire {}{name}_out{PRODUCT};", vector(a + b, true))?;
                        connections.push(format!(".product({name}_out{PRODUCT})"));
                        let connections = connections.join(", ");
                        writeln!(text, "  {} #(.A({a}), .B({b})) u_{name} ({connections});", of_kind.name)?;
                        self.register_bits += 2 * (a + b);
                        if let Some(terms) = self.sums.get(&(kind, unit)) {
                            writeln!(declared, "  reg {}{name}_out{SUM};", vector(*sum_bits, true))?;
                            text += &accumulator(&name, a + b, *sum_bits, terms);
                            self.register_bits += sum_bits;
                            let wire = |place: usize, bits: u32| Wire {
                                name: format!("{name}_out{place}"),
                                low: 0,
                                high: bits,
                                signed: true,
                            };
                            for (place, bits) in [(PRODUCT, a + b), (SUM, *sum_bits)] {
                                let read = mask(0, bits.min(*sum_bits));
                                let result = self.results.entry((kind, unit, place)).or_insert((wire(place, bits), 0));
                                result.1 |= read;
                            }
                        }
                    }
                    Hardware::Module(module) => {
                        if module.cuts == 0 {
                            connections.drain(..2);
                        }
                        self.register_bits += module.register_bits;
                        let mut moves = String::new();
                        for port in &module.outputs {
                            let (width, place) = (port.format.width(), port.place);
                            let vector = vector(width, port.format.signed());
                            writeln!(declared, "  reg {vector}{name}_out{place};")?;
                            writeln!(text, "  wire {vector}{name}_next{place};")?;
                            connections.push(format!(".{}({name}_next{place})", port.name));
                            writeln!(moves, "      {name}_out{place} <= {name}_next{place};")?;
                            self.register_bits += width;
                        }
                        let connections = connections.join(",\n    ");
                        writeln!(text, "  {} u_{name} (\n    {connections}\n  );", module.name)?;
                        writeln!(text, "  always @(posedge clk)\n    if (advance) begin\n{moves}    end")?;
                    }
                }
            }
        }
        Ok((declared, text))
    }
}

impl UnitKind {
    /// Bits of a use's operand that a unit takes, given the operand's range; `None` if the hardware has no such port.
    fn operand(&self, place: usize, range: crate::interval::Range) -> Option<(u32, u32)> {
        match &self.hardware {
            Hardware::Multiplier { widths, .. } => {
                let low = range.zeros.min(62);
                Some((low, low + widths[place]))
            }
            Hardware::Module(module) => {
                let port = module.inputs.iter().find(|port| port.place == place)?;
                Some((port.format.zeros, port.format.zeros + port.format.width()))
            }
        }
    }

    /// Number of ports for operands.
    fn ports(&self) -> usize {
        match self.hardware {
            Hardware::Multiplier { .. } => 2,
            Hardware::Module(_) => self.uses[0].inputs.len(),
        }
    }

    /// Width and sign of an operand's port.
    fn port(&self, place: usize) -> Option<(u32, bool)> {
        match &self.hardware {
            Hardware::Multiplier { widths, .. } => Some((widths[place], true)),
            Hardware::Module(module) => {
                let port = module.inputs.iter().find(|port| port.place == place)?;
                Some((port.format.width(), port.format.signed()))
            }
        }
    }
}

/// Signals of the phases, declared before anything uses them, and the text of the next phase. What moves in a cycle is decided a cycle before, so that
/// no other port's signal is on its way; a design that takes an input each cycle has no cycle before.
fn control(interval: u32, end: u32) -> [String; 2] {
    if interval == 1 {
        let signals = "  wire advance = out_ready | ~full;
  wire [INTERVAL-1:0] take = phase & advance;
  wire [INTERVAL-1:0] next = phase;
";
        return [signals.into(), String::new()];
    }
    let signals = "  reg  advance;
  // Phases in which registers take values.
  reg  [INTERVAL-1:0] take;
  wire [INTERVAL-1:0] next = advance ? {phase[INTERVAL-2:0], phase[INTERVAL-1]} : phase;
";
    let moves = format!(
        "  wire advances = ~rst & ~(next[{end}] & is_full);
  always @(posedge clk) begin
    advance <= advances;
    take <= next & {{INTERVAL{{advances}}}};
  end
"
    );
    [signals.into(), moves]
}

/// Writes the folded top. `flat` is the context of the design as it is not folded, which gives the ports.
pub(super) fn top(
    folded: &Folded,
    body: Body,
    flat: Context,
    name: &str,
    description: &str,
) -> Result<Top, VerilogError> {
    let mut names = Names::default();
    for taken in TAKEN.into_iter().chain(["phase", "next", "take", "full", "INTERVAL"]) {
        names.take(taken);
    }
    let is_read = flat.net.ports_read();
    let mut inputs = Vec::new();
    let mut wire_names: HashMap<NodeId, String> = HashMap::new();
    for place in 0..flat.net.ports.len() {
        let (port, signal) = input(flat, &mut names, place);
        wire_names.insert(folded.shape.net.ports[place].node, signal);
        inputs.push(port);
    }
    let outputs = outputs(flat, &mut names);
    inputs.retain(|port| is_read[port.place]);
    let mut body = body;
    let mut number = 0;
    for id in 0..folded.shape.net.nodes.len() as NodeId {
        if body.reads.contains_key(&id) && !wire_names.contains_key(&id) {
            wire_names.insert(id, names.take(&folded.wire_name(id, number)));
            number += 1;
        }
    }
    body.names = wire_names;
    let mut writer = Writer {
        folded,
        body,
        wires: String::new(),
        parts: Parts::default(),
        operands: BTreeMap::new(),
        zeros: BTreeSet::new(),
        sums: BTreeMap::new(),
        results: BTreeMap::new(),
        register_bits: 0,
        uses_ring: false,
    };
    let mut stage = None;
    for &task in &folded.tasks.all {
        let own = folded.tasks.makes[&task].first().and_then(|&id| folded.shape.net.node(id).stage);
        if own.is_some() && own != stage {
            stage = own;
            let instance = own.map_or_else(String::new, |run| folded.shape.net.runs[run as usize].instance());
            writeln!(writer.wires, "\n  // ---- {instance} ----")?;
        }
        writer.task(task)?;
    }
    let interval = folded.schedule.interval;
    let last = folded.schedule.last;
    writer.body.registers.clear();
    let (mut held, mut moves, mut ends) = (String::new(), String::new(), String::new());
    for port in &outputs {
        let id = folded.shape.net.outputs[port.place].node;
        let (low, high) = (port.format.zeros, port.format.zeros + port.format.width());
        let text = match folded.shape.ranges.of(id).constant() {
            Some(value) => constant_bits(value, low, high).code,
            None => writer.read(id, last, low, high),
        };
        let register = names.take(&format!("{}_held", port.port));
        writeln!(held, "  reg {}{register};", vector(port.format.width(), port.format.signed()))?;
        writeln!(moves, "      {register} <= {text};")?;
        writeln!(ends, "  assign {} = {register};", port.port)?;
        writer.register_bits += port.format.width();
    }
    let end = last % interval;
    let always = writer.registers(&inputs)?;
    let (declared, units) = writer.units()?;
    let latency = folded.latency();
    let stages = last / interval + 1;
    let about = vec![
        format!("{description}."),
        flat.origin.to_owned(),
        String::new(),
        format!("Folded: one input every {interval} cycles, latency {latency} cycles. An outcome is held until it is taken; if it is still"),
        "there when the next one comes, nothing moves.".into(),
        String::new(),
        "A port is named PATH_FORMAT. Formats: iMfN signed, uMfN unsigned, M integer bits (a sign is one of them) and N".into(),
        "fraction bits, n for a minus sign: value = integer / 2^N. Comments give the integers a wire can hold.".into(),
        String::new(),
        "Units:".into(),
    ];
    let units_used = folded.kinds.iter().zip(&folded.schedule.units);
    let units_about =
        units_used.map(|(kind, units)| format!("  {units} x {}, {} uses", kind.name, kind.slots(&folded.shape)));
    let about: Vec<String> = about.into_iter().chain(units_about).collect();
    let mut text = header(name, &about);
    text += &format!("module {name} (\n{});\n\n", port_list(&port_lines(&inputs, &outputs)));
    let [signals, moves_on] = control(interval, end);
    let valid = if stages == 1 { "taken".to_owned() } else { "{valid[STAGES-2:0], taken}".to_owned() };
    writeln!(
        text,
        "  // Cycles between two inputs, and how many fragments are under way.
  localparam INTERVAL = {interval};
  localparam STAGES = {stages};

  // One bit a phase; fragments begin in the first one.
  reg  [INTERVAL-1:0] phase;
  reg  [STAGES-1:0] valid;
  // An outcome waits.
  reg  full;
{signals}  assign out_valid = full;
  assign in_ready = take[INTERVAL-1];
  wire taken = in_valid;
  wire is_full = (full & ~out_ready) | (take[{end}] & valid[STAGES-1]);
{moves_on}
  always @(posedge clk)
    if (rst) begin
      phase <= {};
      valid <= {{STAGES{{1'b0}}}};
      full <= 1'b0;
    end else begin
      phase <= next;
      full <= is_full;
      if (take[INTERVAL-1]) valid <= {valid};
    end
",
        if interval == 1 { "1'b1" } else { "{{(INTERVAL-1){1'b0}}, 1'b1}" },
    )?;
    text += &declared;
    text += &writer.wires;
    writeln!(text, "\n  // ---- registers ----")?;
    text += &always;
    writeln!(text, "\n  // ---- units ----")?;
    text += &units;
    writeln!(text, "\n  // ---- outputs ----")?;
    writeln!(text, "{held}  always @(posedge clk)\n    if (take[{end}]) begin\n{moves}    end\n{ends}")?;
    let unused = writer.unused(&inputs);
    if !unused.is_empty() {
        writeln!(text, "\n  // Bits nobody reads.")?;
        text += &sink("unused", &unused);
    }
    text += END;
    let register_bits = writer.register_bits + 2 * interval + stages + 2;
    let interface = Interface { module: name.to_owned(), latency, inputs, outputs };
    Ok(Top { text, interface, register_bits, parts: writer.parts, uses_ring: writer.uses_ring })
}
