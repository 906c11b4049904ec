//! What frames, readings, preparation, vectors and effects take: one bench a file, `cargo bench -p roughxel-benches --bench NAME`.
