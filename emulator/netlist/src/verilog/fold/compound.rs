//! Compounds: operations that one shared unit does, with their uses in a folded netlist.
//!
//! A use need not have every operation. Its unit then works on zeros, or nobody reads what it makes.

use std::collections::BTreeSet;

use super::super::share::{Local, Operand};
use crate::builder::{self, NamedWire};
use crate::graph::{Net, NodeId, Op};

/// Place of the product among the outcomes of a multiplier.
pub(super) const PRODUCT: usize = 0;
/// Place of the sum.
pub(super) const SUM: usize = 1;
/// Places of the outcomes of a multiplier; after them come the operations that only a sum reads.
pub(super) const PLACES: usize = 2;

/// Content of an input or a place of a unit for one use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// Value of a node, which the use reads or makes.
    Node(NodeId),
    /// Value of a node that the use does not make here.
    Copy(NodeId),
    /// A constant; at an input it is 0.
    Constant(i64),
    /// Anything, for nobody reads it.
    Nothing,
}

impl Content {
    /// The node, if it is one.
    pub(super) fn node(self) -> Option<NodeId> {
        if let Self::Node(id) = self { Some(id) } else { None }
    }
}

/// One use of a unit.
#[derive(Clone, Debug)]
pub(super) struct Use {
    /// Contents of the unit's places.
    pub(super) nodes: Vec<Content>,
    /// Contents of the unit's inputs.
    pub(super) inputs: Vec<Content>,
    /// Flag of each product of a sum, true if it is subtracted; product n reads inputs 2n and 2n + 1. Empty for any other use.
    pub(super) signs: Vec<bool>,
}

impl Use {
    /// Use of a unit that has just these operations and inputs.
    pub(super) fn new(nodes: &[NodeId], inputs: &[NodeId]) -> Self {
        let contents = |nodes: &[NodeId]| nodes.iter().copied().map(Content::Node).collect();
        Self { nodes: contents(nodes), inputs: contents(inputs), signs: Vec::new() }
    }

    /// Slots that it takes: one for each product of a sum.
    pub(super) fn slots(&self) -> usize {
        self.signs.len().max(1)
    }

    /// Product of a sum in one of its slots; `None` for any other use.
    pub(super) fn product(&self, slot: usize) -> Option<NodeId> {
        if self.signs.is_empty() { None } else { self.nodes[PLACES + slot].node() }
    }

    /// Slot in which it reads an input, and the unit's port for it.
    pub(super) fn port(&self, input: usize) -> (usize, usize) {
        if self.signs.is_empty() { (0, input) } else { (input / 2, input % 2) }
    }

    /// Its operations, in the order of the netlist.
    pub(super) fn operations(&self) -> BTreeSet<NodeId> {
        self.nodes.iter().filter_map(|content| content.node()).collect()
    }

    /// Its first operation.
    pub(super) fn first(&self) -> NodeId {
        self.operations().first().copied().unwrap_or_default()
    }

    /// Wires that it reads, with the numbers of the inputs.
    pub(super) fn reads(&self) -> impl Iterator<Item = (usize, NodeId)> {
        self.inputs.iter().enumerate().filter_map(|(input, content)| Some((input, content.node()?)))
    }

    /// Last place that has a node's value.
    pub(super) fn place(&self, id: NodeId) -> Option<usize> {
        self.nodes.iter().rposition(|&content| content == Content::Node(id))
    }

    /// Operand of one of its operations, or an input; `None` for a wire that it does not read.
    pub(super) fn operand(&self, id: NodeId) -> Option<Operand> {
        let input = || self.inputs.iter().position(|&content| content == Content::Node(id));
        self.place(id).map(Operand::Place).or_else(|| input().map(Operand::Input))
    }
}

/// Operations with their uses.
#[derive(Clone, Debug)]
pub(super) struct Compound {
    pub(super) local: Local,
    pub(super) uses: Vec<Use>,
}

