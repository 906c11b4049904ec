//! Studies of the datapath: the named hard cases, its accuracy against the float64 reference, what each effect costs; what goes into the ports of
//! a design.

pub mod accuracy;
pub mod cases;
pub mod plan;
pub mod stimulus;
