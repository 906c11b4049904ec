//! Tests of roughxel on the host: errata, accuracy, properties, hard cases, conformance of backends, pictures.
//!
//! The float64 reference is a separate package (`emulator/reference`) without any dependency on roughxel, so that the program, too, can report
//! errors against it.

pub mod bars;
pub mod checked;
pub mod declarations;
pub mod designs;
pub mod floorplan;
pub mod imports;
pub mod integers;
pub mod keys;
pub mod one_pixel;
pub mod performance;
pub mod photographs;
pub mod side_by_side;
pub mod simulators;
pub mod space;
pub mod table;
pub mod tokens;

pub use roughxel_reference as reference;
