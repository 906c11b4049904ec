//! Exhaustive table check: proof that no vector can show a wrong table entry.
//!
//! A lookup, and the operations after it until another wire joins, are often a function of one wire of some twenty bits: the mantissa of a logarithm
//! or a root. All its values are tried. If none makes a difference to a wire that is read outside that function, the function rounds the last place
//! of the entry away, whatever the ports hold.

use std::collections::{BTreeSet, HashSet};
use std::ops::Range;

use super::fault::{Fault, Faults};
use super::graph::NodeId;

/// Most values of a wire that are tried.
const MOST_VALUES: u64 = 1 << 24;
/// Values of a task.
const TASK: u64 = 1 << 14;
/// Step between the values that are tried first. This number does not meet the intervals of a table at the same places.
const FIRST_STEP: usize = 61;

/// Function of one wire alone.
struct Function {
    /// The wire.
    of: NodeId,
    /// Smallest value of the wire in its last places, the constant low zeros below them, and the number of values.
    first: i64,
    zeros: u32,
    count: u64,
    /// Wires of the function, in order, and the number of them up to the last index of a lookup.
    wires: Vec<NodeId>,
    before_lookups: usize,
    /// Outputs: wires that a field shows or that are read with other wires, with the bits that count.
    out: Vec<(NodeId, u64)>,
    /// Wires that a lookup leads to, in order.
    behind_lookups: Vec<NodeId>,
    /// Table that is looked up, as a place in [`Faults::tables`], and its lookups with their indices.
    table: u32,
    lookups: Vec<(NodeId, NodeId)>,
}

impl Function {
    /// Function around a lookup. Its wire is the furthest earlier one with few values through which all inputs pass.
    fn around(lookup: NodeId, table: u32, faults: &Faults, wanted: &[u64]) -> Option<Self> {
        // A wire after a lookup that its range makes constant is constant in the wrong design too: it reads wires that are compared.
        let is_constant = |id: NodeId| faults.ranges.of(id).constant().is_some();
        let operands = |id: NodeId| faults.net.node(id).op.operands().filter(|&id| !is_constant(id));
        // Wires of which the lookup is a function. The last one is replaced by its operands until one is left.
        let mut before: BTreeSet<NodeId> = operands(lookup).collect();
        let mut furthest = None;
        while let Some(last) = before.pop_last() {
            let range = faults.ranges.of(last);
            let zeros = range.zeros.min(63);
            let is_value = range.low == 0 || range.low.trailing_zeros() >= zeros;
            let first = (range.low >> zeros) + i64::from(!is_value);
            let count = (range.high >> zeros).saturating_sub(first).saturating_add(1).max(0) as u64;
            if before.is_empty() && count <= MOST_VALUES {
                furthest = Some((last, first, zeros, count));
            } else if operands(last).next().is_none() {
                // A port next to other wires: no single wire before it determines the lookup.
                break;
            }
            before.extend(operands(last));
        }
        let (of, first, zeros, count) = furthest?;
        let mut inside = vec![false; faults.net.nodes.len()];
        inside[of as usize] = true;
        for id in of + 1..inside.len() as NodeId {
            let is_inside = |operand: NodeId| inside[operand as usize];
            inside[id as usize] = !is_constant(id) && operands(id).next().is_some() && operands(id).all(is_inside);
        }
        let wires: Vec<_> = (of + 1..inside.len() as NodeId).filter(|&id| inside[id as usize]).collect();
        let leaves = |id: NodeId| faults.readers[id as usize].iter().any(|&reader| !inside[reader as usize]);
        let out = wires.iter().filter(|&&id| faults.shown[id as usize] != 0 || leaves(id));
        let out = out.map(|&id| (id, wanted[id as usize])).collect();
        let lookups = &faults.tables[table as usize].lookups;
        let lookups: Vec<_> = lookups.iter().filter(|(lookup, _)| inside[*lookup as usize]).copied().collect();
        let last_index = lookups.iter().map(|&(_, index)| index).max();
        let before_lookups = wires.partition_point(|&id| Some(id) <= last_index);
        let mut is_behind = vec![false; inside.len()];
        for &id in &wires {
            let reads = operands(id).any(|operand| is_behind[operand as usize]);
            is_behind[id as usize] = reads || lookups.iter().any(|&(lookup, _)| lookup == id);
        }
        let behind_lookups = wires.iter().copied().filter(|&id| is_behind[id as usize]).collect();
        Some(Self { of, first, zeros, count, wires, before_lookups, out, behind_lookups, table, lookups })
    }
}

/// Some values of the wire that determines a lookup.
pub struct Task {
    /// Index of the function.
    function: usize,
    values: Range<u64>,
    /// Step between the values.
    step: usize,
}

/// Wires of the right and of the wrong design; they serve any number of tasks in turn.
pub struct Wires {
    right: Vec<i64>,
    wrong: Vec<i64>,
}

/// Entries of tables, and all values of the wires that determine their lookups.
pub struct Exhaustion<'a> {
    faults: &'a Faults<'a>,
    functions: Vec<Function>,
    /// Entries that every lookup reads as a function of few values.
    entries: HashSet<Fault>,
}

