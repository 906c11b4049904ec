//! Stages and functions on words of 8 bits, on every input: `cargo test --release -p roughxel-exhaustive`.
