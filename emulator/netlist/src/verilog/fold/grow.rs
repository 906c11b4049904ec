//! Growth of shared units: an operation beside the uses of a unit joins it where that saves hardware.
//!
//! An operation of its own costs as many lookup tables as it has bits, for each use. In a shared unit it exists once, but each new operand is a
//! choice, which costs two thirds of a table for each bit and use. So what needs no new operand, or saves one, is nearly free: the exponent of a
//! normaliser, the clamp before a shift, the index of a table.

use std::collections::BTreeSet;

use super::super::share::{Operand, Operation};
use super::compound::{Compound, Content, Use};
use super::shape::{Join, Shape};
use crate::graph::{NodeId, Op};
use crate::unit::{Unit, signed_digits};

/// Cost of a lookup table, in the unit of gains.
const TABLE: i64 = 6;
/// Cost of a choice, a bit and source.
const CHOICE: i64 = 4;
/// Cost of a constant among the sources of a choice, a bit.
const CONSTANT: i64 = 1;
/// Time of a unit, in levels.
const UNIT: u32 = 30;
/// Time of a product, in levels.
const PRODUCT: u32 = 14;

/// An operation that may join a compound. New inputs have the numbers after those of the compound, but the first one takes the input `before`.
#[derive(Clone, Debug, PartialEq)]
struct Step {
    /// Input that the operation makes; `None` if it follows the compound's operations.
    before: Option<usize>,
    operation: Operation,
}

/// A step, and the uses that have its operation, with their nodes.
#[derive(Clone, Debug)]
struct Candidate {
    compound: usize,
    step: Step,
    members: Vec<(usize, NodeId)>,
}

/// Compounds that grow.
struct Growth<'a> {
    shape: &'a Shape,
    compounds: Vec<Compound>,
    /// Compound and use of each node.
    owners: Vec<Option<(usize, usize)>>,
    /// Operations that read each node.
    readers: Vec<Vec<NodeId>>,
    /// Nodes that an output or a join reads.
    escapes: Vec<bool>,
    /// Operations of sums of products.
    of_sums: &'a BTreeSet<NodeId>,
}

/// Lookup tables of an operation; `None` for a product, a port or a constant, which never join a unit.
fn tables(shape: &Shape, id: NodeId) -> Option<i64> {
    let op = shape.net.node(id).op;
    Some(match op.unit(&shape.ranges, id) {
        Unit::Wires => 0,
        Unit::Nothing | Unit::Multiplier(_) | Unit::Table { .. } => return None,
        Unit::Mask => 0,
        Unit::Adder { bits, .. } | Unit::Comparator { bits } | Unit::Select { bits } => bits.into(),
        Unit::ConstantMultiplier { by, operand } => i64::from(operand.width()) * i64::from(signed_digits(by)),
        Unit::Shifter { bits, places } => i64::from(bits) * i64::from(places),
        Unit::LeadingZeros { bits } => 2 * i64::from(bits),
        Unit::Logic { bits } => i64::from(bits.div_ceil(2)),
    })
}

