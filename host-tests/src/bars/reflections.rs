//! Reflections of rough photographs at every distance: brightness of the filtered picture over that of 1024 samples a pixel, in bands of rows from
//! the horizon to the eye, for each channel.
//!
//! The heights are a photograph on a plane to the horizon, under a sky with a sun about 1000 times as bright. The sun gives about as much light as
//! the rest of the sky, and no pixel of a frame is clipped. Panoramas and normal maps of others take the places of sky and heights in the
//! [suite of the world](super::World).

use std::path::Path;

use roughxel_core::precision::Precision;
use roughxel_frame::plan::Mode;
use roughxel_frame::{Frame, Prepared};
use roughxel_scene::Scene;

use crate::photographs::photograph;

/// Photographs whose slopes are far from the normal law.
pub const ROUGH_PHOTOGRAPHS: [&str; 3] = ["gravel.png", "grass.png", "brick.png"];

/// Lines of a material with two lobes of the law of its map.
pub const LAW: &str = "bump_deviation = \"law\"";

/// Lines of a material with one lobe of the same variance (S97).
pub const ONE_LOBE: &str = "bump_deviation = \"root-mean-square\"\ntwo_lobes = false";

/// Edge of the pieces of photographs, texels.
pub(super) const EDGE: u32 = 128;

/// Bands of rows.
const BANDS: usize = 4;

/// Samples along an edge of a pixel of the truth. With 16, far bands differ by up to 9 % from those of 1024 samples; with 64, by up to 4 %.
const SAMPLES_EDGE: u32 = 32;

/// A direction of the sun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Angle above the horizon, degrees.
    pub elevation: f64,
    /// Angle from the far end of the plane to the right, degrees.
    pub azimuth: f64,
}

/// A sun that the plane reflects towards the eye.
pub const SUN: Sun = Sun { elevation: 35.0, azimuth: 25.0 };

/// Twelve suns: at four elevations, far away, to the right and to the left.
///
/// One sun shows the density of slopes at one point. Their mean shows whether light is lost or made.
pub fn suns() -> [Sun; 12] {
    let (elevations, azimuths) = ([20.0, 35.0, 50.0, 65.0], [25.0, 115.0, 265.0]);
    core::array::from_fn(|i| Sun { elevation: elevations[i / 3], azimuth: azimuths[i % 3] })
}

/// A filtered picture of reflections against 1024 samples a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReflectionFigures {
    /// Brightness of each channel over that of the truth, by band, the uppermost first, which is the farthest one of a plane.
    pub bands: [[f64; 3]; BANDS],
    /// PSNR, dB, at the exposure that gives the brightest channel of the truth the value 1.
    pub psnr: f64,
    /// PSNR of 16 samples a pixel against the same truth, dB.
    pub psnr_of_16_samples: f64,
    /// Texels that the filtered picture reads for a pixel of the frame, the mean.
    pub texels: f64,
}

impl ReflectionFigures {
    /// Darkest and brightest channel of any band over the truth.
    pub fn range(&self) -> [f64; 2] {
        let channels = self.bands.iter().flatten();
        channels.fold([f64::INFINITY, 0.0], |[least, most], &ratio| [ratio.min(least), ratio.max(most)])
    }

    /// Mean of the figures of several pictures, at least one.
    pub fn mean(figures: &[Self]) -> Self {
        let mean = |number: &dyn Fn(&Self) -> f64| figures.iter().map(number).sum::<f64>() / figures.len() as f64;
        Self {
            bands: core::array::from_fn(|band| core::array::from_fn(|i| mean(&|figures| figures.bands[band][i]))),
            psnr: mean(&|figures| figures.psnr),
            psnr_of_16_samples: mean(&|figures| figures.psnr_of_16_samples),
            texels: mean(&|figures| figures.texels),
        }
    }
}

/// Bumps of a mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bumps<'a> {
    /// A picture as heights, scaled to a root mean square of slopes.
    Heights(&'a Path, f64),
    /// A normal map with its own slopes.
    Normals(&'a Path),
}

/// Light that a mirror reflects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light<'a> {
    /// A generated sky with a sun.
    Sun(Sun),
    /// A picture by longitude and latitude, exposed by so many stops.
    Panorama(&'a Path, f64),
}

/// Shape of a mirror.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A plane to the horizon.
    Plane,
    /// A knot.
    Mesh,
}

/// A mirror in front of black.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror<'a> {
    /// Bumps of the mirror.
    pub bumps: Bumps<'a>,
    /// Light that it reflects.
    pub light: Light<'a>,
    /// Shape of the mirror.
    pub shape: Shape,
}

