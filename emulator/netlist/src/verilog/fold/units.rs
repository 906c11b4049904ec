//! Shared units: operations that cost more than the choice of their operands.
//!
//! A *use* of a unit is one of these: a product of two wires; a part that the recording marked ([`crate::builder::part`]: a normaliser); a shift by a
//! count on a wire, with the increment that rounds it; a read of a table. Uses with the same operations on the same constants are of one [`UnitKind`],
//! whose wires hold any value of any of them. All other operations have hardware of their own, because an adder is no larger than a choice between
//! two wires.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::super::context::Context;
use super::super::error::VerilogError;
use super::super::excerpt::Excerpt;
use super::super::module::Module;
use super::super::share::{Group, Local, Run as GroupRun};
use super::shape::{Join, Shape};
use crate::graph::{Node, NodeId, Op};
use crate::interval::{Range, Ranges};
use crate::unit::Unit;

/// One use of a unit.
#[derive(Clone, Debug)]
pub(super) struct Use {
    /// Its operations, in order.
    pub(super) nodes: Vec<NodeId>,
    /// Wires that it reads, in the order of their first use.
    pub(super) inputs: Vec<NodeId>,
}

/// Hardware of a kind of unit.
#[derive(Clone, Debug)]
pub(super) enum Hardware {
    /// A multiplier of two signed operands of these widths, with a rank of registers before and one after it.
    Multiplier([u32; 2]),
    /// A module, with a rank of registers before and one after it.
    Module(Box<Module>),
}

/// Uses that the same hardware serves.
#[derive(Clone, Debug)]
pub(super) struct UnitKind {
    /// Name, also of the module.
    pub(super) name: String,
    /// Uses in the order of the netlist.
    pub(super) uses: Vec<Use>,
    /// Hardware of one unit.
    pub(super) hardware: Hardware,
    /// Places of the nodes that others read, with the ranges of these outcomes; a multiplier's outcome has all its bits.
    pub(super) outputs: Vec<(usize, Range)>,
}

impl UnitKind {
    /// Cycles from the choice of the operands to the outcome.
    pub(super) fn latency(&self) -> u32 {
        match &self.hardware {
            Hardware::Multiplier(_) => 2,
            Hardware::Module(module) => 2 + module.cuts,
        }
    }
}

fn hull(a: Range, b: Range) -> Range {
    Range { low: a.low.min(b.low), high: a.high.max(b.high), zeros: a.zeros.min(b.zeros) }
}

/// Bits of a range in two's complement, with its constant low zeros.
fn signed_width(range: Range) -> u32 {
    range.width() + u32::from(!range.signed())
}

/// Nodes of each candidate of a shared unit.
fn candidates(shape: &Shape) -> Vec<Vec<NodeId>> {
    let net = &shape.net;
    let mut parts: BTreeMap<u32, Vec<NodeId>> = BTreeMap::new();
    for (id, node) in net.iter() {
        if let Some(part) = node.part.filter(|_| shape.ranges.of(id).constant().is_none()) {
            parts.entry(part).or_default().push(id);
        }
    }
    let counts = |nodes: &[NodeId]| nodes.iter().any(|&id| matches!(net.node(id).op, Op::LeadingZeros(_)));
    parts.into_values().filter(|nodes| counts(nodes)).collect()
}

/// Shifts by counts and reads of tables outside `taken`, each with the increment that rounds it.
fn singles(shape: &Shape, taken: &BTreeSet<NodeId>) -> Vec<Vec<NodeId>> {
    let net = &shape.net;
    let mut users: HashMap<NodeId, Vec<NodeId>> = HashMap::new();
    for (id, node) in net.iter() {
        for operand in node.op.operands() {
            users.entry(operand).or_default().push(id);
        }
    }
    let is_output = |id| net.outputs.iter().any(|output| output.node == id);
    let mut found = Vec::new();
    for (id, node) in net.iter() {
        if taken.contains(&id) || shape.ranges.of(id).constant().is_some() {
            continue;
        }
        match node.op {
            Op::SarBy(..) | Op::ShlBy(..) => {
                let mut nodes = vec![id];
                if let Some([user]) = users.get(&id).map(Vec::as_slice)
                    && let Op::Add(_, one) = net.node(*user).op
                    && matches!(net.node(one).op, Op::Lit(_))
                    && !is_output(id)
                    && !taken.contains(user)
                {
                    nodes.push(*user);
                }
                found.push(nodes);
            }
            Op::Lookup(..) => found.push(vec![id]),
            _ => {}
        }
    }
    found
}

/// The product of two wires, if a node is one.
fn is_product(shape: &Shape, id: NodeId) -> bool {
    matches!(shape.net.node(id).op.unit(&shape.ranges, id), Unit::Multiplier(_))
}

/// Uses of each kind, grouped by their operations.
fn grouped(shape: &Shape, candidates: Vec<Vec<NodeId>>) -> Vec<(Local, Vec<Use>)> {
    let mut kinds: Vec<(Local, Vec<Use>)> = Vec::new();
    for nodes in candidates {
        let (local, inputs) = Local::new(&shape.net, &nodes);
        let own = Use { nodes, inputs };
        match kinds.iter_mut().find(|(known, _)| *known == local) {
            Some((_, uses)) => uses.push(own),
            None => kinds.push((local, vec![own])),
        }
    }
    kinds
}

