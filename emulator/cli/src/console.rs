//! Progress bars, messages and tables for the terminal.

use std::io::{self, Write};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use comfy_table::{Table, presets};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use roughxel_scene::MapProgress;

/// Makes a progress bar on stderr, which is hidden if stderr is not a terminal.
pub(super) fn progress(total: u64, what: &str) -> ProgressBar {
    styled(ProgressBar::new(total), what)
}

/// Runs `work` with a progress bar. `work` reports how much is done.
pub(super) fn with_progress<T>(total: u64, what: &str, work: impl FnOnce(&(dyn Fn(u64) + Sync)) -> T) -> T {
    let bar = progress(total, what);
    let outcome = work(&|done| bar.set_position(done));
    bar.finish_and_clear();
    outcome
}

/// Duration below which work shows no bar.
const PATIENCE: Duration = Duration::from_millis(500);

/// A progress bar that appears only if the work takes longer than [`PATIENCE`].
pub(super) struct LateProgress {
    bar: ProgressBar,
    start: Instant,
    shown: OnceLock<()>,
}

/// Makes a progress bar like [`progress`] that appears late.
pub(super) fn late_progress(total: u64, what: &str) -> LateProgress {
    let hidden = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden());
    LateProgress { bar: styled(hidden, what), start: Instant::now(), shown: OnceLock::new() }
}

/// A late progress bar for the maps of a scene, one after another.
pub(super) struct SceneProgress {
    scene: String,
    late: LateProgress,
}

/// Makes a late progress bar for the maps of a scene.
pub(super) fn map_progress(scene: &str) -> SceneProgress {
    SceneProgress { scene: scene.to_owned(), late: late_progress(0, scene) }
}

impl SceneProgress {
    /// Removes the bar.
    pub(super) fn finish(&self) {
        self.late.finish();
    }
}

impl MapProgress for SceneProgress {
    fn begin(&self, map: &str, steps: u64) {
        let bar = &self.late.bar;
        bar.reset();
        bar.set_length(steps);
        bar.set_message(format!("{}: {map}", self.scene));
    }

    fn step(&self) {
        self.late.inc(1);
    }
}

impl LateProgress {
    /// Adds finished steps.
    pub(super) fn inc(&self, done: u64) {
        self.bar.inc(done);
        if self.start.elapsed() > PATIENCE {
            self.shown.get_or_init(|| self.bar.set_draw_target(ProgressDrawTarget::stderr()));
        }
    }

    /// Adds skipped steps, which do not count in the estimate of the remaining time.
    pub(super) fn skip(&self, done: u64) {
        self.bar.inc(done);
        self.bar.reset_eta();
    }

    /// Removes the bar.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

fn styled(bar: ProgressBar, what: &str) -> ProgressBar {
    let template = "{msg} {wide_bar} {human_pos}/{human_len} {eta} left";
    // If the template does not parse, the default style stays.
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.set_message(what.to_string());
    bar
}

/// Writes a line to stderr. A closed stderr is ignored.
pub(super) fn complain(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Makes an empty table for stdout.
pub(super) fn new_table<const N: usize>(header: [&str; N]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::UTF8_FULL_CONDENSED).set_header(header);
    table
}

/// A number of things: `1 part`, `2 parts`.
pub(super) fn counted(number: usize, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}
