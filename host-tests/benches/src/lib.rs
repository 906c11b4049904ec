//! Benches of frames, readings, preparation, vectors and effects, one a file: `cargo bench -p roughxel-benches --bench NAME`.
