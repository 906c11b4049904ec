//! Subjects of repeated frames: a scene with its peaks.

use std::sync::{Arc, OnceLock};

use roughxel_core::precision::Precision;
use roughxel_frame::plan::Mode;
use roughxel_frame::raster::RasterError;
use roughxel_frame::{EnvironmentMap, Prepared};
use roughxel_peaks::ScenePeaks;
use roughxel_scene::Scene;

use crate::StudyError;

/// A scene with the maps that do not depend on the profile.
#[derive(Debug)]
pub struct Subject {
    /// The scene.
    pub scene: Scene,
    /// Its peaks, with filters.
    peaks: ScenePeaks,
    /// Its environment, without filters and with them, made on first use.
    environments: [OnceLock<Option<Arc<EnvironmentMap>>>; 2],
}

impl Subject {
    /// A scene with its peaks, with filters.
    pub fn new(scene: Scene, peaks: ScenePeaks) -> Self {
        Self { scene, peaks, environments: Default::default() }
    }

    /// A built-in scene, or a scene file, at a size in pixels.
    ///
    /// Errors: a scene that cannot be read, or peaks that cannot be made.
    pub fn open(name: &str, [width, height]: [u32; 2]) -> Result<Self, StudyError> {
        let scene = Scene::open(name)?.with_size(width, height)?;
        let peaks = ScenePeaks::new(&scene, true, None, &|_| ())?;
        Ok(Self::new(scene, peaks))
    }

    /// Its maps for a mode and a profile.
    pub fn prepare(&self, mode: Mode, p: &Precision) -> Result<Prepared<'_>, RasterError> {
        let filters = mode.filters();
        let environment = self.environments[usize::from(filters)]
            .get_or_init(|| Prepared::environment_map(&self.scene, filters))
            .clone();
        Prepared::with_maps(&self.scene, mode, p, (&self.peaks, environment))
    }
}
