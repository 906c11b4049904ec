//! Filter: texel addresses and weights, bilinear and trilinear interpolation, probe sums.
//!
//! Products of texels and weights are exact. Each level is rounded to a word, then their mean, so equal texels give that value. The memory between
//! address and texel is not part of the datapath. Addresses, weights and texels are control words: 32 bits for a mantissa of any width. Error: one
//! last place of the sample (2^−24 of full scale for 24 fraction bits), plus that of the weights.

use crate::bundle::bundle;
use crate::each::{each, places};
use crate::fx::{Control, Fx, Int, Wide, WideControl};
use crate::ports::{LOD, POSITION, SHARE};
use crate::precision::Precision;
use crate::signals::TexturePosition;
use crate::word::{Wire, Word};

/// Bits before the point of a weight; 10 bits follow it, of which `weight_bits` are kept.
pub const WEIGHT: u32 = 22;

bundle! {
    /// Address of a bilinear sample: texels `index` and `index + 1` in both directions.
    pub struct Address<W> {
        /// The lower texel, −1 … edge − 1.
        #[range(-1..=16383)]
        index: [Int<W>; 2],
        /// Weight of the upper texel, [0, 1).
        #[range(0..1)]
        weight: [Control<W, WEIGHT>; 2],
    }
}

/// Splits a texel coordinate, texel centres at integers, into index and weight.
#[inline(always)]
fn split<W: Word, const INT: u32>(coordinate: WideControl<W, INT>, p: &Precision) -> (Int<W>, Control<W, WEIGHT>) {
    // |coordinate| ≤ 2^14: with 10 fraction bits it is a word.
    let rounded: Control<W, WEIGHT> = coordinate.round_to(p.weight_bits);
    let index = rounded.index(0);
    (index, rounded - Fx::of_index(index, 0))
}

/// Address on a level of a cube face: texel coordinate (s + 1)/2·edge − ½ for s, t in [−1, 1].
#[inline(always)]
pub fn face_address<W: Word>(st: &[Control<W, POSITION>; 2], edge: Int<W>, p: &Precision) -> Address<W> {
    let parts = each!(s in *st => {
        let scaled: WideControl<W, { POSITION + 32 }> = (s + Fx::int(1)).mul(edge);
        split::<W, { POSITION + 31 }>((scaled - Fx::int(1)).reread(), p)
    });
    Address { index: each!(part in parts => part.0), weight: each!(part in parts => part.1) }
}

/// Address on a level of a wrapped map: texel coordinate u·width − ½, u in [0, 1) with 32 fraction bits.
#[inline(always)]
pub fn repeat_address<W: Word>(place: &TexturePosition<W>, size: [Int<W>; 2], p: &Precision) -> Address<W> {
    let parts = each!(i in [0, 1] => {
        // A 32-bit fraction times a 14-bit edge in two 16-bit halves; the product is exact.
        let halves = [place.uv[i].raw().sar(16), place.uv[i].raw().and(Wire::lit(0xffff))];
        let [high, low] = each!(half in halves => W::Count::narrow(half).mul(size[i].raw()));
        let scaled: WideControl<W, 32> = Fx::from_raw(high.shl(16).add(low));
        split::<W, 32>(scaled - Fx::number(1, -1), p)
    });
    Address { index: each!(part in parts => part.0), weight: each!(part in parts => part.1) }
}

/// Columns, or rows, of a bilinear sample of a wrapped map: `index` and `index + 1` modulo `edge`.
#[inline(always)]
pub fn wrapped<C: Word<Count = C>>(index: Fx<C, 32>, edge: Fx<C, 32>) -> [Fx<C, 32>; 2] {
    each!(i in [index, index + Fx::int(1)] => {
        let beyond = Fx::select(i.ge(edge), i - edge, i);
        Fx::select(i.lt(Fx::int(0)), i + edge, beyond)
    })
}

/// Weights of the texels (0,0), (1,0), (0,1), (1,1), 20 fraction bits; they sum to 1.
#[inline(always)]
fn weights<C: Word<Count = C>>(weight: &[Fx<C, WEIGHT>; 2]) -> [C; 4] {
    let one: Fx<C, WEIGHT> = Fx::int(1);
    let [x, y] = *weight;
    each!((a, b) in [(one - x, one - y), (x, one - y), (one - x, y), (x, y)] => {
        C::narrow(a.mul::<WEIGHT, { 2 * WEIGHT }>(b).raw())
    })
}

