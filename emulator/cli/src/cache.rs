//! Cache of peak pyramids between runs, and their building.

use std::env;
use std::ffi::OsString;
use std::path::PathBuf;

use clap::Args;
use roughxel_core::setup::AMPLITUDE_LIMIT;
use roughxel_peaks::{ScenePeaks, Steps};
use roughxel_scene::Scene;

use super::Failure;
use super::console::{complain, late_progress};

#[derive(Args)]
pub(super) struct CacheArgs {
    /// Directory that keeps fitted peaks between runs; it may be deleted at any time. The default is `roughxel` in the user's cache
    /// directory ($XDG_CACHE_HOME, $HOME/.cache or %LOCALAPPDATA%).
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Fit all peaks again and keep none.
    #[arg(long, conflicts_with = "cache")]
    no_cache: bool,
}

impl CacheArgs {
    /// Directory of the cache, if there is one.
    pub(super) fn directory(&self) -> Option<PathBuf> {
        let own = || self.cache.clone().or_else(|| user_directory(|name| env::var_os(name)));
        (!self.no_cache).then(own).flatten()
    }

    /// Fits or reads the peaks of a scene, with a progress bar if that takes long. A cache that cannot be written is a warning, and so
    /// are peaks that are too bright.
    pub(super) fn peaks(&self, scene: &Scene, filters: bool) -> Result<ScenePeaks, Failure> {
        let bar = late_progress(ScenePeaks::steps(scene, filters), &format!("{}: peaks", scene.name));
        let progress = |steps: Steps| match steps {
            Steps::Fitted(done) => bar.inc(done),
            Steps::Found(done) => bar.skip(done),
        };
        let peaks = ScenePeaks::new(scene, filters, self.directory().as_deref(), &progress);
        bar.finish();
        let peaks = peaks?;
        for path in &peaks.damaged {
            complain(&format!("warning: {}: damaged, its peaks were fitted again", path.display()));
        }
        if let Some(reason) = &peaks.not_kept {
            self.warn(reason);
        }
        if peaks.cut > 0 {
            let (name, count) = (&scene.name, peaks.cut);
            complain(&format!(
                "warning: {name}: {count} peaks have an amplitude of {AMPLITUDE_LIMIT} or more and were clamped"
            ));
        }
        Ok(peaks)
    }

    /// Warns that peaks are not kept.
    pub(super) fn warn(&self, reason: impl std::fmt::Display) {
        let directory = self.directory().unwrap_or_default();
        complain(&format!("warning: peaks are not kept in {}: {reason}", directory.display()));
    }
}

/// Finds `roughxel` in the user's cache directory. Relative and empty paths count as missing (XDG base directories 0.8).
fn user_directory(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    let absolute = |name: &str| variable(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let home = || absolute("HOME").map(|home| home.join(".cache"));
    let directory = absolute("XDG_CACHE_HOME").or_else(home).or_else(|| absolute("LOCALAPPDATA"))?;
    Some(directory.join("roughxel"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_users_directory_is_the_first_that_is_absolute() {
        let root = env::temp_dir();
        let below = |name: &str| root.join(name).into_os_string();
        let found = |set: &[(&str, OsString)]| {
            user_directory(|name| set.iter().find(|(known, _)| *known == name).map(|(_, value)| value.clone()))
        };
        let (xdg, home, local) = (("XDG_CACHE_HOME", below("x")), ("HOME", below("h")), ("LOCALAPPDATA", below("l")));
        assert_eq!(found(&[local.clone(), home.clone(), xdg]), Some(root.join("x/roughxel")));
        for unusable in ["", "relative"] {
            let set = [("XDG_CACHE_HOME", unusable.into()), home.clone()];
            assert_eq!(found(&set), Some(root.join("h/.cache/roughxel")));
        }
        assert_eq!(found(&[local]), Some(root.join("l/roughxel")));
        assert_eq!(found(&[]), None);
    }
}
