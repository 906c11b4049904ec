//! The netlist to be folded: runs of a stage that are the same hardware and do not need each other exist once.
//!
//! Such runs are a *block*. Its first run stands for all of them. An input of the block is a [`Join`] of the wires that its runs read, and an outcome
//! that others read is a join of one run. Joins are ports of the folded netlist, so its operations need no other netlist.

use std::collections::{BTreeMap, HashMap};

use super::super::excerpt::port;
use super::super::share::Group;
use crate::graph::{Net, Node, NodeId, Op, Port, Tap};
use crate::interval::{Range, Ranges};
use crate::unit::Unit;

/// Source of a port of the folded netlist that is no port of the design.
#[derive(Clone, Debug)]
pub(super) enum Join {
    /// Input of a block: the wire that each run reads, in the order of the runs.
    Input(Vec<NodeId>),
    /// Outcome of one run of a block, as others read it.
    Outcome {
        /// Wire of the block.
        of: NodeId,
        /// Number of the run.
        run: u32,
    },
}

/// A netlist without the repeated runs of its blocks.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    /// Operations, each once. Ports after those of the design are joins.
    pub(super) net: Net,
    /// Ranges, in a block those of all its runs.
    pub(super) ranges: Ranges,
    /// Joins by their nodes.
    pub(super) joins: HashMap<NodeId, Join>,
    /// Number of runs for which a node computes; 1 outside blocks.
    pub(super) copies: Vec<u32>,
    /// Nodes of the folded netlist for the nodes of the design, with the number of the run.
    pub(super) places: Vec<(NodeId, u32)>,
}

/// A block: run and place of every node of a group with several independent runs.
struct Blocks<'a> {
    groups: Vec<&'a Group>,
    /// Block and run of each node of the design.
    of: Vec<Option<(usize, u32)>>,
}

impl<'a> Blocks<'a> {
    fn new(net: &Net, groups: &'a [Group]) -> Self {
        let mut blocks = Self { groups: Vec::new(), of: vec![None; net.nodes.len()] };
        for group in groups.iter().filter(|group| group.runs.len() > 1 && are_independent(net, group)) {
            for (run, of_run) in (0..).zip(&group.runs) {
                for &id in &of_run.nodes {
                    blocks.of[id as usize] = Some((blocks.groups.len(), run));
                }
            }
            blocks.groups.push(group);
        }
        blocks
    }
}

/// True if no run of a group reads anything that another one made.
fn are_independent(net: &Net, group: &Group) -> bool {
    let mut made = vec![false; net.nodes.len()];
    for run in &group.runs {
        for &id in &run.nodes {
            made[id as usize] = true;
        }
    }
    // Later wires that need a run.
    let mut needs = made.clone();
    for (id, node) in net.iter() {
        needs[id as usize] |= node.op.operands().any(|operand| needs[operand as usize]);
    }
    group.runs.iter().flat_map(|run| &run.inputs).all(|&input| !needs[input as usize])
}

fn hull(ranges: &Ranges, mut nodes: impl Iterator<Item = NodeId>) -> Range {
    let first = nodes.next().map_or(Range::of(0), |id| ranges.of(id));
    nodes.map(|id| ranges.of(id)).fold(first, |hull, range| Range {
        low: hull.low.min(range.low),
        high: hull.high.max(range.high),
        zeros: hull.zeros.min(range.zeros),
    })
}

/// A folded netlist under construction.
struct Folding<'a> {
    of: &'a Net,
    of_ranges: &'a Ranges,
    blocks: Blocks<'a>,
    shape: Shape,
    /// Outcomes that have a join: node of the design to port.
    outcomes: BTreeMap<NodeId, NodeId>,
    /// Inputs that have a join: block and place to port.
    inputs: BTreeMap<(usize, usize), NodeId>,
}

