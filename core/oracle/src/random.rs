//! Seeded random numbers.

/// SplitMix64, started with a seed.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    /// A number below `end`.
    pub fn below(&mut self, end: u64) -> u64 {
        self.bits() % end
    }

    /// A number from `low` to `high`, often one of the two bounds, zero or near a power of two.
    pub fn within(&mut self, low: i64, high: i64) -> i64 {
        let span = high.wrapping_sub(low) as u64;
        let any = low.wrapping_add(if span == u64::MAX { self.bits() } else { self.below(span + 1) } as i64);
        match self.below(8) {
            0 => low,
            1 => high,
            2 => 0.clamp(low, high),
            3 => ((1_i64 << self.below(63)) - self.below(2) as i64).clamp(low, high),
            4 => (-1_i64 << self.below(63)).clamp(low, high),
            _ => any,
        }
    }
}
