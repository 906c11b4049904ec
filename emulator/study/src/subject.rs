//! What frames are drawn of, again and again: a scene whose peaks are there.

use roughxel_core::precision::Precision;
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_frame::raster::RasterError;
use roughxel_maps::peak_pyramid::ScenePeaks;
use roughxel_scene::Scene;

use crate::StudyError;

/// A scene with the peaks of its maps.
#[derive(Debug)]
pub struct Subject {
    /// The scene.
    pub scene: Scene,
    /// Its peaks, with filters.
    pub peaks: ScenePeaks,
}

impl Subject {
    /// A built-in scene, or that of a file, at a size in pixels.
    ///
    /// Errors: a scene that cannot be read, or peaks that cannot be made.
    pub fn open(name: &str, [width, height]: [u32; 2]) -> Result<Self, StudyError> {
        let scene = Scene::open(name)?.with_size(width, height)?;
        let peaks = ScenePeaks::new(&scene, true, None, &|_| ())?;
        Ok(Self { scene, peaks })
    }

    /// Its maps for a mode and a profile.
    pub fn prepare(&self, mode: Mode, p: &Precision) -> Result<Prepared<'_>, RasterError> {
        Prepared::with_peaks(&self.scene, mode, p, &self.peaks)
    }
}
