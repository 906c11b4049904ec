//! Maps as a backend fetches from them: the texels of all levels in one piece.

use std::marker::PhantomData;

use roughxel_core::datapath::texel::{self, BumpScale, Quad};
use roughxel_core::each::{each, places};
use roughxel_core::fetch::Fetch;
use roughxel_core::fx::{Fx, Int};
use roughxel_core::sampler::{self, Cube, CubeMemory, PatchPlace, level_edge};
use roughxel_core::scalar_api::texture_scale;
use roughxel_core::signals::MapScale;
use roughxel_core::stage::moments;
use roughxel_core::stage::seam::{CubeTexel, FaceTexel};
use roughxel_core::stage::texture::TextureScale;
use roughxel_core::word::{Wire, Word};
use roughxel_core::wrapped::{Level, Neighbours};

/// Faces of a cube.
const FACES: u32 = 6;

/// Packs two 32-bit words into one of 64.
pub(crate) fn wide([low, high]: [i32; 2]) -> u64 {
    u64::from(low.cast_unsigned()) | u64::from(high.cast_unsigned()) << 32
}

/// Maximum number of levels of a map: 2^14 texels along an edge, and room for one more.
const LEVELS: usize = 16;

/// Packs three channels into a 64-bit word, of which the upper quarter is 0.
fn colour_word([red, green, blue]: [u16; 3]) -> u64 {
    u64::from(red) | u64::from(green) << 16 | u64::from(blue) << 32
}

/// Unpacks the channels from the halves of such a word.
#[inline(always)]
fn channels<W: Word>([low, high]: [Int<W>; 2]) -> [Int<W>; 3] {
    let lower = W::Count::lit(0xffff);
    [Fx::from_raw(low.raw().and(lower)), Fx::from_raw(low.raw().sar(16).and(lower)), high]
}

/// An environment: levels of [`level_edge`] texels along an edge, the finest first, six faces each, texels in rows. Each face is surrounded by the
/// texels that a bilinear sample reads beyond its edges, so a sample is two pairs of neighbours at any place. A frame reads many coarse levels, which
/// are sixteen texels wide.
#[derive(Clone, Debug)]
pub struct CubeTexels {
    /// Texels, one [`colour_word`] each.
    texels: Vec<u64>,
    /// Start of each level.
    starts: [i32; LEVELS],
    levels: u32,
    edge: u32,
    exponent: i32,
    is_bright: bool,
}

impl CubeTexels {
    /// Environment of faces with `edge` texels along an edge, level by level, and a unit of 2^`exponent` in linear light. `is_bright` states that
    /// codes have an exponent each.
    ///
    /// # Panics
    /// If the texels are not those of whole levels, at least one and at most sixteen.
    pub fn new(edge: u32, exponent: i32, is_bright: bool, faces: &[&[[u16; 3]]]) -> Self {
        let given: Vec<[u16; 3]> = faces.concat();
        let mut cube = Self { texels: Vec::new(), starts: [0; LEVELS], levels: 0, edge, exponent, is_bright };
        let mut texels = &given[..];
        while !texels.is_empty() {
            let of_level = FACES * level_edge(edge, cube.levels).pow(2);
            let (level, rest) = texels.split_at_checked(of_level as usize).unwrap_or((&[], &[]));
            assert!(!level.is_empty(), "{} texels are no levels of edge {edge}", given.len());
            cube.add_level(level);
            texels = rest;
        }
        assert!(cube.levels > 0, "an environment has texels");
        cube
    }

