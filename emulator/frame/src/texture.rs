//! Fetches from repeated maps: the probes of a fragment, colour, and bumps with their second moments.

use roughxel_core::datapath::texel::{self, Bump, BumpCodes, BumpMoments, BumpSample, BumpScale, RepeatAddress};
use roughxel_core::datapath::{pixel, texture_probe};
use roughxel_core::each::{each, places};
use roughxel_core::fx::{Control, Fx, Int};
use roughxel_core::ports::{Port, SHARE};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::signals::{MapScale, Probes, TexturePosition, TextureProbe};
use roughxel_core::soft_core::texture_scale;
use roughxel_core::stage::filter::{LEVEL_WEIGHT, LevelPair, Patch, ProbeSum, WEIGHT};
use roughxel_core::stage::texture::TextureScale;
use roughxel_core::width::on_words;

use crate::raster::FragmentAttributes;
use roughxel_lanes::Reading;
use roughxel_maps::bump::BumpPyramid;
use roughxel_maps::mip::{ColourPyramid, smallest_exponent};
use roughxel_scene::picture::Picture;

use super::MAX_MAP_EXPONENT;
use super::colour::Channel;

/// The footprints of a batch of fragments in maps of one size.
#[derive(Clone, Debug)]
struct SizedFootprints {
    size: [i32; 2],
    scale: (TextureScale<i32>, MapScale<i32>),
    probes: Vec<Probes<i32>>,
}

/// The footprints of a batch of fragments in the maps that they read; none where nothing is filtered.
#[derive(Clone, Debug, Default)]
pub struct Footprints(Vec<SizedFootprints>);

impl Footprints {
    /// Of no fragments yet, for these maps.
    pub(super) fn new<'a>(maps: impl Iterator<Item = &'a RepeatedMap>) -> Self {
        let mut sizes: Vec<SizedFootprints> = Vec::new();
        for map in maps {
            let size = map.levels[0].size;
            if sizes.iter().all(|sized| sized.size != size) {
                sizes.push(SizedFootprints { size, scale: map.scale, probes: Vec::new() });
            }
        }
        Self(sizes)
    }

    /// The footprints of these fragments in place of all others.
    pub fn set<'a>(
        &mut self,
        fragments: impl Iterator<Item = &'a FragmentAttributes>,
        reading: Reading,
        p: &Precision,
    ) {
        if self.0.is_empty() {
            return;
        }
        let derivatives: Vec<_> = fragments.map(|fragment| fragment.duv.wires()).collect();
        for SizedFootprints { scale, probes, .. } in &mut self.0 {
            probes.clear();
            reading.texture_footprints(&derivatives, scale, p, probes);
        }
    }

    /// The footprint of a fragment of the batch in a map; none where nothing is filtered.
    fn of(&self, fragment: usize, map: &RepeatedMap) -> Option<&Probes<i32>> {
        self.0.iter().find(|sized| sized.size == map.levels[0].size)?.probes.get(fragment)
    }
}

/// What a fragment reads of repeated maps: maps of one size share its taps.
#[derive(Debug)]
pub struct MapReads<'a> {
    centre: TexturePosition<i32>,
    footprints: &'a Footprints,
    /// The fragment in the batch.
    fragment: usize,
    p: &'a Precision,
    taps: &'a mut Taps,
}