/// Bilinear interpolation of the texels (0,0), (1,0), (0,1), (1,1), rounded to `extra` more fraction bits than they have.
///
/// Range: |texel| < 2^31.
#[inline(always)]
fn bilinear<C: Word<Count = C>>(texels: &[Fx<C, 32>; 4], weights: &[C; 4], extra: u32) -> Fx<C, 32> {
    // Written out: the closure of a fold is not compiled for the lanes' instruction set unless it is inlined, and it takes vectors through memory.
    let [a, b, c, d] = each!(i in [0, 1, 2, 3] => texels[i].raw().mul(weights[i]));
    let sum = a.add(b).add(c).add(d);
    Fx::from_raw(C::narrow(sum.sar(20 - extra - 1).add(Wire::lit(1)).sar(1)))
}

bundle! {
    /// Two levels of one map.
    pub struct LevelPair<W> {
        /// The finer level.
        #[range(0..=14)]
        level: Int<W>,
        /// Weight of the coarser level, [0, 1), `lod_bits` kept.
        #[range(0..1)]
        weight: Control<W, LEVEL_WEIGHT>,
    }
}

/// Bits before the point of the weight between levels; 12 bits follow it.
pub const LEVEL_WEIGHT: u32 = 20;

/// Bias of the level of detail for a footprint that is a surface's roughness: −½·log₂3, in 2^−16.
///
/// A trilinear probe on texels of size t has the variance t²/12 (box) + t²/6 (tent) = t²/4. At the pixel's level, t = 2√3·λ₂, that is 3λ₂². A pixel's
/// box needs that much against aliasing, for its neighbours see other texels. Roughness needs no such reserve (neighbouring lobes overlap), and t =
/// 2λ₂ gives exactly λ₂². Measured with all bumps below a pixel, the gain is 9 dB. A bump map whose lost detail is roughness is read with the bias,
/// too. Detail between the texels of the pixel's level is neither in the mean nor in K (1 to 2 dB with bumps a few pixels wide).
pub const ROUGHNESS_LOD_BIAS: i32 = -51_936;

/// Level of detail moved by the bias of rough footprints, not below the finest level.
#[inline(always)]
pub fn biased<C: Word<Count = C>>(lod: Fx<C, LOD>, p: &Precision) -> Fx<C, LOD> {
    (lod + Fx::entry(ROUGHNESS_LOD_BIAS)).max(Fx::zero()).quantise(p.lod_bits)
}

/// Splits a level of detail; the level above the last repeats the last with weight 0.
#[inline(always)]
pub fn levels<W: Word>(lod: Control<W, LOD>) -> LevelPair<W> {
    let level = lod.index(0);
    LevelPair { level, weight: (lod - Fx::of_index(level, 0)).to_control() }
}

/// Weights of the finer and of the coarser level for differences between texels, for a probe that spans `reach` of a texel of the finest level. Their
/// sum is the reach.
#[inline(always)]
pub fn ramp_weights<C: Word<Count = C>>(level_weight: Fx<C, LEVEL_WEIGHT>, reach: Fx<C, SHARE>) -> [Fx<C, SHARE>; 2] {
    let coarse = level_weight.mul::<SHARE, { LEVEL_WEIGHT + SHARE }>(reach).round_to(16);
    [reach - coarse, coarse]
}

bundle! {
    /// Four texels of a level and their weights.
    pub struct Patch<W> {
        /// One channel of the texels (0,0), (1,0), (0,1), (1,1).
        texels: [Int<W>; 4],
        /// Weights of the right and of the lower texels, [0, 1).
        #[range(0..1)]
        weight: [Control<W, WEIGHT>; 2],
    }
}

/// Bilinear interpolation of one channel: one level of [`trilinear`], in the same range.
#[inline(always)]
pub fn of_level<W: Word>(patch: &Patch<W>, extra: u32) -> Int<W> {
    bilinear(&patch.texels, &weights(&patch.weight), extra)
}

/// [`of_level`] for every channel of four texels; their weights are computed once.
#[inline(always)]
pub fn channels_of_level<W: Word, const CHANNELS: usize>(
    texels: &[[Int<W>; CHANNELS]; 4],
    weight: &[Control<W, WEIGHT>; 2],
    extra: u32,
) -> [Int<W>; CHANNELS] {
    let weights = weights(weight);
    each!(channel in places() => bilinear(&each!(i in [0, 1, 2, 3] => texels[i][channel]), &weights, extra))
}

/// Trilinear interpolation of one channel: four texels of each of two levels, rounded to `extra` more
/// fraction bits than a texel has.
///
/// Range: any texel with `extra` = 0, or 16-bit texels with `extra` = 8.
#[inline(always)]
pub fn trilinear<W: Word>(
    fine: &Patch<W>,
    coarse: &Patch<W>,
    level_weight: Control<W, LEVEL_WEIGHT>,
    extra: u32,
) -> Int<W> {
    let [fine, coarse] = each!(patch in [fine, coarse] => of_level(patch, extra));
    between(fine, coarse, level_weight)
}

