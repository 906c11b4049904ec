//! Values in rows and columns, made in parallel, and how far their making is.

use rayon::prelude::*;
use roughxel_simd::Backend;

/// Is told how far the making of a scene's maps is; from any thread.
pub trait MapProgress: Sync {
    /// A map is begun that takes so many steps.
    fn begin(&self, map: &str, steps: u64);
    /// One of them is done.
    fn step(&self);
}

/// For whom does not look.
pub(crate) struct Unseen;

impl MapProgress for Unseen {
    fn begin(&self, _: &str, _: u64) {}
    fn step(&self) {}
}

/// Makes the values of a map and tells of it.
#[derive(Clone, Copy)]
pub(super) struct Grid<'a> {
    pub(super) map: &'a str,
    pub(super) progress: &'a dyn MapProgress,
}

impl Grid<'_> {
    /// One that nobody looks at.
    #[cfg(test)]
    pub(super) fn unseen() -> Self {
        Self { map: "", progress: &Unseen }
    }

    /// A square of `size` × `size` values, row 0 on top, from `value(column, row)`; rows are made in parallel, and what is inlined is compiled for the
    /// vectors of the machine.
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

    /// Begins what takes so many steps.
    pub(super) fn begin(self, steps: u64) {
        self.progress.begin(self.map, steps);
    }

    /// Tells of a step.
    pub(super) fn step(self) {
        self.progress.step();
    }
}
