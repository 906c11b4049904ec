//! # roughxel-study
//!
//! Studies of the datapath: its accuracy against the float64 reference, what each effect costs, and what accuracy costs in time.

pub mod accuracy;
pub mod plan;
