//! Digests of small frames: any change of any bit of any pixel is detected.

use rayon::prelude::*;
use roughxel_core::precision::Profile;
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_peaks::ScenePeaks;
use roughxel_scene::{Scene, builtin_names};

/// The committed list, relative to the package.
pub const GOLDEN_FRAMES: &str = "golden/frames.txt";

/// Size of the frames, pixels.
const SIZE: [u32; 2] = [64, 48];
/// Returns one line per built-in scene, and one with [two lobes](super::two_lobes), for each profile and mode: their names and the SHA-256 of the
/// frame's words.
///
/// Scenes with the same map share its fitted peaks; all profiles and modes of a scene share its peaks and environments. Errors: a sentence that
/// names the scene that cannot be drawn.
pub fn golden_frames() -> Result<String, String> {
    let mut text = format!("# SHA-256 of {}x{} frames; written by `picture-bars --bless`.\n", SIZE[0], SIZE[1]);
    let cache = tempfile::tempdir().map_err(|error| error.to_string())?;
    for name in builtin_names().chain(["two-lobes"]) {
        let failed = |error: &dyn std::fmt::Display| format!("scene {name}: {error}");
        let scene = match Scene::builtin(name) {
            Some(scene) => scene.map_err(|error| failed(&error))?,
            None => super::two_lobes(),
        };
        let scene = scene.with_size(SIZE[0], SIZE[1]).map_err(|error| failed(&error))?;
        let peaks = ScenePeaks::new(&scene, true, Some(cache.path()), &|_| ()).map_err(|error| failed(&error))?;
        let [plain, filtered] = [false, true].map(|filters| Prepared::environment_map(&scene, filters));
        let variants: Vec<(&str, Mode)> =
            Profile::NAMES.iter().flat_map(|&profile| super::MODES.map(|mode| (profile, mode))).collect();
        let lines: Result<Vec<String>, String> = variants
            .into_par_iter()
            .map(|(profile, mode)| {
                let precision =
                    Profile::by_name(profile).map(Profile::precision).ok_or_else(|| failed(&"unknown profile"))?;
                let environment = if mode.filters() { &filtered } else { &plain };
                let prepared = Prepared::with_maps(&scene, mode, &precision, (&peaks, environment.clone()));
                let frame = prepared.and_then(|prepared| prepared.render(&|| ()));
                let digest = frame.map_err(|error| failed(&error))?.digest();
                Ok(format!("{name} {profile} {mode} {digest}\n"))
            })
            .collect();
        text.extend(lines?);
    }
    Ok(text)
}
