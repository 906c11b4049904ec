//! # roughxel-frame
//!
//! Whole frames through the integer datapath: visibility, fetches and the stages of each object's plan.
//!
//! Deferred: a tile's visible triangles first, then each pixel once, triangle by triangle. Fragments of an object wait until they are a batch, and
//! go side by side through footprints, maps, surfaces and the environment; lights take them one by one. Tiles are
//! independent, so the bits of a frame do not depend on the number of threads. Everything between texel and pixel is a stage of `roughxel-core`.
//!
//! [`raster`] finds the visible fragments, [`plan`] says which stages each object needs, `prepare` has the maps and
//! constants of the objects, `tile` asks for what is visible, `batch` takes what waits through the stages.

mod capture;
mod colour;
mod environment;
mod frame;
mod lighting;
pub mod plan;
mod prepare;
mod printed;
pub mod raster;
mod texture;
mod tile;

pub use colour::{Colour, MAX_MAP_EXPONENT};
pub use environment::EnvironmentMap;
pub use frame::Frame;
pub use prepare::Prepared;
pub use texture::colour_map;
pub use tile::Counted;
