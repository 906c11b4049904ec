//! Suite of the world: reflections of panoramas and bumps that nobody here made, on a plane and on a mesh.
//!
//! Panoramas and normal maps are those of the npm package `@pmndrs/assets` (CC0), heights are photographs of the Python package scikit-image.
//! `bash host-tests/programs/world.sh` fetches both.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use roughxel_assets::picture::{self, Purpose, Wishes};

use super::reflections::{
    Bumps, EDGE, LAW, Light, Mirror, ONE_LOBE, Pictures, ROUGH_PHOTOGRAPHS, ReflectionFigures, Shape,
};
use crate::photographs::{Photograph, photograph};

/// Panoramas.
const SKIES: [&str; 10] = ["bridge", "city", "dawn", "forest", "night", "park", "sky", "sunset", "venice", "workshop"];
/// Normal maps.
const NORMALS: [&str; 7] = ["0001", "0005", "0009", "0013", "0017", "0021", "0025"];
/// Slopes of the heights, root mean square.
const SLOPES: [f64; 4] = [0.1, 0.25, 0.5, 1.0];
/// Brightest channel of a panorama as it is exposed, times white. A sample of a picture, as a pixel, shows at most 63.
const BRIGHTEST: f64 = 32.0;

/// Lines of a material for each picture: by themselves, S97's one lobe, lobes of the law of the map.
pub const KEYS: [&str; 3] = ["", ONE_LOBE, LAW];

/// Files of the suite.
#[derive(Debug)]
pub struct World {
    folder: PathBuf,
    heights: [Photograph; 3],
}

/// A mirror of the suite.
#[derive(Clone, Debug)]
pub struct Case {
    /// Name of its bumps.
    pub bumps: &'static str,
    /// Slope to which heights are scaled; a normal map has its own.
    pub rms_slope: Option<f64>,
    /// Shape of the mirror.
    pub shape: Shape,
    /// Name of the panorama.
    pub sky: &'static str,
}

/// Pictures of a case and their figures.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The case.
    pub case: Case,
    /// Figures for each of [`KEYS`].
    pub figures: [ReflectionFigures; 3],
    /// The pictures.
    pub pictures: Pictures<3>,
}

impl World {
    /// Finds the files below `target`.
    ///
    /// # Errors
    /// The first file that is missing, and the command that fetches it.
    pub fn open() -> Result<Self, String> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/world");
        let files =
            SKIES.map(|name| format!("{name}.exr")).into_iter().chain(NORMALS.map(|name| format!("{name}.webp")));
        let missing = |file: &str| format!("{file} is missing: run `bash host-tests/programs/world.sh`");
        for file in files {
            let path = folder.join(file);
            if !path.exists() {
                return Err(missing(&path.display().to_string()));
            }
        }
        let [Some(a), Some(b), Some(c)] = ROUGH_PHOTOGRAPHS.map(|name| photograph(name, EDGE)) else {
            return Err(missing("a photograph"));
        };
        Ok(Self { folder, heights: [a, b, c] })
    }

    /// Cases of the suite: bumps of each slope with three panoramas, two on a plane and one on a mesh.
    pub fn cases() -> Vec<Case> {
        let heights = ROUGH_PHOTOGRAPHS.into_iter().flat_map(|name| SLOPES.map(|slope| (name, Some(slope))));
        let bumps = heights.chain(NORMALS.map(|name| (name, None)));
        let shapes = [Shape::Plane, Shape::Plane, Shape::Mesh];
        let of = |(number, (bumps, rms_slope)): (usize, (&'static str, Option<f64>))| {
            let case = move |(turn, shape)| Case {
                bumps,
                rms_slope,
                shape,
                sky: SKIES[(3 * number + 4 * turn) % SKIES.len()],
            };
            shapes.into_iter().enumerate().map(case)
        };
        bumps.enumerate().flat_map(of).collect()
    }

    /// Draws every case. `progress` is called after each.
    ///
    /// # Panics
    /// If a file cannot be read.
    pub fn draw(&self, progress: &(dyn Fn() + Sync)) -> Vec<Outcome> {
        let outcome = |case: Case| {
            let outcome = self.outcome(case);
            progress();
            outcome
        };
        Self::cases().into_par_iter().map(outcome).collect()
    }

    /// Draws a case.
    ///
    /// # Panics
    /// If a file cannot be read.
    pub fn outcome(&self, case: Case) -> Outcome {
        let sky = self.folder.join(format!("{}.exr", case.sky));
        let heights = ROUGH_PHOTOGRAPHS.iter().position(|name| *name == case.bumps).map(|i| self.heights[i].path());
        let normals = self.folder.join(format!("{}.webp", case.bumps));
        let bumps = match (&heights, case.rms_slope) {
            (Some(heights), Some(slope)) => Bumps::Heights(heights, slope),
            _ => Bumps::Normals(&normals),
        };
        let light = picture::read(&sky, Purpose::Environment, &Wishes::default()).expect("the panorama can be read");
        let brightest = light.picture.pixels.as_flattened().iter().fold(0.0, |most: f32, channel| most.max(*channel));
        let exposure = (BRIGHTEST / f64::from(brightest)).log2();
        let mirror = Mirror { bumps, light: Light::Panorama(&sky, exposure), shape: case.shape };
        let pictures = Pictures::of(&mirror, KEYS);
        let figures = pictures.figures();
        Outcome { case, figures, pictures }
    }
}
