//! Coverage: the samples of a tile that are shaded, and the weight of each in its pixel.
//!
//! A filter looks at the neighbourhood of a sample on *one* surface. Several surfaces in a pixel have to be separated first.
//! Visibility is therefore tested at [`PATTERN`] and at the centre, and every visible object is shaded once: at the centre if it
//! is visible there, else at the nearest of its samples. That colour counts for all of them. A pixel that shows one object alone
//! is shaded at its centre.

use std::ops::Range;

use roughxel_simd::LANES;

use super::edges::{Places, TileBuffer};
use super::setup::{Drawn, TriangleList};
use super::{PIXEL_CENTRE_SUBPX, SUBPIXELS, TILE_EDGE_PX, TileRect};

/// Positions of the visibility samples, in sixteenths of a pixel from the centre, the nearest first. No two of the eight are in
/// one row or column of eighths, so an edge near the horizontal or the vertical has nine steps.
const PATTERN: [[i32; 2]; 8] = [[1, -3], [-1, 3], [5, 1], [-3, -5], [-5, 5], [-7, -1], [3, 7], [7, -7]];

/// Choice of the samples of a pixel that are shaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// Each sample of a regular grid; 1 is the centre alone.
    Grid {
        /// Samples along each edge of the pixel.
        edge: u32,
    },
    /// One sample for every object that is visible in the pixel.
    Objects,
}

/// Bits of a position in a tile, sub-pixels along an axis.
const PLACE_BITS: u32 = 14;

const _: () = assert!(TILE_EDGE_PX as i32 * SUBPIXELS <= 1 << PLACE_BITS, "a sample holds its position in the tile");
const _: () = assert!(PATTERN.len() < 1 << (u32::BITS - 2 * PLACE_BITS), "a sample holds its count");

/// Most positions of a pixel that one pass tests: the visibility of a tile at them stays in a second-level cache.
const PLACES_TOGETHER: usize = 16;

/// Positions of a pixel whose samples are found together.
#[derive(Clone, Debug)]
pub struct Pass {
    places: Vec<[i32; 2]>,
    /// True for one sample for every object visible at the positions, false for each of them.
    objects: bool,
}

impl Sampling {
    /// The passes that find all samples of a tile, in order.
    pub fn passes(self) -> Vec<Pass> {
        match self {
            Self::Grid { edge } => {
                let steps = edge as i32;
                let place = |i: i32| (2 * i + 1) * SUBPIXELS / (2 * steps);
                let places: Vec<_> = (0..steps * steps).map(|i| [place(i % steps), place(i / steps)]).collect();
                let pass = |places: &[[i32; 2]]| Pass { places: places.to_vec(), objects: false };
                places.chunks(PLACES_TOGETHER).map(pass).collect()
            }
            Self::Objects => {
                let pattern = PATTERN.map(|place| place.map(|sixteenths| (8 + sixteenths) * (SUBPIXELS / 16)));
                vec![Pass { places: pattern.into_iter().chain([PIXEL_CENTRE_SUBPX]).collect(), objects: true }]
            }
        }
    }
}

/// A shaded sample of a tile: its position in sub-pixels to the right of and below the corner of the tile, and the number of
/// times its colour counts, 1 to 15. It is one word, because many are sorted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sample(u32);

impl Sample {
    /// A sample that counts once, at a position in a pixel of the tile.
    #[inline(always)]
    fn new([column, row]: [u32; 2], [x, y]: [i32; 2]) -> Self {
        let [right, down] = [(column, x), (row, y)].map(|(pixel, at)| pixel * SUBPIXELS as u32 + at as u32);
        Self(right | (down << PLACE_BITS) | (1 << (2 * PLACE_BITS)))
    }

    /// The sample with a count of `times`.
    #[inline(always)]
    fn counted(self, times: u32) -> Self {
        Self((self.0 % (1 << (2 * PLACE_BITS))) | (times << (2 * PLACE_BITS)))
    }

