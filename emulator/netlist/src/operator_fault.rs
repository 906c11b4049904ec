//! Operator faults: replacements of operations, and their values.

use std::fmt;

use super::graph::{Net, NodeId, Op};
use super::interval::Ranges;

/// Replacement of an operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OperatorFault {
    /// a − b for a + b, or a + b for a − b.
    Sign,
    /// b − a for a − b; b < a for a < b; the other value of a choice.
    Swapped,
    /// a for a + c with a constant c: no rounding.
    WithoutConstant,
    /// A sign read as one more value bit, of a factor or of the operand of a right shift.
    Unsigned(Side),
    /// One place more.
    Further,
    /// One place less.
    Nearer,
    /// a | b for a & b, a & b for a | b, or a | b for an exclusive or.
    OtherGate,
    /// a ≤ b for a < b.
    OrEqual,
    /// Always the first or the second value of a choice.
    Always(Side),
}

/// One of two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// The first.
    First,
    /// The second.
    Second,
}

impl OperatorFault {
    /// Faults that an operation can have.
    pub(super) fn of(net: &Net, ranges: &Ranges, op: Op) -> Vec<Self> {
        use Side::{First, Second};
        let signed = |id| ranges.of(id).signed();
        let constant = |id| matches!(net.node(id).op, Op::Lit(_));
        match op {
            Op::Add(_, b) if constant(b) => vec![Self::Sign, Self::WithoutConstant],
            Op::Add(..) => vec![Self::Sign],
            Op::Sub(..) => vec![Self::Sign, Self::Swapped],
            Op::Mul(a, b) => [(a, First), (b, Second)]
                .into_iter()
                .filter(|&(id, _)| signed(id))
                .map(|(_, side)| Self::Unsigned(side))
                .collect(),
            Op::Shl(..) | Op::ShlBy(..) | Op::LeadingZeros(_) => vec![Self::Further, Self::Nearer],
            Op::Sar(a, _) | Op::SarBy(a, _) => {
                let unsigned = signed(a).then_some(Self::Unsigned(First));
                [Self::Further, Self::Nearer].into_iter().chain(unsigned).collect()
            }
            Op::And(..) | Op::Or(..) | Op::Xor(..) => vec![Self::OtherGate],
            Op::Lt(..) => vec![Self::OrEqual, Self::Swapped],
            Op::Select(..) => vec![Self::Swapped, Self::Always(First), Self::Always(Second)],
            Op::Port(_)
            | Op::Lit(_)
            | Op::Not(_)
            | Op::Widen(_)
            | Op::Narrow(_)
            | Op::Lookup(..)
            | Op::Claim { .. } => Vec::new(),
        }
    }

    /// Replacing operation, if it is one of the algebra.
    pub(super) const fn instead(self, op: Op) -> Option<Op> {
        Some(match (self, op) {
            (Self::Sign, Op::Add(a, b)) | (Self::Swapped, Op::Sub(b, a)) => Op::Sub(a, b),
            (Self::Sign, Op::Sub(a, b)) => Op::Add(a, b),
            (Self::Swapped, Op::Lt(a, b)) => Op::Lt(b, a),
            (Self::Swapped, Op::Select(flag, a, b)) => Op::Select(flag, b, a),
            (Self::OtherGate, Op::And(a, b) | Op::Xor(a, b)) => Op::Or(a, b),
            (Self::OtherGate, Op::Or(a, b)) => Op::And(a, b),
            (Self::Always(Side::First), Op::Select(flag, a, _)) => Op::Select(flag, a, a),
            (Self::Always(Side::Second), Op::Select(flag, _, b)) => Op::Select(flag, b, b),
            _ => return None,
        })
    }

    /// Integer of the wrong operation on its wire.
    pub(super) fn value(self, net: &Net, ranges: &Ranges, node: NodeId, of: impl Fn(NodeId) -> i64) -> i64 {
        let (op, kind) = (net.node(node).op, net.node(node).kind);
        let as_is = |op: Op| op.value(kind, |id| net.node(id).kind, &of);
        // Bits of an operand without the meaning of the top one.
        let natural = |id: NodeId| i128::from(of(id)) & ((1_i128 << ranges.of(id).top()) - 1);
        let by = |count: i64| (count as u32) & (kind.bits() - 1);
        let one = if self == Self::Further { 1 } else { -1 };
        let value = match (self, op) {
            (Self::WithoutConstant, Op::Add(a, _)) => of(a).into(),
            (Self::Unsigned(Side::First), Op::Mul(a, b)) => natural(a) * i128::from(of(b)),
            (Self::Unsigned(_), Op::Mul(a, b)) => i128::from(of(a)) * natural(b),
            (Self::Unsigned(_), Op::Sar(a, k)) => natural(a) >> by(k.into()),
            (Self::Unsigned(_), Op::SarBy(a, count)) => natural(a) >> by(of(count)),
            (Self::Further | Self::Nearer, Op::Shl(a, k)) => i128::from(of(a)) << by(i64::from(k) + one),
            (Self::Further | Self::Nearer, Op::Sar(a, k)) => i128::from(of(a)) >> by(i64::from(k) + one),
            (Self::Further | Self::Nearer, Op::ShlBy(a, count)) => i128::from(of(a)) << by(of(count) + one),
            (Self::Further | Self::Nearer, Op::SarBy(a, count)) => i128::from(of(a)) >> by(of(count) + one),
            (Self::Further | Self::Nearer, Op::LeadingZeros(_)) => as_is(op) + i128::from(one),
            (Self::OrEqual, Op::Lt(a, b)) => (of(a) <= of(b)).into(),
            _ => as_is(self.instead(op).unwrap_or(op)),
        };
        kind.cut(value as i64)
    }
}

impl fmt::Display for OperatorFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Sign => "with the other sign",
            Self::Swapped => "with its operands in each other's place",
            Self::WithoutConstant => "without its constant",
            Self::Unsigned(Side::First) => "without the sign of its first operand",
            Self::Unsigned(Side::Second) => "without the sign of its second operand",
            Self::Further => "by one more",
            Self::Nearer => "by one less",
            Self::OtherGate => "as another gate",
            Self::OrEqual => "or equal",
            Self::Always(Side::First) => "always the first value",
            Self::Always(Side::Second) => "always the second value",
        })
    }
}
