//! Modulo scheduling: one fragment begins every `interval` cycles, and each operation has its cycle in it.
//!
//! An operation of a block computes for run r at its own cycle plus r strides. So a use of a unit in a block takes a slot of each run. The netlist has
//! no loops: list scheduling in the order of the longest way to an output always ends, and an interval that leaves a use without a slot is too short.
//! A sum of products takes a slot for each of them on one unit, in any order and with other products between them.
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
    /// Cycles from the first slot of a sum of products to the slot of each of its products, by kind and use.
    pub(super) offsets: HashMap<(usize, usize), Vec<u32>>,
    /// Times of the wires.
    pub(super) made: HashMap<NodeId, Made>,
    /// Cycle in which the outputs are there.
    pub(super) last: u32,
}

/// Levels that a cycle of a unit counts for, where the longest way to an output is sought.
const LEVELS_OF_CYCLE: u32 = 20;

/// Runs of list scheduling for an interval: a sum of products that found no slots comes earlier in the next one, with all that it needs.
const RUNS: usize = 12;

/// Cycles between the runs of a block.
pub(super) fn stride(interval: u32, copies: u32) -> u32 {
    interval / copies
}

/// Phases of the units of a kind.
#[derive(Clone, Debug)]
struct Phases {
    /// Number of units that have operands.
    taken: Vec<u32>,
    /// Flags of each unit, true from the first to the last product of a sum, between which no other sum can be.
    adds: Vec<Vec<bool>>,
}

/// Tasks in the order of scheduling, and the slots that are taken.
struct Scheduler<'a> {
    shape: &'a Shape,
    kinds: &'a [UnitKind],
    tasks: &'a Tasks,
    depth: u32,
    target: Target,
    schedule: Schedule,
    /// Units of each kind.
    units: Vec<Phases>,
}

