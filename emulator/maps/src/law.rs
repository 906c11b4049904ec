//! Law of the bumps that a level no longer shows: two normal laws of the same shape, Σ wₖ·N(0, sₖ²·K), K the covariance of the texel.
//!
//! Slopes of photographs are not normally distributed: many facets are nearly flat, a few are steep. Each bump is measured by z² = dᵀK⁻¹d, d its
//! distance from the mean of its texel. For one normal law, z² has the mean 2 and the second moment 8. Weights and widths are fitted to z² over a
//! level by expectation maximisation. They are stored as integers whose weights sum to one and whose variance Σ wₖ·sₖ² is one to the last place.

use crate::roughness::{Covariance, Metric};
use roughxel_core::datapath::LobeLaw;
use roughxel_core::fx::Fx;
use roughxel_scene::levels::Cover;
use roughxel_simd::LANES;

/// Fraction bits of a stored weight.
const WEIGHT_BITS: u32 = 16;
/// Fraction bits of a stored width, those of a roughness in a word of 16 bits.
const WIDTH_BITS: u32 = 12;
/// Second moment of z², over that of one normal law, up to which a level has one lobe.
const NORMAL: f64 = 1.1;
/// Rounds of expectation maximisation.
const ROUNDS: usize = 200;
/// Smallest width.
const NARROWEST: f64 = 1.0 / 64.0;
/// Largest weight of the narrow lobe. The width of the other one is then at most 4.
const HEAVIEST: f64 = 15.0 / 16.0;

/// Levels whose law is that of a fragment's footprint: a fragment of a level reads about 4 × 4 of its texels, which is what a texel two levels up
/// covers. Footprints of rough bumps read finer levels (`ROUGHNESS_LOD_BIAS` of the core), and the texels of a bilinear sample lie next to each other.
const READ_LEVELS: usize = 2;

/// Weights and widths of the two lobes of a level, the narrower one first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Law {
    /// Weight of the narrower lobe in units of 2⁻¹⁶; the wider one has the rest.
    pub weight: u32,
    /// Widths relative to the standard deviation in units of 2⁻¹², at most 4.
    pub widths: [u32; 2],
}

impl Law {
    /// Law of one lobe: two equal ones, with the weight that a neighbouring level has.
    const fn one_lobe(weight: u32) -> Self {
        Self { weight, widths: [1 << WIDTH_BITS; 2] }
    }

    /// Rounds weight and width of the narrower lobe; the width of the other one gives the variance one.
    fn new(weight: f64, narrow: f64) -> Self {
        let code = |number: f64, bits: u32| (number * f64::from(1 << bits) + 0.5).floor() as u32;
        let weight = code(weight.clamp(1.0 - HEAVIEST, HEAVIEST), WEIGHT_BITS);
        let narrow = code(narrow.clamp(NARROWEST, 1.0), WIDTH_BITS);
        let whole = 1_u64 << WEIGHT_BITS;
        let rest = (whole << (2 * WIDTH_BITS)) - u64::from(weight) * u64::from(narrow) * u64::from(narrow);
        // The nearest integer to the root of a quotient: the root of four times the quotient, plus one, halved.
        let doubled = (4 * rest / (whole - u64::from(weight))).isqrt();
        Self { weight, widths: [narrow, doubled.div_ceil(2) as u32] }
    }

    /// True if both lobes are equal.
    pub fn is_one_lobe(&self) -> bool {
        self.widths[0] == self.widths[1]
    }

    /// The law as the datapath takes it.
    pub fn ports(&self) -> LobeLaw<i32> {
        let [first, second] = self.widths.map(|width| Fx::from_raw((width as i32) << (28 - WIDTH_BITS)));
        LobeLaw { weight: Fx::from_raw(self.weight as i32), widths: [first, second] }
    }
}

/// Number of parts of a factor of two.
const PARTS_LOG2: u32 = 4;
/// Smallest exponent of z² that is told from zero.
const LOWEST: u64 = 1023 - 40;
/// Exponents of z²; a texel of 2^24 bumps has z² below 2^25.
const EXPONENTS: u64 = 66;
const BINS: usize = (EXPONENTS << PARTS_LOG2) as usize;

/// Counts of z². Sums of counts do not depend on their order, so they are the same for any thread count.
#[derive(Clone, Debug)]
pub(crate) struct Histogram(Vec<u64>);

impl Histogram {
    pub(crate) fn new() -> Self {
        Self(vec![0; BINS])
    }

