//! The main job: the demonstration scenes drawn three ways, judged against supersampling, and a vector set of each.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use roughxel_core::plan::ReflectionPlan;
use roughxel_core::ports::ReflectionIn;
use roughxel_core::precision::Precision;
use thiserror::Error;

use crate::frame::{Frame, Prepared};
use crate::picture::{PictureError, beside, write_png_srgb};
use crate::plan::Mode;
use crate::raster::RasterError;
use crate::scene::{Scene, SceneError};

/// The scenes of the demonstration: S97 Fig. 10–13 and 1–2, and the globe of its frame system 3.
pub const DEMO_SCENES: [&str; 4] = ["lake", "zebra", "puzzle", "globe"];

/// The three ways each is drawn, left to right in its picture.
pub const DEMO_MODES: [Mode; 3] = [Mode::Unfiltered, Mode::Isotropic, Mode::Footprint];

/// What the pictures are judged against: 64 samples a pixel.
pub const DEMO_TRUTH: Mode = Mode::Supersampled { edge: 8 };

/// Most fragments of a frame that become vectors.
const CAPTURED_FRAGMENTS: usize = 512;

/// Why a scene could not be drawn.
#[derive(Debug, Error)]
pub enum DrawError {
    /// The scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The camera or the geometry.
    #[error("scene {scene}: {source}")]
    Raster {
        /// Name of the scene.
        scene: String,
        /// What does not fit.
        source: RasterError,
    },
    /// The picture file.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

/// A frame and how long its pixels took (maps built, scene loaded).
#[derive(Clone, Debug)]
pub struct Drawn {
    /// The frame.
    pub frame: Frame,
    /// Time to build the maps.
    pub preparation: Duration,
    /// Time to draw.
    pub drawing: Duration,
}

/// One scene of the demonstration.
#[derive(Clone, Debug)]
pub struct DemoScene {
    /// Name.
    pub name: &'static str,
    /// The picture written: unfiltered, isotropic, footprint side by side.
    pub picture: PathBuf,
    /// Time and PSNR against [`DEMO_TRUTH`] (dB, linear light, range 1) of each of [`DEMO_MODES`].
    pub modes: [(Duration, f64); 3],
    /// Time of [`DEMO_TRUTH`].
    pub truth: Duration,
    /// Reflecting fragments of the filtered frame, for a vector set; empty where nothing reflects.
    pub captured: Vec<ReflectionIn>,
    /// Their plan.
    pub plan: ReflectionPlan,
}

/// Draws a scene in a mode; `progress(done)` is called for every tile.
pub fn draw(scene: &Scene, mode: Mode, profile: &Precision, progress: impl Fn() + Sync) -> Result<Drawn, DrawError> {
    let failed = |source| DrawError::Raster { scene: scene.name.clone(), source };
    let start = Instant::now();
    let prepared = Prepared::new(scene, mode, profile).map_err(failed)?;
    let preparation = start.elapsed();
    let start = Instant::now();
    let frame = prepared.render(progress).map_err(failed)?;
    Ok(Drawn { frame, preparation, drawing: start.elapsed() })
}

/// Draws one scene of the demonstration into `directory`, which exists.
///
/// `step` is called with the name of the step before each of the four drawings.
pub fn demo_scene(
    name: &'static str,
    size: Option<[u32; 2]>,
    profile: &Precision,
    directory: &Path,
    step: impl Fn(&str),
) -> Result<DemoScene, DrawError> {
    step(&format!("{name}: maps"));
    let mut scene = match Scene::builtin(name) {
        Some(scene) => scene?,
        None => Scene::from_file(Path::new(name))?,
    };
    if let Some([width, height]) = size {
        scene = scene.with_size(width, height)?;
    }
    let drawn = |mode: Mode| {
        step(&format!("{name}: {mode}"));
        draw(&scene, mode, profile, || ())
    };
    let [unfiltered, isotropic, footprint] = DEMO_MODES;
    let drawings = [drawn(unfiltered)?, drawn(isotropic)?, drawn(footprint)?];
    let truth = drawn(DEMO_TRUTH)?;
    let picture = directory.join(format!("{name}.png"));
    let pictures = drawings.each_ref().map(|drawing| drawing.frame.picture());
    write_png_srgb(&picture, &beside(&pictures.each_ref()))?;

    let prepared = Prepared::new(&scene, footprint, profile)
        .map_err(|source| DrawError::Raster { scene: scene.name.clone(), source })?;
    let captured = prepared
        .capture(CAPTURED_FRAGMENTS)
        .map_err(|source| DrawError::Raster { scene: scene.name.clone(), source })?;
    // One set has one plan: that of the first reflecting object.
    let plan = captured.first().map_or(ReflectionPlan::FULL, |(_, plan)| *plan);
    let captured = captured.into_iter().filter(|(_, own)| *own == plan).map(|(fragment, _)| fragment).collect();
    let modes = drawings.each_ref().map(|drawing| (drawing.drawing, drawing.frame.psnr(&truth.frame)));
    Ok(DemoScene { name, picture, modes, truth: truth.drawing, captured, plan })
}