impl Mirror<'_> {
    /// The scene. `keys` are further lines of the material.
    fn scene(&self, keys: &str) -> Scene {
        let light = match self.light {
            Light::Sun(Sun { elevation, azimuth }) => format!(
                "generate = \"sky\"\nface_edge = 128\nsun = [60, 50, 36]\nradius_degrees = 2\n\
                 elevation_degrees = {elevation}\nazimuth_degrees = {azimuth}\n\
                 zenith = [0.02, 0.04, 0.09]\nhorizon = [0.1, 0.11, 0.12]\nground = [0.03, 0.025, 0.02]\n"
            ),
            Light::Panorama(path, exposure) => {
                format!("equirectangular = {path:?}\nface_edge = 128\nexposure = {exposure:.3}\n")
            }
        };
        let bumps = match self.bumps {
            Bumps::Heights(path, rms_slope) => format!("height_map = {{ path = {path:?}, rms_slope = {rms_slope} }}\n"),
            Bumps::Normals(path) => format!("normal_map = {{ path = {path:?} }}\n"),
        };
        let [camera, shape] = match self.shape {
            Shape::Plane => [
                "eye = [0, 2.2, 6]\ntarget = [0, 0, -2]\nfov_y = 40\n",
                "shape = \"plane\"\nsize = [60, 60]\nsegments = [30, 30]\nuv_repeat = [20, 20]\n",
            ],
            Shape::Mesh => [
                "eye = [0, 2.5, 6]\ntarget = [0, 0, 0]\nfov_y = 36\n",
                "shape = \"mesh\"\ngenerate = \"knot\"\nuv_repeat = [20, 2]\n",
            ],
        };
        let text = format!(
            "[camera]\n{camera}width = 96\nheight = 72\n\
             [background]\ntop = [0, 0, 0]\nbottom = [0, 0, 0]\n\
             [environment]\n{light}\
             [[object]]\n{shape}[object.material]\ncolour = [0, 0, 0]\nreflectance = 1\n{keys}\n{bumps}"
        );
        Scene::from_toml("reflections", &text, Path::new("")).expect("the scene is valid")
    }

    /// A frame of the scene, and the texels that it reads.
    fn draw(&self, keys: &str, mode: Mode) -> (Frame, u64) {
        let scene = self.scene(keys);
        let prepared = Prepared::new(&scene, mode, &Precision::STANDARD).expect("the scene is valid");
        let (frame, counted) = prepared.render_counted(&|| ()).expect("the scene can be drawn");
        (frame, counted.texels)
    }
}

/// Pictures of a mirror.
#[derive(Clone, Debug)]
pub struct Pictures<const N: usize> {
    /// Picture of 1024 samples a pixel.
    pub truth: Frame,
    /// Picture of 16 samples a pixel.
    pub sampled: Frame,
    /// Filtered pictures, one for each of some lines of its material that do not change what samples show.
    pub filtered: [Frame; N],
    /// Texels that each filtered picture reads.
    pub texels: [u64; N],
}

impl<const N: usize> Pictures<N> {
    /// Draws a mirror.
    ///
    /// # Panics
    /// If the keys are wrong, or a file is missing.
    pub fn of(mirror: &Mirror, keys: [&str; N]) -> Self {
        let filtered = keys.map(|keys| mirror.draw(keys, Mode::Footprint));
        Self {
            truth: mirror.draw("", Mode::Supersampled { edge: SAMPLES_EDGE }).0,
            sampled: mirror.draw("", Mode::Supersampled { edge: 4 }).0,
            texels: filtered.each_ref().map(|(_, texels)| *texels),
            filtered: filtered.map(|(frame, _)| frame),
        }
    }

    /// Figures of the filtered pictures.
    pub fn figures(&self) -> [ReflectionFigures; N] {
        let of_truth = bands(&self.truth);
        let psnr_of_16_samples = psnr(&self.sampled, &self.truth);
        core::array::from_fn(|picture| {
            let filtered = &self.filtered[picture];
            let of_filtered = bands(filtered);
            ReflectionFigures {
                bands: core::array::from_fn(|band| core::array::from_fn(|i| of_filtered[band][i] / of_truth[band][i])),
                psnr: psnr(filtered, &self.truth),
                psnr_of_16_samples,
                texels: self.texels[picture] as f64 / filtered.pixels.len() as f64,
            }
        })
    }
}

/// Sums of each channel over each band of rows that show the mirror, the uppermost first.
fn bands(frame: &Frame) -> [[f64; 3]; BANDS] {
    let rows: Vec<[f64; 3]> = frame
        .pixels
        .chunks(frame.width as usize)
        .map(|row| core::array::from_fn(|i| row.iter().map(|pixel| f64::from(pixel[i])).sum()))
        .collect();
    let first = rows.iter().position(|row| row[0] > 0.0).unwrap_or(rows.len());
    // The uppermost row of a plane is half sky.
    let shown = &rows[(first + 1).min(rows.len())..];
    core::array::from_fn(|band| {
        let rows = &shown[shown.len() * band / BANDS..shown.len() * (band + 1) / BANDS];
        core::array::from_fn(|i| rows.iter().map(|row| row[i]).sum())
    })
}

/// PSNR in dB at the exposure that gives the brightest channel of the truth the value 1.
fn psnr(frame: &Frame, truth: &Frame) -> f64 {
    let channels = || frame.pixels.iter().flatten().zip(truth.pixels.iter().flatten());
    let brightest = channels().fold(0, |most, (_, &channel)| channel.max(most));
    let sum: f64 = channels().map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2)).sum();
    -10.0 * (sum / (3 * truth.pixels.len()) as f64 / f64::from(brightest).powi(2)).log10()
}

/// Draws a photograph as heights of a slope, once with each of `keys`, further lines of its material that do not change what samples show. `None`
/// without the photograph.
///
/// # Panics
/// If the keys are wrong, and as [`photograph`].
pub fn reflection_figures<const N: usize>(
    name: &str,
    rms_slope: f64,
    keys: [&str; N],
    sun: Sun,
) -> Option<[ReflectionFigures; N]> {
    let piece = photograph(name, EDGE)?;
    let mirror =
        Mirror { bumps: Bumps::Heights(&piece.path(), rms_slope), light: Light::Sun(sun), shape: Shape::Plane };
    Some(Pictures::of(&mirror, keys).figures())
}
