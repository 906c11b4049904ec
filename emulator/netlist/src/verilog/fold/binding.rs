//! Binding: which unit does an operation, and which operand of a product comes first.
//!
//! Units that are taken in one phase can change places, and the operands of a product, too. Products of a sum stay together: units change places in
//! all phases from the first to the last of them. Each wire that a unit reads at an input costs as many choices as it has bits, however often it is
//! read. The binding is improved until no exchange of two operations saves anything.

use std::collections::HashMap;

use super::schedule::{Schedule, stride};
use super::shape::Shape;
use super::tasks::Task;
use super::units::{Hardware, UnitKind};
use crate::graph::NodeId;

/// A wire in one of its registers.
type Source = (NodeId, u32);

/// One run of a use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Place {
    number: usize,
    run: usize,
}

/// Phases that change places together, of which there are few.
const TOGETHER: usize = 12;

/// Units of a kind in each phase.
struct Binding<'a> {
    kind: &'a UnitKind,
    /// Wires that each use reads: input, source, bits.
    reads: Vec<Vec<(usize, Source, u32)>>,
    /// Occupant of each phase and unit.
    slots: Vec<Vec<Option<Place>>>,
    /// Sum of products whose first, last or other slots are around each phase and unit.
    sums: Vec<Vec<Option<Place>>>,
    /// Phases from the first to the last slot of each sum.
    windows: HashMap<Place, Vec<usize>>,
    /// Number of reads of a source by a unit's input.
    counts: HashMap<(usize, usize, Source), u32>,
    /// Number of sources of a unit's input.
    inputs: HashMap<(usize, usize), u32>,
}

impl Binding<'_> {
    fn width(&self, input: usize) -> i64 {
        match &self.kind.hardware {
            Hardware::Multiplier { widths, .. } => widths[input].into(),
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

    /// Phases in which two units change places if they do so in one; `None` if they are too many.
    fn together(&self, phase: usize, [a, b]: [usize; 2]) -> Option<Vec<usize>> {
        let mut phases = vec![phase];
        let mut next = 0;
        while let Some(&phase) = phases.get(next) {
            next += 1;
            for sum in [a, b].into_iter().filter_map(|unit| self.sums[phase][unit]) {
                let new: Vec<usize> =
                    self.windows[&sum].iter().copied().filter(|phase| !phases.contains(phase)).collect();
                phases.extend(new);
            }
            if phases.len() > TOGETHER {
                return None;
            }
        }
        Some(phases)
    }

    /// Exchanges the occupants of two units in a phase if that saves something.
    fn exchange(&mut self, phase: usize, [a, b]: [usize; 2]) -> bool {
        let Some(phases) = self.together(phase, [a, b]) else { return false };
        let on = |unit: usize| -> Vec<Place> {
            let mut places: Vec<Place> = phases.iter().filter_map(|&phase| self.slots[phase][unit]).collect();
            places.sort_unstable_by_key(|place| (place.number, place.run));
            places.dedup();
            places
        };
        let [x, y] = [on(a), on(b)];
        if x.iter().map(|place| place.number).eq(y.iter().map(|place| place.number)) {
            return false;
        }
        let swap = |this: &mut Self, [a, b]: [usize; 2]| {
            let mut cost = 0;
            for (places, from, to) in [(&x, a, b), (&y, b, a)] {
                for &Place { number, .. } in places {
                    cost += this.change(from, number, false) + this.change(to, number, true);
                }
            }
            cost
        };
        if swap(self, [a, b]) >= 0 {
            swap(self, [b, a]);
            return false;
        }
        for phase in phases {
            self.slots[phase].swap(a, b);
            self.sums[phase].swap(a, b);
        }
        true
    }

    /// Units that the runs of a use are on.
    fn units(&self, number: usize) -> Vec<usize> {
        let all = self.slots.iter().flat_map(|units| units.iter().enumerate());
        let mut runs: Vec<(usize, usize)> = all
            .filter_map(|(unit, place)| place.filter(|place| place.number == number).map(|place| (place.run, unit)))
            .collect();
        runs.sort_unstable();
        runs.dedup();
        runs.into_iter().map(|(_, unit)| unit).collect()
    }

    /// Exchanges the operands of a product, which are at these places among the reads of its use, if that saves something.
    fn turn(&mut self, number: usize, [x, y]: [usize; 2], widths: [u32; 2]) -> bool {
        let [first, second] = [x, y].map(|place| self.reads[number][place]);
        if first.2 > widths[second.0] || second.2 > widths[first.0] {
            return false;
        }
        let units = self.units(number);
        let before: i64 = units.iter().map(|&unit| self.change(unit, number, false)).sum();
        self.reads[number][x].0 = second.0;
        self.reads[number][y].0 = first.0;
        let after: i64 = units.iter().map(|&unit| self.change(unit, number, true)).sum();
        if before + after < 0 {
            return true;
        }
        units.iter().for_each(|&unit| _ = self.change(unit, number, false));
        self.reads[number][x] = first;
        self.reads[number][y] = second;
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
        let none = vec![vec![None; schedule.units[kind_number] as usize]; interval as usize];
        let (mut slots, mut sums, mut windows) = (none.clone(), none, HashMap::new());
        let mut reads = Vec::new();
        for (number, own) in kind.uses.iter().enumerate() {
            let Some(units) = schedule.bound.get(&(kind_number, number)) else {
                reads.push(Vec::new());
                continue;
            };
            let task = Task::Use(kind_number, number);
            let apart = stride(interval, units.len() as u32);
            for (run, &unit) in units.iter().enumerate() {
                let phase = |cycle: u32| ((cycle + run as u32 * apart) % interval) as usize;
                let place = Place { number, run };
                for slot in 0..own.slots() {
                    slots[phase(schedule.slot_cycle(task, slot))][unit as usize] = Some(place);
                }
                if !own.signs.is_empty() {
                    let window: Vec<usize> = (schedule.cycles[&task]..=schedule.last_slot(task)).map(phase).collect();
                    window.iter().for_each(|&phase| sums[phase][unit as usize] = Some(place));
                    windows.insert(place, window);
                }
            }
            let source = |input: usize, id: NodeId| {
                let cycle = schedule.slot_cycle(task, own.port(input).0);
                base(id).map_or((id, u32::MAX), |base| (base, schedule.register(shape, base, cycle)))
            };
            reads.push(own.reads().map(|(input, id)| (own.port(input).1, source(input, id), bits(id))).collect());
        }
        let (counts, inputs) = (HashMap::new(), HashMap::new());
        let mut binding = Binding { kind, reads, slots, sums, windows, counts, inputs };
        for number in 0..binding.reads.len() {
            for unit in binding.units(number) {
                binding.change(unit, number, true);
            }
        }
        let widths = if let Hardware::Multiplier { widths, .. } = kind.hardware { Some(widths) } else { None };
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
            for (number, widths) in (0..binding.reads.len()).filter_map(|number| Some((number, widths?))) {
                for first in (0..binding.reads[number].len()).step_by(2) {
                    improves |= binding.turn(number, [first, first + 1], widths);
                }
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
                for (operands, reads) in own.inputs.chunks_mut(2).zip(reads.chunks(2)) {
                    if reads[0].0 == 1 {
                        operands.reverse();
                    }
                }
            }
        }
    }
}
