//! Blocks: eight samples per vector operation of the machine; powers of their cosines.
//!
//! Logarithm and exponential are those of the crate `libm`, operation by operation, with selections in place of its branches. They give the same
//! bits on every instruction set, without fused operations. They cover only the arguments of the powers: cosines that are not negligible, and
//! negative logarithms.
//!
//! `libm` has them from FreeBSD's `e_log.c` and `e_exp.c`: Copyright (C) 1993, 2004 by Sun Microsystems, Inc. All rights reserved. Developed at
//! SunSoft, a Sun Microsystems, Inc. business. Permission to use, copy, modify, and distribute this software is freely granted, provided that this
//! notice is preserved.

use std::sync::LazyLock;

use fearless_simd::prelude::*;
use fearless_simd::{Level, f64x8, u64x8};
use glam::DVec3;

/// Samples of a block.
pub(super) const LANES: usize = 8;

/// Instruction set of the machine, detected once.
pub(super) static LEVEL: LazyLock<Level> = LazyLock::new(Level::new);

/// Eight numbers for one vector load, aligned to a cache line: a 512-bit vector is as long as a line.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Block(pub(super) [f64; LANES]);

impl Block {
    pub(super) const ZERO: Self = Self([0.0; LANES]);

    /// Blocks of a list, padded with zeros after its end.
    pub(super) fn list(values: impl IntoIterator<Item = f64>) -> Vec<Self> {
        let mut blocks = Vec::new();
        for (index, value) in values.into_iter().enumerate() {
            if index % LANES == 0 {
                blocks.push(Self::ZERO);
            }
            if let Some(Self(lanes)) = blocks.last_mut() {
                lanes[index % LANES] = value;
            }
        }
        blocks
    }

    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S) -> f64x8<S> {
        f64x8::from_slice(simd, &self.0)
    }

    #[inline(always)]
    pub(super) fn store<S: Simd>(values: f64x8<S>) -> Self {
        Self(values.into())
    }
}

/// Sum of the eight numbers.
#[inline(always)]
pub(super) fn joined(sums: [f64; LANES]) -> f64 {
    (sums[0] + sums[4]) + (sums[1] + sums[5]) + (sums[2] + sums[6]) + (sums[3] + sums[7])
}

/// Coordinates of eight directions.
pub(super) type Directions = [Block; 3];

/// Cosines between one direction and eight, summed in the order of [`DVec3::dot`].
#[inline(always)]
pub(super) fn cosines<S: Simd>(simd: S, direction: DVec3, [x, y, z]: &Directions) -> f64x8<S> {
    x.load(simd) * direction.x + y.load(simd) * direction.y + z.load(simd) * direction.z
}

/// ln of a facet's share of its maximum below which it counts as 0 at a sample: 8e-7, equal to all of its energy beyond.
///
/// With 1e-13, fits to facets of exponent 40 take 25 % more time, and residuals differ by 1e-6 of the density.
pub(super) const NEGLIGIBLE: f64 = -14.0;

/// cosⁿα, 0 if it is negligible; `None` if all eight are negligible. Exponents are at least 1.
#[inline(always)]
pub(super) fn powers<S: Simd>(cos: f64x8<S>, exponent: f64x8<S>) -> Option<f64x8<S>> {
    log_powers(cos, exponent).map(shares)
}

/// ln cosⁿα, [`NEGLIGIBLE`] if cosⁿα is; `None` if all eight are negligible.
#[inline(always)]
pub(super) fn log_powers<S: Simd>(cos: f64x8<S>, exponent: f64x8<S>) -> Option<f64x8<S>> {
    let simd = cos.simd;
    // ln x ≤ x − 1 settles most samples without a logarithm.
    let near = cos.simd_gt(0.0) & (exponent * (cos - 1.0)).simd_ge(NEGLIGIBLE);
    if near.all_false() {
        return None;
    }
    Some(near.select(exponent * log(cos), f64x8::splat(simd, NEGLIGIBLE)))
}

/// cosⁿα from its logarithm, 0 if it is negligible.
#[inline(always)]
pub(super) fn shares<S: Simd>(logs: f64x8<S>) -> f64x8<S> {
    logs.simd_gt(NEGLIGIBLE).select(exp(logs), f64x8::splat(logs.simd, 0.0))
}

/// ln 2 in two parts: the product of the first with a small integer is exact.
const LN2_HI: f64 = 0.693_147_180_369_123_8;
const LN2_LO: f64 = 1.908_214_929_270_587_7e-10;

