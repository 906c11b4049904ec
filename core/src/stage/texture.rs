//! Texture footprint: the columns of a colour or bump map, in map units of 2^k texels.
//!
//! d(u, v) in repeats per pixel times the size of the map is exact; the power of two 2^k ≥ half the longer edge
//! keeps the unit isotropic for every shape of map and the numbers those of a cube face, so that ellipse, axes and
//! probes are the same blocks that serve the environment (S97 §2, footprint assembly).

use crate::block::{Block, normalise};
use crate::bundle::bundle;
use crate::each::each;
use crate::fx::{Fx, Wide};
use crate::precision::Precision;
use crate::signals::{POSITION, TexturePosition};
use crate::word::{Wire, Word};

/// Fraction bits of the units-to-repeats factor.
pub const REPEATS: u32 = 16;

/// Constants of one map.
#[derive(Clone, Copy, Debug)]
pub struct TextureScale<W: Word> {
    /// Width and height of level 0 in texels, 1…16384.
    pub size: [Fx<W, 0>; 2],
    /// k: one map unit is 2^k texels.
    pub log2_unit: Fx<W, 0>,
    /// 2^k/width and 2^k/height: repeats of the map in one map unit.
    pub repeats_per_unit: [Fx<W, REPEATS>; 2],
}

bundle!(TextureScale { size, log2_unit, repeats_per_unit });

/// The footprint column of one derivative d(u, v), repeats per pixel.
#[inline(always)]
pub fn texture_column<W: Word>(duv: &Block<W, 2>, map: &TextureScale<W>, p: &Precision) -> Block<W, 2> {
    // |du·width| ≤ 2^14 with 30 fraction bits.
    let texels: [Wide<W, 30>; 2] = each!(i in [0, 1] => duv.m[i].keep(p.fraction_bits).mul(map.size[i]));
    normalise(texels, duv.e - map.log2_unit, p.fraction_bits)
}

/// Texture coordinates of a probe: centre plus an offset in map units, in repeats modulo 1.
#[inline(always)]
pub fn texture_position<W: Word>(
    centre: &TexturePosition<W>,
    offset: &[Fx<W, POSITION>; 2],
    map: &TextureScale<W>,
) -> TexturePosition<W> {
    let uv = each!(i in [0, 1] => {
        let repeats: Wide<W, 44> = offset[i].mul(map.repeats_per_unit[i]);
        let moved = centre.uv[i] + repeats.floor_shr(12).reread();
        // Repeat addressing wraps on purpose.
        Fx::from_raw(moved.raw().and(W::Wide::lit(0xffff_ffff)))
    });
    TexturePosition { uv }
}
