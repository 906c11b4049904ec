//! Benches of frames, readings, preparation, vectors and effects, one a file: `cargo bench -p roughxel-benches --bench NAME`.

use std::time::{Duration, Instant};

/// What `once` makes, and how long it takes: the fastest of some times.
///
/// # Panics
/// If it is done no time.
pub fn fastest<T>(times: usize, mut once: impl FnMut() -> T) -> (T, Duration) {
    let timed = |_| {
        let start = Instant::now();
        let made = once();
        (made, start.elapsed())
    };
    (0..times).map(timed).min_by_key(|&(_, time)| time).expect("it is done more than once")
}
