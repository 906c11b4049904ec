//! The schedule in integers: cycle by cycle, with registers that are overwritten as those of the hardware are.
//!
//! A wire has a value only in the cycle in which the schedule makes it, and a register only once it has taken one. Whatever is read at another time is
//! nothing, and so is what is made of it. So a wrong cycle, a wrong register or a missing wait cannot go unseen.

use std::collections::BTreeSet;

use super::folded::Folded;
use super::schedule::stride;
use super::tasks::Task;
use crate::evaluate::apply;
use crate::graph::{NodeId, Op};

/// A wire at a register: 0 is the wire itself.
type Place = (NodeId, u32);

/// One task in one run.
#[derive(Clone, Debug)]
struct Step {
    /// The task.
    task: Task,
    /// Cycle in which it is done, counted from that after the fragment was taken.
    cycle: u32,
    /// Wires that it reads.
    fetches: Vec<Place>,
    /// Operations that it computes, in order.
    nodes: Vec<NodeId>,
    /// Wires that have its outcome `latency` cycles later, and the nodes of the outcome.
    makes: Vec<(NodeId, NodeId)>,
    latency: u32,
    /// Kind and number of the unit that it takes.
    unit: Option<(usize, u32)>,
}

/// Fault of a schedule, to be found by running it. The number is that of a step, modulo the count of steps; all runs of its task have the fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A task is done one cycle late, in a slot that is not its own.
    Slot(usize),
    /// A task reads its first wire from the next register.
    Operand(usize),
    /// A task does not wait for its operands: it is done one cycle early.
    Wait(usize),
}

/// A folded design that runs.
#[derive(Clone, Debug)]
pub struct Machine<'a> {
    folded: &'a Folded,
    steps: Vec<Step>,
    /// Steps of each phase, in an order in which wires are made before they are read.
    phases: Vec<Vec<usize>>,
    /// Registers that take a value at the end of each phase: from, to; a wire's last register first.
    moves: Vec<Vec<(Place, Place)>>,
    outputs: Vec<Output>,
    /// Number of each node's wire among the wires and registers of a state, and of its registers.
    places: Vec<Option<(usize, u32)>>,
}

/// An output: its node, the operations that give it, and the wires that these read.
type Output = (NodeId, Vec<NodeId>, Vec<Place>);

/// Operations between the wires that a task reads and some nodes, in order.
struct Between<'a> {
    folded: &'a Folded,
    stops: &'a [NodeId],
    nodes: Vec<NodeId>,
    fetched: Vec<NodeId>,
}

impl Between<'_> {
    fn visit(&mut self, id: NodeId) {
        let shape = &self.folded.shape;
        if self.nodes.contains(&id) || shape.ranges.of(id).constant().is_some() || self.fetched.contains(&id) {
            return;
        }
        if self.stops.contains(&id) {
            self.fetched.push(id);
            return;
        }
        self.operands(id);
        self.nodes.push(id);
    }

    /// Visits the operands of a node, of a choice that is always the same only the one that is chosen.
    fn operands(&mut self, id: NodeId) {
        let shape = &self.folded.shape;
        let op = shape.net.node(id).op;
        match op {
            Op::Select(flag, a, b) => match shape.ranges.of(flag).constant() {
                Some(0) => self.visit(b),
                Some(_) => self.visit(a),
                None => [flag, a, b].into_iter().for_each(|operand| self.visit(operand)),
            },
            _ => op.operands().for_each(|operand| self.visit(operand)),
        }
    }
}

impl Folded {
    /// Operations that give `targets` from the wires `stops`; targets are computed even if they are such wires.
    fn between(&self, stops: &[NodeId], targets: &[NodeId], computed: bool) -> (Vec<NodeId>, Vec<NodeId>) {
        let mut between = Between { folded: self, stops, nodes: Vec::new(), fetched: Vec::new() };
        for &target in targets {
            if computed {
                between.operands(target);
                between.nodes.push(target);
            } else {
                between.visit(target);
            }
        }
        (between.nodes, between.fetched)
    }

