//! # roughxel-utilities
//!
//! Helpers that do not depend on the datapath:
//! - [`input`]: files to read;
//! - [`output`]: files that appear whole;
//! - [`crc`]: check values;
//! - [`random`]: seeded random numbers;
//! - [`mod@exp2`]: powers of two with the same bits everywhere;
//! - [`suggestions`]: suggestions for misspelt words;
//! - [`limits`]: bounds of input and pictures.

pub mod crc;
pub mod exp2;
pub mod input;
pub mod limits;
pub mod output;
pub mod random;
pub mod suggestions;