    #[inline(always)]
    fn place_in_tile(self) -> [u32; 2] {
        [self.0, self.0 >> PLACE_BITS].map(|place| place % (1 << PLACE_BITS))
    }
}

/// The shaded samples of a tile. Their memory is reused from tile to tile.
#[derive(Clone, Debug, Default)]
pub struct TileSamples {
    tile: TileRect,
    places: Vec<[i32; 2]>,
    /// The position in each row of sub-pixels that has one.
    place_of_row: Vec<u8>,
    drawn: Drawn,
    centres: TileBuffer,
    around: TileBuffer,
    /// Samples pixel by pixel, each with the number of its triangle in the tile.
    found: Vec<(u32, Sample)>,
    /// Samples by triangle. Those that show no triangle are the last, followed by padding of one lane group.
    samples: Vec<Sample>,
    /// End of the samples of each triangle.
    ends: Vec<usize>,
    /// Number of samples of each pixel, where a sample counts `times` times: its contribution to the divisor of the pixel's
    /// colour sum.
    counts: Vec<u32>,
}

impl TileSamples {
    /// The samples of each triangle in turn, followed by those that show none.
    pub fn by_triangle(&self) -> impl Iterator<Item = (Option<u32>, &[Sample])> {
        self.spans().map(|(triangle, span)| (triangle, self.span(span)))
    }

    /// Triangles as in [`Self::by_triangle`], with spans of all samples.
    pub fn spans(&self) -> impl Iterator<Item = (Option<u32>, Range<usize>)> {
        let begins = std::iter::once(&0).chain(&self.ends);
        let numbers = self.drawn.triangles.iter().copied().map(Some).chain([None]);
        let spans = begins.zip(&self.ends).map(|(&begin, &end)| begin..end);
        numbers.zip(spans).filter(|(_, span)| !span.is_empty())
    }

    /// The samples of a span.
    pub fn span(&self, span: Range<usize>) -> &[Sample] {
        &self.samples[span]
    }

    /// The samples of a span, [`LANES`] at a time, with the number of lanes in use. Unused lanes hold arbitrary samples.
    #[inline(always)]
    pub fn groups(&self, span: Range<usize>) -> impl Iterator<Item = (&[Sample; LANES], usize)> {
        let end = span.end;
        span.step_by(LANES).map(move |first| (&self.samples[first..].as_chunks().0[0], LANES.min(end - first)))
    }

    /// Number of samples of each pixel, row by row; a sample counts [`Self::times`] times. The sum over all passes is the divisor
    /// of the pixel's colour sum.
    pub fn counts(&self) -> &[u32] {
        &self.counts
    }

    /// Sub-pixels from the top of the frame to each line of samples: the lines of the first pixel row, position by position,
    /// followed by those of the next row.
    pub fn lines(&self) -> impl Iterator<Item = i32> {
        let rows = self.tile.y..self.tile.y + self.tile.height;
        rows.flat_map(|row| self.places.iter().map(move |place| row as i32 * SUBPIXELS + place[1]))
    }

    /// Index of the line in [`Self::lines`] that a sample lies in.
    #[inline(always)]
    pub fn line(&self, sample: Sample) -> usize {
        let [_, y] = sample.place_in_tile().map(|place| place as usize);
        y / SUBPIXELS as usize * self.places.len() + usize::from(self.place_of_row[y % SUBPIXELS as usize])
    }

    /// The pixel of a sample in the tile, row by row.
    #[inline(always)]
    pub fn pixel(&self, sample: Sample) -> u32 {
        let [column, row] = sample.place_in_tile().map(|subpixels| subpixels / SUBPIXELS as u32);
        row * self.tile.width + column
    }

    /// Number of times its colour counts.
    #[inline(always)]
    pub fn times(&self, sample: Sample) -> u32 {
        sample.0 >> (2 * PLACE_BITS)
    }

