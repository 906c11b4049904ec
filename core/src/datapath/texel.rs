//! Texels: from a probe to the sample of a map, one channel at a time. Addresses come before the memory; filters, sums and means come after it.

use crate::block::{Block, of_control};
use crate::bundle::{Value, bundle};
use crate::each::{each, places};
use crate::fx::{Control, Fx, Int};
use crate::ports::{LOD, OFFSET, SHARE};
use crate::precision::{Precision, RoughnessKind};
use crate::signals::{Ellipse, FacePosition, TexturePosition};
use crate::stage::filter::{self, Address, LEVEL_WEIGHT, LevelPair, Patch, ProbeSum, WEIGHT};
use crate::stage::moments::{self, MOMENT};
use crate::stage::seam::{self, CubeTexel};
use crate::stage::{axes, pixel};
use crate::staged::{Staged, control_stage, stage};
use crate::word::Word;

/// Two levels of a footprint; the footprint of a rough surface reads finer ones.
#[inline(always)]
pub fn levels<W: Staged>(lod: Control<W, LOD>, rough: W::Flag, p: &Precision) -> LevelPair<W> {
    stage!("filter.levels", filter::levels(Fx::select(rough, filter::biased(lod, p), lod)))
}

/// Address of a bilinear sample on a level of a cube face. Texels outside of the face are [`cube_texel`]s.
#[inline(always)]
pub fn face_address<W: Staged>(place: &FacePosition<W>, edge: Int<W>, p: &Precision) -> Address<W> {
    stage!("filter.face_address", filter::face_address(&place.st, edge, p))
}

/// Texel at a column and a row of a face; it may be one step outside of the face.
#[inline(always)]
pub fn cube_texel<W: Staged>(face: Int<W>, index: [Int<W>; 2], edge: Int<W>) -> CubeTexel<W> {
    stage!("seam.texel", seam::texel(face, index, edge))
}

/// Texels of a bilinear sample on a level of a cube face: (0,0), (1,0), (0,1), (1,1).
#[inline(always)]
pub fn face_texels<W: Staged>(face: Int<W>, address: &Address<W>, edge: Int<W>) -> [CubeTexel<W>; 4] {
    let neighbours = stage!("seam.neighbours", seam::neighbours(address.index));
    each!(index in neighbours.index => cube_texel(face, index, edge))
}

/// One channel of the texel at a corner of the cube.
#[inline(always)]
pub fn corner<W: Staged>(three: &[Int<W>; 3]) -> Int<W> {
    control_stage!("filter.corner", filter::corner(three))
}

/// One channel of a bright texel from its code.
#[inline(always)]
pub fn bright_texel<W: Staged>(code: Int<W>) -> Int<W> {
    control_stage!("filter.bright_texel", filter::bright_texel(code))
}

/// One channel of the bright texel at a corner of the cube.
#[inline(always)]
pub fn bright_corner<W: Staged>(three: &[Int<W>; 3]) -> Int<W> {
    control_stage!("filter.bright_corner", filter::bright_corner(three))
}

bundle! {
    /// Address of a bilinear sample on a level of a wrapped map.
    pub struct RepeatAddress<W> {
        /// Left and right column.
        #[range(0..=16383)]
        columns: [Int<W>; 2],
        /// Upper and lower row.
        #[range(0..=16383)]
        rows: [Int<W>; 2],
        /// Weights of the right column and of the lower row, [0, 1).
        #[range(0..1)]
        weight: [Control<W, WEIGHT>; 2],
    }
}

/// Address of a bilinear sample on a level of a wrapped map.
#[inline(always)]
pub fn repeat_address<W: Staged>(place: &TexturePosition<W>, size: [Int<W>; 2], p: &Precision) -> RepeatAddress<W> {
    stage!("filter.repeat_address", {
        let Address { index, weight } = filter::repeat_address(place, size, p);
        let [columns, rows] = each!(i in [0, 1] => filter::wrapped(index[i], size[i]));
        RepeatAddress { columns, rows, weight }
    })
}