    /// Adds a level, with the texels around its faces. A corner of bright codes, whose mean no code stands for, is left out.
    fn add_level(&mut self, level: &[[u16; 3]]) {
        let edge = level_edge(self.edge, self.levels) as i32;
        let at = |texel: &FaceTexel<i32>| {
            let [column, row] = texel.index.map(Fx::raw);
            level[((texel.face.raw() * edge + row) * edge + column) as usize]
        };
        self.starts[self.levels as usize] = self.texels.len() as i32;
        self.levels += 1;
        let around = |face: i32, row: i32, column: i32| {
            let [face, column, row, edge] = [face, column, row, edge].map(Fx::from_raw);
            let CubeTexel { texel, across, corner } = texel::cube_texel::<i32>(face, [column, row], edge);
            let own = at(&texel);
            if !corner {
                return colour_word(own);
            }
            let [s, t] = across.map(|texel| at(&texel));
            colour_word(core::array::from_fn(|channel| {
                let three = [own, s, t].map(|texel| Fx::from_raw(texel[channel].into()));
                if self.is_bright { 0 } else { texel::corner::<i32>(&three).raw() as u16 }
            }))
        };
        let mut words = Vec::new();
        for (face, texels) in (0..).zip(level.chunks_exact((edge * edge) as usize)) {
            words.extend((-1..=edge).map(|column| around(face, -1, column)));
            for (row, texels) in (0..).zip(texels.chunks_exact(edge as usize)) {
                words.push(around(face, row, -1));
                words.extend(texels.iter().copied().map(colour_word));
                words.push(around(face, row, edge));
            }
            words.extend((-1..=edge).map(|column| around(face, edge, column)));
        }
        self.texels.append(&mut words);
    }

    /// Number of texels along the edge of a face of level 0.
    pub fn edge(&self) -> u32 {
        self.edge
    }

    /// Number of levels.
    pub fn levels(&self) -> u32 {
        self.levels
    }

    /// log₂ of the unit in linear light.
    pub fn exponent(&self) -> i32 {
        self.exponent
    }

    /// Number of texels of all levels.
    pub fn len(&self) -> usize {
        (0..self.levels).map(|level| FACES as usize * (level_edge(self.edge, level) as usize).pow(2)).sum()
    }

    /// Returns true if there are no texels, which never happens.
    pub fn is_empty(&self) -> bool {
        self.texels.is_empty()
    }

    /// Returns true if each code has an exponent.
    pub fn is_bright(&self) -> bool {
        self.is_bright
    }

    /// View that the sampler takes.
    pub(crate) fn cube(&self) -> Cube<'_, Self> {
        Cube { memory: self, edge: self.edge, last_level: self.levels - 1, exponent: self.exponent }
    }
}

impl CubeMemory for CubeTexels {
    /// A lane without a fragment may ask for a texel that does not exist.
    fn texel(&self, level: u32, face: u32, column: u32, row: u32) -> [u16; 3] {
        let stride = level_edge(self.edge, level) as usize + 2;
        let place = (face as usize * stride + row as usize + 1) * stride + column as usize + 1;
        let texel = self.texels.get(self.starts[level as usize % LEVELS] as usize + place).copied().unwrap_or_default();
        [texel as u16, (texel >> 16) as u16, (texel >> 32) as u16]
    }

    #[inline(always)]
    fn is_bright(&self) -> bool {
        self.is_bright
    }

    #[inline(always)]
    fn patches<W: Fetch>(&self, at: &PatchPlace<W>) -> [[Int<W>; 3]; 4] {
        let &PatchPlace { level, edge, face, index: [column, row] } = at;
        let stride = edge + Fx::int(2);
        let by_stride = |number: Int<W>| -> Int<W> { Fx::from_raw(W::Count::narrow(number.raw().mul(stride.raw()))) };
        // Counted from the corner outside of the face.
        let [column, row] = each!(index in [column, row] => index + Fx::int(1));
        let place = W::entry(level, &self.starts) + by_stride(by_stride(face) + row) + column;
        let [[a, b, c, d], [e, f, g, h]] = each!(place in [place, place + stride] => W::load_pair(place, &self.texels));
        let codes = each!(halves in [[a, b], [c, d], [e, f], [g, h]] => channels::<W>(halves));
        if !self.is_bright {
            return codes;
        }
        let corners = each!(index in [column, row] => index.is_zero() | index.ge(edge));
        let texels = each!(code in codes => each!(code in code => texel::bright_texel::<W>(code)));
        let [s, t] = corners;
        if W::any(s & t) { sampler::patches(self, at) } else { texels }
    }
}

/// Geometry of a wrapped map.
#[derive(Clone, Debug)]
pub struct WrappedMap {
    /// Levels, the finest first, at least one.
    pub levels: Vec<Level>,
    /// Scale, for footprints.
    pub scale: (TextureScale<i32>, MapScale<i32>),
}

