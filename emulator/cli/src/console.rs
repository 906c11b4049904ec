//! What goes to the terminal.

use std::io::{self, Write};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use comfy_table::{Table, presets};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use roughxel_scene::MapProgress;

/// A progress bar on stderr, hidden where that is no terminal.
pub(super) fn progress(total: u64, what: &str) -> ProgressBar {
    styled(ProgressBar::new(total), what)
}

/// Does work that says how much of it is done.
pub(super) fn with_progress<T>(total: u64, what: &str, work: impl FnOnce(&(dyn Fn(u64) + Sync)) -> T) -> T {
    let bar = progress(total, what);
    let outcome = work(&|done| bar.set_position(done));
    bar.finish_and_clear();
    outcome
}

/// Work shorter than this needs no bar.
const PATIENCE: Duration = Duration::from_millis(500);

/// A progress bar that shows itself only where the work takes longer than [`PATIENCE`].
pub(super) struct LateProgress {
    bar: ProgressBar,
    start: Instant,
    shown: OnceLock<()>,
}

/// As [`progress`], but late.
pub(super) fn late_progress(total: u64, what: &str) -> LateProgress {
    let hidden = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden());
    LateProgress { bar: styled(hidden, what), start: Instant::now(), shown: OnceLock::new() }
}

/// A bar for the maps of a scene, one after the other; late, too.
pub(super) struct SceneProgress {
    scene: String,
    late: LateProgress,
}

/// As [`late_progress`], for the maps of a scene.
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
    /// So much more is done.
    pub(super) fn inc(&self, done: u64) {
        self.bar.inc(done);
        if self.start.elapsed() > PATIENCE {
            self.shown.get_or_init(|| self.bar.set_draw_target(ProgressDrawTarget::stderr()));
        }
    }

    /// So much needs not be done: it says nothing about the time that the rest takes.
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
    // A template that does not parse leaves the default style.
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.set_message(what.to_string());
    bar
}

/// A line on stderr; a closed stderr leaves nobody to tell.
pub(super) fn complain(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// An empty table for stdout.
pub(super) fn new_table<const N: usize>(header: [&str; N]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::UTF8_FULL_CONDENSED).set_header(header);
    table
}
