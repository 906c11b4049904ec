//! Benchmarks of frames, backends, preparation, vectors and effects, one per file: `cargo bench -p roughxel-benches --bench NAME`.

use std::time::{Duration, Instant};

/// Result of `once` and its time: the fastest of `times` runs.
///
/// # Panics
/// If `times` is 0.
pub fn fastest<T>(times: usize, mut once: impl FnMut() -> T) -> (T, Duration) {
    let timed = |_| {
        let start = Instant::now();
        let made = once();
        (made, start.elapsed())
    };
    (0..times).map(timed).min_by_key(|&(_, time)| time).expect("`times` is at least 1")
}
