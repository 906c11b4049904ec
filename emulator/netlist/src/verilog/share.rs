//! Groups of stage runs that are the same hardware: equal operations on equal constants, with any drivers of their inputs.
//!
//! Such runs are instances of one module. Its wires hold any value of any of the runs. So ranges of nodes that meet in a place of a module are
//! joined, until every node has one range, at both ends of every connection.

use std::collections::HashMap;

use crate::graph::{Kind, Net, Node, NodeId, Op};
use crate::interval::{Range, Ranges};

/// One run of a stage. Places of nodes and inputs correspond between runs of one module.
#[derive(Clone, Debug)]
pub(super) struct Run {
    /// Index in [`Net::runs`].
    pub(super) stage: u32,
    /// Its operations, in order.
    pub(super) nodes: Vec<NodeId>,
    /// Ports and wires of other stages that it reads, in the order of a person: ports, then outcomes of earlier stages.
    pub(super) inputs: Vec<NodeId>,
}

/// Runs that are instances of one module.
#[derive(Clone, Debug)]
pub(super) struct Group {
    /// Name of the module, before any prefix.
    pub(super) name: String,
    /// The runs, at least one.
    pub(super) runs: Vec<Run>,
}

/// Operand of a local operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Operand {
    /// Outcome of the operation at a place.
    Place(usize),
    /// Input of a number.
    Input(usize),
    /// Constant.
    Constant(i64),
}

/// Operation whose operands are local.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Operation {
    /// The operation with every operand 0.
    pub(super) op: Op,
    /// Kind of its outcome.
    pub(super) kind: Kind,
    /// Its operands, in order.
    pub(super) operands: Vec<Operand>,
}

/// Operations with places for operands: nodes that are equal are the same hardware.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Local {
    /// Operations by their places.
    pub(super) operations: Vec<Operation>,
    /// Kinds of the inputs.
    pub(super) inputs: Vec<Kind>,
}

/// Structure of a run; runs with equal structures are the same hardware.
#[derive(PartialEq)]
struct Structure {
    name: &'static str,
    local: Local,
    taps: Vec<(NodeId, String, u32)>,
}

impl Operation {
    /// Operation of a node; `operand` gives the local operands.
    pub(super) fn new(node: &Node, operand: impl FnMut(NodeId) -> Operand) -> Self {
        Self { op: node.op.map(|_| 0), kind: node.kind, operands: node.op.operands().map(operand).collect() }
    }
}

impl Local {
    /// Operations of some nodes, and the other wires that they read, in the order of their first use.
    pub(super) fn new(net: &Net, nodes: &[NodeId]) -> (Self, Vec<NodeId>) {
        let places: HashMap<NodeId, usize> = nodes.iter().copied().zip(0..).collect();
        let mut inputs: Vec<NodeId> = Vec::new();
        let mut operand = |id: NodeId| match (places.get(&id), net.node(id).op) {
            (Some(&place), _) => Operand::Place(place),
            (None, Op::Lit(value)) => Operand::Constant(value),
            (None, _) => Operand::Input(inputs.iter().position(|&input| input == id).unwrap_or_else(|| {
                inputs.push(id);
                inputs.len() - 1
            })),
        };
        let operations = nodes.iter().map(|&id| Operation::new(net.node(id), &mut operand)).collect();
        let kinds = inputs.iter().map(|&input| net.node(input).kind).collect();
        (Self { operations, inputs: kinds }, inputs)
    }
}

/// The run of a stage with its structure; inputs in the order of their first use.
fn run_of(net: &Net, stage: u32, nodes: Vec<NodeId>) -> (Run, Structure) {
    let (local, inputs) = Local::new(net, &nodes);
    let place: HashMap<NodeId, NodeId> = nodes.iter().copied().zip(0..).collect();
    let own = net.taps.iter().filter(|tap| tap.stage == Some(stage));
    let taps = own.filter_map(|tap| Some((*place.get(&tap.node)?, tap.name.clone(), tap.fraction_bits))).collect();
    let name = net.runs[stage as usize].name;
    (Run { stage, nodes, inputs }, Structure { name, local, taps })
}

/// Groups the runs of stages that have operations, in the order of their first run.
pub(super) fn groups(net: &Net) -> Vec<Group> {
    let mut nodes = vec![Vec::new(); net.runs.len()];
    for (id, node) in net.iter() {
        if let Some(stage) = node.stage {
            nodes[stage as usize].push(id);
        }
    }
    let mut found: Vec<(Structure, Vec<Run>)> = Vec::new();
    for (stage, nodes) in (0..).zip(nodes).filter(|(_, nodes)| !nodes.is_empty()) {
        let (run, structure) = run_of(net, stage, nodes);
        match found.iter_mut().find(|(known, _)| *known == structure) {
            Some((_, runs)) => runs.push(run),
            None => found.push((structure, vec![run])),
        }
    }
    let alone = |name| found.iter().filter(|(structure, _)| structure.name == name).count() == 1;
    let named = found.iter().map(|(structure, runs)| {
        let stage = &net.runs[runs[0].stage as usize];
        let name = if alone(structure.name) { stage.name.replace('.', "_") } else { stage.instance() };
        let mut runs = runs.clone();
        let mut order: Vec<usize> = (0..runs[0].inputs.len()).collect();
        order.sort_by_key(|&place| position(net, runs[0].inputs[place]));
        for run in &mut runs {
            run.inputs = order.iter().map(|&place| run.inputs[place]).collect();
        }
        Group { name, runs }
    });
    named.collect()
}

/// Sort key of an input, as a person expects it: ports first, then outcomes of stages in the order of execution.
fn position(net: &Net, id: NodeId) -> (usize, NodeId) {
    match net.node(id).op {
        Op::Port(port) => (0, port),
        _ => (1 + net.taps.iter().position(|tap| tap.node == id).unwrap_or(net.taps.len()), id),
    }
}

/// Ranges in which nodes that meet in a place of a module have one range.
pub(super) fn joined(net: &Net, ranges: &Ranges, groups: &[Group]) -> Ranges {
    let mut parent: Vec<NodeId> = (0..net.nodes.len() as NodeId).collect();
    fn root(parent: &mut [NodeId], mut id: NodeId) -> NodeId {
        while parent[id as usize] != id {
            parent[id as usize] = parent[parent[id as usize] as usize];
            id = parent[id as usize];
        }
        id
    }
    for group in groups {
        for run in &group.runs[1..] {
            let (first, other) = (&group.runs[0], run);
            let pairs = first.nodes.iter().chain(&first.inputs).zip(other.nodes.iter().chain(&other.inputs));
            for (&a, &b) in pairs {
                let (a, b) = (root(&mut parent, a), root(&mut parent, b));
                parent[b as usize] = a;
            }
        }
    }
    let mut hull: Vec<Option<Range>> = vec![None; net.nodes.len()];
    for id in 0..net.nodes.len() as NodeId {
        let range = ranges.of(id);
        let entry = &mut hull[root(&mut parent, id) as usize];
        *entry = Some(entry.map_or(range, |hull| Range {
            low: hull.low.min(range.low),
            high: hull.high.max(range.high),
            zeros: hull.zeros.min(range.zeros),
        }));
    }
    let of = |id| hull[root(&mut parent, id) as usize].unwrap_or(ranges.of(id));
    Ranges { ranges: (0..net.nodes.len() as NodeId).map(of).collect(), violations: Vec::new() }
}
