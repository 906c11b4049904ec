//! Tasks of a schedule: glue, choices among the runs of a block, uses of units; with the wires that each reads and makes.

use std::collections::{BTreeSet, HashMap};

use super::super::body::Body;
use super::super::value::Value;
use super::shape::{Join, Shape};
use super::units::UnitKind;
use crate::graph::NodeId;
use crate::target::Target;

/// An operation to be scheduled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Task {
    /// Glue: the wire of a node.
    Glue(NodeId),
    /// Choice among the wires that the runs of a block read.
    Choice(NodeId),
    /// Use of a unit: kind, number of the use.
    Use(usize, usize),
}

/// Outcome of one run of a block, as others read it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outcome {
    /// Its node.
    pub(super) id: NodeId,
    /// Node of the block.
    pub(super) of: NodeId,
    /// Wire that stands for that node.
    pub(super) base: NodeId,
    /// Number of the run.
    pub(super) run: u32,
}

/// Tasks in an order in which each comes after those that it needs.
#[derive(Clone, Debug)]
pub(super) struct Tasks {
    pub(super) all: Vec<Task>,
    /// Wires that a task reads.
    pub(super) reads: HashMap<Task, Vec<NodeId>>,
    /// Wires that it makes.
    pub(super) makes: HashMap<Task, Vec<NodeId>>,
    /// Levels of glue and of choices.
    pub(super) levels: HashMap<Task, u32>,
    /// Wires that a sum of products reads in each of its slots.
    pub(super) terms: HashMap<Task, Vec<Vec<NodeId>>>,
    /// Wire that each run of a choice reads; `None` for a constant.
    pub(super) choices: HashMap<NodeId, Vec<Option<NodeId>>>,
    /// Outcomes of blocks.
    pub(super) outcomes: Vec<Outcome>,
    /// Numbers of the tasks that each needs.
    pub(super) needs: Vec<BTreeSet<usize>>,
    /// Numbers of the tasks that need it.
    pub(super) users: Vec<Vec<usize>>,
}

/// Wire that stands for a node; `None` for a constant.
pub(super) fn base(body: &Body, id: NodeId) -> Option<NodeId> {
    match body.value(id) {
        Value::Bits(view) => Some(view.base),
        Value::Constant(_) => None,
    }
}

/// Bits of a wire that somebody reads; `None` if nobody reads any.
pub(super) fn bits_of(body: &Body, id: NodeId) -> Option<u64> {
    Some(body.reads.get(&id)?.values().fold(0, |all, bits| all | bits))
}

impl Tasks {
    /// Tasks of a folded netlist that lead to an output. `body` holds its values, and then the bits of every wire that somebody reads.
    pub(super) fn new(shape: &Shape, kinds: &[UnitKind], body: &mut Body, target: Target) -> Self {
        let mut tasks = Self {
            all: Vec::new(),
            reads: HashMap::new(),
            makes: HashMap::new(),
            levels: HashMap::new(),
            terms: HashMap::new(),
            choices: HashMap::new(),
            outcomes: Vec::new(),
            needs: Vec::new(),
            users: Vec::new(),
        };
        tasks.collect(shape, kinds, body, target);
        tasks.order();
        tasks.demand(shape, kinds, body, |_, _, _| 0);
        tasks.all.retain(|task| tasks.makes[task].iter().any(|id| body.reads.contains_key(id)));
        for reads in tasks.reads.values_mut().chain(tasks.terms.values_mut().flatten()) {
            reads.retain(|id| body.reads.contains_key(id));
        }
        for source in tasks.choices.values_mut().flatten() {
            *source = source.filter(|id| body.reads.contains_key(id));
        }
        tasks.outcomes.retain(|outcome| body.reads.contains_key(&outcome.id));
        tasks.order();
        tasks
    }

    fn collect(&mut self, shape: &Shape, kinds: &[UnitKind], body: &Body, target: Target) {
        for (kind, of_kind) in kinds.iter().enumerate() {
            for (number, own) in of_kind.uses.iter().enumerate() {
                let reads = own.reads().filter_map(|(_, id)| base(body, id)).collect();
                let makes = of_kind.outcomes(own).map(|(_, _, id)| id).collect();
                let task = Task::Use(kind, number);
                if !own.signs.is_empty() {
                    let mut terms = vec![Vec::new(); own.slots()];
                    own.reads().for_each(|(input, id)| terms[own.port(input).0].extend(base(body, id)));
                    self.terms.insert(task, terms);
                }
                self.add(task, reads, makes, 0);
            }
        }
        let mut joins: Vec<_> = shape.joins.iter().filter(|(id, _)| body.constant(**id).is_none()).collect();
        joins.sort_by_key(|(id, _)| **id);
        for (&id, join) in joins {
            match join {
                Join::Input(sources) => {
                    let of_runs: Vec<_> = sources.iter().map(|&source| base(body, source)).collect();
                    let reads = of_runs.iter().flatten().copied().collect();
                    self.choices.insert(id, of_runs);
                    self.add(Task::Choice(id), reads, vec![id], target.choice(sources.len() as u32));
                }
                Join::Outcome { of, run } => {
                    let base = base(body, *of).unwrap_or(*of);
                    self.outcomes.push(Outcome { id, of: *of, base, run: *run });
                }
            }
        }
        for &id in body.nodes {
            let is_wire = body.constant(id).is_none() && !body.values.contains_key(&id);
            if is_wire {
                let operands = body.operands(body.driver(id), 1);
                let reads = operands.into_iter().filter_map(|(operand, _)| base(body, operand)).collect();
                self.add(Task::Glue(id), reads, vec![id], body.levels(id));
            }
        }
    }

