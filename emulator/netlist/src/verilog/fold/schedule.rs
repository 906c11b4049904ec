//! Modulo scheduling: one fragment begins every `interval` cycles, and each operation has its cycle in it.
//!
//! An operation of a block computes for run r at its own cycle plus r strides. So a use of a unit in a block takes a slot of each run. The netlist has
//! no loops: list scheduling in the order of the longest way to an output always ends, and an interval that leaves a use without a slot is too short.
//! Glue (operations with hardware of their own) is chained within a cycle up to the target depth.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap, HashMap};

use super::shape::Shape;
use super::tasks::{Task, Tasks};
use super::units::{Hardware, UnitKind};
use crate::graph::NodeId;
use crate::target::Target;

/// Time at which a wire has its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Made {
    /// Cycle, counted from that after the fragment was taken; for the first run of a block.
    pub(super) cycle: u32,
    /// Levels of logic before it in this cycle.
    pub(super) levels: u32,
    /// True for a register that keeps its value; a wire has it in that cycle alone.
    pub(super) kept: bool,
}

/// A schedule.
#[derive(Clone, Debug)]
pub(super) struct Schedule {
    /// Cycles from a fragment to the next.
    pub(super) interval: u32,
    /// Units of each kind.
    pub(super) units: Vec<u32>,
    /// Cycle of each task, for the first run.
    pub(super) cycles: HashMap<Task, u32>,
    /// Unit of each run of each use, by kind and use.
    pub(super) bound: HashMap<(usize, usize), Vec<u32>>,
    /// Times of the wires.
    pub(super) made: HashMap<NodeId, Made>,
    /// Cycle in which the outputs are there.
    pub(super) last: u32,
}

/// Levels that a cycle of a unit counts for, where the longest way to an output is sought.
const LEVELS_OF_CYCLE: u32 = 20;

/// Cycles between the runs of a block.
pub(super) fn stride(interval: u32, copies: u32) -> u32 {
    interval / copies
}

/// Tasks in the order of scheduling, and the slots that are taken.
struct Scheduler<'a> {
    shape: &'a Shape,
    kinds: &'a [UnitKind],
    tasks: &'a Tasks,
    depth: u32,
    target: Target,
    schedule: Schedule,
    /// Number of units of each kind that are taken, by phase.
    taken: Vec<Vec<u32>>,
}

impl Scheduler<'_> {
    fn copies(&self, task: Task) -> u32 {
        let id = self.tasks.makes[&task].first().copied().unwrap_or_default();
        self.shape.copies[id as usize]
    }

    /// First cycle of a task and the levels before its own there.
    fn ready(&self, task: Task) -> (u32, u32) {
        let time = |id: NodeId, ahead: u32| {
            let made = self.schedule.made[&id];
            let levels = if made.kept { 0 } else { made.levels };
            made.cycle.checked_sub(ahead).map_or((0, 0), |cycle| (cycle, levels))
        };
        let times: Vec<(u32, u32)> = match task {
            // Run r of a block reads its own wire r strides later.
            Task::Choice(id) => {
                let apart = stride(self.schedule.interval, self.copies(task));
                let runs = (0..).zip(&self.tasks.choices[&id]);
                runs.filter_map(|(run, source)| Some(time((*source)?, run * apart))).collect()
            }
            _ => self.tasks.reads[&task].iter().map(|&id| time(id, 0)).collect(),
        };
        let cycle = times.iter().map(|time| time.0).max().unwrap_or(0);
        (cycle, times.iter().filter(|time| time.0 == cycle).map(|time| time.1).max().unwrap_or(0))
    }

    /// Schedules a task; false if no slot is free.
    fn place(&mut self, task: Task) -> bool {
        let (mut cycle, mut before) = self.ready(task);
        let made = match task {
            Task::Glue(_) | Task::Choice(_) => {
                let levels = self.tasks.levels[&task];
                if before + levels > self.depth && before > 0 {
                    (cycle, before) = (cycle + 1, 0);
                }
                Made { cycle, levels: before + levels, kept: false }
            }
            Task::Use(kind, number) => {
                let of_kind = &self.kinds[kind];
                let uses: u32 = of_kind.uses.iter().map(|own| self.shape.copies[own.first() as usize]).sum();
                let choice = self.target.choice(uses.div_ceil(self.schedule.units[kind]));
                if before + choice > self.depth && before > 0 {
                    cycle += 1;
                }
                let Some(found) = self.slot(task, kind, number, cycle) else { return false };
                cycle = found;
                Made { cycle: cycle + of_kind.latency(), levels: 0, kept: false }
            }
        };
        self.schedule.cycles.insert(task, cycle);
        for &id in &self.tasks.makes[&task] {
            self.schedule.made.insert(id, made);
        }
        true
    }

    /// Takes the first slots from a cycle on that are free for each run, on any units: [`super::binding`] finds better ones.
    fn slot(&mut self, task: Task, kind: usize, number: usize, from: u32) -> Option<u32> {
        let (interval, copies) = (self.schedule.interval, self.copies(task));
        let apart = stride(interval, copies);
        let phases = |cycle: u32| (0..copies).map(move |run| ((cycle + run * apart) % interval) as usize);
        let is_free = |cycle: &u32| phases(*cycle).all(|phase| self.taken[kind][phase] < self.schedule.units[kind]);
        let cycle = (from..from + interval).find(is_free)?;
        let mut units = Vec::new();
        for phase in phases(cycle) {
            units.push(self.taken[kind][phase]);
            self.taken[kind][phase] += 1;
        }
        self.schedule.bound.insert((kind, number), units);
        Some(cycle)
    }
}

