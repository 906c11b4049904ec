//! Pyramids of a scene, built before its frames, so that frames of several modes share them.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use roughxel_scene::{Material, Object, Scene};
use thiserror::Error;

use super::cache::Cached;
use super::levels::{PeakPyramid, Steps};
use super::source::{BuildOptions, PeakError, PeakSource};

/// Reason why an object of a scene has no pyramid.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("object {object:?}: {source}")]
pub struct ObjectPeakError {
    /// Name of the object.
    pub object: String,
    /// Error of its source.
    pub source: PeakError,
}

/// The pyramids of the objects of a scene whose peaks come from a map.
#[derive(Debug, Default)]
pub struct ScenePeaks {
    pyramids: Vec<Option<Arc<PeakPyramid>>>,
    /// Number of pyramids read rather than built.
    pub read: usize,
    /// Number of pyramids built. Equal maps with equal options are built once.
    pub built: usize,
    /// Reason why some were not kept for the next time, if any; the pyramids are good all the same.
    pub not_kept: Option<io::Error>,
    /// Texels that an interrupted build had kept: [`Cached::resumed`].
    pub resumed: u64,
    /// Damaged files of interrupted builds: [`Cached::damaged`].
    pub damaged: Vec<PathBuf>,
    /// Peaks that storage clamps: [`PeakPyramid::cut`].
    pub cut: usize,
}

impl ScenePeaks {
    /// Builds or reads the pyramids one after the other, each with all threads; arguments as those of
    /// [`PeakPyramid::of_material`]. Pyramids with filters also serve frames without them: their level 0 is equal.
    ///
    /// `progress` is called with the number of new steps, from any thread, [`ScenePeaks::steps`] in all.
    pub fn new(
        scene: &Scene,
        filters: bool,
        cache: Option<&Path>,
        progress: &(dyn Fn(Steps) + Sync),
    ) -> Result<Self, ObjectPeakError> {
        let mut peaks = Self::default();
        for (index, object) in scene.objects.iter().enumerate() {
            if let Some(earlier) = twin(scene, index) {
                peaks.pyramids.push(peaks.pyramids[earlier].clone());
                continue;
            }
            let failed = |source| ObjectPeakError { object: object.name.clone(), source };
            let cached = PeakPyramid::of_material(&object.material, filters, cache, progress).map_err(failed)?;
            peaks.pyramids.push(cached.map(|cached| {
                peaks.read += usize::from(cached.read);
                peaks.built += usize::from(!cached.read);
                peaks.cut += cached.pyramid.cut();
                peaks.resumed += cached.resumed;
                peaks.damaged.extend(cached.damaged);
                peaks.not_kept = peaks.not_kept.take().or(cached.not_kept);
                Arc::new(cached.pyramid)
            }));
        }
        Ok(peaks)
    }

    /// Steps of progress of [`ScenePeaks::new`]; 0 if nothing is fitted.
    pub fn steps(scene: &Scene, filters: bool) -> u64 {
        let steps = |(index, object): (usize, &Object)| match twin(scene, index) {
            None if filters => PeakSource::of_material(&object.material).map_or(0, |source| source.steps()),
            _ => 0,
        };
        scene.objects.iter().enumerate().map(steps).sum()
    }

    /// The pyramid of an object; `None` if its peaks do not come from a map.
    pub fn pyramid(&self, object: usize) -> Option<&PeakPyramid> {
        self.pyramids.get(object)?.as_deref()
    }
}

impl PeakPyramid {
    /// The pyramid of a material, without filters its base alone; `None` if no peaks come from a map.
    ///
    /// With filters it is read from the directory `cache` if it was built before, and kept there if not. The directory is
    /// made if it is missing. `progress` is called with the number of new steps, from any thread: [`PeakSource::steps`]
    /// in all, none without filters. Errors: as [`PeakPyramid::build`].
    pub fn of_material(
        material: &Material,
        filters: bool,
        cache: Option<&Path>,
        progress: &(dyn Fn(Steps) + Sync),
    ) -> Result<Option<Cached>, PeakError> {
        let Some((source, options)) = PeakSource::of_material(material).zip(BuildOptions::of_material(material)) else {
            return Ok(None);
        };
        let cached = match cache {
            _ if !filters => Cached::new(Self::base(&source, &options)?),
            Some(directory) => Self::cached(directory, &source, &options, progress)?,
            None => Cached::new(Self::build(&source, &options, progress)?),
        };
        Ok(Some(cached))
    }
}