impl WrappedMap {
    /// Map with levels of these widths and heights.
    ///
    /// # Panics
    /// If there is no level.
    pub fn new(sizes: impl Iterator<Item = (u32, u32)>) -> Self {
        let levels = levels(sizes.map(|(width, height)| [width as i32, height as i32]), 0);
        Self { scale: texture_scale(levels[0].size.map(|edge| edge as u16)), levels }
    }

    /// Columns and rows of the finest level.
    pub fn size(&self) -> [i32; 2] {
        self.levels[0].size
    }
}

/// Levels of these sizes, in rows with `behind` more places after the last column.
fn levels(sizes: impl Iterator<Item = [i32; 2]>, behind: i32) -> Vec<Level> {
    let levels = sizes.scan(0, |next, size| {
        let (stride, start) = (size[0] + behind, *next);
        *next += stride * size[1];
        Some(Level { size, stride, start })
    });
    levels.collect()
}

/// A texel of a wrapped map as a memory holds it.
pub trait Texel: Copy {
    /// 64-bit words of the texel.
    type Words: AsRef<[u64]>;
    /// Packs the texel into words.
    fn words(self) -> Self::Words;
}

/// A colour: its channels in the lower three quarters of a word.
impl Texel for [u16; 3] {
    type Words = [u64; 1];
    fn words(self) -> [u64; 1] {
        [colour_word(self)]
    }
}

/// Offset of a bump, in the halves of a word.
impl Texel for [i32; 2] {
    type Words = [u64; 1];
    fn words(self) -> [u64; 1] {
        [wide(self)]
    }
}

/// A bump with roughness.
#[derive(Clone, Copy, Debug)]
pub struct RoughBump {
    /// Codes of b₁, b₂.
    pub offset: [i16; 2],
    /// K, its elements 11, 12, 22, in units of the map.
    pub covariance: [i32; 3],
}

/// Codes of the offset in a half of a word, elements of K in three more.
impl Texel for RoughBump {
    type Words = [u64; 2];
    fn words(self) -> [u64; 2] {
        let [b1, b2] = self.offset.map(|code| u64::from(code.cast_unsigned()));
        let [k11, k12, k22] = self.covariance.map(|channel| u64::from(channel.cast_unsigned()));
        [b1 | b2 << 16 | k11 << 32, k12 | k22 << 32]
    }
}

/// A wrapped map with its texels.
#[derive(Clone, Debug)]
pub struct MapTexels<T> {
    /// Levels as they lie in memory: the first texel of a row is repeated after the last one.
    pub map: WrappedMap,
    words: Vec<u64>,
    texel: PhantomData<T>,
}

impl<T: Texel> MapTexels<T> {
    /// Map of the texels of all levels, in rows.
    ///
    /// # Panics
    /// If the number of texels is not that of the levels.
    pub fn new(map: WrappedMap, texels: impl IntoIterator<Item = T>) -> Self {
        let mut texels = texels.into_iter();
        let mut words = Vec::new();
        for level in &map.levels {
            for _ in 0..level.size[1] {
                let first = words.len();
                (&mut texels)
                    .take(level.size[0] as usize)
                    .for_each(|texel| words.extend_from_slice(texel.words().as_ref()));
                words.extend_from_within(first..first + size_of::<T::Words>() / size_of::<u64>());
            }
        }
        let levels = levels(map.levels.iter().map(|level| level.size), 1);
        let rows: usize = levels.iter().map(|level| (level.stride * level.size[1]) as usize).sum();
        assert!(
            texels.next().is_none() && words.len() * size_of::<u64>() == rows * size_of::<T::Words>(),
            "texels of all levels"
        );
        Self { map: WrappedMap { levels, ..map }, words, texel: PhantomData }
    }
}

impl MapTexels<[u16; 3]> {
    /// Bytes of the texels as a memory of three channels holds them.
    pub fn bytes(&self) -> u64 {
        let texels = |level: &Level| level.size.iter().map(|&edge| edge as u64).product::<u64>();
        size_of::<[u16; 3]>() as u64 * self.map.levels.iter().map(texels).sum::<u64>()
    }

