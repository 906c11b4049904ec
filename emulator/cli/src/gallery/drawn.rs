//! How scenes are drawn, and what is known of them afterwards.

use std::path::PathBuf;
use std::time::Duration;

use roughxel_core::precision::Precision;
use roughxel_frame::plan::Mode;
use roughxel_scene::picture::PictureError;
use roughxel_utilities::output::WriteError;
use thiserror::Error;

use super::entry::{Column, Entry};
use super::table;
use crate::demo::DrawError;

/// How a gallery is drawn.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Size of each picture, pixels.
    pub size: [u32; 2],
    /// Samples of the reference along an edge of the pixel, 1 to 64.
    pub reference_edge: u32,
    /// Profile of the columns.
    pub precision: Precision,
    /// Where fitted peaks are kept from run to run, if they are.
    pub cache: Option<PathBuf>,
}

impl Settings {
    /// Whether the reference can judge what is drawn in a mode: a picture of as many samples as the reference would be judged against
    /// itself, and one of more against something worse.
    pub fn judges(&self, mode: Mode) -> bool {
        mode.filters() || mode.samples_edge() < self.reference_edge
    }
}

/// Why a gallery could not be drawn.
#[derive(Debug, Error)]
pub enum GalleryError {
    /// A scene or a picture of it.
    #[error(transparent)]
    Draw(#[from] DrawError),
    /// A directory, the page or a kept reference.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl From<PictureError> for GalleryError {
    fn from(error: PictureError) -> Self {
        Self::Draw(error.into())
    }
}

/// A scene that has been drawn.
#[derive(Clone, Debug)]
pub struct DrawnScene {
    /// Its entry.
    pub entry: &'static Entry,
    /// Its columns, in the order of the entry.
    pub columns: Vec<DrawnColumn>,
    /// What they were judged against.
    pub reference: DrawnReference,
    /// All columns and the reference in a row.
    pub side_by_side: PathBuf,
    /// Every effect of each object in the filtered picture, and why it is on or off.
    pub plan: String,
    /// Why fitted peaks were not kept for the next time, if so.
    pub not_kept: Option<String>,
}

/// A column that has been drawn.
#[derive(Clone, Debug)]
pub struct DrawnColumn {
    /// What was drawn.
    pub column: Column,
    /// Its picture.
    pub picture: PathBuf,
    /// Signed error against the reference: [`difference`](roughxel_scene::picture::difference).
    pub difference: PathBuf,
    /// Time of drawing, the fastest of some.
    pub time: Duration,
    /// Peak signal to noise ratio against the reference, dB: [`Frame::psnr`](roughxel_frame::Frame::psnr); none where the reference
    /// has no more samples a pixel than the column ([`Settings::judges`]).
    pub psnr: Option<f64>,
    /// Similarity to the reference: [`ssim`](roughxel_scene::picture::ssim); none as for `psnr`, and for pictures smaller than its window.
    pub ssim: Option<f64>,
    /// Digest of the frame: [`Frame::digest`](roughxel_frame::Frame::digest).
    pub digest: String,
}

/// The reference of a scene.
#[derive(Clone, Debug)]
pub struct DrawnReference {
    /// Its picture.
    pub picture: PathBuf,
    /// Time of drawing; none where it was kept from an earlier run.
    pub time: Option<Duration>,
}

impl DrawnScene {
    /// The column of that label, if the scene has it.
    pub fn column(&self, label: &str) -> Option<&DrawnColumn> {
        self.columns.iter().find(|drawn| drawn.column.label == label)
    }

    /// Time of a column in times of the unfiltered one.
    pub fn ratio(&self, drawn: &DrawnColumn) -> Option<f64> {
        self.column(table::UNFILTERED.label).map(|base| drawn.time.as_secs_f64() / base.time.as_secs_f64())
    }
}
