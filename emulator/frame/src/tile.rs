//! The tiles of a frame: what is visible at each sample, and the mean of a pixel's samples.

use rayon::prelude::*;
use roughxel_core::datapath::pixel::{self, PixelSum};
use roughxel_core::fx::Fx;
use roughxel_scene::Background;

use super::Colour;
use super::batch::{Batch, Fragments, Place, SHADED, Sums};
use super::colour::{Channel, colour_word};
use super::frame::Frame;
use super::phases::PhaseTimes;
use super::prepare::{Prepared, PreparedObject};
use crate::raster::{
    AttributeRows, Positions, RasterError, Run, SIDE, SUBPIXELS, Sampling, TileRect, TriangleList, tile_rows, tiles,
};

/// What drawing took.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counted {
    /// Texels that were read, those of each map and level by themselves.
    pub texels: u64,
    /// Where the time went.
    pub times: PhaseTimes,
}

impl Counted {
    /// Both together.
    fn with(mut self, other: Self) -> Self {
        self.texels += other.texels;
        self.times.add(&other.times);
        self
    }
}

impl Prepared<'_> {
    /// Draws the frame. `progress` is called once for each of [`Self::work`] pieces, from any thread.
    pub fn render(&self, progress: &(dyn Fn() + Sync)) -> Result<Frame, RasterError> {
        Ok(self.render_counted(progress)?.0)
    }

    /// The same with what it took.
    pub fn render_counted(&self, progress: &(dyn Fn() + Sync)) -> Result<(Frame, Counted), RasterError> {
        let (width, height) = (self.projection.width(), self.projection.height());
        let triangles = TriangleList::new(&self.projection, &self.scene.objects)?;
        let mut pixels = vec![[0; 3]; width as usize * height as usize];
        // Each tile goes to its own rows of the one frame as soon as it is shaded: there is no second copy, and nobody waits.
        let counted = tile_rows(&mut pixels, width, height)
            .into_par_iter()
            .map(|(tile, rows)| {
                let (colours, counted) = self.shade_tile(&triangles, tile);
                for (row, line) in rows.into_iter().zip(colours.chunks(tile.width as usize)) {
                    row.copy_from_slice(line);
                }
                progress();
                counted
            })
            .reduce(Counted::default, Counted::with);
        Ok((Frame { width, height, pixels }, counted))
    }

    /// Number of progress steps of [`Self::render`].
    pub fn work(&self) -> u64 {
        tiles(self.projection.width(), self.projection.height()).count() as u64
    }

    /// Which samples of a pixel are shaded: its centre, a grid, or one of every object that is visible in it.
    fn sampling(&self) -> Sampling {
        if self.objects.iter().any(|object| object.plan.edges) {
            Sampling::Objects
        } else {
            Sampling::Grid { edge: self.mode.samples_edge() }
        }
    }

    /// The colours of a tile, and what they took.
    fn shade_tile(&self, triangles: &TriangleList<'_>, tile: TileRect) -> (Vec<Colour>, Counted) {
        let mut sums = Sums::new(tile.width as usize * tile.height as usize);
        let mut batch = Batch::default();
        let (runs, counts) = triangles.samples(tile, self.sampling());
        let object_of = |run: &Run| run.triangle.map(|triangle| triangles.object_index(triangle));
        for runs in runs.chunk_by(|a, b| a.triangle == b.triangle || object_of(a) == object_of(b)) {
            match object_of(&runs[0]) {
                None => self.shade_background(runs, &mut batch, &mut sums),
                Some(object) => self.shade_object(&self.objects[object], triangles, runs, &mut batch, &mut sums),
            }
        }
        // Samples are what the datapath is compared with, and edges are the front end's: their mean, to nearest, is no stage.
        let mean = |sum: PixelSum<i32>, count: u32| {
            let count = i64::from(count);
            PixelSum::<i32> { sum: Fx::from_raw((sum.sum.raw() + count / 2) / count) }
        };
        let colours = sums.pixels.into_iter().zip(counts);
        let colours = colours.map(|(sums, count)| sums.map(|sum| pixel::pixel(&mean(sum, count)).raw()));
        let colours = colours.collect();
        (colours, Counted { texels: 4 * sums.taps, times: sums.clock.stop() })
    }

    /// The samples of an object.
    fn shade_object(
        &self,
        object: &PreparedObject,
        triangles: &TriangleList<'_>,
        runs: &[Run],
        batch: &mut Batch,
        sums: &mut Sums,
    ) {
        let mut fragments = Fragments::of(object);
        for runs in runs.chunk_by(|a, b| a.triangle == b.triangle) {
            let triangle = runs[0].triangle.and_then(|index| triangles.triangle(index, object.needs()));
            let Some(triangle) = triangle else { continue };
            let points = object.lighting.as_ref().map(|lighting| lighting.points(&triangle)).unwrap_or_default();
            let derivatives = triangle.derivative_rows();
            for_each_side(runs, |places, positions| {
                let mut rows = AttributeRows::default();
                self.reading.run(
                    #[inline(always)]
                    || triangle.fragments(positions, &mut rows),
                );
                fragments.append(places, &rows, &derivatives);
                if let Some(lighting) = &object.lighting {
                    for lane in 0..places.len() {
                        let position = positions.map(|row| row[lane]);
                        lighting.directions(&triangle, &points, position, &mut fragments.directions);
                    }
                }
                if fragments.len() + SIDE > SHADED {
                    self.shade(object, &mut fragments, batch, sums);
                }
            });
        }
        self.shade(object, &mut fragments, batch, sums);
    }

    /// The samples that show nothing.
    fn shade_background(&self, runs: &[Run], batch: &mut Batch, sums: &mut Sums) {
        if matches!(self.scene.background, Background::Environment) && self.environment.is_some() {
            let (mut rays, derivatives) = (Fragments::rays(), self.projection.mirror_derivatives());
            for_each_side(runs, |places, positions| {
                let mut rows = AttributeRows::default();
                self.reading.run(
                    #[inline(always)]
                    || self.projection.mirror_rays(positions, &mut rows),
                );
                rays.append(places, &rows, &derivatives);
                if rays.len() + SIDE > SHADED {
                    self.shade_rays(&mut rays, batch, sums);
                }
            });
            return self.shade_rays(&mut rays, batch, sums);
        }
        for run in runs {
            for (pixel, [_, y]) in run.samples() {
                sums.add(Place { pixel, times: run.times }, self.background(y));
            }
        }
    }

    /// The colour of a sample in row `y` sub-pixels that shows neither an object nor an environment.
    fn background(&self, y: i32) -> [Channel; 3] {
        match &self.scene.background {
            Background::Colour(colour) => colour_word(*colour),
            Background::Ramp { top, bottom } => {
                let down = y as f32 / (self.projection.height() as i32 * SUBPIXELS) as f32;
                colour_word(core::array::from_fn(|i| top[i] + (bottom[i] - top[i]) * down))
            }
            Background::Environment => [Fx::zero(); 3],
        }
    }
}

/// Hands the samples of runs to `take`, [`SIDE`] at a time: their places and positions; behind the last one, the last again.
fn for_each_side(runs: &[Run], mut take: impl FnMut(&[Place], &Positions)) {
    let mut places = [Place { pixel: 0, times: 0 }; SIDE];
    let mut positions = [[0; SIDE]; 2];
    let mut count = 0;
    for run in runs {
        for (pixel, [x, y]) in run.samples() {
            places[count] = Place { pixel, times: run.times };
            (positions[0][count], positions[1][count]) = (x, y);
            count += 1;
            if count == SIDE {
                take(&places, &positions);
                count = 0;
            }
        }
    }
    if count > 0 {
        for row in &mut positions {
            let last = row[count - 1];
            row[count..].fill(last);
        }
        take(&places[..count], &positions);
    }
}
