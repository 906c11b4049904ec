//! Scenes of the gallery, prepared with their maps.

use roughxel_core::precision::Precision;
use roughxel_frame::plan::Mode;
use roughxel_frame::{Frame, Prepared};
use roughxel_peaks::ScenePeaks;
use roughxel_scene::Scene;

use super::drawn::Settings;
use crate::demo::DrawError;

/// Fits or reads the peaks of a scene's maps, for all modes.
pub(super) fn peaks(scene: &Scene, settings: &Settings) -> Result<ScenePeaks, DrawError> {
    ScenePeaks::new(scene, true, settings.cache.as_deref(), &|_| ())
        .map_err(|source| DrawError::Peaks { scene: scene.name.clone(), source })
}

/// Builds the maps of a scene.
pub(super) fn prepare<'a>(
    scene: &'a Scene,
    mode: Mode,
    precision: &Precision,
    peaks: &ScenePeaks,
) -> Result<Prepared<'a>, DrawError> {
    Prepared::with_peaks(scene, mode, precision, peaks)
        .map_err(|source| DrawError::Raster { scene: scene.name.clone(), source })
}

/// Draws a prepared scene once.
pub(super) fn render(scene: &Scene, prepared: &Prepared<'_>, progress: &(dyn Fn() + Sync)) -> Result<Frame, DrawError> {
    prepared.render(progress).map_err(|source| DrawError::Raster { scene: scene.name.clone(), source })
}