    /// Adds one z².
    fn add(&mut self, square: f64) {
        let bin = (square.to_bits() >> (52 - PARTS_LOG2)).saturating_sub(LOWEST << PARTS_LOG2);
        self.0[(bin as usize).min(BINS - 1)] += 1;
    }

    /// Adds the bumps of a texel. Texels without bumps, or with bumps along one line, have no z².
    pub(crate) fn add_texel<'a>(
        &mut self,
        mean: [f64; 2],
        covariance: Covariance,
        [columns, rows]: [&Cover; 2],
        row: impl Fn(usize) -> &'a [[i16; 2]],
    ) {
        let Some(metric @ Metric::Plane { .. }) = Metric::new(covariance) else { return };
        for y in rows.first..=rows.last {
            for offsets in row(y)[columns.first..=columns.last].chunks(LANES) {
                let mut group = [[0; 2]; LANES];
                group[..offsets.len()].copy_from_slice(offsets);
                metric.squares(&group, mean)[..offsets.len()].iter().for_each(|square| self.add(*square));
            }
        }
    }

    /// Sum of two histograms.
    pub(crate) fn plus(mut self, other: &Self) -> Self {
        self.0.iter_mut().zip(&other.0).for_each(|(sum, count)| *sum += count);
        self
    }

    /// Values of z² at the middle of every bin with their share of all counts, scaled to the mean 2.
    fn shares(&self) -> Vec<[f64; 2]> {
        let all: u64 = self.0.iter().sum();
        let middle = |bin: usize| {
            let bits = ((LOWEST << PARTS_LOG2) + bin as u64) << (52 - PARTS_LOG2);
            f64::from_bits(bits | 1 << (51 - PARTS_LOG2))
        };
        let filled = self.0.iter().enumerate().filter(|(_, count)| **count > 0);
        let shares: Vec<[f64; 2]> = filled.map(|(bin, &count)| [middle(bin), count as f64 / all as f64]).collect();
        let mean: f64 = shares.iter().map(|[square, share]| square * share).sum();
        shares.into_iter().map(|[square, share]| [2.0 * square / mean, share]).collect()
    }

    /// Weight and width of the narrower lobe; `None` if one lobe is enough.
    fn fit(&self) -> Option<[f64; 2]> {
        let shares = self.shares();
        let moment: f64 = shares.iter().map(|[square, share]| square * square * share).sum();
        if moment.is_nan() || moment <= 8.0 * NORMAL {
            return None;
        }
        let (mut weights, mut variances) = ([0.5; 2], [0.1, 2.0]);
        for _ in 0..ROUNDS {
            let (mut sums, mut squares) = ([0.0; 2], [0.0; 2]);
            for &[square, share] in &shares {
                let densities: [f64; 2] =
                    core::array::from_fn(|k| weights[k] / variances[k] * libm::exp(-square / (2.0 * variances[k])));
                let all = densities[0] + densities[1];
                if all > 0.0 {
                    for k in 0..2 {
                        let part = share * densities[k] / all;
                        sums[k] += part;
                        squares[k] += part * square;
                    }
                }
            }
            weights = sums;
            let lowest = NARROWEST * NARROWEST;
            variances = core::array::from_fn(|k| (squares[k] / (2.0 * sums[k])).max(lowest));
        }
        let narrow = usize::from(variances[1] < variances[0]);
        Some([weights[narrow], variances[narrow].sqrt()])
    }
}

/// Laws of the levels that fragments read, from the bumps that level 1, 2, … no longer show; empty if one lobe is enough on every level.
pub(crate) fn laws(lost: &[Histogram]) -> Vec<Law> {
    let Some(last) = lost.len().checked_sub(1) else { return Vec::new() };
    let fits: Vec<Option<[f64; 2]>> = lost.iter().map(Histogram::fit).collect();
    // Two levels with one weight have the variance one between them, too, but for the rounding of widths.
    let weight_near = |level: usize| {
        let next = fits[level..].iter().chain(fits[..level].iter().rev()).flatten().next();
        next.map(|&[weight, width]| Law::new(weight, width).weight)
    };
    let law = |level: usize| match fits[level] {
        Some([weight, width]) => Some(Law::new(weight, width)),
        None => weight_near(level).map(Law::one_lobe),
    };
    // The first histogram is that of level 1.
    (0..=lost.len()).map_while(|level| law((level + READ_LEVELS - 1).min(last))).collect()
}

#[cfg(test)]
mod tests;
