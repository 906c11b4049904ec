//! Fetches from repeated maps: the probes of a fragment, colour, and bumps with their second moments.

use fixed::types::I4F28;
use roughxel_core::block::Block;
use roughxel_core::datapath::{Probe, texture_probe};
use roughxel_core::each::{each, places};
use roughxel_core::fx::Fx;
use roughxel_core::ports::texture_scale;
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::signals::{Ellipse, MapScale, Probes, TexturePosition};
use roughxel_core::stage::filter::{Address, ProbeSum, WEIGHT, levels, repeat_address, trilinear};
use roughxel_core::stage::texture::TextureScale;
use roughxel_core::stage::{axes, moments};

use crate::raster::FragmentAttributes;
use roughxel_lanes::Reading;
use roughxel_maps::bump::BumpPyramid;
use roughxel_maps::mip::{ColourPyramid, smallest_exponent};
use roughxel_scene::picture::Picture;

use super::{Colour, MAX_MAP_EXPONENT};

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
        let derivatives: Vec<_> = fragments.map(|fragment| fragment.duv.map(|duv| duv.wires())).collect();
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
    /// Size of the maps that the taps are for.
    size: Option<[i32; 2]>,
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
        let centre = TexturePosition { uv: attributes.uv.map(|u| Fx::from_raw(i64::from(u.to_bits()))) };
        Self { centre, footprints, fragment, p, size: None, taps }
    }

    /// The taps in a map.
    fn of(&mut self, map: &RepeatedMap) -> &Taps {
        let size = map.levels[0].size;
        if self.size != Some(size) {
            self.size = Some(size);
            self.taps.set(map, &self.centre, self.footprints.of(self.fragment, map), self.p);
        }
        self.taps
    }

    /// The taps in a map, to be changed: no other map will share them.
    pub(super) fn take(&mut self, map: &RepeatedMap) -> &mut Taps {
        self.of(map);
        self.size = None;
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
    fn patch(&self, place: &TexturePosition<i32>, p: &Precision) -> Patch {
        let [width, height] = self.size;
        let Address { index: [x, y], weight } = repeat_address(place, self.size.map(Fx::from_raw), p);
        let wrap = |i: i32, edge: i32| if i < 0 { i + edge } else if i >= edge { i - edge } else { i } as u32;
        let [x0, x1] = [x.raw(), x.raw() + 1].map(|x| wrap(x, width));
        let [y0, y1] = [y.raw(), y.raw() + 1].map(|y| self.start + wrap(y, height) * width as u32);
        Patch { texels: [y0 + x0, y0 + x1, y1 + x0, y1 + x1], weight }
    }
}

/// Four neighbours on one level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    /// Indices among the texels of all levels, the finest first.
    pub(super) texels: [u32; 4],
    weight: [Fx<i32, WEIGHT>; 2],
}

/// What a fragment reads of a map: its memory is kept for the next one.
#[derive(Clone, Debug, Default)]
pub struct Taps {
    /// Of the probes; they sum to 1.
    weights: Vec<Fx<i32, 16>>,
    /// What each probe reads of the finer level, and of the coarser one unless its weight is 0.
    levels: [Vec<Patch>; 2],
    /// Weight of the coarser level.
    level_weight: i32,
}

impl Taps {
    /// The probes of a footprint, or one at the finest level.
    fn set(&mut self, map: &RepeatedMap, centre: &TexturePosition<i32>, probes: Option<&Probes<i32>>, p: &Precision) {
        let [fine, coarse] = &mut self.levels;
        fine.clear();
        coarse.clear();
        self.weights.clear();
        self.level_weight = 0;
        let Some(probes) = probes else {
            self.weights.push(Fx::lit(1 << 16));
            fine.push(map.levels[0].patch(centre, p));
            return;
        };
        let pair = levels(probes.lod);
        let level = pair.level.raw() as usize;
        let [finer, coarser] = [level, (level + 1).min(map.levels.len() - 1)].map(|level| &map.levels[level]);
        self.level_weight = pair.weight.raw();
        // One by one: a list of the probes first takes 2 % of a frame of `denim-plane`.
        for index in (0..probes.count.raw()).map(Fx::from_raw) {
            let Probe { place, weight } = texture_probe(centre, probes, index, &map.scale.0, p);
            self.weights.push(weight);
            fine.push(finer.patch(&place, p));
            if self.level_weight != 0 {
                coarse.push(coarser.patch(&place, p));
            }
        }
    }

    /// The patches of each level, probe by probe.
    pub(super) fn levels(&mut self) -> &mut [Vec<Patch>; 2] {
        &mut self.levels
    }

    /// Averages `CHANNELS` channels of texels over the probes.
    ///
    /// A sample has `extra` fraction bits more than a texel; `probe` turns the sample of one probe into what is averaged.
    pub(super) fn mean<T: Copy + Into<i32>, const CHANNELS: usize>(
        &self,
        extra: u32,
        texels: &[[T; CHANNELS]],
        probe: impl Fn([i32; CHANNELS]) -> [i32; CHANNELS],
    ) -> [i32; CHANNELS] {
        let mut sums = [ProbeSum::<i32>::zero(); CHANNELS];
        let mut add = |weight: Fx<i32, 16>, sample| {
            for (sum, channel) in sums.iter_mut().zip(probe(sample)) {
                *sum = sum.add(channel, weight);
            }
        };
        let [fine, coarse] = &self.levels;
        let probes = self.weights.iter().zip(fine);
        if coarse.is_empty() {
            // Both levels are one: what they share is computed once.
            probes.for_each(|(&weight, fine)| add(weight, self.sample(fine, fine, extra, texels)));
        } else {
            let probes = probes.zip(coarse);
            probes.for_each(|((&weight, fine), coarse)| add(weight, self.sample(fine, coarse, extra, texels)));
        }
        sums.map(ProbeSum::mean)
    }

