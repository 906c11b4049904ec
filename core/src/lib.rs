//! # roughxel-core
//!
//! The per-fragment datapath of antialiased bump and environment mapping (Schilling 1997, Fournier 1992) in integer arithmetic, fit for an FPGA or
//! ASIC description: no float, no division, no allocation, no panic.
//!
//! Read it from the outside in:
//!
//! 1. [`ports`]: inputs and outputs in `fixed` types, with the meaning of every bit pattern.
//! 2. [`datapath`]: the stages in order, and which of them a [`plan`] leaves out; every [`mod@design`] is one function of it.
//! 3. [`mod@stage`]: one file per hardware block; [`signals`] are the bundles between them.
//! 4. [`block`] and [`elementary`]: the compound steps, each with its claimed range and error bound.
//! 5. [`fx`] over [`word`]: a wire with its binary point in the type, over an algebra of 17 operations that several backends implement; [`scalar`] is
//!    the meaning. [`mod@bundle`] declares structures of wires and walks them. [`staged`] marks where a stage begins and ends; [`mod@each`] loops
//!    over arrays of wires.
//!
//! [`firmware`] is the way in for a program on a small processor: effects and accuracy as a type, footprints with their probes, a pixel from start to
//! end ([`sampler`]). [`scanline`] sets its fragments up in integers; [`small`] is the backend that it runs on. `examples` has one of each.
//!
//! [`scalar_api`], the scalar API, runs the datapaths from ports to ports on the scalar backend, with plan and accuracy as values; [`probe_list`] is a
//! footprint unrolled for it. [`precision`] holds the accuracy knobs and the five named profiles, [`width`] the words that each profile runs on.
//! [`rom`] holds the tables and [`status`] the sticky bits of degenerate inputs. With the feature `setup`, the module `setup` makes ports from
//! floating-point numbers.
//!
//! ```
//! use fixed::types::I2F30;
//! use roughxel_core::{plan::ReflectionPlan, ports::{BlockVector, ReflectionIn, SurfaceIn}, precision::Precision};
//!
//! let up = BlockVector { mantissa: [I2F30::ZERO, I2F30::ZERO, I2F30::from_bits(1 << 29)], exponent: 1 };
//! let surface = SurfaceIn { normal: up, view: up, ..Default::default() };
//! let fragment = ReflectionIn { surface, edge_texels: 256, ..Default::default() };
//! let out = fragment.reflect(&ReflectionPlan::FULL, &Precision::STANDARD);
//! assert_eq!(out.face, 4); // straight back, towards +z
//! ```
#![no_std]
#![forbid(unsafe_code)]

pub mod block;
pub mod bundle;
pub mod datapath;
pub mod design;
pub mod each;
pub mod elementary;
pub mod fetch;
pub mod firmware;
pub mod fx;
pub mod knob;
pub mod normalised;
pub mod plan;
pub mod ports;
pub mod precision;
pub mod probe_list;
pub mod wrapped;
pub mod rom;
pub mod sampler;
pub mod scalar;
pub mod scanline;
#[cfg(feature = "setup")]
pub mod setup;
pub mod signals;
pub mod small;
pub mod scalar_api;
pub mod staged;
pub mod stage;
pub mod status;
pub mod width;
pub mod word;
