//! Synthesis, placement and simulation of generated designs: the program `floorplan`, its kept results and its page.
//!
//! A [`cell::Cell`] is a design: profile, plan, multipliers, target. [`yosys`] makes its netlist, [`place`] places and routes the netlist on
//! [`device`]s, and [`simulate`] runs it with golden vectors. [`float`] does the same with float32 units. [`results`] are kept in a file, and
//! [`page`] and [`picture`] show only what is in it.

pub mod cell;
pub mod device;
pub mod float;
pub mod operations;
pub mod page;
pub mod picture;
pub mod place;
pub mod results;
pub mod simulate;
pub mod tools;
pub mod yosys;