    #[inline(always)]
    fn sample<T: Copy + Into<i32>, const CHANNELS: usize>(
        &self,
        fine: &Patch,
        coarse: &Patch,
        extra: u32,
        texels: &[[T; CHANNELS]],
    ) -> [i32; CHANNELS] {
        let [a, b] = each!(patch in [fine, coarse] => each!(texel in patch.texels => &texels[texel as usize]));
        let level_weight = Fx::from_raw(self.level_weight);
        each!(channel in places() => {
            let [a, b] = each!(corners in [a, b] => each!(texel in corners => texel[channel].into()));
            trilinear((&a, &fine.weight), (&b, &coarse.weight), level_weight, extra)
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
    pub fn sample(&self, reads: &mut MapReads<'_>) -> Colour {
        let sample = reads.of(&self.map).mean(8, &self.texels, |sample| sample);
        sample.map(|channel| channel << self.exponent)
    }
}

/// A bump map with roughness.
pub(super) struct BumpMap {
    map: RepeatedMap,
    /// Of all levels, the finest first. Five channels per texel: b₁, b₂ (30 fraction bits) and the elements of K (29), in units of the scale. What
    /// the hardware works out for each fetched texel depends on that texel only, so it is kept.
    texels: Vec<[i32; 5]>,
    /// log₂ of the unit of the channels.
    exponent: i32,
    /// Of offsets and roughness as the format stores them.
    bytes: [u64; 2],
}

impl BumpMap {
    /// Decodes a pyramid into moments.
    pub(super) fn new(pyramid: BumpPyramid) -> Self {
        let format = pyramid.format;
        let exponent = format.offset_exponent.max(format.roughness_exponent);
        let isotropic = format.roughness.kind() == RoughnessKind::Isotropic;
        // A decoded word has 28 fraction bits; in units of 2^exponent with 30 it is shifted by 2 − exponent ≥ −1,
        // and the codes leave that one bit free.
        let scaled = |word: i32| -> Fx<i32, 30> {
            Fx::from_raw(if exponent > 2 { word >> (exponent - 2) } else { word << (2 - exponent) })
        };
        let texels = pyramid
            .levels
            .iter()
            .flat_map(|level| {
                let texel = |index: usize| {
                    let (x, y) = (index as u32 % level.width, index as u32 / level.width);
                    let decoded = level.texel(x, y).decode(&format);
                    let (offset, d) = (decoded.offset.map(scaled), decoded.roughness.map(scaled));
                    let k = if isotropic { moments::of_isotropic_texel(d[0]) } else { moments::of_texel(&d) };
                    [offset[0].raw(), offset[1].raw(), k[0].raw(), k[1].raw(), k[2].raw()]
                };
                (0..level.offsets.len()).map(texel).collect::<Vec<_>>()
            })
            .collect();
        let map = RepeatedMap::new(pyramid.levels.iter().map(|level| (level.width, level.height)));
        let roughness_bits = u64::from(format.roughness.bits()) * if isotropic { 1 } else { 3 };
        let bytes = pyramid.levels.iter().fold([0; 2], |[offsets, roughness], level| {
            let [texels, rough] = [level.offsets.len(), level.roughness.len()].map(|count| count as u64);
            [offsets + 4 * texels, roughness + (rough * roughness_bits).div_ceil(8)]
        });
        Self { map, texels, exponent, bytes }
    }

    pub(super) fn map(&self) -> &RepeatedMap {
        &self.map
    }

    /// Bytes of the stored offsets and of the stored roughness.
    pub(super) fn bytes(&self) -> [u64; 2] {
        self.bytes
    }

    /// Mean offset and roughness of the footprint, as the ports of the reflection datapath take them.
    pub(super) fn sample(
        &self,
        reads: &mut MapReads<'_>,
        kind: RoughnessKind,
        p: &Precision,
    ) -> ([I4F28; 2], [I4F28; 3]) {
        let probe = |[b1, b2, k11, k12, k22]: [i32; 5]| {
            let m = moments::of_probe(&[b1, b2].map(Fx::from_raw), &[k11, k12, k22].map(Fx::<i32, 29>::from_raw));
            [b1, b2, m[0].raw(), m[1].raw(), m[2].raw()]
        };
        let [b1, b2, m11, m12, m22] = reads.of(&self.map).mean(0, &self.texels, probe);
        let b: [Fx<i32, 30>; 2] = [Fx::from_raw(b1), Fx::from_raw(b2)];
        let port = |word: i32, shift: i32| {
            let word = i64::from(word);
            let moved = if shift >= 0 { word << shift } else { (word + (1 << (-shift - 1))) >> -shift };
            I4F28::from_bits(moved.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32)
        };
        let offset = b.map(|b| port(b.raw(), self.exponent - 2));
        if kind == RoughnessKind::None {
            return (offset, [I4F28::ZERO; 3]);
        }
        let second = [m11, m12, m22].map(Fx::from_raw);
        let k = moments::covariance(&(b, second), p);
        let d = match kind {
            RoughnessKind::Isotropic => {
                let major = axes::axes(&Ellipse { k, det: Block::zero() }, p).major;
                [moments::to_roughness(major), Fx::zero(), Fx::zero()]
            }
            _ => moments::decompose(&k, p),
        };
        (offset, d.map(|d| port(d.raw(), self.exponent)))
    }
}
