//! Nodes that wait to be computed again, taken in the order of the graph.

use super::graph::NodeId;

/// A set of nodes, a bit each; whoever takes from it may put in what comes later.
#[derive(Clone, Debug)]
pub(crate) struct Waiting {
    bits: Vec<u64>,
    /// Word below which nobody waits.
    word: usize,
}

impl Waiting {
    /// Set of none, of so many nodes.
    pub(crate) fn new(nodes: usize) -> Self {
        Self { bits: vec![0; nodes.div_ceil(64)], word: 0 }
    }

    /// Puts in a node.
    pub(crate) fn add(&mut self, id: NodeId) {
        let word = id as usize / 64;
        self.bits[word] |= 1 << (id % 64);
        self.word = self.word.min(word);
    }

    /// Takes out the first node.
    pub(crate) fn first(&mut self) -> Option<NodeId> {
        let ahead = self.bits[self.word..].iter().position(|&bits| bits != 0);
        self.word = ahead.map_or(self.bits.len(), |ahead| self.word + ahead);
        let bits = self.bits.get_mut(self.word)?;
        let id = (self.word * 64) as NodeId + bits.trailing_zeros();
        *bits &= *bits - 1;
        Some(id)
    }

    /// Takes out all.
    pub(crate) fn clear(&mut self) {
        self.bits[self.word..].fill(0);
        self.word = self.bits.len();
    }
}
