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

    /// As the sampler takes it; its memory is `M`, [`LinearCube`] or [`BrightCube`] as it is bright.
    pub(super) fn cube<'a, M>(&self, memory: &'a M) -> Cube<'a, M> {
        let last_level = self.starts.len() as u32 - 1;
        Cube { memory, edge: self.edge, last_level, exponent: self.exponent }
    }

    #[inline(always)]
    fn place(&self, level: u32, face: u32, column: u32, row: u32) -> (usize, usize) {
        let edge = level_edge(self.edge, level) as usize;
        (self.starts[level as usize] + (face as usize * edge + row as usize) * edge + column as usize, edge)
    }

    #[inline(always)]
    fn texel(&self, level: u32, face: u32, column: u32, row: u32) -> [u16; 3] {
        let [red, green, blue, _] = self.texels[self.place(level, face, column, row).0];
        [red, green, blue]
    }

    #[inline(always)]
    fn patch(&self, level: u32, face: u32, column: u32, row: u32) -> [[u16; 3]; 4] {
        let (first, edge) = self.place(level, face, column, row);
        let rows = &self.texels[first..][..edge + 2];
        each!([red, green, blue, _] in [rows[0], rows[1], rows[edge], rows[edge + 1]] => [red, green, blue])
    }
}

macro_rules! memory {
    ($(#[$doc:meta])* $name:ident, $bright:literal) => {
        $(#[$doc])*
        pub(super) struct $name<'a>(pub(super) &'a CubeTexels);

        impl CubeMemory for $name<'_> {
            const BRIGHT: bool = $bright;
            #[inline(always)]
            fn texel(&self, level: u32, face: u32, column: u32, row: u32) -> [u16; 3] {
                self.0.texel(level, face, column, row)
            }
            #[inline(always)]
            fn patch(&self, level: u32, face: u32, column: u32, row: u32) -> [[u16; 3]; 4] {
                self.0.patch(level, face, column, row)
            }
        }
    };
}

memory!(
    /// An environment of at most 64 × white.
    LinearCube, false
);
memory!(
    /// A brighter one.
    BrightCube, true
);

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
