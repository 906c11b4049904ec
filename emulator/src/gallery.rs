//! The gallery: every scene of the papers beside what it is compared with, judged against supersampling.
//!
//! [`table`] lists the scenes and their columns; [`draw_scene`] draws one into files, [`write_page`] makes one page of all
//! of them. A column is the scene in a mode, perhaps changed ([`change`]): without its texture, with another formula.
//! The reference is 1024 unfiltered samples a pixel in the most precise profile, kept between runs (`reference`).
//! Times are of drawing only: maps are built before, and a column is drawn again while that is quick, the fastest counts.

pub mod change;
mod page;
mod reference;
pub mod table;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use roughxel_core::precision::Precision;
use thiserror::Error;

use crate::demo::DrawError;
use crate::frame::{Frame, Prepared};
use crate::maps::peak_pyramid::ScenePeaks;
use crate::picture::{Picture, PictureError, beside, difference, ssim, write_png_srgb};
use crate::plan::{Decision, Mode, ObjectPlan};
use crate::raster::tiles;
use crate::scene::Scene;

pub use change::Change;
pub use page::write_page;

/// A scene of the gallery.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Name of a built-in scene.
    pub name: &'static str,
    /// The picture of the papers it stands for.
    pub source: &'static str,
    /// What it shows, one sentence.
    pub shows: &'static str,
    /// How it is drawn, left to right; [`table::UNFILTERED`] is among them, labels differ.
    pub columns: &'static [Column],
}

/// A way to draw a scene.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// What stands above the picture; its file name, with `-` for what is neither letter nor digit.
    pub label: &'static str,
    /// Sampling and filtering.
    pub mode: Mode,
    /// What is changed before.
    pub change: Change,
}

impl Column {
    /// File name of its picture, without an extension.
    fn stem(&self) -> String {
        self.label.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' }).collect()
    }
}

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

