//! # roughxel-frame
//!
//! Whole frames through the integer datapath: visibility, fetches and the stages of each object's plan.
//!
//! Shading is deferred: the visible triangles of a tile first, then each pixel once, triangle by triangle. Fragments of an object
//! wait until they fill a batch. The batch passes through footprints, maps, surfaces and the environment in lanes; lights take
//! one fragment at a time. Tiles are independent, so the bits of a frame do not depend on the number of threads. Everything
//! between texel and pixel is a stage of `roughxel-core`.
//!
//! [`raster`] finds the visible fragments, [`plan`] selects the stages of each object, `prepare` builds the maps and constants of
//! the objects, `tile` finds the visible samples, `batch` takes waiting fragments through the stages.

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
mod texture;
mod tile;

pub use colour::{Colour, MAX_MAP_EXPONENT};
pub use environment::EnvironmentMap;
pub use fragments::{FragmentReflection, FrameFragment};
pub use frame::Frame;
pub use prepare::Prepared;
pub use texture::colour_map;
pub use tile::Counted;
