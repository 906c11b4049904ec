//! Binding: which unit does an operation, and which operand of a product comes first.
//!
//! Units that are taken in one phase can change places, and the operands of a product, too. Each wire that a unit reads at an input costs as many
//! choices as it has bits, however often it is read. The binding is improved until no exchange of two operations saves anything.

use std::collections::HashMap;

use super::schedule::{Schedule, stride};
use super::shape::Shape;
use super::tasks::Task;
use super::units::{Hardware, UnitKind};
use crate::graph::NodeId;

/// A wire in one of its registers.
type Source = (NodeId, u32);

/// One run of a use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Place {
    number: usize,
    run: usize,
}

/// Units of a kind in each phase.
struct Binding<'a> {
    kind: &'a UnitKind,
    /// Wires that each use reads: input, source, bits.
    reads: Vec<Vec<(usize, Source, u32)>>,
    /// Occupant of each phase and unit.
    slots: Vec<Vec<Option<Place>>>,
    /// Number of reads of a source by a unit's input.
    counts: HashMap<(usize, usize, Source), u32>,
    /// Number of sources of a unit's input.
    inputs: HashMap<(usize, usize), u32>,
}

impl Binding<'_> {
    fn width(&self, input: usize) -> i64 {
        match &self.kind.hardware {
            Hardware::Multiplier(widths) => widths[input].into(),
            Hardware::Module(module) => {
                module.inputs.iter().find(|port| port.place == input).map_or(0, |port| port.format.width().into())
            }
        }
    }

    /// Adds the reads of a use to a unit, or takes them away. Returns what the unit's choices cost more.
    fn change(&mut self, unit: usize, number: usize, adds: bool) -> i64 {
        let mut cost = 0;
        for at in 0..self.reads[number].len() {
            let (input, source, _) = self.reads[number][at];
            let width = self.width(input);
            let count = self.counts.entry((unit, input, source)).or_default();
            let sources = self.inputs.entry((unit, input)).or_default();
            if adds {
                *count += 1;
                if *count == 1 {
                    *sources += 1;
                    // The first source of an input brings its register.
                    cost += width * if *sources == 1 { 2 } else { 1 };
                }
            } else {
                *count -= 1;
                if *count == 0 {
                    *sources -= 1;
                    cost -= width * if *sources == 0 { 2 } else { 1 };
                }
            }
        }
        cost
    }

    /// Exchanges the occupants of two units in a phase if that saves something.
    fn exchange(&mut self, phase: usize, [a, b]: [usize; 2]) -> bool {
        let [x, y] = [self.slots[phase][a], self.slots[phase][b]];
        if x.map(|place| place.number) == y.map(|place| place.number) {
            return false;
        }
        let swap = |this: &mut Self, [a, b]: [usize; 2]| {
            let mut cost = 0;
            for (place, from, to) in [(x, a, b), (y, b, a)] {
                if let Some(Place { number, .. }) = place {
                    cost += this.change(from, number, false) + this.change(to, number, true);
                }
            }
            cost
        };
        if swap(self, [a, b]) >= 0 {
            swap(self, [b, a]);
            return false;
        }
        self.slots[phase].swap(a, b);
        true
    }

    /// Units that the runs of a use are on.
    fn units(&self, number: usize) -> Vec<usize> {
        let all = self.slots.iter().flat_map(|units| units.iter().enumerate());
        all.filter(|(_, place)| place.is_some_and(|place| place.number == number)).map(|(unit, _)| unit).collect()
    }

    /// Exchanges the operands of a product if that saves something.
    fn turn(&mut self, number: usize, widths: [u32; 2]) -> bool {
        let [first, second] = self.reads[number][..] else { return false };
        if first.2 > widths[second.0] || second.2 > widths[first.0] {
            return false;
        }
        let units = self.units(number);
        let before: i64 = units.iter().map(|&unit| self.change(unit, number, false)).sum();
        self.reads[number] = vec![(second.0, first.1, first.2), (first.0, second.1, second.2)];
        let after: i64 = units.iter().map(|&unit| self.change(unit, number, true)).sum();
        if before + after < 0 {
            return true;
        }
        units.iter().for_each(|&unit| _ = self.change(unit, number, false));
        self.reads[number] = vec![first, second];
        units.iter().for_each(|&unit| _ = self.change(unit, number, true));
        false
    }
}

/// Improves the binding of every kind of unit. `base` gives the wire of a node, `bits` those that a signed operand needs.
pub(super) fn improve(
    shape: &Shape,
    kinds: &mut [UnitKind],
    schedule: &mut Schedule,
    base: impl Fn(NodeId) -> Option<NodeId>,
    bits: impl Fn(NodeId) -> u32,
) {
    let interval = schedule.interval;
    for (kind_number, kind) in kinds.iter_mut().enumerate() {
        let mut slots = vec![vec![None; schedule.units[kind_number] as usize]; interval as usize];
        let mut reads = Vec::new();
        for (number, own) in kind.uses.iter().enumerate() {
            let Some(units) = schedule.bound.get(&(kind_number, number)) else {
                reads.push(Vec::new());
                continue;
            };
            let cycle = schedule.cycles[&Task::Use(kind_number, number)];
            let apart = stride(interval, units.len() as u32);
            for (run, &unit) in units.iter().enumerate() {
                slots[((cycle + run as u32 * apart) % interval) as usize][unit as usize] = Some(Place { number, run });
            }
            let source =
                |id: NodeId| base(id).map_or((id, u32::MAX), |base| (base, schedule.register(shape, base, cycle)));
            reads.push(own.reads().map(|(input, id)| (input, source(id), bits(id))).collect());
        }
        let mut binding = Binding { kind, reads, slots: Vec::new(), counts: HashMap::new(), inputs: HashMap::new() };
        for units in &slots {
            for (unit, place) in units.iter().enumerate() {
                if let Some(Place { number, .. }) = place {
                    binding.change(unit, *number, true);
                }
            }
        }
        binding.slots = slots;
        let widths = if let Hardware::Multiplier(widths) = kind.hardware { Some(widths) } else { None };
        let mut improves = true;
        while improves {
            improves = false;
            for phase in 0..binding.slots.len() {
                for a in 0..binding.slots[phase].len() {
                    for b in 0..a {
                        improves |= binding.exchange(phase, [a, b]);
                    }
                }
            }
            for number in 0..binding.reads.len() {
                improves |= widths.is_some_and(|widths| binding.turn(number, widths));
            }
        }
        let Binding { reads, slots, .. } = binding;
        for units in &slots {
            for (unit, place) in (0..).zip(units) {
                let Some(Place { number, run }) = *place else { continue };
                if let Some(bound) = schedule.bound.get_mut(&(kind_number, number)) {
                    bound[run] = unit;
                }
            }
        }
        if widths.is_some() {
            for (own, reads) in kind.uses.iter_mut().zip(reads) {
                let turned = reads.first().is_some_and(|read| read.0 == 1);
                if turned {
                    own.inputs.reverse();
                }
            }
        }
    }
}
