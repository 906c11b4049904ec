//! Seeded random numbers for generated maps, vectors and studies: SplitMix64 (Steele, Lea, Flood 2014).
//!
//! The sequence is the same on every machine. It is never used if quality against an adversary matters.

/// Increment of the state for each number.
const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// Generator state.
#[derive(Clone, Debug)]
pub struct SplitMix64(u64);

impl SplitMix64 {
    /// Generator from a seed; equal seeds give equal sequences.
    #[inline(always)]
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Generator for element `index` of the set `name`. An element does not depend on the size of its set.
    pub fn for_element(name: &str, index: u64) -> Self {
        Self::for_element_of(Self::hash_of(name), index)
    }

    /// Hash of the name of a set, for its elements: FNV-1a.
    pub fn hash_of(name: &str) -> u64 {
        name.bytes()
            .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
    }

    /// Generator of an element of the set whose name has this [hash](Self::hash_of).
    #[inline(always)]
    pub const fn for_element_of(hash: u64, index: u64) -> Self {
        // One scramble with the index.
        let mut mixer = Self(hash ^ index.wrapping_mul(GAMMA));
        Self(mixer.next_u64())
    }

    /// Generator after `count` more numbers.
    #[inline(always)]
    pub const fn after(self, count: u64) -> Self {
        Self(self.0.wrapping_add(count.wrapping_mul(GAMMA)))
    }

    /// 64 uniform bits.
    #[inline(always)]
    pub const fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(GAMMA);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// A uniform integer in `0..bound`; `bound` 0 gives 0. The bias is below `bound`/2^64.
    #[inline(always)]
    pub const fn below(&mut self, bound: u64) -> u64 {
        // The upper half of a 128-bit product, from halves of its factors: loops over these become vectors.
        let (number, half) = (self.next_u64(), u32::MAX as u64);
        let ([high, low], [bound_high, bound_low]) = ([number >> 32, number & half], [bound >> 32, bound & half]);
        let middle = [high * bound_low, low * bound_high];
        let carry = ((low * bound_low) >> 32) + (middle[0] & half) + (middle[1] & half);
        high * bound_high + (middle[0] >> 32) + (middle[1] >> 32) + (carry >> 32)
    }

    /// A uniform number in [low, high).
    #[inline(always)]
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.next_u64() >> 11) as f64 / (1_u64 << 53) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_below_a_bound_is_the_upper_half_of_a_product() {
        let mut bounds = SplitMix64::new(1);
        for bound in [0, 1, 3, 10, 1 << 32, u64::MAX].into_iter().chain((0..64).map(|by| bounds.next_u64() >> by)) {
            let mut random = SplitMix64::for_element("below", bound);
            let product = u128::from(random.clone().next_u64()) * u128::from(bound);
            assert_eq!(u128::from(random.below(bound)), product >> 64);
        }
    }
}