/// A channel of 16-bit texels at one probe, 8 more fraction bits.
#[inline(always)]
pub fn colour_sample<W: Staged>(fine: &Patch<W>, coarse: &Patch<W>, level_weight: Control<W, LEVEL_WEIGHT>) -> Int<W> {
    control_stage!("filter.trilinear", filter::trilinear(fine, coarse, level_weight, 8))
}

/// One channel of one-word texels at one probe.
#[inline(always)]
pub fn word_sample<W: Staged>(fine: &Patch<W>, coarse: &Patch<W>, level_weight: Control<W, LEVEL_WEIGHT>) -> Int<W> {
    control_stage!("filter.trilinear", filter::trilinear(fine, coarse, level_weight, 0))
}

bundle! {
    /// Four texels of a level with all their channels.
    pub struct Quad<W, const CHANNELS: usize> {
        /// The texels (0,0), (1,0), (0,1), (1,1).
        texels: [[Int<W>; CHANNELS]; 4],
        /// Weights of the right and of the lower texels, [0, 1).
        #[range(0..1)]
        weight: [Control<W, WEIGHT>; 2],
    }
}

/// [`colour_sample`] of every channel, as one stage: the common part of their weights is computed once. Without a coarser level, as if its weight
/// were 0, it is bilinear.
#[inline(always)]
pub fn colour_samples<W: Staged, const CHANNELS: usize>(
    fine: &Quad<W, CHANNELS>,
    coarse: Option<&Quad<W, CHANNELS>>,
    level_weight: Control<W, LEVEL_WEIGHT>,
) -> [Int<W>; CHANNELS] {
    samples(fine, coarse, level_weight, 8)
}

/// [`word_sample`] of every channel, as one stage, like [`colour_samples`].
#[inline(always)]
pub fn word_samples<W: Staged, const CHANNELS: usize>(
    fine: &Quad<W, CHANNELS>,
    coarse: Option<&Quad<W, CHANNELS>>,
    level_weight: Control<W, LEVEL_WEIGHT>,
) -> [Int<W>; CHANNELS] {
    samples(fine, coarse, level_weight, 0)
}

#[inline(always)]
fn samples<W: Staged, const CHANNELS: usize>(
    fine: &Quad<W, CHANNELS>,
    coarse: Option<&Quad<W, CHANNELS>>,
    level_weight: Control<W, LEVEL_WEIGHT>,
    extra: u32,
) -> [Int<W>; CHANNELS] {
    let samples = match coarse {
        None => stage!(
            "filter.of_level",
            each!(sample in filter::channels_of_level::<W, CHANNELS>(&fine.texels, &fine.weight, extra) => Value(sample))
        ),
        Some(coarse) => stage!("filter.trilinear", {
            let [fine, coarse] = each!(quad in [fine, coarse] => {
                filter::channels_of_level::<W, CHANNELS>(&quad.texels, &quad.weight, extra)
            });
            each!(channel in places() => Value(filter::between(fine[channel], coarse[channel], level_weight)))
        }),
    };
    each!(Value(sample) in samples => sample)
}

/// [`probe_sum`] of every channel, as one stage.
#[inline(always)]
pub fn probe_sums<W: Staged, const CHANNELS: usize>(
    sums: &[ProbeSum<W>; CHANNELS],
    samples: &[Int<W>; CHANNELS],
    weight: Control<W, SHARE>,
) -> [ProbeSum<W>; CHANNELS] {
    stage!("filter.sum", each!(channel in places() => sums[channel].add(samples[channel], weight)))
}

