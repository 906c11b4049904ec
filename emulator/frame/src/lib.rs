//! # roughxel-frame
//!
//! Whole frames through the integer datapath: visibility, fetches and the stages of each object's plan.
//!
//! Shading is deferred: the visible triangles of a tile first, then each pixel once, triangle by triangle. Fragments of an object
//! wait until they fill a batch, which `roughxel-shader` takes through the stages in lanes. Tiles are independent, so the bits of a
//! frame do not depend on the number of threads. Everything between texel and pixel is a stage of `roughxel-core`.
//!
//! [`raster`] finds the visible fragments, and [`plan`] selects the stages of each object. `prepare` builds the maps and constants of
//! the objects, and `shared` a map once for all that hold it. `tile` finds the visible samples; `fragments` makes ports of them.

mod capture;
mod colour;
mod environment;
mod fragments;
mod frame;
mod lighting;
pub mod plan;
mod prepare;
mod printed;
pub mod raster;
pub mod shared;
mod texture;
mod tile;

pub use colour::{Colour, MAX_MAP_EXPONENT};
pub use environment::EnvironmentMap;
pub use fragments::{FragmentReflection, FrameFragment};
pub use frame::Frame;
pub use prepare::Prepared;
pub use texture::colour_map;
pub use tile::Counted;
