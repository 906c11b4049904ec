//! Coverage: which samples of a tile are shaded, and how much each counts in its pixel.
//!
//! A filter looks at what lies around a sample on *one* surface; where several meet in a pixel, they have to be told apart first. So what is
//! visible is asked for at [`PATTERN`] and at the centre, and every object that is seen is shaded once: at the centre if it is seen there, else at the
//! nearest of its samples, for all of them. A pixel that shows one object alone is shaded at its centre, as if nobody had asked.

use super::edges::TileBuffer;
use super::setup::TriangleList;
use super::{PIXEL_CENTRE_SUBPX, SUBPIXELS, TileRect};

/// Where visibility is asked for, in sixteenths of a pixel from its centre, the nearest first: eight places, no two in one row or column
/// of eighths, so that an edge near the horizontal or the vertical has nine steps.
const PATTERN: [[i32; 2]; 8] = [[1, -3], [-1, 3], [5, 1], [-3, -5], [-5, 5], [-7, -1], [3, 7], [7, -7]];

/// Which samples of a pixel are shaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// Each of a regular grid; 1 is the centre alone.
    Grid {
        /// Samples along each edge of the pixel.
        edge: u32,
    },
    /// One for every object that is visible in it.
    Objects,
}

/// A sample to shade.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// The pixel in its tile, in rows.
    pub pixel: usize,
    /// Sub-pixels from the corner of the frame.
    pub position: [i32; 2],
    /// The triangle that is visible there, if any.
    pub triangle: Option<u32>,
    /// How often its colour counts.
    pub times: u32,
}

impl TriangleList<'_> {
    /// Hands every sample of a tile to `shade`. Returns how many samples each pixel has, those counted `times` over: what the sum of its
    /// colours is divided by.
    pub fn samples(&self, tile: TileRect, sampling: Sampling, mut shade: impl FnMut(Sample)) -> Vec<u32> {
        let pixels = tile.width as usize * tile.height as usize;
        match sampling {
            Sampling::Grid { edge } => {
                let steps = edge as i32;
                let place = |i: i32| (2 * i + 1) * SUBPIXELS / (2 * steps);
                let mut buffer = TileBuffer::new();
                for sample in 0..steps * steps {
                    let offset = [place(sample % steps), place(sample / steps)];
                    self.rasterise_tile(tile, offset, &mut buffer);
                    for ((pixel, position), triangle) in positions(tile, offset).enumerate().zip(buffer.triangles()) {
                        shade(Sample { pixel, position, triangle, times: 1 });
                    }
                }
                vec![edge * edge; pixels]
            }
            Sampling::Objects => {
                let at = |offset: [i32; 2]| {
                    let mut buffer = TileBuffer::new();
                    self.rasterise_tile(tile, offset, &mut buffer);
                    buffer
                };
                let centres = at(PIXEL_CENTRE_SUBPX);
                let pattern = PATTERN.map(|place| place.map(|sixteenths| (8 + sixteenths) * (SUBPIXELS / 16)));
                let around = pattern.map(at);
                let mut around = around.each_ref().map(TileBuffer::triangles);
                let centres = positions(tile, PIXEL_CENTRE_SUBPX).enumerate().zip(centres.triangles());
                centres
                    .map(|((pixel, position), triangle)| {
                        let seen = around.each_mut().map(|triangles| triangles.next().flatten());
                        let centre = Sample { pixel, position, triangle, times: 1 };
                        self.objects_of(&centre, &seen, &pattern, &mut shade)
                    })
                    .collect()
            }
        }
    }

    /// A sample for each object of a pixel; returns how many samples they are.
    fn objects_of(
        &self,
        centre: &Sample,
        seen: &[Option<u32>; PATTERN.len()],
        pattern: &[[i32; 2]; PATTERN.len()],
        shade: &mut impl FnMut(Sample),
    ) -> u32 {
        let object = |triangle: Option<u32>| triangle.map(|triangle| self.object_index(triangle));
        if seen.iter().all(|triangle| *triangle == centre.triangle) {
            shade(*centre);
            return 1;
        }
        let own = object(centre.triangle);
        let objects = seen.map(object);
        if objects.iter().all(|object| *object == own) {
            shade(*centre);
            return 1;
        }
        for (index, object) in objects.iter().enumerate() {
            if objects[..index].contains(object) {
                continue;
            }
            let times = objects[index..].iter().filter(|other| *other == object).count() as u32;
            let [x, y] = [0, 1].map(|axis| centre.position[axis] - PIXEL_CENTRE_SUBPX[axis] + pattern[index][axis]);
            let nearest = Sample { position: [x, y], triangle: seen[index], ..*centre };
            shade(Sample { times, ..if *object == own { *centre } else { nearest } });
        }
        PATTERN.len() as u32
    }
}

/// The same place of every pixel of a tile, in rows, in sub-pixels from the corner of the frame.
fn positions(tile: TileRect, offset: [i32; 2]) -> impl Iterator<Item = [i32; 2]> {
    let place = |pixel: u32, offset: i32| pixel as i32 * SUBPIXELS + offset;
    (0..tile.height)
        .flat_map(move |y| (0..tile.width).map(move |x| [place(tile.x + x, offset[0]), place(tile.y + y, offset[1])]))
}
