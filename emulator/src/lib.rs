//! # roughxel-emulator
//!
//! Whole frames of real scenes through the integer datapath of `roughxel-core`, bit-accurate; golden vectors; studies.
pub mod frame;
pub mod maps;
pub mod picture;
pub mod plan;
pub mod random;
pub mod raster;
pub mod scene;
pub mod study;
