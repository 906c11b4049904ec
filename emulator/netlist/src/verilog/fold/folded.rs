//! A folded netlist with its schedule, and its figures.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use serde::Serialize;

use super::super::body::Body;
use super::super::context::Context;
use super::super::error::VerilogError;
use super::super::share::Group;
use super::super::text::identifier;
use super::binding;
use super::compound::Use;
use super::schedule::Schedule;
use super::shape::{Shape, signed_width};
use super::tasks::{self, Task, Tasks};
use super::units::{self, Hardware, UnitKind};
use crate::graph::{NodeId, Op};
use crate::interval::Ranges;
use crate::unit::Unit;

/// A folded netlist with its schedule.
#[derive(Clone, Debug)]
pub struct Folded {
    pub(super) shape: Shape,
    pub(super) kinds: Vec<UnitKind>,
    pub(super) tasks: Tasks,
    pub(super) schedule: Schedule,
    /// Highest register of each wire that somebody reads; 0 is the wire itself.
    pub(super) registers: HashMap<NodeId, u32>,
    multipliers: u32,
    depth: u32,
}

/// Use of the units of a kind.
#[derive(Clone, Debug, Serialize)]
pub struct UnitSummary {
    /// Name of the unit's module.
    pub name: String,
    /// Units of this kind.
    pub units: u32,
    /// Operations that use them, for each fragment.
    pub uses: u32,
    /// Cycles from the choice of the operands to the outcome.
    pub latency: u32,
}

/// Figures of a folded design.
#[derive(Clone, Debug, Serialize)]
pub struct FoldSummary {
    /// Cycles from a fragment to the next.
    pub interval: u32,
    /// Least interval that the multipliers allow.
    pub bound: u32,
    /// Cycles from an accepted input to its output.
    pub latency: u32,
    /// Most levels of logic in a cycle.
    pub depth: u32,
    /// Kinds of units.
    pub units: Vec<UnitSummary>,
    /// Operations with hardware of their own.
    pub glue: u32,
    /// Registers that hold a value from one cycle to later ones.
    pub values: u32,
}

/// Checks that no operation besides products, which take cycles of their own, has more levels than fit in a cycle.
fn check_depth(shape: &Shape, flat: Context, depth: u32) -> Result<(), VerilogError> {
    let context = Context { net: &shape.net, ranges: &shape.ranges, ..flat };
    let unit = |id: NodeId| shape.net.node(id).op.unit(&shape.ranges, id);
    let ids = (0..shape.net.nodes.len() as NodeId).filter(|&id| !matches!(unit(id), Unit::Multiplier(_)));
    match ids.map(|id| (context.levels(id), id)).max() {
        Some((levels, id)) if levels > depth => Err(VerilogError::TooDeep {
            operation: shape.net.node(id).op.name(),
            levels,
            depth,
            least: levels,
            origin: shape.net.origin(id),
        }),
        _ => Ok(()),
    }
}

/// Most products in a sum that shares a multiplier: the first of these that has the shortest interval. Short sums leave adders, but find room where
/// hardly a slot is free.
const LONGEST_SUMS: [usize; 3] = [usize::MAX, 4, 3];

/// Schedules a folded netlist on its units, for a number of multipliers and the most levels in a cycle. The body has the values of its wires.
fn scheduled<R>(
    shape: &Shape,
    kinds: &[UnitKind],
    flat: Context,
    budget: [u32; 2],
    with: impl FnOnce(Body, Tasks, Schedule) -> R,
) -> Result<R, VerilogError> {
    let context = Context { net: &shape.net, ranges: &shape.ranges, depth: None, ..flat };
    let of_units: BTreeSet<NodeId> = kinds.iter().flat_map(|kind| &kind.uses).flat_map(Use::operations).collect();
    let (inputs, nodes): (Vec<NodeId>, Vec<NodeId>) = (0..shape.net.nodes.len() as NodeId)
        .partition(|id| of_units.contains(id) || matches!(shape.net.node(*id).op, Op::Port(_)));
    let mut body = Body::placed(context, &nodes, &inputs)?;
    let tasks = Tasks::new(shape, kinds, &mut body, flat.target);
    let schedule = Schedule::new(shape, kinds, &tasks, budget, flat.target);
    Ok(with(body, tasks, schedule))
}

