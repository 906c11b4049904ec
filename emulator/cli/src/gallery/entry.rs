//! What the gallery shows: scenes with columns, each a way to draw.

use roughxel_frame::plan::Mode;

use super::change::Change;

/// A scene of the gallery.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Name of a built-in scene.
    pub name: &'static str,
    /// The picture of the papers it stands for.
    pub source: &'static str,
    /// What it shows, one sentence.
    pub shows: &'static str,
    /// How it is drawn, left to right; [`UNFILTERED`](super::table::UNFILTERED) is among them, labels differ.
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
    pub(super) fn stem(&self) -> String {
        self.label.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' }).collect()
    }
}
