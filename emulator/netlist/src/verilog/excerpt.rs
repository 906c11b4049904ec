//! Operations that are taken out of a design as a netlist of their own.

use std::collections::HashMap;

use crate::graph::{Net, Node, NodeId, Op, Port, Run, Tap};
use crate::range::Range;

/// A netlist of some operations of a design, which are one run of a stage.
pub(super) struct Excerpt<'a> {
    of: &'a Net,
    pub(super) net: Net,
    /// Places of the design's nodes in the netlist.
    pub(super) places: HashMap<NodeId, NodeId>,
}

/// Port for `node` that no field declares.
pub(super) fn port(name: String, node: NodeId, of: &Node, fraction_bits: u32, range: Range) -> Port {
    let Range { low, high, zeros } = range;
    Port { name, path: Vec::new(), kind: of.kind, mantissa: false, fraction_bits, low, high, zeros, node }
}

impl<'a> Excerpt<'a> {
    /// Netlist without operations. Its run is named as that of a stage.
    pub(super) fn new(of: &'a Net, name: &'static str) -> Self {
        let net = Net { runs: vec![Run { name, run: 0, repeated: false }], ..Net::default() };
        Self { of, net, places: HashMap::new() }
    }

    /// Copies a node with a different operation, once.
    pub(super) fn add(&mut self, id: NodeId, op: Op) {
        let Self { of, net, places } = self;
        places.entry(id).or_insert_with(|| {
            let stage = if matches!(op, Op::Port(_) | Op::Lit(_)) { None } else { Some(0) };
            net.nodes.push(Node { op, stage, ..*of.node(id) });
            net.nodes.len() as NodeId - 1
        });
    }

    /// Adds a port that stands for a node of the design.
    pub(super) fn add_port(&mut self, id: NodeId, name: String, fraction_bits: u32, range: Range) {
        self.add(id, Op::Port(self.net.ports.len() as u32));
        self.net.ports.push(port(name, self.places[&id], self.of.node(id), fraction_bits, range));
    }

    /// Copies an operation, with the constants that it reads. Its other operands are there.
    pub(super) fn add_operation(&mut self, id: NodeId) {
        let op = self.of.node(id).op;
        for operand in op.operands() {
            if let Op::Lit(value) = self.of.node(operand).op {
                self.add(operand, Op::Lit(value));
            }
        }
        let op = op.map(|operand| self.places[&operand]);
        self.add(id, op);
    }

    /// Name for the copy of a node: an outcome of the run, or with `stage` none an output of the netlist.
    pub(super) fn tap(&self, id: NodeId, stage: Option<u32>, name: String, fraction_bits: u32) -> Tap {
        Tap { stage, name, path: Vec::new(), mantissa: false, fraction_bits, node: self.places[&id] }
    }
}
