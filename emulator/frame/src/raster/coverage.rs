//! Coverage: which samples of a tile are shaded, and how much each counts in its pixel.
//!
//! A filter looks at what lies around a sample on *one* surface; where several meet in a pixel, they have to be told apart first. So what is
//! visible is asked for at [`PATTERN`] and at the centre, and every object that is seen is shaded once: at the centre if it is seen there, else at the
//! nearest of its samples, for all of them. A pixel that shows one object alone is shaded at its centre, as if nobody had asked.

use super::edges::{Places, TileBuffer};
use super::setup::{Drawn, TriangleList};
use super::{PIXEL_CENTRE_SUBPX, SUBPIXELS, TILE_EDGE_PX, TileRect};

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

const _: () = assert!(TILE_EDGE_PX <= 1 << u8::BITS, "a sample knows its column and row");

/// Most places of a pixel that are looked at together: what a tile has of them stays in a second-level cache.
const PLACES_TOGETHER: usize = 16;

/// Places of a pixel whose samples are found together.
#[derive(Clone, Debug)]
pub struct Pass {
    places: Vec<[i32; 2]>,
    /// One sample for every object that is visible at them, or each of them.
    objects: bool,
}

impl Sampling {
    /// What has to be looked at for all samples of a tile, a part after the other.
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

/// A sample of a tile that is shaded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sample {
    /// Of its pixel in the tile.
    column: u8,
    row: u8,
    /// Of the pass.
    place: u8,
    /// How often its colour counts.
    times: u8,
}

/// The samples of a tile that are shaded; the memory is kept from tile to tile.
#[derive(Clone, Debug, Default)]
pub struct TileSamples {
    tile: TileRect,
    places: Vec<[i32; 2]>,
    drawn: Drawn,
    centres: TileBuffer,
    around: TileBuffer,
    /// Pixel by pixel, each with the number of its triangle in the tile.
    found: Vec<(u32, Sample)>,
    /// By triangle; those that show none are the last.
    samples: Vec<Sample>,
    /// Where those of each triangle end.
    ends: Vec<usize>,
    /// How many samples each pixel has, those counted `times` over: what they add to what the sum of its colours is divided by.
    counts: Vec<u32>,
}

impl TileSamples {
    /// The samples of each triangle in turn, then those that show none.
    pub fn by_triangle(&self) -> impl Iterator<Item = (Option<u32>, &[Sample])> {
        let begins = std::iter::once(&0).chain(&self.ends);
        let numbers = self.drawn.triangles.iter().copied().map(Some).chain([None]);
        numbers
            .zip(begins.zip(&self.ends))
            .filter(|(_, (begin, end))| begin < end)
            .map(|(triangle, (&begin, &end))| (triangle, &self.samples[begin..end]))
    }

    /// How many samples each pixel has, row by row, those counted over that count more than once: the sum over all passes is what the sum of a pixel's
    /// colours is divided by.
    pub fn counts(&self) -> &[u32] {
        &self.counts
    }

    /// Sub-pixels from the top of the frame to each line of samples: those of the first row of pixels place by place, then of the next.
    pub fn lines(&self) -> impl Iterator<Item = i32> {
        let rows = self.tile.y..self.tile.y + self.tile.height;
        rows.flat_map(|row| self.places.iter().map(move |place| row as i32 * SUBPIXELS + place[1]))
    }

    /// Which of [`Self::lines`] a sample lies in.
    #[inline(always)]
    pub fn line(&self, sample: Sample) -> usize {
        usize::from(sample.row) * self.places.len() + usize::from(sample.place)
    }

    /// The pixel of a sample in the tile, row by row.
    #[inline(always)]
    pub fn pixel(&self, sample: Sample) -> usize {
        usize::from(sample.row) * self.tile.width as usize + usize::from(sample.column)
    }

    /// How often its colour counts.
    #[inline(always)]
    pub fn times(&self, sample: Sample) -> u32 {
        sample.times.into()
    }