/// Compounds of some candidates: equal operations are one.
pub(super) fn compounds(net: &Net, candidates: Vec<Vec<NodeId>>) -> Vec<Compound> {
    let mut found: Vec<Compound> = Vec::new();
    for nodes in candidates {
        let (local, inputs) = Local::new(net, &nodes);
        let own = Use::new(&nodes, &inputs);
        match found.iter_mut().find(|compound| compound.local == local) {
            Some(compound) => compound.uses.push(own),
            None => found.push(Compound { local, uses: vec![own] }),
        }
    }
    found
}

/// A compound whose last inputs are zero, folded.
struct Special {
    local: Local,
    /// Input of the compound for each input that is left.
    inputs: Vec<usize>,
    /// Place, input or constant that has the value of each place of the compound.
    places: Vec<Operand>,
}

impl Special {
    /// Folds the operations of a unit with its first `count` inputs; the others are zero.
    fn new(local: &Local, count: usize) -> Self {
        builder::begin();
        let mut inputs = Vec::new();
        for (number, &kind) in local.inputs.iter().enumerate() {
            inputs.push(if number < count {
                builder::port(Vec::new(), kind, false, 0, kind.limits())
            } else {
                builder::node(Op::Lit(0), kind)
            });
        }
        let mut made: Vec<NodeId> = Vec::new();
        for operation in &local.operations {
            let mut operands = operation.operands.iter();
            let op = operation.op.map(|_| match operands.next() {
                Some(&Operand::Place(place)) => made[place],
                Some(&Operand::Input(input)) => inputs[input],
                Some(&Operand::Constant(value)) => builder::node(Op::Lit(value), operation.kind),
                None => 0,
            });
            made.push(builder::node(op, operation.kind));
        }
        let outputs =
            made.into_iter().map(|node| NamedWire { path: Vec::new(), node, mantissa: false, fraction_bits: 0 });
        let net = builder::end(outputs.collect());
        let is_left = |id: NodeId| !matches!(net.node(id).op, Op::Lit(_) | Op::Port(_));
        let nodes: BTreeSet<NodeId> = net.outputs.iter().map(|output| output.node).filter(|&id| is_left(id)).collect();
        let nodes: Vec<NodeId> = nodes.into_iter().collect();
        let (local, read) = Local::new(&net, &nodes);
        let place = |id: NodeId| match net.node(id).op {
            Op::Lit(value) => Operand::Constant(value),
            Op::Port(_) => Operand::Input(read.iter().position(|&input| input == id).unwrap_or_default()),
            _ => Operand::Place(nodes.iter().position(|&node| node == id).unwrap_or_default()),
        };
        let places = net.outputs.iter().map(|output| place(output.node)).collect();
        let port = |&id: &NodeId| net.ports.iter().position(|port| port.node == id).unwrap_or_default();
        Self { local, inputs: read.iter().map(port).collect(), places }
    }

    /// Use of the compound for a use of what it folds to.
    fn widened(&self, own: &Use, inputs: usize) -> Use {
        let content = |&place: &Operand| match place {
            Operand::Place(place) => own.nodes[place],
            Operand::Input(input) => match own.inputs[input] {
                Content::Node(id) => Content::Copy(id),
                other => other,
            },
            Operand::Constant(value) => Content::Constant(value),
        };
        let nodes = self.places.iter().map(content).collect();
        let mut wide = Use { nodes, inputs: vec![Content::Constant(0); inputs], signs: Vec::new() };
        for (&input, &content) in self.inputs.iter().zip(&own.inputs) {
            wide.inputs[input] = content;
        }
        wide
    }
}

/// Joins compounds that are special cases of others: a normaliser of one wire is one of three wires, two of which are zero.
pub(super) fn joined(mut compounds: Vec<Compound>) -> Vec<Compound> {
    compounds.sort_by_key(|compound| compound.local.inputs.len());
    let mut found: Vec<Compound> = Vec::new();
    while let Some(mut wide) = compounds.pop() {
        for count in (1..wide.local.inputs.len()).rev() {
            let special = Special::new(&wide.local, count);
            if let Some(at) = compounds.iter().position(|compound| compound.local == special.local) {
                let own = compounds.remove(at);
                let inputs = wide.local.inputs.len();
                wide.uses.extend(own.uses.iter().map(|own| special.widened(own, inputs)));
            }
        }
        found.push(wide);
    }
    found
}
