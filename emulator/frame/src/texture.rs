//! Repeated maps: the footprints of fragments in them, colours, and bumps with their second moments.

use roughxel_core::datapath::texel::{self, BumpScale};
use roughxel_core::fx::Fx;
use roughxel_core::ports::PortBlock;
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::signals::{MapScale, RepeatedFootprint, TexturePosition};
use roughxel_core::stage::texture::TextureScale;
use roughxel_lanes::{BumpTexels, Bumped, Columns, MapTexels, Places, Reading, RepeatedMap, RoughBump, Shown};
use roughxel_maps::bump::BumpPyramid;
use roughxel_maps::mip::{ColourPyramid, smallest_exponent};
use roughxel_scene::picture::Picture;

use super::MAX_MAP_EXPONENT;
use super::colour::Channel;
use super::plan::ObjectPlan;

/// Derivatives of texture coordinates over a pixel.
pub type TextureDerivatives = [PortBlock<i32, 2>; 2];

/// The footprints of a batch of fragments in maps of one size.
#[derive(Clone, Debug)]
struct SizedFootprints {
    size: [i32; 2],
    scale: (TextureScale<i32>, MapScale<i32>),
    /// Bumps with roughness are among the maps.
    rough: bool,
    footprints: Columns<RepeatedFootprint<i32>>,
}

/// The footprints of a batch of fragments in the maps that they read; none where nothing is filtered.
#[derive(Clone, Debug, Default)]
pub struct Footprints(Vec<SizedFootprints>);

impl Footprints {
    /// Of no fragments yet, for these maps; of a size that `rough` bumps have they know the reach of their probes.
    pub(super) fn new<'a>(maps: impl Iterator<Item = &'a RepeatedMap>, rough: Option<&RepeatedMap>) -> Self {
        let mut sizes: Vec<SizedFootprints> = Vec::new();
        for map in maps {
            let rough = rough.is_some_and(|rough| rough.size() == map.size());
            if sizes.iter().all(|sized| sized.size != map.size()) {
                let (size, scale) = (map.size(), map.scale);
                sizes.push(SizedFootprints { size, scale, rough, footprints: Columns::default() });
            }
        }
        Self(sizes)
    }

    /// The footprints of these fragments in place of all others.
    pub fn set(&mut self, derivatives: &Columns<TextureDerivatives>, reading: Reading, p: &Precision) {
        for SizedFootprints { scale, rough, footprints, .. } in &mut self.0 {
            reading.texture_footprints(derivatives, (scale, *rough), p, footprints);
        }
    }

    /// Where fragments at these places look in a map.
    pub(super) fn places<'a>(&'a self, centres: &'a Columns<TexturePosition<i32>>, map: &RepeatedMap) -> Places<'a> {
        let footprints = self.0.iter().find(|sized| sized.size == map.size()).map(|sized| &sized.footprints);
        Places { centres, footprints }
    }
}

/// A colour map.
#[derive(Clone, Debug)]
pub struct ColourMap {
    texels: MapTexels<[u16; 3]>,
    /// log₂ of the unit of the channels.
    exponent: i32,
}

impl ColourMap {
    /// Builds the pyramid, or only its base where nothing is filtered.
    pub fn new(picture: &Picture, filters: bool) -> Self {
        let exponent = smallest_exponent([picture]).min(MAX_MAP_EXPONENT);
        let mut pyramid = ColourPyramid::with_exponent(picture, exponent);
        if !filters {
            pyramid.levels.truncate(1);
        }
        let map = RepeatedMap::new(pyramid.levels.iter().map(|level| (level.width, level.height)));
        let texels = pyramid.levels.into_iter().flat_map(|level| level.texels);
        Self { texels: MapTexels::new(map, texels), exponent }
    }

    /// The footprints that its samples need.
    pub fn footprints(&self) -> Footprints {
        Footprints::new([&self.texels.map].into_iter(), None)
    }

    pub(super) fn map(&self) -> &RepeatedMap {
        &self.texels.map
    }

    /// Bytes of the stored texels.
    pub(super) fn bytes(&self) -> u64 {
        self.texels.bytes()
    }

    /// The mean colour of every footprint times `own`.
    pub fn sample(
        &self,
        (centres, footprints): (&Columns<TexturePosition<i32>>, &Footprints),
        own: &[Channel; 3],
        (reading, p): (Reading, &Precision),
        colours: &mut Columns<Shown<i32>>,
    ) {
        let places = footprints.places(centres, &self.texels.map);
        reading.colours(places, (&self.texels, self.exponent, own), p, colours);
    }
}

/// A bump map with roughness.
pub(super) struct BumpMap {
    /// What the hardware works out for each fetched texel depends on that texel only, so it is kept; of the offset where there is roughness, too, one
    /// shift is left, or a texel would be half as large again.
    texels: BumpTexels,
    scale: BumpScale<i32>,
    /// Of offsets and roughness as the format stores them.
    bytes: [u64; 2],
}

impl BumpMap {
    /// Decodes a pyramid into moments.
    pub(super) fn new(pyramid: BumpPyramid) -> Self {
        let scale = pyramid.format.scale();
        let kind = pyramid.format.roughness.kind();
        let codes = pyramid.levels.iter().flat_map(|level| level.codes(&pyramid.format));
        let decoded = codes.map(|codes| (codes, texel::bump_texel(&codes, &scale, kind)));
        let map = RepeatedMap::new(pyramid.levels.iter().map(|level| (level.width, level.height)));
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
        Self { texels, scale, bytes }
    }

    /// What a plan reads of it.
    pub(super) fn with_plan(self, plan: &ObjectPlan) -> Option<Self> {
        let smooth =
            |map: Self| Self { texels: map.texels.without_roughness(&map.scale), bytes: [map.bytes[0], 0], ..map };
        plan.bump_map().then(|| if plan.roughness() == RoughnessKind::None { smooth(self) } else { self })
    }

    pub(super) fn map(&self) -> &RepeatedMap {
        self.texels.map()
    }

    /// Bytes of the stored offsets and of the stored roughness.
    pub(super) fn bytes(&self) -> [u64; 2] {
        self.bytes
    }

    /// Mean offset and roughness of every footprint, as the surface takes them.
    pub(super) fn sample(
        &self,
        (centres, footprints): (&Columns<TexturePosition<i32>>, &Footprints),
        kind: RoughnessKind,
        (reading, p): (Reading, &Precision),
        bumps: &mut Columns<Bumped<i32>>,
    ) {
        let places = footprints.places(centres, self.texels.map());
        reading.bumps(places, (&self.texels, &self.scale, kind), p, bumps);
    }
}
