//! Entries of the gallery: scenes with columns. A column is a way to draw.

use roughxel_frame::plan::Mode;

use super::change::Change;

/// A scene of the gallery.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Name of a built-in scene.
    pub name: &'static str,
    /// Picture of the papers that the scene stands for.
    pub source: &'static str,
    /// One sentence about what the scene shows.
    pub shows: &'static str,
    /// Columns, left to right. [`UNFILTERED`](super::table::UNFILTERED) is among them, and labels differ.
    pub columns: &'static [Column],
}

/// A way to draw a scene.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Label above the picture. The file name is the label with `-` for other characters than letters and digits.
    pub label: &'static str,
    /// Sampling and filtering.
    pub mode: Mode,
    /// Change before drawing.
    pub change: Change,
}

impl Column {
    /// File name of the picture, without extension.
    pub(super) fn stem(&self) -> String {
        self.label.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' }).collect()
    }
}