/// [`probe_mean`] of every channel, as one stage.
#[inline(always)]
pub fn probe_means<W: Staged, const CHANNELS: usize>(sums: &[ProbeSum<W>; CHANNELS]) -> [Int<W>; CHANNELS] {
    let means = stage!("filter.mean", each!(sum in *sums => Value::<W, 32>(sum.mean())));
    each!(Value(mean) in means => mean)
}

/// Sum over probes with one more.
#[inline(always)]
pub fn probe_sum<W: Staged>(sum: &ProbeSum<W>, sample: Int<W>, weight: Control<W, SHARE>) -> ProbeSum<W> {
    stage!("filter.sum", sum.add(sample, weight))
}

/// Mean over the probes of a footprint.
#[inline(always)]
pub fn probe_mean<W: Staged>(sum: &ProbeSum<W>) -> Int<W> {
    control_stage!("filter.mean", sum.mean())
}

bundle! {
    /// A texel of a bump map as it is stored.
    pub struct BumpCodes<W> {
        /// Codes of b₁, b₂.
        #[range(-32767..=32767)]
        offset: [Int<W>; 2],
        /// Codes of d₁, d₂, d₃, or of I₁. Codes of fewer than 16 bits are in the upper bits of 16.
        #[range(-65535..=65535)]
        roughness: [Int<W>; 3],
    }

    /// Scales of a bump map: its numbers are in units of 2^`exponent`.
    pub struct BumpScale<W> {
        /// Powers of two by which the codes of offsets are below the unit.
        #[range(0..=16)]
        offset_down: Int<W>,
        /// Powers of two by which the codes of roughness are below the unit.
        #[range(0..=27)]
        roughness_down: Int<W>,
        /// Exponent e of the unit 2^e of offsets and roughness.
        #[range(-13..=3)]
        exponent: Int<W>,
    }

    /// Filtered channels of a bump map, of a texel or of the sample of a probe, in units of the map.
    pub struct BumpSample<W> {
        /// b₁, b₂.
        #[range(-1..=1)]
        offset: [Control<W, 2>; 2],
        /// K, its elements 11, 12, 22.
        #[range(-2..=2)]
        covariance: [Control<W, MOMENT>; 3],
    }
}

impl<W: Word> BumpSample<W> {
    /// The five channels as words.
    #[inline(always)]
    pub fn words(&self) -> [Int<W>; 5] {
        let ([b1, b2], [k11, k12, k22]) = (self.offset, self.covariance);
        [b1.reread(), b2.reread(), k11.reread(), k12.reread(), k22.reread()]
    }

    /// Channels from these words.
    #[inline(always)]
    pub fn of_words([b1, b2, k11, k12, k22]: [Int<W>; 5]) -> Self {
        Self {
            offset: each!(word in [b1, b2] => word.reread()),
            covariance: each!(word in [k11, k12, k22] => word.reread()),
        }
    }
}

bundle! {
    /// Channels that are averaged over probes, in units of the map.
    pub struct BumpMoments<W> {
        /// b₁, b₂.
        #[range(-1..=1)]
        offset: [Control<W, 2>; 2],
        /// K + b bᵀ, its elements 11, 12, 22.
        #[range(-3..=3)]
        moments: [Control<W, MOMENT>; 3],
    }
}

impl<W: Word> BumpMoments<W> {
    /// The five channels as words.
    #[inline(always)]
    pub fn words(&self) -> [Int<W>; 5] {
        BumpSample::<W> { offset: self.offset, covariance: self.moments }.words()
    }

    /// Channels from these words.
    #[inline(always)]
    pub fn of_words(words: [Int<W>; 5]) -> Self {
        let BumpSample { offset, covariance: moments } = BumpSample::<W>::of_words(words);
        Self { offset, moments }
    }
}

