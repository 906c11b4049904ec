//! The maps of objects in the form that the shader reads.

use std::sync::Arc;

use roughxel_assets::Picture;
use roughxel_core::datapath::texel;
use roughxel_core::fx::Fx;
use roughxel_core::precision::RoughnessKind;
use roughxel_maps::bump::BumpPyramid;
use roughxel_maps::mip::{ColourPyramid, smallest_exponent};
use roughxel_shader::{BumpMap, BumpTexels, ColourMap, MapTexels, ObjectPlan, RoughBump, WrappedMap};

use super::MAX_MAP_EXPONENT;

/// The pyramid of a colour map, or only its base if nothing is filtered.
pub fn colour_map(picture: &Picture, filters: bool) -> ColourMap {
    let exponent = smallest_exponent([picture]).min(MAX_MAP_EXPONENT);
    let mut pyramid = ColourPyramid::with_exponent(picture, exponent);
    if !filters {
        pyramid.levels.truncate(1);
    }
    let map = WrappedMap::new(pyramid.levels.iter().map(|level| (level.width, level.height)));
    let texels = pyramid.levels.into_iter().flat_map(|level| level.texels);
    ColourMap { texels: MapTexels::new(map, texels), exponent }
}

/// A bump map with roughness, and the size of its storage.
#[derive(Clone)]
pub(super) struct StoredBumps {
    /// Values that the hardware derives from a fetched texel depend on that texel only, so they are stored. The offset of a map
    /// with roughness keeps one shift for later; storing it shifted would make a texel half as large again.
    pub(super) map: Arc<BumpMap>,
    /// Bytes of offsets and of roughness in the stored format.
    pub(super) bytes: [u64; 2],
}

impl StoredBumps {
    /// Decodes a pyramid into moments.
    pub(super) fn new(pyramid: &BumpPyramid) -> Self {
        let scale = pyramid.format.scale();
        let kind = pyramid.format.roughness.kind();
        let codes = pyramid.levels.iter().flat_map(|level| level.codes(&pyramid.format));
        let decoded = codes.map(|codes| (codes, texel::bump_texel(&codes, &scale, kind)));
        let map = WrappedMap::new(pyramid.levels.iter().map(|level| (level.width, level.height)));
        let texels = if pyramid.levels.iter().all(|level| level.roughness.is_empty()) {
            BumpTexels::Smooth(MapTexels::new(map, decoded.map(|(_, texel)| texel.offset.map(Fx::raw))))
        } else {
            let rough = decoded.map(|(codes, texel)| RoughBump {
                offset: codes.offset.map(|code| code.raw() as i16),
                covariance: texel.covariance.map(Fx::raw),
            });
            BumpTexels::Rough(MapTexels::new(map, rough))
        };
        let roughness_bits = u64::from(pyramid.format.roughness.bits());
        let roughness_bits = if kind == RoughnessKind::Isotropic { roughness_bits } else { 3 * roughness_bits };
        let bytes = pyramid.levels.iter().fold([0; 2], |[offsets, roughness], level| {
            let [texels, rough] = [level.offsets.len(), level.roughness.len()].map(|count| count as u64);
            [offsets + 4 * texels, roughness + (rough * roughness_bits).div_ceil(8)]
        });
        Self { map: Arc::new(BumpMap { texels, scale }), bytes }
    }

    /// The part of the bumps that a plan reads.
    pub(super) fn with_plan(&self, plan: &ObjectPlan) -> Option<Self> {
        let keeps_all = plan.roughness() != RoughnessKind::None || matches!(self.map.texels, BumpTexels::Smooth(_));
        let part = || if keeps_all { self.clone() } else { self.without_roughness() };
        plan.bump_map().then(part)
    }

    fn without_roughness(&self) -> Self {
        let BumpMap { texels, scale } = &*self.map;
        let map = BumpMap { texels: texels.without_roughness(scale), scale: *scale };
        Self { map: Arc::new(map), bytes: [self.bytes[0], 0] }
    }
}