    /// Position of the sample, in sub-pixels from the corner of the frame.
    #[inline(always)]
    pub fn position(&self, sample: Sample) -> [i32; 2] {
        let [x, y] = sample.place_in_tile();
        [self.tile.x as i32 * SUBPIXELS + x as i32, self.tile.y as i32 * SUBPIXELS + y as i32]
    }

    /// Sorts the samples by triangle; samples of one triangle stay in order.
    fn sort(&mut self) {
        let Self { drawn, found, samples, ends, .. } = self;
        let none = drawn.triangles.len();
        ends.clear();
        ends.resize(none + 1, 0);
        for same in found.chunk_by(|a, b| a.0 == b.0) {
            ends[(same[0].0 as usize).min(none)] += same.len();
        }
        // Begins of the triangles, which become their ends.
        let mut begin = 0;
        for end in ends.iter_mut() {
            begin += std::mem::replace(end, begin);
        }
        samples.resize(found.len() + LANES, Sample::default());
        for same in found.chunk_by(|a, b| a.0 == b.0) {
            let next = &mut ends[(same[0].0 as usize).min(none)];
            let places = &mut samples[*next..][..same.len()];
            places.iter_mut().zip(same).for_each(|(place, (_, sample))| *place = *sample);
            *next += same.len();
        }
    }
}

impl TriangleList<'_> {
    /// Replaces `samples` by the shaded samples of a pass in a tile of [`tiles`](super::tiles).
    pub fn samples(&self, tile: TileRect, pass: &Pass, samples: &mut TileSamples) {
        let pixels = tile.width as usize * tile.height as usize;
        samples.tile = tile;
        samples.places.clone_from(&pass.places);
        samples.place_of_row.resize(SUBPIXELS as usize, 0);
        for (place, &[_, y]) in (0..).zip(&pass.places) {
            samples.place_of_row[y as usize] = place;
        }
        samples.found.clear();
        samples.counts.clear();
        self.drawn(tile, &mut samples.drawn);
        if pass.objects {
            self.objects(samples);
        } else {
            samples.counts.resize(pixels, pass.places.len() as u32);
            self.draw(&samples.drawn, &Places::new(&pass.places), tile, &mut samples.centres);
            for row in 0..tile.height {
                for (column, shown) in (0..).zip(samples.centres.shown(row as usize)) {
                    let found = shown.iter().zip(&pass.places);
                    samples.found.extend(found.map(|(&number, &at)| (number, Sample::new([column, row], at))));
                }
            }
        }
        samples.sort();
    }

    /// Finds the samples of objects; the last position is the centre.
    fn objects(&self, samples: &mut TileSamples) {
        let TileSamples { tile, places, drawn, centres, around, found, counts, .. } = samples;
        let (centre, pattern) = places.split_last().unwrap_or_else(|| unreachable!("the last position is the centre"));
        self.draw(drawn, &Places::new(&[*centre]), *tile, centres);
        self.draw(drawn, &Places::new(pattern), *tile, around);
        let object = |number: u32| drawn.triangles.get(number as usize).map(|&triangle| self.object_index(triangle));
        for row in 0..tile.height {
            let shown = centres.shown(row as usize).zip(around.shown(row as usize));
            for (column, (own, seen)) in (0..).zip(shown) {
                let at_centre = (own[0], Sample::new([column, row], *centre));
                let alone = seen.iter().fold(0, |differs, &number| differs | (number ^ own[0])) == 0;
                let own = object(own[0]);
                if alone || seen.iter().all(|&number| object(number) == own) {
                    found.push(at_centre);
                    counts.push(1);
                    continue;
                }
                counts.push(seen.len() as u32);
                for (place, (&number, &at)) in seen.iter().zip(pattern).enumerate() {
                    let shown = object(number);
                    if seen[..place].iter().any(|&other| object(other) == shown) {
                        continue;
                    }
                    let times = seen.iter().filter(|&&other| object(other) == shown).count() as u32;
                    let nearest = (number, Sample::new([column, row], at));
                    let (number, sample) = if shown == own { at_centre } else { nearest };
                    found.push((number, sample.counted(times)));
                }
            }
        }
    }
}
