//! Studies of the datapath: the named hard cases, its accuracy against the float64 reference, what each effect costs.

pub mod accuracy;
pub mod cases;
pub mod plan;