impl Growth<'_> {
    /// Levels before each node, every use of a compound taken as one operation.
    fn times(&self) -> Vec<u32> {
        let mut times = vec![None; self.shape.net.nodes.len()];
        (0..times.len() as NodeId).for_each(|id| _ = self.time(id, &mut times));
        times.into_iter().map(Option::unwrap_or_default).collect()
    }

    fn time(&self, id: NodeId, times: &mut Vec<Option<u32>>) -> u32 {
        if let Some(time) = times[id as usize] {
            return time;
        }
        let op = self.shape.net.node(id).op;
        let (operands, own): (Vec<NodeId>, u32) = match (self.shape.joins.get(&id), self.owners[id as usize]) {
            (Some(Join::Input(sources)), _) => (sources.clone(), 0),
            (Some(&Join::Outcome { of, .. }), _) => (vec![of], 0),
            (None, Some((compound, number))) => {
                (self.compounds[compound].uses[number].reads().map(|(_, id)| id).collect(), UNIT)
            }
            (None, None) => {
                let own = match tables(self.shape, id) {
                    None => PRODUCT,
                    Some(0) => 0,
                    Some(_) => 2,
                };
                (op.operands().collect(), own)
            }
        };
        let time = own + operands.into_iter().map(|operand| self.time(operand, times)).max().unwrap_or(0);
        times[id as usize] = Some(time);
        time
    }

    /// True if a node is an operation of its own that may join a unit.
    fn is_free(&self, id: NodeId) -> bool {
        self.owners[id as usize].is_none()
            && !self.of_sums.contains(&id)
            && !self.shape.joins.contains_key(&id)
            && self.shape.ranges.of(id).constant().is_none()
            && tables(self.shape, id).is_some()
    }

    /// Operation of a node as a step of a use. New operands are inputs from `next` on; with `general` constants are new, too.
    fn operation(&self, own: &Use, id: NodeId, mut next: Vec<usize>, general: bool) -> (Operation, Vec<NodeId>) {
        let net = &self.shape.net;
        let mut new = Vec::new();
        let operation = Operation::new(net.node(id), |operand| match (own.operand(operand), net.node(operand).op) {
            (Some(known), _) => known,
            (None, Op::Lit(value)) if !general => Operand::Constant(value),
            (None, _) => {
                let at = new.iter().position(|&other| other == operand).unwrap_or_else(|| {
                    new.push(operand);
                    new.len() - 1
                });
                while next.len() <= at {
                    next.push(next.last().map_or(0, |last| last + 1));
                }
                Operand::Input(next[at])
            }
        });
        (operation, new)
    }

    /// Steps that some use of a compound could take.
    fn candidates(&self, number: usize, times: &[u32]) -> Vec<Candidate> {
        let compound = &self.compounds[number];
        let inputs = compound.local.inputs.len();
        let mut found: Vec<Candidate> = Vec::new();
        let mut add = |before: Option<usize>, operation: Operation, member: (usize, NodeId)| {
            let step = Step { before, operation };
            match found.iter_mut().find(|candidate| candidate.step == step) {
                Some(Candidate { members, .. }) if members.iter().any(|&(own, _)| own == member.0) => {}
                Some(candidate) => candidate.members.push(member),
                None => found.push(Candidate { compound: number, step, members: vec![member] }),
            }
        };
        for (at, own) in compound.uses.iter().enumerate() {
            let there = own.reads().map(|(_, id)| times[id as usize]).max().unwrap_or(0);
            for made in own.operations() {
                for &reader in self.readers[made as usize].iter().filter(|&&reader| self.is_free(reader)) {
                    for general in [false, true] {
                        let (operation, new) = self.operation(own, reader, vec![inputs], general);
                        if new.iter().all(|&id| times[id as usize] <= there) {
                            add(None, operation, (at, reader));
                        }
                    }
                }
            }
            for (input, made) in own.reads().filter(|&(_, id)| self.is_free(id)) {
                let only_here = self.readers[made as usize]
                    .iter()
                    .all(|&reader| self.owners[reader as usize] == Some((number, at)));
                if only_here && !self.escapes[made as usize] {
                    for general in [false, true] {
                        let (operation, _) = self.operation(own, made, vec![input, inputs], general);
                        add(Some(input), operation, (at, made));
                    }
                }
            }
        }
        found.retain(|candidate| candidate.step.before.is_none_or(|input| compound.is_total(candidate, input)));
        found
    }

    /// Gain of a step: lookup tables that it saves, in units of a sixth.
    fn gain(&self, candidate: &Candidate) -> i64 {
        let Candidate { step, members, .. } = candidate;
        let compound = &self.compounds[candidate.compound];
        let width = |id: NodeId| i64::from(self.shape.ranges.of(id).width());
        let own: Vec<i64> = members.iter().map(|&(_, id)| tables(self.shape, id).unwrap_or(0)).collect();
        let saved = own.iter().sum::<i64>() - own.iter().max().copied().unwrap_or(0);
        // A new input has a register, too.
        let mut choices = 0;
        let mut widths: Vec<i64> = vec![0; step.operation.operands.len()];
        for &(at, id) in members {
            let of_use = &compound.uses[at];
            let new = |&(place, operand): &(usize, NodeId)| {
                matches!(step.operation.operands[place], Operand::Input(_)) && of_use.operand(operand).is_none()
            };
            let operands: Vec<NodeId> = self.shape.net.node(id).op.operands().collect();
            for (place, operand) in operands.into_iter().enumerate().filter(new) {
                widths[place] = width(operand).max(widths[place]);
                let is_constant = self.shape.ranges.of(operand).constant().is_some();
                choices += width(operand) * if is_constant { CONSTANT } else { CHOICE };
            }
            if step.before.is_some() {
                choices -= width(id) * CHOICE;
            }
        }
        let inputs: i64 = widths.iter().sum::<i64>() * TABLE;
        let replaced = step.before.map_or(0, |_| widths.iter().copied().max().unwrap_or(0) * TABLE);
        saved * TABLE - choices - (inputs - replaced)
    }

    fn apply(&mut self, candidate: Candidate) {
        let Candidate { compound: number, step, members } = candidate;
        let compound = &mut self.compounds[number];
        let net = &self.shape.net;
        let count = compound.local.inputs.len();
        let place = compound.local.operations.len();
        if let Some(input) = step.before {
            for operand in compound.local.operations.iter_mut().flat_map(|operation| &mut operation.operands) {
                if *operand == Operand::Input(input) {
                    *operand = Operand::Place(place);
                }
            }
        }
        for (at, own) in compound.uses.iter_mut().enumerate() {
            let member = members.iter().find(|member| member.0 == at).map(|member| member.1);
            let mut wires: Vec<(usize, NodeId)> = Vec::new();
            match member {
                Some(id) => {
                    for (&operand, wire) in step.operation.operands.iter().zip(net.node(id).op.operands()) {
                        if let Operand::Input(input) = operand {
                            wires.push((input, wire));
                        }
                    }
                    own.nodes.push(Content::Node(id));
                    self.owners[id as usize] = Some((number, at));
                    if let Some(input) = step.before {
                        own.inputs[input] = Content::Constant(0);
                    }
                }
                None => own.nodes.push(match step.before.map(|input| own.inputs[input]) {
                    Some(Content::Node(id)) => Content::Copy(id),
                    Some(other) => other,
                    None => Content::Nothing,
                }),
            }
            let absent = if step.before.is_some() { Content::Constant(0) } else { Content::Nothing };
            let new =
                step.operation.operands.iter().filter(|operand| matches!(operand, Operand::Input(n) if *n >= count));
            let total =
                new.map(|operand| if let Operand::Input(n) = operand { n + 1 } else { 0 }).max().unwrap_or(count);
            own.inputs.resize(total, absent);
            for (input, wire) in wires {
                own.inputs[input] = Content::Node(wire);
            }
        }
        // Any member shows the kinds of the inputs.
        for (operand, wire) in step.operation.operands.iter().zip(net.node(members[0].1).op.operands()) {
            if let &Operand::Input(input) = operand {
                let kind = net.node(wire).kind;
                if input < compound.local.inputs.len() {
                    compound.local.inputs[input] = kind;
                } else {
                    compound.local.inputs.push(kind);
                }
            }
        }
        compound.local.operations.push(step.operation);
    }
}

