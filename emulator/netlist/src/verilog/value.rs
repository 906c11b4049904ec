//! Values of nodes in the text: a constant, or bits of a wire.
//!
//! Shifts by constants, remainders of powers of two, signs and inversions are bits of a different wire and get no wire themselves. Bit positions are
//! those of the node's integer.

use crate::graph::NodeId;

/// A node's integer as bits of a wire: bit p of the value is bit p − `shift` of the wire's integer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct View {
    /// Node that has the wire.
    pub(crate) base: NodeId,
    /// Places to the left.
    pub(crate) shift: i32,
    /// Bits of the wire's integer below this one read zero.
    pub(crate) cut: i32,
    /// Bits of the value from this one on read zero.
    pub(crate) limit: Option<i32>,
    /// The one bit of a flag, inverted.
    pub(crate) inverted: bool,
}

impl View {
    /// The wire itself.
    pub(crate) fn of(base: NodeId) -> Self {
        Self { base, shift: 0, cut: 0, limit: None, inverted: false }
    }

    /// Multiplies by 2^k.
    pub(crate) fn shl(self, k: u32) -> Self {
        let k = k as i32;
        Self { shift: self.shift + k, limit: self.limit.map(|limit| limit + k), ..self }
    }

    /// Divides by 2^k and rounds down.
    pub(crate) fn sar(self, k: u32) -> Self {
        let k = k as i32;
        let limit = self.limit.map(|limit| (limit - k).max(0));
        let shift = self.shift - k;
        Self { shift, cut: self.cut.max(-shift), limit, ..self }
    }

    /// Keeps the lowest `k` bits.
    pub(crate) fn low_bits(self, k: u32) -> Self {
        let k = k as i32;
        Self { limit: Some(self.limit.map_or(k, |limit| limit.min(k))), ..self }
    }

    /// Keeps bit `p` alone.
    pub(crate) fn bit(self, p: u32) -> Self {
        self.sar(p).low_bits(1)
    }

    /// Inverts a flag.
    pub(crate) fn not(self) -> Self {
        Self { inverted: !self.inverted, ..self }
    }
}

/// A node in the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Value {
    /// A constant.
    Constant(i64),
    /// Bits of a wire.
    Bits(View),
}

/// Existing bits of a wire, from `low` up to but not `high`; the top one is a sign if `signed`.
#[derive(Clone, Debug)]
pub(crate) struct Wire {
    pub(crate) name: String,
    pub(crate) low: u32,
    pub(crate) high: u32,
    pub(crate) signed: bool,
}

impl Wire {
    pub(crate) fn width(&self) -> u32 {
        self.high - self.low
    }

    /// Bits `low` up to `high` of the integer, all of them existing.
    pub(crate) fn slice(&self, low: u32, high: u32) -> String {
        let Self { name, low: first, .. } = self;
        match high - low {
            _ if low == self.low && high == self.high => name.clone(),
            1 => format!("{name}[{}]", low - first),
            _ => format!("{name}[{}:{}]", high - 1 - first, low - first),
        }
    }
}

/// An expression of a known width.
#[derive(Clone, Debug)]
pub(crate) struct Text {
    pub(crate) code: String,
    /// True for one signed wire; a slice or a concatenation is unsigned.
    pub(crate) signed: bool,
}

impl Text {
    /// The expression as a signed one.
    pub(crate) fn as_signed(&self) -> String {
        if self.signed { self.code.clone() } else { format!("$signed({})", self.code) }
    }

    /// The expression as an unsigned one.
    pub(crate) fn as_unsigned(&self) -> String {
        if self.signed { format!("$unsigned({})", self.code) } else { self.code.clone() }
    }
}

/// A constant of `width` bits.
pub(crate) fn literal(bits: u128, width: u32) -> String {
    sized(bits, width, "")
}

fn sized(bits: u128, width: u32, sign: &str) -> String {
    let bits = if width < 128 { bits & ((1 << width) - 1) } else { bits };
    if width == 1 {
        return format!("1'{sign}b{bits}");
    }
    if bits < 1000 {
        return format!("{width}'{sign}d{bits}");
    }
    let digits = format!("{bits:x}");
    let mut grouped = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index) % 4 == 0 {
            grouped.push('_');
        }
        grouped.push(digit);
    }
    format!("{width}'{sign}h{grouped}")
}

/// Bits `low` up to `high` of a constant.
pub(crate) fn constant_bits(value: i64, low: u32, high: u32) -> Text {
    Text { code: literal((i128::from(value) >> low.min(127)) as u128, high - low), signed: false }
}

/// Bits `low` up to `high` of a constant as a signed number.
pub(crate) fn signed_constant(value: i64, low: u32, high: u32) -> String {
    sized((i128::from(value) >> low.min(127)) as u128, high - low, "s")
}

/// Bits `low` up to `high` of a view of `wire`. Bits that the wire does not have read zero, or its sign above its top.
pub(crate) fn view_bits(view: &View, wire: &Wire, low: u32, high: u32) -> Text {
    let (low, high) = (low as i32, high as i32);
    let limit = view.limit.unwrap_or(high).clamp(low, high);
    let above = high - limit;
    // These are places in the wire's integer.
    let (from, upto) = (low - view.shift, limit - view.shift);
    let first = from.max(view.cut).max(wire.low as i32).min(upto);
    let zeros = first - from;
    let last = upto.min(wire.high as i32).max(first);
    let mut parts = Vec::new();
    let pad = |count: i32| (count > 0).then(|| literal(0, count as u32));
    parts.extend(pad(above));
    let beyond = upto - last;
    if beyond > 0 {
        if wire.signed {
            let sign = wire.slice(wire.high - 1, wire.high);
            parts.push(if beyond == 1 { sign } else { format!("{{{beyond}{{{sign}}}}}") });
        } else {
            parts.extend(pad(beyond));
        }
    }
    if last > first {
        let bits = wire.slice(first as u32, last as u32);
        parts.push(if view.inverted { format!("~{bits}") } else { bits });
    }
    parts.extend(pad(zeros));
    match &parts[..] {
        [alone] => Text { code: alone.clone(), signed: wire.signed && *alone == wire.name },
        _ => Text { code: format!("{{{}}}", parts.join(", ")), signed: false },
    }
}
