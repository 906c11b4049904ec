//! The emulator's stored pyramids as real numbers.

use roughxel_assets::Picture;
use roughxel_core::precision::RoughnessKind;
use roughxel_frame::MAX_MAP_EXPONENT;
use roughxel_maps::bump::{BumpLevel, BumpPyramid, BumpTexel, PORT_FRACTION_BITS};
use roughxel_maps::environment::CubePyramid;
use roughxel_maps::mip::{ColourPyramid, Level, smallest_exponent};

use roughxel_reference::filter::{CubeMap, Map};
use roughxel_reference::roughness::compose;

/// Channels of a bump map: b₁, b₂ and the elements 11, 12, 22 of K.
pub(super) const BUMP_CHANNELS: usize = 5;

fn colour_level(level: &Level, light: impl Fn(u16) -> f64) -> Map<3> {
    let texels = level.texels.iter().map(|texel| texel.map(&light)).collect();
    Map { width: level.width as usize, height: level.height as usize, texels }
}

/// Levels that are kept: all, or the base if nothing is filtered.
fn kept<L>(levels: &[L], filters: bool) -> &[L] {
    if filters { levels } else { &levels[..1] }
}

/// A colour map as the frame stores it.
pub(super) fn colour(picture: &Picture, filters: bool) -> Vec<Map<3>> {
    let pyramid = ColourPyramid::with_exponent(picture, smallest_exponent([picture]).min(MAX_MAP_EXPONENT));
    let unit = 2_f64.powi(pyramid.exponent - 16);
    let light = |code| f64::from(code) * unit;
    kept(&pyramid.levels, filters).iter().map(|level| colour_level(level, light)).collect()
}

/// An environment as the frame stores it.
pub(super) fn environment(faces: &[Picture; 6], filters: bool) -> Vec<CubeMap<3>> {
    let pyramid = CubePyramid::new(faces);
    let light = |code| pyramid.light(code);
    let level = |faces: &[Level; 6]| CubeMap { faces: faces.each_ref().map(|face| colour_level(face, light)) };
    kept(&pyramid.levels, filters).iter().map(level).collect()
}

/// Offsets and K of every stored texel, K from the stored D or I₁.
pub(super) fn bump(pyramid: &BumpPyramid) -> Vec<Map<BUMP_CHANNELS>> {
    let real = |word: i32| f64::from(word) * 2_f64.powi(-PORT_FRACTION_BITS);
    let isotropic = pyramid.format.roughness.kind() == RoughnessKind::Isotropic;
    let texel = |texel: BumpTexel| {
        let decoded = texel.decode(&pyramid.format);
        let ([u, v], [d1, d2, d3]) = (decoded.offset.map(real), decoded.roughness.map(real));
        let [a, b, c] = compose(if isotropic { [d1, 0.0, d1] } else { [d1, d2, d3] });
        [u, v, a, b, c]
    };
    let level = |level: &BumpLevel| Map {
        width: level.width as usize,
        height: level.height as usize,
        texels: (0..level.height).flat_map(|y| (0..level.width).map(move |x| level.texel(x, y))).map(texel).collect(),
    };
    pyramid.levels.iter().map(level).collect()
}
