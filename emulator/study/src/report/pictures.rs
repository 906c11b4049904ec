//! Effect of a knob on a frame, as pictures.

use std::fs;
use std::path::Path;

use roughxel_assets::picture::{DIFFERENCE_GAIN, Picture, difference, write_png_srgb};
use roughxel_core::knob::Knob;
use roughxel_core::precision::Precision;
use roughxel_frame::plan::Mode;

use super::figures::base_name;
use super::verdict::{BUYS_SOMETHING_DB, knob_gains};
use crate::measurement::{Study, base_of};
use crate::{StudyError, Subject, stability};

/// Pixels of a picture on the page.
const SIZE: [u32; 2] = [240, 180];

/// Pictures of one scene next to each other: the effect of a knob, or of a method in a hard case.
pub(super) struct ScenePictures {
    /// Name of the knob or of the hard case.
    pub(super) name: String,
    pub(super) scene: String,
    pub(super) size: [u32; 2],
    /// PNG file, label, caption.
    pub(super) shown: Vec<(Vec<u8>, String, String)>,
}

/// Draws the frames in which f32 formulas fail.
pub(super) fn naive(directory: &Path) -> Result<Vec<ScenePictures>, StudyError> {
    let drawn = stability::pictures(SIZE)?.into_iter().map(|naive| {
        let shown = vec![
            (Some(naive.truth), "float64".to_string(), naive.scene.clone()),
            (Some(naive.picture), naive.method.clone(), format!("{:.1} dB", naive.psnr)),
        ];
        let shown = files(directory, &naive.case, shown)?;
        Ok(ScenePictures { name: naive.case, scene: naive.scene, size: SIZE, shown })
    });
    drawn.collect()
}

/// Writes pictures as numbered files under a name, and reads the files back.
fn files(
    folder: &Path,
    name: &str,
    pictures: Vec<(Option<Picture>, String, String)>,
) -> Result<Vec<(Vec<u8>, String, String)>, StudyError> {
    let folder = folder.join("pictures");
    fs::create_dir_all(&folder).map_err(|source| StudyError::File { action: "make", path: folder.clone(), source })?;
    let mut shown = Vec::new();
    for (index, (picture, label, caption)) in pictures.into_iter().enumerate() {
        let Some(picture) = picture else { continue };
        let path = folder.join(format!("{name}-{index}.png"));
        write_png_srgb(&path, &picture)?;
        let png = fs::read(&path).map_err(|source| StudyError::File { action: "read", path, source })?;
        shown.push((png, label, caption));
    }
    Ok(shown)
}

/// The two precisions that show a knob: its least accurate value that differs from the base, and the base.
fn shown_of(knob: Knob) -> Option<[Precision; 2]> {
    let base = base_of(knob);
    let least = knob.values().iter().find(|&&value| value != knob.value_in(&base))?;
    Some([knob.with(*least, base), base])
}

/// Draws every knob in the scene that shows it most, if one does, into `directory`/pictures.
pub(super) fn draw(study: &Study, directory: &Path) -> Result<Vec<ScenePictures>, StudyError> {
    let gains = knob_gains(study);
    let mut drawn = Vec::new();
    for knob in Knob::ALL {
        let most =
            gains.iter().filter(|gain| gain.knob == knob.name()).max_by(|a, b| a.filter_db.total_cmp(&b.filter_db));
        let Some(most) = most.filter(|gain| gain.filter_db >= BUYS_SOMETHING_DB) else { continue };
        let Some(precisions) = shown_of(knob) else { continue };
        let subject = Subject::open(&most.scene, SIZE)?;
        let render = |p: &Precision| -> Result<Picture, StudyError> {
            Ok(subject.prepare(Mode::Footprint, p)?.render(&|| ())?.picture())
        };
        let [coarse, base] = precisions.map(|p| render(&p));
        let (coarse, base) = (coarse?, base?);
        let [low, high] = precisions.map(|p| format!("{knob} {}", knob.text(knob.value_in(&p))));
        let between = difference(&coarse, &base);
        let pictures = vec![
            (Some(coarse), low, most.scene.clone()),
            (Some(base), high, base_name(knob)),
            (between, "difference".into(), format!("{DIFFERENCE_GAIN} times enlarged; grey is none")),
        ];
        let shown = files(directory, knob.name(), pictures)?;
        drawn.push(ScenePictures { name: knob.name().into(), scene: most.scene.clone(), size: SIZE, shown });
    }
    Ok(drawn)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurement::settings;

    #[test]
    fn pictures_of_a_knob_are_of_settings_that_the_study_measures() {
        let measured = settings();
        for knob in Knob::ALL {
            for p in shown_of(knob).expect("every knob has two values") {
                assert!(measured.iter().any(|setting| setting.precision == p), "{knob} {}", knob.value_in(&p));
            }
        }
    }
}
