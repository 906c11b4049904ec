//! The slot table: what each unit does in each phase.

use std::fmt::Write;

use super::folded::Folded;
use super::schedule::stride;
use super::tasks::Task;

/// Use of a unit in a phase.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
pub struct Slot {
    /// Name of the unit's kind.
    pub kind: String,
    /// Number of the unit.
    pub unit: u32,
    /// Phase in which it takes its operands.
    pub phase: u32,
    /// Cycle after the fragment was taken.
    pub cycle: u32,
    /// Number of the run, in a block of several.
    pub run: u32,
    /// Operation and line of the source.
    pub origin: String,
}

impl Folded {
    /// Every use of a unit, by unit and phase.
    pub fn slots(&self) -> Vec<Slot> {
        let mut slots = Vec::new();
        for task in &self.tasks.all {
            let &Task::Use(kind, number) = task else { continue };
            let (of_kind, units) = (&self.kinds[kind], &self.schedule.bound[&(kind, number)]);
            let apart = stride(self.schedule.interval, units.len() as u32);
            let own = &of_kind.uses[number];
            for ((run, &unit), slot) in (0..).zip(units).flat_map(|on| (0..own.slots()).map(move |slot| (on, slot))) {
                let cycle = self.schedule.slot_cycle(*task, slot) + run * apart;
                let origin = self.shape.net.origin(own.product(slot).unwrap_or(own.first()));
                let phase = cycle % self.schedule.interval;
                slots.push(Slot { kind: of_kind.name.clone(), unit, phase, cycle, run, origin });
            }
        }
        slots.sort();
        slots
    }

    /// Text of the slots: a paragraph a unit, a line a phase.
    pub fn slot_table(&self) -> String {
        let mut text = format!(
            "Slots of the units: phase of {}, cycle after the fragment was taken, run of a block, operation.\n",
            self.schedule.interval
        );
        let mut unit = None;
        for slot in self.slots() {
            if unit.as_ref() != Some(&(slot.kind.clone(), slot.unit)) {
                // Writing to a string cannot fail.
                let _ = writeln!(text, "\n{} {}", slot.kind, slot.unit);
                unit = Some((slot.kind.clone(), slot.unit));
            }
            let _ = writeln!(text, "{:5} {:5} {:3}  {}", slot.phase, slot.cycle, slot.run, slot.origin);
        }
        text
    }
}