    fn steps_of(&self, task: Task) -> Vec<Step> {
        let schedule = &self.schedule;
        let first = schedule.cycles[&task];
        let makes = &self.tasks.makes[&task];
        let copies = self.shape.copies[makes[0] as usize];
        let apart = stride(schedule.interval, copies);
        let place = |id: NodeId, cycle: u32| (id, schedule.register(&self.shape, id, cycle));
        let reads = &self.tasks.reads[&task];
        let steps = |run: u32| -> Vec<Step> {
            let cycle = first + run * apart;
            match task {
                Task::Glue(id) => {
                    let (nodes, fetched) = self.between(reads, &[id], true);
                    let fetches = fetched.into_iter().map(|read| place(read, first)).collect();
                    vec![Step { task, cycle, fetches, nodes, makes: vec![(id, id)], latency: 0, unit: None }]
                }
                Task::Choice(id) => {
                    let source = self.shape.sources(id)[run as usize];
                    let (nodes, fetched) = self.between(reads, &[source], false);
                    let fetches = fetched.into_iter().map(|read| place(read, cycle)).collect();
                    vec![Step { task, cycle, fetches, nodes, makes: vec![(id, source)], latency: 0, unit: None }]
                }
                Task::Use(kind, number) => {
                    let (of_kind, own) = (&self.kinds[kind], &self.kinds[kind].uses[number]);
                    let unit = Some((kind, schedule.bound[&(kind, number)][run as usize]));
                    let made = schedule.last_slot(task) + of_kind.latency_of(own);
                    // Each product of a sum has its own slot. All of them are there when the accumulator has the sum.
                    let slot = |slot: usize| {
                        let at = schedule.slot_cycle(task, slot);
                        let inputs: Vec<NodeId> =
                            own.reads().filter(|&(input, _)| own.port(input).0 == slot).map(|(_, id)| id).collect();
                        let (mut nodes, fetched) = self.between(reads, &inputs, false);
                        let makes = match own.product(slot) {
                            Some(product) => {
                                nodes.push(product);
                                vec![(product, product)]
                            }
                            None => {
                                nodes.extend(own.operations());
                                makes.iter().map(|&id| (id, id)).collect()
                            }
                        };
                        let fetches = fetched.into_iter().map(|read| place(read, at)).collect();
                        Step { task, cycle: at + run * apart, fetches, nodes, makes, latency: made - at, unit }
                    };
                    let mut steps: Vec<Step> = (0..own.slots()).map(slot).collect();
                    if !own.signs.is_empty() {
                        let products: Vec<NodeId> = (0..own.slots()).filter_map(|slot| own.product(slot)).collect();
                        let nodes = own.operations().into_iter().filter(|id| !products.contains(id)).collect();
                        let fetches = products.into_iter().map(|id| (id, 0)).collect();
                        let makes = makes.iter().map(|&id| (id, id)).collect();
                        let cycle = made + run * apart;
                        steps.push(Step { task, cycle, fetches, nodes, makes, latency: 0, unit: None });
                    }
                    steps
                }
            }
        };
        (0..copies).flat_map(steps).collect()
    }

    /// The schedule as a machine.
    pub fn machine(&self) -> Machine<'_> {
        let steps: Vec<Step> = self.tasks.all.iter().flat_map(|&task| self.steps_of(task)).collect();
        let interval = self.schedule.interval;
        let mut moves = vec![Vec::new(); interval as usize];
        let mut wires: Vec<(&NodeId, &u32)> = self.registers.iter().collect();
        wires.sort_unstable();
        for (&id, &last) in wires {
            let is_join = self.shape.joins.contains_key(&id);
            let outcome = self.tasks.outcomes.iter().find(|outcome| outcome.id == id);
            for number in (1..=last).rev() {
                let is_port = matches!(self.shape.net.node(id).op, Op::Port(_)) && !is_join;
                if number == 1 && is_port {
                    continue;
                }
                let from = match outcome {
                    Some(outcome) if number == 1 => (outcome.of, 0),
                    _ => (id, number - 1),
                };
                for phase in self.schedule.phases(&self.shape, id, number) {
                    moves[phase as usize].push((from, (id, number)));
                }
            }
        }
        let outputs = self.shape.net.outputs.iter().map(|output| {
            let stops: Vec<NodeId> = self.registers.keys().copied().collect();
            let (nodes, fetched) = self.between(&stops, &[output.node], false);
            let place = |id: NodeId| (id, self.schedule.register(&self.shape, id, self.schedule.last));
            (output.node, nodes, fetched.into_iter().map(place).collect())
        });
        let outputs = outputs.collect();
        let mut places = vec![None; self.shape.net.nodes.len()];
        let mut next = 0;
        let uses = self.kinds.iter().flat_map(|kind| &kind.uses);
        let products = uses.flat_map(|own| (0..own.slots()).filter_map(|slot| own.product(slot))).map(|id| (id, 0));
        for (id, last) in self.registers.iter().map(|(&id, &last)| (id, last)).chain(products) {
            places[id as usize] = Some((next, last));
            next += last as usize + 1;
        }
        let mut machine = Machine { folded: self, steps, phases: Vec::new(), moves, outputs, places };
        machine.sort();
        machine
    }
}

