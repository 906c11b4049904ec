//! # roughxel-frame
//!
//! Whole frames through the integer datapath: visibility, fetches and the stages of each object's plan.
//!
//! Deferred: a tile's visible triangles first, then each pixel once. Fragments of an object wait until a batch of them
//! gets its footprints, and what reflects waits again for the reflection datapath, so that lanes are full. Tiles are
//! independent, so the bits of a frame do not depend on the number of threads. Memory between address and texel lives
//! here; everything between texel and pixel is a stage of `roughxel-core`.
//!
//! [`raster`] finds the visible fragments, [`plan`] says which stages each object needs, `prepare` has the maps and
//! constants of the objects, `tile` asks for what is visible, `batch` takes what waits through the stages.

mod batch;
mod capture;
mod colour;
mod environment;
mod frame;
mod lighting;
mod phases;
pub mod plan;
mod prepare;
mod printed;
pub mod raster;
mod texture;
mod tile;

pub use colour::{Channel, Colour, MAX_MAP_EXPONENT};
pub use environment::EnvironmentMap;
pub use frame::Frame;
pub use phases::{Phase, PhaseTimes};
pub use prepare::Prepared;
pub use texture::{ColourMap, Footprints, TextureDerivatives};
pub use tile::Counted;