/// Channels of one texel.
#[inline(always)]
pub fn bump_texel<W: Staged>(codes: &BumpCodes<W>, scale: &BumpScale<W>, kind: RoughnessKind) -> BumpSample<W> {
    stage!("moments.texel", {
        let offset = each!(code in codes.offset => moments::decode_offset(code, scale.offset_down));
        let d = each!(code in codes.roughness => moments::decode_roughness(code, scale.roughness_down));
        let covariance = match kind {
            RoughnessKind::Isotropic => moments::of_isotropic_texel(d[0]),
            _ => moments::of_texel(&d),
        };
        BumpSample { offset, covariance }
    })
}

/// Sample of a probe that spans `reach` of a texel, with the ramp between the texels that it reads: b₁, b₂ of (0,0), (1,0), (0,1), (1,1) on both
/// levels.
#[inline(always)]
pub fn bump_ramp<W: Staged>(
    sample: &BumpSample<W>,
    offsets: &[[[Control<W, 2>; 2]; 4]; 2],
    level_weight: Control<W, LEVEL_WEIGHT>,
    reach: Control<W, SHARE>,
) -> BumpSample<W> {
    let weights = stage!(
        "filter.ramp_weights",
        each!(weight in filter::ramp_weights(level_weight, reach) => Value::<W, SHARE>(weight))
    );
    stage!("moments.ramp", {
        let weights = each!(Value(weight) in weights => weight);
        let covariance = moments::with_ramp(&sample.covariance, &moments::ramp(offsets, &weights));
        BumpSample { offset: sample.offset, covariance }
    })
}

/// Offsets of texels; they are the first two channels.
#[inline(always)]
pub fn bump_offsets<W: Word, const CHANNELS: usize>(quad: &Quad<W, CHANNELS>) -> [[Control<W, 2>; 2]; 4] {
    each!(texel in quad.texels => each!(channel in [0, 1] => texel[channel].reread()))
}

/// Averaged channels of the sample of one probe: second moments in place of K.
#[inline(always)]
pub fn bump_probe<W: Staged>(sample: &BumpSample<W>) -> BumpMoments<W> {
    stage!("moments.probe", {
        let moments = moments::of_probe(&sample.offset, &sample.covariance);
        BumpMoments { offset: sample.offset, moments }
    })
}

bundle! {
    /// Bumps and roughness of a fragment, as the ports of the surface take them.
    pub struct Bump<W> {
        /// b₁, b₂.
        offset: [Fx<W, OFFSET>; 2],
        /// d₁, d₂, d₃, or I₁.
        roughness: [Fx<W, OFFSET>; 3],
    }
}

/// Mean over a footprint as ports; zero roughness if the plan has none.
#[inline(always)]
pub fn bump<W: Staged>(mean: &BumpMoments<W>, scale: &BumpScale<W>, kind: RoughnessKind, p: &Precision) -> Bump<W> {
    let d = match kind {
        RoughnessKind::None => None,
        _ => {
            let k = stage!("moments.covariance", of_control(moments::covariance(&(mean.offset, mean.moments), p)));
            Some(match kind {
                RoughnessKind::Isotropic => {
                    let axes = stage!("axes", axes::axes(&Ellipse { k, det: Block::zero() }, p));
                    [control_stage!("moments.isotropic", moments::to_roughness(axes.major)), Fx::zero(), Fx::zero()]
                }
                _ => {
                    let d = stage!("moments.decompose", each!(d in moments::decompose(&k, p) => Value(d)));
                    each!(Value(d) in d => d)
                }
            })
        }
    };
    stage!("pixel.bump", {
        let fraction_bits = Fx::<W, OFFSET>::FRACTION;
        // A mantissa has two more fraction bits than a port.
        let e = scale.exponent - Fx::int(2);
        let offset = each!(b in mean.offset => Fx::of_control::<OFFSET>(pixel::bump(b, e, fraction_bits)));
        let roughness = match d {
            None => [Fx::zero(); 3],
            Some(d) => each!(d in d => Fx::of_control::<OFFSET>(pixel::bump(d, scale.exponent, fraction_bits))),
        };
        Bump { offset, roughness }
    })
}
