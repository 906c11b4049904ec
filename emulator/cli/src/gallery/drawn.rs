//! Settings of a gallery, and results of drawing it.

use std::path::PathBuf;
use std::time::Duration;

use roughxel_assets::picture::PictureError;
use roughxel_core::precision::Precision;
use roughxel_frame::plan::Mode;
use roughxel_utilities::output::WriteError;
use thiserror::Error;

use super::entry::{Column, Entry};
use super::table;
use crate::demo::DrawError;

/// Settings of a gallery.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Size of each picture, pixels.
    pub size: [u32; 2],
    /// Samples of the reference along an edge of the pixel, 1 to 64.
    pub reference_edge: u32,
    /// Profile of the columns.
    pub precision: Precision,
    /// Directory that keeps fitted peaks between runs, if any.
    pub cache: Option<PathBuf>,
}

impl Settings {
    /// Returns true if the reference can judge a picture in this mode. A picture with as many samples would be compared with itself, and one
    /// with more samples with something worse.
    pub fn judges(&self, mode: Mode) -> bool {
        mode.filters() || mode.samples_edge() < self.reference_edge
    }
}

/// Error of drawing a gallery.
#[derive(Debug, Error)]
pub enum GalleryError {
    /// A scene or its picture failed.
    #[error(transparent)]
    Draw(#[from] DrawError),
    /// A directory, the page or a kept reference cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl From<PictureError> for GalleryError {
    fn from(error: PictureError) -> Self {
        Self::Draw(error.into())
    }
}

/// A drawn scene.
#[derive(Clone, Debug)]
pub struct DrawnScene {
    /// Entry of the scene.
    pub entry: &'static Entry,
    /// Columns in the order of the entry.
    pub columns: Vec<DrawnColumn>,
    /// Reference of the columns.
    pub reference: DrawnReference,
    /// Picture of all columns and the reference in a row.
    pub side_by_side: PathBuf,
    /// Effects of each object in the filtered picture, on or off, with the reason.
    pub plan: String,
    /// Reason why fitted peaks could not be kept for the next run, if any.
    pub not_kept: Option<String>,
}

/// A drawn column.
#[derive(Clone, Debug)]
pub struct DrawnColumn {
    /// Column that was drawn.
    pub column: Column,
    /// Picture of the column.
    pub picture: PathBuf,
    /// Signed error against the reference: [`difference`](roughxel_assets::picture::difference).
    pub difference: PathBuf,
    /// Time of the fastest drawing.
    pub time: Duration,
    /// Peak signal-to-noise ratio against the reference in dB: [`Frame::psnr`](roughxel_frame::Frame::psnr). `None` if the reference has no
    /// more samples a pixel than the column ([`Settings::judges`]).
    pub psnr: Option<f64>,
    /// Similarity to the reference: [`ssim`](roughxel_assets::picture::ssim). `None` as for `psnr`, and for pictures smaller than its window.
    pub ssim: Option<f64>,
    /// Digest of the frame: [`Frame::digest`](roughxel_frame::Frame::digest).
    pub digest: String,
}

/// The reference of a scene.
#[derive(Clone, Debug)]
pub struct DrawnReference {
    /// Picture of the reference.
    pub picture: PathBuf,
    /// Time of drawing. `None` if an earlier run drew it.
    pub time: Option<Duration>,
}

impl DrawnScene {
    /// Finds the column with a label.
    pub fn column(&self, label: &str) -> Option<&DrawnColumn> {
        self.columns.iter().find(|drawn| drawn.column.label == label)
    }

    /// Time of a column divided by that of the unfiltered column.
    pub fn ratio(&self, drawn: &DrawnColumn) -> Option<f64> {
        self.column(table::UNFILTERED.label).map(|base| drawn.time.as_secs_f64() / base.time.as_secs_f64())
    }
}
