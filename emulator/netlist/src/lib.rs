//! The recorded reading: the datapath of `roughxel-core` as a graph, and the walks over it.
//!
//! [`builder`] keeps every operation of the recorded reading as a node ([`graph`]); what follows are walks:
//! [`evaluate`] computes it for given ports (a reading like any other), [`interval`] proves that no wire can leave
//! its word, [`observe`] holds that against what wires carry, [`census`] counts what each stage costs and [`delay`] how
//! long it takes, [`verilog`] writes it down as hardware. What each of them makes of an operation, the operation says itself,
//! in the folder `op`. What can be recorded is every [`Design`](roughxel_core::design::Design).

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
pub mod unit;
pub mod verilog;
mod waiting;
