//! Tests of roughxel on the host: errata, accuracy, properties, hard cases, conformance of readings, pictures.
//!
//! The float64 reference is a package of its own (`emulator/reference`) that depends on nothing of roughxel, so
//! that the program can report errors against it, too.

pub mod bars;
pub mod checked;
pub mod designs;
pub mod imports;
pub mod integers;
pub mod keys;
pub mod one_pixel;
pub mod photographs;
pub mod side_by_side;
pub mod simulators;
pub mod space;
pub mod table;
pub mod tokens;

pub use roughxel_reference as reference;