impl<'a> MapReads<'a> {
    /// N trilinear probes along the major axis of the fragment's footprint, or one at the finest level.
    pub fn new(
        attributes: &FragmentAttributes,
        (footprints, fragment): (&'a Footprints, usize),
        taps: &'a mut Taps,
        p: &'a Precision,
    ) -> Self {
        taps.size = None;
        Self::again(attributes, (footprints, fragment), taps, p)
    }

    /// The same for a fragment that has read before, with its taps.
    pub(super) fn again(
        attributes: &FragmentAttributes,
        (footprints, fragment): (&'a Footprints, usize),
        taps: &'a mut Taps,
        p: &'a Precision,
    ) -> Self {
        let centre = TexturePosition { uv: attributes.uv.wires() };
        Self { centre, footprints, fragment, p, taps }
    }

    /// The taps in a map.
    fn of(&mut self, map: &RepeatedMap) -> &Taps {
        let size = map.levels[0].size;
        if self.taps.size != Some(size) {
            self.taps.size = Some(size);
            self.taps.set(map, &self.centre, self.footprints.of(self.fragment, map), self.p);
        }
        self.taps.fetched += self.taps.levels.iter().map(|taps| taps.len() as u64).sum::<u64>();
        self.taps
    }

    /// The taps in a map, to be changed: no other map will share them.
    pub(super) fn take(&mut self, map: &RepeatedMap) -> &mut Taps {
        self.of(map);
        self.taps.size = None;
        self.taps
    }
}

/// Geometry of a repeated map: its scale for the footprint and the size of its levels.
#[derive(Clone, Debug)]
pub(super) struct RepeatedMap {
    scale: (TextureScale<i32>, MapScale<i32>),
    /// At least one.
    levels: Vec<RepeatedLevel>,
}

/// One level of a repeated map.
#[derive(Clone, Copy, Debug)]
struct RepeatedLevel {
    size: [i32; 2],
    /// Texels of the levels before.
    start: u32,
}

impl RepeatedMap {
    pub(super) fn new(sizes: impl Iterator<Item = (u32, u32)>) -> Self {
        let levels = sizes.scan(0, |next, (width, height)| {
            let start = *next;
            *next += width * height;
            Some(RepeatedLevel { size: [width as i32, height as i32], start })
        });
        let levels: Vec<RepeatedLevel> = levels.collect();
        Self { scale: texture_scale(levels[0].size.map(|edge| edge as u16)), levels }
    }
}

impl RepeatedLevel {
    /// What a bilinear sample reads.
    fn tap(&self, place: &TexturePosition<i32>, p: &Precision) -> Tap {
        let [width, _] = self.size;
        let RepeatAddress { columns, rows, weight } = texel::repeat_address(place, self.size.map(Fx::from_raw), p);
        let [x0, x1] = columns.map(|x| x.raw() as u32);
        let [y0, y1] = rows.map(|y| self.start + y.raw() as u32 * width as u32);
        Tap { texels: [y0 + x0, y0 + x1, y1 + x0, y1 + x1], weight }
    }
}

/// Four neighbours on one level, in memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tap {
    /// Indices among the texels of all levels, the finest first.
    pub(super) texels: [u32; 4],
    weight: [Control<i32, WEIGHT>; 2],
}

/// What a fragment reads of a map: its memory is kept for the next one.
#[derive(Clone, Debug, Default)]
pub struct Taps {
    /// Size of the maps that the taps are for.
    size: Option<[i32; 2]>,
    /// Of the probes; they sum to 1.
    weights: Vec<Control<i32, SHARE>>,
    /// What each probe reads of the finer level, and of the coarser one unless its weight is 0.
    levels: [Vec<Tap>; 2],
    /// Weight of the coarser level, raw.
    level_weight: i32,
    /// Read since the last [`Taps::fetched`].
    fetched: u64,
}

/// One channel of the texels of two levels, filtered.
type Filter = fn(&Patch<i32>, &Patch<i32>, Control<i32, LEVEL_WEIGHT>) -> Int<i32>;

impl Taps {
    /// The probes of a footprint, or one at the finest level.
    fn set(&mut self, map: &RepeatedMap, centre: &TexturePosition<i32>, probes: Option<&Probes<i32>>, p: &Precision) {
        let [fine, coarse] = &mut self.levels;
        fine.clear();
        coarse.clear();
        self.weights.clear();
        self.level_weight = 0;
        let Some(probes) = probes else {
            self.weights.push(Fx::int(1));
            fine.push(map.levels[0].tap(centre, p));
            return;
        };
        let LevelPair { level, weight } = texel::levels::<i32>(probes.lod, false, p);
        let level = level.raw() as usize;
        let [finer, coarser] = [level, (level + 1).min(map.levels.len() - 1)].map(|level| &map.levels[level]);
        self.level_weight = weight.raw();
        // One by one: a list of the probes first takes 2 % of a frame of `denim-plane`.
        for index in (0..probes.count.raw()).map(Fx::from_raw) {
            let TextureProbe { place, weight } = texture_probe(centre, probes, index, &map.scale.0, p);
            self.weights.push(weight);
            fine.push(finer.tap(&place, p));
            if self.level_weight != 0 {
                coarse.push(coarser.tap(&place, p));
            }
        }
    }

    /// Taps read since the last call, those of each map by themselves.
    pub(super) fn fetched(&mut self) -> u64 {
        core::mem::take(&mut self.fetched)
    }

