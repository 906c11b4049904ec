//! Seeded random numbers for generated maps, vectors and studies: SplitMix64 (Steele, Lea, Flood 2014).
//!
//! The same sequence on every machine; never used where quality against an adversary matters.

/// Generator state.
#[derive(Clone, Debug)]
pub struct SplitMix64(u64);

impl SplitMix64 {
    /// A generator; equal seeds give equal sequences.
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// A generator for element `index` of the set `name`: what one element is does not depend on how many there are.
    pub fn for_element(name: &str, index: u64) -> Self {
        // FNV-1a over the name, then one scramble with the index.
        let hash = name
            .bytes()
            .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
        let mut mixer = Self(hash ^ index.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        Self(mixer.next_u64())
    }

    /// 64 uniform bits.
    pub const fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// A uniform integer in `0..bound`; `bound` 0 gives 0. The bias is below `bound`/2^64.
    pub const fn below(&mut self, bound: u64) -> u64 {
        ((self.next_u64() as u128 * bound as u128) >> 64) as u64
    }

    /// A uniform number in [low, high).
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.next_u64() >> 11) as f64 / (1_u64 << 53) as f64)
    }
}
