//! Shifts by constants, which are wires, and by counts on wires.

use super::operation::Operation;
use crate::graph::{Kind, NodeId};
use crate::range::{Exact, Ranges};
use crate::relational_facts::RelationalFacts;
use crate::unit::Unit;
use crate::verilog::body::{Body, mask};
use crate::verilog::value::Value;

/// Shift count as a wire of a kind takes it: modulo its width.
fn places(kind: Kind, count: i64) -> u32 {
    count as u32 & (kind.bits() - 1)
}

fn is_below_width(kind: Kind, count: i64) -> bool {
    (0..i64::from(kind.bits())).contains(&count)
}

/// a · 2^k.
pub(super) struct Shl(pub NodeId, pub u32);

impl Operation for Shl {
    #[inline(always)]
    fn value(&self, kind: Kind, _: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128 {
        i128::from(operand(self.0)) << places(kind, self.1.into())
    }
    fn is_defined(&self, kind: Kind, _: impl Fn(NodeId) -> i64) -> bool {
        is_below_width(kind, self.1.into())
    }
    fn range(&self, known: &mut RelationalFacts, id: NodeId) -> Exact {
        let Self(a, k) = *self;
        known.places(id, k.into(), k.into());
        let a = known.range(a);
        Exact { low: a.low << k, high: a.high << k, zeros: (a.zeros + k).min(63) }
    }
    fn wiring(&self, body: &Body, _: NodeId) -> Option<Value> {
        Some(Value::Bits(body.view(self.0)?.shl(self.1)))
    }
    fn reads(&self, _: &Body, bits: u128, _: u32, _: u32) -> Vec<(NodeId, u128)> {
        vec![(self.0, bits)]
    }
}

/// ⌊a / 2^k⌋.
pub(super) struct Sar(pub NodeId, pub u32);

impl Operation for Sar {
    #[inline(always)]
    fn value(&self, kind: Kind, _: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128 {
        i128::from(operand(self.0)) >> places(kind, self.1.into())
    }
    fn is_defined(&self, kind: Kind, _: impl Fn(NodeId) -> i64) -> bool {
        is_below_width(kind, self.1.into())
    }
    fn range(&self, known: &mut RelationalFacts, id: NodeId) -> Exact {
        let Self(a, k) = *self;
        known.places(id, k.into(), k.into());
        let a = known.range(a);
        Exact { low: a.low >> k, high: a.high >> k, zeros: a.zeros.saturating_sub(k) }
    }
    fn wiring(&self, body: &Body, _: NodeId) -> Option<Value> {
        Some(Value::Bits(body.view(self.0)?.sar(self.1)))
    }
    fn reads(&self, _: &Body, bits: u128, _: u32, _: u32) -> Vec<(NodeId, u128)> {
        vec![(self.0, bits)]
    }
}

/// a · 2^count.
pub(super) struct ShlBy(pub NodeId, pub NodeId);

impl Operation for ShlBy {
    #[inline(always)]
    fn value(&self, kind: Kind, _: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128 {
        i128::from(operand(self.0)) << places(kind, operand(self.1))
    }
    fn is_defined(&self, kind: Kind, operand: impl Fn(NodeId) -> i64) -> bool {
        is_below_width(kind, operand(self.1))
    }
    fn range(&self, known: &mut RelationalFacts, id: NodeId) -> Exact {
        let (x, count) = (known.range(self.0), known.range(self.1));
        let (least, most) = known.places(id, count.low, count.high);
        if known.normalises(self.0, self.1) {
            let (low, high) = known.net.node(id).kind.limits();
            return Exact { low: low.into(), high: high.into(), zeros: x.zeros };
        }
        Exact::corners([x.low << least, x.low << most, x.high << least, x.high << most], x.zeros + least)
    }
    fn unit(&self, ranges: &Ranges, id: NodeId) -> Unit {
        let bits = ranges.of(id).width().max(ranges.of(self.0).width());
        Unit::Shifter { bits, places: ranges.of(self.1).width() }
    }
    fn span(&self, body: &Body, low: u32, high: u32) -> (u32, u32) {
        let most = body.range(self.1).high.clamp(0, 63) as u32;
        (body.range(self.0).zeros.max(low.saturating_sub(most)), high)
    }
    fn reads(&self, body: &Body, _: u128, first: u32, last: u32) -> Vec<(NodeId, u128)> {
        vec![(self.0, mask(first, last)), (self.1, body.all_bits(self.1))]
    }
    fn expression(&self, body: &Body, first: u32, last: u32, rank: u32) -> String {
        format!("{} << {}", body.text(self.0, first, last, rank).code, body.places(self.1, rank))
    }
}

/// ⌊a / 2^count⌋.
pub(super) struct SarBy(pub NodeId, pub NodeId);

impl Operation for SarBy {
    #[inline(always)]
    fn value(&self, kind: Kind, _: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128 {
        i128::from(operand(self.0)) >> places(kind, operand(self.1))
    }
    fn is_defined(&self, kind: Kind, operand: impl Fn(NodeId) -> i64) -> bool {
        is_below_width(kind, operand(self.1))
    }
    fn range(&self, known: &mut RelationalFacts, id: NodeId) -> Exact {
        let (x, count) = (known.range(self.0), known.range(self.1));
        let (least, most) = known.places(id, count.low, count.high);
        let corners = [x.low >> least, x.low >> most, x.high >> least, x.high >> most];
        Exact::corners(corners, x.zeros.saturating_sub(most))
    }
    fn unit(&self, ranges: &Ranges, _: NodeId) -> Unit {
        Unit::Shifter { bits: ranges.of(self.0).width(), places: ranges.of(self.1).width() }
    }
    fn span(&self, body: &Body, low: u32, high: u32) -> (u32, u32) {
        (low, high.max(body.range(self.0).top()))
    }
    fn reads(&self, body: &Body, _: u128, first: u32, _: u32) -> Vec<(NodeId, u128)> {
        vec![(self.0, mask(first, body.range(self.0).top())), (self.1, body.all_bits(self.1))]
    }
    fn expression(&self, body: &Body, first: u32, last: u32, rank: u32) -> String {
        let places = body.places(self.1, rank);
        if body.range(self.0).signed() {
            format!("{} >>> {places}", body.signed_operand(self.0, first, last, rank))
        } else {
            format!("{} >> {places}", body.text(self.0, first, last, rank).code)
        }
    }
}
