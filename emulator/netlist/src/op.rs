//! Operations: integer, range, unit of hardware and text of each, in one place.
//!
//! The walks over a netlist ask an [`Op`]; the [`Operation`]s in the files below answer.

mod arithmetic;
mod given;
mod leading_zeros;
mod logic;
mod lookup;
mod operation;
mod same;
mod shift;

use super::graph::{Kind, NodeId, Op};
use super::range::{Exact, Ranges};
use super::relational_facts::RelationalFacts;
use super::unit::Unit;
use super::verilog::body::Body;
use super::verilog::value::Value;
use arithmetic::{Add, Lt, Mul, Sub};
use given::{Lit, Port};
use leading_zeros::LeadingZeros;
use logic::{And, Not, Or, Select, Xor};
use lookup::Lookup;
use operation::Operation;
use same::{Claim, Resized};
use shift::{Sar, SarBy, Shl, ShlBy};

/// Asks an operation of any kind.
macro_rules! ask {
    ($op:expr, $operation:ident => $question:expr) => {
        match $op {
            Op::Port(port) => ask!(@ Port(port), $operation => $question),
            Op::Lit(value) => ask!(@ Lit(value), $operation => $question),
            Op::Add(a, b) => ask!(@ Add(a, b), $operation => $question),
            Op::Sub(a, b) => ask!(@ Sub(a, b), $operation => $question),
            Op::Mul(a, b) => ask!(@ Mul(a, b), $operation => $question),
            Op::Shl(a, k) => ask!(@ Shl(a, k), $operation => $question),
            Op::Sar(a, k) => ask!(@ Sar(a, k), $operation => $question),
            Op::ShlBy(a, k) => ask!(@ ShlBy(a, k), $operation => $question),
            Op::SarBy(a, k) => ask!(@ SarBy(a, k), $operation => $question),
            Op::And(a, b) => ask!(@ And(a, b), $operation => $question),
            Op::Or(a, b) => ask!(@ Or(a, b), $operation => $question),
            Op::Xor(a, b) => ask!(@ Xor(a, b), $operation => $question),
            Op::Not(a) => ask!(@ Not(a), $operation => $question),
            Op::Lt(a, b) => ask!(@ Lt(a, b), $operation => $question),
            Op::Select(flag, a, b) => ask!(@ Select(flag, a, b), $operation => $question),
            Op::LeadingZeros(a) => ask!(@ LeadingZeros(a), $operation => $question),
            Op::Widen(a) => ask!(@ Resized(a), $operation => $question),
            Op::Narrow(a) => ask!(@ Resized(a), $operation => $question),
            Op::Lookup(index, table) => ask!(@ Lookup(index, table), $operation => $question),
            Op::Claim { of, low, high, .. } => ask!(@ Claim { of, low, high }, $operation => $question),
        }
    };
    (@ $made:expr, $operation:ident => $question:expr) => {{
        let $operation = $made;
        $question
    }};
}

impl Op {
    /// Exact integer of an operation of the kind `kind`: [`Operation::value`]. It is inlined, for callers often need 64 of its bits.
    #[inline(always)]
    pub(crate) fn value(self, kind: Kind, kind_of: impl Fn(NodeId) -> Kind, operand: impl Fn(NodeId) -> i64) -> i128 {
        ask!(self, operation => operation.value(kind, kind_of, operand))
    }

    /// True if it is defined for these operands: [`Operation::is_defined`].
    pub(crate) fn is_defined(self, kind: Kind, operand: impl Fn(NodeId) -> i64) -> bool {
        ask!(self, operation => operation.is_defined(kind, operand))
    }

    /// Exact range of its wire, number `id`: [`Operation::range`].
    pub(crate) fn range(self, known: &mut RelationalFacts, id: NodeId) -> Exact {
        ask!(self, operation => operation.range(known, id))
    }

    /// Hardware of node `id`: [`Operation::unit`].
    pub(crate) fn unit(self, ranges: &Ranges, id: NodeId) -> Unit {
        ask!(self, operation => operation.unit(ranges, id))
    }

    /// Value of node `id` in the text, if wires are enough: [`Operation::wiring`].
    pub(crate) fn wiring(self, body: &Body, id: NodeId) -> Option<Value> {
        ask!(self, operation => operation.wiring(body, id))
    }

    /// Lowest and one above the highest bit that is computed: [`Operation::span`].
    pub(crate) fn span(self, body: &Body, low: u32, high: u32) -> (u32, u32) {
        ask!(self, operation => operation.span(body, low, high))
    }

    /// Bits of its operands that it reads: [`Operation::reads`].
    pub(crate) fn reads(self, body: &Body, bits: u128, first: u32, last: u32) -> Vec<(NodeId, u128)> {
        ask!(self, operation => operation.reads(body, bits, first, last))
    }

    /// Right-hand side of its assignment: [`Operation::expression`].
    pub(crate) fn expression(self, body: &Body, first: u32, last: u32, rank: u32) -> String {
        ask!(self, operation => operation.expression(body, first, last, rank))
    }
}
