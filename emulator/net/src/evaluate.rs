//! The graph evaluator: the meaning of a net, one node after the other.
//!
//! Operations wrap as the scalar reading's do, so the two can be compared even on values outside the declared ranges.

use super::graph::{Kind, Net, NodeId, Op};

/// One operation on integers. `operand` is the integer of a node, `kind` what the node itself may hold.
pub fn apply(op: &Op, kind: Kind, kind_of: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i64 {
    let value = match *op {
        Op::Port(_) => 0,
        Op::Lit(value) => value,
        Op::Add(a, b) => operand(a).wrapping_add(operand(b)),
        Op::Sub(a, b) => operand(a).wrapping_sub(operand(b)),
        Op::Mul(a, b) => operand(a).wrapping_mul(operand(b)),
        Op::Shl(a, k) => operand(a) << (k & (kind.bits() - 1)),
        Op::Sar(a, k) => operand(a) >> (k & (kind.bits() - 1)),
        Op::ShlBy(a, k) => operand(a) << (operand(k) as u32 & (kind.bits() - 1)),
        Op::SarBy(a, k) => operand(a) >> (operand(k) as u32 & (kind.bits() - 1)),
        Op::And(a, b) => operand(a) & operand(b),
        Op::Or(a, b) => operand(a) | operand(b),
        Op::Xor(a, b) => operand(a) ^ operand(b),
        Op::Not(a) => operand(a) ^ 1,
        Op::Lt(a, b) => i64::from(operand(a) < operand(b)),
        Op::Select(flag, a, b) => operand(if operand(flag) != 0 { a } else { b }),
        Op::LeadingZeros(a) => match kind_of(a) {
            Kind::Wide => i64::from(operand(a).leading_zeros()),
            _ => i64::from((operand(a) as i32).leading_zeros()),
        },
        Op::Widen(a) | Op::Narrow(a) => operand(a),
        Op::Claim { of, .. } => operand(of),
        Op::Lookup(a, table) => {
            let entry = usize::try_from(operand(a)).ok().and_then(|index| table.0.get(index));
            entry.copied().map_or(0, i64::from)
        }
    };
    match kind {
        Kind::Word => i64::from(value as i32),
        Kind::Wide | Kind::Flag => value,
    }
}

/// [`apply`] where the exact outcome fits the wire, the shift count its width and the index its table; else `None`.
pub fn apply_exactly(
    op: &Op,
    kind: Kind,
    kind_of: impl Fn(NodeId) -> Kind,
    operand: impl Fn(NodeId) -> i64,
) -> Option<i64> {
    let wide = |id| i128::from(operand(id));
    let places = |k: i64| u32::try_from(k).ok().filter(|&k| k < kind.bits());
    let exact = match *op {
        Op::Add(a, b) => wide(a) + wide(b),
        Op::Sub(a, b) => wide(a) - wide(b),
        Op::Mul(a, b) => wide(a) * wide(b),
        Op::Shl(a, k) => wide(a) << places(i64::from(k))?,
        Op::ShlBy(a, k) => wide(a) << places(operand(k))?,
        Op::Sar(a, k) => wide(a) >> places(i64::from(k))?,
        Op::SarBy(a, k) => wide(a) >> places(operand(k))?,
        Op::Narrow(a) => wide(a),
        Op::Lookup(a, table) => i128::from(*table.0.get(usize::try_from(operand(a)).ok()?)?),
        _ => i128::from(apply(op, kind, kind_of, operand)),
    };
    let (low, high) = kind.limits();
    i64::try_from(exact).ok().filter(|value| (low..=high).contains(value))
}

impl Net {
    /// Computes every wire from the integers of the ports, in the order of [`Net::ports`].
    ///
    /// `wires` is overwritten and then holds one integer a node. Ports that are not given read 0.
    pub fn evaluate(&self, ports: &[i64], wires: &mut Vec<i64>) {
        wires.clear();
        wires.reserve(self.nodes.len());
        for node in &self.nodes {
            let value = match node.op {
                Op::Port(port) => ports.get(port as usize).copied().unwrap_or(0),
                op => apply(&op, node.kind, |id| self.node(id).kind, |id| wires[id as usize]),
            };
            wires.push(value);
        }
    }
}
