//! The tiles of a frame: visibility at each sample, and the mean of a pixel's samples.

use std::ops::Range;

use rayon::prelude::*;
use roughxel_core::datapath::pixel::{self, PixelSum};
use roughxel_core::fx::Fx;
use roughxel_scene::Background;
use roughxel_shader::{Channel, Fragments, Material, PhaseClock, PhaseTimes, Place, Shader, Sums, Work};
use roughxel_simd::LANES;

use super::Colour;
use super::colour::colour_word;
use super::frame::Frame;
use super::prepare::{Prepared, PreparedObject};
use crate::raster::{
    Pass, Positions, RasterError, SUBPIXELS, Sample, Sampling, TileRect, TileSamples, TriangleList, tile_rows, tiles,
};

/// Cost of drawing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counted {
    /// Texels that were read; each map and level counts separately.
    pub texels: u64,
    /// Time of each phase.
    pub times: PhaseTimes,
}

impl Counted {
    /// Sum of two costs.
    fn with(mut self, other: Self) -> Self {
        self.texels += other.texels;
        self.times.add(&other.times);
        self
    }
}

/// Use of the samples of a tile.
pub(super) trait Shading {
    /// Takes the waiting fragments of an object and leaves none.
    fn shade(&mut self, shader: Shader<'_>, material: &Material, fragments: &mut Fragments);
    /// Takes a colour that no fragment makes.
    fn add(&mut self, place: Place, colour: [Channel; 3]);
}

/// Light of the pixels of a tile, and the batches in which it is made.
struct Light {
    sums: Sums,
    work: Work,
}

impl Shading for Light {
    fn shade(&mut self, shader: Shader<'_>, material: &Material, fragments: &mut Fragments) {
        shader.shade(material, fragments, &mut self.work, &mut self.sums);
    }

    fn add(&mut self, place: Place, colour: [Channel; 3]) {
        self.sums.add(place, colour);
    }
}

impl Prepared<'_> {
    /// Draws the frame. `progress` is called once for each of [`Self::work`] pieces, from any thread.
    pub fn render(&self, progress: &(dyn Fn() + Sync)) -> Result<Frame, RasterError> {
        Ok(self.render_counted(progress)?.0)
    }

    /// Same as [`Self::render`], with its cost.
    pub fn render_counted(&self, progress: &(dyn Fn() + Sync)) -> Result<(Frame, Counted), RasterError> {
        let (width, height) = (self.projection.width(), self.projection.height());
        let clock = PhaseClock::start();
        let triangles = TriangleList::new(&self.projection, &self.scene.objects)?.with_backend(self.backend);
        let set_up = Counted { texels: 0, times: clock.stop() };
        let mut pixels = vec![[0; 3]; width as usize * height as usize];
        // Each tile is written to its own rows of the frame as soon as it is shaded. No second copy exists, and no thread waits.
        let passes = self.sampling().passes();
        let counted = tile_rows(&mut pixels, width, height)
            .into_par_iter()
            .map_init(TileSamples::default, |samples, (tile, rows)| {
                let (colours, counted) = self.shade_tile(&triangles, tile, &passes, samples);
                for (row, line) in rows.into_iter().zip(colours.chunks(tile.width as usize)) {
                    row.copy_from_slice(line);
                }
                progress();
                counted
            })
            .reduce(Counted::default, Counted::with);
        Ok((Frame { width, height, pixels }, counted.with(set_up)))
    }

    /// Number of progress steps of [`Self::render`].
    pub fn work(&self) -> u64 {
        tiles(self.projection.width(), self.projection.height()).count() as u64
    }

    /// Choice of the shaded samples of a pixel: its centre, a grid, or one of every visible object.
    pub(super) fn sampling(&self) -> Sampling {
        if self.objects.iter().any(|object| object.material.plan.edges) {
            Sampling::Objects
        } else {
            Sampling::Grid { edge: self.mode.samples_edge() }
        }
    }

    /// The colours of a tile, and their cost.
    fn shade_tile(
        &self,
        triangles: &TriangleList<'_>,
        tile: TileRect,
        passes: &[Pass],
        samples: &mut TileSamples,
    ) -> (Vec<Colour>, Counted) {
        let pixels = tile.width as usize * tile.height as usize;
        let mut light = Light { sums: Sums::new(pixels), work: Work::default() };
        let counts = self.walk_tile(triangles, tile, passes, samples, &mut light);
        // The datapath is compared by samples, and edges belong to the front end: the mean of samples, to nearest, is not a
        // stage.
        let mean = |sum: PixelSum<i32>, count: u32| match i64::from(count) {
            1 => sum,
            count => PixelSum::<i32> { sum: Fx::from_raw((sum.sum.raw() + count / 2) / count) },
        };
        let sums = light.sums;
        let colours = sums.pixels.into_iter().zip(counts);
        let colours = colours.map(|(sums, count)| sums.map(|sum| pixel::pixel(&mean(sum, count)).raw()));
        let colours = colours.collect();
        (colours, Counted { texels: 4 * sums.samples, times: sums.clock.stop() })
    }