impl Folding<'_> {
    fn push(&mut self, node: Node, range: Range, copies: u32) -> NodeId {
        self.shape.net.nodes.push(node);
        self.shape.ranges.ranges.push(range);
        self.shape.copies.push(copies);
        self.shape.net.nodes.len() as NodeId - 1
    }

    /// Port of a join.
    fn port(&mut self, name: String, like: NodeId, range: Range, copies: u32) -> NodeId {
        let node =
            Node { op: Op::Port(self.shape.net.ports.len() as u32), stage: None, part: None, ..*self.of.node(like) };
        let id = self.push(node, range, copies);
        let port = port(name, id, &node, 0, range);
        self.shape.net.ports.push(port);
        id
    }

    /// Node by which a node of the design is read outside its block.
    fn outside(&mut self, id: NodeId) -> NodeId {
        let Some((_, run)) = self.blocks.of[id as usize] else { return self.shape.places[id as usize].0 };
        if let Some(&port) = self.outcomes.get(&id) {
            return port;
        }
        let tap = self.of.taps.iter().find(|tap| tap.node == id);
        let name = tap.map_or_else(|| format!("outcome{id}"), |tap| self.of.tap_name(tap));
        let port = self.port(name, id, self.of_ranges.of(id), 1);
        self.outcomes.insert(id, port);
        self.shape.joins.insert(port, Join::Outcome { of: self.shape.places[id as usize].0, run });
        port
    }

    /// Node by which the first run of a block reads an operand.
    fn inside(&mut self, block: usize, id: NodeId) -> NodeId {
        if matches!(self.of.node(id).op, Op::Lit(_)) || self.blocks.of[id as usize] == Some((block, 0)) {
            return self.shape.places[id as usize].0;
        }
        let group = self.blocks.groups[block];
        let place = group.runs[0].inputs.iter().position(|&input| input == id).unwrap_or(0);
        if let Some(&port) = self.inputs.get(&(block, place)) {
            return port;
        }
        let range = hull(self.of_ranges, group.runs.iter().map(|run| run.inputs[place]));
        let port = self.port(format!("{}.in{place}", group.name), id, range, group.runs.len() as u32);
        self.inputs.insert((block, place), port);
        port
    }
}

/// Bits of a range in two's complement, with its constant low zeros.
pub(super) fn signed_width(range: Range) -> u32 {
    range.width() + u32::from(!range.signed())
}

impl Shape {
    /// True for a product of two wires.
    pub(super) fn is_product(&self, id: NodeId) -> bool {
        matches!(self.net.node(id).op.unit(&self.ranges, id), Unit::Multiplier(_))
    }

    /// Folds the runs of groups of equal hardware. `ranges` are those of every run by itself.
    pub(super) fn new(net: &Net, ranges: &Ranges, groups: &[Group]) -> Self {
        let shape = Self {
            net: Net { runs: net.runs.clone(), limits: net.limits.clone(), ..Net::default() },
            ranges: Ranges { ranges: Vec::new(), violations: Vec::new() },
            joins: HashMap::new(),
            copies: Vec::new(),
            places: vec![(NodeId::MAX, 0); net.nodes.len()],
        };
        let blocks = Blocks::new(net, groups);
        let mut folding =
            Folding { of: net, of_ranges: ranges, blocks, shape, outcomes: BTreeMap::new(), inputs: BTreeMap::new() };
        // Joins are numbered after the ports of the design.
        for port in &net.ports {
            let id = folding.push(*net.node(port.node), ranges.of(port.node), 1);
            folding.shape.places[port.node as usize] = (id, 0);
            folding.shape.net.ports.push(Port { node: id, ..port.clone() });
        }
        for (id, node) in net.iter().filter(|(_, node)| !matches!(node.op, Op::Port(_))) {
            let (copies, range, op) = match folding.blocks.of[id as usize] {
                None => (1, ranges.of(id), node.op.map(|operand| folding.outside(operand))),
                Some((block, 0)) => {
                    let group = folding.blocks.groups[block];
                    let place = group.runs[0].nodes.iter().position(|&own| own == id).unwrap_or(0);
                    let range = hull(ranges, group.runs.iter().map(|run| run.nodes[place]));
                    (group.runs.len() as u32, range, node.op.map(|operand| folding.inside(block, operand)))
                }
                Some((block, run)) => {
                    let group = folding.blocks.groups[block];
                    let place = group.runs[run as usize].nodes.iter().position(|&own| own == id).unwrap_or(0);
                    let first = group.runs[0].nodes[place];
                    folding.shape.places[id as usize] = (folding.shape.places[first as usize].0, run);
                    continue;
                }
            };
            let place = folding.push(Node { op, ..*node }, range, copies);
            folding.shape.places[id as usize] = (place, 0);
        }
        let inputs: Vec<_> = folding.inputs.iter().map(|(&key, &port)| (key, port)).collect();
        for ((block, place), port) in inputs {
            let read: Vec<NodeId> = folding.blocks.groups[block].runs.iter().map(|run| run.inputs[place]).collect();
            let sources = read.into_iter().map(|id| folding.outside(id)).collect();
            folding.shape.joins.insert(port, Join::Input(sources));
        }
        for output in &net.outputs {
            let node = folding.outside(output.node);
            folding.shape.net.outputs.push(Tap { node, ..output.clone() });
        }
        let mut shape = folding.shape;
        for tap in &net.taps {
            let (node, run) = shape.places[tap.node as usize];
            if run == 0 {
                shape.net.taps.push(Tap { node, ..tap.clone() });
            }
        }
        shape
    }

    /// Wires that the runs of a block read at one of its inputs; empty for any other node.
    pub(super) fn sources(&self, id: NodeId) -> &[NodeId] {
        match self.joins.get(&id) {
            Some(Join::Input(sources)) => sources,
            _ => &[],
        }
    }
}
