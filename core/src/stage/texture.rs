//! Texture footprint: the columns of a colour or bump map, in map units of 2^k texels.
//!
//! d(u, v) in repeats per pixel times the size of the map is exact. The power of two 2^k ≥ half the longer edge keeps the unit isotropic for every
//! shape of map, and the numbers are those of a cube face. Ellipse, axes and probes are therefore the blocks that serve the environment (S97 §2,
//! footprint assembly).

use crate::block::{Block, MANTISSA, normalise, of_control};
use crate::bundle::bundle;
use crate::each::each;
use crate::fx::{Fx, WideControl};
use crate::ports::POSITION;
use crate::precision::Precision;
use crate::signals::{MapOffset, TexturePosition};
use crate::word::{Wire, Word};

/// Bits before the point of the units-to-repeats factor.
pub const REPEATS: u32 = 16;

bundle! {
    /// Constants of one map.
    pub struct TextureScale<W> {
        /// Width and height of level 0 in texels, 1…16384.
        #[range(1..=16384)]
        size: [Int<W>; 2],
        /// k: one map unit is 2^k texels.
        #[range(0..=13)]
        log2_unit: Int<W>,
        /// 2^k/width and 2^k/height: repeats of the map in one map unit, from ½ to 2^13 (a map one texel wide).
        #[range(0..=8192)]
        repeats_per_unit: [Control<W, REPEATS>; 2],
    }
}

/// Footprint column of one derivative d(u, v), repeats per pixel.
#[inline(always)]
pub fn texture_column<W: Word>(duv: &Block<W, 2>, map: &TextureScale<W>, p: &Precision) -> Block<W, 2> {
    // |du·width| ≤ 2^14.
    let texels: [WideControl<W, { MANTISSA + 32 }>; 2] =
        each!(i in [0, 1] => duv.m[i].quantise(p.fraction_bits).to_control::<MANTISSA>().mul(map.size[i]));
    of_control(normalise(texels, duv.e - map.log2_unit, p.fraction_bits))
}

/// Texture coordinates of a probe: centre plus an offset in map units, in repeats modulo 1.
#[inline(always)]
pub fn texture_position<W: Word>(
    centre: &TexturePosition<W>,
    offset: &MapOffset<W>,
    map: &TextureScale<W>,
) -> TexturePosition<W> {
    let uv = each!(i in [0, 1] => {
        let repeats: WideControl<W, { POSITION + REPEATS }> = offset.offset[i].mul(map.repeats_per_unit[i]);
        let moved = centre.uv[i] + repeats.floor_shr(32 - (POSITION + REPEATS)).reread();
        // Wrapped addressing is intended.
        Fx::from_raw(moved.raw().and(Wire::lit(0xffff_ffff)))
    });
    TexturePosition { uv }
}
