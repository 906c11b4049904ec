//! Filter: texel addresses and weights, bilinear and trilinear interpolation, the corner of the cube, probe sums.
//!
//! Products of texels and weights are exact; each level is rounded to a word, then their mean, so equal texels give
//! that value. The memory between address and texel is not part of the datapath.
//! Error: one last place of the sample (2^−24 of full scale for 24 fraction bits), beside that of the weights.

use crate::bundle::{Bundle, Rewire, bundle};
use crate::fx::{Fx, Wide};
use crate::precision::Precision;
use crate::signals::{LOD, POSITION, TexturePosition};
use crate::word::{Wire, Word};

/// Fraction bits of a weight on its wire; `weight_bits` of them are kept.
pub const WEIGHT: u32 = 10;

/// Where a bilinear sample reads: texels `index` and `index + 1` in both directions.
#[derive(Clone, Copy, Debug)]
pub struct Address<W: Word> {
    /// The lower texel, −1 … edge − 1.
    pub index: [Fx<W, 0>; 2],
    /// Weight of the upper texel, [0, 1).
    pub weight: [Fx<W, WEIGHT>; 2],
}

bundle!(Address { index, weight });

/// Splits a texel coordinate, texel centres at integers, into index and weight.
#[inline(always)]
fn split<W: Word, const FRAC: u32>(coordinate: Wide<W, FRAC>, p: &Precision) -> (Fx<W, 0>, Fx<W, WEIGHT>) {
    // |coordinate| ≤ 2^14: with 10 fraction bits it is a word.
    let rounded: Fx<W, WEIGHT> = coordinate.round_to(p.weight_bits);
    let index = rounded.floor_shr(WEIGHT);
    (index.reread(), rounded - index.shl(WEIGHT))
}

/// Address on a level of a cube face: texel coordinate (s + 1)/2·edge − ½ for s, t in [−1, 1].
#[inline(always)]
pub fn face_address<W: Word>(st: &[Fx<W, POSITION>; 2], edge: Fx<W, 0>, p: &Precision) -> Address<W> {
    let parts = st.map(|s| {
        let scaled: Wide<W, POSITION> = (s + Fx::lit(1 << POSITION)).mul(edge);
        split((scaled - Fx::lit(1 << POSITION)).reread::<{ POSITION + 1 }>(), p)
    });
    Address { index: parts.map(|part| part.0), weight: parts.map(|part| part.1) }
}

/// Address on a level of a repeated map: texel coordinate u·width − ½, u in [0, 1) with 32 fraction bits.
#[inline(always)]
pub fn repeat_address<W: Word>(place: &TexturePosition<W>, size: [Fx<W, 0>; 2], p: &Precision) -> Address<W> {
    let parts: [_; 2] = core::array::from_fn(|i| {
        // A 32-bit fraction times a 14-bit edge in two halves of 16 bits; the product is exact.
        let (high, low) = (place.uv[i].raw().sar(16), place.uv[i].raw().and(W::Wide::lit(0xffff)));
        let part = |half: W::Wide| Fx::<W, 0>::from_raw(W::narrow(half)).mul::<0, 0>(size[i]).raw();
        let scaled = Fx::<W::Wide, 32>::from_raw(part(high).shl(16).add(part(low)));
        split(scaled - Fx::lit(1 << 31), p)
    });
    Address { index: parts.map(|part| part.0), weight: parts.map(|part| part.1) }
}

/// Bilinear interpolation of the texels (0,0), (1,0), (0,1), (1,1), exact: 2·`WEIGHT` more fraction bits.
///
/// Range: |texel| < 2^31.
#[inline(always)]
fn bilinear<W: Word>(texels: &[W; 4], weight: &[Fx<W, WEIGHT>; 2]) -> W::Wide {
    let one: Fx<W, WEIGHT> = Fx::lit(1 << WEIGHT);
    let [x, y] = *weight;
    let product = |a: Fx<W, WEIGHT>, b: Fx<W, WEIGHT>| W::narrow(a.mul::<WEIGHT, 20>(b).raw());
    let weights = [product(one - x, one - y), product(x, one - y), product(one - x, y), product(x, y)];
    texels.iter().zip(weights).fold(W::Wide::lit(0), |sum, (&texel, weight)| sum.add(texel.mul(weight)))
}

/// Two levels of one map.
#[derive(Clone, Copy, Debug)]
pub struct LevelPair<W: Word> {
    /// The finer level.
    pub level: Fx<W, 0>,
    /// Weight of the coarser one, [0, 1), `lod_bits` kept.
    pub weight: Fx<W, LOD_WEIGHT>,
}

