//! Keys common to several generators.

use crate::error::SceneError;
use crate::source::Arguments;

/// Brightest value of an environment's colour, where white is 1.
pub(super) const BRIGHTEST: f64 = 1000.0;

impl Arguments<'_> {
    /// The edge of a map in texels.
    pub(super) fn size(&self, default: u32) -> Result<u32, SceneError> {
        self.whole("size", default, 4..=4096)
    }

    /// Seed of the random numbers.
    pub(super) fn seed(&self) -> Result<u32, SceneError> {
        self.whole("seed", 1, 0..=u32::MAX)
    }

    /// A light and a dark colour.
    pub(super) fn two_colours(
        &self,
        light: [f32; 3],
        dark: [f32; 3],
        brightest: f64,
    ) -> Result<[[f32; 3]; 2], SceneError> {
        Ok([self.colour("light", light, brightest)?, self.colour("dark", dark, brightest)?])
    }
}

/// Result of a maker with the keys of a table.
#[cfg(test)]
pub(super) fn with_keys<T>(keys: &str, make: impl FnOnce(&Arguments<'_>) -> T) -> T {
    use crate::source::{ArgumentTable, Source};

    #[derive(serde::Deserialize)]
    struct OneTable {
        table: toml::Spanned<ArgumentTable>,
    }

    let source = Source::new("test", &format!("table = {{ {keys} }}"), std::path::Path::new(""));
    let one: OneTable = toml::from_str(&source.text).unwrap();
    make(&Arguments::new(&source, &one.table))
}

/// The map of a generator, without progress reports.
#[cfg(test)]
pub(super) fn made<T>(
    make: impl FnOnce(super::grid::Grid<'_>, &Arguments<'_>) -> Result<T, SceneError>,
    keys: &str,
) -> T {
    with_keys(keys, |keys| make(super::grid::Grid::unseen(), keys)).unwrap()
}
