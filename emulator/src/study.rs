//! Studies of the datapath: the named hard cases and its accuracy against the float64 reference.

pub mod accuracy;
pub mod cases;