    /// Where it is, in sub-pixels from the corner of the frame.
    #[inline(always)]
    pub fn position(&self, sample: Sample) -> [i32; 2] {
        let Sample { column, row, place, .. } = sample;
        let [x, y] = self.places[usize::from(place)];
        let [left, top] = [self.tile.x + u32::from(column), self.tile.y + u32::from(row)].map(|pixel| pixel as i32);
        [left * SUBPIXELS + x, top * SUBPIXELS + y]
    }

    /// Sorts what was found by triangle, in the order in which it was found.
    fn sort(&mut self) {
        let Self { drawn, found, samples, ends, .. } = self;
        let none = drawn.triangles.len();
        ends.clear();
        ends.resize(none + 1, 0);
        for same in found.chunk_by(|a, b| a.0 == b.0) {
            ends[(same[0].0 as usize).min(none)] += same.len();
        }
        // Where each begins, which becomes where it ends.
        let mut begin = 0;
        for end in ends.iter_mut() {
            begin += std::mem::replace(end, begin);
        }
        samples.resize(found.len(), Sample::default());
        for same in found.chunk_by(|a, b| a.0 == b.0) {
            let next = &mut ends[(same[0].0 as usize).min(none)];
            let places = &mut samples[*next..][..same.len()];
            places.iter_mut().zip(same).for_each(|(place, (_, sample))| *place = *sample);
            *next += same.len();
        }
    }
}

impl TriangleList<'_> {
    /// The samples of a pass in a tile of [`tiles`](super::tiles) that are shaded, in place of those that there were.
    pub fn samples(&self, tile: TileRect, pass: &Pass, samples: &mut TileSamples) {
        let pixels = tile.width as usize * tile.height as usize;
        samples.tile = tile;
        samples.places.clone_from(&pass.places);
        samples.found.clear();
        samples.counts.clear();
        self.drawn(tile, &mut samples.drawn);
        if pass.objects {
            self.objects(samples);
        } else {
            samples.counts.resize(pixels, pass.places.len() as u32);
            self.draw(&samples.drawn, &Places::new(&pass.places), tile, &mut samples.centres);
            for row in 0..tile.height as u8 {
                for (column, shown) in (0..).zip(samples.centres.shown(row.into())) {
                    let sample = |place: u8| Sample { column, row, place, times: 1 };
                    samples.found.extend((0..).zip(shown).map(|(place, &number)| (number, sample(place))));
                }
            }
        }
        samples.sort();
    }

    /// The samples of objects: the last place is the centre.
    fn objects(&self, samples: &mut TileSamples) {
        let TileSamples { tile, places, drawn, centres, around, found, counts, .. } = samples;
        let (centre, pattern) = places.split_last().unwrap_or_else(|| unreachable!("there is a centre"));
        self.draw(drawn, &Places::new(&[*centre]), *tile, centres);
        self.draw(drawn, &Places::new(pattern), *tile, around);
        let object = |number: u32| drawn.triangles.get(number as usize).map(|&triangle| self.object_index(triangle));
        for row in 0..tile.height as u8 {
            for (column, (centre, seen)) in (0..).zip(centres.shown(row.into()).zip(around.shown(row.into()))) {
                let (centre, place) = (centre[0], pattern.len() as u8);
                let at_centre = (centre, Sample { column, row, place, times: 1 });
                let alone = seen.iter().fold(0, |differs, &number| differs | (number ^ centre)) == 0;
                let own = object(centre);
                if alone || seen.iter().all(|&number| object(number) == own) {
                    found.push(at_centre);
                    counts.push(1);
                    continue;
                }
                counts.push(seen.len() as u32);
                for (place, &number) in (0..).zip(seen) {
                    let shown = object(number);
                    if seen[..usize::from(place)].iter().any(|&other| object(other) == shown) {
                        continue;
                    }
                    let times = seen.iter().filter(|&&other| object(other) == shown).count() as u8;
                    let nearest = (number, Sample { column, row, place, times });
                    let centre = (centre, Sample { times, ..at_centre.1 });
                    found.push(if shown == own { centre } else { nearest });
                }
            }
        }
    }
}
