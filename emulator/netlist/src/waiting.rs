//! Nodes that wait for a new computation, taken in the order of the netlist.

use super::graph::NodeId;

/// A set of nodes, a bit each. Later nodes may be added while it is emptied.
#[derive(Clone, Debug)]
pub(crate) struct Waiting {
    bits: Vec<u64>,
    /// Lowest word that may hold a waiting node.
    word: usize,
}

impl Waiting {
    /// Empty set for this many nodes.
    pub(crate) fn new(nodes: usize) -> Self {
        Self { bits: vec![0; nodes.div_ceil(64)], word: 0 }
    }

    /// Adds a node.
    pub(crate) fn add(&mut self, id: NodeId) {
        let word = id as usize / 64;
        self.bits[word] |= 1 << (id % 64);
        self.word = self.word.min(word);
    }

    /// Removes and returns the first node.
    pub(crate) fn first(&mut self) -> Option<NodeId> {
        let ahead = self.bits[self.word..].iter().position(|&bits| bits != 0);
        self.word = ahead.map_or(self.bits.len(), |ahead| self.word + ahead);
        let bits = self.bits.get_mut(self.word)?;
        let id = (self.word * 64) as NodeId + bits.trailing_zeros();
        *bits &= *bits - 1;
        Some(id)
    }

    /// Removes all nodes.
    pub(crate) fn clear(&mut self) {
        self.bits[self.word..].fill(0);
        self.word = self.bits.len();
    }
}
