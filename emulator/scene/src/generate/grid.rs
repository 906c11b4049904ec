//! Values in rows and columns, made in parallel.

use rayon::prelude::*;

/// A square of `size` × `size` values, row 0 on top, from `value(column, row)`; rows are made in parallel.
pub(super) fn square<T: Send>(size: u32, value: impl Fn(u32, u32) -> T + Sync) -> Vec<T> {
    rectangle(size, size, value)
}

/// [`square`] for any width and height.
pub(super) fn rectangle<T: Send>(width: u32, height: u32, value: impl Fn(u32, u32) -> T + Sync) -> Vec<T> {
    let value = &value;
    (0..height).into_par_iter().flat_map_iter(|row| (0..width).map(move |column| value(column, row))).collect()
}