impl Compound {
    /// True if a step before an input serves every use: each has its operation, or passes its wire through it with a zero beside it.
    fn is_total(&self, candidate: &Candidate, input: usize) -> bool {
        let Operation { op, operands, .. } = &candidate.step.operation;
        let passes = matches!(op, Op::Add(..) | Op::Sub(..) | Op::Or(..) | Op::Xor(..))
            && *operands == [Operand::Input(input), Operand::Input(self.local.inputs.len())];
        passes || candidate.members.len() == self.uses.len()
    }

    /// Removes an operation that only passes bits on, and that no other operation of the unit reads or that alone reads an input.
    fn without_ends(&mut self, is_wiring: impl Fn(NodeId) -> bool) {
        while let Some(place) = (0..self.local.operations.len()).find(|&place| self.is_end(place, &is_wiring)) {
            let removed = self.local.operations.remove(place);
            for operand in self.local.operations.iter_mut().flat_map(|operation| &mut operation.operands) {
                match *operand {
                    Operand::Place(other) if other > place => *operand = Operand::Place(other - 1),
                    Operand::Place(other) if other == place => *operand = removed.operands[0],
                    _ => {}
                }
            }
            if let Operand::Input(input) = removed.operands[0]
                && self.local.operations.iter().any(|operation| operation.operands.contains(&removed.operands[0]))
            {
                self.local.inputs[input] = removed.kind;
                for own in &mut self.uses {
                    if let Content::Node(id) | Content::Copy(id) = own.nodes[place] {
                        own.inputs[input] = Content::Node(id);
                    }
                }
            }
            self.uses.iter_mut().for_each(|own| _ = own.nodes.remove(place));
        }
    }