    /// The taps of each level, probe by probe.
    pub(super) fn levels(&mut self) -> &mut [Vec<Tap>; 2] {
        &mut self.levels
    }

    /// Averages `CHANNELS` channels of texels over the probes; `probe` turns the sample of one probe into what is averaged.
    #[inline(always)]
    pub(super) fn mean<T: Copy + Into<i32>, const CHANNELS: usize>(
        &self,
        texels: &[[T; CHANNELS]],
        filter: Filter,
        probe: impl Fn([Int<i32>; CHANNELS]) -> [Int<i32>; CHANNELS],
    ) -> [Int<i32>; CHANNELS] {
        let mut sums = [ProbeSum::<i32>::zero(); CHANNELS];
        let mut add = |weight: Control<i32, SHARE>, sample| {
            for (sum, channel) in sums.iter_mut().zip(probe(sample)) {
                *sum = texel::probe_sum(sum, channel, weight);
            }
        };
        let [fine, coarse] = &self.levels;
        let probes = self.weights.iter().zip(fine);
        if coarse.is_empty() {
            // Both levels are one: what they share is computed once.
            probes.for_each(|(&weight, fine)| add(weight, self.sample([fine, fine], texels, filter)));
        } else {
            let probes = probes.zip(coarse);
            probes.for_each(|((&weight, fine), coarse)| add(weight, self.sample([fine, coarse], texels, filter)));
        }
        sums.map(|sum| texel::probe_mean(&sum))
    }

    #[inline(always)]
    fn sample<T: Copy + Into<i32>, const CHANNELS: usize>(
        &self,
        taps: [&Tap; 2],
        texels: &[[T; CHANNELS]],
        filter: Filter,
    ) -> [Int<i32>; CHANNELS] {
        let read = each!(tap in taps => each!(texel in tap.texels => &texels[texel as usize]));
        let level_weight = Fx::from_raw(self.level_weight);
        each!(channel in places() => {
            let [fine, coarse] = each!(level in [0, 1] => Patch {
                texels: each!(texel in read[level] => Fx::from_raw(texel[channel].into())),
                weight: taps[level].weight,
            });
            filter(&fine, &coarse, level_weight)
        })
    }
}

/// A colour map.
#[derive(Clone, Debug)]
pub struct ColourMap {
    map: RepeatedMap,
    /// Of all levels, the finest first.
    texels: Vec<[u16; 3]>,
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
        Self { map, texels: pyramid.levels.into_iter().flat_map(|level| level.texels).collect(), exponent }
    }

    /// The footprints that its samples need.
    pub fn footprints(&self) -> Footprints {
        Footprints::new([&self.map].into_iter())
    }

    pub(super) fn map(&self) -> &RepeatedMap {
        &self.map
    }

    /// Bytes of the stored texels.
    pub(super) fn bytes(&self) -> u64 {
        size_of_val(self.texels.as_slice()) as u64
    }

    /// The mean colour of the footprint.
    pub fn sample(&self, reads: &mut MapReads<'_>) -> [Channel; 3] {
        let mean = reads.of(&self.map).mean(&self.texels, texel::colour_sample::<i32>, |sample| sample);
        mean.map(|channel| pixel::colour::<i32>(channel, Fx::from_raw(self.exponent)))
    }
}

/// A bump map with roughness.
pub(super) struct BumpMap {
    map: RepeatedMap,
    /// The channels of each texel of all levels, the finest first. What the hardware works out for each fetched texel depends on
    /// that texel only, so it is kept.
    texels: Vec<[i32; 5]>,
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
        Self { map, texels, scale, bytes }
    }

    pub(super) fn map(&self) -> &RepeatedMap {
        &self.map
    }

    /// Bytes of the stored offsets and of the stored roughness.
    pub(super) fn bytes(&self) -> [u64; 2] {
        self.bytes
    }

    /// Mean offset and roughness of the footprint, as the surface takes them.
    pub(super) fn sample(&self, reads: &mut MapReads<'_>, kind: RoughnessKind, p: &Precision) -> Bump<i32> {
        let moments = |sample| texel::bump_probe(&BumpSample::<i32>::of_words(sample)).words();
        let mean = reads.of(&self.map).mean(&self.texels, texel::word_sample::<i32>, moments);
        let (mean, scale) = (&BumpMoments::<i32>::of_words(mean), &self.scale);
        on_words!(p, |mean, scale| texel::bump(mean, scale, kind, p))
    }
}
