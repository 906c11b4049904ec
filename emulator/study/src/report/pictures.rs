//! What a knob does to a frame, as pictures.

use std::fs;
use std::path::Path;

use roughxel_core::knob::Knob;
use roughxel_core::precision::Precision;
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_maps::peak_pyramid::ScenePeaks;
use roughxel_scene::Scene;
use roughxel_scene::picture::{DIFFERENCE_GAIN, Picture, difference, write_png_srgb};

use super::verdict::{BUYS_SOMETHING_DB, knob_gains};
use crate::StudyError;
use crate::stability;
use crate::sweep::Study;

/// Pixels of a picture on the page.
const SIZE: [u32; 2] = [240, 180];

/// Pictures of one scene side by side: what a knob or a method makes of it.
pub(super) struct KnobPicture {
    pub(super) knob: String,
    pub(super) scene: String,
    pub(super) size: [u32; 2],
    /// PNG file, label, caption.
    pub(super) shown: Vec<(Vec<u8>, String, String)>,
}

/// Draws the frames in which formulas of f32 fail, with the case of each.
pub(super) fn naive(directory: &Path) -> Result<Vec<(String, KnobPicture)>, StudyError> {
    let drawn = stability::pictures(SIZE)?.into_iter().map(|naive| {
        let shown = vec![
            (Some(naive.truth), "float64".to_string(), naive.scene.clone()),
            (Some(naive.picture), naive.method.clone(), format!("{:.1} dB", naive.psnr)),
        ];
        let shown = files(directory, &naive.case, shown)?;
        Ok((naive.case.clone(), KnobPicture { knob: naive.case, scene: naive.scene, size: SIZE, shown }))
    });
    drawn.collect()
}

/// Pictures as files of a name, read again as they are.
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

/// Draws every knob in the scene that shows it most, where one does, into `directory`/pictures.
pub(super) fn draw(study: &Study, directory: &Path) -> Result<Vec<KnobPicture>, StudyError> {
    let folder = directory.join("pictures");
    fs::create_dir_all(&folder).map_err(|source| StudyError::File { action: "make", path: folder.clone(), source })?;
    let gains = knob_gains(study);
    let mut drawn = Vec::new();
    for knob in Knob::ALL {
        let most =
            gains.iter().filter(|gain| gain.knob == knob.name()).max_by(|a, b| a.filter_db.total_cmp(&b.filter_db));
        let Some(most) = most.filter(|gain| gain.filter_db >= BUYS_SOMETHING_DB) else { continue };
        let Some(&least) = knob.values().iter().find(|&&value| value != knob.of(&Precision::STANDARD)) else {
            continue;
        };
        let scene = Scene::open(&most.scene)?.with_size(SIZE[0], SIZE[1])?;
        let peaks = ScenePeaks::new(&scene, true, None, &|_| ())?;
        let render = |p: &Precision| -> Result<Picture, StudyError> {
            Ok(Prepared::with_peaks(&scene, Mode::Footprint, p, &peaks)?.render(&|| ())?.picture())
        };
        let [coarse, standard] = [knob.with(least, Precision::STANDARD), Precision::STANDARD].map(|p| render(&p));
        let (coarse, standard) = (coarse?, standard?);
        let [low, base] = [least, knob.of(&Precision::STANDARD)].map(|value| knob.text(value).to_string());
        let between = difference(&coarse, &standard);
        let pictures = vec![
            (Some(coarse), format!("{knob} {low}"), most.scene.clone()),
            (Some(standard), format!("{knob} {base}"), "standard".to_string()),
            (between, "difference".into(), format!("{DIFFERENCE_GAIN} times enlarged; grey is none")),
        ];
        let shown = files(directory, knob.name(), pictures)?;
        drawn.push(KnobPicture { knob: knob.name().into(), scene: most.scene.clone(), size: SIZE, shown });
    }
    Ok(drawn)
}
