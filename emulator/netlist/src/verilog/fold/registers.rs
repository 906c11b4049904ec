//! Registers of the folded top: what waits from one cycle to a later one, in registers or in rings of small memories.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::super::error::VerilogError;
use super::super::format::vector;
use super::super::interface::PortDescription;
use super::super::module::unread;
use super::super::value::{View, Wire, view_bits};
use super::compound::SUM;
use super::shape::Join;
use super::text::Writer;
use super::units::Hardware;
use crate::graph::{NodeId, Op};

/// Name of the module of a ring without a prefix.
pub(super) const RING: &str = "roughxel_ring";

/// Least bits of a ring that is worth a block memory.
const BLOCK_BITS: u32 = 40;

/// Enable of a register that takes its value at the end of some phases.
fn enable(phases: &[u32]) -> String {
    let at: Vec<String> = phases.iter().map(|phase| format!("take[{phase}]")).collect();
    at.join(" | ")
}

impl Writer<'_> {
    /// Registers that a ring replaces: the last one that is read before them, and the last of all.
    fn ring(&self, id: NodeId) -> Option<(u32, u32)> {
        let folded = self.folded;
        if !self.body.context.target.has_small_memories() || folded.shape.copies[id as usize] > 1 {
            return None;
        }
        let mut numbers = self.body.reads.get(&id)?.keys().rev().copied();
        let last = numbers.next()?;
        let is_kept = folded.schedule.made.get(&id).is_some_and(|made| made.kept);
        let first = numbers.next().unwrap_or(0).max(u32::from(is_kept));
        (last >= first + 2).then_some((first, last))
    }

    /// Rings: one for each phase and depth, with all its wires.
    fn rings(&mut self, waiting: BTreeMap<(u32, u32), Vec<(Wire, String)>>) -> Result<String, VerilogError> {
        let mut text = String::new();
        for ((phase, depth), wires) in waiting {
            let width: u32 = wires.iter().map(|(wire, _)| wire.width()).sum();
            let joined = |names: Vec<&str>| {
                if let [alone] = names[..] { alone.to_owned() } else { format!("{{{}}}", names.join(", ")) }
            };
            let ins = joined(wires.iter().map(|(_, source)| source.as_str()).collect());
            let outs = joined(wires.iter().map(|(wire, _)| wire.name.as_str()).collect());
            let places = (depth - 1).ilog2() + 1;
            self.register_bits += places;
            let block = u32::from(width >= BLOCK_BITS);
            writeln!(
                text,
                "  {} #(.WIDTH({width}), .DEPTH({depth}), .PLACES({places}), .BLOCK({block})) u_ring_{phase}_{depth} (\n    \
                 .clk(clk), .rst(rst), .enable(take[{phase}]),\n    .in({ins}),\n    .out({outs})\n  );",
                self.body.context.named(RING)
            )?;
        }
        Ok(text)
    }

    /// Registers of every wire that is read later, and of what is kept.
    pub(super) fn registers(&mut self, inputs: &[PortDescription]) -> Result<String, VerilogError> {
        let folded = self.folded;
        let mut declared = String::new();
        let mut moves: BTreeMap<Vec<u32>, String> = BTreeMap::new();
        let mut taken = String::new();
        let mut waiting: BTreeMap<(u32, u32), Vec<(Wire, String)>> = BTreeMap::new();
        let mut ids: Vec<NodeId> = self.body.reads.keys().copied().collect();
        ids.sort_unstable();
        self.body.registers.clear();
        for id in ids {
            let ring = self.ring(id);
            if let Some((first, last)) = ring {
                let to = self.body.wire(id, last);
                writeln!(declared, "  wire {}{};", vector(to.width(), to.signed), to.name)?;
                let phase = folded.schedule.phases(&folded.shape, id, first + 1)[0];
                let source = self.body.wire(id, first).slice(to.low, to.high);
                waiting.entry((phase, last - first)).or_default().push((to, source));
            }
            let last = self.body.reads[&id].keys().copied().max().unwrap_or(0);
            for number in 1..=ring.map_or(last, |(first, _)| first) {
                let to = self.body.wire(id, number);
                let source = match (folded.shape.joins.get(&id), self.body.op(id), number) {
                    (Some(Join::Outcome { of, .. }), _, 1) => self.body.text(*of, to.low, to.high, 0).code,
                    (None, Op::Port(place), 1) => {
                        let port = inputs.iter().find(|port| port.place == place as usize);
                        let Some(PortDescription { port, format, .. }) = port else { continue };
                        let (low, high) = (format.zeros, format.zeros + format.width());
                        let wire = Wire { name: port.clone(), low, high, signed: format.signed() };
                        view_bits(&View::of(id), &wire, to.low, to.high).code
                    }
                    _ => self.body.wire(id, number - 1).slice(to.low, to.high),
                };
                writeln!(declared, "  reg {}{};", vector(to.width(), to.signed), to.name)?;
                self.register_bits += to.width();
                if number == 1 && matches!(self.body.op(id), Op::Port(_)) && !folded.shape.joins.contains_key(&id) {
                    writeln!(taken, "      {} <= {source};", to.name)?;
                    continue;
                }
                let phases = folded.schedule.phases(&folded.shape, id, number);
                writeln!(moves.entry(phases).or_default(), "      {} <= {source};", to.name)?;
            }
        }
        self.wires = format!("{declared}\n{}", self.wires);
        let mut always =
            format!("  // A fragment is taken.\n  always @(posedge clk)\n    if (in_ready) begin\n{taken}    end\n");
        for (phases, moves) in moves {
            let enable = enable(&phases);
            writeln!(always, "  always @(posedge clk)\n    if ({enable}) begin\n{moves}    end")?;
        }
        self.uses_ring = !waiting.is_empty();
        always += &self.rings(waiting)?;
        Ok(always)
    }

    /// True if a unit has this outcome: it has operands, and an accumulator for a sum.
    fn has_outcome(&self, kind: usize, unit: u32, place: usize) -> bool {
        let is_sum = matches!(self.folded.kinds[kind].hardware, Hardware::Multiplier { .. }) && place == SUM;
        !is_sum && self.operands.range((kind, unit, 0)..(kind, unit + 1, 0)).next().is_some()
    }

    /// Bits of inputs, wires and registers that nobody reads.
    pub(super) fn unused(&self, inputs: &[PortDescription]) -> Vec<String> {
        let mut parts = Vec::new();
        for port in inputs {
            let id = self.folded.shape.net.ports[port.place].node;
            let (low, high) = (port.format.zeros, port.format.zeros + port.format.width());
            let wire = Wire { name: port.port.clone(), low, high, signed: port.format.signed() };
            parts.extend(unread(&wire, self.body.reads_from(id, 1)));
        }
        for (kind, of_kind) in self.folded.kinds.iter().enumerate() {
            for unit in 0..self.folded.schedule.units[kind] {
                for &(place, _) in &of_kind.outputs {
                    match self.results.get(&(kind, unit, place)) {
                        Some((wire, reads)) => parts.extend(unread(wire, *reads as u64)),
                        None if self.has_outcome(kind, unit, place) => {
                            parts.push(format!("{}_{unit}_out{place}", of_kind.name));
                        }
                        None => {}
                    }
                }
            }
        }
        // The lowest bit of an accumulator's adder brings its carry.
        parts.extend(self.sums.keys().map(|&(kind, unit)| format!("{}_{unit}_sum[0]", self.folded.kinds[kind].name)));
        let mut ids: Vec<NodeId> = self.body.reads.keys().copied().collect();
        ids.sort_unstable();
        for id in ids {
            let is_kept = self.folded.schedule.made.get(&id).is_some_and(|made| made.kept);
            let last = self.body.reads[&id].keys().copied().max().unwrap_or(0);
            let numbers = (u32::from(is_kept)..=last)
                .filter(|&number| self.ring(id).is_none_or(|(first, last)| number <= first || number == last));
            for number in numbers {
                parts.extend(unread(&self.body.wire(id, number), self.body.reads_from(id, number)));
            }
        }
        parts
    }
}
