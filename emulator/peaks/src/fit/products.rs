//! Products of lists that are 0 outside some of their blocks.

use fearless_simd::f64x8;
use fearless_simd::prelude::*;

use crate::blocks::{Block, LANES, joined};
use crate::spread::BLOCKS;

/// A set of blocks, one bit each.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BlockSet([u64; BLOCKS.div_ceil(64)]);

impl BlockSet {
    /// Blocks of eight samples.
    pub(super) const WHOLE: Self = {
        let mut blocks = [u64::MAX; BLOCKS.div_ceil(64)];
        blocks[(BLOCKS - 1) / 64] = (1 << ((BLOCKS - 1) % 64)) - 1;
        Self(blocks)
    };
    /// Last block, of one sample.
    pub(super) const LAST: Self = {
        let mut blocks = [0; BLOCKS.div_ceil(64)];
        blocks[(BLOCKS - 1) / 64] = 1 << ((BLOCKS - 1) % 64);
        Self(blocks)
    };
    pub(super) const ALL: Self = Self([u64::MAX; BLOCKS.div_ceil(64)]);

    #[inline(always)]
    pub(super) fn add(&mut self, block: usize) {
        self.0[block / 64] |= 1 << (block % 64);
    }

    #[inline(always)]
    pub(super) fn common(self, other: Self) -> Self {
        Self(std::array::from_fn(|word| self.0[word] & other.0[word]))
    }

    /// Visits the blocks in order.
    #[inline(always)]
    pub(super) fn each(self, mut visit: impl FnMut(usize)) {
        for (word, mut bits) in self.0.into_iter().enumerate() {
            while bits != 0 {
                visit(64 * word + bits.trailing_zeros() as usize);
                bits &= bits - 1;
            }
        }
    }
}

/// Products of lists that are 0 outside some blocks: every list of `left` with every list of `right`.
///
/// Terms are summed in the order of [`dot`]: whole blocks as eight sums, the rest one by one.
#[inline(always)]
pub(super) fn products<'a, S: Simd, const M: usize, const N: usize>(
    simd: S,
    blocks: BlockSet,
    left: impl Fn(usize) -> [&'a Block; M],
    right: impl Fn(usize) -> [&'a Block; N],
) -> [[f64; N]; M] {
    let mut sums = [[f64x8::splat(simd, 0.0); N]; M];
    blocks.common(BlockSet::WHOLE).each(|block| {
        let right = right(block).map(|right| right.load(simd));
        for (sums, left) in sums.iter_mut().zip(left(block)) {
            let left = left.load(simd);
            for (sum, right) in sums.iter_mut().zip(right) {
                *sum += left * right;
            }
        }
    });
    let mut products = sums.map(|sums| sums.map(|sum| joined(sum.into())));
    blocks.common(BlockSet::LAST).each(|block| {
        for (sums, left) in products.iter_mut().zip(left(block)) {
            for (sum, right) in sums.iter_mut().zip(right(block)) {
                *sum += left.0[0] * right.0[0];
            }
        }
    });
    products
}

/// The product of two short lists.
#[inline(always)]
pub(super) fn dot(left: &[f64], right: &[f64]) -> f64 {
    let (wholes, rest) = left.as_chunks::<LANES>();
    let (other_wholes, other_rest) = right.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (left, right) in wholes.iter().zip(other_wholes) {
        for ((sum, left), right) in sums.iter_mut().zip(left).zip(right) {
            *sum += left * right;
        }
    }
    rest.iter().zip(other_rest).fold(joined(sums), |sum, (left, right)| sum + left * right)
}
