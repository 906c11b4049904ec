//! Shared units: operations that cost more than the choice of their operands.
//!
//! A *use* of a unit is one of these: a product of two wires; a part that the recording marked ([`crate::builder::part`]: a normaliser); a shift by a
//! count on a wire, with the increment that rounds it; a read of a table. Uses with the same operations on the same constants are of one [`UnitKind`],
//! whose wires hold any value of any of them. All other operations have hardware of their own, because an adder is no larger than a choice between
//! two wires.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::super::context::Context;
use super::super::error::VerilogError;
use super::super::excerpt::port;
use super::super::module::Module;
use super::super::share::{Group, Operand, Run as GroupRun};
use super::compound::{Compound, Content, PRODUCT, SUM, Use, compounds, joined};
use super::grow::grown;
use super::shape::{Join, Shape, signed_width};
use super::sums::sums;
use crate::graph::{Kind, Net, Node, NodeId, Op, Run, Tap};
use crate::interval::{Range, Ranges};

/// Hardware of a kind of unit.
#[derive(Clone, Debug)]
pub(super) enum Hardware {
    /// A multiplier of two signed operands, with a rank of registers before and one after it.
    Multiplier {
        /// Bits of the operands.
        widths: [u32; 2],
        /// Bits of the accumulator behind it.
        sum_bits: u32,
    },
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
    /// Outcomes of a use that others may read: place in the unit, range there, node.
    pub(super) fn outcomes(&self, own: &Use) -> impl Iterator<Item = (usize, Range, NodeId)> {
        let all = self.outputs.iter().filter_map(|&(place, range)| Some((place, range, own.nodes.get(place)?.node()?)));
        all.filter(|&(place, _, id)| own.place(id) == Some(place))
    }

    /// Cycles from the choice of the operands to the outcome.
    pub(super) fn latency(&self) -> u32 {
        match &self.hardware {
            Hardware::Multiplier { .. } => 2,
            Hardware::Module(module) => 2 + module.cuts,
        }
    }

    /// Cycles from the last operands of a use to its outcome: an accumulator takes one more than its multiplier.
    pub(super) fn latency_of(&self, own: &Use) -> u32 {
        self.latency() + u32::from(!own.signs.is_empty())
    }

    /// Slots that its uses take for a fragment.
    pub(super) fn slots(&self, shape: &Shape) -> u32 {
        self.uses.iter().map(|own| shape.copies[own.first() as usize] * own.slots() as u32).sum()
    }
}

fn hull(a: Range, b: Range) -> Range {
    Range { low: a.low.min(b.low), high: a.high.max(b.high), zeros: a.zeros.min(b.zeros) }
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

/// Every kind of shared unit of a folded netlist; the first is the multiplier, of which there are `multipliers`. A sum has at most `longest` products.
/// The context has depth, target and names.
pub(super) fn kinds(
    shape: &Shape,
    [multipliers, longest]: [usize; 2],
    context: Context,
) -> Result<Vec<UnitKind>, VerilogError> {
    let net = &shape.net;
    let copies = |uses: &[Use]| uses.iter().map(|own| shape.copies[own.first() as usize]).sum::<u32>();
    let mut all = joined(compounds(net, candidates(shape)));
    all.retain(|compound| copies(&compound.uses) > 1);
    let taken: BTreeSet<NodeId> = all.iter().flat_map(|compound| &compound.uses).flat_map(Use::operations).collect();
    let is_table = |uses: &[Use]| matches!(net.node(uses[0].first()).op, Op::Lookup(..));
    let singles = compounds(net, singles(shape, &taken));
    all.extend(singles.into_iter().filter(|single| copies(&single.uses) > 1 || is_table(&single.uses)));
    let named: Vec<&str> = all.iter().map(|compound| base_name(net, compound)).collect();
    let taken: BTreeSet<NodeId> = all.iter().flat_map(|compound| &compound.uses).flat_map(Use::operations).collect();
    let products: Vec<NodeId> = (0..net.nodes.len() as NodeId).filter(|&id| shape.is_product(id)).collect();
    let slots: usize = products.iter().map(|&id| shape.copies[id as usize] as usize).sum();
    // The products of a sum fit into half an interval, so that there is room for them.
    let most = longest.min(slots.div_ceil(multipliers) / 2);
    let (sums, sum_bits) = sums(shape, &taken, most, context);
    let of_sums: BTreeSet<NodeId> = sums.iter().flat_map(Use::operations).collect();
    let all = grown(shape, all, &of_sums);
    let taken: BTreeSet<NodeId> = all.iter().flat_map(|compound| &compound.uses).flat_map(Use::operations).collect();

    let mut found = Vec::new();
    let alone = products.into_iter().filter(|id| !taken.contains(id) && !of_sums.contains(id));
    let mut products: Vec<Use> =
        alone.map(|id| Use::new(&[id], &net.node(id).op.operands().collect::<Vec<_>>())).collect();
    products.extend(sums);
    products.sort_by_key(Use::first);
    if !products.is_empty() {
        found.push(multiplier(shape, products, sum_bits, context.named("multiplier")));
    }
    let mut names: HashMap<&'static str, u32> = HashMap::new();
    for (compound, base) in all.into_iter().zip(named) {
        let number = names.entry(base).or_default();
        let name = format!("{base}_{number}");
        *number += 1;
        found.push(module_kind(shape, &name, compound, context)?);
    }
    Ok(found)
}

/// Name of a kind of unit, after the operations that it began with.
fn base_name(net: &Net, compound: &Compound) -> &'static str {
    let nodes = compound.uses[0].operations();
    match net.node(compound.uses[0].first()).op {
        Op::Lookup(..) => "table",
        Op::SarBy(..) if nodes.len() > 1 => "rounding_shifter",
        Op::SarBy(..) => "right_shifter",
        Op::ShlBy(..) => "left_shifter",
        _ => "normaliser",
    }
}