bundle!(LevelPair { level, weight });

/// Fraction bits of the weight between levels.
pub const LOD_WEIGHT: u32 = 12;

/// Bias of the level of detail where a footprint is a surface's roughness: −½·log₂3, in `LOD` fraction bits.
///
/// A trilinear probe on texels of size t has the variance t²/12 (box) + t²/6 (tent) = t²/4. At the pixel's level,
/// t = 2√3·λ₂, that is 3λ₂²: what a pixel's box needs against aliasing, for its neighbours see other texels. Roughness needs no
/// such reserve (neighbouring lobes overlap), and t = 2λ₂ gives exactly λ₂². Measured where all bumps are below a pixel: 9 dB.
pub const ROUGHNESS_LOD_BIAS: i64 = -51_936;

/// A level of detail moved by a sampler's bias ≤ 0, not below the finest level.
#[inline(always)]
pub fn biased<W: Word>(lod: Fx<W, LOD>, bias: Fx<W, LOD>, p: &Precision) -> Fx<W, LOD> {
    (lod + bias).max(Fx::zero()).keep(p.lod_bits)
}

/// Splits a level of detail; the level above the last repeats the last with weight 0.
#[inline(always)]
pub fn levels<W: Word>(lod: Fx<W, LOD>) -> LevelPair<W> {
    let whole = lod.floor_shr(LOD);
    LevelPair { level: whole.reread(), weight: (lod - whole.shl(LOD)).floor_shr(LOD - LOD_WEIGHT).reread() }
}

/// Trilinear interpolation of one channel: four texels of each of two levels, rounded to `extra` more
/// fraction bits than a texel has.
///
/// Range: any texel with `extra` = 0, or 16-bit texels with `extra` = 8.
#[inline(always)]
pub fn trilinear<W: Word>(
    fine: (&[W; 4], &[Fx<W, WEIGHT>; 2]),
    coarse: (&[W; 4], &[Fx<W, WEIGHT>; 2]),
    level_weight: Fx<W, LOD_WEIGHT>,
    extra: u32,
) -> W {
    let (a, b) = (bilinear(fine.0, fine.1), bilinear(coarse.0, coarse.1));
    // Both levels are rounded to words of `extra` more places; the weights sum to one, so equal levels give exactly
    // the sample.
    let narrow = |x: W::Wide| W::narrow(x.sar(2 * WEIGHT - extra - 1).add(W::Wide::lit(1)).sar(1));
    let one: Fx<W, LOD_WEIGHT> = Fx::lit(1 << LOD_WEIGHT);
    let sum = narrow(a).mul((one - level_weight).raw()).add(narrow(b).mul(level_weight.raw()));
    W::narrow(sum.add(W::Wide::lit(1 << (LOD_WEIGHT - 1))).sar(LOD_WEIGHT))
}

/// The texel that does not exist at a corner of the cube: the mean of the three that meet there.
///
/// 174 763/2^19 = 1/3 + 2^−20.6: the nearest integer to the mean of any three 16-bit texels.
#[inline(always)]
pub fn corner<W: Word>(three: &[W; 3]) -> W {
    let sum = three[0].add(three[1]).add(three[2]);
    W::narrow(sum.mul(W::lit(174_763)).add(W::Wide::lit(1 << 18)).sar(19))
}

/// Sum of weighted probes of one channel.
#[derive(Clone, Copy, Debug)]
pub struct ProbeSum<W: Word>(W::Wide);

impl<W: Word> Bundle<W> for ProbeSum<W> {
    type In<V: Word> = ProbeSum<V>;
    #[inline(always)]
    fn rewire<V: Word, R: Rewire<W, V>>(&self, with: &mut R) -> ProbeSum<V> {
        ProbeSum(with.wide(self.0, 16))
    }
}

impl<W: Word> ProbeSum<W> {
    /// No probe yet.
    #[inline(always)]
    pub fn zero() -> Self {
        Self(W::Wide::lit(0))
    }

    /// A sum as it is kept between probes, 16 more fraction bits than a sample.
    #[inline(always)]
    pub fn of(sum: W::Wide) -> Self {
        Self(sum)
    }

    /// Adds a sample with its weight in 2^−16.
    #[inline(always)]
    pub fn add(self, sample: W, weight: Fx<W, 16>) -> Self {
        Self(self.0.add(sample.mul(weight.raw())))
    }

    /// The mean, rounded to nearest. The weights sum to 2^16.
    #[inline(always)]
    pub fn mean(self) -> W {
        W::narrow(self.0.add(W::Wide::lit(1 << 15)).sar(16))
    }
}
