//! The netlist of the datapath of `roughxel-core`, and the walks over it.
//!
//! [`builder`] keeps every operation of the recorded backend as a node ([`graph`]). Walks over the netlist:
//!
//! - [`evaluate`] computes it for given ports (a backend like any other).
//! - [`interval`] proves that no wire can leave its word.
//! - [`observe`] compares these ranges with the values of wires.
//! - [`census`] counts the cost of each stage, [`delay`] its levels on gates, [`target`] on devices.
//! - [`verilog`] writes it as hardware.
//!
//! Folder `op` defines each operation for all walks. Every [`Design`](roughxel_core::design::Design) can be recorded.

pub mod bench;
pub mod bins;
pub mod builder;
pub mod census;
pub mod delay;
pub mod redundant_faults;
pub mod evaluate;
pub mod table_check;
pub mod fault;
pub mod graph;
pub mod integers;
pub mod interval;
mod relational_facts;
pub mod faithful_rounding;
pub mod observe;
mod op;
mod range;
pub mod rounding;
pub mod operator_fault;
pub mod target;
pub mod unit;
pub mod verilog;
mod waiting;
