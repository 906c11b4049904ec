//! The tiles of a frame: what is visible at each sample, and the mean of a pixel's samples.

use rayon::prelude::*;
use roughxel_core::datapath::pixel::{self, PixelSum};
use roughxel_core::fx::Fx;
use roughxel_core::ports::BlockVector;
use roughxel_scene::Background;

use super::Colour;
use super::batch::{Batch, Fragments, Place, SHADED, Sums};
use super::colour::{Channel, colour_word};
use super::frame::Frame;
use super::lighting::Points;
use super::phases::PhaseTimes;
use super::prepare::Prepared;
use crate::raster::{
    FragmentAttributes, RasterError, SUBPIXELS, Sample, Sampling, TileRect, Triangle, TriangleList, tiles,
};

/// What drawing took.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counted {
    /// Texels that were read, those of each map and level by themselves.
    pub texels: u64,
    /// Where the time went.
    pub times: PhaseTimes,
}

/// What a ray that hits nothing sees.
enum Ray {
    /// A colour.
    Colour([Channel; 3]),
    /// The environment, as this mirror reflects it.
    Reflection(FragmentAttributes),
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
        let shaded: Vec<(TileRect, Vec<Colour>, Counted)> = tiles(width, height)
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(|tile| {
                let (colours, counted) = self.shade_tile(&triangles, tile);
                progress();
                (tile, colours, counted)
            })
            .collect();
        let mut pixels = vec![[0; 3]; width as usize * height as usize];
        let mut counted = Counted::default();
        for (tile, colours, own) in shaded {
            counted.texels += own.texels;
            counted.times.add(&own.times);
            for (row, line) in (0..).zip(colours.chunks(tile.width as usize)) {
                let start = (tile.y + row) as usize * width as usize + tile.x as usize;
                pixels[start..start + line.len()].copy_from_slice(line);
            }
        }
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
        let mut fragments: Vec<Fragments> = self.objects.iter().map(Fragments::of).collect();
        let mut rays = Fragments::rays();
        let mut batch = Batch::default();
        let mut current: Option<(u32, Option<(Triangle<'_>, Points)>)> = None;
        let counts = triangles.samples(tile, self.sampling(), |sample| {
            let Sample { pixel, position: [x, y], triangle, times } = sample;
            let place = Place { pixel, times };
            let Some(index) = triangle else {
                match self.background(x, y) {
                    Ray::Colour(colour) => sums.add(place, colour),
                    Ray::Reflection(attributes) => {
                        rays.push(place, &attributes);
                        if rays.len() == SHADED {
                            self.shade_rays(&mut rays, &mut batch, &mut sums);
                        }
                    }
                }
                return;
            };
            let object = triangles.object_index(index);
            let prepared = &self.objects[object];
            if current.as_ref().is_none_or(|(held, _)| *held != index) {
                let triangle = triangles.triangle(index, prepared.needs());
                let set_up = triangle.map(|triangle| {
                    let points = prepared.lighting.as_ref().map(|lighting| lighting.points(&triangle));
                    (triangle, points.unwrap_or_default())
                });
                current = Some((index, set_up));
            }
            let Some((_, Some((triangle, points)))) = &current else { return };
            let fragments = &mut fragments[object];
            fragments.push(place, &triangle.fragment(x, y));
            if let Some(lighting) = &prepared.lighting {
                lighting.directions(triangle, points, [x, y], &mut fragments.directions);
            }
            if fragments.len() == SHADED {
                self.shade(prepared, fragments, &mut batch, &mut sums);
            }
        });
        for (object, fragments) in self.objects.iter().zip(&mut fragments) {
            self.shade(object, fragments, &mut batch, &mut sums);
        }
        self.shade_rays(&mut rays, &mut batch, &mut sums);
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

    /// What the ray through a pixel sees that hits nothing.
    fn background(&self, x: i32, y: i32) -> Ray {
        match (&self.scene.background, &self.environment) {
            (Background::Colour(colour), _) => Ray::Colour(colour_word(*colour)),
            (Background::Ramp { top, bottom }, _) => {
                let down = y as f32 / (self.projection.height() as i32 * SUBPIXELS) as f32;
                Ray::Colour(colour_word(core::array::from_fn(|i| top[i] + (bottom[i] - top[i]) * down)))
            }
            (Background::Environment, None) => Ray::Colour([Fx::zero(); 3]),
            (Background::Environment, Some(_)) => {
                // A mirror facing the ray from behind: r = 2d⟨d·d⟩ − d|d|² = d|d|², and a footprint as wide as the pixel's.
                let view = self.projection.ray_view(x, y);
                let ray = BlockVector { mantissa: view.mantissa.map(|m| -m), ..view };
                let dview = self.projection.dview();
                Ray::Reflection(FragmentAttributes { normal: ray, view: ray, dview, ..FragmentAttributes::default() })
            }
        }
    }
}
