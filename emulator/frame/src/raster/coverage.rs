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

/// Samples side by side in a row of a tile that show the same triangle, at the same place of their pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// The triangle that is visible there, if any.
    pub triangle: Option<u32>,
    /// The first pixel in its tile, in rows.
    pub pixel: u32,
    /// How many there are, at least one.
    pub count: u32,
    /// Of the first, sub-pixels from the corner of the frame.
    pub position: [i32; 2],
    /// How often the colour of each counts.
    pub times: u32,
}

impl Run {
    /// The pixels with their positions.
    #[inline(always)]
    pub fn samples(&self) -> impl ExactSizeIterator<Item = (usize, [i32; 2])> + use<> {
        let Self { pixel, position: [x, y], .. } = *self;
        (0..self.count).map(move |index| ((pixel + index) as usize, [x + index as i32 * SUBPIXELS, y]))
    }
}

/// Makes runs of samples.
struct Runs(Vec<Run>);

impl Runs {
    /// Adds a sample, to the last run if it goes on.
    #[inline(always)]
    fn push(&mut self, run: Run) {
        if let Some(last) = self.0.last_mut() {
            let end = last.position[0] + last.count as i32 * SUBPIXELS;
            let goes_on = last.triangle == run.triangle
                && last.pixel + last.count == run.pixel
                && [end, last.position[1]] == run.position
                && last.times == run.times;
            if goes_on {
                last.count += run.count;
                return;
            }
        }
        self.0.push(run);
    }
}

impl TriangleList<'_> {
    /// Every sample of a tile, by triangle: those of a triangle follow each other, those that show none are the last. Second: how many samples each
    /// pixel has, those counted `times` over: what the sum of its colours is divided by.
    pub fn samples(&self, tile: TileRect, sampling: Sampling) -> (Vec<Run>, Vec<u32>) {
        let pixels = tile.width as usize * tile.height as usize;
        let mut runs = Runs(Vec::new());
        let counts = match sampling {
            Sampling::Grid { edge } => {
                let steps = edge as i32;
                let place = |i: i32| (2 * i + 1) * SUBPIXELS / (2 * steps);
                let mut buffer = TileBuffer::new();
                for sample in 0..steps * steps {
                    let offset = [place(sample % steps), place(sample / steps)];
                    self.rasterise_tile(tile, offset, &mut buffer);
                    let width = tile.width as usize;
                    for (row, shown) in (0..tile.height).zip(buffer.visible().chunks_exact(width)) {
                        let (mut column, start) = (0, row * tile.width);
                        for same in shown.chunk_by(|a, b| a == b) {
                            let count = same.len() as u32;
                            let triangle = TileBuffer::shown(same[0]);
                            let position = position_of(tile, [column, row], offset);
                            runs.0.push(Run { triangle, pixel: start + column, count, position, times: 1 });
                            column += count;
                        }
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
                (0..tile.height)
                    .flat_map(|row| (0..tile.width).map(move |column| [column, row]))
                    .zip(centres.triangles())
                    .map(|(place, triangle)| {
                        let pixel = place[1] * tile.width + place[0];
                        let position = position_of(tile, place, PIXEL_CENTRE_SUBPX);
                        let seen = around.each_mut().map(|triangles| triangles.next().flatten());
                        let centre = Run { triangle, pixel, count: 1, position, times: 1 };
                        self.objects_of(&centre, &seen, &pattern, &mut runs)
                    })
                    .collect()
            }
        };
        let Runs(mut runs) = runs;
        runs.sort_unstable_by_key(|run| (run.triangle.unwrap_or(u32::MAX), run.position));
        (runs, counts)
    }

    /// A sample for each object of a pixel; returns how many samples they are.
    fn objects_of(
        &self,
        centre: &Run,
        seen: &[Option<u32>; PATTERN.len()],
        pattern: &[[i32; 2]; PATTERN.len()],
        runs: &mut Runs,
    ) -> u32 {
        let object = |triangle: Option<u32>| triangle.map(|triangle| self.object_index(triangle));
        if seen.iter().all(|triangle| *triangle == centre.triangle) {
            runs.push(*centre);
            return 1;
        }
        let own = object(centre.triangle);
        let objects = seen.map(object);
        if objects.iter().all(|object| *object == own) {
            runs.push(*centre);
            return 1;
        }
        for (index, object) in objects.iter().enumerate() {
            if objects[..index].contains(object) {
                continue;
            }
            let times = objects[index..].iter().filter(|other| *other == object).count() as u32;
            let [x, y] = [0, 1].map(|axis| centre.position[axis] - PIXEL_CENTRE_SUBPX[axis] + pattern[index][axis]);
            let nearest = Run { position: [x, y], triangle: seen[index], ..*centre };
            runs.push(Run { times, ..if *object == own { *centre } else { nearest } });
        }
        PATTERN.len() as u32
    }
}

/// A place of a pixel of a tile, in sub-pixels from the corner of the frame.
fn position_of(tile: TileRect, [column, row]: [u32; 2], offset: [i32; 2]) -> [i32; 2] {
    [(tile.x + column) as i32 * SUBPIXELS + offset[0], (tile.y + row) as i32 * SUBPIXELS + offset[1]]
}