/// Why a gallery could not be drawn.
#[derive(Debug, Error)]
pub enum GalleryError {
    /// A scene or a picture of it.
    #[error(transparent)]
    Draw(#[from] DrawError),
    /// A directory, the page or a kept reference.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// File or directory.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
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
    /// Signed error against the reference: [`difference`].
    pub difference: PathBuf,
    /// Time of drawing, the fastest of some.
    pub time: Duration,
    /// Peak signal to noise ratio against the reference, dB: [`Frame::psnr`].
    pub psnr: f64,
    /// Similarity to the reference: [`ssim`]; none for pictures smaller than its window.
    pub ssim: Option<f64>,
    /// Digest of the frame: [`Frame::digest`].
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

/// A column is drawn again until this much time has gone into it, or [`MOST_DRAWINGS`] times.
const ENOUGH_TIME: Duration = Duration::from_millis(400);
/// Most drawings of a column.
const MOST_DRAWINGS: u32 = 5;

/// Progress steps of [`draw_scene`]: samples a pixel, for every tile of every picture.
pub fn work(entry: &Entry, settings: &Settings) -> u64 {
    let [width, height] = settings.size;
    let samples: u32 = entry.columns.iter().map(|column| column.mode.samples_edge().pow(2)).sum();
    tiles(width, height).count() as u64 * u64::from(samples + settings.reference_edge.pow(2))
}

/// Draws a scene of the gallery: a picture and a difference for each column, the reference, and all of them side by side,
/// into a directory of its name below `directory`, which is made if it is not there.
///
/// `progress` is called with what is being drawn and how many of the [`work`] steps are done, from any thread.
pub fn draw_scene(
    entry: &'static Entry,
    settings: &Settings,
    directory: &Path,
    progress: &(dyn Fn(&str, u64) + Sync),
) -> Result<DrawnScene, GalleryError> {
    progress(entry.name, 0);
    let [width, height] = settings.size;
    let scene = Scene::open(entry.name).and_then(|scene| scene.with_size(width, height)).map_err(DrawError::from)?;
    let own = directory.join(entry.name);
    fs::create_dir_all(&own).map_err(|source| GalleryError::Write { path: own.clone(), source })?;

    let truth_samples = u64::from(settings.reference_edge.pow(2));
    let truth_name = format!("{}: {truth_samples} samples", entry.name);
    progress(&format!("{}: maps", entry.name), 0);
    let peaks = peaks(&scene, settings)?;
    let not_kept = peaks.not_kept.as_ref().map(ToString::to_string);
    progress(&truth_name, 0);
    let tile_count = tiles(width, height).count() as u64;
    let (truth, truth_time) = reference::reference(&scene, entry.name, &peaks, settings, directory, &|| {
        progress(&truth_name, truth_samples);
    })?;
    if truth_time.is_none() {
        progress(&truth_name, truth_samples * tile_count);
    }
    let truth_picture = truth.picture();
    let reference = DrawnReference { picture: own.join("reference.png"), time: truth_time };
    write_png_srgb(&reference.picture, &truth_picture)?;

    let (mut columns, mut pictures, mut plan) = (Vec::new(), Vec::new(), String::new());
    for column in entry.columns {
        let name = format!("{}: {}", entry.name, column.label);
        progress(&name, 0);
        let (mut changed, mut precision) = (scene.clone(), settings.precision);
        column.change.apply(&mut changed, &mut precision);
        // Another scene may have other peaks.
        let own_peaks =
            matches!(column.change, Change::Scene(_)).then(|| self::peaks(&changed, settings)).transpose()?;
        let mut prepared = prepare(&changed, column.mode, &precision, own_peaks.as_ref().unwrap_or(&peaks))?;
        if let Change::Without(effect) = column.change {
            let plans: Vec<ObjectPlan> = prepared.plans().map(|plan| plan.without(effect)).collect();
            prepared = plans.into_iter().enumerate().fold(prepared, |all, (object, plan)| all.with_plan(object, plan));
        }
        if column.label == table::FILTERED.label {
            plan = plan_text(&changed, &prepared);
        }
        let samples = u64::from(column.mode.samples_edge().pow(2));
        let (frame, time) = timed(&changed, &prepared, &|| progress(&name, samples))?;
        let picture = frame.picture();
        let stem = column.stem();
        let drawn = DrawnColumn {
            column: *column,
            picture: own.join(format!("{stem}.png")),
            difference: own.join(format!("difference-{stem}.png")),
            time,
            psnr: frame.psnr(&truth),
            ssim: ssim(&picture, &truth_picture),
            digest: frame.digest(),
        };
        write_png_srgb(&drawn.picture, &picture)?;
        if let Some(error) = difference(&picture, &truth_picture) {
            write_png_srgb(&drawn.difference, &error)?;
        }
        columns.push(drawn);
        pictures.push(picture);
    }
    pictures.push(truth_picture);
    let side_by_side = own.join("side-by-side.png");
    write_png_srgb(&side_by_side, &beside(&pictures.iter().collect::<Vec<&Picture>>()))?;
    Ok(DrawnScene { entry, columns, reference, side_by_side, plan, not_kept })
}

/// The peaks of a scene's maps, for all modes.
fn peaks(scene: &Scene, settings: &Settings) -> Result<ScenePeaks, DrawError> {
    ScenePeaks::new(scene, true, settings.cache.as_deref(), &|_| ())
        .map_err(|source| DrawError::Peaks { scene: scene.name.clone(), source })
}

/// A scene with its maps.
fn prepare<'a>(
    scene: &'a Scene,
    mode: Mode,
    precision: &Precision,
    peaks: &ScenePeaks,
) -> Result<Prepared<'a>, DrawError> {
    Prepared::with_peaks(scene, mode, precision, peaks)
        .map_err(|source| DrawError::Raster { scene: scene.name.clone(), source })
}

/// Draws once.
fn render(scene: &Scene, prepared: &Prepared<'_>, progress: &(dyn Fn() + Sync)) -> Result<Frame, DrawError> {
    prepared.render(progress).map_err(|source| DrawError::Raster { scene: scene.name.clone(), source })
}

/// Draws, and measures how long it takes; only the first drawing shows in the progress.
fn timed(scene: &Scene, prepared: &Prepared<'_>, progress: &(dyn Fn() + Sync)) -> Result<(Frame, Duration), DrawError> {
    let begin = Instant::now();
    let frame = render(scene, prepared, progress)?;
    let mut fastest = begin.elapsed();
    for _ in 1..MOST_DRAWINGS {
        if begin.elapsed() >= ENOUGH_TIME {
            break;
        }
        let start = Instant::now();
        render(scene, prepared, &|| ())?;
        fastest = fastest.min(start.elapsed());
    }
    Ok((frame, fastest))
}

/// Every effect of every object, on or off, with the reason.
fn plan_text(scene: &Scene, prepared: &Prepared<'_>) -> String {
    let mut text = String::new();
    for (object, decisions) in scene.objects.iter().zip(prepared.decisions()) {
        text += &format!("{}\n", object.name);
        for Decision { effect, on, why } in decisions {
            text += &format!("  {} {}: {why}\n", if *on { "+" } else { "–" }, effect.name());
        }
    }
    text
}
