//! # roughxel-emulator
//!
//! Whole frames of real scenes through the integer datapath of `roughxel-core`, bit-accurate; golden vectors; studies.
//!
//! [`scene`] describes what is drawn, [`maps`] builds its pyramids, [`raster`] finds the visible fragments, [`plan`] says
//! which blocks each object needs, and [`frame`] takes every fragment through them. [`study`] measures the datapath
//! against the float64 reference; [`demo`] is the program's main job, and [`gallery`] sets every picture of
//! the papers beside what it is compared with.

pub mod demo;
pub mod eval;
pub mod frame;
pub mod gallery;
pub mod maps;
pub mod output;
pub mod picture;
pub mod plan;
pub mod random;
pub mod raster;
pub mod scene;
pub mod study;
pub mod vectors;

pub use roughxel_lanes as lanes;
pub use roughxel_net as net;