impl Folded {
    /// Folds a proven design on a number of multipliers. `own` are the ranges of every wire by itself; the body has the values of its wires.
    pub(super) fn new<R>(
        flat: Context,
        own: &Ranges,
        groups: &[Group],
        multipliers: u32,
        with: impl FnOnce(&Self, Body) -> Result<R, VerilogError>,
    ) -> Result<(Self, R), VerilogError> {
        let depth = flat.depth.unwrap_or(flat.target.folded_depth());
        let shape = Shape::new(flat.net, own, groups);
        check_depth(&shape, flat, depth)?;
        let budget = [multipliers, depth];
        let mut shortest: Option<(u32, Vec<UnitKind>)> = None;
        for longest in LONGEST_SUMS {
            let kinds = units::kinds(&shape, [multipliers as usize, longest], flat)?;
            let interval = scheduled(&shape, &kinds, flat, budget, |_, _, schedule| schedule.interval)?;
            if shortest.as_ref().is_none_or(|(least, _)| interval < *least) {
                shortest = Some((interval, kinds));
            }
        }
        let (_, mut kinds) = shortest.expect("some length is tried");
        let of_shape = shape.clone();
        scheduled(&of_shape, &kinds.clone(), flat, budget, |mut body, tasks, mut schedule| {
            let bits = |id| signed_width(shape.ranges.of(id));
            binding::improve(&shape, &mut kinds, &mut schedule, |id| tasks::base(&body, id), bits);
            tasks.demand(&shape, &kinds, &mut body, |task, base, part| {
                let cycle = match task {
                    None => schedule.last,
                    Some(Task::Choice(id)) => schedule.cycles[&Task::Choice(id)] + part * schedule.period(&shape, id),
                    Some(task) => schedule.slot_cycle(task, part as usize),
                };
                schedule.register(&shape, base, cycle)
            });
            let highest = |ranks: &BTreeMap<u32, u64>| ranks.keys().copied().max().unwrap_or(0);
            let registers = body.reads.iter().map(|(&id, ranks)| (id, highest(ranks))).collect();
            let folded = Self { shape, kinds, tasks, schedule, registers, multipliers, depth };
            let made = with(&folded, body)?;
            Ok((folded, made))
        })?
    }

    /// Cycles from an accepted input to its output: the outcome has a register of its own.
    pub(super) fn latency(&self) -> u32 {
        self.schedule.last + 2
    }

    /// Name of a wire before it is made unique.
    pub(super) fn wire_name(&self, id: NodeId, number: u32) -> String {
        let net = &self.shape.net;
        if let Op::Port(port) = net.node(id).op {
            return identifier(&net.ports[port as usize].name);
        }
        match net.taps.iter().find(|tap| tap.node == id) {
            Some(tap) => identifier(&net.tap_name(tap)),
            None => format!("n{number}_{}", net.node(id).op.name()),
        }
    }

    /// Figures of the design.
    pub fn summary(&self) -> FoldSummary {
        let units = self.kinds.iter().zip(&self.schedule.units).map(|(kind, &units)| UnitSummary {
            name: kind.name.clone(),
            units,
            uses: kind.slots(&self.shape),
            latency: kind.latency(),
        });
        let products = self.kinds.iter().find(|kind| matches!(kind.hardware, Hardware::Multiplier { .. }));
        FoldSummary {
            interval: self.schedule.interval,
            bound: products.map_or(1, |kind| kind.slots(&self.shape).div_ceil(self.multipliers)),
            latency: self.latency(),
            depth: self.depth,
            units: units.collect(),
            glue: self.tasks.all.iter().filter(|task| matches!(task, Task::Glue(_))).count() as u32,
            values: self.registers.values().sum(),
        }
    }
}
