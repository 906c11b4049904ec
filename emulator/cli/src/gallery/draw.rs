//! Draws the columns of a scene and measures the time.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use roughxel_assets::picture::{Picture, beside, difference, ssim, write_png_srgb};
use roughxel_frame::plan::Decision;
use roughxel_frame::raster::tiles;
use roughxel_frame::{Frame, Prepared};
use roughxel_scene::Scene;
use roughxel_shader::ObjectPlan;
use roughxel_utilities::output::WriteError;

use super::change::Change;
use super::drawn::{DrawnColumn, DrawnReference, DrawnScene, GalleryError, Settings};
use super::entry::Entry;
use super::prepared::{self, prepare, render};
use super::{reference, table};
use crate::demo::DrawError;

/// Drawing time after which a column is not drawn again. [`MOST_DRAWINGS`] is the other limit.
const ENOUGH_TIME: Duration = Duration::from_millis(400);
/// Most drawings of a column.
const MOST_DRAWINGS: u32 = 5;

/// Counts the progress steps of [`draw_scene`]: samples a pixel for every tile of every picture.
pub fn work(entry: &Entry, settings: &Settings) -> u64 {
    let [width, height] = settings.size;
    let samples: u32 = entry.columns.iter().map(|column| column.mode.samples_edge().pow(2)).sum();
    tiles(width, height).count() as u64 * u64::from(samples + settings.reference_edge.pow(2))
}

/// Draws a scene of the gallery: a picture and a difference for each column, the reference, and all pictures side by side.
///
/// Files go to a directory with the name of the scene below `directory`, created if missing. `progress` is called from any thread, with the
/// name of what is drawn and the number of [`work`] steps done.
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
    fs::create_dir_all(&own).map_err(|source| WriteError { path: own.clone(), source })?;

    let truth_samples = u64::from(settings.reference_edge.pow(2));
    let truth_name = format!("{}: {truth_samples} samples", entry.name);
    progress(&format!("{}: maps", entry.name), 0);
    let peaks = prepared::peaks(&scene, settings)?;
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
        // A changed scene may have different peaks.
        let own_peaks =
            matches!(column.change, Change::Scene(_)).then(|| prepared::peaks(&changed, settings)).transpose()?;
        let mut maps = prepare(&changed, column.mode, &precision, own_peaks.as_ref().unwrap_or(&peaks))?;
        if let Change::Without(effect) = column.change {
            let plans: Vec<ObjectPlan> = maps.plans().map(|plan| plan.without(effect)).collect();
            maps = plans.into_iter().enumerate().fold(maps, |all, (object, plan)| all.with_plan(object, plan));
        }
        if column.label == table::FILTERED.label {
            plan = plan_text(&changed, &maps);
        }
        let samples = u64::from(column.mode.samples_edge().pow(2));
        let (frame, time) = timed(&changed, &maps, &|| progress(&name, samples))?;
        let picture = frame.picture();
        let stem = column.stem();
        let judged = settings.judges(column.mode);
        let drawn = DrawnColumn {
            column: *column,
            picture: own.join(format!("{stem}.png")),
            difference: own.join(format!("difference-{stem}.png")),
            time,
            psnr: judged.then(|| frame.psnr(&truth)),
            ssim: judged.then(|| ssim(&picture, &truth_picture)).flatten(),
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

/// Draws several times and measures the fastest. Only the first drawing counts as progress.
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

/// Lists every effect of every object, on or off, with the reason.
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
