//! Loops over numbers side by side, as vectors of the machine they run on.
//!
//! The compiler makes vectors of loops over arrays whose elements all go the same way. Of +, −, ×, ÷, √, rounding and comparisons the bits are those of
//! one number after the other, with every instruction set.

use fearless_simd::{Level, Simd, dispatch};

/// Numbers side by side: two of the widest vectors.
pub const WIDTH: usize = 16;

/// Runs `body`, and all that is inlined into it, compiled for the widest instruction set of the machine.
#[inline(always)]
pub fn widest<R>(body: impl FnOnce() -> R) -> R {
    dispatch!(Level::new(), simd => simd.vectorize(body))
}