/// Values of a machine under way.
struct State {
    /// Value of each node for the step at hand; constants stay.
    scratch: Vec<i64>,
    /// Value of each wire in this cycle, and of its registers.
    values: Vec<Option<i64>>,
    /// Wires that have a value in this cycle.
    live: Vec<usize>,
    /// Outcomes of units that come in later cycles, a list for each.
    coming: Vec<Vec<(NodeId, Option<i64>)>>,
}

impl<'a> Machine<'a> {
    fn sort(&mut self) {
        let interval = self.folded.schedule.interval;
        self.phases = vec![Vec::new(); interval as usize];
        for (number, step) in self.steps.iter().enumerate() {
            self.phases[(step.cycle % interval) as usize].push(number);
        }
    }

    /// Operation of a step, its source line, its cycle and what it reads: wire and register.
    pub fn step_origin(&self, number: usize) -> String {
        let step = &self.steps[number % self.steps.len()];
        let net = &self.folded.shape.net;
        let made = step.makes.first().map_or(0, |made| made.1);
        let reads: Vec<String> =
            step.fetches.iter().map(|&(id, register)| format!("{} at {register}", net.origin(id))).collect();
        format!("{} {} in cycle {} reads {}", net.node(made).op.name(), net.origin(made), step.cycle, reads.join("; "))
    }

    /// Number of steps.
    pub fn step_count(&self) -> usize {
        self.steps.len()
    }

    /// The machine with a fault.
    pub fn with_fault(mut self, fault: Fault) -> Self {
        let (Fault::Slot(number) | Fault::Operand(number) | Fault::Wait(number)) = fault;
        let task = self.steps[number % self.steps.len()].task;
        // The first cycle has no earlier one, but an interval later it is the same phase.
        let before = self.folded.schedule.interval - 1;
        for step in self.steps.iter_mut().filter(|step| step.task == task) {
            match fault {
                Fault::Slot(_) => step.cycle += 1,
                Fault::Wait(_) => step.cycle += before,
                Fault::Operand(_) => step.fetches.iter_mut().take(1).for_each(|(_, register)| *register += 1),
            }
        }
        self.sort();
        self
    }

    /// Number of times that a unit is taken in a phase in which it is already taken.
    pub fn conflicts(&self) -> usize {
        let interval = self.folded.schedule.interval;
        let mut taken = BTreeSet::new();
        let units = self.steps.iter().filter_map(|step| Some((step.cycle % interval, step.unit?)));
        units.filter(|&slot| !taken.insert(slot)).count()
    }

