//! Numbers on wires, and the same numbers on wires of a different format.

use roughxel_netlist::verilog::PortDescription;

/// Format of a number on wires: value = stored integer / 2^`fraction_bits`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Pin {
    /// Bits.
    pub(crate) width: u32,
    /// True if the top bit is a sign.
    pub(crate) signed: bool,
    /// Binary point of the stored integer.
    pub(crate) fraction_bits: i32,
}

impl Pin {
    /// Format of a count without a sign.
    pub(crate) const fn count(width: u32) -> Self {
        Self::unsigned(width, 0)
    }

    /// Format of a number without a sign.
    pub(crate) const fn unsigned(width: u32, fraction_bits: i32) -> Self {
        Self { width, signed: false, fraction_bits }
    }

    /// Format of a port.
    pub(crate) fn of(port: &PortDescription) -> Self {
        Self { width: port.width, signed: port.signed, fraction_bits: port.format.stored_fraction_bits() }
    }

    /// Declared width: `[3:0] `, or nothing for one bit.
    pub(crate) fn vector(self) -> String {
        if self.width == 1 { String::new() } else { format!("[{}:0] ", self.width - 1) }
    }

    /// Wire of this format as an expression of exactly the bits of `to`. Bits that `to` lacks are lost.
    pub(crate) fn converted(self, wire: &str, to: Self) -> String {
        let shift = to.fraction_bits - self.fraction_bits;
        let (from, to) = (self.width as i32, to.width as i32);
        let low = (-shift).max(0);
        let high = (from - 1).min(to - 1 - shift);
        let taken = (high - low + 1).max(0);
        let zeros = shift.clamp(0, to);
        let above = to - taken - zeros;
        let mut parts = Vec::new();
        if above > 0 {
            let sign = if from == 1 { wire.to_owned() } else { format!("{wire}[{}]", from - 1) };
            parts.push(if self.signed { format!("{{{above}{{{sign}}}}}") } else { format!("{above}'d0") });
        }
        if taken > 0 {
            parts.push(match (taken == from, taken) {
                (true, _) => wire.to_owned(),
                (false, 1) => format!("{wire}[{low}]"),
                (false, _) => format!("{wire}[{high}:{low}]"),
            });
        }
        if zeros > 0 {
            parts.push(format!("{zeros}'d0"));
        }
        if parts.len() == 1 { parts.remove(0) } else { format!("{{{}}}", parts.join(", ")) }
    }

    /// Bits of a wire of this format that [`Self::converted`] loses.
    pub(crate) fn lost(self, wire: &str, to: Self) -> Vec<String> {
        let shift = to.fraction_bits - self.fraction_bits;
        let (from, to) = (self.width as i32, to.width as i32);
        let (low, high) = ((-shift).clamp(0, from), (from - 1).min(to - 1 - shift).max(-1));
        let part = |high: i32, low: i32| (high >= low).then(|| format!("{wire}[{high}:{low}]"));
        [part(from - 1, high.max(low - 1) + 1), part(low - 1, 0)].into_iter().flatten().collect()
    }

    /// Constant `value`/2^`fraction_bits` as a literal of this format.
    pub(crate) fn literal(self, value: i64, fraction_bits: u32) -> String {
        let shift = self.fraction_bits - fraction_bits as i32;
        let stored = if shift >= 0 { value << shift } else { value >> -shift };
        let bits = stored as u64 & (u64::MAX >> (64 - self.width.min(64)));
        format!("{}'h{bits:x}", self.width)
    }
}

#[cfg(test)]
mod tests {
    use super::Pin;

    #[test]
    fn a_converted_wire_has_the_bits_of_the_other_format() {
        let from = Pin { width: 4, signed: true, fraction_bits: 2 };
        let to = |width, fraction_bits| Pin { width, signed: true, fraction_bits };
        assert_eq!(from.converted("a", from), "a");
        assert_eq!(from.converted("a", to(7, 4)), "{{1{a[3]}}, a, 2'd0}");
        assert_eq!(from.converted("a", to(3, 2)), "a[2:0]");
        assert_eq!(from.converted("a", to(3, 1)), "a[3:1]");
        assert_eq!(Pin::count(1).converted("a", Pin::count(3)), "{2'd0, a}");
        assert_eq!(from.converted("a", to(4, -3)), "{4{a[3]}}");
    }

    #[test]
    fn bits_of_no_use_are_named() {
        let from = Pin::unsigned(6, 2);
        assert_eq!(from.lost("a", Pin::unsigned(3, 1)), ["a[5:4]", "a[0:0]"]);
        assert_eq!(from.lost("a", Pin::unsigned(9, 4)), [""; 0]);
        assert_eq!(from.lost("a", Pin::count(1)), ["a[5:3]", "a[1:0]"]);
    }

    #[test]
    fn a_literal_has_the_binary_point_of_its_wire() {
        assert_eq!(Pin::unsigned(4, 2).literal(3, 0), "4'hc");
        assert_eq!(Pin { width: 4, signed: true, fraction_bits: 0 }.literal(-8, 2), "4'he");
    }
}