impl<'a> Exhaustion<'a> {
    /// Check of those faults among `some` that are entries of tables.
    pub fn new(faults: &'a Faults<'a>, some: impl Iterator<Item = Fault> + Clone) -> Self {
        let wanted = faults.wanted();
        let (mut functions, mut entries) = (Vec::<Function>::new(), HashSet::new());
        for (table, read) in (0..).zip(&faults.tables) {
            let of_table =
                || some.clone().filter(move |&fault| matches!(fault, Fault::Entry { table: of, .. } if of == table));
            if !faults.ranges.violations.is_empty() || of_table().next().is_none() {
                continue;
            }
            let known = functions.len();
            let has_all = read.lookups.iter().all(|lookup| {
                let is_in = |function: &Function| function.lookups.contains(lookup);
                functions[known..].iter().any(is_in)
                    || Function::around(lookup.0, table, faults, &wanted)
                        .map(|function| functions.push(function))
                        .is_some()
            });
            if has_all {
                entries.extend(of_table());
            } else {
                functions.truncate(known);
            }
        }
        Self { faults, functions, entries }
    }

    /// Entries that no value shows. `shown` runs tasks by any means and returns the entries that they show. All values are tried in two rounds, for
    /// most entries are shown by one of few values. Later wires are not computed for a value that reads none of the remaining entries.
    pub fn equal(mut self, shown: &dyn Fn(&Self, &[Task]) -> HashSet<Fault>) -> HashSet<Fault> {
        for step in [FIRST_STEP, 1] {
            let shown = shown(&self, &self.tasks(step));
            self.entries.retain(|fault| !shown.contains(fault));
        }
        self.entries
    }

    /// Tasks over every `step`-th value of the tables with remaining entries.
    fn tasks(&self, step: usize) -> Vec<Task> {
        let is_of = |fault: &Fault, of: u32| matches!(*fault, Fault::Entry { table, .. } if table == of);
        let tasks = |(function, Function { count, table, .. }): (usize, &Function)| {
            let count = if self.entries.iter().any(|fault| is_of(fault, *table)) { *count } else { 0 };
            let length = TASK * step as u64;
            let values = move |task| task * length..count.min((task + 1) * length);
            (0..count.div_ceil(length)).map(move |task| Task { function, values: values(task), step })
        };
        self.functions.iter().enumerate().flat_map(tasks).collect()
    }

    /// Wires for tasks.
    pub fn wires(&self) -> Wires {
        let ranges = self.faults.ranges.ranges.iter();
        let constants: Vec<i64> = ranges.map(|range| range.constant().unwrap_or(0)).collect();
        Wires { right: constants.clone(), wrong: constants }
    }

    /// Entries that make a difference for some value of a task.
    pub fn shown(&self, Task { function, values, step }: &Task, Wires { right, wrong }: &mut Wires) -> HashSet<Fault> {
        let Function {
            of,
            first,
            zeros,
            ref wires,
            before_lookups,
            ref out,
            ref behind_lookups,
            table,
            ref lookups,
            ..
        } = self.functions[*function];
        let (before, behind) = wires.split_at(before_lookups);
        let mut shown = HashSet::new();
        // Remaining entries: less and more of each index.
        let mut wanted = vec![[false; 2]; self.faults.tables[table as usize].indices.end as usize];
        for &fault in &self.entries {
            if let Fault::Entry { table: of, index, more } = fault
                && of == table
            {
                wanted[index as usize][usize::from(more)] = true;
            }
        }
        for value in values.clone().step_by(*step) {
            right[of as usize] = (first + value as i64) << zeros;
            let evaluate = |right: &mut [i64], ids: &[NodeId]| {
                ids.iter().for_each(|&id| right[id as usize] = self.faults.net.value(id, &[], right));
            };
            evaluate(right, before);
            let indices = lookups.iter().map(|&(_, at)| right[at as usize] as usize);
            let mut read: Vec<usize> = indices.filter(|&index| wanted[index] != [false; 2]).collect();
            if read.is_empty() {
                continue;
            }
            read.dedup();
            evaluate(right, behind);
            for id in wires.iter().copied().chain([of]) {
                wrong[id as usize] = right[id as usize];
            }
            for index in read {
                for more in [false, true] {
                    if !wanted[index][usize::from(more)] {
                        continue;
                    }
                    let fault = Fault::Entry { table, index: index as u32, more };
                    for &id in behind_lookups {
                        wrong[id as usize] = if lookups.iter().any(|&(lookup, _)| lookup == id) {
                            self.faults.value(fault, id, right, |id| wrong[id as usize])
                        } else {
                            self.faults.net.value(id, &[], wrong)
                        };
                    }
                    if out.iter().any(|&(id, bits)| (right[id as usize] ^ wrong[id as usize]) as u64 & bits != 0) {
                        shown.insert(fault);
                        wanted[index][usize::from(more)] = false;
                    }
                }
            }
        }
        shown
    }
}
