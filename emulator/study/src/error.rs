//! Reasons why a study ends without success.

use std::io;
use std::path::PathBuf;

use roughxel_assets::picture::PictureError;
use roughxel_frame::raster::RasterError;
use roughxel_peaks::ObjectPeakError;
use roughxel_scene::SceneError;
use thiserror::Error;

/// Reason why a study ends without success.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A scene cannot be read.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A scene cannot be drawn.
    #[error(transparent)]
    Raster(#[from] RasterError),
    /// Peaks of a scene cannot be made.
    #[error(transparent)]
    Peaks(#[from] ObjectPeakError),
    /// A picture cannot be written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// Threads cannot be started.
    #[error(transparent)]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A file that holds no study.
    #[error("{}: no study: {problem}", path.display())]
    NoStudy {
        /// The file.
        path: PathBuf,
        /// Description of the fault.
        problem: String,
    },
    /// A file of the study.
    #[error("{}: cannot {action}: {source}", path.display())]
    File {
        /// The verb: read or write.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
}
