//! The netlist evaluator: the meaning of a net, node after node.
//!
//! Operations wrap as those of the scalar backend do, so the two can be compared even on values outside the declared ranges.

use super::graph::{Kind, Net, NodeId, Op};

/// One operation on integers, wrapped to its wire. `operand` returns the integer of a node, `kind` is the kind of the node itself.
#[inline]
pub(crate) fn apply(op: Op, kind: Kind, kind_of: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i64 {
    kind.cut(op.value(kind, kind_of, operand) as i64)
}

/// Integer of an operation, or `None` if it leaves the wire, a shift count its width or an index its table.
pub fn apply_exactly(
    op: Op,
    kind: Kind,
    kind_of: impl Fn(NodeId) -> Kind,
    operand: impl Fn(NodeId) -> i64,
) -> Option<i64> {
    let (low, high) = kind.limits();
    let value = op.is_defined(kind, &operand).then(|| op.value(kind, kind_of, operand))?;
    i64::try_from(value).ok().filter(|value| (low..=high).contains(value))
}

impl Net {
    /// Computes every wire from the integers of the ports, in the order of [`Net::ports`].
    ///
    /// `wires` is overwritten and then holds one integer a node. A port without an integer reads 0.
    pub fn evaluate(&self, ports: &[i64], wires: &mut Vec<i64>) {
        wires.clear();
        wires.reserve(self.nodes.len());
        for id in 0..self.nodes.len() as NodeId {
            wires.push(self.value(id, ports, wires));
        }
    }

    /// Integer of a node from those of the ports and of its operands.
    #[inline]
    pub fn value(&self, id: NodeId, ports: &[i64], wires: &[i64]) -> i64 {
        let node = self.node(id);
        match node.op {
            Op::Port(port) => ports.get(port as usize).copied().unwrap_or(0),
            op => apply(op, node.kind, |id| self.node(id).kind, |id| wires[id as usize]),
        }
    }
}
