//! # roughxel-reference-renderer
//!
//! Frames in float64: the truth for picture bounds, and the frame's own filter without any rounding.
//!
//! The scene, the visible triangles and the attributes of a fragment are those of the emulator (ports read as real numbers), and
//! so are the texels as its pyramids store them. Differences from a frame of the datapath therefore come from addresses, weights,
//! footprints and shading. All mathematics is that of `roughxel-reference`. In [`Mode::Supersampled`] the maps are read
//! bilinearly at level 0; with 1024 samples this is the truth for judging filters. The filtering modes use the probe rule,
//! weights and limits of the frame, at full accuracy.

mod footprint;
mod maps;
mod shade;

pub use footprint::{Float64, Footprints, ProbeRow};

use rayon::prelude::*;
use roughxel_assets::Picture;
use roughxel_core::precision::Precision;
use roughxel_frame::Frame;
use roughxel_frame::plan::Mode;
use roughxel_frame::raster::{Projection, RasterError, Sampling, TileRect, TileSamples, TriangleList, tiles};
use roughxel_scene::Scene;
use roughxel_shader::Needs;

use shade::Shader;

/// Linear colours in float64, rows top to bottom.
#[derive(Clone, Debug, PartialEq)]
pub struct RealPicture {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width`·`height` pixels.
    pub pixels: Vec<[f64; 3]>,
}

impl RealPicture {
    /// Peak signal-to-noise ratio in dB against a range of 1, over all channels of linear colours clamped to [0, 1];
    /// infinite for equal pictures.
    ///
    /// # Panics
    /// If the sizes differ.
    pub fn psnr(&self, other: &Self) -> f64 {
        assert_eq!((self.width, self.height), (other.width, other.height), "pictures have the same size");
        let squared = |(a, b): (&f64, &f64)| (a.clamp(0.0, 1.0) - b.clamp(0.0, 1.0)).powi(2);
        let channels = self.pixels.iter().flatten().zip(other.pixels.iter().flatten());
        let sum: f64 = channels.map(squared).sum();
        -10.0 * (sum / (3 * self.pixels.len()) as f64).log10()
    }
}

impl RealPicture {
    /// The picture in single precision, for files and comparisons.
    pub fn picture(&self) -> Picture {
        let pixels = self.pixels.iter().map(|pixel| pixel.map(|channel| channel as f32));
        Picture { width: self.width, height: self.height, pixels: pixels.collect() }
    }
}

impl From<&Frame> for RealPicture {
    fn from(frame: &Frame) -> Self {
        let real = |word: i32| f64::from(word) / f64::from(1 << 24);
        let pixels = frame.pixels.iter().map(|pixel| pixel.map(real)).collect();
        Self { width: frame.width, height: frame.height, pixels }
    }
}

/// Draws a scene in float64, in any mode of the frame. `progress` is called once per tile ([`work`]), from any thread.
///
/// `profile` gives the probe rule, probe weights, largest probe count and stored roughness; arithmetic word lengths have no
/// effect. Errors: those of the camera and the meshes.
pub fn render(
    scene: &Scene,
    mode: Mode,
    profile: &Precision,
    progress: &(dyn Fn() + Sync),
) -> Result<RealPicture, RasterError> {
    render_with(scene, mode, profile, &Float64, progress)
}

/// Same as [`render`], with reflection footprints from a different datapath. The filter and all else stay float64. Modes that do
/// not filter have no footprints.
pub fn render_with(
    scene: &Scene,
    mode: Mode,
    profile: &Precision,
    footprints: &dyn Footprints,
    progress: &(dyn Fn() + Sync),
) -> Result<RealPicture, RasterError> {
    let projection = Projection::new(&scene.camera)?;
    let triangles = TriangleList::new(&projection, &scene.objects)?;
    let shader = Shader::new(scene, &projection, mode, profile, footprints);
    let (width, height) = (projection.width(), projection.height());
    let sampling = if mode.filters() { Sampling::Objects } else { Sampling::Grid { edge: mode.samples_edge() } };
    let shaded: Vec<(TileRect, Vec<[f64; 3]>)> = tiles(width, height)
        .collect::<Vec<_>>()
        .into_par_iter()
        .map(|tile| {
            let colours = shade_tile(&shader, &triangles, tile, sampling);
            progress();
            (tile, colours)
        })
        .collect();
    let mut pixels = vec![[0.0; 3]; width as usize * height as usize];
    for (tile, colours) in shaded {
        for (row, line) in (0..).zip(colours.chunks(tile.width as usize)) {
            let start = (tile.y + row) as usize * width as usize + tile.x as usize;
            pixels[start..start + line.len()].copy_from_slice(line);
        }
    }
    Ok(RealPicture { width, height, pixels })
}

/// Number of progress steps of [`render`] and [`render_with`].
pub fn work(scene: &Scene) -> u64 {
    tiles(scene.camera.width, scene.camera.height).count() as u64
}

/// The mean over the samples of each pixel.
fn shade_tile(shader: &Shader<'_>, triangles: &TriangleList<'_>, tile: TileRect, sampling: Sampling) -> Vec<[f64; 3]> {
    let pixels = tile.width as usize * tile.height as usize;
    let (mut sums, mut counts) = (vec![[0.0; 3]; pixels], vec![0; pixels]);
    let mut samples = TileSamples::default();
    for pass in sampling.passes() {
        triangles.samples(tile, &pass, &mut samples);
        for (triangle, samples_of) in samples.by_triangle() {
            let shown = triangle.map(|index| {
                let object = triangles.object_index(index);
                let needs = Needs { tangents: shader.needs_tangents(object), ..Needs::ALL };
                (object, triangles.triangle(index, needs))
            });
            for &sample in samples_of {
                let [x, y] = samples.position(sample);
                let colour = match &shown {
                    None => shader.background(x, y),
                    Some((object, Some(triangle))) => shader.fragment(*object, &triangle.fragment(x, y)),
                    Some((_, None)) => [0.0; 3],
                };
                for (sum, channel) in sums[samples.pixel(sample) as usize].iter_mut().zip(colour) {
                    *sum += f64::from(samples.times(sample)) * channel;
                }
            }
        }
        counts.iter_mut().zip(samples.counts()).for_each(|(sum, count)| *sum += count);
    }
    sums.into_iter().zip(counts).map(|(sum, count)| sum.map(|channel| channel / f64::from(count))).collect()
}
