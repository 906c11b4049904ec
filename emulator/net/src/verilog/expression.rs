//! Operations as expressions of exactly the bits they compute.

use super::body::{Body, Driver, hull, top};
use super::value::{Text, Value, Wire, constant_bits, literal, signed_constant, view_bits};
use crate::graph::{NodeId, Op};

impl Body<'_> {
    /// The wire of a node in a stage. An input has all its bits, anything else those that are read.
    pub(super) fn wire(&self, id: NodeId, stage: u32) -> Wire {
        let (made, range) = (self.stages[&id], self.range(id));
        let is_input = !self.nodes.contains(&id);
        let (low, high) =
            if is_input && stage == made { (range.zeros, top(range)) } else { hull(self.reads_from(id, stage)) };
        let name = match self.names.get(&id) {
            Some(name) if stage == made => name.clone(),
            Some(name) => format!("{name}_s{stage}"),
            None => String::new(),
        };
        Wire { name, low, high, signed: range.signed() && high == top(range) }
    }

    pub(super) fn text(&self, id: NodeId, low: u32, high: u32, stage: u32) -> Text {
        match self.value(id) {
            Value::Constant(value) => constant_bits(value, low, high),
            Value::Bits(view) => view_bits(&view, &self.wire(view.base, stage), low, high),
        }
    }

    pub(super) fn flag(&self, id: NodeId, stage: u32) -> String {
        self.text(id, 0, 1, stage).code
    }

    /// All of a node as an operand with a sign of its own: a factor, what is shifted to the right.
    pub(super) fn signed_operand(&self, id: NodeId, low: u32, high: u32, stage: u32) -> String {
        match self.value(id) {
            Value::Constant(value) => signed_constant(value, low, high),
            Value::Bits(_) => self.text(id, low, high, stage).as_signed(),
        }
    }

    /// A factor: signed where the product is.
    pub(super) fn factor(&self, id: NodeId, signed: bool, stage: u32) -> String {
        let range = self.range(id);
        let extra = u32::from(signed && !range.signed());
        let (low, high) = (range.zeros.min(62), top(range) + extra);
        if signed { self.signed_operand(id, low, high, stage) } else { self.text(id, low, high, stage).as_unsigned() }
    }

    /// The right-hand side that computes bits `first` up to `last`.
    pub(super) fn expression(&self, driver: Driver, first: u32, last: u32, stage: u32) -> String {
        let text = |id| self.text(id, first, last, stage).code;
        let op = match driver {
            Driver::IsZero(x) | Driver::IsNotZero(x) => {
                let (low, high) = (self.range(x).zeros, top(self.range(x)));
                let sign = if matches!(driver, Driver::IsZero(_)) { "==" } else { "!=" };
                return format!("{} {sign} {}", self.text(x, low, high, stage).code, literal(0, high - low));
            }
            Driver::Op(op) => op,
        };
        match op {
            Op::Add(a, b) => match self.constant(b) {
                Some(c) if c < 0 => format!("{} - {}", text(a), constant_bits(-c, first, last).code),
                _ => format!("{} + {}", text(a), text(b)),
            },
            Op::Sub(a, b) if self.constant(a) == Some(0) => format!("-{}", text(b)),
            Op::Sub(a, b) => format!("{} - {}", text(a), text(b)),
            Op::And(a, b) => format!("{} & {}", text(a), text(b)),
            Op::Or(a, b) => format!("{} | {}", text(a), text(b)),
            Op::Xor(a, b) => format!("{} ^ {}", text(a), text(b)),
            Op::Select(flag, a, b) => {
                let flag = self.flag(flag, stage);
                match flag.strip_prefix('~') {
                    Some(flag) => format!("{flag} ? {} : {}", text(b), text(a)),
                    None => format!("{flag} ? {} : {}", text(a), text(b)),
                }
            }
            Op::Lt(a, b) => {
                let (low, high) = self.compared(a, b);
                if self.range(a).signed() || self.range(b).signed() {
                    let side = |id| self.signed_operand(id, low, high, stage);
                    format!("{} < {}", side(a), side(b))
                } else {
                    let side = |id| self.text(id, low, high, stage).as_unsigned();
                    format!("{} < {}", side(a), side(b))
                }
            }
            Op::Mul(a, b) => {
                let signed = self.range(a).signed() || self.range(b).signed();
                format!("{} * {}", self.factor(a, signed, stage), self.factor(b, signed, stage))
            }
            Op::ShlBy(x, count) => format!("{} << {}", text(x), self.places(count, stage)),
            Op::SarBy(x, count) => {
                if self.range(x).signed() {
                    format!("{} >>> {}", self.signed_operand(x, first, last, stage), self.places(count, stage))
                } else {
                    format!("{} >> {}", text(x), self.places(count, stage))
                }
            }
            Op::Claim { of, .. } => text(of),
            // Wiring and instances have no expression.
            Op::Port(_) | Op::Lit(_) | Op::Shl(..) | Op::Sar(..) | Op::Not(_) | Op::Widen(_) | Op::Narrow(_) => {
                String::new()
            }
            Op::LeadingZeros(_) | Op::Lookup(..) => String::new(),
        }
    }

    pub(super) fn places(&self, count: NodeId, stage: u32) -> String {
        self.text(count, 0, top(self.range(count)), stage).code
    }
}