/// ln x of normal numbers above 0; unspecified for other arguments.
///
/// No cosine that is not negligible is subnormal: its logarithm would be below −708.
#[inline(always)]
fn log<S: Simd>(x: f64x8<S>) -> f64x8<S> {
    const LG1: f64 = 0.666_666_666_666_673_5;
    const LG2: f64 = 0.399_999_999_994_094_2;
    const LG3: f64 = 0.285_714_287_436_623_9;
    const LG4: f64 = 0.222_221_984_321_497_84;
    const LG5: f64 = 0.181_835_721_616_180_5;
    const LG6: f64 = 0.153_138_376_992_093_73;
    const LG7: f64 = 0.147_981_986_051_165_86;
    /// Upper halves of the bits of 1 and of √½.
    const ONE: u64 = 0x3ff0_0000 << 32;
    const ROOT: u64 = 0x3fe6_a09e << 32;
    let simd = x.simd;
    // x = 2^k (1 + f) with 1 + f from √½ to √2.
    let bits: u64x8<S> = x.bitcast::<u64x8<S>>() + (ONE - ROOT);
    let k = small_integer(bits >> 52) - (SMALL_INTEGERS + 1023.0);
    let f = ((bits & (u64::MAX >> 12)) + ROOT).bitcast::<f64x8<S>>() - 1.0;
    let half_square = f64x8::splat(simd, 0.5) * f * f;
    let s = f / (f64x8::splat(simd, 2.0) + f);
    let z = s * s;
    let w = z * z;
    let even = w * (w * (w * LG6 + LG4) + LG2);
    let odd = z * (w * (w * (w * LG7 + LG5) + LG3) + LG1);
    s * (half_square + (odd + even)) + k * LN2_LO - half_square + f + k * LN2_HI
}

/// eˣ from −700 to 2^−28; unspecified for other arguments.
#[inline(always)]
fn exp<S: Simd>(x: f64x8<S>) -> f64x8<S> {
    const P1: f64 = 0.166_666_666_666_666_02;
    const P2: f64 = -0.002_777_777_777_701_559_3;
    const P3: f64 = 6.613_756_321_437_934e-05;
    const P4: f64 = -1.653_390_220_546_525_2e-06;
    const P5: f64 = 4.138_136_797_057_238_5e-08;
    /// Thresholds of `libm`, which compares the upper halves of the bits: about 1.5 ln 2, 0.5 ln 2 and 2^−28.
    const LARGE: f64 = f64::from_bits(0x3ff0_a2b2 << 32);
    const MEDIUM: f64 = f64::from_bits(0x3fd6_2e43 << 32);
    const TINY: f64 = f64::from_bits(0x3e30_0001 << 32);
    let simd = x.simd;
    let [zero, one] = [0.0, 1.0].map(|value| f64x8::splat(simd, value));
    let size = x.abs();
    // x = k ln 2 + hi − lo. k is rounded towards 0, which is up.
    let rounded = (x * std::f64::consts::LOG2_E - 0.5).ceil();
    let k = size.simd_ge(LARGE).select(rounded, size.simd_ge(MEDIUM).select(-one, zero));
    let (high, low) = (x - k * LN2_HI, k * LN2_LO);
    let rest = high - low;
    let square = rest * rest;
    let c = rest - square * (square * (square * (square * (square * P5 + P4) + P3) + P2) + P1);
    let y = one + (rest * c / (f64x8::splat(simd, 2.0) - c) - low + high);
    // 2^k: k + 1023 in the last bits, moved to the place of an exponent.
    let scale = (k + (LARGE_INTEGERS + 1023.0)).bitcast::<u64x8<S>>() << 52;
    size.simd_ge(TINY).select(y * scale.bitcast::<f64x8<S>>(), one + x)
}

/// 2^52: the last bits of its sum with a small non-negative integer are that integer.
const SMALL_INTEGERS: f64 = 4_503_599_627_370_496.0;
/// 1.5·2^52: as [`SMALL_INTEGERS`], also for negative integers.
const LARGE_INTEGERS: f64 = 6_755_399_441_055_744.0;

/// 2^52 + an integer below 2^52.
#[inline(always)]
fn small_integer<S: Simd>(integer: u64x8<S>) -> f64x8<S> {
    (integer | SMALL_INTEGERS.to_bits()).bitcast()
}

#[cfg(test)]
pub(super) mod tests {
    use fearless_simd::dispatch;
    use roughxel_utilities::random::SplitMix64;

    use super::*;

    /// All instruction sets of this machine.
    pub(crate) fn levels() -> Vec<Level> {
        let level = Level::new();
        let mut levels = vec![level];
        #[cfg(target_arch = "x86_64")]
        levels.extend(
            [level.as_sse2().map(Level::Sse2), level.as_sse4_2().map(Level::Sse4_2), level.as_avx2().map(Level::Avx2)]
                .into_iter()
                .flatten(),
        );
        levels
    }

