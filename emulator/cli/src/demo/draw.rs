//! Draws the demonstration scenes in three modes, compares them with supersampling, and captures fragments of each.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use roughxel_assets::picture::{PictureError, beside, write_png_srgb};
use roughxel_core::plan::ReflectionPlan;
use roughxel_core::ports::ReflectionIn;
use roughxel_core::precision::Precision;
use roughxel_frame::plan::Mode;
use roughxel_frame::raster::RasterError;
use roughxel_frame::{Frame, Prepared};
use roughxel_peaks::{ObjectPeakError, ScenePeaks};
use roughxel_scene::{Scene, SceneError};
use thiserror::Error;

/// Scenes of the demonstration: S97 Fig. 10–13 and 1–2, and the globe of its frame system 3.
pub(crate) const DEMO_SCENES: [&str; 4] = ["lake", "zebra", "puzzle", "globe"];

/// Modes in which each scene is drawn, left to right in its picture.
pub(crate) const DEMO_MODES: [Mode; 3] = [Mode::Unfiltered, Mode::Isotropic, Mode::Footprint];

/// Mode that the pictures are compared with: 64 samples a pixel.
pub(crate) const DEMO_TRUTH: Mode = Mode::Supersampled { edge: 8 };

/// Most fragments of a frame that become vectors.
const CAPTURED_FRAGMENTS: usize = 512;

/// Error of drawing a scene.
#[derive(Debug, Error)]
pub enum DrawError {
    /// The scene cannot be read.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The camera or the geometry does not fit.
    #[error("scene {scene}: {source}")]
    Raster {
        /// Name of the scene.
        scene: String,
        /// Cause.
        source: RasterError,
    },
    /// The peaks of a map cannot be fitted.
    #[error("scene {scene}: {source}")]
    Peaks {
        /// Name of the scene.
        scene: String,
        /// Object and cause.
        source: ObjectPeakError,
    },
    /// The picture file cannot be written.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

/// One scene of the demonstration.
#[derive(Clone, Debug)]
pub(crate) struct DemoScene {
    /// Name.
    pub(crate) name: &'static str,
    /// Written picture: unfiltered, isotropic and footprint, side by side.
    pub(crate) picture: PathBuf,
    /// Time and PSNR against [`DEMO_TRUTH`] (dB, linear light, range 1) of each of [`DEMO_MODES`].
    pub(crate) modes: [(Duration, f64); 3],
    /// Time of [`DEMO_TRUTH`].
    pub(crate) truth: Duration,
    /// Reflecting fragments of the filtered frame, for a vector set. Empty if nothing reflects.
    pub(crate) captured: Vec<ReflectionIn>,
    /// Plan of the captured fragments.
    pub(crate) plan: ReflectionPlan,
    /// Reason why fitted peaks could not be kept for the next run, if any.
    pub(crate) not_kept: Option<String>,
}

/// Draws one scene of the demonstration into `directory`, which must exist.
///
/// Fitted peaks are kept in the directory `cache`. `step` is called with the name of the step before each of the four drawings.
pub(crate) fn demo_scene(
    name: &'static str,
    size: Option<[u32; 2]>,
    profile: &Precision,
    directory: &Path,
    cache: Option<&Path>,
    step: &dyn Fn(&str),
) -> Result<DemoScene, DrawError> {
    step(&format!("{name}: maps"));
    let mut scene = Scene::open(name)?;
    if let Some([width, height]) = size {
        scene = scene.with_size(width, height)?;
    }
    let peaks = ScenePeaks::new(&scene, true, cache, &|_| ())
        .map_err(|source| DrawError::Peaks { scene: scene.name.clone(), source })?;
    let failed = |source| DrawError::Raster { scene: scene.name.clone(), source };
    let draw = |prepared: &Prepared<'_>, mode: Mode| -> Result<(Frame, Duration), DrawError> {
        step(&format!("{name}: {mode}"));
        let start = Instant::now();
        let frame = prepared.render(&|| ()).map_err(failed)?;
        Ok((frame, start.elapsed()))
    };
    let prepare = |mode: Mode| Prepared::with_peaks(&scene, mode, profile, &peaks).map_err(failed);
    let [unfiltered, isotropic, footprint] = DEMO_MODES;
    let filtered = prepare(footprint)?;
    let drawings =
        [draw(&prepare(unfiltered)?, unfiltered)?, draw(&prepare(isotropic)?, isotropic)?, draw(&filtered, footprint)?];
    let (truth, truth_time) = draw(&prepare(DEMO_TRUTH)?, DEMO_TRUTH)?;
    let picture = directory.join(format!("{name}.png"));
    let pictures = drawings.each_ref().map(|(frame, _)| frame.picture());
    write_png_srgb(&picture, &beside(&pictures.each_ref()))?;

    let captured = filtered.capture(CAPTURED_FRAGMENTS).map_err(failed)?;
    // A set has one plan: that of the first reflecting object.
    let plan = captured.first().map_or(ReflectionPlan::FULL, |(_, plan)| *plan);
    let captured = captured.into_iter().filter(|(_, own)| *own == plan).map(|(fragment, _)| fragment).collect();
    let modes = drawings.each_ref().map(|(frame, time)| (*time, frame.psnr(&truth)));
    let not_kept = peaks.not_kept.map(|reason| reason.to_string());
    Ok(DemoScene { name, picture, modes, truth: truth_time, captured, plan, not_kept })
}