    fn add(&mut self, task: Task, reads: Vec<NodeId>, makes: Vec<NodeId>, levels: u32) {
        self.all.push(task);
        self.reads.insert(task, reads);
        self.makes.insert(task, makes);
        self.levels.insert(task, levels);
    }

    /// Sorts the tasks: each after those that it needs, and else by its first wire.
    fn order(&mut self) {
        let first = |task: &Task| self.makes[task].first().copied().unwrap_or(NodeId::MAX);
        let mut all = std::mem::take(&mut self.all);
        all.sort_by_key(|task| (first(task), *task));
        let (needs, users) = self.links(&all);
        let mut waits: Vec<usize> = needs.iter().map(BTreeSet::len).collect();
        let mut free: BTreeSet<usize> = (0..all.len()).filter(|&task| waits[task] == 0).collect();
        let mut order = Vec::new();
        while let Some(task) = free.pop_first() {
            order.push(all[task]);
            for &user in &users[task] {
                waits[user] -= 1;
                if waits[user] == 0 {
                    free.insert(user);
                }
            }
        }
        (self.needs, self.users) = self.links(&order);
        self.all = order;
    }

    /// For each task the numbers of those that it needs, and of those that need it.
    fn links(&self, all: &[Task]) -> (Vec<BTreeSet<usize>>, Vec<Vec<usize>>) {
        let makers: HashMap<NodeId, usize> = all
            .iter()
            .enumerate()
            .flat_map(|(number, task)| self.makes[task].iter().map(move |&id| (id, number)))
            .collect();
        let bases: HashMap<NodeId, NodeId> = self.outcomes.iter().map(|outcome| (outcome.id, outcome.base)).collect();
        let needs: Vec<BTreeSet<usize>> = all
            .iter()
            .map(|task| {
                let reads = self.reads[task].iter().map(|id| bases.get(id).unwrap_or(id));
                reads.filter_map(|id| makers.get(id).copied()).collect()
            })
            .collect();
        let mut users = vec![Vec::new(); all.len()];
        for (number, needs) in needs.iter().enumerate() {
            for &need in needs {
                users[need].push(number);
            }
        }
        (needs, users)
    }

    /// Finds the bits of every wire that somebody reads, from the outputs backwards. `register` gives the register of a wire (the second argument)
    /// that a task reads for one of its runs or in one of its slots (the third), or that the outputs read.
    pub(super) fn demand(
        &self,
        shape: &Shape,
        kinds: &[UnitKind],
        body: &mut Body,
        register: impl Fn(Option<Task>, NodeId, u32) -> u32,
    ) {
        body.reads.clear();
        let read = |body: &mut Body, task: Option<Task>, id: NodeId, bits: u128, part: u32| {
            if let Some(base) = base(body, id) {
                body.read(id, bits, register(task, base, part));
            }
        };
        for output in &shape.net.outputs {
            let bits = body.all_bits(output.node);
            read(body, None, output.node, bits, 0);
        }
        for &task in self.all.iter().rev() {
            for outcome in self.outcomes.iter().filter(|outcome| self.makes[&task].contains(&outcome.base)) {
                if let Some(bits) = bits_of(body, outcome.id) {
                    // It is taken in the cycle in which it is made.
                    body.read(outcome.of, bits.into(), 0);
                }
            }
            match task {
                Task::Glue(id) => {
                    let Some(bits) = bits_of(body, id) else { continue };
                    for (operand, bits) in body.operands(body.driver(id), bits) {
                        read(body, Some(task), operand, bits, 0);
                    }
                }
                Task::Choice(id) => {
                    let Some(bits) = bits_of(body, id) else { continue };
                    for (run, &source) in (0..).zip(shape.sources(id)) {
                        read(body, Some(task), source, bits.into(), run);
                    }
                }
                Task::Use(kind, number) => {
                    if self.makes[&task].iter().any(|&id| bits_of(body, id).is_some()) {
                        let own = &kinds[kind].uses[number];
                        for (input, id) in own.reads() {
                            let bits = body.all_bits(id);
                            read(body, Some(task), id, bits, own.port(input).0 as u32);
                        }
                    }
                }
            }
        }
    }

    /// Brings a task forward in an order of urgency, with all that it needs.
    pub(super) fn bring_forward(&self, task: usize, ahead: &mut [u32]) {
        let mut needed = BTreeSet::from([task]);
        while let Some(task) = needed.pop_last() {
            ahead[task] += 1;
            needed.extend(&self.needs[task]);
        }
    }

    /// Levels from each task to the last outcome; `of_use` gives those of a use of a unit, by kind and number.
    pub(super) fn heights(&self, of_use: impl Fn(usize, usize) -> u32) -> Vec<u32> {
        let mut heights = vec![0; self.all.len()];
        for (number, task) in self.all.iter().enumerate().rev() {
            let own = match *task {
                Task::Use(kind, number) => of_use(kind, number),
                _ => self.levels[task],
            };
            heights[number] = own + self.users[number].iter().map(|&user| heights[user]).max().unwrap_or(0);
        }
        heights
    }
}
