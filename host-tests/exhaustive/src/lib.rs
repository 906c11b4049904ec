//! Stages and functions on 8-bit words, on every input: `cargo test --release -p roughxel-exhaustive`.
