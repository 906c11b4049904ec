//! Studies of the datapath: its accuracy against the float64 reference, what each effect costs.

pub mod accuracy;
pub mod plan;
