//! # roughxel-emulator
//!
//! Whole frames of real scenes through the integer datapath of `roughxel-core`, bit-accurate; golden vectors; studies.
//!
//! [`scene`] describes what is drawn, [`maps`] builds its pyramids, [`raster`] finds the visible fragments, [`plan`] says
//! which stages each object needs, and [`frame`] takes every fragment through them: each a package of its own. [`cases`] are
//! what the datapath is tested with, [`study`] measures it against the float64 reference; [`demo`] is the program's main
//! job, and [`gallery`] sets every picture of the papers beside what it is compared with.

pub mod demo;
pub mod eval;
pub mod gallery;
pub mod vectors;

pub use roughxel_cases as cases;
pub use roughxel_frame as frame;
pub use roughxel_frame::{plan, raster};
pub use roughxel_lanes as lanes;
pub use roughxel_maps as maps;
pub use roughxel_net as net;
pub use roughxel_record as record;
pub use roughxel_scene as scene;
pub use roughxel_scene::{input, output, picture, random, spelling};
pub use roughxel_study as study;