    /// Outputs for fragments that follow each other without a gap, in the order of the design's outputs; `None` where nothing was read.
    pub fn run(&self, fragments: &[Vec<i64>]) -> Vec<Vec<Option<i64>>> {
        let folded = self.folded;
        let (interval, last) = (folded.schedule.interval as usize, folded.schedule.last as usize);
        let nodes = folded.shape.net.nodes.len() as NodeId;
        let scratch = (0..nodes).map(|id| folded.shape.ranges.of(id).constant().unwrap_or(0)).collect();
        let longest = self.steps.iter().map(|step| step.latency).max().unwrap_or(0) as usize + 1;
        let count = self.places.iter().flatten().map(|&(_, last)| last as usize + 1).sum();
        let mut state =
            State { scratch, values: vec![None; count], live: Vec::new(), coming: vec![Vec::new(); longest] };
        let ports: Vec<NodeId> = folded
            .shape
            .net
            .ports
            .iter()
            .map(|port| port.node)
            .filter(|id| !folded.shape.joins.contains_key(id))
            .collect();
        let mut outcomes = Vec::new();
        // The first fragment is taken before the first cycle.
        for cycle in 0..(fragments.len().max(1) - 1) * interval + last + 1 {
            if cycle % interval == 0 {
                let fragment = fragments.get(cycle / interval);
                for (place, &id) in ports.iter().enumerate() {
                    let value = fragment.and_then(|fragment| fragment.get(place)).copied();
                    // What was in the first register went to the second one at the end of the phase before.
                    self.set(&mut state, (id, 1), value);
                }
            }
            for (id, value) in std::mem::take(&mut state.coming[cycle % longest]) {
                self.set(&mut state, (id, 0), value);
            }
            for &number in &self.phases[cycle % interval] {
                self.step(&mut state, &self.steps[number], cycle % longest);
            }
            if cycle >= last && (cycle - last).is_multiple_of(interval) {
                outcomes.push(self.outputs.iter().map(|output| self.output(&mut state, output)).collect());
            }
            let moved: Vec<(Place, Option<i64>)> =
                self.moves[cycle % interval].iter().map(|&(from, to)| (to, self.source(&mut state, from))).collect();
            for wire in std::mem::take(&mut state.live) {
                state.values[wire] = None;
            }
            for (to, value) in moved {
                self.set(&mut state, to, value);
            }
        }
        outcomes.truncate(fragments.len());
        outcomes
    }

    /// Value of a wire or a register; `None` if there is no such register.
    fn get(&self, state: &State, (id, register): Place) -> Option<i64> {
        let (first, last) = self.places[id as usize]?;
        if register > last { None } else { state.values[first + register as usize] }
    }

    /// Sets a wire or a register, if somebody reads it.
    fn set(&self, state: &mut State, (id, register): Place, value: Option<i64>) {
        let Some((first, last)) = self.places[id as usize] else { return };
        if register <= last {
            state.values[first + register as usize] = value;
        }
        if register == 0 {
            state.live.push(first);
        }
    }

    /// Value of a wire or a register, or of a node of a block that is a few bits of a wire.
    fn source(&self, state: &mut State, from: Place) -> Option<i64> {
        let (id, _) = from;
        if self.places[id as usize].is_some() {
            return self.get(state, from);
        }
        let stops: Vec<NodeId> = self.folded.registers.keys().copied().collect();
        let (nodes, fetched) = self.folded.between(&stops, &[id], false);
        let fetches: Vec<Place> = fetched.into_iter().map(|id| (id, 0)).collect();
        self.compute(state, &fetches, &nodes)?;
        Some(state.scratch[id as usize])
    }

    /// Computes nodes from wires; `None` if one of the wires has no value.
    fn compute(&self, state: &mut State, fetches: &[Place], nodes: &[NodeId]) -> Option<()> {
        for place in fetches {
            state.scratch[place.0 as usize] = self.get(state, *place)?;
        }
        let net = &self.folded.shape.net;
        for &id in nodes {
            let node = net.node(id);
            let value = apply(node.op, node.kind, |id| net.node(id).kind, |id| state.scratch[id as usize]);
            state.scratch[id as usize] = value;
        }
        Some(())
    }

    fn step(&self, state: &mut State, step: &Step, now: usize) {
        let done = self.compute(state, &step.fetches, &step.nodes);
        let longest = state.coming.len();
        for &(wire, node) in &step.makes {
            let value = done.map(|()| state.scratch[node as usize]);
            if step.latency == 0 {
                self.set(state, (wire, 0), value);
            } else {
                state.coming[(now + step.latency as usize) % longest].push((wire, value));
            }
        }
    }

    fn output(&self, state: &mut State, (id, nodes, fetches): &(NodeId, Vec<NodeId>, Vec<Place>)) -> Option<i64> {
        self.compute(state, fetches, nodes)?;
        Some(state.scratch[*id as usize])
    }
}