fn multiplier(shape: &Shape, mut uses: Vec<Use>, sum_bits: u32, name: String) -> UnitKind {
    let mut widths = [0, 0];
    for own in &mut uses {
        // The wider operand is the first one.
        let own_width = |content: &Content| content.node().map_or(0, |id| signed_width(shape.ranges.of(id)));
        for operands in own.inputs.chunks_mut(2) {
            operands.sort_by_key(|content| std::cmp::Reverse(own_width(content)));
            for (width, input) in widths.iter_mut().zip(operands) {
                *width = own_width(input).max(*width);
            }
        }
    }
    UnitKind {
        name,
        uses,
        hardware: Hardware::Multiplier { widths, sum_bits },
        outputs: vec![(PRODUCT, Range::of(0)), (SUM, Range::of(0))],
    }
}

/// Range of some contents; `None` if they are all nothing.
fn contents_range<'a>(shape: &Shape, contents: impl Iterator<Item = &'a Content>) -> Option<Range> {
    let ranges = contents.filter_map(|&content| match content {
        Content::Node(id) | Content::Copy(id) => Some(shape.ranges.of(id)),
        Content::Constant(value) => Some(Range::of(value)),
        Content::Nothing => None,
    });
    ranges.reduce(hull)
}

/// Places of a compound whose outcome others read, in some use.
fn read_outside(shape: &Shape, compound: &Compound) -> BTreeSet<usize> {
    let net = &shape.net;
    let joined = shape.joins.values().flat_map(|join| match join {
        Join::Input(sources) => sources.clone(),
        Join::Outcome { of, .. } => vec![*of],
    });
    let always: BTreeSet<NodeId> = joined.chain(net.outputs.iter().map(|output| output.node)).collect();
    let mut places = BTreeSet::new();
    for own in &compound.uses {
        let inside = own.operations();
        let others = net.iter().filter(|(id, _)| !inside.contains(id)).flat_map(|(_, node)| node.op.operands());
        let read: BTreeSet<NodeId> = others.filter(|id| inside.contains(id)).collect();
        let leaves = inside.iter().filter(|id| read.contains(id) || always.contains(id));
        places.extend(leaves.filter_map(|&id| own.place(id)));
    }
    places
}

/// Kind whose hardware is a module of its operations. They become a netlist whose wires hold the values of all uses.
fn module_kind(shape: &Shape, name: &str, compound: Compound, context: Context) -> Result<UnitKind, VerilogError> {
    let Compound { ref local, ref uses } = compound;
    let leaving = read_outside(shape, &compound);
    let model = shape.net.node(uses[0].first());
    let mut unit = Net { runs: vec![Run { name: "unit", run: 0, repeated: false }], ..Net::default() };
    let mut ranges = Ranges { ranges: Vec::new(), violations: Vec::new() };
    let mut add = |unit: &mut Net, op: Op, kind: Kind, like: &Node, range: Range| -> NodeId {
        let stage = (!matches!(op, Op::Port(_) | Op::Lit(_))).then_some(0);
        unit.nodes.push(Node { op, kind, stage, part: None, at: like.at });
        ranges.ranges.push(range);
        unit.nodes.len() as NodeId - 1
    };
    let mut inputs = Vec::new();
    for (input, &kind) in local.inputs.iter().enumerate() {
        let range = contents_range(shape, uses.iter().map(|own| &own.inputs[input])).unwrap_or(Range::of(0));
        let id = add(&mut unit, Op::Port(input as u32), kind, model, range);
        let node = *unit.node(id);
        unit.ports.push(port(format!("in{input}"), id, &node, 0, range));
        inputs.push(id);
    }
    let mut nodes: Vec<NodeId> = Vec::new();
    for (place, operation) in local.operations.iter().enumerate() {
        let contents = || uses.iter().map(|own| &own.nodes[place]);
        let like = contents().find_map(|content| content.node()).map_or(model, |id| shape.net.node(id));
        let mut operands = Vec::new();
        for operand in &operation.operands {
            operands.push(match *operand {
                Operand::Place(place) => nodes[place],
                Operand::Input(input) => inputs[input],
                Operand::Constant(value) => add(&mut unit, Op::Lit(value), operation.kind, like, Range::of(value)),
            });
        }
        let mut operands = operands.into_iter();
        let op = operation.op.map(|_| operands.next().unwrap_or_default());
        let range = contents_range(shape, contents()).unwrap_or(Range::of(0));
        let id = add(&mut unit, op, operation.kind, like, range);
        nodes.push(id);
        if leaving.contains(&place) {
            let name = format!("out{place}");
            unit.taps.push(Tap { stage: Some(0), name, path: Vec::new(), mantissa: false, fraction_bits: 0, node: id });
        }
    }
    let run = GroupRun { stage: 0, nodes, inputs };
    let group = Group { name: name.to_owned(), runs: vec![run] };
    let context = Context { net: &unit, ranges: &ranges, ..context };
    let module = Module::new(context, &group, |_| true)?;
    let outputs = module.outputs.iter().map(|port| (port.place, port.format.range)).collect();
    Ok(UnitKind {
        name: module.name.clone(),
        uses: compound.uses,
        hardware: Hardware::Module(Box::new(module)),
        outputs,
    })
}
