//! Backward rules: ranges of operands from the range of a wire.

use std::collections::BTreeSet;

use super::{Condition, Never, Prover};
use crate::graph::{Kind, NodeId, Op};

impl Prover<'_> {
    /// True if a normalisation by `count` is of one wire alone.
    fn is_alone(&self, x: NodeId, count: NodeId) -> bool {
        let Op::Sub(zeros, _) = self.right.op(count) else { return false };
        matches!(self.right.op(zeros), Op::LeadingZeros(of) if self.right.magnitude_of(of) == Some(x))
    }

    /// Narrows the operands of a wire by its range.
    pub(super) fn narrow_operands(&mut self, id: NodeId, waiting: &mut BTreeSet<NodeId>) -> Result<(), Never> {
        let r = self.right.range(id);
        let of = |id: NodeId| self.right.range(id);
        let any = (i128::MIN, i128::MAX);
        let is_flag = self.kind(id) == Kind::Flag;
        let mut found = Condition::new();
        match self.right.op(id) {
            Op::Port(_) | Op::Lit(_) | Op::Lookup(..) => {}
            Op::Add(a, b) => {
                found.push((a, r.low - of(b).high, r.high - of(b).low));
                found.push((b, r.low - of(a).high, r.high - of(a).low));
            }
            Op::Sub(a, b) => {
                found.push((a, r.low + of(b).low, r.high + of(b).high));
                found.push((b, of(a).low - r.high, of(a).high - r.low));
            }
            Op::Mul(a, b) => {
                for (one, other) in [(a, b), (b, a)] {
                    let by = of(other);
                    if by.low > 0 || by.high < 0 {
                        let quotients = [(r.low, by.low), (r.low, by.high), (r.high, by.low), (r.high, by.high)];
                        let floors =
                            quotients.map(|(x, y)| x.div_euclid(y) - i128::from(y < 0 && x.rem_euclid(y) != 0));
                        let (low, high) =
                            floors.iter().fold((i128::MAX, i128::MIN), |(low, high), &x| (low.min(x), high.max(x + 1)));
                        let exactly_zero = r.low == 0 && r.high == 0;
                        found.push(if exactly_zero { (one, 0, 0) } else { (one, low, high) });
                    }
                }
                if a == b && r.high == 0 {
                    found.push((a, 0, 0));
                }
            }
            Op::Shl(a, k) => found.push((a, -(-r.low >> k), r.high >> k)),
            Op::Sar(a, k) => found.push((a, r.low << k, ((r.high + 1) << k) - 1)),
            Op::ShlBy(a, count) => {
                let half = 1_i128 << (self.kind(id).bits() - 2);
                if self.right.normalises(a, count) && self.is_alone(a, count) && r.low > -half && r.high < half {
                    found.push((a, 0, 0));
                }
                let (least, most) = (of(count).low as u32, of(count).high as u32);
                let low = if r.low <= 0 { -(-r.low >> least) } else { -(-r.low >> most) };
                let high = if r.high >= 0 { r.high >> least } else { r.high >> most };
                found.push((a, low, high));
            }
            Op::SarBy(a, count) => {
                let (least, most) = (of(count).low as u32, of(count).high as u32);
                let low = r.low << if r.low >= 0 { least } else { most };
                let high = ((r.high + 1) << if r.high >= 0 { most } else { least }) - 1;
                found.push((a, low, high));
            }
            Op::And(a, b) if is_flag => {
                for (one, other) in [(a, b), (b, a)] {
                    if r.low == 1 {
                        found.push((one, 1, 1));
                    } else if r.high == 0 && of(other).low == 1 {
                        found.push((one, 0, 0));
                    }
                }
            }
            Op::And(..) => {}
            Op::Or(a, b) => {
                for (one, other) in [(a, b), (b, a)] {
                    if r.low >= 0 {
                        found.push((one, 0, r.high));
                    } else if r.high < 0 && of(other).low >= 0 {
                        found.push((one, any.0, -1));
                    }
                    if is_flag && r.low == 1 && of(other).high == 0 {
                        found.push((one, 1, 1));
                    }
                }
            }
            Op::Xor(..) => {
                if let Some(x) = self.right.magnitude_of(id) {
                    found.push((x, -1 - r.high, r.high));
                    if of(x).low >= 0 {
                        found.push((x, r.low, any.1));
                    } else if of(x).high < 0 {
                        found.push((x, any.0, -1 - r.low));
                    }
                }
            }
            Op::Not(a) => found.push((a, 1 - r.high, 1 - r.low)),
            Op::Lt(a, b) => {
                if r.low == 1 {
                    found.extend([(a, any.0, of(b).high - 1), (b, of(a).low + 1, any.1)]);
                } else if r.high == 0 {
                    found.extend([(a, of(b).low, any.1), (b, any.0, of(a).high)]);
                }
            }
            Op::Select(flag, a, b) => {
                let apart = |value: NodeId| of(value).high < r.low || of(value).low > r.high;
                if of(flag).low == 1 || apart(b) {
                    found.extend([(flag, 1, 1), (a, r.low, r.high)]);
                } else if of(flag).high == 0 || apart(a) {
                    found.extend([(flag, 0, 0), (b, r.low, r.high)]);
                }
                match self.right.op(flag) {
                    // The smaller of two is no larger than either.
                    Op::Lt(x, y) if (x, y) == (a, b) => found.extend([a, b].map(|of| (of, r.low, any.1))),
                    Op::Lt(x, y) if (x, y) == (b, a) => found.extend([a, b].map(|of| (of, any.0, r.high))),
                    _ => {}
                }
                found.extend(self.right.absolute_of(id).map(|x| (x, -r.high, r.high)));
            }
            Op::LeadingZeros(a) => {
                let bits = i128::from(self.kind(a).bits());
                if r.low > 0 {
                    let low = if r.high < bits { 1 << (bits - r.high - 1) } else { 0 };
                    found.push((a, low, (1 << (bits - r.low)) - 1));
                } else if r.high == 0 {
                    found.push((a, any.0, -1));
                }
            }
            Op::Widen(a) | Op::Narrow(a) | Op::Claim { of: a, .. } => found.push((a, r.low, r.high)),
        }
        found.into_iter().try_for_each(|(id, low, high)| self.meet(id, low, high, waiting))
    }
}