impl Scheduler<'_> {
    fn copies(&self, task: Task) -> u32 {
        let id = self.tasks.makes[&task].first().copied().unwrap_or_default();
        self.shape.copies[id as usize]
    }

    /// Time of a wire: cycle, and levels before it there. With `ahead`, it is that of a reader which is so many cycles later than its first run.
    fn time(&self, id: NodeId, ahead: u32) -> (u32, u32) {
        let made = self.schedule.made[&id];
        let levels = if made.kept { 0 } else { made.levels };
        made.cycle.checked_sub(ahead).map_or((0, 0), |cycle| (cycle, levels))
    }

    /// First cycle in which several wires are there, and the levels before the last one.
    fn together(times: impl Iterator<Item = (u32, u32)>) -> (u32, u32) {
        times.max().unwrap_or((0, 0))
    }

    /// First cycle of a task and the levels before its own there.
    fn ready(&self, task: Task) -> (u32, u32) {
        match task {
            // Run r of a block reads its own wire r strides later.
            Task::Choice(id) => {
                let apart = stride(self.schedule.interval, self.copies(task));
                let runs = (0..).zip(&self.tasks.choices[&id]);
                Self::together(runs.filter_map(|(run, source)| Some(self.time((*source)?, run * apart))))
            }
            _ => Self::together(self.tasks.reads[&task].iter().map(|&id| self.time(id, 0))),
        }
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
                let choice = self.target.choice(of_kind.slots(self.shape).div_ceil(self.schedule.units[kind]));
                let chosen =
                    |(cycle, before): (u32, u32)| cycle + u32::from(before + choice > self.depth && before > 0);
                let slots = match self.tasks.terms.get(&task) {
                    None => self.slot(task, chosen((cycle, before))).map(|cycle| [cycle; 2]),
                    Some(terms) => {
                        let ready =
                            terms.iter().map(|reads| chosen(Self::together(reads.iter().map(|&id| self.time(id, 0)))));
                        let ready = ready.collect::<Vec<_>>();
                        self.slots(task, &ready)
                    }
                };
                let Some([first, last]) = slots else { return false };
                cycle = first;
                Made { cycle: last + of_kind.latency_of(&of_kind.uses[number]), levels: 0, kept: false }
            }
        };
        self.schedule.cycles.insert(task, cycle);
        for &id in &self.tasks.makes[&task] {
            self.schedule.made.insert(id, made);
        }
        true
    }

    /// Phases of the runs of a task, of which the first one is in a cycle.
    fn phases(&self, task: Task) -> impl Fn(u32) -> Vec<usize> + use<> {
        let (interval, copies) = (self.schedule.interval, self.copies(task));
        let apart = stride(interval, copies);
        move |cycle| (0..copies).map(|run| ((cycle + run * apart) % interval) as usize).collect()
    }

    /// Takes the first slots from a cycle on in which a unit is free for each run. Units are chosen when all slots are taken.
    fn slot(&mut self, task: Task, from: u32) -> Option<u32> {
        let Task::Use(kind, _) = task else { return None };
        let (phases, count) = (self.phases(task), self.schedule.units[kind]);
        let taken = &mut self.units[kind].taken;
        let is_free = |cycle: &u32| phases(*cycle).into_iter().all(|phase| taken[phase] < count);
        let cycle = (from..from + self.schedule.interval).find(is_free)?;
        for phase in phases(cycle) {
            taken[phase] += 1;
        }
        Some(cycle)
    }

    /// Takes slots for the products of a sum, each from its cycle in `ready` on, all on one unit: those that end first, and of these the latest.
    /// Returns the first and the last one.
    fn slots(&mut self, task: Task, ready: &[u32]) -> Option<[u32; 2]> {
        let Task::Use(kind, number) = task else { return None };
        let (phases, count) = (self.phases(task), self.schedule.units[kind]);
        let (interval, copies) = (self.schedule.interval, self.copies(task));
        // The product that is ready last comes last.
        let mut order: Vec<usize> = (0..ready.len()).collect();
        order.sort_by_key(|&term| Reverse(ready[term]));
        let from = ready.iter().copied().max()?;
        let Phases { taken, adds } = &self.units[kind];
        let is_free = |cycle: u32| phases(cycle).into_iter().all(|phase| taken[phase] < count);
        // Slots that end in a cycle: the latest ones.
        let until = |end: u32| {
            let mut cycles = vec![end; ready.len()];
            let mut next = Some(end);
            for (place, &term) in order.iter().enumerate() {
                let earliest = ready[term].max((end + 1).saturating_sub(stride(interval, copies)));
                let cycle = (earliest..=next?).rev().find(|&cycle| is_free(cycle))?;
                if place == 0 && cycle != end {
                    return None;
                }
                cycles[term] = cycle;
                next = cycle.checked_sub(1);
            }
            let first = cycles.iter().copied().min()?;
            // Runs do not overlap, so each has a unit of its own choice.
            let window = |run: usize| (first..=end).map(|cycle| phases(cycle)[run]).collect::<Vec<_>>();
            let unit = |run: usize| adds.iter().position(|adds| !window(run).into_iter().any(|phase| adds[phase]));
            let units = (0..copies as usize).map(unit).collect::<Option<Vec<usize>>>()?;
            Some((units, first, cycles))
        };
        let (end, (units, first, cycles)) = (from..from + interval).find_map(|end| Some((end, until(end)?)))?;
        let of_kind = &mut self.units[kind];
        for phase in cycles.iter().copied().flat_map(&phases) {
            of_kind.taken[phase] += 1;
        }
        for cycle in first..=end {
            for (phase, &unit) in phases(cycle).into_iter().zip(&units) {
                of_kind.adds[unit][phase] = true;
            }
        }
        self.schedule.bound.insert((kind, number), units.into_iter().map(|unit| unit as u32).collect());
        self.schedule.offsets.insert((kind, number), cycles.iter().map(|cycle| cycle - first).collect());
        Some([first, end])
    }

    /// Chooses units for the uses that are no sums, any that are free: [`super::binding`] finds better ones.
    fn bind(&mut self) {
        let interval = self.schedule.interval as usize;
        let mut free: Vec<Vec<BTreeSet<u32>>> =
            self.schedule.units.iter().map(|&count| vec![(0..count).collect(); interval]).collect();
        let uses = |task: &Task| if let Task::Use(kind, number) = *task { Some((*task, (kind, number))) } else { None };
        let (sums, alone): (Vec<_>, Vec<_>) =
            self.tasks.all.iter().filter_map(uses).partition(|(_, own)| self.schedule.offsets.contains_key(own));
        for (task, own) in sums {
            for slot in 0..self.schedule.offsets[&own].len() {
                let phases = self.phases(task)(self.schedule.slot_cycle(task, slot));
                for (phase, unit) in phases.into_iter().zip(&self.schedule.bound[&own]) {
                    free[own.0][phase].remove(unit);
                }
            }
        }
        for (task, own) in alone {
            let phases = self.phases(task)(self.schedule.cycles[&task]);
            // A slot was taken only where a unit is free.
            let units = phases.into_iter().filter_map(|phase| free[own.0][phase].pop_first()).collect();
            self.schedule.bound.insert(own, units);
        }
    }
}

