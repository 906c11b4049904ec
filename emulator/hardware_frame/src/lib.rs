//! # roughxel-hardware-frame
//!
//! Frames drawn by the generated Verilog. [`Device`] is the hardware: the folded reflection, the probes, a texture cache, the filter and the sum of
//! pixels, as one module. [`Job`] is a frame for it: the fragments after their maps are sampled, and the texels of the environment in tiles.
//! [`Model`] is the device compiled by Verilator; it turns a job into the pixels of the frame and counts cycles, texels and bursts.

mod chain;
mod device;
mod job;
mod model;
mod pin;
mod wiring;

pub use device::{CACHE_LINES, Device, DeviceError, DeviceOptions};
pub use job::{Job, JobError, MAX_PIXELS};
pub use model::{Figures, Model, ModelError};
pub use wiring::Footprint;