    fn is_end(&self, place: usize, is_wiring: &impl Fn(NodeId) -> bool) -> bool {
        let operation = &self.local.operations[place];
        let nodes = || self.uses.iter().filter_map(|own| own.nodes[place].node());
        if operation.operands.len() != 1 || nodes().next().is_none() || !nodes().all(is_wiring) {
            return false;
        }
        let reads = |operand: Operand| {
            let operands = self.local.operations.iter().flat_map(|operation| &operation.operands);
            operands.filter(|&&other| other == operand).count()
        };
        let is_last = reads(Operand::Place(place)) == 0;
        is_last || matches!(operation.operands[0], Operand::Input(_)) && reads(operation.operands[0]) == 1
    }

    /// Sorts the operations: each after those that it reads. Drops inputs that nobody reads.
    fn sort(&mut self) {
        let operations = &self.local.operations;
        let mut order: Vec<usize> = Vec::new();
        while order.len() < operations.len() {
            let is_ready = |&place: &usize| {
                !order.contains(&place)
                    && operations[place].operands.iter().all(|operand| match operand {
                        Operand::Place(other) => order.contains(other),
                        _ => true,
                    })
            };
            let Some(next) = (0..operations.len()).find(is_ready) else { break };
            order.push(next);
        }
        let is_read =
            |input: &usize| operations.iter().any(|operation| operation.operands.contains(&Operand::Input(*input)));
        let inputs: Vec<usize> = (0..self.local.inputs.len()).filter(is_read).collect();
        let moved = |operand: Operand| match operand {
            Operand::Place(place) => Operand::Place(order.iter().position(|&other| other == place).unwrap_or(place)),
            Operand::Input(input) => Operand::Input(inputs.iter().position(|&other| other == input).unwrap_or(input)),
            Operand::Constant(_) => operand,
        };
        let sorted = order.iter().map(|&place| {
            let Operation { op, kind, ref operands } = operations[place];
            Operation { op, kind, operands: operands.iter().copied().map(moved).collect() }
        });
        let sorted = sorted.collect();
        for own in &mut self.uses {
            own.nodes = order.iter().map(|&place| own.nodes[place]).collect();
            own.inputs = inputs.iter().map(|&input| own.inputs[input]).collect();
        }
        self.local.inputs = inputs.iter().map(|&input| self.local.inputs[input]).collect();
        self.local.operations = sorted;
    }
}

/// Compounds with all that saves hardware in them.
/// Operations of sums of products join no unit.
pub(super) fn grown(shape: &Shape, compounds: Vec<Compound>, of_sums: &BTreeSet<NodeId>) -> Vec<Compound> {
    let net = &shape.net;
    let mut owners = vec![None; net.nodes.len()];
    for (number, compound) in compounds.iter().enumerate() {
        for (at, own) in compound.uses.iter().enumerate() {
            own.operations().iter().for_each(|&id| owners[id as usize] = Some((number, at)));
        }
    }
    let mut readers = vec![Vec::new(); net.nodes.len()];
    for (id, node) in net.iter() {
        node.op.operands().for_each(|operand| readers[operand as usize].push(id));
    }
    let mut escapes = vec![false; net.nodes.len()];
    let joined = shape.joins.values().flat_map(|join| match join {
        Join::Input(sources) => sources.clone(),
        Join::Outcome { of, .. } => vec![*of],
    });
    for id in joined.chain(net.outputs.iter().map(|output| output.node)) {
        escapes[id as usize] = true;
    }
    let mut growth = Growth { shape, compounds, owners, readers, escapes, of_sums };
    loop {
        let times = growth.times();
        let all = (0..growth.compounds.len()).flat_map(|number| growth.candidates(number, &times));
        let scored = all.map(|candidate| (growth.gain(&candidate), candidate));
        // An operation that only passes bits on saves nothing, but leads to others.
        let useful = scored.filter(|(gain, candidate)| {
            *gain > 0 || *gain == 0 && candidate.members.len() > 1 && candidate.step.operation.operands.len() == 1
        });
        let Some((_, best)) = useful.max_by_key(|(gain, candidate)| (*gain, candidate.members.len())) else { break };
        growth.apply(best);
    }
    let is_wiring = |id: NodeId| tables(shape, id) == Some(0);
    for compound in &mut growth.compounds {
        compound.without_ends(is_wiring);
        compound.sort();
    }
    growth.compounds
}
