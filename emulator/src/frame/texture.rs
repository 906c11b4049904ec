//! Fetches from repeated maps: the probes of a fragment, colour, and bumps with their second moments.

use fixed::types::I4F28;
use roughxel_core::block::Block;
use roughxel_core::datapath::Probe;
use roughxel_core::fx::Fx;
use roughxel_core::ports::{TextureIn, texture_scale};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::probe_list::{ProbeList, texture_probes};
use roughxel_core::signals::{Ellipse, MapScale, Probes, TexturePosition};
use roughxel_core::stage::filter::{Address, LOD_WEIGHT, ProbeSum, WEIGHT, levels, repeat_address, trilinear};
use roughxel_core::stage::texture::TextureScale;
use roughxel_core::stage::{axes, moments};

use crate::maps::bump::BumpPyramid;
use crate::maps::mip::{ColourPyramid, smallest_exponent};
use crate::picture::Picture;
use crate::raster::FragmentAttributes;

use super::{Colour, MAX_MAP_EXPONENT};

/// What a fragment reads of repeated maps: maps of one size share its footprint.
#[derive(Debug)]
pub struct MapReads<'a> {
    attributes: &'a FragmentAttributes,
    footprint: bool,
    p: &'a Precision,
    /// Size of the maps that the probes are for.
    size: Option<[i32; 2]>,
    taps: Taps,
}

impl<'a> MapReads<'a> {
    /// N trilinear probes along the major axis of the fragment's footprint, or one at the finest level.
    pub fn new(attributes: &'a FragmentAttributes, footprint: bool, p: &'a Precision) -> Self {
        Self { attributes, footprint, p, size: None, taps: Taps::new() }
    }

    /// The probes in a map.
    fn of(&mut self, map: &RepeatedMap) -> &Taps {
        let size = map.levels[0].size;
        if self.size != Some(size) {
            self.size = Some(size);
            let (attributes, p) = (self.attributes, self.p);
            let input = TextureIn { uv: attributes.uv, duv: attributes.duv };
            let centre = TexturePosition { uv: input.uv.map(|u| Fx::from_raw(i64::from(u.to_bits()))) };
            self.taps.clear();
            if self.footprint {
                let probes: Probes<i32> = input.footprint(&map.scale, p).probes;
                for Probe { place, weight } in texture_probes(&centre, &probes, &map.scale.0, p) {
                    self.taps.extend([Probe { place: map.tap(&place, probes.lod, p), weight }]);
                }
            } else {
                self.taps.extend([Probe { place: map.tap(&centre, Fx::zero(), p), weight: Fx::lit(1 << 16) }]);
            }
        }
        &self.taps
    }

    /// The probes in a map, to be changed: no other map will share them.
    pub(super) fn take(&mut self, map: &RepeatedMap) -> &mut Taps {
        self.of(map);
        self.size = None;
        &mut self.taps
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

    fn tap(&self, place: &TexturePosition<i32>, lod: Fx<i32, 16>, p: &Precision) -> Tap {
        let pair = levels(lod);
        let fine = pair.level.raw() as usize;
        let coarse = (fine + 1).min(self.levels.len() - 1);
        let patch = |level: usize| {
            let RepeatedLevel { size, start } = self.levels[level];
            let address: Address<i32> = repeat_address(place, size.map(Fx::from_raw), p);
            let wrap = |i: i32, edge: i32| if i < 0 { i + edge } else if i >= edge { i - edge } else { i } as u32;
            let [x, y] = address.index.map(Fx::raw);
            let (x0, x1) = (wrap(x, size[0]), wrap(x + 1, size[0]));
            let (y0, y1) = (wrap(y, size[1]), wrap(y + 1, size[1]));
            let [y0, y1] = [y0, y1].map(|y| start + y * size[0] as u32);
            Patch { texels: [y0 + x0, y0 + x1, y1 + x0, y1 + x1], weight: address.weight }
        };
        let coarse = (pair.weight.raw() != 0).then(|| patch(coarse));
        Tap { fine: patch(fine), coarse, level_weight: pair.weight }
    }
}

/// Four neighbours on one level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    /// Indices among the texels of all levels, the finest first.
    pub(super) texels: [u32; 4],
    weight: [Fx<i32, WEIGHT>; 2],
}

/// What one probe reads of two levels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tap {
    fine: Patch,
    /// `None` where its weight is 0.
    coarse: Option<Patch>,
    level_weight: Fx<i32, LOD_WEIGHT>,
}

impl Tap {
    /// What it reads of the finer level and of the coarser one.
    pub(super) fn levels(&mut self) -> (&mut Patch, Option<&mut Patch>) {
        (&mut self.fine, self.coarse.as_mut())
    }

    /// A sample has `extra` fraction bits more than a texel.
    fn sample<const CHANNELS: usize>(&self, extra: u32, texel: &impl Fn(u32) -> [i32; CHANNELS]) -> [i32; CHANNELS] {
        let (fine, coarse) = (&self.fine, self.coarse.as_ref().unwrap_or(&self.fine));
        let [a, b] = [fine, coarse].map(|patch| patch.texels.map(texel));
        core::array::from_fn(|channel| {
            let (a, b) = (a.map(|texel| texel[channel]), b.map(|texel| texel[channel]));
            trilinear((&a, &fine.weight), (&b, &coarse.weight), self.level_weight, extra)
        })
    }
}

/// What a fragment reads, with the weight of each probe.
pub(super) type Taps = ProbeList<Tap>;

/// Averages `CHANNELS` channels over the probes.
///
/// A sample has `extra` fraction bits more than a texel; `probe` turns the sample of one probe into what is averaged.
pub(super) fn mean<const CHANNELS: usize>(
    taps: &Taps,
    extra: u32,
    texel: impl Fn(u32) -> [i32; CHANNELS],
    probe: impl Fn([i32; CHANNELS]) -> [i32; CHANNELS],
) -> [i32; CHANNELS] {
    let mut sums = [ProbeSum::<i32>::zero(); CHANNELS];
    for tap in taps {
        let sample = probe(tap.place.sample(extra, &texel));
        for (sum, channel) in sums.iter_mut().zip(sample) {
            *sum = sum.add(channel, tap.weight);
        }
    }
    sums.map(ProbeSum::mean)
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

    /// Bytes of the stored texels.
    pub(super) fn bytes(&self) -> u64 {
        size_of_val(self.texels.as_slice()) as u64
    }

    /// The mean colour of the footprint.
    pub fn sample(&self, reads: &mut MapReads<'_>) -> Colour {
        let texel = |index: u32| self.texels[index as usize].map(i32::from);
        let sample = mean(reads.of(&self.map), 8, texel, |sample| sample);
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
        let texel = |index: u32| self.texels[index as usize];
        let probe = |[b1, b2, k11, k12, k22]: [i32; 5]| {
            let m = moments::of_probe(&[b1, b2].map(Fx::from_raw), &[k11, k12, k22].map(Fx::<i32, 29>::from_raw));
            [b1, b2, m[0].raw(), m[1].raw(), m[2].raw()]
        };
        let [b1, b2, m11, m12, m22] = mean(reads.of(&self.map), 0, texel, probe);
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
