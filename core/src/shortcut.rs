//! Compound steps that a reading may take in fewer operations than their text: what they give is what the text gives.
//!
//! The text is the meaning, and what hardware has; lanes and [`mod@crate::small`] have shorter ways. [`crate::word::Word::round`] is the third.

use crate::each::each;
use crate::word::{WideWire, Wire, Word};

/// The steps of words.
pub trait WordShortcut: Wire {
    /// The outcome of `body`. Where the flag is set, that is `instead`, or nobody uses it: a reading may leave the work.
    #[inline(always)]
    fn unless<T>(unused: Self::Flag, instead: T, body: impl FnOnce() -> T) -> T {
        let _ = (unused, instead);
        body()
    }
}

/// The steps of wide wires.
pub trait WideShortcut: WideWire {
    /// `wires` shifted left until the highest bit of one of them stands behind the sign, each then rounded as by [`Word::round`];
    /// beside them their common leading bits, the sign among them, and whether all are zero.
    ///
    /// Range: any wires; `drop + up` more than the bits of a word.
    #[inline(always)]
    fn normalised<const N: usize>(wires: [Self; N], drop: u32, up: u32) -> ([Self::Word; N], Self::Count, Self::Flag) {
        // One's complement magnitude: −2^k counts as the octave below, which is what lets −1 occur.
        // As many leading zeros as there are bits are not enough for a block of zeros: −1 has them, too, but is negative.
        let (mut magnitude, mut bits) = (Self::lit(0), Self::lit(0));
        for wire in &wires {
            magnitude = magnitude.or(wire.xor(wire.sar(Self::BITS - 1)));
            bits = bits.or(*wire);
        }
        let zeros = magnitude.leading_zeros();
        let all_zero = !zeros.lt(Wire::lit(Self::BITS.into())) & !bits.lt(Self::lit(0));
        let shift = zeros.sub(Wire::lit(1));
        (each!(wire in wires => Self::Word::round(wire.shl_by(shift), drop, up)), zeros, all_zero)
    }
}