    #[inline(always)]
    fn logs<S: Simd>(simd: S, x: Block) -> Block {
        Block::store(log(x.load(simd)))
    }

    #[inline(always)]
    fn exps<S: Simd>(simd: S, x: Block) -> Block {
        Block::store(exp(x.load(simd)))
    }

    #[inline(always)]
    fn both<S: Simd>(simd: S, cos: Block, exponent: Block) -> [Block; 2] {
        let none = [Block::ZERO, Block([NEGLIGIBLE; LANES])];
        log_powers(cos.load(simd), exponent.load(simd)).map_or(none, |logs| [shares(logs), logs].map(Block::store))
    }

    /// The numbers and their neighbours in bit order.
    fn around(values: &[f64]) -> Vec<f64> {
        let steps = |value: &f64| {
            let bits = value.to_bits();
            (0..64).map(move |step| f64::from_bits(bits - 32 + step))
        };
        values.iter().flat_map(steps).collect()
    }

    fn same(x: &[f64], wanted: impl Fn(f64) -> f64, got: impl Fn(Level, Block) -> Block) {
        for level in levels() {
            for block in x.as_chunks().0 {
                for (x, got) in block.iter().zip(got(level, Block(*block)).0) {
                    assert_eq!(got.to_bits(), wanted(*x).to_bits(), "{level:?}: {x:e}");
                }
            }
        }
    }

    #[test]
    fn logarithms_are_those_of_libm() {
        let mut random = SplitMix64::new(1);
        let mut x = around(&[1.0, 0.5, 0.25, std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::SQRT_2, 1e-13, 1e-300]);
        x.extend((0..100_000).map(|_| random.uniform(0.0, 1.0)).filter(|x| *x > 0.0));
        x.extend((0..100_000).map(|_| 1.0 - 1e-6 * random.uniform(0.0, 1.0)));
        same(&x, libm::log, |level, x| dispatch!(level, simd => logs(simd, x)));
    }

    #[test]
    fn exponentials_are_those_of_libm() {
        let mut random = SplitMix64::new(2);
        let limits = [0x3ff0_a2b2_u64, 0x3fd6_2e42, 0x3fd6_2e43, 0x3e30_0000, 0x3e30_0001];
        let limits: Vec<f64> = limits.iter().map(|high| -f64::from_bits(high << 32)).collect();
        let mut x = around(&limits);
        x.extend(around(&[1e-16, -1e-16, 1e-9, -1e-9, -30.0, -0.5, -1.0, -std::f64::consts::LN_2]));
        x.extend([0.0; LANES].map(|zero: f64| -zero));
        x.extend((0..200_000).map(|_| -30.0 * random.uniform(0.0, 1.0)));
        x.extend((0..100_000).map(|_| -1.2 * random.uniform(0.0, 1.0)));
        // Half way between two integers, the next integer is chosen.
        let halves: Vec<f64> = (1..43).map(|k| -(f64::from(k) + 0.5) * std::f64::consts::LN_2).collect();
        x.extend(around(&halves));
        same(&x, libm::exp, |level, x| dispatch!(level, simd => exps(simd, x)));
    }

    #[test]
    fn powers_are_those_of_one_cosine() {
        let mut random = SplitMix64::new(3);
        let mut cosines = around(&[1.0, 0.5]);
        cosines.extend([0.0, -0.0, -1.0, f64::MIN_POSITIVE, 1e-320, 1e-17, 1e-13, 9.3e-14]);
        cosines.extend((0..20_000).map(|_| 2.0 * random.uniform(0.0, 1.0) - 1.0));
        for (index, block) in cosines.as_chunks::<LANES>().0.iter().enumerate() {
            let exponents: [f64; LANES] = std::array::from_fn(|lane| {
                if index % 3 == 0 { 1.0 } else { 1.0 + 255.0 * random.uniform(0.0, 1.0) * lane as f64 / 7.0 }
            });
            for level in levels() {
                let [shares, logs] = dispatch!(level, simd => both(simd, Block(*block), Block(exponents)));
                for lane in 0..LANES {
                    let wanted = super::super::spread::log_power(block[lane], exponents[lane]);
                    let wanted = wanted.map_or([0.0, NEGLIGIBLE], |log| [libm::exp(log), log]);
                    let got = [shares.0[lane], logs.0[lane].max(NEGLIGIBLE)];
                    assert_eq!(got.map(f64::to_bits), wanted.map(f64::to_bits));
                }
            }
        }
    }
}