impl Schedule {
    /// Cycles after which a wire of the folded netlist has a new value.
    pub(super) fn period(&self, shape: &Shape, id: NodeId) -> u32 {
        stride(self.interval, shape.copies[id as usize])
    }

    /// Register, counted from the wire, that has the value of a wire in a cycle: 0 is the wire itself, and any wire of which no bit is read.
    pub(super) fn register(&self, shape: &Shape, id: NodeId, cycle: u32) -> u32 {
        let Some(made) = self.made.get(&id) else { return 0 };
        let period = self.period(shape, id);
        let after = cycle - made.cycle;
        if made.kept { after / period + 1 } else { after.div_ceil(period) }
    }

    /// Phases at whose end register `number` of a wire takes its value: one for each run.
    pub(super) fn phases(&self, shape: &Shape, id: NodeId, number: u32) -> Vec<u32> {
        let (made, period) = (self.made[&id], self.period(shape, id));
        // What is kept is there one cycle after it was taken.
        let first = made.cycle + self.interval - u32::from(made.kept) + (number - 1) * period;
        let mut phases: Vec<u32> =
            (0..shape.copies[id as usize]).map(|run| (first + run * period) % self.interval).collect();
        phases.sort_unstable();
        phases
    }

    /// Schedule with an interval; `None` if a use finds no free slot. Units besides multipliers that would be busy in most phases get some to `spare`.
    fn try_interval(
        shape: &Shape,
        kinds: &[UnitKind],
        tasks: &Tasks,
        [interval, multipliers, depth, spare]: [u32; 4],
        target: Target,
    ) -> Option<Self> {
        let units: Vec<u32> = kinds
            .iter()
            .map(|kind| {
                let uses: u32 = kind.uses.iter().map(|own| shape.copies[own.first() as usize]).sum();
                let least = uses.div_ceil(interval);
                match kind.hardware {
                    Hardware::Multiplier(_) => multipliers,
                    Hardware::Module(_) if 4 * uses > 3 * least * interval => least + spare,
                    Hardware::Module(_) => least,
                }
            })
            .collect();
        let taken = vec![vec![0; interval as usize]; units.len()];
        let schedule =
            Self { interval, units, cycles: HashMap::new(), bound: HashMap::new(), made: HashMap::new(), last: 0 };
        let mut scheduler = Scheduler { shape, kinds, tasks, depth, target, schedule, taken };
        for port in shape.net.ports.iter().filter(|port| !shape.joins.contains_key(&port.node)) {
            scheduler.schedule.made.insert(port.node, Made { cycle: 0, levels: 0, kept: true });
        }
        scheduler.run().then_some(scheduler.schedule)
    }

    /// Schedule with the least interval that list scheduling finds, for a number of multipliers and the most levels in a cycle.
    pub(super) fn new(
        shape: &Shape,
        kinds: &[UnitKind],
        tasks: &Tasks,
        [multipliers, depth]: [u32; 2],
        target: Target,
    ) -> Self {
        let copies = shape.copies.iter().copied().max().unwrap_or(1);
        let products = kinds.iter().filter(|kind| matches!(kind.hardware, Hardware::Multiplier(_)));
        let products: u32 = products.flat_map(|kind| &kind.uses).map(|own| shape.copies[own.first() as usize]).sum();
        let bound = products.div_ceil(multipliers).max(copies).max(1);
        // A few cycles more cost less than further units.
        let few = (bound..=bound + bound / 8).map(|interval| (interval, 0));
        let more = (bound..).flat_map(|interval| [(interval, 1), (interval, 0)]);
        let mut all = few.chain(more).filter_map(|(interval, spare)| {
            Self::try_interval(shape, kinds, tasks, [interval, multipliers, depth, spare], target)
        });
        all.next().expect("an interval that has a slot for each use is tried")
    }
}

impl Scheduler<'_> {
    fn run(&mut self) -> bool {
        let tasks = self.tasks;
        let height = tasks.heights(|kind| self.kinds[kind].latency() * LEVELS_OF_CYCLE);
        let mut waits: Vec<usize> = tasks.needs.iter().map(BTreeSet::len).collect();
        let mut queue: BinaryHeap<(u32, Reverse<usize>)> = BinaryHeap::new();
        queue.extend((0..tasks.all.len()).filter(|&task| waits[task] == 0).map(|task| (height[task], Reverse(task))));
        while let Some((_, Reverse(number))) = queue.pop() {
            let task = tasks.all[number];
            if !self.place(task) {
                return false;
            }
            for id in &tasks.makes[&task] {
                for outcome in tasks.outcomes.iter().filter(|outcome| outcome.base == *id) {
                    let later = outcome.run * stride(self.schedule.interval, self.copies(task));
                    let cycle = self.schedule.made[id].cycle + 1 + later;
                    self.schedule.made.insert(outcome.id, Made { cycle, levels: 0, kept: true });
                }
            }
            for &user in &tasks.users[number] {
                waits[user] -= 1;
                if waits[user] == 0 {
                    queue.push((height[user], Reverse(user)));
                }
            }
        }
        let ends = self.schedule.made.values().map(|made| made.cycle + u32::from(!made.kept));
        self.schedule.last = ends.max().unwrap_or(0);
        true
    }
}