    /// Hands the shaded samples of a tile to `shading`, and returns the sample count of each pixel.
    pub(super) fn walk_tile(
        &self,
        triangles: &TriangleList<'_>,
        tile: TileRect,
        passes: &[Pass],
        samples: &mut TileSamples,
        shading: &mut impl Shading,
    ) -> Vec<u32> {
        let mut counts = Vec::new();
        for pass in passes {
            triangles.samples(tile, pass, samples);
            counts.resize(samples.counts().len(), 0);
            let mut spans = samples.spans().peekable();
            while let Some((triangle, span)) = spans.peek() {
                let Some(triangle) = *triangle else {
                    self.walk_background(samples, span.clone(), shading);
                    break;
                };
                let object = triangles.object_index(triangle);
                let of_object = std::iter::from_fn(|| {
                    spans.next_if(|(triangle, _)| {
                        triangle.is_some_and(|triangle| triangles.object_index(triangle) == object)
                    })
                });
                self.walk_object(&self.objects[object], triangles, (samples, of_object), shading);
            }
            counts.iter_mut().zip(samples.counts()).for_each(|(sum, count)| *sum += count);
        }
        counts
    }

    /// Hands the samples of an object to `shading`, triangle by triangle.
    fn walk_object(
        &self,
        object: &PreparedObject,
        triangles: &TriangleList<'_>,
        (tile, spans): (&TileSamples, impl Iterator<Item = (Option<u32>, Range<usize>)>),
        shading: &mut impl Shading,
    ) {
        let PreparedObject { material, light_points, .. } = object;
        let (shader, needs) = (self.shader(), material.needs());
        let mut fragments = Fragments::new(material);
        let mut rows = fragments.rows();
        for (triangle, span) in spans {
            let triangle = triangle.and_then(|index| triangles.triangle(index, needs));
            let Some(triangle) = triangle else { continue };
            let shown = light_points.iter().filter(|_| material.lighting.is_some());
            let points: Vec<_> = shown.map(|&point| triangle.point(point)).collect();
            let derivatives = triangle.derivatives();
            for (group, count) in tile.groups(span) {
                let (places, positions) = &self.backend.run(
                    #[inline(always)]
                    || {
                        let (places, positions) = places(tile, group);
                        triangle.fragments(&positions, &mut rows);
                        (places, positions)
                    },
                );
                let places = &places[..count];
                fragments.append(places, &rows, &derivatives);
                if !points.is_empty() {
                    for lane in 0..places.len() {
                        let [x, y] = positions.map(|row| row[lane]);
                        fragments.append_directions(points.iter().map(|point| triangle.direction_to(point, x, y)));
                    }
                }
                if fragments.len() + LANES > Fragments::MANY {
                    shading.shade(shader, material, &mut fragments);
                }
            }
        }
        shading.shade(shader, material, &mut fragments);
    }

    /// Hands the samples that show no triangle to `shading`.
    fn walk_background(&self, tile: &TileSamples, span: Range<usize>, shading: &mut impl Shading) {
        if matches!(self.scene.background, Background::Environment) && self.environment.is_some() {
            let (mut rays, derivatives) = (Fragments::new(&self.mirror), self.projection.mirror_derivatives());
            let mut rows = rays.rows();
            for (group, count) in tile.groups(span) {
                let places = self.backend.run(
                    #[inline(always)]
                    || {
                        let (places, positions) = places(tile, group);
                        self.projection.mirror_rays(&positions, &mut rows);
                        places
                    },
                );
                rays.append(&places[..count], &rows, &derivatives);
                if rays.len() + LANES > Fragments::MANY {
                    shading.shade(self.shader(), &self.mirror, &mut rays);
                }
            }
            return shading.shade(self.shader(), &self.mirror, &mut rays);
        }
        let colours: Vec<_> = tile.lines().map(|y| self.background(y)).collect();
        for &sample in tile.span(span) {
            shading.add(Place { pixel: tile.pixel(sample), times: tile.times(sample) }, colours[tile.line(sample)]);
        }
    }

    /// The colour of a sample in sub-pixel row `y` that shows neither an object nor an environment.
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

/// Pixels, counts and positions of a lane group of samples.
#[inline(always)]
fn places(tile: &TileSamples, group: &[Sample; LANES]) -> ([Place; LANES], Positions) {
    let mut places = [Place::default(); LANES];
    let mut positions = [[0; LANES]; 2];
    for (lane, &sample) in group.iter().enumerate() {
        places[lane] = Place { pixel: tile.pixel(sample), times: tile.times(sample) };
        [positions[0][lane], positions[1][lane]] = tile.position(sample);
    }
    (places, positions)
}
