//! Repeated maps: the footprints of fragments in them, colours, and bumps with their second moments.

use roughxel_core::datapath::texel::{self, BumpCodes, BumpScale};
use roughxel_core::fx::{Control, Fx};
use roughxel_core::ports::{PortBlock, SHARE};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::repeated::{self, Tap, View};
use roughxel_core::signals::{MapScale, Probes, TexturePosition};
use roughxel_core::stage::filter::{Patch, ProbeSum};
use roughxel_core::stage::texture::TextureScale;
use roughxel_lanes::{Bumped, Columns, MapTexels, Places, Reading, RepeatedMap, Shown};
use roughxel_maps::bump::BumpPyramid;
use roughxel_maps::mip::{ColourPyramid, smallest_exponent};
use roughxel_scene::picture::Picture;

use super::MAX_MAP_EXPONENT;
use super::colour::Channel;

/// Derivatives of texture coordinates over a pixel.
pub type TextureDerivatives = [PortBlock<i32, 2>; 2];

/// The footprints of a batch of fragments in maps of one size.
#[derive(Clone, Debug)]
struct SizedFootprints {
    size: [i32; 2],
    scale: (TextureScale<i32>, MapScale<i32>),
    probes: Columns<Probes<i32>>,
}

/// The footprints of a batch of fragments in the maps that they read; none where nothing is filtered.
#[derive(Clone, Debug, Default)]
pub struct Footprints(Vec<SizedFootprints>);

impl Footprints {
    /// Of no fragments yet, for these maps.
    pub(super) fn new<'a>(maps: impl Iterator<Item = &'a RepeatedMap>) -> Self {
        let mut sizes: Vec<SizedFootprints> = Vec::new();
        for map in maps {
            if sizes.iter().all(|sized| sized.size != map.size()) {
                sizes.push(SizedFootprints { size: map.size(), scale: map.scale, probes: Columns::default() });
            }
        }
        Self(sizes)
    }

    /// The footprints of these fragments in place of all others.
    pub fn set(&mut self, derivatives: &Columns<TextureDerivatives>, reading: Reading, p: &Precision) {
        for SizedFootprints { scale, probes, .. } in &mut self.0 {
            reading.texture_footprints(derivatives, scale, p, probes);
        }
    }

    /// Those in a map; none where nothing is filtered.
    pub(super) fn of(&self, map: &RepeatedMap) -> Option<&Columns<Probes<i32>>> {
        self.0.iter().find(|sized| sized.size == map.size()).map(|sized| &sized.probes)
    }
}

/// What a fragment reads of a map, one probe after the other: its memory is kept for the next one.
#[derive(Clone, Debug, Default)]
pub(super) struct Taps {
    /// Of the probes; they sum to 1.
    weights: Vec<Control<i32, SHARE>>,
    /// What each probe reads of the finer level, and of the coarser one unless its weight is 0.
    levels: [Vec<Tap<i32>>; 2],
    /// Weight of the coarser level, raw.
    level_weight: i32,
}

impl Taps {
    /// The probes of a footprint, or one at the finest level.
    pub(super) fn set(
        &mut self,
        map: &RepeatedMap,
        centre: &TexturePosition<i32>,
        probes: Option<&Probes<i32>>,
        p: &Precision,
    ) {
        let [fine, coarse] = &mut self.levels;
        fine.clear();
        coarse.clear();
        self.weights.clear();
        let footprint = probes.map(|probes| (probes, &map.scale.0));
        repeated::reads(&View { centre, footprint, levels: &map.levels }, p, |read| {
            self.weights.push(read.weight);
            fine.push(read.fine);
            coarse.extend(read.coarse);
            self.level_weight = read.level_weight.raw();
        });
    }

    /// Bilinear samples.
    pub(super) fn count(&self) -> u64 {
        self.levels.iter().map(|taps| taps.len() as u64).sum()
    }

    /// The taps of each level, probe by probe.
    pub(super) fn levels(&mut self) -> &mut [Vec<Tap<i32>>; 2] {
        &mut self.levels
    }

    /// The mean over the probes of what stands in the places of the texels.
    pub(super) fn mean(&self, values: &[i32]) -> Channel {
        let mut sum = ProbeSum::<i32>::zero();
        let [fine, coarse] = &self.levels;
        let coarse = if coarse.is_empty() { fine } else { coarse };
        for ((&weight, fine), coarse) in self.weights.iter().zip(fine).zip(coarse) {
            let [fine, coarse] = [fine, coarse].map(|tap| Patch::<i32> {
                texels: tap.texels.map(|place| Fx::from_raw(values[place.raw() as usize])),
                weight: tap.weight,
            });
            let sample = texel::word_sample(&fine, &coarse, Fx::from_raw(self.level_weight));
            sum = texel::probe_sum(&sum, sample, weight);
        }
        texel::probe_mean(&sum).reread()
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
        let texels = pyramid.levels.into_iter().flat_map(|level| level.texels).collect();
        Self { texels: MapTexels { map, texels }, exponent }
    }

    /// The footprints that its samples need.
    pub fn footprints(&self) -> Footprints {
        Footprints::new([&self.texels.map].into_iter())
    }

    pub(super) fn map(&self) -> &RepeatedMap {
        &self.texels.map
    }

    /// Bytes of the stored texels.
    pub(super) fn bytes(&self) -> u64 {
        size_of_val(self.texels.texels.as_slice()) as u64
    }

    /// The mean colour of every footprint times `own`.
    pub fn sample(
        &self,
        (centres, footprints): (&Columns<TexturePosition<i32>>, &Footprints),
        own: &[Channel; 3],
        (reading, p): (Reading, &Precision),
        colours: &mut Columns<Shown<i32>>,
    ) {
        let places = Places { centres, footprints: footprints.of(&self.texels.map) };
        reading.colours(places, (&self.texels, self.exponent, own), p, colours);
    }
}

/// A bump map with roughness.
pub(super) struct BumpMap {
    /// The channels of each texel. What the hardware works out for each fetched texel depends on that texel only, so it is kept.
    texels: MapTexels<[i32; 5]>,
    scale: BumpScale<i32>,
    /// Of offsets and roughness as the format stores them.
    bytes: [u64; 2],
}

impl BumpMap {
    /// Decodes a pyramid into moments.
    pub(super) fn new(pyramid: BumpPyramid) -> Self {
        let scale = pyramid.format.scale();
        let kind = pyramid.format.roughness.kind();
        let decoded = |codes: &BumpCodes<i32>| texel::bump_texel(codes, &scale, kind).words().map(Fx::raw);
        let codes = pyramid.levels.iter().flat_map(|level| level.codes(&pyramid.format));
        let texels = codes.map(|codes| decoded(&codes)).collect();
        let map = RepeatedMap::new(pyramid.levels.iter().map(|level| (level.width, level.height)));
        let roughness_bits = u64::from(pyramid.format.roughness.bits());
        let roughness_bits = if kind == RoughnessKind::Isotropic { roughness_bits } else { 3 * roughness_bits };
        let bytes = pyramid.levels.iter().fold([0; 2], |[offsets, roughness], level| {
            let [texels, rough] = [level.offsets.len(), level.roughness.len()].map(|count| count as u64);
            [offsets + 4 * texels, roughness + (rough * roughness_bits).div_ceil(8)]
        });
        Self { texels: MapTexels { map, texels }, scale, bytes }
    }

    pub(super) fn map(&self) -> &RepeatedMap {
        &self.texels.map
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
        let places = Places { centres, footprints: footprints.of(&self.texels.map) };
        reading.bumps(places, (&self.texels, &self.scale, kind), p, bumps);
    }
}