/// The first earlier object with the same pyramid.
fn twin(scene: &Scene, index: usize) -> Option<usize> {
    let object = &scene.objects[index];
    let options = BuildOptions::of_material(&object.material)?;
    let bump = object.material.bump.as_ref()?;
    scene.objects[..index].iter().position(|earlier| {
        let same_map = earlier.material.bump.as_ref().is_some_and(|other| Arc::ptr_eq(bump, other));
        let shadowing = |object: &Object| object.material.peaks.as_ref().map(|peaks| peaks.shadowing.is_some());
        same_map
            && BuildOptions::of_material(&earlier.material) == Some(options)
            && shadowing(earlier) == shadowing(object)
    })
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::super::PeakLevel;
    use super::*;

    /// A lit scene of planes with these materials.
    fn scene(materials: &[&str]) -> Scene {
        let head = "camera = { eye = [0, 1, 5], target = [0, 0, 0] }\n[[light]]\ndirection = [0, 1, 0]\n";
        let object = |keys: &&str| format!("[[object]]\nshape = \"plane\"\n[object.material]\n{keys}\n");
        let text = head.to_owned() + &materials.iter().map(object).collect::<String>();
        Scene::from_toml("test.toml", &text, Path::new("")).expect("the scene is good")
    }

    const MAP: &str = "height_map = { generate = \"bumps\", size = 8, cells = 2 }\n";

    /// The pyramids, checked for the announced progress.
    fn built(scene: &Scene, filters: bool, cache: Option<&Path>) -> ScenePeaks {
        let steps = AtomicU64::new(0);
        let count = |done: Steps| {
            let (Steps::Fitted(done) | Steps::Found(done)) = done;
            steps.fetch_add(done, Ordering::Relaxed);
        };
        let peaks = ScenePeaks::new(scene, filters, cache, &count).expect("the scene is good");
        assert_eq!(steps.into_inner(), ScenePeaks::steps(scene, filters));
        assert!(peaks.not_kept.is_none());
        peaks
    }

    #[test]
    fn heights_reach_the_pyramid_where_shadowing_asks_for_them() {
        let materials = ["peaks = {}", "peaks = { shadowing = true }"].map(|peaks| format!("{MAP}{peaks}"));
        let natural = format!("{}\nframe = \"natural\"", materials[1]);
        let given = "peaks = { given = [{ amplitude = 1, normal = [0, 0, 1], exponent = 9 }] }";
        let scene = scene(&[&materials[0], &materials[1], &natural, given, MAP]);
        let kept = |index: usize| scene.objects[index].material.bump.as_ref().map(|bump| bump.heights.is_some());
        assert_eq!([0, 1, 2, 3, 4].map(kept), [Some(false), Some(true), Some(true), None, Some(false)]);
        let peaks = built(&scene, true, None);
        let horizons = |index: usize| {
            let pyramid = peaks.pyramid(index)?;
            let horizons = pyramid.levels.iter().flat_map(PeakLevel::peaks).map(|peak| peak.horizon);
            let all: Option<Vec<_>> = horizons.collect();
            all.map(|all| all.iter().flatten().any(|side| side.mean > 0.0))
        };
        assert_eq!([0, 1, 2, 3, 4].map(horizons), [None, Some(true), Some(true), None, None]);
        assert!(peaks.pyramid(0).is_some() && peaks.pyramid(3).is_none() && peaks.pyramid(5).is_none());
    }

    #[test]
    fn equal_maps_are_built_once_and_read_the_next_time() {
        let directory = tempfile::tempdir().expect("a directory");
        let peaks = |keys: &str| format!("{MAP}peaks = {{ {keys} }}");
        let (one, same, other) = (peaks("exponent = 30"), peaks("colour = [1, 0, 0], exponent = 30"), peaks(""));
        let scene = scene(&[&one, &same, &other]);
        let first = built(&scene, true, Some(directory.path()));
        assert_eq!((first.built, first.read), (2, 0));
        assert_eq!(first.pyramid(0), first.pyramid(1));
        assert_ne!(first.pyramid(0), first.pyramid(2));
        let second = built(&scene, true, Some(directory.path()));
        assert_eq!((second.built, second.read), (0, 2));
        assert!((0..3).all(|index| second.pyramid(index) == first.pyramid(index)));
    }

    #[test]
    fn facets_too_steep_for_their_amplitude_are_counted() {
        let peaks = |slope: f64, amplitude: f64| {
            let map = format!("height_map = {{ generate = \"bumps\", size = 8, cells = 2, rms_slope = {slope} }}");
            let scene = scene(&[&format!("{map}\npeaks = {{ amplitude = {amplitude} }}")]);
            (built(&scene, false, None).cut, built(&scene, true, None).cut)
        };
        assert_eq!((peaks(4.0, 1.0), peaks(0.2, 15.0)), ((0, 0), (0, 0)));
        let (base, all) = peaks(4.0, 15.0);
        assert!(base > 0 && all >= base, "{base} of level 0, {all} of all");
    }

    #[test]
    fn frames_without_filters_need_the_base_alone_and_keep_nothing() {
        let directory = tempfile::tempdir().expect("a directory");
        let scene = scene(&[&format!("{MAP}peaks = {{ shadowing = true }}")]);
        let (base, all) = (built(&scene, false, Some(directory.path())), built(&scene, true, None));
        assert_eq!(std::fs::read_dir(directory.path()).expect("a directory").count(), 0);
        let levels = |peaks: &ScenePeaks| peaks.pyramid(0).map(|pyramid| pyramid.levels.clone());
        assert_eq!(levels(&base).as_deref(), levels(&all).as_ref().map(|levels| &levels[..1]));
        assert!(ScenePeaks::steps(&scene, true) > 0 && ScenePeaks::steps(&scene, false) == 0);
    }
}