/// Sample between those of two levels.
#[inline(always)]
pub fn between<C: Word<Count = C>>(fine: Fx<C, 32>, coarse: Fx<C, 32>, level_weight: Fx<C, LEVEL_WEIGHT>) -> Fx<C, 32> {
    // The weights sum to one, so equal levels give exactly the sample.
    let one: Fx<C, LEVEL_WEIGHT> = Fx::int(1);
    let sum = fine.raw().mul((one - level_weight).raw()).add(coarse.raw().mul(level_weight.raw()));
    Fx::from_raw(C::narrow(sum.add(Wire::lit(1 << 11)).sar(12)))
}

/// Weight or width of a lobe between two levels of a map, rounded once; `SUM` is `INT` and the bits of a level's weight. Equal levels give exactly theirs.
#[inline(always)]
pub fn law_between<C: Word<Count = C>, const INT: u32, const SUM: u32>(
    [fine, coarse]: [Fx<C, INT>; 2],
    level_weight: Fx<C, LEVEL_WEIGHT>,
) -> Fx<C, INT> {
    let sum: Wide<C, SUM> = fine.mul(Fx::<C, LEVEL_WEIGHT>::int(1) - level_weight);
    (sum + coarse.mul(level_weight)).round_to(Fx::<C, INT>::FRACTION)
}

/// Value for the texel that does not exist at a corner of the cube: the mean of the three that meet there.
///
/// 174 763/2^19 = 1/3 + 2^−20.6: the nearest integer to the mean of any three 16-bit texels.
#[inline(always)]
pub fn corner<C: Word<Count = C>>(three: &[Fx<C, 32>; 3]) -> Fx<C, 32> {
    let sum = three[0] + three[1] + three[2];
    Fx::from_raw(C::narrow(sum.raw().mul(C::lit(174_763)).add(C::Wide::lit(1 << 18)).sar(19)))
}

/// The largest code of a bright texel: 4095 · 2^19, the last number of 12 significant bits below 2^31.
pub const LAST_BRIGHT_CODE: u16 = 21 * 2048 - 1;

/// Channel of a bright texel from its code, exponent c in the upper 5 bits, fraction f in the lower 11: f if c = 0, else (2048 + f) · 2^(c − 1), in
/// 2^−31 of the unit of the map.
///
/// Range: any 16-bit code; codes above [`LAST_BRIGHT_CODE`] read as that one.
#[inline(always)]
pub fn bright_texel<C: Word<Count = C>>(code: Fx<C, 32>) -> Fx<C, 32> {
    let code = code.min(Fx::int(LAST_BRIGHT_CODE.into()));
    let c = code.floor_shr(11);
    let f = code - c.shl(11);
    let m = f + Fx::select(c.is_zero(), Fx::zero(), Fx::int(1 << 11));
    Fx::from_raw(m.raw().shl_by((c - Fx::int(1)).max(Fx::zero()).raw()))
}

/// [`corner`] for bright texels: a sum of three needs more than a word.
///
/// Relative error 2^−19, a 128th of the error of these texels' codes.
#[inline(always)]
pub fn bright_corner<C: Word<Count = C>>(three: &[Fx<C, 32>; 3]) -> Fx<C, 32> {
    let [a, b, c] = each!(texel in *three => texel.raw().mul(C::lit(174_763)));
    Fx::from_raw(C::narrow(a.add(C::Wide::lit(1 << 18)).add(b).add(c).sar(19)))
}

bundle! {
    /// Sum of weighted probes of one channel, 16 more fraction bits than a sample.
    pub struct ProbeSum<W> {
        /// |sum| ≤ 2^16·|sample|: the weights of one footprint are not negative and sum to 2^16.
        #[range(-2147483648..=2147483647)]
        sum: WideControl<W, 48>,
    }
}

impl<W: Word> ProbeSum<W> {
    /// No probe yet.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { sum: Fx::zero() }
    }

    /// Adds a sample with its weight.
    #[inline(always)]
    pub fn add(self, sample: Int<W>, weight: Control<W, SHARE>) -> Self {
        Self { sum: self.sum + sample.mul(weight) }
    }

    /// Mean, rounded to nearest. The weights sum to 1.
    #[inline(always)]
    pub fn mean(self) -> Int<W> {
        Fx::from_raw(W::Count::narrow(self.sum.raw().add(Wire::lit(1 << 15)).sar(16)))
    }
}