    /// Colours of neighbouring texels.
    #[inline(always)]
    pub(crate) fn quad<W: Fetch>(&self, neighbours: &Neighbours<W>) -> Quad<W, 3> {
        let [left, _, lower, _] = neighbours.texels;
        let [[a, b, c, d], [e, f, g, h]] = each!(place in [left, lower] => W::load_pair(place, &self.words));
        Quad {
            texels: each!(halves in [[a, b], [c, d], [e, f], [g, h]] => channels::<W>(halves)),
            weight: neighbours.weight,
        }
    }
}

/// Texels of a bump map.
#[derive(Clone, Debug)]
pub enum BumpTexels {
    /// Offsets in units of the map, without roughness on any level.
    Smooth(MapTexels<[i32; 2]>),
    /// Offsets with roughness.
    Rough(MapTexels<RoughBump>),
}

impl BumpTexels {
    /// Offsets alone, in half the memory, which take half the fetches.
    pub fn without_roughness(&self, scale: &BumpScale<i32>) -> Self {
        match self {
            Self::Smooth(texels) => Self::Smooth(texels.clone()),
            Self::Rough(MapTexels { map, words, .. }) => {
                let offset = |rough: &[u64; 2]| {
                    let codes = [rough[0] as i16, (rough[0] >> 16) as i16];
                    wide(codes.map(|code| moments::decode_offset(Fx::from_raw(code.into()), scale.offset_down).raw()))
                };
                let words = words.as_chunks().0.iter().map(offset).collect();
                Self::Smooth(MapTexels { map: map.clone(), words, texel: PhantomData })
            }
        }
    }

    /// First channels of the bumps of neighbouring texels, in units of the map.
    #[inline(always)]
    pub(crate) fn quad<W: Fetch, const CHANNELS: usize>(
        &self,
        neighbours: &Neighbours<W>,
        scale: &BumpScale<W>,
    ) -> Quad<W, CHANNELS> {
        match self {
            Self::Smooth(texels) => texels.quad_of_offsets(neighbours),
            Self::Rough(texels) => texels.quad_of_moments(neighbours, scale),
        }
    }

    /// Levels as they lie in memory.
    pub fn map(&self) -> &WrappedMap {
        match self {
            Self::Smooth(texels) => &texels.map,
            Self::Rough(texels) => &texels.map,
        }
    }
}

impl MapTexels<[i32; 2]> {
    #[inline(always)]
    fn quad_of_offsets<W: Fetch, const CHANNELS: usize>(&self, neighbours: &Neighbours<W>) -> Quad<W, CHANNELS> {
        let [left, _, lower, _] = neighbours.texels;
        let [[a, b, c, d], [e, f, g, h]] = each!(place in [left, lower] => W::load_pair(place, &self.words));
        let zero = Fx::zero();
        let texels = each!([b1, b2] in [[a, b], [c, d], [e, f], [g, h]] => {
            let channels = [b1, b2, zero, zero, zero];
            each!(channel in places() => channels[channel])
        });
        Quad { texels, weight: neighbours.weight }
    }
}

impl MapTexels<RoughBump> {
    #[inline(always)]
    fn quad_of_moments<W: Fetch, const CHANNELS: usize>(
        &self,
        neighbours: &Neighbours<W>,
        scale: &BumpScale<W>,
    ) -> Quad<W, CHANNELS> {
        let [left, _, lower, _] = neighbours.texels;
        let [left, lower] = each!(texel in [left, lower] => texel.shl(1));
        // `decode_offset` of a code that is already in the upper half of its word.
        let down = scale.offset_down + Fx::int(1);
        let texels = each!(place in [left, left + Fx::int(2), lower, lower + Fx::int(2)] => {
            let [codes, k11, k12, k22] = W::load_pair(place, &self.words);
            let [b1, b2] = each!(upper in [codes.raw().shl(16), codes.raw().and(Wire::lit(-1 << 16))] => {
                Fx::from_raw(upper.sar_by(down.raw()))
            });
            let channels = [b1, b2, k11, k12, k22];
            each!(channel in places() => channels[channel])
        });
        Quad { texels, weight: neighbours.weight }
    }
}