impl Schedule {
    /// Cycle of a slot of a task, for the first run. Only a sum of products has several.
    pub(super) fn slot_cycle(&self, task: Task, slot: usize) -> u32 {
        let offset = match task {
            Task::Use(kind, number) => self.offsets.get(&(kind, number)).map_or(0, |offsets| offsets[slot]),
            _ => 0,
        };
        self.cycles[&task] + offset
    }

    /// Cycle of the last slot of a task, for the first run.
    pub(super) fn last_slot(&self, task: Task) -> u32 {
        let offsets = if let Task::Use(kind, number) = task { self.offsets.get(&(kind, number)) } else { None };
        self.cycles[&task] + offsets.and_then(|offsets| offsets.iter().copied().max()).unwrap_or(0)
    }

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
                let uses = kind.slots(shape);
                let least = uses.div_ceil(interval);
                match kind.hardware {
                    Hardware::Multiplier { .. } => multipliers,
                    Hardware::Module(_) if 4 * uses > 3 * least * interval => least + spare,
                    Hardware::Module(_) => least,
                }
            })
            .collect();
        let mut ahead = vec![0; tasks.all.len()];
        for _ in 0..RUNS {
            let phases = |&count: &u32| Phases {
                taken: vec![0; interval as usize],
                adds: vec![vec![false; interval as usize]; count as usize],
            };
            let phases = units.iter().map(phases).collect();
            let schedule = Self {
                interval,
                units: units.clone(),
                cycles: HashMap::new(),
                bound: HashMap::new(),
                offsets: HashMap::new(),
                made: HashMap::new(),
                last: 0,
            };
            let mut scheduler = Scheduler { shape, kinds, tasks, depth, target, schedule, units: phases };
            for port in shape.net.ports.iter().filter(|port| !shape.joins.contains_key(&port.node)) {
                scheduler.schedule.made.insert(port.node, Made { cycle: 0, levels: 0, kept: true });
            }
            match scheduler.run(&ahead) {
                Ok(()) => return Some(scheduler.schedule),
                Err(without) if tasks.terms.contains_key(&tasks.all[without]) => {
                    tasks.bring_forward(without, &mut ahead);
                }
                Err(_) => return None,
            }
        }
        None
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
        let products = kinds.iter().filter(|kind| matches!(kind.hardware, Hardware::Multiplier { .. }));
        let products: u32 = products.map(|kind| kind.slots(shape)).sum();
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
    /// Schedules all tasks, those that are `ahead` of others first. Error: the number of a task without a slot.
    fn run(&mut self, ahead: &[u32]) -> Result<(), usize> {
        let tasks = self.tasks;
        let height = tasks.heights(|kind, number| {
            let own = &self.kinds[kind].uses[number];
            (self.kinds[kind].latency_of(own) + own.slots() as u32 - 1) * LEVELS_OF_CYCLE
        });
        let mut waits: Vec<usize> = tasks.needs.iter().map(BTreeSet::len).collect();
        let urgency = |task: usize| ((ahead[task], height[task]), Reverse(task));
        let mut queue: BinaryHeap<((u32, u32), Reverse<usize>)> = BinaryHeap::new();
        queue.extend((0..tasks.all.len()).filter(|&task| waits[task] == 0).map(urgency));
        while let Some((_, Reverse(number))) = queue.pop() {
            let task = tasks.all[number];
            if !self.place(task) {
                return Err(number);
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
                    queue.push(urgency(user));
                }
            }
        }
        self.bind();
        let ends = self.schedule.made.values().map(|made| made.cycle + u32::from(!made.kept));
        self.schedule.last = ends.max().unwrap_or(0);
        Ok(())
    }
}
