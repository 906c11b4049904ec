//! Sums of products: products of one sum follow each other on one multiplier, whose accumulator adds them up.
//!
//! An adder of its own costs a carry chain for each sum, and every product waits in registers until the last one is there. An accumulator is an adder
//! behind a multiplier, which exists once. Other products may come between those of a sum, but no other sum.

use std::collections::{BTreeSet, HashMap};

use super::super::context::Context;
use super::compound::{Content, PLACES, SUM, Use};
use super::shape::{Join, Shape, signed_width};
use crate::graph::{NodeId, Op};
use crate::unit::Unit;

/// Levels of an accumulator besides its adder: the first product drops what was there, and a product may be subtracted.
const LEVELS: u32 = 2;

/// Products and sums of a folded netlist under search.
struct Search<'a> {
    shape: &'a Shape,
    taken: &'a BTreeSet<NodeId>,
    /// Number of operations that read each node; what leaves the netlist counts as two.
    readers: HashMap<NodeId, u32>,
}

/// Sum under construction.
#[derive(Default)]
struct Sum {
    operations: Vec<NodeId>,
    /// Products, with a flag for those that are subtracted.
    products: Vec<(NodeId, bool)>,
}

impl Search<'_> {
    /// Adds the terms of an addition to a sum; false if one of them is neither a product nor a sum, or is read elsewhere.
    fn collect(&self, id: NodeId, is_negative: bool, sum: &mut Sum) -> bool {
        let (operands, last_is_negative) = match self.shape.net.node(id).op {
            Op::Add(a, b) => ([a, b], is_negative),
            Op::Sub(a, b) => ([a, b], !is_negative),
            _ => return false,
        };
        sum.operations.push(id);
        operands.into_iter().zip([is_negative, last_is_negative]).all(|(operand, is_negative)| {
            let is_own = self.readers.get(&operand) == Some(&1)
                && self.shape.copies[operand as usize] == self.shape.copies[id as usize]
                && !self.taken.contains(&operand);
            if is_own && self.shape.is_product(operand) {
                sum.products.push((operand, is_negative));
                return true;
            }
            is_own && self.collect(operand, is_negative, sum)
        })
    }

    /// Constant low zeros of a product, which the multiplier has no wires for.
    fn zeros(&self, product: NodeId) -> u32 {
        self.shape.net.node(product).op.operands().map(|operand| self.shape.ranges.of(operand).zeros).sum()
    }

    /// Bits of an accumulator for a sum.
    fn bits(&self, own: &Use) -> u32 {
        let (Content::Node(sum), Some(Content::Node(product))) = (own.nodes[SUM], own.nodes.get(PLACES)) else {
            return 0;
        };
        let range = self.shape.ranges.of(sum);
        signed_width(range) + range.zeros - self.zeros(*product)
    }
}

/// Sums of 2 to `most` products whose operations are not `taken`, as uses of a multiplier, and the bits of the accumulator. The context has the depth.
pub(super) fn sums(shape: &Shape, taken: &BTreeSet<NodeId>, most: usize, context: Context) -> (Vec<Use>, u32) {
    let net = &shape.net;
    let mut readers: HashMap<NodeId, u32> = HashMap::new();
    for operand in net.iter().flat_map(|(_, node)| node.op.operands()) {
        *readers.entry(operand).or_default() += 1;
    }
    let joined = shape.joins.values().flat_map(|join| match join {
        Join::Input(sources) => sources.clone(),
        Join::Outcome { of, .. } => vec![*of],
    });
    for id in joined.chain(net.outputs.iter().map(|output| output.node)) {
        *readers.entry(id).or_default() += 2;
    }
    let search = Search { shape, taken, readers };
    let mut found: Vec<Use> = Vec::new();
    let mut inside: BTreeSet<NodeId> = BTreeSet::new();
    // The last addition of a sum comes after the others.
    for (id, node) in net.iter().rev() {
        let mut sum = Sum::default();
        if taken.contains(&id) || inside.contains(&id) || !search.collect(id, false, &mut sum) {
            continue;
        }
        let Unit::Adder { bits, .. } = node.op.unit(&shape.ranges, id) else { continue };
        let adder = Unit::Adder { bits: bits + 1, constant: false };
        let zeros = search.zeros(sum.products[0].0);
        let aligned = sum.products.iter().all(|&(product, _)| search.zeros(product) == zeros);
        let levels = context.target.levels(adder, context.depth.unwrap_or(0)) + LEVELS;
        if !aligned || sum.products.len() > most || context.depth.is_some_and(|depth| levels > depth) {
            continue;
        }
        let products: Vec<NodeId> = sum.products.iter().map(|&(product, _)| product).collect();
        inside.extend(sum.operations.iter().chain(&products));
        let inputs: Vec<NodeId> = products.iter().flat_map(|&product| net.node(product).op.operands()).collect();
        let others = sum.operations[1..].iter();
        let nodes: Vec<NodeId> = products.iter().chain(others).copied().collect();
        let mut own = Use::new(&nodes, &inputs);
        own.nodes.splice(0..0, [Content::Nothing, Content::Node(id)]);
        own.signs = sum.products.iter().map(|&(_, is_negative)| is_negative).collect();
        found.push(own);
    }
    found.reverse();
    let bits = found.iter().map(|own| search.bits(own)).max().unwrap_or(0);
    (found, bits)
}
