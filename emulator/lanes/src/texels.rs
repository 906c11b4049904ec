//! Maps as a reading fetches from them: the texels of all levels in one piece.

use roughxel_core::each::each;
use roughxel_core::repeated::Level;
use roughxel_core::sampler::{Cube, CubeMemory, level_edge};
use roughxel_core::signals::MapScale;
use roughxel_core::soft_core::texture_scale;
use roughxel_core::stage::texture::TextureScale;

/// Faces of a cube.
const FACES: usize = 6;

/// An environment: levels of [`level_edge`] texels along an edge, the finest first, six faces each, texels in rows.
#[derive(Clone, Debug)]
pub struct CubeTexels {
    /// Three channels and nothing: a texel is a word of 64 bits.
    texels: Vec<[u16; 4]>,
    /// Where each level begins.
    starts: Vec<usize>,
    edge: u32,
    exponent: i32,
    is_bright: bool,
}

impl CubeTexels {
    /// Of faces with `edge` texels along an edge, level by level, and a unit of 2^`exponent` in linear light; `is_bright` if codes have an exponent
    /// each.
    ///
    /// # Panics
    /// If the texels are not those of whole levels, at least one.
    pub fn new(edge: u32, exponent: i32, is_bright: bool, faces: &[&[[u16; 3]]]) -> Self {
        let mut texels = Vec::with_capacity(faces.iter().map(|face| face.len()).sum());
        for face in faces {
            texels.extend(face.iter().map(|&[red, green, blue]| [red, green, blue, 0]));
        }
        let mut starts = Vec::new();
        let mut next = 0;
        while next < texels.len() {
            let edge = level_edge(edge, starts.len() as u32) as usize;
            starts.push(next);
            next += FACES * edge * edge;
        }
        assert!(next == texels.len() && !starts.is_empty(), "{} texels are no levels of edge {edge}", texels.len());
        Self { texels, starts, edge, exponent, is_bright }
    }

    /// Texels along the edge of a face of level 0.
    pub fn edge(&self) -> u32 {
        self.edge
    }

    /// Texels of all levels.
    pub fn len(&self) -> usize {
        self.texels.len()
    }

    /// Whether there are none, which is never so.
    pub fn is_empty(&self) -> bool {
        self.texels.is_empty()
    }

    /// Whether codes have an exponent each.
    pub fn is_bright(&self) -> bool {
        self.is_bright
    }

    /// As the sampler takes it.
    pub(super) fn cube(&self) -> Cube<'_, Self> {
        let last_level = self.starts.len() as u32 - 1;
        Cube { memory: self, edge: self.edge, last_level, exponent: self.exponent }
    }

    /// The place of a texel and the texels of a row. A lane without a fragment may ask for one that there is not.
    #[inline(always)]
    fn place(&self, level: u32, face: u32, column: u32, row: u32) -> (usize, usize) {
        let edge = level_edge(self.edge, level) as usize;
        let start = self.starts.get(level as usize).copied().unwrap_or(self.texels.len());
        (start + (face as usize * edge + row as usize) * edge + column as usize, edge)
    }
}

impl CubeMemory for CubeTexels {
    #[inline(always)]
    fn texel(&self, level: u32, face: u32, column: u32, row: u32) -> [u16; 3] {
        let texel = self.texels.get(self.place(level, face, column, row).0);
        let [red, green, blue, _] = texel.copied().unwrap_or_default();
        [red, green, blue]
    }

    #[inline(always)]
    fn is_bright(&self) -> bool {
        self.is_bright
    }

    #[inline(always)]
    fn patch(&self, level: u32, face: u32, column: u32, row: u32) -> [[u16; 3]; 4] {
        let (first, edge) = self.place(level, face, column, row);
        let Some(rows) = self.texels.get(first..first + edge + 2) else { return [[0; 3]; 4] };
        each!([red, green, blue, _] in [rows[0], rows[1], rows[edge], rows[edge + 1]] => [red, green, blue])
    }
}

/// Geometry of a repeated map.
#[derive(Clone, Debug)]
pub struct RepeatedMap {
    /// Its levels, the finest first, at least one.
    pub levels: Vec<Level>,
    /// For footprints.
    pub scale: (TextureScale<i32>, MapScale<i32>),
}

impl RepeatedMap {
    /// With levels of these widths and heights.
    ///
    /// # Panics
    /// If there is none.
    pub fn new(sizes: impl Iterator<Item = (u32, u32)>) -> Self {
        let levels = sizes.scan(0, |next, (width, height)| {
            let start = *next;
            *next += (width * height) as i32;
            Some(Level { size: [width as i32, height as i32], start })
        });
        let levels: Vec<Level> = levels.collect();
        Self { scale: texture_scale(levels[0].size.map(|edge| edge as u16)), levels }
    }

    /// Columns and rows of the finest level.
    pub fn size(&self) -> [i32; 2] {
        self.levels[0].size
    }
}

/// A repeated map with its texels.
#[derive(Clone, Debug)]
pub struct MapTexels<T> {
    /// Its levels.
    pub map: RepeatedMap,
    /// The texels of all levels, in rows.
    pub texels: Vec<T>,
}