/// Every kind of shared unit of a folded netlist; the first is the multiplier. The context has depth, target and names.
pub(super) fn kinds(shape: &Shape, context: Context) -> Result<Vec<UnitKind>, VerilogError> {
    let net = &shape.net;
    let copies = |uses: &[Use]| uses.iter().map(|own| shape.copies[own.nodes[0] as usize]).sum::<u32>();
    let mut all: Vec<(Local, Vec<Use>)> =
        grouped(shape, candidates(shape)).into_iter().filter(|(_, uses)| copies(uses) > 1).collect();
    let taken: BTreeSet<NodeId> = all.iter().flat_map(|(_, uses)| uses).flat_map(|own| own.nodes.clone()).collect();
    let is_table = |uses: &[Use]| matches!(net.node(uses[0].nodes[0]).op, Op::Lookup(..));
    let singles = grouped(shape, singles(shape, &taken));
    all.extend(singles.into_iter().filter(|(_, uses)| copies(uses) > 1 || is_table(uses)));

    let mut found = Vec::new();
    let products = (0..net.nodes.len() as NodeId).filter(|&id| is_product(shape, id) && !taken.contains(&id));
    let products: Vec<Use> =
        products.map(|id| Use { nodes: vec![id], inputs: net.node(id).op.operands().collect() }).collect();
    if !products.is_empty() {
        found.push(multiplier(shape, products, context.prefix));
    }
    let mut names: HashMap<&'static str, u32> = HashMap::new();
    for (_, uses) in all {
        let base = match net.node(uses[0].nodes[0]).op {
            Op::Lookup(..) => "table",
            Op::SarBy(..) if uses[0].nodes.len() > 1 => "rounding_shifter",
            Op::SarBy(..) => "right_shifter",
            Op::ShlBy(..) => "left_shifter",
            _ => "normaliser",
        };
        let number = names.entry(base).or_default();
        let name = format!("{base}_{number}");
        *number += 1;
        found.push(module_kind(shape, &name, uses, context)?);
    }
    Ok(found)
}

fn multiplier(shape: &Shape, mut uses: Vec<Use>, prefix: &str) -> UnitKind {
    let mut widths = [0, 0];
    for own in &mut uses {
        // The wider operand is the first one.
        own.inputs.sort_by_key(|&id| std::cmp::Reverse(signed_width(shape.ranges.of(id))));
        for (width, &input) in widths.iter_mut().zip(&own.inputs) {
            *width = signed_width(shape.ranges.of(input)).max(*width);
        }
    }
    UnitKind {
        name: format!("{prefix}multiplier"),
        uses,
        hardware: Hardware::Multiplier(widths),
        outputs: vec![(0, Range::of(0))],
    }
}

/// Kind whose hardware is a module of its operations.
fn module_kind(shape: &Shape, name: &str, uses: Vec<Use>, context: Context) -> Result<UnitKind, VerilogError> {
    let net = &shape.net;
    let mut read_outside = vec![false; uses[0].nodes.len()];
    for own in &uses {
        let inside: BTreeSet<NodeId> = own.nodes.iter().copied().collect();
        let others = net.iter().filter(|(id, _)| !inside.contains(id)).flat_map(|(_, node)| node.op.operands());
        let joined = shape.joins.values().flat_map(|join| match join {
            Join::Input(sources) => sources.clone(),
            Join::Outcome { of, .. } => vec![*of],
        });
        let outputs = net.outputs.iter().map(|output| output.node);
        let read: BTreeSet<NodeId> = others.chain(joined).chain(outputs).collect();
        for (flag, id) in read_outside.iter_mut().zip(&own.nodes) {
            *flag |= read.contains(id);
        }
    }
    let all_uses = |node: fn(&Use) -> &[NodeId], place: usize| {
        let ranges = uses.iter().map(|own| shape.ranges.of(node(own)[place]));
        ranges.reduce(hull).unwrap_or(Range::of(0))
    };
    // The operations as a netlist of their own, whose wires hold the values of all uses.
    let first = &uses[0];
    let mut excerpt = Excerpt::new(net, "unit");
    let mut range_of: HashMap<NodeId, Range> = HashMap::new();
    for (place, &id) in first.inputs.iter().enumerate() {
        let range = all_uses(|own| &own.inputs, place);
        excerpt.add_port(id, format!("in{place}"), 0, range);
        range_of.insert(id, range);
    }
    for (place, &id) in first.nodes.iter().enumerate() {
        excerpt.add_operation(id);
        range_of.insert(id, all_uses(|own| &own.nodes, place));
        if read_outside[place] {
            let tap = excerpt.tap(id, Some(0), format!("out{place}"), 0);
            excerpt.net.taps.push(tap);
        }
    }
    let Excerpt { net: unit, places, .. } = excerpt;
    let constant = |node: &Node| if let Op::Lit(value) = node.op { Range::of(value) } else { Range::of(0) };
    let mut ranges = Ranges { ranges: unit.nodes.iter().map(constant).collect(), violations: Vec::new() };
    for (id, range) in range_of {
        ranges.ranges[places[&id] as usize] = range;
    }
    let nodes = first.nodes.iter().map(|id| places[id]).collect();
    let run = GroupRun { stage: 0, nodes, inputs: unit.ports.iter().map(|port| port.node).collect() };
    let group = Group { name: name.to_owned(), runs: vec![run] };
    let context = Context { net: &unit, ranges: &ranges, ..context };
    let module = Module::new(context, &group, |_| true)?;
    let outputs = module.outputs.iter().map(|port| (port.place, port.format.range)).collect();
    Ok(UnitKind { name: module.name.clone(), uses, hardware: Hardware::Module(Box::new(module)), outputs })
}
