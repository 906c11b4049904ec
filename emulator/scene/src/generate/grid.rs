//! Values in rows and columns, made in parallel, with their progress.

use rayon::prelude::*;
use roughxel_simd::Backend;

/// Receiver of the progress of a scene's maps; called from any thread.
pub trait MapProgress: Sync {
    /// Reports that a map of `steps` steps begins.
    fn begin(&self, map: &str, steps: u64);
    /// Reports that one step is done.
    fn step(&self);
}

/// A receiver that ignores progress.
pub(crate) struct Unseen;

impl MapProgress for Unseen {
    fn begin(&self, _: &str, _: u64) {}
    fn step(&self) {}
}

/// Makes the values of a map and reports progress.
#[derive(Clone, Copy)]
pub(super) struct Grid<'a> {
    pub(super) map: &'a str,
    pub(super) progress: &'a dyn MapProgress,
}

impl Grid<'_> {
    /// A grid without progress reports.
    #[cfg(test)]
    pub(super) fn unseen() -> Self {
        Self { map: "", progress: &Unseen }
    }

    /// A square of `size` × `size` values, row 0 on top, from `value(column, row)`. Rows are made in parallel; inlined code is compiled for the
    /// machine's vectors.
    pub(super) fn square<T: Clone + Default + Send>(self, size: u32, value: impl Fn(u32, u32) -> T + Sync) -> Vec<T> {
        self.rectangle(size, size, value)
    }

    /// [`Grid::square`] for any width and height.
    pub(super) fn rectangle<T: Clone + Default + Send>(
        self,
        width: u32,
        height: u32,
        value: impl Fn(u32, u32) -> T + Sync,
    ) -> Vec<T> {
        self.begin(height.into());
        let mut values = vec![T::default(); width as usize * height as usize];
        (0..height).into_par_iter().zip(values.par_chunks_mut(width as usize)).for_each(|(row, values)| {
            Backend::best().run(
                #[inline(always)]
                || {
                    for (column, place) in (0..width).zip(values) {
                        *place = value(column, row);
                    }
                },
            );
            self.step();
        });
        values
    }

    /// Begins a map of `steps` steps.
    pub(super) fn begin(self, steps: u64) {
        self.progress.begin(self.map, steps);
    }

    /// Reports a step.
    pub(super) fn step(self) {
        self.progress.step();
    }
}
